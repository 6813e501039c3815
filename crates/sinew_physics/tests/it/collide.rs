//! Narrow phase: every pair of shapes against the support functions of both, in `f64`.

use sinew_math::{Random, Rotation, Transform, Vec3};
use sinew_physics::Shape;
use sinew_physics::collide::{Manifold, ManifoldPoint, collide};

/// One shape, placed.
#[derive(Clone, Debug)]
struct Placed {
    shape: Shape,
    frame: Transform,
}

impl Placed {
    /// Furthest extent along the unit vector `n` (for a half-space: of its plane, if `n` is its normal).
    fn support(&self, n: [f64; 3]) -> f64 {
        let m = self.frame.rotation.to_mat3();
        let along = |v: Vec3| f64::from(v.x) * n[0] + f64::from(v.y) * n[1] + f64::from(v.z) * n[2];
        let center = along(self.frame.translation);
        match self.shape {
            Shape::Box { half_extents: h } => {
                center
                    + f64::from(h.x) * along(m.x_axis).abs()
                    + f64::from(h.y) * along(m.y_axis).abs()
                    + f64::from(h.z) * along(m.z_axis).abs()
            }
            Shape::Sphere { radius } => center + f64::from(radius),
            Shape::Capsule { half_height, radius } => {
                center + f64::from(half_height) * along(m.y_axis).abs() + f64::from(radius)
            }
            Shape::Mesh(_) | Shape::HeightField(_) => unreachable!("surfaces have no core"),
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                let reach = f64::from(half_height) * along(m.y_axis);
                center + (reach + f64::from(radius_top)).max(f64::from(radius_bottom) - reach)
            }
            Shape::Cylinder { half_height, radius } => {
                let across = along(m.x_axis).hypot(along(m.z_axis));
                center + f64::from(half_height) * along(m.y_axis).abs() + f64::from(radius) * across
            }
            Shape::Cone { half_height, radius } => {
                let across = along(m.x_axis).hypot(along(m.z_axis));
                let reach = f64::from(half_height) * along(m.y_axis);
                center + reach.max(f64::from(radius) * across - reach)
            }
            Shape::HalfSpace => {
                if along(m.y_axis) > 0.999_9 {
                    center
                } else {
                    f64::INFINITY
                }
            }
        }
    }

    fn size(&self) -> f32 {
        if self.shape == Shape::HalfSpace { 0.0 } else { self.shape.bounding_radius() }
    }

    fn collide(&self, other: &Self, margin: f32) -> Manifold {
        let mut out = Manifold::default();
        collide(&self.shape, &self.frame, &other.shape, &other.frame, margin, &mut out);
        out
    }
}

fn wide(v: Vec3) -> [f64; 3] {
    [f64::from(v.x), f64::from(v.y), f64::from(v.z)]
}

fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let l = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    (l > 1e-9).then(|| v.map(|x| x / l))
}

/// Gap between two shapes along `n`, from `a` to `b`.
fn gap(a: &Placed, b: &Placed, n: [f64; 3]) -> f64 {
    -b.support(n.map(|x| -x)) - a.support(n)
}

/// The largest gap over all directions: the distance of two convex shapes, or minus the depth of their overlap.
/// Candidate directions, then a pattern search from the best ones.
fn true_gap(a: &Placed, b: &Placed, random: &mut Random) -> (f64, [f64; 3]) {
    if a.shape == Shape::HalfSpace {
        let n = wide(a.frame.rotation * Vec3::Y);
        return (gap(a, b, n), n);
    }
    let (ma, mb) = (a.frame.rotation.to_mat3(), b.frame.rotation.to_mat3());
    let axes_a = [ma.x_axis, ma.y_axis, ma.z_axis];
    let axes_b = [mb.x_axis, mb.y_axis, mb.z_axis];
    let mut candidates: Vec<Vec3> = axes_a.into_iter().chain(axes_b).collect();
    candidates.extend(axes_a.iter().flat_map(|u| axes_b.iter().map(|v| u.cross(*v))));
    candidates.push(b.frame.translation - a.frame.translation);
    candidates.extend((0..200).map(|_| random.direction()));
    let mut scored: Vec<(f64, [f64; 3])> = candidates
        .into_iter()
        .flat_map(|v| [v, -v])
        .filter_map(|v| unit(wide(v)))
        .map(|n| (gap(a, b, n), n))
        .collect();
    scored.sort_by(|x, y| y.0.total_cmp(&x.0));
    scored.truncate(4);
    let refined = scored.into_iter().map(|(g, n)| refine(a, b, g, n, random));
    refined.reduce(|x, y| if y.0 > x.0 { y } else { x }).expect("there are candidates")
}

/// Random steps, ever shorter: the gap has kinks on which a search along fixed directions gets stuck.
fn refine(a: &Placed, b: &Placed, mut best: f64, mut n: [f64; 3], random: &mut Random) -> (f64, [f64; 3]) {
    let mut step = 0.2;
    while step > 1e-6 {
        let mut moved = false;
        for _ in 0..24 {
            let offset = wide(random.direction());
            let Some(other) = unit([0, 1, 2].map(|k| n[k] + step * offset[k])) else { continue };
            let g = gap(a, b, other);
            if g > best {
                (best, n, moved) = (g, other, true);
            }
        }
        if !moved {
            step *= 0.6;
        }
    }
    (best, n)
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Box,
    Sphere,
    Capsule,
    TaperedCapsule,
    Cylinder,
    Cone,
    HalfSpace,
}

const FINITE: [Kind; 6] =
    [Kind::Box, Kind::Sphere, Kind::Capsule, Kind::TaperedCapsule, Kind::Cylinder, Kind::Cone];

fn random_shape(kind: Kind, scale: f32, random: &mut Random) -> Shape {
    let mut side = || scale * random.range(0.2, 1.0);
    match kind {
        Kind::Box => Shape::Box { half_extents: Vec3::new(side(), side(), side()) },
        Kind::Sphere => Shape::Sphere { radius: side() },
        Kind::Capsule => Shape::Capsule { half_height: side(), radius: 0.4 * side() },
        Kind::TaperedCapsule => {
            let radius_bottom = 0.4 * side();
            // Neither ball holds the other.
            Shape::TaperedCapsule { half_height: side(), radius_bottom, radius_top: 0.4 * side() }
        }
        Kind::Cylinder => Shape::Cylinder { half_height: side(), radius: 0.6 * side() },
        Kind::Cone => Shape::Cone { half_height: side(), radius: side() },
        Kind::HalfSpace => Shape::HalfSpace,
    }
}

fn random_rotation(random: &mut Random) -> Rotation {
    // A third of the cases are aligned, a third nearly so: that is where contacts live.
    match random.index(3) {
        0 => Rotation::IDENTITY,
        1 => Rotation::from_scaled_axis(random.in_cube() * 0.02),
        _ => random.rotation(),
    }
}

/// Two shapes near contact: overlapping by up to a third of their size or apart by up to a tenth.
fn random_pair(ka: Kind, kb: Kind, random: &mut Random) -> (Placed, Placed) {
    let scale = [0.01, 0.1, 1.0, 10.0][random.index(4)];
    let ratio = [1.0, 1.0, 5.0][random.index(3)];
    let common = random.rotation();
    let place = |kind: Kind, scale: f32, random: &mut Random| Placed {
        shape: random_shape(kind, scale, random),
        frame: Transform::new(random.in_cube() * scale, common * random_rotation(random)),
    };
    let a = place(ka, scale, random);
    let mut b = place(kb, scale * ratio, random);
    b.frame.translation += random.direction() * scale;
    let wanted = f64::from(scale * random.range(-0.3, 0.1));
    for _ in 0..2 {
        let (now, n) = true_gap(&a, &b, random);
        b.frame.translation += Vec3::from_array(n.map(|x| (x * (wanted - now)) as f32));
    }
    (a, b)
}

fn all_pairs() -> impl Iterator<Item = (Kind, Kind)> {
    FINITE
        .into_iter()
        .flat_map(|a| FINITE.into_iter().map(move |b| (a, b)))
        .chain(FINITE.into_iter().map(|b| (Kind::HalfSpace, b)))
}

/// The normal is the best direction, the separation the gap along it, and there is a manifold exactly when the
/// shapes are within the margin.
#[test]
fn matches_the_support_functions() {
    let mut random = Random::new(1);
    for (ka, kb) in all_pairs() {
        for case in 0..200 {
            let (a, b) = random_pair(ka, kb, &mut random);
            let size = f64::from(a.size() + b.size());
            let margin = 0.05 * a.size().max(b.size());
            let m = a.collide(&b, margin);
            // Every direction bounds the gap from below: the search may stop short of its best, but not of this one.
            let along = if m.count > 0 { gap(&a, &b, wide(m.normal)) } else { f64::NEG_INFINITY };
            let truth = true_gap(&a, &b, &mut random).0.max(along);
            let context = || format!("{ka:?} {kb:?} case {case}: true gap {truth}, {m:?}\n{a:?}\n{b:?}");
            let rounding = 2e-5 * size;
            if m.count == 0 {
                assert!(truth > f64::from(margin) - rounding, "missed: {}", context());
                continue;
            }
            assert!(truth <= f64::from(margin) + rounding, "invented: {}", context());
            assert!((m.normal.length() - 1.0).abs() < 1e-4, "not unit: {}", context());
            // Faces are preferred to edges that are slightly better, and their normals to those that are slightly
            // off; for the rest it is the best direction.
            let thinnest = f64::from(a.shape.inner_radius().min(b.shape.inner_radius()));
            let preference = match (ka, kb) {
                (Kind::Box, Kind::Box | Kind::Capsule) | (Kind::Capsule, Kind::Box) => {
                    0.06 * truth.abs() + 0.011 * thinnest + 5e-4 * size
                }
                _ => 0.0,
            };
            assert!(along > truth - preference - rounding, "gap {along} along the normal: {}", context());
            let nearest = m.points().iter().map(|p| f64::from(p.separation)).fold(f64::INFINITY, f64::min);
            assert!(nearest > along - rounding - 1e-4 * size, "too deep, {along}: {}", context());
            if truth > 0.0 {
                assert!(nearest < truth + preference + 1e-3 * size, "too far: {}", context());
            }
        }
    }
}

/// A point lies half-way between the surfaces along the normal, on both shapes.
#[test]
fn points_lie_between_the_surfaces() {
    let mut random = Random::new(2);
    let mut off = 0;
    let mut points = 0;
    for (ka, kb) in all_pairs() {
        for _ in 0..200 {
            let (a, b) = random_pair(ka, kb, &mut random);
            let size = a.size().max(b.size());
            let m = a.collide(&b, 0.05 * size);
            for p in m.points() {
                let half = m.normal * (0.5 * p.separation);
                let (on_a, _) = a.shape.signed_distance(&a.frame, p.position - half);
                let (on_b, _) = b.shape.signed_distance(&b.frame, p.position + half);
                assert!(p.separation <= 0.05 * size);
                points += 1;
                off += usize::from(on_a.abs() > 0.01 * size || on_b.abs() > 0.01 * size);
            }
        }
    }
    assert!(points > 2500, "{points} points");
    println!("{off} of {points} points off a surface");
    assert!(off * 100 < points, "{off} of {points} points are off a surface");
}

/// The other order of the shapes gives the opposite normal, the same points, and features with exchanged halves.
#[test]
fn the_order_of_the_shapes_does_not_matter() {
    let mut random = Random::new(3);
    for (ka, kb) in all_pairs() {
        for case in 0..150 {
            let (a, b) = random_pair(ka, kb, &mut random);
            let size = a.size().max(b.size());
            let (ab, ba) = (a.collide(&b, 0.05 * size), b.collide(&a, 0.05 * size));
            let context = || format!("{ka:?} {kb:?} case {case}\n{ab:?}\n{ba:?}\n{a:?}\n{b:?}");
            assert_eq!(ab.count, ba.count, "{}", context());
            assert!((ab.normal + ba.normal).length() < 1e-3, "{}", context());
            for p in ab.points() {
                let far = |q: &ManifoldPoint| (q.position - p.position).length();
                let twin = ba.points().iter().min_by(|q, r| far(q).total_cmp(&far(r))).expect("equal counts");
                assert!(far(twin) < 2e-3 * size, "no twin of {p:?}: {}", context());
                assert!((p.separation - twin.separation).abs() < 1e-3 * size, "{}", context());
                if ka != kb {
                    assert_eq!(p.feature, twin.feature.rotate_left(16), "{}", context());
                }
            }
        }
    }
}

fn unit_box(center: Vec3, rotation: Rotation) -> Placed {
    Placed { shape: Shape::Box { half_extents: Vec3::splat(0.5) }, frame: Transform::new(center, rotation) }
}

/// A box sunk into another by 1 mm touches at its four corners; turned, at four of the eight corners of an octagon.
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
            .expect("a point at each corner");
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

/// Small boxes on a far larger one have their corners as contacts, whichever comes first.
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

/// Two boxes edge over edge, crossed: one point, at the crossing.
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

/// Boxes that pass corner by corner get the distance of the corners and nothing that is far from both.
#[test]
fn corners_that_pass_each_other_touch_at_the_corners() {
    let a = unit_box(Vec3::ZERO, Rotation::IDENTITY);
    let b = unit_box(Vec3::splat(1.01), Rotation::IDENTITY);
    let m = a.collide(&b, 0.02);
    assert_eq!(m.count, 1);
    assert!((m.points[0].separation - 0.01 * 3f32.sqrt()).abs() < 1e-5, "{m:?}");
    assert!((m.points[0].position - Vec3::splat(0.505)).length() < 1e-5, "{m:?}");
    assert_eq!(a.collide(&b, 0.017).count, 0);
}

/// A capsule lying on a box, hanging over its rim: one point at its end, one where the box ends.
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

/// Features keep their names while a box rocks and slides by less than a millimetre.
#[test]
fn features_survive_small_motion() {
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

/// Whatever the shapes: a finite unit normal for coincident centres, flat boxes, capsules without a middle.
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

/// Numbers that are none give no contact, and no panic.
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
