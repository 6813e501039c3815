//! Ray casts against single shapes: the hit is where a distance function in `f64` becomes 0.

use super::oracle::WideShape;
use super::random::{KINDS, frame, shape};
use crate::cases::cases;
use crate::wide::wide;
use sinew_math::{Random, Transform, Vec3};
use sinew_physics::ray::Ray;
use sinew_physics::{BodyDef, BodyHit, BodyKind, Shape, ShapeDef, World, WorldDef};

/// Returns the first hit of a ray in a world of one shape.
fn first(shape: &Shape, frame: &Transform, ray: &Ray) -> Option<BodyHit> {
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef {
        kind: BodyKind::Static,
        position: frame.translation,
        rotation: frame.rotation,
        shapes: vec![ShapeDef::new(shape.clone())],
        ..BodyDef::default()
    });
    world.query().first(ray)
}

#[test]
fn a_ray_enters_where_the_distance_becomes_zero() {
    const NEAR: f64 = 2e-6;
    let mut random = Random::new(404);
    let (mut hits, mut starts) = (0, 0);
    for case in 0..cases(100_000) {
        let shape = shape(case as usize % KINDS, &mut random);
        let frame = frame(3.0, &mut random);
        let origin = frame.point(random.in_cube() * if random.index(4) == 0 { 0.5 } else { 2.0 });
        let ray = Ray { origin, direction: frame.point(random.in_cube() * 0.8) - origin };
        let wide_shape = WideShape::new(&shape, &frame);
        let (start, way) = (wide(ray.origin), wide(ray.direction));
        let found = first(&shape, &frame, &ray);
        let outside = wide_shape.signed_distance(start);
        let Some(hit) = found else {
            let least = wide_shape.least_distance(start, way);
            assert!(
                least > -NEAR,
                "case {case}: the ray missed {shape:?} although its least distance is {least}"
            );
            continue;
        };
        hits += 1;
        let off = wide_shape.signed_distance(wide(hit.point));
        assert!((hit.normal.length() - 1.0).abs() < 1e-5, "case {case}: {hit:?}");
        if let Some(start) = hit.start {
            starts += 1;
            assert!(
                outside <= NEAR && (outside + f64::from(start.depth)).abs() < NEAR,
                "case {case}: {hit:?}"
            );
            assert_eq!((hit.fraction, hit.point), (0.0, ray.origin), "case {case}");
            assert!((hit.normal + ray.direction.normalize()).length() < 1e-5, "case {case}: {hit:?}");
            let out = wide_shape.signed_distance(wide(origin + start.direction * start.depth));
            assert!(out.abs() < NEAR, "case {case}: the push-out ends {out} from the surface");
            continue;
        }
        assert!(off.abs() < 2.0 * NEAR, "case {case}: the hit on {shape:?} is {off} from its surface");
        // For a grazing ray rounding decides the hit: the whole path is near the surface there.
        let fraction = f64::from(hit.fraction);
        let before = wide_shape.least_distance(start, way.map(|x| x * (fraction - 1e-6).max(0.0)));
        assert!(
            before > -2.0 * NEAR,
            "case {case}: {shape:?}: distance {before} before the hit at {fraction}"
        );
        let outward = wide_shape.signed_distance(wide(hit.point + hit.normal * 1e-3));
        assert!(outward > 0.5e-3, "case {case}: {shape:?}: distance {outward} at 1 mm along the normal");
    }
    assert!(hits > cases(100_000) / 3 && starts > cases(100_000) / 50, "{hits} hits, {starts} starts inside");
}

/// Hits at equal fractions are ordered by the bodies' indices, then by the shapes' indices.
#[test]
fn equal_hits_are_ordered_by_body_and_shape_index() {
    let ball = ShapeDef::new(Shape::Sphere { radius: 0.5 });
    let def = BodyDef { kind: BodyKind::Static, shapes: vec![ball.clone(), ball], ..BodyDef::default() };
    let mut world = World::new(WorldDef::default());
    let ids: Vec<_> = (0..9).map(|_| world.add_body(&def)).collect();
    world.remove_body(ids[0]);
    world.remove_body(ids[4]);
    // The new body gets the index of the removed one.
    let again = world.add_body(&def);
    let ray = Ray { origin: Vec3::X * -2.0, direction: Vec3::X * 4.0 };
    let hit = world.query().first(&ray).expect("the ray must hit one of the shapes");
    assert_eq!((hit.body, hit.shape), (ids[1], 0));
    let mut hits = Vec::new();
    world.query().all(&ray, &mut hits);
    let order: Vec<_> = hits.iter().map(|hit| (hit.body, hit.shape)).collect();
    let bodies = [ids[1], ids[2], ids[3], again, ids[5], ids[6], ids[7], ids[8]];
    let expected: Vec<_> = bodies.iter().flat_map(|&body| [(body, 0), (body, 1)]).collect();
    assert_eq!(order, expected);
}

#[test]
fn batched_queries_equal_single_queries() {
    let mut random = Random::new(405);
    let populated = super::random::Populated::new(40, 4.0, &mut random);
    let query = populated.world.query();
    for count in [0, 1, 7, 8, 9, 100] {
        let rays: Vec<Ray> = (0..count)
            .map(|_| Ray { origin: random.in_cube() * 5.0, direction: random.in_cube() * 9.0 })
            .collect();
        let mut hits = vec![None; count];
        query.first_each(&rays, &mut hits);
        let mut met = vec![false; count];
        query.any_each(&rays, &mut met);
        let mut seen = 0;
        let mut all = Vec::new();
        query.all_each(&rays, &mut Vec::new(), |index, hits| {
            assert_eq!(index, seen);
            query.all(&rays[index], &mut all);
            assert_eq!(hits, all);
            seen += 1;
        });
        assert_eq!(seen, count);
        for (ray, (hit, met)) in rays.iter().zip(hits.iter().zip(met)) {
            assert_eq!(*hit, query.first(ray));
            assert_eq!(hit.is_some(), met);
        }
    }
}

/// A batch gives the results of single rays, for any world, any filter and any start and end of the rays.
#[test]
fn batched_rays_hit_the_same_shapes_as_single_rays() {
    let mut random = Random::new(410);
    let (mut asked, mut inside) = (0, 0);
    while asked < cases(100_000) as usize {
        let bodies = 1 + random.index(200);
        let mut populated = super::random::Populated::new(bodies, 4.0, &mut random);
        if random.index(2) == 0 {
            populated.world.step();
        }
        let except: Vec<_> = populated.bodies.iter().take(3).map(|(id, _)| *id).collect();
        let query = populated.world.query().filter(super::random::filter(&except, &mut random));
        let rays: Vec<Ray> = (0..random.index(300))
            .map(|_| {
                let length = [0.0, 1e-6, 1.0, 9.0, 1e5][random.index(5)];
                Ray { origin: random.in_cube() * 5.0, direction: random.in_cube() * length }
            })
            .collect();
        let mut hits = vec![None; rays.len()];
        query.first_each(&rays, &mut hits);
        let single: Vec<_> = rays.iter().map(|ray| query.first(ray)).collect();
        assert_eq!(hits, single);
        asked += rays.len();
        inside += hits.iter().flatten().filter(|hit| hit.start.is_some()).count();
    }
    assert!(inside > asked / 100, "{inside} of {asked} rays start inside");
}

#[test]
#[should_panic(expected = "one answer for each question")]
fn batch_with_a_wrong_number_of_results_is_refused() {
    let ray = Ray { origin: Vec3::ZERO, direction: Vec3::X };
    World::new(WorldDef::default()).query().first_each(&[ray], &mut []);
}
