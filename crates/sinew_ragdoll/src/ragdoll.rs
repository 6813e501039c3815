//! A ragdoll in a world: its bodies and joints.
//!
//! ```
//! # let rig = sinew::mannequin::mannequin().rig;
//! # let analysis = sinew_anim::analyze(&rig)?;
//! # let (def, _) = sinew_ragdoll::build(&rig, &analysis, &sinew_ragdoll::BuildOptions::default())?;
//! use sinew_physics::{BodyDef, Shape, Velocity, World, WorldDef};
//! use sinew_ragdoll::{BodyState, BodySettings, Ragdoll};
//!
//! let mut world = World::new(WorldDef::default());
//! world.add_body(&BodyDef::fixed(Shape::HalfSpace));
//! let start: Vec<BodyState> = def
//!     .bodies
//!     .iter()
//!     .map(|body| BodyState { world_from_body: body.character_from_body, velocity: Velocity::default() })
//!     .collect();
//! let ragdoll = Ragdoll::spawn(&mut world, &def, &start, &BodySettings::default());
//! (0..120).for_each(|_| world.step());
//! let mut poses = Vec::new();
//! ragdoll.poses(&world, &mut poses);
//! assert!(poses[0].translation.y < 0.5 * start[0].world_from_body.translation.y, "it lies");
//! ragdoll.despawn(&mut world);
//! assert_eq!(world.body_ids().count(), 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::def::{RagdollBodyDef, RagdollDef, RagdollJointDef};
use crate::owner::{OwnerKind, owner};
use crate::tuning::TOLERATED;
use crate::tuning::WIDEST_SPAWNED;
use sinew_math::limits::hinge_angle;
use sinew_math::{Range, Rotation, SwingTwistLimit, Transform, Vec3, clamp, max, min};
use sinew_physics::{
    BodyDef, BodyId, BodyKind, ContactRule, Filter, JointDef, JointId, JointKind, Material, Quality,
    ShapeDef, ShapeId, Velocity, World,
};

/// State in which a body starts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyState {
    /// Pose of the body's frame in the world.
    pub world_from_body: Transform,
    /// Velocity of the body's centre of mass, and angular velocity; world axes.
    pub velocity: Velocity,
}

/// Properties that the bodies of a ragdoll have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodySettings {
    /// Surface. Default: friction 0.7, no bounce, and a rolling resistance of 2 cm; without it round limbs roll
    /// forever.
    pub material: Material,
    /// Collision filter of the bodies. Default: the bodies collide with everything, and with each other except for the
    /// definition's disabled pairs.
    pub filter: Filter,
    /// Share of the spin lost per second, 1/s, as in soft tissue. Default 0.05.
    pub angular_damping: f32,
    /// Step quality for the ragdoll's island. Default `None`: the world's setting.
    pub quality: Option<Quality>,
}

impl Default for BodySettings {
    fn default() -> Self {
        Self {
            material: Material { friction: 0.7, rolling: 0.02, ..Material::DEFAULT },
            filter: Filter::default(),
            angular_damping: 0.05,
            quality: None,
        }
    }
}

/// A ragdoll in a world.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ragdoll {
    /// Bodies, in the order of the definition.
    pub bodies: Vec<BodyId>,
    /// Joints, in the order of the definition.
    pub joints: Vec<JointId>,
    /// Pairs of the ragdoll's own bodies that collide: all pairs except those excluded by a joint, the definition or
    /// the starting pose.
    pub colliding: Vec<(BodyId, BodyId)>,
    /// Severed bodies, by index, ascending. They and the joints above them keep their list positions but no longer
    /// belong to the ragdoll.
    pub lost: Vec<usize>,
}

impl Ragdoll {
    /// Adds a ragdoll to the world with these `states` (one per body).
    ///
    /// An animated pose need not satisfy the ragdoll's joints: it may bend a knee sideways, pull a bone out or exceed a
    /// limit, and its limbs may overlap. A correction by force would add energy. Therefore the joints of this instance
    /// are adapted to the pose ([`fitted`]), and pairs of bodies that overlap in the pose do not collide.
    ///
    /// # Panics
    /// If there is not one finite state per body.
    pub fn spawn(
        world: &mut World,
        def: &RagdollDef,
        states: &[BodyState],
        body_settings: &BodySettings,
    ) -> Self {
        assert_eq!(states.len(), def.bodies.len(), "every body has a state");
        let bodies: Vec<BodyId> = def
            .bodies
            .iter()
            .zip(states)
            .enumerate()
            .map(|(index, (body, state))| world.add_body(&body_def(body, state, body_settings, index)))
            .collect();
        for &(a, b) in &def.disabled_pairs {
            world.disable_pair(bodies[a], bodies[b]);
        }
        let ragdoll = Self::jointed(world, def, bodies, states, Vec::new());
        ragdoll.own(world, def, OwnerKind::Ragdoll);
        ragdoll
    }

    /// Adds only the bodies to the world, kinematic and without joints, as hit targets for a character moved by its
    /// clips; `rule` limits how hard the bodies push. [`wake`](Self::wake) turns them into a ragdoll.
    ///
    /// # Panics
    /// As [`spawn`](Self::spawn).
    pub fn spawn_kinematic(
        world: &mut World,
        def: &RagdollDef,
        states: &[BodyState],
        body_settings: &BodySettings,
        rule: ContactRule,
    ) -> Vec<BodyId> {
        Self::spawn_kinematic_without(world, def, states, body_settings, rule, &[])
    }

    /// Like [`spawn_kinematic`](Self::spawn_kinematic), but without the bodies in `gone`, which contains their indices
    /// and placeholder ids.
    pub(crate) fn spawn_kinematic_without(
        world: &mut World,
        def: &RagdollDef,
        states: &[BodyState],
        body_settings: &BodySettings,
        rule: ContactRule,
        gone: &[(usize, BodyId)],
    ) -> Vec<BodyId> {
        assert_eq!(states.len(), def.bodies.len(), "every body has a state");
        let mut bodies = Vec::with_capacity(states.len());
        let is_gone = |index: usize| gone.iter().find(|&&(lost, _)| lost == index);
        for (index, (body, state)) in def.bodies.iter().zip(states).enumerate() {
            if let Some(&(_, id)) = is_gone(index) {
                bodies.push(id);
                continue;
            }
            let mut body = body_def(body, state, body_settings, index);
            body.shapes.iter_mut().for_each(|shape| shape.rule = rule);
            let id = world.add_body(&body);
            world.set_kind(id, BodyKind::Kinematic);
            bodies.push(id);
        }
        for &(a, b) in &def.disabled_pairs {
            if is_gone(a).is_none() && is_gone(b).is_none() {
                world.disable_pair(bodies[a], bodies[b]);
            }
        }
        bodies
    }

    /// Turns bodies added by [`spawn_kinematic`](Self::spawn_kinematic) into a ragdoll, as [`spawn`](Self::spawn) does
    /// with new ones; their ids do not change.
    ///
    /// # Panics
    /// If there is not one existing body and one finite state per body of the definition.
    pub fn wake(
        world: &mut World,
        def: &RagdollDef,
        bodies: &[BodyId],
        states: &[BodyState],
        rule: ContactRule,
    ) -> Self {
        assert_eq!([states.len(), bodies.len()], [def.bodies.len(); 2], "every body has a state");
        let ragdoll = Self::wake_without(world, def, bodies, states, &[]);
        ragdoll.own(world, def, OwnerKind::Ragdoll);
        ragdoll.set_rule(world, rule);
        ragdoll
    }

    /// Like [`wake`](Self::wake), but only for the bodies that are not detached; sets neither contact rule nor owner.
    pub(crate) fn wake_without(
        world: &mut World,
        def: &RagdollDef,
        bodies: &[BodyId],
        states: &[BodyState],
        lost: &[usize],
    ) -> Self {
        for (index, (&body, state)) in bodies.iter().zip(states).enumerate() {
            if !lost.contains(&index) {
                world.set_kind(body, BodyKind::Dynamic);
                world.set_transform(body, state.world_from_body);
                world.set_velocity(body, state.velocity);
            }
        }
        for (a, b) in colliding_pairs(def) {
            if !lost.contains(&a) && !lost.contains(&b) {
                world.enable_pair(bodies[a], bodies[b]);
            }
        }
        Self::jointed(world, def, bodies.to_vec(), states, lost.to_vec())
    }

    /// Adds all bodies except those in `gone` to the world, with their joints; `gone` contains the indices and
    /// placeholder ids of the others.
    pub(crate) fn spawn_without(
        world: &mut World,
        def: &RagdollDef,
        states: &[BodyState],
        body_settings: &BodySettings,
        gone: &[(usize, BodyId)],
    ) -> Self {
        let mut bodies = Vec::with_capacity(states.len());
        for (index, (body, state)) in def.bodies.iter().zip(states).enumerate() {
            let lost = gone.iter().find(|(lost, _)| *lost == index);
            bodies.push(match lost {
                Some(&(_, id)) => id,
                None => world.add_body(&body_def(body, state, body_settings, index)),
            });
        }
        let lost: Vec<usize> = gone.iter().map(|&(index, _)| index).collect();
        for &(a, b) in &def.disabled_pairs {
            if !lost.contains(&a) && !lost.contains(&b) {
                world.disable_pair(bodies[a], bodies[b]);
            }
        }
        Self::jointed(world, def, bodies, states, lost)
    }

    /// Marks bodies and joints as owned by a ragdoll or its owner, so that no other call removes them.
    pub(crate) fn own(&self, world: &mut World, def: &RagdollDef, kind: OwnerKind) {
        let owner = owner(def, kind);
        let (parts, bodies): (Vec<usize>, Vec<BodyId>) = self.own_bodies().unzip();
        world.own_bodies(&owner, &bodies, &parts);
        let (parts, joints): (Vec<usize>, Vec<JointId>) = self.own_joints().unzip();
        world.own_joints(&owner, &joints, &parts);
    }

    /// Returns the attached bodies, with their indices.
    pub fn own_bodies(&self) -> impl Iterator<Item = (usize, BodyId)> {
        self.bodies.iter().copied().enumerate().filter(|(index, _)| !self.lost.contains(index))
    }

    /// Returns the joints of attached bodies, with the indices of these bodies.
    pub fn own_joints(&self) -> impl Iterator<Item = (usize, JointId)> {
        let children = self.joints.iter().enumerate().map(|(index, &joint)| (index + 1, joint));
        children.filter(|(child, _)| !self.lost.contains(child))
    }

    /// Removes the joints and leaves the bodies in the world, kinematic: the reverse of [`wake`](Self::wake).
    ///
    /// # Panics
    /// If a body no longer exists.
    pub fn lull(self, world: &mut World, rule: ContactRule) {
        for (_, joint) in self.own_joints() {
            world.disown_joint(joint);
            world.remove_joint(joint);
        }
        for (_, body) in self.own_bodies() {
            world.set_kind(body, BodyKind::Kinematic);
        }
        self.set_rule(world, rule);
    }

    /// Sets the contact rule of the bodies.
    pub(crate) fn set_rule(&self, world: &mut World, rule: ContactRule) {
        for (_, body) in self.own_bodies() {
            world.set_contact_rule(ShapeId { body, shape: 0 }, rule);
        }
    }

    /// Adds the joints between existing bodies; overlapping pairs do not collide.
    fn jointed(
        world: &mut World,
        def: &RagdollDef,
        bodies: Vec<BodyId>,
        states: &[BodyState],
        lost: Vec<usize>,
    ) -> Self {
        let pose = |body: usize| states[body].world_from_body;
        let joint = |joint: &RagdollJointDef| {
            if lost.contains(&joint.child) || lost.contains(&joint.parent) {
                return JointId::from_bits(u64::MAX);
            }
            let fitted = fitted(joint, pose(joint.parent), pose(joint.child));
            world.add_joint(&joint_def(&fitted, &bodies))
        };
        let joints: Vec<JointId> = def.joints.iter().map(joint).collect();
        let mut colliding = Vec::new();
        for (a, b) in colliding_pairs(def) {
            if lost.contains(&a) || lost.contains(&b) {
                continue;
            }
            let (a, b) = (bodies[a], bodies[b]);
            if world.overlap(a, b) > TOLERATED {
                world.disable_pair(a, b);
            } else {
                colliding.push((a, b));
            }
        }
        Self { bodies, joints, colliding, lost }
    }

    /// Sets the step quality of all bodies of the ragdoll from the next step on: lower for distant ragdolls, higher for
    /// filmed ones; `None`: the world's setting. A body in contact with the ragdoll uses the higher of both qualities.
    ///
    /// # Panics
    /// If a body no longer exists.
    pub fn set_quality(&self, world: &mut World, quality: Option<Quality>) {
        self.own_bodies().for_each(|(_, body)| world.set_quality(body, quality));
    }

    /// Removes the ragdoll from the world.
    ///
    /// # Panics
    /// If a body no longer exists.
    pub fn despawn(self, world: &mut World) {
        for (_, body) in self.own_bodies() {
            world.disown_body(body);
            world.remove_body(body);
        }
    }

    /// Writes the poses of the bodies into `poses`, which is cleared first. A severed body gets the pose of the first
    /// body, the pelvis.
    pub fn poses(&self, world: &World, poses: &mut Vec<Transform>) {
        poses.clear();
        let is_own = |index: usize| !self.lost.contains(&index);
        let own = self
            .bodies
            .iter()
            .enumerate()
            .map(|(index, &body)| if is_own(index) { body } else { self.bodies[0] });
        poses.extend(own.map(|body| world.transform(body)));
    }
}

/// Returns the pairs of bodies, by index, that neither a joint nor the definition excludes from collision.
pub fn colliding_pairs(def: &RagdollDef) -> Vec<(usize, usize)> {
    let same = |pair: (usize, usize), a, b| pair == (a, b) || pair == (b, a);
    let mut pairs = Vec::new();
    for a in 0..def.bodies.len() {
        for b in a + 1..def.bodies.len() {
            let jointed = def.joints.iter().any(|joint| same((joint.parent, joint.child), a, b));
            if !jointed && !def.disabled_pairs.iter().any(|&pair| same(pair, a, b)) {
                pairs.push((a, b));
            }
        }
    }
    pairs
}

pub(crate) fn body_def(
    body: &RagdollBodyDef,
    state: &BodyState,
    body_settings: &BodySettings,
    index: usize,
) -> BodyDef {
    let shape = ShapeDef {
        material: body_settings.material,
        filter: body_settings.filter,
        ..ShapeDef::new(body.shape.clone())
    };
    BodyDef {
        position: state.world_from_body.translation,
        rotation: state.world_from_body.rotation,
        linear_velocity: state.velocity.linear,
        angular_velocity: state.velocity.angular,
        angular_damping: body_settings.angular_damping,
        shapes: vec![shape],
        mass: Some(body.mass),
        user_data: index as u64,
        quality: body_settings.quality,
        ..BodyDef::default()
    }
}

pub(crate) fn joint_def(joint: &RagdollJointDef, bodies: &[BodyId]) -> JointDef {
    let (parent, child) = (bodies[joint.parent], bodies[joint.child]);
    JointDef {
        friction_torque: joint.friction_torque,
        ..JointDef::between(parent, child, joint.frame_parent, joint.frame_child, joint.kind)
    }
}

/// Returns the joint adapted to two bodies in the given poses: the parent's anchor moves to the child's anchor, locked
/// rotations are taken from the pose, and limits that the pose exceeds are widened to it.
pub fn fitted(
    joint: &RagdollJointDef,
    world_from_parent: Transform,
    world_from_child: Transform,
) -> RagdollJointDef {
    let (parent, child) = (joint.frame_parent.rotation, joint.frame_child.rotation);
    let anchor = (world_from_child * joint.frame_child).translation;
    let seen = (world_from_parent.rotation * parent).inverse() * (world_from_child.rotation * child);
    let (swing, twist) = seen.swing_twist(Vec3::X);
    let (parent, child, kind) = match joint.kind {
        JointKind::Ball { limit } => {
            (parent, child, JointKind::Ball { limit: limit.map(|l| holding(l, seen)) })
        }
        JointKind::Hinge { limit } => {
            let limit = limit.map(|range| stretched(range, hinge_angle(twist)));
            (parent * swing, child, JointKind::Hinge { limit })
        }
        JointKind::Universal { limit } => (
            parent,
            child * twist.inverse(),
            JointKind::Universal { limit: limit.map(|l| holding(l, swing)) },
        ),
        JointKind::Fixed => (parent * seen, child, JointKind::Fixed),
        kind => unreachable!("a ragdoll has only joints that rotate or are fixed, not {kind:?}"),
    };
    let frame = |translation: Vec3, rotation: Rotation| Transform::new(translation, rotation.normalize());
    RagdollJointDef {
        frame_parent: frame(world_from_parent.inverse_point(anchor), parent),
        frame_child: frame(joint.frame_child.translation, child),
        kind,
        ..*joint
    }
}

/// Returns the limit, widened to include the rotation `seen`.
fn holding(limit: SwingTwistLimit, seen: Rotation) -> SwingTwistLimit {
    if limit.overshoot(seen) <= 0.0 {
        return limit;
    }
    let (swing, twist) = SwingTwistLimit::angles(seen);
    let middle = limit.twist.center();
    let twist = middle + sinew_math::limits::wrap(twist - middle);
    let wide = SwingTwistLimit {
        swing_y: stretched(limit.swing_y, swing.y),
        swing_z: stretched(limit.swing_z, swing.z),
        twist: stretched(limit.twist, twist),
    };
    // The limit now includes the rotation about each axis alone, but the ellipse between the axes may still exclude the
    // rotation.
    let angle = swing.length();
    let room = if angle > 1e-6 { wide.cone_angle(swing.y / angle, swing.z / angle) } else { angle };
    let factor = if room < angle { 1.001 * angle / room } else { 1.0 };
    let scaled = |range: Range| {
        Range::new(max(range.lo * factor, -WIDEST_SPAWNED), min(range.hi * factor, WIDEST_SPAWNED))
    };
    SwingTwistLimit { swing_y: scaled(wide.swing_y), swing_z: scaled(wide.swing_z), twist: wide.twist }
}

/// Returns the range, widened to include `angle`.
fn stretched(range: Range, angle: f32) -> Range {
    let angle = clamp(angle, -core::f32::consts::PI, core::f32::consts::PI);
    Range::new(min(range.lo, angle), max(range.hi, angle))
}
