//! Meshes: triangles with skin weights (glTF 2.0 §3.7.2, §3.7.3).

use super::attributes::Attributes;
use super::material::Materials;
use super::scene::Scene;
use super::source::Source;
use crate::container::json::At;
use crate::error::Result;
use sinew_anim::weights::SkinPart;
use sinew_anim::{Primitive, RigMesh};
use sinew_math::{Vec2, Vec3, clamp, normalize_or};

/// Returns one mesh per scene node that places one, and the vertices of skinned meshes without weights.
pub(super) fn read_all<'a>(
    source: &Source<'a>,
    scene: &Scene,
    materials: &mut Materials<'_, 'a>,
    warnings: &mut Vec<String>,
) -> Result<(Vec<RigMesh>, Vec<SkinPart>)> {
    let meshes = source.root.list("meshes")?;
    let (mut out, mut without) = (Vec::new(), Vec::new());
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
        let mut skinned = 0;
        for primitive in mesh.need("primitives")?.items()? {
            let mut mending = Mending { warnings, unweighted: Vec::new() };
            if let Some(read) = read_primitive(source, primitive, slots, materials, &mut mending)? {
                if !read.joints.is_empty() {
                    let vertices = mending.unweighted;
                    without.push(SkinPart { mesh: out.len(), primitive: skinned, vertices });
                    skinned += 1;
                }
                primitives.push(read);
            }
        }
        // Parts without weights in a skinned mesh move with the node, as in a rigid mesh.
        let (skinned, rigid): (Vec<_>, Vec<_>) = primitives.into_iter().partition(|p| !p.joints.is_empty());
        for (primitives, skin) in [(skinned, skin), (rigid, None)] {
            if !primitives.is_empty() {
                out.push(RigMesh { name: mesh.name(), joint, skin, primitives });
            }
        }
    }
    Ok((out, without))
}

/// Record of repaired non-finite numbers in a primitive.
struct Mending<'w> {
    warnings: &'w mut Vec<String>,
    /// Vertices without a weight above 0.
    unweighted: Vec<usize>,
}

impl Mending<'_> {
    /// Reports repaired elements, once per location.
    fn note(&mut self, at: At<'_>, holes: &[usize], of: usize, mended: &str) {
        // Finding a location searches the whole file, so it is done only when needed.
        if holes.is_empty() {
            return;
        }
        let note = format!("{} of {of} elements are not finite: {mended} ({})", holes.len(), at.path());
        if !self.warnings.contains(&note) {
            self.warnings.push(note);
        }
    }
}

/// Reads one primitive; `None` for points, lines, and primitives without positions. `slots` is the size of the skin,
/// if any.
fn read_primitive<'a>(
    source: &Source<'a>,
    primitive: At<'a>,
    slots: Option<usize>,
    materials: &mut Materials<'_, 'a>,
    mending: &mut Mending<'_>,
) -> Result<Option<Primitive>> {
    let mode = primitive.get("mode")?.map_or(Ok(4), At::usize)?;
    let Some(position_at) = primitive.need("attributes")?.get("POSITION")? else { return Ok(None) };
    if mode < 4 {
        return Ok(None);
    }
    let attributes = Attributes::of(source, primitive, position_at)?;
    let (mut positions, holes) = attributes.floats::<3>("POSITION", position_at)?;
    let count = positions.len();
    let indices = match attributes.triangles()? {
        Some(corners) => corners,
        None => read_triangles(source, primitive, mode, count)?,
    };
    let used = |hole: &&usize| indices.iter().any(|&corner| corner as usize == **hole);
    // Vertices without a triangle are harmless, but must not enlarge the body.
    if let Some(hole) = holes.iter().take(MOST_UNUSED).find(used).or(holes.get(MOST_UNUSED)) {
        return Err(source.not_finite(position_at, *hole));
    }
    let whole = (0..count).find(|vertex| holes.binary_search(vertex).is_err());
    let whole = whole.map_or([0.0; 3], |vertex| positions[vertex]);
    holes.iter().for_each(|&hole| positions[hole] = whole);
    mending.note(position_at, &holes, count, "no triangle uses them");
    let normals = read_attribute(&attributes, "NORMAL", count, mending)?.into_iter();
    let look = materials.look(primitive)?;
    let uv_name = format!("TEXCOORD_{}", look.uv_set);
    let uvs = read_attribute(&attributes, &uv_name, count, mending)?.into_iter();
    let (joints, weights) = match slots {
        Some(slots) => read_weights(&attributes, count, slots, mending)?,
        None => Default::default(),
    };
    Ok(Some(Primitive {
        indices,
        normals: normals.map(|n| normalize_or(Vec3::from_array(n), Vec3::Y)).collect(),
        uvs: uvs.map(Vec2::from_array).collect(),
        colors: read_colors(source, &attributes, count, mending)?,
        positions: positions.into_iter().map(Vec3::from_array).collect(),
        joints,
        weights,
        base_color: look.base_color,
        texture: look.texture,
        material: look.name,
    }))
}

/// Largest number of non-finite positions outside triangles that are checked; a file with more is rejected.
const MOST_UNUSED: usize = 64;

/// Reads an optional attribute with one element per vertex; empty if absent. Non-finite numbers become 0.
fn read_attribute<const N: usize>(
    attributes: &Attributes<'_, '_>,
    name: &str,
    count: usize,
    mending: &mut Mending<'_>,
) -> Result<Vec<[f32; N]>> {
    let Some(at) = attributes.get(name)? else { return Ok(Vec::new()) };
    let (values, holes) = attributes.floats(name, at)?;
    check_count(at, values.len(), count)?;
    mending.note(at, &holes, count, "taken as 0");
    Ok(values)
}

fn check_count(at: At<'_>, there: usize, vertices: usize) -> Result<()> {
    if there == vertices {
        return Ok(());
    }
    Err(at.malformed(format!("{there} elements for {vertices} vertices")))
}

/// Reads `COLOR_0` as RGBA in 0..=1; RGB gets alpha 1. Non-finite colours become white.
fn read_colors<'a>(
    source: &Source<'a>,
    attributes: &Attributes<'_, 'a>,
    count: usize,
    mending: &mut Mending<'_>,
) -> Result<Vec<[f32; 4]>> {
    const NAME: &str = "COLOR_0";
    let Some(at) = attributes.get(NAME)? else { return Ok(Vec::new()) };
    let (mut colors, holes): (Vec<[f32; 4]>, _) = match source.width(at)? {
        3 => {
            let (colors, holes) = attributes.floats(NAME, at)?;
            (colors.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect(), holes)
        }
        _ => attributes.floats(NAME, at)?,
    };
    check_count(at, colors.len(), count)?;
    holes.iter().for_each(|&hole| colors[hole] = [1.0; 4]);
    mending.note(at, &holes, count, "taken as white");
    Ok(colors.into_iter().map(|color| color.map(|x| clamp(x, 0.0, 1.0))).collect())
}

type Weights = (Vec<[u16; 4]>, Vec<[f32; 4]>);

/// Reads skin slots and weights: the four largest of each vertex, with sum 1. Empty if the primitive has none.
fn read_weights(
    attributes: &Attributes<'_, '_>,
    count: usize,
    slots: usize,
    mending: &mut Mending<'_>,
) -> Result<Weights> {
    let mut influences: Vec<Vec<(u16, f32)>> = Vec::new();
    for set in 0.. {
        let names = [format!("JOINTS_{set}"), format!("WEIGHTS_{set}")];
        let (Some(joints_at), Some(weights_at)) = (attributes.get(&names[0])?, attributes.get(&names[1])?)
        else {
            break;
        };
        let joints = attributes.integers::<4>(&names[0], joints_at)?;
        let (weights, holes) = attributes.floats::<4>(&names[1], weights_at)?;
        check_count(joints_at, joints.len(), count)?;
        check_count(weights_at, weights.len(), count)?;
        mending.note(weights_at, &holes, count, "taken as 0");
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
    let is_bare = |vertex: &usize| influences[*vertex].iter().all(|&(_, weight)| weight <= 0.0);
    mending.unweighted.extend((0..influences.len()).filter(is_bare));
    Ok(influences.into_iter().map(strongest_four).unzip())
}

/// Keeps the four largest weights, sorted only if there are more, and normalises their sum to 1. A vertex without
/// weights follows its first slot.
pub(crate) fn strongest_four(mut influences: Vec<(u16, f32)>) -> ([u16; 4], [f32; 4]) {
    if influences.len() > 4 {
        // The sort is stable, so equal weights keep the file's order.
        influences.sort_by(|a, b| b.1.total_cmp(&a.1));
    }
    let mut slots = [0; 4];
    let mut weights = [0.0; 4];
    for (i, &(slot, weight)) in influences.iter().take(4).enumerate() {
        weights[i] = sinew_math::max(weight, 0.0);
        slots[i] = if weights[i] > 0.0 { slot } else { 0 };
    }
    // Divides by the largest first, because the sum of four large numbers must not overflow.
    let largest = weights.iter().copied().fold(0.0, sinew_math::max);
    if largest <= 0.0 {
        return ([influences.first().map_or(0, |i| i.0), 0, 0, 0], [1.0, 0.0, 0.0, 0.0]);
    }
    let scaled = weights.map(|w| w / largest);
    let sum: f32 = scaled.iter().sum();
    (slots, scaled.map(|w| w / sum))
}

/// Reads the triangles of every mode as a list: 4 list, 5 strip, 6 fan.
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
        // Every second triangle of a strip has reversed winding (§3.7.2.1).
        5 => (0..triangles)
            .flat_map(|i| [corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]])
            .collect(),
        6 => (0..triangles).flat_map(|i| [corners[i + 1], corners[i + 2], corners[0]]).collect(),
        _ => return Err(primitive.malformed(format!("unknown primitive mode {mode}"))),
    })
}
