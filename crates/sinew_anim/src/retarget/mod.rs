//! Transfers an actor's motion to a character of another size and build.
//!
//! Joints are matched by [roles](crate::roles). Each gets the actor's rotation, corrected by the difference of the
//! reference poses, so that thighs and arms point in the actor's directions; the pelvis moves in proportion to leg
//! length; the feet are held where the actor's feet stand. All computation uses the bodies' own axes and metres, so
//! files may differ in up, facing and unit.

mod align;
mod reference;

pub use reference::{Reference, stand};

use crate::cleanup::{FootSlideReport, remove_foot_slide};
use crate::clip::Clip;
use crate::clip::take::Take;
use crate::contact::{
    ContactSettings, FootContact, FootSlide, Ground, contacts, flatten_soles, foot_slide, frames_of, lowest,
    sole_points, toes_up,
};
use crate::legs::{Foot, Legs};
use crate::pose::{local_to_model, rest_pose, smoothstep};
use crate::riders::Riders;
use crate::rig::{JointIdx, Rig};
use crate::roles::{RigAnalysis, Role, Side};
use crate::tuning::{FLOOR_TIME, FOOT_HOLD};
use align::Alignment;
use sinew_math::{Affine, Rotation, Vec3, direction, max};

/// A body: its rig and analysis.
#[derive(Clone, Copy, Debug)]
pub struct Body<'a> {
    /// Joints of the body.
    pub rig: &'a Rig,
    /// Roles of the rig; the bind pose is the reference pose. See [`stand`] for a skeleton without skin.
    pub analysis: &'a RigAnalysis,
}

/// Duration of the motion on a larger body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Pace {
    /// Same duration as the actor's.
    #[default]
    Actor,
    /// Duration times the square root of the ratio of leg lengths (Froude: similar walks have equal v²/(g l)), so that
    /// giants look large.
    Froude,
    /// Duration times this factor, above 0.
    Times(f32),
}

/// Treatment of the feet at the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Feet {
    /// Feet are held where the actor's feet stand, flat on the floor; those of legs without knees are free.
    #[default]
    Locked,
    /// Feet follow the rotations of the leg, and tilt like the actor's.
    Free,
}

/// Options for retargeting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RetargetOptions {
    /// Seconds from frame to frame of the result, above 0. Default 1/60.
    pub frame_time: f64,
    /// Duration of the motion. Default: the actor's.
    pub pace: Pace,
    /// Treatment of the feet. Default: locked.
    pub feet: Feet,
    /// Height of the actor's floor, metres along its up axis from the origin of its file. Default: derived from the
    /// feet.
    pub floor: Option<f32>,
}

impl Default for RetargetOptions {
    fn default() -> Self {
        Self { frame_time: 1.0 / 60.0, pace: Pace::default(), feet: Feet::default(), floor: None }
    }
}

/// Reason why a motion cannot be retargeted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RetargetError {
    /// A body is not recognised as humanoid, so it has only generic roles.
    #[error("the {0} is no humanoid: its joints have no roles to match")]
    NotHumanoid(&'static str),
    /// A joint that the method needs has no counterpart.
    #[error("the {0} has no joint for a role that is needed (hips, or a thigh, shank or foot)")]
    RoleMissing(&'static str),
    /// The frame time, the pace or a length is not above 0.
    #[error("{0} must be above 0 and finite")]
    NotPositive(&'static str),
    /// The clip lasts longer than [`Take::MOST_FRAMES`] frames.
    #[error("the clip lasts {0} frames, which exceeds the limit")]
    TooLong(usize),
}

/// A retargeted motion, and its quality.
#[derive(Clone, Debug, PartialEq)]
pub struct Retargeted {
    /// The retargeted motion, one pose per frame.
    pub take: Take,
    /// Foot contacts, seconds of the new motion.
    pub contacts: Vec<FootContact>,
    /// Roles that both bodies have, with the actor's and the character's joint.
    pub pairs: Vec<(Role, JointIdx, JointIdx)>,
    /// Roles of the character that the actor lacks: these joints follow their parents.
    pub unmatched: Vec<Role>,
    /// Ratio of the character's leg length to the actor's.
    pub scale: f32,
    /// Ratio of the duration to that of the actor's motion.
    pub pace: f32,
    /// Ground of the character, in its own axes, metres; it moves under a motion on the spot.
    pub ground: Ground,
    /// Foot slide of the actor, over the same contacts, for comparison.
    pub actor_slide: FootSlide,
    /// Foot slide of the character before and after holding the feet; equal if they are not held.
    pub feet: FootSlideReport,
}

impl Retargeted {
    /// Converts the motion to a clip of the character's rig.
    ///
    /// # Panics
    /// If `rig` is not the character's.
    pub fn clip(&self, rig: &Rig, name: &str) -> Clip {
        self.take.to_clip(rig, name)
    }
}

/// Transfers `clip`, a motion of `actor`, to `character`. The result has one pose of the character's rig every
/// [`frame_time`](RetargetOptions::frame_time) seconds, local transforms in its file's units; reported lengths are
/// metres by the unit scales of the two analyses. Run it once per clip, not each frame, because it allocates.
///
/// ```
/// use sinew_anim::retarget::{Body, RetargetOptions, retarget, stand};
/// use sinew_anim::{Clip, Rig, analyze};
///
/// fn walk_like(actor: &Rig, clip: &Clip, character: &Rig) -> Result<Clip, Box<dyn std::error::Error>> {
///     let (skeleton, _) = stand(actor, clip, None)?;
///     let skin = analyze(character)?;
///     let from = Body { rig: actor, analysis: &skeleton };
///     let to = Body { rig: character, analysis: &skin };
///     let walk = retarget(from, clip, to, &RetargetOptions::default())?;
///     Ok(walk.clip(character, "walk"))
/// }
/// ```
///
/// # Errors
/// If a body lacks the roles of a humanoid or hips, or has fewer than two complete legs; if a number is not above 0; if
/// the clip is too long.
///
/// # Panics
/// As [`sample`](crate::clip::sample::sample()).
pub fn retarget(
    actor: Body<'_>,
    clip: &Clip,
    character: Body<'_>,
    options: &RetargetOptions,
) -> Result<Retargeted, RetargetError> {
    let mut transfer = Transfer::new(actor, character)?;
    let scale = transfer.scale;
    let pace = match options.pace {
        Pace::Actor => 1.0,
        Pace::Froude => scale.sqrt(),
        Pace::Times(times) => times,
    };
    check(scale, "the ratio of leg lengths")?;
    check(pace, "the pace")?;
    check(options.frame_time as f32, "the frame time")?;
    let step = options.frame_time / f64::from(pace);
    let frames = crate::clip::take::frames_of(clip.duration, step);
    if frames > Take::MOST_FRAMES {
        return Err(RetargetError::TooLong(frames));
    }
    let source = Take::of(actor.rig, clip, step);
    if options.feet == Feet::Locked {
        transfer.flatten_soles(&source);
    }
    let steps = transfer.watch(&source, options.floor);
    let mut take = transfer.carry(&source, &steps, options.frame_time);
    let at_pace = |contact: &FootContact| FootContact {
        start: max((contact.start - FOOT_HOLD) * pace, 0.0),
        end: (contact.end + FOOT_HOLD) * pace,
        ..*contact
    };
    let contacts: Vec<FootContact> = steps.contacts.iter().map(at_pace).collect();
    let ground =
        Ground { height: character.analysis.floor, velocity: steps.ground.velocity * (scale / pace) };
    let feet = transfer.stand(options.feet, &contacts, &ground, &mut take);
    carry_riders(character, &mut take);
    Ok(Retargeted {
        feet,
        take,
        contacts,
        pairs: transfer.alignment.pairs.iter().map(|pair| (pair.role, pair.from, pair.to)).collect(),
        unmatched: transfer.alignment.unmatched,
        scale,
        pace,
        ground,
        actor_slide: steps.slide,
    })
}

/// Moves riders with their body part in every frame.
///
/// # Panics
/// If the take does not fit the character's rig.
fn carry_riders(character: Body<'_>, take: &mut Take) {
    let riders = Riders::of(character.rig, character.analysis);
    let mut model = Vec::new();
    for frame in 0..take.frames() {
        riders.carry(character.rig, take.pose_mut(frame), &mut model);
    }
}

fn check(number: f32, what: &'static str) -> Result<(), RetargetError> {
    if number > 0.0 && number.is_finite() { Ok(()) } else { Err(RetargetError::NotPositive(what)) }
}

/// Data of a retargeting that does not change from frame to frame.
struct Transfer<'a> {
    actor: Body<'a>,
    character: Body<'a>,
    alignment: Alignment,
    /// Transforms from the files' spaces to the bodies' own.
    actor_root: Affine,
    character_root: Affine,
    actor_feet: [Foot; 2],
    /// Legs of the character.
    legs: Legs,
    /// True if the character's legs have no knees.
    is_stiff: bool,
    /// Vector from the pelvis to the middle of its hip joints, in the pelvis' axes without scale, metres.
    hips_to_legs: Vec3,
    /// Ratio of the character's leg length to the actor's.
    scale: f32,
}

/// Contacts and slide of the actor's feet.
struct Steps {
    ground: Ground,
    contacts: Vec<FootContact>,
    /// Height of the lowest sole above the ground in each frame, metres; 0 while a foot stands.
    heights: Vec<f32>,
    slide: FootSlide,
}

impl<'a> Transfer<'a> {
    fn new(actor: Body<'a>, character: Body<'a>) -> Result<Self, RetargetError> {
        for (body, name) in [(actor, "actor"), (character, "character")] {
            if !body.analysis.humanoid {
                return Err(RetargetError::NotHumanoid(name));
            }
        }
        let mut alignment = Alignment::of(actor.analysis, character.analysis);
        let legs =
            |body: Body<'_>, name| Legs::of(body.rig, body.analysis).ok_or(RetargetError::RoleMissing(name));
        let (actor_feet, legs) = (legs(actor, "actor")?.feet, legs(character, "character")?);
        let is_stiff = legs.are_stiff(character.rig);
        let is_shown = |role: Role| !is_stiff || !matches!(role, Role::LowerLeg(_) | Role::Foot(_));
        alignment.pairs.retain(|pair| is_shown(pair.role));
        let root = character.analysis.character_from_file();
        let stands = |joint: JointIdx| (root * character.analysis.bind_model[joint]).to_rigid();
        let hip_joints = legs.feet.map(|foot| stands(foot.leg.upper).translation);
        let pelvis = stands(legs.pelvis);
        let length = |feet: &[Foot; 2]| 0.5 * (feet[0].length + feet[1].length);
        Ok(Self {
            actor,
            character,
            alignment,
            actor_root: actor.analysis.character_from_file(),
            character_root: root,
            scale: length(&legs.feet) / length(&actor_feet),
            actor_feet,
            hips_to_legs: pelvis.rotation.inverse()
                * ((hip_joints[0] + hip_joints[1]) * 0.5 - pelvis.translation),
            legs,
            is_stiff,
        })
    }

    /// Corrects the feet under the assumption that the actor's standing feet are flat in the motion, and so are the
    /// character's.
    fn flatten_soles(&mut self, source: &Take) {
        let points = sole_points(self.actor.rig, &self.actor_root, &self.actor_feet, source);
        let (tilts, flat) = flatten_soles(&self.actor_feet, &points);
        self.actor_feet = flat;
        for pair in &mut self.alignment.pairs {
            let (Role::Foot(side) | Role::Toes(side)) = pair.role else { continue };
            let tilt = tilts[usize::from(side == Side::Right)];
            let stands = (self.actor_root * self.actor.analysis.bind_model[pair.from]).to_rigid().rotation;
            pair.correction = (stands.inverse() * toes_up(-tilt) * stands * pair.correction).normalize();
        }
    }

    /// Finds the actor's ground and foot contacts.
    fn watch(&self, source: &Take, floor: Option<f32>) -> Steps {
        let feet = &self.actor_feet;
        let points = sole_points(self.actor.rig, &self.actor_root, feet, source);
        let settings = ContactSettings::for_leg(feet[0].length);
        let mut ground = Ground::under(source, &points, &settings);
        ground.height = floor.unwrap_or(ground.height);
        let points = ground.seen_from(source, points);
        let contacts = contacts(source, feet, &points, ground.height, &settings);
        let mut heights: Vec<f32> =
            points.iter().map(|frame| max(lowest(frame) - ground.height, 0.0)).collect();
        for contact in &contacts {
            let [first, last] = frames_of(source, contact, heights.len());
            heights[first..=last].fill(0.0);
        }
        Steps { ground, slide: foot_slide(source, feet, &points, &contacts), contacts, heights }
    }

    /// Holds the character's feet during the contacts, or only measures their slide.
    fn stand(
        &self,
        feet: Feet,
        contacts: &[FootContact],
        ground: &Ground,
        take: &mut Take,
    ) -> FootSlideReport {
        let (rig, root) = (self.character.rig, &self.character_root);
        if feet == Feet::Locked && !self.is_stiff {
            return remove_foot_slide(rig, root, &self.legs, contacts, ground, take);
        }
        let points = ground.seen_from(take, sole_points(rig, root, &self.legs.feet, take));
        let slide = foot_slide(take, &self.legs.feet, &points, contacts);
        FootSlideReport { slide: [slide; 2], ..FootSlideReport::default() }
    }

    /// Computes rotations and the path of the pelvis, then the height of the body: near the floor, its lowest sole is
    /// as high as the actor's.
    fn carry(&self, source: &Take, steps: &Steps, frame_time: f64) -> Take {
        let rig = self.character.rig;
        let mut take = Take { frame_time, joints: rig.joints.len(), poses: Vec::new() };
        let (mut from, mut to) = (Vec::new(), Vec::new());
        let mut errors = Vec::new();
        for frame in 0..source.frames() {
            local_to_model(self.actor.rig, source.pose(frame), &self.actor_root, &mut from);
            let mut pose = rest_pose(rig);
            self.turn_joints(&from, &mut pose, &mut to);
            let target = self.hips_target(&from, &to, steps.ground.height);
            self.legs.carry(rig, target - to[self.legs.pelvis].translation, &mut pose, &mut to);
            let low = lowest(&self.legs.feet.each_ref().map(|foot| foot.points(&to)));
            // If the body lies, or leaps with its feet up, its height follows the pelvis.
            let leg = self.legs.feet[0].length;
            let height = self.scale * steps.heights[frame];
            let near = 1.0 - smoothstep((height - 0.1 * leg) / (0.2 * leg));
            errors.push((height - (low - self.character.analysis.floor)) * near);
            take.poses.extend(pose);
        }
        let reach = take.frames_in(FLOOR_TIME * self.scale.sqrt());
        for (frame, lift) in moving_mean(&errors, reach).into_iter().enumerate() {
            local_to_model(rig, take.pose(frame), &self.character_root, &mut to);
            self.legs.carry(rig, Vec3::Y * lift, take.pose_mut(frame), &mut to);
        }
        take
    }

    /// Gives every matched joint the corrected rotation of the actor's joint; other joints follow their parents.
    fn turn_joints(&self, from: &[Affine], pose: &mut [crate::rig::LocalTransform], to: &mut Vec<Affine>) {
        to.clear();
        let mut pairs = self.alignment.pairs.iter().peekable();
        for (joint, local) in pose.iter_mut().enumerate() {
            let parent = self.character.rig.joints[joint].parent.map_or(self.character_root, |p| to[p]);
            if let Some(pair) = pairs.next_if(|pair| pair.to == joint) {
                let straight = self.straight_leg(pair.role, from);
                let wanted = straight * from[pair.from].to_rigid().rotation * pair.correction;
                local.rotation = (parent.to_rigid().rotation.inverse() * wanted).normalize();
            }
            to.push(parent * local.to_affine());
        }
    }

    /// Rotation that turns the actor's thigh to the direction from hip to ankle, if the role is the thigh of a leg
    /// without a knee.
    fn straight_leg(&self, role: Role, from: &[Affine]) -> Rotation {
        let leg = match role {
            Role::UpperLeg(side) if self.is_stiff => self.actor_feet[usize::from(side == Side::Right)].leg,
            _ => return Rotation::IDENTITY,
        };
        let [hip, knee, ankle] = [leg.upper, leg.lower, leg.end].map(|joint| from[joint].translation);
        let ways = direction(knee - hip).zip(direction(ankle - hip));
        ways.map_or(Rotation::IDENTITY, |(thigh, whole)| Rotation::from_arc(thigh, whole))
    }

    /// Target of the character's pelvis: the position of the actor's hip joints times the ratio of the leg lengths.
    fn hips_target(&self, from: &[Affine], to: &[Affine], floor: f32) -> Vec3 {
        let [left, right] = self.actor_feet.map(|foot| from[foot.leg.upper].translation);
        let middle = (left + right) * 0.5 - Vec3::Y * floor;
        let legs = middle * self.scale + Vec3::Y * self.character.analysis.floor;
        let rotation: Rotation = to[self.legs.pelvis].to_rigid().rotation;
        legs - rotation * self.hips_to_legs
    }
}

fn moving_mean(values: &[f32], reach: usize) -> Vec<f32> {
    let mean = |i: usize| {
        let near = &values[i.saturating_sub(reach)..(i + reach + 1).min(values.len())];
        near.iter().sum::<f32>() / near.len() as f32
    };
    (0..values.len()).map(mean).collect()
}
