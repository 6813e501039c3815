//! Data that a character keeps from step to step, one for each thing that it does.

use super::grasp::Grasp;
use sinew_anim::{LocalTransform, TrackId};
use sinew_math::{Transform, Vec3};
use sinew_physics::{BodyId, JointId, Velocity};

/// A character on its way up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Rising {
    /// By this track.
    ByClip(TrackId),
    /// By the looped clip alone, for so many seconds more.
    Without(f32),
}

/// Time for which a limp character has been still, in steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Stillness {
    /// Steps since it went limp.
    pub steps: u32,
    /// Steps for which every body has been slow.
    pub calm_steps: u32,
    pub settled: bool,
    pub touched: bool,
    /// Nobody was on it when it last wanted to get up.
    pub free: bool,
}

/// A limp character on its way out of a wall or the floor.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Clearing {
    /// Way that is left after the next step, world, metres.
    pub way: Vec3,
    /// Velocities of its bodies at the end of the way; empty while it is on no such way.
    pub velocities: Vec<Velocity>,
}

/// A body on its way to where a clip begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Preparation {
    /// Index of the way to get up, and of its moment.
    pub get_up: u32,
    pub start: u32,
    /// That are left.
    pub seconds: f32,
}

/// Pose and place that were shown at the end of the step before.
#[derive(Clone, Debug, Default)]
pub(super) struct Shown {
    pub pose: Vec<LocalTransform>,
    pub world_from_character: Transform,
}

/// A body that is held, and by what.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hold {
    pub held: BodyId,
    pub joint: JointId,
    /// Index of the body that holds it.
    pub body: u32,
    pub drops: bool,
    /// A grip that pulls, and lets go; `None`: a fixed joint holds.
    pub grasp: Option<Grasp>,
}

/// Smoothed ground under each foot, over the floor of the clip, and its rates of change, per second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Planting {
    /// Metres.
    pub heights: [f32; 2],
    pub rates: [f32; 2],
    /// From heel to ball: up over along.
    pub slopes: [f32; 2],
    pub slope_rates: [f32; 2],
}

impl Planting {
    pub fn is_over(&self) -> bool {
        *self == Self::default()
    }
}
