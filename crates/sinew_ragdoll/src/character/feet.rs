//! Keeps feet on the ground while a character gets up on ground that differs from its clip's floor. Otherwise, across
//! the edge of a stair, both feet would be at the height of the lower step.
//!
//! The state is the height of the ground under each foot above the clip's floor. It follows the measured height like a
//! critically damped spring, so that an edge below a moving foot causes no jump.

use super::activity::Activity;
use super::clearance::{Depths, PARTS, Passage, larger};
use super::figure::Figure;
use super::legs::{Legs, Need, Planting, Tilts};
use super::rises::Grounds;
use super::tread::Treads;
use super::walls::WallOffsets;
use super::{CharacterDef, GroundContact, Locomotion, State, ground};
use crate::character::tuning::{FOOT_EDGE, FOOT_FLOOR, FOOT_RANGE, FOOT_SEARCH, PLANTED_SOONER, WALKS_FROM};
use sinew_anim::{Animator, LocalTransform, local_to_model, smoothstep};
use sinew_math::{Affine, Transform, Vec3, max};
use sinew_physics::{BodyId, World};

/// Depths of the body parts in the ground in the shown pose, at least 0, and the transforms of its ankles in the world.
pub(super) type Depth = (Depths, [Transform; 2]);

/// Planted feet of a character, and clearance of its skin.
#[derive(Clone, Debug, Default)]
pub(super) struct Feet {
    /// Ground under the character's feet, where it differs from the floor of its clips.
    pub planting: Planting,
    /// Feet of a character that walks, stands or is powered; `None` while it gets up, lies, or only follows its clips.
    pub treads: Option<Treads>,
    /// Transition during which the character is kept out of the floor.
    pub passage: Passage,
    /// Displacements of trunk, feet and hands out of walls.
    pub walls: WallOffsets,
    /// Pose of the clips with planted feet, clear of floor and walls; empty if it equals the clips' pose.
    pub pose: Vec<LocalTransform>,
}

/// State of a character from which its feet are placed.
#[derive(Clone, Copy)]
pub(super) struct Stand<'a> {
    pub def: &'a CharacterDef,
    pub activity: &'a Activity,
    pub animator: &'a Animator,
    pub figure: &'a Figure,
    /// Speed of the character over the ground, m/s.
    pub speed: f32,
    /// Height by which the ground raised the character in the last step, metres.
    pub lifted: f32,
    /// True if the character jumps or falls.
    pub aloft: bool,
    /// True if the character's feet follow the ground.
    pub follows: bool,
    /// Bodies of the character, if it is in the world.
    pub own: Option<&'a [BodyId]>,
}

impl Feet {
    /// Returns true while the shown pose differs from the clips' pose.
    pub fn are_placed(&self) -> bool {
        !self.planting.is_over() || self.is_passing() || self.are_astray() || !self.walls.are_zero()
    }

    /// Returns true while a foot or the pelvis is displaced from its position in the clips.
    fn are_astray(&self) -> bool {
        self.treads.is_some_and(|treads| {
            treads.lowering > 0.0 || treads.feet.iter().any(|tread| tread.offset != Vec3::ZERO)
        })
    }

    /// Returns the pose with planted feet and clear of the floor, or `pose` if the two are equal.
    pub fn led<'a>(&'a self, pose: &'a [LocalTransform]) -> &'a [LocalTransform] {
        if self.pose.is_empty() { pose } else { &self.pose }
    }

    /// Plants the feet for this step and computes the shown pose. Without planting on the ground, only the feet of a
    /// character that gets up, or has got up and still stands there, are planted.
    pub fn plant(&mut self, stand: &Stand<'_>, world: &World, model: &mut Vec<Affine>) {
        self.go_on_passing(stand.activity.state(), world.def().dt());
        if self.is_passing() {
            let grounds = Grounds { world, own: stand.own };
            self.passage.rises.iter_mut().for_each(|rise| *rise -= stand.lifted);
            self.passage.follow_ground(stand.def, stand.figure, grounds, model);
        }
        self.follow_ground(stand, world, model);
        let state = stand.activity.state();
        self.pose.clear();
        if !matches!(state, State::Animated | State::GettingUp) {
            self.walls = WallOffsets::default();
            return;
        }
        let meets_walls = stand.follows || stand.def.ground_contact == GroundContact::Enforced;
        if !meets_walls && !self.are_placed() {
            return;
        }
        let mut pose = core::mem::take(&mut self.pose);
        let lowering = self.stand_out_of_floor(stand.def, state, stand.figure, &mut pose, model);
        if let Some(treads) = &mut self.treads {
            treads.lowering = lowering;
        }
        if meets_walls {
            local_to_model(&stand.def.rig, &pose, &stand.def.mapping().character_from_model(), model);
            self.walls.follow(stand.def, stand.figure.place, self.treads.is_some(), world, model);
        }
        if self.are_placed() {
            self.walls.shift(stand.def, stand.figure.place, &mut pose, model);
        } else {
            pose.clear();
        }
        self.pose = pose;
    }

    /// Clears the state, because bodies take over.
    pub fn leave(&mut self) {
        *self = Self::default();
    }

    fn follow_ground(&mut self, stand: &Stand<'_>, world: &World, model: &mut Vec<Affine>) {
        let Some(legs) = stand.def.legs() else { return };
        if stand.follows && !matches!(stand.activity, Activity::GettingUp(_)) {
            return self.tread(stand, legs, world, model);
        }
        self.treads = None;
        let is_exact = stand.def.motions().locomotion == Locomotion::Exact;
        let share = match stand.activity {
            Activity::GettingUp(rising) if is_exact && rising.is_without_clip() => 0.0,
            Activity::GettingUp(rising) => {
                smoothstep(PLANTED_SOONER * (1.0 - rising.left(stand.def, stand.animator)))
            }
            Activity::Animated if !self.planting.is_over() => 1.0 - smoothstep(stand.speed / WALKS_FROM),
            _ => 0.0,
        };
        if share <= 0.0 && self.planting.is_over() {
            return;
        }
        let mut goals = if share > 0.0 { stand.needed(world, legs, model) } else { Default::default() };
        goals
            .iter_mut()
            .for_each(|need| (need.height, need.slope) = (share * need.height, share * need.slope));
        self.planting.follow(goals, world.def().dt());
    }

    /// Computes the shown pose from the clips' pose.
    pub fn show(&mut self, def: &CharacterDef, state: State, figure: &Figure, model: &mut Vec<Affine>) {
        let mut pose = core::mem::take(&mut self.pose);
        self.stand_out_of_floor(def, state, figure, &mut pose, model);
        self.walls.shift(def, figure.place, &mut pose, model);
        self.pose = pose;
    }

    /// Computes the clips' pose with planted feet and clear of the floor. Returns the lowering of the pelvis, metres.
    fn stand_out_of_floor(
        &self,
        def: &CharacterDef,
        state: State,
        figure: &Figure,
        pose: &mut Vec<LocalTransform>,
        model: &mut Vec<Affine>,
    ) -> f32 {
        pose.clone_from(&figure.pose);
        let lowering = self.place(def, figure.place, 0.0, pose, model);
        self.clear_floor(def, state, figure.place, 0.0, pose, model);
        lowering
    }

    /// Moves the feet of a pose of the clips to where they will be planted in `later` seconds, when the character will
    /// be at `place`. Returns the lowering of the pelvis, metres.
    pub fn place(
        &self,
        def: &CharacterDef,
        place: Transform,
        later: f32,
        pose: &mut [LocalTransform],
        model: &mut Vec<Affine>,
    ) -> f32 {
        let planting = self.planting_at(place, later);
        let Some(legs) = def.legs().filter(|_| self.treads.is_some() || !planting.is_over()) else {
            return 0.0;
        };
        let (root, up) = (def.mapping().character_from_model(), place.rotation.inverse() * Vec3::Y);
        local_to_model(&def.rig, pose, &root, model);
        let mut offsets = self.offsets(later);
        if self.treads.is_some() {
            for (foot, offset) in offsets.iter_mut().enumerate() {
                *offset += place.rotation * legs.lean(foot, planting.slopes[foot], model);
            }
        }
        if !planting.is_over() {
            let tilts = if self.treads.is_some() { Tilts::Always } else { Tilts::OnTheFloor };
            legs.place(&def.rig, &root, (up, tilts), planting, pose, model);
        }
        self.bring_home(def, offsets, (place, later), pose, model)
    }

    /// Returns the depths of the shown pose in the ground, and its ankles in the world.
    pub fn shown_depths(
        &self,
        def: &CharacterDef,
        figure: &Figure,
        grounds: Grounds<'_>,
        model: &mut Vec<Affine>,
    ) -> Depth {
        let [_, ground] = grounds.depths(def, figure, self.led(&figure.pose), model);
        let depths = larger(ground, [0.0; PARTS]);
        let ankle = |foot: usize| match def.clearance().ankle(foot) {
            Some(ankle) => figure.place * model[ankle].to_rigid(),
            None => Transform::IDENTITY,
        };
        (depths, [0, 1].map(ankle))
    }

    /// Starts a transition of `seconds` from a pose with the depths and ankles given first to a pose with the depths
    /// `to`.
    pub fn pass(&mut self, def: &CharacterDef, (from, ankles): Depth, to: Depths, seconds: f32) {
        self.passage = match def.ground_contact {
            GroundContact::Enforced => Passage { from, to, ankles, seconds, ..Passage::default() },
            GroundContact::AsBlended => Passage::default(),
        };
    }

    /// Sets for each foot the horizontal distance between its body's position in `bodies` and its target, the position
    /// in `to` moved by `motion`. The distance determines how high the foot steps.
    pub fn pass_to(&mut self, def: &CharacterDef, bodies: &[Transform], motion: Transform, to: &[Transform]) {
        if !self.is_passing() {
            return;
        }
        for foot in 0..2 {
            let ankle = def.clearance().ankle(foot);
            let body = ankle.and_then(|ankle| def.ragdoll.bodies.iter().position(|body| body.joint == ankle));
            if let Some(body) = body {
                let way = motion.point(to[body].translation) - bodies[body].translation;
                self.passage.far[foot] = Vec3::new(way.x, 0.0, way.z).length();
            }
        }
    }

    /// Advances the transition by a step.
    fn go_on_passing(&mut self, state: State, dt: f32) {
        if !self.is_passing() {
            return;
        }
        self.passage.age += dt;
        if state == State::Animated && self.passage.age >= 2.0 * self.passage.seconds {
            self.passage = Passage::default();
        }
    }

    /// Returns true while the shown pose is kept out of the floor.
    pub fn is_passing(&self) -> bool {
        self.passage != Passage::default()
    }

    /// Raises a pose of the clips, for a time `later` seconds from now, out of the floor.
    pub fn clear_floor(
        &self,
        def: &CharacterDef,
        state: State,
        place: Transform,
        later: f32,
        pose: &mut [LocalTransform],
        model: &mut Vec<Affine>,
    ) {
        let share = if self.is_passing() { self.passage.share(later, state) } else { 0.0 };
        if share <= 0.0 || def.clearance().is_empty() {
            return;
        }
        let allowed = self.passage.allowed(later);
        let steps = self.passage.steps(later, state, place);
        def.clearance().clear(def, &allowed, share, Some(steps), pose, model);
    }
}

impl Stand<'_> {
    /// Returns the ground under each foot above the clip's floor: on a slope the height under the heel, and the slope;
    /// across an edge the larger of the heights under heel and ball, without a slope.
    fn needed(&self, world: &World, legs: &Legs, model: &mut Vec<Affine>) -> [Need; 2] {
        let root = self.def.mapping().character_from_model();
        local_to_model(&self.def.rig, &self.figure.pose, &root, model);
        let place = self.figure.place;
        let normal = place.rotation * Vec3::Y;
        let over_floor = |point: Vec3| {
            let height = ground::below(world, point, FOOT_SEARCH, self.own)?;
            let away = point - place.translation;
            let floor = place.translation.y - (normal.x * away.x + normal.z * away.z) / normal.y;
            Some(height - floor).filter(|over| over.abs() <= FOOT_RANGE)
        };
        let least = |over: f32| if over.abs() < FOOT_FLOOR { 0.0 } else { over };
        [0, 1].map(|foot| {
            let ankle: Transform = place * model[legs.chains[foot].end].to_rigid();
            let (heel, ball) = (ankle.translation, ankle.point(legs.balls[foot]));
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
