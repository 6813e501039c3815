//! Ragdoll files, version 1 (`NAME.sinew.json`), written by `sinew ragdoll build` and editable by hand.
//!
//! ```json
//! {
//!   "sinew": "ragdoll",
//!   "version": 1,
//!   "total_mass": 60,
//!   "height": 1.7,
//!   "unit_scale": 0.01,
//!   "up_axis": [0, 1, 0],
//!   "character_from_model": { "rotation": [0, 0, 0, 1] },
//!   "bodies": [
//!     {
//!       "bone": "Hips",
//!       "role": "hips",
//!       "confidence": 1,
//!       "rig_joint": 2,
//!       "position": [0, 0.95, 0],
//!       "shape": { "type": "box", "half_extents": [0.16, 0.1, 0.1] },
//!       "mass": { "kg": 40, "center": [0, 0, 0], "inertia": [0.5, 0.6, 0.5, 0, 0, 0] }
//!     },
//!     {
//!       "bone": "LeftUpLeg",
//!       "role": "leftUpperLeg",
//!       "confidence": 0.9,
//!       "rig_joint": 5,
//!       "merged_rig_joints": [6],
//!       "position": [0.1, 0.7, 0],
//!       "shape": { "type": "capsule", "half_height": 0.15, "radius": 0.07 },
//!       "mass": { "kg": 20, "center": [0, 0, 0], "inertia": [0.2, 0.05, 0.2, 0, 0, 0] },
//!       "joint": {
//!         "parent": "Hips",
//!         "type": "ball",
//!         "limits_deg": { "swing_y": [-40, 40], "swing_z": [-20, 110], "twist": [-35, 35] },
//!         "friction_torque": 0.5,
//!         "frame_in_parent": { "position": [0.1, -0.05, 0] },
//!         "frame_in_child": { "position": [0, 0.2, 0] }
//!       }
//!     }
//!   ],
//!   "disabled_pairs": [["Hips", "LeftUpLeg"]],
//!   "dropped_bones": ["LeftHandThumb1"]
//! }
//! ```
//!
//! Metres, kilograms; angles in degrees. `position` and `rotation` of a body are those of its frame in character space
//! at the bind pose (+Y up, facing +Z, feet at y = 0); the shape is at this frame. Every body but the first has a
//! `joint` to a `parent` that precedes it. The x axis of the joint's frames is the axis of a hinge and of twist:
//! - `ball`: `limits_deg` of `swing_y`, `swing_z` (zero lies inside) and `twist`;
//! - `universal`: the same, without `twist`;
//! - `hinge`: `limits_deg` of `twist` only;
//! - `fixed`: none. Without `limits_deg` a joint is unlimited.
//!
//! A body is referred to by its `bone`, or by its number from 0 where two have the same bone name. Shapes, poses and
//! masses are as in [world files](crate::world). A key that is not listed here is an error.
//!
//! ```
//! use sinew_formats::{read_ragdoll, write_ragdoll};
//!
//! let def = sinew::mannequin::character().ragdoll;
//! let read = read_ragdoll(write_ragdoll(&def).as_bytes())?;
//! assert_eq!((read.bodies.len(), &read.bodies[0].role), (def.bodies.len(), &def.bodies[0].role));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod settings;

use crate::container::json::{self, At, number, numbers};
use crate::error::{Result, quoted};
use crate::parts::{self, POSE_KEYS, SHAPE_KEYS};
use serde_json::{Map, Value, json};
use sinew_math::{Range, SwingTwistLimit, Transform, Vec3};
use sinew_physics::{JointKind, MassProperties, Shape};
use sinew_ragdoll::{RagdollBodyDef, RagdollDef, RagdollJointDef};

const VERSION: usize = 1;

/// Largest number of bodies, that of the largest joint tree. The number of pairs grows with its square.
const MOST_BODIES: usize = 1024;
/// Largest distance and largest size, metres.
const FARTHEST: f32 = 1e6;
/// Smallest size, metres.
const SMALLEST: f32 = 1e-6;
/// Range of masses, kg. Moments of inertia are between the square of the smallest mass and the largest mass, kg·m².
const LIGHTEST: f32 = 1e-9;
const HEAVIEST: f32 = 1e12;

const ROOT_KEYS: [&str; 11] = [
    "sinew",
    "version",
    "comment",
    "total_mass",
    "height",
    "unit_scale",
    "up_axis",
    "character_from_model",
    "bodies",
    "disabled_pairs",
    "dropped_bones",
];

const BODY_KEYS: [&str; 9] =
    ["bone", "role", "confidence", "rig_joint", "merged_rig_joints", "shape", "mass", "joint", "comment"];

const JOINT_KEYS: [&str; 7] =
    ["parent", "type", "limits_deg", "friction_torque", "frame_in_parent", "frame_in_child", "comment"];

/// Reads the ragdoll of a ragdoll file. Rig joints are indices that only the rig can check.
///
/// # Errors
/// Returns an error that names the location, such as `bodies[3].joint.limits_deg.twist`: no bodies, a parent that does
/// not precede its child, reversed limits, sizes and masses that are not positive, unknown keys and names, a later
/// version.
pub fn read_ragdoll(bytes: &[u8]) -> Result<RagdollDef> {
    let value = json::parse(bytes)?;
    let root = At::root(&value);
    json::check_header(root, "ragdoll", VERSION)?;
    root.only(&ROOT_KEYS)?;
    let bodies_at = root.need("bodies")?;
    let body_list = bodies_at.items()?;
    if body_list.is_empty() {
        return Err(bodies_at.malformed("a ragdoll needs at least one body"));
    }
    if body_list.len() > MOST_BODIES {
        return Err(bodies_at.unsupported(format!("more than {MOST_BODIES} bodies")));
    }
    let mut def = RagdollDef {
        total_mass: root.need("total_mass")?.positive()?,
        height: read_scale(root.need("height")?)?,
        unit_scale: read_scale(root.need("unit_scale")?)?,
        up_axis: read_up_axis(root.need("up_axis")?)?,
        character_from_model: root
            .get("character_from_model")?
            .map_or(Ok(Transform::IDENTITY), read_frame)?,
        ..RagdollDef::default()
    };
    for (child, &at) in body_list.iter().enumerate() {
        def.bodies.push(read_body(at)?);
        match (child, at.get("joint")?) {
            (0, None) => {}
            (0, Some(joint)) => return Err(joint.malformed("the first body has no joint")),
            (_, Some(joint)) => def.joints.push(read_joint(joint, child, &def.bodies)?),
            (_, None) => return Err(at.malformed("`joint` is missing")),
        }
    }
    for pair in root.list("disabled_pairs")? {
        let [a, b] = pair.items()?[..] else { return Err(pair.malformed("must name two bodies")) };
        let (a, b) = (read_reference(a, &def.bodies)?, read_reference(b, &def.bodies)?);
        if a == b {
            return Err(pair.malformed("must name two different bodies"));
        }
        def.disabled_pairs.push((a, b));
    }
    for bone in root.list("dropped_bones")? {
        def.dropped_bones.push(bone.str()?.to_owned());
    }
    Ok(def)
}

fn read_up_axis(at: At<'_>) -> Result<Vec3> {
    let axis = Vec3::from_array(at.numbers()?);
    let on_axis = sinew_math::abs3(axis).to_array().iter().filter(|&&x| x == 1.0).count() == 1;
    if !on_axis || axis.dot(axis) > 1.0 {
        return Err(at.malformed("must be a unit vector along an axis"));
    }
    Ok(axis)
}

fn read_frame(at: At<'_>) -> Result<Transform> {
    at.only(&POSE_KEYS)?;
    read_pose(at)
}

/// Reads a pose within [`FARTHEST`], so that sums and squares of its numbers stay finite.
fn read_pose(at: At<'_>) -> Result<Transform> {
    let pose = parts::read_pose(at)?;
    if sinew_math::abs3(pose.translation).max_element() > FARTHEST {
        let at = at.get("position")?.unwrap_or(at);
        return Err(at.malformed("lies more than 1,000 km away"));
    }
    Ok(pose)
}

fn read_shape(at: At<'_>) -> Result<Shape> {
    at.only(&SHAPE_KEYS)?;
    let shape = parts::read_shape(at)?;
    if !shape.is_solid() {
        let name = at.need("type")?.str()?;
        return Err(at.malformed(format!("a body of a ragdoll cannot be a {name}")));
    }
    // The comparison is false for NaN, so NaN is rejected.
    if !(shape.smallest_extent() >= SMALLEST && shape.bounding_radius() <= FARTHEST) {
        return Err(at.malformed("is smaller than a micrometre or larger than 1,000 km"));
    }
    Ok(shape)
}

fn read_mass(at: At<'_>) -> Result<MassProperties> {
    let mass = parts::read_mass(at)?;
    let moments = mass.inertia.eigen().0;
    let light = (LIGHTEST..=HEAVIEST).contains(&mass.mass);
    if !(light && moments.z >= LIGHTEST * LIGHTEST && moments.x <= HEAVIEST) {
        return Err(at.malformed("a mass or moment out of range"));
    }
    if sinew_math::abs3(mass.center).max_element() > FARTHEST {
        return Err(at.malformed("its centre lies more than 1,000 km away"));
    }
    Ok(mass)
}

/// Reads a length between positive limits, so that its square is in range, too.
fn read_scale(at: At<'_>) -> Result<f32> {
    let scale = at.positive()?;
    if !(SMALLEST..=FARTHEST).contains(&scale) {
        return Err(at.malformed("must lie between a millionth and a million"));
    }
    Ok(scale)
}

fn read_body(at: At<'_>) -> Result<RagdollBodyDef> {
    at.only(&[&BODY_KEYS[..], &POSE_KEYS].concat())?;
    let merged = at.list("merged_rig_joints")?.into_iter().map(At::usize);
    let confidence = at.need("confidence")?;
    if !(0.0..=1.0).contains(&confidence.f32()?) {
        return Err(confidence.malformed("must be between 0 and 1"));
    }
    Ok(RagdollBodyDef {
        bone: at.need("bone")?.str()?.to_owned(),
        joint: at.need("rig_joint")?.usize()?,
        merged: merged.collect::<Result<_>>()?,
        role: at.need("role")?.str()?.to_owned(),
        confidence: confidence.f32()?,
        shape: read_shape(at.need("shape")?)?,
        character_from_body: read_pose(at)?,
        mass: read_mass(at.need("mass")?)?,
    })
}

/// Reads the joint of the body `child`; its parent must have been read already.
fn read_joint(at: At<'_>, child: usize, bodies: &[RagdollBodyDef]) -> Result<RagdollJointDef> {
    at.only(&JOINT_KEYS)?;
    let parent_at = at.need("parent")?;
    let parent = read_reference(parent_at, bodies)?;
    if parent >= child {
        return Err(parent_at.malformed("a parent must come before its child"));
    }
    let frame = |key: &str| at.get(key)?.map_or(Ok(Transform::IDENTITY), read_frame);
    Ok(RagdollJointDef {
        parent,
        child,
        frame_parent: frame("frame_in_parent")?,
        frame_child: frame("frame_in_child")?,
        kind: read_kind(at)?,
        friction_torque: at.get("friction_torque")?.map_or(Ok(0.0), read_torque)?,
    })
}

fn read_torque(at: At<'_>) -> Result<f32> {
    let torque = at.not_negative()?;
    if torque > HEAVIEST {
        return Err(at.malformed("a torque out of range"));
    }
    Ok(torque)
}

/// Reads a reference to a body: the name of its bone, or its number.
fn read_reference(at: At<'_>, bodies: &[RagdollBodyDef]) -> Result<usize> {
    let Some(name) = at.value().as_str() else { return at.index(bodies.len(), "bodies before") };
    let mut named = (0..bodies.len()).filter(|&i| bodies[i].bone == name);
    match (named.next(), named.next()) {
        (Some(body), None) => Ok(body),
        (Some(_), Some(_)) => Err(at.malformed("two bodies have this bone name: use the number of the body")),
        (None, _) => Err(at.malformed(format!("no body above has the bone name {}", quoted(name)))),
    }
}

pub(crate) fn read_kind(at: At<'_>) -> Result<JointKind> {
    let kind = at.need("type")?;
    let limits = at.get("limits_deg")?;
    Ok(match kind.str()? {
        "ball" => JointKind::Ball { limit: limits.map(read_cone).transpose()? },
        "universal" => JointKind::Universal { limit: limits.map(read_cone).transpose()? },
        "hinge" => JointKind::Hinge { limit: limits.map(read_hinge_range).transpose()? },
        "fixed" => match limits {
            None => JointKind::Fixed,
            Some(at) => return Err(at.malformed("a fixed joint has no limits")),
        },
        _ => return Err(kind.malformed("must be ball, hinge, universal or fixed")),
    })
}

fn read_cone(at: At<'_>) -> Result<SwingTwistLimit> {
    at.only(&["swing_y", "swing_z", "twist"])?;
    let swing = |key: &str| {
        let at = at.need(key)?;
        let range = read_range(at)?;
        if range.lo > 0.0 || range.hi < 0.0 {
            return Err(at.malformed("a swing's range must contain zero"));
        }
        Ok(range)
    };
    Ok(SwingTwistLimit {
        swing_y: swing("swing_y")?,
        swing_z: swing("swing_z")?,
        twist: read_range(at.need("twist")?)?,
    })
}

fn read_hinge_range(at: At<'_>) -> Result<Range> {
    at.only(&["twist"])?;
    read_range(at.need("twist")?)
}

/// Reads two angles in degrees, in ascending order, within half a turn.
fn read_range(at: At<'_>) -> Result<Range> {
    let items = at.items()?;
    let [lo, hi] = items[..] else { return Err(at.malformed("must be [lowest, highest]")) };
    let mut angles = [0.0; 2];
    for (angle, at) in angles.iter_mut().zip([lo, hi]) {
        let degrees = at.f64()?;
        // The limit is slightly above 180°, because half a turn in f32 radians is not exactly 180°.
        if degrees.abs() > 180.001 {
            return Err(at.malformed("must lie between -180 and 180 degrees"));
        }
        *angle = degrees.to_radians() as f32;
    }
    if angles[0] > angles[1] {
        return Err(at.malformed("the lower end comes first"));
    }
    Ok(Range::new(angles[0], angles[1]))
}

/// Returns the text of a ragdoll file, which reads back as an equal ragdoll.
///
/// # Panics
/// If a number is not finite, or the joints are not in the order of the bodies (`joints[i].child == i + 1`).
pub fn write_ragdoll(def: &RagdollDef) -> String {
    assert!(
        def.joints.len() + 1 == def.bodies.len()
            && def.joints.iter().enumerate().all(|(i, joint)| joint.child == i + 1),
        "every body but the first has one joint, in the order of the bodies"
    );
    let bodies: Vec<Value> = (0..def.bodies.len()).map(|i| write_body(def, i)).collect();
    let pairs: Vec<Value> = def
        .disabled_pairs
        .iter()
        .map(|&(a, b)| json!([write_reference(def, a), write_reference(def, b)]))
        .collect();
    json::to_text(&json!({
        "sinew": "ragdoll",
        "version": VERSION,
        "total_mass": number(def.total_mass),
        "height": number(def.height),
        "unit_scale": number(def.unit_scale),
        "up_axis": numbers(&def.up_axis.to_array()),
        "character_from_model": write_frame(def.character_from_model),
        "bodies": bodies,
        "disabled_pairs": pairs,
        "dropped_bones": def.dropped_bones,
    }))
}

fn write_body(def: &RagdollDef, index: usize) -> Value {
    let body = &def.bodies[index];
    let mut object = Map::new();
    let mut shape = Map::new();
    parts::write_shape(&body.shape, &mut shape);
    object.insert("bone".into(), body.bone.as_str().into());
    object.insert("role".into(), body.role.as_str().into());
    object.insert("confidence".into(), number(body.confidence));
    object.insert("rig_joint".into(), body.joint.into());
    if !body.merged.is_empty() {
        object.insert("merged_rig_joints".into(), json!(body.merged));
    }
    parts::write_pose(body.character_from_body, &mut object);
    object.insert("shape".into(), shape.into());
    object.insert("mass".into(), parts::write_mass(&body.mass));
    if index > 0 {
        object.insert("joint".into(), write_joint(def, &def.joints[index - 1]));
    }
    object.into()
}

fn write_joint(def: &RagdollDef, joint: &RagdollJointDef) -> Value {
    let kind = match joint.kind {
        JointKind::Ball { .. } => "ball",
        JointKind::Universal { .. } => "universal",
        JointKind::Hinge { .. } => "hinge",
        JointKind::Fixed => "fixed",
        kind => unreachable!("{kind:?}: joints of a ragdoll only rotate"),
    };
    let mut object = Map::new();
    object.insert("parent".into(), write_reference(def, joint.parent));
    object.insert("type".into(), kind.into());
    if let Some(limits) = write_limits(&joint.kind) {
        object.insert("limits_deg".into(), limits);
    }
    object.insert("friction_torque".into(), number(joint.friction_torque));
    object.insert("frame_in_parent".into(), write_frame(joint.frame_parent));
    object.insert("frame_in_child".into(), write_frame(joint.frame_child));
    object.into()
}

/// Returns the JSON value of `limits_deg`; `None` for a joint without limits.
pub(crate) fn write_limits(kind: &JointKind) -> Option<Value> {
    match kind {
        JointKind::Ball { limit } | JointKind::Universal { limit } => limit.map(|limit| {
            let [y, z, twist] = [limit.swing_y, limit.swing_z, limit.twist].map(write_range);
            json!({"swing_y": y, "swing_z": z, "twist": twist})
        }),
        JointKind::Hinge { limit } => limit.map(|range| json!({"twist": write_range(range)})),
        _ => None,
    }
}

fn write_frame(frame: Transform) -> Value {
    let mut object = Map::new();
    parts::write_pose(frame, &mut object);
    object.into()
}

/// Returns the bone name of a body if it is unique, else the body's number.
fn write_reference(def: &RagdollDef, body: usize) -> Value {
    let name = &def.bodies[body].bone;
    let same = def.bodies.iter().filter(|other| other.bone == *name).count();
    if same == 1 { name.as_str().into() } else { body.into() }
}

fn write_range(range: Range) -> Value {
    json!([write_degrees(range.lo), write_degrees(range.hi)])
}

/// Converts to the shortest decimal in degrees that reads back as the same radians.
fn write_degrees(radians: f32) -> Value {
    let exact = f64::from(radians).to_degrees();
    let mut unit = 1.0;
    for _ in 0..9 {
        let rounded = (exact * unit).round() / unit;
        // Compares bits, because the −0 of a mirrored limit is part of a snapshot.
        if (rounded.to_radians() as f32).to_bits() == radians.to_bits() {
            return Value::from(rounded);
        }
        unit *= 10.0;
    }
    Value::from(exact)
}
