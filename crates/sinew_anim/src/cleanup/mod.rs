//! Repairs of motion capture. Every function changes a [`Take`](crate::Take) in place, in all frames and joints, and
//! returns a report; none keeps state. Rotations are local, in radians; joint lengths are in the unit of the rig.
//! Lengths of feet and floors are metres in the space of `root`, y up.
//!
//! Recommended order: [`despike`], [`smooth`], [`project_limits`], [`remove_penetration`], [`remove_foot_slide`].

mod foot_slide;
mod limits;
mod penetration;
mod smooth;
mod spikes;

pub use foot_slide::{FootSlideReport, remove_foot_slide};
pub use limits::{JointExcess, project_limits};
pub use penetration::{PenetrationReport, raise, remove_penetration};
pub use smooth::{SmoothReport, smooth};
pub use spikes::{Spike, SpikeSettings, despike};

use sinew_math::max;

/// Returns a smooth curve that is nowhere below `least`: the maximum within `reach` frames, averaged over as many.
fn smooth_above(least: &[f32], reach: usize) -> Vec<f32> {
    let around = |i: usize, of: &[f32]| i.saturating_sub(reach)..(i + reach + 1).min(of.len());
    let tops: Vec<f32> =
        (0..least.len()).map(|i| least[around(i, least)].iter().copied().fold(least[i], max)).collect();
    let mean = |i: usize| {
        let near = &tops[around(i, &tops)];
        near.iter().sum::<f32>() / near.len() as f32
    };
    (0..tops.len()).map(mean).collect()
}
