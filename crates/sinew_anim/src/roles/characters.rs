//! Several characters in one file.

use crate::rig::{JointIdx, Rig};

/// The characters of a rig, each by its meshes (indices into [`Rig::meshes`]), in the order of their first mesh: skins whose joints
/// are of one skeleton, with the meshes without a skin that hang on it. Skeletons are of one character where a joint of one hangs
/// on a joint of the other, or both on a node that is no root of the scene. Meshes without a skin that hang on none are in no
/// character. Empty without skins.
///
/// # Panics
/// If the rig's indices are out of range.
pub fn characters(rig: &Rig) -> Vec<Vec<usize>> {
    let mut is_bone = vec![false; rig.joints.len()];
    rig.skins.iter().flat_map(|skin| &skin.joints).for_each(|&joint| is_bone[joint] = true);
    // What a joint is known by: its root of the scene if that is a bone, else the ancestor right below that.
    let stem = |joint: JointIdx| {
        let mut stem = joint;
        while let Some(parent) = rig.joints[stem].parent {
            if rig.joints[parent].parent.is_none() && !is_bone[parent] {
                break;
            }
            stem = parent;
        }
        stem
    };
    let stems: Vec<Vec<JointIdx>> = rig
        .skins
        .iter()
        .map(|skin| {
            let mut stems: Vec<JointIdx> = skin.joints.iter().map(|&joint| stem(joint)).collect();
            stems.sort_unstable();
            stems.dedup();
            stems
        })
        .collect();
    // Per group its stems and its meshes.
    let mut groups: Vec<(Vec<JointIdx>, Vec<usize>)> = Vec::new();
    for (m, mesh) in rig.meshes.iter().enumerate() {
        let Some(skin) = mesh.skin else { continue };
        let (mut own, mut meshes) = (stems[skin].clone(), vec![m]);
        // Whatever has a stem in common becomes one.
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
        let stem = stem(mesh.joint);
        if let Some((_, meshes)) = groups.iter_mut().find(|(stems, _)| stems.contains(&stem)) {
            meshes.push(m);
        }
    }
    let mut characters: Vec<Vec<usize>> = groups.into_iter().map(|(_, meshes)| meshes).collect();
    characters.iter_mut().for_each(|meshes| meshes.sort_unstable());
    characters.sort();
    characters
}
