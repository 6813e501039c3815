//! A joint of an island: where it is, its rows, and what they have given.

use crate::joint::{
    DIRECTIONS, JointDrive, JointGeometry, JointPose, JointRows, LimitImpulse, MAX_LIMITS, Saturation,
};
use crate::solver::articulation::soft_row::SoftRow;
use crate::spatial::Vec6;
use sinew_math::Vec3;

/// A joint of the island.
#[derive(Clone, Debug)]
pub(crate) struct SolverJoint {
    /// World index.
    pub index: u32,
    /// Local bodies.
    pub a: u32,
    pub b: u32,
    pub geometry: JointGeometry,
    pub drive: JointDrive,
    pub pose: JointPose,
    pub rows: JointRows,
    /// Rows that hold exactly.
    pub(super) rigid: usize,
    /// Position errors that the rigid rows may leave in this substep, row by row, m or rad.
    pub(super) left_open: Vec6,
    /// Rows that it may have.
    pub(super) most_rows: usize,
    /// The others, row by row.
    pub(super) soft: [SoftRow; DIRECTIONS],
    /// Part of the motor in the soft rows, row by row.
    pub(super) driven: [SoftRow; DIRECTIONS],
    /// Motion of a weld that gives beyond that along its rows in this substep, m or rad, and before the last correction.
    pub(super) bent: Vec6,
    pub(super) bent_before: Vec6,
    /// Masses that springs and motors move, direction by direction, kg or kg·m².
    pub mass: Vec6,
    /// Least masses that motors move, whatever else gives way: those of the joint's two bodies. Without a motor the same as `mass`.
    pub(super) least_mass: Vec6,
    /// Rates of driven directions when the substep began.
    pub(super) start_rate: Vec6,
    pub saturated: Saturation,
    /// Sign of the push of a pin's motor that contacts and stops have brought beyond its cap in this substep.
    pub(super) exceeded: Saturation,
    pub limits: [LimitImpulse; MAX_LIMITS],
    /// Least slack of its hard rotational stops that are in reach, and what it was a substep before, radians.
    pub(super) least_slack: f32,
    pub(super) slack_before: f32,
    /// Impulses of the limits in the substep so far, world axes.
    pub(super) limit_impulse: [Vec3; MAX_LIMITS],
    pub force: Vec3,
    /// Impulses of this substep if it closes a loop, row by row.
    pub(super) impulse: Vec6,
    /// Impulses of the last substep if it closes a loop, direction by direction.
    pub warm_impulse: Vec6,
    /// Impulses of the substeps so far on B, torque about its anchor.
    pub reaction: Vec6,
    /// As much of them as has been counted as work of a body that moves by itself.
    pub(super) accounted: Vec6,
}
