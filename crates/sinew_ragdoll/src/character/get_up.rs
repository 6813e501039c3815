//! Get-ups: choice of clip and start, free space, and heading.

use super::CharacterDef;
use super::figure::Figure;
use super::moves::{GetUp, Start};
use super::pose_similarity::{PoseSimilarity, Stance};
use crate::character::tuning::{BEARS, BEARS_FOR, INTO_STANDING, ON_TOP, STANDS, STRAIGHTENS};
use sinew_anim::{Animator, TrackId, smoothstep};
use sinew_math::{Rotation, Transform, Vec3};
use sinew_physics::{BodyContact, BodyId, BodyKind, Effect, World};

/// A character that gets up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rising {
    pub way: Way,
    /// Slope of the ground: rotation from the vertical to the ground's normal, as a scaled axis in world axes.
    pub lean: Vec3,
}

/// Method by which a character gets up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Way {
    /// The track plays a get-up clip.
    ByClip(TrackId),
    /// Only the looped clip plays. The get-up lasts for this many more seconds.
    Without(f32),
}

/// Outcome of a step of a get-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Risen {
    /// The get-up continues.
    NotYet,
    /// The get-up clip is over.
    ByClip,
    /// The get-up without a clip is over.
    Without,
}

impl Rising {
    /// Returns the remaining share of a get-up until the character stands upright: 1 and more while it lies, 0 and less
    /// once it stands.
    pub fn left(&self, def: &CharacterDef, animator: &Animator) -> f32 {
        match self.way {
            Way::ByClip(id) => {
                let time = animator.track(id).map(|track| (track.playhead().clip_time(), track.def().clip));
                time.map_or(0.0, |(time, clip)| {
                    let duration = def.set().clip(clip).clip.duration();
                    (duration - time) / (STRAIGHTENS * duration)
                })
            }
            Way::Without(seconds) => seconds / INTO_STANDING,
        }
    }

    /// Returns true if the character gets up without a get-up clip.
    pub fn is_without_clip(&self) -> bool {
        matches!(self.way, Way::Without(_))
    }

    /// Tilts the transform by the slope while the character lies, because clips are made for a level floor, and makes
    /// it upright toward the end.
    pub fn straighten(&self, def: &CharacterDef, animator: &Animator, figure: &mut Figure) {
        if self.lean == Vec3::ZERO {
            return;
        }
        let before = figure.place.rotation;
        // The rotation contains the remaining lean after the last step; the heading is the rotation without the lean.
        let heading = Rotation::from_axis_angle(Vec3::Y, before.twist_angle(Vec3::Y));
        let left = smoothstep(self.left(def, animator));
        figure.place.rotation = Rotation::from_scaled_axis(self.lean * left) * heading;
    }

    /// Advances by `dt` seconds.
    pub fn go_on(&mut self, animator: &Animator, dt: f32) -> Risen {
        match &mut self.way {
            Way::ByClip(track) => {
                let is_over = animator.track(*track).is_none_or(|track| track.playhead().is_at_end(1.0));
                if is_over { Risen::ByClip } else { Risen::NotYet }
            }
            Way::Without(left) => {
                *left -= dt;
                if *left <= 0.0 { Risen::Without } else { Risen::NotYet }
            }
        }
    }
}

/// A get-up clip, the clip time that is most similar to the present pose, and their similarity.
#[derive(Clone, Copy, Debug)]
pub(super) struct Choice<'a> {
    pub get_up: &'a GetUp,
    pub start: &'a Start,
    pub pose_similarity: PoseSimilarity,
}

/// Returns the get-up clip and start time that fit the stance `lies` best. Returns `None` if there are no clips, or if
/// the character stands in nearly the pose of its looped clip and needs no get-up.
pub(super) fn choose<'a>(def: &'a CharacterDef, lies: &Stance) -> Option<Choice<'a>> {
    let moves = def.moves();
    let all = moves.get_ups.iter().flat_map(|get_up| get_up.starts.iter().map(move |start| (get_up, start)));
    let best = all
        .map(|(get_up, start)| Choice {
            get_up,
            start,
            pose_similarity: moves.landmarks.compare(&start.stance, lies),
        })
        .reduce(|a, b| if b.pose_similarity.distance < a.pose_similarity.distance { b } else { a })?;
    let upright = moves.landmarks.compare(&moves.upright, lies);
    let turn = (upright.motion.rotation * moves.upright.pelvis).angle_to(lies.pelvis);
    let stands = turn < STANDS[0] && upright.distance < STANDS[1] * def.ragdoll.height;
    (!stands || best.pose_similarity.distance < upright.distance).then_some(best)
}

/// Returns the transform `place` tilted by `lean`, at the height at which the character's floor is at the height
/// `ground` under the pelvis.
pub(super) fn standing(place: Transform, lean: Vec3, pelvis: Vec3, ground: f32) -> Transform {
    let mut to = Transform::new(place.translation, Rotation::from_scaled_axis(lean) * place.rotation);
    let normal = Rotation::from_scaled_axis(lean) * Vec3::Y;
    let away = to.translation - pelvis;
    to.translation.y = ground - (normal.x * away.x + normal.z * away.z) / normal.y;
    to
}

/// Returns true if another mover occupies the position of the character's mover.
pub(super) fn is_taken(def: &CharacterDef, world: &World, place: Vec3) -> bool {
    let Some(own) = &def.in_world.mover else { return false };
    world.mover_ids().any(|id| {
        let other = world.mover(id);
        let away = other.position() - place;
        let is_level = away.y < own.height && -away.y < other.def().height;
        let apart = own.radius + other.def().radius;
        is_level && away.x * away.x + away.z * away.z < apart * apart
    })
}

/// Returns true if the character must wait because a kinematic body stands on it, or because the load of dynamic bodies
/// on it exceeds its own load on them. Returns false once it has waited for [`BEARS_FOR`]. The net loads of the
/// characters in a pile sum to zero, so at least one of them is always free. `steps` is the number of steps for which
/// the character has lain.
pub(super) fn is_under(def: &CharacterDef, own: &[BodyId], steps: u32, world: &World) -> bool {
    let dt = world.def().dt();
    if steps as f32 * dt > BEARS_FOR {
        return false;
    }
    let weight = def.ragdoll.total_mass * world.def().gravity.length();
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
