//! Roles given by the user take precedence over those of the analysis.

use crate::roles::sound;
use crate::{rigs, toy};
use needs_data::needs_data;
use sinew_anim::{
    Correction, CorrectionError, Hints, Joint, LocalTransform, NoSkin, Rig, RigAnalysis, Role, Side, analyze,
};
use sinew_math::{Affine, Random, Vec3};

/// Analyses a rig with corrections and without hints.
fn analyze_corrected(rig: &Rig, correction: &Correction) -> Result<RigAnalysis, CorrectionError> {
    sinew_anim::analyze_corrected(rig, &Hints::default(), correction)
}

/// Returns a body whose joint names are numbers.
fn numbered() -> Rig {
    let mut rig = toy::body(Role::name);
    rig.joints.iter_mut().enumerate().for_each(|(i, joint)| joint.name = format!("Bone_{i}"));
    rig
}

fn of_roles(roles: &[(Role, usize)]) -> Correction {
    Correction { roles: roles.to_vec(), ..Correction::default() }
}

#[test]
fn empty_correction_changes_nothing() {
    let rig = numbered();
    assert_eq!(analyze_corrected(&rig, &Correction::default()).ok(), analyze(&rig).ok());
    let same = of_roles(&[(Role::Hips, 0)]);
    let (before, after) = (analyze(&rig).expect("a skin"), analyze_corrected(&rig, &same).expect("hips"));
    let roles = |analysis: &sinew_anim::RigAnalysis| -> Vec<_> {
        analysis.kept.iter().map(|bone| (bone.joint, bone.role)).collect()
    };
    assert_eq!(roles(&before), roles(&after));
    assert_eq!((before.kept[0].confidence, after.kept[0].confidence), (0.8, 1.0));
}

#[test]
fn corrected_role_has_the_given_joint() {
    let rig = numbered();
    let found = analyze_corrected(&rig, &of_roles(&[(Role::UpperChest, 2)])).expect("a body");
    sound(&rig, &found);
    assert_eq!(found.joint_with(Role::UpperChest), Some(2));
    assert_eq!(found.joint_with(Role::Chest), None, "one joint, one role");
    // If one side is declared to be the other, the sides swap, and the body faces the opposite direction.
    let forward = |found: &sinew_anim::RigAnalysis| found.character_from_model.rotation.inverse() * Vec3::Z;
    let before = analyze(&rig).expect("a skin");
    let left = before.joint_with(Role::UpperLeg(Side::Left)).expect("a leg");
    let found = analyze_corrected(&rig, &of_roles(&[(Role::UpperLeg(Side::Right), left)])).expect("a body");
    sound(&rig, &found);
    for role in [Role::Hand(Side::Left), Role::Foot(Side::Left), Role::UpperLeg(Side::Left)] {
        assert_eq!(found.joint_with(role), before.joint_with(role.mirror()), "{role:?}");
    }
    assert!(forward(&found).dot(forward(&before)) < -0.99);
}

#[test]
fn impossible_correction_is_rejected() {
    let rig = numbered();
    let error =
        |roles: &[(Role, usize)]| analyze_corrected(&rig, &of_roles(roles)).expect_err("no such body");
    assert_eq!(error(&[(Role::Hips, 0), (Role::Hips, 1)]), CorrectionError::Twice(Role::Hips));
    assert_eq!(error(&[(Role::Hips, 0), (Role::Spine, 0)]), CorrectionError::Twice(Role::Spine));
    let lost = error(&[(Role::Spine, 0)]);
    assert_eq!(lost, CorrectionError::NotHuman { role: Role::Spine, missing: vec![Role::Hips] });
    let all = Correction { ignored: vec![0], ..Correction::default() };
    assert_eq!(analyze_corrected(&rig, &all), Err(CorrectionError::NothingLeft));
    let bare = Rig { skins: Vec::new(), meshes: Vec::new(), ..rig.clone() };
    assert_eq!(analyze_corrected(&bare, &Correction::default()), Err(CorrectionError::NoSkin(NoSkin)));
    // Without arms no character is recognised as human; the error names the missing roles.
    let mut stump = rig.clone();
    let arms: Vec<u16> = (5..11).collect();
    for primitive in &mut stump.meshes[0].primitives {
        let slots = primitive.joints.clone();
        primitive.indices = primitive
            .indices
            .chunks_exact(3)
            .filter(|corner| !arms.contains(&slots[corner[0] as usize][0]))
            .flatten()
            .copied()
            .collect();
        let keep = |i: &usize| !arms.contains(&slots[*i][0]);
        let weights = (0..slots.len()).map(|i| if keep(&i) { primitive.weights[i] } else { [0.0; 4] });
        primitive.weights = weights.collect();
    }
    let found = analyze(&stump).expect("a skin");
    assert!(!found.humanoid);
    let error = analyze_corrected(&stump, &of_roles(&[(Role::Head, 4)])).expect_err("no arms");
    let text = error.to_string();
    assert!(
        text.starts_with("`head` is a role of a human, and the rig is not read as one: give `hips`"),
        "{text}"
    );
    let legless = analyze_corrected(&stump, &of_roles(&[(Role::SpineSegment(0), 6)]));
    assert_eq!(legless, Err(CorrectionError::NoPart(Role::SpineSegment(0))));
}

/// Adds a pole on the chest with a flag far above the head.
fn with_flag(rig: &Rig, chest: usize) -> Rig {
    let mut rig = rig.clone();
    let place = analyze(&rig).expect("a skin").bind_model[chest].translation;
    for (name, parent) in [("Pole", chest), ("Flag", rig.joints.len())] {
        let rest = LocalTransform { translation: Vec3::Y * 0.5, ..LocalTransform::default() };
        rig.joints.push(Joint { name: name.into(), parent: Some(parent), rest, source: rig.joints.len() });
        let height = 0.5 * (rig.joints.len() - 17) as f32;
        rig.skins[0].joints.push(rig.joints.len() - 1);
        let at = place + Vec3::Y * height;
        rig.skins[0].inverse_bind.push(Affine { translation: -at, ..Affine::IDENTITY });
        let primitive = &mut rig.meshes[0].primitives[0];
        let first = u32::try_from(primitive.positions.len()).expect("a small body");
        let slot = u16::try_from(rig.skins[0].joints.len() - 1).expect("a small body");
        primitive.positions.extend([Vec3::ZERO, Vec3::X * 0.3, Vec3::Y * 0.3].map(|corner| at + corner));
        primitive.joints.extend([[slot, 0, 0, 0]; 3]);
        primitive.weights.extend([[1.0, 0.0, 0.0, 0.0]; 3]);
        primitive.indices.extend([first, first + 1, first + 2]);
    }
    rig
}

#[test]
fn ignored_joints_are_merged_and_do_not_affect_shapes() {
    let plain = numbered();
    let rig = with_flag(&plain, 2);
    let (before, flagged) = (analyze(&plain).expect("a skin"), analyze(&rig).expect("a skin"));
    assert!(flagged.height > before.height + 0.5, "{} and {}", flagged.height, before.height);
    let correction = Correction { ignored: vec![17], ..Correction::default() };
    let found = analyze_corrected(&rig, &correction).expect("a body");
    sound(&rig, &found);
    assert_eq!((found.height, found.floor), (before.height, before.floor));
    let bones = |analysis: &sinew_anim::RigAnalysis| -> Vec<_> {
        analysis.kept.iter().map(|bone| (bone.joint, bone.role)).collect()
    };
    assert_eq!(bones(&found), bones(&before));
    assert_eq!(found.merge_into[17..], [Some(2), Some(2)]);
    assert_eq!(correction.seen(&rig).meshes, plain.meshes);
}

/// Any correction gives a body or an error.
#[needs_data]
#[test]
fn any_correction_gives_a_body_or_an_error() {
    let mut all = vec![numbered(), toy::body(Role::name)];
    for file in ["Fox.glb", "quaternius_Spider.glb", "kaykit_Knight.glb", "RiggedSimple.glb"] {
        all.push(rigs::load(&format!("rigs/{file}")).0);
    }
    let mut random = Random::new(21);
    let (mut bodies, mut refusals) = (0, 0);
    for rig in &all {
        for _ in 0..crate::cases(2000) {
            let mut correction = Correction::default();
            for _ in 0..random.index(5) {
                let role = match random.index(4) {
                    0 => Role::SpineSegment(random.index(4) as u16),
                    1 => Role::LimbSegment { limb: random.index(5) as u16, segment: random.index(3) as u16 },
                    _ => sinew_anim::roles::HUMANOID_ROLES[random.index(22)],
                };
                correction.roles.push((role, random.index(rig.joints.len())));
            }
            for _ in 0..random.index(3) {
                correction.ignored.push(random.index(rig.joints.len()));
            }
            match analyze_corrected(rig, &correction) {
                Ok(found) => {
                    sound(rig, &found);
                    bodies += 1;
                }
                Err(_) => refusals += 1,
            }
        }
    }
    assert!(bodies > 0 && refusals > 0, "{bodies} {refusals}");
}
