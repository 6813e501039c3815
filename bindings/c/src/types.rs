//! Plain data that crosses the border. Metres, kilograms, seconds, radians; +Y is up, right-handed.

use crate::border::{Outcome, SinewStatus, error};
use sinew::math::{Rotation, Transform, Vec3};
use sinew::physics::{BodyId, BodyKind, JointId, Shape, Velocity};

/// Three numbers.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SinewVec3 {
    /// Coordinate along x.
    pub x: f32,
    /// Coordinate along y, which is up.
    pub y: f32,
    /// Coordinate along z.
    pub z: f32,
}

/// Rotation as a unit quaternion; other lengths are normalised. Four zeros are the identity.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SinewRotation {
    /// Coefficient of i.
    pub x: f32,
    /// Coefficient of j.
    pub y: f32,
    /// Coefficient of k.
    pub z: f32,
    /// Real part.
    pub w: f32,
}

/// Rigid pose: rotation, then translation.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SinewPose {
    /// Position, metres.
    pub position: SinewVec3,
    /// Rotation.
    pub rotation: SinewRotation,
}

/// Velocity of a centre of mass, m/s, and angular velocity, rad/s; world axes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SinewVelocity {
    /// Linear velocity, m/s.
    pub linear: SinewVec3,
    /// Angular velocity, rad/s.
    pub angular: SinewVec3,
}

/// Id of a body in a world. The id of a removed body is stale: using it is an error, and it never refers to another body.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SinewBodyId {
    /// Index and generation.
    pub bits: u64,
}

/// Id of a joint in a world. The id of a removed joint is stale, as for bodies.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SinewJointId {
    /// Index and generation.
    pub bits: u64,
}

/// Kind of a body.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SinewBodyKind {
    /// Forces move the body.
    Dynamic = 0,
    /// The body never moves.
    Static = 1,
    /// The body moves at its velocity; no force or contact changes it.
    Kinematic = 2,
}

/// Kind of a shape, with the meaning of `size` in [`SinewShape`].
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SinewShapeKind {
    /// Box. `size`: half of each side.
    Box = 0,
    /// Ball. `size.x`: radius.
    Sphere = 1,
    /// Capsule along y. `size.x`: radius; `size.y`: half the length without the caps.
    Capsule = 2,
    /// Cylinder along y. `size.x`: radius; `size.y`: half the length.
    Cylinder = 3,
    /// Cone along y, the apex up. `size.x`: radius of the base; `size.y`: half the height.
    Cone = 4,
    /// All points below y = 0 of its frame, for static bodies. No sizes.
    HalfSpace = 5,
}

/// Shape around its body's origin. `kind` is a number instead of an enum, so that an invalid one is an error.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SinewShape {
    /// One of `SinewShapeKind`.
    pub kind: u32,
    /// Sizes in metres, by the kind.
    pub size: SinewVec3,
}

impl From<Vec3> for SinewVec3 {
    fn from(v: Vec3) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<Transform> for SinewPose {
    fn from(pose: Transform) -> Self {
        let q = pose.rotation;
        Self { position: pose.translation.into(), rotation: SinewRotation { x: q.x, y: q.y, z: q.z, w: q.w } }
    }
}

impl From<Velocity> for SinewVelocity {
    fn from(velocity: Velocity) -> Self {
        Self { linear: velocity.linear.into(), angular: velocity.angular.into() }
    }
}

impl From<BodyId> for SinewBodyId {
    fn from(id: BodyId) -> Self {
        Self { bits: id.to_bits() }
    }
}

impl From<JointId> for SinewJointId {
    fn from(id: JointId) -> Self {
        Self { bits: id.to_bits() }
    }
}

impl SinewVec3 {
    /// Converts to the library's type; `name` is for the error.
    pub(crate) fn read(self, name: &str) -> Outcome<Vec3> {
        let v = Vec3::new(self.x, self.y, self.z);
        if v.is_finite() { Ok(v) } else { Err(bad(format!("{name} is not finite: {v:?}"))) }
    }
}

impl SinewRotation {
    fn read(self, name: &str) -> Outcome<Rotation> {
        let q = Rotation { x: self.x, y: self.y, z: self.z, w: self.w };
        if !q.is_finite() {
            return Err(bad(format!("{name} is not finite: {q:?}")));
        }
        let length = q.length();
        if length == 0.0 {
            return Ok(Rotation::IDENTITY);
        }
        // A unit quaternion keeps its bits, so that setting a pose that was read changes no bits.
        Ok(if (length - 1.0).abs() < 1e-6 { q } else { q.normalize() })
    }
}

impl SinewPose {
    /// Converts to the library's type.
    pub(crate) fn read(self, name: &str) -> Outcome<Transform> {
        Ok(Transform::new(self.position.read(name)?, self.rotation.read(name)?))
    }
}

impl SinewVelocity {
    /// Converts to the library's type.
    pub(crate) fn read(self, name: &str) -> Outcome<Velocity> {
        Ok(Velocity { linear: self.linear.read(name)?, angular: self.angular.read(name)? })
    }
}

impl SinewShape {
    /// Converts to the library's type; invalid sizes are an error.
    pub(crate) fn read(self) -> Outcome<Shape> {
        use SinewShapeKind as Kind;
        let size = self.size.read("the size of a shape")?;
        let (radius, half_height) = (size.x, size.y);
        let shape = match self.kind {
            kind if kind == Kind::Box as u32 => Shape::Box { half_extents: size },
            kind if kind == Kind::Sphere as u32 => Shape::Sphere { radius },
            kind if kind == Kind::Capsule as u32 => Shape::Capsule { half_height, radius },
            kind if kind == Kind::Cylinder as u32 => Shape::Cylinder { half_height, radius },
            kind if kind == Kind::Cone as u32 => Shape::Cone { half_height, radius },
            kind if kind == Kind::HalfSpace as u32 => Shape::HalfSpace,
            kind => return Err(bad(format!("there is no shape of kind {kind}"))),
        };
        shape.check().map_err(|what| bad(what.to_string()))?;
        Ok(shape)
    }
}

/// Returns the kind of a body from its number.
pub(crate) fn body_kind(kind: u32) -> Outcome<BodyKind> {
    match kind {
        kind if kind == SinewBodyKind::Dynamic as u32 => Ok(BodyKind::Dynamic),
        kind if kind == SinewBodyKind::Static as u32 => Ok(BodyKind::Static),
        kind if kind == SinewBodyKind::Kinematic as u32 => Ok(BodyKind::Kinematic),
        kind => Err(bad(format!("there is no body of kind {kind}"))),
    }
}

fn bad(what: String) -> crate::border::CallError {
    error(SinewStatus::BadArgument, what)
}
