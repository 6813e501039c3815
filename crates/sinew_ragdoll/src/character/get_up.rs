//! From lying to standing: which clip, from which moment, where, and which way round.

use super::memory::Rising;
use super::moves::{GetUp, Start};
use super::pose_similarity::{PoseSimilarity, Stance};
use super::{Character, CharacterEvent, State, ground};
use crate::character::tuning::{
    ABOVE_PELVIS, BEARS, BEARS_FOR, INTO_GET_UP, INTO_LOOP, INTO_STANDING, LYING_MOVER, ON_TOP, STRAIGHTENS,
};
use sinew_anim::{Animator, LoopMode, Pose, Track, TrackDef, TrackId, local_to_model, smoothstep};
use sinew_math::{Affine, Rotation, Transform, Vec3};
use sinew_physics::{BodyContact, BodyId, BodyKind, Effect, World};

/// A get-up clip, the moment of it that is most like the present pose, and how much that is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice<'a> {
    pub get_up: &'a GetUp,
    pub start: &'a Start,
    pub pose_similarity: PoseSimilarity,
}

/// The best of all clips and moments for a body that lies like that in the world.
pub(super) fn choose<'a>(
    get_ups: &'a [GetUp],
    landmarks: &super::pose_similarity::Landmarks,
    lies: &Stance,
) -> Option<Choice<'a>> {
    let all = get_ups.iter().flat_map(|get_up| get_up.starts.iter().map(move |start| (get_up, start)));
    all.map(|(get_up, start)| Choice {
        get_up,
        start,
        pose_similarity: landmarks.compare(&start.stance, lies),
    })
    .reduce(|a, b| if b.pose_similarity.distance < a.pose_similarity.distance { b } else { a })
}

impl Character {
    /// The present pose in the world. Its points may be given back to [`Scratch`](super::Scratch).
    pub(super) fn stance(&mut self) -> Stance {
        let model = &mut self.scratch.model;
        local_to_model(&self.def.rig, &self.pose, &Affine::IDENTITY, model);
        let (points, bodies) = (core::mem::take(&mut self.scratch.points), &mut self.scratch.before);
        let landmarks = &self.def.moves().landmarks;
        landmarks.stance(self.def.mapping(), model, self.world_from_character, points, bodies)
    }

    /// Gives the pose back to the clips where nobody stands or lies on it: it lies until they have gone.
    pub(super) fn get_up_where_free(&mut self, world: &mut World) {
        let lies = self.stance();
        let moves = self.def.moves();
        let place = match choose(&moves.get_ups, &moves.landmarks, &lies) {
            Some(choice) => choice.pose_similarity.motion,
            None => moves.landmarks.compare(&moves.upright, &lies).motion,
        };
        let waits = self.is_taken(world, place.translation) || self.is_under(world);
        self.scratch.points = lies.points;
        // Who was on it may have got up in this update, and touches nothing before the next step.
        if core::mem::replace(&mut self.stillness.free, !waits) && !waits {
            self.get_up(world);
        }
    }

    /// True if another mover stands where its own would.
    fn is_taken(&self, world: &World, place: Vec3) -> bool {
        let (Some(_), Some(own)) = (&self.presence, &self.def.in_world.mover) else { return false };
        world.mover_ids().any(|id| {
            let other = world.mover(id);
            let away = other.position() - place;
            let is_level = away.y < own.height && -away.y < other.def().height;
            let apart = own.radius + other.def().radius;
            is_level && away.x * away.x + away.z * away.z < apart * apart
        })
    }

    /// True if it bears what could go away by itself, and has not done so for too long: a kinematic body that stands on it, or dynamic
    /// ones that press it down by more than it presses others. Of those who lie on each other these loads sum to none, so that one is
    /// always free to get up.
    fn is_under(&self, world: &World) -> bool {
        let dt = world.def().dt();
        if self.presence.is_none() || self.stillness.steps as f32 * dt > BEARS_FOR {
            return false;
        }
        let own = self.own();
        let weight = self.def.ragdoll.total_mass * world.def().gravity.length();
        let load = |contact: &BodyContact, other: BodyId, sign: f32| match world.kind(other) {
            BodyKind::Static => 0.0,
            BodyKind::Kinematic => {
                let is_on = contact.points().iter().any(|point| point.separation < 0.0);
                if is_on && sign * contact.normal.y > ON_TOP { f32::INFINITY } else { 0.0 }
            }
            BodyKind::Dynamic => sign * (contact.normal.y * contact.impulse() + contact.friction.y),
        };
        let loads = world.contacts().filter(|contact| contact.effect == Effect::Push).map(|contact| {
            let [a, b] = [contact.a.body, contact.b.body];
            match (own.contains(&a), own.contains(&b)) {
                (true, false) => load(&contact, b, 1.0),
                (false, true) => load(&contact, a, -1.0),
                _ => 0.0,
            }
        });
        loads.sum::<f32>() > BEARS * weight * dt
    }

    /// Gives the pose back to the clips, by the moment of a get-up clip that is most like it.
    pub(super) fn get_up(&mut self, world: &mut World) {
        let lies = self.stance();
        let lying = self.scratch.before.clone();
        let own = self.presence.as_ref().map(|_| self.own());
        self.lean = ground::slope(world, &lies.points, own);
        let def = self.def.clone();
        let moves = def.moves();
        match choose(&moves.get_ups, &moves.landmarks, &lies) {
            Some(Choice { get_up, start, pose_similarity }) => {
                self.settle_into(world, pose_similarity.motion, INTO_GET_UP);
                let from = self.shown_depths();
                self.pass(from, get_up.deepest, INTO_GET_UP);
                self.pass_to(&lying, pose_similarity.motion, &start.bodies);
                let once =
                    TrackDef { start: start.time, loop_mode: LoopMode::Once, ..TrackDef::new(get_up.id) };
                self.rising = Rising::ByClip(self.animator.play(def.set(), &once));
                self.events.push(CharacterEvent::GettingUp { clip: Some(get_up.clip) });
            }
            None => {
                self.settle_into(world, moves.landmarks.compare(&moves.upright, &lies).motion, INTO_STANDING);
                let from = self.shown_depths();
                self.pass(from, moves.deepest, INTO_STANDING);
                def.play_looped(&mut self.animator, 0.0);
                self.rising = Rising::Without(INTO_STANDING);
                self.events.push(CharacterEvent::GettingUp { clip: None });
            }
        }
        self.leave_bodies(world);
        self.state = State::GettingUp;
        if self.is_planted() {
            self.show_planted();
        }
        self.stand_up(world, LYING_MOVER);
    }

    /// Share of a get-up that is left until it stands upright: 1 and more as long as it still lies, 0 and less once it does.
    pub(super) fn lies_still(&self) -> f32 {
        match self.rising {
            Rising::ByClip(id) => {
                let time =
                    self.animator.track(id).map(|track| (track.playhead().clip_time(), track.def().clip));
                time.map_or(0.0, |(time, clip)| {
                    let duration = self.def.set().clip(clip).clip.duration();
                    (duration - time) / (STRAIGHTENS * duration)
                })
            }
            Rising::Without(seconds) => seconds / INTO_STANDING,
        }
    }

    /// On a slope the clip, made for a level floor, lies as the slope does and comes to stand upright.
    pub(super) fn straighten(&mut self) {
        if self.lean == Vec3::ZERO {
            return;
        }
        let before = self.world_from_character.rotation;
        // What is left of the lean after the last step is in the rotation: the heading is what it had without.
        let heading = Rotation::from_axis_angle(Vec3::Y, before.twist_angle(Vec3::Y));
        self.world_from_character.rotation =
            Rotation::from_scaled_axis(self.lean * smoothstep(self.lies_still())) * heading;
    }

    /// Goes on with a get-up, and ends it.
    pub(super) fn rise(&mut self, world: &World) {
        match &mut self.rising {
            Rising::ByClip(track) => {
                let is_over = |animator: &Animator, id| {
                    animator.track(id).is_none_or(|track| track.playhead().is_at_end(1.0))
                };
                if is_over(&self.animator, *track) {
                    self.stand(world);
                }
            }
            Rising::Without(left) => {
                *left -= world.def().dt();
                if *left <= 0.0 {
                    self.be_up();
                }
            }
        }
    }

    /// Back to the looped clip.
    fn stand(&mut self, world: &World) {
        let def = self.def.clone();
        let moves = def.moves();
        let stands = self.stance();
        let from = self.shown_depths();
        self.lean = Vec3::ZERO;
        self.settle_into(world, moves.landmarks.compare(&moves.upright, &stands).motion, INTO_LOOP);
        self.pass(from, moves.deepest, INTO_LOOP);
        def.play_looped(&mut self.animator, 0.0);
        self.be_up();
    }

    fn be_up(&mut self) {
        self.state = State::Animated;
        self.events.push(CharacterEvent::Up);
    }

    /// Stands on the ground at `place`, stops what plays on the whole body, and lets the present pose and its motion die
    /// away within `seconds` in what will be played. Nothing moves in the world yet.
    fn settle_into(&mut self, world: &World, place: Transform, seconds: f32) {
        let own = self.presence.as_ref().map(|_| self.own());
        let mapping = self.def.mapping();
        let pelvis = mapping.world_from_model(self.world_from_character).point({
            let joint = self.def.ragdoll.bodies[0].joint;
            self.scratch.model[joint].translation
        });
        let height = ground::below(world, pelvis, ABOVE_PELVIS, own)
            .unwrap_or(self.world_from_character.translation.y);
        let mut to =
            Transform::new(place.translation, Rotation::from_scaled_axis(self.lean) * place.rotation);
        // As high as the ground where the pelvis is, on the slope that it lies on.
        let normal = Rotation::from_scaled_axis(self.lean) * Vec3::Y;
        let away = to.translation - pelvis;
        to.translation.y = height - (normal.x * away.x + normal.z * away.z) / normal.y;
        mapping.reframe(&mut self.pose, self.world_from_character, to);
        mapping.reframe(&mut self.earlier.pose, self.earlier.world_from_character, to);
        self.world_from_character = to;
        self.earlier.world_from_character = to;
        mapping.reframe(&mut self.shown.pose, self.shown.world_from_character, to);
        self.shown.world_from_character = to;
        self.climbing = 0.0;
        let (earlier, now): (Pose, Pose) =
            (self.earlier.pose.iter().copied().collect(), self.pose.iter().copied().collect());
        self.animator.take_over(&earlier, &now, world.def().dt(), seconds);
        let set = self.def.set();
        let stopped: Vec<TrackId> =
            self.animator.tracks().filter(|track| track.def().layer == 0).map(Track::id).collect();
        stopped.into_iter().for_each(|track| self.animator.stop(set, track));
    }
}
