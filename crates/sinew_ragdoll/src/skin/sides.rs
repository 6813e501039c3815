//! Compares left with right and checks that limbs are connected, from the definition alone.

use crate::build::bones::Bones;
use crate::def::{RagdollDef, RagdollJointDef};
use crate::tuning::BURDENED;
use crate::tuning::{LOOSE, MIDDLE, MIRRORED};
use sinew_anim::roles::Role;
use sinew_math::{Vec3, max};
use sinew_physics::convex::gap;

/// Returns the largest difference between left and right, metres, and the body that has it.
///
/// The compared lengths do not depend on the pose: pivot to body centre, the shape's bounding radius, and the mass
/// difference as a length (a third of the relative difference, times the radius, because mass grows with the cube of a
/// length). A human's part without a counterpart differs by its whole radius. Counterparts of creatures are found by
/// their pivots, and parts without one are not compared: a body with one claw or a sword in one hand is no fault.
pub(super) fn symmetry_error(def: &RagdollDef, bones: &Bones, size: f32) -> (f32, Option<usize>) {
    let mut worst = (0.0, None);
    for body in (1..def.bodies.len()).filter(|&body| !bones.list[body].is_prop) {
        let error = match twin(bones, body, size) {
            Twin::Body(twin) => difference(def, bones, body, twin),
            Twin::Missing => def.bodies[body].shape.bounding_radius(),
            Twin::None => continue,
        };
        if error > worst.0 {
            worst = (error, Some(body));
        }
    }
    worst
}

enum Twin {
    Body(usize),
    Missing,
    None,
}

fn twin(bones: &Bones, body: usize, size: f32) -> Twin {
    if bones.list[body].role.side().is_some() {
        return bones.twin(body).map_or(Twin::Missing, Twin::Body);
    }
    let plane = bones.plane_of_symmetry();
    let head = bones.list[body].head;
    let image = Vec3::new(2.0 * plane - head.x, head.y, head.z);
    if (head.x - plane).abs() < MIDDLE * size {
        return Twin::None;
    }
    let distance = |other: usize| (bones.list[other].head - image).length();
    let others =
        (1..bones.list.len()).filter(|&other| other != body && bones.list[other].role.side().is_none());
    let nearest = others.reduce(|a, b| if distance(b) < distance(a) { b } else { a });
    nearest.filter(|&other| distance(other) < MIRRORED * size).map_or(Twin::None, Twin::Body)
}

fn difference(def: &RagdollDef, bones: &Bones, body: usize, twin: usize) -> f32 {
    if holds(def, bones, body, twin) || holds(def, bones, twin, body) {
        return 0.0;
    }
    let away =
        |body: usize| (def.bodies[body].character_from_body.translation - bones.list[body].head).length();
    let radius = |body: usize| def.bodies[body].shape.bounding_radius();
    let mass = |body: usize| def.bodies[body].mass.mass;
    let larger = max(radius(body), radius(twin));
    let masses = larger * (mass(body) - mass(twin)).abs() / (3.0 * max(max(mass(body), mass(twin)), 1e-9));
    max(max((away(body) - away(twin)).abs(), (radius(body) - radius(twin)).abs()), masses)
}

/// Returns true if the end of a limb is so much larger than the other that its shape must enclose a held object.
fn holds(def: &RagdollDef, bones: &Bones, end: usize, other: usize) -> bool {
    let radius = |body: usize| def.bodies[body].shape.bounding_radius();
    bones.children[end].is_empty() && radius(end) > BURDENED * radius(other)
}

/// Number of joints up to which a body is near the body into which most of its skin continues: four for a thigh whose
/// skin continues into the tail across two hip parts. Feet attached to the root are five joints from their shanks.
const NEAR: usize = 4;

/// Returns the first body attached to a body to which it is not connected. It has one of three defects: most triangle
/// sides from its skin (with its descendants') to other skin lead to a body more than four joints away; or it has no
/// such sides, and its shape is far from its parent's; or it is a part of a limb attached to no part of that limb.
/// `links` are the bodies at both ends of such sides.
pub(super) fn apart(def: &RagdollDef, bones: &Bones, links: &[(usize, usize)], size: f32) -> Option<usize> {
    let is_apart = |joint: &&RagdollJointDef| {
        let far = match neighbour(bones, links, joint.child) {
            Some(other) => bones.distance(joint.child, other) > NEAR,
            None => is_loose(def, joint, size),
        };
        far || !in_order(bones, joint.parent, joint.child)
    };
    def.joints.iter().find(is_apart).map(|joint| joint.child)
}

/// Returns the body outside a subtree to which most links of the subtree lead.
fn neighbour(bones: &Bones, links: &[(usize, usize)], body: usize) -> Option<usize> {
    let mut below = vec![false; bones.list.len()];
    below[body] = true;
    for index in body + 1..below.len() {
        below[index] = bones.list[index].parent.is_some_and(|parent| below[parent]);
    }
    let mut count = vec![0_u32; below.len()];
    for &(a, b) in links {
        match (below[a], below[b]) {
            (true, false) => count[b] += 1,
            (false, true) => count[a] += 1,
            _ => {}
        }
    }
    let most = (0..count.len()).reduce(|a, b| if count[b] > count[a] { b } else { a })?;
    (count[most] > 0).then_some(most)
}

fn is_loose(def: &RagdollDef, joint: &RagdollJointDef, size: f32) -> bool {
    let (parent, child) = (&def.bodies[joint.parent], &def.bodies[joint.child]);
    let gap = gap(&parent.shape, &parent.character_from_body, &child.shape, &child.character_from_body);
    // A gap that cannot be measured does not connect.
    !gap.is_some_and(|gap| gap.distance <= LOOSE * size)
}

/// Returns true if a part of a limb is attached to that limb, where the limb has a part nearer to the trunk.
fn in_order(bones: &Bones, parent: usize, child: usize) -> bool {
    use Role::{Foot, Hand, LimbSegment, LowerArm, LowerLeg, TailSegment, UpperArm, UpperLeg};
    let is = |role| move |other: Role| other == role;
    let on: Box<dyn Fn(Role) -> bool> = match bones.list[child].role {
        LowerArm(side) => Box::new(is(UpperArm(side))),
        Hand(side) => Box::new(is(LowerArm(side))),
        LowerLeg(side) => Box::new(is(UpperLeg(side))),
        Foot(side) => Box::new(is(LowerLeg(side))),
        LimbSegment { limb, segment } => Box::new(
            move |role| matches!(role, LimbSegment { limb: l, segment: s } if l == limb && s < segment),
        ),
        TailSegment(segment) => Box::new(move |role| matches!(role, TailSegment(s) if s < segment)),
        _ => return true,
    };
    on(bones.list[parent].role) || !bones.list.iter().any(|bone| on(bone.role))
}
