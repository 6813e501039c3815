//! World methods for joints: creation, changes, queries.

use crate::body::def::BodyKind;
use crate::id::{BodyId, JointId};
use crate::joint::def::{JointDef, JointState, Motor};
use crate::joint::{Joint, JointPose, anchor_gap, overshoot};
use crate::spatial::{angular, linear};
use crate::world::World;
use sinew_math::{Transform, Vec3};

/// Mean force and torque of a joint on body B during the last step, world axes. While the bodies sleep, the values are
/// those of the step in which the bodies fell asleep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reaction {
    /// Force, N.
    pub force: Vec3,
    /// Torque about B's anchor, N·m, including limits, springs, motors and friction.
    pub torque: Vec3,
}

impl World {
    /// Adds a joint; both bodies wake.
    ///
    /// # Panics
    /// If both bodies are the same, neither is dynamic, or a number of the definition is not valid.
    #[doc(alias = "ImpulseJoint")]
    #[doc(alias = "constraint")]
    #[track_caller]
    pub fn add_joint(&mut self, def: &JointDef) -> JointId {
        let (a, b) = (self.expect(def.body_a), self.expect(def.body_b));
        assert!(def.body_a != def.body_b, "a joint holds two bodies, not {:?} twice", def.body_a);
        assert!(
            a.kind == BodyKind::Dynamic || b.kind == BodyKind::Dynamic,
            "a joint needs a dynamic body: neither {:?} nor {:?} is one",
            def.body_a,
            def.body_b
        );
        let (ia, ib) = (def.body_a.index, def.body_b.index);
        let joint = Joint::new(def, ia, ib, a.principal_from_body, b.principal_from_body);
        let id = self.joints.insert(joint);
        self.activity.joints_of.insert(id.index, self.joints.at(id.index));
        self.joint_changed(id);
        id
    }

    /// Removes a joint; both bodies wake.
    ///
    /// # Panics
    /// If the joint has an [owner](Self::own_joints): a character detaches its limbs by its own methods.
    #[track_caller]
    pub fn remove_joint(&mut self, id: JointId) {
        self.expect_own_joint(id);
        self.take_joint(id);
    }

    /// Removes a joint, even if it has an owner.
    pub(super) fn take_joint(&mut self, id: JointId) {
        self.joint_changed(id);
        let joint = self.joints.take(id);
        self.activity.joints_of.remove(id.index, &joint);
    }

    /// Iterates over all joints, by index.
    pub fn joint_ids(&self) -> impl Iterator<Item = JointId> {
        self.joints.ids()
    }

    /// Iterates over the joints of a body, by index.
    #[track_caller]
    pub fn joints_of(&self, body: BodyId) -> impl Iterator<Item = JointId> {
        self.expect(body);
        let id = |&index: &u32| self.joints.id(index);
        self.activity.joints_of.body(body.index).iter().map(id)
    }

    /// True if the id names an existing joint.
    pub fn contains_joint(&self, id: JointId) -> bool {
        self.joints.get(id).is_some()
    }

    /// Returns body A and body B of a joint.
    #[track_caller]
    pub fn joint_bodies(&self, id: JointId) -> (BodyId, BodyId) {
        let joint = self.expect_joint(id);
        let id = |index| self.bodies.id(index);
        (id(joint.a), id(joint.b))
    }

    /// Returns the current definition of a joint.
    #[track_caller]
    pub fn joint(&self, id: JointId) -> JointDef {
        let joint = self.expect_joint(id);
        let (body_a, body_b) = self.joint_bodies(id);
        let from_principal = |body: BodyId| self.expect(body).principal_from_body.inverse();
        JointDef {
            body_a,
            body_b,
            frame_a: from_principal(body_a) * joint.frame_a,
            frame_b: from_principal(body_b) * joint.frame_b,
            kind: joint.kind,
            weld: joint.drive.weld,
            limit_softness: joint.drive.limit_softness,
            soft_zone: joint.drive.soft_zone,
            spring: joint.drive.spring,
            motor: joint.drive.motor,
            friction_torque: joint.drive.friction,
            strength: joint.strength,
            collision: joint.collision,
            state: joint.state,
        }
    }

    /// Replaces the definition of a joint; both bodies wake.
    ///
    /// # Panics
    /// If the definition names other bodies, or a number is not valid.
    #[track_caller]
    pub fn set_joint(&mut self, id: JointId, def: &JointDef) {
        assert!(self.joint_bodies(id) == (def.body_a, def.body_b), "a joint keeps its bodies ({id:?})");
        let from_body = |body: BodyId| self.expect(body).principal_from_body;
        let (a, b) = (from_body(def.body_a), from_body(def.body_b));
        self.expect_joint_mut(id).redefine(def, a, b);
        self.joint_changed(id);
    }

    /// Sets or removes a joint's motor; both bodies wake if the motor changes. Cheap enough for every step.
    ///
    /// # Panics
    /// If a number is not valid.
    #[track_caller]
    pub fn set_motor(&mut self, id: JointId, motor: Option<Motor>) {
        assert!(
            motor.is_none_or(|motor| motor.is_valid()),
            "a motor's numbers are finite, as in {motor:?} ({id:?})"
        );
        if self.expect_joint(id).drive.motor != motor {
            self.expect_joint_mut(id).set_motor(motor);
            self.wake_joint(id);
        }
    }

    /// Sets a joint's friction, N·m ([`JointDef::friction_torque`]); both bodies wake if the friction changes. Cheap
    /// enough for every step.
    ///
    /// # Panics
    /// If the friction is negative or not finite.
    #[track_caller]
    pub fn set_joint_friction(&mut self, id: JointId, torque: f32) {
        assert!(
            (0.0..f32::INFINITY).contains(&torque),
            "friction is not negative, and finite, not {torque:?} ({id:?})"
        );
        if self.expect_joint(id).drive.friction != torque {
            self.expect_joint_mut(id).drive.friction = torque;
            self.wake_joint(id);
        }
    }

    /// Enables or disables a joint; both bodies wake. A broken joint that is enabled acts again, from its current gap.
    #[track_caller]
    pub fn set_joint_state(&mut self, id: JointId, state: JointState) {
        self.expect_joint_mut(id).state = state;
        self.joint_changed(id);
    }

    /// Mean force and torque of a joint on body B during the last step, world axes.
    #[track_caller]
    pub fn reaction(&self, id: JointId) -> Reaction {
        let reaction = self.expect_joint(id).reaction;
        Reaction { force: linear(&reaction), torque: angular(&reaction) }
    }

    fn joint_pose(&self, joint: &Joint) -> JointPose {
        let pose = |index| &self.bodies.at(index).world_from_principal;
        JointPose::new(&joint.geometry(), pose(joint.a), pose(joint.b))
    }

    /// Pose of frame B of a joint in its frame A: it gives the angles and the travel.
    #[track_caller]
    pub fn joint_transform(&self, id: JointId) -> Transform {
        self.joint_pose(self.expect_joint(id)).a_from_b()
    }

    /// Distance of the joint's anchors from their allowed range, metres; for a ball joint the distance between the two
    /// anchors.
    #[track_caller]
    pub fn joint_gap(&self, id: JointId) -> f32 {
        let joint = self.expect_joint(id);
        anchor_gap(&joint.kind, &self.joint_pose(joint))
    }

    /// Angle by which the joint exceeds its rotation limits, radians; 0 within them.
    #[track_caller]
    pub fn joint_overshoot(&self, id: JointId) -> f32 {
        let joint = self.expect_joint(id);
        overshoot(&joint.kind, &self.joint_pose(joint))
    }

    /// Potential energy of a joint's spring, its weld, and its soft limits with given stiffness, J. For a spring
    /// defined by its frequency the energy is known from the first step on.
    #[track_caller]
    pub fn joint_energy(&self, id: JointId) -> f32 {
        let joint = self.expect_joint(id);
        if joint.is_enabled() { joint.elastic_energy(&self.joint_pose(joint)) } else { 0.0 }
    }

    #[track_caller]
    fn expect_joint(&self, id: JointId) -> &Joint {
        self.joints.expect(id)
    }

    #[track_caller]
    fn expect_joint_mut(&mut self, id: JointId) -> &mut Joint {
        self.joints.expect_mut(id)
    }

    #[track_caller]
    fn wake_joint(&mut self, id: JointId) {
        let &Joint { a, b, .. } = self.expect_joint(id);
        self.wake_body(a);
        self.wake_body(b);
    }

    #[track_caller]
    fn joint_changed(&mut self, id: JointId) {
        self.wake_joint(id);
        self.parted.invalidate();
    }
}
