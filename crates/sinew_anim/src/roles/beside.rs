//! Bind poses of nodes beside the skeleton: rigid meshes, and skeletons of hair and clothes.

use super::bind::{alike, moving_slots};
use super::characters::skeletons;
use super::graph::ancestors;
use crate::rig::{JointIdx, Rig};
use crate::roles::tuning::{AT_MAIN, SIDE_BONES};
use sinew_math::{Affine, Vec3, max, max3, min3};

/// Moves the bind poses of side skeletons (hair, a cape, eyes) with the nearest bone of the main skeleton. Side
/// skeletons are placed relative to the rest pose, so they would be misplaced if the body was bound in another pose.
pub(super) fn move_side_skeletons(rig: &Rig, rest: &[Affine], bound: &mut [Option<Affine>]) {
    let all = skeletons(rig);
    if all.len() < 2 {
        return;
    }
    let bones: Vec<Vec<JointIdx>> = all.iter().map(|meshes| bones_of(rig, meshes)).collect();
    let main = (0..bones.len()).reduce(|a, b| if bones[b].len() > bones[a].len() { b } else { a });
    let Some(main) = main.map(|main| &bones[main]) else { return };
    let places = main.iter().map(|&bone| rest[bone].translation).filter(|place| place.is_finite());
    let corners = places.map(|at| (at, at)).reduce(|a, b| (min3(a.0, b.0), max3(a.1, b.1)));
    let sides = corners.map_or(Vec3::ZERO, |(lo, hi)| hi - lo);
    let near = AT_MAIN * max(sides.x, max(sides.y, sides.z));
    let moves = |side: &Vec<JointIdx>| {
        let root = *side.first()?;
        if SIDE_BONES * side.len() > main.len() || side.iter().any(|bone| main.contains(bone)) {
            return None;
        }
        let away = |bone: JointIdx| (rest[bone].translation - rest[root].translation).length();
        let nearest = main.iter().copied().reduce(|a, b| if away(b) < away(a) { b } else { a })?;
        let moved = bound[nearest]? * rest[nearest].inverse() * rest[root] * bound[root]?.inverse();
        let counts = away(nearest) < near && moved.is_finite() && !alike(&moved, &Affine::IDENTITY);
        counts.then_some(moved)
    };
    let all: Vec<(&Vec<JointIdx>, Option<Affine>)> = bones.iter().map(|side| (side, moves(side))).collect();
    for (side, moved) in all {
        let Some(moved) = moved else { continue };
        for &bone in side {
            bound[bone] = bound[bone].map(|place| moved * place);
        }
    }
}

/// Returns the joints that move vertices of some meshes, parents first. A control without vertices may be bound
/// anywhere.
fn bones_of(rig: &Rig, meshes: &[usize]) -> Vec<JointIdx> {
    let mut bones: Vec<JointIdx> = Vec::new();
    for mesh in meshes.iter().map(|&m| &rig.meshes[m]) {
        let Some(skin) = mesh.skin else { continue };
        let joints = rig.skins[skin].joints.iter().zip(moving_slots(rig, mesh));
        bones.extend(joints.filter(|(_, moves)| *moves).map(|(&joint, _)| joint));
    }
    bones.sort_unstable();
    bones.dedup();
    bones
}

/// Returns positions in the bind pose of rigid mesh nodes beside the skeleton: a hat without a bone is placed relative
/// to the rest pose, and follows the nearest joint. `None` for all other nodes, and if the rest pose of that joint
/// equals its bind pose.
pub(super) fn beside_the_bones(rig: &Rig, rest: &[Affine], bound: &[Option<Affine>]) -> Vec<Option<Affine>> {
    let mut bears = vec![false; rig.joints.len()];
    let bones = (0..rig.joints.len()).filter(|&joint| bound[joint].is_some());
    bones.clone().for_each(|bone| {
        bears[bone] = true;
        ancestors(rig, bone).for_each(|above| bears[above] = true);
    });
    let mut beside = vec![None; rig.joints.len()];
    // For each such mesh, takes the highest ancestor that carries no bones; its first mesh gives the position.
    for mesh in rig.meshes.iter().filter(|mesh| mesh.skin.is_none()) {
        let line = core::iter::once(mesh.joint).chain(ancestors(rig, mesh.joint));
        let own: Vec<JointIdx> = line.take_while(|&at| !bears[at]).collect();
        let on_bone = |top: JointIdx| ancestors(rig, top).any(|above| bound[above].is_some());
        let Some(&top) = own.last().filter(|&&top| beside[top].is_none() && !on_bone(top)) else { continue };
        let corners = mesh.primitives.iter().flat_map(|primitive| &primitive.positions);
        let (sum, count) = corners.fold((Vec3::ZERO, 0.0), |(sum, count), at| (sum + *at, count + 1.0));
        let middle = rest[mesh.joint].point(sum / max(count, 1.0));
        let away = |bone: JointIdx| (rest[bone].translation - middle).length();
        let nearest = bones.clone().reduce(|a, b| if away(b) < away(a) { b } else { a });
        beside[top] = nearest.and_then(|bone| {
            let moved = bound[bone]? * rest[bone].inverse();
            let is_moved = !alike(&moved, &Affine::IDENTITY) && moved.is_finite();
            is_moved.then(|| moved * rest[top])
        });
    }
    beside
}
