//! Built-in human motions: the [mannequin](crate::mannequin)'s walk, idle and both get-ups, retargeted to any humanoid
//! whose file lacks them.

mod clearing;
mod own;

pub use own::{OwnMotions, looped_among, own_motions};

use crate::anim::contact::footsteps;
use crate::anim::legs::Legs;
use crate::anim::retarget::{Body, Pace, RetargetError, RetargetOptions, Retargeted, retarget};
use crate::anim::riders::Riders;
use crate::anim::{Channel, Clip, ClipEvent, Interpolation, Rig, RigAnalysis, analyze};
use crate::mannequin::{Mannequin, mannequin};
use crate::math::{clamp, min};
use crate::ragdoll::{AfterSettling, CharacterDef, Locomotion, MotionError, MotionSet, Opening};
use clearing::Clearing;

/// The mannequin's motions on a character.
#[derive(Clone, Debug)]
pub struct BuiltinMotions {
    /// A cycle of two steps on the spot.
    pub walk: Clip,
    /// Forward speed of this character at which the feet of `walk` do not slide, m/s.
    pub walk_speed: f32,
    /// Footfalls of `walk`: events `footstep` with the payload `left` or `right`.
    pub footsteps: Vec<ClipEvent>,
    /// Standing and breathing, a cycle that starts at the final pose of the get-ups.
    pub idle: Clip,
    /// Get-ups: from lying on the back, and on the face.
    pub get_ups: [Clip; 2],
    /// Retargeting quality of walk, idle and get-ups on the character, in that order.
    pub fits: [Retargeted; 4],
}

/// Reason why a character was not given the built-in motions.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuiltinError {
    /// The built-in motions are those of a human, and the character is not human.
    #[error("the built-in motions are a human's: {0}")]
    Retarget(#[from] RetargetError),
    /// A clip cannot be played.
    #[error(transparent)]
    Motion(#[from] MotionError),
    /// No built-in get-up works on the character's body.
    #[error(
        "the built-in get-ups do not fit its build: it, or what it holds, would be {0:.2} m in the floor"
    )]
    InFloor(f32),
}

/// Depth in the floor above which a get-up is rejected, as a share of the character's height. Raising the body and
/// bending its limbs cannot correct greater depths.
const LEFT_OUT: f32 = 0.2;

/// Retargets the built-in motions to a humanoid, by the roles of its joints. Where its bodies would be in the floor,
/// the body or the hands are raised. Durations are proportional to the square root of the leg length (Froude).
///
/// ```
/// use sinew::anim::RigAnalysis;
/// use sinew::motions::builtin_motions;
/// use sinew::ragdoll::CharacterDef;
///
/// fn walk_speed(def: &CharacterDef, analysis: &RigAnalysis) -> Option<f32> {
///     builtin_motions(def, analysis).ok().map(|motions| motions.walk_speed)
/// }
/// ```
///
/// # Errors
/// If the character lacks the roles of a humanoid or hips, or has fewer than two complete legs.
///
/// # Panics
/// If the analysis does not belong to the rig.
pub fn builtin_motions(def: &CharacterDef, analysis: &RigAnalysis) -> Result<BuiltinMotions, RetargetError> {
    carried_over(def, analysis, None)
}

/// As [`builtin_motions`], but moves props with the joints that carry them in the clip `holds` of the character.
fn carried_over(
    def: &CharacterDef,
    analysis: &RigAnalysis,
    holds: Option<&Clip>,
) -> Result<BuiltinMotions, RetargetError> {
    let rig = &def.rig;
    let riders = Riders::of(rig, analysis);
    let riders = holds.map_or(riders.clone(), |clip| riders.as_in(rig, clip));
    let mut model = Vec::new();
    let Mannequin { rig: actor_rig, clips, motions } = mannequin();
    let actor_analysis = analyze(&actor_rig).expect("the mannequin has a skin");
    let actor = Body { rig: &actor_rig, analysis: &actor_analysis };
    let body = Body { rig, analysis };
    let clearing = Clearing::new(def, analysis);
    let mut onto = |clip: &Clip, bends: bool| -> Result<Retargeted, RetargetError> {
        let mut fitted = retarget(actor, clip, body, &options(actor, body))?;
        if let Some(clearing) = &clearing {
            clearing.clear(&mut fitted);
            for frame in 0..if bends { fitted.take.frames() } else { 0 } {
                def.raise_limbs(fitted.take.pose_mut(frame));
            }
        }
        (0..fitted.take.frames())
            .for_each(|frame| riders.carry(rig, fitted.take.pose_mut(frame), &mut model));
        Ok(fitted)
    };
    let [walks, idles] = [motions.walk, motions.idle].map(|cycle| {
        let clip = &clips[cycle];
        onto(&repeated(clip, PLAYED), false).map(|fitted| one_round(fitted, clip))
    });
    let (walks, idles) = (walks?, idles?);
    let (supine, prone) =
        (onto(&clips[motions.get_up_supine], true)?, onto(&clips[motions.get_up_prone], true)?);
    let walk = walks.clip(rig, &clips[motions.walk].name);
    Ok(BuiltinMotions {
        footsteps: footsteps(rig, analysis, &walk).unwrap_or_default().events,
        walk,
        walk_speed: motions.walk_speed * walks.scale / walks.pace,
        idle: idles.clip(rig, &clips[motions.idle].name),
        get_ups: [
            supine.clip(rig, &clips[motions.get_up_supine].name),
            prone.clip(rig, &clips[motions.get_up_prone].name),
        ],
        fits: [walks, idles, supine, prone],
    })
}

impl BuiltinMotions {
    /// Adds the motions that a character's own clips lack: get-ups, idle, and the walk if no clip loops. The walk
    /// starts after the first get-up; until then the character stands in its rest pose. The walk has events `footstep`
    /// with the payload `left` or `right`.
    pub fn fill_in(self, own: MotionSet) -> MotionSet {
        let mut set = own;
        if set.get_ups.is_empty() {
            set.get_ups = vec![set.clips.len(), set.clips.len() + 1];
            set.clips.extend(self.get_ups);
        }
        if set.idle.is_none() {
            set.idle = Some(set.clips.len());
            set.clips.push(self.idle);
        }
        if set.looped.is_none() {
            let walk = set.clips.len();
            set.looped = Some(walk);
            set.events.extend(self.footsteps.into_iter().map(|step| (walk, step)));
            set.clips.push(self.walk);
            set.locomotion = Locomotion::Forward { speed: self.walk_speed };
            set.opening = Opening::Rest;
        }
        set
    }
}

/// Gives a character motions, and adds the missing built-in ones. The character then gets up, and continues with its
/// own looped clip, or with the walk if it has none. A get-up that would be deep in the floor on its body is left out.
///
/// # Errors
/// If the character is not humanoid, a clip is unplayable, or no get-up works on its body; its motions are then
/// unchanged.
///
/// # Panics
/// As [`CharacterDef::set_motions`].
pub fn set_motions_with_builtin(
    def: &mut CharacterDef,
    analysis: &RigAnalysis,
    own: MotionSet,
) -> Result<(), BuiltinError> {
    let holds = own.looped.and_then(|looped| own.clips.get(looped));
    let builtin = carried_over(def, analysis, holds)?;
    let depths = [2, 3].map(|fit| def.deepest_skin(&builtin.fits[fit].take));
    let comes_out = depths.map(|depth| depth <= LEFT_OUT * def.ragdoll.height);
    let is_filled = own.get_ups.is_empty();
    if is_filled && comes_out == [false; 2] {
        return Err(BuiltinError::InFloor(min(depths[0], depths[1])));
    }
    let first = own.clips.len();
    let mut motions = builtin.fill_in(own);
    hold_as_looped(&def.rig, &mut motions, first);
    if is_filled {
        let mut fits = comes_out.into_iter();
        motions.get_ups.retain(|_| fits.next().unwrap_or(true));
    }
    def.set_motions(motions)?;
    def.after_settling = AfterSettling::GetUp;
    Ok(())
}

/// For every joint that the clips from `first` on do not animate, adds its pose at the start of the looped clip:
/// fingers, a jaw, or a weapon, which need not be in the hand in the rig's rest pose. Ancestors of joints that a clip
/// moves stay unchanged.
fn hold_as_looped(rig: &Rig, motions: &mut MotionSet, first: usize) {
    let Some(looped) = motions.looped.filter(|&index| index < first) else { return };
    let held = motions.clips[looped].channels.clone();
    for clip in &mut motions.clips[first..] {
        let mut carries = vec![false; rig.joints.len()];
        clip.channels.iter().for_each(|channel| carries[channel.joint] = true);
        for (joint, above) in rig.joints.iter().enumerate().rev() {
            if let Some(parent) = above.parent.filter(|_| carries[joint]) {
                carries[parent] = true;
            }
        }
        for channel in held.iter().filter(|channel| !carries[channel.joint]) {
            let width = channel.property.width();
            // A cubic key has three numbers; the middle one is the value.
            let at = if channel.interpolation == Interpolation::CubicSpline { width } else { 0 };
            let values = channel.values[at..at + width].to_vec();
            let interpolation = Interpolation::Linear;
            clip.channels.push(Channel { interpolation, times: vec![0.0], values, ..channel.clone() });
        }
    }
}

/// Frames per second of the retargeted motions, at the mannequin's pace.
const RATE: f64 = 30.0;
/// Number of repetitions of a cycle, so that the middle repetition has both neighbours.
const PLAYED: usize = 3;

/// Returns the retargeting options: pace of `body` relative to `actor`, floor, and frame time.
fn options(actor: Body<'_>, body: Body<'_>) -> RetargetOptions {
    let legs = |body: Body<'_>| {
        Legs::of(body.rig, body.analysis).map(|legs| legs.feet[0].length + legs.feet[1].length)
    };
    let pace = legs(body).zip(legs(actor)).map_or(1.0, |(own, actor)| (own / actor).sqrt());
    let frame_time = f64::from(pace) / RATE;
    RetargetOptions { pace: Pace::Times(pace), floor: Some(0.0), frame_time, ..RetargetOptions::default() }
}

/// Cuts the middle repetition out of a repeated cycle; its last pose equals its first.
fn one_round(mut fitted: Retargeted, clip: &Clip) -> Retargeted {
    let joints = fitted.take.joints;
    let frames = (f64::from(clip.duration) * RATE).round() as usize;
    let mut round = fitted.take.poses[frames * joints..2 * frames * joints].to_vec();
    round.extend_from_within(..joints);
    fitted.take.poses = round;
    let length = clip.duration * fitted.pace;
    for contact in &mut fitted.contacts {
        contact.start = clamp(contact.start - length, 0.0, length);
        contact.end = clamp(contact.end - length, 0.0, length);
    }
    fitted.contacts.retain(|contact| contact.start < contact.end);
    fitted
}

/// Repeats a clip of linear keys `times` times.
fn repeated(clip: &Clip, times: usize) -> Clip {
    let mut whole = Clip { duration: clip.duration * times as f32, ..clip.clone() };
    for (channel, one) in whole.channels.iter_mut().zip(&clip.channels) {
        // The last key of a round equals the first key of the next.
        let width = channel.property.width();
        for round in 1..times {
            let later = one.times.iter().skip(1).map(|time| time + round as f32 * clip.duration);
            channel.times.extend(later);
            channel.values.extend(one.values.iter().skip(width));
        }
    }
    whole
}
