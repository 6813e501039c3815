//! Ray casts against boxes.

use super::oracle::WideBox;
use super::random_pairs::{obb, place};
use crate::cases::{cases, half_extents};
use crate::wide::{add, length, wide};
use sinew_geometry::boxes::Cuboid;
use sinew_geometry::ray::Ray;
use sinew_geometry::{Aabb, Obb};
use sinew_math::{Random, Rotation, Vec3};

/// Returns a ray toward the box, past it, along an axis, or from inside.
fn ray_about(obb: &Obb, random: &mut Random) -> Ray {
    let reach = obb.half_extents.length() + 1e-3;
    let in_box = |q: Vec3| obb.center + obb.rotation * (obb.half_extents * q);
    let from = match random.index(6) {
        0 => in_box(random.in_cube()),
        1 => obb.center + random.direction() * (reach * 300.0),
        _ => obb.center + random.direction() * (reach * random.range(0.5, 4.0)),
    };
    let to = match random.index(5) {
        0 => from + obb.rotation * [Vec3::X, Vec3::Y, -Vec3::Z][random.index(3)] * (5.0 * reach),
        1 => obb.center + random.in_cube() * (3.0 * reach),
        _ => in_box(random.in_cube()),
    };
    Ray { origin: from, direction: (to - from) * random.range(0.3, 2.0) }
}

/// Returns the fraction of the segment before it enters the box, by bisection of the remaining distance; `None` if it
/// misses.
fn entry(wide_box: &WideBox, ray: &Ray) -> Option<f64> {
    let (origin, along) = (wide(ray.origin), wide(ray.direction));
    let up_to = |t: f64| wide_box.distance_to_segment([origin, add(origin, along, t)]);
    if up_to(1.0) > 1e-9 * wide_box.size() {
        return None;
    }
    let (mut lo, mut hi) = (0.0, 1.0);
    for _ in 0..30 {
        let middle = 0.5 * (lo + hi);
        if up_to(middle) > 1e-9 * wide_box.size() { lo = middle } else { hi = middle }
    }
    Some(hi)
}

fn check(cuboid: &impl Cuboid, wide_box: &WideBox, of_center: f64, ray: &Ray, case: u32) {
    let said = cuboid.cast_ray(ray);
    let (origin, along) = (wide(ray.origin), wide(ray.direction));
    let from_center = length(add(origin, wide_box.center, -1.0));
    let tolerance = 1e-6 * (wide_box.size() + from_center + length(along)) + of_center;
    let near = |t: f64| wide_box.signed_distance(add(origin, along, t)).abs();
    let Some(hit) = said else {
        // Because of rounding a grazing ray may pass; it then also misses a box that is smaller by that rounding.
        let smaller = WideBox { half: wide_box.half.map(|h| h - tolerance), ..*wide_box };
        let missed = smaller.half.iter().any(|h| *h < 0.0) || entry(&smaller, ray).is_none();
        assert!(missed, "case {case}: {ray:?} enters {wide_box:?}");
        return;
    };
    assert!((hit.normal.length() - 1.0).abs() < 1e-5, "case {case}: {hit:?}");
    if hit.fraction == 0.0 {
        assert!(
            wide_box.signed_distance(origin) <= tolerance,
            "case {case}: {ray:?} starts outside {wide_box:?}"
        );
        // Without a direction, the normal is that of the surface.
        let still = ray.direction == Vec3::ZERO;
        assert!(
            still || (hit.normal + ray.direction / ray.direction.length()).length() < 1e-5,
            "case {case}: {hit:?}"
        );
        return;
    }
    let t = f64::from(hit.fraction);
    assert!(near(t) <= tolerance, "case {case}: {hit:?} is {} off {wide_box:?}", near(t));
    assert!(hit.normal.dot(ray.direction) <= 0.0, "case {case}: {hit:?}");
    // The normal's face contains the point.
    let [point, normal] =
        [wide_box.local(add(origin, along, t)), wide_box.local(add(wide_box.center, wide(hit.normal), 1.0))];
    let face = (0..3).find(|k| normal[*k].abs() > 0.999_99).expect("a face's normal");
    let off = (point[face] * normal[face].signum() - wide_box.half[face]).abs();
    assert!(off <= tolerance, "case {case}: {hit:?} is {off} off its face");
    // No part of the ray before the hit is inside by more than rounding.
    let smaller = WideBox { half: wide_box.half.map(|h| (h - 2.0 * tolerance).max(0.0)), ..*wide_box };
    if let Some(first) = entry(&smaller, ray).filter(|_| smaller.half.iter().all(|h| *h > 0.0)) {
        assert!(t <= first + 1e-6 + of_center / length(along), "case {case}: {hit:?}, entered at {first}");
    }
}

#[test]
fn ray_hits_match_bisection() {
    let mut random = Random::new(61);
    let mut hits = 0;
    for case in 0..cases(100_000) {
        let obb = obb(&mut random);
        let ray = ray_about(&obb, &mut random);
        check(&obb, &WideBox::from(&obb), 0.0, &ray, case);
        hits += u32::from(obb.cast_ray(&ray).is_some());
        let aabb = Aabb::around(place(&mut random), half_extents(1.0, &mut random));
        let ray = ray_about(&Obb::from(aabb), &mut random);
        // Half the spacing of numbers along each axis.
        let of_center = length(wide(aabb.center())) * 1e-7;
        check(&aabb, &WideBox::from(&aabb), of_center, &ray, case);
    }
    let share = hits * 100 / cases(100_000);
    assert!((20..90).contains(&share), "{share} % of the rays hit");
}

/// The half-line continues beyond the end of the segment.
#[test]
fn half_line_hits_a_box_beyond_the_segment() {
    let obb = Obb::new(Vec3::new(10.0, 0.0, 0.0), Rotation::IDENTITY, Vec3::ONE);
    let ray = Ray::between(Vec3::ZERO, Vec3::X);
    assert_eq!(obb.cast_ray(&ray), None);
    let hit = obb.cast_half_line(&ray).expect("9 m ahead");
    assert_eq!((hit.fraction, hit.point, hit.normal), (9.0, Vec3::new(9.0, 0.0, 0.0), Vec3::NEG_X));
    let away = Ray { origin: Vec3::ZERO, direction: Vec3::NEG_X };
    assert_eq!(obb.cast_half_line(&away), None);
    let touching = Ray::between(Vec3::ZERO, Vec3::new(9.0, 0.0, 0.0));
    assert_eq!(obb.cast_ray(&touching).map(|hit| hit.fraction), Some(1.0));
}

/// Flat boxes stop rays too; a ray in the plane of one hits its edge.
#[test]
fn rays_hit_flat_boxes() {
    let sheet = Obb::new(Vec3::ZERO, Rotation::IDENTITY, Vec3::new(1.0, 0.0, 1.0));
    let down = Ray::between(Vec3::new(0.5, 2.0, 0.5), Vec3::new(0.5, -2.0, 0.5));
    let hit = sheet.cast_ray(&down).expect("the ray passes through the sheet");
    assert_eq!((hit.fraction, hit.normal), (0.5, Vec3::Y));
    let level = Ray::between(Vec3::new(-3.0, 0.0, 0.0), Vec3::new(3.0, 0.0, 0.0));
    let hit = sheet.cast_ray(&level).expect("the ray in the plane hits the rim");
    assert_eq!((hit.point.x, hit.normal), (-1.0, Vec3::NEG_X));
    let start = Ray { origin: Vec3::ZERO, direction: Vec3::ZERO };
    assert_eq!(sheet.cast_ray(&start).map(|hit| (hit.fraction, hit.normal)), Some((0.0, Vec3::Y)));
    let nowhere = Ray { origin: Vec3::new(f32::NAN, 0.0, 0.0), direction: Vec3::X };
    assert_eq!(sheet.cast_ray(&nowhere), None);
}
