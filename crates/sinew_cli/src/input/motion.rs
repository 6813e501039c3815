//! Reads files with clips in any format.

use crate::failure::Result;
use crate::input::kin::units_beside;
use crate::input::source::{load_motion, name};
use sinew::anim::retarget::stand;
use sinew::anim::{Clip, Hints, RigAnalysis, analyze_hinted};
use sinew::character_hints;
use sinew::formats::bvh::{BvhOptions, BvhUnit};
use sinew::formats::{Error, MotionFile, MotionFormat, MotionOptions};
use std::path::Path;

/// A file with clips: its content and the analysis of its joints.
pub struct Motion {
    /// Name of the file, as given by the user.
    pub name: String,
    /// Rig and clips of the file.
    pub file: MotionFile,
    /// Analysis of the file's joints; `None` without a skin or a humanoid skeleton.
    pub analysis: Option<RigAnalysis>,
}

impl Motion {
    /// Reads a file and analyses its joints.
    pub fn load(path: &Path, options: &MotionOptions<'_>) -> Result<Self> {
        let file = load_motion(path, options).map_err(helped)?;
        let mut motion = Self::new(name(path), file);
        motion.read_neighbours(path);
        Ok(motion)
    }

    /// Reads a file whose unit has a given length, metres, or a guessed one.
    pub fn load_in(path: &Path, unit: Option<f32>) -> Result<Self> {
        let bvh =
            BvhOptions { unit: unit.map_or(BvhUnit::default(), BvhUnit::Metres), ..BvhOptions::default() };
        let mut motion = Self::load(path, &MotionOptions { bvh, ..MotionOptions::default() })?;
        // The reader of BVH has converted lengths to metres.
        if motion.file.format != MotionFormat::Bvh
            && let Some(unit) = unit
        {
            motion.analysis = motion.analysis.map(|analysis| analysis.with_unit_scale(unit));
        }
        Ok(motion)
    }

    /// Resolves a doubtful unit by the files next to a character, as `bake` does.
    fn read_neighbours(&mut self, path: &Path) {
        let Some(analysis) = &self.analysis else { return };
        let in_doubt = analysis.unit_guess.as_ref().is_some_and(|guess| !guess.is_only);
        if !(in_doubt && analysis.unit_scale != 1.0 && self.has_skin()) {
            return;
        }
        let hints = Hints { kin: units_beside(path), ..analysis.hints.clone() };
        if hints != analysis.hints
            && let Ok(analysis) = analyze_hinted(&self.file.rig, &hints)
        {
            self.analysis = Some(analysis);
        }
    }

    /// Analyses the joints of a file of that name.
    pub fn new(name: String, file: MotionFile) -> Self {
        let analysis = analyze_any(&name, &file);
        Self { name, file, analysis }
    }

    /// Returns true if the file has a skin.
    pub fn has_skin(&self) -> bool {
        !self.file.rig.skins.is_empty()
    }
}

/// Adds the option that avoids the error to the error's text, if there is one.
fn helped(mut error: Error) -> Error {
    if error.what.starts_with("declares ") && error.what.contains(" frames, has ") {
        error.what += "; 'sinew convert --any-rows' accepts the existing ones";
    }
    error
}

/// Analyses the skin, or without one the skeleton in its most upright pose. A skeleton must be human, because any few
/// nodes resemble some creature.
fn analyze_any(name: &str, file: &MotionFile) -> Option<RigAnalysis> {
    let hints = character_hints(name, &file.rig, &file.clips, &file.generator);
    if let Ok(analysis) = analyze_hinted(&file.rig, &hints) {
        return Some(analysis);
    }
    let has_bones = file.rig.meshes.is_empty() || !file.clips.is_empty() || !file.rig.stated_roles.is_empty();
    if file.rig.joints.is_empty() || !has_bones {
        return None;
    }
    let still = Clip::default();
    let clip = file.clips.first().unwrap_or(&still);
    let (analysis, _) = stand(&file.rig, clip, file.rest_pose.as_deref()).ok()?;
    let analysis = match file.metres_per_unit {
        Some(metres) => analysis.with_unit_scale(metres),
        None => analysis,
    };
    analysis.humanoid.then_some(analysis)
}
