//! Evidence about a character in addition to its skin and joints.

use super::Gait;
use crate::clip::Clip;
use crate::rig::Rig;
use sinew_math::Vec3;

/// Evidence besides a rig: its clips, the exporter, other files, the target world. The default is empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hints {
    /// Motion of the clips.
    pub gait: Gait,
    /// File name without folder and extension; empty if there is none.
    pub name: String,
    /// Exporting program as named in the file; empty if it is not named.
    pub exporter: String,
    /// Units of neighbouring files that are certain, metres.
    pub kin: Vec<f32>,
    /// Up axis of the file, a unit vector along one of its axes, given by the format or the user; `None`: derive
    /// it from the body.
    pub up: Option<Vec3>,
    /// Clearance under the doors of the target world, metres.
    pub door: Option<f32>,
}

impl Hints {
    /// Creates hints from the clips of a rig.
    ///
    /// # Panics
    /// As [`Gait::of`].
    pub fn of_clips(rig: &Rig, clips: &[Clip]) -> Self {
        Self { gait: Gait::of(rig, clips), ..Self::default() }
    }
}
