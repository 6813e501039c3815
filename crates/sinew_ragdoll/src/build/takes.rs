//! A character's clips as poses for the build.

use crate::tuning::FRAME_TIME;
use sinew_anim::{Clip, Rig, Take};

/// Largest number of frames of all takes together: about a minute of motion.
const MOST_FRAMES: usize = 2048;

/// Returns the clips as takes with equal frame times: 30 a second, or fewer if the clips are long. Clips without a
/// finite duration are dropped, and so are those beyond the first 2,048.
///
/// # Panics
/// As [`sample`](sinew_anim::sample()): if a clip is not one of the rig's.
pub fn takes(rig: &Rig, clips: &[Clip]) -> Vec<Take> {
    if rig.joints.is_empty() {
        return Vec::new();
    }
    let lasts = |clip: &&Clip| clip.duration.is_finite() && clip.duration >= 0.0;
    let clips: Vec<&Clip> = clips.iter().filter(lasts).take(MOST_FRAMES).collect();
    let whole: f64 = clips.iter().map(|clip| f64::from(clip.duration)).sum();
    let even = whole / MOST_FRAMES as f64;
    let frame_time = if even > FRAME_TIME { even } else { FRAME_TIME };
    clips.into_iter().map(|clip| Take::of(rig, clip, frame_time)).collect()
}
