//! One step, in order. `docs/step.md` has a heading for each stage.

use crate::runner::TaskRunner;
use crate::solver::View;
use crate::stage::{Profiler, Stage, zone};
use crate::tasks::{Task, Workspace};
use crate::world::World;
use crate::{finalize, sensors, sleep, touch};

/// Everything that lives for one step.
pub(crate) struct StepContext<'a> {
    /// Step and substep, seconds.
    pub dt: f32,
    pub h: f32,
    pub substeps: u32,
    pub runner: &'a dyn TaskRunner,
    pub profiler: &'a dyn Profiler,
}

/// Advances the world by one step.
pub(crate) fn step(world: &mut World, context: &StepContext<'_>) {
    let stage = |stage: Stage, work: &mut dyn FnMut()| zone(context.profiler, stage, work);
    let World { def, bodies, joints, contacts, groups, events, broad, islands, parted, sleepers, .. } = world;

    stage(Stage::Pairs, &mut || broad.update(bodies, parted.of(joints), contacts, context.dt));
    stage(Stage::Collide, &mut || touch::collide(bodies, contacts, context));
    stage(Stage::Touch, &mut || touch::touch(bodies, joints, contacts, events));
    stage(Stage::Islands, &mut || islands.find(bodies, joints, contacts, groups, context.dt));
    stage(Stage::Color, &mut || islands.color(bodies, contacts));

    let view = View { bodies, joints, contacts, def, h: context.h };
    islands.run(context.runner, |task| substeps(task, &view, context));

    stage(Stage::Store, &mut || {
        finalize::store(islands, joints, contacts, groups, context.dt);
        finalize::break_joints(joints, parted, events);
    });
    stage(Stage::Finalize, &mut || finalize::finalize(&islands.solution().bodies, bodies, events, context));
    stage(Stage::Continuous, &mut || finalize::continuous(bodies, islands));
    stage(Stage::Sleep, &mut || sleep::sleep(islands, bodies, sleepers, def.sleeping, context.dt));
    stage(Stage::Sensors, &mut || sensors::sensors(bodies, contacts, events));
}

/// All substeps of one island, as one task without barriers.
fn substeps(task: &mut Task<'_>, view: &View<'_>, context: &StepContext<'_>) {
    let stage = |stage: Stage, work: &mut dyn FnMut()| zone(context.profiler, stage, work);
    let Task { island, groups, solution, workspace: Workspace { solver, surroundings } } = task;
    stage(Stage::Prepare, &mut || {
        solver.prepare(island, view);
        surroundings.make_room(island);
    });
    for substep in 0..context.substeps {
        stage(Stage::IntegrateVelocity, &mut || solver.integrate_velocity());
        stage(Stage::WarmStart, &mut || solver.warm_start());
        stage(Stage::Solve, &mut || solver.solve());
        stage(Stage::IntegratePosition, &mut || solver.integrate_position());
        stage(Stage::Project, &mut || surroundings.project(groups, solver, view, substep));
        stage(Stage::Relax, &mut || solver.relax());
        stage(Stage::Restitution, &mut || solver.restitution());
    }
    stage(Stage::Store, &mut || solver.store(solution));
}
