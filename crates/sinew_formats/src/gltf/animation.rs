//! Animations: channels over joints (glTF 2.0 §3.11).

use super::source::Source;
use crate::container::json::At;
use crate::error::{Result, quoted};
use crate::events;
use sinew_anim::{Channel, Clip, ClipEvent, Interpolation, JointIdx, Property};

type Clips = (Vec<Clip>, Vec<Vec<ClipEvent>>);

/// Reads all animations with their events.
pub(super) fn read_all(
    source: &Source<'_>,
    joint_of_node: &[Option<JointIdx>],
    warnings: &mut Vec<String>,
) -> Result<Clips> {
    let read = |at: At<'_>| {
        let mut clip = read_clip(source, at, joint_of_node)?;
        if let Some(shift) = begin_at_zero(&mut clip) {
            let name = quoted(&clip.name);
            warnings.push(format!("clip {name} has keys from -{shift} s on: it was moved to begin at 0 s"));
        }
        let events = events::read_extras(at, clip.duration)?;
        Ok((clip, events))
    };
    source.root.list("animations")?.into_iter().map(read).collect()
}

/// Shifts a clip whose first key is before 0 s to start at 0, for exports with negative frames. Returns the shift,
/// seconds.
fn begin_at_zero(clip: &mut Clip) -> Option<f32> {
    let first = clip.channels.iter().map(|channel| channel.times[0]).fold(0.0, sinew_math::min);
    if first >= 0.0 {
        return None;
    }
    clip.channels.iter_mut().flat_map(|channel| &mut channel.times).for_each(|time| *time -= first);
    clip.duration -= first;
    Some(-first)
}

fn read_clip<'a>(source: &Source<'a>, animation: At<'a>, joint_of_node: &[Option<JointIdx>]) -> Result<Clip> {
    let samplers = animation.need("samplers")?.items()?;
    let mut channels = Vec::new();
    let mut duration = 0.0;
    for channel in animation.need("channels")?.items()? {
        let sampler_at = channel.need("sampler")?;
        let sampler = samplers[sampler_at.index(samplers.len(), "samplers")?];
        let target = channel.need("target")?;
        // Morph weights and pointers move no joint.
        let property = match target.need("path")?.str()? {
            "translation" => Property::Translation,
            "rotation" => Property::Rotation,
            "scale" => Property::Scale,
            _ => continue,
        };
        let Some(node) = target.get("node")? else { continue };
        let Some(joint) = joint_of_node[node.index(joint_of_node.len(), "nodes")?] else { continue };
        let channel = read_channel(source, sampler, joint, property)?;
        duration = sinew_math::max(channel.times[channel.times.len() - 1], duration);
        channels.push(channel);
    }
    Ok(Clip { name: animation.name(), duration, channels })
}

fn read_channel<'a>(
    source: &Source<'a>,
    sampler: At<'a>,
    joint: JointIdx,
    property: Property,
) -> Result<Channel> {
    let interpolation = match sampler.get("interpolation")? {
        None => Interpolation::Linear,
        Some(at) => match at.str()? {
            "LINEAR" => Interpolation::Linear,
            "STEP" => Interpolation::Step,
            "CUBICSPLINE" => Interpolation::CubicSpline,
            _ => return Err(at.malformed("unknown interpolation")),
        },
    };
    let input = sampler.need("input")?;
    let times: Vec<f32> = source.floats(input)?.into_iter().map(|[t]| t).collect();
    if times.is_empty() {
        return Err(input.malformed("an animation sampler needs at least one key"));
    }
    if let Some(i) = times.windows(2).position(|w| w[1] < w[0]) {
        return Err(input.malformed(format!("key {} is earlier than the one before it", i + 1)));
    }
    let output = sampler.need("output")?;
    let values: Vec<f32> = match property.width() {
        3 => source.floats::<3>(output)?.into_flattened(),
        _ => source.floats::<4>(output)?.into_flattened(),
    };
    let per_key = property.width() * if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    if values.len() != times.len() * per_key {
        let (there, keys) = (values.len() / property.width(), times.len());
        return Err(output.malformed(format!("{there} values do not fit {keys} keys")));
    }
    let (times, values) = drop_repeated_times(times, values, per_key);
    Ok(Channel { joint, property, interpolation, times, values })
}

/// Removes keys at repeated times, so that times strictly increase: the last key at each time is kept.
fn drop_repeated_times(times: Vec<f32>, values: Vec<f32>, per_key: usize) -> (Vec<f32>, Vec<f32>) {
    if times.windows(2).all(|w| w[0] < w[1]) {
        return (times, values);
    }
    let last_of_its_time = |i: &usize| times.get(i + 1).is_none_or(|&next| next > times[*i]);
    let kept: Vec<usize> = (0..times.len()).filter(last_of_its_time).collect();
    let key_values = |&i: &usize| values[i * per_key..(i + 1) * per_key].iter().copied();
    (kept.iter().map(|&i| times[i]).collect(), kept.iter().flat_map(key_values).collect())
}
