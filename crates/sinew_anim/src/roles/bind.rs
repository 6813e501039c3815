//! The bind pose of joints and skin.

use super::beside::{beside_the_bones, move_side_skeletons};
use super::graph::ancestors;
use super::names::{Part, read_names};
use crate::pose::{local_to_model, rest_pose};
use crate::rig::{JointIdx, LocalTransform, Rig, RigMesh};
use crate::roles::tuning::{BOUND_ALIKE, COINCIDENT, LARGEST_BESIDE};
use crate::skinning::skin_vertices;
use sinew_math::{Affine, Vec3, max3, min3};
use std::collections::BTreeMap;

/// Geometry of a rig in its bind pose, model space, file units.
pub(crate) struct Bound {
    /// Transform of every joint in the bind pose.
    pub model: Vec<Affine>,
    /// Skin area that each joint moves (its weights times the area around the vertices).
    pub area: Vec<f32>,
    /// All skinned vertices.
    pub vertices: Vec<Vec3>,
    /// The joint that moves each vertex most; without skin, the joint itself.
    pub movers: Vec<JointIdx>,
    /// Number of triangle edges between vertices of two joints, by the pair of joints, the smaller index first.
    pub links: BTreeMap<(JointIdx, JointIdx), u32>,
    /// Lower corner of the skin's box.
    pub lo: Vec3,
    /// Upper corner of the skin's box.
    pub hi: Vec3,
}

impl Bound {
    /// Collects the bind pose of a rig; `None` if no finite vertex is bound to a joint.
    pub fn of(rig: &Rig) -> Option<Self> {
        let model = bind_pose(rig);
        let mut bound = Self {
            area: vec![0.0; rig.joints.len()],
            vertices: Vec::new(),
            movers: Vec::new(),
            links: BTreeMap::new(),
            lo: Vec3::splat(f32::INFINITY),
            hi: Vec3::splat(f32::NEG_INFINITY),
            model,
        };
        for (m, mesh) in rig.meshes.iter().enumerate() {
            for p in 0..mesh.primitives.len() {
                bound.add_primitive(rig, m, p);
            }
        }
        if !bound.area.iter().any(|&a| a > 0.0) {
            return None;
        }
        bound.add_rigid_parts(rig);
        Some(bound)
    }

    /// Counts rigid meshes as the skin of their joint if the joint has no skin, and is named as a body part or carries
    /// both legs. Low-poly characters consist of such parts. A mesh beside the skeleton is the skin of a neck or head
    /// without any, if it surrounds that bone.
    fn add_rigid_parts(&mut self, rig: &Rig) {
        let names: Vec<&str> = rig.joints.iter().map(|joint| joint.name.as_str()).collect();
        let parents: Vec<Option<JointIdx>> = rig.joints.iter().map(|joint| joint.parent).collect();
        let readings = read_names(&names, &parents);
        let mut in_skin = vec![false; rig.joints.len()];
        rig.skins.iter().flat_map(|skin| &skin.joints).for_each(|&joint| in_skin[joint] = true);
        let is_bare: Vec<bool> = self.area.iter().map(|&area| area <= 0.0).collect();
        let mut legs = vec![[false; 2]; rig.joints.len()];
        for (thigh, reading) in readings.iter().enumerate() {
            let Some(side) = reading.side.filter(|_| reading.part == Some(Part::UpperLeg)) else { continue };
            ancestors(rig, thigh).for_each(|above| legs[above][side as usize] |= in_skin[thigh]);
        }
        let is_part = |joint: JointIdx| {
            let part = readings[joint].part;
            let is_named = part.is_some_and(|part| !matches!(part, Part::Appendix | Part::Tail));
            is_bare[joint] && (is_named || legs[joint] == [true; 2])
        };
        let has_head = (0..readings.len()).any(|i| readings[i].part == Some(Part::Head) && !is_bare[i]);
        let is_top = |joint: JointIdx| matches!(readings[joint].part, Some(Part::Head | Part::Neck));
        let tops: Vec<JointIdx> = (0..readings.len())
            .filter(|&joint| !has_head && in_skin[joint] && is_bare[joint] && is_top(joint))
            .collect();
        for (m, mesh) in rig.meshes.iter().enumerate().filter(|(_, mesh)| mesh.skin.is_none()) {
            let mut line = core::iter::once(mesh.joint).chain(ancestors(rig, mesh.joint));
            let carrier = match line.find(|&joint| in_skin[joint]) {
                Some(joint) => Some(joint).filter(|&joint| is_part(joint)),
                None => self.surrounded(rig, m, &tops),
            };
            if let Some(carrier) = carrier {
                self.add_rigid(rig, m, carrier);
            }
        }
    }

    fn add_rigid(&mut self, rig: &Rig, mesh: usize, carrier: JointIdx) {
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        for (p, primitive) in rig.meshes[mesh].primitives.iter().enumerate() {
            skin_vertices(rig, mesh, p, &self.model, &mut positions, &mut normals);
            let share = vertex_areas(&positions, &primitive.indices);
            for (&position, share) in positions.iter().zip(share) {
                if position.is_finite() && share.is_finite() {
                    self.add_vertex(position, carrier);
                    self.area[carrier] += share;
                }
            }
        }
    }

    /// Returns the bone of `bones` whose middle is inside the box of a mesh; of several the last.
    fn surrounded(&self, rig: &Rig, mesh: usize, bones: &[JointIdx]) -> Option<JointIdx> {
        if bones.is_empty() {
            return None;
        }
        let (mut lo, mut hi) = (Vec3::splat(f32::INFINITY), Vec3::splat(f32::NEG_INFINITY));
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        for p in 0..rig.meshes[mesh].primitives.len() {
            skin_vertices(rig, mesh, p, &self.model, &mut positions, &mut normals);
            positions.iter().for_each(|&at| (lo, hi) = (min3(lo, at), max3(hi, at)));
        }
        let middle = |bone: JointIdx| {
            let end = (0..rig.joints.len()).find(|&joint| rig.joints[joint].parent == Some(bone));
            let start = self.model[bone].translation;
            end.map_or(start, |end| (start + self.model[end].translation) * 0.5)
        };
        let is_inside = |at: Vec3| at.cmpge(lo).all() && at.cmple(hi).all();
        bones.iter().copied().rfind(|&bone| is_inside(middle(bone)))
    }

    fn add_vertex(&mut self, position: Vec3, mover: JointIdx) {
        self.vertices.push(position);
        self.movers.push(mover);
        (self.lo, self.hi) = (min3(self.lo, position), max3(self.hi, position));
    }

    /// Collects the bind pose of a skeleton without skin: the length of a bone replaces its skin area, and joints
    /// replace vertices. `None` if no bone has a finite length.
    pub fn of_bones(rig: &Rig, pose: &[LocalTransform]) -> Option<Self> {
        let mut model = Vec::new();
        local_to_model(rig, pose, &Affine::IDENTITY, &mut model);
        let mut is_end = vec![true; rig.joints.len()];
        rig.joints.iter().filter_map(|joint| joint.parent).for_each(|parent| is_end[parent] = false);
        let is_beside = beside_the_skeleton(rig);
        let is_place = |&i: &usize| model[i].translation.is_finite() && !is_beside[i];
        let movers: Vec<JointIdx> = (0..model.len()).filter(is_place).collect();
        let mut bound = Self {
            area: vec![0.0; rig.joints.len()],
            vertices: movers.iter().map(|&joint| model[joint].translation).collect(),
            movers,
            links: BTreeMap::new(),
            lo: Vec3::splat(f32::INFINITY),
            hi: Vec3::splat(f32::NEG_INFINITY),
            model,
        };
        for &at in &bound.vertices {
            (bound.lo, bound.hi) = (min3(bound.lo, at), max3(bound.hi, at));
        }
        // A joint exactly on its parent (CMU's skeletons have eleven) has no separate position, and two joints at one
        // position (clavicles, hips) would each be their own mirror image. Their children belong to the parent.
        let near = COINCIDENT * bound.size();
        let twins = twins(rig, &bound.model, near);
        let mut place: Vec<usize> = (0..rig.joints.len()).collect();
        for (i, joint) in rig.joints.iter().enumerate() {
            let Some(parent) = joint.parent.map(|parent| place[parent]).filter(|_| !is_beside[i]) else {
                continue;
            };
            let bone = (bound.model[i].translation - bound.model[parent].translation).length();
            if bone < near || twins[i] {
                place[i] = parent;
            }
            if bone.is_finite() {
                bound.area[parent] += bone;
            }
        }
        let has_bones = bound.area.iter().any(|&a| a > 0.0);
        let is_named_end = |&i: &usize| is_end[i] && place[i] == i && !rig.joints[i].name.is_empty();
        for i in (0..rig.joints.len()).filter(is_named_end).filter(|&i| !is_beside[i]) {
            // Assumed length of a hand or a head, because the file does not give the length of its bone.
            bound.area[i] = 0.06 * bound.size();
        }
        has_bones.then_some(bound)
    }

    /// The longest side of the skin's box.
    pub fn size(&self) -> f32 {
        let d = self.hi - self.lo;
        sinew_math::max(d.x, sinew_math::max(d.y, d.z))
    }

    fn add_primitive(&mut self, rig: &Rig, m: usize, p: usize) {
        let primitive = &rig.meshes[m].primitives[p];
        let Some(skin) = rig.meshes[m].skin.map(|s| &rig.skins[s]).filter(|_| !primitive.joints.is_empty())
        else {
            return;
        };
        let (mut positions, mut normals) = (Vec::new(), Vec::new());
        skin_vertices(rig, m, p, &self.model, &mut positions, &mut normals);
        let share = vertex_areas(&positions, &primitive.indices);
        let mover = |i: usize| {
            let slots = primitive.joints[i].into_iter().zip(primitive.weights[i]);
            let most = slots.reduce(|a, b| if b.1 > a.1 { b } else { a });
            most.map_or(0, |(slot, _)| skin.joints[usize::from(slot)])
        };
        for corners in primitive.indices.chunks_exact(3) {
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let (a, b) = (mover(corners[a] as usize), mover(corners[b] as usize));
                if a != b {
                    *self.links.entry((usize::min(a, b), usize::max(a, b))).or_insert(0) += 1;
                }
            }
        }
        for (i, &position) in positions.iter().enumerate() {
            if !position.is_finite() || !share[i].is_finite() {
                continue;
            }
            self.add_vertex(position, mover(i));
            for (slot, weight) in primitive.joints[i].into_iter().zip(primitive.weights[i]) {
                if weight > 0.0 {
                    self.area[skin.joints[usize::from(slot)]] += weight * share[i];
                }
            }
        }
    }
}

/// True for each joint of a tree that does not belong to the skeleton: cameras with targets, lamps.
fn beside_the_skeleton(rig: &Rig) -> Vec<bool> {
    let mut root: Vec<usize> = (0..rig.joints.len()).collect();
    let mut size = vec![0; rig.joints.len()];
    for (i, joint) in rig.joints.iter().enumerate() {
        root[i] = joint.parent.map_or(i, |parent| root[parent]);
        size[root[i]] += 1;
    }
    let largest = size.iter().copied().max().unwrap_or(0);
    root.into_iter().map(|root| LARGEST_BESIDE * size[root] < largest).collect()
}

/// True for each joint with a sibling at the same position that has the other side by name, or if both have no name.
fn twins(rig: &Rig, model: &[Affine], tolerance: f32) -> Vec<bool> {
    let names: Vec<&str> = rig.joints.iter().map(|joint| joint.name.as_str()).collect();
    let readings = read_names(&names, &[]);
    let mirrored = |a: usize, b: usize| match (readings[a].side, readings[b].side) {
        (Some(a), Some(b)) => a != b,
        _ => rig.joints[a].name.is_empty() && rig.joints[b].name.is_empty(),
    };
    let mut found = vec![false; rig.joints.len()];
    let mut children: Vec<Vec<usize>> = vec![Vec::new(); rig.joints.len()];
    for (i, joint) in rig.joints.iter().enumerate() {
        let Some(parent) = joint.parent else { continue };
        for &other in &children[parent] {
            let apart = (model[other].translation - model[i].translation).length();
            if apart < tolerance && mirrored(i, other) {
                (found[i], found[other]) = (true, true);
            }
        }
        children[parent].push(i);
    }
    found
}

/// Returns a third of the area of all triangles around each vertex; equal shares if there is no area.
fn vertex_areas(positions: &[Vec3], indices: &[u32]) -> Vec<f32> {
    let mut share = vec![0.0; positions.len()];
    for corners in indices.chunks_exact(3) {
        let [a, b, c] = [corners[0] as usize, corners[1] as usize, corners[2] as usize];
        let doubled = (positions[b] - positions[a]).cross(positions[c] - positions[a]).length();
        for corner in [a, b, c] {
            share[corner] += doubled / 6.0;
        }
    }
    if share.iter().any(|&s| s > 0.0) { share } else { vec![1.0; positions.len()] }
}

/// Model-space transform of every joint in the bind pose. Joints outside all skins follow their parents as in the rest
/// pose.
pub(crate) fn bind_pose(rig: &Rig) -> Vec<Affine> {
    let mut rest = Vec::new();
    local_to_model(rig, &rest_pose(rig), &Affine::IDENTITY, &mut rest);
    let mut bound: Vec<Option<Affine>> = vec![None; rig.joints.len()];
    for mesh in by_weight(rig) {
        let Some(skin) = mesh.skin.map(|s| &rig.skins[s]) else { continue };
        let model_from_mesh = model_from_mesh(rig, mesh, &rest);
        for (&joint, inverse) in skin.joints.iter().zip(&skin.inverse_bind) {
            let place = model_from_mesh * inverse.inverse();
            if bound[joint].is_none() && place.is_finite() {
                bound[joint] = Some(place);
            }
        }
    }
    move_side_skeletons(rig, &rest, &mut bound);
    let beside = beside_the_bones(rig, &rest, &bound);
    let mut model: Vec<Affine> = Vec::with_capacity(rig.joints.len());
    for (i, joint) in rig.joints.iter().enumerate() {
        let hung = joint.parent.map_or(rest[i], |p| model[p] * joint.rest.to_affine());
        model.push(bound[i].or(beside[i]).unwrap_or(hung));
    }
    model
}

/// Returns skinned meshes, the one that defines the bind pose first. A mesh of the trunk comes before a mesh of only a
/// limb or a gun, which may be placed at a posed hand. Then the mesh with the most moving joints comes first, then the
/// one with the most vertices.
fn by_weight(rig: &Rig) -> Vec<&RigMesh> {
    let mut meshes: Vec<&RigMesh> = rig.meshes.iter().filter(|mesh| mesh.skin.is_some()).collect();
    let movers = |mesh: &RigMesh| -> Vec<JointIdx> {
        let skin = &rig.skins[mesh.skin.expect("a skinned mesh")];
        skin.joints
            .iter()
            .zip(moving_slots(rig, mesh))
            .filter_map(|(&joint, moves)| moves.then_some(joint))
            .collect()
    };
    let mut all: Vec<JointIdx> = meshes.iter().flat_map(|mesh| movers(mesh)).collect();
    all.sort_unstable();
    all.dedup();
    let mut carried = vec![0; rig.joints.len()];
    for &joint in &all {
        core::iter::once(joint).chain(ancestors(rig, joint)).for_each(|at| carried[at] += 1);
    }
    let weight = |mesh: &RigMesh| {
        let movers = movers(mesh);
        let is_trunk = movers.iter().any(|&joint| 2 * carried[joint] >= all.len());
        let vertices: usize = mesh.primitives.iter().map(|part| part.positions.len()).sum();
        (is_trunk, movers.len(), vertices)
    };
    meshes.sort_by_cached_key(|mesh| core::cmp::Reverse(weight(mesh)));
    meshes
}

/// For each slot of the mesh's skin, true if it moves a vertex of the mesh.
pub(super) fn moving_slots(rig: &Rig, mesh: &RigMesh) -> Vec<bool> {
    let mut moves = vec![false; mesh.skin.map_or(0, |skin| rig.skins[skin].joints.len())];
    for primitive in &mesh.primitives {
        for (slots, weights) in primitive.joints.iter().zip(&primitive.weights) {
            slots.iter().zip(weights).filter(|(_, weight)| **weight > 0.0).for_each(|(&slot, _)| {
                moves[usize::from(slot)] = true;
            });
        }
    }
    moves
}

/// Transform of the skinned mesh to model space in its bind pose.
///
/// If the rest pose equals the bind pose, every joint gives the same result (joint × inverse bind). Otherwise the
/// mesh's own node is used if any joint confirms it. Otherwise the skinned joint that carries most others of the same
/// bind scale is used: the root of the skeleton, which poses hardly move. Joints without skin are ignored, because a
/// control may be bound anywhere.
fn model_from_mesh(rig: &Rig, mesh: &RigMesh, rest: &[Affine]) -> Affine {
    let skin = &rig.skins[mesh.skin.expect("only skinned meshes are asked for")];
    let moves = moving_slots(rig, mesh);
    let mut carried = vec![0_u32; rig.joints.len()];
    for (&joint, _) in skin.joints.iter().zip(&moves).filter(|(_, moves)| **moves) {
        carried[joint] += 1;
        ancestors(rig, joint).for_each(|ancestor| carried[ancestor] += 1);
    }
    let place = |slot: usize| rest[skin.joints[slot]] * skin.inverse_bind[slot];
    let slots = 0..usize::min(skin.joints.len(), skin.inverse_bind.len());
    let said: Vec<Affine> =
        slots.clone().filter(|&slot| moves[slot]).map(place).filter(Affine::is_finite).collect();
    let votes = |candidate: &Affine| said.iter().filter(|other| alike(candidate, other)).count();
    let best = said
        .iter()
        .map(|candidate| (votes(candidate), candidate))
        .reduce(|a, b| if b.0 > a.0 { b } else { a });
    let Some((count, majority)) = best else { return rest[mesh.joint] };
    if 2 * count > said.len() {
        return *majority;
    }
    if votes(&rest[mesh.joint]) > 0 {
        return rest[mesh.joint];
    }
    // Of joints that carry equally many, take the first.
    let carries = |slot: usize| {
        let joint = skin.joints[slot];
        (carried[joint], core::cmp::Reverse(ancestors(rig, joint).count()))
    };
    // A control joint above the body may be bound in another scale, so it is ignored.
    let size = |place: &Affine| place.linear.x_axis.length();
    let mut sizes: Vec<f32> = said.iter().map(size).collect();
    sizes.sort_by(f32::total_cmp);
    let usual = sizes[sizes.len() / 2];
    let is_alike = |place: &Affine| (size(place) - usual).abs() <= BOUND_ALIKE * usual;
    let root = slots
        .filter(|&slot| place(slot).is_finite() && is_alike(&place(slot)))
        .reduce(|a, b| if carries(b) > carries(a) { b } else { a });
    // A joint that carries less than half of the joints is a limb, which may have any rotation, so the most common
    // rotation decides.
    match root {
        Some(root) if 2 * carries(root).0 as usize >= said.len() => place(root),
        _ => most_alike(&said, is_alike).unwrap_or(*majority),
    }
}

/// Returns the allowed transform whose axes agree most with all others.
fn most_alike(all: &[Affine], passes: impl Fn(&Affine) -> bool) -> Option<Affine> {
    let axes =
        |place: &Affine| [place.linear.x_axis, place.linear.y_axis, place.linear.z_axis].map(Vec3::normalize);
    let likeness = |place: &Affine| {
        let own = axes(place);
        let with = |other: &Affine| axes(other).iter().zip(own).map(|(a, b)| a.dot(b)).sum::<f32>();
        all.iter().filter(|place| passes(place)).map(with).sum::<f32>()
    };
    let scored = all.iter().filter(|place| passes(place)).map(|place| (likeness(place), place));
    scored.reduce(|a, b| if b.0 > a.0 { b } else { a }).map(|(_, place)| *place)
}

/// True if two transforms are equal up to a thousandth of their scale.
pub(super) fn alike(a: &Affine, b: &Affine) -> bool {
    let scale = a.linear.x_axis.length() + b.linear.x_axis.length() + 1e-12;
    let columns = [
        a.linear.x_axis - b.linear.x_axis,
        a.linear.y_axis - b.linear.y_axis,
        a.linear.z_axis - b.linear.z_axis,
    ];
    let moved = (a.translation - b.translation).length();
    columns.iter().all(|d| d.length() < 2e-3 * scale)
        && moved <= 2e-3 * (a.translation.length() + b.translation.length()) + 1e-3 * scale
}
