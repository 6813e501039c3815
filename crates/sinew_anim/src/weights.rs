//! Repairs skin weights: of vertices without a bone, and of skins whose weights were lost.

use crate::rig::{JointIdx, Primitive, Rig, RigMesh};
use crate::roles::bind_pose;
use crate::skinning::skin_vertices;
use crate::tuning::{FEWEST_OF_A_SKELETON, MOST_COMPARED, NEAREST_FALLOFF};
use sinew_math::{Affine, Vec3, clamp};
use std::collections::BTreeMap;

/// Name of the bone to which Blender's glTF exporter assigns unweighted vertices.
const NEUTRAL_BONE: &str = "neutral_bone";

/// Part of a rig's skin whose weights are replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SkinPart {
    /// Index into [`Rig::meshes`].
    pub mesh: usize,
    /// Index into the mesh's primitives.
    pub primitive: usize,
    /// Indices of the vertices, ascending.
    pub vertices: Vec<usize>,
}

/// Gives unweighted vertices the weights of the nearest skin in the bind pose; returns the changed parts.
///
/// Loose vertices are those of `without`, whose weights the file does not state, and those weighted only to
/// `neutral_bone`, as Blender exports them. A connected piece of the mesh whose vertices are all loose moves rigidly,
/// with the joint that moves the nearest skin most: a hat with the head. Weights are copied from a vertex whose joints
/// all belong to the mesh's own skin; if there is none, vertices stay unchanged.
///
/// The changed parts are sorted by mesh and primitive. For very large meshes not every vertex is compared.
///
/// # Panics
/// If the rig's indices or those of `without` are out of range.
pub fn weigh_loose_vertices(rig: &mut Rig, without: &[SkinPart]) -> Vec<SkinPart> {
    let loose = loose_vertices(rig, without);
    if loose.is_empty() {
        return loose;
    }
    let model = bind_pose(rig);
    let donors = donors(rig, &loose, &model);
    let mut changed = Vec::new();
    for part in loose {
        let Some(skin) = rig.meshes[part.mesh].skin else { continue };
        let slot_of: BTreeMap<JointIdx, u16> = rig.skins[skin].joints.iter().copied().zip(0..).collect();
        let has = |donor: &&Donor| donor.weights.iter().all(|(joint, _)| slot_of.contains_key(joint));
        let own: Vec<&Donor> = donors.iter().filter(has).collect();
        if own.is_empty() {
            continue;
        }
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        skin_vertices(rig, part.mesh, part.primitive, &model, &mut positions, &mut normals);
        let stride = 1 + own.len().saturating_mul(part.vertices.len()) / MOST_COMPARED;
        let nearest = |&vertex: &usize| nearest(&own, stride, positions[vertex]);
        let nearest: Vec<(&Donor, f32)> = part.vertices.iter().map(nearest).collect();
        let primitive = &mut rig.meshes[part.mesh].primitives[part.primitive];
        let piece_of = pieces(primitive);
        // The nearest donor of each piece whose vertices are all loose; `None` for other pieces.
        let mut of_piece: BTreeMap<usize, Option<(&Donor, f32)>> = BTreeMap::new();
        for (&vertex, &found) in part.vertices.iter().zip(&nearest) {
            let best = of_piece.entry(piece_of[vertex]).or_insert(Some(found));
            *best = best.map(|best| if found.1 < best.1 { found } else { best });
        }
        for vertex in (0..piece_of.len()).filter(|vertex| part.vertices.binary_search(vertex).is_err()) {
            of_piece.insert(piece_of[vertex], None);
        }
        for (&vertex, &(own, _)) in part.vertices.iter().zip(&nearest) {
            let (slots, weights) = match of_piece[&piece_of[vertex]] {
                Some((donor, _)) => ([slot_of[&donor.strongest()], 0, 0, 0], [1.0, 0.0, 0.0, 0.0]),
                None => own.in_slots(&slot_of),
            };
            (primitive.joints[vertex], primitive.weights[vertex]) = (slots, weights);
        }
        changed.push(part);
    }
    changed
}

/// Loose vertices by mesh and primitive.
fn loose_vertices(rig: &Rig, without: &[SkinPart]) -> Vec<SkinPart> {
    let is_neutral = |joint: JointIdx| rig.joints[joint].name.starts_with(NEUTRAL_BONE);
    let mut loose = Vec::new();
    for (m, mesh) in rig.meshes.iter().enumerate() {
        let Some(skin) = mesh.skin.map(|skin| &rig.skins[skin]) else { continue };
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let mut vertices: Vec<usize> = (0..primitive.weights.len())
                .filter(|&vertex| {
                    influences(primitive, vertex).all(|(slot, _)| is_neutral(skin.joints[slot]))
                })
                .collect();
            let stated = without.iter().filter(|part| part.mesh == m && part.primitive == p);
            vertices.extend(stated.flat_map(|part| &part.vertices));
            vertices.sort_unstable();
            vertices.dedup();
            if !vertices.is_empty() {
                loose.push(SkinPart { mesh: m, primitive: p, vertices });
            }
        }
    }
    loose
}

/// Returns slots and weights of a vertex, for weights above 0.
fn influences(primitive: &Primitive, vertex: usize) -> impl Iterator<Item = (usize, f32)> {
    let slots = primitive.joints[vertex].into_iter().map(usize::from);
    slots.zip(primitive.weights[vertex]).filter(|&(_, weight)| weight > 0.0)
}

/// A vertex whose weights may be copied.
struct Donor {
    /// Position in model space in the bind pose, file units.
    at: Vec3,
    /// Joints and their weights.
    weights: Vec<(JointIdx, f32)>,
}

impl Donor {
    fn strongest(&self) -> JointIdx {
        let most = self.weights.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a });
        most.map_or(0, |(joint, _)| joint)
    }

    fn in_slots(&self, slot_of: &BTreeMap<JointIdx, u16>) -> ([u16; 4], [f32; 4]) {
        let (mut slots, mut weights) = ([0; 4], [0.0; 4]);
        for (at, &(joint, weight)) in self.weights.iter().enumerate() {
            (slots[at], weights[at]) = (slot_of[&joint], weight);
        }
        (slots, weights)
    }
}

/// Returns the vertices that are not loose.
fn donors(rig: &Rig, loose: &[SkinPart], model: &[Affine]) -> Vec<Donor> {
    let mut donors = Vec::new();
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for (m, mesh) in rig.meshes.iter().enumerate() {
        let Some(skin) = mesh.skin.map(|skin| &rig.skins[skin]) else { continue };
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let part = loose.iter().find(|part| part.mesh == m && part.primitive == p);
            let is_loose = |vertex| part.is_some_and(|part| part.vertices.binary_search(&vertex).is_ok());
            skin_vertices(rig, m, p, model, &mut positions, &mut normals);
            for vertex in (0..primitive.weights.len()).filter(|&vertex| !is_loose(vertex)) {
                let weights = influences(primitive, vertex).map(|(slot, weight)| (skin.joints[slot], weight));
                donors.push(Donor { at: positions[vertex], weights: weights.collect() });
            }
        }
    }
    donors.retain(|donor| donor.at.is_finite() && !donor.weights.is_empty());
    donors
}

fn nearest<'d>(donors: &[&'d Donor], stride: usize, at: Vec3) -> (&'d Donor, f32) {
    let away = |donor: &&'d Donor| (*donor, (donor.at - at).length_squared());
    let all = donors.iter().step_by(stride).map(away);
    all.min_by(|a, b| a.1.total_cmp(&b.1)).expect("there are donors")
}

/// Returns the piece of each vertex: the smallest index connected to it by triangles. Coinciding vertices are
/// connected.
fn pieces(primitive: &Primitive) -> Vec<usize> {
    let mut parent: Vec<usize> = (0..primitive.positions.len()).collect();
    let root = |parent: &mut Vec<usize>, mut at: usize| {
        while parent[at] != at {
            parent[at] = parent[parent[at]];
            at = parent[at];
        }
        at
    };
    let mut join = |a: usize, b: usize| {
        let (a, b) = (root(&mut parent, a), root(&mut parent, b));
        parent[usize::max(a, b)] = usize::min(a, b);
    };
    let mut first_at = BTreeMap::new();
    for (vertex, place) in primitive.positions.iter().enumerate() {
        join(*first_at.entry(place.to_array().map(f32::to_bits)).or_insert(vertex), vertex);
    }
    for corners in primitive.indices.chunks_exact(3) {
        join(corners[0] as usize, corners[1] as usize);
        join(corners[1] as usize, corners[2] as usize);
    }
    (0..parent.len()).map(|vertex| root(&mut parent, vertex)).collect()
}

/// Detects lost vertex weights: returns the joint that moves all skin, although the rig's skins have several joints, so
/// that the skin would move as one piece. `None` if more than one joint moves skin, or if rigid meshes are attached to
/// bones, as in a machine.
///
/// # Panics
/// If the rig's indices are out of range.
pub fn lost_weights(rig: &Rig) -> Option<JointIdx> {
    let mut joints: Vec<JointIdx> = rig.skins.iter().flat_map(|skin| skin.joints.clone()).collect();
    joints.sort_unstable();
    joints.dedup();
    let is_rigid = |mesh: &RigMesh| {
        let mut line = core::iter::successors(Some(mesh.joint), |&at| rig.joints[at].parent);
        mesh.skin.is_none() && line.any(|at| joints.binary_search(&at).is_ok())
    };
    if joints.len() < FEWEST_OF_A_SKELETON || rig.meshes.iter().any(is_rigid) {
        return None;
    }
    let mut mover = None;
    for mesh in &rig.meshes {
        let Some(skin) = mesh.skin.map(|skin| &rig.skins[skin]) else { continue };
        for primitive in &mesh.primitives {
            for vertex in 0..primitive.weights.len() {
                for (slot, _) in influences(primitive, vertex) {
                    let joint = skin.joints[slot];
                    if *mover.get_or_insert(joint) != joint {
                        return None;
                    }
                }
            }
        }
    }
    mover
}

/// Gives every vertex of every skin new weights by its distance from the bones in the bind pose, for a rig whose own
/// weights were [lost](lost_weights).
///
/// A bone runs from a joint of the skin to each of its children in the skin; a childless joint is a point. A vertex is
/// weighted to the nearest bone and the bones that meet it, by the inverse fourth power of the distance, so that an
/// arm at the side does not pull the trunk. A root with a single child does not count as a bone, because it is usually
/// on the ground between the feet.
///
/// Returns the changed parts, all vertices of each.
///
/// # Panics
/// If the rig's indices are out of range.
pub fn weigh_by_nearness(rig: &mut Rig) -> Vec<SkinPart> {
    let model = bind_pose(rig);
    let mut changed = Vec::new();
    let (mut positions, mut normals) = (Vec::new(), Vec::new());
    for m in 0..rig.meshes.len() {
        let Some(skin) = rig.meshes[m].skin else { continue };
        let bones = bones(rig, skin, &model);
        for p in (0..rig.meshes[m].primitives.len()).filter(|_| !bones.is_empty()) {
            if rig.meshes[m].primitives[p].weights.is_empty() {
                continue;
            }
            skin_vertices(rig, m, p, &model, &mut positions, &mut normals);
            let primitive = &mut rig.meshes[m].primitives[p];
            for (vertex, &at) in positions.iter().enumerate() {
                (primitive.joints[vertex], primitive.weights[vertex]) = weights_of_bones(&bones, at);
            }
            changed.push(SkinPart { mesh: m, primitive: p, vertices: (0..positions.len()).collect() });
        }
    }
    changed
}

/// Bone of a skin, in the bind pose.
struct Bone {
    slot: u16,
    /// Slots of the joints above and below the bone.
    meets: Vec<u16>,
    from: Vec3,
    to: Vec3,
}

impl Bone {
    fn distance_squared(&self, at: Vec3) -> f32 {
        distance_squared(at, [self.from, self.to])
    }
}

/// Squared distance from a point to the segment between two others, in the square of their unit.
pub(crate) fn distance_squared(at: Vec3, [from, to]: [Vec3; 2]) -> f32 {
    let along = to - from;
    let length = along.length_squared();
    let share = if length > 0.0 { clamp((at - from).dot(along) / length, 0.0, 1.0) } else { 0.0 };
    (from + along * share - at).length_squared()
}

fn bones(rig: &Rig, skin: usize, model: &[Affine]) -> Vec<Bone> {
    let joints = &rig.skins[skin].joints;
    let slot_of: BTreeMap<JointIdx, u16> = joints.iter().copied().zip(0..).collect();
    let above = |joint: JointIdx| {
        core::iter::successors(rig.joints[joint].parent, |&at| rig.joints[at].parent)
            .find_map(|at| slot_of.get(&at).copied())
    };
    let mut below: Vec<Vec<u16>> = vec![Vec::new(); joints.len()];
    for (&joint, &slot) in &slot_of {
        if let Some(parent) = above(joint) {
            below[usize::from(parent)].push(slot);
        }
    }
    let place = |slot: u16| model[joints[usize::from(slot)]].translation;
    let mut bones = Vec::new();
    for (&joint, &slot) in &slot_of {
        let (parent, children) = (above(joint), &below[usize::from(slot)]);
        if parent.is_none() && children.len() == 1 {
            continue;
        }
        let meets: Vec<u16> = parent.into_iter().chain(children.iter().copied()).collect();
        let ends = if children.is_empty() { vec![slot] } else { children.clone() };
        bones.extend(ends.into_iter().map(|end| Bone {
            slot,
            meets: meets.clone(),
            from: place(slot),
            to: place(end),
        }));
    }
    bones.retain(|bone| bone.from.is_finite() && bone.to.is_finite());
    bones
}

fn weights_of_bones(bones: &[Bone], at: Vec3) -> ([u16; 4], [f32; 4]) {
    let mut distance: BTreeMap<u16, f32> = BTreeMap::new();
    for bone in bones {
        let away = bone.distance_squared(at);
        let least = distance.entry(bone.slot).or_insert(away);
        *least = sinew_math::min(*least, away);
    }
    let least = distance.iter().min_by(|a, b| a.1.total_cmp(b.1)).map(|(&slot, &away)| (slot, away));
    let Some((first, away)) = least else { return ([0; 4], [1.0, 0.0, 0.0, 0.0]) };
    let mut near: Vec<(u16, f32)> = vec![(first, 1.0)];
    for bone in bones.iter().filter(|bone| bone.slot == first) {
        for &slot in bone.meets.iter().filter(|slot| distance.contains_key(slot)) {
            let share = away / sinew_math::max(distance[&slot], f32::MIN_POSITIVE);
            if near.iter().all(|&(known, _)| known != slot) && share * share >= NEAREST_FALLOFF {
                near.push((slot, share * share));
            }
        }
    }
    near.sort_by(|a, b| b.1.total_cmp(&a.1));
    near.truncate(4);
    let sum: f32 = near.iter().map(|(_, share)| share).sum();
    let (mut slots, mut weights) = ([0; 4], [0.0; 4]);
    for (at, (slot, share)) in near.into_iter().enumerate() {
        (slots[at], weights[at]) = (slot, share / sum);
    }
    (slots, weights)
}
