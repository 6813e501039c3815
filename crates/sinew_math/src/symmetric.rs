use crate::{Mat3, Rotation, Vec3};
use core::ops::{Add, AddAssign, Mul, Sub};

/// A symmetric 3×3 matrix: inertia tensors, stiffness blocks, covariances.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Sym3 {
    /// Diagonal (xx, yy, zz).
    pub diagonal: Vec3,
    /// Off-diagonal (yz, xz, xy).
    pub off: Vec3,
}

impl Sym3 {
    /// The zero matrix.
    pub const ZERO: Self = Self { diagonal: Vec3::ZERO, off: Vec3::ZERO };
    /// The unit matrix.
    pub const IDENTITY: Self = Self { diagonal: Vec3::ONE, off: Vec3::ZERO };

    /// Creates a diagonal matrix.
    pub const fn from_diagonal(diagonal: Vec3) -> Self {
        Self { diagonal, off: Vec3::ZERO }
    }

    /// Returns `v vᵀ`.
    pub fn outer(v: Vec3) -> Self {
        Self {
            diagonal: Vec3::new(v.x * v.x, v.y * v.y, v.z * v.z),
            off: Vec3::new(v.y * v.z, v.x * v.z, v.x * v.y),
        }
    }

    /// Returns `R D Rᵀ`: the tensor with the principal values `d` along the axes of `rotation`.
    #[inline]
    pub fn from_rotated_diagonal(rotation: Rotation, d: Vec3) -> Self {
        let m = rotation.to_mat3();
        let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
        Self {
            diagonal: Vec3::new(
                x.x * x.x * d.x + y.x * y.x * d.y + z.x * z.x * d.z,
                x.y * x.y * d.x + y.y * y.y * d.y + z.y * z.y * d.z,
                x.z * x.z * d.x + y.z * y.z * d.y + z.z * z.z * d.z,
            ),
            off: Vec3::new(
                x.y * x.z * d.x + y.y * y.z * d.y + z.y * z.z * d.z,
                x.x * x.z * d.x + y.x * y.z * d.y + z.x * z.z * d.z,
                x.x * x.y * d.x + y.x * y.y * d.y + z.x * z.y * d.z,
            ),
        }
    }

    /// Returns `R S Rᵀ`: the tensor rotated by `rotation`.
    pub fn rotated(self, rotation: Rotation) -> Self {
        let r = rotation.to_mat3();
        Self::from_mat3(&(r * self.to_mat3() * r.transpose()))
    }

    /// Returns the symmetric part of a matrix.
    pub fn from_mat3(m: &Mat3) -> Self {
        Self {
            diagonal: Vec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z),
            off: Vec3::new(m.z_axis.y + m.y_axis.z, m.z_axis.x + m.x_axis.z, m.y_axis.x + m.x_axis.y) * 0.5,
        }
    }

    /// Converts to a full matrix.
    pub fn to_mat3(self) -> Mat3 {
        let (d, o) = (self.diagonal, self.off);
        Mat3::from_cols(Vec3::new(d.x, o.z, o.y), Vec3::new(o.z, d.y, o.x), Vec3::new(o.y, o.x, d.z))
    }

    /// True if every number is finite.
    pub fn is_finite(self) -> bool {
        self.diagonal.is_finite() && self.off.is_finite()
    }

    /// Returns the determinant.
    pub fn determinant(self) -> f32 {
        let (d, o) = (self.diagonal, self.off);
        d.x * (d.y * d.z - o.x * o.x) - o.z * (o.z * d.z - o.x * o.y) + o.y * (o.z * o.x - d.y * o.y)
    }

    /// Returns the inverse; zero if the determinant is zero.
    pub fn inverse(self) -> Self {
        let (d, o) = (self.diagonal, self.off);
        let det = self.determinant();
        if det == 0.0 {
            return Self::ZERO;
        }
        let k = 1.0 / det;
        Self {
            diagonal: Vec3::new(d.y * d.z - o.x * o.x, d.x * d.z - o.y * o.y, d.x * d.y - o.z * o.z) * k,
            off: Vec3::new(o.z * o.y - d.x * o.x, o.z * o.x - d.y * o.y, o.y * o.x - d.z * o.z) * k,
        }
    }

    /// Returns the eigenvalues, largest first, and the rotation whose columns are their eigenvectors (cyclic
    /// Jacobi, Golub & Van Loan §8.5, until the off-diagonal part is below 1e-9 of the trace).
    pub fn eigen(self) -> (Vec3, Rotation) {
        let (d, o) = (self.diagonal, self.off);
        let (values, vectors) = jacobi([[d.x, o.z, o.y], [o.z, d.y, o.x], [o.y, o.x, d.z]]);
        let mut order = [0, 1, 2];
        // Stable insertion by value, so that equal eigenvalues keep the order of the axes.
        for i in 1..3 {
            let mut j = i;
            while j > 0 && values[order[j]] > values[order[j - 1]] {
                order.swap(j, j - 1);
                j -= 1;
            }
        }
        let column = |i: usize| Vec3::new(vectors[0][i], vectors[1][i], vectors[2][i]);
        let (x, y) = (column(order[0]), column(order[1]));
        let frame = Mat3::from_cols(x, y, x.cross(y));
        let [first, second, third] = order.map(|i| values[i]);
        (Vec3::new(first, second, third), Rotation::from_mat3(&frame))
    }
}

/// Returns the eigenvalues of a symmetric matrix, and the matrix whose columns are their eigenvectors, in no
/// order (cyclic Jacobi, Golub & Van Loan §8.5, until the off-diagonal part is below 1e-9 of the trace).
pub(crate) fn jacobi<const N: usize>(mut a: [[f32; N]; N]) -> ([f32; N], [[f32; N]; N]) {
    let mut v = [[0.0; N]; N];
    for i in 0..N {
        v[i][i] = 1.0;
    }
    let pairs = || (0..N).flat_map(|p| (p + 1..N).map(move |q| (p, q)));
    for _ in 0..16 {
        let off: f32 = pairs().map(|(p, q)| a[p][q].abs()).sum();
        let trace: f32 = (0..N).map(|i| a[i][i].abs()).sum();
        if off <= 1e-9 * trace {
            break;
        }
        for (p, q) in pairs() {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let sign = if theta >= 0.0 { 1.0 } else { -1.0 };
            let t = sign / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for k in 0..N {
                let (kp, kq) = (a[k][p], a[k][q]);
                a[k][p] = c * kp - s * kq;
                a[k][q] = s * kp + c * kq;
            }
            for k in 0..N {
                let (pk, qk) = (a[p][k], a[q][k]);
                a[p][k] = c * pk - s * qk;
                a[q][k] = s * pk + c * qk;
                let (kp, kq) = (v[k][p], v[k][q]);
                v[k][p] = c * kp - s * kq;
                v[k][q] = s * kp + c * kq;
            }
        }
    }
    (core::array::from_fn(|i| a[i][i]), v)
}

impl Add for Sym3 {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        Self { diagonal: self.diagonal + b.diagonal, off: self.off + b.off }
    }
}

impl AddAssign for Sym3 {
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}

impl Sub for Sym3 {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        Self { diagonal: self.diagonal - b.diagonal, off: self.off - b.off }
    }
}

impl Mul<f32> for Sym3 {
    type Output = Self;
    #[inline]
    fn mul(self, k: f32) -> Self {
        Self { diagonal: self.diagonal * k, off: self.off * k }
    }
}

impl Mul<Vec3> for Sym3 {
    type Output = Vec3;
    #[inline]
    fn mul(self, v: Vec3) -> Vec3 {
        let (d, o) = (self.diagonal, self.off);
        Vec3::new(
            d.x * v.x + o.z * v.y + o.y * v.z,
            o.z * v.x + d.y * v.y + o.x * v.z,
            o.y * v.x + o.x * v.y + d.z * v.z,
        )
    }
}
