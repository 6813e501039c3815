//! Matrices that should be rotations: measures and corrects their drift.

use crate::symmetric::jacobi;
use crate::{Mat3, Rotation, Vec3, abs3, any_orthonormal, max, max3, normalize_or};

/// Distance of a matrix from the rotation matrices. A rotation has `{ deviation: 0, determinant: 1 }`, up to rounding:
/// at most 2e-6 and 1.5e-6 for a matrix made by [`Rotation::to_mat3`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MatrixDrift {
    /// `‖RᵀR − I‖`, Frobenius: 0 if the columns are orthonormal, mirrored or not.
    pub deviation: f32,
    /// Determinant: the signed volume of the transformed unit cube; −1 if mirrored.
    pub determinant: f32,
}

impl MatrixDrift {
    /// Measures the drift of a matrix.
    pub fn of(m: &Mat3) -> Self {
        Self { deviation: frobenius(&(m.transpose() * *m - Mat3::IDENTITY)), determinant: m.determinant() }
    }
}

/// Method of converting a nearly orthonormal matrix to a rotation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Orthonormalization {
    /// The rotation nearest to the matrix in the sum of squared differences: the rotation part of its polar
    /// decomposition (Higham, "Computing the polar decomposition", 1986). The default, because it treats the three axes
    /// alike: the result rotates with the matrix, and pure stretch gives no rotation.
    ///
    /// Computed as the eigenvector of the largest eigenvalue of Horn's symmetric 4×4 matrix ("Closed-form solution of
    /// absolute orientation using unit quaternions", 1987), so mirrored and flat matrices have a result too.
    #[default]
    Polar,
    /// Gram-Schmidt: x keeps its direction, y loses its component along x, z is the cross product of x and y. Cheaper
    /// (two square roots) and exact in x, but the whole error goes into y and z, and the result does not commute with
    /// rotations.
    GramSchmidt,
}

/// Result of correcting a matrix to a rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orthonormalized {
    /// The rotation; [`Rotation::to_mat3`] returns its matrix.
    pub rotation: Rotation,
    /// `‖M − R‖`, Frobenius: size of the correction. Infinite for a matrix that is not finite.
    pub residual: f32,
    /// Uniqueness of the result.
    pub answer: Uniqueness,
}

/// Uniqueness of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Uniqueness {
    /// There is only one nearest rotation.
    Unique,
    /// Other rotations are as near; the choice depends on the matrix alone. This happens with zero or parallel columns
    /// (the zero matrix and matrices that are not finite give the identity), and for [`Orthonormalization::Polar`] with
    /// mirrored matrices whose two smallest stretches are equal, such as −I.
    Arbitrary,
}

/// Relative difference below which two candidates count as equal (rounding).
const ROUNDING: f32 = 1e-6;

/// Returns the rotation part of a matrix, without scale, shear and mirroring.
pub fn orthonormalize(m: &Mat3, method: Orthonormalization) -> Orthonormalized {
    if !m.is_finite() {
        let residual = f32::INFINITY;
        return Orthonormalized { rotation: Rotation::IDENTITY, residual, answer: Uniqueness::Arbitrary };
    }
    let (rotation, answer) = match method {
        _ if *m == Mat3::ZERO => (Rotation::IDENTITY, Uniqueness::Arbitrary),
        Orthonormalization::Polar => nearest(m),
        Orthonormalization::GramSchmidt => gram_schmidt(m),
    };
    Orthonormalized { rotation, residual: frobenius(&(*m - rotation.to_mat3())), answer }
}

/// Returns the rotation nearest to a matrix that is not zero, and its uniqueness.
fn nearest(m: &Mat3) -> (Rotation, Uniqueness) {
    let columns = [m.x_axis, m.y_axis, m.z_axis].map(abs3);
    let largest = max3(columns[0], max3(columns[1], columns[2]));
    let largest = max(largest.x, max(largest.y, largest.z));
    // Divides by the largest element first, so that matrices of every size give the same result without overflow.
    let [a, b, c] = [m.x_axis, m.y_axis, m.z_axis].map(|column| column / largest);
    // tr(RᵀM) = qᵀKq for the quaternion q = (x, y, z, w) of R: the nearest rotation maximises it.
    let (values, vectors) = jacobi([
        [a.x - b.y - c.z, a.y + b.x, c.x + a.z, b.z - c.y],
        [a.y + b.x, b.y - a.x - c.z, b.z + c.y, c.x - a.z],
        [c.x + a.z, b.z + c.y, c.z - a.x - b.y, a.y - b.x],
        [b.z - c.y, c.x - a.z, a.y - b.x, a.x + b.y + c.z],
    ]);
    let mut order = [3, 0, 1, 2];
    order.sort_by(|&i, &j| values[j].total_cmp(&values[i]));
    let [first, second, ..] = order;
    let q = Rotation::from_xyzw(vectors[0][first], vectors[1][first], vectors[2][first], vectors[3][first]);
    // With stretches σ₁ ≥ σ₂ ≥ |σ₃| (σ₃ < 0 if mirrored) the two largest eigenvalues are σ₁ + σ₂ + σ₃ and σ₁ − σ₂ − σ₃.
    let is_unique = values[first] - values[second] > ROUNDING * (values[first] + values[second]);
    (q.normalize().positive(), if is_unique { Uniqueness::Unique } else { Uniqueness::Arbitrary })
}

pub(crate) fn gram_schmidt(m: &Mat3) -> (Rotation, Uniqueness) {
    let x = normalize_or(m.x_axis, Vec3::X);
    let y = m.y_axis - x * x.dot(m.y_axis);
    let is_unique = m.x_axis.length() > 1e-12 && y.length() > ROUNDING * m.y_axis.length();
    let y = normalize_or(y, any_orthonormal(x));
    let rotation = Rotation::from_mat3(&Mat3::from_cols(x, y, x.cross(y)));
    (rotation, if is_unique { Uniqueness::Unique } else { Uniqueness::Arbitrary })
}

fn frobenius(m: &Mat3) -> f32 {
    (m.x_axis.length_squared() + m.y_axis.length_squared() + m.z_axis.length_squared()).sqrt()
}
