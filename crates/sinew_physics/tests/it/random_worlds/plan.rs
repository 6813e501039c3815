//! A random world as plain data, so that a failing world can be shrunk and printed.

use sinew_math::{Range, Transform, Vec3};
use sinew_physics::*;

#[derive(Clone, Debug)]
pub struct WorldPlan {
    pub gravity: Vec3,
    pub sleeping: Sleeping,
    /// True if the world has a half-space at height 0.
    pub floor: bool,
    /// True if pairs that overlap at the start, or that a joint connects at any time, never collide. Contacts that
    /// separate overlapping bodies lift weights, which adds energy.
    pub parted: bool,
    /// True if nothing in the world releases energy except the test's own changes.
    pub passive: bool,
    pub bodies: Vec<BodyPlan>,
    pub joints: Vec<JointPlan>,
    /// Changes, each with the step before which it happens.
    pub changes: Vec<(u32, Change)>,
    /// Index of the step before which the world is saved.
    pub save_at: u32,
}

#[derive(Clone, Debug)]
pub struct BodyPlan {
    pub kind: BodyKind,
    pub shape: Shape,
    pub material: Material,
    pub mass: f32,
    pub pose: Transform,
    pub velocity: Velocity,
    pub collides: bool,
}

#[derive(Clone, Debug)]
pub struct JointPlan {
    /// Indices into the plan's bodies.
    pub a: usize,
    pub b: usize,
    /// Step before which the joint is created; 0 for joints of the initial world.
    pub born: u32,
    /// Frame of the joint in A; the frame in B agrees with it in the initial pose, except for distances.
    pub frame_a: Transform,
    /// Anchor of a distance joint in B's frame; the range and the rest length are in units of the initial distance.
    pub anchor_b: Vec3,
    pub kind: JointKind,
    pub weld: Option<Softness>,
    pub limit_softness: Option<Softness>,
    pub soft_zone: Option<SoftZone>,
    pub spring: Option<Spring>,
    pub motor: Option<Motor>,
    pub friction: f32,
    pub strength: Strength,
    pub collision: JointCollision,
}

/// Change of a running world. A change of an object that no longer exists has no effect.
#[derive(Clone, Debug)]
pub enum Change {
    RemoveJoint(usize),
    SetState(usize, JointState),
    /// Gives the joint another definition. Its bodies stay the same; its frames stay too, or start in the current pose.
    Redefine(usize, Box<JointPlan>, Frames),
    SetMotor(usize, Option<Motor>),
    RemoveBody(usize),
    /// Adds to the velocity of a body at its centre.
    Kick(usize, Velocity),
    /// Saves the world and loads it again in place.
    Reload,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Frames {
    Kept,
    Present,
}

impl Change {
    pub fn joint(&self) -> Option<usize> {
        match *self {
            Self::RemoveJoint(j) | Self::SetState(j, _) | Self::Redefine(j, ..) | Self::SetMotor(j, _) => {
                Some(j)
            }
            _ => None,
        }
    }

    fn joint_mut(&mut self) -> Option<&mut usize> {
        match self {
            Self::RemoveJoint(j) | Self::SetState(j, _) | Self::Redefine(j, ..) | Self::SetMotor(j, _) => {
                Some(j)
            }
            _ => None,
        }
    }

    fn body_mut(&mut self) -> Option<&mut usize> {
        match self {
            Self::RemoveBody(b) | Self::Kick(b, _) => Some(b),
            _ => None,
        }
    }
}

impl BodyPlan {
    pub fn def(&self) -> BodyDef {
        let mut shape = ShapeDef::new(self.shape.clone());
        shape.material = self.material;
        if !self.collides {
            shape.filter = Filter { layers: 0, mask: 0, group: 0 };
        }
        BodyDef {
            kind: self.kind,
            position: self.pose.translation,
            rotation: self.pose.rotation,
            linear_velocity: self.velocity.linear,
            angular_velocity: self.velocity.angular,
            shapes: vec![shape],
            mass: Some(self.shape.mass_properties(1000.0).scaled_to(self.mass)),
            ..BodyDef::default()
        }
    }
}

impl JointPlan {
    /// Returns the definition of this joint between two bodies in their current pose.
    pub fn def(&self, world: &World, a: BodyId, b: BodyId) -> JointDef {
        let world_from_joint = world.transform(a) * self.frame_a;
        let (a_pose, b_pose) = (world.transform(a), world.transform(b));
        let mut def = JointDef::new(a, b, a_pose, b_pose, world_from_joint, self.kind);
        let mut spring = self.spring;
        if let JointKind::Distance { range } = self.kind {
            def.frame_b.translation = self.anchor_b;
            let distance = (b_pose.point(self.anchor_b) - world_from_joint.translation).length();
            def.kind = JointKind::Distance { range: Range::new(range.lo * distance, range.hi * distance) };
            if let Some(spring) = &mut spring {
                spring.rest.translation.x *= distance;
            }
        }
        JointDef {
            weld: self.weld,
            limit_softness: self.limit_softness,
            soft_zone: self.soft_zone,
            spring,
            motor: self.motor,
            friction_torque: self.friction,
            strength: self.strength,
            collision: self.collision,
            ..def
        }
    }
}

impl WorldPlan {
    /// Returns the plan without a body and without all parts that refer to it.
    pub fn without_body(&self, body: usize) -> Self {
        let mut plan = self.clone();
        while let Some(j) = plan.joints.iter().position(|joint| joint.a == body || joint.b == body) {
            plan = plan.without_joint(j);
        }
        plan.bodies.remove(body);
        plan.changes.retain_mut(|(_, change)| change.body_mut().is_none_or(|b| *b != body));
        let bodies_of_joints = plan.joints.iter_mut().flat_map(|joint| [&mut joint.a, &mut joint.b]);
        let of_changes = plan.changes.iter_mut().filter_map(|(_, change)| change.body_mut());
        for b in bodies_of_joints.chain(of_changes).filter(|b| **b > body) {
            *b -= 1;
        }
        plan
    }

    /// Returns the plan without a joint and without all parts that refer to it.
    pub fn without_joint(&self, joint: usize) -> Self {
        let mut plan = self.clone();
        plan.joints.remove(joint);
        plan.changes.retain(|(_, change)| change.joint() != Some(joint));
        for (_, change) in &mut plan.changes {
            if let Some(j) = change.joint_mut().filter(|j| **j > joint) {
                *j -= 1;
            }
        }
        plan
    }
}
