//! The clips of a character definition, prepared once for playback by all its characters.

use super::clearance::{Depths, PARTS};
use super::floor::{Raised, moved};
use super::mirror::Mirror;
use super::pose_similarity::{Landmarks, Stance};
use super::{CharacterDef, Locomotion, MotionSet, travel};
use crate::character::tuning::{
    BEGINS_LYING, LOW_START, MAY_BEGIN, MIRRORED_FRAME, MOST_PACES, ROOT_FRAME, STARTS_APART,
};
use crate::def::RagdollDef;
use crate::mapping::Mapping;
use sinew_anim::take::Take;
use sinew_anim::{
    AnimatedClip, AnimationSet, BuiltClip, Clip, ClipBuildError, ClipBuildOptions, ClipId, LocalTransform,
    Markers, MotionTrack, Rig, Skeleton, Wrap, local_to_model, rest_pose, sample,
};
use sinew_math::{Affine, Transform, Vec3, max, min};

/// A clip of a character that cannot be played.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("clip '{name}': {error}")]
pub struct MotionError {
    /// Name of the clip.
    pub name: String,
    /// Reason why the clip cannot be played.
    pub error: ClipBuildError,
}

/// Prepared clips of a character definition.
#[derive(Clone, Debug)]
pub(super) struct Moves {
    pub set: AnimationSet,
    /// Ids in `set` of the clips, in the order of [`MotionSet::clips`].
    pub clips: Vec<ClipId>,
    /// Locomotion clips, slowest first; the first is the looped one.
    pub paces: Vec<Pace>,
    /// Get-up clips, each with its mirror image after it.
    pub get_ups: Vec<GetUp>,
    pub landmarks: Landmarks,
    /// Stance at the start of the looped clip, or in the rest pose, character space.
    pub upright: Stance,
    /// Heights by which clips are raised to the floor of the rest pose.
    pub raised: Raised,
    /// Displacement of the looped clip to the position of the character, character space.
    pub shift: Vec3,
    /// Largest depths of the body parts in the floor over the looped clips, or in the rest pose.
    pub deepest: Depths,
}

/// A locomotion clip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pace {
    pub clip: ClipId,
    /// Speed over the ground, m/s; 0 if the clip does not travel.
    pub speed: f32,
}

/// A get-up clip.
#[derive(Clone, Debug)]
pub(super) struct GetUp {
    /// Index of the clip in [`MotionSet::clips`].
    pub clip: usize,
    pub id: ClipId,
    /// Clip times at which a get-up may begin.
    pub starts: Vec<Start>,
    /// Largest depths of the body parts in the floor over the clip.
    pub deepest: Depths,
}

/// A time of a get-up clip at which a get-up may begin.
#[derive(Clone, Debug)]
pub(super) struct Start {
    /// Time in the clip, seconds.
    pub time: f32,
    /// Stance at this time, character space.
    pub stance: Stance,
    /// Transforms from each body to character space at this time.
    pub bodies: Vec<Transform>,
}

impl Moves {
    /// Returns the moves of a character that has no motions.
    pub fn none(rig: &Rig, ragdoll: &RagdollDef, mapping: &Mapping) -> Self {
        let (landmarks, set) = (Landmarks::new(ragdoll), AnimationSet::new(Skeleton::new(rig)));
        let upright = stance(rig, mapping, &landmarks, &rest_pose(rig));
        let raised = Raised::default();
        let deepest = [0.0; PARTS];
        Self {
            set,
            clips: Vec::new(),
            paces: Vec::new(),
            get_ups: Vec::new(),
            landmarks,
            upright,
            raised,
            shift: Vec3::ZERO,
            deepest,
        }
    }

    pub fn new(def: &CharacterDef, motions: &MotionSet) -> Result<Self, MotionError> {
        let mut set = AnimationSet::new(Skeleton::new(&def.rig));
        let mut clips = Vec::new();
        let raised = Raised::of(def, motions);
        let own = motions.clips.iter().enumerate();
        let up = def.mapping().character_from_model().inverse();
        let to_origin = |index: usize| {
            let follows = locomotion_of(motions, index).is_some_and(|by| by != Locomotion::Exact);
            let stays = motions.locomotion != Locomotion::Exact && motions.idle == Some(index);
            if follows || stays { travel::to_origin(def, &motions.clips[index]) } else { Vec3::ZERO }
        };
        let shift = motions.looped.map_or(Vec3::ZERO, |index| Vec3::Y * raised.looped + to_origin(index));
        let motions = &MotionSet {
            clips: own
                .map(|(index, clip)| {
                    let to_origin = to_origin(index);
                    let [by, beside] = [raised.of_clip(index), raised.looped]
                        .map(|up_by| up.vector(Vec3::Y * up_by + to_origin));
                    moved(&def.rig, &def.ragdoll, clip, by, beside)
                })
                .collect(),
            ..motions.clone()
        };
        for (index, clip) in motions.clips.iter().enumerate() {
            let locomotion = locomotion_of(motions, index);
            let mut played =
                match (locomotion == Some(Locomotion::ByClip)).then(|| travelling(def, clip)).flatten() {
                    Some((still, motion)) => AnimatedClip { motion: Some(motion), ..built(def, &still)? },
                    None => {
                        let mut played = built(def, &flat(def, clip))?;
                        played.motion = locomotion.and_then(|by| way(def, by, played.clip.duration()));
                        played
                    }
                };
            played.events = events_of(motions, index);
            if !motions.faster.is_empty() && locomotion.is_some() {
                let left = played
                    .events
                    .iter()
                    .find(|event| event.payload == LEFT && event.time < played.clip.duration());
                played.markers = left.map_or_else(Markers::default, |event| Markers::new(vec![event.time]));
            }
            clips.push(set.add_clip(played));
        }
        let paces = paces(def, &set, &clips, motions);
        let landmarks = Landmarks::new(&def.ragdoll);
        let mirror = Mirror::new(def);
        let clearance = def.clearance();
        let mut get_ups = Vec::new();
        for &clip in &motions.get_ups {
            let take = flat_take(def, &motions.clips[clip], MIRRORED_FRAME);
            let starts = starts(def, &landmarks, &take);
            let deepest = clearance.deepest(def, &take);
            get_ups.push(GetUp { clip, id: clips[clip], starts, deepest });
            let image = mirrored(def, &mirror, &take);
            let starts = self::starts(def, &landmarks, &image);
            let mut mirrored = built(def, &image.to_clip(&def.rig, &motions.clips[clip].name))?;
            mirrored.events = events_of(motions, clip);
            let id = set.add_clip(mirrored);
            let deepest = clearance.deepest(def, &image);
            get_ups.push(GetUp { clip, id, starts, deepest });
        }
        let upright = stance(&def.rig, def.mapping(), &landmarks, &first_pose(def, motions));
        let deepest = clearance.deepest(def, &standing(def, motions));
        Ok(Self { set, clips, paces, get_ups, landmarks, upright, raised, shift, deepest })
    }
}

/// Returns the poses of all looped clips, or the rest pose if there are none.
fn standing(def: &CharacterDef, motions: &MotionSet) -> Take {
    let mut poses = Take { frame_time: MIRRORED_FRAME, joints: def.rig.joints.len(), poses: Vec::new() };
    let faster = motions.faster.iter().map(|&(clip, _)| clip);
    for clip in motions.looped.into_iter().chain(motions.idle).chain(faster) {
        poses.poses.extend(flat_take(def, &motions.clips[clip], MIRRORED_FRAME).poses);
    }
    if poses.poses.is_empty() {
        poses.poses.extend_from_slice(def.rest());
    }
    poses
}

/// Payload of the clip events that synchronize locomotion clips: the left foot lands.
const LEFT: &str = "left";

/// Returns the locomotion of a clip if it is the looped clip or a faster one.
fn locomotion_of(motions: &MotionSet, index: usize) -> Option<Locomotion> {
    let looped = motions.looped.filter(|&clip| clip == index).map(|_| motions.locomotion);
    looped.or_else(|| motions.faster.iter().find(|(clip, _)| *clip == index).map(|&(_, by)| by))
}

/// Returns the looped clip and the faster ones, in order of speed. Drops clips that are no faster than the one before.
fn paces(def: &CharacterDef, set: &AnimationSet, clips: &[ClipId], motions: &MotionSet) -> Vec<Pace> {
    let pace = |index: usize| {
        let clip = set.clip(clips[index]);
        let stride = clip.motion.as_ref().map_or(0.0, MotionTrack::stride);
        let speed = stride * def.ragdoll.unit_scale / max(clip.clip.duration(), 1e-3);
        Pace { clip: clips[index], speed }
    };
    let Some(looped) = motions.looped.map(pace) else { return Vec::new() };
    let mut paces = vec![looped];
    let mut faster: Vec<Pace> = motions.faster.iter().map(|&(clip, _)| pace(clip)).collect();
    faster.sort_by(|a, b| a.speed.total_cmp(&b.speed));
    faster.retain(|_| looped.speed > 0.0);
    for pace in faster {
        if paces.len() < MOST_PACES && paces.last().is_some_and(|slower| pace.speed > slower.speed) {
            paces.push(pace);
        }
    }
    paces
}

/// Returns the events of a clip, in order of time.
fn events_of(motions: &MotionSet, clip: usize) -> Vec<sinew_anim::ClipEvent> {
    let own = motions.events.iter().filter(|(of, _)| *of == clip).map(|(_, event)| event.clone());
    let mut events: Vec<sinew_anim::ClipEvent> = own.collect();
    events.sort_by(|a, b| a.time.total_cmp(&b.time));
    events
}

fn built(def: &CharacterDef, clip: &Clip) -> Result<AnimatedClip, MotionError> {
    BuiltClip::build(clip, &def.rig, &ClipBuildOptions::default())
        .map(AnimatedClip::from)
        .map_err(|error| MotionError { name: clip.name.clone(), error })
}

/// Returns the clip with the motion of all joints above the pelvis moved to the pelvis: see
/// [`Mapping`](crate::Mapping).
fn flat(def: &CharacterDef, clip: &Clip) -> Clip {
    let moves_carriers = clip.channels.iter().any(|channel| def.mapping().carries(channel.joint));
    if moves_carriers { flat_take(def, clip, ROOT_FRAME).to_clip(&def.rig, &clip.name) } else { clip.clone() }
}

fn flat_take(def: &CharacterDef, clip: &Clip, frame_time: f64) -> Take {
    // Limit the number of frames, because a file may contain a clip that claims to last for years.
    let shortest = f64::from(clip.duration) / (Take::MOST_FRAMES - 1) as f64;
    let mut take = Take::of(&def.rig, clip, if shortest > frame_time { shortest } else { frame_time });
    for frame in 0..take.frames() {
        def.mapping().flatten(&def.rig, take.pose_mut(frame));
    }
    take
}

/// Splits a travelling clip into a clip in place and its path; `None` if it does not travel. The frames divide the
/// clip's duration evenly, so that the last one is at its end.
fn travelling(def: &CharacterDef, clip: &Clip) -> Option<(Clip, MotionTrack)> {
    let frames = (f64::from(clip.duration) / ROOT_FRAME).round();
    if !(frames >= 1.0 && frames < (Take::MOST_FRAMES - 1) as f64) {
        return None;
    }
    let take = flat_take(def, clip, f64::from(clip.duration) / frames);
    let (still, motion) = travel::parted(def, &take)?;
    Some((still.to_clip(&def.rig, &clip.name), motion))
}

fn mirrored(def: &CharacterDef, mirror: &Mirror, take: &Take) -> Take {
    let poses = (0..take.frames()).flat_map(|frame| mirror.pose(def, take.pose(frame))).collect();
    Take { poses, ..*take }
}

/// Returns the root motion of [`Locomotion::Forward`] in model space; `None` for other locomotion.
fn way(def: &CharacterDef, locomotion: Locomotion, duration: f32) -> Option<MotionTrack> {
    let Locomotion::Forward { speed } = locomotion else { return None };
    let model = def.mapping().character_from_model().inverse();
    let up = model.to_rigid().rotation * Vec3::Y;
    Some(MotionTrack::straight(model.vector(Vec3::Z * speed), duration, up))
}

/// Returns the times at which a get-up may begin. If the clip begins sitting, a get-up may begin only while the pelvis
/// is low, because a lying body would snap to the crouch that follows.
fn starts(def: &CharacterDef, landmarks: &Landmarks, take: &Take) -> Vec<Start> {
    let last = (take.frames() - 1) as f32 * MAY_BEGIN;
    let apart = usize::max(take.frames_in(STARTS_APART), 1);
    let mut starts: Vec<Start> = (0..=last as usize)
        .step_by(apart)
        .map(|frame| {
            let (mut model, mut bodies) = (Vec::new(), Vec::new());
            local_to_model(&def.rig, take.pose(frame), &Affine::IDENTITY, &mut model);
            let (mapping, points) = (def.mapping(), Vec::new());
            // This call also fills `bodies`.
            let stance = landmarks.stance(mapping, &model, Transform::IDENTITY, points, &mut bodies);
            Start { time: take.time(frame), stance, bodies }
        })
        .collect();
    let begins_lying = starts.first().is_some_and(|start| (start.stance.pelvis * Vec3::Y).y < BEGINS_LYING);
    if !begins_lying {
        let height = |start: &Start| start.stance.points[0].y;
        let lowest = starts.iter().map(height).fold(f32::INFINITY, min);
        starts.retain(|start| height(start) <= lowest + LOW_START * def.ragdoll.height);
    }
    starts
}

fn stance(rig: &Rig, mapping: &Mapping, landmarks: &Landmarks, pose: &[LocalTransform]) -> Stance {
    let mut model = Vec::new();
    local_to_model(rig, pose, &Affine::IDENTITY, &mut model);
    landmarks.stance(mapping, &model, Transform::IDENTITY, Vec::new(), &mut Vec::new())
}

/// Returns the pose at the start of the looped clip, with the motion of joints above the pelvis in the pelvis, or the
/// rest pose.
fn first_pose(def: &CharacterDef, motions: &MotionSet) -> Vec<LocalTransform> {
    let mut pose = def.rest().to_vec();
    if let Some(clip) = motions.looped {
        sample(&motions.clips[clip], &def.rig, 0.0, Wrap::Clamp, &mut pose);
        def.mapping().flatten(&def.rig, &mut pose);
    }
    pose
}
