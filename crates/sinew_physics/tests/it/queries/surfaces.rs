//! Queries of meshes and height fields, compared with tests of every triangle.

use super::random::{KINDS, frame, shape};
use crate::cases::cases;
use sinew_math::{Random, Transform, Vec3};
use sinew_physics::boxes::Cuboid;
use sinew_physics::ray::Ray;
use sinew_physics::*;
use std::sync::Arc;

/// Returns the corners of a cube around the origin, and its triangles, counter-clockwise seen from outside.
fn cube(half: Vec3) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corners = Aabb::around(Vec3::ZERO, half).corners().to_vec();
    let sides: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    (corners, triangles)
}

fn world_of(shape: Shape, at: &Transform) -> World {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(shape).at(at.translation).turned(at.rotation));
    world
}

/// Queries from outside give the same results for a closed mesh as for the box with the same surface. Rays from inside
/// do not hit the mesh.
#[test]
fn queries_of_a_closed_mesh_equal_those_of_a_box() {
    let mut random = Random::new(411);
    let (mut hits, mut casts) = (0, 0);
    for case in 0..cases(20_000) {
        let half = (random.in_cube() * 0.6).abs() + Vec3::splat(0.2);
        let (corners, triangles) = cube(half);
        let at = frame(2.0, &mut random);
        let mesh = Mesh::new(&corners, &triangles).expect("the mesh is valid");
        let meshed = world_of(Shape::Mesh(Arc::new(mesh)), &at);
        let solid = world_of(Shape::Box { half_extents: half }, &at);
        let (meshed, solid) = (meshed.query(), solid.query());

        let origin = at.point(random.in_cube() * 2.0);
        let ray =
            Ray { origin, direction: (at.point(random.in_cube() * 0.5) - origin) * random.range(0.5, 2.0) };
        match (meshed.first(&ray), solid.first(&ray)) {
            (found, Some(hit)) if hit.start.is_some() => {
                assert_eq!(found, None, "case {case}: the cast starts inside");
            }
            (Some(a), Some(b)) => {
                hits += 1;
                assert!((a.point - b.point).length() < 1e-4, "case {case}: the points differ: {a:?} {b:?}");
                assert!(a.normal.dot(b.normal) > 0.999, "case {case}: the normals differ: {a:?} {b:?}");
            }
            (a, b) => assert_eq!(a.is_some(), b.is_some(), "case {case}: {ray:?} gives {a:?} and {b:?}"),
        }

        let probe = Probe::new(shape(random.index(KINDS), &mut random), frame(2.0, &mut random));
        let start = solid
            .first(&NearestToShape { probe: probe.clone(), within: 9.0 })
            .expect("the surface is within 9 m");
        if start.distance > 1e-5 {
            let near = meshed
                .first(&NearestToShape { probe: probe.clone(), within: 9.0 })
                .expect("the surface is within 9 m");
            assert!(
                (near.distance - start.distance).abs() < 1e-5,
                "case {case}: nearest {near:?}, start {start:?}"
            );
            assert!(!meshed.any(&OverlapWith(probe.clone())), "case {case}");
            let translation = at.point(random.in_cube() * 0.5) - probe.world_from_shape.translation;
            let cast = ShapeCast { probe, translation };
            // Relative speed of the surfaces along the path: the uncertainty of the hit is inversely proportional to
            // it.
            let closing = |hit: BodyHit| -hit.normal.dot(translation) / translation.length();
            match (meshed.first(&cast), solid.first(&cast)) {
                (Some(a), Some(b)) => {
                    casts += 1;
                    let apart = (a.fraction - b.fraction).abs() * translation.length();
                    assert!(apart * closing(b) < 5e-5, "case {case}: the fractions differ: {a:?} {b:?}");
                }
                (None, None) => {}
                (a, b) => {
                    let grazes = a.or(b).is_some_and(|hit| closing(hit) < 0.03);
                    assert!(grazes, "case {case}: {cast:?} gives {a:?} and {b:?}");
                }
            }
        } else if start.distance < -1e-4 && !meshed.any(&OverlapWith(probe.clone())) {
            // The probe is entirely inside the solid, so it overlaps no point of the mesh.
            let middle = at.inverse_point(probe.world_from_shape.translation);
            assert!(
                middle.abs().cmplt(half).all(),
                "case {case}: the centre is beyond the border: {start:?}"
            );
        }
    }
    assert!(hits > cases(20_000) / 3 && casts > cases(20_000) / 5, "{hits} ray hits, {casts} cast hits");
}

/// Rays and casts hit a height field from above only. It pushes shapes upward and contains no points.
#[test]
fn height_fields_are_hit_from_above_only() {
    let (columns, rows, spacing) = (5, 5, [1.0, 1.0]);
    let def = HeightFieldDef { columns, rows, spacing, heights: vec![1.0; 25], holes: Vec::new() };
    let field = HeightField::new(def).expect("the height field is valid");
    let middle = field.bounds().center();
    let world = world_of(Shape::HeightField(Arc::new(field)), &Transform::IDENTITY);
    let query = world.query();
    let (above, below) = (middle + Vec3::Y * 2.0, middle - Vec3::Y * 2.0);
    let hit = query.first(&Ray::between(above, below)).expect("a ray from above must hit");
    assert!((hit.point - middle).length() < 1e-5 && (hit.normal - Vec3::Y).length() < 1e-5, "{hit:?}");
    assert_eq!(query.first(&Ray::between(below, above)), None);
    let ball = |y: f32| Probe::at(Shape::Sphere { radius: 0.25 }, middle + Vec3::Y * y);
    for y in [0.2f32, 0.1, -0.2] {
        let way = query.first(&PenetrationOf(ball(y))).expect("a ball through the surface must overlap it");
        assert!(
            (way.depth - (0.25 - y)).abs() < 1e-5 && (way.direction - Vec3::Y).length() < 1e-5,
            "ball at height {y}: {way:?}"
        );
    }
    assert!(!query.any(&OverlapWith(ball(0.26))) && !query.any(&OverlapWith(ball(-0.26))));
    let fall = ShapeCast { probe: ball(1.25), translation: Vec3::Y * -4.0 };
    let landing = query.first(&fall).expect("the shape falls on the ground");
    assert!(
        (landing.fraction - 0.25).abs() < 1e-5 && (landing.point - middle).length() < 1e-4,
        "{landing:?}"
    );
    let rise = ShapeCast { probe: ball(-1.25), translation: Vec3::Y * 4.0 };
    assert_eq!(query.first(&rise), None);
    for point in [above, below] {
        assert!(!query.any(&ContainsPoint(point)));
        let near = query.first(&NearestTo { point, within: 3.0 }).expect("the surface is 2 m away");
        assert!((near.distance - 2.0).abs() < 1e-5 && near.normal.dot(point - middle) > 0.0, "{near:?}");
    }
}
