//! Removes spikes: frames in which a joint jumps away and back.

use crate::clip::take::Take;
use crate::rig::{JointIdx, LocalTransform};
use sinew_math::max;

/// Thresholds for a spike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpikeSettings {
    /// Smallest rotation of a spike, away and back, radians.
    pub least_turn: f32,
    /// Smallest shift of a spike, away and back, units of the rig.
    pub least_shift: f32,
    /// Smallest ratio of a spike's step to the usual step of the joint.
    pub times_usual: f32,
    /// Longest spike, seconds.
    pub longest: f32,
}

impl Default for SpikeSettings {
    /// Thresholds of 5°, 2 cm (of a rig in metres), 6 times the usual step, and 50 ms.
    fn default() -> Self {
        Self { least_turn: 0.0873, least_shift: 0.02, times_usual: 6.0, longest: 0.05 }
    }
}

/// A removed spike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spike {
    /// Joint with the spike.
    pub joint: JointIdx,
    /// First frame of the spike.
    pub frame: usize,
    /// Number of frames of the spike.
    pub frames: usize,
    /// Angle by which the joint turned away, radians.
    pub turn: f32,
    /// Distance by which it was shifted away, units of the rig.
    pub shift: f32,
}

/// Removes spikes: where a joint jumps by far more than its usual step and returns within a few frames, these frames
/// are interpolated. Spikes at the first or last frame have only one side, and stay.
pub fn despike(take: &mut Take, settings: &SpikeSettings) -> Vec<Spike> {
    let mut found = Vec::new();
    let longest = take.frames_in(settings.longest).max(1);
    for joint in 0..take.joints {
        let mut track: Vec<LocalTransform> = take.of_joint(joint).collect();
        let usual = usual_steps(&track);
        let mut frame = 1;
        while frame + 1 < track.len() {
            let ends = (frame + 1)..(frame + 1 + longest).min(track.len());
            let spike =
                ends.into_iter().find_map(|end| spike_between(&track, frame - 1, end, usual, settings));
            if let Some((turn, shift, end)) = spike {
                bridge(&mut track, frame - 1, end);
                found.push(Spike { joint, frame, frames: end - frame, turn, shift });
                frame = end;
            }
            frame += 1;
        }
        for (frame, local) in track.into_iter().enumerate() {
            take.pose_mut(frame)[joint] = local;
        }
    }
    found
}

/// Returns the rotation (radians) and the shift from one transform to another.
fn step(a: LocalTransform, b: LocalTransform) -> [f32; 2] {
    [a.rotation.angle_to(b.rotation), (a.translation - b.translation).length()]
}

/// Returns the upper quartiles of the joint's rotations and shifts from frame to frame, as its usual motion.
fn usual_steps(track: &[LocalTransform]) -> [f32; 2] {
    [0, 1].map(|which| {
        let mut steps: Vec<f32> = track.windows(2).map(|pair| step(pair[0], pair[1])[which]).collect();
        steps.sort_by(f32::total_cmp);
        steps.get(steps.len() * 3 / 4).copied().unwrap_or(0.0)
    })
}

/// Returns the rotation and shift of the joint between frames `before` and `after` (radians, units of the rig), and
/// `after`, if both steps are jumps and the two ends are close.
fn spike_between(
    track: &[LocalTransform],
    before: usize,
    after: usize,
    usual: [f32; 2],
    settings: &SpikeSettings,
) -> Option<(f32, f32, usize)> {
    let away = step(track[before], track[before + 1]);
    let back = step(track[after - 1], track[after]);
    let across = step(track[before], track[after]);
    let least = [settings.least_turn, settings.least_shift];
    let is_spike = |k: usize| {
        let jump = max(least[k], settings.times_usual * usual[k]);
        away[k] > jump && back[k] > jump && across[k] < 0.3 * away[k] && across[k] < 0.3 * back[k]
    };
    (is_spike(0) || is_spike(1)).then_some((away[0], away[1], after))
}

/// Interpolates the frames between `before` and `after`.
fn bridge(track: &mut [LocalTransform], before: usize, after: usize) {
    let (a, b) = (track[before], track[after]);
    for frame in before + 1..after {
        let t = (frame - before) as f32 / (after - before) as f32;
        track[frame] = LocalTransform {
            translation: a.translation + (b.translation - a.translation) * t,
            rotation: a.rotation.slerp(b.rotation, t),
            scale: track[frame].scale,
        };
    }
}
