//! Joint limits as plain data, and the distance of a rotation from them.

use crate::{Rotation, Vec3, trig};

/// A closed interval, in radians unless stated otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Range {
    /// Lower end.
    pub lo: f32,
    /// Upper end, not below `lo`.
    pub hi: f32,
}

impl Range {
    /// Creates a range from both ends.
    pub const fn new(lo: f32, hi: f32) -> Self {
        Self { lo, hi }
    }
    /// Creates a range from −`half` to `half`.
    pub const fn symmetric(half: f32) -> Self {
        Self { lo: -half, hi: half }
    }
    /// Creates a range from both ends in degrees.
    pub fn degrees(lo: f32, hi: f32) -> Self {
        Self { lo: lo.to_radians(), hi: hi.to_radians() }
    }
    /// Returns the distance of `x` from the range; 0 inside.
    pub fn excess(self, x: f32) -> f32 {
        if x < self.lo {
            self.lo - x
        } else if x > self.hi {
            x - self.hi
        } else {
            0.0
        }
    }
    /// Returns the middle of the range.
    pub fn center(self) -> f32 {
        0.5 * (self.lo + self.hi)
    }
}

/// Limits of a ball joint: an elliptic swing cone with its own half-angle on each side, and a twist range.
///
/// The joint rotation `frame_a⁻¹ frame_b` is split as swing × twist about the joint frame's **x axis**. `swing_y` is
/// the rotation about y, `swing_z` about z (the y and z components of the swing's scaled axis); zero lies inside both.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SwingTwistLimit {
    /// Swing about the joint's y axis, radians, `lo ≤ 0 ≤ hi`.
    pub swing_y: Range,
    /// Swing about the joint's z axis, radians, `lo ≤ 0 ≤ hi`.
    pub swing_z: Range,
    /// Twist about the joint's x axis, radians, inside −π..=π.
    pub twist: Range,
}

/// State of a joint at one stop of a limit: distance and gradient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitState {
    /// Distance to the stop, radians; negative when violated.
    pub slack: f32,
    /// Gradient of `slack` in frame A's axes: `slack` grows at the rate `axis · ω`, with ω the angular velocity of B
    /// relative to A. Its length is 1 for small swings and greater for large ones.
    pub axis: Vec3,
}

impl SwingTwistLimit {
    /// Splits a joint rotation `a⁻¹ b` into the swing (scaled axis with x = 0) and the twist angle, radians.
    pub fn angles(joint: Rotation) -> (Vec3, f32) {
        let (swing, twist) = joint.swing_twist(Vec3::X);
        (swing.to_scaled_axis(), twist.twist_angle(Vec3::X))
    }

    /// Returns the half-angle of the cone along the unit direction (`y`, `z`) of the swing's scaled axis, radians.
    pub fn cone_angle(&self, y: f32, z: f32) -> f32 {
        let a = if y < 0.0 { -self.swing_y.lo } else { self.swing_y.hi };
        let b = if z < 0.0 { -self.swing_z.lo } else { self.swing_z.hi };
        // Radius of the ellipse with half-axes a, b in the direction (y, z); a locked axis gives 0 off the other axis.
        let (ya, zb) = (y / crate::max(a, 1e-4), z / crate::max(b, 1e-4));
        1.0 / crate::max((ya * ya + zb * zb).sqrt(), 1e-6)
    }

    /// Returns the state of the swing cone for the joint rotation `a⁻¹ b`. The slack is the distance to the ellipse in
    /// the plane of the swing's scaled axis, to first order; its gradient is exact at the stop.
    ///
    /// With swing angle φ about unit `u`, the ellipse's outward normal `n` and the tangent `τ` perpendicular to `u`:
    /// `φ̇ = ω·u`. The axis itself turns at `−ω·(u × x_b)/sin φ`, because a swung body that spins about the axis of A
    /// moves to another side of the cone.
    pub fn swing_state(&self, joint: Rotation) -> LimitState {
        self.state_of_swing(joint.swing_twist(Vec3::X).0)
    }

    /// Returns the state of the swing cone for the swing of the joint rotation, see [`swing_state`](Self::swing_state).
    pub fn state_of_swing(&self, swing: Rotation) -> LimitState {
        self.place_in_cone(swing).state()
    }

    /// Returns the state of the swing stop if its slack is less than `reach`, radians.
    pub fn swing_within(&self, swing: Rotation, reach: f32) -> Option<LimitState> {
        let place = self.place_in_cone(swing);
        (place.slack < reach).then(|| place.state())
    }

    fn place_in_cone(&self, swing: Rotation) -> PlaceInCone {
        let swing = swing.positive();
        let half = (swing.y * swing.y + swing.z * swing.z).sqrt();
        let angle = 2.0 * trig::atan2(half, swing.w);
        let u = if angle > 1e-6 { Vec3::new(0.0, swing.y, swing.z) / half } else { Vec3::Y };
        let a = crate::max(if u.y < 0.0 { -self.swing_y.lo } else { self.swing_y.hi }, 1e-4);
        let b = crate::max(if u.z < 0.0 { -self.swing_z.lo } else { self.swing_z.hi }, 1e-4);
        let normal = crate::normalize_or(Vec3::new(0.0, u.y / (a * a), u.z / (b * b)), u);
        let slack = (self.cone_angle(u.y, u.z) - angle) * normal.dot(u);
        PlaceInCone { half, cos: swing.w, angle, u, normal, slack }
    }

    /// Returns the states of the lower and the upper twist stop for the joint rotation `a⁻¹ b`.
    pub fn twist_states(&self, joint: Rotation) -> [LimitState; 2] {
        let (swing, twist) = joint.swing_twist(Vec3::X);
        self.states_of_twist(swing, twist)
    }

    /// Returns the states of the lower and the upper twist stop for the swing and the twist of the joint rotation.
    pub fn states_of_twist(&self, swing: Rotation, twist: Rotation) -> [LimitState; 2] {
        twist_states(self.slack_of_twist(twist), swing)
    }

    /// Returns the states of the lower and the upper twist stop if the slack of one of them is less than `reach`,
    /// radians.
    pub fn twist_within(&self, swing: Rotation, twist: Rotation, reach: f32) -> Option<[LimitState; 2]> {
        let slack = self.slack_of_twist(twist);
        (slack[0] < reach || slack[1] < reach).then(|| twist_states(slack, swing))
    }

    /// Returns the distances to the lower and the upper twist stop, radians.
    fn slack_of_twist(&self, twist: Rotation) -> [f32; 2] {
        // Measured from the middle of the range and wrapped, so that ranges near ±π have no jump inside.
        let middle = self.twist.center();
        let half = 0.5 * (self.twist.hi - self.twist.lo);
        let angle = wrap(twist.twist_angle(Vec3::X) - middle);
        [angle + half, half - angle]
    }

    /// Returns the angle by which the joint rotation `a⁻¹ b` exceeds the limits, radians: the larger of swing and twist
    /// excess.
    pub fn overshoot(&self, joint: Rotation) -> f32 {
        let mut worst = -self.swing_state(joint).slack;
        for state in self.twist_states(joint) {
            worst = crate::max(worst, -state.slack);
        }
        crate::max(worst, 0.0)
    }
}

/// Returns the states of the twist stops for the given slacks. The twist rate is ω·(x_a + x_b)/(1 + x_a·x_b); the
/// divisor is bounded away from 0 near a swing of half a turn.
fn twist_states([below, above]: [f32; 2], swing: Rotation) -> [LimitState; 2] {
    let x_b = swing * Vec3::X;
    let axis = (Vec3::X + x_b) / crate::max(1.0 + x_b.x, 0.05);
    [LimitState { slack: below, axis }, LimitState { slack: above, axis: -axis }]
}

/// Position of a swing in the cone of its limit.
struct PlaceInCone {
    /// Sine and cosine of half the swing angle.
    half: f32,
    cos: f32,
    angle: f32,
    /// Unit axis of the swing, perpendicular to x.
    u: Vec3,
    /// Outward normal of the cone's ellipse in the direction of the swing.
    normal: Vec3,
    slack: f32,
}

impl PlaceInCone {
    fn state(&self) -> LimitState {
        let Self { half, angle, u, normal, .. } = *self;
        let tangent = Vec3::new(0.0, -u.z, u.y);
        // Bounds φ/sin φ near half a turn.
        let (sin, cos) = (2.0 * half * self.cos, 1.0 - 2.0 * half * half);
        let turning = if angle > 1e-4 { angle / crate::max(sin, 0.1) } else { 1.0 };
        let x_b = Vec3::new(cos, sin * u.z, -sin * u.y);
        let axis = u.cross(x_b) * (turning * normal.dot(tangent)) - u * normal.dot(u);
        LimitState { slack: self.slack, axis }
    }
}

/// Wraps `angle` into −π..=π, radians; `angle` is off by one turn at most.
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

/// Returns the angle of a hinge about its x axis for the joint rotation `a⁻¹ b`, radians, −π..=π.
pub fn hinge_angle(joint: Rotation) -> f32 {
    let q = joint.positive();
    2.0 * trig::atan2(q.x, q.w)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Random;

    /// Rate of `slack` by central differences, for angular velocity `w` of B in A's axes.
    fn rate(slack: impl Fn(Rotation) -> f32, joint: Rotation, w: Vec3) -> f32 {
        let h = 1e-3;
        let at = |h: f32| slack(Rotation::from_scaled_axis(w * h) * joint);
        (at(h) - at(-h)) / (2.0 * h)
    }

    #[test]
    fn limit_gradients_match_differences_of_the_slack() {
        let limit = SwingTwistLimit {
            swing_y: Range::degrees(-75.0, 60.0),
            swing_z: Range::degrees(-30.0, 40.0),
            twist: Range::degrees(-85.0, 70.0),
        };
        let mut random = Random::new(8);
        let (mut swings, mut twists) = (0, 0);
        while swings < 200 || twists < 200 {
            let joint = random.rotation();
            let w = random.direction();
            let swing = limit.swing_state(joint);
            let (axis, _) = SwingTwistLimit::angles(joint);
            // The normal jumps where the sides of the cone meet, and the distance is exact only at the stop.
            if swing.slack.abs() < 0.02 && axis.y.abs() > 0.05 && axis.z.abs() > 0.05 {
                let measured = rate(|q| limit.swing_state(q).slack, joint, w);
                assert!((measured - swing.axis.dot(w)).abs() < 0.06, "{measured} for {}", swing.axis.dot(w));
                swings += 1;
            }
            if axis.length() < 2.0 {
                for (side, stop) in limit.twist_states(joint).into_iter().enumerate() {
                    if stop.slack.abs() < 1.0 {
                        let measured = rate(|q| limit.twist_states(q)[side].slack, joint, w);
                        assert!(
                            (measured - stop.axis.dot(w)).abs() < 0.02,
                            "{measured} for {}",
                            stop.axis.dot(w)
                        );
                        twists += 1;
                    }
                }
            }
        }
    }
}
