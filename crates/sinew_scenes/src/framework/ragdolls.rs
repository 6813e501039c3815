//! Ragdolls of the mannequin and of other rigs, put into a world.

use crate::mannequin::mannequin;
use sinew::anim::{Rig, analyze};
use sinew::math::{Rotation, Transform, Vec3, min};
use sinew::physics::{Velocity, World};
use sinew::ragdoll::{BodySettings, BodyState, BuildOptions, Ragdoll, RagdollDef, build};

/// Spawns a character in a pose, rotated and moving as one rigid piece, with its lowest point at `place`.
pub(crate) fn spawn_at(
    world: &mut World,
    def: &RagdollDef,
    pose: &[Transform],
    turn: Rotation,
    place: Vec3,
    speed: Vec3,
) -> Ragdoll {
    let velocity = Velocity { linear: speed, angular: Vec3::ZERO };
    let state = |world_from_body| BodyState { world_from_body, velocity };
    let states: Vec<_> = placed(def, pose, turn, place).map(state).collect();
    Ragdoll::spawn(world, def, &states, &BodySettings::default())
}

/// Returns the transforms of the bodies of a rotated pose, with its lowest point at `place`.
pub(crate) fn placed(
    def: &RagdollDef,
    pose: &[Transform],
    turn: Rotation,
    place: Vec3,
) -> impl Iterator<Item = Transform> {
    let turned = Transform::new(Vec3::ZERO, turn);
    let lowest = def
        .bodies
        .iter()
        .zip(pose)
        .fold(f32::INFINITY, |lowest, (body, &at)| min(lowest, body.shape.aabb(&(turned * at)).min.y));
    let placed = Transform::new(place - Vec3::Y * lowest, turn);
    pose.iter().map(move |&at| placed * at)
}

/// The pose in which a rig was bound to its skin.
pub(crate) fn bind_pose(def: &RagdollDef) -> Vec<Transform> {
    def.bodies.iter().map(|body| body.character_from_body).collect()
}

pub(crate) fn ragdoll_of_mannequin() -> RagdollDef {
    ragdoll_of(&mannequin().rig).expect("the mannequin has a skin and bones")
}

/// Returns the ragdoll of a rig; `None` if the rig has no skin or no bones.
pub(crate) fn ragdoll_of(rig: &Rig) -> Option<RagdollDef> {
    let analysis = analyze(rig).ok()?;
    Some(build(rig, &analysis, &BuildOptions::default()).ok()?.0)
}
