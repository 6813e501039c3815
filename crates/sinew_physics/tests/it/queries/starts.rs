//! Queries that start inside a shape, for every shape and every query.

use super::random::{KINDS, shape};
use sinew_math::{Random, Transform, Vec3};
use sinew_physics::ray::Ray;
use sinew_physics::*;

/// Returns each kind of shape, with a world that has one static body of that shape.
fn each_shape() -> impl Iterator<Item = (World, Shape)> {
    let mut random = Random::new(407);
    let mut shapes: Vec<Shape> = (0..KINDS).map(|kind| shape(kind, &mut random)).collect();
    shapes.push(Shape::HalfSpace);
    shapes.into_iter().map(|shape| {
        let mut world = World::new(WorldDef::default());
        let def = ShapeDef::new(shape.clone());
        world.add_body(&BodyDef { kind: BodyKind::Static, shapes: vec![def], ..BodyDef::default() });
        (world, shape)
    })
}

/// Point inside every shape that is on no plane of symmetry.
const INSIDE: Vec3 = Vec3::new(0.01, -0.03, 0.02);

#[test]
fn ray_that_starts_inside_hits_at_fraction_zero() {
    for (world, shape) in each_shape() {
        for way in [Vec3::X, Vec3::NEG_Y, Vec3::Y * 100.0, Vec3::new(1.0, 2.0, 3.0)] {
            let hit = world
                .query()
                .first(&Ray { origin: INSIDE, direction: way })
                .expect("a query that starts inside must hit");
            assert_eq!((hit.fraction, hit.point), (0.0, INSIDE), "{shape:?}");
            assert!((hit.normal + way.normalize()).length() < 1e-6, "{shape:?}: {hit:?}");
            let start = hit.start.expect("a query that starts inside must hit");
            let (distance, outward) = shape.signed_distance(&Transform::IDENTITY, INSIDE);
            assert_eq!((start.depth, start.direction), (-distance, outward), "{shape:?}");
        }
    }
}

#[test]
fn zero_length_ray_that_starts_inside_hits_the_shape() {
    for (world, shape) in each_shape() {
        let hit = world
            .query()
            .first(&Ray { origin: INSIDE, direction: Vec3::ZERO })
            .expect("a query that starts inside must hit");
        let (_, outward) = shape.signed_distance(&Transform::IDENTITY, INSIDE);
        assert_eq!((hit.fraction, hit.normal), (0.0, outward), "{shape:?}");
        let outside = Ray { origin: Vec3::Y * 3.0, direction: Vec3::ZERO };
        assert_eq!(world.query().first(&outside), None, "{shape:?}");
    }
}

/// A ray that starts on the surface counts as starting inside, whatever its direction.
#[test]
fn ray_that_starts_on_the_surface_hits_at_fraction_zero() {
    for (world, shape) in each_shape() {
        // Height of the ray's origin: the largest number that is not above the surface.
        let above = |y: f32| shape.signed_distance(&Transform::IDENTITY, Vec3::Y * y).0 > 0.0;
        let (mut top, mut outside) = (0.0, 4.0);
        for _ in 0..60 {
            let middle = 0.5 * (top + outside);
            if above(middle) { outside = middle } else { top = middle }
        }
        for way in [Vec3::Y, Vec3::NEG_Y, Vec3::X] {
            let hit = world
                .query()
                .first(&Ray { origin: Vec3::Y * top, direction: way })
                .expect("a ray that starts on the surface must hit");
            assert_eq!((hit.fraction, hit.normal), (0.0, -way), "{shape:?}");
            let depth = hit.start.expect("touching shapes must count as overlapping").depth;
            assert!(depth < 1e-6, "{shape:?}: depth {depth} m");
        }
    }
}

#[test]
fn points_and_probes_inside_a_shape_overlap_it() {
    for (world, shape) in each_shape() {
        assert!(world.query().any(&ContainsPoint(INSIDE)), "{shape:?}");
        let nearest = world
            .query()
            .first(&NearestTo { point: INSIDE, within: 0.0 })
            .expect("the nearest surface must be found from inside");
        assert!(nearest.distance < 0.0, "{shape:?}: not inside: {nearest:?}");
        let (distance, _) = shape.signed_distance(&Transform::IDENTITY, nearest.point);
        assert!(distance.abs() < 1e-6, "{shape:?}: the nearest point is {distance} m from the surface");
        let speck = Probe::at(Shape::Sphere { radius: 0.005 }, INSIDE);
        assert!(world.query().any(&OverlapWith(speck.clone())), "{shape:?}");
        let way =
            world.query().first(&PenetrationOf(speck)).expect("a probe inside the shape must overlap it");
        assert!(
            (way.depth + nearest.distance - 0.005).abs() < 1e-6,
            "{shape:?}: depth {way:?}, nearest {nearest:?}"
        );
    }
}

#[test]
fn cast_that_starts_inside_hits_at_fraction_zero() {
    for (world, shape) in each_shape() {
        let probe = Probe::at(Shape::Box { half_extents: Vec3::splat(0.01) }, INSIDE);
        let way =
            world.query().first(&PenetrationOf(probe.clone())).expect("a query that starts inside must hit");
        for translation in [Vec3::X, Vec3::NEG_Y, Vec3::Y * 100.0, Vec3::new(1.0, 2.0, 3.0)] {
            let cast = ShapeCast { probe: probe.clone(), translation };
            let hit = world.query().first(&cast).expect("a query that starts inside must hit");
            assert_eq!(hit.fraction, 0.0, "{shape:?}");
            assert!((hit.normal + translation.normalize()).length() < 1e-6, "{shape:?}: {hit:?}");
            let start = hit.start.expect("a query that starts inside must hit");
            assert_eq!((start.depth, start.direction), (way.depth, way.direction), "{shape:?}");
        }
        let still = ShapeCast { probe, translation: Vec3::ZERO };
        let hit = world.query().first(&still).expect("a query that starts inside must hit");
        assert_eq!((hit.fraction, hit.normal), (0.0, way.direction), "{shape:?}");
        let outside = Probe::at(Shape::Sphere { radius: 0.1 }, Vec3::Y * 3.0);
        assert_eq!(world.query().first(&ShapeCast { probe: outside, translation: Vec3::ZERO }), None);
    }
}

/// A cast of a probe that rests on a shape hits it in any direction. A cast from slightly above the shape hits it only
/// if it moves toward the shape.
#[test]
fn cast_that_starts_on_the_surface_hits_in_any_direction() {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let at = |y: f32, translation: Vec3| {
        let probe = Probe::at(Shape::Sphere { radius: 0.5 }, Vec3::Y * y);
        world.query().first(&ShapeCast { probe, translation }).map(|hit| (hit.fraction, hit.start.is_some()))
    };
    for way in [Vec3::X, Vec3::Y, Vec3::NEG_Y] {
        assert_eq!(at(0.5, way), Some((0.0, true)), "{way}");
    }
    assert_eq!(at(0.500_001, Vec3::X), None);
    assert_eq!(at(0.500_001, Vec3::Y), None);
    assert_eq!(at(0.500_001, Vec3::NEG_Y), Some((0.0, false)));
}
