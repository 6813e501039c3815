//! Triangles against shapes, and meshes against rays and points, compared with brute force.

use crate::cases::cases;
use sinew_geometry::collide::{Manifold, collide_all};
use sinew_geometry::ray::Ray;
use sinew_geometry::*;
use sinew_math::{Random, Rotation, Transform, Vec3};
use std::sync::Arc;

const MARGIN: f32 = 0.3;

fn triangle(random: &mut Random) -> [Vec3; 3] {
    loop {
        let corners = [random.in_cube(), random.in_cube(), random.in_cube()];
        let [a, b, c] = corners;
        if (b - a).cross(c - a).length() > 0.1 {
            return corners;
        }
    }
}

fn mesh_of(corners: &[Vec3]) -> Shape {
    let triangles: Vec<[u32; 3]> =
        (0..corners.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Shape::Mesh(Arc::new(Mesh::new(corners, &triangles).unwrap()))
}

/// Bounded kinds of convex shapes.
const KINDS: usize = 7;

fn shape(kind: usize, random: &mut Random) -> Shape {
    let mut size = || random.range(0.05, 0.5);
    let (a, b, c) = (size(), size(), size());
    match kind {
        0 => Shape::Sphere { radius: a },
        1 => Shape::Capsule { half_height: a, radius: b },
        2 => Shape::Cylinder { half_height: a, radius: b },
        3 => Shape::Cone { half_height: a, radius: b },
        4 => {
            let points: Vec<Vec3> = (0..12).map(|_| random.in_cube() * 0.5).collect();
            Shape::Hull(Arc::new(Hull::new(&points).unwrap()))
        }
        5 => Shape::TaperedCapsule { half_height: 0.5, radius_bottom: a, radius_top: b },
        _ => Shape::Box { half_extents: Vec3::new(a, b, c) },
    }
}

/// Returns the distance of a convex shape from a triangle, negative for an overlap. The signed distance is a convex
/// function over the triangle; two nested searches find its minimum.
fn distance(shape: &Shape, frame: &Transform, &[a, b, c]: &[Vec3; 3]) -> f32 {
    let least = |f: &dyn Fn(f32) -> f32| {
        let (mut low, mut high) = (0.0_f32, 1.0_f32);
        for _ in 0..24 {
            let (left, right) = (low + (high - low) * 0.382, low + (high - low) * 0.618);
            if f(left) < f(right) { high = right } else { low = left }
        }
        f(0.5 * (low + high))
    };
    let along = |s: f32| {
        let (from, to) = (a + (b - a) * s, a + (c - a) * s);
        least(&|t: f32| shape.signed_distance(frame, from + (to - from) * t).0)
    };
    least(&along)
}

fn contacts(a: &Shape, at: &Transform, b: &Shape, bt: &Transform) -> Vec<Manifold> {
    let mut found = Vec::new();
    collide_all(a, at, b, bt, MARGIN, |manifold| found.push(*manifold));
    found
}

fn nearest(manifolds: &[Manifold]) -> f32 {
    let points = manifolds.iter().flat_map(Manifold::points);
    points.fold(f32::INFINITY, |least, point| least.min(point.separation))
}

/// Runs 100,000 cases of each kind with `SINEW_FULL` set, otherwise a hundredth.
#[test]
fn triangle_distances_match_search() {
    let mut random = Random::new(41);
    for kind in 0..KINDS {
        near_a_triangle(kind, &mut random);
    }
}

fn near_a_triangle(kind: usize, random: &mut Random) {
    let (mut apart, mut deep) = (0, 0);
    for case in 0..cases(100_000) {
        let corners = triangle(random);
        let (mesh, shape) = (mesh_of(&corners), shape(kind, random));
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize();
        let over = a + (b - a) * random.range(-0.2, 0.7) + (c - a) * random.range(-0.2, 0.7);
        // A triangle is solid only from its front, so the centre of the shape is in front.
        let rotation = random.rotation();
        let away = normal * random.range(0.02, 1.0) - rotation * middle(&shape);
        let frame = Transform::new(over + away, rotation);
        let expected = distance(&shape, &frame, &corners);
        let found = contacts(&mesh, &Transform::IDENTITY, &shape, &frame);
        let separation = nearest(&found);
        let place = format!("case {case}: {shape:?} at {frame:?} over {corners:?}: {expected}, {found:?}");
        // Round ends are represented by octagons, round sides by lines.
        let round =
            matches!(shape, Shape::Cylinder { .. } | Shape::Cone { .. } | Shape::TaperedCapsule { .. });
        let tolerance = 2e-3 + if round { 0.08 * shape.bounding_radius() } else { 0.0 };
        if expected > MARGIN + 1e-3 {
            assert!(found.is_empty(), "{place}");
        } else if (1e-3..MARGIN - 1e-3).contains(&expected) {
            apart += 1;
            assert!(found.len() == 1 && (separation - expected).abs() < tolerance, "{place}");
        } else if expected < -1e-3 {
            deep += 1;
            // The shape moved along the normal no longer overlaps.
            assert!(found.len() == 1 && separation < 0.0, "{place}");
            let left = distance(&shape, &moved_out(&frame, &found[0]), &corners);
            // Depths within a twentieth count as deepest. The depth of a capsule that is deeper than half its thickness
            // is measured over the triangle alone.
            let measured = expected > -0.5 * shape.inner_radius() || !matches!(shape, Shape::Capsule { .. });
            assert!(!measured || left > -2e-3 + 0.05 * separation, "{place}, {left}");
        }
        for manifold in &found {
            assert!((manifold.normal.length() - 1.0).abs() < 1e-5, "{place}");
            assert!(manifold.points().iter().all(|point| point.separation <= MARGIN), "{place}");
        }
    }
    assert!(
        apart * 5 > cases(100_000) && deep * 10 > cases(100_000),
        "{apart} separated, {deep} overlapping pairs"
    );
}

/// Moves a shape out along the normal of its manifold, a millimetre further than the separation.
fn moved_out(frame: &Transform, manifold: &Manifold) -> Transform {
    let separation = nearest(core::slice::from_ref(manifold));
    Transform::new(frame.translation - manifold.normal * (separation - 1e-3), frame.rotation)
}

/// The lowest face over the triangle is not the deepest part of the hull: a steeper face beside it is deeper by 23 mm.
#[test]
fn deepest_face_beside_the_lowest_is_used() {
    let corners =
        [Vec3::new(-0.967, 0.802, 0.770), Vec3::new(-0.015, -0.123, 0.869), Vec3::new(-0.248, 0.688, -0.870)];
    let points = [
        Vec3::new(-0.470, -0.233, -0.040),
        Vec3::new(-0.465, 0.308, 0.152),
        Vec3::new(-0.451, -0.137, 0.201),
        Vec3::new(-0.349, 0.460, 0.118),
        Vec3::new(-0.319, -0.426, -0.443),
        Vec3::new(-0.059, 0.111, 0.409),
        Vec3::new(-0.005, 0.359, 0.030),
        Vec3::new(0.191, -0.458, -0.289),
        Vec3::new(0.283, 0.317, -0.174),
        Vec3::new(0.395, -0.486, -0.044),
    ];
    let hull = Shape::Hull(Arc::new(Hull::new(&points).unwrap()));
    let rotation = Rotation { x: 0.672, y: 0.115, z: 0.657, w: 0.321 }.normalize();
    let frame = Transform::new(Vec3::new(-0.373, 0.284, 1.186), rotation);
    let found = contacts(&mesh_of(&corners), &Transform::IDENTITY, &hull, &frame);
    assert_eq!(found.len(), 1);
    let (before, after) =
        (distance(&hull, &frame, &corners), distance(&hull, &moved_out(&frame, &found[0]), &corners));
    assert!(
        before < -0.09 && (0.0..2e-3).contains(&after),
        "separation {before} before, {after} after: {found:?}"
    );
}

/// The separation of a box edge above the top of a pyramid is the edge's height: no side of the pyramid treats the top
/// as a point of an edge, which the other sides would reject.
#[test]
fn edge_over_a_peak_has_contacts() {
    let peak = Vec3::Y * 0.5;
    let foot = [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0)].map(|(x, z)| Vec3::new(x, 0.0, z));
    let vertices = [peak, foot[0], foot[1], foot[2], foot[3]];
    let sides = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]];
    let pyramid = Shape::Mesh(Arc::new(Mesh::new(&vertices, &sides).unwrap()));
    let mut random = Random::new(46);
    for case in 0..1_000 {
        let mut size = || random.range(0.05, 0.5);
        let half_extents = Vec3::new(size(), size(), size());
        let gap = random.range(0.01, 0.25);
        let roll = Rotation::from_axis_angle(Vec3::X, random.range(0.4, 1.1));
        let rotation = Rotation::from_axis_angle(Vec3::Y, random.range(0.0, 6.0)) * roll;
        let over = half_extents * Vec3::new(random.range(-0.9, 0.9), -1.0, 1.0);
        let frame = Transform::new(peak + Vec3::Y * gap - rotation * over, rotation);
        let found = contacts(&pyramid, &Transform::IDENTITY, &Shape::Box { half_extents }, &frame);
        assert!((nearest(&found) - gap).abs() < 1e-4, "case {case}: gap {gap}, manifold {found:?}");
    }
}

#[test]
fn mesh_contacts_are_independent_of_order_and_position() {
    let mut random = Random::new(42);
    for kind in 0..KINDS {
        for case in 0..cases(100_000) {
            let corners = triangle(&mut random);
            let (mesh, shape) = (mesh_of(&corners), shape(kind, &mut random));
            let frame = Transform::new(random.in_cube() * 0.8, random.rotation());
            let found = contacts(&mesh, &Transform::IDENTITY, &shape, &frame);
            check_exchanged(&found, &contacts(&shape, &frame, &mesh, &Transform::IDENTITY));
            let turn = Transform::new(random.in_cube() * 3.0, random.rotation());
            let turned = contacts(&mesh, &turn, &shape, &(turn * frame));
            let place = format!("case {case}: {shape:?} at {frame:?} over {corners:?}: {found:?} {turned:?}");
            let (here, there) = (nearest(&found), nearest(&turned));
            // At the margin, and with the centre in the plane, rounding decides whether there is a contact.
            if !found.is_empty() && !turned.is_empty() {
                assert!((here - there).abs() < 5e-3, "{place}");
            }
        }
    }
}

/// Swapped shapes give the same points, opposite normals, and features with exchanged halves.
fn check_exchanged(found: &[Manifold], swapped: &[Manifold]) {
    assert_eq!(found.len(), swapped.len());
    for (one, other) in found.iter().zip(swapped) {
        assert_eq!(one.normal, -other.normal);
        for (p, q) in one.points().iter().zip(other.points()) {
            assert_eq!((p.position, p.separation), (q.position, q.separation));
            assert_eq!(p.feature, q.feature.rotate_left(16));
        }
    }
}

fn bumps(random: &mut Random, side: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let at = |i: usize, j: usize, y: f32| Vec3::new(i as f32 * 0.5, y, j as f32 * 0.5);
    let mut vertices = Vec::new();
    for j in 0..=side {
        vertices.extend((0..=side).map(|i| at(i, j, random.range(0.0, 0.6))));
    }
    let mut triangles = Vec::new();
    for j in 0..side {
        for i in 0..side {
            let index = |i: usize, j: usize| (i + j * (side + 1)) as u32;
            let [a, b, c, d] = [index(i, j), index(i, j + 1), index(i + 1, j + 1), index(i + 1, j)];
            triangles.extend([[a, b, d], [d, b, c]]);
        }
    }
    (vertices, triangles)
}

/// Returns the same terrain as a mesh and as a height field, and its triangles.
fn terrain(random: &mut Random, side: usize) -> (Shape, Shape, Vec<[Vec3; 3]>) {
    let (vertices, triangles) = bumps(random, side);
    let def = HeightFieldDef {
        columns: side + 1,
        rows: side + 1,
        spacing: [0.5; 2],
        heights: vertices.iter().map(|v| v.y).collect(),
        holes: Vec::new(),
    };
    let corners = triangles.iter().map(|t| t.map(|i| vertices[i as usize])).collect();
    let mesh = Shape::Mesh(Arc::new(Mesh::new(&vertices, &triangles).unwrap()));
    (mesh, Shape::HeightField(Arc::new(HeightField::new(def).unwrap())), corners)
}

/// The nearest contact of a shape over terrain is that of the nearest triangle, each triangle tested alone.
#[test]
fn terrain_distance_equals_that_of_the_nearest_triangle() {
    let mut random = Random::new(45);
    let (mesh, field, corners) = terrain(&mut random, 12);
    let alone: Vec<Shape> = corners.iter().map(|corners| mesh_of(corners)).collect();
    let still = Transform::IDENTITY;
    for kind in 0..KINDS {
        let (mut apart, mut off, mut deep, mut lost) = (0, 0, 0, 0);
        for _ in 0..cases(100_000) {
            let shape = shape(kind, &mut random);
            let place = Vec3::new(random.range(1.5, 4.5), random.range(0.2, 1.4), random.range(1.5, 4.5));
            let frame = Transform::new(place, random.rotation());
            let middle = frame.point(middle(&shape));
            let down = Ray { origin: middle, direction: Vec3::NEG_Y * 2.0 };
            if mesh.cast_ray(&still, &down).is_none() {
                continue;
            }
            // A triangle of a closed surface is not solid from its back.
            let reach = shape.aabb(&frame).expand(MARGIN);
            let faces = |&[a, b, c]: &[Vec3; 3]| (b - a).cross(c - a).dot(middle - a) > 0.0;
            let meets = |&[a, b, c]: &[Vec3; 3]| {
                a.min(b).min(c).cmple(reach.max).all() && a.max(b).max(c).cmpge(reach.min).all()
            };
            let near = corners.iter().zip(&alone).filter(|(corners, _)| meets(corners) && faces(corners));
            let each = near.map(|(_, alone)| nearest(&contacts(alone, &still, &shape, &frame)));
            let expected = each.fold(f32::INFINITY, f32::min);
            for surface in [&mesh, &field] {
                let found = contacts(surface, &still, &shape, &frame);
                check_exchanged(&found, &contacts(&shape, &frame, surface, &still));
                if expected > MARGIN {
                    assert!(
                        found.is_empty(),
                        "{shape:?} at {frame:?}: separation {expected}, manifold {found:?}"
                    );
                } else if (1e-3..MARGIN - 1e-3).contains(&expected) {
                    apart += 1;
                    off += u32::from((nearest(&found) - expected).abs() > 2e-3);
                } else if expected < -1e-3 {
                    deep += 1;
                    lost += u32::from(nearest(&found) > 0.0);
                }
            }
        }
        println!(
            "kind {kind}: {off} of {apart} separated points are wrong, {lost} of {deep} points inside have no contact"
        );
        assert!(
            apart * 10 > cases(100_000) && deep * 10 > cases(100_000),
            "{apart} separated, {deep} overlapping pairs"
        );
        assert!(
            off * 20_000 <= apart && lost * 20_000 <= deep,
            "kind {kind}: wrong at {off} of {apart} separated points, missed {lost} of {deep} inside"
        );
    }
}

/// Returns a point well inside a shape, which decides if the shape is in front of a triangle.
fn middle(shape: &Shape) -> Vec3 {
    let centred = matches!(shape, Shape::Hull(_) | Shape::Cone { .. });
    if centred { shape.mass_properties(1.0).center } else { Vec3::ZERO }
}

/// Returns the parameter at which a ray passes through a triangle from above, by plane and barycentric coordinates in
/// `f64`.
fn pierced(&[a, b, c]: &[Vec3; 3], ray: &Ray) -> Option<f64> {
    let wide = |v: Vec3| v.to_array().map(f64::from);
    let sub = |p: [f64; 3], q: [f64; 3]| core::array::from_fn::<f64, 3, _>(|k| p[k] - q[k]);
    let cross = |p: [f64; 3], q: [f64; 3]| {
        [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
    };
    let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let (o, d) = (wide(ray.origin), wide(ray.direction));
    let [a, b, c] = [a, b, c].map(wide);
    let normal = cross(sub(b, a), sub(c, a));
    let toward = dot(normal, d);
    if toward >= 0.0 {
        return None;
    }
    let t = dot(normal, sub(a, o)) / toward;
    let p = [o[0] + d[0] * t, o[1] + d[1] * t, o[2] + d[2] * t];
    let inside = [(a, b), (b, c), (c, a)]
        .into_iter()
        .all(|(p0, p1)| dot(cross(sub(p1, p0), sub(p, p0)), normal) >= 0.0);
    (inside && (0.0..=1.0).contains(&t)).then_some(t)
}

#[test]
fn terrain_rays_match_triangle_rays() {
    let mut random = Random::new(43);
    let (mesh, field, corners) = terrain(&mut random, 20);
    let mut hits = 0;
    for case in 0..cases(100_000) {
        let spread = |random: &mut Random| {
            Vec3::new(random.range(-1.0, 11.0), random.range(-0.5, 2.0), random.range(-1.0, 11.0))
        };
        let ray = Ray::between(spread(&mut random), spread(&mut random));
        let expected = corners.iter().filter_map(|c| pierced(c, &ray)).reduce(f64::min);
        for shape in [&mesh, &field] {
            let found = shape.cast_ray(&Transform::IDENTITY, &ray).map(|hit| hit.fraction);
            match (expected, found) {
                (Some(t), Some(found)) => {
                    assert!(
                        (t - f64::from(found)).abs() < 1e-4,
                        "case {case}: fraction {found}, expected {t}"
                    );
                }
                (None, None) => {}
                // The ray starts or ends on the surface.
                (t, found) => {
                    let at = t.map(|t| t as f32).or(found).unwrap();
                    assert!(
                        !(1e-4..=1.0 - 1e-4).contains(&at),
                        "case {case}: fraction {found:?}, expected {t:?}"
                    );
                }
            }
            hits += u32::from(found.is_some());
        }
    }
    assert!(hits * 4 > cases(100_000), "{hits} hits");
    // Rays down through every edge and vertex: none passes between two triangles.
    for i in 1..40 {
        for j in 1..40 {
            let over = Vec3::new(0.25 * i as f32, 5.0, 0.25 * j as f32);
            let ray = Ray { origin: over, direction: Vec3::NEG_Y * 10.0 };
            for shape in [&mesh, &field] {
                assert!(shape.cast_ray(&Transform::IDENTITY, &ray).is_some(), "{over}");
                let up = Ray { origin: over - Vec3::Y * 6.0, direction: Vec3::Y * 10.0 };
                assert!(shape.cast_ray(&Transform::IDENTITY, &up).is_none(), "{over} from below");
            }
        }
    }
}

#[test]
fn closest_point_equals_the_closest_of_all_triangles() {
    let mut random = Random::new(44);
    let (mesh, field, corners) = terrain(&mut random, 12);
    let alone: Vec<Shape> = corners.iter().map(|corners| mesh_of(corners)).collect();
    for case in 0..cases(100_000) {
        let p = Vec3::new(random.range(-2.0, 8.0), random.range(-1.0, 3.0), random.range(-2.0, 8.0));
        let away = |alone: &Shape| alone.signed_distance(&Transform::IDENTITY, p).0.abs();
        let expected = alone.iter().map(away).fold(f32::INFINITY, f32::min);
        for shape in [&mesh, &field] {
            let (found, normal) = shape.signed_distance(&Transform::IDENTITY, p);
            assert!(
                (found.abs() - expected).abs() < 1e-4,
                "case {case} at {p}: distance {found}, expected {expected}"
            );
            let back = shape.signed_distance(&Transform::IDENTITY, p - normal * found).0;
            assert!(back.abs() < 1e-3, "case {case} at {p}: the closest point is {back} from the surface");
            let over = (0.0..6.0).contains(&p.x) && (0.0..6.0).contains(&p.z);
            assert!(
                !(over && p.y > 0.6 && found < 0.0),
                "case {case}: {p} is above the whole surface but counts as behind it"
            );
        }
    }
}
