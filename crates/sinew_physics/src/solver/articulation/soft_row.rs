//! A soft row of a joint: a spring, a motor, friction.

use crate::joint::def::Softness;
use crate::solver::tuning::{FASTEST_SPRING, SPRING_MARGIN};
use sinew_math::trig;

/// Soft row with the impulse `λ = −(gain v⁺ + carry v + push)`, where `v` and `v⁺` are its rates at the beginning and at the end of the
/// substep.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::solver) struct SoftRow {
    pub(super) gain: f32,
    pub(super) carry: f32,
    pub(super) push: f32,
}

impl SoftRow {
    /// Adds a damped oscillator of the given mass, where `x` is the displacement from the target and `rate` the target rate. Its poles and
    /// static stiffness are those of the differential equation, for any substep: with poles `e^(−ζωh ± iω_d h)` and `x⁺ = x + h v⁺`, the
    /// update `(1 + α) v⁺ = (1 − γ) v − h ω² x` has determinant `(1 − γ)/(1 + α)` and `(1 + α)(1 + det − trace) = (ωh)²`. Implicit Euler
    /// would add a damping ratio of ωh/2. `least` is the smallest mass that may move by itself while the rest yields.
    pub(super) fn add_spring(
        &mut self,
        softness: Softness,
        [mass, least]: [f32; 2],
        x: f32,
        rate: f32,
        h: f32,
    ) {
        let (stiffness, damping) = softness.of_mass(mass);
        let omega2 = stiffness / mass * h * h;
        let a = 0.5 * damping / mass * h;
        // Oscillations too fast for the substep, and springs without oscillation, use implicit Euler.
        let shown = omega2 > 0.0 && omega2 < FASTEST_SPRING;
        let implicit = (2.0 * a + omega2, 0.0);
        let (mut alpha, mut gamma) = if shown { exact_oscillator(omega2, a) } else { implicit };
        // If a share `r` of the mass moves, the update is stable as long as `4r + 2(α − γ) > (ωh)²`: a pin that carries a ragdoll by its
        // hand must not shake if only the hand moves. Implicit Euler is stable for any mass.
        if 4.0 * least + 2.0 * mass * (alpha - gamma) < SPRING_MARGIN * mass * omega2 {
            (alpha, gamma) = implicit;
        }
        self.gain += mass * alpha;
        self.carry += mass * gamma;
        self.push += h * stiffness * x - mass * (alpha + gamma) * rate;
    }

    pub(super) fn add_viscosity(&mut self, gain: f32, rate: f32) {
        self.gain += gain;
        self.push -= gain * rate;
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.gain += other.gain;
        self.carry += other.carry;
        self.push += other.push;
    }

    /// Work of the row while its rate changes from `before` to `after`, J.
    pub(super) fn work(&self, before: f32, after: f32) -> f32 {
        0.5 * self.impulse(before, after) * (before + after)
    }

    pub(in crate::solver) fn impulse(&self, before: f32, after: f32) -> f32 {
        -(self.gain * after + self.carry * before + self.push)
    }

    /// Compliance Γ of the row.
    pub fn compliance(&self) -> f32 {
        1.0 / self.gain
    }

    /// Rate of the row if it moves no mass.
    pub fn wanted(&self, before: f32) -> f32 {
        -(self.carry * before + self.push) / self.gain
    }
}

/// α and γ of [`SoftRow::add_spring`] from `(ωh)²` and `a = ζωh`. Differences of nearly equal numbers are avoided:
/// `1 + det − trace = (1 − e^−a)² + 4 e^−a sin²(½ω_d h)`, or `(1 − e^(s−a))(1 − e^(−s−a))` when overdamped.
fn exact_oscillator(omega2: f32, a: f32) -> (f32, f32) {
    let det = trig::exp(-2.0 * a);
    let distance = if omega2 > a * a {
        let sin = trig::sin(0.5 * (omega2 - a * a).sqrt());
        let fall = trig::exp_m1(-a);
        fall * fall + 4.0 * trig::exp(-a) * sin * sin
    } else {
        let s = (a * a - omega2).sqrt();
        // Computing a − s as ω²h²/(a + s) avoids cancellation.
        trig::exp_m1(-omega2 / (a + s)) * trig::exp_m1(-a - s)
    };
    let one_plus_alpha = omega2 / distance;
    (one_plus_alpha - 1.0, 1.0 - det * one_plus_alpha)
}
