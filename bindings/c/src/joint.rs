//! Joints between bodies of a world.

use crate::border::{Outcome, SinewStatus, error, exclusive, give, guard, refused, room, shared};
use crate::types::{SinewBodyId, SinewJointId, SinewPose, SinewVec3};
use crate::world::{SinewWorld, body};
use sinew::math::{Range, Rotation, Transform, Vec3};
use sinew::physics::{JointDef, JointId, JointKind, Motor, Softness, World};

/// Kind of a joint.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SinewJointKind {
    /// Allows rotation about the anchor.
    Ball = 0,
    /// Allows rotation about the axis. `range`: radians.
    Hinge = 1,
    /// Allows sliding along the axis. `range`: metres.
    Slider = 2,
    /// Locks all motions.
    Fixed = 3,
    /// Rope or rod from the anchor of A to the anchor of B. `range`: metres.
    Distance = 4,
}

/// Definition of a joint.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct SinewJointDef {
    /// One of `SinewJointKind`.
    pub kind: u32,
    /// The first body.
    pub a: SinewBodyId,
    /// The second body; at least one of the two must be dynamic.
    pub b: SinewBodyId,
    /// Anchor of both bodies, world, metres; for a distance joint, its end at A.
    pub anchor: SinewVec3,
    /// End of a distance joint at B, world, metres; ignored by other kinds.
    pub anchor_b: SinewVec3,
    /// Axis of a hinge or a slider, world; must not be zero.
    pub axis: SinewVec3,
    /// 1 if a hinge or slider has a range, else 0; a distance joint always has one. The present pose is 0.
    pub has_range: u32,
    /// Lower end of the range.
    pub range_lo: f32,
    /// Upper end of the range.
    pub range_hi: f32,
}

impl SinewJointDef {
    fn read(&self, world: &World) -> Outcome<JointDef> {
        let (a, b) = (body(world, self.a)?, body(world, self.b)?);
        let (anchor, axis) = (self.anchor.read("the anchor")?, self.axis.read("the axis")?);
        let bad = |what: &str| error(SinewStatus::BadArgument, what);
        let is_axial = [SinewJointKind::Hinge as u32, SinewJointKind::Slider as u32].contains(&self.kind);
        if is_axial && axis == Vec3::ZERO {
            return Err(bad("the axis of a hinge or slider is zero"));
        }
        if self.has_range > 1 {
            return Err(bad("has_range is 0 or 1"));
        }
        let range = Range { lo: self.range_lo, hi: self.range_hi };
        let limit = (self.has_range == 1).then_some(range);
        let def = match self.kind {
            kind if kind == SinewJointKind::Ball as u32 => world.ball(a, b, anchor),
            kind if kind == SinewJointKind::Hinge as u32 => {
                JointDef { kind: JointKind::Hinge { limit }, ..world.hinge(a, b, anchor, axis) }
            }
            kind if kind == SinewJointKind::Slider as u32 => {
                JointDef { kind: JointKind::Slider { limit }, ..world.slider(a, b, anchor, axis) }
            }
            kind if kind == SinewJointKind::Fixed as u32 => world.fixed(a, b),
            kind if kind == SinewJointKind::Distance as u32 => {
                world.distance(a, b, anchor, self.anchor_b.read("the anchor at B")?, range)
            }
            kind => return Err(bad(&format!("there is no joint of kind {kind}"))),
        };
        Ok(def)
    }
}

fn joint(world: &World, id: SinewJointId) -> Outcome<JointId> {
    let joint = JointId::from_bits(id.bits);
    let is_there = world.contains_joint(joint);
    if is_there { Ok(joint) } else { Err(error(SinewStatus::StaleId, format!("no joint {:#x}", id.bits))) }
}

/// Adds a joint at the present poses of its bodies; stores its id in `id`.
///
/// # Safety
/// `world` is null or a world that no other thread uses, `def` null or a definition, `id` null or room for one.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_add_joint(
    world: *mut SinewWorld,
    def: *const SinewJointDef,
    id: *mut SinewJointId,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let (world, def) = unsafe { (exclusive(world, "world")?, shared(def, "def")?) };
        room(id, "id")?;
        let added = world.world.change(|world| {
            let def = def.read(world)?;
            refused(|| world.add_joint(&def))
        })?;
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give(id, "id", added.into()) }
    })
}

/// Removes a joint.
///
/// # Safety
/// `world` is null or a world that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_remove_joint(world: *mut SinewWorld, id: SinewJointId) -> SinewStatus {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    guard(|| unsafe {
        exclusive(world, "world")?.world.change(|world| {
            let joint = joint(world, id)?;
            world.remove_joint(joint);
            Ok(())
        })
    })
}

/// Drives a joint toward a rotation of B relative to A, given as a scaled axis (a hinge: along x), by a spring with a frequency in Hz, a
/// damping ratio and a largest torque, N·m. 0 Hz removes the motor.
///
/// # Safety
/// `world` is null or a world that no other thread uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_drive_joint(
    world: *mut SinewWorld,
    id: SinewJointId,
    target: SinewVec3,
    hertz: f32,
    damping_ratio: f32,
    max_torque: f32,
) -> SinewStatus {
    // SAFETY: the caller guarantees the conditions under `# Safety`.
    guard(|| unsafe {
        let rotation = Rotation::from_scaled_axis(target.read("the target")?);
        let softness = Softness::Frequency { hertz, damping_ratio };
        let toward = Motor::toward(Transform::new(Vec3::ZERO, rotation), softness);
        let motor = (hertz != 0.0).then_some(Motor { max_force: 0.0, max_torque, ..toward });
        exclusive(world, "world")?.world.change(|world| {
            let joint = joint(world, id)?;
            refused(|| world.set_motor(joint, motor))
        })
    })
}

/// Stores the distance between the joint's two anchors in `gap`, metres.
///
/// # Safety
/// `world` is null or a world that no other thread changes, `gap` is null or points to a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_joint_gap(
    world: *const SinewWorld,
    id: SinewJointId,
    gap: *mut f32,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let world = unsafe { shared(world, "world") }?.world.get()?;
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give(gap, "gap", world.joint_gap(joint(world, id)?)) }
    })
}

/// Stores the pose of B relative to A, in the joint's frames, in `pose`: rotation and translation.
///
/// # Safety
/// As `sinew_world_joint_gap`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sinew_world_joint_pose(
    world: *const SinewWorld,
    id: SinewJointId,
    pose: *mut SinewPose,
) -> SinewStatus {
    guard(|| {
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        let world = unsafe { shared(world, "world") }?.world.get()?;
        // SAFETY: the caller guarantees the conditions under `# Safety`.
        unsafe { give(pose, "pose", world.joint_transform(joint(world, id)?).into()) }
    })
}
