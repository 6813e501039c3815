//! Gap or depth of two boxes by the separating axis theorem (Gottschalk, Lin & Manocha, "OBBTree", SIGGRAPH 1996), with
//! the distance along each axis.

use super::record::{Record, matrix};
use crate::boxes::Obb;
use sinew_math::Vec3;
use sinew_math::lanes::Real;

/// Squared sine below which two edges count as parallel. Skipping their axis changes the distance by at most the sine
/// times the boxes' size; using it, by the rounding error divided by the sine. At a sine of 1e-3 neither error exceeds
/// 1e-3 of the boxes' size.
const PARALLEL: f32 = 1e-6;

/// Axis with the largest gap or the least overlap of two boxes, and the distance along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Separation {
    /// Gap along the axis, metres; 0 if the boxes touch. Negative if they overlap: the shortest way out is then a
    /// displacement of B by this length along [`direction`](SeparatingAxis::direction). NaN if a number of the boxes is
    /// NaN; unreliable if one is infinite.
    ///
    /// A gap is at most the boxes' distance: less if their closest points are two corners, or a corner and an edge. It
    /// is exact except for rounding, unless edges are within a milliradian of parallel: then the error may be that
    /// angle times the boxes' size.
    pub distance: f32,
    /// First of the best axes, in the order of [`SeparatingAxis`].
    pub axis: SeparatingAxis,
}

/// One of the fifteen directions that decide whether two boxes overlap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SeparatingAxis {
    /// Normal of face 0, 1 or 2 of A, by its axis.
    FaceOfA(u8),
    /// Normal of face 0, 1 or 2 of B, by its axis.
    FaceOfB(u8),
    /// Cross product of this axis of A and this axis of B.
    Edges(u8, u8),
}

impl SeparatingAxis {
    /// Returns the axis of an index: three faces of A, three of B, nine pairs of edges, with the axis of B changing
    /// fastest.
    #[inline]
    pub(super) fn from_index(index: u8) -> Self {
        match index {
            0..3 => Self::FaceOfA(index),
            3..6 => Self::FaceOfB(index - 3),
            _ => Self::Edges((index - 6) / 3, (index - 6) % 3),
        }
    }

    /// Returns the axis as a unit vector from A toward B, in the common space of the boxes.
    pub fn direction(self, a: &Obb, b: &Obb) -> Vec3 {
        let side = |of: &Obb, k: u8| {
            let m = of.rotation.to_mat3();
            [m.x_axis, m.y_axis, m.z_axis][usize::from(k)]
        };
        let axis = match self {
            Self::FaceOfA(k) => side(a, k),
            Self::FaceOfB(k) => side(b, k),
            Self::Edges(i, j) => side(a, i).cross(side(b, j)).normalize(),
        };
        if axis.dot(b.center - a.center) < 0.0 { -axis } else { axis }
    }
}

impl Separation {
    /// Returns the separation of two boxes, by all fifteen axes.
    ///
    /// Swapped boxes give the same distance except for rounding, and the same axis unless another one is equally good.
    pub fn between(a: &Obb, b: &Obb) -> Self {
        let found = Relative::new(&Record::of(a), &Record::of(b)).fifteen_axes();
        Self { distance: found.distance, axis: SeparatingAxis::from_index(found.index as u8) }
    }
}

/// Best separating axis so far.
#[derive(Clone, Copy)]
pub(super) struct Best<R> {
    /// Gap along the axis, or a monotonic function of it.
    pub distance: R,
    /// Index of the axis, a small whole number.
    pub index: R,
}

impl<R: Real> Best<R> {
    #[inline(always)]
    fn of(distance: R, index: usize) -> Self {
        Self { distance, index: R::splat(index as f32) }
    }

    /// Replaces the axis if this one is better than all before (NaN is not better). `index` must exceed all earlier
    /// ones.
    #[inline(always)]
    fn try_axis(&mut self, distance: R, index: usize) {
        let is_better = R::gt(distance, self.distance);
        // Indices rise, so the maximum is the last one chosen; that is cheaper than a selection.
        self.index = R::max(R::splat(index as f32).masked(is_better), self.index);
        self.distance = R::max(distance, self.distance);
    }
}

/// Two boxes in the frame of the first.
pub(super) struct Relative<R> {
    half_a: [R; 3],
    half_b: [R; 3],
    /// Centre of B along the axes of A.
    offset: [R; 3],
    /// `cosine[i][j]` is axis `i` of A times axis `j` of B.
    cosine: [[R; 3]; 3],
}

impl<R: Real> Relative<R> {
    #[inline(always)]
    pub fn new(a: &Record<R>, b: &Record<R>) -> Self {
        let (u, v) = (a.vector, b.vector);
        // Rotation from B to A: the conjugate of A's times B's.
        let w = a.w * b.w + u.x * v.x + (u.y * v.y + u.z * v.z);
        let turn = v * a.w - u * b.w - u.cross(v);
        // Offset of B's centre, rotated by the conjugate of A's rotation.
        let way = b.center - a.center;
        let t = u.cross(way);
        let t = t + t;
        let offset = way - t * a.w + u.cross(t);
        Self {
            half_a: a.half.to_array(),
            half_b: b.half.to_array(),
            offset: offset.to_array(),
            cosine: matrix(turn, w),
        }
    }

    /// Returns the best of the six face axes: a lower bound of the gap, never NaN if all numbers of the boxes are
    /// finite.
    #[inline(always)]
    pub fn six_faces(&self) -> Best<R> {
        let (best, poison) = self.best_face();
        Best { distance: R::select(R::eq(poison, poison), best.distance, poison), ..best }
    }

    /// Returns the best of all fifteen axes.
    #[inline(always)]
    pub fn fifteen_axes(&self) -> Best<R> {
        let (face, poison) = self.best_face();
        let edges = self.best_edges();
        let root = edges.distance.abs().sqrt();
        let edge = R::select(R::lt(edges.distance, R::splat(0.0)), -root, root);
        let is_edge = R::gt(edge, face.distance);
        let distance = R::max(edge, face.distance);
        Best {
            distance: R::select(R::eq(poison, poison), distance, poison),
            index: R::select(is_edge, edges.index, face.index),
        }
    }

    /// Returns the best face axis, and a number that is NaN if any number of the boxes is NaN.
    #[inline(always)]
    fn best_face(&self) -> (Best<R>, R) {
        let (c, t, a, b) = (&self.cosine, &self.offset, &self.half_a, &self.half_b);
        let [mut of_a, mut of_b] = [[R::splat(0.0); 3]; 2];
        for k in 0..3 {
            let reach = b[0] * c[k][0].abs() + b[1] * c[k][1].abs() + b[2] * c[k][2].abs();
            of_a[k] = t[k].abs() - (a[k] + reach);
            let along = t[0] * c[0][k] + t[1] * c[1][k] + t[2] * c[2][k];
            let reach = a[0] * c[0][k].abs() + a[1] * c[1][k].abs() + a[2] * c[2][k].abs();
            of_b[k] = along.abs() - (b[k] + reach);
        }
        let mut best = Best::of(of_a[0], 0);
        best.try_axis(of_a[1], 1);
        best.try_axis(of_a[2], 2);
        best.try_axis(of_b[0], 3);
        best.try_axis(of_b[1], 4);
        best.try_axis(of_b[2], 5);
        (best, of_a[0] + of_a[1] + of_a[2])
    }

    /// Returns the best of the nine pairs of edges, by signed squared distance: the length of the cross product of two
    /// axes is their sine, and its square needs no root.
    #[inline(always)]
    fn best_edges(&self) -> Best<R> {
        let mut best = Best::of(R::splat(f32::NEG_INFINITY), 0);
        // Unrolled by hand; loops with variable indices would go through memory.
        best.try_axis(self.edges::<0, 0>(), 6);
        best.try_axis(self.edges::<0, 1>(), 7);
        best.try_axis(self.edges::<0, 2>(), 8);
        best.try_axis(self.edges::<1, 0>(), 9);
        best.try_axis(self.edges::<1, 1>(), 10);
        best.try_axis(self.edges::<1, 2>(), 11);
        best.try_axis(self.edges::<2, 0>(), 12);
        best.try_axis(self.edges::<2, 1>(), 13);
        best.try_axis(self.edges::<2, 2>(), 14);
        best
    }

    /// Returns the signed square of the gap along the cross product of edge `I` of A and edge `J` of B; NaN if the
    /// edges are parallel.
    #[inline(always)]
    fn edges<const I: usize, const J: usize>(&self) -> R {
        let (c, t, a, b) = (&self.cosine, &self.offset, &self.half_a, &self.half_b);
        let (k, l, m, n) = ((I + 1) % 3, (I + 2) % 3, (J + 1) % 3, (J + 2) % 3);
        let along = t[l] * c[k][J] - t[k] * c[l][J];
        let reach_a = a[k] * c[l][J].abs() + a[l] * c[k][J].abs();
        let reach_b = b[m] * c[I][n].abs() + b[n] * c[I][m].abs();
        let gap = along.abs() - (reach_a + reach_b);
        let squared_sine = c[k][J] * c[k][J] + c[l][J] * c[l][J];
        let parallel = R::le(squared_sine, R::splat(PARALLEL));
        (gap * gap.abs() / squared_sine).nan_where(parallel)
    }
}
