use crate::toy;
use sinew_anim::{
    LocalTransform, WeightedPose, blend, crossfade, joint_velocities, local_to_model, rest_pose, smoothstep,
};
use sinew_math::{Affine, Random, Rotation, Transform, Vec3, trig};

fn distance(a: &[LocalTransform], b: &[LocalTransform]) -> f32 {
    let one = |(a, b): (&LocalTransform, &LocalTransform)| {
        (a.translation - b.translation).length()
            + (a.scale - b.scale).length()
            + a.rotation.angle_to(b.rotation)
    };
    a.iter().zip(b).map(one).fold(0.0, sinew_math::max)
}

#[test]
fn bent_chain_matches_trigonometry() {
    let rig = toy::chain(4, Vec3::X);
    let angle = 0.3;
    let bend = Rotation::from_axis_angle(Vec3::Z, angle);
    let local: Vec<_> = rest_pose(&rig).into_iter().map(|l| LocalTransform { rotation: bend, ..l }).collect();
    let root = Affine::from_scale_rotation_translation(Vec3::splat(2.0), Rotation::IDENTITY, Vec3::Y);
    let mut model = Vec::new();
    local_to_model(&rig, &local, &root, &mut model);
    // Joint k is at the sum of unit steps rotated by 0, a, 2a, …, doubled and lifted by the root.
    let mut expected = Vec3::ZERO;
    for (k, joint) in model.iter().enumerate() {
        let (sin, cos) = trig::sin_cos(angle * k as f32);
        expected += Vec3::new(cos, sin, 0.0);
        assert!((joint.translation - (expected * 2.0 + Vec3::Y)).length() < 1e-5, "joint {k}");
    }
}

#[test]
fn velocities_of_a_spinning_scaled_frame_are_exact() {
    let (linear, angular) = (Vec3::new(1.0, -2.0, 0.5), Vec3::new(0.4, 3.0, -1.0));
    let dt = 1.0 / 60.0;
    let start =
        Transform::new(Vec3::new(3.0, 1.0, 2.0), Rotation::from_scaled_axis(Vec3::new(0.5, 1.0, -0.2)));
    let end = Transform::new(start.translation + linear * dt, start.rotation.integrate(angular, dt));
    let scaled =
        |t: Transform| Affine::from_scale_rotation_translation(Vec3::splat(100.0), t.rotation, t.translation);
    let mut out = Vec::new();
    joint_velocities(&[scaled(start)], &[scaled(end)], dt, &mut out);
    assert!((out[0].linear - linear).length() < 1e-4, "{out:?}");
    assert!((out[0].angular - angular).length() < 1e-3, "{out:?}");
    joint_velocities(&[scaled(start)], &[scaled(end)], 0.0, &mut out);
    assert_eq!(out[0].linear, Vec3::ZERO);
}

#[test]
fn pose_blend_is_independent_of_layer_order() {
    let mut random = Random::new(1);
    for _ in 0..50 {
        let rest = toy::random_pose(&mut random, 3);
        let poses: Vec<_> = (0..4).map(|_| toy::random_pose(&mut random, 3)).collect();
        let weights: Vec<_> = poses.iter().map(|_| random.range(0.1, 1.0)).collect();
        let layers: Vec<_> =
            poses.iter().zip(&weights).map(|(pose, &weight)| WeightedPose { pose, weight }).collect();
        let reversed: Vec<_> = layers.iter().rev().copied().collect();
        let (mut a, mut b) = (rest.clone(), rest.clone());
        blend(&rest, &layers, &mut a);
        blend(&rest, &reversed, &mut b);
        assert!(distance(&a, &b) < 1e-3);
    }
}

#[test]
fn equal_poses_blend_to_themselves_for_any_quaternion_signs() {
    let mut random = Random::new(2);
    let rest = toy::random_pose(&mut random, 5);
    let pose = toy::random_pose(&mut random, 5);
    let mut flipped = pose.clone();
    for local in &mut flipped {
        let q = local.rotation;
        local.rotation = Rotation::from_xyzw(-q.x, -q.y, -q.z, -q.w);
    }
    let mut out = rest.clone();
    blend(
        &rest,
        &[WeightedPose { pose: &pose, weight: 3.0 }, WeightedPose { pose: &flipped, weight: 1.0 }],
        &mut out,
    );
    assert!(distance(&out, &pose) < 1e-5);
}

#[test]
fn zero_or_invalid_weights_give_the_rest_pose() {
    let mut random = Random::new(3);
    let rest = toy::random_pose(&mut random, 2);
    let pose = toy::random_pose(&mut random, 2);
    let mut out = pose.clone();
    blend(&rest, &[], &mut out);
    assert_eq!(out, rest);
    out.clone_from(&pose);
    blend(&rest, &[WeightedPose { pose: &pose, weight: f32::NAN }], &mut out);
    assert_eq!(out, rest);
    blend(
        &rest,
        &[WeightedPose { pose: &rest, weight: -1.0 }, WeightedPose { pose: &pose, weight: 0.1 }],
        &mut out,
    );
    assert!(distance(&out, &pose) < 1e-6);
}

#[test]
fn crossfade_starts_and_ends_at_its_poses() {
    let mut random = Random::new(4);
    let rest = toy::random_pose(&mut random, 3);
    let (from, to) = (toy::random_pose(&mut random, 3), toy::random_pose(&mut random, 3));
    let mut out = rest.clone();
    for (t, expected) in [(0.0, &from), (1.0, &to), (-3.0, &from), (7.0, &to)] {
        crossfade(&rest, &from, &to, t, &mut out);
        assert!(distance(&out, expected) < 1e-5, "t {t}");
    }
}

#[test]
fn smoothstep_is_flat_at_its_ends_and_symmetric() {
    assert_eq!((smoothstep(-1.0), smoothstep(0.0), smoothstep(1.0), smoothstep(2.0)), (0.0, 0.0, 1.0, 1.0));
    for i in 0..=10 {
        let x = i as f32 / 10.0;
        assert!((smoothstep(x) + smoothstep(1.0 - x) - 1.0).abs() < 1e-6);
    }
    assert!(smoothstep(0.01) < 4e-4);
}
