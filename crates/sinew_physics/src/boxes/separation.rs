//! Separating axes of two boxes (Gottschalk, Lin & Manocha, "OBBTree", SIGGRAPH 1996): three faces of each and nine pairs of
//! edges.

use super::Penetration;
use super::placed::{PlacedBox, sign};
use sinew_math::{Vec3, abs3, max};

/// Edges whose sine is below this are parallel: what their direction would add to the faces' is rounding.
pub(super) const PARALLEL_SINE: f32 = 1e-5;
/// Share of the lengths at hand by which boxes may be apart and still count as touching: several roundings.
pub(super) const TOUCH: f32 = 5e-7;

/// A candidate normal from A to B and the gap along it.
#[derive(Clone, Copy)]
pub(crate) struct Axis {
    pub normal: Vec3,
    pub separation: f32,
    pub of: AxisOf,
}

/// Where it comes from: the face of A or of B with that number, or an edge of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum AxisOf {
    FaceA(usize),
    FaceB(usize),
    Edges(usize, usize),
}

/// The face of `of` that separates best; `toward_b` is −1 if `of` is B.
pub(crate) fn best_face(of: &PlacedBox, other: &PlacedBox, toward_b: f32, name: fn(usize) -> AxisOf) -> Axis {
    let mut best = face(of, other, toward_b, name, 0);
    for k in 1..3 {
        let axis = face(of, other, toward_b, name, k);
        if axis.separation > best.separation {
            best = axis;
        }
    }
    best
}

fn face(of: &PlacedBox, other: &PlacedBox, toward_b: f32, name: fn(usize) -> AxisOf, k: usize) -> Axis {
    let along = (other.center - of.center).dot(of.axes[k]);
    Axis {
        normal: of.axes[k] * (sign(along) * toward_b),
        separation: along.abs() - of.half[k] - other.half_width(of.axes[k]),
        of: name(k),
    }
}

/// The direction across an edge of each that separates best; `None` if all edges are parallel, that is at a sine below
/// `parallel_sine`.
pub(crate) fn best_edges(a: &PlacedBox, b: &PlacedBox, parallel_sine: f32) -> Option<Axis> {
    let mut best: Option<Axis> = None;
    for i in 0..3 {
        for j in 0..3 {
            let Some(axis) = edges(a, b, (i, j), parallel_sine) else { continue };
            if best.is_none_or(|best| axis.separation > best.separation) {
                best = Some(axis);
            }
        }
    }
    best
}

fn edges(a: &PlacedBox, b: &PlacedBox, (i, j): (usize, usize), parallel_sine: f32) -> Option<Axis> {
    let offset = b.center - a.center;
    let cross = a.axes[i].cross(b.axes[j]);
    let sine = cross.length();
    if sine < parallel_sine {
        return None;
    }
    let across = cross / sine;
    let normal = across * sign(across.dot(offset));
    let separation = normal.dot(offset) - a.half_width(normal) - b.half_width(normal);
    Some(Axis { normal, separation, of: AxisOf::Edges(i, j) })
}

/// The axis of that name, with the bits that [`best_face`] and [`best_edges`] give it; `None` if they have none of it.
pub(crate) fn axis(a: &PlacedBox, b: &PlacedBox, of: AxisOf, parallel_sine: f32) -> Option<Axis> {
    match of {
        AxisOf::FaceA(k) => (k < 3).then(|| face(a, b, 1.0, AxisOf::FaceA, k)),
        AxisOf::FaceB(k) => (k < 3).then(|| face(b, a, -1.0, AxisOf::FaceB, k)),
        AxisOf::Edges(i, j) if i < 3 && j < 3 => edges(a, b, (i, j), parallel_sine),
        AxisOf::Edges(..) => None,
    }
}

/// Whether two boxes overlap, without square roots and divisions (Ericson, "Real-Time Collision Detection", 2005, §4.4.1):
/// they are apart if the offset of their centres is longer than their half widths together along one of 15 directions.
///
/// With `Rᵢⱼ = aᵢ·bⱼ`, `t` the offset in A's axes, `|t|₁` the sum of its magnitudes and
/// `slack = TOUCH × (|t|₁ + (|ha|₁ + |hb|₁))`, indices modulo 3, sums from the left, they overlap if for all `i`, `j`
/// - faces of A: `|tᵢ| ≤ (haᵢ + (hb₀|Rᵢ₀| + hb₁|Rᵢ₁| + hb₂|Rᵢ₂|)) + slack`
/// - faces of B: `|t₀R₀ⱼ + t₁R₁ⱼ + t₂R₂ⱼ| ≤ (hbⱼ + (ha₀|R₀ⱼ| + ha₁|R₁ⱼ| + ha₂|R₂ⱼ|)) + slack`
/// - edges, with `i1 = i + 1`, `i2 = i + 2`, `j1 = j + 1`, `j2 = j + 2`:
///   `|tᵢ₂Rᵢ₁ⱼ − tᵢ₁Rᵢ₂ⱼ| ≤ ((haᵢ₁|Rᵢ₂ⱼ| + haᵢ₂|Rᵢ₁ⱼ|) + (hbⱼ₁|Rᵢⱼ₂| + hbⱼ₂|Rᵢⱼ₁|)) + slack`
///
/// Both sides of the last kind vanish as edges become parallel; the slack keeps rounding from parting boxes there.
pub(super) fn overlap(a: &PlacedBox, b: &PlacedBox) -> bool {
    let t = a.local_point(b.center);
    let (ha, hb) = (a.half, b.half);
    let r = a.axes.map(|u| b.axes.map(|v| u.dot(v)));
    let s = r.map(|row| row.map(f32::abs));
    let sum = |v: Vec3| v.x + v.y + v.z;
    let slack = TOUCH * (sum(abs3(t)) + (sum(ha) + sum(hb)));
    let face_a = |i: usize| {
        let width = ha[i] + (hb.x * s[i][0] + hb.y * s[i][1] + hb.z * s[i][2]);
        t[i].abs() <= width + slack
    };
    let face_b = |j: usize| {
        let along = t.x * r[0][j] + t.y * r[1][j] + t.z * r[2][j];
        let width = hb[j] + (ha.x * s[0][j] + ha.y * s[1][j] + ha.z * s[2][j]);
        along.abs() <= width + slack
    };
    let edges = |i: usize, j: usize| {
        let [i1, i2, j1, j2] = [i + 1, i + 2, j + 1, j + 2].map(|k| k % 3);
        let along = t[i2] * r[i1][j] - t[i1] * r[i2][j];
        let width = (ha[i1] * s[i2][j] + ha[i2] * s[i1][j]) + (hb[j1] * s[i][j2] + hb[j2] * s[i][j1]);
        along.abs() <= width + slack
    };
    (0..3).all(face_a) && (0..3).all(face_b) && (0..3).all(|i| (0..3).all(|j| edges(i, j)))
}

/// The faces of the Minkowski difference of two boxes have those 15 directions for normals, so the way out along the best of
/// them is the shortest of all.
pub(super) fn penetration(a: &PlacedBox, b: &PlacedBox) -> Option<Penetration> {
    if !overlap(a, b) {
        return None;
    }
    let faces = [best_face(a, b, 1.0, AxisOf::FaceA), best_face(b, a, -1.0, AxisOf::FaceB)];
    let axes = faces.into_iter().chain(best_edges(a, b, PARALLEL_SINE));
    let best = axes.reduce(|x, y| if y.separation > x.separation { y } else { x })?;
    Some(Penetration { depth: max(-best.separation, 0.0), direction: best.normal })
}
