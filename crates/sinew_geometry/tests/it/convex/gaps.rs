//! Gaps compared with bounds: points on both surfaces bound the distance from above, and the support functions along
//! the normal bound it from below. For overlaps, tested directions bound the depth from above.

use crate::cases::cases;
use crate::collide::{
    FINITE, Kind, Placed, all_pairs, gap as apart_along, random_rotation, random_shape, unit, wide,
};
use sinew_geometry::Shape;
use sinew_geometry::convex::{Gap, gap, overlaps};
use sinew_math::{Random, Transform, Vec3};

fn ask(a: &Placed, b: &Placed) -> Gap {
    gap(&a.shape, &a.frame, &b.shape, &b.frame).expect("one of the two shapes is bounded")
}

/// Returns the shape with some sides randomly scaled down, so that it is up to a thousand times as long as thick.
fn stretched(shape: Shape, random: &mut Random) -> Shape {
    let mut share = || [1.0, 1.0, 0.1, 0.001][random.index(4)];
    match shape {
        Shape::Box { half_extents: h } => {
            Shape::Box { half_extents: h * Vec3::new(share(), share(), share()) }
        }
        Shape::Capsule { half_height, radius } => Shape::Capsule { half_height, radius: radius * share() },
        Shape::Cylinder { half_height, radius } => {
            Shape::Cylinder { half_height: half_height * share(), radius: radius * share() }
        }
        Shape::Cone { half_height, radius } => {
            Shape::Cone { half_height: half_height * share(), radius: radius * share() }
        }
        other => other,
    }
}

/// Returns shapes of 1 mm to 100 m, of similar or different size; apart, touching, or overlapping slightly or deeply.
pub fn any_pair(ka: Kind, kb: Kind, random: &mut Random) -> (Placed, Placed) {
    const SCALES: [f32; 5] = [0.001, 0.02, 1.0, 10.0, 100.0];
    let scale_a = SCALES[random.index(5)];
    let scale_b = if random.index(2) == 0 { scale_a } else { SCALES[random.index(5)] };
    let common = random.rotation();
    let place = |kind: Kind, scale: f32, random: &mut Random| Placed {
        shape: stretched(random_shape(kind, scale, random), random),
        frame: Transform::new(random.in_cube() * scale, common * random_rotation(random)),
    };
    let (a, mut b) = (place(ka, scale_a, random), place(kb, scale_b, random));
    let reach = a.size() + b.size();
    b.frame.translation = a.frame.translation + random.direction() * (reach * random.range(0.0, 1.2));
    if random.index(2) == 0 {
        // Moves them until they nearly touch.
        let now = ask(&a, &b);
        let wanted = reach * [0.0, 1e-4, -1e-4, 0.01, -0.01][random.index(5)];
        b.frame.translation += now.normal * (wanted - now.distance);
    }
    (a, b)
}

/// Checks a gap; returns its largest error as a share of the sizes.
fn check(a: &Placed, b: &Placed, found: &Gap, random: &mut Random) -> Result<f64, String> {
    let size = f64::from(a.size() + b.size()) + f64::from(found.distance).abs();
    // Positions are exact only to rounding.
    let places = f64::from(a.frame.translation.length() + b.frame.translation.length());
    let fine = 2e-6 * size + 2e-7 * places;
    let distance = f64::from(found.distance);
    if (found.normal.length() - 1.0).abs() > 1e-5 {
        return Err("the normal is not a unit vector".into());
    }
    let Some(n) = unit(wide(found.normal)) else { return Err("no normal".into()) };
    let mut worst = (apart_along(a, b, n) - distance).abs();
    if worst > fine {
        return Err(format!("the gap along the normal is {}", apart_along(a, b, n)));
    }
    let way = (found.on_b - found.on_a) - found.normal * found.distance;
    if f64::from(way.length()) > fine {
        return Err("the points are not opposite each other along the normal".into());
    }
    if distance > 0.0 {
        for (of, point) in [(a, found.on_a), (b, found.on_b)] {
            let outside = f64::from(of.shape.signed_distance(&of.frame, point).0);
            worst = worst.max(outside);
            if outside > fine {
                return Err(format!("a point is {outside} off its shape"));
            }
        }
        return Ok(worst / size);
    }
    if a.shape == Shape::HalfSpace {
        return Ok(worst / size);
    }
    // No other way out is shorter.
    for k in 0..40 {
        let near = found.normal + random.in_cube() * [0.01, 0.1, 0.5][k % 3];
        let other = if k < 12 { near } else { random.direction() };
        let Some(m) = unit(wide(other)) else { continue };
        let along = apart_along(a, b, m);
        worst = worst.max(along - distance);
        if along > distance + fine {
            return Err(format!("the gap along {m:?} is larger: {along}"));
        }
    }
    Ok(worst / size)
}

#[test]
fn gaps_are_bounded_by_points_and_planes() {
    let mut random = Random::new(11);
    for (ka, kb) in all_pairs() {
        let (mut worst, mut deep) = (0.0f64, 0);
        for case in 0..cases(100_000) {
            let (a, b) = any_pair(ka, kb, &mut random);
            let found = ask(&a, &b);
            match check(&a, &b, &found, &mut random) {
                Ok(off) => worst = worst.max(off),
                Err(what) => panic!("{ka:?} {kb:?} case {case}: {what}: {found:?}\n{a:?}\n{b:?}"),
            }
            deep += u32::from(found.distance <= 0.0);
            assert_eq!(overlaps(&a.shape, &a.frame, &b.shape, &b.frame), found.distance <= 0.0);
        }
        println!("{ka:?} {kb:?}: error {worst:.1e} of the sizes, {deep} overlaps");
        assert!(deep > cases(10_000), "{ka:?} {kb:?}: only {deep} overlaps");
    }
}

/// Exchanged shapes have the same gap from the other side; a moved pair has the same gap, moved.
#[test]
fn gaps_are_invariant_under_exchange_and_motion() {
    let mut random = Random::new(12);
    for (ka, kb) in all_pairs() {
        for case in 0..cases(100_000) {
            let (a, b) = any_pair(ka, kb, &mut random);
            let (found, swapped) = (ask(&a, &b), ask(&b, &a));
            let scale = a.size().max(b.size());
            let motion = Transform::new(random.in_cube() * scale, random.rotation());
            let moved = |p: &Placed| Placed { shape: p.shape.clone(), frame: motion * p.frame };
            let turned = ask(&moved(&a), &moved(&b));
            let places = a.frame.translation.length() + b.frame.translation.length() + scale;
            let size = a.size() + b.size() + found.distance.abs() + 0.5 * places;
            let context =
                || format!("{ka:?} {kb:?} case {case}: {found:?} {swapped:?} {turned:?}\n{a:?}\n{b:?}");
            // Nearly concentric round shapes are equally deep in many directions, so the best may be missed.
            let slack = if found.distance < 0.0 { 5e-5 * size } else { 5e-6 * size };
            assert!((found.distance - swapped.distance).abs() < slack, "{}", context());
            assert!((found.distance - turned.distance).abs() < slack, "{}", context());
            if found.distance > 1e-3 * size {
                assert!((found.normal + swapped.normal).length() < 5e-4, "{}", context());
                let there = motion.rotation * found.normal;
                assert!((there - turned.normal).length() < 5e-3, "{}", context());
            }
        }
    }
}

/// Three methods give the same gap of two boxes: separating axes, GJK and EPA, and a search over directions.
#[test]
fn three_gap_methods_agree_for_boxes() {
    let mut random = Random::new(13);
    for case in 0..cases(100_000) {
        let (a, b) = any_pair(Kind::Box, Kind::Box, &mut random);
        let found = ask(&a, &b);
        let size = a.size() + b.size();
        let m = a.collide(&b, found.distance.max(0.0) + 0.01 * size);
        let context = || format!("case {case}: {found:?} {m:?}\n{a:?}\n{b:?}");
        assert!(m.count > 0, "{}", context());
        let by_axes = apart_along(&a, &b, unit(wide(m.normal)).expect("unit"));
        let distance = f64::from(found.distance);
        let thinnest = f64::from(a.shape.inner_radius().min(b.shape.inner_radius()));
        let preference = 0.06 * distance.abs() + 0.011 * thinnest + 2e-3 * f64::from(size);
        assert!(by_axes <= distance + 4e-6 * f64::from(size), "{}", context());
        // Boxes that are nearest at corners have no separating axis as good as their distance.
        assert!(by_axes >= distance - preference || distance > 0.0, "{}", context());
        if let Err(what) = check(&a, &b, &found, &mut random) {
            panic!("{what}: {}", context());
        }
    }
}

#[test]
fn gap_of_nan_is_none() {
    for kind in FINITE {
        let shape = random_shape(kind, 1.0, &mut Random::new(1));
        let nowhere = Transform::from_translation(Vec3::new(f32::NAN, 0.0, 0.0));
        for other in [&Shape::HalfSpace, &shape] {
            assert_eq!(gap(&shape, &nowhere, other, &Transform::IDENTITY), None);
            assert_eq!(gap(other, &Transform::IDENTITY, &shape, &nowhere), None);
            let [a, b] = [(&shape, nowhere), (other, Transform::IDENTITY)]
                .map(|(shape, frame)| Placed { shape: shape.clone(), frame });
            assert_eq!(a.collide(&b, 1.0).count, 0);
            assert_eq!(b.collide(&a, 1.0).count, 0);
        }
    }
    let plane = Transform::IDENTITY;
    assert_eq!(gap(&Shape::HalfSpace, &plane, &Shape::HalfSpace, &plane), None);
}
