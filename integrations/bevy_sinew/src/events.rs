//! Steps and their events, as messages and to observers.

use crate::{BevyTasks, Physics, StepThreads};
use bevy_app::App;
use bevy_ecs::prelude::*;
use bevy_math::Vec3;
use sinew_physics::BodyId;
use sinew_physics::stage::NoProfiler;

/// Two bodies began to touch.
#[derive(Event, Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct TouchBegan {
    /// One of the two bodies.
    pub a: Entity,
    /// The other body.
    pub b: Entity,
}

/// Two bodies stopped touching; one of them may be removed.
#[derive(Event, Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct TouchEnded {
    /// One of the two bodies.
    pub a: Entity,
    /// The other body.
    pub b: Entity,
}

/// A body entered a sensor of another body.
#[derive(Event, Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct SensorEntered {
    /// One of the two bodies.
    pub a: Entity,
    /// The other body.
    pub b: Entity,
}

/// A body left a sensor of another body; one of them may be removed.
#[derive(Event, Message, Clone, Copy, Debug, PartialEq, Eq)]
pub struct SensorLeft {
    /// One of the two bodies.
    pub a: Entity,
    /// The other body.
    pub b: Entity,
}

/// Two bodies hit each other fast ([`WorldDef::hit_speed`](crate::WorldDef::hit_speed)).
#[derive(Event, Message, Clone, Copy, Debug, PartialEq)]
pub struct HitTold {
    /// One of the two bodies.
    pub a: Entity,
    /// The other body.
    pub b: Entity,
    /// Point of the hit, world, metres.
    pub point: Vec3,
    /// Normal from A to B, unit length, world axes.
    pub normal: Vec3,
    /// Speed along the normal, m/s.
    pub approach: f32,
    /// Total impulse, N·s.
    pub impulse: f32,
}

pub(crate) fn add_messages(app: &mut App) {
    app.add_message::<TouchBegan>().add_message::<TouchEnded>();
    app.add_message::<SensorEntered>().add_message::<SensorLeft>().add_message::<HitTold>();
}

pub(crate) fn step(mut physics: ResMut<Physics>, threads: Res<StepThreads>) {
    match *threads {
        StepThreads::Bevy => physics.step_with(&BevyTasks, &NoProfiler),
        StepThreads::One => physics.step(),
    }
}

pub(crate) fn tell(mut physics: ResMut<Physics>, mut commands: Commands) {
    // Contacts between limbs of one character are not reported.
    let told = |(a, b): (BodyId, BodyId)| {
        let pair = (physics.entity(a)?, physics.entity(b)?);
        (pair.0 != pair.1).then_some(pair)
    };
    let events = physics.events();
    for (a, b) in events.begin.iter().copied().filter_map(told) {
        both(&mut commands, TouchBegan { a, b });
    }
    for (a, b) in events.end.iter().copied().filter_map(told) {
        both(&mut commands, TouchEnded { a, b });
    }
    for (a, b) in events.sensor_begin.iter().copied().filter_map(told) {
        both(&mut commands, SensorEntered { a, b });
    }
    for (a, b) in events.sensor_end.iter().copied().filter_map(told) {
        both(&mut commands, SensorLeft { a, b });
    }
    for hit in &events.hits {
        let Some((a, b)) = told((hit.a.body, hit.b.body)) else { continue };
        let (point, normal, approach, impulse) = (hit.point, hit.normal, hit.approach, hit.impulse);
        both(&mut commands, HitTold { a, b, point, normal, approach, impulse });
    }
    for body in core::mem::take(&mut physics.gone) {
        physics.entities.remove(&body);
        physics.limbs.remove(&body);
    }
}

/// Sends an event as a message and to observers.
pub(crate) fn both<E>(commands: &mut Commands, event: E)
where
    E: Message + Clone + for<'a> Event<Trigger<'a>: Default>,
{
    commands.write_message(event.clone());
    commands.trigger(event);
}
