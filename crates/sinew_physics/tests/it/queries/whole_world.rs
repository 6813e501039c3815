//! Every query of a whole world, compared with queries of every shape alone.

use super::random::{KINDS, Populated, filter, frame, shape};
use crate::cases::cases;
use sinew_math::{Random, Transform};
use sinew_physics::boxes::{Penetration, SurfacePoint};
use sinew_physics::convex::{cast_shape, gap};
use sinew_physics::ray::Ray;
use sinew_physics::{
    BodyHit, BodyId, BodyPenetration, BodySurface, ContainsPoint, NearestTo, NearestToShape, OverlapWith,
    PenetrationOf, Probe, QueryFilter, QueryKind, Shape, ShapeCast, ShapeId,
};

/// Function that queries one shape. Returns its answer, with a number by which the answers of all shapes are sorted.
type One<'a, A> = &'a dyn Fn(ShapeId, &Shape, &Transform) -> Option<(f32, A)>;

/// Runs a query by `all`, `first`, `any` and `bodies`, and compares the results with the answers of all single shapes.
fn check<Q: QueryKind>(populated: &Populated, filter: QueryFilter<'_>, question: &Q, one: One<'_, Q::Answer>)
where
    Q::Answer: Copy + PartialEq + core::fmt::Debug,
{
    let odd = |id: ShapeId| (id.body.to_bits() + u64::from(id.shape)) % 5 != 3;
    let found = populated.shapes(&filter).filter(|(id, ..)| odd(*id));
    let mut expected: Vec<(f32, ShapeId, Q::Answer)> = found
        .filter_map(|(id, shape, frame)| one(id, &shape, &frame).map(|(rank, answer)| (rank, id, answer)))
        .collect();
    let index = |id: &ShapeId| (id.body.to_bits() as u32, id.shape);
    expected.sort_by(|a, b| (a.0, index(&a.1)).partial_cmp(&(b.0, index(&b.1))).expect("no rank is NaN"));
    let mut bodies: Vec<BodyId> = expected.iter().map(|(_, id, _)| id.body).collect();
    bodies.sort_by_key(|id| id.to_bits() as u32);
    bodies.dedup();

    let accept = |body: BodyId, shape: u32| odd(ShapeId { body, shape });
    let query = populated.world.query().filter(filter).accept(accept);
    let answers: Vec<Q::Answer> = expected.iter().map(|(.., answer)| *answer).collect();
    let mut all = Vec::new();
    query.all(question, &mut all);
    assert_eq!(all, answers);
    assert_eq!(query.first(question), answers.first().copied());
    assert_eq!(query.any(question), !answers.is_empty());
    let mut found = Vec::new();
    query.bodies(question, &mut found);
    assert_eq!(found, bodies);
}

/// Runs queries in random worlds, with and without a filter.
fn in_random_worlds(seed: u64, mut ask: impl FnMut(&Populated, QueryFilter<'_>, &mut Random)) {
    let mut random = Random::new(seed);
    for case in 0..cases(100_000).div_ceil(50) {
        let populated = Populated::new(2 + case as usize % 30, 3.0, &mut random);
        let except = [populated.bodies[0].0, populated.bodies[populated.bodies.len() / 2].0];
        for turn in 0..50 {
            let filter = if turn % 3 == 0 { QueryFilter::default() } else { filter(&except, &mut random) };
            ask(&populated, filter, &mut random);
        }
    }
}

#[test]
fn rays_match_queries_of_every_shape() {
    let mut hits = 0;
    in_random_worlds(401, |populated, filter, random| {
        let ray = Ray { origin: random.in_cube() * 3.5, direction: random.in_cube() * 8.0 };
        check(populated, filter, &ray, &|ShapeId { body, shape: number }, shape, frame| {
            let hit = shape.cast_ray(frame, &ray)?;
            let start = shape.nearest_surface(frame, ray.origin);
            let start = (hit.fraction == 0.0 && start.distance <= 0.0)
                .then_some(Penetration { depth: -start.distance, direction: start.normal });
            let (fraction, point, normal) = (hit.fraction, hit.point, hit.normal);
            Some((fraction, BodyHit { body, shape: number, fraction, point, normal, start }))
        });
        hits += u32::from(populated.world.query().any(&ray));
    });
    assert!(hits > cases(100_000) / 4, "{hits}");
}

#[test]
fn points_match_queries_of_every_shape() {
    in_random_worlds(402, |populated, filter, random| {
        let point = random.in_cube() * 4.0;
        check(populated, filter, &ContainsPoint(point), &|id, shape, frame| {
            (shape.signed_distance(frame, point).0 <= 0.0).then_some((0.0, id))
        });
        let near = NearestTo { point, within: random.range(0.0, 3.0) };
        check(populated, filter, &near, &|ShapeId { body, shape: number }, shape, frame| {
            let SurfacePoint { point, normal, distance } = shape.nearest_surface(frame, point);
            let answer = BodySurface { body, shape: number, point, normal, distance };
            (distance <= near.within).then_some((distance, answer))
        });
    });
}

#[test]
fn probes_match_queries_of_every_shape() {
    in_random_worlds(403, |populated, filter, random| {
        let probe = Probe::new(shape(random.index(KINDS), random), frame(3.5, random));
        let way = |shape: &Shape, frame: &Transform| {
            let gap = gap(shape, frame, &probe.shape, &probe.world_from_shape)?;
            (gap.distance <= 0.0).then_some(gap)
        };
        check(populated, filter, &OverlapWith(probe.clone()), &|id, shape, frame| {
            way(shape, frame).map(|_| (0.0, id))
        });
        check(
            populated,
            filter,
            &PenetrationOf(probe.clone()),
            &|ShapeId { body, shape: number }, shape, frame| {
                let (depth, direction) = way(shape, frame).map(|gap| (-gap.distance, gap.normal))?;
                Some((-depth, BodyPenetration { body, shape: number, depth, direction }))
            },
        );
        let near = NearestToShape { probe: probe.clone(), within: random.range(0.0, 2.0) };
        check(populated, filter, &near, &|ShapeId { body, shape: number }, shape, frame| {
            let found = gap(shape, frame, &probe.shape, &probe.world_from_shape)?;
            let (point, normal, distance) = (found.on_a, found.normal, found.distance);
            let answer = BodySurface { body, shape: number, point, normal, distance };
            (distance <= near.within).then_some((distance, answer))
        });
        let cast = ShapeCast { probe: probe.clone(), translation: random.in_cube() * 5.0 };
        check(populated, filter, &cast, &|ShapeId { body, shape: number }, shape, frame| {
            let (from, way) = (&probe.world_from_shape, cast.translation);
            let hit = cast_shape(&probe.shape, from, way, shape, frame)?;
            let found = gap(shape, frame, &probe.shape, from)?;
            let start = (found.distance <= 0.0)
                .then_some(Penetration { depth: -found.distance, direction: found.normal });
            let normal = if start.is_some() { -way / way.length() } else { hit.normal };
            let (fraction, point) = (hit.fraction, hit.point);
            Some((fraction, BodyHit { body, shape: number, fraction, point, normal, start }))
        });
    });
}
