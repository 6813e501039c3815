//! Feet on the ground under them, while a character gets up where that is not the floor its clip was made for: across the edge
//! of a stair both feet would be over the lower step.
//!
//! What is kept from step to step is how high the ground is that each foot stands on, over the floor of the clip: it follows
//! the world as a spring does that is damped critically, so that an edge below a foot that moves is no jump.

use super::{Character, State, ground};
use crate::def::RagdollDef;
use sinew_anim::ik::{FootGround, FootPlacement, TwoBone, place_feet};
use sinew_anim::{JointIdx, LocalTransform, Rig, local_to_model, smoothstep};
use sinew_math::{Affine, Transform, Vec3, max, min, trig};
use sinew_physics::World;

/// How fast feet follow the ground, rad/s: a step of a stair asks for as much of a leg as a transition within 0.2 s.
const QUICKNESS: f32 = 12.0;
/// Ground farther up or down than this is nothing to stand on, metres.
const MOST: f32 = 0.32;
/// Ground less far up or down than this is the floor, metres.
const LEAST: f32 = 2e-3;
/// A foot that is no higher and no faster than this has nothing left to come back from, metres and m/s.
const OVER: f32 = 1e-5;
/// So many times sooner than the body stands upright its feet are planted.
const PLANTED: f32 = 2.0;
/// How far above a foot the ground is sought, metres.
const ABOVE: f32 = 0.5;
/// A character that goes this fast has its feet where its clips have them, m/s.
const WALKS: f32 = 0.3;
/// Place of the ball in front of an ankle without toes, in lengths of the leg.
const BALL: f32 = 0.14;

/// The legs of a humanoid that stands on them.
#[derive(Clone, Debug)]
pub(super) struct Feet {
    pelvis: JointIdx,
    legs: [TwoBone; 2],
    /// The ball, in the axes of the ankle without scale, metres.
    balls: [Vec3; 2],
    /// Height of the ankles in the bind pose, metres.
    ankle_height: f32,
}

impl Feet {
    /// By the roles of the bodies; `None` without two whole legs that hang on the pelvis. `bind`: in character space, metres.
    pub fn of(rig: &Rig, def: &RagdollDef, bind: &[Affine]) -> Option<Self> {
        let joint = |role: &str| def.bodies.iter().find(|body| body.role == role).map(|body| body.joint);
        let hangs_on = |joint: JointIdx, above: JointIdx| {
            core::iter::successors(Some(joint), |&i| rig.joints[i].parent).any(|i| i == above)
        };
        let pelvis = def.bodies.first()?.joint;
        let foot = |side: &str| {
            let part = |name: &str| joint(&format!("{side}{name}"));
            let leg = TwoBone { upper: part("UpperLeg")?, lower: part("LowerLeg")?, end: part("Foot")? };
            let is_chain =
                hangs_on(leg.upper, pelvis) && hangs_on(leg.lower, leg.upper) && hangs_on(leg.end, leg.lower);
            let place = |joint: JointIdx| bind[joint].translation;
            let ankle = bind[leg.end].to_rigid();
            let length =
                (place(leg.lower) - place(leg.upper)).length() + (place(leg.end) - place(leg.lower)).length();
            let body = def.bodies.iter().find(|body| body.joint == leg.end)?;
            let toes = part("Toes").into_iter().chain(body.merged.iter().copied()).map(place);
            // The foremost of what the foot is made of.
            let foremost = toes.fold(ankle.translation, |a, b| if b.z > a.z { b } else { a });
            let usual = ankle.translation + Vec3::Z * (BALL * length);
            let ball = if foremost.z > ankle.translation.z + 0.5 * BALL * length { foremost } else { usual };
            is_chain.then(|| (leg, ankle.inverse_point(ball), ankle.translation.y))
        };
        let [left, right] = [foot("left")?, foot("right")?];
        Some(Self {
            pelvis,
            legs: [left.0, right.0],
            balls: [left.1, right.1],
            ankle_height: max(min(left.2, right.2), 0.0),
        })
    }

    /// Brings a pose's feet so much higher than the floor of its clip, along `up` (character axes), by the pelvis and the
    /// knees. `model` is cleared and filled.
    fn place(
        &self,
        rig: &Rig,
        root: &Affine,
        up: Vec3,
        heights: [f32; 2],
        local: &mut [LocalTransform],
        model: &mut Vec<Affine>,
    ) {
        local_to_model(rig, local, root, model);
        let settings = FootPlacement {
            up,
            forward: Vec3::Z,
            floor: 0.0,
            ankle_height: self.ankle_height,
            free_height: 0.1,
            max_step: MOST,
            max_tilt: 0.0,
        };
        let mut heights = heights.into_iter();
        let ground = |_: Vec3| heights.next().map(|height| FootGround { height, normal: up });
        place_feet(rig, self.pelvis, &self.legs, &settings, ground, local, model);
    }
}

/// How high the ground under each foot is held to be over the floor of the clip, metres, and how fast that changes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Planting {
    pub heights: [f32; 2],
    pub rates: [f32; 2],
}

impl Planting {
    pub fn is_over(&self) -> bool {
        *self == Self::default()
    }

    /// Follows the ground for `dt` seconds: `x″ = −ω²(x − g) − 2ω x′`, solved exactly.
    fn follow(&mut self, goals: [f32; 2], dt: f32) {
        let decay = trig::exp(-QUICKNESS * dt);
        for (foot, goal) in goals.into_iter().enumerate() {
            let (off, rate) = (self.heights[foot] - goal, self.rates[foot]);
            let carried = rate + QUICKNESS * off;
            self.heights[foot] = goal + (off + carried * dt) * decay;
            self.rates[foot] = (rate - QUICKNESS * carried * dt) * decay;
        }
        let is_nothing = |x: f32| x.abs() < OVER;
        let rests = self.heights.into_iter().chain(self.rates).all(is_nothing);
        if rests && goals == [0.0; 2] {
            *self = Self::default();
        }
    }

    /// After so many seconds more at the present rates.
    pub fn ahead(&self, seconds: f32) -> Self {
        let at = |foot: usize| self.heights[foot] + self.rates[foot] * seconds;
        Self { heights: [at(0), at(1)], ..*self }
    }
}

impl Character {
    /// Puts the feet of a character that gets up, or has and still stands there, on the ground under them. Of one that goes on
    /// they come back to where its clips have them.
    pub(super) fn plant(&mut self, world: &World) {
        let def = self.def.clone();
        let Some(feet) = def.feet() else { return };
        let share = match self.state {
            State::GettingUp => smoothstep(PLANTED * (1.0 - self.lies_still())),
            State::Animated if !self.planting.is_over() => 1.0 - smoothstep(self.speed / WALKS),
            _ => 0.0,
        };
        if share <= 0.0 && self.planting.is_over() {
            return;
        }
        let goals = if share > 0.0 { self.needed(world, feet).map(|need| share * need) } else { [0.0; 2] };
        self.planting.follow(goals, world.def().dt());
        self.show_planted();
    }

    /// Makes the pose that is shown of the clips'.
    pub(super) fn show_planted(&mut self) {
        let mut planted = core::mem::take(&mut self.planted);
        planted.clone_from(&self.pose);
        self.place_feet(self.planting, &mut planted);
        self.planted = planted;
    }

    /// Brings a pose of the clips to where the feet are planted.
    pub(super) fn place_feet(&mut self, planting: Planting, pose: &mut [LocalTransform]) {
        let Some(feet) = self.def.feet().filter(|_| !planting.is_over()) else { return };
        let root = self.def.mapping().character_from_model();
        let up = self.world_from_character.rotation.inverse() * Vec3::Y;
        feet.place(&self.def.rig, &root, up, planting.heights, pose, &mut self.scratch.model);
    }

    /// How high the ground is under each foot over the floor of the clip: under heel or ball, whichever is higher, for it is
    /// there that a foot across an edge stands.
    fn needed(&mut self, world: &World, feet: &Feet) -> [f32; 2] {
        let root = self.def.mapping().character_from_model();
        let model = &mut self.scratch.model;
        local_to_model(&self.def.rig, &self.pose, &root, model);
        let place = self.world_from_character;
        let normal = place.rotation * Vec3::Y;
        let over_floor = |point: Vec3| {
            let height = ground::below(world, point, ABOVE)?;
            let away = point - place.translation;
            let floor = place.translation.y - (normal.x * away.x + normal.z * away.z) / normal.y;
            Some(height - floor).filter(|over| over.abs() <= MOST)
        };
        [0, 1].map(|foot| {
            let ankle: Transform = place * model[feet.legs[foot].end].to_rigid();
            let [heel, ball] = [ankle.translation, ankle.point(feet.balls[foot])].map(over_floor);
            let over = heel.into_iter().chain(ball).reduce(max).unwrap_or(0.0);
            if over.abs() < LEAST { 0.0 } else { over }
        })
    }
}
