//! A joint of an island: its bodies and anchors, its rows, and their impulses.

use crate::joint::{
    DIRECTIONS, JointDrive, JointGeometry, JointPose, JointRows, LimitImpulse, MAX_LIMITS, Saturation,
};
use crate::solver::articulation::soft_row::SoftRow;
use crate::spatial::Vec6;
use sinew_math::Vec3;

/// A joint of the island.
#[derive(Clone, Debug)]
pub(crate) struct SolverJoint {
    /// Index in the world.
    pub index: u32,
    /// Local indices of the bodies.
    pub a: u32,
    pub b: u32,
    pub geometry: JointGeometry,
    pub drive: JointDrive,
    pub pose: JointPose,
    pub rows: JointRows,
    /// Number of rigid rows.
    pub(super) rigid: usize,
    /// Position errors that the rigid rows may leave in this substep, row by row, m or rad.
    pub(super) left_open: Vec6,
    /// Largest number of rows that the joint may have.
    pub(super) most_rows: usize,
    /// Softness of the rows that are not rigid, row by row.
    pub(super) soft: [SoftRow; DIRECTIONS],
    /// Contribution of the motor to the soft rows, row by row.
    pub(super) driven: [SoftRow; DIRECTIONS],
    /// Motion of a soft weld in this substep beyond that along its rows, m or rad, and its value before the last correction.
    pub(super) bent: Vec6,
    pub(super) bent_before: Vec6,
    /// Effective masses of springs and motors, direction by direction, kg or kg·m².
    pub mass: Vec6,
    /// Smallest effective masses of motors, if everything except the joint's two bodies yields. Without a motor the
    /// same as `mass`.
    pub(super) least_mass: Vec6,
    /// Rates of driven directions at the start of the substep.
    pub(super) start_rate: Vec6,
    pub saturated: Saturation,
    /// Sign of a pin motor's impulse in the directions in which contacts and stops pushed it beyond its cap in this substep.
    pub(super) exceeded: Saturation,
    pub limits: [LimitImpulse; MAX_LIMITS],
    /// Smallest slack of the joint's hard rotational stops in reach, and that of the last substep, radians.
    pub(super) least_slack: f32,
    pub(super) slack_before: f32,
    /// Impulses of the limits in the substep so far, world axes.
    pub(super) limit_impulse: [Vec3; MAX_LIMITS],
    pub force: Vec3,
    /// Impulses of a loop joint in this substep, row by row.
    pub(super) impulse: Vec6,
    /// Impulses of a loop joint in the last substep, direction by direction.
    pub warm_impulse: Vec6,
    /// Impulses on B in the substeps so far, torque about B's anchor.
    pub reaction: Vec6,
    /// Part of the reaction already counted as work of a kinematic body.
    pub(super) accounted: Vec6,
}
