//! Rigs that nobody here drew: what the manifest beside them says is what is read.

use crate::data::{GLTF, files, shared_data};
use sinew_formats::{Document, ReadOptions, Textures, load_gltf};

fn load(name: &str) -> Option<Document> {
    let path = shared_data()?.join("rigs").join(name);
    Some(load_gltf(path, ReadOptions { textures: Textures::Decode }).unwrap())
}

/// (skin joints, vertices, triangles, clips, duration of the first clip) as the manifest of the data states them.
fn check(name: &str, skin_joints: usize, vertices: usize, triangles: usize, clips: usize, duration: f32) {
    let Some(document) = load(name) else { return };
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

#[test]
fn every_rig_keeps_the_promises_of_its_types() {
    let Some(data) = shared_data() else { return };
    for path in files(&data.join("rigs"), &GLTF) {
        let document =
            load_gltf(&path, ReadOptions { textures: Textures::Decode }).unwrap_or_else(|e| panic!("{e}"));
        let rig = &document.rig;
        println!(
            "{}: {} joints, {} skins, {} meshes, {} textures, {} clips, roles {}, {:?}",
            path.display(),
            rig.joints.len(),
            rig.skins.len(),
            rig.meshes.len(),
            rig.textures.len(),
            document.clips.len(),
            rig.stated_roles.len(),
            document.warnings
        );
    }
}
