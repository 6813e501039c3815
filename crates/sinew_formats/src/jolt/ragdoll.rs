//! Reads `RagdollSettings` as a rig and a ragdoll.

use super::objects::{At, Object, Objects};
use super::shape::Solid;
use crate::error::{Error, Result, quoted};
use sinew_anim::{Joint, LocalTransform, Rig, analyze_skeleton, rest_pose};
use sinew_math::{Mat3, Range, Rotation, SwingTwistLimit, Transform, Vec3, max, min};
use sinew_physics::JointKind;
use sinew_ragdoll::{RagdollBodyDef, RagdollDef, RagdollJointDef};

/// Settings of a joint's motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JoltMotor {
    /// Frequency, Hz.
    pub hertz: f32,
    /// Damping ratio; 1 is critical.
    pub damping_ratio: f32,
    /// Largest torque, N·m; infinite without a limit.
    pub max_torque: f32,
}

/// A ragdoll of Jolt.
#[derive(Clone, Debug, PartialEq)]
pub struct JoltRagdoll {
    /// Skeleton without skin; its rest pose is that of the ragdoll's parts.
    pub rig: Rig,
    /// Ragdoll with one body for each joint of the skeleton, in the same order.
    pub def: RagdollDef,
    /// Swing motor of each body's joint to its parent; `None` for the root.
    pub motors: Vec<Option<JoltMotor>>,
}

/// Reads a ragdoll: its skeleton, one solid per body, joints with swing and twist limits, friction and motors, and the
/// pairs that collide.
///
/// Jolt's swing limit is an ellipse in quaternion space, ours in angle space: they are equal on both axes, and within a
/// few per cent elsewhere. A part's mass is given, or follows from its shape and density.
///
/// # Errors
/// Returns an error that names the line: no text object file, no ragdoll, a part before its parent, a number that is
/// not finite or out of range. Other classes of shapes and joints, and mass given with inertia, are not supported.
pub fn read_jolt_ragdoll(bytes: &[u8]) -> Result<JoltRagdoll> {
    let objects = Objects::read(bytes)?;
    let Some(settings) = objects.of_class("RagdollSettings") else {
        return Err(Error::malformed("no ragdoll in it (an object of class RagdollSettings)", "top level"));
    };
    let skeleton = objects.need(settings.member("mSkeleton")?)?;
    let parts = settings.member("mParts")?;
    let joints = skeleton.member("mJoints")?;
    if parts.list()?.is_empty() || parts.list()?.len() != joints.list()?.len() {
        return Err(parts.malformed("not one part for each joint of the skeleton"));
    }
    let mut read = Read::default();
    for (index, (part, joint)) in parts.list()?.iter().zip(joints.list()?).enumerate() {
        read.add(&objects, index, objects.need(part)?, objects.need(joint)?)?;
    }
    read.filter(&objects, parts.list()?)?;
    Ok(read.finish())
}

#[derive(Default)]
struct Read {
    rig: Rig,
    def: RagdollDef,
    motors: Vec<Option<JoltMotor>>,
    /// Transform of each part, model space.
    model_from_part: Vec<Transform>,
    model_from_body: Vec<Transform>,
}

impl Read {
    fn add(&mut self, objects: &Objects, index: usize, part: &Object, joint: &Object) -> Result<()> {
        let name = joint.member("mName")?.text()?.to_owned();
        let parent_name = joint.member("mParentName")?;
        let parent = match parent_name.text()? {
            "" => None,
            parent => {
                let found = self.rig.joints.iter().position(|joint| joint.name == parent);
                Some(found.ok_or_else(|| {
                    parent_name.malformed(format!(
                        "{} is not a joint before {}",
                        quoted(parent),
                        quoted(&name)
                    ))
                })?)
            }
        };
        if parent.is_none() != (index == 0) {
            return Err(parent_name.malformed("the first joint alone has no parent"));
        }
        let model_from_part =
            Transform::new(part.member("mPosition")?.vec3()?, part.member("mRotation")?.rotation()?);
        let solid = Solid::read(objects, objects.need(part.member("mShape")?)?)?;
        let model_from_body = model_from_part * solid.part_from_shape;
        let local =
            parent.map_or(model_from_part, |p: usize| self.model_from_part[p].inverse() * model_from_part);
        let rest =
            LocalTransform { translation: local.translation, rotation: local.rotation, scale: Vec3::ONE };
        self.rig.joints.push(Joint { name: name.clone(), parent, rest, source: index });
        let mass = mass(part, &solid)?;
        self.def.bodies.push(RagdollBodyDef {
            bone: name,
            joint: index,
            merged: Vec::new(),
            role: String::new(),
            confidence: 0.0,
            shape: solid.shape,
            character_from_body: model_from_body,
            mass,
        });
        self.model_from_part.push(model_from_part);
        self.model_from_body.push(model_from_body);
        self.motors.push(None);
        if let Some(parent) = parent {
            let constraint = objects.need(part.member("mToParent")?)?;
            let (def, motor) = self.constraint(objects, constraint, [parent, index])?;
            self.def.joints.push(def);
            self.motors[index] = motor;
        }
        Ok(())
    }

    /// Converts a swing-twist constraint: x is its twist axis, z its plane axis, y their normal. The cone's half-angle
    /// in the plane is that of the swing about y (Jolt, `SwingTwistConstraint::UpdateLimits`).
    fn constraint(
        &self,
        objects: &Objects,
        c: &Object,
        bodies: [usize; 2],
    ) -> Result<(RagdollJointDef, Option<JoltMotor>)> {
        if c.class != "SwingTwistConstraintSettings" {
            return Err(c.unsupported(format!("a joint of class {}", quoted(&c.class))));
        }
        // The member is absent in older files; frames are then in world axes, as with the value 1.
        if let Some(space) = c.get("mSpace")
            && space.count()? != 1
        {
            return Err(c.unsupported("a joint given in the axes of its bodies"));
        }
        let frame = |n: usize| -> Result<Transform> {
            let [position, twist, plane] = ["mPosition", "mTwistAxis", "mPlaneAxis"]
                .map(|name| c.member(&format!("{name}{n}")).and_then(At::vec3));
            let (x, z) = (unit(c, twist?)?, unit(c, plane?)?);
            let y = unit(c, z.cross(x))?;
            let axes = Rotation::from_mat3(&Mat3::from_cols(x, y, x.cross(y)));
            let model_from_body = self.model_from_body[bodies[n - 1]];
            Ok(model_from_body.inverse() * Transform::new(position?, axes))
        };
        let number = |name: &str| c.member(name)?.number();
        let half = |name: &str| -> Result<Range> {
            match number(name)? {
                half if (0.0..=core::f32::consts::PI).contains(&half) => Ok(Range::symmetric(half)),
                _ => Err(c.malformed("a cone's half-angle beyond half a turn")),
            }
        };
        let (lo, hi) = (number("mTwistMinAngle")?, number("mTwistMaxAngle")?);
        if !(-core::f32::consts::PI <= lo && lo <= hi && hi <= core::f32::consts::PI) {
            return Err(c.malformed("an empty twist range"));
        }
        let limit = SwingTwistLimit {
            swing_y: half("mPlaneHalfConeAngle")?,
            swing_z: half("mNormalHalfConeAngle")?,
            twist: Range::new(lo, hi),
        };
        let friction_torque = number("mMaxFrictionTorque")?;
        if friction_torque < 0.0 {
            return Err(c.malformed("a negative friction"));
        }
        let def = RagdollJointDef {
            parent: bodies[0],
            child: bodies[1],
            frame_parent: frame(1)?,
            frame_child: frame(2)?,
            kind: JointKind::Ball { limit: Some(limit) },
            friction_torque,
        };
        let motor = c.get("mSwingMotorSettings").map(|at| motor(objects, at)).transpose()?.flatten();
        Ok((def, motor))
    }

    /// Disables the pairs that the table of collision groups disables: one bit per pair, row by row of the lower triangle.
    fn filter(&mut self, objects: &Objects, parts: &[At]) -> Result<()> {
        let mut groups = Vec::new();
        for part in parts {
            let group = objects.need(objects.need(part)?.member("mCollisionGroup")?)?;
            let table = objects.follow(group.member("mGroupFilter")?)?;
            let table = table.filter(|table| table.class == "GroupFilterTable");
            groups.push((table, group.member("mSubGroupID")?.count()? as usize));
        }
        for b in 0..groups.len() {
            for a in 0..b {
                let (Some(table), Some(other)) = (groups[a].0, groups[b].0) else { continue };
                let (p, q) = (groups[a].1, groups[b].1);
                let jointed = self.def.joints[b - 1].parent == a;
                if !core::ptr::eq(table, other) || p == q || jointed {
                    continue;
                }
                let bytes = table.member("mTable")?;
                let (low, high) = if p < q { (p, q) } else { (q, p) };
                let bit = high.saturating_mul(high - 1) / 2 + low;
                let byte = bytes.list()?.get(bit / 8);
                let byte = byte.ok_or_else(|| bytes.malformed("a group beyond the table"))?.count()?;
                if byte >> (bit % 8) & 1 == 0 {
                    self.def.disabled_pairs.push((a, b));
                }
            }
        }
        self.def.disabled_pairs.sort_unstable();
        Ok(())
    }

    /// Sets roles and facing, as far as the skeleton shows them, and the sums of the ragdoll.
    fn finish(mut self) -> JoltRagdoll {
        let def = &mut self.def;
        let mut turn = Transform::IDENTITY;
        let analysis = analyze_skeleton(&self.rig, &rest_pose(&self.rig)).ok();
        if let Some(analysis) = &analysis {
            turn = analysis.character_from_model;
        }
        let (mut bottom, mut top) = (f32::INFINITY, f32::NEG_INFINITY);
        for (index, body) in def.bodies.iter_mut().enumerate() {
            let guess = analysis.as_ref().and_then(|analysis| analysis.roles[index]);
            body.role = guess.map_or_else(|| format!("limb_{index}_0"), |guess| guess.role.name());
            body.confidence = guess.map_or(0.0, |guess| guess.confidence);
            body.character_from_body = turn * body.character_from_body;
            let bounds = body.shape.aabb(&body.character_from_body);
            (bottom, top) = (min(bottom, bounds.min.y), max(top, bounds.max.y));
        }
        def.total_mass = def.bodies.iter().map(|body| body.mass.mass).sum();
        def.height = top - bottom;
        def.unit_scale = 1.0;
        def.up_axis = Vec3::Y;
        def.character_from_model = turn;
        JoltRagdoll { rig: self.rig, def: self.def, motors: self.motors }
    }
}

fn unit(object: &Object, v: Vec3) -> Result<Vec3> {
    let length = v.length();
    if length > 1e-3 && length < 1e3 {
        Ok(v / length)
    } else {
        Err(object.malformed("an axis without direction"))
    }
}

fn mass(part: &Object, solid: &Solid) -> Result<sinew_physics::MassProperties> {
    let mut mass = solid.mass;
    match part.get("mOverrideMassProperties").map(At::count).transpose()?.unwrap_or(0) {
        0 => {}
        1 => {
            let given = part.member("mMassPropertiesOverride")?;
            let kilograms = match given.object().and_then(|object| object.get("mMass")) {
                Some(at) => at.number()?,
                None => return Err(given.malformed("no mass")),
            };
            if kilograms <= 0.0 {
                return Err(given.malformed("a mass that is not positive"));
            }
            mass.inertia = mass.inertia * (kilograms / mass.mass);
            mass.mass = kilograms;
        }
        _ => return Err(part.unsupported("a part whose inertia is given")),
    }
    Ok(mass)
}

/// Reads a motor; `None` for a motor without strength.
fn motor(objects: &Objects, at: &At) -> Result<Option<JoltMotor>> {
    let settings = objects.need(at)?;
    // In newer files the spring is a nested object.
    let spring = settings.get("mSpringSettings").map(|at| objects.need(at)).transpose()?.unwrap_or(settings);
    let number = |object: &Object, name: &str| object.member(name)?.number();
    let (hertz, damping_ratio) = (number(spring, "mFrequency")?, number(spring, "mDamping")?);
    let torque = min(number(settings, "mMaxTorqueLimit")?, -number(settings, "mMinTorqueLimit")?);
    if hertz < 0.0 || damping_ratio < 0.0 {
        return Err(settings.malformed("a motor's spring with negative numbers"));
    }
    let max_torque = if torque >= f32::MAX { f32::INFINITY } else { torque };
    Ok((hertz > 0.0 && torque > 0.0).then_some(JoltMotor { hertz, damping_ratio, max_torque }))
}
