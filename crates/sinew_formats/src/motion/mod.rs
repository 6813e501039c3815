//! Reads any file with clips by one function: glTF, GLB, VRM and VRMA, BVH, DeepMimic, FBX, and the skeleton of a Jolt
//! ragdoll.
//!
//! ```
//! use sinew_formats::{MotionFormat, MotionOptions, no_files, read_motion, write_gltf};
//!
//! let mannequin = sinew::mannequin::mannequin();
//! let bytes = write_gltf(&mannequin.rig, &mannequin.clips)?; // or those of any other file
//! let file = read_motion(&bytes, &MotionOptions::default(), &mut no_files)?;
//! assert_eq!((file.format, file.clips.len()), (MotionFormat::Glb, mannequin.clips.len()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod format;

pub use format::MotionFormat;
pub(crate) use format::foreign;

use crate::bvh::{BvhOptions, read_bvh};
use crate::deepmimic::{DeepMimicCharacter, read_deepmimic, read_deepmimic_character};
use crate::error::{Error, Result};
use crate::gltf::{ReadOptions, Resolver, SpringFormat, read_gltf};
use crate::jolt::read_jolt_ragdoll;
use sinew_anim::{Clip, ClipEvent, LocalTransform, Rig};

/// Options for reading a file with clips.
#[derive(Clone, Copy, Debug, Default)]
pub struct MotionOptions<'a> {
    /// Options for a BVH file.
    pub bvh: BvhOptions,
    /// Character of a DeepMimic clip, which the clip does not name.
    pub deepmimic: Option<&'a DeepMimicCharacter>,
    /// Options for a glTF or FBX file.
    pub gltf: ReadOptions,
}

/// A rig and its clips, from any format.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionFile {
    /// Format of the file.
    pub format: MotionFormat,
    /// Program that wrote the file, or `""`.
    pub generator: String,
    /// Names of the extensions that a glTF uses.
    pub extensions: Vec<String>,
    /// Format of the rig's springs; `None` if the file has none.
    pub spring_format: Option<SpringFormat>,
    /// Joints, with skins and meshes where the format has them.
    pub rig: Rig,
    /// Clips in file order.
    pub clips: Vec<Clip>,
    /// Events of each clip, by time: from the file itself, and from the events file next to it.
    pub events: Vec<Vec<ClipEvent>>,
    /// Seconds from frame to frame, if the file was captured or baked at a fixed rate.
    pub frame_time: Option<f64>,
    /// Metres per unit of the rig, if the file states the unit or it is inferred; with `None` the rig's analysis
    /// decides.
    pub metres_per_unit: Option<f32>,
    /// A pose that shows the body, if the file has one in addition to the rig's rest pose: see
    /// [`stand`](sinew_anim::retarget::stand).
    pub rest_pose: Option<Vec<LocalTransform>>,
    /// Notes on assumptions, repairs and omissions, one sentence each.
    pub notes: Vec<String>,
}

/// Reads any file with clips; the bytes determine the format. `resolve` returns the files next to a glTF, and the
/// pictures next to an FBX.
///
/// Formats without clip names leave the names empty. A DeepMimic character is a rig without clips, and so is a Jolt
/// ragdoll: [`read_jolt_animation`](crate::read_jolt_animation) reads its clips.
///
/// # Errors
/// If the bytes are of no known format; as the readers ([`read_gltf`], [`read_bvh`], [`read_deepmimic`]); for a
/// DeepMimic clip without its character, and an FBX file without the feature `fbx`.
pub fn read_motion(
    bytes: &[u8],
    options: &MotionOptions<'_>,
    resolve: &mut Resolver<'_>,
) -> Result<MotionFile> {
    let format = MotionFormat::of(bytes)?;
    match format {
        MotionFormat::Glb | MotionFormat::Gltf => of_gltf(format, bytes, options.gltf, resolve),
        MotionFormat::Bvh => of_bvh(bytes, options.bvh),
        MotionFormat::DeepMimicCharacter => Ok(MotionFile {
            metres_per_unit: Some(1.0),
            ..bare(format, read_deepmimic_character(bytes)?.rig)
        }),
        MotionFormat::DeepMimic => of_deepmimic(bytes, options.deepmimic),
        MotionFormat::Jolt => {
            Ok(MotionFile { metres_per_unit: Some(1.0), ..bare(format, read_jolt_ragdoll(bytes)?.rig) })
        }
        #[cfg(feature = "fbx")]
        MotionFormat::Fbx => crate::fbx::read_fbx_with(bytes, options.gltf, resolve),
        #[cfg(not(feature = "fbx"))]
        MotionFormat::Fbx => {
            let what = "an FBX file: this build has no reader for it (feature `fbx`)";
            Err(Error::unsupported(what, "byte 0"))
        }
    }
}

/// Returns the contents of a file that has only a rig.
fn bare(format: MotionFormat, rig: Rig) -> MotionFile {
    MotionFile {
        format,
        generator: String::new(),
        extensions: Vec::new(),
        spring_format: None,
        rig,
        clips: Vec::new(),
        events: Vec::new(),
        frame_time: None,
        metres_per_unit: None,
        rest_pose: None,
        notes: Vec::new(),
    }
}

fn of_gltf(
    format: MotionFormat,
    bytes: &[u8],
    options: ReadOptions,
    resolve: &mut Resolver<'_>,
) -> Result<MotionFile> {
    let document = read_gltf(bytes, options, resolve)?;
    let animation = &document.json["extensions"]["VRMC_vrm_animation"];
    let unread = [("expressions", "expressions of the face"), ("lookAt", "where it looks")];
    let unread = unread.iter().filter(|(key, _)| animation.get(key).is_some());
    let mut notes = document.warnings.clone();
    notes.extend(unread.map(|(_, what)| format!("left out of a VRM animation: {what}")));
    Ok(MotionFile {
        generator: document.generator().to_owned(),
        extensions: document.extensions().into_iter().map(str::to_owned).collect(),
        spring_format: document.spring_format(),
        clips: document.clips,
        events: document.events,
        notes,
        ..bare(format, document.rig)
    })
}

fn of_bvh(bytes: &[u8], options: BvhOptions) -> Result<MotionFile> {
    let document = read_bvh(bytes, options)?;
    Ok(MotionFile {
        clips: vec![document.clip],
        events: vec![Vec::new()],
        frame_time: Some(document.frame_time),
        // The reader has converted the file's units to metres.
        metres_per_unit: Some(1.0),
        rest_pose: document.rest_pose,
        notes: document.notes,
        ..bare(MotionFormat::Bvh, document.rig)
    })
}

fn of_deepmimic(bytes: &[u8], character: Option<&DeepMimicCharacter>) -> Result<MotionFile> {
    let Some(character) = character else {
        let what = "a DeepMimic clip does not say whose joints it moves: its character's file is needed";
        return Err(Error::unsupported(what, "top level"));
    };
    let clip = read_deepmimic(bytes, character)?.clip;
    Ok(MotionFile {
        clips: vec![clip],
        events: vec![Vec::new()],
        metres_per_unit: Some(1.0),
        ..bare(MotionFormat::DeepMimic, character.rig.clone())
    })
}
