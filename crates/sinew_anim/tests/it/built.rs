//! Compares built clips with raw clips and with `f64`.

use crate::{precise, rigs, toy};
use needs_data::needs_data;
use sinew_anim::{
    BuiltClip, Channel, Clip, ClipBuildError, ClipBuildOptions, Cursor, Fill, Interpolation, LocalTransform,
    Pose, Property, Rig, SampleCache, Skeleton, Wrap, local_to_model, sample, sample_cached,
};
use sinew_math::{Affine, Random, Rotation, Vec3};

fn build(clip: &Clip, rig: &Rig) -> BuiltClip {
    BuiltClip::build(clip, rig, &ClipBuildOptions::default())
        .unwrap_or_else(|error| panic!("{}: {error}", clip.name))
}

/// Returns channels of every kind over a chain of joints, with random keys.
fn random_clip(random: &mut Random, joints: usize) -> Clip {
    let mut clip = Clip { name: "random".to_owned(), duration: 3.0, channels: Vec::new() };
    let interpolations = [Interpolation::Step, Interpolation::Linear, Interpolation::CubicSpline];
    for joint in 0..joints {
        for property in [Property::Translation, Property::Rotation, Property::Scale] {
            if random.index(4) == 0 {
                continue;
            }
            let interpolation = interpolations[random.index(3)];
            let keys = 1 + random.index(12);
            let times: Vec<f32> =
                (0..keys).map(|i| (i as f32 + random.unit() * 0.9) * 3.0 / keys as f32).collect();
            let parts = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
            let mut values = Vec::new();
            for part in 0..keys * parts {
                let q = random.rotation();
                // For rotations of a spline, tangents are small compared with the values between keys.
                let scale = if parts == 3 && part % 3 != 1 { 0.5 } else { 1.0 };
                let numbers = [q.x * scale, q.y * scale, q.z * scale, q.w * scale];
                values.extend_from_slice(&numbers[..property.width()]);
            }
            clip.channels.push(Channel { joint, property, interpolation, times, values });
        }
    }
    clip
}

#[needs_data]
#[test]
fn built_clips_are_within_their_bound_on_all_open_clips() {
    let (mut clips, mut keys, mut worst) = (0, 0, sinew_anim::ClipError::default());
    for file in rigs::WITH_CLIPS {
        let (rig, all) = rigs::load(&format!("rigs/{file}"));
        assert!(!all.is_empty(), "{file} holds clips");
        for clip in &all {
            let built = match BuiltClip::build(clip, &rig, &ClipBuildOptions::default()) {
                Ok(built) => built,
                Err(error) => panic!("{file}, {}: {error}", clip.name),
            };
            let (error, bound) = (built.measure_error(clip, &rig, 2), built.error_bound());
            assert!(
                error.is_within(bound),
                "{file}, {}: error {error:?} exceeds the bound {bound:?}",
                clip.name
            );
            (clips, keys, worst) = (clips + 1, keys + built.keys(), worst.merged(error));
        }
    }
    println!("{clips} clips, {keys} keys, largest error {worst:?}");
    assert_eq!(clips, 168, "the manifest lists 168 clips");
}

#[needs_data]
#[test]
fn raw_clips_equal_the_file_at_every_key() {
    for file in rigs::WITH_CLIPS {
        let (rig, clips) = rigs::load(&format!("rigs/{file}"));
        let (mut cache, mut out) =
            (SampleCache::default(), vec![LocalTransform::default(); rig.joints.len()]);
        for clip in &clips {
            let channels = clip.channels.iter();
            let keys = channels.flat_map(|channel| {
                channel.times.iter().enumerate().map(move |(key, &time)| (time, key, channel))
            });
            let mut keys: Vec<(f32, usize, &Channel)> = keys.collect();
            keys.sort_by(|a, b| a.0.total_cmp(&b.0));
            for at_one_time in keys.chunk_by(|a, b| a.0 == b.0) {
                sample_cached(clip, &rig, at_one_time[0].0, Wrap::Clamp, &mut cache, &mut out);
                for &(_, key, channel) in at_one_time {
                    let (joint, error) = (channel.joint, key_error(channel, key, &out[channel.joint]));
                    assert!(error < 1e-6, "{file}, {}, joint {joint}, key {key}: error {error}", clip.name);
                }
            }
        }
    }
}

/// Returns the difference of a local transform from a key of the file: radians, or the distance over the value's
/// length.
fn key_error(channel: &Channel, key: usize, local: &LocalTransform) -> f64 {
    let width = channel.property.width();
    let start = if channel.interpolation == Interpolation::CubicSpline { 3 * key + 1 } else { key } * width;
    let value: Vec<f64> = channel.values[start..start + width].iter().copied().map(f64::from).collect();
    let vector = |got: Vec3| {
        let [x, y, z] = got.to_array().map(f64::from);
        let square = (x - value[0]).powi(2) + (y - value[1]).powi(2) + (z - value[2]).powi(2);
        square.sqrt() / (value.iter().map(|x| x * x).sum::<f64>().sqrt().max(1.0))
    };
    match channel.property {
        Property::Translation => vector(local.translation),
        Property::Scale => vector(local.scale),
        Property::Rotation => {
            precise::angle(precise::quaternion(local.rotation), [value[0], value[1], value[2], value[3]])
        }
    }
}

#[test]
fn steps_splines_and_wide_arcs_are_within_the_bound() {
    let mut random = Random::new(7);
    for _ in 0..12 {
        let joints = 1 + random.index(9);
        let rig = toy::chain(joints, Vec3::X);
        let clip = random_clip(&mut random, joints);
        let built = build(&clip, &rig);
        let (error, bound) = (built.measure_error(&clip, &rig, 5), built.error_bound());
        assert!(error.is_within(bound), "error {error:?} exceeds the bound {bound:?}");
    }
}

#[test]
fn built_steps_stay_sharp() {
    let rig = toy::chain(1, Vec3::ZERO);
    let values = vec![1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 4.0, 0.0, 0.0];
    let (property, interpolation) = (Property::Translation, Interpolation::Step);
    let channel = Channel { joint: 0, property, interpolation, times: vec![0.1, 0.7, 1.3], values };
    let built = build(&Clip { name: String::new(), duration: 2.0, channels: vec![channel] }, &rig);
    let (mut cursor, mut out) = (Cursor::new(), Pose::new(1));
    for (time, x) in [(0.0, 1.0), (0.699_999_8, 1.0), (0.7, 2.0), (1.299_999_6, 2.0), (1.3, 4.0), (2.0, 4.0)]
    {
        built.sample(time, &mut cursor, &mut out);
        assert!((out.get(0).translation.x - x).abs() < 1e-4, "at {time}: {:?}", out.get(0));
    }
}

#[test]
fn cursor_does_not_change_the_pose() {
    let mut random = Random::new(8);
    let rig = toy::chain(19, Vec3::X);
    let clips: Vec<BuiltClip> = (0..3).map(|_| build(&random_clip(&mut random, 19), &rig)).collect();
    let (mut cursor, mut warm, mut cold) = (Cursor::new(), Pose::new(19), Pose::new(19));
    let mut time = 0.0_f32;
    for i in 0..4_000 {
        // Time runs forward and backward at all speeds, with jumps and changes of clip.
        time = match i % 37 {
            0 => random.range(-0.5, 3.5),
            k if k < 20 => time + 0.013 * k as f32,
            k => time - 0.005 * k as f32,
        };
        let clip = &clips[i / 100 % 3];
        clip.sample(time, &mut cursor, &mut warm);
        clip.sample(time, &mut Cursor::new(), &mut cold);
        assert_eq!(warm, cold, "sample {i} at {time}");
    }
    clips[0].sample(f32::NAN, &mut cursor, &mut warm);
    clips[0].sample(0.0, &mut cursor, &mut cold);
    assert_eq!(warm, cold);
}

#[test]
fn constant_channels_have_no_keys() {
    let rig = toy::chain(9, Vec3::X);
    let still = [0.6, 0.0, 0.0, 0.8, 0.6, 0.0, 0.0, 0.8];
    let channel = |joint, values: &[f32]| Channel {
        joint,
        property: Property::Rotation,
        interpolation: Interpolation::Linear,
        times: vec![0.0, 1.0],
        values: values.to_vec(),
    };
    let clip = |channels| Clip { name: String::new(), duration: 1.0, channels };
    let built = build(&clip(vec![channel(8, &still)]), &rig);
    assert_eq!(built.keys(), 0);
    let mut out = Pose::new(9);
    built.sample(0.5, &mut Cursor::new(), &mut out);
    assert_eq!(out.get(8).rotation, Rotation::from_xyzw(0.6, 0.0, 0.0, 0.8).normalize());
    assert_eq!(out.get(8).translation, Vec3::X, "a joint without a channel must have the rest pose");
    // Opposite signs of one quaternion are no motion.
    let signs = [0.6, 0.0, 0.0, 0.8, -0.6, 0.0, 0.0, -0.8];
    assert_eq!(build(&clip(vec![channel(8, &signs)]), &rig).keys(), 0);
    // Of two channels the later one is used.
    let moving = [0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0];
    assert_eq!(build(&clip(vec![channel(8, &moving), channel(8, &still)]), &rig).keys(), 0);
    assert!(build(&clip(vec![channel(8, &still), channel(8, &moving)]), &rig).keys() > 0);
}

#[test]
fn invalid_clips_are_rejected_with_their_place() {
    let rig = toy::chain(2, Vec3::X);
    let channel = Channel {
        joint: 1,
        property: Property::Rotation,
        interpolation: Interpolation::Linear,
        times: vec![0.0, 0.5, 1.0],
        values: [0.0, 0.0, 0.0, 1.0].repeat(3),
    };
    let good = Clip { name: String::new(), duration: 1.0, channels: vec![channel.clone(), channel] };
    let error = |change: &dyn Fn(&mut Clip)| {
        let mut clip = good.clone();
        change(&mut clip);
        BuiltClip::build(&clip, &rig, &ClipBuildOptions::default()).expect_err("the clip is invalid")
    };
    assert!(BuiltClip::build(&good, &rig, &ClipBuildOptions::default()).is_ok());
    let none = Rig::default();
    assert_eq!(BuiltClip::build(&good, &none, &ClipBuildOptions::default()), Err(ClipBuildError::NoJoints));
    assert_eq!(error(&|c| c.duration = -1.0), ClipBuildError::Duration { duration: -1.0 });
    assert!(matches!(error(&|c| c.duration = f32::NAN), ClipBuildError::Duration { .. }));
    let unknown = ClipBuildError::UnknownJoint { channel: 1, joint: 2, joints: 2 };
    assert_eq!(error(&|c| c.channels[1].joint = 2), unknown);
    assert_eq!(error(&|c| c.channels[0].times.clear()), ClipBuildError::NoKeys { channel: 0 });
    let short = ClipBuildError::ValueCount { channel: 0, values: 11, needed: 12 };
    assert_eq!(error(&|c| c.channels[0].values.truncate(11)), short);
    let late = ClipBuildError::Time { channel: 1, key: 2, time: 0.5 };
    assert_eq!(error(&|c| c.channels[1].times[2] = 0.5), late);
    assert_eq!(
        error(&|c| c.channels[1].times[0] = -1.0),
        ClipBuildError::Time { channel: 1, key: 0, time: -1.0 }
    );
    assert!(matches!(
        error(&|c| c.channels[1].times[1] = f32::NAN),
        ClipBuildError::Time { channel: 1, key: 1, .. }
    ));
    assert_eq!(error(&|c| c.channels[1].values[5] = f32::NAN), ClipBuildError::Value { channel: 1, key: 1 });
    assert_eq!(error(&|c| c.channels[1].values[5] = 1e30), ClipBuildError::Value { channel: 1, key: 1 });
    assert_eq!(
        error(&|c| c.channels[1].values[7] = 0.0),
        ClipBuildError::ZeroRotation { channel: 1, key: 1 }
    );
    let many = |c: &mut Clip| {
        c.channels[1].times = (0..70_000).map(|i| i as f32 * 1e-3).collect();
        c.channels[1].values = (0..70_000).flat_map(|i| [0.0, (i % 7) as f32, 0.0, 1.0]).collect();
    };
    assert!(matches!(error(&many), ClipBuildError::TooManyTimes { times } if times >= 70_000));
}

#[test]
fn additive_clip_on_its_reference_equals_the_clip() {
    let mut random = Random::new(9);
    let rig = toy::chain(6, Vec3::X);
    let reference = toy::random_pose(&mut random, 6);
    let mut clip = random_clip(&mut random, 6);
    // A spline of quaternions equals the spline of their products with the reference before both are normalised.
    clip.channels.retain(|channel| channel.property != Property::Scale);
    let difference = clip.difference_from(&reference);
    let fill = Fill::Identity;
    let built =
        BuiltClip::build(&difference, &rig, &ClipBuildOptions { fill, ..ClipBuildOptions::default() });
    let built = built.expect("the difference of valid clips must be valid");
    let (mut out, mut expected) = (Pose::new(6), reference.clone());
    for i in 0..30 {
        let time = 0.1 * i as f32;
        built.sample(time, &mut Cursor::new(), &mut out);
        sample(&clip, &rig, time, Wrap::Clamp, &mut expected);
        for channel in &clip.channels {
            let (joint, delta) = (channel.joint, out.get(channel.joint));
            let error = match channel.property {
                Property::Rotation => {
                    (reference[joint].rotation * delta.rotation).angle_to(expected[joint].rotation)
                }
                _ => {
                    (reference[joint].translation + delta.translation - expected[joint].translation).length()
                }
            };
            assert!(error < 2e-3, "joint {joint} at {time} s: error {error}");
        }
    }
}

#[test]
fn model_space_matches_the_slices_exactly_and_f64_closely() {
    let mut random = Random::new(10);
    for joints in [1, 7, 8, 9, 50] {
        let mut rig = toy::chain(joints, Vec3::X);
        for joint in 1..joints {
            rig.joints[joint].parent = Some(random.index(joint));
        }
        let locals = toy::random_pose(&mut random, joints);
        let skeleton = Skeleton::new(&rig);
        let (mut fast, mut slow) = (sinew_anim::ModelPose::default(), Vec::new());
        let root =
            Affine::from_scale_rotation_translation(Vec3::splat(2.0), random.rotation(), random.in_cube());
        skeleton.to_model(&Pose::from(&locals[..]), &root, &mut fast);
        local_to_model(&rig, &locals, &root, &mut slow);
        assert_eq!(fast.iter().collect::<Vec<_>>(), slow);
        assert!(fast.matrices().iter().all(|m| [m[0][3], m[1][3], m[2][3], m[3][3]] == [0.0, 0.0, 0.0, 1.0]));
        skeleton.to_model(&Pose::from(&locals[..]), &Affine::IDENTITY, &mut fast);
        for (joint, exact) in precise::model(&rig, &locals).iter().enumerate() {
            let got = fast.get(joint);
            let columns = [got.linear.x_axis, got.linear.y_axis, got.linear.z_axis, got.translation];
            let size = exact.as_flattened().iter().fold(1.0_f64, |size, x| size.max(x.abs()));
            for (j, column) in columns.iter().enumerate() {
                for (i, x) in column.to_array().into_iter().enumerate() {
                    let error = (f64::from(x) - exact[i][j]).abs();
                    assert!(error < 1e-5 * size, "joint {joint}: error {error} at size {size}");
                }
            }
        }
    }
}
