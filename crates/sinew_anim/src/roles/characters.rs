//! Several characters in one file.

use super::bind::bind_pose;
use crate::rig::{JointIdx, Rig};
use crate::roles::tuning::{BONES_OF_A_CHARACTER, LARGE_WITHIN, LIES_WITHIN, SAME_BONE, SMALL_BESIDE};
use crate::skinning::skin_vertices;
use sinew_math::{Affine, Vec3, max, max3, min, min3};

/// Returns the characters of a rig, each as its meshes (indices into [`Rig::meshes`]), in the order of their first
/// mesh.
///
/// A character is a skeleton beside the others. A skeleton inside another, or small beside it, belongs to the other:
/// eyes, a hat, clothes with bones at the body's bones, a cape of few bones. A skeleton of similar size with bones
/// elsewhere is a character. Empty without skins.
///
/// # Panics
/// If the rig's indices are out of range.
pub fn characters(rig: &Rig) -> Vec<Vec<usize>> {
    let skeletons = skeletons(rig);
    if skeletons.len() < 2 {
        return skeletons;
    }
    let bind = bind_pose(rig);
    let extents: Vec<Option<Extent>> = skeletons.iter().map(|meshes| extent(rig, &bind, meshes)).collect();
    let mut by_size: Vec<usize> = (0..skeletons.len()).collect();
    let size = |of: usize| extents[of].map_or(0.0, |extent| extent.longest());
    by_size.sort_by(|&a, &b| size(b).total_cmp(&size(a)));
    let mut own: Vec<(usize, Vec<usize>)> = Vec::new();
    for skeleton in by_size {
        let belongs = |(main, meshes): &(usize, Vec<usize>)| match (extents[*main], extents[skeleton]) {
            (Some(main), Some(extent)) => {
                let is_other = extent.longest() > LARGE_WITHIN * main.longest()
                    && !shares_bones(rig, &bind, meshes, &skeletons[skeleton], main.longest());
                // Half of a cape's size may be outside of the body.
                let is_worn = extent.common(&main) > 0.0
                    && bones(rig, &skeletons[skeleton]) < BONES_OF_A_CHARACTER
                    && bones(rig, meshes) >= BONES_OF_A_CHARACTER;
                is_worn || extent.belongs_to(&main) && !is_other
            }
            _ => true,
        };
        match own.iter().position(belongs) {
            Some(main) => own[main].1.extend(&skeletons[skeleton]),
            None => own.push((skeleton, skeletons[skeleton].clone())),
        }
    }
    let mut characters: Vec<Vec<usize>> = own.into_iter().map(|(_, meshes)| meshes).collect();
    characters.iter_mut().for_each(|meshes| meshes.sort_unstable());
    characters.sort();
    characters
}

/// Number of bones of a skeleton.
fn bones(rig: &Rig, meshes: &[usize]) -> usize {
    let skins = meshes.iter().filter_map(|&m| rig.meshes[m].skin);
    let mut bones: Vec<JointIdx> = skins.flat_map(|skin| rig.skins[skin].joints.iter().copied()).collect();
    bones.sort_unstable();
    bones.dedup();
    bones.len()
}

/// True if most bones of a skeleton coincide with those of another of similar size.
fn shares_bones(rig: &Rig, bind: &[Affine], main: &[usize], other: &[usize], size: f32) -> bool {
    let places = |meshes: &[usize]| -> Vec<Vec3> {
        let skins = meshes.iter().filter_map(|&m| rig.meshes[m].skin);
        skins.flat_map(|skin| &rig.skins[skin].joints).map(|&joint| bind[joint].translation).collect()
    };
    let (main, other) = (places(main), places(other));
    let near = |at: &&Vec3| main.iter().any(|place| (*place - **at).length() < SAME_BONE * size);
    other.len() < BONES_OF_A_CHARACTER || 2 * other.iter().filter(near).count() > other.len()
}

/// Axis-aligned box of a skin in its bind pose, model space, file units.
#[derive(Clone, Copy)]
struct Extent {
    lo: Vec3,
    hi: Vec3,
}

impl Extent {
    fn longest(&self) -> f32 {
        let sides = self.hi - self.lo;
        max(sides.x, max(sides.y, sides.z))
    }

    /// Smallest share of the box within the other box, over the three axes; below 0 if the boxes are apart.
    fn common(&self, main: &Self) -> f32 {
        let common = min3(self.hi, main.hi) - max3(self.lo, main.lo);
        let share = |k: usize| {
            let own = self.hi[k] - self.lo[k];
            if own > 0.0 { common[k] / own } else { f32::from(u8::from(common[k] >= 0.0)) }
        };
        min(share(0), min(share(1), share(2)))
    }

    /// True if the box is mostly within the other, or small and near it. A skeleton of similar size beside the other is
    /// a character.
    fn belongs_to(&self, main: &Self) -> bool {
        let least = self.common(main);
        let is_small = self.longest() < SMALL_BESIDE * main.longest();
        least > LIES_WITHIN || is_small && least > -1.0
    }
}

fn extent(rig: &Rig, bind: &[Affine], meshes: &[usize]) -> Option<Extent> {
    let mut extent: Option<Extent> = None;
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for &m in meshes.iter().filter(|&&m| rig.meshes[m].skin.is_some()) {
        for p in 0..rig.meshes[m].primitives.len() {
            skin_vertices(rig, m, p, bind, &mut positions, &mut normals);
            for &at in positions.iter().filter(|at| at.is_finite()) {
                let Extent { lo, hi } = extent.unwrap_or(Extent { lo: at, hi: at });
                extent = Some(Extent { lo: min3(lo, at), hi: max3(hi, at) });
            }
        }
    }
    extent
}

/// Returns the skeletons of a rig, each as its meshes (indices into [`Rig::meshes`]), in the order of their first mesh.
/// A skeleton is a set of skins whose joints share a tree of bones, or whose trees start at one node that is no root of
/// the scene, with the rigid meshes below them. Rigid meshes elsewhere are in no skeleton. Empty without skins.
///
/// # Panics
/// If the rig's indices are out of range.
pub(super) fn skeletons(rig: &Rig) -> Vec<Vec<usize>> {
    let mut is_bone = vec![false; rig.joints.len()];
    rig.skins.iter().flat_map(|skin| &skin.joints).for_each(|&joint| is_bone[joint] = true);
    // Key of a joint: the node that carries the highest bone above the joint, or that bone if the node is a root of the
    // scene.
    let stem = |joint: JointIdx| {
        let line = core::iter::successors(Some(joint), |&at| rig.joints[at].parent);
        let top = line.filter(|&at| is_bone[at]).last()?;
        let carrier = rig.joints[top].parent.filter(|&node| rig.joints[node].parent.is_some());
        Some(carrier.unwrap_or(top))
    };
    let stems: Vec<Vec<JointIdx>> = rig
        .skins
        .iter()
        .map(|skin| {
            let mut stems: Vec<JointIdx> = skin.joints.iter().filter_map(|&joint| stem(joint)).collect();
            stems.sort_unstable();
            stems.dedup();
            stems
        })
        .collect();
    // Stems and meshes of each group.
    let mut groups: Vec<(Vec<JointIdx>, Vec<usize>)> = Vec::new();
    for (m, mesh) in rig.meshes.iter().enumerate() {
        let Some(skin) = mesh.skin else { continue };
        let (mut own, mut meshes) = (stems[skin].clone(), vec![m]);
        // Trees with a common stem are merged.
        let mut apart = Vec::new();
        for (stems, others) in groups {
            if stems.iter().any(|stem| own.contains(stem)) {
                own.extend(stems);
                meshes.extend(others);
            } else {
                apart.push((stems, others));
            }
        }
        apart.push((own, meshes));
        groups = apart;
    }
    for (m, mesh) in rig.meshes.iter().enumerate().filter(|(_, mesh)| mesh.skin.is_none()) {
        let Some(stem) = stem(mesh.joint) else { continue };
        if let Some((_, meshes)) = groups.iter_mut().find(|(stems, _)| stems.contains(&stem)) {
            meshes.push(m);
        }
    }
    let mut skeletons: Vec<Vec<usize>> = groups.into_iter().map(|(_, meshes)| meshes).collect();
    skeletons.iter_mut().for_each(|meshes| meshes.sort_unstable());
    skeletons.sort();
    skeletons
}

/// True for the joints that move skin of the largest skeleton, if several skeletons count as one character; the joints
/// of the others follow its bodies. `None` if there is only one skeleton.
pub(super) fn main_skeleton(rig: &Rig, area: &[f32]) -> Option<Vec<bool>> {
    let skeletons = skeletons(rig);
    if skeletons.len() < 2 {
        return None;
    }
    let joints = |meshes: &Vec<usize>| {
        let mut joints: Vec<JointIdx> = meshes
            .iter()
            .filter_map(|&m| rig.meshes[m].skin)
            .flat_map(|skin| rig.skins[skin].joints.iter().copied())
            .collect();
        joints.sort_unstable();
        joints.dedup();
        joints
    };
    let skin = |joints: &Vec<JointIdx>| joints.iter().map(|&joint| area[joint]).sum::<f32>();
    let all = skeletons.iter().map(joints);
    let main = all.reduce(|a, b| if skin(&b) > skin(&a) { b } else { a })?;
    let mut is_main = vec![false; rig.joints.len()];
    main.into_iter().for_each(|joint| is_main[joint] = true);
    Some(is_main)
}
