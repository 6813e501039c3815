//! Conjugate steps between sweeps: the change of all impulses in a sweep serves as a gradient (nonsmooth nonlinear conjugate
//! gradients: Silcowitz, Niebe and Erleben 2010). A hand between the floor and the chest on top of it needs 12 sweeps
//! instead of 30 (ADR 0011).

use crate::solver::articulation::tree::Link;
use crate::solver::contact_rows::{ContactImpulses, ManifoldRows};
use crate::solver::limits::row::LimitRow;
use crate::solver::sweep::dirty::DirtyRows;
use crate::spatial::{Vec6, add_scaled, largest};

/// State of the conjugate steps of a pass. Values of an earlier pass are never used, since the first sweep of a pass has no previous energy.
#[derive(Clone, Debug, Default)]
pub(in crate::solver) struct Conjugate {
    /// State before the sweep, then the change in the sweep.
    was: State,
    /// Search direction.
    direction: State,
    /// Energy of the changes of the last sweep, J.
    energy: f32,
}

/// Impulses of all rows, and the velocities that result from them.
#[derive(Clone, Debug, Default)]
struct State {
    manifolds: Vec<ContactImpulses>,
    limits: Vec<f32>,
    velocities: Vec<Vec6>,
}

/// Rows and bodies of an island in a pass.
pub(in crate::solver) struct Rows<'a> {
    pub manifolds: &'a mut [ManifoldRows],
    pub limits: &'a mut [LimitRow],
    pub velocities: &'a mut [Vec6],
    pub links: &'a [Link],
    pub dirty: &'a mut DirtyRows,
}

impl Conjugate {
    /// Reserves memory for `bodies` bodies and `manifolds` manifolds, also if this island has none: the next island may
    /// use it.
    pub fn make_room(&mut self, bodies: usize, manifolds: usize) {
        for state in [&mut self.was, &mut self.direction] {
            state.manifolds.clear();
            state.manifolds.reserve(manifolds);
            state.velocities.clear();
            state.velocities.reserve(bodies);
        }
    }

    /// Starts a pass, before the first sweep.
    pub fn start(&mut self) {
        self.energy = 0.0;
    }

    /// Stores the state before a sweep.
    pub fn before(&mut self, rows: &Rows<'_>) {
        self.was.manifolds.clear();
        self.was.manifolds.extend(rows.manifolds.iter().map(ManifoldRows::impulses));
        self.was.limits.clear();
        self.was.limits.extend(rows.limits.iter().map(|row| row.impulse));
        self.was.velocities.clear();
        self.was.velocities.extend_from_slice(rows.velocities);
    }

    /// Moves along the search direction after a sweep whose changes had this energy. The next sweep corrects rows that
    /// moved too far.
    pub fn after(&mut self, rows: &mut Rows<'_>, energy: f32) {
        // Rounding may make the energy negative if joints resist everything that the rows push.
        let share = if energy > 0.0 && energy < self.energy { energy / self.energy } else { 0.0 };
        self.energy = energy;
        if share == 0.0 {
            core::mem::swap(&mut self.direction, &mut self.was);
            self.direction.set_difference(rows);
            return;
        }
        self.was.set_difference(rows);
        self.direction.go_on(rows, &self.was, share);
    }
}

impl State {
    /// Replaces this earlier state by the change from it to the present state.
    fn set_difference(&mut self, rows: &Rows<'_>) {
        for (was, row) in self.manifolds.iter_mut().zip(rows.manifolds.iter()) {
            *was = row.impulses().plus(was, -1.0);
        }
        for (was, row) in self.limits.iter_mut().zip(rows.limits.iter()) {
            *was = row.impulse - *was;
        }
        for (was, now) in self.velocities.iter_mut().zip(rows.velocities.iter()) {
            for (was, now) in was.iter_mut().zip(now) {
                *was = now - *was;
            }
        }
    }

    /// Adds `share` of this direction to the rows. The new direction is that share plus `change`.
    fn go_on(&mut self, rows: &mut Rows<'_>, change: &Self, share: f32) {
        for (i, row) in rows.manifolds.iter_mut().enumerate() {
            let d = &mut self.manifolds[i];
            rows.dirty.mark_manifold(i, row.apply(d, share));
            *d = change.manifolds[i].plus(d, share);
        }
        for (i, row) in rows.limits.iter_mut().enumerate() {
            let d = &mut self.limits[i];
            rows.dirty.mark_limits(row.block, row.apply(*d * share));
            *d = change.limits[i] + *d * share;
        }
        for (i, link) in rows.links.iter().enumerate() {
            let by = self.velocities[i].map(|d| d * share);
            add_scaled(&mut rows.velocities[i], &by, 1.0);
            rows.dirty.mark(link.tree, largest(&by));
            self.velocities[i] = change.velocities[i];
            add_scaled(&mut self.velocities[i], &by, 1.0);
        }
    }
}
