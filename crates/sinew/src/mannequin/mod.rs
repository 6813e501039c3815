//! The embedded character: a wooden mannequin of 1.75 m with its motions, made by code.
//!
//! `skeleton` says where the joints are, `loft` and `body` put a surface round them; `posture` poses them by hand and
//! foot goals, `gait` plants and swings the feet, `keys` turns postures into clips, `walk` and `get_up` hold the motions
//! themselves, and [`drills`] those that only experiments need.

mod body;
pub mod drills;
mod gait;
mod get_up;
mod keys;
mod loft;
mod posture;
mod skeleton;
mod walk;

use crate::anim::{Clip, Rig};

pub use gait::Path;
pub use walk::{RUN_SPEED, WALK_SPEED};

/// The mannequin: rig with skinned mesh, and its clips.
///
/// Metres, +Y up, facing +Z, soles at y = 0. The bind pose is an A-pose: arms 40° below the horizontal, palms toward the
/// thighs, elbows bent by 8° and knees by 4°, so that their hinge axes can be read off. All rest rotations are the
/// identity. Joint names are those of VRM 1 under one root `mannequin` that moves no vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct Mannequin {
    /// Joints, one skin, one mesh of three primitives (wood, joints, shoes and visor).
    pub rig: Rig,
    /// All clips, linear keys at 30 Hz; [`motions`](Self::motions) says which is which.
    pub clips: Vec<Clip>,
    /// Indices of the clips by what they are for.
    pub motions: Motions,
}

/// Indices into [`Mannequin::clips`], by what each clip does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motions {
    /// A cycle of two steps on the spot, starting as the left heel strikes.
    pub walk: usize,
    /// Speed along +Z at which the feet of `walk` do not slide, m/s.
    pub walk_speed: f32,
    /// Standing and breathing, a cycle.
    pub idle: usize,
    /// From lying on the back, feet along +Z, to the first pose of `idle`, facing +Z.
    pub get_up_supine: usize,
    /// From lying on the face, head along +Z, to the first pose of `idle`, facing +Z.
    pub get_up_prone: usize,
}

/// Makes the mannequin. The same bits on every target.
pub fn mannequin() -> Mannequin {
    let mut rig = skeleton::skeleton();
    rig.meshes.push(body::mesh());
    let clips = vec![walk::walk(), walk::idle(), get_up::from_back(), get_up::from_face()];
    let motions = Motions { walk: 0, walk_speed: WALK_SPEED, idle: 1, get_up_supine: 2, get_up_prone: 3 };
    Mannequin { rig, clips, motions }
}

/// The mannequin as a character that stands where it is not moved, walks, and gets up: for
/// [`Character::spawn`](crate::ragdoll::Character::spawn). Its walk tells of each `left step` and `right step` as the heel strikes.
#[cfg(feature = "ragdoll")]
pub fn character() -> crate::ragdoll::CharacterDef {
    use crate::ragdoll::{BuildOptions, CharacterDef, Locomotion, MotionSet, build};
    let Mannequin { rig, clips, motions } = mannequin();
    let analysis = crate::anim::analyze(&rig).expect("the mannequin has a skin");
    let (ragdoll, _) = build(&rig, &analysis, &BuildOptions::default()).expect("and bones");
    let mut def = CharacterDef::new(rig, ragdoll, &analysis.bind_model);
    // The walk begins as the left heel strikes, and has two equal steps.
    let half = 0.5 * clips[motions.walk].duration;
    let step = |foot: &str, time: f32| (motions.walk, crate::anim::ClipEvent::new(time, foot));
    let motions = MotionSet {
        events: vec![step("left step", 0.0), step("right step", half)],
        clips,
        looped: Some(motions.walk),
        idle: Some(motions.idle),
        get_ups: vec![motions.get_up_supine, motions.get_up_prone],
        locomotion: Locomotion::Forward { speed: motions.walk_speed },
        ..MotionSet::default()
    };
    def.set_motions(motions).expect("clips made by code can be played");
    def
}
