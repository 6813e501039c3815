//! Strands, cloth, blobs and fast particles, compared with closed forms.

use crate::build::floor;
use sinew_math::{Random, Sym3, Transform, Vec3, max, min};
use sinew_physics::particles::{
    BlobDef, GroupDef, Obstacle, ObstacleBody, ParticleDef, ParticleGroup, Resists, RopeDef, SpringDef,
    StrandDef,
};
use sinew_physics::*;

const G: f32 = 9.81;

fn run(world: &mut World, steps: usize) {
    for _ in 0..steps {
        world.step();
    }
}

/// Runs steps and checks that none adds more than a share of the kinetic energy.
fn run_without_gain(world: &mut World, steps: usize) {
    for step in 0..steps {
        let before = world.energy();
        world.step();
        let rise = world.energy().total() - before.total();
        assert!(rise < 0.01 * max(before.kinetic, 1.0), "step {step}: the energy rose by {rise} J");
    }
}

/// A strand clamped horizontally bends like a chain of elastic corners: each turns by the moment of the weight beyond
/// it.
#[test]
fn a_strand_bends_as_a_beam() {
    const LINKS: u32 = 8;
    let (length, mass, bending) = (1.0, 0.08, 1.0);
    let rope =
        RopeDef { from: Vec3::ZERO, to: Vec3::X * length, links: LINKS, mass, stiffness: 1e5, radius: 0.0 };
    let mut strand = StrandDef { rope, bending }.build();
    strand.group.hold_in_world(&[0, 1]);
    strand.group.linear_damping = 4.0;
    strand.group.iterations = 16;
    let link = length / LINKS as f32;
    let masses: Vec<f32> = strand.group.particles.iter().map(|p| p.mass).collect();
    let mut sunk = 0.0;
    for corner in 1..LINKS as usize {
        let beyond = |i: usize| masses[i] * G * (i - corner) as f32 * link;
        let moment: f32 = (corner + 1..=LINKS as usize).map(beyond).sum();
        sunk += moment * link / bending * (LINKS as usize - corner) as f32 * link;
    }
    let mut world = World::new(WorldDef::default());
    let id = world.add_particles(&strand.group);
    run(&mut world, 600);
    let tip = -world.particles(id).positions()[LINKS as usize].y;
    assert!((tip / sunk - 1.0).abs() < 0.005, "the tip sank by {sunk} m, expected {tip} m");
}

#[test]
fn a_chain_of_fifty_masses_stretches_by_mg_over_k() {
    const MASSES: u32 = 50;
    let particle = |k: u32| ParticleDef {
        position: Vec3::NEG_Y * (0.2 * k as f32),
        velocity: Vec3::ZERO,
        mass: 1.0,
        radius: 0.0,
    };
    let mut chain = GroupDef {
        particles: (0..=MASSES).map(particle).collect(),
        springs: (0..MASSES).map(|k| SpringDef::new([k, k + 1], 0.2, 1e5)).collect(),
        linear_damping: 4.0,
        // Measured with an accuracy of a micrometre.
        sleeping: Sleeping::Off,
        ..GroupDef::default()
    };
    chain.hold_in_world(&[0]);
    chain.damp(1.0);
    let mut world = World::new(WorldDef::default());
    let id = world.add_particles(&chain);
    run(&mut world, 900);
    for k in 0..MASSES {
        let expected = (MASSES - k) as f32 * G / 1e5;
        let found = world.particles(id).stretch(k as usize);
        assert!((found / expected - 1.0).abs() < 0.01, "spring {k}: length {found} m, expected {expected} m");
    }
}

/// Half a period of a mass on a spring: at a damping ratio of 0.2 the mass returns to exp(−π ζ/√(1 − ζ²)) = 0.53 of its
/// height, at 1 it never passes its rest position, and a string does not push.
#[test]
fn springs_follow_their_damping_ratio_and_strings_do_not_push() {
    let lowest = |ratio: f32, resists: Resists| {
        let hung =
            |y: f32| ParticleDef { position: Vec3::Y * y, velocity: Vec3::ZERO, mass: 2.0, radius: 0.0 };
        let spring = SpringDef { resists, ..SpringDef::new([0, 1], 1.0, 800.0) };
        let mut group = GroupDef {
            particles: vec![hung(0.0), hung(-1.1)],
            springs: vec![spring.damped(ratio, [f32::INFINITY, 2.0])],
            gravity_scale: 0.0,
            iterations: 16,
            ..GroupDef::default()
        };
        group.hold_in_world(&[0]);
        let mut world = World::new(WorldDef::default());
        let id = world.add_particles(&group);
        let mut shortest = 0.0;
        for _ in 0..20 {
            world.step();
            shortest = min(shortest, -1.0 - world.particles(id).positions()[1].y);
        }
        -shortest
    };
    let back = lowest(0.2, Resists::Both) / 0.1;
    assert!((back - 0.527).abs() < 0.02, "the mass returned to {back} of its height, expected 0.527");
    assert!(lowest(1.0, Resists::Both) < 1e-3);
    assert!(lowest(0.0, Resists::Stretch) > 0.5, "a string must not stop the mass on its way back");
}

#[test]
fn group_setters_panic_on_nonfinite_numbers() {
    let def = GroupDef {
        particles: vec![ParticleDef { position: Vec3::ZERO, velocity: Vec3::ZERO, mass: 1.0, radius: 0.0 }],
        ..GroupDef::default()
    };
    let panics = |work: &dyn Fn(&mut ParticleGroup)| {
        let mut group = ParticleGroup::new(&def);
        std::panic::catch_unwind(core::panic::AssertUnwindSafe(|| work(&mut group))).is_err()
    };
    for bad in [Vec3::NAN, Vec3::X * f32::INFINITY] {
        assert!(panics(&|group| group.apply_impulse(0, bad)));
        assert!(panics(&|group| group.set_velocity(0, bad)));
        assert!(panics(&|group| group.set_position(0, bad)));
        let broken =
            GroupDef { particles: vec![ParticleDef { velocity: bad, ..def.particles[0] }], ..def.clone() };
        assert!(broken.check().is_err(), "a NaN must not pass the check");
    }
    assert!(GroupDef { linear_damping: f32::NAN, ..def.clone() }.check().is_err());
    assert!(GroupDef { iterations: 0, ..def.clone() }.check().is_err());
    assert!(!panics(&|group| group.apply_impulse(0, Vec3::X)));
}

/// Particles hit moving and rotating shapes of every kind at up to 100 m/s: on the path between the ends of a substep,
/// in the shape's frame, none is inside.
#[test]
fn particles_never_pass_through_moving_shapes() {
    let mut random = Random::new(7);
    let h = 1.0 / 240.0;
    for case in 0..600 {
        let shape = match case % 5 {
            0 => Shape::Box { half_extents: Vec3::new(1.0, 0.025, 1.0) },
            1 => Shape::Box { half_extents: Vec3::new(0.02, 0.5, 0.02) },
            2 => Shape::Capsule { half_height: 0.5, radius: 0.03 },
            3 => Shape::Sphere { radius: 0.1 },
            _ => Shape::HalfSpace,
        };
        let moves = shape != Shape::HalfSpace;
        let (linear, angular) =
            if moves { (random.in_cube() * 50.0, random.in_cube() * 20.0) } else { (Vec3::ZERO, Vec3::ZERO) };
        let radius = if case % 2 == 0 { 0.0 } else { 0.02 };
        let mut frame = Transform::new(Vec3::ZERO, random.rotation());
        let mut from = frame.rotation * random.direction();
        if !moves {
            let up = frame.rotation * Vec3::Y;
            from = (from + up * 1.2).normalize();
        }
        let aim = random.in_cube() * 0.05;
        let particle =
            ParticleDef { position: from * 2.0 + aim, velocity: linear - from * 100.0, mass: 0.1, radius };
        let mut group = ParticleGroup::new(&GroupDef { particles: vec![particle], ..GroupDef::default() });
        for step in 0..12 {
            let previous = frame;
            frame = Transform::new(frame.translation + linear * h, frame.rotation.integrate(angular, h));
            let body = ObstacleBody {
                center: frame.translation,
                linear_velocity: linear,
                angular_velocity: angular,
                inverse_mass: 0.0,
                inverse_inertia: Sym3::ZERO,
            };
            let obstacle = Obstacle {
                shape: shape.clone(),
                previous,
                world_from_shape: frame,
                body: 0,
                material: Material::default(),
            };
            let start = previous.inverse_point(group.positions()[0]);
            group.substep(h, Vec3::ZERO, &[], &[obstacle], &mut [body]);
            let end = frame.inverse_point(group.positions()[0]);
            for k in 0..=64 {
                let at = start + (end - start) * (k as f32 / 64.0);
                let (distance, _) = shape.signed_distance(&Transform::IDENTITY, at);
                assert!(distance > radius - 2e-3, "case {case}, step {step}: distance {distance} m");
            }
        }
    }
}

/// A kinematic wall at 50 m/s pushes all particles along, within a step and across steps.
#[test]
fn a_fast_wall_pushes_all_particles() {
    let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
    let mut random = Random::new(3);
    let wall = BodyDef {
        kind: BodyKind::Kinematic,
        linear_velocity: Vec3::X * 50.0,
        shapes: vec![ShapeDef::new(Shape::Box { half_extents: Vec3::new(0.025, 4.0, 4.0) })],
        ..BodyDef::default()
    };
    let wall = world.add_body(&wall);
    let lone = |_| ParticleDef {
        position: Vec3::X * 6.0 + random.in_cube() * 3.0,
        velocity: Vec3::ZERO,
        mass: 0.1,
        radius: 0.01,
    };
    let particles = (0..200).map(lone).collect();
    let id = world.add_particles(&GroupDef { particles, ..GroupDef::default() });
    for _ in 0..30 {
        world.step();
        let front = world.transform(wall).translation.x + 0.025 + 0.01 - 1e-3;
        assert!(world.particles(id).positions().iter().all(|p| p.x > front));
    }
}

/// A falling blob keeps its air volume, and comes to rest without gaining energy.
#[test]
fn a_blob_falls_and_rests() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let blob = BlobDef {
        center: Vec3::Y * 0.5,
        radius: 0.12,
        subdivisions: 2,
        mass: 0.6,
        stiffness: 400.0,
        damping_ratio: 0.2,
        bulk_modulus: 2e4,
        skin: 0.005,
    };
    let blob = blob.build();
    let rest = blob.group.volumes[0].rest_volume;
    assert!(blob.group.particles[blob.top as usize].position.y > 0.61);
    assert!(blob.group.particles[blob.bottom as usize].position.y < 0.39);
    let id = world.add_particles(&blob.group);
    run_without_gain(&mut world, 300);
    let group = world.particles(id);
    assert!((group.volume(0) / rest - 1.0).abs() < 0.01, "volume {} m³, at rest {rest} m³", group.volume(0));
    let lowest = group.positions().iter().fold(1.0, |low, p| min(low, p.y));
    assert!((lowest - 0.005).abs() < 1e-3, "the lowest particle is at {lowest} m, expected 0.005 m");
}

/// Air pressed to half its height expands to the sides.
#[test]
fn a_pressed_blob_keeps_its_volume() {
    let mut world = World::new(WorldDef::default());
    floor(&mut world);
    let blob = BlobDef {
        center: Vec3::Y * 0.13,
        radius: 0.12,
        subdivisions: 2,
        mass: 0.6,
        stiffness: 400.0,
        damping_ratio: 0.2,
        bulk_modulus: 2e5,
        skin: 0.005,
    };
    let blob = blob.build();
    let rest = blob.group.volumes[0].rest_volume;
    let id = world.add_particles(&blob.group);
    let plate = world.add_body(&BodyDef {
        kind: BodyKind::Kinematic,
        position: Vec3::Y * 0.28,
        shapes: vec![ShapeDef::new(Shape::Box { half_extents: Vec3::new(0.5, 0.02, 0.5) })],
        ..BodyDef::default()
    });
    world.set_velocity(plate, Velocity { linear: Vec3::NEG_Y * 0.1, angular: Vec3::ZERO });
    run(&mut world, 78);
    world.set_velocity(plate, Velocity::default());
    for _ in 0..120 {
        world.step();
        let kept = world.particles(id).volume(0) / rest;
        assert!((kept - 1.0).abs() < 0.01, "{kept} of the volume remains under the plate");
    }
    let highest = world.particles(id).positions().iter().fold(0.0, |high, p| max(high, p.y));
    assert!(highest < 0.13, "the highest particle is at {highest} m; the blob was 0.25 m high");
}
