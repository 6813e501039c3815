//! Visits of a manifold's rows in a sweep.

use super::row::NEVER;
use super::row::Row;
use super::{AXES, ManifoldRows};
use super::{disk, lcp};
use crate::body::material::ContactMaterial;
use crate::collide::MAX_POINTS;
use crate::solver::articulation::response_cache::{CachedColumns, Change};
use crate::solver::pass::Pass;
use crate::solver::tuning::{DEAD_ZONE, SLIP_SPEED};
use crate::spatial::{Vec6, angular};
use sinew_math::{Vec3, clamp, max, min};

/// Complementarity problem of a manifold's normal rows: `K (x − old) + rate + soft x ≥ 0`, complementary to `x ≥ 0`.
#[derive(Clone, Copy, Debug, Default)]
struct NormalProblem {
    /// Rate of the gap plus the bias, m/s; negative if the gap closes too fast.
    rate: [f32; MAX_POINTS],
    /// Impulses so far, N·s.
    old: [f32; MAX_POINTS],
    /// Softness, m/s per N·s.
    soft: [f32; MAX_POINTS],
}

impl ManifoldRows {
    /// Stores the present normal impulses as the load that limits friction.
    pub fn update_friction_bound(&mut self) {
        self.load = self.impulse[..self.count].iter().fold(0.0, |sum, p| sum + max(*p, 0.0));
    }

    /// Builds the problem of the normal rows at the present velocities.
    fn normal_problem(&self, velocities: &[Vec6], pass: Pass, h: f32) -> NormalProblem {
        let (pair, biased) = (self.pair(), pass == Pass::Solve);
        let mut mean = 0.0;
        for row in &self.k[..self.count] {
            for k in &row[..self.count] {
                mean += k;
            }
        }
        // The block's softness is computed at the manifold's centre; computed at each point, a 1 kg foot under 69 kg sinks by 7 mm.
        let at_center = self.firmness.softness * self.soft.impulse_scale / self.soft.mass_scale * mean
            / self.count as f32;
        let mut problem = NormalProblem::default();
        for i in 0..self.count {
            let s = self.separation[i];
            let bias = self.bias(i, pass, h);
            let soft = if biased && s <= 0.0 { at_center } else { 0.0 };
            problem.soft[i] = soft;
            problem.old[i] = self.impulse[i] - self.floor[i];
            let lasting = self.memory.points[i].lasting;
            problem.rate[i] = self.rows[i].rate(pair, velocities) + bias - soft * lasting;
        }
        problem
    }

    /// Velocity bias of a point, m/s: the point may approach at up to this rate.
    fn bias(&self, i: usize, pass: Pass, h: f32) -> f32 {
        let (s, biased) = (self.separation[i], pass == Pass::Solve);
        if pass == Pass::Restitution && self.rebound[i] > 0.0 {
            -self.rebound[i]
        } else if s > 0.0 && self.comes_to_bounce(i) && !biased {
            NEVER
        } else if s > 0.0 {
            s / h
        } else if biased {
            let apart = self.firmness.bias * self.soft.bias_rate * min(s + DEAD_ZONE * self.slop, 0.0);
            let push = max(apart, -self.firmness.push_speed);
            min(push, -self.material.launch)
        } else {
            -self.material.launch
        }
    }

    /// True if all impulses of the manifold are zero and stay zero at these velocities.
    pub fn is_idle(&self, velocities: &[Vec6], pass: Pass, h: f32) -> bool {
        let rate = |i: usize| self.rows[i].rate(self.pair(), velocities) + self.bias(i, pass, h);
        let is_apart = |i: usize| self.separation[i] > 0.0 && self.impulse[i] == 0.0;
        self.friction == Vec3::ZERO
            && self.twist == 0.0
            && self.rolling == Vec3::ZERO
            && (0..self.count).all(|i| is_apart(i) && rate(i) >= 0.0)
    }

    /// Visits the normal rows once, as a block.
    pub fn visit_normal(&mut self, strip: CachedColumns, velocities: &[Vec6], pass: Pass, h: f32) -> Change {
        let NormalProblem { rate, old, soft } = self.normal_problem(velocities, pass, h);
        let new = lcp::solve(&self.k, &rate, &old, &soft, self.count);
        let mut change = Change::from_column(strip.column(0));
        for i in 0..self.count {
            change.add(self.rows[i].ends(), new[i] - old[i]);
            self.impulse[i] = new[i] + self.floor[i];
        }
        change
    }

    /// Visits friction once, limited by the last stored load: a 2×2 row limited to the circle, then twist about the normal. A slip beyond
    /// static friction becomes sliding.
    pub fn visit_friction(&mut self, strip: CachedColumns, velocities: &[Vec6]) -> Change {
        let pair = self.pair();
        let mut change = Change::from_column(strip.column(self.count));
        let k = &self.k_tangent;
        let old = self.tangent_axes.map(|axis| self.friction.dot(axis));
        let slip = |i: usize| {
            self.tangents[i].rate(pair, velocities) + self.material.velocity.dot(self.tangent_axes[i])
        };
        let rates = [slip(0), slip(1)];
        let b = [0, 1].map(|i| k[i][0] * old[0] + k[i][1] * old[1] - rates[i]);
        let ContactMaterial { friction, static_friction, .. } = self.material;
        let mut new = disk::least_energy(k, b, static_friction * self.load);
        let mut grip = static_friction;
        let slip = [0, 1].map(|i| k[i][0] * new[0] + k[i][1] * new[1] - b[i]);
        if static_friction > friction && slip[0] * slip[0] + slip[1] * slip[1] > SLIP_SPEED * SLIP_SPEED {
            new = disk::least_energy(k, b, friction * self.load);
            grip = friction;
        }
        for i in 0..2 {
            change.add(self.tangents[i].ends(), new[i] - old[i]);
        }
        self.friction = self.tangent_axes[0] * new[0] + self.tangent_axes[1] * new[1];
        if self.k_spin > 1e-12 {
            // Visits the twist after the tangents: a light hand turns far about a contact beside its centre, and a joint solve of both
            // overshoots more in each sweep.
            let [k0, k1] = self.k_spin_tangent;
            let rate = self.spin.rate(pair, velocities)
                + self.material.spin.dot(self.normal)
                + k0 * (new[0] - old[0])
                + k1 * (new[1] - old[1]);
            let wanted = self.twist - rate / self.k_spin;
            let most = grip * self.lever * self.load;
            let slip = max(wanted.abs() - most, 0.0) * self.k_spin * self.lever;
            let most = if slip > SLIP_SPEED { friction * self.lever * self.load } else { most };
            let new = clamp(wanted, -most, most);
            change.add(self.spin.ends(), new - self.twist);
            self.twist = new;
        }
        change
    }

    /// Visits the rolling resistance once: a torque against the relative rotation, at most `rolling × load`.
    pub fn visit_rolling(&mut self, strip: CachedColumns, velocities: &[Vec6]) -> Option<Change> {
        if self.material.rolling <= 0.0 {
            return None;
        }
        let w = angular(&velocities[self.b as usize]) - angular(&velocities[self.a as usize]);
        let new = disk::step_in_ball(&self.k_roll, self.rolling, w, self.material.rolling * self.load);
        let mut change = Change::from_column(strip.column(self.count + 3));
        for (axis, by) in AXES.into_iter().zip((new - self.rolling).to_array()) {
            change.add(Row::about(axis).ends(), by);
        }
        self.rolling = new;
        Some(change)
    }
}
