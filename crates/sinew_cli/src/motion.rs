//! Files with clips, whatever they are.

use crate::failure::Result;
use sinew::anim::retarget::stand;
use sinew::anim::{Clip, RigAnalysis, analyze};
use sinew::formats::{Error, MotionFile, MotionOptions, load_motion};
use std::path::Path;

/// A file with clips: what it holds, and what its joints are.
pub struct Motion {
    /// As the user named it.
    pub name: String,
    /// Its rig and its clips.
    pub file: MotionFile,
    /// What its joints are; `None` where there is neither a skin nor a skeleton like a human's.
    pub analysis: Option<RigAnalysis>,
}

impl Motion {
    /// Reads a file and finds out what its joints are.
    pub fn load(path: &Path, options: &MotionOptions<'_>) -> Result<Self> {
        let file = load_motion(path, options).map_err(helped)?;
        Ok(Self::new(path.display().to_string(), file))
    }

    /// Finds out what the joints of a file of that name are.
    pub fn new(name: String, file: MotionFile) -> Self {
        let analysis = analyze_any(&file);
        Self { name, file, analysis }
    }

    /// Whether a mesh hangs on its joints.
    pub fn has_skin(&self) -> bool {
        !self.file.rig.skins.is_empty()
    }
}

/// An error with the option that gets around it, where there is one.
fn helped(mut error: Error) -> Error {
    if error.what.starts_with("declares ") && error.what.contains(" frames, has ") {
        error.what += "; 'sinew convert --any-rows' takes those that are there";
    }
    error
}

/// By the skin, else as a skeleton in the pose in which it stands best: any few nodes look like some creature, so that
/// counts for humans only.
fn analyze_any(file: &MotionFile) -> Option<RigAnalysis> {
    if let Ok(analysis) = analyze(&file.rig) {
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
