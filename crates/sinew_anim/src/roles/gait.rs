//! Gait: limbs that swing alternately, their stepping direction and stride time.

use crate::clip::Clip;
use crate::clip::sample::{SampleCache, Wrap, sample_cached};
use crate::pose::local_to_model;
use crate::rig::{JointIdx, LocalTransform, Rig};
use crate::roles::tuning::{GAIT_RATE, IN_TURNS, LEAST_SWING, SHORTEST_WALK, SWINGS_ALIKE};
use sinew_math::{Affine, Vec3, clamp, max};
use std::sync::Arc;

/// Largest number of clips that are examined; walks and runs by name come first.
const MOST_CLIPS: usize = 12;
/// Smallest and largest number of poses of a clip that are examined.
const FRAMES: [f32; 2] = [16.0, 96.0];
/// Words in names of clips in which legs walk.
const WALKS: [&str; 8] = ["walk", "run", "jog", "trot", "gallop", "sprint", "march", "move"];

/// Words in names of clips in which legs rest.
const RESTS: [&str; 6] = ["idle", "stand", "wait", "sleep", "sit", "eat"];

/// Poses of a rig in its clips, used to recognise legs by their swing. The default is empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gait {
    takes: Arc<Vec<Poses>>,
}

/// A clip, evenly sampled.
#[derive(Clone, Debug, PartialEq)]
struct Poses {
    /// True if the clip is a walk by its name, and false if another clip is.
    is_gait: bool,
    /// Seconds from frame to frame.
    frame_time: f32,
    /// Model transforms of all joints in each frame, file units.
    frames: Vec<Vec<Affine>>,
}

/// Alternating swing of a pair of limbs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Swing {
    /// Half the distance between the two ends along the walking direction, root mean square, file units; 0 if they
    /// swing together or not at all.
    pub reach: f32,
    /// Longest time between two steps of one limb, seconds; 0 if no clip has a whole stride. Of walks by name, else of
    /// all clips but those that rest by name: an idle sways slowly.
    pub stride: f32,
    /// Correlation of the ends' height with their forward speed, -1..=1: a walking foot moves forward in the air and
    /// back on the ground.
    pub ahead: f32,
}

/// A pair of limbs to examine.
pub(super) struct Pair {
    /// The joint that carries both limbs, and its bind pose.
    pub carrier: JointIdx,
    pub bind: Affine,
    pub ends: [JointIdx; 2],
    /// Walking direction, a unit vector in model space.
    pub forward: Vec3,
    pub up: Vec3,
    /// Height of the body, file units.
    pub height: f32,
}

/// Paths of the two ends through a clip relative to their carrier, each minus its mean.
struct Ways {
    ahead: [Vec<f32>; 2],
    lift: [Vec<f32>; 2],
}

impl Gait {
    /// Samples the clips of a rig.
    ///
    /// # Panics
    /// As [`sample`](crate::clip::sample::sample()): if a clip is not one of the rig's.
    pub fn of(rig: &Rig, clips: &[Clip]) -> Self {
        let lasts = |clip: &&Clip| clip.duration.is_finite() && clip.duration >= SHORTEST_WALK;
        let mut wanted: Vec<&Clip> = clips.iter().filter(lasts).collect();
        let has = |clip: &Clip, words: &[&str]| {
            let name = clip.name.to_lowercase();
            words.iter().any(|word| name.contains(word))
        };
        let walks = |clip: &Clip| has(clip, &WALKS);
        let any_walks = clips.iter().filter(lasts).any(walks);
        let is_gait = |clip: &Clip| if any_walks { walks(clip) } else { !has(clip, &RESTS) };
        // The sort is stable, so clips of a kind keep their order.
        wanted.sort_by_key(|clip| !walks(clip));
        wanted.truncate(MOST_CLIPS);
        if rig.joints.is_empty() {
            wanted.clear();
        }
        Self { takes: Arc::new(wanted.into_iter().map(|clip| Poses::of(rig, clip, is_gait(clip))).collect()) }
    }

    /// True if there is no clip.
    pub(super) fn is_empty(&self) -> bool {
        self.takes.is_empty()
    }

    /// Returns the alternating swing of a pair: the widest and the longest stride of all clips, and the correlation
    /// over all clips.
    pub(super) fn swing(&self, pair: &Pair) -> Swing {
        let mut swing = Swing { reach: 0.0, stride: 0.0, ahead: 0.0 };
        let (mut up_and_on, mut lifts, mut speeds) = (0.0, 0.0, 0.0);
        for take in self.takes.iter() {
            let Some(ways) = take.ways(pair) else { continue };
            let reach = ways.reach();
            if reach < LEAST_SWING * pair.height {
                continue;
            }
            swing.reach = max(swing.reach, reach);
            if take.is_gait {
                swing.stride = max(swing.stride, ways.stride(reach) * take.frame_time);
            }
            let [a, b, c] = ways.steps();
            (up_and_on, lifts, speeds) = (up_and_on + a, lifts + b, speeds + c);
        }
        if lifts > 0.0 && speeds > 0.0 {
            swing.ahead = clamp(up_and_on / (lifts * speeds).sqrt(), -1.0, 1.0);
        }
        swing
    }
}

impl Poses {
    fn of(rig: &Rig, clip: &Clip, is_gait: bool) -> Self {
        let count = clamp((clip.duration * GAIT_RATE).ceil(), FRAMES[0], FRAMES[1]) as usize;
        let frame_time = clip.duration / count as f32;
        let mut local = vec![LocalTransform::default(); rig.joints.len()];
        let mut cache = SampleCache::default();
        let pose = |frame: usize| {
            let mut model = Vec::new();
            sample_cached(clip, rig, frame as f32 * frame_time, Wrap::Clamp, &mut cache, &mut local);
            local_to_model(rig, &local, &Affine::IDENTITY, &mut model);
            model
        };
        Self { is_gait, frame_time, frames: (0..count).map(pose).collect() }
    }

    /// Returns the paths of a pair; `None` if a pose is not finite.
    fn ways(&self, pair: &Pair) -> Option<Ways> {
        let mut ways = Ways { ahead: Default::default(), lift: Default::default() };
        for model in &self.frames {
            // Uses the carrier's bind pose, so that rotations of the whole body do not count as motion of legs.
            let steady = pair.bind * model[pair.carrier].inverse();
            for (side, &end) in pair.ends.iter().enumerate() {
                let at = steady.point(model[end].translation);
                if !at.is_finite() {
                    return None;
                }
                ways.ahead[side].push(at.dot(pair.forward));
                ways.lift[side].push(at.dot(pair.up));
            }
        }
        for way in ways.ahead.iter_mut().chain(&mut ways.lift) {
            let mean = way.iter().sum::<f32>() / way.len() as f32;
            way.iter_mut().for_each(|at| *at -= mean);
        }
        Some(ways)
    }
}

impl Ways {
    /// Half of the lead of the first end over the second, frame by frame.
    fn apart(&self) -> impl Iterator<Item = f32> + '_ {
        self.ahead[0].iter().zip(&self.ahead[1]).map(|(a, b)| 0.5 * (a - b))
    }

    /// Alternating swing, root mean square; 0 if both ends move together, or only one moves.
    fn reach(&self) -> f32 {
        let squared = |way: &[f32]| way.iter().map(|at| at * at).sum::<f32>();
        let [left, right] = self.ahead.each_ref().map(|way| squared(way));
        let apart: f32 = self.apart().map(|d| d * d).sum();
        let together: f32 =
            self.ahead[0].iter().zip(&self.ahead[1]).map(|(a, b)| 0.25 * (a + b) * (a + b)).sum();
        let alike = left < SWINGS_ALIKE * right && right < SWINGS_ALIKE * left;
        if alike && apart > IN_TURNS * together { (apart / self.ahead[0].len() as f32).sqrt() } else { 0.0 }
    }

    /// Number of frames of a stride in a clip treated as a loop; 0 if there is no whole stride.
    fn stride(&self, reach: f32) -> f32 {
        // Only positions beyond the centre by a share of the swing count, so that noise near the centre has no effect.
        let sides = self.apart().filter(|d| d.abs() > 0.3 * reach).map(|d| d > 0.0);
        let sides: Vec<bool> = sides.collect();
        let next = sides.iter().cycle().skip(1);
        let turns = sides.iter().zip(next).filter(|(now, next)| now != next).count();
        if turns < 2 { 0.0 } else { 2.0 * self.ahead[0].len() as f32 / turns as f32 }
    }

    /// Returns sums over both ends: height times forward speed, squared height, squared speed.
    fn steps(&self) -> [f32; 3] {
        let mut sums = [0.0; 3];
        for (ahead, lift) in self.ahead.iter().zip(&self.lift) {
            for i in 1..ahead.len() - 1 {
                let speed = ahead[i + 1] - ahead[i - 1];
                sums[0] += lift[i] * speed;
                sums[1] += lift[i] * lift[i];
                sums[2] += speed * speed;
            }
        }
        sums
    }
}
