//! Appends clips to the user's own file: the original JSON is edited as a value, and the original bytes remain a
//! prefix.

use super::Document;
use super::source::Buffer;
use crate::error::{Error, Result};
use crate::{container::glb, container::uri};
use serde_json::{Map, Value, json};
use sinew_anim::{Channel, Clip, Interpolation, Joint, LocalTransform, Property};
use std::collections::BTreeMap;

const FLOAT: u32 = 5126;

/// A clip to append.
#[derive(Clone, Debug)]
pub struct NewClip<'a> {
    /// Keys of the clip.
    pub clip: &'a Clip,
    /// Name of the animation; `""` for unnamed.
    pub name: &'a str,
    /// The animation's `extras`, such as those of [`events_extras`](crate::events_extras).
    pub extras: Option<Value>,
}

/// Returns the user's own file with one more animation, as a GLB: [`append_clips`] with one clip.
///
/// # Errors
/// As [`append_clips`].
///
/// # Panics
/// As [`append_clips`].
pub fn append_clip(document: &Document, clip: &Clip, name: &str, extras: Option<Value>) -> Result<Vec<u8>> {
    append_clips(document, &[NewClip { clip, name, extras }])
}

/// Returns the user's own file with more animations, as a GLB.
///
/// The existing JSON is preserved in its order, including unknown extensions, and the old binary chunk is a prefix of
/// the new one. Each clip adds one buffer view, the accessors of its keys and the animation, each at the end of its
/// list. Channels target the nodes that the joints came from.
///
/// A rig with sheets of cloth ([`sinew_anim::Rig::sheets`]) adds a node per particle, and the primitives that became
/// cloth are skinned to these nodes.
///
/// Only these old entries change:
/// - `buffers[0].byteLength` grows.
/// - Primitives whose vertices got other weights on reading, because no bone moved them, refer to new accessors with
///   these weights.
/// - A `.gltf` becomes a single self-contained file: `buffers[0]` loses its `uri` and becomes the binary chunk,
///   external pictures are embedded, further external buffers become data URIs. A picture that was missing on reading
///   keeps its `uri`.
/// - An animated node with a `matrix` gets `translation`, `rotation` and `scale` instead, as glTF 2.0 §3.5.3 requires.
///
/// Channels that only repeat a node's rest pose are omitted where the format discourages them: if the node has a
/// `matrix` (which can then stay), or carries a skinned mesh, whose own transform is ignored.
///
/// # Errors
/// If there is nothing to write (no channel of a clip remains), the first buffer is a placeholder without bytes, or the
/// result exceeds 4 GiB.
///
/// # Panics
/// If a channel's joint is not in the document's rig, or a channel violates the rules of [`Channel`].
pub fn append_clips(document: &Document, clips: &[NewClip<'_>]) -> Result<Vec<u8>> {
    let mut editor = Editor::open(document)?;
    editor.embed_external(document)?;
    editor.write_reweighed(document)?;
    editor.write_sheets(document)?;
    for clip in clips {
        editor.append(document, clip)?;
    }
    editor.finish(&document.other_chunks)
}

fn better_left_alone(node: &Value) -> bool {
    node.get("matrix").is_some() || node.get("skin").is_some()
}

/// Returns the nodes of joints that some channel moves from their rest pose, with that pose.
fn moved_nodes(channels: &[&Channel], joints: &[Joint]) -> BTreeMap<usize, LocalTransform> {
    let moving = channels.iter().filter(|c| !repeats_rest(c, &joints[c.joint].rest));
    moving.map(|c| (joints[c.joint].source, joints[c.joint].rest)).collect()
}

fn repeats_rest(channel: &Channel, rest: &LocalTransform) -> bool {
    let (t, r, s) = (rest.translation, rest.rotation, rest.scale);
    let value: &[f32] = match channel.property {
        Property::Translation => &t.to_array(),
        Property::Rotation => &[r.x, r.y, r.z, r.w],
        Property::Scale => &s.to_array(),
    };
    let near = |(a, b): (&f32, &f32)| (a - b).abs() <= 1e-6 * (1.0 + b.abs());
    channel.interpolation != Interpolation::CubicSpline
        && channel.values.chunks(value.len()).all(|key| key.iter().zip(value).all(near))
}

/// Editor of a file that is being written.
pub(super) struct Editor {
    root: Map<String, Value>,
    bin: Vec<u8>,
}

impl Editor {
    /// Opens the document, with its first buffer as the binary chunk.
    pub(super) fn open(document: &Document) -> Result<Self> {
        let Value::Object(root) = document.json.clone() else {
            return Err(Error::malformed("must be an object", "top level"));
        };
        let bin = match document.buffers.first() {
            None | Some(Buffer::Chunk) => document.bin.clone().unwrap_or_default(),
            Some(Buffer::DataUri(bytes) | Buffer::External(bytes)) => bytes.clone(),
            Some(Buffer::Absent) => {
                return Err(Error::unsupported("buffer has no bytes of its own to add to", "buffers[0]"));
            }
        };
        let mut editor = Self { root, bin };
        editor.align();
        if document.buffers.is_empty() {
            editor.push("buffers", json!({}))?;
        }
        editor.entry("buffers", 0)?.shift_remove("uri");
        Ok(editor)
    }

    fn append(&mut self, document: &Document, NewClip { clip, name, extras }: &NewClip<'_>) -> Result<()> {
        let joints = &document.rig.joints;
        // Joints that were added to the rig only for its motion have no node.
        let (nodes, is_of_sheet) = (document.node_count(), document.rig.is_of_sheet());
        let is_node = |channel: &&Channel| joints[channel.joint].source < nodes || is_of_sheet[channel.joint];
        let own: Vec<&Channel> = clip.channels.iter().filter(is_node).collect();
        let moved = moved_nodes(&own, joints);
        self.free_matrices(&moved)?;
        let channels = own.into_iter().filter(|c| {
            let node = joints[c.joint].source;
            moved.contains_key(&node) || !better_left_alone(&document.json["nodes"][node])
        });
        let mut animation = Map::new();
        if !name.is_empty() {
            animation.insert("name".into(), (*name).into());
        }
        self.write_channels(channels, joints, &mut animation)?;
        if let Some(extras) = extras {
            animation.insert("extras".into(), extras.clone());
        }
        self.push("animations", animation.into())?;
        Ok(())
    }

    /// Embeds external buffers and pictures.
    pub(super) fn embed_external(&mut self, document: &Document) -> Result<()> {
        for (i, buffer) in document.buffers.iter().enumerate().skip(1) {
            if let Buffer::External(bytes) = buffer {
                self.entry("buffers", i)?.insert("uri".into(), uri::encode_data(bytes).into());
            }
        }
        for (&i, bytes) in &document.external_images {
            // The type of a picture in a buffer view must be stated; pictures of other types stay external.
            let mime = match bytes.as_slice() {
                [0x89, b'P', b'N', b'G', ..] => "image/png",
                [0xFF, 0xD8, 0xFF, ..] => "image/jpeg",
                _ => continue,
            };
            let view = self.push_view(bytes)?;
            let image = self.entry("images", i)?;
            image.shift_remove("uri");
            image.insert("bufferView".into(), view.into());
            image.insert("mimeType".into(), mime.into());
        }
        Ok(())
    }

    /// Replaces the matrix of animated nodes with translation, rotation and scale.
    fn free_matrices(&mut self, moved: &BTreeMap<usize, LocalTransform>) -> Result<()> {
        for (&node, rest) in moved {
            let node = self.entry("nodes", node)?;
            if node.shift_remove("matrix").is_some() {
                let r = rest.rotation;
                node.insert("translation".into(), json!(rest.translation.to_array()));
                node.insert("rotation".into(), json!([r.x, r.y, r.z, r.w]));
                node.insert("scale".into(), json!(rest.scale.to_array()));
            }
        }
        Ok(())
    }

    /// Writes keys into one new buffer view, and `channels` and `samplers` into `animation`. Channels with equal key
    /// times share one accessor for them.
    fn write_channels<'c>(
        &mut self,
        channels: impl Iterator<Item = &'c Channel>,
        joints: &[Joint],
        animation: &mut Map<String, Value>,
    ) -> Result<()> {
        let mut data = Vec::new();
        let mut inputs: Vec<(&[f32], usize)> = Vec::new();
        let (mut channel_list, mut samplers) = (Vec::new(), Vec::new());
        let view = self.list("bufferViews")?.len();
        for channel in channels {
            let known =
                inputs.iter().find(|(times, _)| *times == channel.times).map(|(_, accessor)| *accessor);
            let input = if let Some(accessor) = known {
                accessor
            } else {
                let accessor = self.push_keys(view, &mut data, &channel.times, "SCALAR")?;
                inputs.push((&channel.times, accessor));
                accessor
            };
            let (path, kind) = match channel.property {
                Property::Translation => ("translation", "VEC3"),
                Property::Rotation => ("rotation", "VEC4"),
                Property::Scale => ("scale", "VEC3"),
            };
            let interpolation = match channel.interpolation {
                Interpolation::Step => "STEP",
                Interpolation::Linear => "LINEAR",
                Interpolation::CubicSpline => "CUBICSPLINE",
            };
            let output = self.push_keys(view, &mut data, &channel.values, kind)?;
            let node = joints[channel.joint].source;
            channel_list.push(json!({"sampler": samplers.len(), "target": {"node": node, "path": path}}));
            samplers.push(json!({"input": input, "interpolation": interpolation, "output": output}));
        }
        if channel_list.is_empty() {
            return Err(Error::unsupported(
                "the clip moves nothing: there is no channel to write",
                "animations",
            ));
        }
        self.push_view(&data)?;
        animation.insert("channels".into(), channel_list.into());
        animation.insert("samplers".into(), samplers.into());
        Ok(())
    }

    /// Adds numbers to the `data` of the future view, and an accessor for them; returns its index. Accessors of times
    /// have bounds, as §3.11 requires.
    fn push_keys(&mut self, view: usize, data: &mut Vec<u8>, numbers: &[f32], kind: &str) -> Result<usize> {
        let width = match kind {
            "SCALAR" => 1,
            "VEC3" => 3,
            _ => 4,
        };
        let mut accessor = json!({
            "bufferView": view, "byteOffset": data.len(), "componentType": FLOAT,
            "count": numbers.len() / width, "type": kind,
        });
        if width == 1 {
            accessor["min"] = json!([f64::from(numbers[0])]);
            accessor["max"] = json!([f64::from(numbers[numbers.len() - 1])]);
        }
        data.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        self.push("accessors", accessor)
    }

    pub(super) fn push_view(&mut self, bytes: &[u8]) -> Result<usize> {
        self.align();
        let view = json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()});
        self.bin.extend(bytes);
        self.push("bufferViews", view)
    }

    /// Pads the binary chunk to a multiple of 4 bytes.
    fn align(&mut self) {
        self.bin.resize(self.bin.len().div_ceil(4) * 4, 0);
    }

    pub(super) fn list(&mut self, name: &str) -> Result<&mut Vec<Value>> {
        let list = self.root.entry(name).or_insert_with(|| Value::Array(Vec::new()));
        list.as_array_mut().ok_or_else(|| Error::malformed("must be an array", name))
    }

    pub(super) fn push(&mut self, list: &str, value: Value) -> Result<usize> {
        let list = self.list(list)?;
        list.push(value);
        Ok(list.len() - 1)
    }

    pub(super) fn entry(&mut self, list: &str, index: usize) -> Result<&mut Map<String, Value>> {
        let entry = self.list(list)?.get_mut(index).and_then(Value::as_object_mut);
        entry.ok_or_else(|| Error::malformed("must be an object", format!("{list}[{index}]")))
    }

    /// Adds an extension to the top level of the file, and to `extensionsUsed`.
    pub(super) fn extension(&mut self, name: &str, value: Value) -> Result<()> {
        let extensions = self.root.entry("extensions").or_insert_with(|| json!({}));
        let extensions =
            extensions.as_object_mut().ok_or_else(|| Error::malformed("must be an object", "extensions"))?;
        extensions.insert(name.into(), value);
        let used = self.list("extensionsUsed")?;
        if !used.iter().any(|known| known == name) {
            used.push(name.into());
        }
        Ok(())
    }

    pub(super) fn finish(mut self, other_chunks: &[u8]) -> Result<Vec<u8>> {
        let length = self.bin.len();
        self.entry("buffers", 0)?.insert("byteLength".into(), length.into());
        let text = Value::Object(self.root).to_string();
        glb::write(text.as_bytes(), &self.bin, other_chunks)
    }
}
