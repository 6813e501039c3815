//! Tests of blends of whole poses: order, weights, masks, means.

use crate::{precise, toy};
use sinew_anim::{BlendLayer, BlendOptions, Blender, Mask, Pose, RotationMean};
use sinew_math::{Random, Rotation, Vec3};

const JOINTS: usize = 13;

fn random_pose(random: &mut Random) -> Pose {
    toy::random_pose(random, JOINTS).into_iter().collect()
}

fn shuffle<T>(random: &mut Random, list: &mut [T]) {
    for i in (1..list.len()).rev() {
        list.swap(i, random.index(i + 1));
    }
}

#[test]
fn layer_order_does_not_change_the_pose() {
    let mut random = Random::new(1);
    for round in 0..200 {
        let rest = random_pose(&mut random);
        let poses: Vec<Pose> = (0..6).map(|_| random_pose(&mut random)).collect();
        let masks: Vec<Mask> = (0..2).map(|_| (0..JOINTS).map(|_| random.unit()).collect()).collect();
        let mut layers: Vec<BlendLayer<'_>> = (0..8)
            .map(|_| BlendLayer {
                pose: &poses[random.index(6)],
                // Equal weights are frequent.
                weight: random.index(4) as f32 * 0.3,
                mask: [None, Some(&masks[0]), Some(&masks[1])][random.index(3)],
            })
            .collect();
        let mean = if round % 2 == 0 { RotationMean::Sum } else { RotationMean::Exact };
        let mut blender = Blender::new(BlendOptions { fill_below: 0.1, mean });
        let (mut first, mut other) = (Pose::new(JOINTS), Pose::new(JOINTS));
        blender.blend(&rest, &layers, &mut first);
        for _ in 0..5 {
            shuffle(&mut random, &mut layers);
            blender.blend(&rest, &layers, &mut other);
            assert_eq!(first, other, "round {round}");
        }
    }
}

#[test]
fn blend_equals_the_weighted_mean() {
    let mut random = Random::new(2);
    for _ in 0..100 {
        let rest = random_pose(&mut random);
        let poses: Vec<Pose> = (0..4).map(|_| random_pose(&mut random)).collect();
        let weights: Vec<f32> = (0..4).map(|_| random.range(0.0, 2.0)).collect();
        let masks: Vec<Mask> = (0..4).map(|_| (0..JOINTS).map(|_| random.unit()).collect()).collect();
        let layers: Vec<BlendLayer<'_>> = (0..4)
            .map(|i| BlendLayer { pose: &poses[i], weight: weights[i], mask: Some(&masks[i]) })
            .collect();
        let mut out = Pose::new(JOINTS);
        Blender::default().blend(&rest, &layers, &mut out);
        for joint in 0..JOINTS {
            let shares: Vec<f32> = (0..4).map(|i| weights[i] * masks[i].get(joint)).collect();
            let total: f32 = shares.iter().sum();
            let locals: Vec<_> = poses.iter().map(|pose| pose.get(joint)).collect();
            let expected =
                locals.iter().zip(&shares).fold(Vec3::ZERO, |sum, (l, w)| sum + l.translation * (w / total));
            assert!((out.get(joint).translation - expected).length() < 1e-5);
            let rotations: Vec<_> = locals.iter().map(|l| l.rotation).zip(shares.iter().copied()).collect();
            let expected = precise::mean(rest.get(joint).rotation, &rotations);
            let error = precise::angle(precise::quaternion(out.get(joint).rotation), expected);
            assert!(error < 3e-6, "{error}");
        }
    }
}

#[test]
fn pose_blended_with_itself_keeps_its_bits() {
    let mut random = Random::new(3);
    for mean in [RotationMean::Sum, RotationMean::Exact] {
        let (rest, pose) = (random_pose(&mut random), random_pose(&mut random));
        let mut blender = Blender::new(BlendOptions { mean, ..BlendOptions::default() });
        let mut out = Pose::new(JOINTS);
        for weights in [&[0.3][..], &[0.1, 0.7], &[1.0, 1.0, 1.0], &[0.2, 0.5, 0.1, 3.0]] {
            let layers: Vec<_> = weights.iter().map(|&weight| BlendLayer::new(&pose, weight)).collect();
            blender.blend(&rest, &layers, &mut out);
            assert_eq!(out, pose, "mean {mean:?}, weights {weights:?}");
        }
    }
}

#[test]
fn zero_weight_gives_exactly_the_rest_pose() {
    let mut random = Random::new(4);
    let (rest, pose) = (random_pose(&mut random), random_pose(&mut random));
    let mut out = Pose::new(JOINTS);
    let mut blender = Blender::default();
    let nothing = Mask::splat(JOINTS, 0.0);
    let masked = BlendLayer { mask: Some(&nothing), ..BlendLayer::new(&pose, 1.0) };
    let bad = [BlendLayer::new(&pose, -1.0), BlendLayer::new(&pose, f32::NAN), BlendLayer::new(&pose, 0.0)];
    for layers in [&[][..], &bad[..], &[masked][..], &[masked, masked][..]] {
        blender.blend(&rest, layers, &mut out);
        assert_eq!(out, rest);
    }
    // With a mask on half of the body, each joint is blended as if alone.
    let half: Mask = (0..JOINTS).map(|joint| if joint < 6 { 0.0 } else { 1.0 }).collect();
    blender.blend(&rest, &[BlendLayer { mask: Some(&half), ..BlendLayer::new(&pose, 0.2) }], &mut out);
    for joint in 0..JOINTS {
        assert_eq!(out.get(joint), if joint < 6 { rest.get(joint) } else { pose.get(joint) });
    }
}

#[test]
fn weight_ramp_leaves_the_rest_pose_continuously() {
    let mut random = Random::new(5);
    let (rest, pose) = (random_pose(&mut random), random_pose(&mut random));
    let mut blender = Blender::new(BlendOptions { fill_below: 0.1, ..BlendOptions::default() });
    let (mut out, mut before) = (rest.clone(), rest.clone());
    for i in 0..=400 {
        blender.blend(&rest, &[BlendLayer::new(&pose, i as f32 / 2_000.0)], &mut out);
        for joint in 0..JOINTS {
            let way = (pose.get(joint).translation - rest.get(joint).translation).length();
            let step = (out.get(joint).translation - before.get(joint).translation).length();
            assert!(step <= way * 0.0051 + 1e-6, "step {i}: moved {step} of the total {way}");
        }
        before.copy_from(&out);
    }
    for joint in 0..JOINTS {
        assert_eq!(out.get(joint), pose.get(joint), "from 0.1 s on only the pose may count");
    }
}

#[test]
fn exact_mean_minimises_the_squared_chords() {
    let mut random = Random::new(6);
    let mut blender = Blender::new(BlendOptions { mean: RotationMean::Exact, ..BlendOptions::default() });
    let mut out = Pose::new(JOINTS);
    for _ in 0..50 {
        let rest = random_pose(&mut random);
        let poses: Vec<Pose> = (0..3).map(|_| random_pose(&mut random)).collect();
        let weights = [0.5, 0.3, 0.2];
        let layers: Vec<_> =
            poses.iter().zip(weights).map(|(pose, weight)| BlendLayer::new(pose, weight)).collect();
        blender.blend(&rest, &layers, &mut out);
        for joint in 0..JOINTS {
            let cost = |q: Rotation| -> f64 {
                let chord = |(pose, w): (&Pose, f32)| {
                    let c =
                        precise::dot(precise::quaternion(pose.get(joint).rotation), precise::quaternion(q));
                    f64::from(w) * (1.0 - c * c)
                };
                poses.iter().zip(weights).map(chord).sum()
            };
            let found = out.get(joint).rotation;
            for _ in 0..20 {
                let nearby = Rotation::from_scaled_axis(random.direction() * 0.03) * found;
                assert!(
                    cost(found) < cost(nearby) + 1e-6,
                    "a nearby rotation has a lower cost than the mean"
                );
            }
        }
    }
}

#[test]
fn opposite_rotations_give_unit_quaternions_at_the_rest_pose() {
    let mut random = Random::new(7);
    let rest: Pose = toy::random_pose(&mut random, JOINTS).into_iter().collect();
    let mut poses = [rest.clone(), rest.clone()];
    for joint in 0..JOINTS {
        let mut local = rest.get(joint);
        let side = random.direction();
        let q = local.rotation;
        // Half a turn in each direction gives opposite quaternions, perpendicular to the rest pose.
        local.rotation = q * Rotation::from_xyzw(side.x, side.y, side.z, 0.0);
        poses[0].set(joint, &local);
        local.rotation = q * Rotation::from_xyzw(-side.x, -side.y, -side.z, 0.0);
        poses[1].set(joint, &local);
    }
    let mut out = Pose::new(JOINTS);
    Blender::default().blend(
        &rest,
        &[BlendLayer::new(&poses[0], 1.0), BlendLayer::new(&poses[1], 1.0)],
        &mut out,
    );
    for local in out.iter() {
        assert!((local.rotation.length() - 1.0).abs() < 1e-5);
    }
}
