//! Roles stated by a VRM file: its humanoid bones.

use crate::container::json::At;
use serde_json::Value;
use sinew_anim::JointIdx;

/// Returns VRM 1 bone names with their joints, sorted by joint. Entries without a joint of the scene are omitted:
/// bones are optional in both versions, and some exporters write −1.
pub(super) fn stated_roles(root: At<'_>, joint_of_node: &[Option<JointIdx>]) -> Vec<(String, JointIdx)> {
    let Some(extensions) = root.value().get("extensions") else { return Vec::new() };
    let joint = |bone: &Value| {
        let node = usize::try_from(bone.get("node")?.as_u64()?).ok()?;
        joint_of_node.get(node).copied().flatten()
    };
    let mut roles = Vec::new();
    for version_1 in ["VRMC_vrm", "VRMC_vrm_animation"] {
        let bones = extensions.get(version_1).and_then(|vrm| vrm["humanoid"]["humanBones"].as_object());
        for (name, bone) in bones.into_iter().flatten() {
            roles.extend(joint(bone).map(|joint| (name.clone(), joint)));
        }
    }
    if roles.is_empty() {
        let bones = extensions.get("VRM").and_then(|vrm| vrm["humanoid"]["humanBones"].as_array());
        for bone in bones.into_iter().flatten() {
            let name = bone["bone"].as_str().map(version_1_name);
            roles.extend(name.zip(joint(bone)));
        }
    }
    roles.sort_by_key(|&(_, joint)| joint);
    roles
}

/// Converts a VRM 0 bone name. VRM 1 renamed the thumb: its first bone is the metacarpal, not the proximal phalanx;
/// all other names are the same.
fn version_1_name(version_0: &str) -> String {
    match version_0 {
        "leftThumbProximal" => "leftThumbMetacarpal",
        "leftThumbIntermediate" => "leftThumbProximal",
        "rightThumbProximal" => "rightThumbMetacarpal",
        "rightThumbIntermediate" => "rightThumbProximal",
        same => same,
    }
    .to_owned()
}
