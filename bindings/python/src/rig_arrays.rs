//! Creates rigs and clips from arrays.

use crate::arrays::{elements, floats, vectors};
use crate::errors::bad;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sinew::anim::{
    Channel, Clip, Interpolation, Joint, LocalTransform, Primitive, Property, Rig, RigMesh, Skin,
};
use sinew::math::{Affine, Mat3, Rotation, Vec3};

/// Largest number of influences per vertex.
const INFLUENCES: usize = 4;

/// Makes a rig without skin from names, parents (-1 for a root), and the rest pose.
pub fn skeleton(
    names: Vec<String>,
    parents: &Bound<'_, PyAny>,
    [translations, rotations]: [&Bound<'_, PyAny>; 2],
    scales: Option<&Bound<'_, PyAny>>,
) -> PyResult<Rig> {
    let count = Some(names.len());
    if names.is_empty() {
        return Err(bad("joints must not be empty"));
    }
    let parents: Vec<i64> = elements(parents, &[count], "parents")?;
    let translations = vectors(&floats(translations, &[count, Some(3)], "translations")?);
    let rotations = floats(rotations, &[count, Some(4)], "rotations")?;
    let scales = match scales {
        Some(scales) => vectors(&floats(scales, &[count, Some(3)], "scales")?),
        None => vec![Vec3::ONE; names.len()],
    };
    let mut rig = Rig::default();
    for (index, name) in names.into_iter().enumerate() {
        let parent = match parents[index] {
            -1 => None,
            parent if (0..index as i64).contains(&parent) => Some(parent as usize),
            parent => {
                return Err(bad(format!(
                    "parents: joint {index} has parent {parent}; it must come before, or be -1"
                )));
            }
        };
        let rest = LocalTransform {
            translation: translations[index],
            rotation: unit(&rotations[4 * index..], "rotations")?,
            scale: scales[index],
        };
        rig.joints.push(Joint { name, parent, rest, source: index });
    }
    Ok(rig)
}

fn unit(q: &[f32], name: &str) -> PyResult<Rotation> {
    let rotation = Rotation { x: q[0], y: q[1], z: q[2], w: q[3] };
    let length = rotation.length();
    if length.is_nan() || length < 1e-6 {
        return Err(bad(format!("{name}: a quaternion must not be zero")));
    }
    Ok(rotation.normalize())
}

/// Adds one skin of all joints and the meshes to a rig.
pub fn skin(
    rig: &mut Rig,
    inverse_bind: Option<&Bound<'_, PyAny>>,
    meshes: &[Bound<'_, PyDict>],
) -> PyResult<()> {
    let count = rig.joints.len();
    let inverse_bind = match inverse_bind {
        Some(given) => {
            let numbers = floats(given, &[Some(count), Some(4), Some(4)], "inverse_bind")?;
            numbers.chunks_exact(16).map(affine).collect()
        }
        None => rest_model(rig).iter().map(Affine::inverse).collect::<Vec<_>>(),
    };
    if let Some(joint) = inverse_bind.iter().position(|bind| !bind.is_finite()) {
        return Err(bad(format!("inverse_bind: the matrix of joint {joint} is singular")));
    }
    rig.skins.push(Skin { name: String::new(), joints: (0..count).collect(), inverse_bind });
    for (index, given) in meshes.iter().enumerate() {
        let mesh = mesh(given, index, count)?;
        rig.meshes.push(mesh);
    }
    Ok(())
}

/// Returns the rest pose of each joint in model space.
fn rest_model(rig: &Rig) -> Vec<Affine> {
    let mut model: Vec<Affine> = Vec::new();
    for joint in &rig.joints {
        let local = joint.rest.to_affine();
        model.push(joint.parent.map_or(local, |parent| model[parent] * local));
    }
    model
}

/// Makes a map from a 4×4 matrix, given row by row; the last row is ignored.
fn affine(m: &[f32]) -> Affine {
    let column = |k: usize| Vec3::new(m[k], m[4 + k], m[8 + k]);
    Affine { linear: Mat3::from_cols(column(0), column(1), column(2)), translation: column(3) }
}

fn mesh(given: &Bound<'_, PyDict>, index: usize, joint_count: usize) -> PyResult<RigMesh> {
    let of = |key: &str| format!("meshes[{index}].{key}");
    let need = |key: &str| given.get_item(key)?.ok_or_else(|| bad(format!("{} is missing", of(key))));
    let positions = vectors(&floats(&need("positions")?, &[None, Some(3)], &of("positions"))?);
    let vertices = positions.len();
    let triangles: Vec<u32> = elements(&need("triangles")?, &[None, Some(3)], &of("triangles"))?;
    if let Some(&vertex) = triangles.iter().find(|&&vertex| vertex as usize >= vertices) {
        return Err(bad(format!("{}: vertex {vertex} of {vertices}", of("triangles"))));
    }
    let name = match given.get_item("name")? {
        Some(name) => name.extract()?,
        None => format!("mesh {index}"),
    };
    let primitive =
        Primitive { positions, indices: triangles, base_color: [0.8, 0.8, 0.8, 1.0], ..Primitive::default() };
    if let Some(joint) = given.get_item("joint")? {
        let joint: usize = joint.extract()?;
        if joint >= joint_count {
            return Err(bad(format!("{}: joint {joint} of {joint_count}", of("joint"))));
        }
        return Ok(RigMesh { name, joint, skin: None, primitives: vec![primitive] });
    }
    let slots: Vec<u16> = elements(&need("joints")?, &[Some(vertices), Some(INFLUENCES)], &of("joints"))?;
    if let Some(slot) = slots.iter().find(|&&slot| usize::from(slot) >= joint_count) {
        return Err(bad(format!("{}: joint {slot} of {joint_count}", of("joints"))));
    }
    let weights = floats(&need("weights")?, &[Some(vertices), Some(INFLUENCES)], &of("weights"))?;
    if weights.iter().any(|weight| *weight < 0.0) {
        return Err(bad(format!("{} must be at least 0", of("weights"))));
    }
    let even = |w: &[f32]| {
        let sum: f32 = w.iter().sum();
        if sum > 0.0 { [w[0] / sum, w[1] / sum, w[2] / sum, w[3] / sum] } else { [1.0, 0.0, 0.0, 0.0] }
    };
    let primitive = Primitive {
        joints: slots.chunks_exact(INFLUENCES).map(|j| [j[0], j[1], j[2], j[3]]).collect(),
        weights: weights.chunks_exact(INFLUENCES).map(even).collect(),
        ..primitive
    };
    Ok(RigMesh { name, joint: 0, skin: Some(0), primitives: vec![primitive] })
}

/// Makes clips from a dictionary by name: times (f,), translations (f, n, 3), rotations (f, n, 4), scales (f,
/// n, 3).
pub fn clips(rig: &Rig, given: &Bound<'_, PyDict>) -> PyResult<Vec<Clip>> {
    let mut clips = Vec::new();
    for (name, clip) in given {
        let name: String = name.extract()?;
        let clip = clip.cast::<PyDict>().map_err(|_| bad(format!("clips[{name:?}] is not a dictionary")))?;
        clips.push(one_clip(rig, name, clip)?);
    }
    Ok(clips)
}

fn one_clip(rig: &Rig, name: String, given: &Bound<'_, PyDict>) -> PyResult<Clip> {
    let of = |key: &str| format!("clips[{name:?}].{key}");
    let times = given.get_item("times")?.ok_or_else(|| bad(format!("{} are missing", of("times"))))?;
    let times = floats(&times, &[None], &of("times"))?;
    let ascend = times.windows(2).all(|pair| pair[0] < pair[1]);
    if times.is_empty() || times[0] < 0.0 || !ascend {
        return Err(bad(format!("{} must be at least 0 and ascend", of("times"))));
    }
    let joints = rig.joints.len();
    let mut channels = Vec::new();
    for (key, property) in [
        ("translations", Property::Translation),
        ("rotations", Property::Rotation),
        ("scales", Property::Scale),
    ] {
        let Some(given) = given.get_item(key)? else { continue };
        let width = property.width();
        let numbers = floats(&given, &[Some(times.len()), Some(joints), Some(width)], &of(key))?;
        for joint in 0..joints {
            let rows =
                numbers.chunks_exact(width * joints).map(|frame| &frame[width * joint..width * (joint + 1)]);
            let values = match property {
                Property::Rotation => near(rows, &of(key))?,
                _ => rows.flatten().copied().collect(),
            };
            channels.push(Channel {
                joint,
                property,
                interpolation: Interpolation::Linear,
                times: times.clone(),
                values,
            });
        }
    }
    if channels.is_empty() {
        return Err(bad(format!("clips[{name:?}] moves nothing")));
    }
    Ok(Clip { duration: times[times.len() - 1], name, channels })
}

/// Returns unit quaternions, each with the sign nearest to the previous one.
fn near<'a>(rows: impl Iterator<Item = &'a [f32]>, name: &str) -> PyResult<Vec<f32>> {
    let mut values = Vec::new();
    let mut last: Option<Rotation> = None;
    for row in rows {
        let turn = unit(row, name)?;
        let turn = last.map_or(turn, |last| turn.toward(last));
        values.extend([turn.x, turn.y, turn.z, turn.w]);
        last = Some(turn);
    }
    Ok(values)
}
