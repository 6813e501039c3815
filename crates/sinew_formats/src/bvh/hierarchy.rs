//! The first half of a file: joints, their offsets and their channels.

use super::channel::BvhChannel;
use super::words::Words;
use crate::error::{Error, Result, quoted};
use sinew_anim::{Joint, LocalTransform, Rig};
use sinew_math::Vec3;

/// A joint as in the file.
pub(super) struct FileJoint {
    /// Name, `""` for an End Site.
    pub name: String,
    pub parent: Option<usize>,
    /// Offset from the parent, file units.
    pub offset: Vec3,
    pub channels: Vec<BvhChannel>,
    /// Index of the joint's first number in a row.
    pub column: usize,
}

impl FileJoint {
    pub fn has_positions(&self) -> bool {
        self.channels.iter().any(|channel| !channel.is_rotation())
    }

    pub fn has_rotations(&self) -> bool {
        self.channels.iter().any(|channel| channel.is_rotation())
    }
}

/// Joints in file order, parents before children.
pub(super) struct Hierarchy {
    pub joints: Vec<FileJoint>,
    /// Number of numbers in a row.
    pub width: usize,
}

/// Largest number of channels per joint: one of each kind.
const MOST_CHANNELS: usize = BvhChannel::ALL.len();

impl Hierarchy {
    /// Reads the text up to and including the word `MOTION`. Open joints are kept in a list instead of the call
    /// stack, so deep nesting is safe.
    pub fn read(words: &mut Words<'_>) -> Result<Self> {
        let first = words.next().unwrap_or_default();
        if !first.eq_ignore_ascii_case("HIERARCHY") {
            return Err(Error::malformed("not a BVH file: does not begin with `HIERARCHY`", "line 1"));
        }
        let mut found = Self { joints: Vec::new(), width: 0 };
        let mut open: Vec<usize> = Vec::new();
        loop {
            let expected = if open.is_empty() { "`ROOT` or `MOTION`" } else { "`}`, `JOINT` or `End Site`" };
            let word = words.need(expected)?;
            let is = |keyword: &str| word.eq_ignore_ascii_case(keyword);
            match open.last().copied() {
                None if is("ROOT") => open.push(found.open(words, None, false)?),
                None if is("MOTION") => break,
                Some(_) if is("}") => drop(open.pop()),
                Some(joint) if is("OFFSET") => found.joints[joint].offset = read_offset(words)?,
                Some(joint) if is("CHANNELS") => found.read_channels(words, joint)?,
                Some(parent) if is("JOINT") => open.push(found.open(words, Some(parent), false)?),
                Some(parent) if is("End") => {
                    words.expect("Site")?;
                    open.push(found.open(words, Some(parent), true)?);
                }
                _ => {
                    let what = format!("expected {expected}, found {}", quoted(word));
                    return Err(Error::malformed(what, words.place()));
                }
            }
        }
        match found {
            Self { ref joints, .. } if joints.is_empty() => Err(Error::malformed("no joints", words.place())),
            Self { width: 0, .. } => Err(Error::malformed("no joint has a channel", words.place())),
            found => Ok(found),
        }
    }

    /// Starts a joint: reads up to and including its `{`.
    fn open(&mut self, words: &mut Words<'_>, parent: Option<usize>, is_end: bool) -> Result<usize> {
        let name = words.rest_of_line();
        if name.is_empty() && !is_end {
            return Err(Error::malformed("a joint without a name", words.place()));
        }
        words.expect("{")?;
        let name = if is_end { String::new() } else { name.to_owned() };
        self.joints.push(FileJoint { name, parent, offset: Vec3::ZERO, channels: Vec::new(), column: 0 });
        Ok(self.joints.len() - 1)
    }

    fn read_channels(&mut self, words: &mut Words<'_>, joint: usize) -> Result<()> {
        let count = words.number("the number of channels")?;
        let owner = quoted(&self.joints[joint].name);
        let complain = |what: String, words: &Words<'_>| {
            Error::malformed(what, format!("{}, joint {owner}", words.place()))
        };
        if !self.joints[joint].channels.is_empty() {
            return Err(complain("a second list of channels".into(), words));
        }
        if !(0.0..=MOST_CHANNELS as f64).contains(&count) || count.fract() != 0.0 {
            return Err(complain(format!("{count} channels; a joint has 0 to {MOST_CHANNELS}"), words));
        }
        let mut channels = Vec::new();
        for _ in 0..count as usize {
            let word = words.need("a channel")?;
            let channel = BvhChannel::from_name(word)
                .ok_or_else(|| complain(format!("unknown channel {}", quoted(word)), words))?;
            if channels.contains(&channel) {
                return Err(complain(format!("`{}` is listed twice", channel.name()), words));
            }
            channels.push(channel);
        }
        self.joints[joint].column = self.width;
        self.width += channels.len();
        self.joints[joint].channels = channels;
        Ok(())
    }

    /// Makes a rig of the joints; the rest pose has the offsets.
    pub fn rig(&self, metres_per_unit: f32) -> Rig {
        let joint = |(source, joint): (usize, &FileJoint)| Joint {
            name: joint.name.clone(),
            parent: joint.parent,
            rest: LocalTransform { translation: joint.offset * metres_per_unit, ..LocalTransform::default() },
            source,
        };
        Rig { joints: self.joints.iter().enumerate().map(joint).collect(), ..Rig::default() }
    }

    /// Describes the joint and the channel to which a number of a row belongs.
    pub fn name_column(&self, column: usize) -> String {
        let owns = |joint: &&FileJoint| (joint.column..joint.column + joint.channels.len()).contains(&column);
        self.joints.iter().find(owns).map_or_else(String::new, |joint| {
            format!("{} of {}", joint.channels[column - joint.column].name(), quoted(&joint.name))
        })
    }
}

fn read_offset(words: &mut Words<'_>) -> Result<Vec3> {
    let mut offset = [0.0; 3];
    for number in &mut offset {
        *number = words.number("an offset")? as f32;
    }
    Ok(Vec3::from_array(offset))
}
