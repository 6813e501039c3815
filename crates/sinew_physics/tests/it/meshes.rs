//! Meshes and height fields: sliding bodies do not catch on edges between triangles, and falling bodies come to rest.

mod levels;

use sinew_math::{Random, Rotation, Transform, Vec3};
use sinew_physics::*;
use std::sync::Arc;

/// Number of tiles along a side of the floor.
const TILES: usize = 100;
/// Side of a tile, metres: 20 m/s for two seconds is 40 m.
const TILE: f32 = 0.5;
const FRICTION: f32 = 0.4;

#[derive(Clone, Copy, Debug)]
enum Floor {
    /// All diagonals have the same direction.
    Plain,
    /// Diagonals and the order of the triangles are random; each tile has its own vertices.
    Shuffled,
    Field,
}

fn floor_shape(floor: Floor) -> Shape {
    let at = |i: usize, j: usize| Vec3::new((i as f32 - 50.0) * TILE, 0.0, (j as f32 - 50.0) * TILE);
    let mut random = Random::new(7);
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    match floor {
        Floor::Field => {
            let side = TILES + 1;
            let def = HeightFieldDef {
                columns: side,
                rows: side,
                spacing: [TILE; 2],
                heights: vec![0.0; side * side],
                holes: Vec::new(),
            };
            return Shape::HeightField(Arc::new(HeightField::new(def).unwrap()));
        }
        Floor::Plain => {
            for j in 0..=TILES {
                vertices.extend((0..=TILES).map(|i| at(i, j)));
            }
            for (i, j) in tiles() {
                let index = |i: usize, j: usize| (i + j * (TILES + 1)) as u32;
                let [a, b, c, d] = [index(i, j), index(i, j + 1), index(i + 1, j + 1), index(i + 1, j)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        Floor::Shuffled => {
            for (i, j) in tiles() {
                let first = vertices.len() as u32;
                vertices.extend([at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
                let [a, b, c, d] = [0, 1, 2, 3].map(|k| first + k);
                let halves = match random.index(2) {
                    0 => [[a, b, c], [a, c, d]],
                    _ => [[b, c, d], [b, d, a]],
                };
                for mut triangle in halves {
                    triangle.rotate_left(random.index(3));
                    let place = random.index(triangles.len() + 1);
                    triangles.push(triangle);
                    let last = triangles.len() - 1;
                    triangles.swap(place, last);
                }
            }
        }
    }
    Shape::Mesh(Arc::new(Mesh::new(&vertices, &triangles).unwrap()))
}

fn tiles() -> impl Iterator<Item = (usize, usize)> {
    (0..TILES).flat_map(|j| (0..TILES).map(move |i| (i, j)))
}

fn surfaced(shape: Shape, friction: f32) -> ShapeDef {
    ShapeDef { material: Material { friction, ..Material::default() }, ..ShapeDef::new(shape) }
}

fn ground(world: &mut World, shape: Shape, friction: f32) -> BodyId {
    let offset = if matches!(shape, Shape::HeightField(_)) { -0.5 * TILES as f32 * TILE } else { 0.0 };
    world.add_body(&BodyDef {
        kind: BodyKind::Static,
        position: Vec3::new(offset, 0.0, offset),
        shapes: vec![surfaced(shape, friction)],
        ..BodyDef::default()
    })
}

/// Lets a body slide for two seconds. Returns the largest change of its height after it has settled, metres, and its
/// final speed, m/s.
fn slide(floor: &Shape, slider: &Shape, height: f32, speed: f32, friction: f32) -> (f32, f32) {
    let mut world = World::new(WorldDef::default());
    ground(&mut world, floor.clone(), friction);
    let along = Vec3::new(0.93, 0.0, 0.37).normalize();
    let id = world.add_body(&BodyDef {
        position: Vec3::new(-19.03, height, -7.61),
        linear_velocity: along * speed,
        shapes: vec![ShapeDef { body_from_shape: lying(slider), ..surfaced(slider.clone(), friction) }],
        ..BodyDef::default()
    });
    let mut rest = None;
    let mut deviation = 0.0_f32;
    for step in 0..120 {
        world.step();
        let y = world.transform(id).translation.y;
        // The body first sinks by the slop of contacts.
        if step == 20 {
            rest = Some(y);
        }
        if let Some(rest) = rest {
            deviation = deviation.max((y - rest).abs());
        }
        assert!((y - height).abs() < 2e-3, "{slider:?} at {speed} m/s: height {y} after {step} steps");
    }
    (deviation, world.velocity(id).linear.length())
}

/// Returns a slightly rotated pose, so that no side is parallel to the tiles; a capsule lies down.
fn lying(slider: &Shape) -> Transform {
    let down = match slider {
        Shape::Capsule { .. } => Rotation::from_axis_angle(Vec3::X, core::f32::consts::FRAC_PI_2),
        _ => Rotation::IDENTITY,
    };
    Transform::new(Vec3::ZERO, Rotation::from_axis_angle(Vec3::Y, 0.3) * down)
}

fn sliders() -> [(Shape, f32); 4] {
    [
        (Shape::Sphere { radius: 0.2 }, 0.2),
        (Shape::Box { half_extents: Vec3::new(0.2, 0.15, 0.3) }, 0.15),
        (Shape::Box { half_extents: Vec3::new(0.7, 0.4, 1.1) }, 0.4),
        (Shape::Capsule { half_height: 0.3, radius: 0.1 }, 0.1),
    ]
}

#[test]
fn friction_on_a_tiled_floor_equals_friction_on_a_plane() {
    for floor in [Floor::Plain, Floor::Shuffled, Floor::Field] {
        let shape = floor_shape(floor);
        for (slider, height) in
            sliders().into_iter().filter(|(slider, _)| matches!(slider, Shape::Box { .. }))
        {
            let (deviation, end) = slide(&shape, &slider, height, 20.0, FRICTION);
            // The body decelerates for two seconds less one substep.
            let expected = 20.0 - FRICTION * 9.81 * 2.0;
            println!("{floor:?} {slider:?}: {deviation} m, {end} m/s for {expected}");
            assert!(deviation < 1e-3, "{floor:?} {slider:?}: its height changes by {deviation} m");
            assert!(
                (end - expected).abs() < 0.01 * (20.0 - expected),
                "{floor:?} {slider:?}: final speed {end} m/s"
            );
        }
    }
}

#[test]
fn bodies_slide_over_a_tiled_floor_without_catching() {
    for floor in [Floor::Plain, Floor::Shuffled, Floor::Field] {
        let shape = floor_shape(floor);
        for (slider, height) in sliders() {
            for speed in [1.0, 5.0, 20.0] {
                let (deviation, end) = slide(&shape, &slider, height, speed, 0.0);
                println!("{floor:?} {slider:?} {speed} m/s: {deviation} m, {end} m/s");
                assert!(
                    deviation < 1e-3,
                    "{floor:?} {slider:?} {speed} m/s: its height changes by {deviation} m"
                );
                assert!(
                    (end - speed).abs() < 1e-3 * speed,
                    "{floor:?} {slider:?} {speed} m/s: final speed {end} m/s"
                );
            }
        }
    }
}
