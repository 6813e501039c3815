//! Seams of the ground: bodies slide and roll over abutting shapes as over a single one, and real edges stop them.

use crate::solids::box_hull;
use sinew_math::{Random, Rotation, Transform, Vec3, max, trig};
use sinew_physics::*;

/// Kinds of ground.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Tiles {
    One,
    Boxes,
    Hulls,
    /// Several shapes of a single body.
    Shapes,
    /// Boxes raised, lowered and separated by less than the slop.
    Rough,
    /// Open meshes of the upper faces.
    Sheets,
    /// Closed meshes of boxes.
    Blocks,
    /// Height fields.
    Fields,
    /// All of these in turn.
    Mixed,
}

/// All kinds of tiles except the single one.
const ALL: [Tiles; 8] = [
    Tiles::Boxes,
    Tiles::Hulls,
    Tiles::Shapes,
    Tiles::Rough,
    Tiles::Sheets,
    Tiles::Blocks,
    Tiles::Fields,
    Tiles::Mixed,
];

/// Returns the mesh of a tile with sides of 1 m around its origin: all six faces, or one if it is open.
fn block(is_closed: bool) -> Shape {
    let corner =
        |i: u32| Vec3::new(0.5 - (i & 1) as f32, 0.5 - (i >> 1 & 1) as f32, 0.5 - (i >> 2 & 1) as f32);
    let points: Vec<Vec3> = (0..8).map(corner).collect();
    let sides = [[0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6], [0, 4, 6, 2], [1, 3, 7, 5]];
    let sides = if is_closed { &sides[..] } else { &sides[..1] };
    let triangles: Vec<[u32; 3]> = sides.iter().flat_map(|&[a, b, c, d]| [[a, c, b], [a, d, c]]).collect();
    Shape::mesh(&points, &triangles).expect("the mesh is valid")
}

fn field() -> Shape {
    let heights = vec![0.0; 9];
    let def = HeightFieldDef { columns: 3, rows: 3, spacing: [0.5; 2], heights, holes: Vec::new() };
    Shape::HeightField(HeightField::new(def).expect("the height field is valid").into())
}

const SIDE: i32 = 9;

/// Adds ground with its top at height 0.
fn add_ground(world: &mut World, tiles: Tiles, material: Material, random: &mut Random) {
    let tile = |shape: Shape| ShapeDef { material, ..ShapeDef::new(shape) };
    let half = Vec3::splat(0.5);
    if tiles == Tiles::One {
        let far = SIDE as f32;
        world.add_body(&BodyDef::fixed(tile(Shape::cuboid(Vec3::new(far, 0.5, far)))).at(Vec3::Y * -0.5));
        return;
    }
    let mut all = Vec::new();
    for (i, j) in (-SIDE..SIDE).flat_map(|i| (-SIDE..SIDE).map(move |j| (i, j))) {
        let at = Vec3::new(i as f32 + 0.5, -0.5, j as f32 + 0.5);
        match tiles {
            Tiles::Boxes => _ = world.add_body(&BodyDef::fixed(tile(Shape::cuboid(half))).at(at)),
            Tiles::Hulls => _ = world.add_body(&BodyDef::fixed(tile(box_hull(half))).at(at)),
            Tiles::Rough => {
                let by =
                    Vec3::new(random.range(-3e-4, 3e-4), random.range(-2e-4, 0.0), random.range(-3e-4, 3e-4));
                world.add_body(&BodyDef::fixed(tile(Shape::cuboid(half))).at(at + by));
            }
            Tiles::Sheets | Tiles::Blocks | Tiles::Fields | Tiles::Mixed => {
                let kinds = [Tiles::Sheets, Tiles::Blocks, Tiles::Fields, Tiles::Boxes];
                let kind =
                    if tiles == Tiles::Mixed { kinds[(i + 2 * j).rem_euclid(4) as usize] } else { tiles };
                let shape = match kind {
                    Tiles::Boxes => Shape::cuboid(half),
                    Tiles::Fields => field(),
                    _ => block(kind == Tiles::Blocks),
                };
                let by = if kind == Tiles::Fields { Vec3::new(-0.5, 0.5, -0.5) } else { Vec3::ZERO };
                world.add_body(&BodyDef::fixed(tile(shape)).at(at + by));
            }
            _ => all.push(ShapeDef {
                body_from_shape: Transform::from_translation(at),
                ..tile(Shape::cuboid(half))
            }),
        }
    }
    if !all.is_empty() {
        world.add_body(&BodyDef { kind: BodyKind::Static, shapes: all, ..BodyDef::default() });
    }
}

/// A body that slides or rolls on the ground. `height` is that of its centre, `spin` its roll rate at 1 m/s.
struct Slider {
    shape: Shape,
    height: f32,
    turn: Rotation,
    spin: f32,
    friction: f32,
}

fn slider(kind: usize, way: Vec3, random: &mut Random) -> Slider {
    let yaw = Rotation::from_axis_angle(Vec3::Y, random.range(0.0, core::f32::consts::TAU));
    let half = Vec3::new(0.2, 0.15, 0.25);
    let lying = Rotation::from_arc(Vec3::Y, Vec3::Y.cross(way).normalize());
    let rolls = |shape: Shape, radius: f32, turn: Rotation| Slider {
        shape,
        height: radius,
        turn,
        spin: 1.0 / radius,
        friction: 0.6,
    };
    let slides =
        |shape: Shape, height: f32, friction: f32| Slider { shape, height, turn: yaw, spin: 0.0, friction };
    match kind {
        0 => rolls(Shape::sphere(0.3), 0.3, Rotation::IDENTITY),
        1 => rolls(Shape::sphere(0.05), 0.05, Rotation::IDENTITY),
        2 => slides(Shape::cuboid(half), half.y, 0.0),
        3 => slides(Shape::cuboid(half), half.y, 0.1),
        4 => slides(box_hull(half), half.y, 0.0),
        5 => rolls(Shape::capsule(0.3, 0.1), 0.1, lying),
        6 => Slider { spin: 0.0, friction: 0.0, ..rolls(Shape::capsule(0.3, 0.1), 0.1, lying) },
        _ => slides(Shape::cylinder(0.1, 0.2), 0.1, 0.0),
    }
}

/// Result of a run: final speed along the initial direction; final and largest height, both relative to the start.
#[derive(Debug)]
struct Way {
    speed: f32,
    height: f32,
    apex: f32,
}

fn run(tiles: Tiles, kind: usize, speed: f32, seed: u64) -> Way {
    let mut random = Random::new(seed);
    let heading = random.range(0.0, core::f32::consts::TAU);
    let way = Vec3::new(trig::cos(heading), 0.0, trig::sin(heading));
    let slider = slider(kind, way, &mut random);
    let start = Vec3::new(random.range(-1.0, 1.0), slider.height, random.range(-1.0, 1.0));
    let mut world = World::new(WorldDef::default());
    let material = Material { friction: slider.friction, ..Material::DEFAULT };
    add_ground(&mut world, tiles, material, &mut random);
    let shape = ShapeDef { material, ..ShapeDef::new(slider.shape) };
    let body = world.add_body(&BodyDef {
        linear_velocity: way * speed,
        angular_velocity: Vec3::Y.cross(way) * (speed * slider.spin),
        ..BodyDef::dynamic(shape).at(start).turned(slider.turn)
    });
    let mut apex = 0.0;
    let height = |world: &World| world.center_of_mass(body).y - slider.height;
    for _ in 0..sinew_math::min(6.0 / speed * 60.0, 240.0) as usize {
        world.step();
        apex = max(apex, height(&world));
    }
    Way { speed: world.velocity(body).linear.dot(way), height: height(&world), apex }
}

#[test]
fn sliding_over_seams_matches_one_box() {
    let mut seed = 0;
    for kind in 0..8 {
        for speed in [0.5, 1.0, 3.0, 6.0, 10.0] {
            for tiles in ALL {
                seed += 1;
                let (one, way) = (run(Tiles::One, kind, speed, seed), run(tiles, kind, speed, seed));
                let case = format!(
                    "{tiles:?}, kind {kind} at {speed} m/s, seed {seed}: {way:?}, on one box {one:?}"
                );
                assert!((way.speed - one.speed).abs() < 0.01 * speed, "{case}");
                assert!((way.height - one.height).abs() < 1e-3 && way.apex - one.apex < 1e-3, "{case}");
            }
        }
    }
}

/// A step of 5 mm stops bodies, and so do walls on the ground and beside it.
#[test]
fn real_edges_stop_bodies() {
    for (name, at, half) in [
        ("a wall beside the floor", Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.5, 1.0, 0.5)),
        ("a wall on the floor", Vec3::new(0.4, 0.5, 0.0), Vec3::new(0.1, 0.5, 0.5)),
        ("a step", Vec3::new(1.0, -0.495, 0.0), Vec3::splat(0.5)),
    ] {
        for seed in 0..20 {
            let mut random = Random::new(seed);
            let mut world = World::new(WorldDef::default());
            let smooth = Material { friction: 0.0, ..Material::DEFAULT };
            let def = |half: Vec3| ShapeDef { material: smooth, ..ShapeDef::new(Shape::cuboid(half)) };
            let floor = ShapeDef {
                shape: if seed % 2 == 0 { block(true) } else { Shape::cuboid(Vec3::splat(0.5)) },
                ..def(half)
            };
            world.add_body(&BodyDef::fixed(floor).at(Vec3::Y * -0.5));
            world.add_body(&BodyDef::fixed(def(half)).at(at));
            let start = Vec3::new(-0.2, 0.15, random.range(-0.2, 0.2));
            let crate_of = BodyDef::dynamic(def(Vec3::splat(0.15))).at(start);
            let speed = random.range(0.3, 2.0);
            let body = world.add_body(&BodyDef { linear_velocity: Vec3::X * speed, ..crate_of });
            (0..120).for_each(|_| world.step());
            let x = world.center_of_mass(body).x;
            assert!(x < 0.4, "{name}, {speed} m/s: the crate is at x = {x}");
        }
    }
}
