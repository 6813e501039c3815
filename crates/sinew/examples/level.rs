//! A level: `cargo run -p sinew --example level`.
//!
//! Shapes of a level: a mesh to roll on, terrain as a height field, and a hull of points.

use sinew::prelude::*;
use std::sync::Arc;

/// Returns a strip of quads down a slope, as a modelling program would export it.
fn slide() -> Shape {
    let edge = |i: u32, z: f32| Vec3::new(i as f32, 4.0 - 0.5 * i as f32, z);
    let vertices: Vec<Vec3> = (0..=8).flat_map(|i| [edge(i, -1.0), edge(i, 1.0)]).collect();
    let quad = |i: u32| [[2 * i, 2 * i + 1, 2 * i + 2], [2 * i + 1, 2 * i + 3, 2 * i + 2]];
    let triangles: Vec<[u32; 3]> = (0..8).flat_map(quad).collect();
    Shape::mesh(&vertices, &triangles).expect("these are triangles")
}

/// Returns a bowl of terrain, 1 m deep.
fn bowl() -> Shape {
    let height = |i: usize| {
        let (x, z) = ((i % 11) as f32 - 5.0, (i / 11) as f32 - 5.0);
        -1.0 + 0.04 * (x * x + z * z)
    };
    let heights = (0..121).map(height).collect();
    let def = HeightFieldDef { columns: 11, rows: 11, spacing: [1.0, 1.0], heights, holes: Vec::new() };
    Shape::HeightField(Arc::new(HeightField::new(def).expect("this is terrain")))
}

/// Rolls a stone down the slide into the bowl.
pub fn main() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(slide()));
    world.add_body(&BodyDef::fixed(bowl()).at(Vec3::new(7.0, -0.5, -5.0)));
    let corners: Vec<Vec3> = (0..8)
        .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 0.4 - Vec3::splat(0.2))
        .collect();
    let stone = Shape::hull(&corners).expect("these span a solid");
    let ball = world.add_body(&BodyDef::dynamic(Shape::sphere(0.25)).at(Vec3::new(0.5, 4.3, 0.0)));
    let stone = world.add_body(&BodyDef::dynamic(stone).at(Vec3::new(12.0, 2.0, 0.0)));

    let down = Ray { origin: Vec3::new(12.0, 10.0, 0.3), direction: Vec3::Y * -20.0 };
    let ground = world.query().first(&down).expect("there is ground");
    println!("the ground at x = 12 is at {:.2} m, normal {:.2}", ground.point.y, ground.normal);

    (0..900).for_each(|_| world.step());
    for (name, id) in [("ball", ball), ("stone", stone)] {
        let at = world.transform(id).translation;
        println!("the {name} lies at {at:.2}");
        assert!(
            (at - Vec3::new(12.0, at.y, 0.0)).length() < 4.0 && (-1.6..0.5).contains(&at.y),
            "in the bowl: {at}"
        );
    }
}
