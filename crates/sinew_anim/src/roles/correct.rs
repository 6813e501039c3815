//! Corrections of an analysis by the user.

use super::anatomy::{Draft, Scene};
use super::role::{HUMANOID_ROLES, Role};
use super::{Basis, NoSkin, RoleGuess};
use crate::rig::{JointIdx, Primitive, Rig};
use std::borrow::Cow;

/// Roles of joints, and joints outside the body, as given by the user. The default corrects nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Correction {
    /// Joints with given roles, which override shape and names. The previous joint of a role loses it, or swaps
    /// roles.
    pub roles: Vec<(Role, JointIdx)>,
    /// Joints that are not part of the body, with all their descendants: they follow their parent, and their skin is
    /// ignored.
    pub ignored: Vec<JointIdx>,
}

/// Reason why a correction cannot be applied.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CorrectionError {
    /// The rig has no skin.
    #[error(transparent)]
    NoSkin(#[from] NoSkin),
    /// All joints that move skin are ignored.
    #[error("nothing that moves skin is left")]
    NothingLeft,
    /// A role or a joint is given twice.
    #[error("`{}` is given twice: a role has one bone, and a bone one role", .0.name())]
    Twice(Role),
    /// A role is human, but the rig is not recognised as human; some roles are missing.
    #[error(
        "`{}` is a role of a human, and the rig is not read as one: give {} too, and both sides have to be where a \
         human's are",
        .role.name(),
        listed(.missing)
    )]
    NotHuman {
        /// The role that was given.
        role: Role,
        /// Missing human roles; empty if all are given but at impossible positions.
        missing: Vec<Role>,
    },
    /// The joint moves no skin, which a creature part must do.
    #[error("it moves no skin: it cannot be `{}`", .0.name())]
    NoPart(Role),
}

fn listed(roles: &[Role]) -> String {
    let names: Vec<String> = roles.iter().map(|role| format!("`{}`", role.name())).collect();
    if names.is_empty() { "the other roles".to_owned() } else { names.join(", ") }
}

/// Roles that a human needs.
pub(super) fn needed() -> impl Iterator<Item = Role> {
    let is_needed = |role: &Role| {
        matches!(
            role,
            Role::Hips
                | Role::Head
                | Role::UpperArm(_)
                | Role::LowerArm(_)
                | Role::UpperLeg(_)
                | Role::LowerLeg(_)
        )
    };
    HUMANOID_ROLES.into_iter().filter(is_needed)
}

impl Correction {
    /// True if the correction changes nothing.
    pub fn is_empty(&self) -> bool {
        self.roles.is_empty() && self.ignored.is_empty()
    }

    /// Returns the rig without the ignored skin, meshes and joint names; joint indices do not change.
    ///
    /// # Panics
    /// If a joint, or an index of the rig, is out of range.
    pub fn seen<'a>(&self, rig: &'a Rig) -> Cow<'a, Rig> {
        if self.ignored.is_empty() {
            return Cow::Borrowed(rig);
        }
        let mut is_ignored = vec![false; rig.joints.len()];
        self.ignored.iter().for_each(|&joint| is_ignored[joint] = true);
        for joint in 0..rig.joints.len() {
            is_ignored[joint] |= rig.joints[joint].parent.is_some_and(|parent| is_ignored[parent]);
        }
        let mut seen = rig.clone();
        // Ignored joints get no name, so that it cannot name a body part.
        let ignored = seen.joints.iter_mut().zip(&is_ignored).filter(|(_, is_ignored)| **is_ignored);
        ignored.for_each(|(joint, _)| joint.name.clear());
        for mesh in &mut seen.meshes {
            match mesh.skin {
                None if is_ignored[mesh.joint] => mesh.primitives.clear(),
                None => {}
                Some(skin) => {
                    let joints = &rig.skins[skin].joints;
                    let slots: Vec<bool> = joints.iter().map(|&joint| is_ignored[joint]).collect();
                    mesh.primitives.iter_mut().for_each(|primitive| strip(primitive, &slots));
                }
            }
        }
        Cow::Owned(seen)
    }
}

/// Removes vertices that are moved mostly by ignored joints, with their triangles; other vertices lose the weights
/// of ignored joints.
fn strip(primitive: &mut Primitive, is_ignored: &[bool]) {
    if primitive.joints.is_empty() {
        return;
    }
    let ignored = |slot: u16| is_ignored.get(usize::from(slot)).copied().unwrap_or(false);
    let pull = |vertex: usize| -> f32 {
        let pulls = primitive.joints[vertex].iter().zip(primitive.weights[vertex]);
        pulls.filter(|(slot, _)| ignored(**slot)).map(|(_, weight)| weight).sum()
    };
    let whole = |vertex: usize| primitive.weights[vertex].iter().sum::<f32>();
    let stays: Vec<bool> =
        (0..primitive.joints.len()).map(|vertex| 2.0 * pull(vertex) < whole(vertex)).collect();
    let mut place: Vec<u32> = Vec::with_capacity(stays.len());
    let mut count = 0;
    for &stays in &stays {
        place.push(count);
        count += u32::from(stays);
    }
    let kept = |vertex: u32| stays.get(vertex as usize).copied().unwrap_or(false);
    let corners = primitive.indices.chunks_exact(3).filter(|corners| corners.iter().all(|&i| kept(i)));
    primitive.indices = corners.flatten().map(|&vertex| place[vertex as usize]).collect();
    retain(&mut primitive.positions, &stays);
    retain(&mut primitive.normals, &stays);
    retain(&mut primitive.joints, &stays);
    retain(&mut primitive.weights, &stays);
    retain(&mut primitive.uvs, &stays);
    retain(&mut primitive.colors, &stays);
    for (slots, weights) in primitive.joints.iter().zip(&mut primitive.weights) {
        let ours = |i: &usize| !ignored(slots[*i]);
        let left: f32 = (0..slots.len()).filter(ours).map(|i| weights[i]).sum();
        for i in 0..slots.len() {
            weights[i] = if ours(&i) && left > 0.0 { weights[i] / left } else { 0.0 };
        }
    }
}

/// Keeps the data of the vertices in `stays`; items beyond the end of `stays` remain.
fn retain<T>(list: &mut Vec<T>, stays: &[bool]) {
    let mut vertex = 0;
    list.retain(|_| {
        vertex += 1;
        stays.get(vertex - 1).copied().unwrap_or(true)
    });
}

/// Returns the draft with the known roles applied.
pub(super) fn corrected(
    scene: &Scene<'_>,
    mut draft: Draft,
    known: &[(Role, JointIdx)],
    notes: &mut Vec<String>,
) -> Result<Draft, CorrectionError> {
    for (index, &(role, joint)) in known.iter().enumerate() {
        if known[..index].iter().any(|&(other, at)| other == role || at == joint) {
            return Err(CorrectionError::Twice(role));
        }
    }
    let human = known.iter().map(|&(role, _)| role).find(|role| HUMANOID_ROLES.contains(role));
    if let Some(role) = human.filter(|_| !draft.humanoid) {
        draft = scene.known_draft(known).map_err(|missing| CorrectionError::NotHuman { role, missing })?;
        notes.retain(|note| !note.starts_with("no human shape"));
    }
    if draft.humanoid && is_seen_mirrored(scene, &draft, known) {
        draft.left = -draft.left;
        for guess in draft.roles.iter_mut().flatten() {
            guess.role = guess.role.mirror();
        }
        notes.push("left and right are as they were given: the body faces the other way".into());
    }
    for &(role, joint) in known {
        assign(&mut draft, role, joint)?;
    }
    let has_hips = || draft.roles.iter().any(|guess| guess.is_some_and(|guess| guess.role == Role::Hips));
    if draft.humanoid && !has_hips() {
        let role = known.first().map_or(Role::Hips, |&(role, _)| role);
        return Err(CorrectionError::NotHuman { role, missing: vec![Role::Hips] });
    }
    if !known.is_empty() {
        notes.push("some roles are those that were given".into());
    }
    Ok(draft)
}

/// True if every known joint with a side is on the other side of the body in the draft.
fn is_seen_mirrored(scene: &Scene<'_>, draft: &Draft, known: &[(Role, JointIdx)]) -> bool {
    let mut sided = known.iter().filter(|(role, _)| role.side().is_some()).peekable();
    sided.peek().is_some()
        && sided.all(|&(role, joint)| {
            let toward_left = scene.toward(draft.left, joint);
            if role.is_left() { toward_left < 0.0 } else { toward_left > 0.0 }
        })
}

/// Assigns a role to a joint. Creature parts swap roles, because each has one; the two sides of a human swap, too.
fn assign(draft: &mut Draft, role: Role, joint: JointIdx) -> Result<(), CorrectionError> {
    let holds = |guess: &Option<RoleGuess>| guess.is_some_and(|guess| guess.role == role);
    let holder = draft.roles.iter().position(holds);
    let before = draft.roles[joint];
    if before.is_none() && !draft.humanoid {
        return Err(CorrectionError::NoPart(role));
    }
    if let Some(holder) = holder.filter(|&holder| holder != joint) {
        let changes = |guess: &RoleGuess| !draft.humanoid || guess.role == role.mirror();
        draft.roles[holder] = before.filter(changes);
    }
    draft.roles[joint] = Some(RoleGuess::new(role, Basis::Stated));
    Ok(())
}
