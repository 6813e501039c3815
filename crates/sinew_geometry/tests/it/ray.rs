//! Rays, distances, bounds and masses of shapes, compared with marching and sampling.

use sinew_geometry::ray::Ray;
use sinew_geometry::{MassProperties, Shape};
use sinew_math::{Random, Rotation, Sym3, Transform, Vec3};

const SHAPES: [Shape; 11] = [
    Shape::Box { half_extents: Vec3::new(0.3, 0.8, 0.5) },
    Shape::Sphere { radius: 0.7 },
    Shape::Capsule { half_height: 0.6, radius: 0.25 },
    Shape::Capsule { half_height: 0.0, radius: 0.5 },
    Shape::TaperedCapsule { half_height: 0.4, radius_bottom: 0.5, radius_top: 0.2 },
    Shape::TaperedCapsule { half_height: 0.1, radius_bottom: 0.4, radius_top: 0.55 },
    Shape::Cylinder { half_height: 0.7, radius: 0.3 },
    Shape::Cylinder { half_height: 0.1, radius: 0.8 },
    Shape::Cone { half_height: 0.6, radius: 0.7 },
    Shape::Cone { half_height: 0.1, radius: 0.8 },
    Shape::HalfSpace,
];

/// Bounded shapes: all except the half-space.
fn solids() -> &'static [Shape] {
    SHAPES.split_last().expect("the list has shapes").1
}

fn from_axis(p: Vec3) -> f32 {
    (p.x * p.x + p.z * p.z).sqrt()
}

/// True if a point is in the shape, computed independently.
fn holds(shape: &Shape, p: Vec3) -> bool {
    match *shape {
        Shape::Box { half_extents: h } => p.x.abs() <= h.x && p.y.abs() <= h.y && p.z.abs() <= h.z,
        Shape::Sphere { radius } => p.length() <= radius,
        Shape::Capsule { half_height, radius } => {
            let beyond = (p.y.abs() - half_height).max(0.0);
            (p.x * p.x + p.z * p.z + beyond * beyond).sqrt() <= radius
        }
        Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
            // True if the point is in one of the balls between the two ends: ρ² + (y − c)² ≤ r², with c and r linear
            // along the axis.
            let (rho, y) = (f64::from(p.x).hypot(f64::from(p.z)), f64::from(p.y));
            let beyond = |t: f64| {
                let center = f64::from(half_height) * (2.0 * t - 1.0);
                let radius = f64::from(radius_bottom) * (1.0 - t) + f64::from(radius_top) * t;
                rho.hypot(y - center) - radius
            };
            // The function has one minimum, found by golden section search.
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..30 {
                let (u, v) = (low + 0.382 * (high - low), high - 0.382 * (high - low));
                if beyond(u) < beyond(v) {
                    high = v;
                } else {
                    low = u;
                }
            }
            beyond(0.0).min(beyond(1.0)).min(beyond(0.5 * (low + high))) <= 0.0
        }
        Shape::Cylinder { half_height, radius } => p.y.abs() <= half_height && from_axis(p) <= radius,
        Shape::Cone { half_height, radius } => {
            p.y.abs() <= half_height && from_axis(p) <= radius * (half_height - p.y) / (2.0 * half_height)
        }
        Shape::HalfSpace => p.y <= 0.0,
        Shape::Mesh(_) | Shape::HeightField(_) => unreachable!("surfaces have no inside"),
        Shape::Hull(ref hull) => hull.faces().all(|face| face.normal().dot(p) <= face.offset()),
    }
}

fn frames(random: &mut Random) -> Transform {
    Transform::new(random.in_cube() * 3.0, random.rotation())
}

/// Marching along the ray finds the same entry; the normal is that of the surface there.
#[test]
fn shape_rays_match_marching() {
    const STEPS: u32 = 4000;
    let mut random = Random::new(1);
    for shape in SHAPES {
        let surface: Vec<Vec3> = (0..500).filter_map(|_| surface_point(&shape, &mut random)).collect();
        let mut hits = 0;
        for case in 0..200 {
            let frame = frames(&mut random);
            let origin = frame.point(random.in_cube() * 1.5);
            let toward = frame.point(random.in_cube() * 0.8) - origin;
            let ray = Ray { origin, direction: toward * random.range(0.2, 2.0) };
            let marched = (0..=STEPS).map(|k| k as f32 / STEPS as f32).find(|t| {
                let p = frame.inverse_point(ray.at(*t));
                holds(&shape, p)
            });
            let step = 1.0 / STEPS as f32;
            match shape.cast_ray(&frame, &ray) {
                Some(hit) => {
                    hits += 1;
                    // Marching may step over a grazed edge.
                    let (depth, outward) = shape.signed_distance(&frame, hit.point);
                    assert!(hit.fraction == 0.0 || depth.abs() < 1e-5, "{shape:?} case {case}");
                    if let Some(t) = marched {
                        assert!(
                            hit.fraction <= t + 1e-5,
                            "{shape:?} case {case}: hit {hit:?}, by marching {t}"
                        );
                        assert!(
                            hit.fraction > t - 2.0 * step,
                            "{shape:?} case {case}: hit {hit:?}, by marching {t}"
                        );
                    }
                    if hit.fraction > 0.0 {
                        assert!(hit.normal.dot(ray.direction) <= 1e-5, "{shape:?} case {case}");
                        // The whole shape is behind the plane through the hit.
                        let behind =
                            surface.iter().all(|p| (frame.point(*p) - hit.point).dot(hit.normal) < 2e-4);
                        assert!(behind, "{shape:?} case {case}: outward {outward}, hit {hit:?}");
                    } else {
                        let back = -ray.direction / ray.direction.length();
                        assert!((hit.normal - back).length() < 1e-5, "{shape:?} case {case}");
                    }
                }
                None => assert!(marched.is_none(), "{shape:?} case {case}: no hit, by marching {marched:?}"),
            }
        }
        assert!(hits > 40, "{shape:?}: only {hits} hits");
    }
}

/// A ray of 10 km hits a ball of 1 cm at the right point.
#[test]
fn long_rays_keep_their_precision() {
    let ball = Shape::Sphere { radius: 0.01 };
    let ray = Ray { origin: Vec3::new(5000.0, 0.005, 0.0), direction: Vec3::new(-10_000.0, 0.0, 0.0) };
    let hit =
        ball.cast_ray(&Transform::IDENTITY, &ray).expect("the ray passes half a radius from the centre");
    assert!((hit.normal.y - 0.5).abs() < 0.05, "{hit:?}");
    let beside = Ray { origin: Vec3::new(5000.0, 0.0101, 0.0), ..ray };
    assert_eq!(ball.cast_ray(&Transform::IDENTITY, &beside), None);
}

#[test]
fn degenerate_rays_outside_a_shape_miss() {
    for shape in SHAPES {
        let outside = Vec3::new(0.0, 3.0, 0.0);
        for direction in [Vec3::ZERO, Vec3::Y, Vec3::new(f32::NAN, 0.0, 0.0)] {
            assert_eq!(
                shape.cast_ray(&Transform::IDENTITY, &Ray { origin: outside, direction }),
                None,
                "{shape:?}"
            );
        }
        let inside = Ray { origin: Vec3::new(0.0, -0.1, 0.0), direction: Vec3::ZERO };
        let hit = shape.cast_ray(&Transform::IDENTITY, &inside).expect("a ray from inside hits");
        assert_eq!(hit.fraction, 0.0);
        assert!((hit.normal.length() - 1.0).abs() < 1e-6, "{shape:?}");
    }
}

/// A displacement along the normal by the distance ends on the surface, and no sampled surface point is closer.
#[test]
fn signed_distance_matches_the_closest_surface_point() {
    let mut random = Random::new(2);
    for shape in SHAPES {
        let surface: Vec<Vec3> = (0..4000).filter_map(|_| surface_point(&shape, &mut random)).collect();
        for case in 0..300 {
            let frame = frames(&mut random);
            let local = random.in_cube() * 1.2;
            let (distance, normal) = shape.signed_distance(&frame, frame.point(local));
            assert!((normal.length() - 1.0).abs() < 1e-5, "{shape:?} case {case}");
            assert_eq!(distance < 0.0, holds(&shape, local), "{shape:?} case {case}");
            let foot = frame.inverse_point(frame.point(local) - normal * distance);
            let (off, _) = shape.signed_distance(&Transform::IDENTITY, foot);
            assert!(off.abs() < 1e-5, "{shape:?} case {case}: the closest point is {off} from the surface");
            let sampled = surface.iter().map(|p| (*p - local).length()).fold(f32::INFINITY, f32::min);
            assert!(
                distance.abs() <= sampled + 1e-5,
                "{shape:?} case {case}: distance {distance}, sampled {sampled}"
            );
        }
    }
}

/// Returns a point of the surface, by bisection between a point inside and a point outside.
fn surface_point(shape: &Shape, random: &mut Random) -> Option<Vec3> {
    let (mut inside, mut outside) = (random.in_cube(), random.direction() * 3.0);
    if !holds(shape, inside) || holds(shape, outside) {
        return None;
    }
    for _ in 0..40 {
        let middle = (inside + outside) * 0.5;
        if holds(shape, middle) {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    Some(inside)
}

/// Compares volume, mass and inertia with sums over a grid.
#[test]
fn mass_properties_match_integration() {
    const CELLS: i32 = 80;
    const CELL: f32 = 2.0 / CELLS as f32;
    let density = 700.0;
    let mut random = Random::new(4);
    for shape in solids() {
        let (mut mass, mut moment, mut inertia) = (0.0f64, 0.0f64, [0.0f64; 3]);
        for k in 0..CELLS * CELLS * CELLS {
            // Random within its cell, otherwise whole layers of cells would be inside or outside.
            let mut at = |i: i32| (i as f32 + random.unit()) * CELL - 1.0;
            let p = Vec3::new(at(k % CELLS), at(k / CELLS % CELLS), at(k / CELLS / CELLS));
            if holds(shape, p) {
                let m = f64::from(density * CELL * CELL * CELL);
                mass += m;
                moment += m * f64::from(p.y);
                for (axis, sum) in inertia.iter_mut().enumerate() {
                    *sum += m * f64::from(p.dot(p) - p[axis] * p[axis]);
                }
            }
        }
        let exact = shape.mass_properties(density);
        assert!(
            (f64::from(exact.mass) / mass - 1.0).abs() < 0.01,
            "{shape:?}: {exact:?}, sampled mass {mass}"
        );
        let center = moment / mass;
        assert!(
            (f64::from(exact.center.y) - center).abs() < 0.005,
            "{shape:?}: {exact:?}, sampled centre {center}"
        );
        for axis in 0..3 {
            let about_center = inertia[axis] - if axis == 1 { 0.0 } else { mass * center * center };
            let ratio = f64::from(exact.inertia.diagonal[axis]) / about_center;
            assert!((ratio - 1.0).abs() < 0.015, "{shape:?}: {exact:?}, sampled inertia {inertia:?}");
        }
    }
    assert_eq!(Shape::HalfSpace.mass_properties(density), MassProperties::default());
}

/// Two halves of a box, combined in a rotated frame, have the mass properties of the box.
#[test]
fn masses_of_two_halves_sum_to_the_box() {
    let whole = Shape::Box { half_extents: Vec3::new(0.4, 0.2, 0.1) }.mass_properties(1000.0);
    let half = Shape::Box { half_extents: Vec3::new(0.2, 0.2, 0.1) }.mass_properties(1000.0);
    let frame =
        Transform::new(Vec3::new(1.0, 2.0, 3.0), Rotation::from_scaled_axis(Vec3::new(0.3, -0.5, 0.9)));
    let part = |x: f32| half.transformed(&(frame * Transform::from_translation(Vec3::new(x, 0.0, 0.0))));
    let both = part(-0.2).combine(&part(0.2));
    let expected = whole.transformed(&frame);
    let far = |a: Sym3, b: Sym3| (a.diagonal - b.diagonal).length() + (a.off - b.off).length();
    assert!((both.mass - whole.mass).abs() < 1e-3);
    assert!((both.center - expected.center).length() < 1e-5);
    assert!(far(both.inertia, expected.inertia) < 1e-4 * whole.inertia.diagonal.length());
    let double = whole.scaled_to(2.0 * whole.mass);
    assert!(far(double.inertia, whole.inertia * 2.0) < 1e-6);
    assert_eq!(MassProperties::default().combine(&MassProperties::default()), MassProperties::default());
}

/// Bounds contain every point of the shape, and the shape touches each of their sides.
#[test]
fn bounds_touch_their_shape() {
    let mut random = Random::new(3);
    for shape in solids() {
        for _ in 0..20 {
            let frame = frames(&mut random);
            let bounds = shape.aabb(&frame);
            let mut slack = [f32::INFINITY; 6];
            for _ in 0..20_000 {
                let Some(p) = surface_point(shape, &mut random) else { continue };
                let p = frame.point(p);
                for axis in 0..3 {
                    slack[axis] = slack[axis].min(p[axis] - bounds.min[axis]);
                    slack[axis + 3] = slack[axis + 3].min(bounds.max[axis] - p[axis]);
                }
            }
            assert!(slack.iter().all(|s| *s > -1e-5 && *s < 0.2), "{shape:?}: {slack:?}");
        }
    }
    let ground = Shape::HalfSpace.aabb(&Transform::from_translation(Vec3::new(4.0, 1.5, 4.0)));
    assert_eq!(ground.max.y, 1.5);
    assert!(ground.min.is_finite() && ground.max.x > 1e8 && ground.min.y < -1e8);
    let slope = Shape::HalfSpace.aabb(&Transform::new(Vec3::ZERO, Rotation::from_axis_angle(Vec3::X, 0.1)));
    assert!(slope.max.y > 1e8);
}

#[test]
fn errors_name_the_invalid_size() {
    for shape in SHAPES {
        assert_eq!(shape.check(), Ok(()));
    }
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(Shape::Sphere { radius: bad }.check().is_err());
        assert!(Shape::Box { half_extents: Vec3::new(1.0, bad, 1.0) }.check().is_err());
        assert!(Shape::Capsule { half_height: 1.0, radius: bad }.check().is_err());
    }
    for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        for (half_height, radius) in [(bad, 1.0), (1.0, bad)] {
            assert!(Shape::Cylinder { half_height, radius }.check().is_err());
            assert!(Shape::Cone { half_height, radius }.check().is_err());
            for (radius_bottom, radius_top) in [(radius, 1.0), (1.0, radius)] {
                let tapered = Shape::TaperedCapsule { half_height, radius_bottom, radius_top };
                assert!(tapered.check().is_err());
            }
        }
    }
    let swallowed = Shape::TaperedCapsule { half_height: 0.5, radius_bottom: 1.5, radius_top: 0.5 };
    assert_eq!(
        swallowed.check(),
        Err(sinew_geometry::DefError::new("one end of a tapered capsule must not hold the other"))
    );
    for bad in [-1.0, f32::NAN, f32::INFINITY] {
        assert!(Shape::Capsule { half_height: bad, radius: 1.0 }.check().is_err());
    }
}
