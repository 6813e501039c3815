//! Tests of takes, and of bodies recognised from bones alone; without files.

use crate::toy;
use core::f32::consts::TAU;
use sinew_anim::legs::{Legs, add_ankles};
use sinew_anim::retarget::{Body, Feet, Reference, RetargetOptions, retarget, stand};
use sinew_anim::{
    Channel, Clip, Interpolation, Joint, LocalTransform, Property, Rig, Role, Side, Take, analyze,
    analyze_skeleton, local_to_model, rest_pose,
};
use sinew_math::{Affine, Random, Rotation, Vec3, trig};

/// Returns the toy body without its skin.
fn skeleton(name: impl Fn(Role) -> String) -> Rig {
    Rig { joints: toy::body(name).joints, ..Rig::default() }
}

#[test]
fn take_and_its_clip_are_the_same_motion() {
    let mut random = Random::new(8);
    let rig = toy::chain(4, Vec3::Y);
    let rest = rest_pose(&rig);
    let mut poses = Vec::new();
    for frame in 0..30 {
        let mut pose = toy::random_pose(&mut random, 4);
        // Joint 1 has the rest pose, and joint 2 another constant pose.
        pose[1] = rest[1];
        pose[2] = if frame == 0 { pose[2] } else { poses[2] };
        poses.extend(pose);
    }
    let take = Take { frame_time: 0.05, joints: 4, poses };
    let clip = take.to_clip(&rig, "wild");
    assert!((clip.duration - 29.0 * 0.05).abs() < 1e-6 && clip.name == "wild");
    assert!(clip.channels.iter().all(|channel| channel.joint != 1));
    assert!(
        clip.channels.iter().filter(|channel| channel.joint == 2).all(|channel| channel.times.len() == 1)
    );
    assert!(
        clip.channels.iter().filter(|channel| channel.joint == 3).all(|channel| channel.times.len() == 30)
    );
    let again = Take::of(&rig, &clip, 0.05);
    assert_eq!(again.frames(), 30);
    for (a, b) in take.poses.iter().zip(&again.poses) {
        assert!(a.rotation.angle_to(b.rotation) < 1e-3 && (a.translation - b.translation).length() < 1e-5);
    }
    let still = Take::of(&rig, &Clip::default(), 0.05);
    assert_eq!((still.frames(), still.pose(0)), (1, &rest[..]));
}

#[test]
fn roles_are_found_from_bones_alone() {
    let rig = skeleton(Role::name);
    let found = analyze_skeleton(&rig, &rest_pose(&rig)).unwrap();
    assert!(found.humanoid, "{:?}", found.notes);
    for (i, (role, ..)) in toy::BODY.iter().enumerate() {
        let expected = Role::from_name(role);
        // The roles of the three spine joints are interchangeable.
        let found = found.roles[i].map(|guess| guess.role);
        let in_trunk = matches!(expected, Some(Role::Spine | Role::Chest | Role::UpperChest));
        assert!(found == expected || in_trunk, "{role}: {found:?}");
    }
    assert!((found.unit_scale - 1.0).abs() < 1e-6 && (found.height - 1.5).abs() < 0.01);
    let bare = Rig { joints: rig.joints[..1].to_vec(), ..Rig::default() };
    assert!(analyze_skeleton(&bare, &rest_pose(&bare)).is_err());
}

/// Returns a clip of the body in which it steps in place: thighs and knees swing.
fn stepping(rig: &Rig) -> Clip {
    let joint = |name: &str| rig.joints.iter().position(|joint| joint.name == name).unwrap();
    let times: Vec<f32> = (0..61).map(|i| i as f32 / 60.0).collect();
    let swing = |joint: usize, middle: f32, wide: f32, phase: f32| {
        let angle = |&t: &f32| middle + wide * trig::sin(TAU * t + phase);
        let turn = |t: &f32| {
            let q = rig.joints[joint].rest.rotation * Rotation::from_axis_angle(Vec3::X, angle(t));
            [q.x, q.y, q.z, q.w]
        };
        let values = times.iter().flat_map(turn).collect();
        Channel {
            joint,
            property: Property::Rotation,
            interpolation: Interpolation::Linear,
            times: times.clone(),
            values,
        }
    };
    let half = core::f32::consts::PI;
    let channels = vec![
        swing(joint("leftUpperLeg"), 0.0, -0.4, 0.0),
        swing(joint("rightUpperLeg"), 0.0, -0.4, half),
        swing(joint("leftLowerLeg"), 0.4, 0.3, 1.0),
        swing(joint("rightLowerLeg"), 0.4, 0.3, 1.0 + half),
    ];
    Clip { name: "step".into(), duration: 1.0, channels }
}

/// Scaled and rotated bodies with arbitrary joint axes: the bones move equally.
#[test]
fn motion_transfers_between_different_joint_axes() {
    let actor = skeleton(Role::name);
    let clip = stepping(&actor);
    let (analysis, reference) = stand(&actor, &clip, None).unwrap();
    assert_eq!(reference, Reference::Rest);
    let mut random = Random::new(21);
    let mut other = actor.clone();
    let turns: Vec<Rotation> = (0..other.joints.len()).map(|_| random.rotation()).collect();
    let scale = 3.0;
    for i in 0..other.joints.len() {
        let above = other.joints[i].parent.map_or(Rotation::IDENTITY, |parent| turns[parent]);
        let rest = &mut other.joints[i].rest;
        rest.translation = above.inverse() * (rest.translation * scale);
        rest.rotation = (above.inverse() * turns[i]).normalize();
    }
    let found = analyze_skeleton(&other, &rest_pose(&other)).unwrap().with_unit_scale(1.0);
    let (from, to) = (Body { rig: &actor, analysis: &analysis }, Body { rig: &other, analysis: &found });
    let options = RetargetOptions { feet: Feet::Free, ..RetargetOptions::default() };
    let moved = retarget(from, &clip, to, &options).unwrap();
    assert!((moved.scale - scale).abs() < 1e-3);
    let source = Take::of(&actor, &clip, options.frame_time);
    let (mut a, mut b) = (Vec::new(), Vec::new());
    for frame in 0..source.frames() {
        local_to_model(&actor, source.pose(frame), &Affine::IDENTITY, &mut a);
        local_to_model(&other, moved.take.pose(frame), &Affine::IDENTITY, &mut b);
        for i in 1..a.len() {
            let bone =
                |model: &[Affine]| model[i].translation - model[actor.joints[i].parent.unwrap()].translation;
            assert!((bone(&a) * scale - bone(&b)).length() < 1e-3, "frame {frame}, {}", actor.joints[i].name);
        }
    }
}

/// A foot that is a child of the root still follows the shin.
#[test]
fn foot_on_the_root_follows_the_shin() {
    let mut rig = skeleton(Role::name);
    let joint = |rig: &Rig, name: &str| rig.joints.iter().position(|joint| joint.name == name).unwrap();
    let (shank, foot) = (joint(&rig, "leftLowerLeg"), joint(&rig, "leftFoot"));
    let analysis = analyze_skeleton(&rig, &rest_pose(&rig)).unwrap();
    let mut model = Vec::new();
    local_to_model(&rig, &rest_pose(&rig), &Affine::IDENTITY, &mut model);
    rig.joints[foot].parent = Some(0);
    rig.joints[foot].rest.translation = model[foot].translation - model[0].translation;
    let legs = Legs::of(&rig, &analysis).unwrap();
    assert_eq!(legs.feet[0].side, Side::Left);
    let mut pose: Vec<LocalTransform> = rest_pose(&rig);
    pose[shank].rotation = Rotation::from_axis_angle(Vec3::X, 1.0);
    local_to_model(&rig, &pose, &Affine::IDENTITY, &mut model);
    legs.gather(&rig, &mut pose, &mut model);
    let bone = model[foot].translation - model[shank].translation;
    let hanging = Vec3::new(0.0, -0.4 * trig::cos(1.0), -0.4 * trig::sin(1.0));
    assert!((bone - hanging).length() < 1e-5, "{bone}");
}

/// Camera targets far away from a captured skeleton are not part of it.
#[test]
fn cameras_of_a_capture_are_ignored() {
    let plain = skeleton(Role::name);
    let expected = analyze_skeleton(&plain, &rest_pose(&plain)).unwrap();
    let mut rig = plain.clone();
    for (number, far) in [Vec3::new(0.0, 0.0, 400.0), Vec3::new(300.0, 120.0, 0.0)].into_iter().enumerate() {
        let source = rig.joints.len();
        let rest = LocalTransform { translation: far, ..LocalTransform::default() };
        rig.joints.push(Joint { name: format!("Camera{number}"), parent: None, rest, source });
    }
    let found = analyze_skeleton(&rig, &rest_pose(&rig)).unwrap();
    assert!(found.humanoid, "{:?}", found.notes);
    assert!((found.height - expected.height).abs() < 1e-4, "{} m", found.height);
    for role in [Role::Hips, Role::Head, Role::Hand(Side::Left), Role::Foot(Side::Right)] {
        assert_eq!(found.joint_with(role), expected.joint_with(role), "{role:?}");
    }
}

/// The skeleton stands along Y, but the capture walks along Z; the result is upright.
#[test]
fn capture_along_another_axis_is_made_upright() {
    let actor = skeleton(Role::name);
    let mut clip = stepping(&actor);
    let tilt = Rotation::from_axis_angle(Vec3::X, core::f32::consts::FRAC_PI_2);
    let hips = actor.joints.iter().position(|joint| joint.name == "hips").unwrap();
    assert!(actor.joints[hips].parent.is_none());
    let turned = tilt * actor.joints[hips].rest.rotation;
    let place = tilt * actor.joints[hips].rest.translation;
    for (property, values) in [
        (Property::Rotation, vec![turned.x, turned.y, turned.z, turned.w]),
        (Property::Translation, place.to_array().to_vec()),
    ] {
        let interpolation = Interpolation::Linear;
        clip.channels.push(Channel { joint: hips, property, interpolation, times: vec![0.0], values });
    }
    let (analysis, reference) = stand(&actor, &clip, None).unwrap();
    assert!(matches!(reference, Reference::Clip(_)), "{reference:?}");
    assert!((analysis.up_axis - Vec3::Z).length() < 1e-6, "up along {}", analysis.up_axis);
    let body = skeleton(Role::name);
    let found = analyze_skeleton(&body, &rest_pose(&body)).unwrap().with_unit_scale(1.0);
    let (from, to) = (Body { rig: &actor, analysis: &analysis }, Body { rig: &body, analysis: &found });
    let moved = retarget(from, &clip, to, &RetargetOptions::default()).unwrap();
    let mut model = Vec::new();
    let head = body.joints.iter().position(|joint| joint.name == "head").unwrap();
    for frame in 0..moved.take.frames() {
        local_to_model(&body, moved.take.pose(frame), &Affine::IDENTITY, &mut model);
        let trunk = model[head].translation - model[hips].translation;
        assert!(trunk.y > 0.9 * trunk.length(), "frame {frame}: the direction from hips to head is {trunk}");
    }
}

/// A low-poly character whose legs end with the shin gets ankles, and walks like a character with feet.
#[test]
fn legs_without_feet_get_ankles() {
    let whole = toy::body(|_| String::new());
    let mut rig = whole.clone();
    for side in ["left", "right"] {
        let joint = |part: &str| {
            let name = format!("{side}{part}");
            toy::BODY.iter().position(|(role, ..)| *role == name).unwrap()
        };
        let [foot, shank] = [joint("Foot"), joint("LowerLeg")].map(|joint| u16::try_from(joint).unwrap());
        let slots = rig.meshes[0].primitives[0].joints.iter_mut();
        slots.filter(|slots| slots[0] == foot).for_each(|slots| slots[0] = shank);
    }
    let mut found = analyze(&rig).unwrap();
    assert!(found.humanoid && found.joint_with(Role::Foot(Side::Left)).is_none(), "{:?}", found.notes);
    assert!(Legs::of(&rig, &found).is_none());
    assert_eq!(add_ankles(&mut rig, &mut found), 2);
    assert_eq!(add_ankles(&mut rig, &mut found), 0, "they are there");
    let foot = found.joint_with(Role::Foot(Side::Left)).unwrap();
    let expected = analyze(&whole).unwrap();
    let [made, real] = [&found, &expected].map(|found| {
        let foot = found.joint_with(Role::Foot(Side::Left)).unwrap();
        found.character_from_file().point(found.bind_model[foot].translation)
    });
    assert!((made - real).length() < 0.06, "the point is at {made}, in the whole body at {real}");
    let actor = skeleton(Role::name);
    let clip = stepping(&actor);
    let (analysis, _) = stand(&actor, &clip, None).unwrap();
    let (from, to) = (Body { rig: &actor, analysis: &analysis }, Body { rig: &rig, analysis: &found });
    let moved = retarget(from, &clip, to, &RetargetOptions::default()).unwrap();
    let (mut model, mut lifted) = (Vec::new(), 0.0_f32);
    for frame in 0..moved.take.frames() {
        local_to_model(&rig, moved.take.pose(frame), &found.character_from_file(), &mut model);
        let ankle = model[foot].translation;
        assert!(ankle.y > found.floor - 0.02, "frame {frame}: the ankle is at {ankle}");
        lifted = sinew_math::max(lifted, ankle.y - found.floor);
    }
    assert!(lifted > 0.1, "the feet are lifted by only {lifted} m");
}
