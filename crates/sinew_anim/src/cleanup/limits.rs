//! Rotates joints back into their limits.

use crate::clip::take::Take;
use crate::learned_limits::LearnedLimit;
use crate::rig::JointIdx;
use sinew_math::max;

/// Number of frames and largest angle by which a joint exceeded its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointExcess {
    /// Joint that exceeded its limit.
    pub joint: JointIdx,
    /// Number of frames beyond the limit.
    pub frames: usize,
    /// Largest excess, radians.
    pub largest: f32,
}

/// Rotates every joint that is beyond its limit to the nearest rotation within it. Returns the joints that exceeded
/// their limits.
///
/// # Panics
/// If the take lacks the joint of a limit.
pub fn project_limits(take: &mut Take, limits: &[LearnedLimit]) -> Vec<JointExcess> {
    let mut report = Vec::new();
    for limit in limits {
        assert!(limit.joint < take.joints, "the limits must fit the rig");
        let mut excess = JointExcess { joint: limit.joint, frames: 0, largest: 0.0 };
        for frame in 0..take.frames() {
            let local = &mut take.pose_mut(frame)[limit.joint];
            let within = limit.project(local.rotation);
            let turn = within.angle_to(local.rotation);
            if turn > 1e-4 {
                excess.frames += 1;
                excess.largest = max(excess.largest, turn);
                local.rotation = within;
            }
        }
        if excess.frames > 0 {
            report.push(excess);
        }
    }
    report
}
