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

/// Relative attitude of two boxes: what their axes share.
pub(crate) struct Crossed<'a> {
    a: &'a PlacedBox,
    b: &'a PlacedBox,
    offset: Vec3,
    /// `cosine[i][j]` is axis `i` of A times axis `j` of B.
    cosine: [[f32; 3]; 3],
}

/// Share of two boxes' size by which the quick estimate of a gap across two edges may be off, times their sine.
const ESTIMATE: f32 = 1e-4;

impl<'a> Crossed<'a> {
    pub fn new(a: &'a PlacedBox, b: &'a PlacedBox) -> Self {
        Self { a, b, offset: b.center - a.center, cosine: a.axes.map(|u| b.axes.map(|v| u.dot(v))) }
    }

    /// The face of A that separates best.
    pub fn best_face_of_a(&self) -> Axis {
        let axis = |k: usize| {
            let along = self.offset.dot(self.a.axes[k]);
            facing(self.a, along, 1.0, width(self.b.half, self.cosine[k]), (AxisOf::FaceA, k))
        };
        better(better(axis(0), axis(1)), axis(2))
    }

    /// The face of B that separates best; the normal points from A to B.
    pub fn best_face_of_b(&self) -> Axis {
        let axis = |k: usize| {
            let along = -self.offset.dot(self.b.axes[k]);
            let cosines = [self.cosine[0][k], self.cosine[1][k], self.cosine[2][k]];
            facing(self.b, along, -1.0, width(self.a.half, cosines), (AxisOf::FaceB, k))
        };
        better(better(axis(0), axis(1)), axis(2))
    }

    /// The direction across an edge of each that separates best, if that is by more than `enough` (m); else `None`, or one that
    /// does not. All of the directions are left out whose edges are parallel, that is at a sine below `parallel_sine`.
    pub fn best_edges(&self, parallel_sine: f32, enough: f32) -> Option<Axis> {
        let mut best: Option<Axis> = None;
        for (k, may_part) in self.edges_that_may_part(enough).into_iter().enumerate() {
            if !may_part {
                continue;
            }
            let Some(axis) = edges(self.a, self.b, (k / 3, k % 3), parallel_sine) else { continue };
            if best.is_none_or(|best| axis.separation > best.separation) {
                best = Some(axis);
            }
        }
        best
    }

    /// Pairs of edges among the nine, the side of B changing fastest, that may part by more than `enough` (m): by the gap
    /// times the sine, as in [`overlap`].
    fn edges_that_may_part(&self, enough: f32) -> [bool; 9] {
        let t = self.a.local_vector(self.offset).to_array();
        let (ha, hb) = (self.a.half.to_array(), self.b.half.to_array());
        let (r, s) = (&self.cosine, self.cosine.map(|row| row.map(f32::abs)));
        let sum = |v: [f32; 3]| v[0] + v[1] + v[2];
        let slack = ESTIMATE * (sum(t.map(f32::abs)) + (sum(ha) + sum(hb)));
        let mut may = [true; 9];
        for i in 0..3 {
            let (i1, i2) = AFTER[i];
            for j in 0..3 {
                let (j1, j2) = AFTER[j];
                let along = t[i2] * r[i1][j] - t[i1] * r[i2][j];
                let width = (ha[i1] * s[i2][j] + ha[i2] * s[i1][j]) + (hb[j1] * s[i][j2] + hb[j2] * s[i][j1]);
                let sine = max(1.0 - r[i][j] * r[i][j], 0.0).sqrt();
                let parts_less = along.abs() - width + slack <= enough * sine;
                may[3 * i + j] = !parts_less;
            }
        }
        may
    }
}

/// The two axes after each.
const AFTER: [(usize, usize); 3] = [(1, 2), (2, 0), (0, 1)];

/// The one that separates better, of equals the first.
fn better(first: Axis, second: Axis) -> Axis {
    if second.separation > first.separation { second } else { first }
}

/// Half of a box's width along a direction that has these cosines with its axes.
fn width(half: Vec3, cosines: [f32; 3]) -> f32 {
    half.x * cosines[0].abs() + half.y * cosines[1].abs() + half.z * cosines[2].abs()
}

/// Face `k` of a box whose centre is `along` before that of the other, which is half as wide as `width`; `toward_b` is −1 if it
/// is one of B.
fn facing(
    of: &PlacedBox,
    along: f32,
    toward_b: f32,
    width: f32,
    (name, k): (fn(usize) -> AxisOf, usize),
) -> Axis {
    Axis {
        normal: of.axes[k] * (sign(along) * toward_b),
        separation: along.abs() - of.half[k] - width,
        of: name(k),
    }
}

fn face(of: &PlacedBox, other: &PlacedBox, toward_b: f32, name: fn(usize) -> AxisOf, k: usize) -> Axis {
    let along = (other.center - of.center).dot(of.axes[k]);
    facing(of, along, toward_b, other.half_width(of.axes[k]), (name, k))
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

/// The axis of that name, with the bits that [`Crossed`] gives it; `None` if they have none of it.
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
    let crossed = Crossed::new(a, b);
    let faces = [crossed.best_face_of_a(), crossed.best_face_of_b()];
    let axes = faces.into_iter().chain(crossed.best_edges(PARALLEL_SINE, f32::NEG_INFINITY));
    let best = axes.reduce(|x, y| if y.separation > x.separation { y } else { x })?;
    Some(Penetration { depth: max(-best.separation, 0.0), direction: best.normal })
}
