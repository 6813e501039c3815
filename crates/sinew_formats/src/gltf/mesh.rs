//! Meshes: triangles with skin weights (glTF 2.0 §3.7.2, §3.7.3).

use super::material::Materials;
use super::scene::Scene;
use super::source::Source;
use super::{DRACO, draco};
use crate::error::Result;
use crate::json::At;
use sinew_anim::{Mesh, Primitive};
use sinew_math::{Vec2, Vec3, clamp, normalize_or};

/// Every mesh of the scene as often as a node places it.
pub(super) fn read_all<'a>(
    source: &Source<'a>,
    scene: &Scene,
    materials: &mut Materials<'_, 'a>,
) -> Result<Vec<Mesh>> {
    let meshes = source.root.list("meshes")?;
    let mut out = Vec::new();
    for (joint, at_joint) in scene.rig.joints[..scene.shown].iter().enumerate() {
        let node = source.nodes[at_joint.source];
        let Some(mesh_at) = node.get("mesh")? else { continue };
        let mesh = meshes[mesh_at.index(meshes.len(), "meshes")?];
        let skin = match node.get("skin")? {
            Some(at) => Some(at.index(scene.rig.skins.len(), "skins")?),
            None => None,
        };
        let slots = skin.map(|skin| scene.rig.skins[skin].joints.len());
        let mut primitives = Vec::new();
        for primitive in mesh.need("primitives")?.items()? {
            primitives.extend(read_primitive(source, primitive, slots, materials)?);
        }
        // Parts without weights in a skinned mesh move with the node, like any rigid mesh.
        let (skinned, rigid): (Vec<_>, Vec<_>) = primitives.into_iter().partition(|p| !p.joints.is_empty());
        for (primitives, skin) in [(skinned, skin), (rigid, None)] {
            if !primitives.is_empty() {
                out.push(Mesh { name: mesh.name(), joint, skin, primitives });
            }
        }
    }
    Ok(out)
}

/// One primitive; `None` for points, lines, and what has no positions. `slots` is the size of the skin, if any.
fn read_primitive<'a>(
    source: &Source<'a>,
    primitive: At<'a>,
    slots: Option<usize>,
    materials: &mut Materials<'_, 'a>,
) -> Result<Option<Primitive>> {
    let mode = primitive.get("mode")?.map_or(Ok(4), At::usize)?;
    let attributes = primitive.need("attributes")?;
    let Some(position_at) = attributes.get("POSITION")? else { return Ok(None) };
    if mode < 4 {
        return Ok(None);
    }
    refuse_compressed(source, primitive, position_at)?;
    let positions: Vec<Vec3> = source.floats(position_at)?.into_iter().map(Vec3::from_array).collect();
    let count = positions.len();
    let normals = read_attribute(source, attributes, "NORMAL", count)?.into_iter();
    let look = materials.look(primitive)?;
    let uv_name = format!("TEXCOORD_{}", look.uv_set);
    let uvs = read_attribute(source, attributes, &uv_name, count)?.into_iter();
    let (joints, weights) = match slots {
        Some(slots) => read_weights(source, attributes, count, slots)?,
        None => Default::default(),
    };
    Ok(Some(Primitive {
        indices: read_triangles(source, primitive, mode, count)?,
        normals: normals.map(|n| normalize_or(Vec3::from_array(n), Vec3::Y)).collect(),
        uvs: uvs.map(Vec2::from_array).collect(),
        colors: read_colors(source, attributes, count)?,
        positions,
        joints,
        weights,
        base_color: look.base_color,
        texture: look.texture,
    }))
}

/// Compressed geometry whose plain fallback is not there.
fn refuse_compressed<'a>(source: &Source<'a>, primitive: At<'a>, position: At<'a>) -> Result<()> {
    let accessor = source.accessors[position.index(source.accessors.len(), "accessors")?];
    let plain = accessor.get("bufferView")?.is_some() || accessor.get("sparse")?.is_some();
    if !plain && primitive.value()["extensions"].get(DRACO).is_some() {
        return Err(primitive.unsupported(draco()));
    }
    Ok(())
}

/// An optional attribute with one element a vertex; empty if absent.
fn read_attribute<'a, const N: usize>(
    source: &Source<'a>,
    attributes: At<'a>,
    name: &str,
    count: usize,
) -> Result<Vec<[f32; N]>> {
    let Some(at) = attributes.get(name)? else { return Ok(Vec::new()) };
    let values = source.floats(at)?;
    check_count(at, values.len(), count)?;
    Ok(values)
}

fn check_count(at: At<'_>, there: usize, vertices: usize) -> Result<()> {
    if there == vertices {
        return Ok(());
    }
    Err(at.malformed(format!("{there} elements for {vertices} vertices")))
}

/// `COLOR_0` as RGBA in 0..=1; RGB gets alpha 1.
fn read_colors<'a>(source: &Source<'a>, attributes: At<'a>, count: usize) -> Result<Vec<[f32; 4]>> {
    let Some(at) = attributes.get("COLOR_0")? else { return Ok(Vec::new()) };
    let colors: Vec<[f32; 4]> = match source.width(at)? {
        3 => source.floats(at)?.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect(),
        _ => source.floats(at)?,
    };
    check_count(at, colors.len(), count)?;
    Ok(colors.into_iter().map(|color| color.map(|x| clamp(x, 0.0, 1.0))).collect())
}

type Weights = (Vec<[u16; 4]>, Vec<[f32; 4]>);

/// Skin slots and weights, the four largest of each vertex, their sum 1. Empty if the primitive has none.
fn read_weights<'a>(source: &Source<'a>, attributes: At<'a>, count: usize, slots: usize) -> Result<Weights> {
    let mut influences: Vec<Vec<(u16, f32)>> = Vec::new();
    for set in 0.. {
        let joints_at = attributes.get(&format!("JOINTS_{set}"))?;
        let weights_at = attributes.get(&format!("WEIGHTS_{set}"))?;
        let (Some(joints_at), Some(weights_at)) = (joints_at, weights_at) else { break };
        let joints = source.integers::<4>(joints_at)?;
        let weights = source.floats::<4>(weights_at)?;
        check_count(joints_at, joints.len(), count)?;
        check_count(weights_at, weights.len(), count)?;
        influences.resize_with(count, Vec::new);
        for (vertex, (joints, weights)) in joints.iter().zip(&weights).enumerate() {
            for (&slot, &weight) in joints.iter().zip(weights) {
                let Some(slot) = u16::try_from(slot).ok().filter(|&s| usize::from(s) < slots) else {
                    let what =
                        format!("vertex {vertex}: joint index {slot} is out of range: the skin has {slots}");
                    return Err(joints_at.malformed(what));
                };
                influences[vertex].push((slot, weight));
            }
        }
    }
    Ok(influences.into_iter().map(strongest_four).unzip())
}

/// Keeps the four largest weights, in order of size beyond four only, and brings their sum to 1. A vertex without any
/// weight follows the first slot it names.
pub(crate) fn strongest_four(mut influences: Vec<(u16, f32)>) -> ([u16; 4], [f32; 4]) {
    if influences.len() > 4 {
        // Stable, so equal weights keep the file's order.
        influences.sort_by(|a, b| b.1.total_cmp(&a.1));
    }
    let mut slots = [0; 4];
    let mut weights = [0.0; 4];
    for (i, &(slot, weight)) in influences.iter().take(4).enumerate() {
        weights[i] = sinew_math::max(weight, 0.0);
        slots[i] = if weights[i] > 0.0 { slot } else { 0 };
    }
    // Divided by the largest first: the sum of four large numbers must not overflow.
    let largest = weights.iter().copied().fold(0.0, sinew_math::max);
    if largest <= 0.0 {
        return ([influences.first().map_or(0, |i| i.0), 0, 0, 0], [1.0, 0.0, 0.0, 0.0]);
    }
    let scaled = weights.map(|w| w / largest);
    let sum: f32 = scaled.iter().sum();
    (slots, scaled.map(|w| w / sum))
}

/// Triangles as a list, whatever the mode: 4 list, 5 strip, 6 fan.
fn read_triangles<'a>(source: &Source<'a>, primitive: At<'a>, mode: usize, count: usize) -> Result<Vec<u32>> {
    let corners: Vec<u32> = match primitive.get("indices")? {
        Some(at) => {
            let indices: Vec<u32> = source.integers(at)?.into_iter().map(|[i]| i).collect();
            if let Some((n, i)) = indices.iter().enumerate().find(|&(_, &i)| i as usize >= count) {
                return Err(at.malformed(format!("index {n} is {i}, but there are {count} vertices")));
            }
            indices
        }
        None => (0..count).map(|i| i as u32).collect(),
    };
    let triangles = corners.len().saturating_sub(2);
    source.spend(primitive, triangles, if mode == 4 { 4 } else { 12 })?;
    Ok(match mode {
        4 => corners[..corners.len() / 3 * 3].to_vec(),
        // Every second triangle of a strip is wound the other way (§3.7.2.1).
        5 => (0..triangles)
            .flat_map(|i| [corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]])
            .collect(),
        6 => (0..triangles).flat_map(|i| [corners[i + 1], corners[i + 2], corners[0]]).collect(),
        _ => return Err(primitive.malformed(format!("unknown primitive mode {mode}"))),
    })
}
