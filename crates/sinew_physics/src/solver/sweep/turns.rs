//! Sweeps by turns, for heaps of ragdolls: each visits limits with the exact response of their trees, then all blocks of contacts with the
//! bodies' own masses, then solves the trees exactly with the impulses of both.
//!
//! Each of the three lowers the energy of the error (block Gauss-Seidel on the impulses of limits, contacts and joints), and conjugate steps
//! follow the sweeps. The exact response of contacts, which small islands use, costs more than it saves where hundreds of contacts couple
//! dozens of trees. Limits need it: with the response of their own two bodies alone, a chain of 70 links curled up by a wall gained five times
//! its energy.

use crate::runner::TaskRunner;
use crate::solver::IslandSolver;
use crate::solver::articulation::batches::{Batches, TurnVelocities};
use crate::solver::articulation::tree::{self, Link, NONE};
use crate::solver::body::SolverBody;
use crate::solver::pass::{Coupling, Pass};
use crate::solver::sweep::dirty::DirtyRows;
use crate::spatial::{Vec6, ZERO6, add_scaled, angular, difference, join, largest, linear};
use core::ops::Range;
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::{LaneMask, Lanes};
use sinew_math::max;

/// Impulse that causes a given velocity change of a free body.
fn impulse_of(body: &SolverBody, change: &Vec6) -> Vec6 {
    let r = body.pose.rotation;
    let inertia = (body.inertia + body.excess) * body.mass_scale;
    let spin = r * ((r.inverse() * angular(change)) * inertia);
    join(linear(change) * (body.mass * body.mass_scale), spin)
}

/// Solves the trees outside batches for the impulses of a sweep, from the velocities before it, and records how far they moved.
struct TurnOfTrees<'a> {
    links: &'a [Link],
    trees: &'a [Range<usize>],
    batches: &'a Batches,
    impulses: &'a mut [Vec6],
    dv: &'a mut [Vec6],
    /// Velocities before the sweep; velocities that replace them if loops were closed; velocities after the visits of the limits.
    before: &'a [Vec6],
    solved: &'a [Vec6],
    swept: &'a [Vec6],
    velocities: &'a mut [Vec6],
    dirty: &'a mut DirtyRows,
}

impl Kernel for TurnOfTrees<'_> {
    type Output = f32;

    #[inline(always)]
    fn run<L: Lanes>(self) -> f32 {
        let Self { links, trees, batches, impulses, dv, .. } = self;
        let Self { before, solved, swept, velocities, dirty, .. } = self;
        let mut most = L::splat(0.0);
        for (tree, range) in trees.iter().enumerate() {
            if batches.have(tree) {
                continue;
            }
            let mut is_pushed = !solved.is_empty();
            for impulse in &impulses[range.clone()] {
                is_pushed = is_pushed || !L::eq(L::load(impulse), L::splat(0.0)).all();
            }
            if !is_pushed {
                continue;
            }
            if solved.is_empty() {
                tree::solve_in::<L>(links, range.clone(), impulses, &[], dv);
            }
            let mut moved = L::splat(0.0);
            for i in range.clone() {
                let now = match solved.get(i) {
                    Some(solved) => L::load(solved),
                    None => L::load(&before[i]) + L::load(&dv[i]),
                };
                let change = (now - L::load(&velocities[i])).abs();
                most = L::max(most, change);
                moved = L::max(moved, (now - L::load(&swept[i])).abs());
                now.store(&mut velocities[i]);
            }
            dirty.mark(tree as u32, largest_of(moved));
        }
        largest_of(most)
    }
}

/// Largest lane of non-negative numbers.
#[inline(always)]
fn largest_of<L: Lanes>(numbers: L) -> f32 {
    let mut all = ZERO6;
    numbers.store(&mut all);
    largest(&all)
}

impl IslandSolver {
    /// Sweeps over limits, contacts and trees until a sweep changes little.
    pub(in crate::solver) fn sweep_by_turns(&mut self, pass: Pass, runner: &dyn TaskRunner) {
        if self.contacts.is_empty() && self.limits.is_empty() {
            return;
        }
        self.contacts.begin_pass(pass, &self.velocities, self.h, runner);
        self.arrange_limits(pass);
        self.dirty.start(self.policy.tolerance, self.trees.len(), 0, self.limit_blocks.len());
        let bounded = pass == Pass::Relax && self.is_passive();
        if bounded {
            self.scratch.relaxed_from.clear();
            self.scratch.relaxed_from.extend_from_slice(&self.velocities[..self.links.len()]);
        }
        self.run_turns(pass, 1, runner);
        if bounded {
            core::mem::swap(&mut self.scratch.before, &mut self.scratch.relaxed_from);
            self.keep_energy();
        }
    }

    /// Resumes `solve` after limits gained rows. Only trees that the new rows or position corrections change are visited by limits.
    pub(in crate::solver) fn resume_by_turns(&mut self, runner: &dyn TaskRunner) {
        if self.contacts.is_empty() && self.limits.is_empty() {
            return;
        }
        let known = self.limit_blocks.placed();
        self.arrange_limits(Pass::Solve);
        self.dirty.resume(self.limit_blocks.len(), &self.limits[known..]);
        self.contacts.start_conjugate();
        self.run_turns(Pass::Solve, 0, runner);
    }

    /// Runs sweeps until one after the first `least` changes little.
    fn run_turns(&mut self, pass: Pass, least: usize, runner: &dyn TaskRunner) {
        let sweeps = self.policy.of_turns(pass);
        let enough = self.enough_energy();
        let conjugate = pass != Pass::Restitution;
        for done in 1..=sweeps.most {
            self.note_limits();
            self.contacts.before_conjugate(&self.velocities, &self.scratch.limits);
            let rows = self.contacts.tally().manifolds as usize + self.limits.len();
            self.tally.sweep(pass, done, rows);
            self.take_turn_of_limits(pass);
            let swept = self.contacts.sweep_once((pass, sweeps, done), &mut self.velocities, runner);
            self.take_impulses_of_contacts();
            let change = max(self.largest_change, max(swept.largest, self.take_turn_of_trees()));
            let energy = swept.energy + self.change_energy;
            if done == sweeps.most || (done > least && (energy < enough || change < sweeps.tolerance)) {
                break;
            }
            if conjugate {
                self.step_conjugate(energy, runner);
            }
        }
    }

    /// Stores the impulses of limits before a sweep or a conjugate step.
    fn note_limits(&mut self) {
        self.scratch.limits.clear();
        self.scratch.limits.extend(self.limits.iter().map(|row| row.impulse));
    }

    /// Visits the limits and stores their impulses as the first ones of the sweep.
    fn take_turn_of_limits(&mut self, pass: Pass) {
        (self.largest_change, self.change_energy) = (0.0, 0.0);
        self.reset_impulses();
        self.visit_limits(pass);
        self.note_swept();
    }

    fn note_swept(&mut self) {
        self.scratch.swept.clear();
        self.scratch.swept.extend_from_slice(&self.velocities[..self.links.len()]);
    }

    /// Adds the impulses of contacts, computed from the velocity changes that they made with the bodies' own masses. For trees in batches
    /// [`Batches::take_turns`] does this.
    fn take_impulses_of_contacts(&mut self) {
        for range in &self.batches.alone {
            for i in range.clone() {
                let change = difference(&self.velocities[i], &self.scratch.swept[i]);
                if change != ZERO6 {
                    add_scaled(&mut self.impulses[i], &impulse_of(&self.bodies[i], &change), 1.0);
                }
            }
        }
    }

    /// Solves velocities exactly from those before the sweep and its impulses. Trees without impulses keep their velocities. Returns the
    /// largest change, without the changes by the contacts.
    fn take_turn_of_trees(&mut self) -> f32 {
        let Self { batches, contacts, impulses, scratch, velocities, dirty, .. } = self;
        let before = contacts.before_sweep();
        let mut velocities = TurnVelocities { before, limited: &scratch.swept, now: velocities };
        let change = batches.take_turns(impulses, &mut velocities, dirty);
        self.add_pushes();
        if self.batches.alone.is_empty() {
            return change;
        }
        let moving = self.links.len();
        core::mem::swap(&mut self.scratch.impulses, &mut self.impulses);
        let entangled = !self.loops.is_empty();
        if entangled {
            let s = &mut self.scratch;
            s.contacted.clear();
            s.contacted.extend_from_slice(&self.velocities[..moving]);
            self.velocities[..moving].copy_from_slice(&self.contacts.before_sweep()[..moving]);
            self.answer_impulses();
            self.velocities[..moving].swap_with_slice(&mut self.scratch.contacted);
        }
        let s = &mut self.scratch;
        s.dv.resize(moving, ZERO6);
        let of_others = dispatch::run(TurnOfTrees {
            links: &self.links,
            trees: &self.trees,
            batches: &self.batches,
            impulses: &mut s.impulses,
            dv: &mut s.dv,
            before: self.contacts.before_sweep(),
            solved: if entangled { &s.contacted } else { &[] },
            swept: &s.swept,
            velocities: &mut self.velocities[..moving],
            dirty: &mut self.dirty,
        });
        max(change, of_others)
    }

    /// Makes a conjugate step in the direction of the last sweeps.
    fn step_conjugate(&mut self, energy: f32, runner: &dyn TaskRunner) {
        self.note_limits();
        let Self { contacts, velocities, scratch, dirty, trees, limits, .. } = self;
        let mut tree = 0;
        let mut note_change = |body: usize, change: f32| {
            while trees.get(tree).is_some_and(|links| body >= links.end) {
                tree += 1;
            }
            if tree == trees.len() {
                return; // fixed
            }
            dirty.mark(tree as u32, change);
        };
        contacts.after_conjugate(energy, (velocities, &mut scratch.limits), runner, Some(&mut note_change));
        for (row, impulse) in limits.iter_mut().zip(&scratch.limits) {
            let change = row.apply(impulse - row.impulse);
            dirty.mark_limits(row.block, change);
        }
    }

    /// Applies the warm start of limits and contacts to the bodies as if they were free.
    pub(in crate::solver) fn warm_start_by_turns(&mut self, runner: &dyn TaskRunner) {
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
        self.contacts.warm_start(&mut self.velocities, runner);
        for (i, before) in self.scratch.swept.iter().enumerate() {
            let change = difference(&self.velocities[i], before);
            let mass = self.bodies[i].mass * self.bodies[i].mass_scale;
            self.contact_push[i] += linear(&self.impulses[i]) + linear(&change) * mass;
        }
    }

    /// True if a body is part of a tree with joints.
    pub(in crate::solver) fn is_jointed(&self, body: u32) -> bool {
        self.coupling != Coupling::Free
            && self.links.get(body as usize).is_some_and(|link| {
                let next = self.links.get(body as usize + 1);
                link.joint != NONE || next.is_some_and(|next| next.tree == link.tree)
            })
    }
}
