//! Triangle levels in a world: boxes at rest, ramps, bowls, fast bodies, events, snapshots.

use super::{FRICTION, Floor, floor_shape, ground, surfaced};
use sinew_math::trig::{cos, sin};
use sinew_math::{Reader, Rotation, Vec3, Writer};
use sinew_physics::particles::{GroupDef, ParticleDef};
use sinew_physics::*;
use std::sync::Arc;

fn fixed(shape: Shape) -> BodyDef {
    BodyDef { kind: BodyKind::Static, shapes: vec![surfaced(shape, FRICTION)], ..BodyDef::default() }
}

fn thrown(shape: Shape, position: Vec3, velocity: Vec3, friction: f32) -> BodyDef {
    BodyDef {
        position,
        linear_velocity: velocity,
        shapes: vec![surfaced(shape, friction)],
        ..BodyDef::default()
    }
}

/// Returns a surface over a grid in x and z, with `n` cells of `cell` metres per side.
fn grid(n: usize, cell: f32, height: impl Fn(f32, f32) -> f32) -> Shape {
    let mut vertices = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            let (x, z) = ((i as f32 - 0.5 * n as f32) * cell, (j as f32 - 0.5 * n as f32) * cell);
            vertices.push(Vec3::new(x, height(x, z), z));
        }
    }
    let mut triangles = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let index = |i: usize, j: usize| (i + j * (n + 1)) as u32;
            let [a, b, c, d] = [index(i, j), index(i, j + 1), index(i + 1, j + 1), index(i + 1, j)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    Shape::Mesh(Arc::new(Mesh::new(&vertices, &triangles).unwrap()))
}

fn sleepless() -> World {
    World::new(WorldDef { sleeping: Sleeping::Off, ..WorldDef::default() })
}

#[test]
fn bodies_at_rest_on_a_mesh_stay() {
    let mut world = sleepless();
    ground(&mut world, floor_shape(Floor::Shuffled), FRICTION);
    let half = Vec3::new(0.2, 0.1, 0.3);
    let mut bodies = Vec::new();
    for k in 0..12 {
        // Over faces, edges and vertices, each body rotated by another angle.
        let place = Vec3::new(1.0 + 0.125 * k as f32, 0.101, 1.5 * k as f32 - 8.0);
        let turn = Rotation::from_axis_angle(Vec3::Y, 0.26 * k as f32);
        let def = thrown(Shape::Box { half_extents: half }, place, Vec3::ZERO, FRICTION);
        bodies.push((world.add_body(&BodyDef { rotation: turn, ..def }), place, turn));
    }
    for _ in 0..300 {
        world.step();
    }
    for (id, place, turn) in bodies {
        let pose = world.transform(id);
        let drift = pose.translation - place;
        assert!(drift.length() < 3e-3, "{drift} from {place}");
        assert!(
            (pose.rotation * Vec3::Y).y > 0.999_99 && (pose.rotation * Vec3::X).dot(turn * Vec3::X) > 0.9999
        );
        assert!(world.penetration(id) < 2e-3, "{}", world.penetration(id));
    }
}

#[test]
fn a_ramp_lifts_sliding_bodies() {
    for (degrees, speed) in [(10.0_f32, 5.0), (30.0, 5.0), (10.0, 20.0), (30.0, 20.0), (60.0, 10.0)] {
        let angle = degrees.to_radians();
        let slope = sin(angle) / cos(angle);
        let level = grid(40, 1.0, |x, _| if x > 0.0 { x * slope } else { 0.0 });
        for slider in [Shape::Box { half_extents: Vec3::new(0.2, 0.1, 0.2) }, Shape::Sphere { radius: 0.1 }] {
            let mut world = sleepless();
            world.add_body(&BodyDef { position: Vec3::new(0.0, 0.0, 0.13), ..fixed(level.clone()) });
            let def = thrown(slider.clone(), Vec3::new(-4.03, 0.1, 0.2), Vec3::X * speed, 0.0);
            let id = world.add_body(&def);
            let mut lowest = f32::INFINITY;
            let mut energy = 0.0_f32;
            let start = world.body_energy(id).total();
            for _ in 0..120 {
                world.step();
                let p = world.center_of_mass(id);
                if p.x > 18.0 {
                    break;
                }
                let over_ramp = (p.y - p.x * slope) * cos(angle);
                lowest = lowest.min(if p.x > 0.0 { over_ramp } else { p.y });
                energy = energy.max(world.body_energy(id).total() / start);
            }
            let what = format!("{slider:?} up {degrees}° at {speed} m/s");
            println!("{what}: lowest {lowest}, energy {energy}");
            assert!(lowest > 0.08, "{what}: lowest point {lowest} m above the ramp");
            assert!(energy < 1.01, "{what}: {energy} times its initial energy");
        }
    }
}

const OCTAHEDRON: [Vec3; 6] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];

#[test]
fn fast_bodies_do_not_pass() {
    let floor = floor_shape(Floor::Shuffled);
    let size = 0.05;
    let shapes = [
        Shape::Sphere { radius: size },
        Shape::Box { half_extents: Vec3::splat(size) },
        Shape::Capsule { half_height: size, radius: size },
        Shape::Cylinder { half_height: size, radius: size },
        Shape::Cone { half_height: size, radius: size },
        Shape::Hull(Arc::new(Hull::new(&OCTAHEDRON.map(|p| p * 2.0 * size)).unwrap())),
    ];
    let mut world = sleepless();
    ground(&mut world, floor, FRICTION);
    let mut bodies = Vec::new();
    for (k, shape) in shapes.iter().enumerate() {
        for i in 0..8 {
            let place = Vec3::new(2.0 * k as f32 - 3.98, 1.0 + 0.37 * i as f32, 1.1 * i as f32 - 4.0);
            let velocity = Vec3::new(3.0 * i as f32 - 10.0, -30.0, 4.0);
            let def = thrown(shape.clone(), place, velocity, FRICTION);
            let rotation = Rotation::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 0.4 * i as f32);
            bodies.push((world.add_body(&BodyDef { rotation, ..def }), shape));
        }
    }
    for step in 0..120 {
        world.step();
        for (id, shape) in &bodies {
            let y = world.center_of_mass(*id).y;
            assert!(y > 0.0, "{shape:?} at height {y} after {step} steps");
        }
    }
}

#[test]
fn a_ball_swings_in_a_bowl() {
    // Bowl of radius 3 m with triangles of 5 cm: a ball without rotation swings like a pendulum of 3 m minus the ball's
    // radius.
    let (bowl, radius) = (3.0_f32, 0.2);
    let level = grid(80, 0.05, |x, z| bowl - (bowl * bowl - x * x - z * z).sqrt());
    let mut world = sleepless();
    world.add_body(&fixed(level));
    let (arm, amplitude) = (bowl - radius, 0.3_f32);
    let start = Vec3::new(arm * sin(amplitude), bowl - arm * cos(amplitude), 0.0);
    let id = world.add_body(&thrown(Shape::Sphere { radius }, start, Vec3::ZERO, 0.0));
    let mut crossings = Vec::new();
    let mut last = start.x;
    let mut off = 0.0_f32;
    for _ in 0..600 {
        world.step();
        let p = world.center_of_mass(id);
        if last < 0.0 && p.x >= 0.0 {
            crossings.push(world.time() as f32);
        }
        last = p.x;
        off = off.max(((p - Vec3::Y * bowl).length() - arm).abs());
    }
    // T = 2π √(l/g) (1 + θ²/16).
    let expected = core::f32::consts::TAU * (arm / 9.81).sqrt() * (1.0 + amplitude * amplitude / 16.0);
    let period = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f32;
    println!("period {period} for {expected}, off the bowl by {off}");
    assert!((period / expected - 1.0).abs() < 0.01, "period {period} s, expected {expected} s");
    assert!(off < 3e-3, "{off} off the bowl");
}

#[test]
fn events_report_a_pair_once() {
    let mut world = sleepless();
    // Corner of three walls: three manifolds.
    let vertices = [Vec3::ZERO, Vec3::X * 3.0, Vec3::Y * 3.0, Vec3::Z * 3.0];
    let mesh = Mesh::new(&vertices, &[[0, 3, 1], [0, 1, 2], [0, 2, 3]]).unwrap();
    world.add_body(&fixed(Shape::Mesh(Arc::new(mesh))));
    let def = thrown(Shape::Sphere { radius: 0.2 }, Vec3::splat(0.5), Vec3::splat(-2.0), 0.5);
    let id = world.add_body(&def);
    let (mut begun, mut ended) = (0, 0);
    for _ in 0..120 {
        world.step();
        assert!(world.events().begin.len() <= 1 && world.events().end.len() <= 1);
        begun += world.events().begin.len();
        ended += world.events().end.len();
    }
    // The ball may leave once, when it bounces.
    assert!(begun == ended + 1 && begun <= 2, "{begun} contacts begun, {ended} ended");
    let p = world.center_of_mass(id);
    assert!((p - Vec3::splat(0.2)).length() < 0.02, "in the corner: {p}");
    world.set_velocity(id, Velocity { linear: Vec3::splat(4.0), ..Velocity::default() });
    for _ in 0..10 {
        world.step();
        ended += world.events().end.len();
    }
    assert_eq!(begun, ended);
}

/// Adds many bodies on terrain with a bump in each cell.
fn crowd(world: &mut World) {
    let level = grid(30, 0.4, |x, z| 0.15 * sin(7.0 * x) * cos(5.0 * z));
    world.add_body(&fixed(level));
    for k in 0..24 {
        let place =
            Vec3::new(0.8 * (k % 6) as f32 - 2.0, 1.0 + 0.3 * (k / 6) as f32, 0.9 * (k / 6) as f32 - 1.5);
        let shape = match k % 4 {
            0 => Shape::Box { half_extents: Vec3::new(0.25, 0.1, 0.15) },
            1 => Shape::Sphere { radius: 0.15 },
            2 => Shape::Cylinder { half_height: 0.1, radius: 0.2 },
            _ => Shape::Capsule { half_height: 0.2, radius: 0.1 },
        };
        world.add_body(&thrown(shape, place, Vec3::new(0.5, -1.0, 0.2), FRICTION));
    }
}

#[test]
fn snapshots_go_on_with_the_same_bits_on_any_number_of_threads() {
    let mut world = sleepless();
    crowd(&mut world);
    for _ in 0..90 {
        world.step();
    }
    let mut saved = Writer::new();
    world.save(&mut saved);
    let mut shapes = Writer::new();
    world.save_shapes(&mut shapes);
    for _ in 0..30 {
        world.step();
    }
    for threads in [1, 2, 3] {
        let mut other = sleepless();
        other.load_shapes(&mut Reader::new(shapes.as_bytes())).unwrap();
        other.load(&mut Reader::new(saved.as_bytes())).unwrap();
        for _ in 0..30 {
            other.step_with(&Threads::new(threads), &stage::NoProfiler);
        }
        assert_eq!(other.hash(), world.hash(), "{threads} threads");
    }
}

#[test]
fn a_height_field_and_holes() {
    let def = HeightFieldDef {
        columns: 5,
        rows: 5,
        spacing: [1.0, 1.0],
        heights: vec![0.0; 25],
        // Cell from (2, 2) to (3, 3).
        holes: vec![10],
    };
    let field = HeightField::new(def.clone()).unwrap();
    let mut world = sleepless();
    world.add_body(&fixed(Shape::HeightField(Arc::new(field))));
    let ball = |x: f32, z: f32| thrown(Shape::Sphere { radius: 0.2 }, Vec3::new(x, 1.0, z), Vec3::ZERO, 0.5);
    let (held, fallen) = (world.add_body(&ball(1.5, 1.5)), world.add_body(&ball(2.5, 2.5)));
    for _ in 0..90 {
        world.step();
    }
    assert!((world.center_of_mass(held).y - 0.2).abs() < 2e-3);
    assert!(world.center_of_mass(fallen).y < -1.0);
    let refused = |change: &dyn Fn(&mut HeightFieldDef)| {
        let mut def = def.clone();
        change(&mut def);
        HeightField::new(def).unwrap_err()
    };
    assert_eq!(refused(&|def| def.columns = 1), HeightFieldError::Size);
    assert_eq!(refused(&|def| def.rows = usize::MAX), HeightFieldError::Size);
    assert_eq!(refused(&|def| def.rows = 6), HeightFieldError::Heights { heights: 25, vertices: 30 });
    assert_eq!(refused(&|def| def.spacing[1] = f32::NAN), HeightFieldError::Spacing);
    assert_eq!(refused(&|def| def.heights[3] = f32::NAN), HeightFieldError::NotFinite { index: 3 });
    assert_eq!(refused(&|def| def.holes[0] = 16), HeightFieldError::Hole { hole: 16, cells: 16 });
    assert_eq!(refused(&|def| def.holes = (0..16).collect()), HeightFieldError::Empty);
}

#[test]
fn bad_meshes_are_refused() {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X * 2.0];
    let refused = |vertices: &[Vec3], triangles: &[[u32; 3]]| Mesh::new(vertices, triangles).unwrap_err();
    assert_eq!(refused(&corners, &[]), MeshError::NoTriangles { degenerate: 0 });
    assert_eq!(refused(&corners, &[[0, 1, 3], [1, 1, 2]]), MeshError::NoTriangles { degenerate: 2 });
    let out_of_range = MeshError::IndexOutOfRange { triangle: 1, index: 4, vertices: 4 };
    assert_eq!(refused(&corners, &[[0, 1, 2], [0, 1, 4]]), out_of_range);
    assert_eq!(refused(&[Vec3::NAN], &[]), MeshError::NotFinite { vertex: 0 });
    assert_eq!(refused(&[Vec3::X * 2e6], &[]), MeshError::NotFinite { vertex: 0 });
    let mesh = Mesh::new(&corners, &[[0, 1, 2], [0, 1, 3], [1, 2, 0]]).unwrap();
    assert_eq!((mesh.triangle_count(), mesh.dropped().degenerate, mesh.dropped().repeated), (1, 1, 1));
}

#[test]
fn particles_rest_on_a_mesh_and_slide_down_it() {
    let mut world = sleepless();
    world.add_body(&fixed(grid(20, 0.5, |x, _| 0.2 * x)));
    let particle = |x: f32, z: f32| ParticleDef {
        position: Vec3::new(x, 1.5 + 0.2 * x, z),
        velocity: Vec3::ZERO,
        mass: 0.1,
        radius: 0.05,
    };
    let particles = (0..40).map(|k| particle(0.1 * k as f32 - 1.0, 0.17 * k as f32 - 3.0)).collect();
    let stuck = Material { friction: 1.0, ..Material::default() };
    let group = world.add_particles(&GroupDef { particles, material: stuck, ..GroupDef::default() });
    let slick = world.add_particles(&GroupDef {
        particles: vec![particle(0.0, 0.13)],
        material: Material { friction: 0.0, ..Material::default() },
        ..GroupDef::default()
    });
    let under = world.add_particles(&GroupDef {
        particles: vec![ParticleDef { position: Vec3::new(0.0, -0.5, 0.0), ..particle(0.0, 0.0) }],
        ..GroupDef::default()
    });
    for _ in 0..90 {
        world.step();
    }
    let cosine = 1.0 / (1.0_f32 + 0.04).sqrt();
    for &p in world.particles(group).positions() {
        let over = (p.y - 0.2 * p.x) * cosine;
        assert!((over - 0.05).abs() < 1e-3, "{over} over the slope");
    }
    let slid = world.particles(slick).velocities()[0];
    assert!(slid.x < -0.5, "the body must slide down; it moved {slid}");
    // The triangles do not stop the particle from below.
    assert!(world.particles(under).positions()[0].y < -5.0);
}

#[test]
fn warm_steps_on_terrain_allocate_nothing() {
    let mut world = sleepless();
    crowd(&mut world);
    for _ in 0..500 {
        world.step();
    }
    let allocations: u64 = (0..120).map(|_| allocation_counter::measure(|| world.step()).count_total).sum();
    assert_eq!(allocations, 0);
}
