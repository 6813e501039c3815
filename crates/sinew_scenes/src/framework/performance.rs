//! One actor's captured motion, and its retargeting to other characters.

use crate::mannequin::mannequin;
use sinew::anim::retarget::{Body, Pace, RetargetError, RetargetOptions, Retargeted, retarget, stand};
use sinew::anim::{Clip, Rig, RigAnalysis, analyze_skeleton, rest_pose};
use sinew::formats::BvhDocument;

/// An actor's motion.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Performance {
    pub rig: Rig,
    pub clip: Clip,
    analysis: RigAnalysis,
}

/// Longest accepted motion, seconds.
const LONGEST: f32 = 600.0;

impl Performance {
    /// Reads a performance from a file; returns the reason if the performance cannot be retargeted.
    pub fn of(document: BvhDocument) -> Result<Self, String> {
        let BvhDocument { rig, clip, rest_pose, .. } = document;
        if clip.duration > LONGEST {
            return Err(format!(
                "the motion lasts {:.0} s; a scene accepts at most {LONGEST} s",
                clip.duration
            ));
        }
        let (analysis, _) = stand(&rig, &clip, rest_pose.as_deref()).map_err(|error| error.to_string())?;
        let performance = Self { rig, clip, analysis };
        performance.fitted(&mannequin().rig).map_err(|error| error.to_string())?;
        Ok(performance)
    }

    /// The mannequin's walk.
    pub fn walk() -> Self {
        let mut actor = mannequin();
        let analysis = analyze_skeleton(&actor.rig, &rest_pose(&actor.rig)).expect("the mannequin has bones");
        Self { rig: actor.rig, clip: actor.clips.swap_remove(actor.motions.walk), analysis }
    }

    pub fn fitted(&self, rig: &Rig) -> Result<Retargeted, RetargetError> {
        let analysis =
            analyze_skeleton(rig, &rest_pose(rig)).expect("a rig made from the mannequin has bones");
        // Set the unit explicitly. Otherwise a giant would be taken for a human in a file with other units.
        let analysis = analysis.with_unit_scale(1.0);
        let (from, to) =
            (Body { rig: &self.rig, analysis: &self.analysis }, Body { rig, analysis: &analysis });
        let options =
            RetargetOptions { frame_time: 1.0 / 30.0, pace: Pace::Froude, ..RetargetOptions::default() };
        retarget(from, &self.clip, to, &options)
    }
}
