//! Phases of a step: the stages that an island executes independently.

use crate::context::StepContext;
use crate::solver::View;
use crate::stage::{Stage, zone};
use crate::step::tasks::{Task, Workspace};

/// A part of a step that an island executes independently. With objects, which act between two parts, all islands
/// execute the same part at the same time; otherwise a task executes all parts without barriers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    Prepare,
    /// The first part of the substep with this number, until all bodies and particles have moved.
    Move(u32),
    /// Remaining stages of the substep.
    Relax(u32),
    Store,
}

impl Phase {
    /// Phases of a step, in order.
    pub fn of_step(substeps: u32) -> impl Iterator<Item = Self> {
        core::iter::once(Self::Prepare)
            .chain(Self::of_substeps(substeps))
            .chain(core::iter::once(Self::Store))
    }

    /// Phases of `substeps` substeps of an island, between [`Prepare`](Self::Prepare) and [`Store`](Self::Store).
    pub fn of_substeps(substeps: u32) -> impl Iterator<Item = Self> {
        (0..substeps).flat_map(|substep| [Self::Move(substep), Self::Relax(substep)])
    }
}

/// Executes a part of an island's step; continues where the previous part ended.
pub(crate) fn solve(phase: Phase, task: &mut Task<'_>, view: &View<'_>, context: &StepContext<'_>) {
    let stage = |stage: Stage, work: &mut dyn FnMut()| zone(context.profiler, stage, work);
    let Task { island, groups, solution, workspace: Workspace { solver, surroundings }, .. } = task;
    match phase {
        Phase::Prepare => stage(Stage::Prepare, &mut || {
            solver.prepare(island, view, context.runner);
            surroundings.make_room(island);
        }),
        Phase::Move(substep) => {
            stage(Stage::IntegrateVelocity, &mut || solver.integrate_velocity(view, groups));
            stage(Stage::WarmStart, &mut || solver.warm_start(context.runner));
            stage(Stage::Solve, &mut || solver.solve(context.runner));
            stage(Stage::IntegratePosition, &mut || solver.integrate_position(view, context.runner));
            stage(Stage::Project, &mut || surroundings.project(groups, solver, view, substep));
        }
        Phase::Relax(_) => {
            stage(Stage::Relax, &mut || solver.relax(view, context.runner));
            stage(Stage::Restitution, &mut || solver.restitution(context.runner));
            surroundings.find_added(groups, solver);
            solver.drop_fields(view);
        }
        Phase::Store => stage(Stage::Store, &mut || solver.store(solution, context.profiler)),
    }
}
