//! Submerged volumes, compared with brute force: every shape is cut into small cubes.

use crate::solids::pebble;
use sinew_geometry::Shape;
use sinew_geometry::submerged::{WaterPlane, submerged_hull};
use sinew_math::{Random, Rotation, Transform, Vec3};

/// Returns volume and moment of the cells of a fine grid that are inside the shape and under water.
fn brute_force(shape: &Shape, at: &Transform, plane: &WaterPlane, cells: i32) -> (f32, Vec3) {
    let reach = shape.bounding_radius();
    let size = 2.0 * reach / cells as f32;
    // Tilted against all faces, otherwise whole layers of cells would be inside or outside.
    let turned = Rotation::from_axis_angle(Vec3::new(0.6, 0.48, 0.64), 0.7);
    let (mut volume, mut moment) = (0.0f64, [0.0f64; 3]);
    for i in 0..cells * cells * cells {
        let cell = Vec3::new((i % cells) as f32, (i / cells % cells) as f32, (i / cells / cells) as f32);
        let point = at.translation + turned * ((cell + Vec3::splat(0.5)) * size - Vec3::splat(reach));
        if plane.above(point) <= 0.0 && shape.signed_distance(at, point).0 <= 0.0 {
            volume += 1.0;
            for k in 0..3 {
                moment[k] += f64::from(point[k]);
            }
        }
    }
    let cell = f64::from(size) * f64::from(size) * f64::from(size);
    ((volume * cell) as f32, Vec3::from_array(moment.map(|m| (m * cell) as f32)))
}

#[test]
fn submerged_volumes_match_brute_force() {
    let mut random = Random::new(9);
    let shapes = [
        Shape::Sphere { radius: 0.4 },
        Shape::Box { half_extents: Vec3::new(0.2, 0.5, 0.3) },
        Shape::Capsule { half_height: 0.5, radius: 0.2 },
        Shape::Capsule { half_height: 0.05, radius: 0.4 },
        pebble(0.4, &mut random),
        Shape::Cylinder { half_height: 0.5, radius: 0.2 },
        Shape::Cone { half_height: 0.3, radius: 0.4 },
        Shape::TaperedCapsule { half_height: 0.3, radius_bottom: 0.1, radius_top: 0.3 },
    ];
    for shape in shapes {
        let whole = shape.volume();
        for case in 0..40 {
            // Some shapes are upright or lying.
            let rotation = match case {
                0 | 1 => Rotation::IDENTITY,
                2 | 3 => Rotation::from_axis_angle(Vec3::X, core::f32::consts::FRAC_PI_2),
                4 => Rotation::from_axis_angle(Vec3::X, 1.5),
                _ => random.rotation(),
            };
            let at = Transform::new(random.in_cube(), rotation);
            let normal = if case < 5 { Vec3::Y } else { random.direction() };
            let reach = shape.bounding_radius();
            let height = normal.dot(at.translation) + random.range(-0.9, 0.9) * reach;
            let plane = WaterPlane { normal, height };
            let found = shape.submerged(&at, &plane);
            let (volume, moment) = brute_force(&shape, &at, &plane, 60);
            let off = (found.volume - volume).abs() / whole;
            assert!(off < 0.015, "{shape:?} {case}: volume {}, sampled {volume}", found.volume);
            let off = (found.center() * found.volume - moment).length() / (whole * reach);
            assert!(off < 0.02, "{shape:?} {case}: centre {}, sampled {}", found.center(), moment / volume);
        }
    }
}

#[test]
fn submerged_and_dry_parts_sum_to_the_whole() {
    let mut random = Random::new(4);
    for i in 0..2000 {
        let shape = match i % 6 {
            0 => Shape::Sphere { radius: random.range(0.1, 2.0) },
            1 => Shape::Box { half_extents: (random.in_cube() + Vec3::splat(1.1)) * 0.5 },
            2 => Shape::Capsule { half_height: random.range(0.0, 1.0), radius: random.range(0.05, 1.0) },
            3 => Shape::Cylinder { half_height: random.range(0.05, 1.0), radius: random.range(0.05, 1.0) },
            4 => Shape::Cone { half_height: random.range(0.05, 1.0), radius: random.range(0.05, 1.0) },
            _ => Shape::TaperedCapsule {
                half_height: random.range(0.5, 1.0),
                radius_bottom: random.range(0.05, 1.0),
                radius_top: random.range(0.05, 1.0),
            },
        };
        let at = Transform::new(random.in_cube() * 3.0, random.rotation());
        let normal = random.direction();
        let height = normal.dot(at.translation) + random.range(-1.0, 1.0) * shape.bounding_radius();
        let below = shape.submerged(&at, &WaterPlane { normal, height });
        let above = shape.submerged(&at, &WaterPlane { normal: -normal, height: -height });
        let whole = shape.volume();
        assert!((below.volume + above.volume - whole).abs() < 2e-5 * whole, "{i} {shape:?}");
        assert!(below.volume >= 0.0 && below.volume < 1.00001 * whole);
        let middle = below.center() * below.volume + above.center() * above.volume;
        let center = at.point(shape.mass_properties(1.0).center);
        let off = (middle / whole - center).length() / shape.bounding_radius();
        assert!(off < 2e-5, "{i} {shape:?}: the centroid is off by {off}");
    }
}

#[test]
fn submerged_tetrahedron_lacks_the_volume_of_its_dry_tip() {
    let [o, x, y, z] = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
    let faces = [[o, y, x], [o, z, y], [o, x, z], [x, y, z]].map(<[Vec3; 3]>::into_iter);
    for height in [0.1f32, 0.5, 0.9] {
        let below = submerged_hull(faces.clone().into_iter(), &WaterPlane { normal: Vec3::Y, height });
        let top = 1.0 - height;
        let expected = (1.0 - top * top * top) / 6.0;
        assert!((below.volume - expected).abs() < 1e-6, "{} for {expected}", below.volume);
    }
    let all = submerged_hull(faces.clone().into_iter(), &WaterPlane { normal: Vec3::Y, height: 2.0 });
    assert!((all.center() - Vec3::splat(0.25)).length() < 1e-6);
    let none = submerged_hull(faces.clone().into_iter(), &WaterPlane { normal: Vec3::Y, height: -1.0 });
    assert_eq!((none.volume, none.center()), (0.0, Vec3::ZERO));
}
