//! Quickhull: random clouds, and the hardest ones: flat, regular, with duplicates, far away.

use super::{cases, corners};
use sinew_geometry::hull::{MAX_FACES, MAX_VERTICES};
use sinew_geometry::{Hull, HullError};
use sinew_math::{Random, Vec3, max, max3, min3};

fn cloud(kind: usize, random: &mut Random) -> Vec<Vec3> {
    let count = 4 + random.index(56);
    let turn = random.rotation();
    let mut points: Vec<Vec3> = match kind {
        0 => (0..count).map(|_| random.in_cube()).collect(),
        1 => (0..count).map(|_| random.direction()).collect(),
        // Nearly flat cloud.
        2 => (0..count).map(|_| turn * (random.in_cube() * Vec3::new(1.0, 1e-3, 1.0))).collect(),
        // Grid, whole or in part: many coplanar and collinear points.
        3 => (0..count).map(|_| (random.in_cube() * 2.5).round()).collect(),
        4 => corners(Vec3::new(0.3, 1.0, 0.7)).into_iter().map(|p| turn * p).collect(),
        // Rotated prism with points on its faces and edges.
        5 => {
            let sides = 3 + random.index(20);
            let rim = (0..sides).flat_map(|k| {
                let (sin, cos) = sinew_math::trig::sin_cos(k as f32 / sides as f32 * core::f32::consts::TAU);
                [-0.4, 0.0, 0.4].map(|y| turn * Vec3::new(cos, y, sin))
            });
            rim.chain([turn * Vec3::Y * 0.4]).collect()
        }
        // Two dense clusters.
        6 => (0..count).map(|k| random.in_cube() * 1e-4 + Vec3::X * (k % 2) as f32).collect(),
        // Needle.
        _ => (0..count).map(|_| turn * (random.in_cube() * Vec3::new(1.0, 2e-3, 2e-3))).collect(),
    };
    // Some points occur twice.
    points.extend_from_within(..points.len() / 3);
    let scale = [0.01, 1.0, 300.0][random.index(3)];
    let shift = random.in_cube() * [0.0, 1.0, 100.0][random.index(3)];
    points.into_iter().map(|p| (p + shift) * scale).collect()
}

fn size(points: &[Vec3]) -> f32 {
    let low = points.iter().copied().fold(points[0], min3);
    let high = points.iter().copied().fold(points[0], max3);
    let sides = high - low;
    max(sides.x, max(sides.y, sides.z))
}

/// Checks that a hull is closed, flat-faced and convex: Euler's formula, corners on their faces, all other corners
/// below.
fn check_solid(hull: &Hull, size: f32, context: &str) {
    let (faces, vertices) = (hull.faces().len(), hull.vertices().len());
    assert!((4..=MAX_FACES).contains(&faces) && (4..=MAX_VERTICES).contains(&vertices), "{context}");
    assert_eq!(vertices + faces, hull.edges().count() + 2, "Euler: {context}");
    let far = hull.bounding_radius();
    let mut sides = 0;
    for face in hull.faces() {
        sides += face.corners().len();
        assert!(face.corners().len() >= 3 && face.area() > 0.0, "{context}");
        assert!((face.normal().length() - 1.0).abs() < 1e-6, "{context}");
        for corner in face.corners() {
            let height = face.normal().dot(hull.vertices()[corner]) - face.offset();
            assert!(height.abs() < 1e-5 * size + 1e-6 * far, "a corner is {height} from its face: {context}");
        }
        let highest = hull.vertices().iter().map(|v| v.dot(face.normal()) - face.offset()).fold(-1.0, max);
        assert!(highest <= 1e-6 * (size + far), "a corner is {highest} above a face: {context}");
        assert!(face.normal().dot(hull.center()) < face.offset(), "the centre is outside: {context}");
    }
    assert_eq!(sides, 2 * hull.edges().count(), "{context}");
}

#[test]
fn hulls_of_random_clouds_contain_their_points() {
    let mut random = Random::new(11);
    let (mut made, mut refused) = (0, 0);
    for case in 0..cases(10_000).max(2_000) {
        let kind = case as usize % 8;
        let points = cloud(kind, &mut random);
        let context = format!("case {case}, kind {kind}, {} points", points.len());
        let size = size(&points);
        let hull = match Hull::new(&points) {
            Ok(hull) => hull,
            Err(error) => {
                // A few points of a grid or a cluster may be coplanar.
                assert!(matches!(kind, 0..=3 | 6..), "{error}: {context}");
                refused += 1;
                continue;
            }
        };
        made += 1;
        check_solid(&hull, size, &context);
        let far = size + points[0].length();
        for &p in &points {
            let (distance, _) = hull.distance(p);
            assert!(distance <= 1e-5 * size + 1e-6 * far, "{p} is {distance} outside the hull: {context}");
        }
        for &vertex in hull.vertices() {
            let off = points.iter().map(|p| (*p - vertex).length()).fold(f32::INFINITY, f32::min);
            assert!(off <= 1e-6 * size, "a corner is {off} from all points: {context}");
        }
        if kind == 4 && far < 4.0 * size {
            assert_eq!(
                (hull.vertices().len(), hull.faces().len()),
                (8, 6),
                "the cloud of a box must give 8 corners and 6 faces: {context}"
            );
        }
        let again = Hull::new(hull.vertices()).expect("the points of a hull must have a hull");
        assert!(again.volume() > (1.0 - 1e-3) * hull.volume(), "{context}");
    }
    println!("{made} hulls, {refused} clouds without one");
    assert!(made > 6 * refused);
}

#[test]
fn point_order_does_not_change_the_hull() {
    let mut random = Random::new(12);
    for case in 0..200 {
        let mut points = cloud(case % 8, &mut random);
        let Ok(hull) = Hull::new(&points) else { continue };
        for k in (1..points.len()).rev() {
            points.swap(k, random.index(k + 1));
        }
        let other = Hull::new(&points).expect("the same points in another order must have a hull");
        assert_eq!(hull, other);
        assert_eq!(hull.content_hash(), other.content_hash());
    }
}

/// A cube from all points of a grid on and in it: 8 corners and 6 faces remain.
#[test]
fn grid_of_points_gives_a_cube() {
    let line = (0..9).map(|k| k as f32 * 0.125 - 0.5);
    let points: Vec<Vec3> = line
        .clone()
        .flat_map(|x| line.clone().flat_map(move |y| [0, 4, 8].map(|k| Vec3::new(x, y, k as f32 * 0.1))))
        .collect();
    let hull = Hull::new(&points).expect("a solid");
    assert_eq!((hull.vertices().len(), hull.faces().len(), hull.edges().count()), (8, 6, 12));
    assert!((hull.volume() - 0.8).abs() < 1e-6);
}

/// A hull that would exceed the limit of faces is simplified, and points outside it have the returned distance.
#[test]
fn hull_of_a_round_cloud_is_simplified() {
    let mut random = Random::new(13);
    let points: Vec<Vec3> = (0..5_000).map(|_| random.direction()).collect();
    let hull = Hull::new(&points).expect("a solid");
    check_solid(&hull, 2.0, "ball");
    let lost = points.iter().map(|&p| hull.distance(p).0).fold(0.0, max);
    println!("{} corners, {} faces, {lost} of the radius is lost", hull.vertices().len(), hull.faces().len());
    assert!(hull.faces().len() > 100 && lost < 0.07, "{} faces, {lost} lost", hull.faces().len());
}

#[test]
fn degenerate_clouds_are_rejected() {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let new = |points: &[Vec3]| Hull::new(points).expect_err("no solid");
    assert_eq!(new(&[]), HullError::TooFewPoints);
    assert_eq!(new(&[x, y, z]), HullError::TooFewPoints);
    assert_eq!(new(&[x, y, z, z, y, x]), HullError::TooFewPoints);
    assert_eq!(new(&[x; 9]), HullError::TooFewPoints);
    assert_eq!(new(&[x, x * 2.0, x * 3.0, x * 7.0]), HullError::Collinear);
    assert_eq!(new(&[Vec3::ZERO, x, y, x + y, x - y]), HullError::Coplanar);
    assert_eq!(new(&[Vec3::ZERO, x, y, x + y + z * 1e-5]), HullError::TooThin);
    assert_eq!(new(&[Vec3::ZERO, x, y, z * f32::NAN]), HullError::NotFinite);
    assert_eq!(new(&[Vec3::ZERO, x, y, z * f32::INFINITY]), HullError::NotFinite);
    assert_eq!(new(&[Vec3::ZERO, x, y, z].map(|p| p * 1e8)), HullError::Size);
    assert_eq!(new(&[Vec3::ZERO, x, y, z].map(|p| p * 1e-8)), HullError::Size);
    assert_eq!(new(&[Vec3::splat(-3e38), Vec3::splat(3e38), x, y]), HullError::Size);
}
