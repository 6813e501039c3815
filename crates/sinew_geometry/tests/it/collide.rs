//! Narrow phase: pairs with closed forms, and every pair of kinds compared with brute force.

mod brute;
mod placed;

pub use placed::{FINITE, Kind, Placed, all_pairs, gap, random_rotation, random_shape, unit, wide};
use sinew_geometry::Shape;
use sinew_math::{Random, Rotation, Transform, Vec3};

fn unit_box(center: Vec3, rotation: Rotation) -> Placed {
    Placed { shape: Shape::Box { half_extents: Vec3::splat(0.5) }, frame: Transform::new(center, rotation) }
}

/// A box that overlaps another by 1 mm touches at its four corners; rotated by 45°, at four of the eight corners of an
/// octagon.
#[test]
fn box_on_box_touches_at_four_corners() {
    let below = unit_box(Vec3::ZERO, Rotation::IDENTITY);
    let above = unit_box(Vec3::new(0.0, 0.999, 0.0), Rotation::IDENTITY);
    let m = below.collide(&above, 0.02);
    assert_eq!(m.count, 4);
    assert!((m.normal - Vec3::Y).length() < 1e-6);
    for corner in [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)] {
        let expected = Vec3::new(corner.0, 0.4995, corner.1);
        let p = m
            .points()
            .iter()
            .find(|p| (p.position - expected).length() < 1e-5)
            .expect("expected a point at each corner");
        assert!((p.separation + 0.001).abs() < 1e-6);
    }

    let turned = unit_box(above.frame.translation, Rotation::from_axis_angle(Vec3::Y, 0.6));
    let m = below.collide(&turned, 0.02);
    assert_eq!(m.count, 4);
    let area = {
        let p: Vec<Vec3> = m.points().iter().map(|p| p.position).collect();
        0.5 * (p[2] - p[0]).cross(p[3] - p[1]).length()
    };
    // Four corners of a regular octagon around a circle of 1 m span at most 0.586 m².
    assert!(area > 0.53, "{area}");
}

/// Small boxes on a much larger one have their corners as contacts, in either order.
#[test]
fn small_box_on_large_box_touches_at_its_own_corners() {
    let ground = Placed {
        shape: Shape::Box { half_extents: Vec3::new(50.0, 1.0, 50.0) },
        frame: Transform::from_translation(Vec3::new(0.0, -1.0, 0.0)),
    };
    let small = Placed {
        shape: Shape::Box { half_extents: Vec3::splat(0.01) },
        frame: Transform::from_translation(Vec3::new(31.0, 0.0101, -17.0)),
    };
    for m in [ground.collide(&small, 0.001), small.collide(&ground, 0.001)] {
        assert_eq!(m.count, 4);
        for p in m.points() {
            assert!((p.separation - 0.0001).abs() < 5e-6, "{p:?}");
            let from_center = p.position - small.frame.translation;
            assert!((from_center.x.abs() - 0.01).abs() < 1e-5 && (from_center.z.abs() - 0.01).abs() < 1e-5);
        }
    }
}

/// Two boxes whose edges cross touch at one point, at the crossing.
#[test]
fn crossed_edges_touch_at_one_point() {
    let eighth = core::f32::consts::FRAC_PI_4;
    let below = unit_box(Vec3::ZERO, Rotation::from_axis_angle(Vec3::Z, eighth));
    let diagonal = 0.5f32.sqrt();
    for gap in [-0.01, 0.01] {
        let above =
            unit_box(Vec3::new(0.1, 2.0 * diagonal + gap, 0.2), Rotation::from_axis_angle(Vec3::X, eighth));
        let m = below.collide(&above, 0.02);
        assert_eq!(m.count, 1);
        assert!((m.normal - Vec3::Y).length() < 1e-5);
        assert!((m.points[0].separation - gap).abs() < 1e-5);
        // The lower edge runs along z at x = 0, the upper one along x at z = 0.2.
        assert!((m.points[0].position - Vec3::new(0.0, diagonal + 0.5 * gap, 0.2)).length() < 1e-5);
    }
}

/// Boxes that pass each other near a corner have the distance of the corners as separation, and no distant points.
#[test]
fn boxes_nearest_at_corners_have_contacts_at_those_corners() {
    let a = unit_box(Vec3::ZERO, Rotation::IDENTITY);
    let b = unit_box(Vec3::splat(1.01), Rotation::IDENTITY);
    let m = a.collide(&b, 0.02);
    assert_eq!(m.count, 1);
    assert!((m.points[0].separation - 0.01 * 3f32.sqrt()).abs() < 1e-5, "{m:?}");
    assert!((m.points[0].position - Vec3::splat(0.505)).length() < 1e-5, "{m:?}");
    assert_eq!(a.collide(&b, 0.017).count, 0);
}

/// A capsule that overhangs a box has one point at its end and one at the edge of the box.
#[test]
fn capsule_on_box_touches_along_a_line() {
    let ground = unit_box(Vec3::ZERO, Rotation::IDENTITY);
    let lying = Rotation::from_axis_angle(Vec3::Z, core::f32::consts::FRAC_PI_2);
    let capsule = Placed {
        shape: Shape::Capsule { half_height: 0.4, radius: 0.1 },
        frame: Transform::new(Vec3::new(0.3, 0.599, 0.0), lying),
    };
    let m = ground.collide(&capsule, 0.02);
    assert_eq!(m.count, 2);
    assert!((m.normal - Vec3::Y).length() < 1e-5);
    let mut x: Vec<f32> = m.points().iter().map(|p| p.position.x).collect();
    x.sort_by(f32::total_cmp);
    assert!((x[0] + 0.1).abs() < 1e-5 && (x[1] - 0.5).abs() < 1e-5, "{x:?}");
    assert!(m.points().iter().all(|p| (p.separation + 0.001).abs() < 1e-5));
}

/// Feature ids do not change while a box rocks and slides by less than a millimetre.
#[test]
fn feature_ids_survive_small_motion() {
    let mut random = Random::new(4);
    let below = unit_box(Vec3::ZERO, Rotation::IDENTITY);
    for angle in [0.0, 0.3, 0.785] {
        let turn = Rotation::from_axis_angle(Vec3::Y, angle);
        let names = |offset: Vec3, tilt: Vec3| {
            let rotation = Rotation::from_scaled_axis(tilt) * turn;
            let m = below.collide(&unit_box(Vec3::new(0.0, 0.999, 0.0) + offset, rotation), 0.02);
            let mut features: Vec<u32> = m.points().iter().map(|p| p.feature).collect();
            features.sort_unstable();
            features
        };
        let at_rest = names(Vec3::ZERO, Vec3::ZERO);
        assert_eq!(at_rest.len(), 4);
        for _ in 0..200 {
            let moved = names(random.in_cube() * 1e-4, random.in_cube() * 1e-5);
            assert_eq!(at_rest, moved, "at {angle}");
        }
    }
}

/// All shapes with coincident centres, flat boxes, and capsules of length zero have finite unit normals.
#[test]
fn degenerate_pairs_have_finite_contacts() {
    let shapes = [
        Shape::Box { half_extents: Vec3::new(0.5, 0.0005, 0.5) },
        Shape::Box { half_extents: Vec3::splat(0.005) },
        Shape::Box { half_extents: Vec3::splat(50.0) },
        Shape::Sphere { radius: 0.005 },
        Shape::Sphere { radius: 50.0 },
        Shape::Capsule { half_height: 0.0, radius: 0.1 },
        Shape::Capsule { half_height: 50.0, radius: 0.005 },
        Shape::HalfSpace,
    ];
    let mut random = Random::new(5);
    let rotations = [Rotation::IDENTITY, Rotation::IDENTITY, random.rotation()];
    for sa in &shapes {
        for sb in &shapes {
            for rotation in rotations {
                let a = Placed { shape: sa.clone(), frame: Transform::IDENTITY };
                let b = Placed { shape: sb.clone(), frame: Transform::new(Vec3::ZERO, rotation) };
                let m = a.collide(&b, 0.01);
                if *sa == Shape::HalfSpace && *sb == Shape::HalfSpace {
                    assert_eq!(m.count, 0);
                    continue;
                }
                assert!(m.count > 0, "{a:?} {b:?}");
                assert!((m.normal.length() - 1.0).abs() < 1e-4, "{a:?} {b:?} {m:?}");
                assert!(m.points().iter().all(|p| p.separation <= 0.01 && p.position.is_finite()));
            }
        }
    }
}

/// NaN gives no contact and no panic.
#[test]
fn nan_gives_no_contact() {
    let shapes = [
        Shape::Box { half_extents: Vec3::ONE },
        Shape::Box { half_extents: Vec3::new(1.0, f32::NAN, 1.0) },
        Shape::Sphere { radius: f32::NAN },
        Shape::Capsule { half_height: f32::NAN, radius: 1.0 },
        Shape::HalfSpace,
    ];
    for sa in &shapes {
        for sb in &shapes {
            for x in [f32::NAN, f32::INFINITY] {
                let a = Placed { shape: sa.clone(), frame: Transform::IDENTITY };
                let b =
                    Placed { shape: sb.clone(), frame: Transform::from_translation(Vec3::new(0.0, x, 0.0)) };
                assert_eq!(a.collide(&b, 0.01).count, 0);
                assert_eq!(b.collide(&a, 0.01).count, 0);
            }
            let a = Placed { shape: sa.clone(), frame: Transform::IDENTITY };
            let b = Placed { shape: sb.clone(), frame: Transform::IDENTITY };
            let m = a.collide(&b, 0.01);
            assert!(m.normal.is_finite());
            assert!(m.points().iter().all(|p| p.separation.is_finite() && p.position.is_finite()));
        }
    }
}
