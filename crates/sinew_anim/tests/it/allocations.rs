//! Checks that playing a character does not allocate after warm-up.

use crate::{stage, toy};
use sinew_anim::ik::{
    FootGround, FootPlacement, LookAt, Pole, TwoBone, TwoBoneGoal, look_at, place_feet, two_bone_ik,
};
use sinew_anim::{
    AnimatedClip, AnimationSet, Animator, ClipEvent, Easing, JointIdx, Mask, ModelPose, Role, Skeleton,
    TrackDef, Transition, local_to_model, rest_pose,
};
use sinew_math::{Affine, Random, Vec3};

#[test]
fn animator_update_does_not_allocate_after_warm_up() {
    let mut set = AnimationSet::new(Skeleton::new(&stage::rig()));
    let mut random = Random::new(1);
    for duration in [1.0, 0.75, 1.5] {
        let clip = stage::build(&stage::swaying(&mut random, duration), sinew_anim::Fill::Rest);
        set.add_clip(AnimatedClip {
            events: vec![ClipEvent::new(0.3, "a"), ClipEvent::new(0.0, "b")],
            ..clip
        });
    }
    let mask = set.add_mask(Mask::splat(stage::JOINTS, 0.5));
    let clips: Vec<_> = set.clips().collect();
    let mut animator = Animator::new(&set);
    animator.play(&set, &TrackDef { layer: 1, mask: Some(mask), speed: -0.7, ..TrackDef::new(clips[2]) });
    let [walk, run] = [0, 1].map(|i| TrackDef { sync_group: Some(0), ..TrackDef::new(clips[i]) });
    animator.play(&set, &walk);
    animator.play(&set, &run);
    let mut model = ModelPose::default();
    let mut cycle = |animator: &mut Animator| {
        for i in 0..100 {
            if i % 25 == 0 {
                let to = TrackDef::new(clips[i / 25 % 3]);
                let seconds = 0.2;
                let transition = match i / 25 % 2 {
                    0 => Transition::Inertial { seconds },
                    _ => Transition::Crossfade { seconds, easing: Easing::Smooth },
                };
                animator.transition(&set, &to, transition);
            }
            animator.update(&set, 1.0 / 60.0);
            set.skeleton().to_model(animator.pose(), &Affine::IDENTITY, &mut model);
        }
    };
    cycle(&mut animator);
    cycle(&mut animator);
    let counted = allocation_counter::measure(|| cycle(&mut animator));
    assert_eq!(counted.count_total, 0);
}

#[test]
fn animator_predicts_the_future_pose_of_a_twin() {
    let mut set = AnimationSet::new(Skeleton::new(&stage::rig()));
    let mut random = Random::new(2);
    for duration in [1.0, 0.75, 1.5] {
        let clip = stage::build(&stage::swaying(&mut random, duration), sinew_anim::Fill::Rest);
        set.add_clip(AnimatedClip { events: vec![ClipEvent::new(0.3, "a")], ..clip });
    }
    let clips: Vec<_> = set.clips().collect();
    let mut animator = Animator::new(&set);
    animator.play(&set, &TrackDef::new(clips[0]));
    let mut ahead = animator.clone();
    let mut allocations = 0;
    for i in 0..200_usize {
        let to = TrackDef::new(clips[i / 20 % 3]);
        match i % 60 {
            20 => drop(animator.transition(&set, &to, Transition::Inertial { seconds: 0.4 })),
            40 => {
                let by = Transition::Crossfade { seconds: 0.3, easing: Easing::Smooth };
                animator.transition(&set, &to, by);
            }
            _ => {}
        }
        let counted = allocation_counter::measure(|| {
            ahead.copy_from(&animator);
            ahead.update(&set, 1.0 / 60.0);
        });
        // The first cycle warms up all buffers.
        allocations += if i >= 120 { counted.count_total } else { 0 };
        animator.update(&set, 1.0 / 60.0);
        assert_eq!(ahead.pose(), animator.pose(), "update {i}");
        assert_eq!((ahead.root_motion(), ahead.events()), (animator.root_motion(), animator.events()));
        assert!(ahead.tracks().eq(animator.tracks()));
    }
    assert_eq!(allocations, 0);
}

#[test]
fn inverse_kinematics_does_not_allocate() {
    let rig = toy::body(Role::name);
    let joint =
        |name: &str| rig.joints.iter().position(|joint| joint.name == name).expect("a joint of that name");
    let limb = |side: &str, parts: [&str; 3]| -> TwoBone {
        let [upper, lower, end]: [JointIdx; 3] = parts.map(|part| joint(&format!("{side}{part}")));
        TwoBone { upper, lower, end }
    };
    let legs = ["left", "right"].map(|side| limb(side, ["UpperLeg", "LowerLeg", "Foot"]));
    let arm = limb("left", ["UpperArm", "LowerArm", "Hand"]);
    let settings = FootPlacement {
        up: Vec3::Y,
        forward: Vec3::Z,
        floor: 0.0,
        ankle_height: 0.1,
        free_height: 0.1,
        max_step: 0.4,
        max_tilt: 0.5,
    };
    let look = LookAt {
        joint: joint("head"),
        forward: Vec3::Z,
        up: Vec3::Y,
        target: Vec3::new(1.0, 1.5, 2.0),
        max_yaw: 1.0,
        max_pitch: 0.5,
        weight: 1.0,
    };
    let hand = TwoBoneGoal {
        stretch: 1.1,
        softness: 0.1,
        ..TwoBoneGoal::at(Vec3::new(0.4, 1.2, 0.4), Pole::Toward(Vec3::NEG_Y))
    };
    let rest = rest_pose(&rig);
    let (mut local, mut model) = (rest.clone(), Vec::new());
    local_to_model(&rig, &local, &Affine::IDENTITY, &mut model);
    let ground = |p: Vec3| Some(FootGround { height: 0.3 * p.x, normal: Vec3::new(-0.3, 1.0, 0.0) });
    let hips = joint("hips");
    let counted = allocation_counter::measure(|| {
        for _ in 0..50 {
            local.copy_from_slice(&rest);
            local_to_model(&rig, &local, &Affine::IDENTITY, &mut model);
            place_feet(&rig, hips, &legs, &settings, ground, &mut local, &mut model);
            two_bone_ik(&rig, arm, &hand, &mut local, &mut model);
            look_at(&rig, &look, &mut local, &mut model);
        }
    });
    assert_ne!(local, rest);
    assert_eq!(counted.count_total, 0);
}
