//! Feet on the ground under them, while a character gets up where that is not the floor its clip was made for: across the edge
//! of a stair both feet would be over the lower step.
//!
//! What is kept from step to step is how high the ground is that each foot stands on, over the floor of the clip: it follows
//! the world as a spring does that is damped critically, so that an edge below a foot that moves is no jump.

use super::memory::Planting;
use super::{Character, State, ground};
use crate::character::tuning::{
    BALL_AHEAD, FEET_QUICKNESS, FOOT_EDGE, FOOT_FLOOR, FOOT_HOME, FOOT_RANGE, FOOT_SEARCH, MOST_TILT,
    PLANTED_SOONER, WALKS_FROM,
};
use crate::def::RagdollDef;
use sinew_anim::ik::{FootGround, FootPlacement, TwoBone, place_feet};
use sinew_anim::{JointIdx, LocalTransform, Rig, local_to_model, smoothstep};
use sinew_math::{Affine, Transform, Vec3, max, min, normalize_or, trig};
use sinew_physics::World;

/// The legs of a humanoid that stands on them.
#[derive(Clone, Debug)]
pub(super) struct Feet {
    pub pelvis: JointIdx,
    pub legs: [TwoBone; 2],
    /// The ball, in the axes of the ankle without scale, metres.
    pub balls: [Vec3; 2],
    /// Height of the ankles in the bind pose, metres.
    pub ankle_height: f32,
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
            let usual = ankle.translation + Vec3::Z * (BALL_AHEAD * length);
            let ball =
                if foremost.z > ankle.translation.z + 0.5 * BALL_AHEAD * length { foremost } else { usual };
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

    /// Brings a pose's feet onto the ground as it is planted on, by the pelvis and the knees; `up` is seen by the character.
    /// `model` is cleared and filled.
    fn place(
        &self,
        rig: &Rig,
        root: &Affine,
        up: Vec3,
        planting: Planting,
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
            max_step: FOOT_RANGE,
            max_tilt: MOST_TILT,
        };
        let normal = |foot: usize| {
            let ankle = model[self.legs[foot].end].to_rigid();
            let along = ankle.rotation * self.balls[foot];
            let along = normalize_or(along - up * along.dot(up), Vec3::ZERO);
            (up - along * planting.slopes[foot]).normalize()
        };
        let grounds = [0, 1].map(|foot| FootGround { height: planting.heights[foot], normal: normal(foot) });
        let mut grounds = grounds.into_iter();
        let ground = |_: Vec3| grounds.next();
        place_feet(rig, self.pelvis, &self.legs, &settings, ground, local, model);
    }
}

/// Ground under a foot over the floor of its clip: metres, and up over along.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Need {
    height: f32,
    slope: f32,
}

impl Planting {
    /// Follows the ground for `dt` seconds.
    fn follow(&mut self, goals: [Need; 2], dt: f32) {
        for (foot, goal) in goals.into_iter().enumerate() {
            follow(&mut self.heights[foot], &mut self.rates[foot], goal.height, dt);
            follow(&mut self.slopes[foot], &mut self.slope_rates[foot], goal.slope, dt);
        }
        let all = [self.heights, self.rates, self.slopes, self.slope_rates];
        if goals == [Need::default(); 2] && all.as_flattened().iter().all(|x| x.abs() < FOOT_HOME) {
            *self = Self::default();
        }
    }

    /// After so many seconds more at the present rates.
    pub fn ahead(&self, seconds: f32) -> Self {
        let at = |x: [f32; 2], rate: [f32; 2]| [0, 1].map(|foot| x[foot] + rate[foot] * seconds);
        Self { heights: at(self.heights, self.rates), slopes: at(self.slopes, self.slope_rates), ..*self }
    }
}

/// `x″ = −ω²(x − g) − 2ω x′` for `dt` seconds, solved exactly.
fn follow(x: &mut f32, rate: &mut f32, goal: f32, dt: f32) {
    let decay = trig::exp(-FEET_QUICKNESS * dt);
    let off = *x - goal;
    let carried = *rate + FEET_QUICKNESS * off;
    *x = goal + (off + carried * dt) * decay;
    *rate = (*rate - FEET_QUICKNESS * carried * dt) * decay;
}

impl Character {
    /// Puts the feet of a character that gets up, or has and still stands there, on the ground under them. Of one that goes on
    /// they come back to where its clips have them.
    pub(super) fn plant(&mut self, world: &World) {
        self.go_on_passing(world.def().dt());
        self.plant_feet(world);
        if self.is_planted() {
            self.show_planted();
        }
    }

    fn plant_feet(&mut self, world: &World) {
        let def = self.def.clone();
        let Some(feet) = def.feet() else { return };
        let share = match self.state {
            State::GettingUp => smoothstep(PLANTED_SOONER * (1.0 - self.lies_still())),
            State::Animated if !self.planting.is_over() => 1.0 - smoothstep(self.speed / WALKS_FROM),
            _ => 0.0,
        };
        if share <= 0.0 && self.planting.is_over() {
            return;
        }
        let mut goals = if share > 0.0 { self.needed(world, feet) } else { Default::default() };
        goals
            .iter_mut()
            .for_each(|need| (need.height, need.slope) = (share * need.height, share * need.slope));
        self.planting.follow(goals, world.def().dt());
    }

    /// Makes the pose that is shown of the clips'.
    pub(super) fn show_planted(&mut self) {
        let mut planted = core::mem::take(&mut self.planted);
        planted.clone_from(&self.pose);
        self.place_feet(self.planting, &mut planted);
        self.clear_floor(0.0, &mut planted);
        self.planted = planted;
    }

    /// Brings a pose of the clips to where the feet are planted.
    pub(super) fn place_feet(&mut self, planting: Planting, pose: &mut [LocalTransform]) {
        let Some(feet) = self.def.feet().filter(|_| !planting.is_over()) else { return };
        let root = self.def.mapping().character_from_model();
        let up = self.world_from_character.rotation.inverse() * Vec3::Y;
        feet.place(&self.def.rig, &root, up, planting, pose, &mut self.scratch.model);
    }

    /// The ground under each foot over the floor of the clip: on a slope that under the heel, and how it tilts; across an edge
    /// what is higher of that under heel and ball, for there a foot stands.
    fn needed(&mut self, world: &World, feet: &Feet) -> [Need; 2] {
        let root = self.def.mapping().character_from_model();
        let own = self.presence.as_ref().map(|presence| presence.bodies.as_slice());
        let model = &mut self.scratch.model;
        local_to_model(&self.def.rig, &self.pose, &root, model);
        let place = self.world_from_character;
        let normal = place.rotation * Vec3::Y;
        let over_floor = |point: Vec3| {
            let height = ground::below(world, point, FOOT_SEARCH, own)?;
            let away = point - place.translation;
            let floor = place.translation.y - (normal.x * away.x + normal.z * away.z) / normal.y;
            Some(height - floor).filter(|over| over.abs() <= FOOT_RANGE)
        };
        let least = |over: f32| if over.abs() < FOOT_FLOOR { 0.0 } else { over };
        [0, 1].map(|foot| {
            let ankle: Transform = place * model[feet.legs[foot].end].to_rigid();
            let (heel, ball) = (ankle.translation, ankle.point(feet.balls[foot]));
            let along = (ball - heel) * Vec3::new(1.0, 0.0, 1.0);
            match (over_floor(heel), over_floor(ball)) {
                (Some(heel), Some(ball)) if (ball - heel).abs() <= FOOT_EDGE * along.length() => {
                    Need { height: least(heel), slope: least(ball - heel) / max(along.length(), 1e-3) }
                }
                (heel, ball) => {
                    let over = heel.into_iter().chain(ball).reduce(max).unwrap_or(0.0);
                    Need { height: least(over), slope: 0.0 }
                }
            }
        })
    }
}
