//! Overlap test of two boxes, for one pair or for eight at a time: fifteen comparisons without square roots or
//! divisions (Ericson, "Real-Time Collision Detection", 2005, §4.4.1).

use super::PlacedBox;
use sinew_math::lanes::{Real, Vector3};

/// Largest gap, relative to the boxes' sizes and distance, at which separated boxes still count as touching; several
/// times the rounding error of `f32`.
const TOUCH: f32 = 5e-7;

/// Two boxes in the frame of the first. They are apart if, along one of 15 directions, the offset of their centres
/// exceeds the sum of their half widths.
///
/// With `Rᵢⱼ = aᵢ·bⱼ`, `t` the offset in A's axes, `|t|₁` the sum of its absolute components and `slack = TOUCH × (|t|₁
/// + (|ha|₁ + |hb|₁))`, indices modulo 3, sums from the left, the boxes overlap if for all `i`, `j`
/// - faces of A: `|tᵢ| ≤ (haᵢ + (hb₀|Rᵢ₀| + hb₁|Rᵢ₁| + hb₂|Rᵢ₂|)) + slack`
/// - faces of B: `|t₀R₀ⱼ + t₁R₁ⱼ + t₂R₂ⱼ| ≤ (hbⱼ + (ha₀|R₀ⱼ| + ha₁|R₁ⱼ| + ha₂|R₂ⱼ|)) + slack`
/// - edges, with `i1 = i + 1`, `i2 = i + 2`, `j1 = j + 1`, `j2 = j + 2`:
///   `|tᵢ₂Rᵢ₁ⱼ − tᵢ₁Rᵢ₂ⱼ| ≤ ((haᵢ₁|Rᵢ₂ⱼ| + haᵢ₂|Rᵢ₁ⱼ|) + (hbⱼ₁|Rᵢⱼ₂| + hbⱼ₂|Rᵢⱼ₁|)) + slack`
///
/// Both sides of the last comparison vanish as edges become parallel; the slack prevents a separation by rounding.
pub(super) struct FifteenAxes<R> {
    half_a: [R; 3],
    half_b: [R; 3],
    /// Centre of B along the axes of A.
    offset: [R; 3],
    /// `cosine[i][j]` is the dot product of axis `i` of A and axis `j` of B.
    cosine: [[R; 3]; 3],
    /// Tolerance of each comparison, metres.
    slack: R,
}

impl FifteenAxes<f32> {
    /// Prepares the test of one pair of boxes.
    pub fn of(a: &PlacedBox, b: &PlacedBox) -> Self {
        let parts = |of: &PlacedBox| (of.center.into(), of.axes.map(Into::into), of.half.into());
        Self::new(parts(a), parts(b))
    }

    /// True if no axis separates the boxes.
    pub fn overlap(&self) -> bool {
        self.faces() && self.edges()
    }
}

impl<R: Real> FifteenAxes<R> {
    /// Prepares the test of boxes given by their centres, the unit directions of their sides, and their half extents.
    #[inline(always)]
    pub fn new(
        (center_a, [ax, ay, az], half_a): (Vector3<R>, [Vector3<R>; 3], Vector3<R>),
        (center_b, [bx, by, bz], half_b): (Vector3<R>, [Vector3<R>; 3], Vector3<R>),
    ) -> Self {
        let way = center_b - center_a;
        let offset = Vector3::new(way.dot(ax), way.dot(ay), way.dot(az));
        let sum = offset.abs().sum() + (half_a.sum() + half_b.sum());
        Self {
            half_a: half_a.to_array(),
            half_b: half_b.to_array(),
            offset: offset.to_array(),
            cosine: [
                [ax.dot(bx), ax.dot(by), ax.dot(bz)],
                [ay.dot(bx), ay.dot(by), ay.dot(bz)],
                [az.dot(bx), az.dot(by), az.dot(bz)],
            ],
            slack: R::splat(TOUCH) * sum,
        }
    }

    /// True if the boxes have no gap along any face normal.
    #[inline(always)]
    pub fn faces(&self) -> R::Mask {
        self.face_of_a::<0>()
            & self.face_of_a::<1>()
            & self.face_of_a::<2>()
            & self.face_of_b::<0>()
            & self.face_of_b::<1>()
            & self.face_of_b::<2>()
    }

    /// True if the boxes have no gap along any cross product of two edges.
    #[inline(always)]
    pub fn edges(&self) -> R::Mask {
        self.pair::<0, 0>()
            & self.pair::<0, 1>()
            & self.pair::<0, 2>()
            & self.pair::<1, 0>()
            & self.pair::<1, 1>()
            & self.pair::<1, 2>()
            & self.pair::<2, 0>()
            & self.pair::<2, 1>()
            & self.pair::<2, 2>()
    }

    #[inline(always)]
    fn face_of_a<const I: usize>(&self) -> R::Mask {
        let ([x, y, z], b) = (self.cosine[I], &self.half_b);
        let width = self.half_a[I] + (b[0] * x.abs() + b[1] * y.abs() + b[2] * z.abs());
        R::le(self.offset[I].abs(), width + self.slack)
    }

    #[inline(always)]
    fn face_of_b<const J: usize>(&self) -> R::Mask {
        let (c, t, a) = (&self.cosine, &self.offset, &self.half_a);
        let along = t[0] * c[0][J] + t[1] * c[1][J] + t[2] * c[2][J];
        let width = self.half_b[J] + (a[0] * c[0][J].abs() + a[1] * c[1][J].abs() + a[2] * c[2][J].abs());
        R::le(along.abs(), width + self.slack)
    }

    #[inline(always)]
    fn pair<const I: usize, const J: usize>(&self) -> R::Mask {
        let (c, t, a, b) = (&self.cosine, &self.offset, &self.half_a, &self.half_b);
        let (k, l, m, n) = ((I + 1) % 3, (I + 2) % 3, (J + 1) % 3, (J + 2) % 3);
        let along = t[l] * c[k][J] - t[k] * c[l][J];
        let width_a = a[k] * c[l][J].abs() + a[l] * c[k][J].abs();
        let width_b = b[m] * c[I][n].abs() + b[n] * c[I][m].abs();
        R::le(along.abs(), (width_a + width_b) + self.slack)
    }
}
