//! Sweeps over contact and limit rows in impulse space. During the sweeps only bodies with rows are updated, through
//! the articulated response. Afterwards the trees are solved once with all impulses, so that the joints are satisfied
//! exactly.

pub(in crate::solver) mod choice;
pub(in crate::solver) mod conjugate;
pub(in crate::solver) mod dirty;
pub(in crate::solver) mod policy;
mod turns;

use crate::runner::TaskRunner;
use crate::solver::IslandSolver;
use crate::solver::articulation::response_cache::Change;
use crate::solver::contact_rows::ManifoldRows;
use crate::solver::pass::{Corrected, Coupling, Pass};
use crate::solver::sweep::conjugate::{Conjugate, Rows};
use crate::solver::tuning::FRICTION_BOUND_UPDATES;
use crate::spatial::{ZERO6, add_scaled, largest, linear};
use sinew_math::max;

impl IslandSolver {
    /// Visits all rows and applies their impulses to the bodies.
    pub(in crate::solver) fn sweep(&mut self, pass: Pass, runner: &dyn TaskRunner) {
        match self.coupling {
            Coupling::Free => self.sweep_free(pass, runner),
            Coupling::Turns => self.sweep_by_turns(pass, runner),
            Coupling::Response => self.sweep_by_response(pass),
        }
    }

    /// Resumes the sweeps of `solve` after limits or contacts gained rows. Returns the trees that may have changed.
    pub(in crate::solver) fn sweep_again(&mut self, runner: &dyn TaskRunner) -> Corrected {
        if self.coupling == Coupling::Turns {
            self.resume_by_turns(runner);
            return Corrected::Changed;
        }
        self.sweep(Pass::Solve, runner);
        Corrected::All
    }

    /// Sweeps an island without joints, whose contacts are in lanes.
    fn sweep_free(&mut self, pass: Pass, runner: &dyn TaskRunner) {
        let sweeps = self.policy.of_blocks(pass);
        let done = self.contacts.sweep(pass, sweeps, &mut self.velocities, (self.h, runner));
        let rows = self.contacts.tally().manifolds as usize;
        (1..=done).for_each(|sweep| self.tally.sweep(pass, sweep, rows));
    }

    fn sweep_by_response(&mut self, pass: Pass) {
        if self.manifolds.is_empty() && self.limits.is_empty() {
            return;
        }
        self.reset_impulses();
        self.add_impulses(-1.0);
        self.arrange_limits(pass);
        let blocks = self.limit_blocks.len();
        self.dirty.start(self.policy.tolerance, self.trees.len(), self.manifolds.len(), blocks);
        let moving = self.links.len();
        self.scratch.before.clear();
        self.scratch.before.extend_from_slice(&self.velocities[..moving]);
        let sweeps = self.policy.sweeps(pass);
        let conjugates = pass != Pass::Restitution;
        let enough = self.enough_energy();
        self.conjugate.start();
        for done in 1..=sweeps {
            self.largest_change = 0.0;
            self.change_energy = 0.0;
            self.tally.sweep(pass, done, self.manifolds.len() + self.limits.len());
            if pass == Pass::Relax && done <= FRICTION_BOUND_UPDATES {
                self.manifolds.iter_mut().for_each(ManifoldRows::update_friction_bound);
            }
            if conjugates {
                let (conjugate, rows) = self.rows_to_conjugate();
                conjugate.before(&rows);
            }
            self.visit_contacts(pass);
            self.visit_limits(pass);
            let is_small = self.change_energy < enough || self.largest_change < self.policy.tolerance;
            if done == sweeps || (done > 1 && is_small) {
                break;
            }
            if conjugates {
                let energy = self.change_energy;
                let (conjugate, mut rows) = self.rows_to_conjugate();
                conjugate.after(&mut rows, energy);
            }
        }
        self.finish_sweep(pass);
    }

    /// Energy of the changes in a sweep below which no other sweep follows, J.
    pub(in crate::solver) fn enough_energy(&self) -> f32 {
        let enough = self.policy.enough;
        0.5 * enough * enough * self.mass() / self.links.len() as f32
    }

    fn rows_to_conjugate(&mut self) -> (&mut Conjugate, Rows<'_>) {
        let moving = self.links.len();
        let rows = Rows {
            manifolds: &mut self.manifolds,
            limits: &mut self.limits,
            velocities: &mut self.velocities[..moving],
            links: &self.links,
            dirty: &mut self.dirty,
        };
        (&mut self.conjugate, rows)
    }

    fn visit_contacts(&mut self, pass: Pass) {
        for i in 0..self.manifolds.len() {
            let now = self.dirty.of(&self.links, self.manifolds[i].a, self.manifolds[i].b);
            if !self.dirty.wakes_manifold(i, now) {
                continue;
            }
            let Self { bodies, links, batches, response, response_cache, .. } = self;
            let rows = &mut self.manifolds[i];
            let strip = match rows.columns {
                Some(strip) => strip,
                None if rows.is_idle(&self.velocities, pass, self.h) => continue,
                None => rows.respond(bodies, (links, batches), response, response_cache),
            };
            let bodies = [rows.a, rows.b];
            self.tally.visits += 1;
            if pass == Pass::Relax {
                let change = self.manifolds[i].visit_friction(strip, &self.velocities);
                self.push(bodies, &change);
                if let Some(change) = self.manifolds[i].visit_rolling(strip, &self.velocities) {
                    self.push(bodies, &change);
                }
            }
            let change = self.manifolds[i].visit_normal(strip, &self.velocities, pass, self.h);
            self.push(bodies, &change);
        }
    }

    /// Applies impulse changes of rows to two bodies and their trees.
    pub(in crate::solver) fn push(&mut self, bodies: [u32; 2], change: &Change) {
        if change.is_zero() {
            return;
        }
        let before = bodies.map(|body| self.velocities[body as usize]);
        self.response_cache.push(&self.response, &self.links, bodies, change, &mut self.velocities);
        for (end, body) in bodies.into_iter().enumerate() {
            let body = body as usize;
            let Some(link) = self.links.get(body) else { continue };
            let mut by = self.velocities[body];
            add_scaled(&mut by, &before[end], -1.0);
            for (x, p) in by.iter().zip(&change.push[end]) {
                self.change_energy += x * p;
            }
            let largest = largest(&by);
            self.dirty.mark(link.tree, largest);
            self.largest_change = max(self.largest_change, largest);
        }
    }

    pub(in crate::solver) fn reset_impulses(&mut self) {
        self.impulses.clear();
        self.impulses.resize(self.links.len(), ZERO6);
    }

    /// Adds the present impulses of all rows, times `sign`, to the impulses of the sweeps.
    pub(in crate::solver) fn add_impulses(&mut self, sign: f32) {
        for rows in &self.manifolds {
            rows.add_impulses(&mut self.impulses, sign);
        }
        for row in &self.limits {
            row.add_impulses(&self.joints, &mut self.impulses, sign);
        }
    }

    /// Solves the velocities of all bodies exactly with the impulses of the sweeps.
    fn finish_sweep(&mut self, pass: Pass) {
        self.add_impulses(1.0);
        self.answer_sweep();
        if pass == Pass::Relax && self.is_passive() {
            self.keep_energy();
        }
    }

    /// Computes velocities from those before the sweep and all impulses of the sweep.
    pub(in crate::solver) fn answer_sweep(&mut self) {
        self.add_pushes();
        let moving = self.links.len();
        self.velocities[..moving].copy_from_slice(&self.scratch.before);
        self.scratch.impulses.clear();
        self.scratch.impulses.extend_from_slice(&self.impulses);
        self.answer_impulses();
    }

    /// Adds the impulses of a sweep to those of the substep.
    pub(in crate::solver) fn add_pushes(&mut self) {
        for (push, p) in self.contact_push.iter_mut().zip(&self.impulses) {
            *push += linear(p);
        }
    }
}
