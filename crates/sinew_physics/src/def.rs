//! Definitions: plain data that the world's objects are made from.

use crate::id::BodyId;
use crate::shape::{MassProperties, ShapeDef};
use sinew_math::{Range, Rotation, SwingTwistLimit, Transform, Vec3};

/// Settings of a world.
#[derive(Clone, Debug, PartialEq)]
pub struct WorldDef {
    /// m/s². Default (0, −9.81, 0).
    pub gravity: Vec3,
    /// Length of one step, integer nanoseconds, so that time does not drift. Default 1/60 s (16 666 667 ns).
    pub step_nanoseconds: u64,
    /// Substeps per step, at least 1. Default 4.
    pub substeps: u32,
    /// Bodies may fall asleep. Default yes.
    pub sleeping: Sleeping,
}

/// Whether islands at rest are put to sleep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sleeping {
    /// They are.
    On,
    /// They go on being simulated.
    Off,
}

impl Default for WorldDef {
    fn default() -> Self {
        Self {
            gravity: Vec3::new(0.0, -9.81, 0.0),
            step_nanoseconds: 16_666_667,
            substeps: 4,
            sleeping: Sleeping::On,
        }
    }
}

impl WorldDef {
    /// Step length, seconds.
    pub fn dt(&self) -> f32 {
        self.step_nanoseconds as f32 * 1e-9
    }
}

/// How a body moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodyKind {
    /// Never.
    Static,
    /// As its velocity says; nothing pushes it.
    Kinematic,
    /// By forces.
    Dynamic,
}

/// A body to be made.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyDef {
    /// How it moves. Default dynamic.
    pub kind: BodyKind,
    /// World position of the body's origin (not its centre of mass), metres.
    pub position: Vec3,
    /// World orientation.
    pub rotation: Rotation,
    /// Of the centre of mass, m/s.
    pub linear_velocity: Vec3,
    /// rad/s, world axes.
    pub angular_velocity: Vec3,
    /// 1/s: share of linear velocity lost per second. Default 0.
    pub linear_damping: f32,
    /// 1/s. Default 0.
    pub angular_damping: f32,
    /// Factor on the world's gravity. Default 1.
    pub gravity_scale: f32,
    /// Shapes; may be empty if `mass` is given.
    pub shapes: Vec<ShapeDef>,
    /// Mass, centre and inertia in the body's frame; `None`: from the shapes' densities.
    pub mass: Option<MassProperties>,
    /// For the user.
    pub user_data: u64,
}

impl Default for BodyDef {
    fn default() -> Self {
        Self {
            kind: BodyKind::Dynamic,
            position: Vec3::ZERO,
            rotation: Rotation::IDENTITY,
            linear_velocity: Vec3::ZERO,
            angular_velocity: Vec3::ZERO,
            linear_damping: 0.0,
            angular_damping: 0.0,
            gravity_scale: 1.0,
            shapes: Vec::new(),
            mass: None,
            user_data: 0,
        }
    }
}

/// What a joint leaves free. The joint's frames are `JointDef::frame_a` and `frame_b`; zero angle is where they agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointKind {
    /// Three rotations, within limits.
    Ball {
        /// `None`: unlimited.
        limit: Option<SwingTwistLimit>,
    },
    /// One rotation, about the frames' x axis.
    Hinge {
        /// Radians, inside −π..=π; `None`: unlimited.
        limit: Option<Range>,
    },
    /// Two rotations: swing about y and z, no twist about x.
    Universal {
        /// Swing half-angles; its twist range is ignored. `None`: unlimited.
        limit: Option<SwingTwistLimit>,
    },
    /// None.
    Fixed,
}

/// Whether the two bodies of a joint collide with each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointCollision {
    /// They do.
    Enabled,
    /// They do not.
    Disabled,
}

/// A joint to be made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointDef {
    /// First body (the parent, where there is one).
    pub body_a: BodyId,
    /// Second body.
    pub body_b: BodyId,
    /// Joint frame in A's frame: anchor and axes.
    pub frame_a: Transform,
    /// Joint frame in B's frame.
    pub frame_b: Transform,
    /// What is free.
    pub kind: JointKind,
    /// Torque that resists the free rotations, N·m. Default 0.
    pub friction_torque: f32,
    /// Default disabled.
    pub collision: JointCollision,
}

impl JointDef {
    /// A joint whose frames agree in the bodies' present pose: `world_from_joint` is seen from both bodies.
    pub fn new(
        body_a: BodyId,
        body_b: BodyId,
        world_from_a: Transform,
        world_from_b: Transform,
        world_from_joint: Transform,
        kind: JointKind,
    ) -> Self {
        Self {
            body_a,
            body_b,
            frame_a: world_from_a.inverse() * world_from_joint,
            frame_b: world_from_b.inverse() * world_from_joint,
            kind,
            friction_torque: 0.0,
            collision: JointCollision::Disabled,
        }
    }
}
