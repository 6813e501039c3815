//! Settings that change the analysis: unit, axis, the set of bones with bodies.

use super::{BodyWish, Settings, SettingsError, Unit, instead};
use crate::build::joint_name;
use sinew_anim::roles::{KeptBone, RigAnalysis, Role};
use sinew_anim::skinning::skin_vertices;
use sinew_anim::{JointIdx, Rig};
use sinew_math::{Rotation, Transform, Vec3, max, min};

/// Returns the analysis with the requested axis and unit.
pub(super) fn placed(
    rig: &Rig,
    mut analysis: RigAnalysis,
    settings: &Settings,
) -> Result<RigAnalysis, SettingsError> {
    if let Some(up) = settings.up_axis {
        stand_along(rig, &mut analysis, up);
    }
    match settings.unit {
        Some(Unit::Scale(scale)) => Ok(analysis.with_unit_scale(scale)),
        Some(Unit::Height(height)) => {
            let scale = analysis.unit_scale * height / analysis.height;
            if !(scale.is_finite() && scale > 0.0) {
                return Err(SettingsError::at("height", "the character has no height in its bind pose"));
            }
            Ok(analysis.with_unit_scale(scale))
        }
        None => Ok(analysis),
    }
}

/// Returns the analysis with bodies for the requested bones.
pub(super) fn settled(
    rig: &Rig,
    mut analysis: RigAnalysis,
    settings: &Settings,
) -> Result<RigAnalysis, SettingsError> {
    for (name, bone) in &settings.bones {
        let place = || format!("bones.{name}");
        match bone.body {
            Some(BodyWish::Drop) => drop(rig, &mut analysis, name, &place())?,
            Some(BodyWish::Keep) => keep(rig, &mut analysis, name, &place())?,
            None => {}
        }
    }
    Ok(analysis)
}

/// Rotates the character so that `up` of the file is up; its facing changes as little as possible.
fn stand_along(rig: &Rig, analysis: &mut RigAnalysis, up: Vec3) {
    let before = analysis.character_from_model.rotation;
    let seen = before * up;
    // Turn about the character's left axis, so that the sides are not swapped.
    let turn = if seen.y < -0.9 {
        Rotation::from_axis_angle(Vec3::X, core::f32::consts::PI)
    } else {
        Rotation::from_arc(seen, Vec3::Y)
    };
    analysis.character_from_model = Transform::new(Vec3::ZERO, (turn * before).normalize());
    analysis.up_axis = up;
    let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for (m, mesh) in rig.meshes.iter().enumerate().filter(|(_, mesh)| mesh.skin.is_some()) {
        for p in 0..mesh.primitives.len() {
            skin_vertices(rig, m, p, &analysis.bind_model, &mut positions, &mut normals);
            for &position in &positions {
                let y = analysis.character_from_model.point(position * analysis.unit_scale).y;
                (low, high) = (min(low, y), max(high, y));
            }
        }
    }
    if low < high {
        (analysis.floor, analysis.height) = (low, high - low);
    }
}

/// Returns the indices of the kept bones with that name: a role, a role of both sides, or a joint name.
fn kept_named(rig: &Rig, analysis: &RigAnalysis, name: &str) -> Vec<usize> {
    let is = |bone: &KeptBone| named(name, &bone.role.name(), &joint_name(rig, bone.joint));
    (0..analysis.kept.len()).filter(|&index| is(&analysis.kept[index])).collect()
}

/// Returns true if a setting's name refers to a bone of this role and name: `upperArm` means both sides.
pub(super) fn named(name: &str, role: &str, bone: &str) -> bool {
    let without_side = ["left", "right"].iter().find_map(|side| role.strip_prefix(side));
    let both = without_side.is_some_and(|part| {
        let mut letters = name.chars();
        letters.next().is_some_and(|first| {
            first.is_ascii_lowercase()
                && part.starts_with(first.to_ascii_uppercase())
                && part[first.len_utf8()..] == *letters.as_str()
        })
    });
    name == role || both || name == bone
}

fn drop(rig: &Rig, analysis: &mut RigAnalysis, name: &str, place: &str) -> Result<(), SettingsError> {
    let mut found = kept_named(rig, analysis, name);
    if found.is_empty() {
        return Err(unknown(rig, analysis, name, place));
    }
    // Start from the end, so that indices stay valid.
    found.reverse();
    for index in found {
        let Some(parent) = analysis.kept[index].parent else {
            return Err(SettingsError::at(place, "the first bone carries the others: it cannot be dropped"));
        };
        let gone = analysis.kept.remove(index);
        let into = &mut analysis.kept[parent];
        into.merged.push(gone.joint);
        into.merged.extend(&gone.merged);
        into.merged.sort_unstable();
        let carrier = into.joint;
        for bone in &mut analysis.kept {
            bone.parent = match bone.parent {
                Some(above) if above == index => Some(parent),
                Some(above) if above > index => Some(above - 1),
                above => above,
            };
        }
        for follows in &mut analysis.merge_into {
            if *follows == Some(gone.joint) {
                *follows = Some(carrier);
            }
        }
        analysis.merge_into[gone.joint] = Some(carrier);
        if !analysis.dropped.contains(&gone.joint) {
            analysis.dropped.push(gone.joint);
            analysis.dropped.sort_unstable();
        }
    }
    Ok(())
}

fn keep(rig: &Rig, analysis: &mut RigAnalysis, name: &str, place: &str) -> Result<(), SettingsError> {
    if !kept_named(rig, analysis, name).is_empty() {
        return Ok(());
    }
    let wanted = (0..rig.joints.len()).find(|&joint| {
        let role = analysis.roles[joint].map_or(String::new(), |guess| guess.role.name());
        named(name, &role, &joint_name(rig, joint))
    });
    let Some(joint) = wanted else { return Err(unknown(rig, analysis, name, place)) };
    let carrier = analysis.merge_into[joint]
        .and_then(|carrier| analysis.kept.iter().position(|bone| bone.joint == carrier));
    let Some(carrier) = carrier else {
        let what = "it moves no skin and hangs on no body: there is nothing to make a body of";
        return Err(SettingsError::at(place, what));
    };
    insert(rig, analysis, joint, carrier);
    Ok(())
}

/// Makes a separate bone of a joint that belonged to another bone, with the joint's descendants.
fn insert(rig: &Rig, analysis: &mut RigAnalysis, joint: JointIdx, carrier: usize) {
    let is_below = |mut at: JointIdx| loop {
        if at == joint {
            return true;
        }
        match rig.joints[at].parent {
            Some(parent) => at = parent,
            None => return false,
        }
    };
    let (own, rest) = analysis.kept[carrier].merged.iter().partition(|&&merged| is_below(merged));
    analysis.kept[carrier].merged = rest;
    let own: Vec<JointIdx> = own;
    let limbs = analysis.kept.iter().filter_map(|bone| match bone.role {
        Role::LimbSegment { limb, .. } => Some(limb + 1),
        _ => None,
    });
    let free = Role::LimbSegment { limb: limbs.max().unwrap_or(0), segment: 0 };
    let guess = analysis.roles[joint];
    let moves_skin = |at: JointIdx| rig.skins.iter().any(|skin| skin.joints.contains(&at));
    // A rigid mesh without a role, such as a helmet, does not swing on its carrier.
    let is_prop = guess.is_none() && !own.iter().chain([&joint]).any(|&at| moves_skin(at));
    let new = KeptBone {
        joint,
        role: guess.map_or(free, |guess| guess.role),
        confidence: guess.map_or(0.5, |guess| guess.confidence),
        parent: Some(carrier),
        merged: own.into_iter().filter(|&merged| merged != joint).collect(),
        bind_model: analysis.bind_model[joint],
        is_prop,
    };
    let index = carrier + 1;
    for follower in &new.merged {
        analysis.merge_into[*follower] = Some(joint);
    }
    analysis.merge_into[joint] = None;
    for bone in &mut analysis.kept {
        bone.parent = match bone.parent {
            Some(above) if above == carrier && is_below(bone.joint) => Some(index),
            Some(above) if above >= index => Some(above + 1),
            above => above,
        };
    }
    analysis.kept.insert(index, new);
    analysis.dropped.retain(|&dropped| dropped != joint);
}

fn unknown(rig: &Rig, analysis: &RigAnalysis, name: &str, place: &str) -> SettingsError {
    let roles = analysis.kept.iter().map(|bone| bone.role.name());
    let names = (0..rig.joints.len()).map(|joint| joint_name(rig, joint));
    let known: Vec<String> = roles.chain(names).collect();
    no_bone(name, &known, place)
}

/// Returns the error for a name that no bone has; `known` are the existing names.
pub(super) fn no_bone(name: &str, known: &[String], place: &str) -> SettingsError {
    let instead = instead(name, known.iter().map(String::as_str));
    SettingsError::at(place, format!("no bone or role `{}`; {instead}", name.escape_debug()))
}
