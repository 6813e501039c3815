//! Poses over time as channels of a clip.

use super::Frame;
use sinew_anim::{Channel, Clip, Interpolation, JointIdx, LocalTransform, Property, Rig};
use sinew_math::Rotation;

/// Creates linear channels for values that differ from the rest pose in any frame; joints without a channel stay in their rest pose.
pub(super) fn clip(rig: &Rig, name: &str, frames: &[Frame]) -> Clip {
    let times: Vec<f32> = frames.iter().map(|frame| frame.time).collect();
    let mut channels = Vec::new();
    for (joint, node) in rig.joints.iter().enumerate() {
        for property in [Property::Translation, Property::Rotation, Property::Scale] {
            if frames.iter().any(|frame| differs(property, &frame.pose[joint], &node.rest)) {
                channels.push(Channel {
                    joint,
                    property,
                    interpolation: Interpolation::Linear,
                    times: times.clone(),
                    values: values(frames, joint, property),
                });
            }
        }
    }
    Clip { name: name.to_owned(), duration: times.last().copied().unwrap_or(0.0), channels }
}

fn values(frames: &[Frame], joint: JointIdx, property: Property) -> Vec<f32> {
    let mut values = Vec::with_capacity(frames.len() * property.width());
    let mut last: Option<Rotation> = None;
    for frame in frames {
        let local = &frame.pose[joint];
        match property {
            Property::Translation => values.extend(local.translation.to_array()),
            Property::Scale => values.extend(local.scale.to_array()),
            Property::Rotation => {
                // Choose the sign for the shorter arc, since some players blend quaternions by component.
                let q = last.map_or(local.rotation, |last| local.rotation.toward(last));
                values.extend([q.x, q.y, q.z, q.w]);
                last = Some(q);
            }
        }
    }
    values
}

/// Returns true if a value differs from the rest pose by more than the rounding of blending it with itself.
fn differs(property: Property, a: &LocalTransform, rest: &LocalTransform) -> bool {
    const ROUNDING: f32 = 1e-6;
    match property {
        Property::Translation => {
            (a.translation - rest.translation).length() > ROUNDING * rest.translation.length()
        }
        Property::Rotation => a.rotation.dot(rest.rotation).abs() < 1.0 - ROUNDING,
        Property::Scale => (a.scale - rest.scale).length() > ROUNDING * rest.scale.length(),
    }
}
