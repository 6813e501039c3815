//! Locomotion of a character: its clips, its mover, and the requested velocity and heading.

use super::activity::Activity;
use super::figure::Figure;
use super::stumble::level;
use super::{CharacterDef, HitBodies, Locomotion, State, ground};
use crate::character::tuning::{
    CLIMB_SPEED, FASTEST_PACE, FOOTHOLD, HIGHEST_STEP, LIFTS_OFF, MOST_ASIDE, MOST_BESIDE, MOST_PACES,
    OFF_GROUND, PACE_RATE, PICKS_UP, POWERED_TURNS, PULL_RATE, PULL_SLACK, PULL_SPEED, PUSHED_ASIDE,
    STANDS_BELOW, STANDS_IN, STEP_SETTLES, STEP_SLOPE,
};
use sinew_anim::{Animator, ClipId, TrackDef, TrackId, smoothstep, weights_on_line};
use sinew_math::{Rotation, Transform, Vec3, clamp, max, min, normalize_or, trig};
use sinew_physics::{BodyId, MoverDef, MoverId, World};

/// Clips and mover of a character, and its requested motion.
#[derive(Clone, Debug)]
pub(super) struct Gait {
    pub animator: Animator,
    /// Mover of the character, while it stands in a world.
    pub mover: Option<MoverId>,
    /// Requested velocity, m/s; `None`: root motion.
    pub wish: Option<Vec3>,
    /// Horizontal direction toward which the character turns, of length 1; `None`: it does not turn.
    pub facing: Option<Vec3>,
    /// Rotation of the mover about the vertical when it was last read, radians.
    pub yaw: f32,
    /// Velocity of the mover, m/s.
    pub velocity: Vec3,
    /// Horizontal speed of the character over the ground in the last step, m/s.
    pub speed: f32,
    /// Speed at which the ground raised the character's origin in the last step, m/s; 0 with a mover.
    pub climbing: f32,
    /// Height by which a step of the ground raised the character's origin in the last step, metres; 0 without a mover,
    /// and between updates.
    pub lifted: f32,
    /// Speed at which the looped clip is played, m/s.
    pub pace: f32,
    /// Time since the mover last had ground, seconds.
    pub air: f32,
    /// Offset from the mover to the shown position, metres. It is not zero after a stair step and after a mover was
    /// pushed aside, which the character follows with a delay.
    pub beside: Vec3,
    /// Velocity by blasts and fields in addition to the walk, m/s; on the ground the feet brake it. An upward component
    /// lifts the character off the ground.
    pub shoved: Vec3,
    /// Change of velocity by blasts and fields in the last step, m/s; zero between updates.
    pub blown: Vec3,
    /// Velocity at which the character follows a held limb, horizontal, m/s; zero between updates.
    pub pulled: Vec3,
    /// True if the character must fall: it was off the ground for too long, landed too fast, or, without a mover, went
    /// over an edge.
    pub falls: bool,
}

/// Returns the root motion of the last update of an animator, in character space.
pub(super) fn root_step(def: &CharacterDef, animator: &Animator) -> Transform {
    let root = def.mapping().character_from_model();
    let turn = root.to_rigid().rotation;
    let step = animator.root_motion();
    Transform::new(root.vector(step.translation), turn * step.rotation * turn.inverse())
}

impl Gait {
    pub fn new(animator: Animator) -> Self {
        Self {
            animator,
            mover: None,
            wish: None,
            facing: None,
            yaw: 0.0,
            velocity: Vec3::ZERO,
            speed: 0.0,
            climbing: 0.0,
            lifted: 0.0,
            pace: 0.0,
            air: 0.0,
            beside: Vec3::ZERO,
            shoved: Vec3::ZERO,
            blown: Vec3::ZERO,
            pulled: Vec3::ZERO,
            falls: false,
        }
    }

    /// Advances the clips and moves the character over the ground by a step. `own`: bodies of the character, if it is
    /// in the world.
    pub fn advance(
        &mut self,
        def: &CharacterDef,
        activity: &Activity,
        figure: &mut Figure,
        own: Option<&[BodyId]>,
        world: &World,
    ) {
        let dt = world.def().dt();
        self.keep_pace(def, dt);
        self.animator.update(def.set(), dt);
        figure.keep_earlier();
        figure.take(&self.animator);
        let step = root_step(def, &self.animator);
        // At full turning speed a lying body would swing about its feet, so the turning speed grows as the character
        // rises.
        let most = if activity.state() == State::Powered { POWERED_TURNS } else { f32::INFINITY };
        let turns = min(def.in_world.turn_speed, most) * (1.0 - activity.lowness(def, &self.animator));
        let from = figure.place;
        if let Some(to) = self.ride(def, world, from, step, turns) {
            figure.place = to;
            self.climbing = 0.0;
            return;
        }
        let mut to = from * step;
        let follows = def.motions().locomotion != Locomotion::Exact;
        let below = follows.then(|| ground::below(world, to.translation, HIGHEST_STEP, own)).flatten();
        let is_over_edge = below.is_none_or(|height| to.translation.y - height > HIGHEST_STEP);
        let [before, now] = [from.translation, to.translation];
        self.falls = follows
            && is_over_edge
            && ground::ends_between(world, [before, now], FOOTHOLD * def.ragdoll.height, own);
        if let Some(height) = below.filter(|_| !self.falls) {
            to.translation.y += clamp(height - to.translation.y, -CLIMB_SPEED * dt, CLIMB_SPEED * dt);
        }
        figure.place = to;
        let way = to.translation - from.translation;
        self.speed = Vec3::new(way.x, 0.0, way.z).length() / dt;
        self.climbing = (to.translation.y - from.translation.y) / dt;
    }

    /// Returns the character's transform after a step according to its mover, and records the mover's speeds. `turns`
    /// is the largest turning speed, rad/s.
    fn ride(
        &mut self,
        def: &CharacterDef,
        world: &World,
        from: Transform,
        step: Transform,
        turns: f32,
    ) -> Option<Transform> {
        let mover = world.mover(self.mover?);
        let settings = &def.in_world;
        let dt = world.def().dt();
        let (feet, velocity) = (mover.position(), mover.velocity());
        let ground = world.mover_ground(self.mover?);
        let floor = ground.map_or(Vec3::ZERO, |ground| ground.velocity);
        let way = feet - mover.interpolated(0.0);
        let beyond = way - velocity * dt;
        // Overlapping bodies and a step in front of the mover push it aside within a step of the world.
        let aside = if ground.is_some() { level(beyond) } else { beyond };
        let pushed = aside * max(1.0 - PUSHED_ASIDE * dt / max(aside.length(), 1e-6), 0.0);
        self.beside -= pushed;
        if ground.is_some() && beyond.y.abs() > STEP_SLOPE * level(way - pushed).length() + 1e-3 {
            self.beside.y -= beyond.y;
        }
        let away = level(self.beside);
        let kept = away * min(MOST_ASIDE / max(away.length(), 1e-6), 1.0);
        let raised = clamp(self.beside.y, -MOST_BESIDE, MOST_BESIDE);
        self.beside = (kept + Vec3::Y * raised) * trig::exp(-STEP_SETTLES * dt);
        let fell = floor.y - self.velocity.y;
        let landed = ground.is_some() && self.air > 0.0;
        self.air = if ground.is_some() { 0.0 } else { self.air + dt };
        self.falls = self.air > settings.air_time || landed && fell > settings.landing_speed;
        // A falling body keeps its landing velocity.
        if !(self.falls && landed) {
            self.velocity = velocity;
        }
        self.speed = level(velocity - floor).length();
        self.lifted = -from.translation.y - floor.y * dt;
        let carried = Rotation::from_axis_angle(Vec3::Y, mover.yaw() - self.yaw);
        self.yaw = mover.yaw();
        let heading = carried * from.rotation;
        let rotation = match self.facing {
            Some(facing) => turned_to(heading, facing, turns * dt),
            None if self.wish.is_some() => heading,
            None => heading * step.rotation,
        };
        // The mover floats above the ground by its skin distance; the character's soles are on the ground.
        let to = feet + self.beside - Vec3::Y * mover.def().skin;
        self.lifted += to.y;
        Some(Transform::new(to, rotation.normalize()))
    }

    /// Sets the mover's motion for the next step, and lets it grow to its full height as the character rises. If
    /// `on_feet` is true, the acceleration is limited to that of the character's own feet.
    pub fn steer(
        &mut self,
        def: &CharacterDef,
        activity: &Activity,
        rotation: Rotation,
        on_feet: bool,
        world: &mut World,
    ) {
        let Some(mover) = self.mover else { return };
        let walk = match activity.stumble() {
            Some(stumble) => stumble.velocity,
            None => self.reachable_walk(def, activity, rotation, on_feet, world),
        };
        let walk = self.be_shoved(mover, walk, world);
        world.set_mover_walk(mover, if walk.is_finite() { walk } else { Vec3::ZERO });
        let height = def.in_world.mover.as_ref().map_or(0.0, |mover| mover.height);
        if world.mover(mover).def().height < height && activity.left_to_rise(def, &self.animator) < 0.5 {
            world.set_mover_height(mover, height);
        }
    }

    /// Returns a walk with the velocities by blasts, fields and pulls added. Feet on the ground brake these velocities;
    /// in the air nothing brakes them.
    fn be_shoved(&mut self, mover: MoverId, walk: Vec3, world: &mut World) -> Vec3 {
        let (blown, pulled) = (core::mem::take(&mut self.blown), core::mem::take(&mut self.pulled));
        if blown == Vec3::ZERO && self.shoved == Vec3::ZERO {
            return walk + pulled;
        }
        let dt = world.def().dt();
        let stands = world.mover_ground(mover).is_some();
        let lift = blown.y - world.def().gravity.length() * dt;
        let rises = if stands { max(self.shoved.y + lift, 0.0) } else { 0.0 };
        self.shoved = Vec3::new(self.shoved.x + blown.x, rises, self.shoved.z + blown.z);
        if !stands || rises > LIFTS_OFF {
            let velocity = world.mover(mover).velocity() + blown + Vec3::Y * rises;
            if velocity.is_finite() {
                world.set_mover_velocity(mover, velocity);
            }
            self.shoved.y = 0.0;
            // In the air, a mover whose motion is zero keeps its velocity.
            return if walk == Vec3::ZERO { walk } else { walk + self.shoved };
        }
        let level = Vec3::new(self.shoved.x, 0.0, self.shoved.z);
        let kept = level * max(1.0 - PICKS_UP * dt / max(level.length(), 1e-6), 0.0);
        self.shoved = Vec3 { y: rises, ..kept };
        walk + kept + pulled
    }

    /// Returns [`wanted_walk`](Self::wanted_walk), limited by the largest acceleration of the character's own feet.
    fn reachable_walk(
        &self,
        def: &CharacterDef,
        activity: &Activity,
        rotation: Rotation,
        on_feet: bool,
        world: &World,
    ) -> Vec3 {
        let dt = world.def().dt();
        let wish = self.wanted_walk(def, activity.state(), rotation, dt);
        let ground = self.mover.filter(|_| on_feet).and_then(|mover| world.mover_ground(mover));
        let Some(ground) = ground else { return wish };
        let now = (self.velocity - ground.velocity) * Vec3::new(1.0, 0.0, 1.0);
        let now = now - Vec3 { y: 0.0, ..self.shoved };
        let change = wish - now;
        now + change * min(PICKS_UP * dt / max(change.length(), 1e-6), 1.0)
    }

    /// Returns the wanted velocity over the ground in a step of `dt` seconds: as requested, or by root motion.
    pub fn wanted_walk(&self, def: &CharacterDef, state: State, rotation: Rotation, dt: f32) -> Vec3 {
        let step = root_step(def, &self.animator).translation;
        let wish = self.wish.filter(|_| state != State::GettingUp);
        wish.unwrap_or(rotation * step / dt * Vec3::new(1.0, 0.0, 1.0))
    }

    /// Plays the looped clip at the character's speed, and idles at rest.
    fn keep_pace(&mut self, def: &CharacterDef, dt: f32) {
        if self.mover.is_none() || self.wish.is_none() {
            return;
        }
        self.pace += (self.speed - self.pace) * -trig::exp_m1(-PACE_RATE * dt);
        let pace = self.pace;
        if self.looped_track(def).is_none() {
            return;
        }
        let paces = def.paces();
        let (mut tracks, mut speeds, mut weights) =
            ([None; MOST_PACES], [0.0; MOST_PACES], [0.0; MOST_PACES]);
        for (i, own) in paces.iter().enumerate() {
            let track = self.track_or_silent(def, own.clip, def.sync_group());
            if own.speed > 0.0 {
                self.animator.set_speed(track, clamp(pace / own.speed, 0.0, FASTEST_PACE));
            }
            (tracks[i], speeds[i]) = (Some(track), own.speed);
        }
        let count = paces.len();
        weights_on_line(&speeds[..count], pace, &mut weights[..count]);
        let tracks = tracks.into_iter().flatten();
        let share = match def.motions().idle.map(|idle| def.clip(idle)) {
            Some(idle) => {
                let idle = self.track_or_silent(def, idle, None);
                let wanted = smoothstep(clamp(pace / STANDS_BELOW, 0.0, 1.0));
                let weight =
                    |track: TrackId| self.animator.track(track).map_or(0.0, |track| track.def().weight);
                let now: f32 = tracks.clone().map(weight).sum();
                let share = clamp(wanted, now - dt / STANDS_IN, now + dt / STANDS_IN);
                self.animator.set_weight(idle, 1.0 - share);
                share
            }
            None if count == 1 => return,
            None => 1.0,
        };
        for (track, weight) in tracks.zip(weights) {
            self.animator.set_weight(track, share * weight);
        }
    }

    /// Returns the track that plays a clip; starts one with the weight 0 if there is none.
    fn track_or_silent(&mut self, def: &CharacterDef, clip: ClipId, sync_group: Option<u8>) -> TrackId {
        self.track_of(clip).unwrap_or_else(|| {
            self.animator.play(def.set(), &TrackDef { weight: 0.0, sync_group, ..TrackDef::new(clip) })
        })
    }

    /// Moves the character with its clips' root motion.
    pub fn follow_clips(&mut self, def: &CharacterDef) {
        self.wish = None;
        if let Some(track) = self.looped_track(def) {
            self.animator.set_speed(track, 1.0);
            self.animator.set_weight(track, 1.0);
        }
        let idle = def.motions().idle.map(|idle| def.clip(idle));
        let faster = def.paces().iter().skip(1).map(|pace| pace.clip);
        for clip in idle.into_iter().chain(faster) {
            if let Some(track) = self.track_of(clip) {
                self.animator.set_weight(track, 0.0);
            }
        }
    }

    fn looped_track(&self, def: &CharacterDef) -> Option<TrackId> {
        self.track_of(def.clip(def.motions().looped?))
    }

    fn track_of(&self, clip: ClipId) -> Option<TrackId> {
        let plays = |track: &&sinew_anim::Track| track.def().clip == clip && track.def().layer == 0;
        self.animator.tracks().find(plays).map(sinew_anim::Track::id)
    }

    /// Returns the predicted transform of the character in `seconds`, relative to its present one, according to its
    /// mover or else to its clips.
    pub fn gone_on(
        &self,
        def: &CharacterDef,
        rotation: Rotation,
        place: Transform,
        ahead: &Animator,
        seconds: f32,
    ) -> Transform {
        let step = root_step(def, ahead);
        if self.mover.is_some() {
            let way = rotation.inverse() * self.velocity * seconds;
            let keeps = self.wish.is_some() || self.facing.is_some();
            let turn = if keeps { Rotation::IDENTITY } else { step.rotation };
            return Transform::new(place.translation + way, place.rotation * turn);
        }
        let mut place = place * step;
        place.translation += Vec3::Y * (self.climbing * seconds);
        place
    }

    /// Adds a mover at the position `place`, with the share `share` of its full height.
    pub fn stand_up(&mut self, def: &CharacterDef, place: Vec3, world: &mut World, share: f32) {
        let Some(mover) = def.in_world.mover.as_ref().filter(|_| self.mover.is_none()) else { return };
        let height = max(2.0 * mover.radius, share * mover.height);
        let position = place + Vec3::Y * mover.skin;
        let lets_pass = match def.in_world.hit_bodies {
            HitBodies::Present(yields) => max(yields.max_impulse, mover.lets_pass),
            HitBodies::Absent => mover.lets_pass,
        };
        let mover = MoverDef { position, height, lets_pass, ..mover.clone() };
        self.mover = Some(world.add_mover(&mover));
        (self.yaw, self.air, self.pace) = (0.0, 0.0, 0.0);
        (self.velocity, self.beside, self.falls) = (Vec3::ZERO, Vec3::ZERO, false);
        self.clear_shoves();
    }

    /// Returns true once the character has left the ground: immediately in a jump, with a delay over an edge or a kerb.
    pub fn is_aloft(&self) -> bool {
        self.air >= OFF_GROUND || self.air > 0.0 && self.velocity.y > LIFTS_OFF
    }

    /// Sets the velocity at which the character follows a held limb that is away from its clip by `off` and moves at
    /// `velocity`. The speed is the limb's own speed (a share of it while `off` is within the slack), plus a term that
    /// grows with the distance beyond the slack.
    pub fn follow_pull(&mut self, off: Vec3, velocity: Vec3, height: f32) {
        let level = Vec3::new(off.x, 0.0, off.z);
        let way = normalize_or(level, Vec3::ZERO);
        let slack = PULL_SLACK * height;
        let along = max(velocity.dot(way), 0.0) * min(level.length() / slack, 1.0);
        let speed = along + PULL_RATE * max(level.length() - slack, 0.0);
        self.pulled = way * min(speed, PULL_SPEED);
    }

    /// Clears shoves and pulls.
    fn clear_shoves(&mut self) {
        (self.shoved, self.blown, self.pulled) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    }

    /// Removes the mover of a lying character.
    pub fn sit_down(&mut self, world: &mut World) {
        self.clear_shoves();
        if let Some(mover) = self.mover.take().filter(|&mover| world.contains_mover(mover)) {
            world.remove_mover(mover);
        }
    }

    /// Moves the mover to a new position and clears the velocities and the offset.
    pub fn teleport(&mut self, place: Vec3, world: &mut World) {
        (self.air, self.beside, self.velocity) = (0.0, Vec3::ZERO, Vec3::ZERO);
        self.clear_shoves();
        if let Some(mover) = self.mover {
            let skin = world.mover(mover).def().skin;
            world.set_mover_position(mover, place + Vec3::Y * skin);
        }
    }
}

/// Returns a rotation that is turned about the vertical by at most `most` radians, so that its +z points more toward
/// the horizontal direction.
fn turned_to(rotation: Rotation, direction: Vec3, most: f32) -> Rotation {
    let ahead = rotation * Vec3::Z;
    let angle = trig::atan2(
        ahead.z * direction.x - ahead.x * direction.z,
        ahead.x * direction.x + ahead.z * direction.z,
    );
    Rotation::from_axis_angle(Vec3::Y, clamp(angle, -most, most)) * rotation
}
