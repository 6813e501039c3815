//! Writes changed skins into the user's own file: meshes that became sheets of cloth (a node per particle, a longer
//! skin, new joints and weights), and vertices with changed weights.

use super::Document;
use super::append::Editor;
use crate::error::{Error, Result};
use serde_json::{Map, Value, json};
use sinew_anim::garments::MeshSheet;
use sinew_anim::{JointIdx, Primitive, Rig, RigMesh};
use sinew_math::Affine;
use std::collections::BTreeMap;

/// Component type of accessors.
const U16: u32 = 5123;
const FLOAT: u32 = 5126;
/// Target of buffer views with vertices.
const VERTICES: u32 = 34962;

impl Editor {
    /// Writes the sheets of the document's rig, which its JSON does not contain yet.
    pub(super) fn write_sheets(&mut self, document: &Document) -> Result<()> {
        let rig = &document.rig;
        let mut skins: Vec<usize> = Vec::new();
        for sheet in &rig.sheets {
            self.write_nodes(rig, sheet)?;
            self.write_primitives(rig, &rig.meshes[sheet.mesh], &sheet.primitives)?;
            skins.extend(rig.meshes[sheet.mesh].skin);
        }
        skins.sort_unstable();
        skins.dedup();
        skins.into_iter().try_for_each(|skin| self.write_skin(rig, skin))
    }

    fn write_nodes(&mut self, rig: &Rig, sheet: &MeshSheet) -> Result<()> {
        for &joint in &sheet.joints {
            let joint = &rig.joints[joint];
            let node = self.push(
                "nodes",
                json!({"name": joint.name, "translation": joint.rest.translation.to_array()}),
            )?;
            if node != joint.source {
                let what = format!("the joints of a sheet begin at node {node}, not {}", joint.source);
                return Err(Error::malformed(what, "nodes"));
            }
            if let Some(parent) = joint.parent {
                let children = self.entry("nodes", rig.joints[parent].source)?;
                let children = children.entry("children").or_insert_with(|| json!([]));
                children
                    .as_array_mut()
                    .ok_or_else(|| Error::malformed("must be an array", "children"))?
                    .push(node.into());
            }
        }
        Ok(())
    }

    /// Writes the joints of a skin and their inverse bind matrices; existing joints are unchanged.
    fn write_skin(&mut self, rig: &Rig, skin: usize) -> Result<()> {
        let of_rig = &rig.skins[skin];
        let bytes: Vec<u8> = of_rig.inverse_bind.iter().flat_map(matrix).flat_map(f32::to_le_bytes).collect();
        let view = self.push_view(&bytes)?;
        let accessor = json!({
            "bufferView": view, "componentType": FLOAT, "count": of_rig.inverse_bind.len(), "type": "MAT4",
        });
        let accessor = self.push("accessors", accessor)?;
        let nodes: Vec<usize> = of_rig.joints.iter().map(|&joint| rig.joints[joint].source).collect();
        // Meshes without a skin got one after all others, in this order.
        if skin == self.list("skins")?.len() {
            self.push("skins", json!({}))?;
        }
        let entry = self.entry("skins", skin)?;
        entry.insert("joints".into(), nodes.into());
        entry.insert("inverseBindMatrices".into(), accessor.into());
        Ok(())
    }

    /// Writes the weights of skins that were changed on reading.
    pub(super) fn write_reweighed(&mut self, document: &Document) -> Result<()> {
        let mut of_joint: BTreeMap<JointIdx, Vec<usize>> = BTreeMap::new();
        for &(joint, primitive) in &document.reweighed {
            of_joint.entry(joint).or_default().push(primitive);
        }
        for (joint, primitives) in of_joint {
            let mut meshes = document.rig.meshes.iter();
            // The mesh of another character was removed.
            let Some(mesh) = meshes.find(|mesh| mesh.joint == joint && mesh.skin.is_some()) else { continue };
            self.write_primitives(&document.rig, mesh, &primitives)?;
        }
        Ok(())
    }

    /// Writes the weights of some of a mesh's primitives, and the mesh's skin.
    fn write_primitives(&mut self, rig: &Rig, mesh: &RigMesh, primitives: &[usize]) -> Result<()> {
        let node = rig.joints[mesh.joint].source;
        let of_file = self.own_mesh(node)?;
        let had_skin = self.entry("nodes", node)?.contains_key("skin");
        let of_mesh = self.entry("meshes", of_file)?.get("primitives").and_then(Value::as_array);
        let read = of_mesh.into_iter().flatten().enumerate().filter(|(_, it)| is_read(it, had_skin));
        let read: Vec<usize> = read.map(|(at, _)| at).collect();
        // In a mesh that had no skin, all parts need weights.
        let written = if had_skin { primitives.to_vec() } else { (0..mesh.primitives.len()).collect() };
        for at in written {
            let lost =
                || Error::malformed("the primitives are not those of the rig", format!("meshes[{of_file}]"));
            let attributes = self.write_weights(&mesh.primitives[at])?;
            let at = *read.get(at).ok_or_else(lost)?;
            let list = self.entry("meshes", of_file)?.get_mut("primitives");
            let primitive = list.and_then(|list| list.get_mut(at)).ok_or_else(lost)?;
            hang(primitive, &attributes).ok_or_else(lost)?;
        }
        self.entry("nodes", node)?.insert("skin".into(), mesh.skin.into());
        Ok(())
    }

    /// Returns the mesh of a node; a mesh shared with other nodes is copied first.
    fn own_mesh(&mut self, node: usize) -> Result<usize> {
        let lost = || Error::malformed("the node has no mesh", format!("nodes[{node}]"));
        let of = |entry: &Value| entry.get("mesh").and_then(Value::as_u64);
        let all: Vec<Option<u64>> = self.list("nodes")?.iter().map(of).collect();
        let mesh = all.get(node).copied().flatten().ok_or_else(lost)?;
        if all.iter().filter(|other| **other == Some(mesh)).count() == 1 {
            return Ok(mesh as usize);
        }
        let copy = Value::Object(self.entry("meshes", mesh as usize)?.clone());
        let copy = self.push("meshes", copy)?;
        self.entry("nodes", node)?.insert("mesh".into(), copy.into());
        Ok(copy)
    }

    /// Writes accessors of the slots and weights of a primitive's vertices; returns their indices.
    fn write_weights(&mut self, primitive: &Primitive) -> Result<[usize; 2]> {
        let slots: Vec<u8> = primitive.joints.iter().flatten().flat_map(|slot| slot.to_le_bytes()).collect();
        let weights: Vec<u8> =
            primitive.weights.iter().flatten().flat_map(|weight| weight.to_le_bytes()).collect();
        let mut accessors = [0; 2];
        for ((accessor, bytes), kind) in accessors.iter_mut().zip([slots, weights]).zip([U16, FLOAT]) {
            let view = self.push_view(&bytes)?;
            self.entry("bufferViews", view)?.insert("target".into(), VERTICES.into());
            let count = primitive.positions.len();
            *accessor = self.push(
                "accessors",
                json!({"bufferView": view, "componentType": kind, "count": count, "type": "VEC4"}),
            )?;
        }
        Ok(accessors)
    }
}

/// True if the reader keeps a primitive, with weights if `with_weights` is true.
fn is_read(primitive: &Value, with_weights: bool) -> bool {
    let has = |name: &str| primitive["attributes"].get(name).is_some();
    let weighs = has("JOINTS_0") && has("WEIGHTS_0");
    has("POSITION") && (weighs || !with_weights) && primitive["mode"].as_u64().is_none_or(|mode| mode >= 4)
}

/// Replaces a primitive's slots and weights.
fn hang(primitive: &mut Value, [slots, weights]: &[usize; 2]) -> Option<()> {
    let is_weight = |name: &str| name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_");
    let draco = primitive.pointer_mut("/extensions/KHR_draco_mesh_compression/attributes");
    if let Some(compressed) = draco.and_then(Value::as_object_mut) {
        compressed.retain(|name, _| !is_weight(name));
    }
    let attributes: &mut Map<String, Value> = primitive.get_mut("attributes")?.as_object_mut()?;
    attributes.retain(|name, _| !is_weight(name));
    attributes.insert("JOINTS_0".into(), (*slots).into());
    attributes.insert("WEIGHTS_0".into(), (*weights).into());
    Some(())
}

/// Returns the matrix column by column.
fn matrix(affine: &Affine) -> [f32; 16] {
    let (x, y, z, t) = (affine.linear.x_axis, affine.linear.y_axis, affine.linear.z_axis, affine.translation);
    [x.x, x.y, x.z, 0.0, y.x, y.y, y.z, 0.0, z.x, z.y, z.z, 0.0, t.x, t.y, t.z, 1.0]
}
