//! The embedded character: a wooden mannequin of 1.75 m, made by code.

mod body;
mod get_up;
mod keys;
mod loft;
mod posture;
mod skeleton;
mod walk;

use sinew::anim::{Clip, Rig};

pub use walk::WALK_SPEED;

/// The mannequin: rig with skinned mesh, and its clips.
///
/// Metres, +Y up, facing +Z, soles at y = 0. The bind pose is an A-pose: arms 40° below the horizontal, palms toward the
/// thighs, elbows bent by 8° and knees by 4°, so that their hinge axes can be read off. All rest rotations are the
/// identity. Joint names are those of VRM 1 under one root `mannequin` that moves no vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct Mannequin {
    /// Joints, one skin, one mesh of three primitives.
    pub rig: Rig,
    /// All clips.
    pub clips: Vec<Clip>,
}

/// Makes the mannequin. The same bits on every target.
pub fn mannequin() -> Mannequin {
    let mut rig = skeleton::skeleton();
    rig.meshes.push(body::mesh());
    Mannequin { rig, clips: vec![walk::walk(), walk::idle(), get_up::from_back(), get_up::from_face()] }
}
