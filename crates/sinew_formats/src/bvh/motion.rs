//! The second half of a file: a row of numbers per frame, converted to joint transforms.

use super::BvhRows;
use super::channel::BvhChannel;
use super::hierarchy::{FileJoint, Hierarchy};
use super::timing::mended_frame_time;
use super::words::{Words, parse_number};
use crate::error::{Error, Result};
use sinew_anim::{Channel, Clip, Interpolation, LocalTransform, Property, Rig};
use sinew_math::{Rotation, Vec3};

/// Rows of numbers.
pub(super) struct Motion {
    /// Frame time, seconds.
    pub frame_time: f64,
    /// Rows of the hierarchy's width, concatenated, file units and degrees.
    pub rows: Vec<f32>,
}

impl Motion {
    /// Reads the text after the word `MOTION`. Allocates only for rows that are present, not for declared ones.
    pub fn read(
        words: &mut Words<'_>,
        hierarchy: &Hierarchy,
        expected: BvhRows,
        notes: &mut Vec<String>,
    ) -> Result<Self> {
        let declared = read_count(words)?;
        let frame_time = read_frame_time(words, notes)?;
        let mut rows = Vec::new();
        while let Some((number, line)) = words.next_line() {
            read_row(line, number, hierarchy, &mut rows)?;
        }
        let found = (rows.len() / hierarchy.width) as f64;
        if found == 0.0 {
            return Err(Error::malformed("no frames", words.place()));
        }
        if found != declared {
            let what = format!("declares {declared} frames, has {found}");
            match expected {
                BvhRows::AsDeclared => return Err(Error::malformed(what, words.place())),
                BvhRows::AsPresent => notes.push(format!("{what}: read the present ones")),
            }
        }
        Ok(Self { frame_time, rows })
    }
}

/// Reads `Frames: N`, with or without a blank before the colon, and returns N.
fn read_count(words: &mut Words<'_>) -> Result<f64> {
    expect_label(words, "Frames")?;
    let declared = words.number("the number of frames")?;
    if declared >= 0.0 && declared.fract() == 0.0 {
        return Ok(declared);
    }
    Err(Error::malformed(format!("{declared} is not a number of frames"), words.place()))
}

/// Reads `Frame Time: T` and returns T, seconds, repaired.
fn read_frame_time(words: &mut Words<'_>, notes: &mut Vec<String>) -> Result<f64> {
    words.expect("Frame")?;
    expect_label(words, "Time")?;
    let printed = words.need("the frame time")?;
    let stated = parse_number(printed)
        .map_err(|wrong| Error::malformed(format!("the frame time: {wrong}"), words.place()))?;
    if stated <= 0.0 {
        return Err(Error::malformed(format!("a frame time of {printed} s"), words.place()));
    }
    let Some(rate) = mended_frame_time(printed, stated) else { return Ok(stated) };
    notes.push(format!("the frame time {printed} s is 1/{rate} s cut short: taken as that"));
    Ok(1.0 / f64::from(rate))
}

/// Reads a word and a colon, as one word or two.
fn expect_label(words: &mut Words<'_>, label: &str) -> Result<()> {
    let with_colon = format!("{label}:");
    let word = words.need(&format!("`{with_colon}`"))?;
    if word.eq_ignore_ascii_case(label) {
        return words.expect(":");
    }
    if word.eq_ignore_ascii_case(&with_colon) {
        return Ok(());
    }
    let what = format!("expected `{with_colon}`, found {}", crate::error::quoted(word));
    Err(Error::malformed(what, words.place()))
}

fn read_row(line: &str, number: usize, hierarchy: &Hierarchy, rows: &mut Vec<f32>) -> Result<()> {
    let place = || format!("line {number}");
    let mut column = 0;
    for word in line.split_whitespace() {
        if column == hierarchy.width {
            let there = line.split_whitespace().count();
            let what = format!("{there} numbers in a row of {}", hierarchy.width);
            return Err(Error::malformed(what, place()));
        }
        let value = parse_number(word).map_err(|wrong| {
            Error::malformed(wrong, format!("line {number}, {}", hierarchy.name_column(column)))
        })?;
        rows.push(value as f32);
        column += 1;
    }
    if column == hierarchy.width {
        return Ok(());
    }
    Err(Error::malformed(format!("{column} numbers in a row of {}", hierarchy.width), place()))
}

/// Local transforms of all joints, joint by joint.
pub(super) struct Frames {
    /// Rotations of each joint by frame; empty if it has no rotation channel.
    rotations: Vec<Vec<Rotation>>,
    /// Translations of each joint by frame, metres; empty if it has no position channel.
    translations: Vec<Vec<Vec3>>,
}

/// Converts the rows to channels, joint by joint.
pub(super) fn frames(
    hierarchy: &Hierarchy,
    motion: &Motion,
    metres_per_unit: f32,
    notes: &mut Vec<String>,
) -> Frames {
    let mut found = Frames { rotations: Vec::new(), translations: Vec::new() };
    let mut added = 0;
    for joint in &hierarchy.joints {
        let numbers = || {
            let columns = joint.column..joint.column + joint.channels.len();
            motion.rows.chunks_exact(hierarchy.width).map(move |row| &row[columns.clone()])
        };
        let mut rotations = Vec::new();
        if joint.has_rotations() {
            let mut last = Rotation::IDENTITY;
            rotations.extend(numbers().map(|numbers| {
                last = rotation(joint, numbers).toward(last);
                last
            }));
        }
        let mut translations = Vec::new();
        if joint.has_positions() {
            let (base, is_added) = position_base(joint, &motion.rows);
            added += usize::from(is_added);
            translations
                .extend(numbers().map(|numbers| (base + positions(joint, numbers)) * metres_per_unit));
        }
        found.rotations.push(rotations);
        found.translations.push(translations);
    }
    if added > 0 {
        notes.push(format!(
            "positions of {added} joints start nearer to zero than to the offset: they add to it"
        ));
    }
    found
}

/// Returns the rotation of a joint, with the first channel outermost.
fn rotation(joint: &FileJoint, numbers: &[f32]) -> Rotation {
    let turns = joint.channels.iter().zip(numbers).filter(|(channel, _)| channel.is_rotation());
    let product = turns.fold(Rotation::IDENTITY, |outer, (channel, &degrees)| {
        // Computes in f64, because a file may count whole turns, and a thousand degrees lose three digits in f32.
        let turn = (f64::from(degrees) % 360.0).to_radians() as f32;
        outer * Rotation::from_axis_angle(channel.direction(), turn)
    });
    product.normalize()
}

/// Returns the numbers of the position channels, by axis; 0 along an axis without a channel.
fn positions(joint: &FileJoint, numbers: &[f32]) -> Vec3 {
    let mut at = Vec3::ZERO;
    for (channel, &value) in joint.channels.iter().zip(numbers) {
        if !channel.is_rotation() {
            at[channel.axis()] = value;
        }
    }
    at
}

/// Returns the components of a vector along axes that have a position channel; 0 along others.
pub(super) fn along_positions(channels: &[BvhChannel], v: Vec3) -> Vec3 {
    let has = |axis: usize| channels.contains(&BvhChannel::POSITIONS[axis]);
    Vec3::from_array(core::array::from_fn(|axis| if has(axis) { v[axis] } else { 0.0 }))
}

/// Returns the base to which the positions of a joint are added, file units, and whether they are displacements. Along
/// an axis without a channel the base is the offset. Along the other axes some programs write the joint's position,
/// others its displacement from the offset; the first frame decides.
fn position_base(joint: &FileJoint, rows: &[f32]) -> (Vec3, bool) {
    let first = positions(joint, &rows[joint.column..joint.column + joint.channels.len()]);
    let shifted = along_positions(&joint.channels, joint.offset);
    let added = is_added(first, shifted);
    (if added { joint.offset } else { joint.offset - shifted }, added)
}

/// True if a position in the first frame must be added to the offset.
pub(super) fn is_added(first: Vec3, offset: Vec3) -> bool {
    (first - offset).length_squared() > first.length_squared()
}

impl Frames {
    /// Returns the pose of a frame; components without a channel are at rest.
    pub fn pose(&self, rig: &Rig, frame: usize) -> Vec<LocalTransform> {
        let local = |(i, joint): (usize, &sinew_anim::Joint)| LocalTransform {
            translation: self.translations[i].get(frame).copied().unwrap_or(joint.rest.translation),
            rotation: self.rotations[i].get(frame).copied().unwrap_or(joint.rest.rotation),
            scale: joint.rest.scale,
        };
        rig.joints.iter().enumerate().map(local).collect()
    }

    /// Converts the frames from `first` on to a clip that starts at 0.
    pub fn clip(&self, rig: &Rig, first: usize, frame_time: f64) -> Result<Clip> {
        let count = self.rotations.iter().map(Vec::len).chain(self.translations.iter().map(Vec::len)).max();
        let frames = count.unwrap_or(0).saturating_sub(first);
        let times: Vec<f32> = (0..frames).map(|i| (i as f64 * frame_time) as f32).collect();
        if times.windows(2).any(|pair| !(pair[0] < pair[1] && pair[1].is_finite())) {
            let what = format!("{frames} frames {frame_time} s apart have equal times in 32 bits");
            return Err(Error::malformed(what, "frame time"));
        }
        let mut channels = Vec::new();
        for joint in 0..rig.joints.len() {
            let mut add = |property: Property, values: Vec<f32>| {
                if !values.is_empty() {
                    let interpolation = Interpolation::Linear;
                    channels.push(Channel { joint, property, interpolation, times: times.clone(), values });
                }
            };
            let at = |i: usize| i.min(self.translations[joint].len());
            let shifts = &self.translations[joint][at(first)..];
            add(Property::Translation, shifts.iter().flat_map(Vec3::to_array).collect());
            let turns = self.rotations[joint].get(first..).unwrap_or_default();
            add(Property::Rotation, turns.iter().flat_map(|q| [q.x, q.y, q.z, q.w]).collect());
        }
        Ok(Clip { name: String::new(), duration: times.last().copied().unwrap_or(0.0), channels })
    }
}
