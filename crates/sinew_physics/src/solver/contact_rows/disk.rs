//! Impulses limited to a disk or a ball: friction and rolling resistance.

use sinew_math::{Mat3, Vec3, inverse3, max};

/// Returns the impulse in the disk of radius `most` with the least energy: it minimises `½ xᵀ K x − bᵀ x`.
///
/// Outside the disk the solution is `(K + μ 1)⁻¹ b`, with the μ that moves it to the rim (the secular equation of a trust region, Moré &
/// Sorensen 1983, by Newton). Shortening `K⁻¹ b` instead would push along the stiff direction only, and a sweep would never come to rest.
pub(crate) fn least_energy(k: &[[f32; 2]; 2], b: [f32; 2], most: f32) -> [f32; 2] {
    let solve = |mu: f32, b: [f32; 2]| {
        let (k00, k01, k11) = (k[0][0] + mu, k[0][1], k[1][1] + mu);
        let det = max(k00 * k11 - k01 * k01, 1e-9 * k00 * k11);
        [(k11 * b[0] - k01 * b[1]) / det, (k00 * b[1] - k01 * b[0]) / det]
    };
    let length = |x: [f32; 2]| (x[0] * x[0] + x[1] * x[1]).sqrt();
    if most <= 0.0 || k[0][0] <= 0.0 || k[1][1] <= 0.0 {
        return [0.0; 2];
    }
    let mut mu = 0.0;
    let mut x = solve(mu, b);
    if length(x) <= most {
        return x;
    }
    for _ in 0..6 {
        let y = solve(mu, x);
        let along = x[0] * y[0] + x[1] * y[1];
        let now = length(x);
        if along <= 0.0 || now <= most * 1.0001 {
            break;
        }
        mu += (now * now / along) * ((now - most) / most);
        x = solve(mu, b);
    }
    let scale = most / max(length(x), 1e-30);
    [x[0] * scale, x[1] * scale]
}

/// Returns an impulse in a ball after one projected gradient step from `x` against the rate `v` with response `k`. The step is exact if the
/// result is inside the ball.
pub(crate) fn step_in_ball(k: &Mat3, x: Vec3, v: Vec3, most: f32) -> Vec3 {
    let exact = x - inverse3(k) * v;
    if exact.is_finite() && exact.length() <= most {
        return exact;
    }
    // The trace bounds the largest eigenvalue, so the step cannot overshoot.
    let trace = k.x_axis.x + k.y_axis.y + k.z_axis.z;
    if trace <= 0.0 {
        return x;
    }
    let step = x - v / trace;
    let length = step.length();
    if length > most { step * (most / length) } else { step }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_math::{Random, trig};

    #[test]
    fn least_energy_impulse_is_minimal_within_the_disk() {
        let mut random = Random::new(4);
        for _ in 0..2000 {
            let (p, q, r) = (random.range(0.1, 3.0), random.range(-1.0, 1.0), random.range(0.1, 30.0));
            let k = [[p * p, p * q], [p * q, q * q + r]];
            let b = [random.range(-5.0, 5.0), random.range(-5.0, 5.0)];
            let most = random.range(0.01, 2.0);
            let energy = |x: [f32; 2]| {
                let [x, y] = x;
                0.5 * (k[0][0] * x * x + 2.0 * k[0][1] * x * y + k[1][1] * y * y) - b[0] * x - b[1] * y
            };
            let best = least_energy(&k, b, most);
            let found = energy(best);
            for i in 0..64 {
                let (s, c) = trig::sin_cos(i as f32 * 0.1);
                for share in [0.25, 0.5, 0.9, 1.0] {
                    let other = [c * most * share, s * most * share];
                    assert!(
                        found <= energy(other) + 1e-3 * (1.0 + found.abs()),
                        "{best:?} has more energy than {other:?}"
                    );
                }
            }
        }
    }
}
