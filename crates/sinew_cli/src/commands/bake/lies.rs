//! A character in a lying pose in its file.

use crate::judge::LIMP_AT;
use sinew::anim::{Wrap, local_to_model, rest_pose, sample::sample, skin_vertices};
use sinew::math::{Affine, Rotation, Transform, Vec3, min};
use sinew::ragdoll::{CharacterDef, RagdollDef};

/// Cosine above which a character counts as standing: the up axis of its body within 45° of the file's.
const STANDS: f32 = 0.7;

/// Number of sampled times of the looped clip besides its start: about ten per second.
const LOOKS: usize = 5;

/// Returns true if a character lies in its file, whose up axis is `up`.
pub fn lies(ragdoll: &RagdollDef, up: Vec3) -> bool {
    (ragdoll.character_from_model.rotation * up).y <= STANDS
}

/// Returns the placement of a character from its file: as it `stands`, or rotated and lowered onto the ground there
/// if it lies. `up` is the file's up axis.
pub fn as_in_file(stands: Transform, character: &CharacterDef, up: Vec3) -> Transform {
    let character_from_model = character.mapping().character_from_model();
    if !lies(&character.ragdoll, up) {
        return stands;
    }
    let up = character.ragdoll.character_from_model.rotation * up;
    let turn = Rotation::from_arc(up, Vec3::Y);
    let lowest =
        lowest_point(character, &(Affine::from(Transform::new(Vec3::ZERO, turn)) * character_from_model));
    Transform::new(stands.translation - Vec3::Y * lowest, stands.rotation * turn)
}

/// Returns the height of the lowest drawn vertex under a map from model space, metres: in the looped clip until the
/// character goes limp, or in the rest pose.
fn lowest_point(character: &CharacterDef, world_from_model: &Affine) -> f32 {
    let motions = character.motions();
    let looped = motions.looped.map(|looped| &motions.clips[looped]);
    let looks = looped.map_or(0, |_| LOOKS);
    let times = (0..=looks).map(|look| LIMP_AT * look as f32 / LOOKS as f32);
    let rig = &character.rig;
    let (mut pose, mut model) = (rest_pose(rig), Vec::new());
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    let mut lowest = f32::INFINITY;
    for time in times {
        if let Some(clip) = looped {
            sample(clip, rig, time, Wrap::Loop, &mut pose);
        }
        local_to_model(rig, &pose, world_from_model, &mut model);
        for (mesh, of_rig) in rig.meshes.iter().enumerate() {
            for primitive in 0..of_rig.primitives.len() {
                skin_vertices(rig, mesh, primitive, &model, &mut positions, &mut normals);
                lowest = positions.iter().fold(lowest, |lowest, at| min(lowest, at.y));
            }
        }
    }
    if lowest.is_finite() { lowest } else { 0.0 }
}
