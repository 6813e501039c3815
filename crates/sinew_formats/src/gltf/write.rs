//! Writes a rig that was not read from a file as a new GLB.

use super::{Document, NewClip, ReadOptions, append_clips, no_files, read_gltf};
use crate::container::glb;
use crate::error::Result;
use crate::events::events_extras;
use serde_json::{Map, Value, json};
use sinew_anim::{Clip, ClipEvent, Primitive, Rig, RigMesh, Skin};
use sinew_math::{Affine, Vec2, Vec3, max, min};

const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// Writes a rig made by code, with its clips, as a new GLB. Joint `i` becomes node `i`. Each mesh gets a node after
/// the joints; a skinned mesh is at the root of the scene, where no ancestor's transform can affect it. For a rig
/// read from a file use [`append_clips`](super::append_clips), which preserves the rest of that file.
///
/// Pictures are not written: a textured surface keeps its base colour.
///
/// # Errors
/// If the file would exceed 4 GiB, or a clip has no channels.
///
/// # Panics
/// If an index of the rig or of a clip is out of range, or a number is not finite.
pub fn write_gltf(rig: &Rig, clips: &[Clip]) -> Result<Vec<u8>> {
    write_motion(rig, clips, &vec![Vec::new(); clips.len()])
}

/// [`write_gltf`] with the events of each clip.
///
/// # Errors
/// As [`write_gltf`].
///
/// # Panics
/// As [`write_gltf`], and if there is not one list of events per clip.
pub fn write_motion(rig: &Rig, clips: &[Clip], events: &[Vec<ClipEvent>]) -> Result<Vec<u8>> {
    assert_eq!(clips.len(), events.len(), "a list of events for each clip");
    let bytes = write_rig(rig)?;
    if clips.is_empty() {
        return Ok(bytes);
    }
    let document = read_gltf(&bytes, ReadOptions::default(), &mut no_files)?;
    let clips: Vec<Clip> = clips.iter().map(|clip| renumbered(clip, &document)).collect();
    let new = clips.iter().zip(events);
    let new = new.map(|(clip, events)| NewClip { clip, name: &clip.name, extras: events_extras(events) });
    append_clips(&document, &new.collect::<Vec<_>>())
}

/// Renumbers the joints of a clip as in the document, where nodes of meshes may be between them.
fn renumbered(clip: &Clip, document: &Document) -> Clip {
    let mut clip = clip.clone();
    for channel in &mut clip.channels {
        let mut joints = document.rig.joints.iter();
        let found = joints.position(|joint| joint.source == channel.joint);
        channel.joint = found.expect("a channel moves a joint of the rig");
    }
    clip
}

fn write_rig(rig: &Rig) -> Result<Vec<u8>> {
    let mut writer = Writer::default();
    let mut nodes: Vec<Value> = rig.joints.iter().map(|joint| node(&joint.name, &joint.rest)).collect();
    let mut roots = Vec::new();
    for (index, joint) in rig.joints.iter().enumerate() {
        match joint.parent {
            Some(parent) => add_child(&mut nodes[parent], index),
            None => roots.push(index),
        }
    }
    let mut meshes = Vec::new();
    for mesh in &rig.meshes {
        let index = nodes.len();
        let mut object = json!({"name": mesh.name, "mesh": meshes.len()});
        match mesh.skin {
            Some(skin) => {
                object["skin"] = skin.into();
                roots.push(index);
            }
            None => add_child(&mut nodes[mesh.joint], index),
        }
        nodes.push(object);
        meshes.push(writer.mesh(mesh));
    }
    let skins: Vec<Value> = rig.skins.iter().map(|skin| writer.skin(skin)).collect();
    let mut root = Map::new();
    root.insert("asset".into(), json!({"version": "2.0", "generator": "sinew"}));
    root.insert("scene".into(), 0.into());
    root.insert("scenes".into(), json!([{"nodes": roots}]));
    // Empty lists are not allowed (glTF 2.0 §3.3).
    let lists = [("nodes", nodes), ("meshes", meshes), ("skins", skins), ("materials", writer.materials)];
    for (name, list) in
        lists.into_iter().chain([("accessors", writer.accessors), ("bufferViews", writer.views)])
    {
        if !list.is_empty() {
            root.insert(name.into(), list.into());
        }
    }
    if !writer.bin.is_empty() {
        root.insert("buffers".into(), json!([{"byteLength": writer.bin.len()}]));
    }
    glb::write(Value::Object(root).to_string().as_bytes(), &writer.bin, &[])
}

fn node(name: &str, rest: &sinew_anim::LocalTransform) -> Value {
    let r = rest.rotation;
    json!({
        "name": name,
        "translation": rest.translation.to_array(),
        "rotation": [r.x, r.y, r.z, r.w],
        "scale": rest.scale.to_array(),
    })
}

fn add_child(node: &mut Value, child: usize) {
    match node["children"].as_array_mut() {
        Some(children) => children.push(child.into()),
        None => node["children"] = json!([child]),
    }
}

/// Writer of a file: its lists and its binary chunk.
#[derive(Default)]
struct Writer {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
}

impl Writer {
    fn mesh(&mut self, mesh: &RigMesh) -> Value {
        let primitives: Vec<Value> = mesh.primitives.iter().map(|part| self.primitive(part)).collect();
        json!({"name": mesh.name, "primitives": primitives})
    }

    fn primitive(&mut self, part: &Primitive) -> Value {
        let mut attributes = Map::new();
        let positions = self.floats("VEC3", part.positions.iter().map(Vec3::to_array));
        let (low, high) = bounds(&part.positions);
        self.accessors[positions]["min"] = json!(low.to_array());
        self.accessors[positions]["max"] = json!(high.to_array());
        attributes.insert("POSITION".into(), positions.into());
        if !part.normals.is_empty() {
            let accessor = self.floats("VEC3", part.normals.iter().map(Vec3::to_array));
            attributes.insert("NORMAL".into(), accessor.into());
        }
        if !part.uvs.is_empty() {
            let accessor = self.floats("VEC2", part.uvs.iter().map(Vec2::to_array));
            attributes.insert("TEXCOORD_0".into(), accessor.into());
        }
        if !part.colors.is_empty() {
            attributes.insert("COLOR_0".into(), self.floats("VEC4", part.colors.iter().copied()).into());
        }
        if !part.joints.is_empty() {
            attributes.insert("JOINTS_0".into(), self.slots(part).into());
            attributes.insert("WEIGHTS_0".into(), self.floats("VEC4", part.weights.iter().copied()).into());
        }
        let indices = part.indices.iter().flat_map(|i| i.to_le_bytes());
        let indices = self.push(UNSIGNED_INT, "SCALAR", part.indices.len(), indices);
        let mut material = json!({"pbrMetallicRoughness": {
            "baseColorFactor": part.base_color, "metallicFactor": 0.0, "roughnessFactor": 0.8,
        }});
        if !part.material.is_empty() {
            material["name"] = part.material.as_str().into();
        }
        self.materials.push(material);
        json!({"attributes": attributes, "indices": indices, "material": self.materials.len() - 1})
    }

    /// Writes the skin slots of the vertices; 0 where the weight is 0, as §3.7.3.3 requires.
    fn slots(&mut self, part: &Primitive) -> usize {
        let used = part.joints.iter().zip(&part.weights).flat_map(|(slots, weights)| {
            let used = |k: usize| if weights[k] > 0.0 { slots[k] } else { 0 };
            [used(0), used(1), used(2), used(3)]
        });
        self.push(UNSIGNED_SHORT, "VEC4", part.joints.len(), used.flat_map(u16::to_le_bytes))
    }

    fn skin(&mut self, skin: &Skin) -> Value {
        let matrices = self.floats("MAT4", skin.inverse_bind.iter().map(columns));
        json!({"name": skin.name, "joints": skin.joints, "inverseBindMatrices": matrices})
    }

    fn floats<const N: usize>(
        &mut self,
        kind: &str,
        items: impl ExactSizeIterator<Item = [f32; N]>,
    ) -> usize {
        let count = items.len();
        let numbers = items.flatten().inspect(|x| assert!(x.is_finite(), "a number is finite"));
        self.push(FLOAT, kind, count, numbers.flat_map(f32::to_le_bytes))
    }

    /// Adds a buffer view and an accessor for all of its bytes; returns the accessor's index.
    fn push(&mut self, component: u32, kind: &str, count: usize, bytes: impl Iterator<Item = u8>) -> usize {
        let start = self.bin.len();
        self.bin.extend(bytes);
        self.views.push(json!({"buffer": 0, "byteOffset": start, "byteLength": self.bin.len() - start}));
        self.bin.resize(self.bin.len().div_ceil(4) * 4, 0);
        let view = self.views.len() - 1;
        self.accessors
            .push(json!({"bufferView": view, "componentType": component, "count": count, "type": kind}));
        self.accessors.len() - 1
    }
}

/// Returns the column-major 4×4 numbers of an affine map.
fn columns(m: &Affine) -> [f32; 16] {
    let (x, y, z, t) = (m.linear.x_axis, m.linear.y_axis, m.linear.z_axis, m.translation);
    [x.x, x.y, x.z, 0.0, y.x, y.y, y.z, 0.0, z.x, z.y, z.z, 0.0, t.x, t.y, t.z, 1.0]
}

fn bounds(points: &[Vec3]) -> (Vec3, Vec3) {
    let first = points.first().copied().unwrap_or(Vec3::ZERO);
    points.iter().fold((first, first), |(low, high), p| {
        let low = Vec3::new(min(low.x, p.x), min(low.y, p.y), min(low.z, p.z));
        (low, Vec3::new(max(high.x, p.x), max(high.y, p.y), max(high.z, p.z)))
    })
}
