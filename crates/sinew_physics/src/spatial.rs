//! Six-dimensional algebra of the joint trees: linear part first, angular part second.

use sinew_math::lanes::WIDTH;
use sinew_math::{Vec3, max};

/// Velocity (m/s, rad/s) or impulse (N·s, N·m·s) of a body at its centre of mass, or one row of a Jacobian: six numbers
/// and two zeros, which fill a register of eight.
pub(crate) type Vec6 = [f32; WIDTH];
/// Rows of a 6×6 matrix.
pub(crate) type Mat6 = [Vec6; 6];

pub(crate) const ZERO6: Vec6 = [0.0; WIDTH];
pub(crate) const ZERO66: Mat6 = [ZERO6; 6];
/// Rows of the unit matrix.
pub(crate) const UNITS: Mat6 = {
    let mut units = ZERO66;
    let mut k = 0;
    while k < 6 {
        units[k][k] = 1.0;
        k += 1;
    }
    units
};

#[inline(always)]
pub(crate) fn join(linear: Vec3, angular: Vec3) -> Vec6 {
    [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z, 0.0, 0.0]
}

/// Spatial impulse at the centre of mass of a linear impulse at `arm` from it.
#[inline(always)]
pub(crate) fn wrench(arm: Vec3, impulse: Vec3) -> Vec6 {
    join(impulse, arm.cross(impulse))
}

#[inline(always)]
pub(crate) fn linear(v: &Vec6) -> Vec3 {
    Vec3::new(v[0], v[1], v[2])
}

#[inline(always)]
pub(crate) fn angular(v: &Vec6) -> Vec3 {
    Vec3::new(v[3], v[4], v[5])
}

#[inline(always)]
pub(crate) fn dot(a: &Vec6, b: &Vec6) -> f32 {
    (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) + (a[3] * b[3] + a[4] * b[4] + a[5] * b[5])
}

/// Largest absolute value of the components; compares in pairs, as registers hold them.
#[inline(always)]
pub(crate) fn largest(v: &Vec6) -> f32 {
    let [a, b, c, d, e, f, g, h] = v.map(f32::abs);
    let [a, b, c, d] = [max(a, e), max(b, f), max(c, g), max(d, h)];
    max(max(a, c), max(b, d))
}

/// `a − b`
#[inline(always)]
pub(crate) fn difference(a: &Vec6, b: &Vec6) -> Vec6 {
    core::array::from_fn(|k| a[k] - b[k])
}

/// `a += k b`
#[inline(always)]
pub(crate) fn add_scaled(a: &mut Vec6, b: &Vec6, k: f32) {
    for (a, b) in a.iter_mut().zip(b) {
        *a += b * k;
    }
}

/// Inverse of the leading `n`×`n` block of a symmetric positive definite matrix by LDLᵀ; the other entries are zero.
/// `None` if a pivot is not safely positive (below 1e-7 of its diagonal entry) or not finite.
#[inline(always)]
pub(crate) fn spd_inverse(m: &Mat6, n: usize) -> Option<Mat6> {
    match n {
        0 => Some(ZERO66),
        1 => inverse_of::<1>(m),
        2 => inverse_of::<2>(m),
        3 => inverse_of::<3>(m),
        4 => inverse_of::<4>(m),
        5 => inverse_of::<5>(m),
        _ => inverse_of::<6>(m),
    }
}

/// Inverts with constant loop bounds, which the compiler unrolls.
#[inline(always)]
fn inverse_of<const N: usize>(m: &Mat6) -> Option<Mat6> {
    // L below the diagonal, 1/D on it.
    let mut l = [[0.0; N]; N];
    for i in 0..N {
        // Row i holds L·D until it is divided below.
        for j in 0..i {
            let mut sum = m[i][j];
            for k in 0..j {
                sum -= l[i][k] * l[j][k];
            }
            l[i][j] = sum;
        }
        let mut pivot = m[i][i];
        for k in 0..i {
            pivot -= l[i][k] * l[i][k] * l[k][k];
        }
        let safe = pivot > 1e-7 * m[i][i] && pivot < f32::INFINITY;
        if !safe {
            return None;
        }
        l[i][i] = 1.0 / pivot;
        for k in 0..i {
            l[i][k] *= l[k][k];
        }
    }
    // All columns together: L D Lᵀ X = 1, row by row of X.
    let mut inverse = ZERO66;
    for i in 0..N {
        inverse[i][i] = 1.0;
        for k in 0..i {
            let above = inverse[k];
            add_scaled(&mut inverse[i], &above, -l[i][k]);
        }
    }
    for i in 0..N {
        inverse[i] = inverse[i].map(|x| x * l[i][i]);
    }
    for i in (0..N).rev() {
        for k in i + 1..N {
            let below = inverse[k];
            add_scaled(&mut inverse[i], &below, -l[k][i]);
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::Random;

    /// `a b`
    fn product(a: &Mat6, b: &Mat6) -> Mat6 {
        let mut out = ZERO66;
        for i in 0..6 {
            for k in 0..6 {
                add_scaled(&mut out[i], &b[k], a[i][k]);
            }
        }
        out
    }

    #[test]
    fn inverse_of_random_spd_matrices() {
        let mut random = Random::new(7);
        for n in 1..=6 {
            for _ in 0..50 {
                let mut g = ZERO66;
                for row in g.iter_mut().take(n) {
                    for x in row.iter_mut().take(n) {
                        *x = random.range(-1.0, 1.0);
                    }
                }
                let mut m = ZERO66;
                for i in 0..n {
                    for j in 0..n {
                        m[i][j] = dot(&g[i], &g[j]) + if i == j { 0.5 } else { 0.0 };
                    }
                }
                let inverse = spd_inverse(&m, n).expect("positive definite");
                let unit = product(&m, &inverse);
                for i in 0..n {
                    for j in 0..n {
                        let expected = if i == j { 1.0 } else { 0.0 };
                        assert!((unit[i][j] - expected).abs() < 2e-4, "n {n}: {unit:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_singular_matrix_is_refused() {
        let mut m = ZERO66;
        m[0] = [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        m[1] = [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert!(spd_inverse(&m, 2).is_none());
        m[1][1] = f32::NAN;
        assert!(spd_inverse(&m, 2).is_none());
    }
}
