//! Keeps the skin out of the floor during transitions from bodies to a clip and between clips. Each joint blends on its
//! own, so feet, hands and knees would pass through the floor although both poses are above it.
//!
//! The allowed depth of each part changes gradually from its depth at the start of the transition to its depth in the
//! clip. Parts that are deeper are raised: for trunk and knees the whole body moves up, for a foot or a hand its limb
//! bends, and for an elbow the upper arm rotates.

use super::stumble::level;
use super::{CharacterDef, State};
use crate::character::tuning::{
    ARMS_ASIDE, LIMB_SOFTNESS, LIMBS_SINK, MOST_LIFT, STEP_HEIGHT, STEP_OVER, STEPS_FROM, STRAIGHT_UP,
};
use crate::def::RagdollDef;
use crate::fit::surface::carried;
use crate::skin::surface::Surface;
use sinew_anim::ik::{Pole, TwoBone, TwoBoneGoal, two_bone_ik};
use sinew_anim::roles::{HUMANOID_ROLES, Role, Side};
use sinew_anim::take::Take;
use sinew_anim::{JointIdx, LocalTransform, Rig, local_to_model, smoothstep};
use sinew_math::{Affine, Rotation, Transform, Vec3, max, min, trig};

/// Number of parts: the trunk with its knees, then feet, hands and elbows, the left one first.
pub(super) const PARTS: usize = 7;
const TRUNK: usize = 0;
/// Number of halvings of the angle by which a stiff arm is raised.
const HALVINGS: usize = 10;
/// Largest number of passes that raise trunk and limbs. One pass may not suffice, because raising a foot may press its
/// knee into the floor.
const MOST_PASSES: usize = 3;
pub(super) const FEET: [usize; 2] = [1, 2];
const HANDS: [usize; 2] = [3, 4];
/// Number of parts that are moved out of walls: the trunk, two feet and two hands.
pub(super) const MOVABLE: usize = 5;
const ELBOWS: [usize; 2] = [5, 6];

/// Depth of each part in the floor, metres; negative above the floor, −∞ for a missing part.
pub(super) type Depths = [f32; PARTS];

/// A transition of a character, with the depths that its parts may have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Passage {
    /// Depths at the start of the transition, at least 0.
    pub from: Depths,
    /// Largest depths in the target poses, at least 0.
    pub to: Depths,
    /// Transforms of the ankles at the start of the transition, world, left and right.
    pub ankles: [Transform; 2],
    /// Least horizontal distance, metres, from which the height of a foot's step is computed.
    pub far: [f32; 2],
    /// Seconds since the start of the transition.
    pub age: f32,
    pub seconds: f32,
    /// Smoothed height of the ground under each part over the floor of the clip, metres, and its rate of change, m/s.
    pub rises: Depths,
    pub rise_rates: Depths,
}

/// A stepping foot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// Ankle at the start of the step, character space.
    from: Transform,
    /// Least horizontal distance, metres, from which the height of the step is computed.
    far: f32,
    /// Share of the step's length that is done.
    along: f32,
    /// Height of the foot above the straight line between start and goal, as a share of the step's height.
    over: f32,
}

impl Passage {
    /// Returns the allowed depths in the floor of the clip after `later` seconds more.
    pub fn allowed(&self, later: f32) -> Depths {
        let share = if self.seconds > 0.0 { smoothstep((self.age + later) / self.seconds) } else { 1.0 };
        core::array::from_fn(|part| {
            let in_ground = self.from[part] + (self.to[part] - self.from[part]) * share;
            in_ground - (self.rises[part] + self.rise_rates[part] * later)
        })
    }

    /// Returns the steps of the feet after `later` seconds more: both feet step together while the character lies, and
    /// one after the other once it stands.
    pub fn steps(&self, later: f32, state: State, place: Transform) -> [Step; 2] {
        let u = if self.seconds > 0.0 { (self.age + later) / self.seconds } else { f32::INFINITY };
        [0, 1].map(|foot| {
            let own = if state == State::GettingUp { u } else { u - foot as f32 };
            let along = smoothstep((own - STRAIGHT_UP) / (1.0 - 2.0 * STRAIGHT_UP));
            let over = smoothstep(own / STRAIGHT_UP) * smoothstep((1.0 - own) / STRAIGHT_UP);
            Step { from: place.inverse() * self.ankles[foot], far: self.far[foot], along, over }
        })
    }

    /// Returns the share of the lift out of the floor that is applied after `later` seconds more; it decreases to zero
    /// after the transition.
    pub fn share(&self, later: f32, state: State) -> f32 {
        match state {
            State::GettingUp => 1.0,
            State::Animated if self.seconds > 0.0 => {
                1.0 - smoothstep((self.age + later) / self.seconds - 1.0)
            }
            _ => 0.0,
        }
    }
}

/// Joints of a leg or an arm whose end can be lifted.
#[derive(Clone, Copy, Debug)]
struct LimbChain {
    bones: TwoBone,
    /// Index of the part at the limb's end.
    end: usize,
    /// Index of the part at the limb's middle joint, if the limb raises that joint.
    middle: Option<usize>,
}

impl LimbChain {
    /// Returns the transform of an ankle that steps to `to`; `None` if the foot does not step.
    fn stepped(&self, to: Transform, steps: Option<[Step; 2]>, def: &CharacterDef) -> Option<Transform> {
        let foot = FEET.into_iter().position(|part| part == self.end)?;
        let Step { from, far, along, over } = steps?[foot];
        // A lying leg has no sole that could slide; lifting its foot would press the knee into the floor.
        let stands = from.rotation * (def.bind()[self.bones.end].to_rigid().rotation.inverse() * Vec3::Y);
        // A foot that has arrived is still raised until `over` is 0.
        let is_over = along >= 1.0 && over <= 0.0;
        if is_over || from == to || stands.y < STEPS_FROM {
            return None;
        }
        let way = to.translation - from.translation;
        let far = max(Vec3::new(way.x, 0.0, way.z).length(), far);
        let height = min(STEP_OVER * far, STEP_HEIGHT * def.ragdoll.height);
        let place = from.translation + way * along + Vec3::Y * (over * height);
        Some(Transform::new(place, from.rotation.nlerp(to.rotation, along)))
    }
}

/// An arm without an elbow: it is raised by a rotation about the shoulder.
#[derive(Clone, Copy, Debug)]
struct StiffArm {
    shoulder: JointIdx,
    /// Index of the arm's part, that of its hand.
    end: usize,
}

/// Candidates for the lowest points of the skin, and the limbs that raise them.
#[derive(Clone, Debug, Default)]
pub(super) struct Clearance {
    /// Skin of each part.
    parts: Vec<Surface>,
    limbs: Vec<LimbChain>,
    stiff_arms: Vec<StiffArm>,
    /// Joint of each hand, and the skin of the hand with the objects that it holds.
    hands: Vec<(JointIdx, Surface)>,
    /// Joints that must move with a limb although they are not its descendants in the rig, each with the joint that it
    /// follows.
    strays: Vec<(JointIdx, JointIdx)>,
}

impl Clearance {
    /// Collects the points of the drawn skin; `bind` is the bind pose in model space.
    pub fn of(rig: &Rig, def: &RagdollDef, bind: &[Affine]) -> Self {
        let surface = Surface::of(rig, def);
        if surface.sample.is_empty() {
            return Self::default();
        }
        let (limbs, stiff_arms) = (limbs(rig, def), stiff_arms(def));
        let mut palette = Vec::new();
        surface.palette(bind, &mut palette);
        let mut chosen: [Vec<usize>; PARTS] = Default::default();
        let mut held: [Vec<usize>; 2] = Default::default();
        for body in 0..def.bodies.len() {
            for (vertex, place) in outermost(&surface, body, &palette) {
                let part =
                    part_of_stiff(def, &stiff_arms, body).or_else(|| part_of(def, &limbs, bind, body, place));
                part.into_iter().for_each(|part| chosen[part].push(vertex));
                hand_of(def, body).into_iter().for_each(|hand| held[hand].push(vertex));
            }
        }
        let skin = |vertices: Vec<usize>| part_without_repeats(&surface, vertices);
        let joint = |hand: usize| {
            def.bodies.iter().find(|body| body.role == hand_roles()[hand].name()).map(|body| body.joint)
        };
        let hands =
            held.map(skin).into_iter().enumerate().filter_map(|(hand, own)| Some((joint(hand)?, own)));
        let (parts, hands) = (chosen.map(skin).into(), hands.collect());
        Self { parts, hands, strays: strays(rig, def), limbs, stiff_arms }
    }

    /// Returns true if no part has skin.
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Returns the joint of an ankle, left and right.
    pub fn ankle(&self, foot: usize) -> Option<JointIdx> {
        self.limbs.iter().find(|limb| limb.end == FEET[foot]).map(|limb| limb.bones.end)
    }

    /// Returns the outermost points of a part, in the space of `model`.
    pub fn places(&self, part: usize, model: &[Affine], palette: &mut Vec<Affine>) -> Vec<Vec3> {
        self.parts.get(part).map_or_else(Vec::new, |surface| surface.places(model, palette))
    }

    fn depth(&self, part: usize, model: &[Affine], palette: &mut Vec<Affine>) -> f32 {
        -self.places(part, model, palette).iter().map(|place| place.y).fold(f32::INFINITY, min)
    }

    /// Returns the depths of all parts in the pose `model`, which is in character space.
    pub fn depths(&self, model: &[Affine]) -> Depths {
        let mut palette = Vec::new();
        if self.parts.is_empty() {
            return [f32::NEG_INFINITY; PARTS];
        }
        core::array::from_fn(|part| self.depth(part, model, &mut palette))
    }

    /// Returns the largest depth of each part over all frames of a take, at least 0.
    pub fn deepest(&self, def: &CharacterDef, take: &Take) -> Depths {
        let (mut model, mut deepest) = (Vec::new(), [0.0; PARTS]);
        for frame in 0..take.frames() {
            local_to_model(&def.rig, take.pose(frame), &def.mapping().character_from_model(), &mut model);
            deepest = larger(deepest, self.depths(&model));
        }
        deepest
    }

    /// Raises the parts that are deeper than allowed, by `share` of the excess.
    pub fn clear(
        &self,
        def: &CharacterDef,
        allowed: &Depths,
        share: f32,
        steps: Option<[Step; 2]>,
        pose: &mut [LocalTransform],
        model: &mut Vec<Affine>,
    ) {
        let (rig, root) = (&def.rig, def.mapping().character_from_model());
        local_to_model(rig, pose, &root, model);
        let depths = self.depths(model);
        let most = MOST_LIFT * def.ragdoll.height;
        let lift = |depth: f32, part: usize| min(max(share * (depth - allowed[part]), 0.0), most);
        let lifts: Depths = core::array::from_fn(|part| lift(depths[part], part));
        let ends: Vec<Transform> = self.limbs.iter().map(|limb| model[limb.bones.end].to_rigid()).collect();
        let steps: Vec<Option<Transform>> =
            self.limbs.iter().zip(&ends).map(|(limb, &end)| limb.stepped(end, steps, def)).collect();
        if lifts.iter().all(|&lift| lift <= 0.0) && steps.iter().all(Option::is_none) {
            return;
        }
        let carried = self.carried(model);
        let mut palette = Vec::new();
        let mut trunk = lifts[TRUNK];
        for _ in 0..MOST_PASSES {
            if trunk > 0.0 {
                let up = Transform::new(Vec3::Y * trunk, Rotation::IDENTITY);
                def.mapping().reframe(pose, up, Transform::IDENTITY);
                local_to_model(rig, pose, &root, model);
            }
            for ((limb, &was), &step) in self.limbs.iter().zip(&ends).zip(&steps) {
                if trunk > 0.0 || lifts[limb.end] > 0.0 || step.is_some() {
                    let raised =
                        Transform { translation: was.translation + Vec3::Y * lifts[limb.end], ..was };
                    put(rig, limb.bones, step.unwrap_or(raised), &root, pose, model);
                    let up = lift(self.depth(limb.end, model, &mut palette), limb.end);
                    if let Some(mut wanted) = step.filter(|_| up > 0.0) {
                        wanted.translation.y += up;
                        put(rig, limb.bones, wanted, &root, pose, model);
                    }
                }
                let Some(middle) = limb.middle else { continue };
                let up = lift(self.depth(middle, model, &mut palette), middle);
                raise_middle(rig, limb.bones, up, &root, pose, model);
            }
            for &arm in &self.stiff_arms {
                let up = lift(self.depth(arm.end, model, &mut palette), arm.end);
                self.raise_stiff(def, arm, up, pose, model);
            }
            // A raised foot presses its knee, which belongs to the trunk, into the floor.
            trunk = lift(self.depth(TRUNK, model, &mut palette), TRUNK);
            if trunk <= 0.0 {
                break;
            }
        }
        self.carry(def, &carried, 0..self.strays.len(), pose, model);
    }

    /// Rotates a stiff arm about its shoulder until its lowest point is `up` metres higher, but not beyond level.
    fn raise_stiff(
        &self,
        def: &CharacterDef,
        arm: StiffArm,
        up: f32,
        pose: &mut [LocalTransform],
        model: &mut Vec<Affine>,
    ) {
        let (rig, root) = (&def.rig, def.mapping().character_from_model());
        let shoulder = model[arm.shoulder].to_rigid();
        let from_shoulder = |place: Vec3| place - shoulder.translation;
        let points: Vec<Vec3> =
            self.places(arm.end, model, &mut Vec::new()).into_iter().map(from_shoulder).collect();
        let low = |turn: Rotation| points.iter().map(|&point| (turn * point).y).fold(f32::INFINITY, min);
        let middle = points.iter().fold(Vec3::ZERO, |sum, &point| sum + point);
        // An arm that hangs straight down turns away from the pelvis.
        let aside = from_shoulder(model[def.ragdoll.bodies[0].joint].translation) * -1.0;
        let away = level(middle.normalize_or_zero()) + level(aside.normalize_or_zero()) * ARMS_ASIDE;
        if up <= 0.0 || middle.y >= 0.0 {
            return;
        }
        let away = away.normalize_or(Vec3::X);
        let axis = Vec3::NEG_Y.cross(away);
        let target = low(Rotation::IDENTITY) + up;
        let (mut least, mut most) = (0.0, trig::atan2(-middle.y, middle.dot(away)));
        for _ in 0..HALVINGS {
            let angle = 0.5 * (least + most);
            let is_out = low(Rotation::from_axis_angle(axis, angle)) >= target;
            (least, most) = if is_out { (least, angle) } else { (angle, most) };
        }
        let turn = Rotation::from_axis_angle(axis, most);
        turn_to(rig, arm.shoulder, turn * shoulder.rotation, &root, pose, model);
    }

    /// Displaces the trunk and the ends of the limbs by `offsets`, in character space; the other ends keep their
    /// positions.
    pub fn shift(
        &self,
        def: &CharacterDef,
        offsets: [Vec3; MOVABLE],
        pose: &mut [LocalTransform],
        model: &mut Vec<Affine>,
    ) {
        let (rig, root) = (&def.rig, def.mapping().character_from_model());
        local_to_model(rig, pose, &root, model);
        let carried = self.carried(model);
        let ends: Vec<Transform> = self.limbs.iter().map(|limb| model[limb.bones.end].to_rigid()).collect();
        let trunk = offsets[TRUNK];
        if trunk != Vec3::ZERO {
            let way = Transform::new(trunk, Rotation::IDENTITY);
            def.mapping().reframe(pose, way, Transform::IDENTITY);
            local_to_model(rig, pose, &root, model);
        }
        for (limb, &was) in self.limbs.iter().zip(&ends) {
            let offset = offsets[limb.end];
            if trunk != Vec3::ZERO || offset != Vec3::ZERO {
                let end = Transform { translation: was.translation + offset, ..was };
                put(rig, limb.bones, end, &root, pose, model);
            }
        }
        self.carry(def, &carried, 0..self.strays.len(), pose, model);
    }

    /// Returns the transforms of the strays relative to their carriers.
    fn carried(&self, model: &[Affine]) -> Vec<Transform> {
        let at = |&(joint, carrier): &(JointIdx, JointIdx)| {
            model[carrier].to_rigid().inverse() * model[joint].to_rigid()
        };
        self.strays.iter().map(at).collect()
    }

    /// Moves the strays with these indices to the transforms `carried`, which are relative to their carriers.
    fn carry(
        &self,
        def: &CharacterDef,
        carried: &[Transform],
        strays: impl IntoIterator<Item = usize>,
        pose: &mut [LocalTransform],
        model: &mut Vec<Affine>,
    ) {
        let (rig, root) = (&def.rig, def.mapping().character_from_model());
        for stray in strays {
            let (joint, carrier) = self.strays[stray];
            let parent = rig.joints[joint].parent.map_or(root, |parent| model[parent]);
            let place = model[carrier].to_rigid() * carried[stray];
            let translation = parent.inverse().point(place.translation);
            if translation.is_finite() {
                pose[joint].translation = translation;
                pose[joint].rotation = (parent.to_rigid().rotation.inverse() * place.rotation).normalize();
                local_to_model(rig, pose, &root, model);
            }
        }
    }

    /// Returns the joint at the inner end of a part: a shoulder, a hip, or the pelvis.
    pub fn origin(&self, def: &RagdollDef, part: usize) -> Option<JointIdx> {
        match part {
            TRUNK => def.bodies.first().map(|pelvis| pelvis.joint),
            _ => {
                let chains = self.limbs.iter().map(|limb| (limb.end, limb.bones.upper));
                let stiff = self.stiff_arms.iter().map(|arm| (arm.end, arm.shoulder));
                chains.chain(stiff).find(|&(end, _)| end == part).map(|(_, upper)| upper)
            }
        }
    }

    /// Rotates hands about their wrists until the objects that they hold are at most `allowed` deep.
    fn turn_hands(
        &self,
        def: &CharacterDef,
        allowed: f32,
        pose: &mut [LocalTransform],
        model: &mut Vec<Affine>,
    ) {
        let (rig, root) = (&def.rig, def.mapping().character_from_model());
        local_to_model(rig, pose, &root, model);
        let carried = self.carried(model);
        let mut palette = Vec::new();
        for (hand, skin) in &self.hands {
            // The hand itself may be a stray of the forearm.
            let is_held =
                |&(joint, carrier): &(JointIdx, JointIdx)| joint != *hand && hangs(rig, carrier, *hand);
            let held: Vec<usize> =
                (0..self.strays.len()).filter(|&stray| is_held(&self.strays[stray])).collect();
            for _ in 0..MOST_PASSES {
                let places = skin.places(model, &mut palette);
                let lowest = places.into_iter().reduce(|a, b| if b.y < a.y { b } else { a });
                let wrist = model[*hand].to_rigid();
                let turn = lowest.and_then(|lowest| raised_about(wrist.translation, lowest, allowed));
                let Some(turn) = turn else { break };
                turn_to(rig, *hand, turn * wrist.rotation, &root, pose, model);
                self.carry(def, &carried, held.iter().copied(), pose, model);
            }
        }
    }
}

/// Returns, for each of a set of directions, the vertex of a body that is farthest along it, with its position. A
/// vertex may occur more than once.
pub(super) fn outermost(surface: &Surface, body: usize, palette: &[Affine]) -> Vec<(usize, Vec3)> {
    let own = surface.sample.iter().copied().filter(|&vertex| surface.owner(vertex) == Some(body));
    let places: Vec<(usize, Vec3)> = own.map(|vertex| (vertex, surface.place(palette, vertex))).collect();
    let farthest = |direction: Vec3| {
        let along = |place: &(usize, Vec3)| place.1.dot(direction);
        places.iter().copied().reduce(|a, b| if along(&b) > along(&a) { b } else { a })
    };
    directions().filter_map(farthest).collect()
}

/// Returns the part of a surface that consists of these vertices, without duplicates.
pub(super) fn part_without_repeats(surface: &Surface, mut vertices: Vec<usize>) -> Surface {
    vertices.sort_unstable();
    vertices.dedup();
    surface.part(&vertices)
}

/// Returns up to `most` of the points, each at least `apart` metres from the others; points with a larger `size` come
/// first.
pub(super) fn spread(mut left: Vec<Vec3>, apart: f32, most: usize, size: impl Fn(Vec3) -> f32) -> Vec<Vec3> {
    let mut chosen = Vec::new();
    while chosen.len() < most {
        let larger = |a: Vec3, b: Vec3| if size(b) > size(a) { b } else { a };
        let Some(largest) = left.iter().copied().reduce(larger) else { break };
        chosen.push(largest);
        left.retain(|&place| (place - largest).length_squared() > apart * apart);
    }
    chosen
}

/// Moves the end of a limb to a position in the space of `model`. Before the limb becomes straight, its end falls short
/// of the position, so that the middle joint does not snap.
fn put(
    rig: &Rig,
    bones: TwoBone,
    end: Transform,
    root: &Affine,
    pose: &mut [LocalTransform],
    model: &mut Vec<Affine>,
) {
    let [upper, lower, now] =
        [bones.upper, bones.lower, bones.end].map(|joint: JointIdx| model[joint].translation);
    let length = (lower - upper).length() + (now - lower).length();
    let softness = min((end.translation - now).length() / max(length, f32::MIN_POSITIVE), LIMB_SOFTNESS);
    let side = lower - (upper + end.translation) * 0.5;
    let goal = TwoBoneGoal { softness, ..TwoBoneGoal::at(end.translation, Pole::Keep(side)) };
    two_bone_ik(rig, bones, &goal, pose, model);
    turn_to(rig, bones.end, end.rotation, root, pose, model);
}

/// Returns the rotation about `wrist` that raises `lowest` to `allowed` metres below the floor; `None` if the point is
/// not deeper, or no rotation suffices.
fn raised_about(wrist: Vec3, lowest: Vec3, allowed: f32) -> Option<Rotation> {
    let arm = lowest - wrist;
    let (length, down) = (arm.length(), wrist.y + allowed);
    if lowest.y >= -allowed || down <= 0.0 {
        return None;
    }
    let level = Vec3::new(arm.x, 0.0, arm.z);
    let away = if level.length() > 1e-3 * length { level.normalize() } else { Vec3::X };
    let wanted = away * max(length * length - down * down, 0.0).sqrt() - Vec3::Y * down;
    Some(Rotation::from_arc(arm.normalize(), wanted.normalize()))
}

/// Rotates a limb about its upper joint until the middle joint is `up` metres higher, in the axes of `model`.
fn raise_middle(
    rig: &Rig,
    bones: TwoBone,
    up: f32,
    root: &Affine,
    pose: &mut [LocalTransform],
    model: &mut Vec<Affine>,
) {
    let bone = model[bones.lower].translation - model[bones.upper].translation;
    if up > 0.0 && bone.length() > 0.0 {
        let turned = Rotation::from_arc(bone.normalize(), (bone + Vec3::Y * up).normalize());
        let rotation = turned * model[bones.upper].to_rigid().rotation;
        turn_to(rig, bones.upper, rotation, root, pose, model);
    }
}

/// Sets a joint's rotation in the axes of `model`; its descendants rotate with it.
fn turn_to(
    rig: &Rig,
    joint: JointIdx,
    rotation: Rotation,
    root: &Affine,
    pose: &mut [LocalTransform],
    model: &mut Vec<Affine>,
) {
    let parent = rig.joints[joint].parent.map_or(*root, |parent| model[parent]);
    pose[joint].rotation = (parent.to_rigid().rotation.inverse() * rotation).normalize();
    local_to_model(rig, pose, root, model);
}

pub(super) fn larger(a: Depths, b: Depths) -> Depths {
    core::array::from_fn(|part| max(a[part], b[part]))
}

/// Returns legs and arms by the roles of the bodies; limbs that are not chains of three joints are skipped.
fn limbs(rig: &Rig, def: &RagdollDef) -> Vec<LimbChain> {
    let joint = |role: Role| def.bodies.iter().find(|body| body.role == role.name()).map(|body| body.joint);
    let hangs = |joint: JointIdx, above: JointIdx| {
        core::iter::successors(rig.joints[joint].parent, |&i| rig.joints[i].parent).any(|i| i == above)
    };
    let chain = |[upper, lower, end]: [Role; 3]| {
        let bones = TwoBone { upper: joint(upper)?, lower: joint(lower)?, end: joint(end)? };
        (hangs(bones.lower, bones.upper) && hangs(bones.end, bones.lower)).then_some(bones)
    };
    let mut limbs = Vec::new();
    for (k, side) in [Side::Left, Side::Right].into_iter().enumerate() {
        let leg = chain([Role::UpperLeg(side), Role::LowerLeg(side), Role::Foot(side)]);
        let arm = chain([Role::UpperArm(side), Role::LowerArm(side), Role::Hand(side)]);
        limbs.extend(leg.map(|bones| LimbChain { bones, end: FEET[k], middle: None }));
        limbs.extend(arm.map(|bones| LimbChain { bones, end: HANDS[k], middle: Some(ELBOWS[k]) }));
    }
    limbs
}

/// Returns the arms whose bodies have neither a lower arm nor a hand.
fn stiff_arms(def: &RagdollDef) -> Vec<StiffArm> {
    let joint = |role: Role| def.bodies.iter().find(|body| body.role == role.name()).map(|body| body.joint);
    let arm = |(k, side): (usize, Side)| {
        let is_stiff = joint(Role::LowerArm(side)).is_none() && joint(Role::Hand(side)).is_none();
        let shoulder = joint(Role::UpperArm(side)).filter(|_| is_stiff)?;
        Some(StiffArm { shoulder, end: HANDS[k] })
    };
    [Side::Left, Side::Right].into_iter().enumerate().filter_map(arm).collect()
}

/// Returns the part of the stiff arm that a body is or that carries the body.
fn part_of_stiff(def: &RagdollDef, arms: &[StiffArm], body: usize) -> Option<usize> {
    let parent = |body: usize| def.joints.iter().find(|joint| joint.child == body).map(|joint| joint.parent);
    let mut bearers = core::iter::successors(Some(body), |&body| parent(body));
    bearers.find_map(|body| arms.iter().find(|arm| def.bodies[body].joint == arm.shoulder).map(|arm| arm.end))
}

/// Returns the part to which a skin point belongs; the point is in model space of the bind pose. `None` for tails and
/// other points without a part.
fn part_of(
    def: &RagdollDef,
    limbs: &[LimbChain],
    bind: &[Affine],
    body: usize,
    place: Vec3,
) -> Option<usize> {
    let is_human = |body: usize| {
        Role::from_name(&def.bodies[body].role).is_some_and(|role| HUMANOID_ROLES.contains(&role))
    };
    let parent = |body: usize| def.joints.iter().find(|joint| joint.child == body).map(|joint| joint.parent);
    // Props follow the part that carries them.
    let bearers = core::iter::successors(Some(body), |&body| parent(body));
    let Some(bearer) = bearers.into_iter().find(|&body| is_human(body)) else { return Some(TRUNK) };
    let is_beyond = |joint: JointIdx, of: JointIdx| {
        (place - bind[joint].translation).length() < (place - bind[of].translation).length()
    };
    for limb in limbs {
        let joint = def.bodies[bearer].joint;
        let TwoBone { upper, lower, end } = limb.bones;
        let above =
            core::iter::successors(Some(bearer), |&body| parent(body)).map(|body| def.bodies[body].joint);
        if above.into_iter().any(|joint| joint == end) {
            return Some(limb.end);
        }
        if joint == lower {
            let middle = limb.middle.unwrap_or(TRUNK);
            return Some(if is_beyond(end, lower) { limb.end } else { middle });
        }
        if joint == upper && is_beyond(lower, upper) {
            return Some(limb.middle.unwrap_or(TRUNK));
        }
    }
    is_human(body).then_some(TRUNK)
}

fn hand_roles() -> [Role; 2] {
    [Side::Left, Side::Right].map(Role::Hand)
}

/// Returns the hand, left or right, that a body is or that carries the body.
fn hand_of(def: &RagdollDef, body: usize) -> Option<usize> {
    let parent = |body: usize| def.joints.iter().find(|joint| joint.child == body).map(|joint| joint.parent);
    let mut bearers = core::iter::successors(Some(body), |&body| parent(body));
    bearers.find_map(|body| hand_roles().into_iter().position(|role| def.bodies[body].role == role.name()))
}

/// Returns true if a joint is `above` or its descendant.
fn hangs(rig: &Rig, joint: JointIdx, above: JointIdx) -> bool {
    core::iter::successors(Some(joint), |&i| rig.joints[i].parent).any(|i| i == above)
}

/// Returns the joints that are not descendants of the joint that carries their body, each with that joint; of a subtree
/// only the topmost joint.
fn strays(rig: &Rig, def: &RagdollDef) -> Vec<(JointIdx, JointIdx)> {
    let hangs = |joint: JointIdx, above: JointIdx| hangs(rig, joint, above);
    let of_bodies = def.joints.iter().filter_map(|joint| {
        let (child, parent) = (def.bodies[joint.child].joint, def.bodies[joint.parent].joint);
        (!hangs(child, parent)).then_some((child, parent))
    });
    let carried = carried(rig, def.bodies.iter().map(|body| (body.joint, body.merged.as_slice())));
    let of_joints = (0..rig.joints.len()).filter_map(|joint| {
        let carrier = def.bodies[carried[joint]?].joint;
        let parent = rig.joints[joint].parent.and_then(|parent| carried[parent]);
        (!hangs(joint, carrier) && parent != carried[joint]).then_some((joint, carrier))
    });
    // Skip a joint that is an ancestor of its carrier, because it cannot follow its own descendant.
    of_bodies.chain(of_joints).filter(|&(joint, carrier)| !hangs(carrier, joint)).collect()
}

/// Returns the directions from the centre of a box to its faces, edges and corners.
fn directions() -> impl Iterator<Item = Vec3> {
    let steps = [-1.0_f32, 0.0, 1.0];
    let all = steps.into_iter().flat_map(move |x| steps.into_iter().map(move |y| (x, y)));
    all.flat_map(move |(x, y)| steps.into_iter().map(move |z| Vec3::new(x, y, z)))
        .filter(|direction| *direction != Vec3::ZERO)
        .map(Vec3::normalize)
}

/// A foot of a humanoid.
pub(crate) struct Sole<'a> {
    pub joint: JointIdx,
    /// Up direction of a flat foot, in the foot's own axes.
    pub up: Vec3,
    skin: &'a Surface,
}

impl Sole<'_> {
    /// Returns the outermost points of the sole, in the space of `model`.
    pub fn places(&self, model: &[Affine], palette: &mut Vec<Affine>) -> Vec<Vec3> {
        self.skin.places(model, palette)
    }
}

impl CharacterDef {
    /// Returns the soles of the feet on which the character can stand.
    pub(crate) fn soles(&self) -> Vec<Sole<'_>> {
        let legs = self.clearance.limbs.iter().filter(|limb| FEET.contains(&limb.end));
        let sole = |limb: &LimbChain| {
            let joint = limb.bones.end;
            let up = self.bind()[joint].to_rigid().rotation.inverse() * Vec3::Y;
            Sole { joint, up, skin: &self.clearance.parts[limb.end] }
        };
        legs.map(sole).collect()
    }

    /// Returns the largest depth of the drawn skin, including props, in the floor over all frames of a take of this
    /// rig, metres; at least 0, and 0 for a rig without skin.
    pub fn deepest_skin(&self, take: &Take) -> f32 {
        self.clearance.deepest(self, take).into_iter().fold(0.0, max)
    }

    /// Returns the depth in the floor of the lowest drawn point of trunk, head and thighs, down to the knees, in a
    /// pose, metres; negative above the floor, `None` for a rig without skin.
    pub fn trunk_depth(&self, pose: &[LocalTransform]) -> Option<f32> {
        let mut model = Vec::new();
        local_to_model(&self.rig, pose, &self.mapping().character_from_model(), &mut model);
        let depth = self.clearance.depth(TRUNK, &model, &mut Vec::new());
        depth.is_finite().then_some(depth)
    }

    /// Raises feet, hands and elbows whose drawn skin is in the floor, by bending their limbs. If a hand holds an
    /// object that is too long for that, the hand rotates about its wrist. `pose` has one local transform per joint of
    /// the rig.
    pub fn raise_limbs(&self, pose: &mut [LocalTransform]) {
        if !self.clearance.parts.is_empty() {
            let sunk = LIMBS_SINK * self.ragdoll.height;
            let mut allowed = [sunk; PARTS];
            allowed[TRUNK] = f32::INFINITY;
            let mut model = Vec::new();
            self.clearance.clear(self, &allowed, 1.0, None, pose, &mut model);
            self.clearance.turn_hands(self, sunk, pose, &mut model);
        }
    }
}
