//! Tests of key reduction and the resulting errors of joints.

use crate::toy;
use sinew_anim::{
    Channel, Clip, Interpolation, KeyBound, Property, Rig, Wrap, local_to_model, reduce_keys, sample,
};
use sinew_math::{Affine, Random, Rotation, Transform, Vec3, max, trig};

const BOUND: KeyBound = KeyBound { distance: 1e-4, angle: 1.7e-4 };

fn channel(joint: usize, property: Property, times: &[f32], value: impl Fn(f32) -> Vec<f32>) -> Channel {
    let values = times.iter().flat_map(|&time| value(time)).collect();
    Channel { joint, property, interpolation: Interpolation::Linear, times: times.to_vec(), values }
}

fn turn(axis: Vec3, angle: f32) -> Vec<f32> {
    let q = Rotation::about(axis, angle);
    vec![q.x, q.y, q.z, q.w]
}

fn frames(count: u16, rate: f32) -> Vec<f32> {
    (0..count).map(|frame| f32::from(frame) / rate).collect()
}

/// Returns the largest distance and angle between the joints of two clips at many times, computed
/// independently.
fn apart(rig: &Rig, a: &Clip, b: &Clip, root: &Affine, times: &[f32]) -> [f32; 2] {
    let mut worst = [0.0, 0.0];
    for &time in times {
        let model = |clip: &Clip| {
            let mut pose = sinew_anim::rest_pose(rig);
            let mut model = Vec::new();
            sample(clip, rig, time, Wrap::Clamp, &mut pose);
            local_to_model(rig, &pose, root, &mut model);
            model
        };
        for (a, b) in model(a).iter().zip(&model(b)) {
            let (a, b) = (a.to_rigid(), b.to_rigid());
            worst[0] = max(worst[0], (a.translation - b.translation).length());
            worst[1] = max(worst[1], a.rotation.angle_to(b.rotation));
        }
    }
    worst
}

#[test]
fn linear_motion_needs_two_keys_and_rest_one() {
    let rig = toy::chain(3, Vec3::Y);
    let times = frames(101, 50.0);
    let clip = Clip {
        name: "straight".into(),
        duration: 2.0,
        channels: vec![
            channel(0, Property::Translation, &times, |time| vec![3.0 * time, 1.0, -time]),
            channel(1, Property::Rotation, &times, |time| turn(Vec3::Z, 0.7 * time)),
            channel(2, Property::Rotation, &times, |_| turn(Vec3::X, 1.0)),
        ],
    };
    let reduced = reduce_keys(&rig, &clip, &Affine::IDENTITY, BOUND);
    let keys: Vec<usize> = reduced.clip.channels.iter().map(|channel| channel.times.len()).collect();
    assert_eq!((keys, reduced.keys), (vec![2, 2, 1], [303, 5]));
    assert!((reduced.clip.duration - 2.0).abs() < 1e-6 && reduced.clip.name == "straight");
    // The duration is kept also without any motion.
    let still = Clip { channels: vec![clip.channels[2].clone()], ..clip };
    let reduced = reduce_keys(&rig, &still, &Affine::IDENTITY, BOUND);
    assert_eq!(reduced.clip.channels[0].times, [0.0, 2.0]);
}

#[test]
fn corner_keeps_its_key() {
    let rig = toy::chain(1, Vec3::Y);
    let times = frames(41, 20.0);
    let fold = |time: f32| vec![(time - 1.0).abs(), 0.0, 0.0];
    let clip = Clip {
        duration: 2.0,
        channels: vec![channel(0, Property::Translation, &times, fold)],
        ..Clip::default()
    };
    let reduced = reduce_keys(&rig, &clip, &Affine::IDENTITY, BOUND);
    assert_eq!(reduced.clip.channels[0].times, [0.0, 1.0, 2.0]);
}

/// Returns a clip of a chain of eight joints that all sway, at different rates.
fn swaying(random: &mut Random, times: &[f32]) -> Clip {
    let mut channels = Vec::new();
    for joint in 0..8 {
        let axis = random.direction();
        let (size, rate) = (random.range(0.05, 0.6), random.range(0.5, 4.0));
        let angle = move |time: f32| size * trig::sin(rate * time);
        channels.push(channel(joint, Property::Rotation, times, |time| turn(axis, angle(time))));
    }
    let way = |time: f32| vec![time, trig::sin(time), 0.0];
    channels.push(channel(0, Property::Translation, times, way));
    Clip { name: String::new(), duration: times[times.len() - 1], channels }
}

#[test]
fn error_of_a_whole_chain_stays_within_the_bound() {
    let mut random = Random::new(7);
    let times = frames(241, 60.0);
    let between: Vec<f32> = (0..1200_u16).map(|i| f32::from(i) / 300.0).collect();
    for (unit, bound) in [(1.0, BOUND), (1.0, KeyBound { distance: 2e-3, angle: 0.1 }), (0.01, BOUND)] {
        let rig = toy::chain(8, Vec3::Y * 0.3 / unit);
        let root = Affine::from_scale_rotation_translation(
            Vec3::splat(unit),
            Rotation::about(Vec3::X, 1.0),
            Vec3::new(3.0, 2.0, 1.0),
        );
        let clip = swaying(&mut random, &times);
        let reduced = reduce_keys(&rig, &clip, &root, bound);
        let [distance, angle] = apart(&rig, &clip, &reduced.clip, &root, &times);
        println!("{unit} {bound:?}: {:?} keys, {distance} and {angle}", reduced.keys);
        assert!(
            distance <= bound.distance && angle <= bound.angle,
            "error {distance} m and {angle} rad, bound {bound:?}"
        );
        assert!((distance - reduced.error.distance).abs() < 2e-6 + 0.01 * distance, "{:?}", reduced.error);
        assert!((angle - reduced.error.angle).abs() < 2e-6 + 0.01 * angle, "{:?}", reduced.error);
        // The bound is nearly used up, and many keys are removed.
        assert!(distance > 0.5 * bound.distance || angle > 0.5 * bound.angle, "{distance} {angle}");
        assert!(4 * reduced.keys[1] < 3 * reduced.keys[0], "{:?}", reduced.keys);
        // Between keys the error is only slightly larger, because motion there is linear.
        let [distance, _] = apart(&rig, &clip, &reduced.clip, &root, &between);
        assert!(distance <= 1.1 * bound.distance, "error between keys: {distance} m");
    }
}

#[test]
fn zero_bound_keeps_all_keys_and_tighter_bounds_keep_more() {
    let mut random = Random::new(8);
    let rig = toy::chain(8, Vec3::Y * 0.3);
    let clip = swaying(&mut random, &frames(121, 30.0));
    let keys = |bound| reduce_keys(&rig, &clip, &Affine::IDENTITY, bound);
    assert_eq!(keys(KeyBound::ALL_KEYS).clip, clip);
    let counts =
        [1e-5, 1e-4, 1e-3, 1e-2].map(|distance| keys(KeyBound { distance, angle: 1.7 * distance }).keys[1]);
    assert!(counts.windows(2).all(|pair| pair[1] < pair[0]), "{counts:?}");
}

#[test]
fn random_walks_stay_within_the_bound() {
    // In noise no key can be removed, and the attempt changes nothing.
    let mut random = Random::new(9);
    let rig = toy::chain(5, Vec3::Y);
    let times = frames(60, 30.0);
    let mut channels = Vec::new();
    for joint in 0..5 {
        let turns: Vec<f32> = (0..60)
            .flat_map(|_| {
                let q = Rotation::from_scaled_axis(random.direction() * random.range(0.0, 3.0));
                [q.x, q.y, q.z, q.w]
            })
            .collect();
        let mut one = channel(joint, Property::Rotation, &times, |_| Vec::new());
        one.values = turns;
        channels.push(one);
    }
    let clip = Clip { name: String::new(), duration: times[59], channels };
    let root = Affine::from(Transform::IDENTITY);
    let reduced = reduce_keys(&rig, &clip, &root, BOUND);
    let [distance, angle] = apart(&rig, &clip, &reduced.clip, &root, &times);
    assert!(distance <= BOUND.distance && angle <= 5.0 * BOUND.angle, "{distance} {angle}");
    for channel in &reduced.clip.channels {
        for pair in channel.values.chunks_exact(4).collect::<Vec<_>>().windows(2) {
            let dot: f32 = pair[0].iter().zip(pair[1]).map(|(a, b)| a * b).sum();
            assert!(dot >= 0.0, "consecutive keys must be in one hemisphere");
        }
    }
}
