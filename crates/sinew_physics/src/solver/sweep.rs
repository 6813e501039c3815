//! Sweeps over contact, loop and limit rows in impulse space. While they run, only the bodies that carry rows are
//! kept up to date, through the articulated response; then the trees are solved once with all impulses, so that the
//! joints hold exactly.

use super::contact_rows::Push;
use super::{IslandSolver, SWEEP_TOLERANCE, SWEEPS_FREE, SWEEPS_FREE_RELAX, SWEEPS_JOINTED};
use crate::spatial::{ZERO6, add_scaled, linear};
use sinew_math::max;

/// What a pass over the rows is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pass {
    /// With bias, no friction.
    Solve,
    /// Without bias, with friction: friction that reacts to bias velocities pumps tall stacks.
    Relax,
    /// Bounce.
    Restitution,
}

impl IslandSolver {
    /// Visits all rows and gives the bodies their impulses.
    pub(super) fn sweep(&mut self, pass: Pass) {
        if self.manifolds.is_empty() && self.limits.is_empty() {
            return;
        }
        self.reset_impulses();
        let moving = self.links.len();
        self.scratch.before.clear();
        self.scratch.before.extend_from_slice(&self.velocities[..moving]);
        let sweeps = match (self.is_articulated(), pass) {
            (true, _) => SWEEPS_JOINTED,
            (_, Pass::Relax) => SWEEPS_FREE_RELAX,
            (..) => SWEEPS_FREE,
        };
        for done in 1..=sweeps {
            self.largest_change = 0.0;
            match pass {
                Pass::Solve | Pass::Relax => self.visit_contacts(pass),
                Pass::Restitution => self.visit_bounces(),
            }
            self.visit_limits(pass);
            if done > 1 && self.largest_change < SWEEP_TOLERANCE {
                break;
            }
        }
        self.finish_sweep(pass);
    }

    fn visit_contacts(&mut self, pass: Pass) {
        for i in 0..self.manifolds.len() {
            if pass == Pass::Relax {
                let push = self.manifolds[i].visit_friction(&self.velocities);
                self.push(self.manifolds[i].a, self.manifolds[i].b, &push);
            }
            let push = self.manifolds[i].visit_normal(&self.velocities, pass == Pass::Solve, self.h);
            self.push(self.manifolds[i].a, self.manifolds[i].b, &push);
        }
    }

    fn visit_bounces(&mut self) {
        for i in 0..self.manifolds.len() {
            for point in 0..self.manifolds[i].count() {
                if let Some(push) = self.manifolds[i].visit_bounce(point, &self.velocities) {
                    self.push(self.manifolds[i].a, self.manifolds[i].b, &push);
                }
            }
        }
    }

    /// Puts impulses on two bodies and their trees.
    pub(super) fn push(&mut self, a: u32, b: u32, push: &Push) {
        for (body, p) in [(a as usize, &push.0), (b as usize, &push.1)] {
            if body < self.links.len() {
                add_scaled(&mut self.impulses[body], p, 1.0);
                let before = self.velocities[body];
                self.response.apply(&self.links, body, p, &mut self.velocities);
                for (x, y) in self.velocities[body].iter().zip(&before) {
                    self.largest_change = max(self.largest_change, (x - y).abs());
                }
            }
        }
    }

    pub(super) fn reset_impulses(&mut self) {
        self.impulses.clear();
        self.impulses.resize(self.links.len(), ZERO6);
    }

    /// Velocities of all bodies from the impulses of the sweeps, exactly.
    fn finish_sweep(&mut self, pass: Pass) {
        for (push, p) in self.contact_push.iter_mut().zip(&self.impulses) {
            *push += linear(p);
        }
        if !self.is_articulated() {
            return; // every tree is one body, and the response was exact
        }
        let moving = self.links.len();
        self.velocities[..moving].copy_from_slice(&self.scratch.before);
        self.scratch.impulses.clear();
        self.scratch.impulses.extend_from_slice(&self.impulses);
        self.answer_impulses();
        if pass == Pass::Relax && self.is_passive() {
            self.keep_energy();
        }
    }
}
