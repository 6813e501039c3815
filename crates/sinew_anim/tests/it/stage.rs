//! Animation sets built in code.

use crate::toy;
use sinew_anim::{
    AnimatedClip, AnimationSet, BuiltClip, Channel, Clip, ClipBuildOptions, Fill, Interpolation, Property,
    Rig, Skeleton,
};
use sinew_math::{Random, Vec3};

pub const JOINTS: usize = 11;

pub fn rig() -> Rig {
    toy::chain(JOINTS, Vec3::X)
}

/// Returns a looped clip with random rotations of all joints; first and last key are equal.
pub fn swaying(random: &mut Random, duration: f32) -> Clip {
    let keys = 13;
    let times: Vec<f32> = (0..keys).map(|i| duration * (i as f32 / (keys - 1) as f32)).collect();
    let channel = |joint| {
        let (axis, lean) = (random.direction(), random.in_cube() * 0.6);
        let (size, shift) = (random.range(0.1, 0.8), random.range(0.0, 6.0));
        let value = |&time: &f32| {
            let swing = sinew_math::trig::sin(core::f32::consts::TAU * time / duration + shift);
            let q = sinew_math::Rotation::from_scaled_axis(lean)
                * sinew_math::Rotation::from_scaled_axis(axis * (size * swing));
            [q.x, q.y, q.z, q.w]
        };
        let (property, interpolation) = (Property::Rotation, Interpolation::Linear);
        Channel {
            joint,
            property,
            interpolation,
            values: times.iter().flat_map(value).collect(),
            times: times.clone(),
        }
    };
    Clip { name: "sway".to_owned(), duration, channels: (0..JOINTS).map(channel).collect() }
}

pub fn build(clip: &Clip, fill: Fill) -> AnimatedClip {
    let options = ClipBuildOptions { fill, ..ClipBuildOptions::default() };
    AnimatedClip::from(BuiltClip::build(clip, &rig(), &options).expect("a good clip"))
}

/// Returns a set with three clips of 1, 0.75 and 1.5 s.
pub fn set(seed: u64) -> AnimationSet {
    let mut random = Random::new(seed);
    let mut set = AnimationSet::new(Skeleton::new(&rig()));
    for duration in [1.0, 0.75, 1.5] {
        set.add_clip(build(&swaying(&mut random, duration), Fill::Rest));
    }
    set
}
