//! Accelerates the sweeps of tall piles and unequal masses: the change of all impulses in a sweep is a descent step, and these steps are
//! made conjugate (nonsmooth nonlinear conjugate gradients: Silcowitz, Niebe and Erleben 2010).

use super::Contacts;
use super::block::{Block, Eight};
use crate::runner::TaskRunner;
use crate::slices::split_off;
use crate::slices::{MOST_NEAR, for_each_near};
use crate::solver::contacts::block::Impulses;
use crate::solver::contacts::visit::Step;
use crate::spatial::{Vec6, ZERO6, largest};
use sinew_math::dispatch::{self, Kernel};
use sinew_math::lanes::Lanes;

/// State of the conjugate steps of a pass. Lists left over from an earlier pass are never used: the first sweep of a pass has no previous
/// energy to extrapolate with.
#[derive(Clone, Debug, Default)]
pub(super) struct Conjugate {
    /// Velocities and limit impulses before the sweep.
    was: State,
    /// Search direction.
    direction: State,
    /// Energy of the changes of the last sweep, J.
    energy: f32,
    /// Step of the blocks, applied when the next sweep visits them.
    pub step: Step,
}

/// Velocities of all bodies, and impulses of limits; the impulses of blocks are kept in the blocks.
#[derive(Clone, Debug, Default)]
struct State {
    velocities: Vec<Vec6>,
    limits: Vec<f32>,
}

/// Moves one impulse of each of eight manifolds along the search direction.
#[inline(always)]
fn go_on<L: Lanes>(impulse: &mut Eight, was: &mut Eight, direction: &mut Eight, share: f32) {
    let now = L::load(impulse);
    let change = now - L::load(was);
    if share == 0.0 {
        change.store(direction);
        now.store(was);
        return;
    }
    let by = L::load(direction) * L::splat(share);
    (change + by).store(direction);
    let now = now + by;
    now.store(impulse);
    now.store(was);
}

impl<const N: usize, const T: usize> Block<N, T> {
    /// Applies a conjugate step to the block, before a visit.
    #[inline(always)]
    pub fn step<L: Lanes>(&mut self, step: Step) {
        let share = match step {
            Step::None => return,
            Step::Begin => {
                let Self { impulse, friction, twist, .. } = self;
                self.was = Impulses { normal: *impulse, friction: *friction, twist: *twist };
                return;
            }
            Step::GoOn(share) => share,
        };
        let Self { was, direction, .. } = self;
        for i in 0..N {
            go_on::<L>(&mut self.impulse[i], &mut was.normal[i], &mut direction.normal[i], share);
        }
        for k in 0..2 {
            go_on::<L>(&mut self.friction[k], &mut was.friction[k], &mut direction.friction[k], share);
        }
        go_on::<L>(&mut self.twist, &mut was.twist, &mut direction.twist, share);
    }
}

/// Moves bodies by a share of the search direction; the new direction is that share plus the change in the sweep.
struct GoOnBodies<'a> {
    velocities: &'a mut [Vec6],
    /// Velocities before the sweep.
    was: &'a [Vec6],
    direction: &'a mut [Vec6],
    share: f32,
    /// Largest component by which each body moves, m/s or rad/s; empty if not needed.
    changes: &'a mut [f32],
}

/// Smallest number of bodies for one thread.
const BODIES: usize = 256;

impl<'a> GoOnBodies<'a> {
    /// Runs on several threads if there are many bodies.
    fn run_on(self, runner: &dyn TaskRunner) {
        let count = usize::min(self.velocities.len() / BODIES, MOST_NEAR);
        if count < 2 {
            return dispatch::run(self);
        }
        let mut parts = [const { None }; MOST_NEAR];
        let mut rest = self;
        for (number, part) in parts[..count].iter_mut().enumerate() {
            *part = Some(rest.take(rest.velocities.len() / (count - number)));
        }
        for_each_near(runner, &mut parts[..count], |part| {
            if let Some(part) = part.take() {
                dispatch::run(part);
            }
        });
    }

    /// Takes `count` bodies from the front.
    fn take(&mut self, count: usize) -> Self {
        let (was, rest) = self.was.split_at(count);
        self.was = rest;
        let velocities = split_off(&mut self.velocities, count);
        let direction = split_off(&mut self.direction, count);
        let asked = usize::min(count, self.changes.len());
        Self { velocities, was, direction, share: self.share, changes: split_off(&mut self.changes, asked) }
    }
}

impl Kernel for GoOnBodies<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { velocities, was, direction, share, changes } = self;
        if share == 0.0 {
            for (i, v) in velocities.iter().enumerate() {
                (L::load(v) - L::load(&was[i])).store(&mut direction[i]);
            }
            return;
        }
        let share = L::splat(share);
        for (i, v) in velocities.iter_mut().enumerate() {
            let now = L::load(v);
            let change = now - L::load(&was[i]);
            let by = L::load(&direction[i]) * share;
            (now + by).store(v);
            (change + by).store(&mut direction[i]);
            if let Some(most) = changes.get_mut(i) {
                let mut sizes = ZERO6;
                by.abs().store(&mut sizes);
                *most = largest(&sizes);
            }
        }
    }
}

impl Contacts {
    /// Reserves memory for `bodies` bodies.
    pub(super) fn make_room_for_conjugate(&mut self, bodies: usize) {
        for state in [&mut self.conjugate.was, &mut self.conjugate.direction] {
            state.limits.clear();
            state.velocities.clear();
            state.velocities.reserve(bodies);
        }
        self.changes.reserve(bodies.saturating_sub(self.changes.len()));
    }

    /// Starts the conjugate steps, before the first sweep of a pass.
    pub(in crate::solver) fn start_conjugate(&mut self) {
        self.conjugate.energy = 0.0;
        self.conjugate.step = Step::None;
    }

    /// Stores the state before a sweep. `limits` are the impulses of other rows that take part.
    pub(in crate::solver) fn before_conjugate(&mut self, velocities: &[Vec6], limits: &[f32]) {
        let Conjugate { was, step, .. } = &mut self.conjugate;
        was.velocities.clear();
        was.velocities.extend_from_slice(velocities);
        was.limits.clear();
        was.limits.extend_from_slice(limits);
        if *step == Step::None {
            *step = Step::Begin;
        }
    }

    /// Velocities before the sweep.
    pub(in crate::solver) fn before_sweep(&self) -> &[Vec6] {
        &self.conjugate.was.velocities
    }

    /// Moves along the search direction after a sweep whose changes had this energy; blocks move when the next sweep visits them. The next
    /// sweep corrects rows that moved too far. `moved`, if given, is called for the bodies, in order, with the change of each.
    pub(in crate::solver) fn after_conjugate(
        &mut self,
        energy: f32,
        (velocities, limits): (&mut [Vec6], &mut [f32]),
        runner: &dyn TaskRunner,
        moved: Option<&mut dyn FnMut(usize, f32)>,
    ) {
        let Conjugate { was, direction, energy: last, step } = &mut self.conjugate;
        let share = if energy > 0.0 && energy < *last { energy / *last } else { 0.0 };
        (*last, *step) = (energy, Step::GoOn(share));
        direction.velocities.resize(velocities.len(), ZERO6);
        direction.limits.resize(limits.len(), 0.0);
        let mut changes = core::mem::take(&mut self.changes);
        changes.resize(if moved.is_some() { velocities.len() } else { 0 }, 0.0);
        let bodies = GoOnBodies {
            velocities,
            was: &was.velocities,
            direction: &mut direction.velocities,
            share,
            changes: &mut changes,
        };
        bodies.run_on(runner);
        for (i, limit) in limits.iter_mut().enumerate() {
            let change = *limit - was.limits[i];
            if share == 0.0 {
                direction.limits[i] = change;
                continue;
            }
            let by = direction.limits[i] * share;
            *limit += by;
            direction.limits[i] = change + by;
        }
        if let Some(moved) = moved.filter(|_| share != 0.0) {
            changes.iter().enumerate().for_each(|(i, &change)| moved(i, change));
        }
        self.changes = changes;
    }
}
