//! Legs of a humanoid, and placing its feet on the ground.

use crate::character::tuning::{BALL_AHEAD, FEET_QUICKNESS, FOOT_HOME, FOOT_RANGE, MOST_TILT};
use crate::def::RagdollDef;
use sinew_anim::ik::{FootGround, FootPlacement, TwoBone, place_feet};
use sinew_anim::{JointIdx, LocalTransform, Rig, local_to_model};
use sinew_math::{Affine, Vec3, max, min, normalize_or, trig};

/// The legs of a humanoid that stands on them.
#[derive(Clone, Debug)]
pub(super) struct Legs {
    pub pelvis: JointIdx,
    pub chains: [TwoBone; 2],
    /// Balls of the feet, in the axes of the ankle without scale, metres.
    pub balls: [Vec3; 2],
    /// Points on the sole below the ankle, below the ball, and at the tip of the toes, in the same axes, metres.
    pub soles: [[Vec3; 3]; 2],
    /// Length of a foot behind the ankle, metres.
    pub heel: f32,
    /// Height of the ankles in the bind pose, metres.
    pub ankle_height: f32,
}

impl Legs {
    /// Finds the legs by the roles of the bodies; `None` without two whole legs below the pelvis. `bind`: in character
    /// space, metres.
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
            // Find the foremost joint of the foot.
            let foremost = toes.fold(ankle.translation, |a, b| if b.z > a.z { b } else { a });
            let usual = ankle.translation + Vec3::Z * (BALL_AHEAD * length);
            let ball =
                if foremost.z > ankle.translation.z + 0.5 * BALL_AHEAD * length { foremost } else { usual };
            let on_floor = |point: Vec3| ankle.inverse_point(Vec3::new(point.x, 0.0, point.z));
            let of_foot =
                def.bodies.iter().filter(|body| body.joint == leg.end || Some(body.joint) == part("Toes"));
            let bounds = of_foot.map(|body| body.shape.aabb(&body.character_from_body));
            let (back, front) = bounds.fold((ankle.translation.z, ball.z), |(back, front), bounds| {
                (min(back, bounds.min.z), max(front, bounds.max.z))
            });
            let tip = Vec3::new(ball.x, 0.0, front);
            let sole = [on_floor(ankle.translation), on_floor(ball), on_floor(tip)];
            let heel = ankle.translation.z - back;
            is_chain.then(|| (leg, ankle.inverse_point(ball), ankle.translation.y, sole, heel))
        };
        let [left, right] = [foot("left")?, foot("right")?];
        Some(Self {
            pelvis,
            chains: [left.0, right.0],
            balls: [left.1, right.1],
            soles: [left.3, right.3],
            heel: max(left.4, right.4),
            ankle_height: max(min(left.2, right.2), 0.0),
        })
    }

    /// Returns the displacement of an ankle that is raised along the normal of a slope instead of the vertical; `model`
    /// and the result are in character space.
    pub fn lean(&self, foot: usize, slope: f32, model: &[Affine]) -> Vec3 {
        let ankle = model[self.chains[foot].end].to_rigid();
        let ahead = normalize_or(ankle.rotation * self.balls[foot] * Vec3::new(1.0, 0.0, 1.0), Vec3::ZERO);
        ahead * (slope / (1.0 + slope * slope).sqrt() * (self.ankle_height - ankle.translation.y))
    }

    /// Moves the feet of a pose onto the ground in `planting`, by moving the pelvis and bending the knees; `up` is in
    /// character space. Updates `model` to the new pose.
    pub fn place(
        &self,
        rig: &Rig,
        root: &Affine,
        (up, tilts): (Vec3, Tilts),
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
            free_height: match tilts {
                Tilts::OnTheFloor => 0.1,
                Tilts::Always => f32::MAX,
            },
            max_step: match tilts {
                Tilts::OnTheFloor => FOOT_RANGE,
                Tilts::Always => f32::MAX,
            },
            max_tilt: MOST_TILT,
        };
        let normal = |foot: usize| {
            let ankle = model[self.chains[foot].end].to_rigid();
            let along = ankle.rotation * self.balls[foot];
            let along = normalize_or(along - up * along.dot(up), Vec3::ZERO);
            (up - along * planting.slopes[foot]).normalize()
        };
        let grounds = [0, 1].map(|foot| FootGround { height: planting.heights[foot], normal: normal(foot) });
        let mut grounds = grounds.into_iter();
        let ground = |_: Vec3| grounds.next();
        place_feet(rig, self.pelvis, &self.chains, &settings, ground, local, model);
    }
}

/// Condition under which feet tilt with a slope.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Tilts {
    /// Feet tilt on the floor only.
    OnTheFloor,
    /// Feet tilt in the air as well.
    Always,
}

/// Smoothed ground under each foot, over the floor of the clip, and its rates of change, per second.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Planting {
    /// Heights of the ground, metres.
    pub heights: [f32; 2],
    pub rates: [f32; 2],
    /// Slopes of the ground from heel to ball, rise over run.
    pub slopes: [f32; 2],
    pub slope_rates: [f32; 2],
}

/// Ground under a foot over the floor of its clip: height, metres, and slope, rise over run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Need {
    pub height: f32,
    pub slope: f32,
}

impl Planting {
    pub fn is_over(&self) -> bool {
        *self == Self::default()
    }

    /// Makes both feet follow the ground for `dt` seconds.
    pub fn follow(&mut self, goals: [Need; 2], dt: f32) {
        for (foot, goal) in goals.into_iter().enumerate() {
            self.follow_foot(foot, goal, FEET_QUICKNESS, dt);
        }
        let all = [self.heights, self.rates, self.slopes, self.slope_rates];
        if goals == [Need::default(); 2] && all.as_flattened().iter().all(|x| x.abs() < FOOT_HOME) {
            *self = Self::default();
        }
    }

    /// Sets the state of a foot to zero once it is back on the floor of its clip.
    pub fn come_to_rest(&mut self, foot: usize, goal: Need) {
        let all = [self.heights[foot], self.rates[foot], self.slopes[foot], self.slope_rates[foot]];
        if goal == Need::default() && all.iter().all(|x| x.abs() < FOOT_HOME) {
            (self.heights[foot], self.rates[foot]) = (0.0, 0.0);
            (self.slopes[foot], self.slope_rates[foot]) = (0.0, 0.0);
        }
    }

    /// Makes one foot follow the ground under it.
    pub fn follow_foot(&mut self, foot: usize, goal: Need, quickness: f32, dt: f32) {
        follow(&mut self.heights[foot], &mut self.rates[foot], goal.height, quickness, dt);
        follow(&mut self.slopes[foot], &mut self.slope_rates[foot], goal.slope, quickness, dt);
    }

    /// Returns the state after `seconds` more at the present rates.
    pub fn ahead(&self, seconds: f32) -> Self {
        let at = |x: [f32; 2], rate: [f32; 2]| [0, 1].map(|foot| x[foot] + rate[foot] * seconds);
        Self { heights: at(self.heights, self.rates), slopes: at(self.slopes, self.slope_rates), ..*self }
    }
}

/// Advances `x` and its rate for `dt` seconds by the exact solution of `x″ = −ω²(x − g) − 2ω x′`, a critically damped
/// spring.
pub(super) fn follow(x: &mut f32, rate: &mut f32, goal: f32, quickness: f32, dt: f32) {
    let decay = trig::exp(-quickness * dt);
    let off = *x - goal;
    let carried = *rate + quickness * off;
    *x = goal + (off + carried * dt) * decay;
    *rate = (*rate - quickness * carried * dt) * decay;
}
