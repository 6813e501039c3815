//! Prepares a rig's skeleton for other programs: metres, the program's up axis, and only bone nodes.

use crate::report::table::{counted, shown};
use sinew::anim::{Channel, Clip, Interpolation, Joint, JointIdx, Property, Rig};
use sinew::math::{Rotation, Vec3};

/// Returns the joints that a skin or the clip uses, with their ancestors and descendants, without meshes; the clip
/// on these; and the names of the joints that were left out.
pub fn bones_only(rig: &Rig, clip: &Clip) -> (Rig, Clip, Vec<String>) {
    let mut kept = vec![rig.skins.is_empty(); rig.joints.len()];
    let named = rig.skins.iter().flat_map(|skin| skin.joints.iter().copied());
    for joint in named.chain(clip.channels.iter().map(|channel| channel.joint)) {
        kept[joint] = true;
    }
    for joint in 0..rig.joints.len() {
        // Sockets and bone ends are descendants.
        kept[joint] |= rig.joints[joint].parent.is_some_and(|parent| kept[parent]);
    }
    for mesh in &rig.meshes {
        let is_leaf = rig.joints.iter().all(|joint| joint.parent != Some(mesh.joint));
        let is_moved = clip.channels.iter().any(|channel| channel.joint == mesh.joint);
        let is_bone = rig.skins.iter().any(|skin| skin.joints.contains(&mesh.joint));
        kept[mesh.joint] &= !is_leaf || is_moved || is_bone;
    }
    for joint in (0..rig.joints.len()).rev() {
        if let (true, Some(parent)) = (kept[joint], rig.joints[joint].parent) {
            kept[parent] = true;
        }
    }
    let mut new: Vec<Option<JointIdx>> = Vec::with_capacity(kept.len());
    let mut bones = Rig::default();
    for (index, joint) in rig.joints.iter().enumerate() {
        new.push(kept[index].then_some(bones.joints.len()));
        if kept[index] {
            let parent = joint.parent.and_then(|parent| new[parent]);
            bones.joints.push(Joint { parent, ..joint.clone() });
        }
    }
    let mut clip = clip.clone();
    clip.channels.retain(|channel| !keeps_its_size(channel, rig));
    clip.channels.retain_mut(|channel| new[channel.joint].map(|joint| channel.joint = joint).is_some());
    let dropped = (0..kept.len()).filter(|&joint| !kept[joint]).map(|joint| rig.joints[joint].name.clone());
    (bones, clip, dropped.collect())
}

/// Returns true if a scale channel only repeats the rest pose, as some exporters write it.
fn keeps_its_size(channel: &Channel, rig: &Rig) -> bool {
    let rest = rig.joints[channel.joint].rest.scale;
    let near = |value: &[f32]| (Vec3::from_slice(value) - rest).length() < 1e-4 * rest.length();
    channel.property == Property::Scale
        && channel.interpolation != Interpolation::CubicSpline
        && channel.values.chunks_exact(3).all(near)
}

/// Adds notes on the losses of a bones-only format: meshes, and the nodes with these names.
pub fn lost_meshes(rig: &Rig, dropped: &[String], notes: &mut Vec<String>) {
    if !rig.meshes.is_empty() {
        let (meshes, skins) =
            (counted(rig.meshes.len(), "mesh", "meshes"), counted(rig.skins.len(), "skin", "skins"));
        notes.push(format!("left out: {meshes} and {skins}, which the format lacks"));
    }
    if !dropped.is_empty() {
        let names: Vec<String> = dropped.iter().take(8).map(|name| shown(name)).collect();
        let more = if dropped.len() > names.len() { ", …" } else { "" };
        let nodes = counted(dropped.len(), "node", "nodes");
        notes.push(format!("left out: {nodes} without a bone ({}{more})", names.join(", ")));
    }
}

/// Rotates and scales a whole rig and its clip about the origin.
pub fn transform(rig: &mut Rig, clip: &mut Clip, turn: Rotation, scale: f32) {
    let roots: Vec<JointIdx> = (0..rig.joints.len()).filter(|&i| rig.joints[i].parent.is_none()).collect();
    for &root in &roots {
        let rest = &mut rig.joints[root].rest;
        rest.translation = turn * rest.translation * scale;
        rest.rotation = (turn * rest.rotation).normalize();
        rest.scale *= scale;
    }
    for channel in clip.channels.iter_mut().filter(|channel| roots.contains(&channel.joint)) {
        // Rotation and scale are linear, so tangents transform the same way.
        for value in channel.values.chunks_exact_mut(channel.property.width()) {
            match (channel.property, value) {
                (Property::Rotation, [x, y, z, w]) => {
                    let turned = turn * Rotation::from_xyzw(*x, *y, *z, *w);
                    (*x, *y, *z, *w) = (turned.x, turned.y, turned.z, turned.w);
                }
                (Property::Translation, [x, y, z]) => {
                    [*x, *y, *z] = (turn * Vec3::new(*x, *y, *z) * scale).to_array();
                }
                (_, [x, y, z]) => [*x, *y, *z] = (Vec3::new(*x, *y, *z) * scale).to_array(),
                _ => {}
            }
        }
    }
}

/// Returns the estimated frame rate of a clip's keys; 60 if it cannot be estimated.
pub fn frame_rate(clip: &Clip) -> f64 {
    const USUAL: f64 = 60.0;
    let most = clip.channels.iter().filter(|channel| channel.interpolation != Interpolation::Step);
    let Some(channel) = most.max_by_key(|channel| channel.times.len()) else { return USUAL };
    let mut gaps: Vec<f32> = channel.times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    gaps.sort_by(f32::total_cmp);
    let Some(&gap) = gaps.get(gaps.len() / 2) else { return USUAL };
    let rate = (1.0 / f64::from(gap)).round();
    if (10.0..=240.0).contains(&rate) { rate } else { USUAL }
}
