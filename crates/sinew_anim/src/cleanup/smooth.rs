//! Smooths a take to remove trembling.

use crate::clip::take::Take;
use crate::rig::LocalTransform;
use sinew_math::{Rotation, Vec3, max, trig};

/// Change of a take by smoothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SmoothReport {
    /// Largest rotation of a joint, radians.
    pub largest_turn: f32,
    /// Mean rotation over all joints and frames, radians.
    pub mean_turn: f32,
    /// Largest shift of a joint, units of the rig.
    pub largest_shift: f32,
}

/// Smooths a take by a Gaussian mean over time with standard deviation `sigma` seconds, cut off at 3 sigma. The mean
/// is symmetric, so it adds no delay. A periodic motion at frequency f keeps `exp(−2 (π f σ)²)` of its amplitude: at
/// 20 ms a tenth is lost at 3.7 Hz and nine tenths at 17 Hz. Does nothing if `sigma` is below a fifth of a frame.
pub fn smooth(take: &mut Take, sigma: f32) -> SmoothReport {
    let mut report = SmoothReport::default();
    let frames = f64::from(sigma) / take.frame_time;
    if frames.is_nan() || frames < 0.2 || take.frames() < 2 {
        return report;
    }
    let reach = usize::min((3.0 * frames).ceil() as usize, take.frames());
    let weight = |k: usize| {
        let x = (k as f64 / frames) as f32;
        trig::exp(-0.5 * x * x)
    };
    let weights: Vec<f32> = (0..=reach).map(weight).collect();
    let mut sum = 0.0;
    for joint in 0..take.joints {
        let track: Vec<LocalTransform> = take.of_joint(joint).collect();
        for frame in 0..track.len() {
            let mean = mean_around(&track, frame, &weights);
            let turn = mean.rotation.angle_to(track[frame].rotation);
            sum += f64::from(turn);
            report.largest_turn = max(report.largest_turn, turn);
            report.largest_shift =
                max(report.largest_shift, (mean.translation - track[frame].translation).length());
            take.pose_mut(frame)[joint] = mean;
        }
    }
    report.mean_turn = (sum / take.poses.len() as f64) as f32;
    report
}

fn mean_around(track: &[LocalTransform], frame: usize, weights: &[f32]) -> LocalTransform {
    let here = track[frame];
    let (mut total, mut translation, mut sum) = (0.0, Vec3::ZERO, [0.0_f32; 4]);
    let reach = weights.len() - 1;
    for (k, local) in track.iter().enumerate().take(frame + reach + 1).skip(frame.saturating_sub(reach)) {
        let w = weights[frame.abs_diff(k)];
        let q = local.rotation.toward(here.rotation);
        total += w;
        translation += (local.translation - here.translation) * w;
        sum = [sum[0] + q.x * w, sum[1] + q.y * w, sum[2] + q.z * w, sum[3] + q.w * w];
    }
    LocalTransform {
        translation: here.translation + translation / total,
        rotation: Rotation::from_xyzw(sum[0], sum[1], sum[2], sum[3]).normalize(),
        scale: here.scale,
    }
}
