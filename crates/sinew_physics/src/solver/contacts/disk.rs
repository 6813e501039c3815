//! Friction and rolling impulses of eight manifolds, each limited to its disk or ball: [`crate::solver::disk`] in lanes.

use crate::solver::tuning::FRICTION_RIM_STEPS;
use sinew_math::lanes::{LaneMask, Lanes, Vector3};

/// Computes `(K + μ 1)⁻¹ b` for a symmetric 2×2 matrix (00, 01, 11).
#[inline(always)]
fn solve<L: Lanes>(k: [L; 3], mu: L, b: [L; 2]) -> [L; 2] {
    let (k00, k01, k11) = (k[0] + mu, k[1], k[2] + mu);
    let product = k00 * k11;
    let det = L::max(product - k01 * k01, L::splat(1e-9) * product);
    let inverse = L::splat(1.0) / det;
    [(k11 * b[0] - k01 * b[1]) * inverse, (k00 * b[1] - k01 * b[0]) * inverse]
}

#[inline(always)]
fn length<L: Lanes>(x: [L; 2]) -> L {
    (x[0] * x[0] + x[1] * x[1]).sqrt()
}

/// Returns the impulses in the disks of radius `most` with the least energy: they minimise `½ xᵀ K x − bᵀ x` (the
/// secular equation of a trust region, Moré and Sorensen 1983, by Newton).
#[inline(always)]
pub(super) fn least_energy<L: Lanes>(k: [L; 3], b: [L; 2], most: L) -> [L; 2] {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let moves = L::gt(most, zero) & L::gt(k[0], zero) & L::gt(k[2], zero);
    let mut mu = zero;
    let mut x = solve(k, mu, b);
    let beyond = moves & L::gt(length(x), most);
    if beyond.any() {
        for _ in 0..FRICTION_RIM_STEPS {
            let y = solve(k, mu, x);
            let along = x[0] * y[0] + x[1] * y[1];
            let now = length(x);
            let goes_on = beyond & L::gt(along, zero) & L::gt(now, most * L::splat(1.0001));
            if !goes_on.any() {
                break;
            }
            let step = ((now * now) / along) * ((now - most) / most);
            mu = mu + step.masked(goes_on);
            x = solve(k, mu, b);
        }
        let scale = L::select(beyond, most / L::max(length(x), L::splat(1e-30)), one);
        x = [x[0] * scale, x[1] * scale];
    }
    [x[0].masked(moves), x[1].masked(moves)]
}

/// Returns impulses in balls of radius `most` after one projected gradient step from `x` against the rates `v`. The
/// step is exact if the result is inside the ball. `answer` is `K⁻¹ v`. The trace of `K` bounds its largest eigenvalue,
/// so the step cannot overshoot.
#[inline(always)]
pub(super) fn step_in_ball<L: Lanes>(
    x: Vector3<L>,
    v: Vector3<L>,
    answer: Vector3<L>,
    trace: L,
    most: L,
) -> Vector3<L> {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let exact = x - answer;
    let holds = L::le(exact.length(), most);
    let turns = L::gt(trace, zero);
    let step = x - v * (one / L::select(turns, trace, one));
    let long = step.length();
    let scale = L::select(L::gt(long, most), most / L::max(long, L::splat(1e-30)), one);
    let rim = step * scale;

    let step = select3(holds, exact, rim);
    select3(turns, step, x)
}

#[inline(always)]
fn select3<L: Lanes>(mask: L::Mask, a: Vector3<L>, b: Vector3<L>) -> Vector3<L> {
    Vector3::new(L::select(mask, a.x, b.x), L::select(mask, a.y, b.y), L::select(mask, a.z, b.z))
}
