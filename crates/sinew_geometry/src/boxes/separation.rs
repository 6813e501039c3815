//! Separating axes of two boxes (Gottschalk, Lin & Manocha, "OBBTree", SIGGRAPH 1996): three faces of each and nine pairs of
//! edges.

use super::Penetration;
use super::fifteen::FifteenAxes;
use super::placed::{PlacedBox, sign};
use sinew_math::{Vec3, max};

/// Sine below which edges count as parallel: their direction adds only rounding to that of the faces.
pub(super) const PARALLEL_SINE: f32 = 1e-5;

/// A candidate normal from A to B, and the gap along it, metres.
#[derive(Clone, Copy)]
pub(crate) struct Axis {
    pub normal: Vec3,
    pub separation: f32,
    pub of: AxisOf,
}

/// Source of a separating axis of two polytopes: a face of A, a face of B, or an edge of each, by index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AxisOf {
    /// Normal of a face of A.
    FaceA(usize),
    /// Normal of a face of B.
    FaceB(usize),
    /// Cross product of an edge of A and an edge of B.
    Edges(usize, usize),
}

/// Relative orientation of two boxes.
pub(crate) struct Crossed<'a> {
    a: &'a PlacedBox,
    b: &'a PlacedBox,
    offset: Vec3,
    /// `cosine[i][j]` is the dot product of axis `i` of A and axis `j` of B.
    cosine: [[f32; 3]; 3],
}

/// Relative error of the quick estimate of the gap across two edges times their sine.
const ESTIMATE: f32 = 1e-4;

impl<'a> Crossed<'a> {
    pub fn new(a: &'a PlacedBox, b: &'a PlacedBox) -> Self {
        Self { a, b, offset: b.center - a.center, cosine: a.axes.map(|u| b.axes.map(|v| u.dot(v))) }
    }

    /// Returns the face of A that separates best.
    pub fn best_face_of_a(&self) -> Axis {
        let axis = |k: usize| {
            let along = self.offset.dot(self.a.axes[k]);
            facing(self.a, along, 1.0, width(self.b.half, self.cosine[k]), (AxisOf::FaceA, k))
        };
        better(better(axis(0), axis(1)), axis(2))
    }

    /// Returns the face of B that separates best; the normal points from A to B.
    pub fn best_face_of_b(&self) -> Axis {
        let axis = |k: usize| {
            let along = -self.offset.dot(self.b.axes[k]);
            let cosines = [self.cosine[0][k], self.cosine[1][k], self.cosine[2][k]];
            facing(self.b, along, -1.0, width(self.a.half, cosines), (AxisOf::FaceB, k))
        };
        better(better(axis(0), axis(1)), axis(2))
    }

    /// Returns the best cross product of edges if it separates by more than `enough` (metres); otherwise `None` or an
    /// axis that separates less. Skips parallel edges (sine below `parallel_sine`).
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

    /// Returns the pairs of edges that may separate by more than `enough` (metres), with the axis of B changing
    /// fastest. Uses the gap times the sine, as in [`FifteenAxes`].
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

/// The next two axes after each axis, cyclic.
const AFTER: [(usize, usize); 3] = [(1, 2), (2, 0), (0, 1)];

/// Returns the axis that separates better; the first among equals.
fn better(first: Axis, second: Axis) -> Axis {
    if second.separation > first.separation { second } else { first }
}

/// Half of a box's width along the direction whose cosines with the box's axes are given.
fn width(half: Vec3, cosines: [f32; 3]) -> f32 {
    half.x * cosines[0].abs() + half.y * cosines[1].abs() + half.z * cosines[2].abs()
}

/// Axis of face `k` of a box. `along` is the offset of the other box's centre along the face's axis, and `width` the
/// half width of the other box. `toward_b` is −1 for a face of B.
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

/// Returns the axis with this source, with the bits of [`Crossed`]; `None` if the source is not valid.
pub(crate) fn axis(a: &PlacedBox, b: &PlacedBox, of: AxisOf, parallel_sine: f32) -> Option<Axis> {
    match of {
        AxisOf::FaceA(k) => (k < 3).then(|| face(a, b, 1.0, AxisOf::FaceA, k)),
        AxisOf::FaceB(k) => (k < 3).then(|| face(b, a, -1.0, AxisOf::FaceB, k)),
        AxisOf::Edges(i, j) if i < 3 && j < 3 => edges(a, b, (i, j), parallel_sine),
        AxisOf::Edges(..) => None,
    }
}

/// Returns the penetration of two boxes. The faces of the Minkowski difference have these 15 normals, so the best of
/// them gives the shortest way out.
pub(super) fn penetration(a: &PlacedBox, b: &PlacedBox) -> Option<Penetration> {
    if !FifteenAxes::of(a, b).overlap() {
        return None;
    }
    let crossed = Crossed::new(a, b);
    let faces = [crossed.best_face_of_a(), crossed.best_face_of_b()];
    let axes = faces.into_iter().chain(crossed.best_edges(PARALLEL_SINE, f32::NEG_INFINITY));
    let best = axes.reduce(|x, y| if y.separation > x.separation { y } else { x })?;
    Some(Penetration { depth: max(-best.separation, 0.0), direction: best.normal })
}
