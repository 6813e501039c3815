//! Queries with balls as probes: the expected results are computed from distances to the ball's centre, in `f64`.

use super::oracle::WideShape;
use super::random::{KINDS, frame, shape};
use crate::cases::cases;
use crate::wide::wide;
use sinew_math::Random;
use sinew_physics::*;

/// Tolerance, metres. Depths of deeply overlapping round shapes have an error of 1e-6 of the sizes.
const NEAR: f64 = 4e-6;

#[test]
fn ball_queries_follow_centre_distances() {
    let mut random = Random::new(410);
    let (mut overlaps, mut hits) = (0, 0);
    for case in 0..cases(100_000) {
        let shape = shape(case as usize % KINDS, &mut random);
        let at = frame(2.0, &mut random);
        let mut world = World::new(WorldDef::default());
        world.add_body(&BodyDef::fixed(shape.clone()).at(at.translation).turned(at.rotation));
        let query = world.query();
        let wide_shape = WideShape::new(&shape, &at);
        let radius = random.range(0.05, 0.6);
        let center = at.point(random.in_cube() * 1.6);
        let probe = Probe::at(Shape::Sphere { radius }, center);
        let gap = wide_shape.signed_distance(wide(center)) - f64::from(radius);

        let message = |what: &str| format!("case {case}: {what} of a ball of {radius} {gap} from {shape:?}");
        let way = query.first(&PenetrationOf(probe.clone()));
        assert_eq!(query.any(&OverlapWith(probe.clone())), way.is_some(), "{}", message("overlap"));
        match way {
            Some(way) => {
                overlaps += 1;
                assert!((gap + f64::from(way.depth)).abs() < NEAR, "{}: {way:?}", message("depth"));
                let out = wide_shape.signed_distance(wide(center + way.direction * way.depth));
                assert!(
                    (out - f64::from(radius)).abs() < NEAR,
                    "{}: the push-out ends {out} m from the surface",
                    message("way out")
                );
            }
            None => assert!(gap > -NEAR, "{}", message("no overlap")),
        }

        let near = query
            .first(&NearestToShape { probe: probe.clone(), within: 10.0 })
            .expect("the shape is within 10 m");
        assert!((f64::from(near.distance) - gap).abs() < NEAR, "{}: {near:?}", message("distance"));
        assert!(
            wide_shape.signed_distance(wide(near.point)).abs() < NEAR,
            "{}: {near:?}",
            message("surface")
        );

        let translation = (at.point(random.in_cube() * 0.8) - center) * random.range(0.3, 1.5);
        let along = |fraction: f64| {
            let way = wide(translation).map(|x| x * fraction);
            wide_shape.least_distance(wide(center), way) - f64::from(radius)
        };
        match query.first(&ShapeCast { probe, translation }) {
            Some(hit) if hit.start.is_some() => {
                assert!(gap < NEAR && hit.fraction == 0.0, "{}", message("start of the cast"));
            }
            Some(hit) => {
                hits += 1;
                let fraction = f64::from(hit.fraction);
                // The cast may stop early by the touch tolerance, 1e-5 of the smaller shape and 1e-7 of the motion.
                let there =
                    wide_shape.signed_distance(wide(center + translation * hit.fraction)) - f64::from(radius);
                assert!(there.abs() < 1.5e-5, "{}: {hit:?} is {there} m from touching", message("hit"));
                assert!(along(fraction) > -NEAR, "{}: {hit:?} is late", message("hit"));
                assert!(
                    wide_shape.signed_distance(wide(hit.point)).abs() < 1.5e-5,
                    "{}: {hit:?}",
                    message("place")
                );
            }
            None => assert!(along(1.0) > -NEAR, "{}: the cast along {translation} misses", message("cast")),
        }
    }
    assert!(overlaps > cases(100_000) / 20 && hits > cases(100_000) / 5, "{overlaps} overlaps, {hits} hits");
}
