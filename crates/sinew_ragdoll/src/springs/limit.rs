//! Limits of the directions of springs.

use sinew_anim::springs::{LimitKind, SpringLimit};
use sinew_math::trig::{asin, atan2, cos, sin};
use sinew_math::{Rotation, Vec3, clamp, min, normalize_or};

/// A limit in the space of its joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limit {
    kind: LimitKind,
    /// Rotation from the limit's frame, whose +Y is along the bone at rest, to the joint's frame.
    joint_from_limit: Rotation,
}

impl Limit {
    /// Creates the limit for a bone whose tip is in the direction `axis` from its joint, unit.
    pub fn new(limit: &SpringLimit, axis: Vec3) -> Self {
        let along = Rotation::from_arc(Vec3::Y, axis);
        Self { kind: limit.kind, joint_from_limit: (along * limit.rotation).normalize() }
    }

    /// Returns the nearest allowed direction, unit, in the joint's space. `direction` is unit.
    pub fn hold(&self, direction: Vec3) -> Vec3 {
        let v = self.joint_from_limit.inverse() * direction;
        let held = match self.kind {
            LimitKind::Cone { angle } => cone(v, angle),
            LimitKind::Hinge { angle } => {
                let turn = atan2(v.z, v.y);
                let turn = clamp(turn, -angle, angle);
                Vec3::new(0.0, cos(turn), sin(turn))
            }
            LimitKind::Spherical { phi, theta } => {
                let (turn, rise) = (atan2(v.z, v.y), asin(clamp(v.x, -1.0, 1.0)));
                let (turn, rise) = (clamp(turn, -phi, phi), clamp(rise, -theta, theta));
                Vec3::new(sin(rise), cos(rise) * cos(turn), cos(rise) * sin(turn))
            }
        };
        if held == v { direction } else { self.joint_from_limit * held }
    }
}

fn cone(v: Vec3, angle: f32) -> Vec3 {
    let side = Vec3::new(v.x, 0.0, v.z);
    if atan2(side.length(), v.y) <= angle {
        return v;
    }
    let angle = min(angle, core::f32::consts::PI);
    normalize_or(side, Vec3::X) * sin(angle) + Vec3::Y * cos(angle)
}
