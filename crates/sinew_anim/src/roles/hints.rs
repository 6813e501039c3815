//! Evidence about a character beside its skin and its joints.

use super::Gait;
use crate::clip::Clip;
use crate::rig::Rig;
use sinew_math::Vec3;

/// Evidence from around a rig: its clips, the program that wrote its file, other files, the world that it is put in. The default
/// knows nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hints {
    /// Motion in its clips.
    pub gait: Gait,
    /// Name of the file without its folder and ending; empty if it has none.
    pub name: String,
    /// The program that wrote the file, as the file names it; empty if it does not.
    pub exporter: String,
    /// Units of files that lie beside it, metres, as far as they leave no doubt.
    pub kin: Vec<f32>,
    /// Up axis of the file, a unit vector along one of its axes: what its format or its user says; `None`: read off the body.
    pub up: Option<Vec3>,
    /// Free height under the doors of the world that it is put in, metres.
    pub door: Option<f32>,
}

impl Hints {
    /// Hints that the clips of a rig give.
    ///
    /// # Panics
    /// As [`Gait::of`].
    pub fn of_clips(rig: &Rig, clips: &[Clip]) -> Self {
        Self { gait: Gait::of(rig, clips), ..Self::default() }
    }
}
