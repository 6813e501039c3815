//! Queries of points in and around boxes.

use super::oracle::WideBox;
use super::random_pairs::{obb, place};
use crate::cases::{cases, half_extents};
use crate::wide::{length, wide};
use sinew_geometry::boxes::{Cuboid, Penetration};
use sinew_geometry::{Aabb, Obb};
use sinew_math::{Random, Rotation, Transform, Vec3};

/// Returns a point near the box: around it, in it, on its surface, far away, or its centre.
fn point_about(obb: &Obb, random: &mut Random) -> Vec3 {
    let reach = obb.half_extents.length();
    let in_box = |q: Vec3| obb.center + obb.rotation * (obb.half_extents * q);
    match random.index(8) {
        0 => obb.center,
        1 => {
            let mut q = random.in_cube();
            q[random.index(3)] = [-1.0, 1.0][random.index(2)];
            in_box(q)
        }
        2 => obb.center + random.direction() * (reach * random.range(2.0, 1e4)),
        3 | 4 => in_box(random.in_cube()),
        _ => obb.center + random.in_cube() * (2.0 * reach + 1e-3),
    }
}

/// Checks all results for a point.
fn check(cuboid: &impl Cuboid, wide_box: &WideBox, point: Vec3, case: u32) {
    let distance = wide_box.signed_distance(wide(point));
    let tolerance = 1e-6 * (wide_box.size() + distance.abs());
    let on_grid = tolerance + 2e-7 * length(wide_box.center);
    let found = cuboid.nearest_surface(point);
    assert!(
        (f64::from(found.distance) - distance).abs() <= tolerance,
        "case {case}: found {found:?}, distance {distance}"
    );
    assert_eq!(cuboid.signed_distance(point), found.distance);
    assert!((found.normal.length() - 1.0).abs() < 1e-5, "case {case}: {found:?}");
    let off = wide_box.signed_distance(wide(found.point)).abs();
    assert!(off <= on_grid, "case {case}: {found:?} is {off} from the surface of {wide_box:?}");
    let (inside, outside) = (distance < -tolerance, distance > tolerance);
    let held = cuboid.contains_point(point);
    assert!(held || !inside, "case {case}: {point} is in {wide_box:?}");
    assert!(!held || !outside, "case {case}: {point} is not in {wide_box:?}");
    let closest = cuboid.closest_point(point);
    let apart = f64::from((closest - point).length());
    assert!(
        (apart - distance.max(0.0)).abs() <= on_grid,
        "case {case}: the distance from {closest} to {point} is {apart}"
    );
    assert!(
        wide_box.signed_distance(wide(closest)) <= on_grid,
        "case {case}: {closest} is outside {wide_box:?}"
    );
    match cuboid.point_penetration(point) {
        Some(Penetration { depth, direction }) => {
            assert!(!outside && depth >= 0.0, "case {case}");
            let out = wide_box.signed_distance(wide(point + direction * depth)).abs();
            assert!(out <= on_grid, "case {case}: the push-out ends {out} from the surface");
        }
        None => assert!(!inside, "case {case}"),
    }
}

#[test]
fn point_depth_matches_the_nearest_of_six_faces() {
    let mut random = Random::new(41);
    for case in 0..cases(100_000) {
        let obb = obb(&mut random);
        check(&obb, &WideBox::from(&obb), point_about(&obb, &mut random), case);
        let aabb = Aabb::around(place(&mut random), half_extents(1.0, &mut random));
        check(&aabb, &WideBox::from(&aabb), point_about(&Obb::from(aabb), &mut random), case);
    }
}

/// With exact coordinates a point on the surface is inside the box, and the next representable one is outside.
#[test]
fn points_on_the_surface_are_inside() {
    let aabb = Aabb::new(Vec3::new(-1.0, 2.0, 4.0), Vec3::new(1.0, 4.0, 4.0));
    let obb = Obb::new(Vec3::new(0.0, 3.0, 4.0), Rotation::IDENTITY, Vec3::new(1.0, 1.0, 0.0));
    for on in [Vec3::new(1.0, 2.0, 4.0), Vec3::new(-1.0, 4.0, 4.0), Vec3::new(0.3, 3.0, 4.0)] {
        assert!(aabb.contains_point(on) && obb.contains_point(on), "{on}");
        assert_eq!(obb.signed_distance(on), 0.0);
        assert_eq!(obb.point_penetration(on).map(|way| way.depth), Some(0.0));
    }
    for off in [Vec3::new(1.0f32.next_up(), 3.0, 4.0), Vec3::new(0.0, 3.0, 4.0f32.next_down())] {
        assert!(!aabb.contains_point(off) && !obb.contains_point(off), "{off}");
        assert!(obb.signed_distance(off) > 0.0);
        assert_eq!(obb.point_penetration(off), None);
    }
}

/// Compares depth and direction in a box rotated by 45° with values computed by hand.
#[test]
fn exit_direction_is_through_the_nearest_face() {
    let turned = Rotation::from_axis_angle(Vec3::Y, core::f32::consts::FRAC_PI_4);
    let obb = Obb::new(Vec3::new(5.0, 0.0, 0.0), turned, Vec3::new(2.0, 0.5, 1.0));
    let along = turned * Vec3::X;
    let way = obb.point_penetration(obb.center + along * 1.9).expect("inside");
    assert!((way.depth - 0.1).abs() < 1e-6 && (way.direction - along).length() < 1e-6, "{way:?}");
    let way = obb.point_penetration(obb.center + Vec3::Y * 0.1).expect("inside");
    assert!((way.depth - 0.4).abs() < 1e-6 && (way.direction - Vec3::Y).length() < 1e-6, "{way:?}");
    let corner = obb.to_transform().point(Vec3::new(5.0, 4.5, 1.0));
    assert!((obb.signed_distance(corner) - 5.0).abs() < 1e-5);
    assert_eq!(obb.point_penetration(corner), None);
}

/// Moving the point and the box does not change the results.
#[test]
fn point_results_move_with_the_box() {
    let mut random = Random::new(43);
    for case in 0..cases(100_000) {
        let scale = [0.1, 1.0, 10.0][random.index(3)];
        let obb = Obb::new(random.in_cube(), random.rotation(), half_extents(scale, &mut random));
        let motion = Transform::new(random.in_cube(), random.rotation());
        let moved = Obb::from_transform(&(motion * obb.to_transform()), obb.half_extents);
        let point = point_about(&obb, &mut random);
        let (here, there) = (obb.signed_distance(point), moved.signed_distance(motion.point(point)));
        let tolerance = 1e-6 * (scale + here.abs() + 2.0);
        assert!((here - there).abs() <= tolerance, "case {case}: distances {here} and {there}");
    }
}
