//! Casts of shapes, compared with the gaps along their path.

use super::gaps::any_pair;
use crate::cases::cases;
use crate::collide::all_pairs;
use sinew_geometry::Shape;
use sinew_geometry::convex::{cast_shape, gap};
use sinew_math::{Random, Transform, Vec3};

#[test]
fn casts_stop_where_the_gap_becomes_zero() {
    let mut random = Random::new(21);
    for (ka, kb) in all_pairs() {
        let (mut hits, mut starts) = (0, 0);
        for case in 0..cases(100_000) {
            // A half-space, if there is one, is the target.
            let (b, a) = any_pair(ka, kb, &mut random);
            let size = a.size() + b.size();
            let motion = (random.in_cube() + (b.frame.translation - a.frame.translation) / size) * size;
            let along = |t: f32| {
                let frame = Transform::new(a.frame.translation + motion * t, a.frame.rotation);
                gap(&a.shape, &frame, &b.shape, &b.frame).expect("one shape is bounded and both are finite")
            };
            let hit = cast_shape(&a.shape, &a.frame, motion, &b.shape, &b.frame);
            let context = || format!("{ka:?} {kb:?} case {case}: {hit:?} along {motion}\n{a:?}\n{b:?}");
            // Touch tolerance, and rounding of positions on the path.
            let close = 2e-5 * size + 1e-6 * (a.frame.translation.length() + b.frame.translation.length());
            let before = hit.map_or(1.0, |hit| hit.fraction);
            if along(0.0).distance <= 0.0 {
                let hit = hit.expect("the shapes overlap at the start");
                assert_eq!(hit.fraction, 0.0, "{}", context());
                assert_eq!(hit.normal, -along(0.0).normal, "{}", context());
                starts += 1;
                continue;
            }
            for k in 0..12 {
                let t = before * (k as f32 / 12.0);
                assert!(along(t).distance > -close, "overlap at {t}: {}", context());
            }
            if let Some(hit) = hit {
                hits += 1;
                assert!(along(hit.fraction).distance.abs() <= close, "{}", context());
                assert!(hit.normal.dot(motion) <= 1e-3 * motion.length(), "{}", context());
                for shape in [&a, &b] {
                    let shift = if core::ptr::eq(shape, &a) { motion * hit.fraction } else { Vec3::ZERO };
                    let (off, _) = shape.shape.signed_distance(&shape.frame, hit.point - shift);
                    assert!(off.abs() <= close, "off by {off}, bound {close}, size {size}: {}", context());
                }
            }
        }
        assert!(hits > cases(100_000) / 10, "{ka:?} {kb:?}: only {hits} hits");
        assert!(starts > cases(100_000) / 20, "{ka:?} {kb:?}: only {starts} overlaps at the start");
    }
}

#[test]
fn tilted_cylinder_lands_on_its_rim() {
    let barrel = Shape::Cylinder { half_height: 0.5, radius: 0.3 };
    let lean = sinew_math::Rotation::from_axis_angle(Vec3::Z, 0.2);
    let start = Transform::new(Vec3::new(0.0, 2.0, 0.0), lean);
    let motion = Vec3::new(0.0, -4.0, 0.0);
    let ground = Transform::IDENTITY;
    let hit =
        cast_shape(&barrel, &start, motion, &Shape::HalfSpace, &ground).expect("the barrel hits the ground");
    let (sin, cos) = (sinew_math::trig::sin(0.2), sinew_math::trig::cos(0.2));
    let height = 0.5 * cos + 0.3 * sin;
    assert!((hit.fraction - (2.0 - height) / 4.0).abs() < 1e-5, "{hit:?}");
    assert!((hit.normal - Vec3::Y).length() < 1e-6);
    assert!((hit.point - Vec3::new(0.5 * sin - 0.3 * cos, 0.0, 0.0)).length() < 1e-4, "{hit:?}");
    assert_eq!(cast_shape(&barrel, &start, -motion, &Shape::HalfSpace, &ground), None);
    let nan = Vec3::new(f32::NAN, 0.0, 0.0);
    assert_eq!(cast_shape(&barrel, &start, nan, &Shape::HalfSpace, &ground), None);
}
