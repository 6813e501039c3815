//! Target of a joint motor that brings two bodies into the relative rotation of a pose.

use crate::tuning::STOP_ROOM;
use sinew_math::limits::{hinge_angle, wrap};
use sinew_math::{Range, Rotation, SwingTwistLimit, Transform, Vec3, clamp, max, min};
use sinew_physics::{JointDef, JointKind, Velocity};

/// Returns the rotation of frame B relative to frame A, restricted to rotations that the joint allows, and its angular
/// velocity in A's axes, rad/s.
pub(super) fn of_joint(
    joint: &JointDef,
    poses: [Transform; 2],
    velocities: [Velocity; 2],
) -> (Rotation, Vec3) {
    let world_from_a = poses[0].rotation * joint.frame_a.rotation;
    let world_from_b = poses[1].rotation * joint.frame_b.rotation;
    let wanted = (world_from_a.inverse() * world_from_b).normalize();
    let rate = world_from_a.inverse() * (velocities[1].angular - velocities[0].angular);
    let (held, inside) = match joint.kind {
        JointKind::Hinge { limit } => {
            let (angle, inside) = within(limit, hinge_angle(wanted));
            (Rotation::from_axis_angle(Vec3::X, angle), inside)
        }
        JointKind::Ball { limit: Some(limit) } => clamped(&limit, wanted),
        JointKind::Universal { limit } => {
            let (swing, _) = wanted.swing_twist(Vec3::X);
            limit.map_or((swing, true), |limit| {
                let free = Range::symmetric(core::f32::consts::PI);
                clamped(&SwingTwistLimit { twist: free, ..limit }, swing)
            })
        }
        _ => (wanted, true),
    };
    (held, if inside { rate } else { Vec3::ZERO })
}

/// Returns an angle clamped to a range, and true if the angle was inside the range.
fn within(range: Option<Range>, angle: f32) -> (f32, bool) {
    let Some(range) = range else { return (angle, true) };
    let (middle, half) = (range.center(), 0.5 * (range.hi - range.lo));
    let room = max(half - STOP_ROOM, 0.0);
    let beyond = wrap(angle - middle);
    (middle + clamp(beyond, -room, room), beyond.abs() <= half)
}

/// Returns a rotation clamped to a limit, and true if the rotation was inside the limit.
fn clamped(limit: &SwingTwistLimit, wanted: Rotation) -> (Rotation, bool) {
    let (swing, twist) = SwingTwistLimit::angles(wanted);
    let angle = swing.length();
    let mut share = 1.0;
    let mut inside = true;
    if angle > 1e-6 {
        let cone = limit.cone_angle(swing.y / angle, swing.z / angle);
        share = min(max(cone - STOP_ROOM, 0.0) / angle, 1.0);
        inside = angle <= cone;
    }
    let (twist, twist_inside) = within(Some(limit.twist), twist);
    if inside && twist_inside && share == 1.0 {
        return (wanted, true);
    }
    let held = Rotation::from_scaled_axis(swing * share) * Rotation::from_axis_angle(Vec3::X, twist);
    (held, inside && twist_inside)
}
