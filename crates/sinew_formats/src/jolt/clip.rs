//! Reads a `SkeletalAnimation` as a clip.

use super::objects::Objects;
use crate::error::{Error, Result, quoted};
use sinew_anim::{Channel, Clip, Interpolation, Property, Rig};

/// Reads an animation of a skeleton: keys of rotation and translation for each joint. Joints are matched by name.
///
/// # Errors
/// Returns an error that names the line: no text object file, no animation, a joint that the rig lacks or that has two
/// tracks, a joint without keys, times that do not increase, a non-finite number.
pub fn read_jolt_animation(bytes: &[u8], rig: &Rig) -> Result<Clip> {
    let objects = Objects::read(bytes)?;
    let Some(animation) = objects.of_class("SkeletalAnimation") else {
        return Err(Error::malformed(
            "no animation in it (an object of class SkeletalAnimation)",
            "top level",
        ));
    };
    let mut clip = Clip::default();
    for track in animation.member("mAnimatedJoints")?.list()? {
        let track = objects.need(track)?;
        let name = track.member("mJointName")?;
        let joint = rig.joints.iter().position(|joint| joint.name == name.text().unwrap_or_default());
        let joint = joint.ok_or_else(|| {
            name.malformed(format!(
                "{} is not a joint of the skeleton",
                quoted(name.text().unwrap_or_default())
            ))
        })?;
        if clip.channels.iter().any(|channel| channel.joint == joint) {
            return Err(name.malformed("a second track of the same joint"));
        }
        let keys = track.member("mKeyframes")?;
        let (mut times, mut turns, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for key_at in keys.list()? {
            let key = objects.need(key_at)?;
            let time = key.member("mTime")?.number()?;
            if times.last().is_some_and(|&last| last >= time) {
                return Err(key_at.malformed("a key that is not after the previous one"));
            }
            let r = key.member("mRotation")?.rotation()?;
            times.push(time);
            turns.extend([r.x, r.y, r.z, r.w]);
            places.extend(key.member("mTranslation")?.vec3()?.to_array());
        }
        let Some(&last) = times.last() else { return Err(keys.malformed("a joint without keys")) };
        clip.duration = sinew_math::max(clip.duration, last);
        let channel = |property, values| Channel {
            joint,
            property,
            interpolation: Interpolation::Linear,
            times: times.clone(),
            values,
        };
        clip.channels.push(channel(Property::Translation, places));
        clip.channels.push(channel(Property::Rotation, turns));
    }
    Ok(clip)
}
