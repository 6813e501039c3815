//! Converts a rig and a clip to BVH text.

use super::channel::BvhChannel;
use super::motion::{along_positions, is_added};
use crate::error::{Error, Result};
use sinew_anim::{
    Clip, JointIdx, LocalTransform, Property, Rig, SampleCache, Take, Wrap, local_to_model, rest_pose,
    sample_cached,
};
use sinew_math::{Affine, EulerOrder, Rotation, Vec3, limits::wrap};
use std::fmt::Write as _;

/// Ends of chains that get an End Site.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BvhEnds {
    /// Unnamed joints that end a chain and do not move become End Sites; no others are added.
    #[default]
    AsInRig,
    /// Also, each named joint that ends a chain gets an End Site, at half the length of its own bone. Without End
    /// Sites, Blender and other programs give these joints no length.
    EveryChain,
}

/// Options for writing a BVH file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BvhWriteOptions<'a> {
    /// Seconds from frame to frame, above 0. Default 1/60.
    pub frame_time: f64,
    /// Metres per unit of the file, above 0. Default 0.01: centimetres, as most programs expect.
    pub metres_per_unit: f32,
    /// Order of the rotation channels, one of the six with three different axes. Default z, y, x.
    pub rotation_order: EulerOrder,
    /// Channels per joint, as [`BvhDocument::channels`](super::BvhDocument::channels); `None`: positions where the clip
    /// moves a joint, and rotations in `rotation_order`.
    pub channels: Option<&'a [Vec<BvhChannel>]>,
    /// Ends of chains. Default: as in the rig.
    pub ends: BvhEnds,
}

impl Default for BvhWriteOptions<'_> {
    fn default() -> Self {
        let (frame_time, metres_per_unit) = (1.0 / 60.0, 0.01);
        let ends = BvhEnds::default();
        Self { frame_time, metres_per_unit, rotation_order: EulerOrder::Zyx, channels: None, ends }
    }
}

/// A BVH file, with notes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BvhText {
    /// The file.
    pub text: String,
    /// Notes on changes and omissions, one sentence each.
    pub notes: Vec<String>,
}

/// Deepest indentation: keeps the text size of a very long chain linear.
const MOST_TABS: usize = 40;

/// Writes the motion of a rig whose lengths are metres. The file's joints have the axes of the rig's model space, so
/// that the rest pose has no rotations; a rig read from a BVH file is written with its original numbers.
///
/// Unnamed joints that end a chain and do not move become End Sites; see [`BvhEnds`]. Skins and scales are not part of
/// the format.
///
/// # Errors
/// If the rig has no joints, the frame time or unit is not above 0, the order has an axis twice, the numbers of
/// channels and joints differ, or there are more frames than [`Take::MOST_FRAMES`].
///
/// # Panics
/// As [`sinew_anim::sample()`].
pub fn write_bvh(rig: &Rig, clip: &Clip, options: &BvhWriteOptions<'_>) -> Result<BvhText> {
    check(rig, options)?;
    let mut writer = Writer::new(rig, clip, options);
    let frames = (f64::from(clip.duration) / options.frame_time).round();
    if frames >= Take::MOST_FRAMES as f64 {
        return Err(Error::malformed(format!("too many frames: {frames}"), "frame time"));
    }
    let rows = writer.rows(clip, frames as usize + 1);
    let mut text = writer.hierarchy();
    let _ = write!(text, "MOTION\nFrames: {}\nFrame Time: {:.9}\n", frames as usize + 1, options.frame_time);
    text.push_str(&rows);
    let cut = f64::from(clip.duration) - frames * options.frame_time;
    if cut.abs() > 0.01 * options.frame_time {
        writer.notes.push(format!("the clip's length was changed by {:.1} ms to whole frames", -1e3 * cut));
    }
    Ok(BvhText { text, notes: writer.notes })
}

fn check(rig: &Rig, options: &BvhWriteOptions<'_>) -> Result<()> {
    let wrong = |what: &str, place: &str| Err(Error::malformed(what, place));
    if rig.joints.is_empty() {
        return wrong("no joints", "rig");
    }
    if !(options.frame_time > 0.0 && options.frame_time.is_finite()) {
        return wrong("must be above 0", "frame time");
    }
    if !(options.metres_per_unit > 0.0 && options.metres_per_unit.is_finite()) {
        return wrong("must be above 0", "metres per unit");
    }
    if options.rotation_order.is_proper() {
        return wrong("names an axis twice", "rotation order");
    }
    if options.channels.is_some_and(|channels| channels.len() != rig.joints.len()) {
        return wrong("must be as many as the joints", "channels");
    }
    Ok(())
}

/// Data needed to write a joint.
struct Line {
    /// Offset from the parent, metres, model axes.
    offset: Vec3,
    /// Rest rotations of the parent and of the joint itself, model space.
    turned: [Rotation; 2],
    /// Map from the parent's directions at rest to model space.
    parent: Affine,
    channels: Vec<BvhChannel>,
    is_end: bool,
    /// True if positions are displacements from the offset.
    added: bool,
    /// Angles of the previous frame, degrees, by axis.
    angles: [f64; 3],
}

#[derive(Clone, Copy, PartialEq)]
enum Brace {
    Open,
    Close,
}

struct Writer<'a> {
    rig: &'a Rig,
    options: &'a BvhWriteOptions<'a>,
    lines: Vec<Line>,
    children: Vec<Vec<JointIdx>>,
    notes: Vec<String>,
}

impl<'a> Writer<'a> {
    fn new(rig: &'a Rig, clip: &Clip, options: &'a BvhWriteOptions<'a>) -> Self {
        let mut children = vec![Vec::new(); rig.joints.len()];
        for (i, joint) in rig.joints.iter().enumerate() {
            joint.parent.into_iter().for_each(|parent| children[parent].push(i));
        }
        let mut notes = Vec::new();
        if clip.channels.iter().any(|channel| channel.property == Property::Scale) {
            notes.push("left out: scale channels, which the format lacks".into());
        }
        if rig.joints.iter().filter(|joint| joint.parent.is_none()).count() > 1 {
            notes.push("the rig has several roots; many programs read only the first".into());
        }
        let mut model = Vec::new();
        local_to_model(rig, &rest_pose(rig), &Affine::IDENTITY, &mut model);
        let line = |i: JointIdx| {
            let parent = rig.joints[i].parent.map_or(Affine::IDENTITY, |p| model[p]);
            let is_end = children[i].is_empty()
                && rig.joints[i].name.is_empty()
                && clip.channels.iter().all(|channel| channel.joint != i);
            Line {
                offset: model[i].translation - parent.translation,
                turned: [parent.to_rigid().rotation, model[i].to_rigid().rotation],
                parent,
                channels: if is_end { Vec::new() } else { channels_of(rig, clip, options, i) },
                is_end: is_end && rig.joints[i].parent.is_some(),
                added: false,
                angles: [0.0; 3],
            }
        };
        let lines = (0..rig.joints.len()).map(line).collect();
        Self { rig, options, lines, children, notes }
    }

    /// Returns the joints depth first, as the format nests them, each with an opening and a closing event and its
    /// depth.
    fn walk(&self) -> Vec<(Brace, JointIdx, usize)> {
        let mut stack: Vec<(Brace, JointIdx, usize)> = Vec::new();
        let roots = (0..self.rig.joints.len()).filter(|&i| self.rig.joints[i].parent.is_none());
        stack.extend(roots.rev().map(|i| (Brace::Open, i, 0)));
        let mut walked = Vec::with_capacity(2 * self.rig.joints.len());
        while let Some(step) = stack.pop() {
            walked.push(step);
            let (Brace::Open, i, depth) = step else { continue };
            stack.push((Brace::Close, i, depth));
            stack.extend(self.children[i].iter().rev().map(|&child| (Brace::Open, child, depth + 1)));
        }
        walked
    }

    fn hierarchy(&self) -> String {
        let mut text = String::from("HIERARCHY\n");
        for (brace, i, depth) in self.walk() {
            let (line, tabs) = (&self.lines[i], "\t".repeat(depth.min(MOST_TABS)));
            if brace == Brace::Close {
                let _ = writeln!(text, "{tabs}}}");
                continue;
            }
            let _ = match (line.is_end, depth) {
                (true, _) => writeln!(text, "{tabs}End Site"),
                (false, 0) => writeln!(text, "{tabs}ROOT {}", word(&self.rig.joints[i].name, i)),
                (false, _) => writeln!(text, "{tabs}JOINT {}", word(&self.rig.joints[i].name, i)),
            };
            let _ = writeln!(text, "{tabs}{{\n{tabs}\tOFFSET {}", self.numbers(line.offset));
            if !line.is_end {
                let names: Vec<&str> = line.channels.iter().map(|channel| channel.name()).collect();
                let _ = writeln!(text, "{tabs}\tCHANNELS {} {}", names.len(), names.join(" "));
            }
            if !line.is_end && self.children[i].is_empty() && self.options.ends == BvhEnds::EveryChain {
                let end = self.numbers(line.offset * 0.5);
                let _ = writeln!(text, "{tabs}\tEnd Site\n{tabs}\t{{\n{tabs}\t\tOFFSET {end}\n{tabs}\t}}");
            }
        }
        text
    }

    /// Writes an offset in units of the file.
    fn numbers(&self, offset: Vec3) -> String {
        (offset / self.options.metres_per_unit).to_array().map(|x| format!("{x:.6}")).join(" ")
    }

    fn rows(&mut self, clip: &Clip, frames: usize) -> String {
        let opened = |&(brace, i, _): &(Brace, JointIdx, usize)| (brace == Brace::Open).then_some(i);
        let order: Vec<JointIdx> = self.walk().iter().filter_map(opened).collect();
        let (mut text, mut cache) = (String::new(), SampleCache::default());
        let mut pose = rest_pose(self.rig);
        for frame in 0..frames {
            let time = (frame as f64 * self.options.frame_time) as f32;
            sample_cached(clip, self.rig, time, Wrap::Clamp, &mut cache, &mut pose);
            let mut gap = "";
            for &i in &order {
                for value in self.lines[i].values(pose[i], frame == 0, self.options.metres_per_unit) {
                    let _ = write!(text, "{gap}{value:.6}");
                    gap = " ";
                }
            }
            text.push('\n');
        }
        text
    }
}

impl Line {
    /// Returns the numbers of a frame.
    fn values(&mut self, local: LocalTransform, is_first: bool, metres_per_unit: f32) -> Vec<f64> {
        let [parent, own] = self.turned;
        let shift = self.parent.vector(local.translation);
        let base = along_positions(&self.channels, self.offset);
        if is_first {
            self.added = is_added(along_positions(&self.channels, shift), base);
        }
        let shift = if self.added { shift - base } else { shift };
        self.turn((parent * local.rotation * own.inverse()).normalize());
        let value = |channel: &BvhChannel| match channel.is_rotation() {
            true => self.angles[channel.axis()],
            false => f64::from(shift[channel.axis()]) / f64::from(metres_per_unit),
        };
        self.channels.iter().map(value).collect()
    }

    /// Converts a rotation to angles: chooses the solution nearest to the previous one, without jumps by whole turns.
    fn turn(&mut self, rotation: Rotation) {
        let axes: Vec<usize> = self.channels.iter().filter(|c| c.is_rotation()).map(|c| c.axis()).collect();
        let Some(order) = EulerOrder::ALL.into_iter().find(|order| order.indices()[..] == axes[..]) else {
            return;
        };
        let [a, b, c] = rotation.to_euler(order.intrinsic()).angles;
        let half_turn = core::f32::consts::PI;
        let before = axes.iter().map(|&axis| self.angles[axis]).collect::<Vec<f64>>();
        let near = |angles: [f32; 3]| -> [f64; 3] {
            core::array::from_fn(|i| {
                let degrees = f64::from(wrap(angles[i])).to_degrees();
                degrees + 360.0 * ((before[i] - degrees) / 360.0).round()
            })
        };
        let [first, second] = [near([a, b, c]), near([a + half_turn, half_turn - b, c + half_turn])];
        let way = |angles: &[f64; 3]| (0..3).map(|i| (angles[i] - before[i]).abs()).sum::<f64>();
        let nearest = if way(&second) < way(&first) { second } else { first };
        axes.into_iter().zip(nearest).for_each(|(axis, angle)| self.angles[axis] = angle);
    }
}

/// Returns the channels with which a joint is written: the requested ones, completed to three rotations if it has any.
fn channels_of(rig: &Rig, clip: &Clip, options: &BvhWriteOptions<'_>, joint: JointIdx) -> Vec<BvhChannel> {
    let in_order = options.rotation_order.indices().map(BvhChannel::rotation);
    let Some(asked) = options.channels else {
        let shifts = |channel: &sinew_anim::Channel| {
            channel.joint == joint && channel.property == Property::Translation
        };
        let moves = rig.joints[joint].parent.is_none() || clip.channels.iter().any(shifts);
        let positions: &[BvhChannel] = if moves { &BvhChannel::POSITIONS } else { &[] };
        return [positions, &in_order].concat();
    };
    let mut channels = asked[joint].clone();
    if channels.iter().any(|channel| channel.is_rotation()) {
        let missing: Vec<BvhChannel> = in_order.into_iter().filter(|turn| !channels.contains(turn)).collect();
        channels.extend(missing);
    }
    channels
}

/// Returns a name that is one word.
fn word(name: &str, joint: JointIdx) -> String {
    if name.is_empty() {
        return format!("joint_{joint}");
    }
    name.chars()
        .map(|c| if c.is_whitespace() || c.is_control() || matches!(c, '{' | '}') { '_' } else { c })
        .collect()
}
