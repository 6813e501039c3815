//! Approach and rebound of a manifold's points: their approach speeds and the speeds at which they leave.

use super::ManifoldRows;
use crate::collide::MAX_POINTS;
use crate::solver::tuning::BOUNCE_SPEED;
use crate::spatial::Vec6;
use sinew_math::max;

/// Motion of a point along its normal, in a substep.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Approach {
    /// Normal rate at the substep's beginning, m/s; negative if the point approaches.
    pub rate: f32,
    /// Gap at the substep's beginning, metres; 0 if the surfaces overlap.
    pub gap: f32,
    /// Speed toward the surface added by forces and joints in the substep before contacts, m/s; not negative.
    pub pull: f32,
}

impl Approach {
    /// Speed at the surface, m/s. A velocity of symplectic Euler is that of half a substep ago, and forces continue to
    /// accelerate the point between its present position and the surface.
    fn speed_at_surface(&self, h: f32) -> f32 {
        let now = self.rate - 0.5 * self.pull;
        if now < 0.0 { (now * now + 2.0 * (self.pull / h) * self.gap).sqrt() } else { 0.0 }
    }
}

impl ManifoldRows {
    /// Records the approach of the points at the start of the substep.
    pub fn begin_approach(&mut self, velocities: &[Vec6]) {
        for i in 0..self.bouncy_count() {
            let rate = self.rows[i].rate(self.pair(), velocities);
            self.approach[i] = Approach { rate, gap: max(self.separation[i], 0.0), pull: 0.0 };
        }
    }

    /// Records the speed toward the surface added by forces and joints.
    pub fn pull_approach(&mut self, velocities: &[Vec6]) {
        for i in 0..self.bouncy_count() {
            let rate = self.rows[i].rate(self.pair(), velocities);
            self.approach[i].pull = max(self.approach[i].rate - rate, 0.0);
        }
    }

    /// Marks points that approached fast and were hit: they bounce as high as their speed at the surface allows.
    pub fn end_approach(&mut self, h: f32) {
        self.rebound = [0.0; MAX_POINTS];
        for i in 0..self.bouncy_count() {
            let speed = self.approach[i].speed_at_surface(h);
            if self.impulse[i] > 0.0 && speed > BOUNCE_SPEED {
                self.rebound[i] = self.material.restitution * speed + 0.5 * self.approach[i].pull;
            }
        }
    }

    /// Returns true if the point will bounce but has not touched yet: `relax` must not brake its approach.
    pub(super) fn comes_to_bounce(&self, i: usize) -> bool {
        self.material.restitution > 0.0 && self.impulse[i] == 0.0
    }

    /// Number of points that may bounce.
    fn bouncy_count(&self) -> usize {
        if self.material.restitution > 0.0 { self.count } else { 0 }
    }

    /// True if a point bounces in this substep.
    pub fn bounces(&self) -> bool {
        (0..self.bouncy_count()).any(|i| self.rebound[i] > 0.0)
    }

    /// Adds the impulses of this substep's bounce to the totals of the points.
    pub fn add_bounce(&mut self) {
        for i in 0..self.count {
            let point = &mut self.memory.points[i];
            point.total += max(self.impulse[i], 0.0) - point.now;
        }
    }
}
