//! Backstops: balls that stop one particle each, without friction, and push their body as much as the particle.

use crate::build::{box_body, sphere_body};
use sinew_math::{Reader, Rotation, Transform, Vec3, Writer};
use sinew_physics::particles::{
    AttachmentDef, AttachmentTarget, BackstopDef, ClothDef, GroupDef, ParticleDef, SpringDef,
};
use sinew_physics::*;

/// Radius of the particles, metres.
const RADIUS: f32 = 0.02;

fn particle(position: Vec3, mass: f32) -> ParticleDef {
    ParticleDef { position, velocity: Vec3::ZERO, mass, radius: RADIUS }
}

/// Returns a body that is far away from its backstops.
fn far_from_it(kind: BodyKind, frame: Transform) -> BodyDef {
    let body_from_shape = Transform::from_translation(Vec3::new(0.0, -5.0, 1.0));
    let shape = ShapeDef { body_from_shape, ..ShapeDef::new(Shape::Sphere { radius: 0.1 }) };
    BodyDef {
        kind,
        position: frame.translation,
        rotation: frame.rotation,
        shapes: vec![shape],
        ..BodyDef::default()
    }
}

/// A particle on a spring beside a frictionless ball comes to rest where the sum of spring force and gravity acts along
/// the normal. A particle for which the ball is not a backstop passes through it.
#[test]
fn particle_rests_on_its_backstop_without_friction() {
    let mut world = World::new(WorldDef::default());
    let frame =
        Transform::new(Vec3::new(0.4, 1.0, -0.3), Rotation::from_axis_angle(Vec3::ONE.normalize(), 0.7));
    let body = world.add_body(&far_from_it(BodyKind::Static, frame));
    let (center, reach) = (Vec3::new(0.1, 1.2, 0.0), 0.3);
    let (pin, mass, stiffness, rest_length) = (Vec3::new(0.25, 1.7, 0.05), 0.5, 30.0, 0.2);
    let group = |backstops: Vec<BackstopDef>| GroupDef {
        particles: vec![particle(pin, 1.0), particle(Vec3::new(0.3, 1.5, 0.05), mass)],
        springs: vec![SpringDef::new([0, 1], rest_length, stiffness).damped(0.3, [f32::INFINITY, mass])],
        attachments: vec![AttachmentDef { particle: 0, target: AttachmentTarget::World(pin) }],
        linear_damping: 2.0,
        backstops,
        material: Material { friction: 0.8, restitution: 0.5, ..Material::DEFAULT },
        ..GroupDef::default()
    };
    let backstop =
        BackstopDef { particle: 1, body, center: frame.inverse_point(center), radius: reach - RADIUS };
    let stopped = world.add_particles(&group(vec![backstop]));
    let free = world.add_particles(&group(Vec::new()));
    let mut deepest = reach;
    for _ in 0..1200 {
        world.step();
        let off = (world.particles(stopped).positions()[1] - center).length();
        deepest = f32::min(deepest, off);
    }
    assert!(deepest > reach - 1e-4, "the particle is {} m inside the ball", reach - deepest);
    let at = world.particles(stopped).positions()[1];
    let normal = (at - center).normalize();
    assert!(
        ((at - center).length() - reach).abs() < 2e-5,
        "the particle is {} m from the ball's centre, expected {reach} m",
        (at - center).length()
    );
    let pull = (pin - at).normalize() * (stiffness * ((pin - at).length() - rest_length));
    let force = pull + Vec3::NEG_Y * (9.81 * mass);
    assert!(force.dot(normal) < -0.2, "the force along the normal is {} N", force.dot(normal));
    let along = force - normal * force.dot(normal);
    assert!(along.length() < 5e-3, "friction must be 0; the force along the surface is {} N", along.length());
    let below = world.particles(free).positions()[1];
    assert!(
        (below - center).length() < reach - 0.05,
        "the particle without a backstop must pass through the ball; it is at {below}"
    );
}

/// A particle passes through the backstop of another particle, and so does another body.
#[test]
fn backstops_affect_only_their_particle() {
    let mut world = World::new(WorldDef::default());
    let body = world.add_body(&far_from_it(BodyKind::Static, Transform::IDENTITY));
    let at = |x: f32| particle(Vec3::new(x, 1.0, 0.0), 0.1);
    let group = world.add_particles(&GroupDef {
        particles: vec![at(0.0), at(0.001), at(-0.001)],
        backstops: vec![BackstopDef { particle: 1, body, center: Vec3::new(0.001, 0.0, 0.0), radius: 0.2 }],
        ..GroupDef::default()
    });
    let ball = world.add_body(&sphere_body(0.05, Vec3::new(0.1, 1.5, 0.0)));
    (0..60).for_each(|_| world.step());
    let height = |i: usize| world.particles(group).positions()[i].y;
    assert!(
        (height(1) - 0.22).abs() < 1e-4,
        "the middle particle must rest on its own ball; height {}",
        height(1)
    );
    assert!(
        height(0) < -1.0 && height(2) < -1.0,
        "the other particles must fall through the ball; heights {}, {}",
        height(0),
        height(2)
    );
    assert!(world.transform(ball).translation.y < -1.0);
}

/// A particle hits the backstop of a free body without restitution: both end with one speed along the normal, and
/// momentum and angular momentum do not change.
#[test]
fn backstop_impulses_are_equal_and_opposite() {
    for aside in [0.0, 0.15] {
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let (radius, mass, speed) = (0.1, 0.3, 2.0);
        let body = world.add_body(&sphere_body(radius, Vec3::ZERO));
        let whole = world.mass(body).mass;
        let center = Vec3::new(0.0, aside, 0.5);
        let mut def = GroupDef {
            particles: vec![particle(Vec3::new(0.0, aside, 1.5), mass)],
            backstops: vec![BackstopDef { particle: 0, body, center, radius: 0.25 }],
            ..GroupDef::default()
        };
        def.particles[0].velocity = Vec3::Z * -speed;
        let group = world.add_particles(&def);
        let momentum = |world: &World| {
            let (v, p) = (world.velocity(body), world.particles(group));
            let (at, moves) = (p.positions()[0], p.velocities()[0] * mass);
            let spin = v.angular * (0.4 * whole * radius * radius);
            let orbit = world.transform(body).translation.cross(v.linear * whole);
            (v.linear * whole + moves, spin + orbit + at.cross(moves))
        };
        let (before, turning) = momentum(&world);
        (0..20).for_each(|_| world.step());
        assert_eq!(
            world.velocity(body).linear,
            Vec3::ZERO,
            "the particle must not have hit the backstop yet"
        );
        (0..40).for_each(|_| world.step());
        let (after, turning_after) = momentum(&world);
        assert!((after - before).length() < 1e-5, "momentum {before} before, {after} after, N·s");
        assert!(
            (turning_after - turning).length() < 2e-3 * mass * speed,
            "angular momentum {turning} before, {turning_after} after"
        );
        let v = world.velocity(body);
        assert!(v.linear.z < -0.05, "the particle must pull the body along; speed {}", v.linear.z);
        if aside == 0.0 {
            let together = -speed * mass / (whole + mass);
            assert!(
                (v.linear.z - together).abs() < 1e-4 * speed,
                "body speed {} m/s, expected {together} m/s",
                v.linear.z
            );
            let own = world.particles(group).velocities()[0].z;
            assert!(
                (own - together).abs() < 1e-4 * speed,
                "particle speed {own} m/s, expected {together} m/s"
            );
        } else {
            assert!(v.angular.x.abs() > 0.1, "the body must rotate; spin {}", v.angular.x);
        }
    }
}

/// The particle stays on its backstop while the body moves and rotates.
#[test]
fn a_backstop_moves_with_its_body() {
    let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
    let body = world.add_body(&far_from_it(BodyKind::Kinematic, Transform::IDENTITY));
    // The particle starts ahead of the backstop.
    let (linear, angular) = (Vec3::Y * 0.2, Vec3::Y * -2.0);
    let way = linear + angular.cross(Vec3::X - world.center_of_mass(body));
    let ahead = way.normalize();
    let group = world.add_particles(&GroupDef {
        particles: vec![particle(Vec3::X + ahead * 0.25, 0.1)],
        backstops: vec![BackstopDef { particle: 0, body, center: Vec3::X, radius: 0.2 }],
        iterations: 3,
        ..GroupDef::default()
    });
    world.set_velocity(body, Velocity { linear, angular });
    let mut pushed = 0;
    for _ in 0..120 {
        world.step();
        let (at, frame) = (world.particles(group).positions()[0], world.transform(body));
        let gap = (at - frame.point(Vec3::X)).length() - 0.2 - RADIUS;
        assert!(gap > -1e-4, "the particle is {} m inside the backstop", -gap);
        pushed += u32::from(gap < 1e-3);
    }
    let speed = world.particles(group).velocities()[0].length();
    assert!(
        pushed > 1 && speed > 0.9 * way.length(),
        "the ball pushed for {pushed} steps, up to {speed} m/s"
    );
}

/// Returns cloth above a heap of bodies, each particle with a backstop on one of them.
fn draped() -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let at = |k: i32| Vec3::new(0.4 * k as f32 - 0.4, 0.3, 0.1 * k as f32);
    let bodies: Vec<BodyId> =
        (0..3).map(|k| world.add_body(&box_body(Vec3::new(0.12, 0.2, 0.15), at(k)))).collect();
    let mut def = ClothDef {
        corner: Vec3::new(-0.6, 0.9, -0.4),
        across: Vec3::X * 1.2,
        down: Vec3::Z * 0.8,
        columns: 12,
        rows: 8,
        mass: 0.4,
        stretching: 1000.0,
        shearing: 100.0,
        bending: 1e-4,
        damping_ratio: 0.2,
        radius: RADIUS,
    }
    .build()
    .group;
    let stop = |(index, particle): (usize, &ParticleDef)| {
        let body = bodies[index % 3];
        let center = world.transform(body).inverse_point(particle.position - Vec3::Y * 0.45);
        BackstopDef { particle: index as u32, body, center, radius: 0.25 }
    };
    def.backstops = def.particles.iter().enumerate().map(stop).collect();
    world.add_particles(&def);
    world
}

#[test]
fn threads_and_snapshots_have_the_same_bits() {
    let mut one = draped();
    let mut others: Vec<(Threads, World)> = [2, 4].map(|count| (Threads::new(count), draped())).into();
    let mut copy: Option<World> = None;
    for step in 0..90 {
        one.step();
        for (threads, world) in &mut others {
            world.step_with(threads, &stage::NoProfiler);
            assert_eq!(world.hash(), one.hash(), "step {step}");
        }
        if let Some(copy) = &mut copy {
            copy.step();
            assert_eq!(copy.hash(), one.hash(), "step {step}");
        }
        if step == 40 {
            let mut w = Writer::new();
            one.save(&mut w);
            let mut again = World::new(WorldDef::default());
            again.load(&mut Reader::new(w.as_bytes())).expect("a world must load its own snapshot");
            let groups = one.group_ids().zip(again.group_ids()).next().expect("there is one");
            assert_eq!(again.particles(groups.1).backstops(), one.particles(groups.0).backstops());
            copy = Some(again);
        }
    }
    let group = one.particles(one.group_ids().next().expect("there is one"));
    let off = group.backstops().iter().map(|stop| {
        let center = one.transform(stop.body).point(stop.center);
        (group.positions()[stop.particle as usize] - center).length() - stop.radius - RADIUS
    });
    let on = off.filter(|gap| *gap < 1e-3).count();
    assert!(on > 10, "only {on} particles rest on their backstops");
}

/// A group that sleeps on its backstop sleeps with the body, and wakes when the body is moved.
#[test]
fn a_backstop_sleeps_and_wakes_with_its_body() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let body = world.add_body(&box_body(Vec3::splat(0.2), Vec3::Y * 0.2));
    let group = world.add_particles(&GroupDef {
        particles: vec![particle(Vec3::new(0.0, 1.05, 0.0), 0.1)],
        backstops: vec![BackstopDef { particle: 0, body, center: Vec3::Y * 0.5, radius: 0.25 }],
        ..GroupDef::default()
    });
    let mut steps = 0;
    while (world.particles(group).is_awake() || world.is_awake(body)) && steps < 600 {
        world.step();
        steps += 1;
    }
    assert!(steps < 600, "the group and the body must fall asleep");
    world.apply_impulse(body, Vec3::X * 20.0, world.center_of_mass(body));
    (0..3).for_each(|_| world.step());
    assert!(world.particles(group).is_awake(), "removing the support must wake the particles");
    (0..60).for_each(|_| world.step());
    let gone = world.particles(group).positions()[0];
    assert!(
        (gone - Vec3::new(0.0, 0.97, 0.0)).length() > 0.05,
        "the particles must move away after the support is gone; moved by {gone}"
    );
}

#[test]
fn group_check_refuses_invalid_backstops() {
    let mut world = World::new(WorldDef::default());
    let body = world.add_body(&sphere_body(0.1, Vec3::ZERO));
    let stop = BackstopDef { particle: 1, body, center: Vec3::ZERO, radius: 0.1 };
    let whole = GroupDef {
        particles: vec![particle(Vec3::Y, 0.1), particle(Vec3::Y * 2.0, 0.1)],
        attachments: vec![AttachmentDef { particle: 0, target: AttachmentTarget::World(Vec3::Y) }],
        backstops: vec![stop],
        ..GroupDef::default()
    };
    assert_eq!(whole.check(), Ok(()));
    let bad: [&[BackstopDef]; 7] = [
        &[stop, stop],
        &[BackstopDef { particle: 0, ..stop }],
        &[BackstopDef { particle: 2, ..stop }],
        &[BackstopDef { radius: 0.0, ..stop }],
        &[BackstopDef { radius: f32::NAN, ..stop }],
        &[BackstopDef { radius: f32::INFINITY, ..stop }],
        &[BackstopDef { center: Vec3::new(0.0, f32::NAN, 0.0), ..stop }],
    ];
    for backstops in bad {
        let def = GroupDef { backstops: backstops.to_vec(), ..whole.clone() };
        assert!(def.check().is_err(), "{backstops:?}");
    }
}

#[test]
#[should_panic(expected = "have backstops")]
fn a_body_with_a_backstop_cannot_be_removed() {
    let mut world = World::new(WorldDef::default());
    let body = world.add_body(&sphere_body(0.1, Vec3::ZERO));
    world.add_particles(&GroupDef {
        particles: vec![particle(Vec3::Y, 0.1)],
        backstops: vec![BackstopDef { particle: 0, body, center: Vec3::ZERO, radius: 0.1 }],
        ..GroupDef::default()
    });
    world.remove_body(body);
}
