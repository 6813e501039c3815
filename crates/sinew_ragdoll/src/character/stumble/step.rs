//! Position of a step: the body as an inverted pendulum.
//!
//! With `ω² = g / h` the centre of mass `x` moves away from the point of support `p`, `x″ = ω² (x − p)`. It comes to
//! rest over `p` if `p` is the **capture point** `ξ = x + x′ / ω`, which itself moves away: `ξ(t) = p + (ξ − p) exp(ω
//! t)`. A foot that lands on `ξ` stops the body. A foot that lands `u T / (exp(ω T) − 1)` before `ξ` keeps the speed
//! `u` with steps of the time `T`.

use super::support::level;
use crate::character::tuning::{BRAKES, FEET_APART, FOOT_SPEED, STEP_OUT, STEP_REACH, STRIDE_TIME};
use sinew_math::{Rotation, Vec3, clamp, max, min, trig};

/// Allowed durations of a step, seconds, the longest first.
pub(super) const STEP_TIMES: [f32; 4] = [0.3, 0.26, 0.22, 0.18];

/// The body as an inverted pendulum in the horizontal plane; its height enters only through `ω`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pendulum {
    /// Centre of mass, world, metres.
    pub center: Vec3,
    /// Velocity of the centre of mass over the ground, m/s.
    pub velocity: Vec3,
    pub wish: Vec3,
    /// Rate `ω` of the pendulum, 1/s.
    pub omega: f32,
    pub heading: Rotation,
    /// Height of the whole body, metres.
    pub height: f32,
}

/// A position at which a foot can land.
#[derive(Clone, Copy, Debug)]
pub(super) struct Print {
    /// Centre of the sole, with the sole horizontal.
    pub at: Vec3,
    /// Distance from `at` to the ideal position, metres.
    pub miss: f32,
    /// Distance by which the body would then be beyond the reach of the other foot, metres.
    pub strain: f32,
}

impl Pendulum {
    /// Returns the capture point for the requested velocity: supported there, the body approaches this velocity.
    pub fn capture(&self) -> Vec3 {
        level(self.center) + (self.velocity - self.wish) / self.omega
    }

    /// Returns a point of support beyond the capture point, at which the body reaches the requested velocity in finite
    /// time.
    pub fn brake(&self) -> Vec3 {
        level(self.center) + (self.velocity - self.wish) * (BRAKES / self.omega)
    }

    /// Returns the change of the body's velocity within `seconds`, a short time, while it is supported at `on`.
    pub fn pushed(&self, on: Vec3, seconds: f32) -> Vec3 {
        (level(self.center) - on) * (self.omega * self.omega * seconds)
    }

    /// Returns the offset from the landing position that keeps the requested velocity to the capture point.
    pub fn goes_on(&self) -> Vec3 {
        self.wish * (STRIDE_TIME / (trig::exp(self.omega * STRIDE_TIME) - 1.0))
    }

    /// Returns the landing position of a foot (0 left, 1 right) that lands in `seconds`. The centre of its sole is at
    /// `from` now, the body is supported at `on` until then, and the other foot is at `stance`.
    pub fn print(&self, foot: usize, from: Vec3, stance: Vec3, on: Vec3, seconds: f32) -> Print {
        let (grown, shrunk) = (trig::exp(self.omega * seconds), trig::exp(-self.omega * seconds));
        let (cosh, sinh) = (0.5 * (grown + shrunk), 0.5 * (grown - shrunk));
        let away = level(self.center) - on;
        let center = on + away * cosh + self.velocity * (sinh / self.omega);
        let capture = on + (away + self.velocity / self.omega) * grown;
        let side = if foot == 0 { 1.0 } else { -1.0 };
        let across = self.heading * (Vec3::X * side);
        let wanted = capture - self.goes_on() + across * (STEP_OUT * self.height);
        let mut at = wanted;
        // Keep the foot on its own side of the other foot.
        let apart = (at - stance).dot(across);
        at += across * max(FEET_APART * self.height - apart, 0.0);
        let reach = at - center;
        let far = reach.length();
        at = center + reach * min(STEP_REACH * self.height / max(far, 1e-6), 1.0);
        let way = at - level(from);
        let far = way.length();
        at = level(from) + way * min(FOOT_SPEED * self.height * seconds / max(far, 1e-6), 1.0);
        let apart = (at - stance).dot(across);
        at += across * clamp(FEET_APART * self.height - apart, 0.0, FEET_APART * self.height);
        let strain = max((center - level(stance)).length() - STEP_REACH * self.height, 0.0);
        Print { at, miss: (at - wanted).length(), strain }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pushed(velocity: Vec3, wish: Vec3) -> Pendulum {
        let heading = Rotation::IDENTITY;
        Pendulum { center: Vec3::Y, velocity, wish, omega: 3.1, heading, height: 1.75 }
    }

    /// Returns the velocities at the time when a foot lands on its print and after the body has stood on it for as long
    /// as the foot swung, and the landing error `miss`.
    fn after_a_step(mut body: Pendulum, foot: usize, stance: Vec3) -> ([Vec3; 2], f32) {
        let steps = 2800;
        let dt = STRIDE_TIME / steps as f32;
        let print = body.print(foot, body.center, stance, stance, STRIDE_TIME);
        assert!(print.miss < 0.06, "{print:?}");
        let velocities = [stance, print.at].map(|on| {
            for _ in 0..steps {
                body.velocity += body.pushed(on, dt);
                body.center += body.velocity * dt;
            }
            body.velocity
        });
        (velocities, print.miss)
    }

    /// On the capture point a pendulum's velocity decays as `exp(-ω t)`; an error `e` of the print adds `e ω sinh(ω
    /// t)`.
    #[test]
    fn step_onto_the_print_slows_the_body_like_a_pendulum() {
        let body = pushed(Vec3::new(0.1, 0.0, 0.9), Vec3::ZERO);
        let ([down, after], miss) = after_a_step(body, 0, Vec3::new(-0.05, 0.0, 0.02));
        let shrunk = trig::exp(-body.omega * STRIDE_TIME);
        let left = down.z * shrunk + body.omega * miss * 0.5 * (1.0 / shrunk - shrunk);
        assert!(after.z > 0.0 && after.z < left + 0.01, "{after}, {left}");
        assert!(after.z < 0.6 * body.velocity.z, "{after}");
    }

    #[test]
    fn step_keeps_the_requested_velocity() {
        let (wish, stance) = (Vec3::Z * 1.0, Vec3::new(-0.08, 0.0, 0.1));
        let body = Pendulum { center: Vec3::new(0.0, 1.0, 0.0), ..pushed(Vec3::Z * 1.0, wish) };
        let ([_, after], _) = after_a_step(body, 0, stance);
        assert!((after.z - 1.0).abs() < 0.35, "{after}");
    }

    #[test]
    fn foot_that_would_cross_the_other_lands_beside_it() {
        let stance = Vec3::new(-0.1, 0.0, 0.0);
        let body = pushed(Vec3::X * -1.0, Vec3::ZERO);
        let print = body.print(0, -stance, stance, stance, STRIDE_TIME);
        assert!(print.at.x >= stance.x + FEET_APART * 1.75 - 1e-4 && print.miss > 0.2, "{print:?}");
    }
}
