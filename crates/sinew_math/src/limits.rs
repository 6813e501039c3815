//! Joint limits as plain data, and how far a rotation is beyond them.

use crate::{Rotation, Vec3, trig};

/// A closed interval, radians unless said otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub lo: f32,
    /// Upper end, not below `lo`.
    pub hi: f32,
}

impl Range {
    /// From both ends.
    pub const fn new(lo: f32, hi: f32) -> Self {
        Self { lo, hi }
    }
    /// From −`half` to `half`.
    pub const fn symmetric(half: f32) -> Self {
        Self { lo: -half, hi: half }
    }
    /// From both ends in degrees.
    pub fn degrees(lo: f32, hi: f32) -> Self {
        Self { lo: lo.to_radians(), hi: hi.to_radians() }
    }
    /// How far `x` lies outside; 0 inside.
    pub fn excess(self, x: f32) -> f32 {
        if x < self.lo {
            self.lo - x
        } else if x > self.hi {
            x - self.hi
        } else {
            0.0
        }
    }
    /// Middle.
    pub fn center(self) -> f32 {
        0.5 * (self.lo + self.hi)
    }
}

/// Limits of a ball joint: an elliptic swing cone with its own half-angle on each side, and a twist range.
///
/// The joint rotation `frame_a⁻¹ frame_b` is split as swing × twist about the joint frame's **x axis**. `swing_y` is
/// the rotation about y, `swing_z` about z (the y and z components of the swing's scaled axis); zero lies inside both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwingTwistLimit {
    /// Swing about the joint's y axis, radians, `lo ≤ 0 ≤ hi`.
    pub swing_y: Range,
    /// Swing about the joint's z axis, radians, `lo ≤ 0 ≤ hi`.
    pub swing_z: Range,
    /// Twist about the joint's x axis, radians, inside −π..=π.
    pub twist: Range,
}

/// One limit that is near or past its stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitState {
    /// Room left, radians; negative when violated.
    pub room: f32,
    /// Gradient of `room` in frame A's axes: `room` grows at the rate `axis · ω`, ω the angular velocity of B relative
    /// to A. Of length 1 for a swing, a little more for a twist at a large swing.
    pub axis: Vec3,
}

impl SwingTwistLimit {
    /// The swing (scaled axis; its x is 0) and twist angle of a joint rotation `a⁻¹ b`, radians.
    pub fn angles(joint: Rotation) -> (Vec3, f32) {
        let (swing, twist) = joint.swing_twist(Vec3::X);
        (swing.to_scaled_axis(), twist.twist_angle(Vec3::X))
    }

    /// Half-angle of the cone along the unit direction (`y`, `z`) of the swing's scaled axis, radians.
    pub fn cone_angle(&self, y: f32, z: f32) -> f32 {
        let a = if y < 0.0 { -self.swing_y.lo } else { self.swing_y.hi };
        let b = if z < 0.0 { -self.swing_z.lo } else { self.swing_z.hi };
        // Radius of the ellipse with half-axes a, b in the direction (y, z); a locked axis gives 0 off the other axis.
        let (ya, zb) = (y / crate::max(a, 1e-4), z / crate::max(b, 1e-4));
        1.0 / crate::max((ya * ya + zb * zb).sqrt(), 1e-6)
    }

    /// State of the swing cone for the joint rotation `a⁻¹ b`. The axis is the outward normal of the elliptic cone,
    /// not the swing's own direction, so that the push back does not slide along the ellipse.
    pub fn swing_state(&self, joint: Rotation) -> LimitState {
        let (swing, _) = Self::angles(joint);
        let angle = swing.length();
        let (y, z) = if angle > 1e-6 { (swing.y / angle, swing.z / angle) } else { (1.0, 0.0) };
        let a = crate::max(if y < 0.0 { -self.swing_y.lo } else { self.swing_y.hi }, 1e-4);
        let b = crate::max(if z < 0.0 { -self.swing_z.lo } else { self.swing_z.hi }, 1e-4);
        // Gradient of (y/a)² + (z/b)² at the swing, normalised; on a circle it is the swing's direction itself.
        let normal = crate::normalize_or(Vec3::new(0.0, y / (a * a), z / (b * b)), Vec3::new(0.0, y, z));
        // Radial room projected on the normal: the distance to the tangent of the cone.
        let room = (self.cone_angle(y, z) - angle) * (normal.y * y + normal.z * z);
        LimitState { room, axis: -normal }
    }

    /// States of the lower and the upper twist stop for the joint rotation `a⁻¹ b`.
    pub fn twist_states(&self, joint: Rotation) -> [LimitState; 2] {
        let (swing, twist_about_x) = joint.swing_twist(Vec3::X);
        // Measured from the middle of the range and wrapped, so that ranges near ±π have no jump inside.
        let middle = self.twist.center();
        let half = 0.5 * (self.twist.hi - self.twist.lo);
        let angle = wrap(twist_about_x.twist_angle(Vec3::X) - middle);
        // The twist rate is ω·(x_a + x_b)/(1 + x_a·x_b); the divisor is held off 0 near a swing of half a turn.
        let x_b = swing * Vec3::X;
        let axis = (Vec3::X + x_b) / crate::max(1.0 + x_b.x, 0.05);
        [LimitState { room: angle + half, axis }, LimitState { room: half - angle, axis: -axis }]
    }

    /// How far the joint rotation `a⁻¹ b` is beyond the limits, radians: the larger of swing and twist excess.
    pub fn overshoot(&self, joint: Rotation) -> f32 {
        let mut worst = -self.swing_state(joint).room;
        for state in self.twist_states(joint) {
            worst = crate::max(worst, -state.room);
        }
        crate::max(worst, 0.0)
    }
}

/// `angle` radians brought into −π..=π.
pub fn wrap(angle: f32) -> f32 {
    const TURN: f32 = 2.0 * core::f32::consts::PI;
    if angle > core::f32::consts::PI {
        angle - TURN
    } else if angle < -core::f32::consts::PI {
        angle + TURN
    } else {
        angle
    }
}

/// Angle of a hinge about its x axis for the joint rotation `a⁻¹ b`, radians, −π..=π.
pub fn hinge_angle(joint: Rotation) -> f32 {
    let q = joint.positive();
    2.0 * trig::atan2(q.x, q.w)
}
