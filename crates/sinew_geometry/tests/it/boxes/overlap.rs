//! Overlaps of boxes with boxes, balls and capsules.

use super::oracle::WideBox;
use super::random_pairs::{pair, place};
use crate::cases::{cases, half_extents};
use crate::wide::{Wide, add, length, wide};
use sinew_geometry::boxes::{Capsule, Cuboid, Overlap, Penetration, Sphere};
use sinew_geometry::{Aabb, Obb};
use sinew_math::{Random, Rotation, Transform, Vec3};

/// Checks the results for a pair against `meets(shift, grow)`, which is true if the shapes, one moved by `shift` and
/// enlarged by `grow`, have a point in common.
pub fn check(
    found: Option<Penetration>,
    meets: impl Fn(Wide, f64) -> bool,
    [fine, coarse]: [f64; 2],
    random: &mut Random,
) -> Result<(), String> {
    let still = [0.0; 3];
    let Some(Penetration { depth, direction }) = found else {
        return if meets(still, -fine) { Err("they overlap".into()) } else { Ok(()) };
    };
    if !meets(still, coarse) {
        return Err("they are apart".into());
    }
    let (depth, n) = (f64::from(depth), wide(direction));
    if depth.is_nan() || depth < 0.0 || (length(n) - 1.0).abs() > 1e-5 {
        return Err(format!("{depth} along {direction} is no way"));
    }
    if meets(add(still, n, depth + 2.0 * fine), -fine) {
        return Err(format!("{depth} along {direction} does not part them"));
    }
    // No other way out is shorter.
    for k in 0..6 {
        let other = if k == 0 {
            direction
        } else if k < 3 {
            direction + random.in_cube() * 0.3
        } else {
            random.direction()
        };
        let shorter = (depth - 2.0 * coarse).max(0.0);
        let other = wide(other / other.length());
        if !meets(add(still, other, shorter), coarse) {
            return Err(format!("{shorter} along {other:?} parts them, not {depth} along {direction} only"));
        }
    }
    Ok(())
}

/// Returns two error bounds for a pair of boxes, metres. The first covers the rounding of their sizes, their distance,
/// and the centre of an aligned box; the second also the uncertain cross product of nearly parallel edges.
pub fn tolerances(a: &WideBox, b: &WideBox, of_center: f64) -> [f64; 2] {
    let scale = a.size() + b.size() + length(add(a.center, b.center, -1.0));
    let fine = 1e-6 * scale + of_center + 1e-12;
    let sine = a.least_sine(b);
    [fine, fine + (4.0 * fine / sine).min(sine * scale)]
}

fn check_boxes<A: Cuboid + Overlap<B>, B: Cuboid + Overlap<A>>(
    (a, wide_a): (&A, &WideBox),
    (b, wide_b): (&B, &WideBox),
    of_center: f64,
    random: &mut Random,
) -> bool {
    let tolerances = tolerances(wide_a, wide_b, of_center);
    let (found, back) = (a.penetration(b), b.penetration(a));
    let said = |what: String| panic!("{what}: {wide_a:?} {wide_b:?}");
    check(found, |shift, grow| wide_a.meets(&wide_b.moved(shift), grow), tolerances, random)
        .unwrap_or_else(said);
    check(back, |shift, grow| wide_b.meets(&wide_a.moved(shift), grow), tolerances, random)
        .unwrap_or_else(said);
    assert_eq!((found.is_some(), back.is_some()), (a.overlaps(b), b.overlaps(a)));
    if let (Some(found), Some(back)) = (found, back) {
        let apart = f64::from((found.depth - back.depth).abs());
        assert!(apart <= tolerances[1], "{found:?} {back:?} {wide_a:?} {wide_b:?}");
    }
    found.is_some()
}

#[test]
fn oriented_boxes_match_enumeration() {
    let mut random = Random::new(51);
    let mut overlapping = 0;
    for _ in 0..cases(100_000) {
        let [a, b] = pair(&mut random);
        let met = check_boxes((&a, &WideBox::from(&a)), (&b, &WideBox::from(&b)), 0.0, &mut random);
        overlapping += u32::from(met);
    }
    let share = overlapping * 100 / cases(100_000);
    assert!((20..80).contains(&share), "{share} % overlap");
}

#[test]
fn aligned_and_oriented_boxes_match_enumeration() {
    let mut random = Random::new(52);
    for _ in 0..cases(100_000) {
        let [a, b] = pair(&mut random);
        let frame = a.to_transform().inverse();
        let aligned = Aabb::around(frame.point(a.center) + place(&mut random), a.half_extents);
        let rotation = frame.rotation * b.rotation;
        let turned =
            Obb::new(aligned.center() + frame.rotation * (b.center - a.center), rotation, b.half_extents);
        // Half the spacing of numbers along each axis.
        let of_center = length(wide(aligned.center())) * 1e-7;
        check_boxes(
            (&aligned, &WideBox::from(&aligned)),
            (&turned, &WideBox::from(&turned)),
            of_center,
            &mut random,
        );
    }
}

#[test]
fn aligned_boxes_match_enumeration() {
    let mut random = Random::new(53);
    for _ in 0..cases(100_000) {
        let [a, b] = pair(&mut random).map(|obb| Aabb::around(obb.center, obb.half_extents));
        check_boxes((&a, &WideBox::from(&a)), (&b, &WideBox::from(&b)), 0.0, &mut random);
    }
}

/// Returns the two ends of a capsule's core near a box; equal for a ball.
fn core_about(obb: &Obb, random: &mut Random) -> [Vec3; 2] {
    let reach = obb.half_extents.length() + 1e-3;
    let far = if random.index(6) == 0 { 100.0 } else { 1.0 };
    let first = obb.center + random.in_cube() * (1.5 * reach * far);
    let second = match random.index(5) {
        0 => first,
        1 => first + obb.rotation * Vec3::X * reach,
        2 => first + obb.rotation * (Vec3::X + random.in_cube() * 0.01) * reach,
        _ => obb.center + random.in_cube() * (1.5 * reach * far),
    };
    [first, second]
}

fn radius(reach: f32, random: &mut Random) -> f32 {
    if random.index(4) == 0 { 0.0 } else { reach * random.range(0.05, 1.0) }
}

fn check_round(
    wide_box: &WideBox,
    ends: [Vec3; 2],
    radius: f32,
    found: Option<Penetration>,
    random: &mut Random,
) {
    let wide_ends = ends.map(wide);
    let meets = |shift: Wide, grow: f64| {
        let grown = f64::from(radius) + grow;
        grown >= 0.0 && wide_box.distance_to_segment(wide_ends.map(|p| add(p, shift, 1.0))) <= grown
    };
    let distance =
        length(add(wide_ends[0], wide_box.center, -1.0)) + length(add(wide_ends[1], wide_box.center, -1.0));
    let fine = 2e-6 * (wide_box.size() + distance + f64::from(radius)) + 1e-12;
    check(found, meets, [fine, 60.0 * fine], random)
        .unwrap_or_else(|what| panic!("{what}: {wide_box:?} {ends:?} radius {radius}"));
}

#[test]
fn balls_match_the_distance_to_the_box() {
    let mut random = Random::new(54);
    for _ in 0..cases(100_000) {
        let [obb, _] = pair(&mut random);
        let [center, _] = core_about(&obb, &mut random);
        let ball = Sphere::new(center, radius(obb.half_extents.length(), &mut random));
        let found = obb.penetration(&ball);
        check_round(&WideBox::from(&obb), [center; 2], ball.radius, found, &mut random);
        assert_eq!(obb.overlaps(&ball), found.is_some());
        let reversed = ball.penetration(&obb).map(|way| Penetration { direction: -way.direction, ..way });
        assert_eq!(reversed, found);
        let aligned = Aabb::around(obb.center, obb.half_extents);
        check_round(
            &WideBox::from(&aligned),
            [center; 2],
            ball.radius,
            aligned.penetration(&ball),
            &mut random,
        );
        assert_eq!(ball.overlaps(&aligned), aligned.penetration(&ball).is_some());
    }
}

#[test]
fn capsules_match_a_search_along_their_cores() {
    let mut random = Random::new(55);
    for _ in 0..cases(100_000) {
        let [obb, _] = pair(&mut random);
        let ends = core_about(&obb, &mut random);
        let capsule = Capsule::new(ends, radius(obb.half_extents.length(), &mut random));
        let found = obb.penetration(&capsule);
        check_round(&WideBox::from(&obb), ends, capsule.radius, found, &mut random);
        assert_eq!(obb.overlaps(&capsule), found.is_some());
        let reversed = capsule.penetration(&obb).map(|way| Penetration { direction: -way.direction, ..way });
        assert_eq!(reversed, found);
        let aligned = Aabb::around(obb.center, obb.half_extents);
        check_round(
            &WideBox::from(&aligned),
            ends,
            capsule.radius,
            aligned.penetration(&capsule),
            &mut random,
        );
        assert_eq!(capsule.overlaps(&aligned), aligned.penetration(&capsule).is_some());
    }
}

/// Boxes that touch overlap, at depth 0.
#[test]
fn touching_boxes_overlap() {
    let unit = Obb::new(Vec3::ZERO, Rotation::IDENTITY, Vec3::ONE);
    let beside = Obb::new(Vec3::new(2.0, 0.0, 0.0), Rotation::IDENTITY, Vec3::ONE);
    let way = unit.penetration(&beside).expect("touching boxes overlap");
    assert_eq!((way.depth, way.direction), (0.0, Vec3::X));
    let corner = Aabb::new(Vec3::ONE, Vec3::splat(3.0));
    assert!(unit.overlaps(&corner) && corner.overlaps(&unit));
    assert_eq!(Aabb::new(-Vec3::ONE, Vec3::ONE).penetration(&corner).map(|way| way.depth), Some(0.0));
    assert!(unit.overlaps(&Sphere::new(Vec3::new(0.0, 3.0, 0.0), 2.0)));
    assert!(!unit.overlaps(&Sphere::new(Vec3::new(0.0, 3.0f32.next_up(), 0.0), 2.0)));
    let lying = Capsule::new([Vec3::new(-5.0, 1.5, 0.0), Vec3::new(5.0, 1.5, 0.0)], 0.5);
    let way = unit.penetration(&lying).expect("touching boxes overlap");
    assert_eq!((way.depth, way.direction), (0.0, Vec3::Y));
    // Edge on edge, at right angles, with each box resting on its edge.
    let eighth = Rotation::from_axis_angle(Vec3::X, core::f32::consts::FRAC_PI_4);
    let above = Rotation::from_axis_angle(Vec3::Z, core::f32::consts::FRAC_PI_4);
    let height = core::f32::consts::SQRT_2;
    let (low, high) = (Obb::new(Vec3::ZERO, eighth, Vec3::ONE), |y| Obb::new(Vec3::Y * y, above, Vec3::ONE));
    assert!(low.overlaps(&high(2.0 * height)));
    assert!(!low.overlaps(&high(2.0 * height + 2e-5)));
    let way = low.penetration(&high(2.0 * height - 0.1)).expect("the boxes overlap");
    assert!((way.depth - 0.1).abs() < 2e-6 && (way.direction - Vec3::Y).length() < 1e-5, "{way:?}");
}

/// Boxes that are rectangles, segments or points.
#[test]
fn flat_boxes_overlap_exactly() {
    let point = |p: Vec3| Obb::new(p, Rotation::from_scaled_axis(Vec3::new(0.3, 0.2, 0.9)), Vec3::ZERO);
    assert!(point(Vec3::ONE).overlaps(&point(Vec3::ONE)));
    assert!(!point(Vec3::ONE).overlaps(&point(Vec3::new(1.0, 1.0, 1.001))));
    let turned = Rotation::from_axis_angle(Vec3::Z, core::f32::consts::FRAC_PI_4);
    let along_x = Obb::new(Vec3::ZERO, Rotation::IDENTITY, Vec3::X);
    let diagonal = |z: f32| Obb::new(Vec3::new(0.5, 0.0, z), turned, Vec3::X);
    assert_eq!(along_x.penetration(&diagonal(0.0)).map(|way| way.depth), Some(0.0));
    assert!(!along_x.overlaps(&diagonal(1e-3)));
    let sheet = Obb::new(Vec3::ZERO, Rotation::IDENTITY, Vec3::new(1.0, 0.0, 1.0));
    let pin = Obb::new(Vec3::new(0.2, 0.3, 0.0), Rotation::IDENTITY, Vec3::new(0.0, 0.5, 0.0));
    let way = sheet.penetration(&pin).expect("the pin goes through");
    assert!((way.depth - 0.2).abs() < 1e-6 && (way.direction - Vec3::Y).length() < 1e-6, "{way:?}");
}

/// Moving both boxes changes neither the overlap test nor the depth.
#[test]
fn overlap_is_invariant_under_common_motion() {
    let mut random = Random::new(56);
    let mut compared = 0;
    for _ in 0..cases(100_000) {
        let half = [half_extents(1.0, &mut random), half_extents(1.0, &mut random)];
        let [a, b] = half.map(|half| Obb::new(random.in_cube(), random.rotation(), half));
        let motion = Transform::new(random.in_cube() * 3.0, random.rotation());
        let [c, d] = [a, b].map(|obb| Obb::from_transform(&(motion * obb.to_transform()), obb.half_extents));
        if let (Some(here), Some(there)) = (a.penetration(&b), c.penetration(&d)) {
            let [_, coarse] = tolerances(&WideBox::from(&a), &WideBox::from(&b), 0.0);
            assert!(
                f64::from((here.depth - there.depth).abs()) <= 2.0 * coarse,
                "{a:?} {b:?}: overlaps {here:?} and {there:?}"
            );
            compared += 1;
        }
    }
    assert!(compared * 4 > cases(100_000), "{compared}");
}
