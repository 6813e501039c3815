//! Biovision Hierarchy (BVH): a skeleton and its motion as text, the format of most free motion capture.
//!
//! The makers of the format never published a specification, so files differ in almost every detail. This reader
//! accepts rotation channels in any order and number, per joint; positions at any joint; joints of length zero;
//! missing End Sites; any line ends and any white space. Assumptions and corrections are in [`BvhDocument::notes`].
//!
//! ```
//! use sinew_formats::{BvhOptions, BvhWriteOptions, read_bvh, write_bvh};
//!
//! let text = "HIERARCHY
//! ROOT hips { OFFSET 0 0 0
//!   CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
//!   JOINT head { OFFSET 0 80 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET 0 20 0 } } }
//! MOTION
//! Frames: 2
//! Frame Time: 0.0333333
//! 0 90 0  0 0 0  0 0 0
//! 0 90 5  0 0 0  0 30 0";
//! let document = read_bvh(text.as_bytes(), BvhOptions::default())?;
//! assert_eq!((document.frames, document.metres_per_unit), (2, 0.01)); // no one is 100 m tall
//! println!("{}", document.notes.join("\n"));
//!
//! let written = write_bvh(&document.rig, &document.clip, &BvhWriteOptions::default())?;
//! let again = read_bvh(written.text.as_bytes(), BvhOptions::default())?;
//! assert_eq!(again.rig.joints.len(), document.rig.joints.len());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod channel;
mod hierarchy;
mod motion;
mod rest_frame;
mod timing;
mod unit;
mod words;
mod write;

pub use channel::BvhChannel;
pub use rest_frame::RestFrame;
pub use unit::BvhUnit;
pub use write::{BvhEnds, BvhText, BvhWriteOptions, write_bvh};

use crate::error::Result;
use hierarchy::Hierarchy;
use motion::Motion;
use sinew_anim::{Clip, LocalTransform, Rig};
use words::Words;

/// Handling of a file with more or fewer rows than its `Frames:` line declares.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BvhRows {
    /// Reject the file: it may be truncated.
    #[default]
    AsDeclared,
    /// Read the complete rows and add a note.
    AsPresent,
}

/// Options for reading a BVH file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BvhOptions {
    /// Length of the file's unit. Default: inferred.
    pub unit: BvhUnit,
    /// Handling of a rest pose before the motion. Default: excluded from the clip.
    pub rest_frame: RestFrame,
    /// Handling of a wrong number of rows. Default: reject the file.
    pub rows: BvhRows,
}

/// A BVH file as plain data.
#[derive(Clone, Debug, PartialEq)]
pub struct BvhDocument {
    /// Joints in file order, metres. Rest pose: the offsets, no rotation. An End Site is a joint without a name.
    pub rig: Rig,
    /// One linear channel for every joint's rotations, and one for the translations of each joint with positions.
    pub clip: Clip,
    /// Frame time in seconds, as repaired; see [`notes`](Self::notes).
    pub frame_time: f64,
    /// Frames in the clip, at least 1.
    pub frames: usize,
    /// Metres per unit of the file.
    pub metres_per_unit: f32,
    /// Channels of each joint in file order, for [`BvhWriteOptions::channels`].
    pub channels: Vec<Vec<BvhChannel>>,
    /// The rest pose in the first frame, if there is one. It shows the body better than the offsets.
    pub rest_pose: Option<Vec<LocalTransform>>,
    /// Notes on assumptions, repairs and omissions, one sentence each.
    pub notes: Vec<String>,
}

/// Reads a BVH file. Memory is proportional to the file size, for any numbers in the file, and the call depth is
/// bounded.
///
/// # Errors
/// Returns an error that names the line, and the joint if there is one: misplaced words, unbalanced braces, an
/// unknown or repeated channel, an invalid or non-finite number, a row that is too long or too short, a wrong number
/// of rows (see [`BvhRows`]), no joint, no channel, no frame, a frame time that is not above 0.
pub fn read_bvh(bytes: &[u8], options: BvhOptions) -> Result<BvhDocument> {
    let text = String::from_utf8_lossy(bytes);
    let mut words = Words::new(text.strip_prefix('\u{feff}').unwrap_or(&text));
    let mut notes = Vec::new();
    let hierarchy = Hierarchy::read(&mut words)?;
    let motion = Motion::read(&mut words, &hierarchy, options.rows, &mut notes)?;
    let unit = options.unit.resolve(&hierarchy, &mut notes);
    let rest = rest_frame::find(&hierarchy, &motion, options.rest_frame, &mut notes);
    let rig = hierarchy.rig(unit);
    let frames = motion::frames(&hierarchy, &motion, unit, &mut notes);
    let skipped = usize::from(rest && options.rest_frame == RestFrame::Skip);
    let clip = frames.clip(&rig, skipped, motion.frame_time)?;
    Ok(BvhDocument {
        rest_pose: rest.then(|| frames.pose(&rig, 0)),
        rig,
        clip,
        frame_time: motion.frame_time,
        frames: motion.rows.len() / hierarchy.width - skipped,
        metres_per_unit: unit,
        channels: hierarchy.joints.into_iter().map(|joint| joint.channels).collect(),
        notes,
    })
}
