//! Queries of a world with points and regions.

use crate::cases::{cases, half_extents};
use sinew_math::{Random, Rotation, Transform, Vec3};
use sinew_physics::boxes::Cuboid;
use sinew_physics::{Aabb, BodyDef, BodyId, BodyKind, Obb, OverlapWith, Shape, ShapeDef, World, WorldDef};

fn body(shapes: Vec<ShapeDef>, position: Vec3, rotation: Rotation) -> BodyDef {
    BodyDef { kind: BodyKind::Static, position, rotation, shapes, ..BodyDef::default() }
}

/// Adds a body with a ball of radius 1 m at its origin and a box of 2 × 1 × 1 m beside the ball.
fn pair_of_shapes(world: &mut World) -> BodyId {
    let ball = ShapeDef::new(Shape::Sphere { radius: 1.0 });
    let beside = ShapeDef {
        body_from_shape: Transform::from_translation(Vec3::X),
        ..ShapeDef::new(Shape::Box { half_extents: Vec3::new(1.0, 0.5, 0.5) })
    };
    world.add_body(&body(vec![ball, beside], Vec3::new(0.0, 10.0, 0.0), Rotation::IDENTITY))
}

#[test]
fn queries_of_a_body_include_all_its_shapes() {
    let mut world = World::new(WorldDef::default());
    let id = pair_of_shapes(&mut world);
    assert_eq!(world.bounds(id), Aabb::new(Vec3::new(-1.0, 9.0, -1.0), Vec3::new(2.0, 11.0, 1.0)));
    let deepest = |x: f32, y: f32| world.point_penetration(id, Vec3::new(x, 10.0 + y, 0.0));
    let way = deepest(1.7, 0.2).expect("the point is in the box");
    assert!((way.depth - 0.3).abs() < 1e-5, "{way:?}");
    let way = deepest(-0.6, 0.0).expect("the point is in the ball");
    assert!((way.depth - 0.4).abs() < 1e-5 && (way.direction - Vec3::NEG_X).length() < 1e-5, "{way:?}");
    assert_eq!(deepest(1.5, 0.6), None);
    let above = world.nearest_surface(id, Vec3::new(1.5, 12.5, 0.0)).expect("the body has shapes");
    let expected = (1.5f32 * 1.5 + 2.5 * 2.5).sqrt() - 1.0;
    assert!((above.distance - expected).abs() < 1e-5, "{above:?}");
    assert!(world.contains_point(id, Vec3::new(2.0, 10.0, 0.0)));
    assert!(!world.contains_point(id, Vec3::new(2.01, 10.0, 0.0)));
    let bare = world.add_body(&body(Vec::new(), Vec3::ONE, Rotation::IDENTITY));
    assert_eq!(world.bounds(bare), Aabb::new(Vec3::ONE, Vec3::ONE));
    assert_eq!(world.nearest_surface(bare, Vec3::ZERO), None);
    assert!(!world.contains_point(bare, Vec3::ONE));
}

/// Bodies that a region overlaps have sample points in the region; bodies that it misses have none.
#[test]
fn regions_find_bodies_with_points_inside() {
    let mut random = Random::new(95);
    for case in 0..cases(10_000) {
        let mut world = World::new(WorldDef::default());
        for _ in 0..6 {
            let half = half_extents(0.8, &mut random) + Vec3::splat(0.1);
            let shape = match random.index(3) {
                0 => Shape::Box { half_extents: half },
                1 => Shape::Sphere { radius: half.x },
                _ => Shape::Capsule { half_height: half.y, radius: 0.5 * half.x },
            };
            world.add_body(&body(vec![ShapeDef::new(shape)], random.in_cube() * 2.0, random.rotation()));
        }
        let ground = Transform::new(Vec3::NEG_Y, Rotation::from_scaled_axis(random.in_cube() * 0.5));
        world.add_body(&body(vec![ShapeDef::new(Shape::HalfSpace)], ground.translation, ground.rotation));
        let region = Obb::new(random.in_cube() * 2.0, random.rotation(), half_extents(0.8, &mut random));
        let mut found = Vec::new();
        world.query().bodies(&OverlapWith(region.into()), &mut found);
        let frame = region.to_transform();
        let points: Vec<Vec3> =
            (0..400).map(|_| frame.point(region.half_extents * random.in_cube())).collect();
        for id in world.body_ids() {
            let distance = |p: &Vec3| world.nearest_surface(id, *p).expect("the body has a shape").distance;
            let nearest = points.iter().map(distance).fold(f32::INFINITY, f32::min);
            if found.contains(&id) {
                // Samples are about a sixth of the region's size apart.
                assert!(nearest < 0.35, "case {case}: {id:?} was found {nearest} m from {region:?}");
            } else {
                assert!(nearest > 0.0, "case {case}: {id:?} inside {region:?} was not found");
            }
        }
        let all = Aabb::around(Vec3::ZERO, Vec3::splat(10.0));
        world.query().bodies(&OverlapWith(all.into()), &mut found);
        assert_eq!(found.len(), 7);
        assert!(all.volume() > 0.0);
    }
}
