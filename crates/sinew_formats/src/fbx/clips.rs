//! Converts curves of animation stacks to keys.

use super::{explain, index, limited, not_finite};
use crate::error::Result;
use sinew_anim::{Channel, Clip, Interpolation, JointIdx, Property};
use sinew_math::Rotation;
use ufbx::{BakeOpts, BakedNode, Scene};

/// Frame rate of a file that does not state one.
const RATE: f64 = 30.0;

/// Returns one clip for each stack that moves a joint, and a note for each other stack.
pub(super) fn read_all(scene: &Scene, size: usize) -> Result<(Vec<Clip>, Vec<String>)> {
    let (mut clips, mut notes) = (Vec::new(), Vec::new());
    let rate = scene.settings.frames_per_second;
    for stack in &scene.anim_stacks {
        let options = BakeOpts {
            temp_allocator: limited(size),
            result_allocator: limited(size),
            trim_start_time: true,
            resample_rate: if rate > 0.0 { rate } else { RATE },
            key_reduction_enabled: true,
            key_reduction_rotation: true,
            ..BakeOpts::default()
        };
        let name = stack.element.name.to_string();
        let baked = ufbx::bake_anim(scene, &stack.anim, options).map_err(|error| explain(&error, size))?;
        let mut channels = Vec::new();
        for node in &baked.nodes {
            // The scene's own root is not a joint.
            if let Some(joint) = scene.nodes.get(node.typed_id as usize).and_then(|node| index(node)) {
                channels.extend(read_node(node, joint, &name)?);
            }
        }
        if channels.is_empty() {
            notes.push(format!("left out: the clip {name:?}, which moves nothing"));
            continue;
        }
        let last = channels.iter().map(|channel: &Channel| channel.times[channel.times.len() - 1]);
        clips.push(Clip { duration: last.fold(0.0, sinew_math::max), name, channels });
    }
    Ok((clips, notes))
}

/// Returns the channels of a node. A constant property has one key, even if it equals the rest pose, because clips
/// are blended.
fn read_node(node: &BakedNode, joint: JointIdx, clip: &str) -> Result<Vec<Channel>> {
    let vector =
        |key: &ufbx::BakedVec3| (key.time, [key.value.x, key.value.y, key.value.z].map(|x| x as f32));
    let mut last = Rotation::IDENTITY;
    let turn = |key: &ufbx::BakedQuat| {
        let q = &key.value;
        last = Rotation::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32).toward(last);
        (key.time, [last.x, last.y, last.z, last.w])
    };
    let kept = |is_constant: bool| if is_constant { 1 } else { usize::MAX };
    let translations = node.translation_keys.iter().take(kept(node.constant_translation));
    let rotations = node.rotation_keys.iter().take(kept(node.constant_rotation));
    let scales = node.scale_keys.iter().take(kept(node.constant_scale));
    let channels = [
        channel(joint, Property::Translation, translations.map(vector)),
        channel(joint, Property::Rotation, rotations.map(turn)),
        channel(joint, Property::Scale, scales.map(vector)),
    ];
    let channels: Vec<Channel> = channels.into_iter().flatten().collect();
    if channels.iter().any(|channel| channel.values.iter().chain(&channel.times).any(|x| !x.is_finite())) {
        return Err(not_finite(format!("clip {clip:?}, node {joint}")));
    }
    Ok(channels)
}

/// Converts keys to a channel; of keys with equal `f32` times, the last one is kept.
fn channel<const N: usize>(
    joint: JointIdx,
    property: Property,
    keys: impl Iterator<Item = (f64, [f32; N])>,
) -> Option<Channel> {
    let (mut times, mut values): (Vec<f32>, Vec<f32>) = (Vec::new(), Vec::new());
    for (time, value) in keys {
        let time = time as f32;
        if times.last().is_some_and(|&last| time <= last) {
            times.pop();
            values.truncate(values.len() - N);
        }
        times.push(time);
        values.extend(value);
    }
    from_start::<N>(&mut times, &mut values);
    (!times.is_empty()).then_some(Channel {
        joint,
        property,
        interpolation: Interpolation::Linear,
        times,
        values,
    })
}

/// Removes keys before time 0, which a file may have; the value at 0 is interpolated.
fn from_start<const N: usize>(times: &mut Vec<f32>, values: &mut Vec<f32>) {
    let before = times.iter().take_while(|time| **time < 0.0).count();
    let Some(last) = before.checked_sub(1) else { return };
    if let Some(&next) = times.get(before) {
        let share = -times[last] / (next - times[last]);
        for at in last * N..before * N {
            values[at] += (values[at + N] - values[at]) * share;
        }
        if let [x, y, z, w] = values[last * N..before * N] {
            let unit = Rotation::from_xyzw(x, y, z, w).normalize();
            values[last * N..before * N].copy_from_slice(&[unit.x, unit.y, unit.z, unit.w]);
        }
    }
    times[last] = 0.0;
    let dropped = last + usize::from(times.get(before) == Some(&0.0));
    times.drain(..dropped);
    values.drain(..dropped * N);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_before_the_take_are_replaced_by_its_first_value() {
        let key = |time: f64, x: f32| (time, [x]);
        let cut = |keys: &[(f64, [f32; 1])]| {
            let channel = channel(0, Property::Scale, keys.iter().copied()).expect("the channel has keys");
            (channel.times, channel.values)
        };
        assert_eq!(cut(&[key(-3.0, 9.0), key(-1.0, 1.0), key(3.0, 5.0)]), (vec![0.0, 3.0], vec![2.0, 5.0]));
        assert_eq!(cut(&[key(-1.0, 1.0), key(0.0, 4.0), key(1.0, 5.0)]), (vec![0.0, 1.0], vec![4.0, 5.0]));
        assert_eq!(cut(&[key(-2.0, 7.0), key(-1.0, 1.0)]), (vec![0.0], vec![1.0]));
        assert_eq!(cut(&[key(0.5, 1.0)]), (vec![0.5], vec![1.0]));
    }
}
