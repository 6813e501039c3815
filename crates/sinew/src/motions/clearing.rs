//! Adapts motions to another body: lifts lying, kneeling and rolling parts out of the floor, and puts standing feet on
//! it.

use crate::anim::cleanup::raise;
use crate::anim::contact::FootContact;
use crate::anim::ik::{Pole, TwoBone, TwoBoneGoal, two_bone_ik};
use crate::anim::legs::{Foot, Legs};
use crate::anim::retarget::Retargeted;
use crate::anim::roles::HUMANOID_ROLES;
use crate::anim::{JointIdx, LocalTransform, RigAnalysis, Role, Side, local_to_model, smoothstep};
use crate::math::{Affine, Transform, Vec3, clamp, max, min};
use crate::ragdoll::CharacterDef;

/// Duration of raising and lowering the body, seconds at a human's pace.
const BLEND: f32 = 0.07;
/// Duration of lowering a foot to its standing position, seconds at a human's pace.
const TREAD: f32 = 0.1;
/// Largest distance by which a standing foot is lowered, in leg lengths.
const REACH: f32 = 0.3;
/// Number of halvings that find how far a foot can return to its position before the body was raised.
const HALVINGS: usize = 5;
/// Largest height of the skin above the floor to which shapes outside the skin raise the body, in heights of the
/// character.
const OUTSIDE: f32 = 0.035;
/// Largest height by which the body is raised, in heights of the character; deeper penetration remains.
const MOST: f32 = 0.3;

/// The bodies of a character, whose shapes determine how deep the character is in the floor.
pub(super) struct Clearing<'a> {
    def: &'a CharacterDef,
    root: Affine,
    legs: Legs,
    /// Height of the floor in the character's own axes, metres.
    floor: f32,
    /// Depth of each body in the floor in the bind pose, metres: shapes differ slightly from the skin.
    stands: Vec<f32>,
    /// Bodies for which the pelvis is raised when they are in the floor: the trunk, the head, thighs and shanks.
    trunk: Vec<usize>,
    /// Bodies of the feet, and of the legs above them, left and right.
    feet: [Vec<usize>; 2],
    shanks: [Vec<usize>; 2],
    arms: Vec<Arm>,
    /// Bodies whose rig parent differs from the body that carries them.
    props: Vec<Prop>,
}

/// An arm, and the bodies at its end.
struct Arm {
    limb: TwoBone,
    bodies: Vec<usize>,
}

/// A joint that moves with another, and its position in that joint's axes.
struct Prop {
    joint: JointIdx,
    carrier: JointIdx,
    at: Transform,
}

impl<'a> Clearing<'a> {
    /// Collects the bodies of a character by part; `None` without two complete legs.
    pub fn new(def: &'a CharacterDef, analysis: &RigAnalysis) -> Option<Self> {
        let bodies = &def.ragdoll.bodies;
        let places: Vec<Transform> = bodies.iter().map(|body| body.character_from_body).collect();
        let low = |body: usize| bodies[body].shape.aabb(&places[body]).min.y;
        let hanging_on = |top: JointIdx| -> Vec<usize> {
            (0..bodies.len()).filter(|&body| hangs(def, bodies[body].joint, top)).collect()
        };
        let foot = |side: Side| analysis.joint_with(Role::Foot(side)).map_or(Vec::new(), hanging_on);
        let shank = |side: Side| {
            let leg = [Role::UpperLeg(side), Role::LowerLeg(side)].map(Role::name);
            (0..bodies.len()).filter(|&body| leg.contains(&bodies[body].role)).collect()
        };
        let is_trunk = |body: &usize| {
            use Role::{Chest, Head, Hips, LowerLeg, Neck, Spine, UpperChest, UpperLeg};
            let role = Role::from_name(&bodies[*body].role);
            matches!(role, Some(Hips | Spine | Chest | UpperChest | Neck | Head | UpperLeg(_) | LowerLeg(_)))
        };
        let arm = |side: Side| {
            let [upper, lower] =
                [Role::UpperArm(side), Role::LowerArm(side)].map(|role| analysis.joint_with(role));
            let (upper, lower) = (upper?, lower?);
            let end = analysis.joint_with(Role::Hand(side)).or_else(|| tip(def, analysis, lower))?;
            let is_chain = hangs(def, lower, upper) && hangs(def, end, lower);
            is_chain.then(|| Arm { limb: TwoBone { upper, lower, end }, bodies: hanging_on(lower) })
        };
        Some(Self {
            root: analysis.character_from_file(),
            legs: Legs::of(&def.rig, analysis)?,
            floor: analysis.floor,
            stands: (0..bodies.len()).map(|body| max(-low(body), 0.0)).collect(),
            trunk: (0..bodies.len()).filter(is_trunk).collect(),
            feet: [Side::Left, Side::Right].map(foot),
            shanks: [Side::Left, Side::Right].map(shank),
            arms: [Side::Left, Side::Right].into_iter().filter_map(arm).collect(),
            props: props(def, analysis),
            def,
        })
    }

    /// Corrects a motion: moves props with the joints that carry them, raises the body where its trunk, head or legs
    /// are in the floor, puts the feet on the floor, and raises the hands.
    pub fn clear(&self, fitted: &mut Retargeted) {
        let (def, most) = (self.def, MOST * self.def.ragdoll.height);
        let mut model = Vec::new();
        let (mut depths, mut ankles) = (Vec::new(), Vec::new());
        for frame in 0..fitted.take.frames() {
            let pose = fitted.take.pose_mut(frame);
            self.bring_props(pose, &mut model);
            let shapes = self.depth(&self.trunk, pose);
            let skin = def.trunk_depth(pose).map(|skin| max(skin, 0.0) + OUTSIDE * def.ragdoll.height);
            depths.push(clamp(min(shapes, skin.unwrap_or(shapes)), 0.0, most));
            local_to_model(&def.rig, pose, &self.root, &mut model);
            ankles.push(self.legs.feet.each_ref().map(|foot| model[foot.leg.end].to_rigid()));
        }
        raise(&def.rig, &self.root, &self.legs, &depths, BLEND * fitted.pace, &mut fitted.take);
        for (frame, ankles) in ankles.iter().enumerate() {
            let time = fitted.take.time(frame);
            let pose = fitted.take.pose_mut(frame);
            // Legs without knees cannot reach down to the floor, so they move with the raised body.
            let legs = if self.legs.are_stiff(&def.rig) { 0 } else { 2 };
            for (k, foot) in self.legs.feet.iter().enumerate().take(legs) {
                let stands = standing(&fitted.contacts, foot.side, time, TREAD * fitted.pace);
                self.tread(k, ankles[k], stands, pose, &mut model);
            }
            for arm in &self.arms {
                let depth = max(self.depth(&arm.bodies, pose), 0.0);
                if depth > 0.0 {
                    local_to_model(&def.rig, pose, &self.root, &mut model);
                    let side = model[arm.limb.lower].translation - model[arm.limb.end].translation;
                    let target = model[arm.limb.end].translation + Vec3::Y * depth;
                    let goal = TwoBoneGoal::at(target, Pole::Keep(side));
                    two_bone_ik(&def.rig, arm.limb, &goal, pose, &mut model);
                }
            }
            self.bring_props(pose, &mut model);
        }
    }

    /// Moves a foot back to its position before the body was raised, then by the share `stands` onto the floor, or out
    /// of it.
    fn tread(
        &self,
        k: usize,
        was: Transform,
        stands: f32,
        pose: &mut [LocalTransform],
        model: &mut Vec<Affine>,
    ) {
        let (rig, foot) = (&self.def.rig, &self.legs.feet[k]);
        local_to_model(rig, pose, &self.root, model);
        let raised = model[foot.leg.end].translation;
        if was.translation != raised {
            self.put_back(k, (was, raised), stands, pose, model);
        }
        let shape = -self.depth(&self.feet[k], pose);
        local_to_model(rig, pose, &self.root, model);
        let sole = foot.points(model).iter().fold(f32::INFINITY, |low, point| min(low, point.y)) - self.floor;
        let reach = REACH * foot.length;
        let off = if shape < 0.0 { shape } else { min(min(shape, max(sole, 0.0)), reach) * stands };
        if off != 0.0 {
            let ankle = model[foot.leg.end].to_rigid();
            let on_floor = Transform::new(ankle.translation - Vec3::Y * off, ankle.rotation);
            self.put(foot, on_floor, pose, model);
        }
    }

    /// Moves a foot from its position after the body was `raised` back to where it `was`, by the share `least` at least,
    /// and farther while the leg above it stays out of the floor: a raised pelvis leaves its feet on the floor.
    fn put_back(
        &self,
        k: usize,
        (was, raised): (Transform, Vec3),
        least: f32,
        pose: &mut [LocalTransform],
        model: &mut [Affine],
    ) {
        let foot = &self.legs.feet[k];
        let most = max(self.depth(&self.shanks[k], pose), 0.0);
        let at = |share: f32| Transform::new(raised + (was.translation - raised) * share, was.rotation);
        let (mut good, mut tried, mut bad) = (least, 1.0, 1.0);
        for _ in 0..HALVINGS {
            self.put(foot, at(tried), pose, model);
            let is_out = self.depth(&self.shanks[k], pose) <= most;
            (good, bad) = if is_out { (tried, bad) } else { (good, tried) };
            tried = 0.5 * (good + bad);
        }
        self.put(foot, at(good), pose, model);
    }

    fn put(&self, foot: &Foot, ankle: Transform, pose: &mut [LocalTransform], model: &mut [Affine]) {
        let side = model[foot.leg.upper].to_rigid().rotation * foot.forward;
        let goal = TwoBoneGoal::at(ankle.translation, Pole::Keep(side));
        two_bone_ik(&self.def.rig, foot.leg, &goal, pose, model);
        self.legs.plant(&self.def.rig, foot, ankle.rotation, pose, model);
    }

    fn bring_props(&self, pose: &mut [LocalTransform], model: &mut Vec<Affine>) {
        for prop in &self.props {
            local_to_model(&self.def.rig, pose, &Affine::IDENTITY, model);
            let parent = self.def.rig.joints[prop.joint].parent.map_or(Affine::IDENTITY, |p| model[p]);
            // Uses a rigid transform, because the scale of a pose may differ from the bind pose's.
            let place = model[prop.carrier].to_rigid() * prop.at;
            let translation = parent.inverse().point(place.translation);
            if translation.is_finite() {
                pose[prop.joint].translation = translation;
                pose[prop.joint].rotation = parent.to_rigid().rotation.inverse() * place.rotation;
            }
        }
    }

    /// Returns the largest depth of `bodies` in the floor beyond their depth in the bind pose, metres; negative above
    /// the floor, −∞ without bodies.
    fn depth(&self, bodies: &[usize], pose: &[LocalTransform]) -> f32 {
        let (mut model, mut places) = (Vec::new(), Vec::new());
        local_to_model(&self.def.rig, pose, &Affine::IDENTITY, &mut model);
        self.def.mapping().bodies_from_model(&model, Transform::IDENTITY, &mut places);
        let under = |&body: &usize| {
            -self.def.ragdoll.bodies[body].shape.aabb(&places[body]).min.y - self.stands[body]
        };
        bodies.iter().map(under).fold(f32::NEG_INFINITY, max)
    }
}

/// Standing weight of a foot at a time, 0 to 1, which blends over `blend` seconds at both ends of a contact.
fn standing(contacts: &[FootContact], side: Side, time: f32, blend: f32) -> f32 {
    let own = contacts.iter().filter(|contact| contact.foot == side);
    let share = own.map(|contact| {
        let away = max(max(contact.start - time, time - contact.end), 0.0);
        smoothstep(clamp(1.0 - away / blend, 0.0, 1.0))
    });
    share.fold(0.0, max)
}

/// Bodies without a humanoid role whose rig joint is not a descendant of the parent body's joint.
fn props(def: &CharacterDef, analysis: &RigAnalysis) -> Vec<Prop> {
    let bodies = &def.ragdoll.bodies;
    let strays = def.ragdoll.joints.iter().filter(|joint| {
        let (parent, child) = (&bodies[joint.parent], &bodies[joint.child]);
        Role::from_name(&child.role).is_none_or(|role| !HUMANOID_ROLES.contains(&role))
            && !hangs(def, child.joint, parent.joint)
    });
    let prop = |(joint, carrier): (JointIdx, JointIdx)| Prop {
        joint,
        carrier,
        at: analysis.bind_model[carrier].to_rigid().inverse() * analysis.bind_model[joint].to_rigid(),
    };
    strays.map(|joint| prop((bodies[joint.child].joint, bodies[joint.parent].joint))).collect()
}

/// The descendant of a joint that is farthest from it in the bind pose; `None` if it has none.
fn tip(def: &CharacterDef, analysis: &RigAnalysis, top: JointIdx) -> Option<JointIdx> {
    let place = |joint: JointIdx| analysis.bind_model[joint].translation;
    let away = |joint: &JointIdx| (place(*joint) - place(top)).length();
    let hanging = (0..def.rig.joints.len()).filter(|&joint| hangs(def, joint, top));
    hanging.max_by(|a, b| away(a).total_cmp(&away(b))).filter(|&joint| joint != top)
}

/// True if `joint` is `top` or its descendant.
fn hangs(def: &CharacterDef, joint: JointIdx, top: JointIdx) -> bool {
    core::iter::successors(Some(joint), |&i| def.rig.joints[i].parent).any(|i| i == top)
}
