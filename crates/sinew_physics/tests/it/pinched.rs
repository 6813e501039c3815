//! Particles between a body and a fixed shape: they carry the body, are not pushed into the shape, and add no energy.

use crate::build::{floor, joint};
use sinew_math::{Reader, Rotation, Transform, Vec3, Writer, trig};
use sinew_physics::particles::{
    AttachmentDef, AttachmentTarget, ClothDef, GroupDef, ParticleDef, RopeDef, SpringScheme, TetherDef,
};
use sinew_physics::*;

/// Radius of the roller, metres.
const ROLLER: f32 = 0.15;
/// Radius of the particles, metres.
const RADIUS: f32 = 0.03;

/// Adds a roller of 40 kg above the floor, with its axis along z, moving along x.
fn roller(world: &mut World, height: f32, speed: f32) -> BodyId {
    let shape = Shape::Capsule { half_height: 0.18, radius: ROLLER };
    let mut def = BodyDef {
        position: Vec3::new(0.0, ROLLER + height, 0.0),
        rotation: Rotation::from_axis_angle(Vec3::X, core::f32::consts::FRAC_PI_2),
        linear_velocity: Vec3::X * speed,
        angular_velocity: Vec3::Z * (-speed / ROLLER),
        shapes: vec![ShapeDef::new(shape)],
        ..BodyDef::default()
    };
    def.shapes[0].density *= 40.0 / world_mass(&def);
    world.add_body(&def)
}

fn world_mass(def: &BodyDef) -> f32 {
    let mut world = World::new(WorldDef::default());
    let id = world.add_body(def);
    world.mass(id).mass
}

/// Returns the depth of the deepest particle in the floor, metres.
fn depth_in_floor(world: &World, id: GroupId) -> f32 {
    let group = world.particles(id);
    let depths = group.positions().iter().zip(group.radii()).map(|(at, radius)| radius - at.y);
    depths.fold(0.0, f32::max)
}

/// A heavy roller crosses a rope on the ground. The total energy does not rise, and the rope's particles stay on the
/// ground.
#[test]
fn a_roller_crosses_a_rope_without_energy_gain() {
    for (stiffness, turn) in [(1e3, 0.0), (5e4, 0.0), (5e4, 0.7), (5e4, 1.5)] {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        roller(&mut world, 0.0, 1.0);
        let half = Rotation::from_axis_angle(Vec3::Y, turn) * (Vec3::Z * 0.45);
        let middle = Vec3::new(0.75, RADIUS, 0.0);
        let def = RopeDef {
            from: middle - half,
            to: middle + half,
            links: 14,
            mass: 0.5,
            stiffness,
            radius: RADIUS,
        };
        let rope = world.add_particles(&def.build().group);
        let begin = world.energy().total();
        for step in 0..180 {
            world.step();
            let what = format!("{stiffness} N at {turn} rad, step {step}");
            let gain = world.energy().total() - begin;
            assert!(gain < 0.1, "{what}: the energy rose by {gain} J");
            assert!(
                depth_in_floor(&world, rope) < 1e-4,
                "{what}: {} m in the floor",
                depth_in_floor(&world, rope)
            );
        }
    }
}

/// A roller placed on cloth on the ground rests on it and does not sink in.
#[test]
fn cloth_on_the_ground_carries_a_roller() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let roller = roller(&mut world, 2.0 * RADIUS + 0.01, 0.0);
    let cloth = ClothDef {
        corner: Vec3::new(-0.3, RADIUS, -0.3),
        across: Vec3::X * 0.6,
        down: Vec3::Z * 0.6,
        columns: 12,
        rows: 12,
        mass: 0.5,
        stretching: 2000.0,
        shearing: 200.0,
        bending: 1e-5,
        damping_ratio: 0.2,
        radius: RADIUS,
    };
    let cloth = world.add_particles(&cloth.build().group);
    let begin = world.energy().total();
    for step in 0..240 {
        world.step();
        let gain = world.energy().total() - begin;
        assert!(gain < 0.1, "step {step}: the energy rose by {gain} J");
        assert!(
            depth_in_floor(&world, cloth) < 1e-4,
            "step {step}: {} m in the floor",
            depth_in_floor(&world, cloth)
        );
    }
    let height = world.center_of_mass(roller).y - ROLLER;
    assert!(height > 1.8 * RADIUS, "the roller is {height} m above the ground");
}

/// The end of a rope that starts in the narrow crease between two limbs comes out without a gain of energy.
#[test]
fn rope_end_that_starts_in_a_crease_leaves_it() {
    for bend in [0.2_f32, 0.8, 1.6] {
        let mut world = World::new(WorldDef::default());
        let limb = |turn: f32| {
            let along = Rotation::from_axis_angle(Vec3::X, turn);
            BodyDef {
                kind: BodyKind::Static,
                // The ends of the limbs are 5 mm apart.
                position: Vec3::Y + along * (Vec3::Y * 0.1825),
                rotation: along,
                shapes: vec![ShapeDef::new(Shape::Capsule { half_height: 0.15, radius: 0.03 })],
                ..BodyDef::default()
            }
        };
        world.add_body(&limb(bend * 0.5));
        world.add_body(&limb(core::f32::consts::PI - bend * 0.5));
        let mut rope = RopeDef {
            from: Vec3::new(0.6, 1.005, 0.002),
            to: Vec3::new(0.0, 1.005, 0.002),
            links: 12,
            mass: 0.1,
            stiffness: 500.0,
            radius: 0.015,
        }
        .build();
        rope.group.hold_in_world(&[rope.first]);
        rope.group.linear_damping = 1.0;
        let id = world.add_particles(&rope.group);
        let most = world.energy().total() + 1e-3;
        for step in 0..240 {
            world.step();
            let energy = world.energy().total();
            assert!(energy < most, "bent by {bend}, step {step}: energy {energy} J, bound {most} J");
        }
        let end = world.particles(id).positions()[rope.last as usize];
        assert!(end.x > 0.05, "bent by {bend}: the rope's end must leave the crease; it is at {end:?}");
    }
}

/// Returns cloth on the ground, with cells of 5 cm and 1 kg/m².
fn carpet(corner: Vec3, cells: [u32; 2], friction: f32) -> GroupDef {
    let [columns, rows] = cells;
    let (across, down) = (Vec3::X * (0.05 * columns as f32), Vec3::Z * (0.05 * rows as f32));
    let mut cloth = ClothDef {
        corner: corner + Vec3::Y * RADIUS,
        across,
        down,
        columns,
        rows,
        mass: across.x * down.z,
        stretching: 2000.0,
        shearing: 200.0,
        bending: 1e-5,
        damping_ratio: 0.2,
        radius: RADIUS,
    }
    .build();
    cloth.group.material.friction = friction;
    cloth.group
}

/// Adds a crate of `mass` kg, half a metre wide, with its lower face at the height `bottom`.
fn crate_of(world: &mut World, mass: f32, bottom: f32) -> BodyId {
    let half_extents = Vec3::new(0.25, 0.15, 0.25);
    let mut def = BodyDef {
        position: Vec3::Y * (bottom + half_extents.y),
        shapes: vec![ShapeDef::new(Shape::Box { half_extents })],
        ..BodyDef::default()
    };
    def.shapes[0].density *= mass / world_mass(&def);
    world.add_body(&def)
}

/// A crate rests on light cloth as on the floor: raised by the thickness of the cloth, still, and asleep.
#[test]
fn crates_on_cloth_rest_and_fall_asleep() {
    for mass in [1.0, 100.0, 2000.0] {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        let cloth = world.add_particles(&carpet(Vec3::new(-0.4, 0.0, -0.4), [16, 16], 0.6));
        let id = crate_of(&mut world, mass, 2.0 * RADIUS + 0.02);
        for _ in 0..240 {
            world.step();
        }
        let bottom = world.center_of_mass(id).y - 0.15;
        // Without cloth, a crate sinks into the floor by the same depth: a fifth of the slop, and the yield of the
        // soft contact.
        assert!((bottom - 2.0 * RADIUS).abs() < 2e-3, "{mass} kg: the bottom is {bottom} m above the floor");
        assert!(
            depth_in_floor(&world, cloth) < 1e-4,
            "{mass} kg: {} m in the floor",
            depth_in_floor(&world, cloth)
        );
        assert!(!world.is_awake(id), "{mass} kg: still awake after 4 s");
    }
}

/// A crate that settles on cloth over a sleeping crate wakes that crate, which carries it; both fall asleep.
#[test]
fn crate_landing_on_cloth_wakes_the_crate_below() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let below = crate_of(&mut world, 5.0, 0.0);
    world.put_to_sleep(below);
    let mut def = carpet(Vec3::new(-0.2, 0.3, -0.2), [8, 8], 0.6);
    def.sleeping = Sleeping::Off;
    world.add_particles(&def);
    for _ in 0..60 {
        world.step();
    }
    assert!(!world.is_awake(below), "cloth alone must not wake a body");
    // The crate falls too slowly to count as an impact.
    let above = crate_of(&mut world, 5.0, 0.3 + 2.0 * RADIUS + 0.001);
    let mut woke = false;
    for _ in 0..30 {
        world.step();
        woke |= world.is_awake(below);
    }
    assert!(woke, "the upper crate must wake the lower one through the cloth");
    for _ in 0..240 {
        world.step();
    }
    assert!(!world.is_awake(below) && !world.is_awake(above), "both crates must fall asleep");
}

/// The load on cloth under a crate holds the cloth by friction: a smaller pull does not move it, a larger one pulls it
/// out.
#[test]
fn cloth_under_a_crate_is_held_by_its_friction() {
    let (mass, friction) = (2.0, 0.5);
    // Floor and crate each hold the cloth by friction, 0.55 times the load.
    for (pull, stays) in [(0.6 * friction * mass * 9.81, true), (4.0 * friction * mass * 9.81, false)] {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        let columns = 16;
        let def = carpet(Vec3::new(-0.2, 0.0, -0.2), [columns, 8], friction);
        let cloth = world.add_particles(&def);
        crate_of(&mut world, mass, 2.0 * RADIUS);
        let edge: Vec<u32> = (0..9).map(|row| row * (columns + 1) + columns).collect();
        for _ in 0..60 {
            world.step();
        }
        let middle = (4 * (columns + 1) + 4) as usize;
        let begin = world.particles(cloth).positions()[middle];
        for _ in 0..60 {
            for &particle in &edge {
                let share = Vec3::X * (pull / edge.len() as f32 * world.def().dt());
                world.particles_mut(cloth).apply_impulse(particle, share);
            }
            world.step();
        }
        let way = (world.particles(cloth).positions()[middle] - begin).x;
        assert_eq!(way < 0.03, stays, "pulled with {pull} N: moved {way} m");
    }
}

/// Cloth pulled from under a crate that can move only vertically slides by Coulomb's law: floor and crate each act once
/// with the load.
#[test]
fn cloth_slides_from_under_a_crate_by_coulombs_law() {
    let (load, friction, mass) = (4.0 * 9.81, 0.5, 0.4 * 0.4);
    // Geometric mean with 0.6.
    let rubs = f32::sqrt(0.6 * friction) * (2.0 * load + mass * 9.81);
    for share in [0.9, 1.1, 1.3] {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        let cloth = world.add_particles(&carpet(Vec3::new(-0.2, 0.0, -0.2), [8, 8], friction));
        let id = crate_of(&mut world, 4.0, 2.0 * RADIUS);
        let post = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
        let axis = Transform::new(Vec3::ZERO, Rotation::from_arc(Vec3::X, Vec3::Y));
        world.add_joint(&joint(&world, post, id, axis, JointKind::Slider { limit: None }));
        for _ in 0..60 {
            world.step();
        }
        let middle = |world: &World| {
            let positions = world.particles(cloth).positions();
            positions.iter().sum::<Vec3>() / positions.len() as f32
        };
        let begin = middle(&world);
        world.set_gravity(Vec3::new(share * rubs / mass, -9.81, 0.0));
        // Within these steps the cloth stays under the crate.
        for _ in 0..4 {
            world.step();
        }
        let time = 4.0 * world.def().dt();
        let way = (middle(&world) - begin).x;
        let found = share * rubs - mass * 2.0 * way / (time * time);
        let expected = f32::min(share, 1.0) * rubs;
        assert!(
            (found / expected - 1.0).abs() < 0.05,
            "pulled by {share}: force {found} N, expected {expected} N, moved {way} m"
        );
    }
}

/// A ball in the wedge between the floor and a hinged slab carries the slab if half the opening angle is below the
/// friction angle, 16.7°. Otherwise the slab sinks and pushes the ball out along the floor until the angle is small
/// enough.
#[test]
fn a_ball_in_a_narrow_wedge_carries_and_in_a_wide_one_slips_out() {
    for (degrees, is_nipped) in [(30.0_f32, true), (80.0, false)] {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        let post = world.add_body(&BodyDef { kind: BodyKind::Static, ..BodyDef::default() });
        let along = Rotation::from_axis_angle(Vec3::Z, degrees.to_radians());
        // The lower face rises from the origin.
        let half_extents = Vec3::new(0.4, 0.02, 0.3);
        let slab = world.add_body(&BodyDef {
            rotation: along,
            position: along * Vec3::new(0.4, 0.02, 0.0),
            shapes: vec![ShapeDef::new(Shape::Box { half_extents })],
            ..BodyDef::default()
        });
        let axis = Transform::new(Vec3::ZERO, Rotation::from_arc(Vec3::X, Vec3::Z));
        let hinge = joint(&world, post, slab, axis, JointKind::Hinge { limit: None });
        world.add_joint(&hinge);
        let (sine, cosine) = trig::sin_cos((0.5 * degrees).to_radians());
        let at = RADIUS * cosine / sine;
        let position = Vec3::new(at, RADIUS, 0.0);
        let mut group = GroupDef {
            particles: vec![ParticleDef { position, velocity: Vec3::ZERO, mass: 0.001, radius: RADIUS }],
            ..GroupDef::default()
        };
        // The geometric mean with 0.6 is 0.3.
        group.material.friction = 0.15;
        let ball = world.add_particles(&group);
        for _ in 0..120 {
            world.step();
        }
        let way = world.particles(ball).positions()[0].x - at;
        let rises = world.transform(slab).rotation * Vec3::X;
        assert_eq!(way.abs() < 0.01, is_nipped, "{degrees}°: moved {way} m");
        let least = if is_nipped { degrees - 2.0 } else { 20.0 };
        assert!(rises.y > trig::sin(least.to_radians()), "{degrees}°: the slab rises along {rises}");
    }
}

/// A world loaded from a snapshot during a pinch continues with the same bits.
#[test]
fn restored_pinched_contacts_continue_with_the_same_bits() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    world.add_particles(&carpet(Vec3::new(-0.4, 0.0, -0.4), [16, 16], 0.6));
    let id = crate_of(&mut world, 40.0, 2.0 * RADIUS + 0.1);
    world.set_velocity(id, Velocity { linear: Vec3::new(1.0, -1.0, 0.3), angular: Vec3::new(1.0, 2.0, 3.0) });
    for step in 0..60 {
        world.step();
        if step % 15 != 14 {
            continue;
        }
        let mut other = World::new(WorldDef::default());
        let mut bytes = Writer::new();
        world.save(&mut bytes);
        other.load(&mut Reader::new(bytes.as_bytes())).expect("the snapshot must load");
        let mut copy = world.clone();
        for _ in 0..20 {
            copy.step();
            other.step();
            assert_eq!(copy.hash(), other.hash(), "the hashes differ after step {step}");
        }
    }
}

/// The floor prevents a tether with one end below it and the other on it from closing. The tether must pull the body at
/// its lower end only as hard as it pulls the upper particle, not with the force that would close it.
#[test]
fn a_tether_through_the_floor_does_not_tear() {
    let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
    floor(&mut world);
    let id = crate_of(&mut world, 1.0, 0.1);
    let below = Vec3::Y * -0.05;
    let particle =
        |position: Vec3| ParticleDef { position, velocity: Vec3::ZERO, mass: 0.001, radius: RADIUS };
    let target = AttachmentTarget::Body { body: id, point: below - world.transform(id).translation };
    world.add_particles(&GroupDef {
        particles: vec![particle(Vec3::Y * RADIUS), particle(below)],
        tethers: vec![TetherDef { particle: 0, to: 1, length: 0.02 }],
        attachments: vec![AttachmentDef { particle: 1, target }],
        scheme: SpringScheme::Projected,
        ..GroupDef::default()
    });
    world.step();
    let speed = world.velocity(id).linear.length();
    // Expected: the tether's error per iteration, as a speed, times the mass ratio of a gram to a kilogram.
    assert!((0.01..0.5).contains(&speed), "the body moves at {speed} m/s");
}

/// Pinched contacts forget removed bodies and shapes: a world saved afterwards can be loaded.
#[test]
fn removed_bodies_leave_no_pinched_contacts() {
    for takes_shape in [false, true] {
        let mut world = World::new(WorldDef::default());
        floor(&mut world);
        world.add_particles(&carpet(Vec3::new(-0.4, 0.0, -0.4), [16, 16], 0.6));
        let id = crate_of(&mut world, 40.0, 2.0 * RADIUS);
        (0..10).for_each(|_| world.step());
        if takes_shape {
            world.remove_shape(ShapeId { body: id, shape: 0 }, MassUpdate::Keep);
        } else {
            world.remove_body(id);
        }
        let mut bytes = Writer::new();
        world.save(&mut bytes);
        let mut other = World::new(WorldDef::default());
        other.load(&mut Reader::new(bytes.as_bytes())).expect("the snapshot must load");
        world.step();
        other.step();
        assert_eq!(world.hash(), other.hash());
    }
}

/// A crate on cloth on a belt moves with the belt; a crate whose contact a modifier drops falls through.
#[test]
fn surface_velocities_and_modifiers_act_through_cloth() {
    for drops in [false, true] {
        let mut world = World::new(WorldDef::default());
        world.register_modifier(1, |_, _| None);
        let mut belt = BodyDef {
            kind: BodyKind::Static,
            position: Vec3::Y * -0.5,
            shapes: vec![ShapeDef::new(Shape::Box { half_extents: Vec3::new(5.0, 0.5, 5.0) })],
            ..BodyDef::default()
        };
        belt.shapes[0].material.surface_velocity = Vec3::X;
        if drops {
            belt.shapes[0].rule = ContactRule::Modified { modifier: 1 };
        }
        world.add_body(&belt);
        world.add_particles(&carpet(Vec3::new(-0.4, 0.0, -0.4), [16, 16], 0.6));
        let id = crate_of(&mut world, 20.0, 2.0 * RADIUS);
        (0..60).for_each(|_| world.step());
        let (at, speed) = (world.center_of_mass(id), world.velocity(id).linear.x);
        if drops {
            assert!(at.y < -0.2, "the crate without a contact must fall through; it is at {at}");
        } else {
            assert!((speed - 1.0).abs() < 0.1, "the crate moves at {speed} m/s, expected 1 m/s");
        }
    }
}
