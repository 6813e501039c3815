//! Limits, contacts in lanes, and joint trees by turns, for heaps of figures: a sweep visits the limits with the exact response of their
//! trees, then all blocks of contacts with the bodies' own masses, then the trees are solved exactly with what both gave.
//!
//! Each of the three lessens the energy of the error (block Gauss-Seidel on impulses of limits, contacts and joints), and the sweeps
//! are conjugate steps. The exact response of contacts, too, which small islands sweep with, costs more than it saves where hundreds
//! of them couple dozens of trees. Limits must have it: those of a tree see each other, and with what their own two bodies answer
//! alone, a chain of 70 links that was curled up by a wall gained five times its energy.

use super::sweep::Pass;
use super::tree::NONE;
use super::{Coupling, IslandSolver, SolverBody};
use crate::spatial::{Vec6, ZERO6, add_scaled, angular, difference, join, largest, linear};
use sinew_math::max;

/// What gave a body this change of velocity, if nothing held it.
fn impulse_of(body: &SolverBody, change: &Vec6) -> Vec6 {
    let r = body.pose.rotation;
    let inertia = (body.inertia + body.excess) * body.ballast;
    let spin = r * ((r.inverse() * angular(change)) * inertia);
    join(linear(change) * (body.mass * body.ballast), spin)
}

impl IslandSolver {
    /// Sweeps over limits, blocks and trees.
    pub(super) fn sweep_by_turns(&mut self, pass: Pass) {
        let sweeps = self.effort.of_turns(pass);
        if self.contacts.is_empty() && self.limits.is_empty() {
            return;
        }
        self.contacts.begin_pass(pass, &self.velocities, self.h);
        let conjugate = pass != Pass::Restitution;
        for done in 1..=sweeps.most {
            if conjugate {
                self.note_limits();
                self.contacts.before_conjugate(&self.velocities, &self.scratch.limits);
            }
            let rows = self.contacts.tally().manifolds as usize + self.limits.len();
            self.tally.sweep(pass, done, rows);
            self.take_turn_of_limits(pass);
            let swept = self.contacts.sweep_once(pass, sweeps, done, &mut self.velocities);
            self.take_impulses_of_contacts();
            let change = max(self.largest_change, max(swept.largest, self.solve_trees_with_impulses()));
            if done == sweeps.most || (done > 1 && change < sweeps.tolerance) {
                break;
            }
            if conjugate {
                self.note_limits();
                let energy = swept.energy + self.change_energy;
                let impulses = &mut self.scratch.limits;
                self.contacts.after_conjugate(energy, &mut self.velocities, impulses);
                for (row, &impulse) in self.limits.iter_mut().zip(impulses.iter()) {
                    row.impulse = impulse;
                }
            }
        }
    }

    /// Impulses of limits, for conjugate steps.
    fn note_limits(&mut self) {
        self.scratch.limits.clear();
        self.scratch.limits.extend(self.limits.iter().map(|row| row.impulse));
    }

    /// Visits the limits, and begins the list of the sweep's impulses with theirs.
    fn take_turn_of_limits(&mut self, pass: Pass) {
        let moving = self.links.len();
        self.scratch.before.clear();
        self.scratch.before.extend_from_slice(&self.velocities[..moving]);
        self.unrest.start(self.effort.tolerance, self.tree_count, 0, self.limits.len());
        (self.largest_change, self.change_energy) = (0.0, 0.0);
        self.reset_impulses();
        self.add_given(-1.0);
        self.visit_limits(pass);
        self.add_given(1.0);
        if self.largest_change > 0.0 {
            for (i, before) in self.scratch.before.iter().enumerate() {
                self.contacts.stir(i, largest(&difference(&self.velocities[i], before)));
            }
        }
        self.note_swept();
    }

    fn note_swept(&mut self) {
        self.scratch.swept.clear();
        self.scratch.swept.extend_from_slice(&self.velocities[..self.links.len()]);
    }

    /// From the changes of velocities since they were noted, which the contacts made with the bodies' own masses.
    fn take_impulses_of_contacts(&mut self) {
        for (i, before) in self.scratch.swept.iter().enumerate() {
            let change = difference(&self.velocities[i], before);
            if change != ZERO6 {
                add_scaled(&mut self.impulses[i], &impulse_of(&self.bodies[i], &change), 1.0);
            }
        }
    }

    /// Velocities from those before the sweep and the impulses of it, exactly. Gives the largest change by what the sweep did not
    /// know of.
    fn solve_trees_with_impulses(&mut self) -> f32 {
        self.note_swept();
        self.answer_sweep();
        let mut most = 0.0;
        for (i, swept) in self.scratch.swept.iter().enumerate() {
            let change = largest(&difference(&self.velocities[i], swept));
            self.contacts.stir(i, change);
            most = max(most, change);
        }
        most
    }

    /// Puts the starting impulses of limits and contacts on the bodies, as if nothing held them.
    pub(super) fn warm_start_by_turns(&mut self) {
        self.reset_impulses();
        for row in &mut self.limits {
            row.warm_start(&self.joints, &mut self.impulses);
        }
        for (i, p) in self.impulses.iter().enumerate() {
            if *p != ZERO6 {
                let change = self.bodies[i].velocity_change(p);
                add_scaled(&mut self.velocities[i], &change, 1.0);
            }
        }
        self.note_swept();
        self.contacts.warm_start(&mut self.velocities);
        self.take_impulses_of_contacts();
        self.add_pushes();
    }

    /// Whether a link is part of a tree of joints.
    pub(super) fn is_jointed(&self, body: u32) -> bool {
        self.coupling != Coupling::Free
            && self.links.get(body as usize).is_some_and(|link| {
                let next = self.links.get(body as usize + 1);
                link.joint != NONE || next.is_some_and(|next| next.tree == link.tree)
            })
    }
}
