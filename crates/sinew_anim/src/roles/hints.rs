//! Evidence about a character beside its skin and joints.

use super::Gait;
use crate::clip::Clip;
use crate::rig::Rig;
use sinew_math::Vec3;

/// Evidence from around a rig: its clips, the exporter, other files, the target world. The default is empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hints {
    /// Motion of the clips.
    pub gait: Gait,
    /// File name without folder and extension; empty if there is none.
    pub name: String,
    /// Exporting program as the file names it; empty if it does not.
    pub exporter: String,
    /// Units of neighbouring files, metres, if they are certain.
    pub kin: Vec<f32>,
    /// Up axis of the file, a unit vector along one of its axes, by its format or user; `None`: derive it from the
    /// body.
    pub up: Option<Vec3>,
    /// Clearance under the doors of its world, metres.
    pub door: Option<f32>,
}

impl Hints {
    /// Hints from the clips of a rig.
    ///
    /// # Panics
    /// As [`Gait::of`].
    pub fn of_clips(rig: &Rig, clips: &[Clip]) -> Self {
        Self { gait: Gait::of(rig, clips), ..Self::default() }
    }
}
