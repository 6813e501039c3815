//! Construction of boxes, and their measures.

use super::random_pairs::place;
use crate::cases::{cases, half_extents};
use sinew_geometry::boxes::{Capsule, Cuboid, Sphere};
use sinew_geometry::{Aabb, Obb, Shape};
use sinew_math::{Random, Rotation, Vec3};
use std::panic::catch_unwind;

#[test]
fn nonfinite_sizes_and_positions_panic() {
    let turn = Rotation::IDENTITY;
    for bad in [-1.0, f32::NAN, f32::INFINITY] {
        let half = Vec3::new(1.0, bad, 1.0);
        assert!(catch_unwind(|| Obb::new(Vec3::ZERO, turn, half)).is_err(), "{bad}");
        assert!(catch_unwind(|| Aabb::around(Vec3::ZERO, half)).is_err(), "{bad}");
        assert!(catch_unwind(|| Sphere::new(Vec3::ZERO, bad)).is_err(), "{bad}");
        assert!(catch_unwind(|| Capsule::new([Vec3::ZERO; 2], bad)).is_err(), "{bad}");
        let obb = Obb::new(Vec3::ZERO, turn, Vec3::ONE);
        assert!(catch_unwind(|| obb.inertia(bad)).is_err(), "{bad}");
        assert!(catch_unwind(|| obb.mass_properties(bad)).is_err(), "{bad}");
    }
    let nowhere = Vec3::new(0.0, f32::NAN, 0.0);
    let no_turn = Rotation::from_xyzw(0.0, f32::NAN, 0.0, 1.0);
    assert!(catch_unwind(|| Obb::new(nowhere, turn, Vec3::ONE)).is_err());
    assert!(catch_unwind(|| Obb::new(Vec3::ZERO, no_turn, Vec3::ONE)).is_err());
    assert!(catch_unwind(|| Aabb::new(nowhere, Vec3::ONE)).is_err());
    assert!(catch_unwind(|| Aabb::new(Vec3::ONE, Vec3::new(2.0, 0.5, 2.0))).is_err());
    assert!(catch_unwind(|| Sphere::new(nowhere, 1.0)).is_err());
    assert!(catch_unwind(|| Capsule::new([Vec3::ZERO, nowhere], 1.0)).is_err());
    assert_eq!(Obb::new(Vec3::ONE, turn, Vec3::ZERO).volume(), 0.0);
    assert_eq!(Aabb::new(Vec3::ONE, Vec3::ONE).half_extents(), Vec3::ZERO);
}

/// Volume, area and inertia of a box of 2 × 4 × 6 m, computed by hand, and of a plate without volume.
#[test]
fn measures() {
    let obb = Obb::new(Vec3::new(7.0, 0.0, 0.0), Rotation::IDENTITY, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!((obb.volume(), obb.surface_area()), (48.0, 88.0));
    let inertia = obb.inertia(12.0);
    assert_eq!((inertia.diagonal, inertia.off), (Vec3::new(52.0, 40.0, 20.0), Vec3::ZERO));
    let plate = Obb::new(Vec3::ZERO, Rotation::IDENTITY, Vec3::new(1.0, 0.0, 1.0));
    assert_eq!((plate.volume(), plate.surface_area()), (0.0, 8.0));
    assert_eq!(plate.inertia(3.0).diagonal, Vec3::new(1.0, 2.0, 1.0));
}

/// A rotated box has the mass properties of a shape of a body in the same frame.
#[test]
fn mass_properties_of_a_box_equal_those_of_its_shape() {
    let mut random = Random::new(71);
    for _ in 0..cases(10_000) {
        let obb = Obb::new(random.in_cube(), random.rotation(), half_extents(1.0, &mut random));
        let shape = Shape::Box { half_extents: obb.half_extents };
        let expected = shape.mass_properties(500.0).transformed(&obb.to_transform());
        let found = obb.mass_properties(500.0);
        assert!((found.mass - expected.mass).abs() <= 1e-6 * expected.mass);
        let scale = 1e-5 * expected.inertia.diagonal.length();
        assert!((found.inertia.diagonal - expected.inertia.diagonal).length() <= scale, "{obb:?}");
        assert!((found.inertia.off - expected.inertia.off).length() <= scale, "{obb:?}");
        assert_eq!(found.center, obb.center);
    }
}

/// Corners have the right distance from the centre and are on the right sides of the axes.
#[test]
fn corners_are_numbered_by_their_sides() {
    let mut random = Random::new(72);
    for _ in 0..cases(10_000) {
        let obb = Obb::new(place(&mut random), random.rotation(), half_extents(1.0, &mut random));
        for (index, corner) in obb.corners().into_iter().enumerate() {
            let local = obb.to_transform().inverse_point(corner);
            for axis in 0..3 {
                let side = if index >> axis & 1 == 1 { 1.0 } else { -1.0 };
                let off = local[axis] - side * obb.half_extents[axis];
                assert!(
                    off.abs() <= 2e-6 + 3e-7 * obb.center.length(),
                    "{obb:?} lacks corner {index} at {corner}"
                );
            }
        }
    }
}
