//! Definitions of joints: plain data.

use crate::body::Velocity;
use crate::id::BodyId;
use sinew_math::{Range, SwingTwistLimit, Transform, Vec3};

/// Kind of a joint: its free motions. The joint's frames are `JointDef::frame_a` and `frame_b`; zero is where they
/// coincide.
///
#[doc = include_str!("kinds.svg")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum JointKind {
    /// Three rotations, within limits.
    Ball {
        /// Swing and twist limits; `None`: unlimited.
        limit: Option<SwingTwistLimit>,
    },
    /// One rotation, about the frames' x axis.
    Hinge {
        /// Limit of the angle, radians, inside −π..=π; `None`: unlimited.
        limit: Option<Range>,
    },
    /// Two rotations: swing about y and z, no twist about x. Twist is undefined at a swing of half a turn and is weak
    /// near it: limit the swing if it can reach half a turn.
    Universal {
        /// Cone of the swing; the twist range is ignored. `None`: unlimited.
        limit: Option<SwingTwistLimit>,
    },
    /// No free motion.
    Fixed,
    /// One translation, along the frames' x axis.
    Slider {
        /// Limit of the translation, metres; `None`: unlimited.
        limit: Option<Range>,
    },
    /// Only the distance of the two anchors is constrained, to a range: a rod if both ends are equal, a rope if the
    /// lower one is 0, a spring with [`JointDef::spring`] and a wide range.
    Distance {
        /// Range of the distance, metres, at least 0.
        range: Range,
    },
    /// Each of the six directions is set separately.
    SixDof(SixDof),
}

/// Six relative motions of two frames, each locked, free or limited.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SixDof {
    /// Translation along the axes of frame A, metres.
    pub linear: [AxisMotion; 3],
    /// Rotation about x, radians, inside −π..=π. Locked with free swings it equals [`JointKind::Universal`].
    pub twist: AxisMotion,
    /// Swing about y, radians, containing 0; limits on both swings make an elliptic cone.
    pub swing_y: AxisMotion,
    /// Swing about z, radians, with the same rule as `swing_y`.
    pub swing_z: AxisMotion,
}

impl SixDof {
    /// All directions free: the joint acts only by its motor, spring and friction. On a static or kinematic body it is
    /// a pin, which stays stable for any number of pins on a tree of bodies and closes no loop.
    pub const FREE: Self = Self {
        linear: [AxisMotion::Free; 3],
        twist: AxisMotion::Free,
        swing_y: AxisMotion::Free,
        swing_z: AxisMotion::Free,
    };
}

/// One direction of a [`SixDof`] joint.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum AxisMotion {
    /// Held at zero.
    Locked,
    /// Unlimited.
    Free,
    /// Free within a range, metres or radians. For a range without width, use `Locked`.
    Limited(Range),
}

/// Stiffness and damping of a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Softness {
    /// Stiffness and damping independent of the masses.
    Stiffness {
        /// Stiffness, N/m or N·m/rad.
        stiffness: f32,
        /// Damping, N·s/m or N·m·s/rad.
        damping: f32,
    },
    /// Frequency-based: the joint behaves as a damped oscillator. Its mass is that of the two sides of the joint, each
    /// as one rigid piece in the pose at the step's start, rotating about one joint axis. For a joint that closes a
    /// loop it is the mass of its two bodies. For a pin ([`SixDof::FREE`] to a kinematic or static body) it is the mass
    /// of all bodies that are nearer to this pin, in joints, than to other pins and to the tree's support. For limits
    /// and soft zones it is the effective mass of their row while the joints hold.
    Frequency {
        /// Natural frequency, Hz.
        hertz: f32,
        /// Damping ratio; 1 is critical.
        damping_ratio: f32,
    },
}

/// Pulls the free directions toward a rest pose, with unlimited force; see [`Motor`] for limited force. The rest pose
/// must be inside the limits: a stop that a stiff spring exceeds pushes back only as fast as the available energy
/// allows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Spring {
    /// Stiffness and damping of the spring.
    pub softness: Softness,
    /// Rest pose of frame B relative to frame A. For [`JointKind::Distance`] the rest length is its `translation.x`.
    pub rest: Transform,
}

/// Aim of a motor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Gains {
    /// Reaches the target velocity, as exactly as the caps allow.
    Velocity,
    /// Reaches the target pose by stiffness, and the target velocity by damping.
    Position(Softness),
}

/// Drives the free directions of a joint. The targets must be inside the limits, see [`Spring`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(alias = "drive")]
#[doc(alias = "actuator")]
pub struct Motor {
    /// Aim of the motor: a velocity, or a pose.
    pub gains: Gains,
    /// Target pose of frame B in frame A. For a hinge only the rotation about x counts, for a slider only translation
    /// x.
    pub target: Transform,
    /// Target velocity of frame B relative to frame A, in A's axes, m/s and rad/s.
    pub velocity: Velocity,
    /// Largest force along each free axis, N; may be infinite, and 0 disables translations.
    #[cfg_attr(feature = "serde", serde(with = "sinew_math::unlimited"))]
    pub max_force: f32,
    /// Largest torque about each free axis, N·m; may be infinite, and 0 disables rotations.
    #[cfg_attr(feature = "serde", serde(with = "sinew_math::unlimited"))]
    pub max_torque: f32,
}

impl Motor {
    /// Creates a motor toward a pose, with unlimited force and torque.
    pub fn toward(target: Transform, softness: Softness) -> Self {
        Self {
            gains: Gains::Position(softness),
            target,
            velocity: Velocity::default(),
            max_force: f32::INFINITY,
            max_torque: f32::INFINITY,
        }
    }

    /// Creates a motor that rotates a hinge at `speed` (rad/s) with at most `max_torque` (N·m).
    pub fn spin(speed: f32, max_torque: f32) -> Self {
        Self {
            gains: Gains::Velocity,
            target: Transform::IDENTITY,
            velocity: Velocity { linear: Vec3::ZERO, angular: Vec3::X * speed },
            max_force: 0.0,
            max_torque,
        }
    }

    /// Creates a motor that moves a slider at `speed` (m/s) with at most `max_force` (N).
    pub fn push(speed: f32, max_force: f32) -> Self {
        Self {
            gains: Gains::Velocity,
            target: Transform::IDENTITY,
            velocity: Velocity { linear: Vec3::X * speed, angular: Vec3::ZERO },
            max_force,
            max_torque: 0.0,
        }
    }
}

/// Softens the end of a joint's rotation. No effect on translations, or where the limits themselves are soft.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SoftZone {
    /// Distance from the stop at which a spring starts to push back, radians. 5° suits limbs.
    pub width: f32,
    /// Stiffness and damping; damping increases from zero at the zone's edge to its full value at the stop. 10 Hz and
    /// critical suits limbs.
    pub softness: Softness,
}

/// Load at which a joint breaks. It is then disabled, and reported in `Events::broken`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Strength {
    /// Mean force over a step at which the joint breaks, N.
    #[cfg_attr(feature = "serde", serde(with = "sinew_math::unlimited"))]
    pub force: f32,
    /// Mean torque over a step at which the joint breaks, N·m about B's anchor; includes springs, motors, limits and
    /// friction.
    #[cfg_attr(feature = "serde", serde(with = "sinew_math::unlimited"))]
    pub torque: f32,
}

impl Strength {
    /// Strength of a joint that never breaks.
    pub const UNBREAKABLE: Self = Self { force: f32::INFINITY, torque: f32::INFINITY };
}

/// Collision of the two bodies of a joint with each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum JointCollision {
    /// The bodies collide.
    Enabled,
    /// The bodies do not collide while the joint is enabled.
    Disabled,
}

/// State of a joint: enabled or disabled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum JointState {
    /// The joint acts.
    Enabled,
    /// The joint is disabled and has no effect.
    Disabled,
}

/// Definition of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(alias = "constraint")]
#[doc(alias = "ImpulseJoint")]
#[doc(alias = "GenericJoint")]
#[must_use = "a joint is there once `World::add_joint` has it"]
pub struct JointDef {
    /// First body (the parent, if there is a hierarchy).
    pub body_a: BodyId,
    /// Second body.
    pub body_b: BodyId,
    /// Joint frame in A's frame: anchor and axes.
    pub frame_a: Transform,
    /// Joint frame in B's frame.
    pub frame_b: Transform,
    /// Kind of the joint: its free motions.
    pub kind: JointKind,
    /// Stiffness and damping of the locked directions. Default `None`: exact.
    pub weld: Option<Softness>,
    /// Stiffness and damping of the limits. Default `None`: hard stops without bounce.
    pub limit_softness: Option<Softness>,
    /// Zone in front of hard limits of rotations. Default `None`.
    pub soft_zone: Option<SoftZone>,
    /// Spring that pulls the free directions. Default `None`.
    pub spring: Option<Spring>,
    /// Motor that drives the free directions. Default `None`.
    pub motor: Option<Motor>,
    /// Torque that resists the free rotations, N·m, and force that resists the free translations, N. Default 0.
    pub friction_torque: f32,
    /// Load at which the joint breaks. Default unbreakable.
    pub strength: Strength,
    /// Collision of the two bodies with each other. Default disabled.
    pub collision: JointCollision,
    /// Enabled or disabled. Default enabled.
    pub state: JointState,
}

impl JointDef {
    /// Creates a joint at the world frame `world_from_joint`; its frames coincide in the bodies' current pose.
    pub fn new(
        body_a: BodyId,
        body_b: BodyId,
        world_from_a: Transform,
        world_from_b: Transform,
        world_from_joint: Transform,
        kind: JointKind,
    ) -> Self {
        let frame_a = world_from_a.inverse() * world_from_joint;
        let frame_b = world_from_b.inverse() * world_from_joint;
        Self::between(body_a, body_b, frame_a, frame_b, kind)
    }

    /// Creates a joint with a frame on each body, in that body's axes.
    pub fn between(
        body_a: BodyId,
        body_b: BodyId,
        frame_a: Transform,
        frame_b: Transform,
        kind: JointKind,
    ) -> Self {
        Self {
            body_a,
            body_b,
            frame_a,
            frame_b,
            kind,
            weld: None,
            limit_softness: None,
            soft_zone: None,
            spring: None,
            motor: None,
            friction_torque: 0.0,
            strength: Strength::UNBREAKABLE,
            collision: JointCollision::Disabled,
            state: JointState::Enabled,
        }
    }

    /// Sets the range of motion: radians for a hinge, metres for a slider.
    ///
    /// # Panics
    /// If the joint is of another kind: other limits are fields of their [kinds](JointKind).
    #[track_caller]
    pub fn limited(self, range: Range) -> Self {
        let limit = Some(range);
        let kind = match self.kind {
            JointKind::Hinge { .. } => JointKind::Hinge { limit },
            JointKind::Slider { .. } => JointKind::Slider { limit },
            other => panic!("a hinge or a slider has one range, not {other:?}"),
        };
        Self { kind, ..self }
    }

    /// Creates a mouse joint, which pulls a point of `body_b` toward the origin of `hand`, a static or kinematic body:
    /// move the hand, or the motor's target. `point` is in B's frame, `max_force` in N.
    pub fn drag(hand: BodyId, body_b: BodyId, point: Vec3, softness: Softness, max_force: f32) -> Self {
        let frame_b = Transform::from_translation(point);
        let kind = JointKind::SixDof(SixDof::FREE);
        let motor = Motor { max_force, max_torque: 0.0, ..Motor::toward(Transform::IDENTITY, softness) };
        Self {
            motor: Some(motor),
            collision: JointCollision::Enabled,
            ..Self::between(hand, body_b, Transform::IDENTITY, frame_b, kind)
        }
    }

    /// # Panics
    /// If a number is not finite (except caps and strengths, which may be infinite), negative where that is invalid, or
    /// a range is empty.
    #[track_caller]
    pub(crate) fn check(&self) {
        assert!(
            self.frame_a.is_finite() && self.frame_b.is_finite(),
            "a joint's frames must be finite, not {:?} and {:?}",
            self.frame_a,
            self.frame_b
        );
        assert!(
            self.friction_torque >= 0.0 && self.friction_torque < f32::INFINITY,
            "a joint's friction torque is at least 0 and finite, not {}",
            self.friction_torque
        );
        assert!(
            self.strength.force >= 0.0 && self.strength.torque >= 0.0,
            "a joint's strength is at least 0, not {:?}",
            self.strength
        );
        assert!(self.kind.ranges_are_valid(), "a joint's ranges are not empty, as in {:?}", self.kind);
        let zone = self.soft_zone.map(|zone| zone.softness);
        let spring = self.spring.map(|spring| spring.softness);
        let motor = self.motor.and_then(|motor| match motor.gains {
            Gains::Velocity => None,
            Gains::Position(softness) => Some(softness),
        });
        for softness in [self.weld, self.limit_softness, zone, spring, motor].into_iter().flatten() {
            assert!(softness.is_valid(), "a spring's numbers are at least 0 and finite, not {softness:?}");
        }
        assert!(
            self.soft_zone.is_none_or(|zone| zone.width >= 0.0 && zone.width < f32::INFINITY),
            "a soft zone's width is at least 0 and finite, as in {:?}",
            self.soft_zone
        );
        assert!(
            self.spring.is_none_or(|spring| spring.rest.is_finite()),
            "a spring's rest pose is finite, as in {:?}",
            self.spring
        );
        assert!(
            self.motor.is_none_or(|motor| motor.is_valid()),
            "a motor's numbers are finite, as in {:?}",
            self.motor
        );
    }
}

impl JointKind {
    fn ranges_are_valid(&self) -> bool {
        let some = |range: Range| range.lo <= range.hi;
        let cone = |limit: &SwingTwistLimit| {
            let inside = |swing: Range| swing.lo <= 0.0 && swing.hi >= 0.0;
            inside(limit.swing_y) && inside(limit.swing_z) && some(limit.twist)
        };
        let axis = |motion: &AxisMotion| match *motion {
            AxisMotion::Limited(range) => some(range),
            _ => true,
        };
        match self {
            Self::Ball { limit } | Self::Universal { limit } => limit.as_ref().is_none_or(cone),
            Self::Hinge { limit } | Self::Slider { limit } => limit.is_none_or(some),
            Self::Fixed => true,
            Self::Distance { range } => some(*range) && range.lo >= 0.0,
            Self::SixDof(six) => {
                six.linear.iter().all(axis) && [six.twist, six.swing_y, six.swing_z].iter().all(axis)
            }
        }
    }
}

impl Softness {
    fn is_valid(&self) -> bool {
        let (p, q) = match *self {
            Self::Stiffness { stiffness, damping } => (stiffness, damping),
            Self::Frequency { hertz, damping_ratio } => (hertz, damping_ratio),
        };
        let sound = 0.0..f32::INFINITY;
        sound.contains(&p) && sound.contains(&q)
    }
}

impl Motor {
    pub(crate) fn is_valid(&self) -> bool {
        self.target.is_finite()
            && self.velocity.linear.is_finite()
            && self.velocity.angular.is_finite()
            && self.max_force >= 0.0
            && self.max_torque >= 0.0
    }
}
