//! Volume, centre and inertia of hulls, compared with closed forms and a sum over voxels; rays and distances.

use super::{box_hull, corners, hull_of, pebble};
use sinew_geometry::Shape;
use sinew_geometry::ray::Ray;
use sinew_geometry::submerged::WaterPlane;
use sinew_math::{Random, Sym3, Transform, Vec3};

#[test]
fn closed_forms() {
    let half = Vec3::new(0.3, 1.0, 0.7);
    let (hull, cuboid) = (box_hull(half), Shape::Box { half_extents: half });
    let (of_hull, of_box) = (hull.mass_properties(700.0), cuboid.mass_properties(700.0));
    assert!((of_hull.mass - of_box.mass).abs() < 2e-6 * of_box.mass);
    assert!(of_hull.center.length() < 1e-6);
    assert!(
        (of_hull.inertia.diagonal - of_box.inertia.diagonal).length()
            < 5e-6 * of_box.inertia.diagonal.length()
    );
    assert!(
        (hull.inner_radius() - 0.3).abs() < 1e-6 && (hull.bounding_radius() - half.length()).abs() < 1e-6
    );

    // Tetrahedron between the axes: V = 1/6, centre at 1/4; about the centre Ixx = 3 V/40, Ixy = V/80 (products with a
    // minus sign).
    let tetrahedron = hull_of(&[Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z]);
    assert!((tetrahedron.volume() - 1.0 / 6.0).abs() < 1e-6);
    assert!((tetrahedron.center() - Vec3::splat(0.25)).length() < 1e-6);
    let Sym3 { diagonal, off } = tetrahedron.inertia();
    assert!((diagonal - Vec3::splat(3.0 / 240.0)).length() < 1e-6, "{diagonal}");
    assert!((off - Vec3::splat(1.0 / 480.0)).length() < 1e-6, "{off}");
    assert_eq!(tetrahedron.faces().map(|face| face.corners().len()).collect::<Vec<_>>(), [3; 4]);

    // The parallel axis theorem holds for a cube far from its frame's origin.
    let away = hull_of(&corners(Vec3::ONE).into_iter().map(|p| p + Vec3::X * 50.0).collect::<Vec<_>>());
    assert!((away.center() - Vec3::X * 50.0).length() < 1e-5);
    assert!((away.inertia().diagonal - Vec3::splat(16.0 / 3.0)).length() < 1e-4);
}

#[test]
fn mass_properties_match_voxels() {
    const CELLS: i32 = 60;
    let mut random = Random::new(14);
    for _ in 0..6 {
        let shape = pebble(1.0, &mut random);
        let exact = shape.mass_properties(1.0);
        let cell = 2.0 / CELLS as f32;
        let (mut volume, mut first, mut second) = (0.0, Vec3::ZERO, Sym3::ZERO);
        for i in 0..CELLS * CELLS * CELLS {
            let place = |k: i32| (k as f32 + 0.5) * cell - 1.0;
            let p = Vec3::new(place(i % CELLS), place(i / CELLS % CELLS), place(i / CELLS / CELLS));
            if shape.signed_distance(&Transform::IDENTITY, p).0 <= 0.0 {
                let v = cell * cell * cell;
                volume += v;
                first += p * v;
                let r = p - exact.center;
                second += (Sym3::IDENTITY * r.dot(r) - Sym3::outer(r)) * v;
            }
        }
        assert!((volume - exact.mass).abs() < 0.02 * exact.mass, "{volume} {}", exact.mass);
        assert!((first / volume - exact.center).length() < 0.01);
        assert!((second.diagonal - exact.inertia.diagonal).length() < 0.03 * exact.inertia.diagonal.length());
        assert!((second.off - exact.inertia.off).length() < 0.03 * exact.inertia.diagonal.length());
    }
}

/// Marches along rays in small steps: the first step inside is the hit, and distances decrease along the ray.
#[test]
fn hull_rays_match_marching_by_distance() {
    let mut random = Random::new(15);
    let mut hits = 0;
    for _ in 0..300 {
        let shape = pebble(1.0, &mut random);
        let frame = Transform::new(random.in_cube(), random.rotation());
        let from = frame.point(random.direction() * 2.0);
        let ray = Ray { origin: from, direction: frame.point(random.in_cube() * 0.7) - from };
        let direction = ray.direction * 2.0;
        let ray = Ray { direction, ..ray };
        let hit = shape.cast_ray(&frame, &ray);
        let inside = (0..2_000)
            .map(|k| k as f32 / 2_000.0)
            .find(|&t| shape.signed_distance(&frame, ray.at(t)).0 <= 0.0);
        match (hit, inside) {
            (Some(hit), Some(t)) => {
                hits += 1;
                assert!(hit.fraction <= t + 1e-5 && t <= hit.fraction + 1e-3, "{} {t}", hit.fraction);
                assert!(shape.signed_distance(&frame, hit.point).0.abs() < 1e-5);
                assert!(hit.normal.dot(direction) < 0.0);
            }
            (None, Some(t)) => panic!("the ray missed the hull although a point at {t} is inside"),
            // A ray may graze an edge between two steps.
            (Some(hit), None) => assert!(shape.signed_distance(&frame, ray.at(hit.fraction + 1e-3)).0 < 1e-3),
            (None, None) => {}
        }
        // The closest point of the surface has the returned distance, and the normal points away from it.
        let p = frame.point(random.in_cube() * 2.0);
        let (distance, normal) = shape.signed_distance(&frame, p);
        let (on_surface, _) = shape.signed_distance(&frame, p - normal * distance);
        assert!(on_surface.abs() < 1e-5, "the hit at {distance} is {on_surface} from the surface");
        assert!(
            (shape.signed_distance(&frame, p + normal * 0.1).0 - distance - 0.1).abs() < 1e-4
                || distance < 0.0
        );
    }
    assert!(hits > 150, "{hits} hits");
}

/// Water, bounds and regions treat a hull of a box's corners like the box.
#[test]
fn hull_of_box_corners_gives_the_results_of_the_box() {
    let mut random = Random::new(22);
    let half = Vec3::new(0.3, 1.0, 0.7);
    let shapes = [box_hull(half), Shape::Box { half_extents: half }];
    for case in 0..300 {
        let frame = Transform::new(random.in_cube() * 2.0, random.rotation());
        let [hull, cuboid] = shapes.each_ref().map(|shape| shape.aabb(&frame));
        assert!((hull.min - cuboid.min).length() < 1e-6 && (hull.max - cuboid.max).length() < 1e-6);
        let plane = WaterPlane { normal: random.direction(), height: random.range(-1.0, 1.0) };
        let [hull, cuboid] = shapes.each_ref().map(|shape| shape.submerged(&frame, &plane));
        assert!(
            (hull.volume - cuboid.volume).abs() < 1e-5,
            "case {case}: volume of {hull:?}, box {cuboid:?}"
        );
        let apart = hull.center() * hull.volume - cuboid.center() * cuboid.volume;
        assert!(apart.length() < 1e-5, "case {case}: {apart}");
        let point = frame.point(random.in_cube() * 1.5);
        let [hull, cuboid] = shapes.each_ref().map(|shape| shape.signed_distance(&frame, point));
        assert!((hull.0 - cuboid.0).abs() < 1e-5, "case {case}: distance of {hull:?}, box {cuboid:?}");
        let ray = Ray::between(point, frame.point(random.in_cube() * 1.5));
        match shapes.each_ref().map(|shape| shape.cast_ray(&frame, &ray)) {
            [Some(hull), Some(cuboid)] => {
                assert!((hull.fraction - cuboid.fraction).abs() < 1e-4, "case {case}");
            }
            [None, None] => {}
            other => panic!("case {case}: unexpected {other:?}"),
        }
    }
}
