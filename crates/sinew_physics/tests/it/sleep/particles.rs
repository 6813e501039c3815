//! Particles and sleeping bodies.

use super::{Nap, linear, nap, run, slab};
use crate::build::{box_body, floor};
use sinew_math::{Reader, Rotation, Vec3, Writer, max};
use sinew_physics::particles::{AttachmentTarget, ClothDef, GroupDef, ParticleDef, RopeDef};
use sinew_physics::*;

fn grains(height: f32) -> GroupDef {
    let grain = |i: u32| ParticleDef {
        position: Vec3::new(0.03 * i as f32 - 0.1, height, 0.02),
        velocity: Vec3::ZERO,
        mass: 0.01,
        radius: 0.01,
    };
    GroupDef { particles: (0..8).map(grain).collect(), ..GroupDef::default() }
}

#[test]
fn fast_particles_wake_bodies() {
    // A fall of 1 m to the crate takes 0.45 s.
    let Nap { mut world, sleeper, .. } = nap();
    world.add_particles(&grains(1.41));
    run(&mut world, 24);
    assert!(!world.is_awake(sleeper), "particles 0.2 m away must not wake the body");
    run(&mut world, 5);
    assert!(world.is_awake(sleeper));
}

/// Contacts wake bodies; overlapping bounds do not, because a world loaded from a snapshot has other bounds.
#[test]
fn overlapping_bounds_do_not_wake_a_body() {
    let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
    let slope = Rotation::from_axis_angle(Vec3::Z, core::f32::consts::FRAC_PI_4);
    let plank = BodyDef::dynamic(Shape::cuboid(Vec3::new(3.0, 0.05, 0.5))).turned(slope);
    let sleeper = world.add_body(&plank);
    world.put_to_sleep(sleeper);
    // The grains are within the plank's bounds, 1.4 m from the plank, and move toward it at 1 m/s.
    let away = slope * Vec3::Y;
    let mut flying = grains(0.0);
    for grain in &mut flying.particles {
        grain.position += away * 1.4;
        grain.velocity = -away;
    }
    world.add_particles(&flying);
    run(&mut world, 60);
    assert!(!world.is_awake(sleeper), "particles 0.2 m away must not wake the body");
    run(&mut world, 40);
    assert!(world.is_awake(sleeper));
}

#[test]
fn bodies_under_resting_particles_sleep() {
    let Nap { mut world, sleeper, .. } = nap();
    let id = world.add_particles(&grains(0.41));
    run(&mut world, 30);
    let group = world.particles(id);
    assert!(
        group.positions().iter().all(|at| (at.y - 0.41).abs() < 1e-3),
        "the particles must rest on the body"
    );
    assert!(!world.is_awake(sleeper), "particles put down gently must not wake the body");
}

#[test]
fn passing_particles_wake_nothing() {
    let Nap { mut world, sleeper, .. } = nap();
    let mut def = grains(0.5);
    def.gravity_scale = 0.0;
    for particle in &mut def.particles {
        particle.velocity = Vec3::Z * -20.0;
        particle.position.z = 3.0;
    }
    world.add_particles(&def);
    run(&mut world, 30);
    assert!(!world.is_awake(sleeper));
}

/// Returns a world with a cloth that hangs by two corners, asleep.
fn curtain() -> (World, GroupId) {
    let mut cloth = ClothDef {
        corner: Vec3::new(-0.5, 2.0, 0.0),
        across: Vec3::X,
        down: Vec3::NEG_Y,
        columns: 6,
        rows: 6,
        mass: 0.3,
        stretching: 1000.0,
        shearing: 100.0,
        bending: 1e-5,
        damping_ratio: 0.2,
        radius: 0.01,
    }
    .build();
    let row = cloth.row(0);
    cloth.hang(&row);
    cloth.group.linear_damping = 2.0;
    let mut world = World::new(WorldDef::default());
    let id = world.add_particles(&cloth.group);
    let asleep = (0..900).any(|_| {
        world.step();
        !world.particles(id).is_awake()
    });
    assert!(asleep, "the curtain must fall asleep");
    (world, id)
}

/// Checks that `act` on a sleeping curtain wakes it immediately or within `steps` steps.
fn wakes_curtain(what: &str, steps: usize, act: impl FnOnce(&mut World, GroupId)) {
    let (mut world, id) = curtain();
    act(&mut world, id);
    let woke = (0..steps).any(|_| {
        world.step();
        world.particles(id).is_awake()
    });
    assert!(woke, "{what} must wake the curtain");
}

#[test]
fn sleeping_cloth_does_not_move() {
    let (mut world, id) = curtain();
    let before = world.particles(id).positions().to_vec();
    let calls = world.hash();
    run(&mut world, 120);
    assert!(!world.particles(id).is_awake());
    assert_eq!(world.particles(id).positions(), before.as_slice());
    assert!(world.particles(id).velocities().iter().all(|v| *v == Vec3::ZERO));
    assert_ne!(world.hash(), calls, "the world's time must advance while the cloth sleeps");
}

#[test]
fn changes_wake_particles() {
    wakes_curtain("a push", 1, |world, id| world.particles_mut(id).apply_impulse(40, Vec3::Z * 1e-6));
    wakes_curtain("a velocity", 1, |world, id| world.particles_mut(id).set_velocity(40, Vec3::ZERO));
    wakes_curtain("a position", 1, |world, id| {
        let at = world.particles(id).positions()[40];
        world.particles_mut(id).set_position(40, at);
    });
    wakes_curtain("a pin", 1, |world, id| world.particles_mut(id).move_pin(0, Vec3::new(-0.5, 2.01, 0.0)));
    wakes_curtain("`wake`", 1, |world, id| world.particles_mut(id).wake());
    wakes_curtain("`Sleeping::Off`", 1, |world, id| world.particles_mut(id).set_sleeping(Sleeping::Off));
    wakes_curtain("an explosion", 1, |world, _| world.explode(&Explosion::new(Vec3::Y * 1.5, 2.0, 1.0)));
    wakes_curtain("gravity", 1, |world, _| world.set_gravity(Vec3::Y * -1.6));
    wakes_curtain("a new wind", 1, |world, _| {
        let wind = Wind { velocity: Vec3::Z * 3.0, ..Wind::default() };
        world.add_field(&FieldDef::new(FieldKind::Wind(wind)));
    });
}

#[test]
fn contacts_wake_particles() {
    let ball = |at: Vec3, velocity: Vec3| BodyDef {
        linear_velocity: velocity,
        gravity_scale: 0.0,
        ..box_body(Vec3::splat(0.1), at)
    };
    wakes_curtain("a body that flies into it", 60, |world, _| {
        world.add_body(&ball(Vec3::new(0.0, 1.5, 2.0), Vec3::Z * -4.0));
    });
    wakes_curtain("a slab that is moved into it", 60, |world, _| {
        let id = world.add_body(&slab(0.2, Vec3::new(0.0, 1.5, 0.5)));
        world.set_velocity(id, linear(Vec3::Z * -1.0));
    });
    wakes_curtain("a wall that is added at its position", 1, |world, _| {
        world.add_body(&BodyDef { kind: BodyKind::Static, ..ball(Vec3::Y * 1.5, Vec3::ZERO) });
    });
    let (mut world, id) = curtain();
    world.add_body(&ball(Vec3::new(0.0, 1.5, 2.0), Vec3::X));
    run(&mut world, 60);
    assert!(!world.particles(id).is_awake(), "a passing ball must not wake the particles");
}

/// Returns a world with a box that hangs on a rope, both asleep.
fn hung() -> (World, GroupId, BodyId) {
    let mut world = World::new(WorldDef::default());
    let calm =
        BodyDef { linear_damping: 2.0, angular_damping: 2.0, ..box_body(Vec3::splat(0.1), Vec3::Y * 0.9) };
    let body = world.add_body(&calm);
    let mut rope =
        RopeDef { from: Vec3::Y * 2.0, to: Vec3::Y, links: 5, mass: 0.1, stiffness: 1e4, radius: 0.01 }
            .build();
    rope.group.hold_in_world(&[rope.first]);
    rope.group.hold(rope.last, AttachmentTarget::Body { body, point: Vec3::Y * 0.1 });
    rope.group.linear_damping = 2.0;
    let id = world.add_particles(&rope.group);
    let asleep = (0..1200).any(|_| {
        world.step();
        !world.particles(id).is_awake()
    });
    assert!(asleep && !world.is_awake(body), "box and particles must fall asleep together");
    (world, id, body)
}

#[test]
fn attached_groups_and_bodies_wake_together() {
    let (mut world, id, body) = hung();
    world.apply_impulse_at_center(body, Vec3::X);
    world.step();
    assert!(world.particles(id).is_awake(), "the rope must wake with its box");
    let (mut world, id, body) = hung();
    world.particles_mut(id).apply_impulse(3, Vec3::X * 0.1);
    world.step();
    assert!(world.is_awake(body), "the box must wake with its rope");
    let (mut world, id, body) = hung();
    world.remove_particles(id);
    assert!(world.is_awake(body), "removing the rope must wake the box");
}

#[test]
fn restored_world_sleeps_and_wakes_like_the_original() {
    let (mut world, id, body) = hung();
    let mut at_rest = Writer::new();
    world.save(&mut at_rest);
    let wake = |world: &mut World| {
        world.particles_mut(id).apply_impulse(3, Vec3::X * 0.1);
        let mut roused = Writer::new();
        world.save(&mut roused);
        run(world, 50);
        (roused.into_bytes(), world.hash())
    };
    let (roused, expected) = wake(&mut world);
    world.load(&mut Reader::new(at_rest.as_bytes())).expect("the snapshot must load");
    assert!(!world.particles(id).is_awake() && !world.is_awake(body));
    run(&mut world, 10);
    world.load(&mut Reader::new(at_rest.as_bytes())).expect("the snapshot must load");
    assert_eq!(wake(&mut world).1, expected, "the restored sleeping world must wake in the same way");
    let mut other = World::new(WorldDef::default());
    other.load(&mut Reader::new(&roused)).expect("the snapshot must load");
    run(&mut other, 50);
    assert_eq!(other.hash(), expected, "a world saved between the push and the step must continue equally");
}

#[test]
fn a_body_under_a_swinging_rope_sleeps() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let at = Vec3::Y * 0.25;
    let body = world.add_body(&box_body(Vec3::splat(0.25), at));
    let middle = Vec3::new(0.0, 0.8, 0.02);
    let rope = RopeDef {
        from: middle - Vec3::X * 0.6,
        to: middle + Vec3::X * 0.6,
        links: 24,
        mass: 1.0,
        stiffness: 2000.0,
        radius: 0.01,
    };
    let rope = world.add_particles(&rope.build().group);
    run(&mut world, 40);
    let group = world.particles(rope);
    let fastest = group.velocities().iter().fold(0.0, |most, v| max(most, v.length()));
    // Particles may fall asleep below 0.001 m/s.
    assert!(
        group.is_awake() && fastest > 0.003,
        "the rope must still swing on the box; fastest {fastest} m/s"
    );
    assert!(!world.is_awake(body), "the box must sleep under the rope");
    run(&mut world, 260);
    let way = (world.center_of_mass(body) - at).length();
    assert!(!world.is_awake(body) && way < 1e-3, "the sleeping box moved {way} m");
}

/// Returns a net of a square metre at a height of 1 m.
fn net(damping_ratio: f32) -> GroupDef {
    let net = ClothDef {
        corner: Vec3::new(-0.5, 1.0, -0.5),
        across: Vec3::X,
        down: Vec3::Z,
        columns: 10,
        rows: 10,
        mass: 0.5,
        stretching: 2000.0,
        shearing: 500.0,
        bending: 1e-3,
        damping_ratio,
        radius: 0.02,
    };
    net.build().group
}

/// Returns a world with a ball asleep on a net that still moves.
fn netted() -> (World, GroupId, BodyId) {
    let mut world = World::new(WorldDef::default());
    let mut net = net(1.0);
    net.hold_in_world(&(0..11).chain(110..121).collect::<Vec<_>>());
    net.sleeping = Sleeping::Off;
    let net = world.add_particles(&net);
    run(&mut world, 240);
    let group = world.particles(net);
    let height = |(at, radius): (&Vec3, &f32)| {
        let reach = radius + 0.1;
        at.y + max(reach * reach - at.x * at.x - at.z * at.z, 0.0).sqrt()
    };
    let near = group.positions().iter().zip(group.radii()).filter(|(at, _)| at.x * at.x + at.z * at.z < 0.01);
    let ball = BodyDef {
        position: Vec3::Y * near.map(height).fold(0.0, max),
        shapes: vec![ShapeDef::new(Shape::Sphere { radius: 0.1 })],
        ..BodyDef::default()
    };
    let ball = world.add_body(&ball);
    world.put_to_sleep(ball);
    run(&mut world, 60);
    assert!(!world.is_awake(ball) && world.particles(net).is_awake());
    (world, net, ball)
}

#[test]
fn bodies_wake_when_the_particles_below_are_removed() {
    let (mut world, net, ball) = netted();
    let at = world.center_of_mass(ball);
    for pin in 0..22 {
        let AttachmentTarget::World(place) = world.particles(net).attachments()[pin].target else {
            panic!("all attachments of the net are to the world");
        };
        world.particles_mut(net).move_pin(pin, place - Vec3::Y * 0.5);
    }
    run(&mut world, 30);
    assert!(world.is_awake(ball), "removing the net below must wake the ball");
    assert!((world.center_of_mass(ball) - at).y < -0.1, "the ball must fall");

    let (mut world, net, ball) = netted();
    world.remove_particles(net);
    assert!(world.is_awake(ball), "removing the net must wake the ball");

    let (mut world, net, ball) = netted();
    world.particles_mut(net).apply_impulse(115, Vec3::Y * 1e-4);
    world.step();
    assert!(!world.is_awake(ball), "removing a net that does not support the ball must not wake it");
}

#[test]
fn a_body_in_a_net_falls_asleep() {
    let mut world = World::new(WorldDef::default());
    let mut net = net(0.2);
    let is_border = |i: &u32| [0, 10].contains(&(i % 11)) || [0, 10].contains(&(i / 11));
    net.hold_in_world(&(0..121).filter(is_border).collect::<Vec<_>>());
    net.iterations = 2;
    net.linear_damping = 2.0;
    world.add_particles(&net);
    let ball = world.add_body(&BodyDef {
        position: Vec3::Y * 1.3,
        shapes: vec![ShapeDef { density: 50.0, ..ShapeDef::new(Shape::Sphere { radius: 0.15 }) }],
        linear_damping: 2.0,
        angular_damping: 2.0,
        ..BodyDef::default()
    });
    run(&mut world, 900);
    let at = world.center_of_mass(ball);
    assert!(!world.is_awake(ball), "the ball must sleep");
    assert!((0.9..1.1).contains(&at.y) && at.x.abs() < 0.05 && at.z.abs() < 0.05, "the ball lies at {at:?}");
    run(&mut world, 300);
    assert_eq!(world.center_of_mass(ball), at, "the net must not move the sleeping ball");
}
