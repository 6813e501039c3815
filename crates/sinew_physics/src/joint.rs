//! A joint as the world keeps it, and its constraint rows.

use crate::def::{JointCollision, JointDef, JointKind};
use crate::spatial::{Vec6, ZERO6, join};
use sinew_math::limits::{LimitState, hinge_angle, wrap};
use sinew_math::{Range, Rotation, SwingTwistLimit, Transform, Vec3, max};

/// At most this many limit rows has a joint: swing, twist below, twist above.
pub(crate) const MAX_LIMITS: usize = 3;

/// Impulse of a limit in the last substep and the one before, N·m·s, in frame A: as a vector, because the axis of a cone
/// turns, and an impulse about the old axis must not be handed on about the new one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct LimitImpulse {
    pub now: Vec3,
    pub before: Vec3,
}

#[derive(Clone, Debug)]
pub(crate) struct Joint {
    /// Body indices.
    pub a: u32,
    pub b: u32,
    /// Joint frame in the principal frames of the bodies.
    pub frame_a: Transform,
    pub frame_b: Transform,
    pub kind: JointKind,
    pub friction_torque: f32,
    pub collision: JointCollision,
    pub limits: [LimitImpulse; MAX_LIMITS],
    /// Impulses of the last substep if the joint closes a loop, row by row.
    pub loop_impulse: Vec6,
    /// Linear force of the last substep on body B, N, world axes: geometric stiffness needs it.
    pub force: Vec3,
}

impl Joint {
    pub fn new(
        def: &JointDef,
        a: u32,
        b: u32,
        principal_from_a: Transform,
        principal_from_b: Transform,
    ) -> Self {
        assert!(def.frame_a.is_finite() && def.frame_b.is_finite(), "a joint's frames are finite");
        assert!(def.friction_torque >= 0.0, "a joint's friction torque is at least 0");
        Self {
            a,
            b,
            frame_a: principal_from_a * def.frame_a,
            frame_b: principal_from_b * def.frame_b,
            kind: def.kind,
            friction_torque: def.friction_torque,
            collision: def.collision,
            limits: [LimitImpulse::default(); MAX_LIMITS],
            loop_impulse: ZERO6,
            force: Vec3::ZERO,
        }
    }
}

/// What the rows of a joint are computed from: its definition without state.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointGeometry {
    pub frame_a: Transform,
    pub frame_b: Transform,
    pub kind: JointKind,
}

/// The joint's frames in the world, and the arms of its anchors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointPose {
    /// World arm from A's centre of mass to its anchor, likewise B.
    pub arm_a: Vec3,
    pub arm_b: Vec3,
    /// Anchor of B less anchor of A, world, metres: 0 when the joint holds.
    pub gap: Vec3,
    pub rotation_a: Rotation,
    pub rotation_b: Rotation,
}

impl JointPose {
    pub fn new(joint: &JointGeometry, a: &Transform, b: &Transform) -> Self {
        let arm_a = a.rotation * joint.frame_a.translation;
        let arm_b = b.rotation * joint.frame_b.translation;
        Self {
            arm_a,
            arm_b,
            gap: (b.translation - a.translation) + (arm_b - arm_a),
            rotation_a: a.rotation * joint.frame_a.rotation,
            rotation_b: b.rotation * joint.frame_b.rotation,
        }
    }

    /// Rotation of frame B seen from frame A.
    pub fn relative(&self) -> Rotation {
        self.rotation_a.inverse() * self.rotation_b
    }
}

/// Rows `J_a v_a + J_b v_b` of one joint: rigid ones first, then those of dry friction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointRows {
    /// Rows in use.
    pub count: usize,
    /// Of these, rigid ones.
    pub rigid: usize,
    /// Position error of the rigid rows, metres or radians.
    pub error: Vec6,
    /// Jacobians of the two bodies, row by row.
    pub a: [Vec6; 6],
    pub b: [Vec6; 6],
}

impl JointRows {
    /// All rows of the joint; `friction` adds a row for each free rotation.
    pub fn new(joint: &JointGeometry, pose: &JointPose, friction: bool) -> Self {
        let mut rows = Self { count: 0, rigid: 0, error: ZERO6, a: [ZERO6; 6], b: [ZERO6; 6] };
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            rows.push(
                axis.dot(pose.gap),
                join(-axis, -pose.arm_a.cross(axis)),
                join(axis, pose.arm_b.cross(axis)),
            );
        }
        let mut free = [Vec3::X, Vec3::Y, Vec3::Z];
        let mut free_count = 3;
        for (error, axis) in locked_axes(joint, pose).into_iter().flatten() {
            rows.push(error, join(Vec3::ZERO, -axis), join(Vec3::ZERO, axis));
            free_count -= 1;
        }
        rows.rigid = rows.count;
        match free_count {
            1 => free[0] = pose.rotation_a * Vec3::X,
            2 => free = [pose.rotation_a * Vec3::Y, pose.rotation_a * Vec3::Z, Vec3::ZERO],
            _ => {}
        }
        if friction {
            for &axis in &free[..free_count] {
                rows.push(0.0, join(Vec3::ZERO, -axis), join(Vec3::ZERO, axis));
            }
        }
        rows
    }

    fn push(&mut self, error: f32, a: Vec6, b: Vec6) {
        self.error[self.count] = error;
        self.a[self.count] = a;
        self.b[self.count] = b;
        self.count += 1;
    }
}

/// Position errors of the rigid rows alone, in the order of [`JointRows`].
pub(crate) fn rigid_error(joint: &JointGeometry, pose: &JointPose) -> Vec6 {
    let mut error = [pose.gap.x, pose.gap.y, pose.gap.z, 0.0, 0.0, 0.0];
    for (row, (angle, _)) in locked_axes(joint, pose).into_iter().flatten().enumerate() {
        error[3 + row] = angle;
    }
    error
}

/// Locked rotations: error in radians and world axis whose dot product with `ω_b − ω_a` is its rate.
fn locked_axes(joint: &JointGeometry, pose: &JointPose) -> [Option<(f32, Vec3)>; 3] {
    let (ra, rb) = (pose.rotation_a, pose.rotation_b);
    match joint.kind {
        JointKind::Ball { .. } => [None; 3],
        JointKind::Hinge { .. } => {
            // C = y_a · x_b and z_a · x_b: the hinge axes stay parallel. Ċ = (x_b × y_a) · (ω_b − ω_a).
            let (y, z, x_b) = (ra * Vec3::Y, ra * Vec3::Z, rb * Vec3::X);
            [Some((y.dot(x_b), x_b.cross(y))), Some((z.dot(x_b), x_b.cross(z))), None]
        }
        JointKind::Universal { .. } => {
            let stop = twist_stops(Range::symmetric(0.0), pose.relative())[0];
            [Some((stop.room, ra * stop.axis)), None, None]
        }
        JointKind::Fixed => {
            let error = pose.relative().to_scaled_axis();
            let axes = [ra * Vec3::X, ra * Vec3::Y, ra * Vec3::Z];
            [Some((error.x, axes[0])), Some((error.y, axes[1])), Some((error.z, axes[2]))]
        }
    }
}

fn twist_stops(twist: Range, relative: Rotation) -> [LimitState; 2] {
    let free = Range::symmetric(core::f32::consts::PI);
    SwingTwistLimit { swing_y: free, swing_z: free, twist }.twist_states(relative)
}

/// States of a joint's limit rows; axes in frame A. Rows that the joint does not have are `None`.
pub(crate) fn limit_states(kind: &JointKind, relative: Rotation) -> [Option<LimitState>; MAX_LIMITS] {
    match kind {
        JointKind::Ball { limit: Some(limit) } => {
            let [below, above] = limit.twist_states(relative);
            [Some(limit.swing_state(relative)), Some(below), Some(above)]
        }
        JointKind::Universal { limit: Some(limit) } => [Some(limit.swing_state(relative)), None, None],
        JointKind::Hinge { limit: Some(range) } => {
            // Measured from the middle and wrapped, as for a twist.
            let half = 0.5 * (range.hi - range.lo);
            let angle = wrap(hinge_angle(relative) - range.center());
            [
                None,
                Some(LimitState { room: half + angle, axis: Vec3::X }),
                Some(LimitState { room: half - angle, axis: -Vec3::X }),
            ]
        }
        _ => [None; MAX_LIMITS],
    }
}

/// How far a joint is beyond its limits, radians.
pub(crate) fn overshoot(kind: &JointKind, relative: Rotation) -> f32 {
    let mut worst = 0.0;
    for state in limit_states(kind, relative).into_iter().flatten() {
        worst = max(worst, -state.room);
    }
    worst
}
