//! Self-collision of particle groups.

use sinew_math::{Reader, Vec3, Writer, max};
use sinew_physics::particles::{Cloth, ClothDef, GroupDef, ParticleDef, ParticleGroup, SpringDef};
use sinew_physics::{BodyDef, GroupId, Shape, ShapeDef, Threads, World, WorldDef};

/// Distance between neighbouring particles of the cloth, metres.
const GRID: f32 = 0.02;
const THICKNESS: f32 = 0.028;
const COLUMNS: u32 = 8;
/// Number of springs along each layer, and between layers.
const LAYER: u32 = 8;
const FOLD: u32 = 2;
const FOLDS: u32 = 5;
const ROWS: u32 = (LAYER + FOLD) * FOLDS + LAYER;

/// Returns a strip folded five times, its layers slightly apart, before it falls.
fn pleated(thickness: f32) -> Cloth {
    let mut cloth = ClothDef {
        corner: Vec3::ZERO,
        across: Vec3::X * (COLUMNS as f32 * GRID),
        down: Vec3::Z * (ROWS as f32 * GRID),
        columns: COLUMNS,
        rows: ROWS,
        mass: 0.5 * (COLUMNS * ROWS) as f32 * GRID * GRID,
        stretching: 500.0,
        shearing: 50.0,
        bending: 1e-6,
        damping_ratio: 0.2,
        radius: 0.5 * GRID,
    }
    .build();
    let mut at = Vec3::Y * 0.05;
    for row in 0..=ROWS {
        for i in cloth.row(row) {
            let position = &mut cloth.group.particles[i as usize].position;
            *position = Vec3::new(position.x, at.y, at.z);
        }
        let (layer, within) = (row / (LAYER + FOLD), row % (LAYER + FOLD));
        let forth = if layer % 2 == 0 { GRID } else { -GRID };
        at += if within < LAYER { Vec3::Z * forth } else { Vec3::Y * GRID };
    }
    cloth.group.thickness = thickness;
    cloth.group.iterations = 4;
    cloth.group.linear_damping = 0.5;
    cloth.group.material.friction = 0.5;
    cloth
}

/// Counts the pairs of a spring and a triangle of the cloth that share no corner and intersect.
fn crossings(positions: &[Vec3]) -> usize {
    let wide = COLUMNS as usize + 1;
    let mut triangles = Vec::new();
    let mut threads = Vec::new();
    for a in 0..positions.len() {
        let (right, down) = (a % wide + 1 < wide, a + wide < positions.len());
        threads.extend(right.then_some([a, a + 1]));
        threads.extend(down.then_some([a, a + wide]));
        if right && down {
            triangles.extend([[a, a + 1, a + wide], [a + 1, a + wide + 1, a + wide]]);
        }
    }
    let pierced = |triangle: &[usize; 3]| {
        let apart = threads.iter().filter(|ends| !ends.iter().any(|end| triangle.contains(end)));
        let corners = triangle.map(|i| positions[i]);
        apart.filter(|ends| pierces(ends.map(|i| positions[i]), corners)).count()
    };
    triangles.iter().map(pierced).sum()
}

fn pierces([p, q]: [Vec3; 2], [a, b, c]: [Vec3; 3]) -> bool {
    let volume = |a: Vec3, b: Vec3, c: Vec3, d: Vec3| (b - a).cross(c - a).dot(d - a);
    if (p - a).length() > 4.0 * GRID || volume(a, b, c, p) * volume(a, b, c, q) >= 0.0 {
        return false;
    }
    let sides = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    sides.iter().all(|&side| side > 0.0) || sides.iter().all(|&side| side < 0.0)
}

/// Returns a world with a floor, a pleated strip and a box of mass `load` (kg) above it; no box for 0.
fn folded(load: f32, thickness: f32) -> (World, GroupId) {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let group = world.add_particles(&pleated(thickness).group);
    if load > 0.0 {
        let half_extents = Vec3::new(0.06, 0.03, 0.06);
        let mut shape = ShapeDef::new(Shape::Box { half_extents });
        shape.density = load / (8.0 * half_extents.x * half_extents.y * half_extents.z);
        let position = Vec3::new(0.08, 0.4, 0.08);
        world.add_body(&BodyDef { position, shapes: vec![shape], ..BodyDef::default() });
    }
    (world, group)
}

/// Takes `steps` steps. Returns the number of crossings, counted in every tenth step; the energy gain, J; and the
/// height of the last body, metres.
fn fall(load: f32, thickness: f32, steps: usize) -> (usize, f32, f32) {
    let (mut world, group) = folded(load, thickness);
    let first = world.energy().total();
    let (mut seen, mut gain) = (0, 0.0);
    for step in 1..=steps {
        world.step();
        gain = max(gain, world.energy().total() - first);
        if step % 10 == 0 {
            seen += crossings(world.particles(group).positions());
        }
    }
    let body = world.body_ids().last().expect("the world has a floor");
    (seen, gain, world.center_of_mass(body).y)
}

#[test]
fn folds_do_not_intersect() {
    // A box as heavy as the cloth, and a box thirteen times as heavy as the particles under it.
    for load in [0.1, 0.2] {
        let (seen, gain, height) = fall(load, THICKNESS, 240);
        println!("{load} kg: {seen} crossings, {gain} J gained, box at {height} m");
        assert_eq!(seen, 0, "{load} kg: threads of the cloth cross its triangles");
        assert!(gain < 0.002, "{load} kg: the energy rose by {gain} J");
        assert!(height > 0.03 + 0.01 + 4.0 * THICKNESS, "{load} kg: the box is at height {height} m");
    }
    // Without thickness the layers cross, which shows that the count detects crossings.
    let (seen, ..) = fall(0.2, 0.0, 240);
    assert!(seen > 50, "only {seen} crossings without thickness");
}

#[test]
fn folds_come_to_rest() {
    let (mut world, group) = folded(0.0, THICKNESS);
    (0..600).for_each(|_| world.step());
    let group = world.particles(group);
    assert!(
        !group.is_awake(),
        "the fastest particle moves at {} m/s",
        group.velocities().iter().fold(0.0, |most, v| max(most, v.length()))
    );
    let top = group.positions().iter().fold(0.0, |most, p| max(most, p.y));
    assert!(top > 0.01 + 4.0 * THICKNESS, "the top of the folds is at {top} m");
}

/// Returns two particles with these positions, velocities and masses, which keep 0.1 m apart, without gravity.
fn pair(particles: [(Vec3, Vec3, f32); 2], joined: bool) -> ParticleGroup {
    let particle = |(position, velocity, mass)| ParticleDef { position, velocity, mass, radius: 0.01 };
    ParticleGroup::new(&GroupDef {
        particles: particles.map(particle).to_vec(),
        springs: joined.then(|| SpringDef::new([0, 1], 0.05, 1.0)).into_iter().collect(),
        thickness: 0.1,
        ..GroupDef::default()
    })
}

#[test]
fn two_colliding_particles_move_on_together() {
    let mut group = pair([(Vec3::ZERO, Vec3::X, 1.0), (Vec3::X * 0.2, -Vec3::X, 3.0)], false);
    for _ in 0..200 {
        group.substep(1e-3, Vec3::ZERO, &[], &[], &mut []);
    }
    // Velocity after an inelastic impact: (1 − 3) / 4.
    for velocity in group.velocities() {
        assert!((velocity.x + 0.5).abs() < 1e-5, "velocity after the impact {velocity:?}");
    }
    let apart = (group.positions()[1] - group.positions()[0]).length();
    assert!((apart - 0.1).abs() < 1e-5, "the particles are {apart} m apart");
}

#[test]
fn spring_neighbours_may_be_closer_than_the_thickness() {
    for (joined, distance) in [(true, 0.05), (false, 0.1)] {
        let mut group = pair([(Vec3::ZERO, Vec3::ZERO, 1.0), (Vec3::X * 0.05, Vec3::ZERO, 1.0)], joined);
        for _ in 0..1000 {
            group.substep(1e-3, Vec3::ZERO, &[], &[], &mut []);
        }
        let apart = (group.positions()[1] - group.positions()[0]).length();
        assert!((apart - distance).abs() < 1e-4, "joined: {joined}, distance {apart} m");
        // Particles that start closer than the thickness must stop there, not fly apart.
        assert!(group.velocities().iter().all(|v| v.length() < 1e-4), "{:?}", group.velocities());
    }
}

#[test]
fn restored_and_threaded_self_collision_matches_the_original() {
    let [mut one, mut two] = [folded(0.1, THICKNESS).0, folded(0.1, THICKNESS).0];
    let threads = Threads::new(2);
    for _ in 0..40 {
        one.step();
        two.step_with(&threads, &sinew_physics::stage::NoProfiler);
    }
    assert_eq!(one.hash(), two.hash());
    let mut reloaded = World::new(WorldDef::default());
    let (mut state, mut shapes) = (Writer::new(), Writer::new());
    one.save(&mut state);
    one.save_shapes(&mut shapes);
    reloaded.load_shapes(&mut Reader::new(shapes.as_bytes())).expect("the saved shape library must load");
    reloaded.load(&mut Reader::new(state.as_bytes())).expect("the snapshot must load");
    let group = reloaded.group_ids().next().expect("the world has the cloth");
    assert_eq!(reloaded.particles(group).thickness(), THICKNESS);
    for _ in 0..40 {
        one.step();
        reloaded.step();
    }
    assert_eq!(one.hash(), reloaded.hash());
}
