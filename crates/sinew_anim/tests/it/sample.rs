use crate::{rigs, toy};
use needs_data::needs_data;
use sinew_anim::{
    Channel, Clip, Interpolation, LocalTransform, Property, Rig, SampleCache, Wrap, sample, sample_cached,
};
use sinew_math::{Random, Rotation, Vec3, trig};

fn clip(property: Property, interpolation: Interpolation, times: &[f32], values: &[f32]) -> Clip {
    let channel =
        Channel { joint: 0, property, interpolation, times: times.to_vec(), values: values.to_vec() };
    Clip { name: String::new(), duration: *times.last().expect("a key"), channels: vec![channel] }
}

fn at(clip: &Clip, time: f32, wrap: Wrap) -> LocalTransform {
    let rig = toy::chain(1, Vec3::new(7.0, 8.0, 9.0));
    let mut out = vec![LocalTransform::default()];
    sample(clip, &rig, time, wrap, &mut out);
    out[0]
}

const STEPS: [f32; 9] = [1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 4.0, 0.0, 0.0];

#[test]
fn step_holds_the_earlier_key() {
    let clip = clip(Property::Translation, Interpolation::Step, &[0.5, 1.0, 2.0], &STEPS);
    for (time, x) in [(0.0, 1.0), (0.5, 1.0), (0.999, 1.0), (1.0, 2.0), (1.99, 2.0), (2.0, 4.0), (9.0, 4.0)] {
        assert_eq!(at(&clip, time, Wrap::Clamp).translation.x, x, "at {time}");
    }
}

#[test]
fn linear_is_a_straight_line_and_clamps_before_the_first_key() {
    let clip = clip(Property::Scale, Interpolation::Linear, &[0.5, 1.0, 2.0], &STEPS);
    for (time, x) in [(-1.0, 1.0), (0.25, 1.0), (0.75, 1.5), (1.25, 2.5), (2.0, 4.0), (5.0, 4.0)] {
        assert!((at(&clip, time, Wrap::Clamp).scale.x - x).abs() < 1e-6, "at {time}");
    }
    // Properties without a channel keep the rig's values.
    assert_eq!(at(&clip, 1.0, Wrap::Clamp).translation, Vec3::new(7.0, 8.0, 9.0));
}

#[test]
fn linear_rotation_turns_at_constant_speed_and_the_short_way() {
    let (a, b) = (Rotation::from_axis_angle(Vec3::Y, 0.2), Rotation::from_axis_angle(Vec3::Y, 1.8));
    // The second key has the opposite sign of the same rotation.
    let values = [a.x, a.y, a.z, a.w, -b.x, -b.y, -b.z, -b.w];
    let clip = clip(Property::Rotation, Interpolation::Linear, &[0.0, 2.0], &values);
    for i in 0..=20 {
        let time = i as f32 * 0.1;
        let expected = Rotation::from_axis_angle(Vec3::Y, 0.2 + 0.8 * time);
        assert!(at(&clip, time, Wrap::Clamp).rotation.angle_to(expected) < 1e-3, "at {time}");
    }
}

#[test]
fn a_cubic_spline_reproduces_a_cubic() {
    // x = t³ − 2t on uneven keys, with its exact slopes as tangents per second.
    let (value, slope) = (|t: f32| t * t * t - 2.0 * t, |t: f32| 3.0 * t * t - 2.0);
    let times = [0.0, 0.3, 1.0, 2.5];
    let values: Vec<f32> =
        times.iter().flat_map(|&t| [slope(t), 0.0, 0.0, value(t), 5.0, 0.0, slope(t), 0.0, 0.0]).collect();
    let clip = clip(Property::Translation, Interpolation::CubicSpline, &times, &values);
    for i in 0..=50 {
        let time = i as f32 * 0.05;
        let got = at(&clip, time, Wrap::Clamp).translation;
        assert!((got - Vec3::new(value(time), 5.0, 0.0)).length() < 2e-5, "at {time}: {got}");
    }
}

#[test]
fn a_cubic_rotation_is_normalised() {
    let half = trig::sin(std::f32::consts::FRAC_PI_4);
    let (zero, one) = ([0.0; 4], [0.0, 0.0, 0.0, 1.0]);
    let quarter = [0.0, half, 0.0, half];
    let values: Vec<f32> = [zero, one, zero, zero, quarter, zero].concat();
    let clip = clip(Property::Rotation, Interpolation::CubicSpline, &[0.0, 1.0], &values);
    let middle = at(&clip, 0.5, Wrap::Clamp).rotation;
    // By symmetry, the rotation is the mean of both keys, an eighth of a turn.
    assert!(middle.angle_to(Rotation::from_axis_angle(Vec3::Y, std::f32::consts::FRAC_PI_4)) < 1e-5);
    assert!((middle.dot(middle) - 1.0).abs() < 1e-6);
}

#[test]
fn loop_wraps_in_both_directions() {
    let times = [0.0, 1.0, 2.0];
    let clip = clip(Property::Translation, Interpolation::Linear, &times, &STEPS);
    for (time, x) in [(0.5, 1.5), (2.5, 1.5), (200.5, 1.5), (-0.5, 3.0), (-1.5, 1.5)] {
        assert!((at(&clip, time, Wrap::Loop).translation.x - x).abs() < 1e-5, "at {time}");
    }
}

#[test]
fn non_finite_keys_affect_only_their_joint() {
    let mut clip = clip(Property::Translation, Interpolation::Linear, &[0.0, 1.0, 2.0], &STEPS);
    for wrap in [Wrap::Clamp, Wrap::Loop] {
        assert_eq!(at(&clip, f32::NAN, wrap).translation.x, 1.0);
        assert!(at(&clip, f32::INFINITY, wrap).translation.is_finite());
        assert_eq!(wrap.clip_time(1.0, f32::NAN), 0.0);
        assert_eq!(wrap.clip_time(1.0, 0.0), 0.0);
    }
    clip.channels[0].values[3] = f32::NAN;
    assert_eq!(at(&clip, 0.5, Wrap::Clamp).translation, Vec3::new(7.0, 8.0, 9.0));
}

#[test]
fn sampling_cache_does_not_change_the_pose() {
    let mut random = Random::new(5);
    let times: Vec<f32> = (0..40).map(|i| i as f32 * 0.1 + random.range(0.0, 0.09)).collect();
    let values: Vec<f32> = (0..120).map(|_| random.range(-1.0, 1.0)).collect();
    let long = clip(Property::Translation, Interpolation::Linear, &times, &values);
    let short = clip(Property::Translation, Interpolation::Step, &[0.5, 1.0, 2.0], &STEPS);
    let rig: Rig = toy::chain(1, Vec3::X);
    let mut cache = SampleCache::default();
    let (mut cached, mut plain) = ([LocalTransform::default()], [LocalTransform::default()]);
    for i in 0..2_000 {
        // Time mostly runs forward, with jumps, backward play and changes of clip.
        let time = if i % 7 == 0 { random.range(-1.0, 9.0) } else { i as f32 * 0.013 };
        let clip = if i % 11 == 0 { &short } else { &long };
        sample_cached(clip, &rig, time, Wrap::Loop, &mut cache, &mut cached);
        sample(clip, &rig, time, Wrap::Loop, &mut plain);
        assert_eq!(cached, plain, "step {i}");
    }
}

#[needs_data]
#[test]
fn interpolation_test_file_is_sampled_correctly() {
    let (rig, clips) = rigs::load("negative/InterpolationTest/InterpolationTest.gltf");
    assert_eq!(clips.len(), 9);
    let mut out: Vec<LocalTransform> = rig.joints.iter().map(|joint| joint.rest).collect();
    for clip in &clips {
        let channel = &clip.channels[0];
        let (width, cubic) = (channel.property.width(), channel.interpolation == Interpolation::CubicSpline);
        for (key, &time) in channel.times.iter().enumerate() {
            sample(clip, &rig, time, Wrap::Clamp, &mut out);
            // At a key every interpolation gives the key; a cubic key is stored between its two tangents.
            let start = if cubic { (3 * key + 1) * width } else { key * width };
            let expected = &channel.values[start..start + width];
            let local = out[channel.joint];
            let error = match channel.property {
                Property::Translation => (local.translation - Vec3::from_slice(expected)).length(),
                Property::Scale => (local.scale - Vec3::from_slice(expected)).length(),
                Property::Rotation => {
                    let q = Rotation::from_xyzw(expected[0], expected[1], expected[2], expected[3]);
                    local.rotation.angle_to(q.normalize())
                }
            };
            assert!(error < 1e-3, "clip {} at key {key}: error {error}", clip.name);
        }
        // Halfway between the first two keys, step interpolation still gives the first key, and the others do not.
        let (a, b) = (channel.times[0], channel.times[1]);
        sample(clip, &rig, a, Wrap::Clamp, &mut out);
        let at_key = out[channel.joint];
        sample(clip, &rig, 0.5 * (a + b), Wrap::Clamp, &mut out);
        assert_eq!(
            out[channel.joint] == at_key,
            channel.interpolation == Interpolation::Step,
            "{}",
            clip.name
        );
    }
}

#[needs_data]
#[test]
fn every_clip_of_every_rig_gives_finite_unit_poses() {
    for file in ["CesiumMan.glb", "mannequiny.glb", "Fox.glb", "quaternius_Spider.glb", "kaykit_Knight.glb"] {
        let (rig, clips) = rigs::load(&format!("rigs/{file}"));
        let mut out = vec![LocalTransform::default(); rig.joints.len()];
        for clip in &clips {
            for i in -2..=12 {
                sample(clip, &rig, clip.duration * i as f32 / 10.0, Wrap::Loop, &mut out);
                for (joint, local) in out.iter().enumerate() {
                    let finite = local.translation.is_finite() && local.scale.is_finite();
                    let unit = (local.rotation.dot(local.rotation) - 1.0).abs() < 1e-4;
                    assert!(
                        finite && unit,
                        "{file}, {}, joint {joint}: invalid transform {local:?}",
                        clip.name
                    );
                }
            }
        }
    }
}

#[test]
fn reversed_clip_passes_the_same_values_backwards() {
    let cubic: Vec<f32> = (0..27).map(|i| trig::sin(3.0 * i as f32)).collect();
    for (interpolation, values) in [
        (Interpolation::Step, &STEPS[..]),
        (Interpolation::Linear, &STEPS[..]),
        (Interpolation::CubicSpline, &cubic[..]),
    ] {
        for times in [[0.0, 1.0, 2.0], [0.5, 0.7, 2.0]] {
            for duration in [2.0, 2.5] {
                let mut clip = clip(Property::Translation, interpolation, &times, values);
                clip.duration = duration;
                let back = clip.reversed();
                for step in 0..40 {
                    let time = 0.049 * step as f32 + 0.013;
                    let place = |clip: &Clip, time: f32| at(clip, time, Wrap::Clamp).translation;
                    let (there, here) = (place(&clip, time), place(&back, duration - time));
                    assert!(
                        (there - here).length() < 1e-4,
                        "{interpolation:?} at {time}: {there} and {here}"
                    );
                }
                assert_eq!(back.duration, duration);
            }
        }
    }
    let still = clip(Property::Translation, Interpolation::Step, &[0.0], &STEPS[..3]);
    assert_eq!(still.reversed(), still);
}
