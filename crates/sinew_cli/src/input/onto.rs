//! Retargets clips of one file to the character of another.

use crate::failure::{Failure, Result};
use crate::input::motion::Motion;
use crate::report::table::shown;
use sinew::anim::retarget::{Body, RetargetOptions, Retargeted, retarget};
use sinew::anim::{Channel, Clip, ClipEvent, JointIdx, LocalTransform, Rig, RigAnalysis};

/// A clip of another rig, converted to the character's rig.
pub struct Carried {
    /// Clip of the character's joints.
    pub clip: Clip,
    /// Events of the clip, at its pace.
    pub events: Vec<ClipEvent>,
    /// Criterion by which the clip's joints were matched.
    pub by: By,
}

/// Criterion by which joints were matched.
pub enum By {
    /// By name: both skeletons are the same, and keys are copied.
    Name {
        /// Number of matched joints.
        matched: usize,
    },
    /// By role: human bodies of any size.
    Role(Box<Retargeted>),
}

/// Retargets all clips of a file: by joint names if the skeletons are equal or not human, else by roles.
pub fn carry(
    motion: &Motion,
    rig: &Rig,
    analysis: Option<&RigAnalysis>,
    options: &RetargetOptions,
) -> Result<Vec<Carried>> {
    let clips = motion.file.clips.iter().zip(&motion.file.events);
    let namesakes = Namesakes::find(&motion.file.rig, &motion.file.clips, rig);
    let humans = [&motion.analysis.as_ref(), &analysis].iter().all(|a| a.is_some_and(|a| a.humanoid));
    if let Some(same) = namesakes.filter(|same| same.rest_alike || !humans) {
        return Ok(clips.filter_map(|(clip, events)| by_name(clip, events, &same.joints)).collect());
    }
    let (Some(from), Some(to)) = (&motion.analysis, analysis) else {
        let what = "its joints are neither those of the character, by name, nor those of a human body";
        return Err(Failure::of_file(&motion.name, what));
    };
    let actor = Body { rig: &motion.file.rig, analysis: from };
    let by_role = |(clip, events): (&Clip, &Vec<ClipEvent>)| {
        let fitted = retarget(actor, clip, Body { rig, analysis: to }, options)
            .map_err(|error| Failure::of_file(&motion.name, error.to_string().replace("actor", "file")))?;
        let new = fitted.clip(rig, &clip.name);
        let at_pace = |event: &ClipEvent| {
            let time = (event.time * fitted.pace).min(new.duration);
            ClipEvent { time, ..event.clone() }
        };
        let events = events.iter().map(at_pace).collect();
        Ok(Carried { clip: new, events, by: By::Role(Box::new(fitted)) })
    };
    clips.map(by_role).collect()
}

/// Largest angle between equal rest poses of matching joints, radians.
const SAME_TURN: f32 = 0.02;
/// Largest difference of the joints' rest positions, as a share of their distance from the parent.
const SAME_PLACE: f32 = 0.05;

/// Joints of a rig matched to those of another by name.
struct Namesakes {
    /// For each joint of the other rig, the matching joint.
    joints: Vec<Option<JointIdx>>,
    /// True if most moving joints have the same rest pose in both: keys of one fit the other.
    rest_alike: bool,
}

impl Namesakes {
    /// Returns `None` if most joints that the clips move have no match.
    fn find(other: &Rig, clips: &[Clip], rig: &Rig) -> Option<Self> {
        let find = |name: &str| rig.joints.iter().position(|own| !name.is_empty() && own.name == name);
        let joints: Vec<Option<JointIdx>> = other.joints.iter().map(|joint| find(&joint.name)).collect();
        let mut moved: Vec<JointIdx> =
            clips.iter().flat_map(|clip| clip.channels.iter().map(|channel| channel.joint)).collect();
        moved.sort_unstable();
        moved.dedup();
        let own =
            |&joint: &JointIdx| joints[joint].map(|own| (other.joints[joint].rest, rig.joints[own].rest));
        let named = moved.iter().filter_map(own).count();
        let alike = moved.iter().filter_map(own).filter(|(a, b)| rests_alike(a, b)).count();
        let most = |count: usize| 2 * count > moved.len();
        most(named).then(|| Self { rest_alike: most(alike), joints })
    }
}

fn rests_alike(a: &LocalTransform, b: &LocalTransform) -> bool {
    let apart = (a.translation - b.translation).length();
    a.rotation.angle_to(b.rotation) < SAME_TURN && apart <= SAME_PLACE * b.translation.length().max(1e-3)
}

fn by_name(clip: &Clip, events: &[ClipEvent], same: &[Option<JointIdx>]) -> Option<Carried> {
    let renamed = |channel: &Channel| same[channel.joint].map(|joint| Channel { joint, ..channel.clone() });
    let channels: Vec<Channel> = clip.channels.iter().filter_map(renamed).collect();
    let mut joints: Vec<JointIdx> = channels.iter().map(|channel| channel.joint).collect();
    joints.sort_unstable();
    joints.dedup();
    let by = By::Name { matched: joints.len() };
    (!channels.is_empty()).then(|| Carried {
        clip: Clip { channels, ..clip.clone() },
        events: events.to_vec(),
        by,
    })
}

impl Carried {
    /// Returns a line of text that describes the result.
    pub fn to_text(&self) -> String {
        let name = shown(&self.clip.name);
        match &self.by {
            By::Name { matched } => format!("{name}: taken as it is, {matched} joints have the same names"),
            By::Role(fitted) => {
                let missing = fitted.unmatched.len();
                let rest = match missing {
                    0 => String::new(),
                    _ => format!(", {missing} of the character move with their parents"),
                };
                format!(
                    "{name}: {} joints matched by role{rest}; legs {:.2} times as long; feet slide {:.1} cm/s",
                    fitted.pairs.len(),
                    fitted.scale,
                    100.0 * fitted.feet.slide[1].mean,
                )
            }
        }
    }
}
