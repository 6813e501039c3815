//! Changes to a rig's file that leave the character the same: units, axes, names, order, helper joints.

use sinew_anim::{
    Clip, Interpolation, Joint, JointIdx, LocalTransform, Primitive, Property, Rig, RigAnalysis, RigMesh,
    Role, Side, Skin,
};
use sinew_math::{Affine, Random, Rotation, Transform, Vec3};

/// Returns the rig in other units and axes: changes every root and every bind matrix.
pub fn transformed(rig: &Rig, scale: f32, turn: Rotation) -> Rig {
    let mut rig = rig.clone();
    for joint in rig.joints.iter_mut().filter(|joint| joint.parent.is_none()) {
        joint.rest.translation = turn * (joint.rest.translation * scale);
        joint.rest.rotation = turn * joint.rest.rotation;
        joint.rest.scale *= scale;
    }
    // Mesh space is turned and scaled with the model: p' = S p, so inverse_bind' = inverse_bind S⁻¹.
    let there = Affine::from_scale_rotation_translation(Vec3::splat(scale), turn, Vec3::ZERO);
    let back = there.inverse();
    for skin in &mut rig.skins {
        for inverse in &mut skin.inverse_bind {
            *inverse = *inverse * back;
        }
    }
    for mesh in rig.meshes.iter_mut().filter(|mesh| mesh.skin.is_some()) {
        for position in mesh.primitives.iter_mut().flat_map(|p| &mut p.positions) {
            *position = there.point(*position);
        }
    }
    rig
}

/// Returns the joints in random order, parents before children, and the new index of each.
pub fn shuffled(rig: &Rig, seed: u64) -> (Rig, Vec<usize>) {
    let mut random = Random::new(seed);
    let mut place = vec![None; rig.joints.len()];
    for new in 0..rig.joints.len() {
        let parent_is_placed = |joint: usize| rig.joints[joint].parent.is_none_or(|p| place[p].is_some());
        let free: Vec<usize> = (0..rig.joints.len())
            .filter(|&joint| place[joint].is_none() && parent_is_placed(joint))
            .collect();
        place[free[random.index(free.len())]] = Some(new);
    }
    let place: Vec<usize> = place.into_iter().map(|new| new.expect("every joint has a position")).collect();
    let mut other = rig.clone();
    for (old, &new) in place.iter().enumerate() {
        other.joints[new] = rig.joints[old].clone();
        other.joints[new].parent = rig.joints[old].parent.map(|parent| place[parent]);
    }
    for joint in other.skins.iter_mut().flat_map(|skin| &mut skin.joints) {
        *joint = place[*joint];
    }
    for mesh in &mut other.meshes {
        mesh.joint = place[mesh.joint];
    }
    for (_, joint) in &mut other.stated_roles {
        *joint = place[*joint];
    }
    (other, place)
}

pub fn z_up() -> Rotation {
    Rotation::from_axis_angle(Vec3::X, core::f32::consts::FRAC_PI_2)
}

pub fn nameless(rig: &Rig) -> Rig {
    let mut rig = rig.clone();
    for joint in &mut rig.joints {
        joint.name.clear();
    }
    rig
}

/// Gives joints names without meaning, or with a wrong one.
pub fn misnamed(rig: &Rig) -> Rig {
    let mut rig = rig.clone();
    let count = rig.joints.len();
    for (i, joint) in rig.joints.iter_mut().enumerate() {
        joint.name = format!("node{}", (i * 7 + 3) % count);
    }
    rig
}

/// A naming convention for the joints of a human: hips, spine, chest, upper chest, neck, head; then shoulder, upper arm, lower arm, hand,
/// upper leg, lower leg, foot, toes, with `[a|b]` for left and right.
pub struct Convention {
    trunk: [&'static str; 6],
    limbs: [&'static str; 8],
}

pub const CONVENTIONS: [Convention; 15] = [
    // Mixamo.
    Convention {
        trunk: [
            "mixamorig:Hips",
            "mixamorig:Spine",
            "mixamorig:Spine1",
            "mixamorig:Spine2",
            "mixamorig:Neck",
            "mixamorig:Head",
        ],
        limbs: [
            "mixamorig:[Left|Right]Shoulder",
            "mixamorig:[Left|Right]Arm",
            "mixamorig:[Left|Right]ForeArm",
            "mixamorig:[Left|Right]Hand",
            "mixamorig:[Left|Right]UpLeg",
            "mixamorig:[Left|Right]Leg",
            "mixamorig:[Left|Right]Foot",
            "mixamorig:[Left|Right]ToeBase",
        ],
    },
    // Mixamo with its colon stripped.
    Convention {
        trunk: [
            "mixamorigHips",
            "mixamorigSpine",
            "mixamorigSpine1",
            "mixamorigSpine2",
            "mixamorigNeck",
            "mixamorigHead",
        ],
        limbs: [
            "mixamorig[Left|Right]Shoulder",
            "mixamorig[Left|Right]Arm",
            "mixamorig[Left|Right]ForeArm",
            "mixamorig[Left|Right]Hand",
            "mixamorig[Left|Right]UpLeg",
            "mixamorig[Left|Right]Leg",
            "mixamorig[Left|Right]Foot",
            "mixamorig[Left|Right]ToeBase",
        ],
    },
    // 3ds Max Biped.
    Convention {
        trunk: ["Bip01 Pelvis", "Bip01 Spine", "Bip01 Spine1", "Bip01 Spine2", "Bip01 Neck", "Bip01 Head"],
        limbs: [
            "Bip01 [L|R] Clavicle",
            "Bip01 [L|R] UpperArm",
            "Bip01 [L|R] Forearm",
            "Bip01 [L|R] Hand",
            "Bip01 [L|R] Thigh",
            "Bip01 [L|R] Calf",
            "Bip01 [L|R] Foot",
            "Bip01 [L|R] Toe0",
        ],
    },
    // Source.
    Convention {
        trunk: [
            "ValveBiped.Bip01_Pelvis",
            "ValveBiped.Bip01_Spine",
            "ValveBiped.Bip01_Spine1",
            "ValveBiped.Bip01_Spine4",
            "ValveBiped.Bip01_Neck1",
            "ValveBiped.Bip01_Head1",
        ],
        limbs: [
            "ValveBiped.Bip01_[L|R]_Clavicle",
            "ValveBiped.Bip01_[L|R]_UpperArm",
            "ValveBiped.Bip01_[L|R]_Forearm",
            "ValveBiped.Bip01_[L|R]_Hand",
            "ValveBiped.Bip01_[L|R]_Thigh",
            "ValveBiped.Bip01_[L|R]_Calf",
            "ValveBiped.Bip01_[L|R]_Foot",
            "ValveBiped.Bip01_[L|R]_Toe0",
        ],
    },
    // Character Creator.
    Convention {
        trunk: [
            "CC_Base_Hip",
            "CC_Base_Waist",
            "CC_Base_Spine01",
            "CC_Base_Spine02",
            "CC_Base_NeckTwist01",
            "CC_Base_Head",
        ],
        limbs: [
            "CC_Base_[L|R]_Clavicle",
            "CC_Base_[L|R]_Upperarm",
            "CC_Base_[L|R]_Forearm",
            "CC_Base_[L|R]_Hand",
            "CC_Base_[L|R]_Thigh",
            "CC_Base_[L|R]_Calf",
            "CC_Base_[L|R]_Foot",
            "CC_Base_[L|R]_ToeBase",
        ],
    },
    // VRoid.
    Convention {
        trunk: [
            "J_Bip_C_Hips",
            "J_Bip_C_Spine",
            "J_Bip_C_Chest",
            "J_Bip_C_UpperChest",
            "J_Bip_C_Neck",
            "J_Bip_C_Head",
        ],
        limbs: [
            "J_Bip_[L|R]_Shoulder",
            "J_Bip_[L|R]_UpperArm",
            "J_Bip_[L|R]_LowerArm",
            "J_Bip_[L|R]_Hand",
            "J_Bip_[L|R]_UpperLeg",
            "J_Bip_[L|R]_LowerLeg",
            "J_Bip_[L|R]_Foot",
            "J_Bip_[L|R]_ToeBase",
        ],
    },
    // Unreal.
    Convention {
        trunk: ["pelvis", "spine_01", "spine_02", "spine_03", "neck_01", "head"],
        limbs: [
            "clavicle_[l|r]",
            "upperarm_[l|r]",
            "lowerarm_[l|r]",
            "hand_[l|r]",
            "thigh_[l|r]",
            "calf_[l|r]",
            "foot_[l|r]",
            "ball_[l|r]",
        ],
    },
    // Rigify.
    Convention {
        trunk: ["DEF-spine", "DEF-spine.001", "DEF-spine.002", "DEF-spine.003", "DEF-neck", "DEF-head"],
        limbs: [
            "DEF-shoulder.[L|R]",
            "DEF-upper_arm.[L|R]",
            "DEF-forearm.[L|R]",
            "DEF-hand.[L|R]",
            "DEF-thigh.[L|R]",
            "DEF-shin.[L|R]",
            "DEF-foot.[L|R]",
            "DEF-toe.[L|R]",
        ],
    },
    // HumanIK.
    Convention {
        trunk: [
            "Character1_Hips",
            "Character1_Spine",
            "Character1_Spine1",
            "Character1_Spine2",
            "Character1_Neck",
            "Character1_Head",
        ],
        limbs: [
            "Character1_[Left|Right]Shoulder",
            "Character1_[Left|Right]Arm",
            "Character1_[Left|Right]ForeArm",
            "Character1_[Left|Right]Hand",
            "Character1_[Left|Right]UpLeg",
            "Character1_[Left|Right]Leg",
            "Character1_[Left|Right]Foot",
            "Character1_[Left|Right]ToeBase",
        ],
    },
    // MikuMikuDance.
    Convention {
        trunk: ["腰", "上半身", "上半身2", "上半身3", "首", "頭"],
        limbs: [
            "[左|右]肩",
            "[左|右]腕",
            "[左|右]ひじ",
            "[左|右]手首",
            "[左|右]足",
            "[左|右]ひざ",
            "[左|右]足首",
            "[左|右]つま先",
        ],
    },
    // French.
    Convention {
        trunk: ["Bassin", "Colonne", "Colonne1", "Colonne2", "Cou", "Tete"],
        limbs: [
            "Epaule_[G|D]",
            "Bras_[G|D]",
            "AvantBras_[G|D]",
            "Main_[G|D]",
            "Cuisse_[G|D]",
            "Mollet_[G|D]",
            "Pied_[G|D]",
            "Orteils_[G|D]",
        ],
    },
    // German.
    Convention {
        trunk: ["Becken", "Wirbel1", "Wirbel2", "Brust", "Hals", "Kopf"],
        limbs: [
            "Schulter_[links|rechts]",
            "Oberarm_[links|rechts]",
            "Unterarm_[links|rechts]",
            "Hand_[links|rechts]",
            "Oberschenkel_[links|rechts]",
            "Unterschenkel_[links|rechts]",
            "Fuss_[links|rechts]",
            "Zehen_[links|rechts]",
        ],
    },
    // Spanish.
    Convention {
        trunk: ["Pelvis", "Columna", "Columna1", "Pecho", "Cuello", "Cabeza"],
        limbs: [
            "Hombro_[izq|der]",
            "Brazo_[izq|der]",
            "Antebrazo_[izq|der]",
            "Mano_[izq|der]",
            "Muslo_[izq|der]",
            "Pantorrilla_[izq|der]",
            "Pie_[izq|der]",
            "Dedos_[izq|der]",
        ],
    },
    // Italian.
    Convention {
        trunk: ["Bacino", "Schiena", "Torso", "Petto", "Collo", "Testa"],
        limbs: [
            "Spalla.[sx|dx]",
            "Braccio.[sx|dx]",
            "Avambraccio.[sx|dx]",
            "Mano.[sx|dx]",
            "Coscia.[sx|dx]",
            "Polpaccio.[sx|dx]",
            "Piede.[sx|dx]",
            "Dita.[sx|dx]",
        ],
    },
    // Japanese, in Latin letters.
    Convention {
        trunk: ["koshibone", "koshi", "hara", "mune", "kubi", "atama"],
        limbs: [
            "kata.[L|R]",
            "ude.[L|R]",
            "hiji.[L|R]",
            "tekubi.[L|R]",
            "momo.[L|R]",
            "hiza.[L|R]",
            "ashikubi.[L|R]",
            "tsumasaki.[L|R]",
        ],
    },
];

impl Convention {
    fn name(&self, role: Role) -> Option<String> {
        let trunk = [Role::Hips, Role::Spine, Role::Chest, Role::UpperChest, Role::Neck, Role::Head];
        if let Some(place) = trunk.iter().position(|&part| part == role) {
            return Some(self.trunk[place].to_owned());
        }
        let side = role.side()?;
        let limbs = [
            Role::Shoulder(side),
            Role::UpperArm(side),
            Role::LowerArm(side),
            Role::Hand(side),
            Role::UpperLeg(side),
            Role::LowerLeg(side),
            Role::Foot(side),
            Role::Toes(side),
        ];
        let pattern = self.limbs[limbs.iter().position(|&part| part == role)?];
        let (before, rest) = pattern.split_once('[')?;
        let (choice, after) = rest.split_once(']')?;
        let (left, right) = choice.split_once('|')?;
        Some(format!("{before}{}{after}", if side == Side::Left { left } else { right }))
    }
}

/// Renames joints with a human role by a convention; other names stay.
pub fn renamed(rig: &Rig, analysis: &RigAnalysis, convention: &Convention) -> Rig {
    let mut rig = rig.clone();
    for (joint, guess) in rig.joints.iter_mut().zip(&analysis.roles) {
        if let Some(name) = guess.as_ref().and_then(|guess| convention.name(guess.role)) {
            joint.name = name;
        }
    }
    rig
}

/// Adds a prefix and a suffix to every name.
pub fn affixed(rig: &Rig, prefix: &str, suffix: &str) -> Rig {
    let mut rig = rig.clone();
    for joint in &mut rig.joints {
        joint.name = format!("{prefix}{}{suffix}", joint.name);
    }
    rig
}

/// Binds meshes in another unit than the joints, as in exports through FBX, or mirrored by a negative unit; the skin is
/// drawn at the same position.
pub fn bound_in(rig: &Rig, unit: f32) -> Rig {
    let mut rig = rig.clone();
    let joints_from_mesh =
        Affine::from_scale_rotation_translation(Vec3::splat(unit), Rotation::IDENTITY, Vec3::ZERO);
    for inverse in rig.skins.iter_mut().flat_map(|skin| &mut skin.inverse_bind) {
        *inverse = *inverse * joints_from_mesh;
    }
    for mesh in rig.meshes.iter_mut().filter(|mesh| mesh.skin.is_some()) {
        for position in mesh.primitives.iter_mut().flat_map(|primitive| &mut primitive.positions) {
            *position /= unit;
        }
    }
    rig
}

/// Adds a new first joint of negative scale above all roots, and adjusts the roots so that the drawing is unchanged.
pub fn under_a_mirror(rig: &Rig) -> Rig {
    let mut rig = rig.clone();
    let mirror = Vec3::new(-1.0, 1.0, 1.0);
    for joint in &mut rig.joints {
        if joint.parent.is_none() {
            // A mirrored rotation is negated about the two axes in the mirror's plane.
            let [x, y, z, w] =
                [joint.rest.rotation.x, joint.rest.rotation.y, joint.rest.rotation.z, joint.rest.rotation.w];
            joint.rest.rotation = Rotation::from_xyzw(x, -y, -z, w);
            joint.rest.translation *= mirror;
            joint.rest.scale *= mirror;
        }
        joint.parent = Some(joint.parent.map_or(0, |parent| parent + 1));
    }
    let rest = LocalTransform { scale: mirror, ..LocalTransform::default() };
    rig.joints.insert(0, Joint { name: "mirror".into(), parent: None, rest, source: rig.joints.len() });
    for joint in rig.skins.iter_mut().flat_map(|skin| &mut skin.joints) {
        *joint += 1;
    }
    for mesh in &mut rig.meshes {
        mesh.joint += 1;
    }
    for (_, joint) in &mut rig.stated_roles {
        *joint += 1;
    }
    rig
}

/// Splits every skinned mesh in two, the second with its own skin, bound in another unit.
pub fn with_two_skins(rig: &Rig, unit: f32) -> Rig {
    let mut rig = rig.clone();
    let other = bound_in(&rig, unit);
    let skins = rig.skins.len();
    rig.skins.extend(other.skins);
    let keep = |mesh: &mut RigMesh, second: bool| {
        for primitive in &mut mesh.primitives {
            let half = primitive.indices.len() / 6 * 3;
            let rest = primitive.indices.split_off(half);
            if second {
                primitive.indices = rest;
            }
        }
    };
    let mut added = Vec::new();
    for (mesh, mut twin) in rig.meshes.iter_mut().zip(other.meshes) {
        if let Some(skin) = mesh.skin {
            twin.skin = Some(skins + skin);
            keep(mesh, false);
            keep(&mut twin, true);
            added.push(twin);
        }
    }
    rig.meshes.extend(added);
    rig
}

fn rest_models(rig: &Rig) -> Vec<Affine> {
    let mut model: Vec<Affine> = Vec::new();
    sinew_anim::local_to_model(rig, &sinew_anim::rest_pose(rig), &Affine::IDENTITY, &mut model);
    model
}

/// Returns a transform of uniform scale, split into translation, rotation, scale.
fn parts(transform: &Affine) -> LocalTransform {
    let Transform { translation, rotation } = transform.to_rigid();
    LocalTransform { translation, rotation, scale: Vec3::splat(transform.linear.x_axis.length()) }
}

/// Returns the joint that is an ancestor of all others, if there is one.
fn top(rig: &Rig) -> Option<JointIdx> {
    let mut roots = (0..rig.joints.len()).filter(|&joint| rig.joints[joint].parent.is_none());
    roots.next().filter(|_| roots.next().is_none())
}

/// Reparents joints to the root without moving them, like the feet of a rig for inverse kinematics.
pub fn parented_to_root(rig: &Rig, joints: &[JointIdx]) -> Rig {
    let model = rest_models(rig);
    let root = top(rig);
    let mut rig = rig.clone();
    for &joint in joints {
        let parent = root.map_or(Affine::IDENTITY, |root| model[root]);
        rig.joints[joint].parent = root;
        rig.joints[joint].rest = parts(&(parent.inverse() * model[joint]));
    }
    rig
}

/// Makes joints roots of their own without moving them, as in exports of deform bones alone.
pub fn made_roots(rig: &Rig, joints: &[JointIdx]) -> Rig {
    let model = rest_models(rig);
    let mut rig = rig.clone();
    for &joint in joints {
        rig.joints[joint].parent = None;
        rig.joints[joint].rest = parts(&model[joint]);
    }
    rig
}

/// Adds a hat with its own skeleton: one root bone that moves a small mesh at the crown.
pub fn with_hat(rig: &Rig, analysis: &RigAnalysis, head: JointIdx) -> Rig {
    let mut rig = rig.clone();
    let size = analysis.height / analysis.unit_scale;
    let place = analysis.bind_model[head].translation + analysis.up_axis * (0.06 * size);
    let bone = add_joint(&mut rig, "Bone", None, place);
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|corner| place + corner * (0.01 * size));
    rig.skins.push(Skin {
        name: "hat".into(),
        joints: vec![bone],
        inverse_bind: vec![Affine { translation: -place, ..Affine::IDENTITY }],
    });
    let primitive = Primitive {
        positions: corners.to_vec(),
        joints: vec![[0; 4]; 4],
        weights: vec![[1.0, 0.0, 0.0, 0.0]; 4],
        indices: vec![0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2],
        ..Primitive::default()
    };
    let skin = Some(rig.skins.len() - 1);
    rig.meshes.push(RigMesh { name: "hat".into(), joint: bone, skin, primitives: vec![primitive] });
    rig
}

/// Adds a joint at `place` (model space) to the end of the rig.
fn add_joint(rig: &mut Rig, name: &str, parent: Option<JointIdx>, place: Vec3) -> JointIdx {
    let on = parent.map_or(Affine::IDENTITY, |parent| rest_models(rig)[parent]);
    let rest = LocalTransform { translation: on.inverse().point(place), ..LocalTransform::default() };
    rig.joints.push(Joint { name: name.into(), parent, rest, source: rig.joints.len() });
    rig.joints.len() - 1
}

/// Returns a mesh and a skin slot by which the mesh moves with a joint.
fn skinned_by(rig: &Rig, joint: JointIdx) -> Option<(usize, usize)> {
    rig.meshes.iter().enumerate().find_map(|(m, mesh)| {
        let slot = rig.skins[mesh.skin?].joints.iter().position(|&other| other == joint)?;
        mesh.primitives.iter().any(|primitive| !primitive.joints.is_empty()).then_some((m, slot))
    })
}

/// Adds a slot for a joint, bound next to `slot`'s joint at `offset` in that joint's space.
fn add_slot(rig: &mut Rig, mesh: usize, slot: usize, joint: JointIdx, offset: Vec3) -> u16 {
    let skin = &mut rig.skins[rig.meshes[mesh].skin.expect("a skinned mesh")];
    let moved = Affine { translation: -offset, ..Affine::IDENTITY };
    skin.joints.push(joint);
    skin.inverse_bind.push(moved * skin.inverse_bind[slot]);
    u16::try_from(skin.joints.len() - 1).expect("the count fits")
}

/// Adds a strand of hair to a joint, three joints long, with a little skin.
pub fn with_hair(rig: &Rig, analysis: &RigAnalysis, head: JointIdx, random: &mut Random) -> Rig {
    let Some((mesh, slot)) = skinned_by(rig, head) else { return rig.clone() };
    let mut rig = rig.clone();
    let size = analysis.height / analysis.unit_scale;
    let way = (analysis.up_axis + random.in_cube() * 0.8).normalize() * (0.02 * size);
    let head_from_mesh = rig.skins[rig.meshes[mesh].skin.expect("the rig is skinned")].inverse_bind[slot];
    let head_from_model = analysis.bind_model[head].inverse();
    let (mesh_from_head, step) = (head_from_mesh.inverse(), head_from_model.vector(way));
    let (mut parent, mut skin) = (head, Primitive::default());
    for part in 1..=3 {
        let rest = LocalTransform { translation: step, ..LocalTransform::default() };
        rig.joints.push(Joint {
            name: format!("hair_0{part}"),
            parent: Some(parent),
            rest,
            source: rig.joints.len(),
        });
        parent = rig.joints.len() - 1;
        let slot = add_slot(&mut rig, mesh, slot, parent, step * part as f32);
        let first = u32::try_from(skin.positions.len()).expect("the count fits");
        let side = step.cross(Vec3::new(0.3, 0.5, 0.8)).normalize() * (0.1 * step.length());
        for (along, across) in [(0.0, 1.0), (0.0, -1.0), (1.0, 0.0)] {
            let at = step * (part as f32 + along) + side * across;
            skin.positions.push(mesh_from_head.point(at));
            skin.joints.push([slot, 0, 0, 0]);
            skin.weights.push([1.0, 0.0, 0.0, 0.0]);
        }
        skin.indices.extend([0, 1, 2, 2, 1, 0].map(|corner| first + corner));
    }
    rig.meshes[mesh].primitives.push(skin);
    rig
}

/// Adds controls, targets and poles without skin; some of them are in the skin's list of joints.
pub fn with_controls(rig: &Rig, analysis: &RigAnalysis, random: &mut Random) -> Rig {
    let mut rig = rig.clone();
    let model = rest_models(&rig);
    let root = top(&rig);
    let size = analysis.height / analysis.unit_scale;
    let root = Some(add_joint(&mut rig, "CTRL_master", root, Vec3::ZERO));
    let ends: Vec<JointIdx> = analysis.kept.iter().map(|bone| bone.joint).collect();
    for number in 0..6 {
        let near = ends[random.index(ends.len())];
        let (name, away) = [("IK_Target", 0.0), ("PoleTarget", 0.3), ("Control", 0.02)][number % 3];
        let place = model[near].translation + random.in_cube() * (away * size);
        let side = [".L", ".R"][number / 3];
        let joint = add_joint(&mut rig, &format!("{name}{side}"), root, place);
        if let Some((mesh, slot)) = skinned_by(&rig, near).filter(|_| random.unit() < 0.5) {
            add_slot(&mut rig, mesh, slot, joint, Vec3::ZERO);
        }
    }
    rig
}

/// Adds twist bones that move half of the skin of forearms and shanks.
pub fn with_twists(rig: &Rig, analysis: &RigAnalysis) -> Rig {
    let mut rig = rig.clone();
    for side in [Side::Left, Side::Right] {
        for (role, next) in
            [(Role::LowerArm(side), Role::Hand(side)), (Role::LowerLeg(side), Role::Foot(side))]
        {
            let (Some(joint), Some(next)) = (analysis.joint_with(role), analysis.joint_with(next)) else {
                continue;
            };
            let Some((mesh, slot)) = skinned_by(&rig, joint) else { continue };
            let place = |joint: JointIdx| analysis.bind_model[joint].translation;
            let offset = analysis.bind_model[joint].inverse().point((place(joint) + place(next)) * 0.5);
            let rest = LocalTransform { translation: offset, ..LocalTransform::default() };
            let name = format!("{}_twist", rig.joints[joint].name);
            rig.joints.push(Joint { name, parent: Some(joint), rest, source: rig.joints.len() });
            let twist = rig.joints.len() - 1;
            let twist = add_slot(&mut rig, mesh, slot, twist, offset);
            let joint_from_mesh =
                rig.skins[rig.meshes[mesh].skin.expect("the rig is skinned")].inverse_bind[slot];
            give_far_half(&mut rig.meshes[mesh], &joint_from_mesh, offset, slot, twist);
        }
    }
    rig
}

/// Moves the weights of a slot beyond `middle` (in its joint's space) to another slot.
fn give_far_half(mesh: &mut RigMesh, joint_from_mesh: &Affine, middle: Vec3, slot: usize, to: u16) {
    for primitive in mesh.primitives.iter_mut().filter(|primitive| !primitive.joints.is_empty()) {
        for (position, slots) in primitive.positions.iter().zip(&mut primitive.joints) {
            let beyond = (joint_from_mesh.point(*position) - middle).dot(middle) > 0.0;
            for other in slots.iter_mut().filter(|other| beyond && usize::from(**other) == slot) {
                *other = to;
            }
        }
    }
}

/// Moves the skin of bones at the beginning of a limb to their parents.
pub fn unweighted(rig: &Rig, bones: &[(JointIdx, JointIdx)]) -> Rig {
    let mut rig = rig.clone();
    for (mesh, skin) in rig.meshes.iter_mut().filter_map(|mesh| mesh.skin.map(|skin| (mesh, skin))) {
        let joints = &rig.skins[skin].joints;
        let slot = |joint: JointIdx| joints.iter().position(|&other| other == joint);
        for &(bone, carrier) in bones {
            let (Some(from), Some(to)) = (slot(bone), slot(carrier)) else { continue };
            let to = u16::try_from(to).expect("the count fits");
            for slots in mesh.primitives.iter_mut().flat_map(|primitive| &mut primitive.joints) {
                slots.iter_mut().filter(|slot| usize::from(**slot) == from).for_each(|slot| *slot = to);
            }
        }
    }
    rig
}

/// Adds eyes with their own skeleton: one root bone that moves two small meshes in front of the face.
pub fn with_eyes(rig: &Rig, analysis: &RigAnalysis, head: JointIdx) -> Rig {
    let mut rig = rig.clone();
    let size = analysis.height / analysis.unit_scale;
    let to_model = analysis.character_from_model.inverse();
    let place = analysis.bind_model[head].translation + analysis.up_axis * (0.04 * size);
    let bone = add_joint(&mut rig, "EyeBone", None, place);
    let mut primitive = Primitive::default();
    for side in [-0.015, 0.015] {
        let eye = place + to_model.rotation * (Vec3::new(side, 0.0, 0.03) * size);
        let first = u32::try_from(primitive.positions.len()).expect("the count fits");
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|corner| eye + corner * (0.004 * size));
        primitive.positions.extend(corners);
        primitive.joints.extend([[0; 4]; 4]);
        primitive.weights.extend([[1.0, 0.0, 0.0, 0.0]; 4]);
        primitive.indices.extend([0, 1, 2, 0, 2, 3, 0, 3, 1, 1, 3, 2].map(|corner| first + corner));
    }
    rig.skins.push(Skin {
        name: "eyes".into(),
        joints: vec![bone],
        inverse_bind: vec![Affine { translation: -place, ..Affine::IDENTITY }],
    });
    let skin = Some(rig.skins.len() - 1);
    rig.meshes.push(RigMesh { name: "eyes".into(), joint: bone, skin, primitives: vec![primitive] });
    rig
}

/// Moves half of the skin of a joint to a new bone at the same position, with the same parent, like the halves of a
/// pelvis or a breast.
pub fn with_halves(rig: &Rig, joint: JointIdx, name: &str) -> Rig {
    let Some((mesh, slot)) = skinned_by(rig, joint) else { return rig.clone() };
    let mut rig = rig.clone();
    let twin = Joint { name: name.into(), source: rig.joints.len(), ..rig.joints[joint].clone() };
    rig.joints.push(Joint { parent: Some(joint), rest: LocalTransform::default(), ..twin });
    let half = rig.joints.len() - 1;
    let half = add_slot(&mut rig, mesh, slot, half, Vec3::ZERO);
    for primitive in &mut rig.meshes[mesh].primitives {
        for slots in primitive.joints.iter_mut().step_by(2) {
            slots.iter_mut().filter(|other| usize::from(**other) == slot).for_each(|other| *other = half);
        }
    }
    rig
}

/// Shifts the root motion of clips, as in captures cut out of a longer one.
pub fn shifted(clips: &[Clip], rig: &Rig, by: Vec3) -> Vec<Clip> {
    let mut clips = clips.to_vec();
    for channel in clips.iter_mut().flat_map(|clip| &mut clip.channels) {
        let is_root =
            rig.joints[channel.joint].parent.is_none_or(|parent| rig.joints[parent].parent.is_none());
        if channel.property == Property::Translation
            && is_root
            && channel.interpolation != Interpolation::CubicSpline
        {
            for key in channel.values.chunks_exact_mut(3) {
                key.iter_mut().zip(by.to_array()).for_each(|(value, by)| *value += by);
            }
        }
    }
    clips
}
