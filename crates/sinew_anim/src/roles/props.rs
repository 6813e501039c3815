//! Props: swords, shields and rigid capes as unskinned meshes on a bone of the body.
//!
//! A hat that hardly extends beyond the head moves with it. Parts that extend farther get a fixed body of their own,
//! so that they do not sink into the floor.

use super::bind::Bound;
use super::keep::Kept;
use super::role::Role;
use super::{Basis, KeptBone, RoleGuess};
use crate::rig::{JointIdx, Rig};
use crate::roles::tuning::{LEAST_PROP, PROP_BEYOND, PROP_CONFIDENCE, PROP_SHARE};
use crate::skinning::skin_vertices;
use sinew_math::{Vec3, max, max3, min3};

/// An axis-aligned box in model space, file units.
#[derive(Clone, Copy)]
struct Extent {
    lo: Vec3,
    hi: Vec3,
}

impl Extent {
    fn with(of: Option<Self>, point: Vec3) -> Option<Self> {
        let Self { lo, hi } = of.unwrap_or(Self { lo: point, hi: point });
        Some(Self { lo: min3(lo, point), hi: max3(hi, point) })
    }

    fn longest(&self) -> f32 {
        let sides = self.hi - self.lo;
        max(sides.x, max(sides.y, sides.z))
    }

    /// Largest distance of a point from the box along one of its axes.
    fn beyond(&self, point: Vec3) -> f32 {
        let (below, above) = (self.lo - point, point - self.hi);
        max(max(max(below.x, above.x), max(below.y, above.y)), max(below.z, above.z))
    }
}

/// A joint with all joints of its carrier below it, which have meshes but no skin.
struct Prop {
    joint: JointIdx,
    /// Index into the kept bones.
    carrier: usize,
    points: Vec<Vec3>,
}

/// Gives protruding props their own bone, with the role of the next free limb.
pub(super) fn keep_props(rig: &Rig, bound: &Bound, kept: &mut Kept, roles: &mut [Option<RoleGuess>]) {
    let mut owner = vec![None; rig.joints.len()];
    for (index, bone) in kept.bones.iter().enumerate() {
        bone.merged.iter().chain([&bone.joint]).for_each(|&joint| owner[joint] = Some(index));
    }
    let props = props(rig, bound, kept, &owner);
    if props.is_empty() {
        return;
    }
    let carriers = carriers(rig, bound, &owner, kept.bones.len());
    for prop in props {
        let Some(carrier) = carriers[prop.carrier] else { continue };
        let Some(extent) = prop.points.iter().fold(None, |extent, &point| Extent::with(extent, point)) else {
            continue;
        };
        let out =
            prop.points.iter().filter(|&&point| carrier.beyond(point) > PROP_BEYOND * bound.size()).count();
        let sticks_out = out as f32 > PROP_SHARE * prop.points.len() as f32;
        if sticks_out && extent.longest() > LEAST_PROP * bound.size() {
            insert(rig, bound, kept, roles, &prop);
        }
    }
}

/// Returns rigid meshes on joints below a kept bone, grouped by the highest joint above them without skin in its
/// subtree.
fn props(rig: &Rig, bound: &Bound, kept: &Kept, owner: &[Option<usize>]) -> Vec<Prop> {
    let mut moves_skin: Vec<bool> = bound.area.iter().map(|&area| area > 0.0).collect();
    for joint in (0..rig.joints.len()).rev() {
        if let Some(parent) = rig.joints[joint].parent.filter(|_| moves_skin[joint]) {
            moves_skin[parent] = true;
        }
    }
    let swings = swings(rig);
    let is_held = |joint: JointIdx, carrier: usize| {
        let is_joint_of_carrier = kept.bones[carrier].joint == joint;
        owner[joint] == Some(carrier) && !is_joint_of_carrier && !moves_skin[joint] && !swings[joint]
    };
    let mut props: Vec<Prop> = Vec::new();
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for (m, mesh) in rig.meshes.iter().enumerate().filter(|(_, mesh)| mesh.skin.is_none()) {
        let Some(carrier) = owner[mesh.joint].filter(|&carrier| is_held(mesh.joint, carrier)) else {
            continue;
        };
        let mut joint = mesh.joint;
        while let Some(parent) = rig.joints[joint].parent.filter(|&parent| is_held(parent, carrier)) {
            joint = parent;
        }
        let known = props.iter().position(|prop| prop.joint == joint);
        let at = known.unwrap_or_else(|| {
            props.push(Prop { joint, carrier, points: Vec::new() });
            props.len() - 1
        });
        for p in 0..mesh.primitives.len() {
            skin_vertices(rig, m, p, &bound.model, &mut positions, &mut normals);
            props[at].points.extend(positions.iter().filter(|point| point.is_finite()));
        }
    }
    props
}

/// Returns boxes of the skin that each kept bone moves most, in the bind pose; `None` without skin.
fn carriers(rig: &Rig, bound: &Bound, owner: &[Option<usize>], bones: usize) -> Vec<Option<Extent>> {
    let mut extents: Vec<Option<Extent>> = vec![None; bones];
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for (m, mesh) in rig.meshes.iter().enumerate() {
        let Some(skin) = mesh.skin.map(|skin| &rig.skins[skin]) else { continue };
        for (p, primitive) in mesh.primitives.iter().enumerate().filter(|(_, p)| !p.joints.is_empty()) {
            skin_vertices(rig, m, p, &bound.model, &mut positions, &mut normals);
            for (index, &position) in positions.iter().enumerate() {
                let slots = primitive.joints[index].into_iter().zip(primitive.weights[index]);
                let most = slots.reduce(|a, b| if b.1 > a.1 { b } else { a });
                let bone = most.and_then(|(slot, _)| owner[skin.joints[usize::from(slot)]]);
                if let Some(bone) = bone.filter(|_| position.is_finite()) {
                    extents[bone] = Extent::with(extents[bone], position);
                }
            }
        }
    }
    extents
}

fn insert(rig: &Rig, bound: &Bound, kept: &mut Kept, roles: &mut [Option<RoleGuess>], prop: &Prop) {
    let joint = prop.joint;
    let is_below = |mut at: JointIdx| loop {
        if at == joint {
            return true;
        }
        match rig.joints[at].parent {
            Some(parent) => at = parent,
            None => return false,
        }
    };
    let merged = core::mem::take(&mut kept.bones[prop.carrier].merged);
    let (own, rest): (Vec<JointIdx>, Vec<JointIdx>) = merged.into_iter().partition(|&at| is_below(at));
    kept.bones[prop.carrier].merged = rest;
    let limbs = kept.bones.iter().filter_map(|bone| match bone.role {
        Role::LimbSegment { limb, .. } => Some(limb.saturating_add(1)),
        _ => None,
    });
    let role = Role::LimbSegment { limb: limbs.max().unwrap_or(0), segment: 0 };
    roles[joint] = Some(RoleGuess { confidence: PROP_CONFIDENCE, ..RoleGuess::new(role, Basis::Place) });
    for &at in &own {
        kept.merge_into[at] = Some(joint);
    }
    kept.merge_into[joint] = None;
    kept.bones.push(KeptBone {
        joint,
        role,
        confidence: PROP_CONFIDENCE,
        parent: Some(prop.carrier),
        merged: own.into_iter().filter(|&at| at != joint).collect(),
        bind_model: bound.model[joint],
        is_prop: true,
    });
}

/// True for joints that the file's springs move; their meshes are hair or cloth, not props.
fn swings(rig: &Rig) -> Vec<bool> {
    let mut swings = vec![false; rig.joints.len()];
    let bones = rig.springs.chains.iter().flat_map(|chain| &chain.bones);
    bones.for_each(|bone| swings[bone.joint] = true);
    for joint in 0..swings.len() {
        swings[joint] |= rig.joints[joint].parent.is_some_and(|parent| swings[parent]);
    }
    swings
}
