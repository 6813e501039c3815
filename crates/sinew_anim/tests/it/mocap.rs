//! Captured motions of ../shared/data and their characters.

use sinew_anim::retarget::{Reference, stand};
use sinew_anim::{Clip, Rig, RigAnalysis, analyze};
use sinew_formats::bvh::{BvhDocument, BvhOptions, read_bvh};
use sinew_formats::{read_deepmimic, read_deepmimic_character};

/// A captured actor: rig, clip, analysis.
pub struct Actor {
    pub rig: Rig,
    pub clip: Clip,
    pub analysis: RigAnalysis,
    pub reference: Reference,
}

/// Reads a BVH file under ../shared/data/mocap, for tests with `needs_data`.
pub fn actor(name: &str) -> Actor {
    let bytes = crate::rigs::bytes(&format!("mocap/{name}"));
    let document = read_bvh(&bytes, BvhOptions::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
    let BvhDocument { rig, clip, rest_pose, .. } = document;
    let (analysis, reference) = stand(&rig, &clip, rest_pose.as_deref()).expect("bones");
    Actor { rig, clip, analysis, reference }
}

/// Reads a DeepMimic clip under ../shared/data/mocap, for tests with `needs_data`.
pub fn imitation(name: &str) -> Actor {
    let skeleton = read_deepmimic_character(&crate::rigs::bytes("mocap/deepmimic_humanoid3d.txt")).unwrap();
    let clip = read_deepmimic(&crate::rigs::bytes(&format!("mocap/{name}")), &skeleton).unwrap().clip;
    let (analysis, reference) = stand(&skeleton.rig, &clip, None).expect("bones");
    Actor { rig: skeleton.rig, clip, analysis, reference }
}

/// Reads a character under ../shared/data/rigs, for tests with `needs_data`.
pub fn character(name: &str) -> (Rig, RigAnalysis) {
    let (rig, _) = crate::rigs::load(&format!("rigs/{name}"));
    let analysis = analyze(&rig).expect("a skin");
    (rig, analysis)
}
