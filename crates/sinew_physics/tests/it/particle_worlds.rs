//! Random worlds with ropes, strands, cloth, blobs and grains among bodies: numbers stay finite, no particle is deeper
//! in a fixed shape than its radius, no world gains energy, and two threads give the same bits as one.
//!
//! `SINEW_WORLDS=100..200 cargo test --release -p sinew_physics --test it -- --nocapture worlds_of_particles` runs
//! other seeds.

use crate::random_worlds::asked_seeds;
use sinew_math::{Random, Reader, Rotation, Vec3, Writer, max};
use sinew_physics::particles::{BlobDef, ClothDef, GroupDef, ParticleDef, RopeDef, SpringScheme, StrandDef};
use sinew_physics::{BodyDef, BodyKind, Shape, ShapeDef, Threads, Velocity, World, WorldDef};

const STEPS: usize = 600;

/// Seeds of a default run: the first ones, and those in which ropes or cloth once gained energy or cloth once sank into
/// the ground.
const SEEDS: [u64; 25] = [
    0, 1, 2, 3, 4, 5, 6, 7, 20, 21, 101, 113, 117, 171, 382, 564, 689, 3271, 3581, 4023, 4087, 6871, 9488,
    9553, 9775,
];

/// Largest allowed depth of a particle in a fixed shape, beyond its radius, metres.
const DEPTH: f32 = 1e-4;

/// Largest allowed energy gain per kilogram, J.
const GAIN: f32 = 0.01;

/// Steps in which stretched springs release their energy: in these worlds five steps release most of it.
const RELEASE_STEPS: usize = 30;

/// Returns cloth that starts at the rope's first end, with the rope's mass and radius. `hang`: two corners are
/// held.
fn cloth(random: &mut Random, rope: &RopeDef, damping_ratio: f32, hang: bool) -> GroupDef {
    let turn = Rotation::from_axis_angle(Vec3::Y, random.range(-3.0, 3.0));
    let mut cloth = ClothDef {
        corner: rope.from,
        across: turn * (Vec3::X * 0.6),
        down: turn * (Vec3::Z * 0.6),
        columns: 3 + random.index(8) as u32,
        rows: 3 + random.index(8) as u32,
        mass: rope.mass,
        stretching: random.range(200.0, 5000.0),
        shearing: random.range(20.0, 500.0),
        bending: random.range(0.0, 1e-4),
        damping_ratio,
        radius: rope.radius,
    }
    .build();
    if hang {
        let [a, b, ..] = cloth.corners();
        cloth.hang(&[a, b]);
    }
    cloth.group
}

/// Returns a rope, a strand, cloth, a blob or grains, partly held in the world.
fn group(random: &mut Random) -> GroupDef {
    let at = Vec3::new(random.range(-1.0, 1.0), random.range(2.2, 3.5), random.range(-1.0, 1.0));
    let radius = random.range(0.01, 0.04);
    let mass = random.range(0.05, 2.0);
    let hang = random.unit() < 0.5;
    let damping_ratio = random.range(0.0, 0.5);
    let rope = RopeDef {
        from: at,
        to: at + random.in_cube(),
        links: 4 + random.index(12) as u32,
        mass,
        stiffness: random.range(1e3, 1e5),
        radius,
    };
    let mut group = match random.index(5) {
        0 => {
            let mut rope = rope.build();
            if hang {
                rope.group.hold_in_world(&[rope.first]);
            }
            rope.group
        }
        1 => StrandDef { rope, bending: random.range(1e-4, 1e-1) }.build().group,
        2 => cloth(random, &rope, damping_ratio, hang),
        3 => {
            BlobDef {
                center: at,
                radius: random.range(0.1, 0.3),
                subdivisions: 1 + random.index(2) as u32,
                mass,
                stiffness: random.range(100.0, 1000.0),
                damping_ratio,
                bulk_modulus: random.range(1e3, 2e4),
                skin: radius,
            }
            .build()
            .group
        }
        _ => {
            let grain = |_| ParticleDef {
                position: at + random.in_cube() * 0.4,
                velocity: random.in_cube() * 5.0,
                mass: 0.02,
                radius,
            };
            GroupDef { particles: (0..12).map(grain).collect(), ..GroupDef::default() }
        }
    };
    group.linear_damping = random.range(0.0, 1.0);
    group.material.friction = random.range(0.0, 1.0);
    group
}

/// Returns the world of a seed. `whole`: the springs of nets and blobs are solved as one implicit system.
fn world(seed: u64, whole: bool) -> World {
    let mut random = Random::new(seed);
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    // No shapes overlap at the start.
    for k in 0..1 + random.index(4) {
        let size = random.range(0.1, 0.3);
        let shape = match random.index(3) {
            0 => Shape::Sphere { radius: size },
            1 => Shape::Capsule { half_height: 0.6 * size, radius: 0.5 * size },
            _ => Shape::Box { half_extents: Vec3::new(size, 0.5 * size, 0.7 * size) },
        };
        let kind = if random.unit() < 0.5 { BodyKind::Static } else { BodyKind::Dynamic };
        world.add_body(&BodyDef {
            kind,
            position: Vec3::new(0.7 * k as f32 - 1.0, 0.5, random.range(-0.5, 0.5)),
            shapes: vec![ShapeDef::new(shape)],
            ..BodyDef::default()
        });
    }
    for _ in 0..1 + random.index(2) {
        let mut group = group(&mut random);
        if whole {
            group.scheme = SpringScheme::Implicit;
        }
        world.add_particles(&group);
    }
    world
}

/// Returns the largest depth of a particle in a fixed shape, minus the particle's radius, metres. Ignores attached
/// particles, whose positions are prescribed.
fn beyond(world: &World) -> f32 {
    let mut most = f32::NEG_INFINITY;
    for id in world.group_ids() {
        let group = world.particles(id);
        for (i, &position) in group.positions().iter().enumerate() {
            assert!(position.is_finite(), "particle {i} is at {position:?}");
            let held = group.attachments().iter().any(|a| a.particle == i as u32);
            let fixed = world.body_ids().filter(|&body| world.kind(body) == BodyKind::Static);
            for body in fixed.filter(|_| !held) {
                let depth = world.point_penetration(body, position).map_or(0.0, |found| found.depth);
                most = max(most, depth);
            }
        }
    }
    most
}

/// Returns the energy of springs, bends and volumes as the group computes it, J.
fn elastic(world: &World) -> f32 {
    world.group_ids().map(|id| world.particles(id).elastic_energy()).sum()
}

/// Returns the energy that springs, bends and volumes release, J: the largest kinetic energy within [`RELEASE_STEPS`]
/// after all motion is stopped, without gravity.
///
/// [`elastic`] adds the energies that each row alone would release. In a net the sum exceeds the energy that all rows
/// release together (ADR 0027).
fn released_energy(world: &World) -> f32 {
    let mut stopped = World::new(WorldDef::default());
    let mut state = Writer::new();
    world.save(&mut state);
    stopped.load(&mut Reader::new(&state.into_bytes())).expect("the snapshot must load");
    stopped.set_gravity(Vec3::ZERO);
    for id in stopped.body_ids().collect::<Vec<_>>() {
        stopped.set_velocity(id, Velocity::default());
    }
    for id in stopped.group_ids().collect::<Vec<_>>() {
        for particle in 0..stopped.particles(id).positions().len() as u32 {
            stopped.particles_mut(id).set_velocity(particle, Vec3::ZERO);
        }
    }
    let mut most = 0.0;
    for _ in 0..RELEASE_STEPS {
        stopped.step();
        most = max(most, stopped.energy().kinetic);
    }
    most
}

/// Returns the mass of all moving bodies and particles, kg.
fn mass(world: &World) -> f32 {
    let dynamic = world.body_ids().filter(|&id| world.kind(id) == BodyKind::Dynamic);
    let bodies: f32 = dynamic.map(|id| world.mass(id).mass).sum();
    let particles = world.group_ids().flat_map(|id| world.particles(id).masses());
    bodies + particles.sum::<f32>()
}

#[test]
fn worlds_of_particles_stay_finite_and_add_no_energy() {
    check_worlds(&asked_seeds().map_or_else(|| SEEDS.to_vec(), Iterator::collect), false);
}

/// Runs the worlds without projected springs. Seeds 0 to 199 pass if requested.
#[test]
fn worlds_of_implicit_nets_stay_finite_and_add_no_energy() {
    check_worlds(&asked_seeds().map_or_else(|| SEEDS[..8].to_vec(), Iterator::collect), true);
}

fn check_worlds(seeds: &[u64], whole: bool) {
    let two = Threads::new(2);
    let mut bad = Vec::new();
    for &seed in seeds {
        let [mut one, mut other] = [world(seed, whole), world(seed, whole)];
        let most = one.energy().total() + GAIN * mass(&one);
        let (mut gain, mut depth) = (f32::NEG_INFINITY, f32::NEG_INFINITY);
        for step in 0..STEPS {
            one.step();
            other.step_with(&two, &sinew_physics::stage::NoProfiler);
            let counted = one.energy().total();
            if counted > most {
                gain = max(gain, counted - elastic(&one) + released_energy(&one) - most);
            }
            if step % 20 == 0 {
                depth = max(depth, beyond(&one));
            }
        }
        assert_eq!(one.hash(), other.hash(), "world {seed}: the hash differs on two threads");
        if gain > 0.0 || depth > DEPTH {
            bad.push(format!("world {seed}: {gain} J above the allowed energy, depth {depth} m"));
        }
    }
    assert!(bad.is_empty(), "{bad:#?}");
}
