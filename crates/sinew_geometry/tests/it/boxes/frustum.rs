//! Culling and picking, compared with sampled points of the box in the coordinates of the eye.

use super::oracle::WideBox;
use crate::cases::{cases, half_extents};
use crate::wide::{Wide, add, dot, wide};
use sinew_geometry::boxes::{Cuboid, Frustum, Sphere, Visibility, pick};
use sinew_geometry::ray::Ray;
use sinew_geometry::{Aabb, Obb};
use sinew_math::{Random, Transform, Vec2, Vec3};
use std::panic::catch_unwind;

fn frustum(random: &mut Random) -> Frustum {
    let eye = Transform::new(random.in_cube() * 5.0, random.rotation());
    let near = random.range(0.05, 1.0);
    Frustum::new(eye, random.range(0.2, 2.2), random.range(0.5, 2.0), near, near + random.range(1.0, 20.0))
}

/// Returns about the depth of a point inside all six planes: the smallest of the six heights.
fn depth(frustum: &Frustum, eye: &WideBox, p: Wide) -> f64 {
    let [x, y, z] = eye.local(p);
    let ahead = -z;
    let [sx, sy] = [frustum.slopes.x, frustum.slopes.y].map(f64::from);
    let sides = [(sx * ahead - x.abs()) / sx.hypot(1.0), (sy * ahead - y.abs()) / sy.hypot(1.0)];
    let ends = [ahead - f64::from(frustum.near), f64::from(frustum.far) - ahead];
    sides.into_iter().chain(ends).fold(f64::INFINITY, f64::min)
}

fn eye(frustum: &Frustum) -> WideBox {
    WideBox::from(&Obb::from_transform(&frustum.world_from_eye, Vec3::ONE))
}

#[test]
fn culled_boxes_have_no_visible_point() {
    let mut random = Random::new(91);
    let mut counts = [0; 3];
    let mut untold = 0;
    for case in 0..cases(100_000) {
        let frustum = frustum(&mut random);
        let eye = eye(&frustum);
        let middle = frustum
            .ray(Vec2::new(random.range(-1.5, 1.5), random.range(-1.5, 1.5)))
            .at(random.range(-0.2, 1.2));
        let scale = [0.1, 1.0, 5.0][random.index(3)];
        let obb = Obb::new(middle, random.rotation(), half_extents(scale, &mut random));
        let wide_box = WideBox::from(&obb);
        let tolerance = 1e-5 * f64::from(frustum.far + scale);
        let at = |q: Vec3| {
            depth(&frustum, &eye, wide_box.point([0, 1, 2].map(|k| wide_box.half[k] * f64::from(q[k]))))
        };
        let corners = (0..8).map(|bits: usize| {
            Vec3::from_array([0, 1, 2].map(|k| if bits >> k & 1 == 1 { 1.0 } else { -1.0 }))
        });
        let lowest = corners.map(at).fold(f64::INFINITY, f64::min);
        let highest = (0..200).map(|_| at(random.in_cube())).fold(lowest, f64::max);
        let seen = frustum.sees(&obb);
        match seen {
            Visibility::Inside => {
                assert!(lowest > -tolerance, "case {case}: lowest distance {lowest} of {obb:?} {frustum:?}");
            }
            Visibility::Outside => {
                assert!(
                    highest < tolerance,
                    "case {case}: highest distance {highest} of {obb:?} {frustum:?}"
                );
            }
            Visibility::Intersects => {
                assert!(lowest < tolerance, "case {case}: {obb:?} {frustum:?}");
                untold += u32::from(highest < -tolerance);
            }
        }
        counts[seen as usize] += 1;
    }
    let all = cases(100_000);
    assert!(counts.iter().all(|count| count * 20 > all), "{counts:?}");
    // Sampling misses some visible points, so this is an upper bound.
    assert!(untold * 100 < 15 * all, "{untold} of {all} boxes count as intersecting without a visible point");
}

#[test]
fn visibility_of_balls_matches_their_depth() {
    let mut random = Random::new(92);
    for case in 0..cases(100_000) {
        let frustum = frustum(&mut random);
        let eye = eye(&frustum);
        let center = frustum
            .ray(Vec2::new(random.range(-1.5, 1.5), random.range(-1.5, 1.5)))
            .at(random.range(-0.2, 1.2));
        let sphere = Sphere::new(center, random.range(0.0, 2.0));
        let (depth, radius) = (depth(&frustum, &eye, wide(center)), f64::from(sphere.radius));
        let tolerance = 1e-5 * f64::from(frustum.far);
        let seen = frustum.sees_sphere(&sphere);
        assert!(seen != Visibility::Inside || depth > radius - tolerance, "case {case}");
        assert!(seen != Visibility::Outside || depth < -radius + tolerance, "case {case}");
        assert!(seen != Visibility::Intersects || depth.abs() < radius + tolerance, "case {case}");
    }
}

/// A ray passes through its position in the picture, and the position follows from the ray.
#[test]
fn ray_of_a_pixel_passes_through_its_point() {
    let mut random = Random::new(93);
    for _ in 0..cases(10_000) {
        let frustum = frustum(&mut random);
        let eye = eye(&frustum);
        let screen = Vec2::new(random.range(-1.0, 1.0), random.range(-1.0, 1.0));
        let ray = frustum.ray(screen);
        for (t, ahead) in [(0.0, frustum.near), (1.0, frustum.far)] {
            let [x, y, z] = eye.local(wide(ray.at(t)));
            let slopes = [frustum.slopes.x * screen.x, frustum.slopes.y * screen.y].map(f64::from);
            let expected = [slopes[0], slopes[1], -1.0].map(|v| v * f64::from(ahead));
            let off = add([x, y, z], expected, -1.0);
            assert!(dot(off, off).sqrt() < 1e-5 * f64::from(frustum.far), "{frustum:?} {screen}");
        }
    }
}

/// The first box along the segment is picked; among equals, the first in the list.
#[test]
fn nearest_box_is_picked() {
    let eye = Transform::from_translation(Vec3::new(0.0, 0.0, 10.0));
    let frustum = Frustum::new(eye, 1.0, 1.5, 0.1, 100.0);
    let at = |z: f32| Aabb::around(Vec3::new(0.0, 0.0, z), Vec3::splat(0.5));
    let boxes = [at(-4.0), at(2.0), at(2.0), at(-1.0)];
    let middle = frustum.ray(Vec2::ZERO);
    let (index, hit) = pick(&boxes, &middle).expect("the ray hits boxes");
    assert_eq!((index, hit.normal), (1, Vec3::Z));
    assert!((hit.point.z - 2.5).abs() < 1e-5);
    assert_eq!(pick(&boxes, &frustum.ray(Vec2::new(0.9, 0.0))), None);
    assert_eq!(pick::<Obb>(&[], &middle), None);
    let behind = [at(20.0)];
    assert_eq!(pick(&behind, &middle), None);
    let ray = Ray::between(Vec3::ZERO, Vec3::X);
    assert_eq!(pick(&boxes[..1], &ray), None);
}

#[test]
fn degenerate_cameras_panic() {
    let at = Transform::IDENTITY;
    let lost = Transform::from_translation(Vec3::new(f32::NAN, 0.0, 0.0));
    assert!(catch_unwind(|| Frustum::new(lost, 1.0, 1.0, 0.1, 10.0)).is_err());
    let bad = [
        (0.0, 1.0, 0.1, 10.0),
        (3.2, 1.0, 0.1, 10.0),
        (f32::NAN, 1.0, 0.1, 10.0),
        (1.0, 0.0, 0.1, 10.0),
        (1.0, 1.0, 0.0, 10.0),
        (1.0, 1.0, 2.0, 1.0),
        (1.0, 1.0, 0.1, f32::INFINITY),
    ];
    for (fov_y, aspect, near, far) in bad {
        let seen = catch_unwind(|| Frustum::new(at, fov_y, aspect, near, far));
        assert!(seen.is_err(), "angle {fov_y}, aspect {aspect}, near {near}, far {far}");
    }
    let corners = Frustum::new(at, core::f32::consts::FRAC_PI_2, 2.0, 1.0, 3.0).corners();
    assert!((corners[0] - Vec3::new(-2.0, -1.0, -1.0)).length() < 1e-6, "{corners:?}");
    assert!((corners[7] - Vec3::new(6.0, 3.0, -3.0)).length() < 1e-6, "{corners:?}");
    let bounds = Aabb::from_points(&corners).expect("finite");
    assert!((bounds.volume() - 12.0 * 6.0 * 2.0).abs() < 1e-3);
}
