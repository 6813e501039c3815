//! Mirror images of motions for any rig.
//!
//! Local rotations cannot be mirrored, because their axes differ from rig to rig. Instead the rotations since the bind
//! pose are mirrored, in the character's own axes.

use super::CharacterDef;
use crate::character::tuning::{MIRROR_TOLERANCE, MOVED};
use sinew_anim::{JointIdx, LocalTransform, Rig, local_to_model};
use sinew_math::{Affine, Rotation, Transform, Vec3};

/// Counterpart of each joint on the other side of the body.
#[derive(Clone, Debug)]
pub(super) struct Mirror {
    /// Counterpart of each joint; a joint of the midline, or one without a counterpart, is its own.
    twins: Vec<JointIdx>,
    /// True for one-sided parts, such as a sword in one hand: they stay on their limb.
    one_sided: Vec<bool>,
    /// Rotations of the bind pose, character space.
    bind: Vec<Rotation>,
}

impl Mirror {
    pub fn new(def: &CharacterDef) -> Self {
        let bind: Vec<Transform> = def.bind().iter().map(Affine::to_rigid).collect();
        let mut twins = by_places(&def.rig, &bind, MIRROR_TOLERANCE * def.ragdoll.height);
        by_roles(def, &mut twins);
        // A joint is one-sided if its counterpart has another counterpart.
        let seen = twins.clone();
        for (joint, twin) in twins.iter_mut().enumerate() {
            if seen[*twin] != joint {
                *twin = joint;
            }
        }
        let mut one_sided: Vec<bool> = Vec::with_capacity(twins.len());
        for (joint, node) in def.rig.joints.iter().enumerate() {
            let is_below = node.parent.is_some_and(|parent| twins[parent] != parent || one_sided[parent]);
            one_sided.push(twins[joint] == joint && is_below);
        }
        Self { twins, one_sided, bind: bind.iter().map(|bind| bind.rotation).collect() }
    }

    /// Returns the mirror image of a pose whose root motion is in the pelvis. A joint with an animated translation gets
    /// the mirrored translation of its counterpart; other joints keep their own, because the two sides of a rig may
    /// differ.
    pub fn pose(&self, def: &CharacterDef, pose: &[LocalTransform]) -> Vec<LocalTransform> {
        let (rig, mapping) = (&def.rig, def.mapping());
        let root = mapping.character_from_model();
        let mut shown = Vec::new();
        local_to_model(rig, pose, &root, &mut shown);
        let mut image = pose.to_vec();
        let mut made: Vec<Affine> = Vec::with_capacity(pose.len());
        for (joint, node) in rig.joints.iter().enumerate() {
            let parent = node.parent.map_or(root, |parent| made[parent]);
            if self.one_sided[joint] {
                made.push(parent * image[joint].to_affine());
                continue;
            }
            let twin = self.twins[joint];
            if !mapping.carries(joint) {
                let turned = shown[twin].to_rigid().rotation * self.bind[twin].inverse();
                let wanted = reflected(turned) * self.bind[joint];
                image[joint].rotation = (parent.to_rigid().rotation.inverse() * wanted).normalize();
            }
            let is_head = mapping.heads().any(|head| head == joint);
            image[joint].translation = match rig.joints[twin].parent {
                Some(above) if !is_head && is_moved(rig, pose, twin) => {
                    let offset = across(shown[twin].translation - shown[above].translation);
                    parent.inverse().point(parent.translation + offset)
                }
                _ if is_head => parent.inverse().point(across(shown[twin].translation)),
                _ if mapping.carries(joint) => pose[joint].translation,
                _ => node.rest.translation,
            };
            made.push(parent * image[joint].to_affine());
        }
        image
    }
}

/// Returns true if a pose translates the joint from its rest position.
fn is_moved(rig: &Rig, pose: &[LocalTransform], joint: JointIdx) -> bool {
    let rest = rig.joints[joint].rest.translation;
    (pose[joint].translation - rest).length() > MOVED * rest.length()
}

fn across(v: Vec3) -> Vec3 {
    Vec3::new(-v.x, v.y, v.z)
}

/// Returns the same rotation mirrored across x.
fn reflected(q: Rotation) -> Rotation {
    Rotation::from_xyzw(q.x, -q.y, -q.z, q.w)
}

/// Returns counterparts according to the positions of joints in the bind pose: among the children of two counterparts,
/// the joint nearest to the mirror image of the other.
fn by_places(rig: &Rig, bind: &[Transform], tolerance: f32) -> Vec<JointIdx> {
    let mut twins: Vec<JointIdx> = Vec::with_capacity(bind.len());
    for (joint, node) in rig.joints.iter().enumerate() {
        let below = node.parent.map(|parent| twins[parent]);
        let image = across(bind[joint].translation);
        let distance = |other: JointIdx| (bind[other].translation - image).length();
        let nearest = (0..bind.len())
            .filter(|&other| rig.joints[other].parent == below)
            .reduce(|a, b| if distance(b) < distance(a) { b } else { a });
        twins.push(nearest.filter(|&other| distance(other) <= tolerance).unwrap_or(joint));
    }
    twins
}

/// Sets counterparts by the roles of the bodies, which are more reliable than positions.
fn by_roles(def: &CharacterDef, twins: &mut [JointIdx]) {
    for body in &def.ragdoll.bodies {
        let Some(part) = body.role.strip_prefix("left") else { continue };
        let other = def.ragdoll.bodies.iter().find(|other| other.role.strip_prefix("right") == Some(part));
        if let Some(other) = other {
            (twins[body.joint], twins[other.joint]) = (other.joint, body.joint);
        }
    }
}
