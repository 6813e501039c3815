//! Hull against hull, compared with all face normals and edge pairs in `f64`, and, if the hulls are apart, with all
//! pairs of corners, edges and faces. Boxes as hulls of their corners, compared with boxes.

use super::{box_hull, cases, pebble};
use sinew_geometry::collide::{Manifold, collide};
use sinew_geometry::{Hull, Shape};
use sinew_math::{Random, Rotation, Transform, Vec3};

type Wide = [f64; 3];

fn wide(v: Vec3) -> Wide {
    v.to_array().map(f64::from)
}
fn sub(a: Wide, b: Wide) -> Wide {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
fn add(a: Wide, b: Wide, t: f64) -> Wide {
    [a[0] + b[0] * t, a[1] + b[1] * t, a[2] + b[2] * t]
}
fn dot(a: Wide, b: Wide) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
fn cross(a: Wide, b: Wide) -> Wide {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
fn unit(a: Wide) -> Option<Wide> {
    let length = dot(a, a).sqrt();
    (length > 1e-9).then(|| a.map(|x| x / length))
}

/// Corners, edges and faces of a hull in the world, in `f64`.
struct Oracle {
    corners: Vec<Wide>,
    edges: Vec<[usize; 2]>,
    faces: Vec<(Wide, Vec<usize>)>,
}

impl Oracle {
    fn new(hull: &Hull, frame: &Transform) -> Self {
        let m = frame.rotation.to_mat3();
        let turn = |v: Vec3| {
            let v = wide(v);
            let columns = [wide(m.x_axis), wide(m.y_axis), wide(m.z_axis)];
            add(add(columns[0].map(|x| x * v[0]), columns[1], v[1]), columns[2], v[2])
        };
        let corners = hull.vertices().iter().map(|&v| add(turn(v), wide(frame.translation), 1.0)).collect();
        let faces = hull.faces().map(|face| (turn(face.normal()), face.corners().collect())).collect();
        Self { corners, edges: hull.edges().collect(), faces }
    }

    fn support(&self, n: Wide) -> f64 {
        self.corners.iter().map(|&p| dot(p, n)).fold(f64::NEG_INFINITY, f64::max)
    }
}

fn gap(a: &Oracle, b: &Oracle, n: Wide) -> f64 {
    -b.support(n.map(|x| -x)) - a.support(n)
}

/// Returns the largest gap over all face normals and all edge pairs.
fn best_axis(a: &Oracle, b: &Oracle) -> f64 {
    let faces =
        a.faces.iter().map(|f| gap(a, b, f.0)).chain(b.faces.iter().map(|f| gap(a, b, f.0.map(|x| -x))));
    let mut best = faces.fold(f64::NEG_INFINITY, f64::max);
    for &[p, q] in &a.edges {
        for &[r, s] in &b.edges {
            let across = cross(sub(a.corners[q], a.corners[p]), sub(b.corners[s], b.corners[r]));
            if let Some(n) = unit(across) {
                best = best.max(gap(a, b, n)).max(gap(a, b, n.map(|x| -x)));
            }
        }
    }
    best
}

/// Returns the distance of two segments.
fn segments([p, q]: [Wide; 2], [r, s]: [Wide; 2]) -> f64 {
    let (u, v, w) = (sub(q, p), sub(s, r), sub(p, r));
    let (a, b, c, d, e) = (dot(u, u), dot(u, v), dot(v, v), dot(u, w), dot(v, w));
    let at = |t: f64, k: f64| {
        let x = sub(add(p, u, t), add(r, v, k));
        dot(x, x).sqrt()
    };
    let clamp = |x: f64| x.clamp(0.0, 1.0);
    let mut best = f64::INFINITY;
    let determinant = a * c - b * b;
    if determinant > 1e-12 * a * c {
        let t = clamp((b * e - c * d) / determinant);
        let k = clamp((b * t + e) / c);
        best = at(clamp((b * k - d) / a), k);
    }
    for t in [0.0, 1.0] {
        best = best.min(at(t, clamp((b * t + e) / c)));
        best = best.min(at(clamp((b * t - d) / a), t));
    }
    best
}

/// Returns the distance of two separate hulls.
fn distance(a: &Oracle, b: &Oracle) -> f64 {
    let to_faces = |from: &Oracle, to: &Oracle| {
        let mut best = f64::INFINITY;
        for &p in &from.corners {
            for (n, ring) in &to.faces {
                let height = dot(sub(p, to.corners[ring[0]]), *n);
                let above = (0..ring.len()).all(|k| {
                    let (x, y) = (to.corners[ring[k]], to.corners[ring[(k + 1) % ring.len()]]);
                    dot(cross(sub(y, x), sub(p, x)), *n) >= 0.0
                });
                if above && height >= 0.0 {
                    best = best.min(height);
                }
            }
        }
        best
    };
    let mut best = to_faces(a, b).min(to_faces(b, a));
    for e in &a.edges {
        for f in &b.edges {
            best = best.min(segments(e.map(|i| a.corners[i]), f.map(|i| b.corners[i])));
        }
    }
    best
}

struct Case {
    shapes: [Shape; 2],
    frames: [Transform; 2],
    size: f32,
}

impl Case {
    /// Returns two random hulls near contact: a third of them face to face, edge to edge or nearly so.
    fn new(random: &mut Random) -> Self {
        let scale = [0.01, 0.1, 1.0, 10.0][random.index(4)];
        let ratio = [1.0, 1.0, 5.0][random.index(3)];
        let mut shape = |scale: f32| match random.index(4) {
            0 => box_hull(
                Vec3::new(random.range(0.2, 1.0), random.range(0.2, 1.0), random.range(0.2, 1.0)) * scale,
            ),
            _ => pebble(scale, random),
        };
        let shapes = [shape(scale), shape(scale * ratio)];
        let common = random.rotation();
        let turn = |random: &mut Random| match random.index(3) {
            0 => Rotation::IDENTITY,
            1 => Rotation::from_scaled_axis(random.in_cube() * 0.02),
            _ => random.rotation(),
        };
        let place = random.in_cube() * scale;
        let frame_a = Transform::new(place, common * turn(random));
        let mut frame_b = Transform::new(place, common * turn(random));
        // Moves B along a random direction until the hulls touch, then slightly further or back.
        let away = random.direction();
        let (mut low, mut high) = (0.0, 3.0 * scale * (1.0 + ratio));
        let meets = |t: f32, frame_b: &mut Transform| {
            frame_b.translation = place + away * t;
            let mut out = Manifold::default();
            collide(&shapes[0], &frame_a, &shapes[1], frame_b, 0.0, &mut out);
            out.count > 0
        };
        for _ in 0..20 {
            let middle = 0.5 * (low + high);
            if meets(middle, &mut frame_b) { low = middle } else { high = middle }
        }
        frame_b.translation = place + away * (low + scale * random.range(-0.3, 0.1));
        Self { shapes, frames: [frame_a, frame_b], size: scale * (1.0 + ratio) }
    }

    fn collide(&self, margin: f32) -> Manifold {
        let mut out = Manifold::default();
        collide(&self.shapes[0], &self.frames[0], &self.shapes[1], &self.frames[1], margin, &mut out);
        out
    }

    fn swapped(&self) -> Self {
        let [a, b] = self.shapes.clone();
        let [frame_a, frame_b] = self.frames;
        Self { shapes: [b, a], frames: [frame_b, frame_a], size: self.size }
    }

    fn turned(&self, by: Rotation) -> Self {
        let frames = self.frames.map(|f| Transform::new(by * f.translation, by * f.rotation));
        Self { shapes: self.shapes.clone(), frames, size: self.size }
    }

    fn oracles(&self) -> [Oracle; 2] {
        [0, 1].map(|k| match &self.shapes[k] {
            Shape::Hull(hull) => Oracle::new(hull, &self.frames[k]),
            _ => unreachable!("a hull"),
        })
    }
}

fn nearest(manifold: &Manifold) -> f64 {
    manifold.points().iter().map(|p| f64::from(p.separation)).fold(f64::INFINITY, f64::min)
}

#[test]
fn hull_contacts_match_brute_force() {
    let mut random = Random::new(18);
    let (mut apart, mut deep, mut missing) = (0, 0, 0);
    for number in 0..cases(100_000) {
        let case = Case::new(&mut random);
        let margin = 0.05 * case.size;
        let found = case.collide(margin);
        let [a, b] = case.oracles();
        let axis = best_axis(&a, &b);
        let truth = if axis > 0.0 { distance(&a, &b) } else { axis };
        let context = || format!("case {number}: {truth} by {axis}, {found:?}\n{:?}", case.frames);
        let rounding = 1e-5 * f64::from(case.size);
        let thinnest = f64::from(case.shapes[0].inner_radius().min(case.shapes[1].inner_radius()));
        // Faces are preferred to slightly better edges.
        let preference = 0.06 * axis.abs() + 0.011 * thinnest.min(0.05);
        if found.count == 0 {
            assert!(truth > f64::from(margin) - rounding, "missed: {}", context());
            missing += 1;
            continue;
        }
        assert!(truth <= f64::from(margin) + preference + rounding, "invented: {}", context());
        let along = gap(&a, &b, wide(found.normal));
        assert!(
            along > axis.max(truth) - preference - 10.0 * rounding || truth > 0.0,
            "normal, {along}: {}",
            context()
        );
        assert!(nearest(&found) > along - 2.0 * preference - rounding, "too deep, {along}: {}", context());
        if truth > 0.0 {
            apart += 1;
            assert!(
                nearest(&found) < truth + preference + 1e-3 * f64::from(case.size),
                "too far: {}",
                context()
            );
            assert!(along > 0.9 * truth - preference - rounding, "normal, {along}: {}", context());
        } else {
            deep += 1;
        }
    }
    println!("{deep} overlaps, {apart} within the margin, {missing} beyond");
    assert!(deep > 10 * apart.min(20) && apart > 10);
}

#[test]
fn hull_contacts_are_invariant_under_exchange_and_rotation() {
    let mut random = Random::new(19);
    let mut other = 0;
    let all = cases(100_000);
    for number in 0..all {
        let case = Case::new(&mut random);
        let margin = 0.05 * case.size;
        let found = case.collide(margin);
        let swapped = case.swapped().collide(margin);
        let turn = random.rotation();
        let turned = case.turned(turn).collide(margin);
        let context = || format!("case {number}: {found:?}\n{swapped:?}\n{turned:?}");
        let tolerance = 2e-3 * case.size;
        assert_eq!(found.count == 0, swapped.count == 0, "{}", context());
        if found.count == 0 {
            continue;
        }
        assert!((found.normal + swapped.normal).length() < 1e-2, "{}", context());
        assert!((nearest(&found) - nearest(&swapped)).abs() < f64::from(tolerance), "{}", context());
        // A world direction decides ties between faces of A and B; the normal may then rotate slightly.
        let same = (turn * found.normal - turned.normal).length() < 0.05
            && (nearest(&found) - nearest(&turned)).abs() < f64::from(tolerance);
        other += u32::from(!same);
    }
    println!("{other} of {all} manifolds differ after a rotation");
    assert!(other * 50 <= all, "{other} of {all}");
}

/// A hull of the eight corners of a box has the contacts of the box.
#[test]
fn hull_of_box_corners_has_the_contacts_of_the_box() {
    let mut random = Random::new(20);
    let mut met = 0;
    for number in 0..cases(100_000) {
        let halves =
            [0, 1].map(|_| Vec3::new(random.range(0.2, 1.0), random.range(0.2, 1.0), random.range(0.2, 1.0)));
        let turn = |random: &mut Random| match random.index(3) {
            0 => Rotation::IDENTITY,
            1 => Rotation::from_scaled_axis(random.in_cube() * 0.02),
            _ => random.rotation(),
        };
        let frame_a = Transform::new(random.in_cube(), turn(&mut random));
        let frame_b = Transform::new(frame_a.translation + random.in_cube() * 1.5, turn(&mut random));
        let run = |shapes: [Shape; 2]| {
            let mut out = Manifold::default();
            collide(&shapes[0], &frame_a, &shapes[1], &frame_b, 0.1, &mut out);
            out
        };
        let boxes = run(halves.map(|half_extents| Shape::Box { half_extents }));
        let hulls = run(halves.map(box_hull));
        let mixed = run([Shape::Box { half_extents: halves[0] }, box_hull(halves[1])]);
        for other in [hulls, mixed] {
            let context = || format!("case {number}: {boxes:?}\n{other:?}");
            let (one, two) = (nearest(&boxes), nearest(&other));
            let at_margin = |m: &Manifold| m.count == 0 || nearest(m) > 0.099;
            if boxes.count == 0 || other.count == 0 {
                assert!(at_margin(&boxes) && at_margin(&other), "{}", context());
                continue;
            }
            met += 1;
            assert!((one - two).abs() < 2e-3 || (one - two).abs() < 0.06 * one.abs(), "{}", context());
            assert!(
                (boxes.normal - other.normal).length() < 0.02 || (one - two).abs() < 1e-3,
                "{}",
                context()
            );
        }
    }
    assert!(met > 100);
}
