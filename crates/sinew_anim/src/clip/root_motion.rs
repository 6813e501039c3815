//! Root motion: extracts the path of a character from a clip, so that the game can move it.

use crate::clip::sample::{SampleCache, Wrap, sample_cached};
use crate::clip::{Channel, Clip, Interpolation, Property};
use crate::playback::playhead::{LoopMode, Place};
use crate::rig::{JointIdx, LocalTransform, Rig};
use crate::tuning::ROOT_SAMPLING;
use sinew_math::{Affine, Rotation, Transform, Vec3};

/// Component of a motion that is extracted along an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AxisExtraction {
    /// No component is extracted: the motion stays in the pose.
    #[default]
    None,
    /// The straight line from the first pose to the last; oscillation about it stays in the pose.
    Linear,
    /// All of the motion.
    Full,
}

/// Selection of the motion to extract.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RootMotionOptions {
    /// The joint that carries the body: the hips, or a joint above them.
    pub joint: JointIdx,
    /// Translation along x, y, z of model space.
    pub axes: [AxisExtraction; 3],
    /// Rotation about `up`.
    pub turn: AxisExtraction,
    /// Up axis: unit vector, model space.
    pub up: Vec3,
}

impl RootMotionOptions {
    /// Extracts the motion over the ground and about y: all of x, z and the rotation, but no y.
    pub fn on_ground(joint: JointIdx) -> Self {
        let (none, full) = (AxisExtraction::None, AxisExtraction::Full);
        Self { joint, axes: [full, none, full], turn: full, up: Vec3::Y }
    }
}

/// Path of a character since the start of its clip: model space, file units.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionTrack {
    /// Sample times, seconds, increasing, at least one.
    times: Vec<f32>,
    positions: Vec<Vec3>,
    /// Rotations about `up`, radians, of any size.
    turns: Vec<f32>,
    up: Vec3,
}

/// Extracts the motion of a joint from a clip: returns the clip in place, and the motion. Combined they reproduce the
/// original: `motion · pose` in model space, within rounding and the interpolation between samples 1/60 s apart. The
/// clip in place ends where it starts in every component that was extracted fully or linearly.
///
/// Model space and unit are the file's; times are seconds. The joint's channels of translation and rotation are
/// replaced. `clip` and `rig` must satisfy [`BuiltClip::build`](crate::BuiltClip::build).
///
/// # Panics
/// If the joint is not in the rig, or the clip is not fit to be sampled (see [`sample`](crate::clip::sample::sample())).
pub fn extract_root_motion(clip: &Clip, rig: &Rig, options: &RootMotionOptions) -> (Clip, MotionTrack) {
    let times = sample_times(clip);
    let poses = chain_poses(clip, rig, options.joint, &times);
    let motion = MotionTrack::from_poses(&times, &poses, options);
    let mut rest = Keys::default();
    for (i, pose) in poses.iter().enumerate() {
        let back = Affine::from(motion.sample(i).inverse());
        let place = pose.parent.inverse() * (back * (pose.parent * pose.local.to_affine()));
        let parent = pose.parent.to_rigid().rotation;
        let turn = parent.inverse() * motion.sample(i).rotation.inverse() * parent;
        rest.translations.extend(place.translation.to_array());
        let q = (turn * pose.local.rotation).normalize();
        rest.rotations.extend([q.x, q.y, q.z, q.w]);
    }
    let joint = options.joint;
    let mut still = clip.clone();
    still.channels.retain(|channel| channel.joint != joint || channel.property == Property::Scale);
    for (property, values) in
        [(Property::Translation, rest.translations), (Property::Rotation, rest.rotations)]
    {
        let interpolation = Interpolation::Linear;
        still.channels.push(Channel { joint, property, interpolation, times: times.clone(), values });
    }
    (still, motion)
}

#[derive(Default)]
struct Keys {
    translations: Vec<f32>,
    rotations: Vec<f32>,
}

/// A joint and its parent at a time, in model space.
struct ChainPose {
    local: LocalTransform,
    parent: Affine,
}

/// Evenly spaced times from 0 to the clip's end.
fn sample_times(clip: &Clip) -> Vec<f32> {
    let steps = (clip.duration / ROOT_SAMPLING).ceil();
    let steps = if steps >= 1.0 { steps as u32 } else { 1 };
    if clip.duration > 0.0 {
        (0..=steps).map(|i| clip.duration * (i as f32 / steps as f32)).collect()
    } else {
        vec![0.0]
    }
}

fn chain_poses(clip: &Clip, rig: &Rig, joint: JointIdx, times: &[f32]) -> Vec<ChainPose> {
    let (mut cache, mut pose) = (SampleCache::default(), vec![LocalTransform::default(); rig.joints.len()]);
    let at = |&time: &f32| {
        sample_cached(clip, rig, time, Wrap::Clamp, &mut cache, &mut pose);
        let mut parent = Affine::IDENTITY;
        let mut above = rig.joints[joint].parent;
        while let Some(next) = above {
            parent = pose[next].to_affine() * parent;
            above = rig.joints[next].parent;
        }
        ChainPose { local: pose[joint], parent }
    };
    times.iter().map(at).collect()
}

impl MotionTrack {
    /// Makes a straight motion of `duration` seconds, for a clip made on the spot. `velocity` is in file units per
    /// second, model space; `up` is a unit vector in model space.
    ///
    /// # Panics
    /// If `duration` is negative or not finite.
    pub fn straight(velocity: Vec3, duration: f32, up: Vec3) -> Self {
        assert!(
            duration >= 0.0 && duration.is_finite(),
            "duration must be finite and at least 0, not {duration}"
        );
        if duration == 0.0 {
            return Self { times: vec![0.0], positions: vec![Vec3::ZERO], turns: vec![0.0], up };
        }
        let positions = vec![Vec3::ZERO, velocity * duration];
        Self { times: vec![0.0, duration], positions, turns: vec![0.0; 2], up }
    }

    /// Makes a motion through positions (file units, model space) and rotations (radians about `up`) at ascending
    /// times; linear in between.
    ///
    /// # Panics
    /// If there is no time, the numbers of positions or rotations differ from the number of times, a number is not
    /// finite, or times do not ascend.
    pub fn through(times: Vec<f32>, positions: Vec<Vec3>, turns: Vec<f32>, up: Vec3) -> Self {
        let count = times.len();
        assert!(
            count > 0 && [positions.len(), turns.len()] == [count; 2],
            "positions and rotations must be as many as times"
        );
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "times increase");
        let finite =
            times.iter().chain(&turns).all(|x| x.is_finite()) && positions.iter().all(|p| p.is_finite());
        assert!(finite, "times, positions and rotations must be finite");
        Self { times, positions, turns, up }
    }

    fn from_poses(times: &[f32], poses: &[ChainPose], options: &RootMotionOptions) -> Self {
        let rotation = |pose: &ChainPose| pose.parent.to_rigid().rotation * pose.local.rotation;
        let first = rotation(&poses[0]);
        let mut turns: Vec<f32> = Vec::with_capacity(poses.len());
        for pose in poses {
            let turn = (rotation(pose) * first.inverse()).twist_angle(options.up);
            let last = turns.last().copied().unwrap_or(0.0);
            turns.push(unwrapped(turn, last));
        }
        take(options.turn, times, &mut turns);
        let place = |pose: &ChainPose| pose.parent.point(pose.local.translation);
        let start = place(&poses[0]);
        // Keeps the joint at its first position relative to its parent.
        let carried = |(pose, &turn): (&ChainPose, &f32)| {
            place(pose) - Rotation::from_axis_angle(options.up, turn) * start
        };
        let carried: Vec<Vec3> = poses.iter().zip(&turns).map(carried).collect();
        let axis = |i: usize| {
            let mut way: Vec<f32> = carried.iter().map(|at| at[i]).collect();
            take(options.axes[i], times, &mut way);
            way
        };
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        let positions = (0..times.len()).map(|i| Vec3::new(x[i], y[i], z[i])).collect();
        Self { times: times.to_vec(), positions, turns, up: options.up }
    }

    fn sample(&self, i: usize) -> Transform {
        Transform::new(self.positions[i], Rotation::from_axis_angle(self.up, self.turns[i]))
    }

    /// Returns the pose of the character at `time`, clip seconds, limited to the clip; the identity at the start.
    pub fn at(&self, time: f32) -> Transform {
        let right = self.times.partition_point(|&t| t <= time);
        if right == 0 || right == self.times.len() {
            return self.sample(right.saturating_sub(1));
        }
        let left = right - 1;
        let share = (time - self.times[left]) / (self.times[right] - self.times[left]);
        let position = self.positions[left] + (self.positions[right] - self.positions[left]) * share;
        let turn = self.turns[left] + (self.turns[right] - self.turns[left]) * share;
        Transform::new(position, Rotation::from_axis_angle(self.up, turn))
    }

    /// Returns the motion of one lap: from the clip's start to its end.
    pub fn lap(&self) -> Transform {
        self.at(0.0).inverse() * self.sample(self.times.len() - 1)
    }

    /// Distance of a lap over the ground, file units, without the component along up.
    pub fn stride(&self) -> f32 {
        let way = self.lap().translation;
        (way - self.up * self.up.dot(way)).length()
    }

    /// Returns the motion between two positions, relative to the first.
    pub(crate) fn between(&self, from: Place, to: Place, mode: LoopMode, length: f64) -> Transform {
        let at = |place: Place| {
            let is_way_back = mode == LoopMode::PingPong && place.lap.rem_euclid(2) == 1;
            self.at(if is_way_back { length - place.time } else { place.time } as f32)
        };
        let laps = if mode == LoopMode::Loop { to.lap.saturating_sub(from.lap) } else { 0 };
        at(from).inverse() * (power(self.lap(), laps) * at(to))
    }
}

/// Returns `t` repeated `n` times, inverted for negative `n`.
fn power(t: Transform, n: i64) -> Transform {
    let (mut square, mut rest) = (if n < 0 { t.inverse() } else { t }, n.unsigned_abs());
    let mut product = Transform::IDENTITY;
    while rest > 0 {
        if rest & 1 == 1 {
            product = product * square;
        }
        square = square * square;
        rest >>= 1;
    }
    product
}

/// Returns the angle equivalent to `angle` that is nearest to `last`.
fn unwrapped(angle: f32, last: f32) -> f32 {
    const TURN: f32 = core::f32::consts::TAU;
    angle + TURN * ((last - angle) / TURN + 0.5).floor()
}

/// Replaces the path `way` by the component that a mode extracts, relative to its first number.
fn take(mode: AxisExtraction, times: &[f32], way: &mut [f32]) {
    let first = way[0];
    let last = way[way.len() - 1] - first;
    let duration = times[times.len() - 1];
    for (value, &time) in way.iter_mut().zip(times) {
        *value = match mode {
            AxisExtraction::None => 0.0,
            AxisExtraction::Linear if duration > 0.0 => last * (time / duration),
            AxisExtraction::Linear => 0.0,
            AxisExtraction::Full => *value - first,
        };
    }
}
