//! Tests of root motion: extraction, recombination, and blending as deltas.

use crate::stage;
use sinew_anim::{
    AnimatedClip, AnimationSet, Animator, AxisExtraction, BuiltClip, Channel, Clip, ClipBuildOptions,
    Interpolation, LocalTransform, LoopMode, Property, Rig, RootMotionOptions, Skeleton, TrackDef,
    Transition, Wrap, extract_root_motion, local_to_model, sample,
};
use sinew_math::{Affine, Rotation, Transform, Vec3, trig};

/// Returns a motion once around a circle of `radius` in `duration` seconds, with vertical oscillation; joint 1 is a
/// child of a rotated and scaled joint 0.
fn circling(duration: f32, radius: f32, share: f32) -> (Rig, Clip) {
    let mut rig = stage::rig();
    let turned = Rotation::from_axis_angle(Vec3::X, -core::f32::consts::FRAC_PI_2);
    rig.joints[0].rest = LocalTransform { translation: Vec3::Y, rotation: turned, scale: Vec3::splat(0.01) };
    let above = rig.joints[0].rest.to_affine();
    let times: Vec<f32> = (0..=120).map(|i| duration * i as f32 / 120.0).collect();
    let (mut places, mut turns) = (Vec::new(), Vec::new());
    for &time in &times {
        let angle = share * core::f32::consts::TAU * time / duration;
        let (sin, cos) = trig::sin_cos(angle);
        let height = 1.0 + 0.05 * trig::sin(4.0 * angle);
        let place = Vec3::new(radius * sin, height, radius * (1.0 - cos));
        places.extend(above.inverse().point(place).to_array());
        // The body faces its direction of motion, and leans.
        let q = turned.inverse()
            * Rotation::from_axis_angle(Vec3::Y, -angle)
            * Rotation::from_axis_angle(Vec3::X, 0.2);
        turns.extend([q.x, q.y, q.z, q.w]);
    }
    let channel = |property, values| Channel {
        joint: 1,
        property,
        interpolation: Interpolation::Linear,
        times: times.clone(),
        values,
    };
    let channels = vec![channel(Property::Translation, places), channel(Property::Rotation, turns)];
    (rig, Clip { name: "circle".to_owned(), duration, channels })
}

fn model(clip: &Clip, rig: &Rig, time: f32) -> Affine {
    let (mut pose, mut model) = (vec![LocalTransform::default(); rig.joints.len()], Vec::new());
    sample(clip, rig, time, Wrap::Clamp, &mut pose);
    local_to_model(rig, &pose, &Affine::IDENTITY, &mut model);
    model[1]
}

#[test]
fn root_motion_and_remainder_recombine_to_the_clip() {
    let (rig, clip) = circling(2.0, 1.5, 0.7);
    for options in [
        RootMotionOptions::on_ground(1),
        RootMotionOptions { axes: [AxisExtraction::Linear; 3], ..RootMotionOptions::on_ground(1) },
        RootMotionOptions { turn: AxisExtraction::None, ..RootMotionOptions::on_ground(1) },
        RootMotionOptions { turn: AxisExtraction::Linear, ..RootMotionOptions::on_ground(1) },
    ] {
        let (still, motion) = extract_root_motion(&clip, &rig, &options);
        for i in 0..=40 {
            let time = 0.05 * i as f32;
            let (whole, rest) = (model(&clip, &rig, time), model(&still, &rig, time));
            let again = Affine::from(motion.at(time)) * rest;
            assert!(
                (again.translation - whole.translation).length() < 2e-3,
                "translation at {time} s differs from the clip's, {options:?}"
            );
            let apart = again.to_rigid().rotation.angle_to(whole.to_rigid().rotation);
            assert!(apart < 3e-3, "rotation at {time} s is off by {apart} rad, {options:?}");
        }
        assert_eq!(motion.at(0.0), Transform::IDENTITY);
    }
}

#[test]
fn remainder_of_ground_motion_stays_in_place_and_loops() {
    let (rig, clip) = circling(2.0, 1.5, 0.7);
    let (still, motion) = extract_root_motion(&clip, &rig, &RootMotionOptions::on_ground(1));
    let start = model(&still, &rig, 0.0);
    for i in 0..=40 {
        let now = model(&still, &rig, 0.05 * i as f32);
        let aside = now.translation - start.translation;
        assert!(aside.x.abs() < 1e-3 && aside.z.abs() < 1e-3, "{aside}");
        assert!(now.to_rigid().rotation.angle_to(start.to_rigid().rotation) < 3e-3);
    }
    // The chord of seven tenths of the circle.
    let chord = 2.0 * 1.5 * trig::sin(0.7 * core::f32::consts::PI);
    assert!((motion.stride() - chord).abs() < 1e-3, "{}", motion.stride());
}

fn walker(share: f32, speed: f32, loop_mode: LoopMode) -> (AnimationSet, Animator) {
    let (rig, clip) = circling(2.0, 1.5, share);
    let (still, motion) = extract_root_motion(&clip, &rig, &RootMotionOptions::on_ground(1));
    let built = BuiltClip::build(&still, &rig, &ClipBuildOptions::default()).expect("a good clip");
    let mut set = AnimationSet::new(Skeleton::new(&rig));
    let clip = set.add_clip(AnimatedClip { motion: Some(motion), ..AnimatedClip::from(built) });
    let mut animator = Animator::new(&set);
    animator.play(&set, &TrackDef { speed, loop_mode, ..TrackDef::new(clip) });
    (set, animator)
}

#[test]
fn root_motion_is_independent_of_step_length() {
    for speed in [1.0, -0.7] {
        for (steps, dt) in [(1, 6.0), (6, 1.0), (100, 0.06), (1_000, 0.006)] {
            let (set, mut animator) = walker(0.25, speed, LoopMode::Loop);
            let mut place = Transform::IDENTITY;
            for _ in 0..steps {
                animator.update(&set, dt);
                place = place * animator.root_motion();
            }
            // Each cycle of 2 s covers a quarter of the circle.
            let angle = core::f32::consts::FRAC_PI_2 * 3.0 * speed;
            let (sin, cos) = trig::sin_cos(angle);
            let expected = Vec3::new(1.5 * sin, 0.0, 1.5 * (1.0 - cos));
            let error = (place.translation - expected).length();
            assert!(
                error < 1e-2,
                "{steps} steps at speed {speed}: at {}, expected {expected}",
                place.translation
            );
            assert!(place.rotation.angle_to(Rotation::from_axis_angle(Vec3::Y, -angle)) < 1e-2);
        }
    }
}

#[test]
fn forward_and_backward_playback_cancel() {
    let (set, mut animator) = walker(0.25, 1.0, LoopMode::PingPong);
    let mut place = Transform::IDENTITY;
    for _ in 0..16 {
        animator.update(&set, 0.25);
        place = place * animator.root_motion();
    }
    assert!(place.translation.length() < 1e-4 && place.rotation.angle_to(Rotation::IDENTITY) < 1e-3);
}

#[test]
fn two_speeds_blend_as_deltas() {
    let (set, _) = walker(0.25, 1.0, LoopMode::Loop);
    let clip = set.clips().next().expect("a clip");
    let mut animator = Animator::new(&set);
    animator.play(&set, &TrackDef { weight: 0.75, ..TrackDef::new(clip) });
    animator.play(&set, &TrackDef { weight: 0.25, speed: 2.0, ..TrackDef::new(clip) });
    animator.update(&set, 0.01);
    let step = animator.root_motion().translation.length();
    let pace = 1.5 * core::f32::consts::FRAC_PI_2 / 2.0;
    assert!((step - 0.01 * pace * 1.25).abs() < 1e-4, "{step}");
}

#[test]
fn inertial_transition_accelerates_the_root_smoothly() {
    const DT: f32 = 1.0 / 120.0;
    const TIME: f32 = 0.5;
    let (rig, clip) = circling(2.0, 1.5, 0.25);
    let (still, motion) = extract_root_motion(&clip, &rig, &RootMotionOptions::on_ground(1));
    let built = BuiltClip::build(&still, &rig, &ClipBuildOptions::default()).expect("a good clip");
    let mut set = AnimationSet::new(Skeleton::new(&rig));
    let standing = set.add_clip(AnimatedClip::from(built.clone()));
    let going = set.add_clip(AnimatedClip { motion: Some(motion), ..AnimatedClip::from(built) });
    let mut animator = Animator::new(&set);
    animator.play(&set, &TrackDef::new(standing));
    animator.update(&set, DT);
    animator.transition(&set, &TrackDef::new(going), Transition::Inertial { seconds: TIME });
    let (mut speed, mut way, mut steepest) = (0.0, 0.0, 0.0_f32);
    for _ in 0..60 {
        animator.update(&set, DT);
        let step = animator.root_motion().translation.length();
        steepest = sinew_math::max(steepest, (step / DT - speed) / DT);
        (speed, way) = (step / DT, way + step);
    }
    let pace = 1.5 * core::f32::consts::FRAC_PI_2 / 2.0;
    // The quintic's maximum slope is 15/8 of its mean, and it covers half of the distance.
    assert!(steepest < 1.02 * 1.875 * pace / TIME, "{steepest}");
    assert!((speed - pace).abs() < 1e-3 && (way - 0.5 * pace * TIME).abs() < 5e-3, "{speed} m/s, {way} m");
}
