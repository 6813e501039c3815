//! Ragdoll definitions built from files: bodies, masses and invariants.

use crate::data::rig;
use needs_data::needs_data;
use sinew_anim::Rig;
use sinew_anim::roles::analyze;
use sinew_math::Vec3;
use sinew_physics::Shape;
use sinew_ragdoll::{BuildError, BuildOptions, BuildReport, RagdollDef, Sex, ShapeChoice, build};

pub const PEOPLE: [&str; 4] =
    ["CesiumMan.glb", "RiggedFigure.glb", "mannequiny.glb", "mesh2motion_human_rigify.glb"];
pub const OTHERS: [&str; 11] = [
    "kaykit_Knight.glb",
    "quaternius_cyberpunk_Character.glb",
    "CoolLoops_mixamorig_vrm0.vrm",
    "Fox.glb",
    "quaternius_Spider.glb",
    "quaternius_MandarinFish.glb",
    "quaternius_Robot.glb",
    "RecursiveSkeletons.glb",
    "RiggedSimple.glb",
    "SimpleSkin.gltf",
    "kaykit_mannequin/manny_med_mod.gltf",
];

pub fn built(rig: &Rig, options: &BuildOptions) -> (RagdollDef, BuildReport) {
    let analysis = analyze(rig).expect("the rig has a skin");
    build(rig, &analysis, options).expect("the ragdoll can be built")
}

fn body(def: &RagdollDef, role: &str) -> usize {
    def.bodies.iter().position(|body| body.role == role).unwrap_or_else(|| panic!("no {role}"))
}

/// Checks invariants that hold for the definition of any rig.
pub fn check_sound(name: &str, def: &RagdollDef) {
    assert!(!def.bodies.is_empty(), "{name}");
    assert_eq!(def.joints.len() + 1, def.bodies.len(), "{name}");
    for (i, joint) in def.joints.iter().enumerate() {
        assert_eq!(joint.child, i + 1, "{name}");
        assert!(joint.parent < joint.child, "{name}");
        assert!(joint.frame_parent.is_finite() && joint.frame_child.is_finite(), "{name} joint {i}");
        let pivot = |body: usize, p: Vec3| def.bodies[body].character_from_body.point(p);
        let gap = pivot(joint.parent, joint.frame_parent.translation)
            - pivot(joint.child, joint.frame_child.translation);
        assert!(gap.length() < 1e-4 * def.height.max(1.0), "{name} joint {i}: gap {gap}");
        assert!(joint.friction_torque > 0.0 && joint.friction_torque.is_finite(), "{name} joint {i}");
    }
    for body in &def.bodies {
        let label = format!("{name} {}", body.role);
        assert_eq!(body.shape.check(), Ok(()), "{label}");
        assert!(body.shape.smallest_extent() >= 0.0149, "{label}: {:?}", body.shape);
        assert!(body.character_from_body.is_finite(), "{label}");
        assert!(body.mass.mass > 0.0 && body.mass.mass.is_finite(), "{label}");
        let (distance, _) = body.shape.signed_distance(&sinew_math::Transform::IDENTITY, body.mass.center);
        assert!(distance < 0.0, "{label}: the centre of mass is {distance} m outside");
        let (moments, _) = body.mass.inertia.eigen();
        assert!(moments.z > 0.0 && moments.x <= 8.01 * moments.z, "{label}: {moments}");
        assert!(moments.x <= 1.001 * (moments.y + moments.z), "{label}: {moments}");
    }
    let sum: f32 = def.bodies.iter().map(|body| body.mass.mass).sum();
    assert!((sum - def.total_mass).abs() <= 1e-5 * def.total_mass, "{name}: {sum} of {}", def.total_mass);
    for &(a, b) in &def.disabled_pairs {
        assert!(a < b && b < def.bodies.len(), "{name}");
    }
}

#[needs_data]
#[test]
fn human_rigs_get_human_bodies_and_masses() {
    for name in PEOPLE {
        let rig = rig(name);
        let (def, report) = built(&rig, &BuildOptions { mass: Some(75.0), ..BuildOptions::default() });
        check_sound(name, &def);
        assert!((13..=25).contains(&def.bodies.len()), "{name}: {} bodies", def.bodies.len());
        assert!((def.total_mass - 75.0).abs() < 1e-3, "{name}: {}", def.total_mass);
        assert!(report.mean_error < 0.0125 * def.height, "{name}: mean error {} m", report.mean_error);
        assert!(report.shape_volume < 1.6 * 0.075, "{name}: the shapes have {} m³", report.shape_volume);
        for role in ["hips", "spine", "head"] {
            body(&def, role);
        }
        for part in ["UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot"] {
            let [left, right] = ["left", "right"].map(|side| body(&def, &format!("{side}{part}")));
            let (l, r) = (def.bodies[left].mass.mass, def.bodies[right].mass.mass);
            assert!((l - r).abs() < 0.01 * l, "{name} {part}: left {l} kg, right {r} kg");
        }
        // De Leva: a thigh is 14.16 % of a man, a shank 4.33 %.
        let thigh = def.bodies[body(&def, "leftUpperLeg")].mass.mass;
        assert!((thigh / 75.0 - 0.1416).abs() < 0.001, "{name}: {thigh}");
    }
}

#[needs_data]
#[test]
fn unusual_rigs_give_valid_definitions() {
    for name in OTHERS {
        let rig = rig(name);
        for shapes in [ShapeChoice::Auto, ShapeChoice::Box, ShapeChoice::Capsule] {
            let (def, _) = built(&rig, &BuildOptions { shapes, ..BuildOptions::default() });
            check_sound(name, &def);
            let boxes = def.bodies.iter().filter(|body| matches!(body.shape, Shape::Box { .. })).count();
            assert!(shapes != ShapeChoice::Capsule || boxes == 0, "{name}: {boxes} boxes");
        }
    }
}

#[needs_data]
#[test]
fn sex_and_mass_options_are_applied() {
    let rig = rig("mannequiny.glb");
    let of = |sex, mass| built(&rig, &BuildOptions { sex, mass, ..BuildOptions::default() }).0;
    let (man, woman) = (of(Sex::Male, None), of(Sex::Female, None));
    let thigh = |def: &RagdollDef| def.bodies[body(def, "leftUpperLeg")].mass.mass / def.total_mass;
    assert!((thigh(&man) - 0.1416).abs() < 1e-3 && (thigh(&woman) - 0.1478).abs() < 1e-3);
    let index = 73.0 / (1.741 * 1.741) * man.height * man.height;
    assert!((man.total_mass - index).abs() < 0.01, "{} kg at {} m", man.total_mass, man.height);
    assert!((of(Sex::Male, Some(60.0)).total_mass - 60.0).abs() < 1e-3);
}

#[needs_data]
#[test]
fn rig_without_skin_is_rejected() {
    let rig = rig("SimpleSkin.gltf");
    let analysis = analyze(&rig).expect("the rig has a skin");
    let bare = Rig { skins: Vec::new(), ..rig.clone() };
    assert_eq!(build(&bare, &analysis, &BuildOptions::default()), Err(BuildError::NoSkin));
    assert_eq!(BuildError::NoSkin.to_string(), "no skin: nothing to build a ragdoll from");
    let options = BuildOptions { mass: Some(-1.0), ..BuildOptions::default() };
    assert_eq!(build(&rig, &analysis, &options), Err(BuildError::Mass(-1.0)));
}
