//! The drawn skin of a character as plain vertices: the bodies that move each vertex, and the sides along which the
//! skin may tear.

use crate::def::RagdollDef;
use crate::fit::surface::carried;
use crate::tuning::SAME_WEIGHTS;
use sinew_anim::roles::{HUMANOID_ROLES, Role};
use sinew_anim::{JointIdx, Primitive, Rig, RigMesh};
use sinew_math::{Affine, Mat3, Vec3};

/// Largest number of vertices measured; larger meshes are sampled at every n-th vertex.
const MOST_VERTICES: usize = 8192;
/// Largest number of triangle sides measured, of those that a pose can stretch.
const MOST_SIDES: usize = 4096;

/// A joint that moves vertices, and their bind positions.
#[derive(Clone, Copy, Debug)]
struct Slot {
    joint: JointIdx,
    /// Transform from mesh space to the joint's space.
    inverse_bind: Affine,
}

/// A vertex in mesh space with slot indices and weights.
#[derive(Clone, Copy, Debug)]
struct Vertex {
    position: Vec3,
    slots: [u32; 4],
    weights: [f32; 4],
}

/// A triangle side whose ends are moved by different joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Side(pub usize, pub usize);

/// The drawn skin: meshes with a skin, and rigid meshes attached to a body's bone. Deterministic samples of large ones.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    slots: Vec<Slot>,
    vertices: Vec<Vertex>,
    /// Body that carries each slot; `None` if no body does.
    owners: Vec<Option<usize>>,
    /// Sampled vertices.
    pub sample: Vec<usize>,
    /// Sides that a pose can stretch, sampled.
    pub sides: Vec<Side>,
    /// Share of all sides that a pose can stretch, 0..=1.
    pub stretchable: f32,
}

impl Surface {
    pub fn of(rig: &Rig, def: &RagdollDef) -> Self {
        let carried = carried(rig, def.bodies.iter().map(|body| (body.joint, body.merged.as_slice())));
        let mut raw = Raw::default();
        for mesh in &rig.meshes {
            raw.add_mesh(rig, mesh, &carried);
        }
        let sample = strided(raw.vertices.len(), MOST_VERTICES);
        let stretchable = raw.sides.len() as f32 / raw.all_sides.max(1) as f32;
        let sides = strided(raw.sides.len(), MOST_SIDES).into_iter().map(|i| raw.sides[i]).collect();
        let owners = raw.slots.iter().map(|slot| carried[slot.joint]).collect();
        Self { slots: raw.slots, vertices: raw.vertices, owners, sample, sides, stretchable }
    }

    /// Returns a surface of only these vertices, with the slots that move them; no sides.
    pub fn part(&self, vertices: &[usize]) -> Self {
        let mut part = Self {
            slots: Vec::new(),
            vertices: Vec::new(),
            owners: Vec::new(),
            sample: (0..vertices.len()).collect(),
            sides: Vec::new(),
            stretchable: 0.0,
        };
        let mut index = vec![u32::MAX; self.slots.len()];
        for &vertex in vertices {
            let mut vertex = self.vertices[vertex];
            for (slot, weight) in vertex.slots.iter_mut().zip(vertex.weights) {
                let old = *slot as usize;
                if weight <= 0.0 {
                    *slot = 0;
                    continue;
                }
                if index[old] == u32::MAX {
                    index[old] = part.slots.len() as u32;
                    part.slots.push(self.slots[old]);
                    part.owners.push(self.owners[old]);
                }
                *slot = index[old];
            }
            part.vertices.push(vertex);
        }
        part
    }

    /// Computes the matrices from mesh space to the space of `model`, one per slot: `palette` is cleared and filled.
    pub fn palette(&self, model: &[Affine], palette: &mut Vec<Affine>) {
        palette.clear();
        palette.extend(self.slots.iter().map(|slot| model[slot.joint] * slot.inverse_bind));
    }

    /// Returns the positions of the sampled vertices in the space of `model`; `palette` is cleared and filled.
    pub fn places(&self, model: &[Affine], palette: &mut Vec<Affine>) -> Vec<Vec3> {
        self.palette(model, palette);
        self.sample.iter().map(|&vertex| self.place(palette, vertex)).collect()
    }

    /// Returns the position of a vertex in the target space of the matrices in `palette`.
    pub fn place(&self, palette: &[Affine], vertex: usize) -> Vec3 {
        let Vertex { position, slots, weights } = self.vertices[vertex];
        // Most of a character's vertices follow one joint.
        if weights[0] >= 1.0 {
            return palette[slots[0] as usize].point(position);
        }
        let mut sum = Affine { linear: Mat3::ZERO, translation: Vec3::ZERO };
        for (slot, weight) in slots.into_iter().zip(weights) {
            if weight > 0.0 {
                let matrix = &palette[slot as usize];
                sum.linear += matrix.linear * weight;
                sum.translation += matrix.translation * weight;
            }
        }
        sum.point(position)
    }

    /// Returns the bodies that move a vertex, with weights: at most four, each once; without weights of joints that no
    /// body carries.
    pub fn pulls(&self, vertex: usize) -> impl Iterator<Item = (usize, f32)> {
        let Vertex { slots, weights, .. } = self.vertices[vertex];
        let mut pulls = [(0_usize, 0.0_f32); 4];
        let mut count = 0;
        for (slot, weight) in slots.into_iter().zip(weights) {
            let Some(body) = self.owners[slot as usize].filter(|_| weight > 0.0) else { continue };
            match pulls[..count].iter_mut().find(|(known, _)| *known == body) {
                Some((_, sum)) => *sum += weight,
                None => {
                    pulls[count] = (body, weight);
                    count += 1;
                }
            }
        }
        pulls.into_iter().take(count)
    }

    /// Returns the bodies at both ends of the sides whose ends are moved by different bodies.
    pub fn links(&self) -> Vec<(usize, usize)> {
        let link = |&Side(a, b): &Side| Some((self.owner(a)?, self.owner(b)?));
        self.sides.iter().filter_map(link).filter(|(a, b)| a != b).collect()
    }

    /// Returns the joint with a body that moves a vertex most; `None` without such a joint.
    pub fn mover(&self, vertex: usize) -> Option<JointIdx> {
        let Vertex { slots, weights, .. } = self.vertices[vertex];
        let on_bodies = slots
            .into_iter()
            .zip(weights)
            .filter(|&(slot, weight)| weight > 0.0 && self.owners[slot as usize].is_some());
        let most = on_bodies.reduce(|a, b| if b.1 > a.1 { b } else { a });
        most.map(|(slot, _)| self.slots[slot as usize].joint)
    }

    /// Returns the body that moves a vertex most; `None` without such a body.
    pub fn owner(&self, vertex: usize) -> Option<usize> {
        self.pulls(vertex).reduce(|a, b| if b.1 > a.1 { b } else { a }).map(|(body, _)| body)
    }
}

/// The full surface before sampling.
#[derive(Default)]
struct Raw {
    slots: Vec<Slot>,
    vertices: Vec<Vertex>,
    sides: Vec<Side>,
    all_sides: usize,
}

impl Raw {
    fn add_mesh(&mut self, rig: &Rig, mesh: &RigMesh, carried: &[Option<usize>]) {
        let first = self.slots.len();
        if let Some(skin) = mesh.skin.map(|skin| &rig.skins[skin]) {
            let slots = skin.joints.iter().zip(&skin.inverse_bind);
            self.slots.extend(slots.map(|(&joint, &inverse_bind)| Slot { joint, inverse_bind }));
        }
        let rigid = self.slots.len();
        self.slots.push(Slot { joint: mesh.joint, inverse_bind: Affine::IDENTITY });
        for primitive in &mesh.primitives {
            let is_skinned = mesh.skin.is_some() && !primitive.joints.is_empty();
            // Scenery in the file is not part of the character.
            if is_skinned || carried[mesh.joint].is_some() {
                self.add_primitive(primitive, is_skinned.then_some(first), rigid);
            }
        }
    }

    /// Adds vertices and sides of a part; `first` is the slot of the part's slot 0, `rigid` that of a part without
    /// weights.
    fn add_primitive(&mut self, primitive: &Primitive, first: Option<usize>, rigid: usize) {
        let base = self.vertices.len();
        for (index, &position) in primitive.positions.iter().enumerate() {
            let (slots, weights) = match first {
                Some(first) => (
                    primitive.joints[index].map(|slot| u32::from(slot) + first as u32),
                    primitive.weights[index],
                ),
                None => ([rigid as u32; 4], [1.0, 0.0, 0.0, 0.0]),
            };
            self.vertices.push(Vertex { position, slots, weights });
        }
        for corner in primitive.indices.chunks_exact(3) {
            let corner = [corner[0] as usize, corner[1] as usize, corner[2] as usize];
            if corner.iter().any(|&at| at >= primitive.positions.len()) {
                continue;
            }
            for [a, b] in [[0, 1], [1, 2], [2, 0]] {
                let (a, b) = (base + corner[a], base + corner[b]);
                self.all_sides += 1;
                if !alike(&self.vertices[a], &self.vertices[b]) {
                    self.sides.push(Side(a, b));
                }
            }
        }
    }
}

/// Returns true if the same joints move both vertices with equal weights.
fn alike(a: &Vertex, b: &Vertex) -> bool {
    let weight = |of: &Vertex, slot: u32| -> f32 {
        of.slots.iter().zip(of.weights).filter(|(at, _)| **at == slot).map(|(_, weight)| weight).sum()
    };
    let mut slots = a.slots.iter().chain(&b.slots);
    slots.all(|&slot| (weight(a, slot) - weight(b, slot)).abs() <= SAME_WEIGHTS)
}

/// Returns at most `most` of the indices below `count`, evenly spread, including the first.
fn strided(count: usize, most: usize) -> Vec<usize> {
    let used = usize::min(count, most);
    // For a count that fits in memory the product does not overflow in 64 bits; 32-bit targets widen it.
    (0..used).map(|k| (k as u64 * count as u64 / used as u64) as usize).collect()
}

/// Returns, for each body, true if a character may stand on its skin: false for a human's hands and forearms and
/// objects that they hold.
pub(crate) fn may_stand(def: &RagdollDef) -> Vec<bool> {
    let is_human = def.bodies[0].role == "hips";
    let may = |role: &str| {
        let role = Role::from_name(role).filter(|role| HUMANOID_ROLES.contains(role));
        !is_human || role.is_some_and(|role| !matches!(role, Role::Hand(_) | Role::LowerArm(_)))
    };
    def.bodies.iter().map(|body| may(&body.role)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_even_and_in_range() {
        assert_eq!(strided(3, 8), [0, 1, 2]);
        assert_eq!(strided(10, 4), [0, 2, 5, 7]);
        assert!(strided(0, 4).is_empty());
    }
}
