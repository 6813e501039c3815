//! Characters and clips of DeepMimic (Peng et al., "DeepMimic: Example-Guided Deep Reinforcement Learning of
//! Physics-Based Character Skills", SIGGRAPH 2018): JSON, metres, +Y up, the body faces +X.
//!
//! A frame is a row of numbers: its duration; position and orientation (w, x, y, z) of the root; then per joint four
//! numbers for a ball joint, one angle about z for a hinge, none for a fixed joint. The joints are defined only in
//! the character, a separate file.
//!
//! ```
//! use sinew_formats::{read_deepmimic, read_deepmimic_character};
//!
//! let root = r#"{"Name": "root", "Type": "none", "Parent": -1, "AttachX": 0, "AttachY": 0, "AttachZ": 0,
//!     "AttachThetaX": 0, "AttachThetaY": 0, "AttachThetaZ": 0}"#;
//! let knee = r#"{"Name": "knee", "Type": "revolute", "Parent": 0, "AttachX": 0, "AttachY": -1, "AttachZ": 0,
//!     "AttachThetaX": 0, "AttachThetaY": 0, "AttachThetaZ": 0}"#;
//! let text = format!(r#"{{"Skeleton": {{"Joints": [{root}, {knee}]}}}}"#);
//! let character = read_deepmimic_character(text.as_bytes())?;
//! let frames = br#"{"Loop": "wrap", "Frames": [[0.5, 0, 2, 0, 1, 0, 0, 0, 0.25], [0, 0, 2, 0, 1, 0, 0, 0, 0.5]]}"#;
//! let clip = read_deepmimic(frames, &character)?;
//! assert_eq!(clip.clip.duration, 0.5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::container::json::{self, At};
use crate::error::{Result, quoted};
use sinew_anim::{Channel, Clip, Interpolation, Joint, JointIdx, LocalTransform, Property, Rig, Wrap};
use sinew_math::{EulerOrder, Rotation, Vec3};

/// Motion of a joint of a DeepMimic character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeepMimicJoint {
    /// Root: three numbers for its position, four for its orientation.
    Root,
    /// Ball joint: a quaternion w, x, y, z.
    Spherical,
    /// Hinge about z: an angle, radians.
    Revolute,
    /// Slide along x: metres.
    Prismatic,
    /// Fixed joint, without numbers.
    Fixed,
}

impl DeepMimicJoint {
    /// Number of values of the joint in a row.
    fn width(self) -> usize {
        match self {
            Self::Root => 7,
            Self::Spherical => 4,
            Self::Revolute | Self::Prismatic => 1,
            Self::Fixed => 0,
        }
    }
}

/// A DeepMimic character.
#[derive(Clone, Debug, PartialEq)]
pub struct DeepMimicCharacter {
    /// Joints in file order, metres.
    pub rig: Rig,
    /// Motion of each joint.
    pub joints: Vec<DeepMimicJoint>,
}

/// A DeepMimic clip.
#[derive(Clone, Debug, PartialEq)]
pub struct DeepMimicClip {
    /// The motion.
    pub clip: Clip,
    /// Behaviour outside the clip's time range, by the loop flag of the file.
    pub wrap: Wrap,
}

/// Reads a character: joints and their attachment. Ignores bodies, limits and gains.
///
/// # Errors
/// Returns an error that names the location: invalid JSON, a missing key or one of another type, a parent that does not
/// precede its child, a joint of an unknown type, no joint, a second root.
pub fn read_deepmimic_character(bytes: &[u8]) -> Result<DeepMimicCharacter> {
    let json = json::parse(bytes)?;
    let joints_at = At::root(&json).need("Skeleton")?.need("Joints")?;
    let mut found = DeepMimicCharacter { rig: Rig::default(), joints: Vec::new() };
    for (index, at) in joints_at.items()?.into_iter().enumerate() {
        let parent_at = at.need("Parent")?;
        let parent = match parent_at.f64()? {
            -1.0 => None,
            _ => Some(parent_at.index(index, "joints before it")?),
        };
        if parent.is_none() && index > 0 {
            return Err(parent_at.malformed("a second root"));
        }
        found.joints.push(joint_kind(at, parent)?);
        let rest =
            LocalTransform { translation: triple(at, "Attach")?, rotation: attached(at)?, scale: Vec3::ONE };
        found.rig.joints.push(Joint {
            name: at.need("Name")?.str()?.to_owned(),
            parent,
            rest,
            source: index,
        });
    }
    if found.joints.is_empty() {
        return Err(joints_at.malformed("no joints"));
    }
    Ok(found)
}

fn joint_kind(at: At<'_>, parent: Option<JointIdx>) -> Result<DeepMimicJoint> {
    let kind_at = at.need("Type")?;
    Ok(match (kind_at.str()?, parent) {
        (_, None) => DeepMimicJoint::Root,
        ("spherical", _) => DeepMimicJoint::Spherical,
        ("revolute", _) => DeepMimicJoint::Revolute,
        ("prismatic", _) => DeepMimicJoint::Prismatic,
        ("fixed", _) => DeepMimicJoint::Fixed,
        (other, _) => return Err(kind_at.unsupported(format!("a joint of type {}", quoted(other)))),
    })
}

/// Reads three numbers whose keys are `key` with X, Y and Z appended.
fn triple(at: At<'_>, key: &str) -> Result<Vec3> {
    let number = |axis: &str| at.need(&format!("{key}{axis}"))?.f32();
    Ok(Vec3::new(number("X")?, number("Y")?, number("Z")?))
}

/// Reads the rotation of a joint relative to its parent at rest: about fixed x, then y, then z.
fn attached(at: At<'_>) -> Result<Rotation> {
    let angles = triple(at, "AttachTheta")?;
    Ok(Rotation::from_euler(EulerOrder::Xyz.extrinsic(), angles.to_array()))
}

/// Reads a clip of a character.
///
/// # Errors
/// Returns an error that names the location: invalid JSON, no frame, a row whose length does not match the character, a
/// non-finite number, a frame without duration (other than the last).
pub fn read_deepmimic(bytes: &[u8], character: &DeepMimicCharacter) -> Result<DeepMimicClip> {
    let json = json::parse(bytes)?;
    let root = At::root(&json);
    let loops = root.get("Loop")?.map_or(Ok("none"), At::str)? == "wrap";
    let frames_at = root.need("Frames")?;
    let rows = read_rows(frames_at, 1 + character.joints.iter().map(|joint| joint.width()).sum::<usize>())?;
    let times = times(frames_at, &rows)?;
    let mut channels = Vec::new();
    let mut column = 1;
    for (joint, kind) in character.joints.iter().enumerate() {
        let part: Vec<&[f32]> = rows.iter().map(|row| &row[column..column + kind.width()]).collect();
        column += kind.width();
        for (property, values) in keys(*kind, character.rig.joints[joint].rest, &part) {
            let interpolation = Interpolation::Linear;
            channels.push(Channel { joint, property, interpolation, times: times.clone(), values });
        }
    }
    let clip = Clip { name: String::new(), duration: times[times.len() - 1], channels };
    Ok(DeepMimicClip { clip, wrap: if loops { Wrap::Loop } else { Wrap::Clamp } })
}

fn read_rows(frames_at: At<'_>, width: usize) -> Result<Vec<Vec<f32>>> {
    let mut rows = Vec::new();
    for at in frames_at.items()? {
        let items = at.items()?;
        if items.len() != width {
            let what = format!("{} numbers; a frame of this character has {width}", items.len());
            return Err(at.malformed(what));
        }
        rows.push(items.into_iter().map(At::f32).collect::<Result<Vec<f32>>>()?);
    }
    if rows.is_empty() {
        return Err(frames_at.malformed("no frames"));
    }
    Ok(rows)
}

/// Returns the start time of each frame, seconds. The last frame's duration is not used.
fn times(frames_at: At<'_>, rows: &[Vec<f32>]) -> Result<Vec<f32>> {
    let mut times = vec![0.0_f32];
    let mut sum = 0.0;
    for (i, row) in rows[..rows.len() - 1].iter().enumerate() {
        sum += f64::from(row[0]);
        if !(sum as f32 > times[i] && (sum as f32).is_finite()) {
            return Err(frames_at.items()?[i].malformed("the frame has no duration"));
        }
        times.push(sum as f32);
    }
    Ok(times)
}

/// Returns the animated properties of one joint, each with its values frame by frame.
fn keys(kind: DeepMimicJoint, rest: LocalTransform, part: &[&[f32]]) -> Vec<(Property, Vec<f32>)> {
    let turns = |turn: &dyn Fn(&[f32]) -> Rotation| {
        let mut last = rest.rotation;
        let mut values = Vec::with_capacity(4 * part.len());
        for numbers in part {
            last = (rest.rotation * turn(numbers)).normalize().toward(last);
            values.extend([last.x, last.y, last.z, last.w]);
        }
        (Property::Rotation, values)
    };
    let shifts = |shift: &dyn Fn(&[f32]) -> Vec3| {
        let values = part.iter().flat_map(|numbers| (rest.translation + shift(numbers)).to_array()).collect();
        (Property::Translation, values)
    };
    let quaternion = |n: &[f32]| Rotation::from_xyzw(n[1], n[2], n[3], n[0]).normalize();
    match kind {
        DeepMimicJoint::Root => {
            vec![shifts(&|n| Vec3::new(n[0], n[1], n[2])), turns(&|n| quaternion(&n[3..]))]
        }
        DeepMimicJoint::Spherical => vec![turns(&quaternion)],
        DeepMimicJoint::Revolute => vec![turns(&|n| Rotation::from_axis_angle(Vec3::Z, n[0]))],
        DeepMimicJoint::Prismatic => vec![shifts(&|n| rest.rotation * Vec3::new(n[0], 0.0, 0.0))],
        DeepMimicJoint::Fixed => Vec::new(),
    }
}
