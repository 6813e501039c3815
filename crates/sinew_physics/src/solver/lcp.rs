//! The small linear complementarity problem of one manifold's normal rows.

use crate::spatial::{Mat6, spd_inverse};
use sinew_math::max;

/// At most this many rows.
const N: usize = 4;

/// New impulses `x ≥ 0` of `n` unilateral rows with response `k`, gap velocities `v` (at impulses `old`, bias
/// included) and softness `soft`: `K (x − old) + v + soft x ≥ 0`, complementary to `x`.
///
/// Active set with a proximal term (four coplanar points make K singular). The set may cycle: then Gauss-Seidel on
/// the block, without which a body explodes about once in five 30 m/s wall hits.
pub(crate) fn solve(k: &[[f32; N]; N], v: &[f32; N], old: &[f32; N], soft: &[f32; N], n: usize) -> [f32; N] {
    let mut largest = 0.0;
    for i in 0..n {
        largest = max(largest, k[i][i]);
    }
    let proximal = 1e-5 * largest;
    let mut m = *k;
    let mut r = [0.0; N];
    for i in 0..n {
        m[i][i] += soft[i];
        r[i] = v[i] + soft[i] * old[i];
    }
    let change =
        active_set(&m, &r, old, proximal, n).unwrap_or_else(|| gauss_seidel(&m, &r, old, proximal, n));
    let mut new = [0.0; N];
    for i in 0..n {
        new[i] = max(old[i] + change[i], 0.0);
    }
    new
}

fn row(m: &[[f32; N]; N], i: usize, x: &[f32; N], n: usize) -> f32 {
    let mut sum = 0.0;
    for j in 0..n {
        sum += m[i][j] * x[j];
    }
    sum
}

fn active_set(m: &[[f32; N]; N], r: &[f32; N], old: &[f32; N], proximal: f32, n: usize) -> Option<[f32; N]> {
    let mut active = [false; N];
    for i in 0..n {
        active[i] = old[i] > 0.0 || r[i] < 0.0;
    }
    for _ in 0..8 {
        let mut x = [0.0; N];
        for i in 0..n {
            x[i] = if active[i] { 0.0 } else { -old[i] };
        }
        solve_active(m, r, &active, proximal, n, &mut x)?;
        let (mut drop, mut add) = ([false; N], [false; N]);
        for i in 0..n {
            drop[i] = active[i] && old[i] + x[i] < 0.0;
            add[i] = !active[i] && r[i] + row(m, i, &x, n) < -1e-7;
        }
        if drop.contains(&true) {
            for i in 0..n {
                active[i] &= !drop[i];
            }
        } else if add.contains(&true) {
            for i in 0..n {
                active[i] |= add[i];
            }
        } else {
            return Some(x);
        }
    }
    None
}

/// Solves the equations of the active rows with the inactive ones as they are in `x`.
fn solve_active(
    m: &[[f32; N]; N],
    r: &[f32; N],
    active: &[bool; N],
    proximal: f32,
    n: usize,
    x: &mut [f32; N],
) -> Option<()> {
    let mut index = [0; N];
    let mut count = 0;
    for i in 0..n {
        if active[i] {
            index[count] = i;
            count += 1;
        }
    }
    let mut a: Mat6 = [[0.0; 6]; 6];
    let mut b = [0.0; N];
    for p in 0..count {
        for q in 0..count {
            a[p][q] = m[index[p]][index[q]];
        }
        a[p][p] += proximal;
        b[p] = r[index[p]] + row(m, index[p], x, n);
    }
    let inverse = spd_inverse(&a, count)?;
    for p in 0..count {
        let mut sum = 0.0;
        for q in 0..count {
            sum += inverse[p][q] * b[q];
        }
        x[index[p]] = -sum;
    }
    Some(())
}

fn gauss_seidel(m: &[[f32; N]; N], r: &[f32; N], old: &[f32; N], proximal: f32, n: usize) -> [f32; N] {
    let mut x = [0.0; N];
    for _ in 0..16 {
        for i in 0..n {
            x[i] = max(-old[i], x[i] - (r[i] + row(m, i, &x, n)) / (m[i][i] + proximal));
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::Random;

    #[test]
    fn solutions_are_complementary() {
        let mut random = Random::new(3);
        for case in 0..2000 {
            let n = 1 + random.index(4);
            let mut g = [[0.0; N]; N];
            for line in &mut g {
                for x in line.iter_mut() {
                    *x = random.range(-1.0, 1.0);
                }
            }
            let (mut k, mut v, mut old) = ([[0.0; N]; N], [0.0; N], [0.0; N]);
            for i in 0..n {
                for j in 0..n {
                    for l in 0..N {
                        k[i][j] += g[i][l] * g[j][l];
                    }
                }
                k[i][i] += 0.1;
                v[i] = random.range(-2.0, 2.0);
                old[i] = max(0.0, random.range(-1.0, 1.0));
            }
            let new = solve(&k, &v, &old, &[0.0; N], n);
            for i in 0..n {
                let mut rate = v[i];
                for j in 0..n {
                    rate += k[i][j] * (new[j] - old[j]);
                }
                assert!(new[i] >= 0.0 && rate > -2e-3, "case {case}: row {i} {new:?} rate {rate}");
                assert!(new[i] * rate.abs() < 5e-3, "case {case}: row {i} pushes while it opens");
            }
        }
    }
}
