//! Small rigs made in code.

use sinew_anim::{Joint, LocalTransform, Primitive, Rig, RigMesh, Role, Skin};
use sinew_math::{Affine, Random, Rotation, Vec3};

/// Returns a chain of `n` joints, each at `offset` from its parent.
pub fn chain(n: usize, offset: Vec3) -> Rig {
    let joint = |i: usize| Joint {
        name: format!("joint{i}"),
        parent: i.checked_sub(1),
        rest: LocalTransform { translation: offset, ..LocalTransform::default() },
        source: i,
    };
    Rig { joints: (0..n).map(joint).collect(), ..Rig::default() }
}

/// Returns a random pose of `n` joints.
pub fn random_pose(random: &mut Random, n: usize) -> Vec<LocalTransform> {
    let local = |_| LocalTransform {
        translation: random.in_cube(),
        rotation: Rotation::from_scaled_axis(random.in_cube() * 1.2),
        scale: Vec3::splat(random.range(0.5, 2.0)),
    };
    (0..n).map(local).collect()
}

/// A standing body: role, parent's role, joint position in metres.
pub const BODY: [(&str, &str, [f32; 3]); 17] = [
    ("hips", "", [0.0, 0.95, 0.0]),
    ("spine", "hips", [0.0, 1.1, 0.0]),
    ("chest", "spine", [0.0, 1.3, 0.0]),
    ("neck", "chest", [0.0, 1.5, 0.0]),
    ("head", "neck", [0.0, 1.6, 0.0]),
    ("leftUpperArm", "chest", [0.18, 1.45, 0.0]),
    ("leftLowerArm", "leftUpperArm", [0.46, 1.45, 0.0]),
    ("leftHand", "leftLowerArm", [0.71, 1.45, 0.0]),
    ("rightUpperArm", "chest", [-0.18, 1.45, 0.0]),
    ("rightLowerArm", "rightUpperArm", [-0.46, 1.45, 0.0]),
    ("rightHand", "rightLowerArm", [-0.71, 1.45, 0.0]),
    ("leftUpperLeg", "hips", [0.1, 0.9, 0.0]),
    ("leftLowerLeg", "leftUpperLeg", [0.1, 0.5, 0.0]),
    ("leftFoot", "leftLowerLeg", [0.1, 0.1, 0.0]),
    ("rightUpperLeg", "hips", [-0.1, 0.9, 0.0]),
    ("rightLowerLeg", "rightUpperLeg", [-0.1, 0.5, 0.0]),
    ("rightFoot", "rightLowerLeg", [-0.1, 0.1, 0.0]),
];

/// Returns [`BODY`] with a tetrahedron of skin at every joint; those of the feet reach the floor and point
/// forward (+Z).
pub fn body(name: impl Fn(Role) -> String) -> Rig {
    let place = |i: usize| Vec3::from_array(BODY[i].2);
    let mut rig = Rig::default();
    let mut skin = Skin { name: String::new(), joints: vec![], inverse_bind: vec![] };
    let mut skinned = Primitive::default();
    for (i, (role, parent, _)) in BODY.iter().enumerate() {
        let parent = BODY.iter().position(|(other, ..)| other == parent);
        let translation = place(i) - parent.map_or(Vec3::ZERO, place);
        let role = Role::from_name(role).expect("a VRM name");
        let rest = LocalTransform { translation, ..LocalTransform::default() };
        rig.joints.push(Joint { name: name(role), parent, rest, source: i });
        skin.joints.push(i);
        skin.inverse_bind.push(Affine { translation: -place(i), ..Affine::IDENTITY });
        let tip = if matches!(role, Role::Foot(_)) { Vec3::new(0.0, -0.1, 0.15) } else { Vec3::Y * 0.16 };
        let first = u32::try_from(4 * i).expect("a small body");
        let corners = [Vec3::X * 0.05, Vec3::new(-0.025, 0.0, 0.043), Vec3::new(-0.025, 0.0, -0.043), tip];
        skinned.positions.extend(corners.map(|corner| place(i) + corner));
        skinned.joints.extend([[u16::try_from(i).expect("a small body"), 0, 0, 0]; 4]);
        skinned.weights.extend([[1.0, 0.0, 0.0, 0.0]; 4]);
        skinned.indices.extend([0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3].map(|corner| first + corner));
    }
    rig.skins = vec![skin];
    rig.meshes = vec![RigMesh { name: String::new(), joint: 0, skin: Some(0), primitives: vec![skinned] }];
    rig
}
