//! Writes skeletons and animations as the bytes that ozz-animation reads: the library has a format, but no builder.
//!
//! An animation's keys are sorted by the time at which they are needed, which is the time of the previous key; each
//! stores the distance back to that key. Every track has at least two keys.

use core::cmp::Ordering;
use sinew::anim::{Channel, Clip, LocalTransform, Property, rest_pose};
use sinew_scenes::crowd::CrowdScene;

/// Number of joints side by side in ozz's poses; tracks are padded to a multiple.
const SIDE_BY_SIDE: usize = 4;

/// First byte of a file on machines like this one.
const ENDIAN_TAG: u8 = cfg!(target_endian = "little") as u8;

/// Returns the rig of a crowd, version 2 of the format.
pub fn skeleton(scene: &CrowdScene) -> Vec<u8> {
    let mut bytes = Bytes::begin("ozz-skeleton", 2);
    let joints = &scene.rig.joints;
    bytes.u32(joints.len());
    bytes.u32(joints.iter().map(|joint| joint.name.len() + 1).sum());
    joints.iter().for_each(|joint| bytes.text(&joint.name));
    for joint in joints {
        let parent = joint.parent.map_or(-1, |parent| i16::try_from(parent).expect("a small rig"));
        bytes.0.extend(parent.to_ne_bytes());
    }
    for four in filled(rest_pose(&scene.rig)).chunks(SIDE_BY_SIDE) {
        for number in 0..10 {
            four.iter().for_each(|local| bytes.f32(numbers(local)[number]));
        }
    }
    bytes.0
}

/// Returns a clip of a crowd, version 7 of the format, with all keys of the clip; constant tracks have two.
///
/// # Panics
/// If a channel has other key times than the clip's first channel.
pub fn animation(scene: &CrowdScene, clip: &Clip) -> Vec<u8> {
    let times = &clip.channels[0].times;
    let rest = filled(rest_pose(&scene.rig));
    let [translations, rotations, scales] = [Property::Translation, Property::Rotation, Property::Scale]
        .map(|property| sorted(tracks(clip, property, times.len(), &rest)));
    let mut bytes = Bytes::begin("ozz-animation", 7);
    bytes.f32(clip.duration);
    bytes.u32(scene.rig.joints.len());
    bytes.u32(clip.name.len());
    bytes.u32(times.len());
    for keys in [&translations, &rotations, &scales] {
        bytes.u32(keys.len());
    }
    // Without iframes (seek points): two numbers for each property.
    (0..6).for_each(|_| bytes.u32(0));
    bytes.0.extend(clip.name.as_bytes());
    times.iter().for_each(|time| bytes.f32(time / clip.duration));
    for keys in [&translations, &rotations, &scales] {
        for key in keys {
            bytes.0.push(u8::try_from(key.time).expect("fewer than 256 times"));
        }
        keys.iter().for_each(|key| bytes.u16(key.back));
        // Interval of iframes, as a share of the whole.
        bytes.f32(1.0);
        keys.iter().flat_map(|key| key.packed).for_each(|number| bytes.u16(number));
    }
    bytes.0
}

/// Pads with identities to a multiple of four.
fn filled(mut pose: Vec<LocalTransform>) -> Vec<LocalTransform> {
    pose.resize(pose.len().next_multiple_of(SIDE_BY_SIDE), LocalTransform::default());
    pose
}

fn numbers(local: &LocalTransform) -> [f32; 10] {
    let (t, q, s) = (local.translation, local.rotation, local.scale);
    [t.x, t.y, t.z, q.x, q.y, q.z, q.w, s.x, s.y, s.z]
}

struct Key {
    track: usize,
    /// Index into the table of times.
    time: usize,
    /// Time at which the key is needed; `None` for the first key.
    needed: Option<usize>,
    /// Number of keys back to the previous key of the track.
    back: u16,
    packed: [u16; 3],
}

/// Returns the keys of all joints, track after track.
fn tracks(clip: &Clip, property: Property, times: usize, rest: &[LocalTransform]) -> Vec<Key> {
    let mut keys = Vec::new();
    for (track, local) in rest.iter().enumerate() {
        let mut key = |time, needed, value: &[f32]| {
            let packed = if property == Property::Rotation { rotation(value) } else { halves(value) };
            keys.push(Key { track, time, needed, back: 0, packed });
        };
        let moves = |channel: &&_| is_of(channel, track, property);
        if let Some(channel) = clip.channels.iter().find(moves) {
            assert_eq!(channel.times.len(), times, "all channels have the same times");
            for (time, value) in channel.values.chunks(property.width()).enumerate() {
                key(time, time.checked_sub(1), value);
            }
        } else {
            let all = numbers(local);
            let value = match property {
                Property::Translation => &all[..3],
                Property::Rotation => &all[3..7],
                Property::Scale => &all[7..],
            };
            key(0, None, value);
            key(times - 1, Some(0), value);
        }
    }
    keys
}

fn is_of(channel: &Channel, joint: usize, property: Property) -> bool {
    channel.joint == joint && channel.property == property
}

/// Sorts keys in ozz's order.
fn sorted(mut keys: Vec<Key>) -> Vec<Key> {
    keys.sort_by(|a, b| match a.needed.cmp(&b.needed) {
        Ordering::Equal => a.track.cmp(&b.track),
        order => order,
    });
    let mut last = vec![0; keys.iter().map(|key| key.track + 1).max().unwrap_or(0)];
    for (place, key) in keys.iter_mut().enumerate() {
        if key.needed.is_some() {
            key.back = u16::try_from(place - last[key.track]).expect("a small rig");
        }
        last[key.track] = place;
    }
    keys
}

/// Returns the three smaller numbers of a unit quaternion, 15 bits each; the bits above them hold the index of the
/// missing number (two bits) and its sign.
fn rotation(q: &[f32]) -> [u16; 3] {
    let largest = (1..4).fold(0, |best, i| if q[i].abs() > q[best].abs() { i } else { best });
    let step = core::f32::consts::SQRT_2 / 32_767.0;
    let coded = |i: usize| {
        let units = (q[i] + core::f32::consts::FRAC_1_SQRT_2) / step;
        (units + 0.5).clamp(0.0, 32_767.0) as u64
    };
    let mut bits = largest as u64 | u64::from(q[largest] < 0.0) << 2;
    for (field, i) in (0..4).filter(|&i| i != largest).enumerate() {
        bits |= coded(i) << (3 + 15 * field);
    }
    [bits as u16, (bits >> 16) as u16, (bits >> 32) as u16]
}

fn halves(value: &[f32]) -> [u16; 3] {
    [half(value[0]), half(value[1]), half(value[2])]
}

/// Rounds to the nearest half-precision number, for values that are neither tiny nor huge.
fn half(value: f32) -> u16 {
    let sign = if value.is_sign_negative() { 0x8000 } else { 0 };
    // Below the smallest normal number, 2⁻¹⁴, values are multiples of 2⁻²⁴.
    if value.abs() < 6.2e-5 {
        return sign | (value.abs() * 16_777_216.0 + 0.5) as u16;
    }
    // The exponent's bias changes from 127 to 15, and 13 bits of the fraction are dropped.
    let rounded = value.abs().to_bits() + 0x1000 - (112 << 23);
    sign | u16::try_from(rounded >> 13).expect("below 65,504")
}

/// A file under construction.
struct Bytes(Vec<u8>);

impl Bytes {
    fn begin(tag: &str, version: usize) -> Self {
        let mut bytes = Self(vec![ENDIAN_TAG]);
        bytes.text(tag);
        bytes.u32(version);
        bytes
    }

    fn text(&mut self, text: &str) {
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    fn u16(&mut self, number: u16) {
        self.0.extend(number.to_ne_bytes());
    }

    fn u32(&mut self, number: usize) {
        self.0.extend(u32::try_from(number).expect("small").to_ne_bytes());
    }

    fn f32(&mut self, number: f32) {
        self.0.extend(number.to_ne_bytes());
    }
}
