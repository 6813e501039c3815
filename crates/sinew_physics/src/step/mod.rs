//! Order of the stages of one step. `docs/step.md` has a heading for each stage.

mod blows;
pub(crate) mod collide;
pub(crate) mod continuous;
pub(crate) mod finalize;
pub(crate) mod islands;
pub(crate) mod pairs;
pub(crate) mod phase;
pub(crate) mod pinched;
pub(crate) mod project;
pub(crate) mod sensors;
pub(crate) mod sleep;
pub(crate) mod store;
pub(crate) mod tasks;
pub(crate) mod touch;
mod tuning;

use crate::context::StepContext;
use crate::field::Fields;
use crate::mover;
use crate::solver::{Pace, View};
use crate::stage::{Stage, zone};
use crate::step::pinched::Around;
use crate::step::tuning::FASTEST_KINEMATIC;
use crate::user_object::lockstep;
use crate::world::World;

/// Advances the world by one step.
pub(crate) fn step(world: &mut World, context: &StepContext<'_>) {
    let stage = |stage: Stage, work: &mut dyn FnMut()| zone(context.profiler, stage, work);
    let World { def, bodies, joints, contacts, groups, objects, .. } = world;
    let World { events, broad, parts, pinches, activity, islands, parted, sleepers, meetings, .. } = world;
    let fields = Fields::new(&world.fields, &world.functions, def, world.steps).among(groups);

    stage(Stage::Pairs, &mut || {
        activity.bound_kinematic(bodies, FASTEST_KINEMATIC);
        activity.wake_struck(bodies, groups, &broad.proxies, def);
        activity.wake_groups(bodies, groups, &broad.proxies, objects.let_sleep(), def);
        broad.blows.find(bodies, joints, activity);
        broad.update(bodies, parted.filter(joints), meetings, contacts, activity, context.dt);
    });
    stage(Stage::Collide, &mut || {
        collide::collide((bodies, parted.filter(joints)), broad, contacts, parts, context);
    });
    meetings.hits.start(contacts.len(), def.hit_speed);
    stage(Stage::Touch, &mut || {
        touch::touch(bodies, joints, groups, contacts, activity, &fields, meetings, events);
        let filter = parted.filter(joints);
        let around = Around { bodies, proxies: &broad.proxies, activity, filter, step: fields.step };
        pinches.find(&around, groups, contacts, &mut meetings.modifiers, context);
    });
    let (proxies, modifiers, pace) =
        (&broad.proxies, &meetings.modifiers, Pace::new(context, objects.grading()));
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
    stage(Stage::Store, &mut || {
        store::store(islands, joints, parted, contacts, groups, events, context);
        pinches.store(groups, contacts);
    });
    stage(Stage::Finalize, &mut || finalize::finalize(islands, bodies, activity, events, def, context));
    let filter = parted.filter(joints);
    stage(Stage::Continuous, &mut || {
        continuous::continuous(islands, bodies, activity, broad, filter, context);
    });
    stage(Stage::Sleep, &mut || {
        let may = objects.let_sleep();
        sleep::sleep(islands, (bodies, groups), (activity, sleepers), &fields, may, def);
    });
    stage(Stage::Sensors, &mut || sensors::sensors(bodies, contacts, meetings, events));
    stage(Stage::Movers, &mut || mover::movers(world));
}
