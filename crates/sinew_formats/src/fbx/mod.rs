//! FBX, text and binary, through the C library ufbx (feature `fbx`).
//!
//! The variants of the format are normalised. Axes become +Y up and lengths metres in joints, meshes and keys, so that
//! no root has a scale. Pivots, rotation orders and non-inherited scale become plain translation, rotation and scale.
//! Curves that are not straight are sampled at the file's frame rate, then reduced to the necessary keys. Materials
//! keep the base colour and its picture. Morph targets, constraints, cameras and lights are omitted.
//!
//! ```
//! # let bytes: &[u8] = b"neither text nor binary";
//! let error = sinew_formats::read_fbx(bytes).expect_err("this is none");
//! println!("{error}");
//! ```

mod clips;
mod material;
mod mesh;

use crate::error::{Error, Result};
use crate::gltf::{ReadOptions, Resolver, Textures, no_files, note_of_loose};
use crate::motion::{MotionFile, MotionFormat};
use material::Materials;
use sinew_anim::weights::weigh_loose_vertices;
use sinew_anim::{Joint, JointIdx, LocalTransform, Rig};
use sinew_math::{Affine, Mat3, Rotation, Vec3};
use ufbx::{
    AllocatorOpts, GeometryTransformHandling, InheritModeHandling, LoadOpts, Node, Scene, SpaceConversion,
};

/// Largest depth of nested nodes, larger than in any skeleton.
const DEEPEST: u32 = 512;

/// Reads an FBX file: every node as a joint, meshes with their skins, one clip for each animation stack.
///
/// The rest pose of the joints is that of the file's nodes; skins use their bind pose. Memory stays within 64 times
/// the file size plus 64 MiB, because arrays in the file may be compressed.
///
/// # Errors
/// If the bytes are no FBX, are truncated, have a version before 3.0 or need more memory; if numbers are not finite.
pub fn read_fbx(bytes: &[u8]) -> Result<MotionFile> {
    read_fbx_with(bytes, ReadOptions::default(), &mut no_files)
}

/// [`read_fbx`] with the pictures next to the file, which `resolve` returns. A missing or broken picture is omitted
/// with a note.
///
/// # Errors
/// As [`read_fbx`].
pub fn read_fbx_with(bytes: &[u8], options: ReadOptions, resolve: &mut Resolver<'_>) -> Result<MotionFile> {
    let scene =
        ufbx::load_memory(bytes, load_options(bytes.len())).map_err(|error| explain(&error, bytes.len()))?;
    let joints =
        scene.nodes.iter().filter(|node| !node.is_root).map(|node| joint(node)).collect::<Result<_>>()?;
    let mut rig = Rig { joints, ..Rig::default() };
    let mut materials = Materials::new(options.textures, resolve);
    let without_weights = mesh::read_all(&scene, &mut rig, &mut materials)?;
    let reweighed = weigh_loose_vertices(&mut rig, &without_weights);
    rig.textures = materials.textures;
    let pictures = materials.notes;
    let (clips, mut notes) = clips::read_all(&scene, bytes.len())?;
    notes.extend(pictures);
    notes.extend(note_of_loose(&reweighed));
    notes.extend(left_out(&scene, options.textures));
    notes.extend(scene.metadata.warnings.iter().map(|warning| warning.description.to_string()));
    let rate = scene.settings.frames_per_second;
    Ok(MotionFile {
        format: MotionFormat::Fbx,
        generator: scene.metadata.creator.to_string(),
        extensions: Vec::new(),
        spring_format: None,
        rig,
        events: vec![Vec::new(); clips.len()],
        clips,
        frame_time: (rate > 0.0).then_some(1.0 / rate),
        metres_per_unit: None,
        rest_pose: None,
        notes,
    })
}

fn load_options(size: usize) -> LoadOpts<'static> {
    LoadOpts {
        temp_allocator: limited(size),
        result_allocator: limited(size),
        clean_skin_weights: true,
        normalize_normals: true,
        node_depth_limit: DEEPEST,
        geometry_transform_handling: GeometryTransformHandling::ModifyGeometry,
        inherit_mode_handling: InheritModeHandling::Compensate,
        space_conversion: SpaceConversion::ModifyGeometry,
        target_axes: ufbx::axes_right_handed_y_up(),
        target_unit_meters: 1.0,
        ..LoadOpts::default()
    }
}

/// Returns the memory limit for a file of this size.
fn limited(size: usize) -> AllocatorOpts {
    let memory_limit = size.saturating_mul(64).saturating_add(64 << 20);
    AllocatorOpts { memory_limit, ..AllocatorOpts::default() }
}

/// Converts an error of ufbx, which reports only a position: the byte offset, or its current task.
fn explain(error: &ufbx::Error, size: usize) -> Error {
    use ufbx::ErrorType as Kind;
    let detail = error.info().trim();
    let place = if detail.is_empty() { "FBX".to_owned() } else { format!("FBX: {detail}") };
    match error.type_ {
        Kind::TruncatedFile | Kind::EmptyFile => Error::malformed("truncated", format!("byte {size}")),
        Kind::MemoryLimit | Kind::AllocationLimit | Kind::OutOfMemory => {
            Error::malformed("needs more memory than its size justifies", place)
        }
        Kind::NodeDepthLimit => {
            Error::unsupported(format!("nodes are nested deeper than {DEEPEST} levels"), place)
        }
        Kind::UnsupportedVersion => Error::unsupported("of a version that is not supported", place),
        _ => {
            let what = error.description.lines().next().unwrap_or_default().to_owned();
            Error::malformed(format!("broken FBX: {what}"), place)
        }
    }
}

/// Returns the joint of a node. Nodes are in order of depth, and the first, the root of the scene, is no joint.
fn index(node: &Node) -> Option<JointIdx> {
    (node.element.typed_id as usize).checked_sub(1)
}

fn joint(node: &Node) -> Result<Joint> {
    let local = &node.local_transform;
    let place = || format!("node {:?}", &*node.element.name);
    Ok(Joint {
        name: node.element.name.to_string(),
        parent: node.parent.as_ref().and_then(|parent| index(parent)),
        rest: LocalTransform {
            translation: vector(local.translation, place)?,
            rotation: rotation(local.rotation, place)?,
            scale: vector(local.scale, place)?,
        },
        source: index(node).unwrap_or_default(),
    })
}

fn vector(v: ufbx::Vec3, place: impl Fn() -> String) -> Result<Vec3> {
    let v = Vec3::new(v.x as f32, v.y as f32, v.z as f32);
    if v.is_finite() { Ok(v) } else { Err(not_finite(place())) }
}

fn rotation(q: ufbx::Quat, place: impl Fn() -> String) -> Result<Rotation> {
    let q = Rotation::from_xyzw(q.x as f32, q.y as f32, q.z as f32, q.w as f32);
    let square = q.dot(q);
    if square > 0.5 && square.is_finite() { Ok(q.normalize()) } else { Err(not_finite(place())) }
}

fn affine(m: &ufbx::Matrix, place: impl Fn() -> String) -> Result<Affine> {
    let column = |x: f64, y: f64, z: f64| vector(ufbx::Vec3 { x, y, z }, &place);
    Ok(Affine {
        linear: Mat3::from_cols(
            column(m.m00, m.m10, m.m20)?,
            column(m.m01, m.m11, m.m21)?,
            column(m.m02, m.m12, m.m22)?,
        ),
        translation: column(m.m03, m.m13, m.m23)?,
    })
}

fn not_finite(place: String) -> Error {
    Error::malformed("a number is not finite", place)
}

/// Lists the parts of the scene that do not become part of a rig, one sentence each.
fn left_out(scene: &Scene, pictures: Textures) -> Vec<String> {
    let counted = [
        (if pictures == Textures::Skip { scene.textures.len() } else { 0 }, "textures"),
        (scene.blend_channels.len(), "morph targets"),
        (scene.constraints.len(), "constraints"),
        (scene.nurbs_surfaces.len() + scene.nurbs_curves.len() + scene.line_curves.len(), "curves and NURBS"),
    ];
    let note = |&(count, what): &(usize, &str)| (count > 0).then(|| format!("left out: {count} {what}"));
    counted.iter().filter_map(note).collect()
}
