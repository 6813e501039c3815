//! One step, in order. `docs/step.md` has a heading for each stage.

use crate::field::Fields;
use crate::object::lockstep;
use crate::runner::TaskRunner;
use crate::solver::{Pace, View};
use crate::stage::{Profiler, Stage, zone};
use crate::tasks::{Phase, Task, Workspace};
use crate::world::World;
use crate::{finalize, mover, sensors, sleep, touch};

/// Everything that lives for one step.
pub(crate) struct StepContext<'a> {
    /// Step and substep, seconds.
    pub dt: f32,
    pub h: f32,
    pub substeps: u32,
    /// When it begins, seconds.
    pub time: f64,
    pub runner: &'a dyn TaskRunner,
    pub profiler: &'a dyn Profiler,
}

/// Advances the world by one step.
pub(crate) fn step(world: &mut World, context: &StepContext<'_>) {
    let stage = |stage: Stage, work: &mut dyn FnMut()| zone(context.profiler, stage, work);
    let World { def, bodies, joints, contacts, groups, objects, .. } = world;
    let World { events, broad, parts, activity, islands, parted, sleepers, meetings, .. } = world;
    let fields = Fields::new(&world.fields, &world.functions, def, world.steps).among(groups);

    stage(Stage::Pairs, &mut || {
        activity.wake_struck(bodies, groups, &broad.proxies, def);
        broad.update(bodies, parted.filter(joints), meetings, contacts, activity, context.dt);
    });
    stage(Stage::Collide, &mut || touch::collide(bodies, broad, contacts, parts, context));
    stage(Stage::Touch, &mut || touch::touch(bodies, joints, contacts, activity, &fields, meetings, events));
    let (proxies, modifiers, pace) = (&broad.proxies, &meetings.modifiers, Pace::new(context, objects));
    let view = View { bodies, activity, proxies, joints, contacts, modifiers, def, fields, pace };
    stage(Stage::Islands, &mut || islands.find(&view, groups));
    stage(Stage::Color, &mut || islands.color());
    if objects.is_empty() {
        stage(Stage::Flight, &mut || islands.fly(&view, context));
        islands.run(context.runner, |task| task.solve(&view, context));
    } else {
        lockstep(objects, islands, &view, context);
        objects.rouse(bodies, activity);
    }
    stage(Stage::Store, &mut || finalize::store(islands, joints, parted, contacts, groups, events, context));
    stage(Stage::Finalize, &mut || finalize::finalize(islands, bodies, activity, events, context));
    let filter = parted.filter(joints);
    stage(Stage::Continuous, &mut || finalize::continuous(islands, bodies, activity, broad, filter, context));
    stage(Stage::Sleep, &mut || sleep::sleep(islands, bodies, activity, &fields, sleepers, def));
    stage(Stage::Sensors, &mut || sensors::sensors(bodies, contacts, meetings, def.hit_speed, events));
    stage(Stage::Movers, &mut || mover::movers(world));
}

/// A part of an island's step, which goes on where the part before ended.
pub(crate) fn solve(phase: Phase, task: &mut Task<'_>, view: &View<'_>, context: &StepContext<'_>) {
    let stage = |stage: Stage, work: &mut dyn FnMut()| zone(context.profiler, stage, work);
    let Task { island, groups, solution, workspace: Workspace { solver, surroundings }, .. } = task;
    match phase {
        Phase::Prepare => stage(Stage::Prepare, &mut || {
            solver.prepare(island, view);
            surroundings.make_room(island);
        }),
        Phase::Move(substep) => {
            stage(Stage::IntegrateVelocity, &mut || solver.integrate_velocity(view, groups));
            stage(Stage::WarmStart, &mut || solver.warm_start());
            stage(Stage::Solve, &mut || solver.solve());
            stage(Stage::IntegratePosition, &mut || solver.integrate_position(view));
            stage(Stage::Project, &mut || surroundings.project(groups, solver, view, substep));
        }
        Phase::Relax(_) => {
            stage(Stage::Relax, &mut || solver.relax(view));
            stage(Stage::Restitution, &mut || solver.restitution());
            solver.drop_fields(view);
        }
        Phase::Store => stage(Stage::Store, &mut || solver.store(solution, context.profiler)),
    }
}
