//! Steering: where a character's mover is to go, and how the character goes with it.

use super::{Character, State};
use crate::character::tuning::{
    FASTEST_PACE, MOST_BESIDE, PACE_RATE, PICKS_UP, PUSHED_ASIDE, STANDS_BELOW, STANDS_IN, STEP_SETTLES,
    STEP_SLOPE,
};
use sinew_anim::{ClipId, MotionTrack, TrackDef, TrackId, smoothstep};
use sinew_math::{Rotation, Transform, Vec3, clamp, max, min, normalize_or, trig};
use sinew_physics::World;

impl Character {
    /// Has it go at a velocity over the ground from now on, m/s, whatever its clips do: they are played as fast as it really
    /// goes. Its part along up does nothing. Without a mover nothing happens.
    ///
    /// # Panics
    /// If the velocity is not finite.
    pub fn set_move(&mut self, velocity: Vec3) {
        assert!(velocity.is_finite(), "a velocity is finite");
        if let Some(presence) = &mut self.presence {
            presence.wish = Some(velocity);
        }
    }

    /// Has it go as its clips go again, which it does to begin with.
    pub fn follow_clips(&mut self) {
        if let Some(presence) = &mut self.presence {
            presence.wish = None;
        }
        if let Some(track) = self.looped_track() {
            self.animator.set_speed(track, 1.0);
            self.animator.set_weight(track, 1.0);
        }
        if let Some(track) = self.def.motions().idle.and_then(|idle| self.track_of(self.def.clip(idle))) {
            self.animator.set_weight(track, 0.0);
        }
    }

    /// Has it turn to look along a direction, at [`InWorld::turn_speed`](super::InWorld::turn_speed), once it stands. A direction that is
    /// level nowhere does nothing.
    ///
    /// # Panics
    /// If the direction is not finite.
    pub fn face(&mut self, direction: Vec3) {
        assert!(direction.is_finite(), "a direction is finite");
        let level = normalize_or(direction * Vec3::new(1.0, 0.0, 1.0), Vec3::ZERO);
        if let Some(presence) = self.presence.as_mut().filter(|_| level != Vec3::ZERO) {
            presence.facing = Some(level);
        }
    }

    /// Has it jump in the next step, if it has ground then.
    pub fn jump(&mut self, world: &mut World) {
        if let Some(mover) = self.mover() {
            world.mover_jump(mover, self.def.in_world.jump_speed);
        }
    }

    /// Puts it elsewhere at once, standing; what lies between is not asked. A character that lies is brought there as it lies, springs and
    /// garments as they swing; [`reset_springs`](Self::reset_springs) and [`reset_garments`](Self::reset_garments) start those over.
    ///
    /// # Panics
    /// If the place is not finite.
    pub fn teleport(&mut self, world: &mut World, world_from_character: Transform) {
        assert!(world_from_character.is_finite(), "a character stands at a finite place");
        let from = self.world_from_character;
        let moved = world_from_character * from.inverse();
        self.world_from_character = world_from_character;
        self.earlier.world_from_character = moved * self.earlier.world_from_character;
        self.shown.world_from_character = moved * self.shown.world_from_character;
        for &body in self.own() {
            let velocity = world.velocity(body);
            world.set_transform(body, moved * world.transform(body));
            let turned = |v: Vec3| moved.rotation * v;
            let velocity = sinew_physics::Velocity {
                linear: turned(velocity.linear),
                angular: turned(velocity.angular),
            };
            world.set_velocity(body, velocity);
        }
        self.scratch.posed.clear();
        self.swing.carry(self.def.springs(), moved);
        self.worn.carry(world, moved);
        // Pins are fixed to the world: they would pull it back.
        match (self.state, &self.ragdoll) {
            (State::Flinching | State::Powered, _) => self.drive_bodies(world),
            (State::Preparing, Some(ragdoll)) => self.drives.release(world, ragdoll),
            _ => {}
        }
        let Some(presence) = &mut self.presence else { return };
        presence.before.iter_mut().for_each(|pose| *pose = moved * *pose);
        (presence.air, presence.beside, presence.velocity) = (0.0, Vec3::ZERO, Vec3::ZERO);
        presence.stumble = None;
        if let Some(mover) = presence.mover {
            let skin = world.mover(mover).def().skin;
            world.set_mover_position(mover, world_from_character.translation + Vec3::Y * skin);
        }
    }

    /// Place that it comes to within a step, with the mover that stands for it; notes what the mover feels.
    pub(super) fn ride(&mut self, world: &World, step: Transform) -> Option<Transform> {
        let from = self.world_from_character;
        // Who lies would be swung about by its feet: it turns as it comes to stand.
        let turns = self.def.in_world.turn_speed * (1.0 - self.lowness());
        let presence = self.presence.as_mut()?;
        let mover = world.mover(presence.mover?);
        let settings = &self.def.in_world;
        let dt = world.def().dt();
        let (feet, velocity) = (mover.position(), mover.velocity());
        let ground = world.mover_ground(presence.mover?);
        let floor = ground.map_or(Vec3::ZERO, |ground| ground.velocity);
        let way = feet - mover.interpolated(0.0);
        let level = |v: Vec3| Vec3::new(v.x, 0.0, v.z);
        let beyond = way - velocity * dt;
        // What overlaps it, and a tread in front of it, push it aside within a step.
        let aside = if ground.is_some() { level(beyond) } else { beyond };
        let pushed = aside * max(1.0 - PUSHED_ASIDE * dt / max(aside.length(), 1e-6), 0.0);
        presence.beside -= pushed;
        if ground.is_some() && beyond.y.abs() > STEP_SLOPE * level(way - pushed).length() + 1e-3 {
            presence.beside.y -= beyond.y;
        }
        let length = max(presence.beside.length(), 1e-6);
        presence.beside *= min(MOST_BESIDE / length, 1.0) * trig::exp(-STEP_SETTLES * dt);
        let fell = floor.y - presence.velocity.y;
        let landed = ground.is_some() && presence.air > 0.0;
        presence.air = if ground.is_some() { 0.0 } else { presence.air + dt };
        presence.falls = presence.air > settings.air_time || landed && fell > settings.landing_speed;
        // What falls keeps the velocity with which it came down.
        if !(presence.falls && landed) {
            presence.velocity = velocity;
        }
        self.speed = level(velocity - floor).length();
        let carried = Rotation::from_axis_angle(Vec3::Y, mover.yaw() - presence.yaw);
        presence.yaw = mover.yaw();
        let heading = carried * from.rotation;
        let rotation = match presence.facing {
            Some(facing) => turned_to(heading, facing, turns * dt),
            None if presence.wish.is_some() => heading,
            None => heading * step.rotation,
        };
        // The mover keeps its skin free, the character stands on its soles.
        Some(Transform::new(feet + presence.beside - Vec3::Y * mover.def().skin, rotation.normalize()))
    }

    /// Tells the mover where to go in the next step, and lets it grow to its height.
    pub(super) fn steer(&mut self, world: &mut World) {
        self.spare_bearer(world);
        let Some(mover) = self.mover() else { return };
        let walk = match self.stumbling() {
            Some(stumble) => stumble.velocity,
            None => self.reachable_walk(world),
        };
        world.set_mover_walk(mover, if walk.is_finite() { walk } else { Vec3::ZERO });
        let stands = self.state != State::GettingUp;
        let height = self.def.in_world.mover.as_ref().map_or(0.0, |mover| mover.height);
        if world.mover(mover).def().height < height && (stands || self.lies_still() < 0.5) {
            world.set_mover_height(mover, height);
        }
    }

    /// [`wanted_walk`](Self::wanted_walk), or as near to it as what stands on its own feet gets within a step.
    fn reachable_walk(&self, world: &World) -> Vec3 {
        let dt = world.def().dt();
        let wish = self.wanted_walk(dt);
        let Some(presence) = self.presence.as_ref().filter(|_| self.steps()) else { return wish };
        let ground = presence.mover.and_then(|mover| world.mover_ground(mover));
        let Some(ground) = ground else { return wish };
        let now = (presence.velocity - ground.velocity) * Vec3::new(1.0, 0.0, 1.0);
        let change = wish - now;
        now + change * min(PICKS_UP * dt / max(change.length(), 1e-6), 1.0)
    }

    /// Velocity over the ground at which it is to go in a step of `dt` seconds: as it was told, or as its clips go.
    pub(super) fn wanted_walk(&self, dt: f32) -> Vec3 {
        let stands = self.state != State::GettingUp;
        let step = self.step_of(&self.animator).translation;
        let wish = self.presence.as_ref().and_then(|presence| presence.wish).filter(|_| stands);
        wish.unwrap_or(self.world_from_character.rotation * step / dt * Vec3::new(1.0, 0.0, 1.0))
    }

    /// Plays the looped clip as fast as the character goes, and lets it stand where it does not.
    pub(super) fn keep_pace(&mut self, dt: f32) {
        let Some(presence) = self.presence.as_mut().filter(|presence| presence.mover.is_some()) else {
            return;
        };
        if presence.wish.is_none() {
            return;
        }
        presence.pace += (self.speed - presence.pace) * -trig::exp_m1(-PACE_RATE * dt);
        let pace = presence.pace;
        let Some(walk) = self.looped_track() else { return };
        let natural = self.natural_speed();
        if natural > 0.0 {
            self.animator.set_speed(walk, clamp(pace / natural, 0.0, FASTEST_PACE));
        }
        let Some(idle) = self.def.motions().idle.map(|idle| self.def.clip(idle)) else { return };
        let def = self.def.clone();
        let idle = self.track_of(idle).unwrap_or_else(|| {
            self.animator.play(def.set(), &TrackDef { weight: 0.0, ..TrackDef::new(idle) })
        });
        let wanted = smoothstep(clamp(pace / STANDS_BELOW, 0.0, 1.0));
        let now = self.animator.track(walk).map_or(wanted, |track| track.def().weight);
        let share = clamp(wanted, now - dt / STANDS_IN, now + dt / STANDS_IN);
        self.animator.set_weight(walk, share);
        self.animator.set_weight(idle, 1.0 - share);
    }

    /// Speed at which the looped clip goes over the ground, m/s.
    fn natural_speed(&self) -> f32 {
        let Some(looped) = self.def.motions().looped else { return 0.0 };
        let clip = self.def.set().clip(self.def.clip(looped));
        let stride = clip.motion.as_ref().map_or(0.0, MotionTrack::stride);
        stride * self.def.ragdoll.unit_scale / max(clip.clip.duration(), 1e-3)
    }

    pub(super) fn looped_track(&self) -> Option<TrackId> {
        self.track_of(self.def.clip(self.def.motions().looped?))
    }

    fn track_of(&self, clip: ClipId) -> Option<TrackId> {
        let plays = |track: &&sinew_anim::Track| track.def().clip == clip && track.def().layer == 0;
        self.animator.tracks().find(plays).map(sinew_anim::Track::id)
    }

    /// Place that it comes to in `seconds` more, seen from where it stands now: by its mover, or by its clips.
    pub(super) fn gone_on(&self, place: Transform, ahead: &sinew_anim::Animator, seconds: f32) -> Transform {
        let step = self.step_of(ahead);
        match self.presence.as_ref().filter(|presence| presence.mover.is_some()) {
            Some(presence) => {
                let way = self.world_from_character.rotation.inverse() * presence.velocity * seconds;
                let keeps = presence.wish.is_some() || presence.facing.is_some();
                let turn = if keeps { Rotation::IDENTITY } else { step.rotation };
                Transform::new(place.translation + way, place.rotation * turn)
            }
            None => {
                let mut place = place * step;
                place.translation += Vec3::Y * (self.climbing * seconds);
                place
            }
        }
    }
}

/// A rotation turned about the vertical so that +z comes toward a level direction, by an angle at most.
fn turned_to(rotation: Rotation, direction: Vec3, most: f32) -> Rotation {
    let ahead = rotation * Vec3::Z;
    let angle = trig::atan2(
        ahead.z * direction.x - ahead.x * direction.z,
        ahead.x * direction.x + ahead.z * direction.z,
    );
    Rotation::from_axis_angle(Vec3::Y, clamp(angle, -most, most)) * rotation
}
