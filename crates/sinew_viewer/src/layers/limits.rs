//! Cones of joint limits.

use crate::session::limits;
use sinew::math::{Range, Rotation, Transform, Vec3, clamp, max, normalize_or};
use sinew::physics::{JointDef, JointKind, World};
use sinew_picture::{Line, LineDepth};

/// Straight pieces around a cone.
const SEGMENTS: usize = 32;
/// Length of a cone, as a share of the size of the second body.
const LENGTH: f32 = 0.6;
/// Linear colours: of the cone, of the joint's present axis, and of the cone when the joint is beyond its
/// limits.
const CONE: [f32; 3] = [0.95, 0.55, 0.05];
const AXIS: [f32; 3] = [0.05, 0.65, 0.10];
const BEYOND: [f32; 3] = [0.95, 0.05, 0.05];

/// Present limits of a joint in the world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    /// World from the joint's frame on the first body.
    pub frame: Transform,
    /// Rotation from the frame on the second body to the frame on the first.
    pub turn: Rotation,
    /// Swing about y, swing about z, twist, radians.
    pub ranges: [Option<Range>; 3],
    /// True for a hinge: the angle of the twist range then swings the second body.
    pub is_hinge: bool,
    /// Length of the drawn cone, metres.
    pub length: f32,
    /// Angle by which the joint is beyond its limits, radians.
    pub beyond: f32,
}

impl Cone {
    /// Returns the direction of the edge of a range (0: swing about y, 1: about z), world space, unit.
    pub fn edge(&self, axis: usize, angle: f32) -> Vec3 {
        let about = if axis == 0 { Vec3::Y } else { Vec3::Z };
        self.frame.rotation * (Rotation::from_axis_angle(about, angle) * Vec3::X)
    }

    /// Returns the point of the edge of a range, metres, world space.
    pub fn handle(&self, axis: usize, angle: f32) -> Vec3 {
        let way = if self.is_hinge { self.hinge_way(angle) } else { self.edge(axis, angle) };
        self.frame.translation + way * self.length
    }

    /// Returns the direction in which a hinge at an angle is drawn, world space, unit.
    pub fn hinge_way(&self, angle: f32) -> Vec3 {
        self.frame.rotation * (Rotation::from_axis_angle(Vec3::X, angle) * Vec3::Y)
    }
}

/// Returns the limits of a joint; `None` if no rotation is limited.
pub(crate) fn cone_of(world: &World, joint: &JointDef) -> Option<Cone> {
    let ranges = limits(&joint.kind);
    if ranges == [None; 3] {
        return None;
    }
    let frame = world.transform(joint.body_a) * joint.frame_a;
    let other = world.transform(joint.body_b) * joint.frame_b;
    let turn = frame.rotation.inverse() * other.rotation;
    let bounds = world.bounds(joint.body_b);
    let length = max(LENGTH * (bounds.max - bounds.min).max_element(), 1e-3);
    let beyond = match joint.kind {
        JointKind::Ball { limit: Some(limit) } => limit.overshoot(turn),
        _ => 0.0,
    };
    let is_hinge = ranges[0].is_none() && ranges[1].is_none();
    Some(Cone { frame, turn, ranges, is_hinge, length, beyond })
}

/// Adds the lines of a joint's limits, in `color` if one is given.
pub(crate) fn add_cone(cone: &Cone, color: Option<[f32; 3]>, lines: &mut Vec<Line>) {
    let color = color.unwrap_or(if cone.beyond > 0.02 { BEYOND } else { CONE });
    let at = cone.frame.translation;
    let mut line =
        |from: Vec3, to: Vec3, color| lines.push(Line { from, to, color, depth: LineDepth::OnTop });
    if let [y, z, _] = cone.ranges
        && !cone.is_hinge
    {
        let around = |i: usize| at + rim(cone, [y, z], i) * cone.length;
        for i in 0..SEGMENTS {
            line(around(i), around(i + 1), color);
            if i.is_multiple_of(SEGMENTS / 8) {
                line(at, around(i), color);
            }
        }
        line(at, at + cone.frame.rotation * (cone.turn * Vec3::X) * cone.length, AXIS);
    }
    if let [_, _, Some(twist)] = cone.ranges {
        // A hinge is drawn as a fan; a twist as a smaller one, about the joint's present axis.
        let (length, base) = if cone.is_hinge {
            (cone.length, cone.frame.rotation)
        } else {
            let (swing, _) = cone.turn.swing_twist(Vec3::X);
            (0.4 * cone.length, cone.frame.rotation * swing)
        };
        let way = |angle: f32| base * (Rotation::from_axis_angle(Vec3::X, angle) * Vec3::Y) * length;
        let angle = |i: usize| twist.lo + (twist.hi - twist.lo) * (i as f32 / SEGMENTS as f32);
        for i in 0..SEGMENTS {
            line(at + way(angle(i)), at + way(angle(i + 1)), color);
        }
        line(at, at + way(twist.lo), color);
        line(at, at + way(twist.hi), color);
        let (_, now) = cone.turn.swing_twist(Vec3::X);
        line(at, at + way(now.twist_angle(Vec3::X)), AXIS);
    }
}

/// Returns the direction of a point of the rim of a cone, world space, unit.
fn rim(cone: &Cone, ranges: [Option<Range>; 2], i: usize) -> Vec3 {
    let (sin, cos) = sinew::math::trig::sin_cos(i as f32 * (core::f32::consts::TAU / SEGMENTS as f32));
    // The rim is an ellipse in the plane of the swing's scaled axis; each quarter has its own half axes.
    let half = |range: Option<Range>, sign: f32| {
        let range = range.unwrap_or(Range::new(0.0, 0.0));
        clamp(if sign < 0.0 { -range.lo } else { range.hi }, 0.0, core::f32::consts::PI)
    };
    let swing = Vec3::new(0.0, cos * half(ranges[0], cos), sin * half(ranges[1], sin));
    let turn = Rotation::from_axis_angle(normalize_or(swing, Vec3::Y), swing.length());
    cone.frame.rotation * (turn * Vec3::X)
}
