//! Boxes around points, compared with known optima and with a search.

use super::random_pairs::place;
use crate::cases::{cases, half_extents};
use sinew_geometry::boxes::Cuboid;
use sinew_geometry::{Aabb, Obb};
use sinew_math::{Mat3, Random, Rotation, Vec3};

fn holds_all(obb: &Obb, points: &[Vec3]) -> bool {
    points.iter().all(|&p| obb.contains_point(p))
}

/// Returns the volume of the box along the axes of a rotation.
fn volume_along(rotation: Rotation, points: &[Vec3]) -> f32 {
    let turned: Vec<Vec3> = points.iter().map(|&p| rotation.inverse() * p).collect();
    Aabb::from_points(&turned).map_or(0.0, |bounds| bounds.volume())
}

/// Returns the least volume that random rotations of decreasing size find.
fn searched(points: &[Vec3], random: &mut Random) -> f32 {
    let mut starts: Vec<(f32, Rotation)> = (0..400)
        .map(|_| random.rotation())
        .map(|rotation| (volume_along(rotation, points), rotation))
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    starts.truncate(6);
    for (best, rotation) in &mut starts {
        let mut step = 0.3;
        while step > 1e-4 {
            let tries: Vec<_> =
                (0..12).map(|_| Rotation::from_scaled_axis(random.in_cube() * step) * *rotation).collect();
            let found = tries.into_iter().map(|turn| (volume_along(turn, points), turn));
            match found.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|found| found.0 < *best) {
                Some(found) => (*best, *rotation) = found,
                None => step *= 0.7,
            }
        }
    }
    starts.iter().map(|start| start.0).fold(f32::INFINITY, f32::min)
}

#[test]
fn box_is_recovered_from_its_corners() {
    let mut random = Random::new(81);
    for _ in 0..cases(10_000) {
        let obb = Obb::new(random.in_cube(), random.rotation(), half_extents(1.0, &mut random));
        let corners = obb.corners();
        let fit = Obb::from_points(&corners).expect("finite points");
        assert!(holds_all(&fit, &corners), "{obb:?} {fit:?}");
        assert!((fit.volume() - obb.volume()).abs() < 1e-5 * (1.0 + obb.volume()), "{obb:?} {fit:?}");
        // Flat boxes too: the sides are those of the box, possibly in another order.
        let sorted = |half: Vec3| {
            let mut sides = half.to_array();
            sides.sort_by(f32::total_cmp);
            Vec3::from_array(sides)
        };
        let off = (sorted(fit.half_extents) - sorted(obb.half_extents)).length();
        assert!(off < 5e-5, "{obb:?} {fit:?}");
        assert!((fit.center - obb.center).length() < 1e-5, "{obb:?} {fit:?}");
    }
}

/// The smallest box around a regular tetrahedron is the cube whose face diagonals are its edges: three times its
/// volume.
#[test]
fn box_around_a_regular_tetrahedron_is_a_cube() {
    let mut random = Random::new(82);
    for _ in 0..cases(10_000) {
        let turn = random.rotation();
        let corners =
            [Vec3::ONE, Vec3::new(1.0, -1.0, -1.0), Vec3::new(-1.0, 1.0, -1.0), Vec3::new(-1.0, -1.0, 1.0)]
                .map(|p| turn * p);
        let fit = Obb::from_points(&corners).expect("finite points");
        assert!((fit.volume() - 8.0).abs() < 1e-4, "{fit:?}");
        assert!((fit.half_extents - Vec3::ONE).length() < 1e-5, "{fit:?}");
    }
}

/// Prism on a regular triangle: the smallest rectangle around a triangle has a common side with it and twice its area.
#[test]
fn prism_gets_a_box_on_one_of_its_sides() {
    let height = 0.5 * 3.0f32.sqrt();
    let turn = Rotation::from_scaled_axis(Vec3::new(0.4, -1.1, 0.3));
    let corner = |x: f32, y: f32, z: f32| turn * Vec3::new(x, y, z);
    let mut points = Vec::new();
    for z in [-0.2, 0.3] {
        points.extend([corner(-0.5, 0.0, z), corner(0.5, 0.0, z), corner(0.0, height, z)]);
    }
    let fit = Obb::from_points(&points).expect("finite points");
    assert!((fit.volume() - 0.5 * height).abs() < 1e-5, "{fit:?}");
}

/// Boxes around random clouds are never larger than the simpler boxes, and about as small as a random search finds.
#[test]
fn fitted_box_is_about_as_small_as_a_random_search_finds() {
    let mut random = Random::new(83);
    let (mut worst, mut sum) = (0.0f32, 0.0);
    let count = cases(10_000);
    for _ in 0..count {
        let scale = half_extents(1.0, &mut random) + Vec3::splat(0.02);
        let turn = random.rotation();
        let cloud = 4 + random.index(60);
        let points: Vec<Vec3> = (0..cloud).map(|_| turn * (random.in_cube() * scale)).collect();
        let fit = Obb::from_points(&points).expect("finite points");
        assert!(holds_all(&fit, &points), "{points:?}");
        let simple = Obb::from_points_pca(&points).expect("finite points");
        assert!(holds_all(&simple, &points), "{points:?}");
        let bounds = Aabb::from_points(&points).expect("finite points");
        let most = fit.volume() * (1.0 - 1e-4);
        assert!(most <= simple.volume() && most <= bounds.volume(), "{points:?}");
        let excess = fit.volume() / searched(&points, &mut random) - 1.0;
        (worst, sum) = (worst.max(excess), sum + excess);
    }
    println!(
        "{count} clouds: volume above the search's by {:.4} on average, {worst:.4} at most",
        sum / count as f32
    );
    assert!(worst < 0.06 && sum < 0.0, "{worst}, {sum}");
}

/// Function that returns a box around points.
type Fit = fn(&[Vec3]) -> Option<Obb>;

/// Clouds of one point, of equal points, on a line or in a plane get a box; no points, NaN and infinity give `None`.
#[test]
fn degenerate_clouds_get_a_box() {
    let (p, along) = (Vec3::new(3.0, -1.0, 2.0), Vec3::new(0.6, 0.0, 0.8));
    for fit in [Obb::from_points as Fit, Obb::from_points_pca] {
        assert_eq!(fit(&[]), None);
        for bad in [f32::NAN, f32::INFINITY] {
            assert_eq!(fit(&[p, Vec3::new(bad, 0.0, 0.0)]), None);
        }
        for same in [&[p][..], &[p; 5]] {
            let obb = fit(same).expect("finite points");
            assert_eq!((obb.center, obb.half_extents), (p, Vec3::ZERO));
        }
        let line: Vec<Vec3> = (0..9).map(|k| p + along * k as f32).collect();
        let obb = fit(&line).expect("finite points");
        assert!(holds_all(&obb, &line));
        let mut sides = obb.half_extents.to_array();
        sides.sort_by(f32::total_cmp);
        assert!((sides[2] - 4.0).abs() < 1e-5 && sides[1] < 1e-5, "{obb:?}");
    }
    // Square sheet with corners 1 m from its centre.
    let turn = Rotation::from_scaled_axis(Vec3::new(0.3, 0.7, -0.2));
    let square = [Vec3::X, Vec3::Y, -Vec3::X, -Vec3::Y, Vec3::ZERO].map(|q| p + turn * q);
    let obb = Obb::from_points(&square).expect("finite points");
    let mut sides = obb.half_extents.to_array();
    sides.sort_by(f32::total_cmp);
    let half = core::f32::consts::FRAC_1_SQRT_2;
    assert!(sides[0] < 1e-6 && (sides[1] - half).abs() < 1e-5 && (sides[2] - half).abs() < 1e-5, "{obb:?}");
    assert_eq!(Aabb::from_points(&[]), None);
    assert_eq!(Aabb::from_points(&[Vec3::splat(f32::NAN)]), None);
    assert_eq!(Aabb::from_points(&[p]), Some(Aabb::new(p, p)));
}

#[test]
fn merged_box_contains_both_boxes() {
    let mut random = Random::new(84);
    for _ in 0..cases(10_000) {
        let [a, b] =
            [0, 1].map(|_| Obb::new(random.in_cube(), random.rotation(), half_extents(1.0, &mut random)));
        let both = a.merge(&b);
        let corners: Vec<Vec3> = a.corners().into_iter().chain(b.corners()).collect();
        assert!(corners.iter().all(|&p| both.signed_distance(p) < 1e-6), "{a:?} {b:?}");
        for axes in [a.rotation, b.rotation] {
            assert!(both.volume() <= volume_along(axes, &corners) * 1.0001 + 1e-5, "{a:?} {b:?}");
        }
        // For flat boxes rounding decides if one contains the other.
        let a = Obb { half_extents: a.half_extents + Vec3::splat(0.01), ..a };
        let inner = Obb { half_extents: a.half_extents * 0.5, ..a };
        assert_eq!((a.merge(&inner), inner.merge(&a)), (a, a));
    }
    let [left, right] = [-1.0, 1.0].map(|x| Obb::new(Vec3::X * x, Rotation::IDENTITY, Vec3::ONE));
    assert_eq!(left.merge(&right).half_extents, Vec3::new(2.0, 1.0, 1.0));
    let [low, high] = [0.0, 3.0].map(|y| Aabb::around(Vec3::Y * y, Vec3::ONE));
    assert_eq!(low.merge(&high), Aabb::new(-Vec3::ONE, Vec3::new(1.0, 4.0, 1.0)));
}

/// Bounds of a rotated box are `|R| h` about its centre, and corners touch every side.
#[test]
fn bounds_touch_the_outermost_corners() {
    let mut random = Random::new(85);
    for _ in 0..cases(10_000) {
        let obb = Obb::new(place(&mut random), random.rotation(), half_extents(1.0, &mut random));
        let (bounds, corners) = (obb.bounds(), Aabb::from_points(&obb.corners()).expect("finite points"));
        let off = (bounds.min - corners.min).length() + (bounds.max - corners.max).length();
        assert!(off <= 2e-6 + 3e-7 * obb.center.length(), "{obb:?}: bounds {bounds:?}, corners {corners:?}");
        let m: Mat3 = obb.rotation.to_mat3();
        assert!((bounds.half_extents().x - (m.transpose().x_axis.abs()).dot(obb.half_extents)).abs() <= 2e-3);
    }
}
