//! Rigs of the shared test data.

use sinew_anim::{Clip, Rig};

pub const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/");

/// All rig files that contain clips.
pub const WITH_CLIPS: [&str; 16] = [
    "CesiumMan.glb",
    "Fox.glb",
    "RecursiveSkeletons.glb",
    "RiggedFigure.glb",
    "RiggedSimple.glb",
    "SimpleSkin.gltf",
    "kaykit_Knight.glb",
    "kaykit_mannequin/Med_MovementBasic.glb",
    "kaykit_mannequin/Med_Simulation.glb",
    "mannequiny.glb",
    "mesh2motion_human_rigify.glb",
    "quaternius_MandarinFish.glb",
    "quaternius_Robot.glb",
    "quaternius_Spider.glb",
    "quaternius_cyberpunk_Character.glb",
    "vrma_test.vrma",
];

/// Returns the bytes of a shared file, for tests with `needs_data`.
pub fn bytes(path: &str) -> Vec<u8> {
    std::fs::read(format!("{DATA}{path}")).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Returns rig and clips of a shared file, for tests with `needs_data`.
pub fn load(path: &str) -> (Rig, Vec<Clip>) {
    let document = sinew_formats::load_gltf(format!("{DATA}{path}"), sinew_formats::ReadOptions::default());
    let document = document.unwrap_or_else(|error| panic!("{path}: {error}"));
    (document.rig, document.clips)
}
