//! Joints with any names, parents, positions and skin: the analysis returns a result for any roles given by a user.
#![no_main]

use libfuzzer_sys::fuzz_target;
use sinew_anim::roles::HUMANOID_ROLES;
use sinew_anim::{
    Correction, Hints, Joint, LocalTransform, Primitive, Rig, RigMesh, Role, Skin, analyze, analyze_corrected,
};
use sinew_math::{Affine, Vec3};

/// Most joints of a rig.
const MOST: usize = 64;

/// A line of the input: parent, position, the role given by the user, then the joint's name.
struct Line<'a> {
    numbers: [u8; 5],
    name: std::borrow::Cow<'a, str>,
}

fn lines(bytes: &[u8]) -> Vec<Line<'_>> {
    let lines = bytes.split(|&byte| byte == b'\n').filter_map(|line| {
        let (numbers, name) = line.split_first_chunk::<5>()?;
        Some(Line { numbers: *numbers, name: String::from_utf8_lossy(name) })
    });
    lines.take(MOST).collect()
}

/// A rig with a tetrahedron of skin on each joint but those that are to have none.
fn rig(lines: &[Line<'_>]) -> Rig {
    let mut rig = Rig::default();
    let mut skin = Skin { name: String::new(), joints: vec![], inverse_bind: vec![] };
    let mut part = Primitive::default();
    for (joint, line) in lines.iter().enumerate() {
        let [parent, x, y, z, said] = line.numbers;
        let at = Vec3::new(f32::from(x as i8), f32::from(y), f32::from(z as i8)) * 0.02;
        let parent = usize::from(parent).checked_rem(joint).filter(|_| parent < 250);
        let rest = LocalTransform { translation: at, ..LocalTransform::default() };
        rig.joints.push(Joint { name: line.name.clone().into_owned(), parent, rest, source: joint });
        skin.joints.push(joint);
        skin.inverse_bind.push(Affine { translation: -at, ..Affine::IDENTITY });
        if said % 16 == 15 {
            continue;
        }
        let first = part.positions.len() as u32;
        part.positions.extend([Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|way| at + way * 0.1));
        part.joints.extend([[joint as u16, 0, 0, 0]; 4]);
        part.weights.extend([[1.0, 0.0, 0.0, 0.0]; 4]);
        part.indices.extend([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3].map(|corner| first + corner));
    }
    rig.skins = vec![skin];
    rig.meshes = vec![RigMesh { name: String::new(), joint: 0, skin: Some(0), primitives: vec![part] }];
    rig
}

/// Roles and joints to ignore, as the input has them.
fn correction(lines: &[Line<'_>]) -> Correction {
    let mut correction = Correction::default();
    for (joint, line) in lines.iter().enumerate() {
        let said = usize::from(line.numbers[4]);
        match said / 16 {
            1 => correction.ignored.push(joint),
            2 => correction.roles.push((Role::SpineSegment((said % 16) as u16), joint)),
            3 => correction.roles.push((Role::LimbSegment { limb: (said % 4) as u16, segment: 1 }, joint)),
            12.. => correction.roles.push((HUMANOID_ROLES[said % HUMANOID_ROLES.len()], joint)),
            _ => {}
        }
    }
    correction
}

fuzz_target!(|bytes: &[u8]| {
    let lines = lines(bytes);
    if lines.is_empty() {
        return;
    }
    let rig = rig(&lines);
    let found = [analyze(&rig).ok(), analyze_corrected(&rig, &Hints::default(), &correction(&lines)).ok()];
    for found in found.into_iter().flatten() {
        assert_eq!(found.roles.len(), rig.joints.len());
        assert!(found.unit_scale > 0.0 && found.unit_scale.is_finite());
        for (place, bone) in found.kept.iter().enumerate() {
            assert!(bone.joint < rig.joints.len() && bone.parent.is_none_or(|parent| parent < place));
        }
    }
});
