//! Finds the body for a hit.

use super::hit::HitArg;
use crate::failure::{Failure, Result};
use crate::input::files::CharacterFile;
use crate::report::table::shown;
use sinew::anim::{Rig, RigAnalysis, Role, Side};
use sinew::ragdoll::settings::{instead, role_named};
use sinew::ragdoll::{BakeHit, CharacterDef, RagdollBodyDef};

/// Roles of the spine, from the hips up.
const SPINE: [Role; 6] = [Role::Hips, Role::Spine, Role::Chest, Role::UpperChest, Role::Neck, Role::Head];

/// Returns the aim at the named body, or at the nearest body with a note if the body part has none.
pub fn aim(
    hit: &HitArg,
    character: &CharacterDef,
    file: &CharacterFile,
    notes: &mut Vec<String>,
) -> Result<BakeHit> {
    let bodies = &character.ragdoll.bodies;
    let role = role_named(&hit.bone).ok();
    let named = || character.body_named(&hit.bone).or_else(|| body_with(role?, bodies));
    let by_joint = || bearer(&hit.bone, &character.rig, bodies);
    let body = match named().or_else(|| carrier(role?, &file.analysis, bodies)).or_else(by_joint) {
        Some(body) => body,
        None => {
            let Some(body) = role.and_then(|role| nearest(role, bodies)) else {
                let names = bodies.iter().flat_map(|body| [body.role.as_str(), body.bone.as_str()]);
                let what = format!("no bone '{}' to hit; {}", hit.bone, instead(&hit.bone, names));
                return Err(Failure::at(&file.name, what, "--hit"));
            };
            body
        }
    };
    let RagdollBodyDef { role: met, bone, merged, .. } = &bodies[body];
    let joint_named = |&joint: &usize| character.rig.joints.get(joint).is_some_and(|j| j.name == hit.bone);
    let meant = role.is_some_and(|role| role.name() == *met) || *bone == hit.bone || *met == hit.bone;
    if !meant {
        let bone = shown(bone);
        notes.push(if merged.iter().any(joint_named) {
            format!("--hit {}: it moves with the body of {met} ({bone}), which is hit", shown(&hit.bone))
        } else {
            format!("--hit {}: there is no such body; the nearest is hit, {met} ({bone})", shown(&hit.bone))
        });
    }
    Ok(BakeHit { time: hit.time, body, impulse: hit.impulse })
}

fn body_with(role: Role, bodies: &[RagdollBodyDef]) -> Option<usize> {
    let name = role.name();
    bodies.iter().position(|body| body.role == name)
}

/// Returns the body that moves the joint of a role.
fn carrier(role: Role, analysis: &RigAnalysis, bodies: &[RagdollBodyDef]) -> Option<usize> {
    let joint = analysis.joint_with(role)?;
    bodies.iter().position(|body| body.joint == joint || body.merged.contains(&joint))
}

/// Returns the body that moves the joint of that name: its own, else the nearest one among its ancestors, else one
/// among its descendants.
fn bearer(name: &str, rig: &Rig, bodies: &[RagdollBodyDef]) -> Option<usize> {
    let own =
        |joint: usize| bodies.iter().position(|body| body.joint == joint || body.merged.contains(&joint));
    let line = |joint: usize| core::iter::successors(Some(joint), |&at| rig.joints[at].parent);
    let joint = rig.joints.iter().position(|joint| joint.name == name)?;
    line(joint)
        .find_map(own)
        .or_else(|| bodies.iter().position(|body| line(body.joint).any(|at| at == joint)))
}

/// Returns the nearest body along the spine (of two equally near ones, the lower one); for a limb, the body of the next
/// part toward the trunk. Positions along a creature's spine are scaled to those of a human's, for any number of parts.
fn nearest(role: Role, bodies: &[RagdollBodyDef]) -> Option<usize> {
    if let Some(place) = SPINE.iter().position(|other| *other == role) {
        let along = (1..SPINE.len()).flat_map(|away| [place.checked_sub(away), Some(place + away)]);
        let human = along.flatten().filter_map(|at| SPINE.get(at)).find_map(|&role| body_with(role, bodies));
        return human.or_else(|| {
            let segment = |body: &RagdollBodyDef| match Role::from_name(&body.role) {
                Some(Role::SpineSegment(n)) => Some(n),
                _ => None,
            };
            let mut parts: Vec<(u16, usize)> =
                (0..bodies.len()).filter_map(|body| segment(&bodies[body]).map(|n| (n, body))).collect();
            parts.sort_unstable();
            let at = (place * parts.len().saturating_sub(1) + 2) / (SPINE.len() - 1);
            parts.get(at.min(parts.len().saturating_sub(1))).map(|&(_, body)| body)
        });
    }
    let inward = |side: Side| {
        use Role::{Foot, Hand, LowerArm, LowerLeg, Shoulder, Toes, UpperArm, UpperLeg};
        let arm = vec![Hand(side), LowerArm(side), UpperArm(side), Shoulder(side)];
        let trunk = [Role::UpperChest, Role::Chest, Role::Spine, Role::Hips];
        let leg = vec![Toes(side), Foot(side), LowerLeg(side), UpperLeg(side), Role::Hips];
        [arm.into_iter().chain(trunk).collect(), leg]
    };
    let chains: [Vec<Role>; 2] = inward(role.side()?);
    let chain = chains.iter().find(|chain| chain.contains(&role))?;
    let place = chain.iter().position(|other| *other == role)?;
    chain[place..].iter().find_map(|&role| body_with(role, bodies))
}
