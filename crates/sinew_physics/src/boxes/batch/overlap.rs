//! Whether two boxes overlap: fifteen comparisons without a root or a division.

use super::record::Record;
use crate::boxes::separation::TOUCH;
use sinew_math::lanes::{Real, Vector3};

/// Two boxes in the frame of the first, as `Obb::overlaps_obb` has them, operation by operation: the bits are equal.
pub(super) struct Overlap<R> {
    half_a: [R; 3],
    half_b: [R; 3],
    /// Centre of B along the axes of A.
    offset: [R; 3],
    /// `cosine[i][j]` is axis `i` of A times axis `j` of B.
    cosine: [[R; 3]; 3],
    /// Metres.
    slack: R,
}

impl<R: Real> Overlap<R> {
    #[inline(always)]
    pub fn new(a: &Record<R>, b: &Record<R>) -> Self {
        let ([ax, ay, az], [bx, by, bz]) = (a.axes(), b.axes());
        let way = b.center - a.center;
        let offset = Vector3::new(way.dot(ax), way.dot(ay), way.dot(az));
        let sum = offset.abs().sum() + (a.half.sum() + b.half.sum());
        Self {
            half_a: a.half.to_array(),
            half_b: b.half.to_array(),
            offset: offset.to_array(),
            cosine: [
                [ax.dot(bx), ax.dot(by), ax.dot(bz)],
                [ay.dot(bx), ay.dot(by), ay.dot(bz)],
                [az.dot(bx), az.dot(by), az.dot(bz)],
            ],
            slack: R::splat(TOUCH) * sum,
        }
    }

    /// Whether the axes of the faces leave no gap.
    #[inline(always)]
    pub fn faces(&self) -> R::Mask {
        self.face_of_a::<0>()
            & self.face_of_a::<1>()
            & self.face_of_a::<2>()
            & self.face_of_b::<0>()
            & self.face_of_b::<1>()
            & self.face_of_b::<2>()
    }

    /// Whether what is at right angles to an edge of each leaves no gap.
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
