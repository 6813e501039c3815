//! Joint definitions from points and axes in the world.

use crate::id::{BodyId, JointId};
use crate::joint::def::{AxisMotion, JointCollision, JointDef, JointKind, SixDof};
use crate::world::World;
use core::ops::BitOr;
use sinew_math::{Range, Rotation, Transform, Vec3};

/// World axes along and about which a body cannot move: for [`World::axis_locks`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LockedAxes(u8);

impl LockedAxes {
    /// No motion along the world's x axis.
    pub const TRANSLATION_X: Self = Self(1);
    /// No motion along the world's y axis.
    pub const TRANSLATION_Y: Self = Self(1 << 1);
    /// No motion along the world's z axis.
    pub const TRANSLATION_Z: Self = Self(1 << 2);
    /// No rotation about the world's x axis.
    pub const ROTATION_X: Self = Self(1 << 3);
    /// No rotation about the world's y axis.
    pub const ROTATION_Y: Self = Self(1 << 4);
    /// No rotation about the world's z axis.
    pub const ROTATION_Z: Self = Self(1 << 5);
    /// No motion along any axis.
    pub const TRANSLATIONS: Self = Self(0b111);
    /// No rotation: the body stays upright.
    pub const ROTATIONS: Self = Self(0b111 << 3);
    /// Motion in the world's xy plane only.
    pub const PLANE_XY: Self = Self(Self::TRANSLATION_Z.0 | Self::ROTATION_X.0 | Self::ROTATION_Y.0);

    /// True if all axes of `other` are in this set.
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    fn motion(self, first: Self, axis: usize) -> AxisMotion {
        if self.contains(Self(first.0 << axis)) { AxisMotion::Locked } else { AxisMotion::Free }
    }
}

impl BitOr for LockedAxes {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// Joint definitions at the bodies' current poses, from points and axes in the world. Change the fields of the returned
/// definition for non-default values, or call [`World::set_joint`] later.
///
/// ```
/// use sinew_math::{Range, Vec3};
/// use sinew_physics::{BodyDef, JointDef, Motor, Shape, World, WorldDef};
///
/// let mut world = World::new(WorldDef::default());
/// let frame = world.add_body(&BodyDef::fixed(Shape::cuboid(Vec3::new(0.05, 1.0, 0.05))));
/// let panel = Shape::cuboid(Vec3::new(0.4, 1.0, 0.02));
/// let panel = world.add_body(&BodyDef::dynamic(panel).at(Vec3::X * 0.5));
/// let hinge = world.hinge(frame, panel, Vec3::X * 0.1, Vec3::Y).limited(Range { lo: 0.0, hi: 1.5 });
/// let door = world.add_joint(&JointDef { motor: Some(Motor::spin(1.0, 500.0)), ..hinge });
/// (0..60).for_each(|_| world.step());
/// let angle = world.joint_transform(door).rotation.twist_angle(Vec3::X);
/// assert!((angle - 1.0).abs() < 0.05);
/// ```
///
/// # Panics
/// If an id is stale, a number not finite, or an axis zero.
impl World {
    /// Ball joint: the bodies share a world point (metres) and rotate freely about it.
    #[doc(alias = "SphericalJoint")]
    #[doc(alias = "point to point")]
    #[track_caller]
    pub fn ball(&self, a: BodyId, b: BodyId, anchor: Vec3) -> JointDef {
        self.joint_at(a, b, anchor, Vec3::X, JointKind::Ball { limit: None })
    }

    /// Hinge: the bodies share a world point (metres) and rotate about a world axis of any length.
    #[doc(alias = "RevoluteJoint")]
    #[track_caller]
    pub fn hinge(&self, a: BodyId, b: BodyId, anchor: Vec3, axis: Vec3) -> JointDef {
        self.joint_at(a, b, anchor, axis, JointKind::Hinge { limit: None })
    }

    /// Universal joint: the bodies share a world point (metres) and swing, but do not twist, about a world axis of any
    /// length.
    #[doc(alias = "cardan joint")]
    #[track_caller]
    pub fn universal(&self, a: BodyId, b: BodyId, anchor: Vec3, axis: Vec3) -> JointDef {
        self.joint_at(a, b, anchor, axis, JointKind::Universal { limit: None })
    }

    /// Slider: the bodies move along a world axis of any length through a world point (metres), without rotation.
    #[doc(alias = "PrismaticJoint")]
    #[track_caller]
    pub fn slider(&self, a: BodyId, b: BodyId, anchor: Vec3, axis: Vec3) -> JointDef {
        self.joint_at(a, b, anchor, axis, JointKind::Slider { limit: None })
    }

    /// Fixed joint: the bodies keep their current relative pose. The reaction torque is about B's centre of mass.
    #[doc(alias = "weld joint")]
    #[track_caller]
    pub fn fixed(&self, a: BodyId, b: BodyId) -> JointDef {
        self.joint_at(a, b, self.center_of_mass(b), Vec3::X, JointKind::Fixed)
    }

    /// Distance joint between a world point (metres) of each body. The distance stays within a range (metres): a rope
    /// has a range from 0 to its length, and a rod has two equal ends of the range.
    #[doc(alias = "RopeJoint")]
    #[doc(alias = "rod")]
    #[track_caller]
    pub fn distance(&self, a: BodyId, b: BodyId, point_a: Vec3, point_b: Vec3, range: Range) -> JointDef {
        let (from_a, from_b) = (self.transform(a), self.transform(b));
        let at = |from: Transform, point| Transform::from_translation(from.inverse_point(point));
        let (frame_a, frame_b) = (at(from_a, finite(point_a)), at(from_b, finite(point_b)));
        JointDef::between(a, b, frame_a, frame_b, JointKind::Distance { range })
    }

    /// Locks a body's motion along and rotation about world axes, by a joint to a static body `ground`; the two still
    /// collide. Rotation is locked at the current orientation. A lock about a single axis acts like a [universal
    /// joint](Self::universal).
    ///
    /// ```
    /// use sinew_math::Vec3;
    /// use sinew_physics::{BodyDef, LockedAxes, Shape, World, WorldDef};
    ///
    /// let mut world = World::new(WorldDef::default());
    /// let ground = world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    /// let pawn = world.add_body(&BodyDef::dynamic(Shape::capsule(0.5, 0.3)).at(Vec3::Y * 0.8));
    /// world.add_joint(&world.axis_locks(ground, pawn, LockedAxes::ROTATIONS));
    /// world.apply_impulse(pawn, Vec3::X * 500.0, Vec3::Y * 1.6);
    /// (0..60).for_each(|_| world.step());
    /// assert!((world.transform(pawn).rotation * Vec3::Y).y > 0.9999);
    /// ```
    ///
    /// # Panics
    /// If an id is stale.
    #[doc(alias = "lock_rotations")]
    #[doc(alias = "set_locked_axes")]
    #[doc(alias = "allowed DOFs")]
    #[track_caller]
    pub fn axis_locks(&self, ground: BodyId, body: BodyId, locks: LockedAxes) -> JointDef {
        let turns = |axis: &usize| locks.motion(LockedAxes::ROTATION_X, *axis) == AxisMotion::Free;
        // The axis that differs from the other two becomes the x axis of the frames, the twist axis.
        let free = (0..3).filter(turns).count();
        let unlike = (0..3).find(|axis| turns(axis) == (free == 1)).unwrap_or(0);
        let axis = |i: usize| (i + unlike) % 3;
        let turning = |i: usize| locks.motion(LockedAxes::ROTATION_X, axis(i));
        let six = SixDof {
            linear: [0, 1, 2].map(|i| locks.motion(LockedAxes::TRANSLATION_X, axis(i))),
            twist: turning(0),
            swing_y: turning(1),
            swing_z: turning(2),
        };
        // Rotation by a third of a turn about the diagonal: maps X to Y, Y to Z and Z to X.
        let cycle = Rotation::from_xyzw(0.5, 0.5, 0.5, 0.5);
        let rotation = [Rotation::IDENTITY, cycle, cycle.inverse()][unlike];
        let world_from_joint = Transform::new(self.center_of_mass(body), rotation);
        let (from_a, from_b) = (self.transform(ground), self.transform(body));
        let collision = JointCollision::Enabled;
        let def = JointDef::new(ground, body, from_a, from_b, world_from_joint, JointKind::SixDof(six));
        JointDef { collision, ..def }
    }

    /// Adds a [ball joint](Self::ball) at a world point, metres.
    ///
    /// # Panics
    /// As [`add_joint`](Self::add_joint) does.
    #[track_caller]
    pub fn add_ball(&mut self, a: BodyId, b: BodyId, anchor: Vec3) -> JointId {
        self.add_joint(&self.ball(a, b, anchor))
    }

    /// Adds a [hinge](Self::hinge) at a world point (metres), about a world axis.
    ///
    /// # Panics
    /// As [`add_joint`](Self::add_joint) does.
    #[track_caller]
    pub fn add_hinge(&mut self, a: BodyId, b: BodyId, anchor: Vec3, axis: Vec3) -> JointId {
        self.add_joint(&self.hinge(a, b, anchor, axis))
    }

    /// Adds a [slider](Self::slider) along a world axis through a world point, metres.
    ///
    /// # Panics
    /// As [`add_joint`](Self::add_joint) does.
    #[track_caller]
    pub fn add_slider(&mut self, a: BodyId, b: BodyId, anchor: Vec3, axis: Vec3) -> JointId {
        self.add_joint(&self.slider(a, b, anchor, axis))
    }

    /// Adds a [fixed joint](Self::fixed) that keeps the current relative pose of the bodies.
    ///
    /// # Panics
    /// As [`add_joint`](Self::add_joint) does.
    #[track_caller]
    pub fn add_fixed(&mut self, a: BodyId, b: BodyId) -> JointId {
        self.add_joint(&self.fixed(a, b))
    }

    /// Adds a [rope](Self::distance) of a length (metres) between a world point of body A and a world point of body B.
    ///
    /// # Panics
    /// As [`add_joint`](Self::add_joint) does.
    #[track_caller]
    pub fn add_rope(&mut self, a: BodyId, b: BodyId, point_a: Vec3, point_b: Vec3, length: f32) -> JointId {
        self.add_joint(&self.distance(a, b, point_a, point_b, Range { lo: 0.0, hi: length }))
    }

    #[track_caller]
    fn joint_at(&self, a: BodyId, b: BodyId, anchor: Vec3, axis: Vec3, kind: JointKind) -> JointDef {
        let (axis, anchor) = (finite(axis), finite(anchor));
        let length = axis.length();
        assert!(length > 0.0 && length < f32::INFINITY, "a joint's axis has a length, not {length:?}");
        let world_from_joint = Transform::new(anchor, Rotation::from_arc(Vec3::X, axis / length));
        JointDef::new(a, b, self.transform(a), self.transform(b), world_from_joint, kind)
    }
}

#[track_caller]
fn finite(v: Vec3) -> Vec3 {
    assert!(v.is_finite(), "a joint's anchor and axis must be finite, not {v:?}");
    v
}
