//! Meshes and skins.

use super::material::{self, Materials};
use super::{affine, index, vector};
use crate::error::{Error, Result};
use crate::gltf::strongest_four;
use sinew_anim::weights::SkinPart;
use sinew_anim::{Primitive, Rig, RigMesh, Skin};
use sinew_math::{Vec2, Vec3, normalize_or};
use std::collections::BTreeMap;
use ufbx::{MeshPart, Scene, SkinDeformer};

/// Reads one mesh for each node that places one. Returns the vertices of skinned meshes without weights.
pub(super) fn read_all(
    scene: &Scene,
    rig: &mut Rig,
    materials: &mut Materials<'_, '_>,
) -> Result<Vec<SkinPart>> {
    let mut without = Vec::new();
    for node in &scene.nodes {
        let (Some(mesh), Some(joint)) = (node.mesh.as_ref(), index(node)) else { continue };
        if !mesh.vertex_position.exists {
            continue;
        }
        let name = mesh.element.name.to_string();
        let name = if name.is_empty() { node.element.name.to_string() } else { name };
        let skin = match mesh.skin_deformers.first() {
            Some(deformer) => Slots::of(deformer, &name, rig)?,
            None => None,
        };
        let mut primitives = Vec::new();
        for part in mesh.material_parts.iter().filter(|part| part.num_triangles > 0) {
            let (mut primitive, vertices) = Corners::new(mesh, skin.as_ref(), &name).read(part)?;
            without.push(SkinPart { mesh: rig.meshes.len(), primitive: primitives.len(), vertices });
            (primitive.base_color, primitive.texture) = materials.look(node, mesh, part);
            primitive.material = material::name(node, mesh, part);
            primitives.push(primitive);
        }
        if !primitives.is_empty() {
            rig.meshes.push(RigMesh { name, joint, skin: skin.map(|skin| skin.skin), primitives });
        }
    }
    Ok(without)
}

/// A skin of the rig, with the slot of each cluster of the file.
struct Slots<'a> {
    deformer: &'a SkinDeformer,
    skin: usize,
    /// Slot of each cluster; `None` if no joint carries the cluster.
    of_cluster: Vec<Option<u16>>,
}

impl<'a> Slots<'a> {
    /// Adds the skin to the rig; `None` if the skin has no joint.
    fn of(deformer: &'a SkinDeformer, mesh: &str, rig: &mut Rig) -> Result<Option<Self>> {
        let mut skin = Skin { name: mesh.to_owned(), joints: Vec::new(), inverse_bind: Vec::new() };
        let mut of_cluster = Vec::new();
        for cluster in &deformer.clusters {
            let joint = cluster.bone_node.as_ref().and_then(|node| index(node));
            let slot = joint.and_then(|_| u16::try_from(skin.joints.len()).ok());
            if let (Some(joint), Some(_)) = (joint, slot) {
                skin.joints.push(joint);
                let place = || format!("skin of {mesh:?}, cluster {}", of_cluster.len());
                skin.inverse_bind.push(affine(&cluster.geometry_to_bone, place)?);
            }
            of_cluster.push(slot);
        }
        if skin.joints.is_empty() {
            return Ok(None);
        }
        rig.skins.push(skin);
        Ok(Some(Self { deformer, skin: rig.skins.len() - 1, of_cluster }))
    }

    /// Returns slots and weights of a vertex of the file; `None` if it has no weight.
    fn of_vertex(&self, vertex: usize) -> Option<([u16; 4], [f32; 4])> {
        let range = self.deformer.vertices.get(vertex).map_or(0..0, |vertex| {
            let begin = vertex.weight_begin as usize;
            begin..begin + vertex.num_weights as usize
        });
        let weights = self.deformer.weights.get(range).unwrap_or_default();
        let influence = |weight: &ufbx::SkinWeight| {
            let slot = self.of_cluster.get(weight.cluster_index as usize).copied().flatten()?;
            (weight.weight.is_finite() && weight.weight > 0.0).then_some((slot, weight.weight as f32))
        };
        let influences: Vec<(u16, f32)> = weights.iter().filter_map(influence).collect();
        (!influences.is_empty()).then(|| strongest_four(influences))
    }
}

/// Corners of a mesh's faces; equal corners are merged into one vertex.
struct Corners<'a> {
    mesh: &'a ufbx::Mesh,
    skin: Option<&'a Slots<'a>>,
    name: &'a str,
    known: BTreeMap<[u32; 3], u32>,
    out: Primitive,
    /// Vertices without a weight.
    without: Vec<usize>,
}

impl<'a> Corners<'a> {
    fn new(mesh: &'a ufbx::Mesh, skin: Option<&'a Slots<'a>>, name: &'a str) -> Self {
        Self { mesh, skin, name, known: BTreeMap::new(), out: Primitive::default(), without: Vec::new() }
    }

    /// Returns the primitive, and its vertices without weights.
    fn read(mut self, part: &MeshPart) -> Result<(Primitive, Vec<usize>)> {
        let mut corners = vec![0_u32; self.mesh.max_face_triangles * 3];
        for &face in &part.face_indices {
            let Some(&face) = self.mesh.faces.get(face as usize) else { continue };
            let triangles = ufbx::triangulate_face(&mut corners, self.mesh, face) as usize;
            for &corner in corners.iter().take(3 * triangles) {
                let vertex = self.vertex(corner as usize)?;
                self.out.indices.push(vertex);
            }
        }
        Ok((self.out, self.without))
    }

    /// Returns the vertex of a corner; adds it if it is new.
    fn vertex(&mut self, corner: usize) -> Result<u32> {
        let mesh = self.mesh;
        let place = || format!("mesh {:?}, corner {corner}", self.name);
        let of = |indices: &[u32]| indices.get(corner).copied().unwrap_or(0);
        let key =
            [of(&mesh.vertex_position.indices), of(&mesh.vertex_normal.indices), of(&mesh.vertex_uv.indices)];
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let new = u32::try_from(self.out.positions.len())
            .map_err(|_| Error::unsupported("more vertices than 32 bits can count", place()))?;
        let lost = || Error::malformed("an index is out of range", place());
        let position = mesh.vertex_position.values.get(key[0] as usize).ok_or_else(lost)?;
        let position = vector(*position, place)?;
        if mesh.vertex_normal.exists {
            let normal = vector(*mesh.vertex_normal.values.get(key[1] as usize).ok_or_else(lost)?, place)?;
            self.out.normals.push(normalize_or(normal, Vec3::Y));
        }
        if mesh.vertex_uv.exists {
            let uv = mesh.vertex_uv.values.get(key[2] as usize).ok_or_else(lost)?;
            let uv = Vec2::new(uv.x as f32, 1.0 - uv.y as f32);
            self.out.uvs.push(if uv.is_finite() { uv } else { Vec2::ZERO });
        }
        self.out.positions.push(position);
        if let Some(skin) = self.skin {
            let vertex = mesh.vertex_indices.get(corner).copied().unwrap_or(0) as usize;
            let (slots, weights) = skin.of_vertex(vertex).unwrap_or_else(|| {
                self.without.push(new as usize);
                ([0; 4], [1.0, 0.0, 0.0, 0.0])
            });
            self.out.joints.push(slots);
            self.out.weights.push(weights);
        }
        self.known.insert(key, new);
        Ok(new)
    }
}
