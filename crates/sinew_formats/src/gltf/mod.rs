//! Reads glTF 2.0 and its relatives (GLB, VRM 0 and 1, VRMA) as a rig, clips and the source JSON.
//!
//! The JSON is read by our own cursor instead of a typed model: every index, range and number is checked where it is
//! used, errors name the location, and [`append_clip`] edits and writes back the same value.
//!
//! ```
//! use sinew_formats::{ReadOptions, append_clip, no_files, read_gltf, write_gltf};
//!
//! let mannequin = sinew::mannequin::mannequin();
//! let file = write_gltf(&mannequin.rig, &mannequin.clips[..1])?;
//! let document = read_gltf(&file, ReadOptions::default(), &mut no_files)?;
//! assert_eq!(document.clips[0].name, mannequin.clips[0].name);
//!
//! // Adds one more clip to the same file; existing content is unchanged.
//! let slow = sinew_anim::Clip { name: "slow".into(), ..document.clips[0].clone() };
//! let longer = append_clip(&document, &slow, "slow", None)?;
//! let document = read_gltf(&longer, ReadOptions::default(), &mut no_files)?;
//! assert_eq!(document.clips.len(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod accessor;
mod animation;
mod append;
mod attributes;
mod draco;
mod khr;
mod material;
mod mesh;
mod meshopt;
#[cfg(feature = "pictures")]
mod picture;
mod scene;
mod sheets;
mod source;
mod springs;
mod vrm;
mod write;

pub use append::{NewClip, append_clip, append_clips};
pub use khr::{KhrFile, write_khr};
#[cfg(feature = "fbx")]
pub(crate) use material::MAX_DECODED;
#[cfg(all(feature = "fbx", not(feature = "pictures")))]
pub(crate) use material::decode_picture;
#[cfg(feature = "fbx")]
pub(crate) use mesh::strongest_four;
#[cfg(all(feature = "fbx", feature = "pictures"))]
pub(crate) use picture::decode_picture;
pub use springs::SpringFormat;
pub use write::{write_gltf, write_motion};

use crate::container::json::{self, At};
use crate::error::{Error, Result, quoted};
use crate::{container::glb, container::uri};
use serde_json::Value;
use sinew_anim::weights::{SkinPart, weigh_by_nearness, weigh_loose_vertices};
use sinew_anim::{Clip, ClipEvent, JointIdx, Rig};
use source::{Buffer, Source};
use std::collections::BTreeMap;

/// Container of the JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Container {
    /// Binary: JSON and one buffer in one file (also VRM and VRMA).
    Glb,
    /// JSON text; buffers as data URIs or external files.
    Gltf,
}

/// Choice to decode base colour pictures or not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Textures {
    /// Pictures are not decoded: [`Rig::textures`] stays empty.
    #[default]
    Skip,
    /// PNG and JPEG are decoded, with the feature `pictures`. A picture that cannot be decoded becomes a warning;
    /// without the feature, every picture does.
    Decode,
}

/// Options for reading a glTF or FBX file. Default: all content but pictures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Decoding of pictures. Default: skip.
    pub textures: Textures,
}

/// A glTF file as plain data, including all data needed to write it back.
#[derive(Clone, Debug)]
pub struct Document {
    /// Every node of the default scene (else of the first scene, else every node), with skins and meshes.
    pub rig: Rig,
    /// Animations in file order.
    pub clips: Vec<Clip>,
    /// Events of each clip (`extras.sinew_events`), by time.
    pub events: Vec<Vec<ClipEvent>>,
    /// The file's JSON, with keys in order and numbers unchanged.
    pub json: Value,
    /// The file's binary chunk.
    pub bin: Option<Vec<u8>>,
    /// Container of the JSON.
    pub container: Container,
    /// Omissions with their reasons, one line each (an undecodable picture, a missing external file).
    pub warnings: Vec<String>,
    /// Bytes of the buffers that are not the binary chunk.
    buffers: Vec<Buffer>,
    /// Bytes of external pictures, by image index.
    external_images: BTreeMap<usize, Vec<u8>>,
    /// Further chunks of a GLB.
    other_chunks: Vec<u8>,
    /// Parts of the skin with changed weights: the mesh's joint, and the primitive's index among those with weights.
    reweighed: Vec<(JointIdx, usize)>,
}

impl Document {
    /// Returns `asset.generator`, the program that wrote the file, or `""`.
    pub fn generator(&self) -> &str {
        self.json["asset"]["generator"].as_str().unwrap_or_default()
    }

    /// Number of nodes of the file.
    pub fn node_count(&self) -> usize {
        self.json["nodes"].as_array().map_or(0, Vec::len)
    }

    /// Returns the names of the extensions that the file uses.
    pub fn extensions(&self) -> Vec<&str> {
        let used = self.json["extensionsUsed"].as_array();
        used.into_iter().flatten().filter_map(Value::as_str).collect()
    }

    /// Recomputes the weights of all skins from the distances of their vertices to the bones, for a file whose weights
    /// were [lost](sinew_anim::weights::lost_weights). [`append_clips`] writes the new weights.
    pub fn weigh_by_nearness(&mut self) {
        let changed = weigh_by_nearness(&mut self.rig);
        self.note_reweighed(&changed);
    }

    fn weigh_loose_vertices(&mut self, without: &[SkinPart]) {
        let changed = weigh_loose_vertices(&mut self.rig, without);
        self.warnings.extend(note_of_loose(&changed));
        self.note_reweighed(&changed);
    }

    fn note_reweighed(&mut self, changed: &[SkinPart]) {
        let of_mesh = |part: &SkinPart| (self.rig.meshes[part.mesh].joint, part.primitive);
        let changed: Vec<(JointIdx, usize)> = changed.iter().map(of_mesh).collect();
        self.reweighed.extend(changed);
    }

    /// Format of the rig's springs; `None` if the file has none.
    pub fn spring_format(&self) -> Option<SpringFormat> {
        SpringFormat::of(&self.json)
    }
}

/// Returns a note on vertices that follow the nearest skin; `None` if there are none.
pub(crate) fn note_of_loose(changed: &[SkinPart]) -> Option<String> {
    let vertices: usize = changed.iter().map(|part| part.vertices.len()).sum();
    match vertices {
        0 => None,
        1 => Some("1 vertex has no bone: it follows the nearest skin".into()),
        _ => Some(format!("{vertices} vertices have no bone: they follow the nearest skin")),
    }
}

/// Function that returns the bytes of a file next to the one being read. The path is relative, decoded, and has no `..`
/// and no scheme.
pub type Resolver<'a> = dyn FnMut(&str) -> Result<Vec<u8>> + 'a;

/// Resolver for bytes without a folder: every external file is missing.
///
/// # Errors
/// Always returns an error.
pub fn no_files(path: &str) -> Result<Vec<u8>> {
    Err(Error::io(format!("{} is not available", quoted(path))))
}

/// Reads a GLB, glTF, VRM or VRMA; the bytes determine the kind.
///
/// Memory is proportional to the input: lengths in the file are checked before allocation, and decoded data may not
/// exceed 64 times the input plus 16 MiB (many nodes may place one mesh).
///
/// # Errors
/// If the bytes are no glTF 2.0; for an index or range outside its list, non-finite numbers, a node that is its own
/// ancestor, an unsupported required extension, a compressed view or mesh with a broken stream, a missing external
/// buffer, or a spring with a dangling reference. Non-finite numbers in normals, texture coordinates, colours and
/// weights are repaired with a warning.
pub fn read_gltf(bytes: &[u8], options: ReadOptions, resolve: &mut Resolver<'_>) -> Result<Document> {
    let (container, json_bytes, bin, other_chunks) = unwrap_container(bytes)?;
    let json = json::parse(json_bytes)?;
    let root = At::root(&json);
    check_asset(root)?;
    check_extensions(root)?;
    let buffers = load_buffers(root, bin, resolve)?;
    let mut warnings = Vec::new();
    let external_images = load_images(root, resolve, &mut warnings)?;
    let mut budget = source::budget(&buffers, bytes.len());
    let decompressed = meshopt::decode_views(root, &buffers, bin, &mut budget)?;
    let source = Source::new(root, &buffers, bin, &decompressed, budget)?;
    let mut materials = material::Materials::new(&source, &external_images, options.textures)?;
    let mut scene = scene::read(&source)?;
    let (meshes, without_weights) = mesh::read_all(&source, &scene, &mut materials, &mut warnings)?;
    scene.rig.meshes = meshes;
    scene.rig.textures = materials.textures;
    warnings.append(&mut materials.warnings);
    scene.rig.stated_roles = vrm::stated_roles(root, &scene.joint_of_node);
    scene.rig.springs = springs::read(&source, &scene, &mut warnings)?;
    let (clips, events) = animation::read_all(&source, &scene.joint_of_node, &mut warnings)?;
    let mut document = Document {
        rig: scene.rig,
        clips,
        events,
        bin: bin.map(<[u8]>::to_vec),
        container,
        warnings,
        buffers,
        external_images,
        other_chunks: other_chunks.to_vec(),
        json,
        reweighed: Vec::new(),
    };
    document.weigh_loose_vertices(&without_weights);
    Ok(document)
}

type Unwrapped<'a> = (Container, &'a [u8], Option<&'a [u8]>, &'a [u8]);

fn unwrap_container(bytes: &[u8]) -> Result<Unwrapped<'_>> {
    if glb::is_glb(bytes) {
        let glb = glb::parse(bytes)?;
        return Ok((Container::Glb, glb.json, glb.bin, glb.other_chunks));
    }
    match bytes.iter().find(|b| !b.is_ascii_whitespace()) {
        Some(b'{') => Ok((Container::Gltf, bytes, None, &[])),
        Some(_) => Err(match crate::motion::foreign(bytes) {
            Some(what) => Error::unsupported(what, "byte 0"),
            None => Error::malformed("not a glTF file: begins neither with `glTF` nor with `{`", "byte 0"),
        }),
        None => Err(Error::malformed("file is empty", "byte 0")),
    }
}

/// Checks the version (glTF 2.0 §3.2): it must be 2.x, and the minimum version at most 2.0.
fn check_asset(root: At<'_>) -> Result<()> {
    let asset = root.need("asset")?;
    let version = asset.need("version")?;
    let text = version.str()?;
    if !text.starts_with("2.") {
        return Err(version.unsupported(format!("glTF version {} is not supported, only 2.0", quoted(text))));
    }
    if let Some(least) = asset.get("minVersion")?
        && least.str()? != "2.0"
    {
        let text = quoted(least.str()?);
        return Err(least.unsupported(format!("needs a reader of glTF {text}; this one reads 2.0")));
    }
    Ok(())
}

/// Extensions that may be required: supported, or without influence on geometry, joints and motion.
const HARMLESS: [&str; 10] = [
    "KHR_mesh_quantization",
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    "KHR_xmp",
    "KHR_node_",
    "VRM",
    "KHR_physics_",
];

fn check_extensions(root: At<'_>) -> Result<()> {
    for required in root.list("extensionsRequired")? {
        let name = required.str()?;
        if !HARMLESS.iter().any(|prefix| name.starts_with(prefix))
            && !meshopt::is_known(name)
            && name != draco::NAME
        {
            let name = quoted(name);
            return Err(required.unsupported(format!("needs the extension {name}, which is not supported")));
        }
    }
    Ok(())
}

/// Returns the bytes of every buffer: from the binary chunk, a data URI, or an external file.
fn load_buffers(root: At<'_>, bin: Option<&[u8]>, resolve: &mut Resolver<'_>) -> Result<Vec<Buffer>> {
    let mut buffers = Vec::new();
    for (i, buffer) in root.list("buffers")?.into_iter().enumerate() {
        let claimed = buffer.need("byteLength")?;
        let loaded = match (buffer.get("uri")?, bin) {
            (Some(at), _) => match uri::parse(at.str()?).map_err(|what| at.malformed(what))? {
                uri::Uri::Data(bytes) => Buffer::DataUri(bytes),
                uri::Uri::Relative(path) => Buffer::External(resolve(&path).map_err(|e| Error {
                    where_: at.path(),
                    what: e.what,
                    ..e
                })?),
            },
            (None, Some(_)) if i == 0 => Buffer::Chunk,
            // A placeholder, which is an error only if it is read.
            (None, _) => Buffer::Absent,
        };
        let there = loaded.bytes(bin).map(<[u8]>::len);
        if let Some(there) = there
            && claimed.usize()? > there
        {
            let what = format!("buffer claims {} bytes, {there} are there", claimed.usize()?);
            return Err(claimed.malformed(what));
        }
        buffers.push(loaded);
    }
    Ok(buffers)
}

/// Loads external pictures. A missing picture does not affect the motion, so it becomes a warning.
fn load_images(
    root: At<'_>,
    resolve: &mut Resolver<'_>,
    warnings: &mut Vec<String>,
) -> Result<BTreeMap<usize, Vec<u8>>> {
    let mut images = BTreeMap::new();
    for (i, image) in root.list("images")?.into_iter().enumerate() {
        let Some(at) = image.get("uri")? else { continue };
        let loaded = uri::parse(at.str()?).and_then(|uri| match uri {
            uri::Uri::Relative(path) => resolve(&path).map(Some).map_err(|e| e.what),
            uri::Uri::Data(_) => Ok(None),
        });
        match loaded {
            Ok(Some(bytes)) => drop(images.insert(i, bytes)),
            Ok(None) => {}
            Err(what) => warnings.push(format!("picture left out: {what} ({})", at.path())),
        }
    }
    Ok(images)
}
