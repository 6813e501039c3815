//! A step with objects: all islands run substep by substep, so that objects get a consistent world between the parts.

use super::{Corrections, Forces, Objects, Substep};
use crate::activity::Activity;
use crate::arena::Arena;
use crate::body::Body;
use crate::context::StepContext;
use crate::id::{BodyId, GroupId};
use crate::solver::View;
use crate::spatial::{Vec6, angular, linear};
use crate::stage::{Stage, zone};
use crate::step::islands::Islands;
use crate::step::phase::{Phase, solve};

/// Map from body and group slots to islands during a step.
#[derive(Clone, Debug, Default)]
pub(super) struct Places {
    /// Island and local index of each moving body.
    bodies: Vec<Option<(u32, u32)>>,
    /// Position of each group among the groups taken out of the world.
    groups: Vec<u32>,
}

impl Places {
    fn find(&mut self, islands: &mut Islands, bodies: &Arena<Body>) {
        let (workspaces, taken) = islands.halted();
        self.bodies.clear();
        self.bodies.resize(bodies.slot_count(), None);
        for (island, workspace) in workspaces.iter().enumerate() {
            for (local, body) in workspace.solver.moving_bodies().iter().enumerate() {
                self.bodies[body.index as usize] = Some((island as u32, local as u32));
            }
        }
        let slots = taken.iter().map(|group| group.index as usize + 1).max().unwrap_or(0);
        self.groups.clear();
        self.groups.resize(slots, u32::MAX);
        for (place, group) in taken.iter().enumerate() {
            self.groups[group.index as usize] = place as u32;
        }
    }

    /// Island and local index of a moving body.
    pub fn body(&self, id: BodyId) -> Option<(usize, usize)> {
        self.bodies[id.index as usize].map(|(island, local)| (island as usize, local as usize))
    }

    /// Position of a group among the taken groups.
    pub fn group(&self, id: GroupId) -> Option<usize> {
        self.groups.get(id.index as usize).map(|&place| place as usize)
    }
}

/// A sleeping body that was pushed. It wakes after the step, with its change of velocity.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roused {
    /// Index of the body in the world.
    pub index: u32,
    /// Change of velocity, m/s and rad/s.
    pub change: Vec6,
}

/// Solves all islands phase by phase. Objects act before the two phases of each substep. Strands that no object
/// touched are solved again as strands, so an object that does nothing changes no bit of the result.
pub(crate) fn lockstep(
    objects: &mut Objects,
    islands: &mut Islands,
    view: &View<'_>,
    context: &StepContext<'_>,
) {
    for phase in Phase::of_step(context.substeps) {
        match phase {
            Phase::Prepare | Phase::Store => {}
            Phase::Move(done) => zone(context.profiler, Stage::IntegrateVelocity, || {
                objects.add_forces(islands, view, context, done);
            }),
            Phase::Relax(done) => zone(context.profiler, Stage::Project, || {
                objects.satisfy_constraints(islands, view, context, done + 1);
            }),
        }
        islands.run_part(context.runner, |task| solve(phase, task, view, context));
        if phase == Phase::Prepare {
            objects.places.find(islands, view.bodies);
        }
    }
    zone(context.profiler, Stage::Flight, || islands.fly_undisturbed(view, context));
}

impl Objects {
    fn add_forces(&mut self, islands: &mut Islands, view: &View<'_>, context: &StepContext<'_>, moved: u32) {
        for workspace in islands.halted().0 {
            workspace.solver.renew_forces(view);
        }
        let Self { arena, places, roused, .. } = self;
        let mut forces = Forces(Substep::new(islands, view, places, roused, context, moved));
        for (_, object) in arena.iter_mut() {
            object.add_forces(&mut forces);
        }
    }

    fn satisfy_constraints(
        &mut self,
        islands: &mut Islands,
        view: &View<'_>,
        context: &StepContext<'_>,
        moved: u32,
    ) {
        let Self { arena, places, roused, .. } = self;
        let mut corrections = Corrections(Substep::new(islands, view, places, roused, context, moved));
        for (_, object) in arena.iter_mut() {
            object.satisfy_constraints(&mut corrections);
        }
    }

    /// Wakes the bodies that objects pushed while they slept, after the substeps.
    pub fn rouse(&mut self, bodies: &mut Arena<Body>, activity: &mut Activity) {
        for Roused { index, change } in self.roused.drain(..) {
            activity.wake(bodies, index);
            let body = bodies.at_mut(index);
            body.velocity.linear += linear(&change);
            body.velocity.angular += angular(&change);
        }
    }
}
