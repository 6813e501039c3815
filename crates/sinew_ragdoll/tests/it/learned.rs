//! Limits learned from clips: they contain the clips' motion, and little of the anatomical range beyond it.

use crate::data::document;
use needs_data::needs_data;
use sinew_anim::{Rig, Take, analyze, local_to_model};
use sinew_math::limits::{hinge_angle, wrap};
use sinew_math::{Affine, Random, Rotation, Transform, Vec3, max};
use sinew_physics::JointKind;
use sinew_ragdoll::build::takes;
use sinew_ragdoll::limits::sample::random_turn;
use sinew_ragdoll::{
    BuildError, BuildOptions, LimitSource, Mapping, RagdollDef, RagdollJointDef, Settings, SettingsError,
    build_moving,
};
use sinew_scenes::mannequin::mannequin;

fn built(rig: &Rig, takes: &[Take], limits: LimitSource) -> Result<RagdollDef, SettingsError> {
    let analysis = analyze(rig).expect("the rig has a skin");
    let options = BuildOptions { limits, ..BuildOptions::default() };
    build_moving(rig, &analysis, takes, &options, &Settings::default()).map(|(def, _)| def)
}

/// Returns the pose of every body in character space, in every frame.
fn poses(rig: &Rig, def: &RagdollDef, takes: &[Take]) -> Vec<Vec<Transform>> {
    let mapping = Mapping::new(rig, def, &analyze(rig).expect("the rig has a skin").bind_model);
    let (mut model, mut poses) = (Vec::new(), Vec::new());
    for take in takes {
        for frame in 0..take.frames() {
            let mut bodies = Vec::new();
            local_to_model(rig, take.pose(frame), &Affine::IDENTITY, &mut model);
            mapping.bodies_from_model(&model, Transform::IDENTITY, &mut bodies);
            poses.push(bodies);
        }
    }
    poses
}

/// Returns the joint rotation for a rotation of the child relative to the parent.
fn joint_turn(joint: &RagdollJointDef, parent: Rotation, child: Rotation) -> Rotation {
    (parent * joint.frame_parent.rotation).inverse() * (child * joint.frame_child.rotation)
}

/// Returns the excess of a joint's rotation over its limits, radians.
fn beyond(joint: &RagdollJointDef, turn: Rotation) -> f32 {
    match joint.kind {
        JointKind::Ball { limit: Some(limit) } => limit.overshoot(turn),
        JointKind::Universal { limit: Some(limit) } => max(-limit.swing_state(turn).slack, 0.0),
        JointKind::Hinge { limit: Some(limit) } => {
            let middle = limit.center();
            limit.excess(middle + wrap(hinge_angle(turn) - middle))
        }
        kind => panic!("{kind:?} has no limits"),
    }
}

/// Checks that the clips and the bind pose are within the limits. An allowed rotation exceeds the table no further than
/// the clips do, except at the corners of an ellipse around them.
fn check(name: &str, rig: &Rig, takes: &[Take]) {
    let table = built(rig, takes, LimitSource::Anatomy).expect("the rig can be built");
    let learned = built(rig, takes, LimitSource::Clips).expect("clips");
    let poses = poses(rig, &table, takes);
    let mut random = Random::new(1);
    let mut changed = 0;
    for (old, new) in table.joints.iter().zip(&learned.joints) {
        let label = format!("{name}, {}", table.bodies[old.child].role);
        let turns = |joint: &RagdollJointDef| -> Vec<Rotation> {
            let of = |pose: &Vec<Transform>| {
                joint_turn(joint, pose[joint.parent].rotation, pose[joint.child].rotation)
            };
            poses.iter().map(of).collect()
        };
        if old.kind == new.kind {
            continue;
        }
        changed += 1;
        let mut outside: Vec<f32> = turns(new).into_iter().map(|turn| beyond(new, turn)).collect();
        outside.sort_by(f32::total_cmp);
        let most = outside[(outside.len() - 1) * 98 / 100].to_degrees();
        assert!(most < 1.0, "{label}: the clips exceed their learned limits by {most}°");
        let bind = |body: usize| table.bodies[body].character_from_body.rotation;
        let bound = beyond(new, joint_turn(new, bind(new.parent), bind(new.child)));
        assert!(
            bound.to_degrees() < 0.1,
            "{label}: the bind pose exceeds the limits by {}°",
            bound.to_degrees()
        );
        // Motion of the other side counts as well.
        let twin = table.bodies[old.child].role.replacen("left", "?", 1).replacen("right", "left", 1);
        let twin = twin.replacen('?', "right", 1);
        let twin = table.joints.iter().find(|joint| table.bodies[joint.child].role == twin);
        let shown = [Some(old), twin]
            .into_iter()
            .flatten()
            .flat_map(|joint| turns(joint).into_iter().map(|turn| beyond(joint, turn)).collect::<Vec<_>>());
        let shown = shown.fold(0.0, max);
        for _ in 0..200 {
            let turn = random_turn(new.kind, &mut random, 1.0);
            // Compute the relative rotation of the bodies in the old frames.
            let child = new.frame_parent.rotation * turn * new.frame_child.rotation.inverse();
            let excess = beyond(old, joint_turn(old, Rotation::IDENTITY, child)) - shown;
            assert!(
                excess.to_degrees() < 6.0,
                "{label}: the limits are {}° wider than the clips",
                excess.to_degrees()
            );
        }
    }
    assert!(
        changed * 2 > table.joints.len(),
        "{name}: limits of {changed} of {} joints changed",
        table.joints.len()
    );
}

#[needs_data]
#[test]
fn learned_limits_contain_the_clips_and_little_more() {
    let mannequin = mannequin();
    check("mannequin", &mannequin.rig, &takes(&mannequin.rig, &mannequin.clips));
    for name in ["CesiumMan.glb", "mannequiny.glb", "mesh2motion_human_rigify.glb"] {
        let document = document(name);
        check(name, &document.rig, &takes(&document.rig, &document.clips));
    }
}

/// Returns a take in which the left elbow bends from 20° to 70° and the left knee 20° the wrong way.
fn bending(rig: &Rig) -> Take {
    let def = built(rig, &[], LimitSource::Anatomy).expect("the rig can be built");
    let frames = 200;
    let rest: Vec<_> = rig.joints.iter().map(|joint| joint.rest).collect();
    let mut poses = Vec::new();
    for frame in 0..=frames {
        let mut pose = rest.clone();
        let share = frame as f32 / frames as f32;
        for (role, degrees) in [("leftLowerArm", 20.0 + 50.0 * share), ("leftLowerLeg", -20.0 * share)] {
            let joint = def.joints.iter().find(|joint| def.bodies[joint.child].role == role);
            let joint = joint.expect("it has both");
            let child = &def.bodies[joint.child];
            let bind = |body: usize| def.bodies[body].character_from_body.rotation;
            let now = hinge_angle(joint_turn(joint, bind(joint.parent), bind(joint.child)));
            let axis = bind(joint.child) * (joint.frame_child.rotation * Vec3::X);
            // The mannequin's character axes equal its model axes, in which bind pose and rest pose are equal.
            let mut model = Vec::new();
            local_to_model(rig, &rest, &Affine::IDENTITY, &mut model);
            let own = model[child.joint].to_rigid().rotation;
            let turn = Rotation::from_axis_angle(own.inverse() * axis, degrees.to_radians() - now);
            pose[child.joint].rotation = (pose[child.joint].rotation * turn).normalize();
        }
        poses.extend(pose);
    }
    Take { frame_time: 1.0 / 30.0, joints: rig.joints.len(), poses }
}

#[test]
fn learned_hinge_margin_stays_within_the_anatomy() {
    let rig = mannequin().rig;
    let def = built(&rig, &[bending(&rig)], LimitSource::Clips).expect("it moves");
    let range = |role: &str| {
        let joint = def.joints.iter().find(|joint| def.bodies[joint.child].role == role);
        match joint.expect("it has both").kind {
            JointKind::Hinge { limit: Some(range) } => [range.lo.to_degrees(), range.hi.to_degrees()],
            kind => panic!("{kind:?}"),
        }
    };
    for side in ["left", "right"] {
        // The straight bind pose counts as part of the motion.
        let [lo, hi] = range(&format!("{side}LowerArm"));
        assert!(lo > -3.0 && lo < 1.0 && (hi - 80.0).abs() < 1.0, "{side} elbow: range {lo}..{hi}°");
        let [lo, hi] = range(&format!("{side}LowerLeg"));
        assert!((lo + 20.0).abs() < 1.0 && hi > 5.0 && hi < 20.0, "{side} knee: range {lo}..{hi}°");
    }
    // Joints that do not move keep the table's limits.
    let table = built(&rig, &[], LimitSource::Anatomy).expect("the rig can be built");
    let neck = table.bodies.iter().position(|body| body.role == "neck").expect("a neck");
    assert_eq!(def.joints[neck - 1], table.joints[neck - 1]);
}

#[test]
fn learning_without_clips_is_an_error() {
    let rig = mannequin().rig;
    let still = Take {
        frame_time: 0.1,
        joints: rig.joints.len(),
        poses: rig.joints.iter().map(|joint| joint.rest).collect(),
    };
    for takes in [vec![], vec![still]] {
        let refused = built(&rig, &takes, LimitSource::Clips);
        assert_eq!(refused, Err(SettingsError::Build(BuildError::NoClips)));
    }
}
