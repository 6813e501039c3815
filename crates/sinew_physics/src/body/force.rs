//! Forces, torques and impulses applied by the user: for one step, until changed, or as an instant impulse.
//!
//! World axes and SI units unless stated otherwise. A force `F` at a point `p` accelerates the centre of mass `c` as if
//! it acted there, and also rotates the body: `a = F/m`, `τ = (p − c) × F`, `α = I⁻¹ τ` (Newton, Euler). Forces add up.
//! They act on dynamic bodies only, and wake sleeping ones.

use crate::body::Body;
use crate::id::BodyId;
use sinew_math::{ReadError, Reader, Transform, Vec3, Writer, max, min};

/// Force and torque about the centre of mass, world axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force, N.
    pub force: Vec3,
    /// Torque, N·m.
    pub torque: Vec3,
}

/// Axes in which a lasting force is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ForceFrame {
    /// World axes: the direction is constant while the body rotates. Default.
    #[default]
    World,
    /// Body axes: the direction rotates with the body, as for a thruster.
    Body,
}

/// A force that acts on a body in every substep until it is changed or removed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(default))]
pub struct ForceDef {
    /// Force, N, in the axes of `frame`.
    pub force: Vec3,
    /// Torque, N·m, in the axes of `frame`, in addition to the torque from `force` at `point`.
    pub torque: Vec3,
    /// Point at which `force` acts, metres in the body's frame. `None`, the default: the centre of mass.
    pub point: Option<Vec3>,
    /// Axes of `force` and `torque`. Default the world's.
    pub frame: ForceFrame,
}

impl ForceDef {
    pub(crate) fn is_finite(&self) -> bool {
        self.force.is_finite() && self.torque.is_finite() && self.point.is_none_or(Vec3::is_finite)
    }
}

/// A lasting force of a body of a [`World`](crate::World).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ForceId {
    body: BodyId,
    number: u32,
}

impl ForceId {
    pub(crate) fn new(body: BodyId, number: u32) -> Self {
        Self { body, number }
    }

    /// Body that the force acts on.
    pub fn body(self) -> BodyId {
        self.body
    }
}

/// Bytes of the shortest force in a snapshot.
const FORCE_BYTES: usize = 4 + 12 + 12 + 1 + 1;

/// Lasting forces of a body, ascending by the number in their ids.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyForces {
    pub list: Vec<(u32, ForceDef)>,
    /// Number of the next force.
    pub next: u32,
}

impl BodyForces {
    pub fn save(&self, w: &mut Writer) {
        w.u32(self.next);
        w.count(self.list.len());
        for (number, def) in &self.list {
            w.u32(*number);
            w.vec3(def.force);
            w.vec3(def.torque);
            w.bool(def.point.is_some());
            if let Some(point) = def.point {
                w.vec3(point);
            }
            w.bool(def.frame == ForceFrame::Body);
        }
    }

    pub fn load(r: &mut Reader<'_>) -> Result<Self, ReadError> {
        let mut forces = Self { list: Vec::new(), next: r.u32()? };
        for _ in 0..r.count(FORCE_BYTES)? {
            let (number, force, torque) = (r.u32()?, r.vec3()?, r.vec3()?);
            let point = if r.bool()? { Some(r.vec3()?) } else { None };
            let frame = if r.bool()? { ForceFrame::Body } else { ForceFrame::World };
            forces.list.push((number, ForceDef { force, torque, point, frame }));
        }
        let known = forces.list.last().is_none_or(|&(number, _)| number < forces.next);
        if !(known && forces.list.is_sorted_by(|a, b| a.0 < b.0)) {
            return Err(r.error("lasting forces are out of order"));
        }
        Ok(forces)
    }

    #[track_caller]
    pub fn place(&self, id: ForceId) -> usize {
        let place = self.list.binary_search_by_key(&id.number, |&(number, _)| number);
        place.unwrap_or_else(|_| panic!("{id:?} is not there"))
    }

    /// Sum of the forces and of their torques about the centre of mass, for the given pose of the body's principal
    /// frame.
    pub fn sum(&self, body: &Body, world_from_principal: Transform) -> Wrench {
        let mut sum = Wrench::default();
        let world_from_body = world_from_principal.rotation * body.principal_from_body.rotation;
        for (_, def) in &self.list {
            let turned = |v: Vec3| match def.frame {
                ForceFrame::World => v,
                ForceFrame::Body => world_from_body * v,
            };
            let force = turned(def.force);
            sum.force += force;
            sum.torque += turned(def.torque);
            if let Some(point) = def.point {
                let arm = world_from_principal.rotation * body.principal_from_body.point(point);
                sum.torque += arm.cross(force);
            }
        }
        sum
    }
}

/// Change of a velocity by an impulse. An overflowing change keeps its direction, and the next step limits the speed to
/// the world's maximum.
pub(crate) fn finite_change(impulse: Vec3, change: impl Fn(Vec3) -> Vec3) -> Vec3 {
    // Beyond `HUGE`, products with arms and inverse masses may overflow; beyond `MOST`, squares of sums may.
    const HUGE: f32 = 1e15;
    const MOST: f32 = 1e30;
    const SCALE: f32 = 1e-20;
    let largest = |v: Vec3| max(max(v.x.abs(), v.y.abs()), v.z.abs());
    if largest(impulse) <= HUGE {
        return change(impulse);
    }
    let small = change(impulse * SCALE);
    small * min(1.0 / SCALE, MOST / max(largest(small), f32::MIN_POSITIVE))
}
