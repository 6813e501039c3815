//! Rigs from other sources: the reader agrees with the manifest beside them.

use crate::data::{GLTF, files, shared_data};
use needs_data::needs_data;
use sinew_anim::{Interpolation, Primitive};
use sinew_formats::{Document, ReadOptions, Textures, load_gltf};
use sinew_math::{Affine, Vec3};

fn load(name: &str) -> Document {
    let path = shared_data().join("rigs").join(name);
    load_gltf(path, ReadOptions { textures: Textures::Decode }).unwrap()
}

/// Compares skin joints, vertices, triangles, clips and duration of the first clip with the manifest of the
/// data.
fn check(name: &str, skin_joints: usize, vertices: usize, triangles: usize, clips: usize, duration: f32) {
    let document = load(name);
    let rig = &document.rig;
    let primitives = || rig.meshes.iter().flat_map(|m| &m.primitives);
    let found = (
        rig.skins.iter().map(|s| s.joints.len()).max().unwrap_or(0),
        primitives().map(|p| p.positions.len()).sum(),
        primitives().map(|p| p.indices.len() / 3).sum(),
        document.clips.len(),
    );
    assert_eq!(found, (skin_joints, vertices, triangles, clips), "{name}");
    let first = document.clips.first().map_or(0.0, |c| c.duration);
    assert!((first - duration).abs() < 0.006, "{name}: {first}");
}

#[needs_data]
#[test]
fn counts_match_the_manifest() {
    check("CesiumMan.glb", 19, 3273, 4672, 1, 2.0);
    check("RiggedFigure.glb", 19, 370, 256, 1, 1.25);
    check("RiggedSimple.glb", 2, 96, 188, 1, 2.08);
    check("kaykit_Knight.glb", 41, 7024, 6952, 76, 1.07);
    check("kaykit_mannequin/manny_med_mod.gltf", 21, 6578, 6756, 0, 0.0);
    check("kaykit_mannequin/Med_Simulation.glb", 23, 0, 0, 14, 1.7);
    check("quaternius_cyberpunk_Character.glb", 25, 7778, 7520, 22, 1.04);
    check("quaternius_Robot.glb", 43, 7218, 3238, 14, 3.33);
}

/// Checks the promises in the documentation of [`Rig`] and [`Clip`](sinew_anim::Clip).
pub fn assert_sound(document: &Document) {
    let rig = &document.rig;
    for (i, joint) in rig.joints.iter().enumerate() {
        assert!(joint.parent.is_none_or(|p| p < i));
        assert!(joint.rest.translation.is_finite() && joint.rest.scale.is_finite());
        assert!((joint.rest.rotation.dot(joint.rest.rotation) - 1.0).abs() < 1e-5);
    }
    for skin in &rig.skins {
        assert_eq!(skin.joints.len(), skin.inverse_bind.len());
        assert!(skin.joints.iter().all(|&j| j < rig.joints.len()));
        assert!(skin.inverse_bind.iter().all(sinew_math::Affine::is_finite));
    }
    for mesh in &rig.meshes {
        assert!(mesh.joint < rig.joints.len());
        let slots = mesh.skin.map(|s| rig.skins[s].joints.len());
        mesh.primitives.iter().for_each(|p| assert_sound_primitive(p, slots, rig.textures.len()));
    }
    assert!(rig.textures.iter().all(|t| t.rgba.len() == (t.width * t.height * 4) as usize));
    assert!(rig.stated_roles.iter().all(|(_, joint)| *joint < rig.joints.len()));
    for channel in document.clips.iter().flat_map(|c| &c.channels) {
        let per_key = if channel.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        assert!(channel.joint < rig.joints.len() && !channel.times.is_empty());
        assert!(channel.times.windows(2).all(|w| w[0] < w[1]));
        assert_eq!(channel.values.len(), channel.times.len() * per_key * channel.property.width());
        assert!(channel.times.iter().chain(&channel.values).all(|x| x.is_finite()));
    }
}

fn assert_sound_primitive(part: &Primitive, slots: Option<usize>, textures: usize) {
    let count = part.positions.len();
    let fits = |n: usize| n == count || n == 0;
    assert!(fits(part.normals.len()) && fits(part.uvs.len()) && fits(part.colors.len()));
    assert!(part.positions.iter().all(|p| p.is_finite()));
    assert!(part.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4));
    assert!(part.indices.len().is_multiple_of(3) && part.indices.iter().all(|&i| (i as usize) < count));
    assert!(part.texture.is_none_or(|t| t < textures));
    let expected = if slots.is_some() { count } else { 0 };
    assert_eq!((part.joints.len(), part.weights.len()), (expected, expected));
    for (joints, weights) in part.joints.iter().zip(&part.weights) {
        assert!(joints.iter().all(|&j| usize::from(j) < slots.unwrap()));
        assert!(weights.iter().all(|&w| w >= 0.0) && (weights.iter().sum::<f32>() - 1.0).abs() < 1e-5);
    }
}

#[needs_data]
#[test]
fn every_rig_satisfies_the_invariants_of_its_types() {
    let data = shared_data();
    for path in files(&data.join("rigs"), &GLTF) {
        let document = load_gltf(&path, ReadOptions { textures: Textures::Decode });
        let document = document.unwrap_or_else(|e| panic!("{e}"));
        assert_sound(&document);
        assert_eq!(document.warnings, [""; 0], "{}", path.display());
    }
}

/// In the rest pose a skinned mesh is in the file's bind pose: rest × inverse bind is the identity, up to the
/// placement of the armature, for rigs in which both poses agree according to the manifest.
#[needs_data]
#[test]
fn inverse_bind_matrices_invert_the_rest_pose() {
    for name in
        ["CesiumMan.glb", "RiggedFigure.glb", "kaykit_Knight.glb", "mannequiny.glb", "quaternius_Robot.glb"]
    {
        let document = load(name);
        let rig = &document.rig;
        let mut model: Vec<Affine> = Vec::new();
        for joint in &rig.joints {
            let local = joint.rest.to_affine();
            model.push(joint.parent.map_or(local, |p| model[p] * local));
        }
        let skin = &rig.skins[0];
        let place = |slot: usize| model[skin.joints[slot]] * skin.inverse_bind[slot];
        for slot in 1..skin.joints.len() {
            for point in [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z] {
                let gap = place(slot).point(point).distance(place(0).point(point));
                assert!(gap < 2e-3, "{name} slot {slot}: gap {gap}");
            }
        }
    }
}

#[needs_data]
#[test]
fn vrm_roles_have_the_names_of_vrm_1() {
    let document = load("CoolLoops_mixamorig_vrm0.vrm");
    let rig = &document.rig;
    let joint = |role: &str| {
        let stated = rig.stated_roles.iter().find(|(name, _)| name == role);
        rig.joints[stated.unwrap_or_else(|| panic!("{role}")).1].name.as_str()
    };
    assert_eq!(joint("hips"), "mixamorig:Hips");
    assert_eq!(joint("leftThumbMetacarpal"), "mixamorig:LeftHandThumb1");
    assert_eq!(joint("leftThumbProximal"), "mixamorig:LeftHandThumb2");
    assert_eq!(joint("rightThumbDistal"), "mixamorig:RightHandThumb3");
    assert_eq!(joint("rightLowerLeg"), "mixamorig:RightLeg");

    let document = load("vrm1_unskinned_humanoid.vrm");
    assert!(
        document
            .rig
            .stated_roles
            .iter()
            .any(|(role, joint)| { role == "hips" && document.rig.joints[*joint].source == 21 })
    );
}
