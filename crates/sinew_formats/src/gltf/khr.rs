//! Writes a ragdoll into the user's own file, as `KHR_physics_rigid_bodies` with `KHR_implicit_shapes` (drafts of
//! October 2025).

use super::Document;
use super::append::Editor;
use crate::container::json::{number, numbers};
use crate::error::{Error, Result, quoted};
use serde_json::{Map, Value, json};
use sinew_math::{Affine, Range, Rotation, SwingTwistLimit, Transform, Vec3, max};
use sinew_physics::{JointKind, Shape};
use sinew_ragdoll::mapping::character_from_model;
use sinew_ragdoll::{BodySettings, RagdollDef};

const BODIES: &str = "KHR_physics_rigid_bodies";
const SHAPES: &str = "KHR_implicit_shapes";

/// A file with physics.
#[derive(Clone, Debug, PartialEq)]
pub struct KhrFile {
    /// Bytes of a GLB.
    pub bytes: Vec<u8>,
    /// Notes on features that the drafts cannot represent, one sentence each.
    pub notes: Vec<String>,
}

/// Returns the user's own file with the ragdoll on its joints, as a GLB. Existing content is unchanged. Each body adds
/// `motion` to its node and a child node with its collider; each joint adds a node on each side at its pivot.
///
/// Lengths are in the file's unit, masses in kilograms, inertias in kilograms times the unit squared. `extras.sinew` of
/// the joints has data that the drafts cannot represent: they limit swing by a circle or per axis, but a ragdoll's cone
/// is an ellipse. Hulls become their bounding box. Body and bone coincide in the bind pose (`RigAnalysis::bind_model`).
///
/// # Errors
/// If the file already has physics; also as [`append_clips`](super::append_clips).
///
/// # Panics
/// If the definition's joints are not those of the document's rig (see `RagdollDef::for_rig`), or `bind_model` is not
/// as long as the rig has joints.
pub fn write_khr(document: &Document, bind_model: &[Affine], def: &RagdollDef) -> Result<KhrFile> {
    assert_eq!(bind_model.len(), document.rig.joints.len(), "the bind pose has one transform per joint");
    let known = &document.json["extensions"];
    if known.get(BODIES).is_some() || known.get(SHAPES).is_some() {
        return Err(Error::unsupported("the file already has physics", format!("extensions.{BODIES}")));
    }
    let mut editor = Editor::open(document)?;
    editor.embed_external(document)?;
    let mut writer = Writer {
        editor,
        def,
        model_from_character: character_from_model(def).inverse(),
        bind: bind_model,
        nodes: def.bodies.iter().map(|body| document.rig.joints[body.joint].source).collect(),
        shapes: Vec::new(),
        notes: Vec::new(),
    };
    for body in 0..def.bodies.len() {
        writer.body(body)?;
    }
    let joints = (0..def.joints.len()).map(|joint| writer.joint(joint)).collect::<Result<Vec<Value>>>()?;
    writer.finish(joints, &document.other_chunks)
}

struct Writer<'a> {
    editor: Editor,
    def: &'a RagdollDef,
    model_from_character: Affine,
    bind: &'a [Affine],
    /// The node that carries each body.
    nodes: Vec<usize>,
    shapes: Vec<Value>,
    notes: Vec<String>,
}

impl Writer<'_> {
    /// Returns a body frame relative to its bone, and the length of a metre in the bone's unit.
    fn seen_from_bone(&self, body: usize, body_from_frame: Transform) -> (Transform, f32) {
        let character = Affine::from(self.def.bodies[body].character_from_body * body_from_frame);
        let bone = self.bind[self.def.bodies[body].joint].inverse();
        let seen = bone * self.model_from_character * character;
        let m = &seen.linear;
        let metre = (m.x_axis.length() + m.y_axis.length() + m.z_axis.length()) / 3.0;
        (Transform::new(seen.translation, Rotation::from_mat3_lossy(m).normalize()), metre)
    }

    fn body(&mut self, index: usize) -> Result<()> {
        let body = &self.def.bodies[index];
        let (frame, metre) = self.seen_from_bone(index, Transform::IDENTITY);
        let (shape, moved) = self.shape(index, metre);
        self.shapes.push(shape);
        let (at, _) = self.seen_from_bone(index, Transform::from_translation(moved));
        let (moments, axes) = body.mass.inertia.eigen();
        let unit = self.def.unit_scale;
        let turned = (frame.rotation * axes).normalize();
        let motion = json!({
            "mass": number(body.mass.mass),
            "centerOfMass": numbers(&(frame.point(body.mass.center * metre)).to_array()),
            "inertiaDiagonal": numbers(&(moments / (unit * unit)).to_array()),
            "inertiaOrientation": quaternion(turned),
        });
        let collider = json!({
            "geometry": {"shape": self.shapes.len() - 1},
            "physicsMaterial": 0,
            "collisionFilter": index,
        });
        let name = format!("{} collider", body.bone);
        self.child(index, &name, at, &json!({ "collider": collider }))?;
        self.extend(self.nodes[index], "motion", motion)
    }

    /// Returns the shape in the bone's unit, and the position of its centre in the body, metres.
    fn shape(&mut self, index: usize, metre: f32) -> (Value, Vec3) {
        let body = &self.def.bodies[index];
        let size = |length: f32| number(length * metre);
        let round = |kind: &str, height: f32, bottom: f32, top: f32| {
            let sizes = json!({"height": size(height), "radiusBottom": size(bottom), "radiusTop": size(top)});
            Value::Object(Map::from_iter([("type".into(), kind.into()), (kind.into(), sizes)]))
        };
        let cuboid =
            |full: Vec3| json!({"type": "box", "box": {"size": numbers(&(full * metre).to_array())}});
        let shape = match body.shape {
            Shape::Sphere { radius } | Shape::Capsule { half_height: 0.0, radius } => {
                json!({"type": "sphere", "sphere": {"radius": size(radius)}})
            }
            Shape::Box { half_extents } => cuboid(half_extents * 2.0),
            Shape::Capsule { half_height, radius } => round("capsule", 2.0 * half_height, radius, radius),
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                round("capsule", 2.0 * half_height, radius_bottom, radius_top)
            }
            Shape::Cylinder { half_height, radius } => round("cylinder", 2.0 * half_height, radius, radius),
            Shape::Cone { half_height, radius } => round("cylinder", 2.0 * half_height, radius, 0.0),
            ref other => {
                let bounds = other.aabb(&Transform::IDENTITY);
                self.notes.push(format!("the hull of {} became the box around it", quoted(&body.bone)));
                return (cuboid(bounds.max - bounds.min), (bounds.min + bounds.max) * 0.5);
            }
        };
        (shape, Vec3::ZERO)
    }

    /// Writes one joint with limits: a node on the parent's bone, constrained relative to a node on the child's.
    fn joint(&mut self, index: usize) -> Result<Value> {
        let joint = self.def.joints[index];
        let [parent, child] = [joint.parent, joint.child].map(|body| self.def.bodies[body].bone.as_str());
        let names = [format!("{child} pivot"), format!("{parent} to {child}")];
        let (on_child, _) = self.seen_from_bone(joint.child, joint.frame_child);
        let (on_parent, _) = self.seen_from_bone(joint.parent, joint.frame_parent);
        let pivot = self.child(joint.child, &names[0], on_child, &json!({}))?;
        let link = json!({"joint": {"connectedNode": pivot, "joint": index, "enableCollision": false}});
        self.child(joint.parent, &names[1], on_parent, &link)?;
        let mut exact = Map::new();
        exact.insert("type".into(), kind_name(&joint.kind).into());
        if let Some(limits) = crate::ragdoll::write_limits(&joint.kind) {
            exact.insert("limits_deg".into(), limits);
        }
        exact.insert("friction_torque".into(), number(joint.friction_torque));
        Ok(json!({"name": names[1], "limits": limits(&joint.kind), "extras": {"sinew": exact}}))
    }

    /// Adds a node under a body's bone; returns its index.
    fn child(&mut self, body: usize, name: &str, at: Transform, extension: &Value) -> Result<usize> {
        let mut node = json!({
            "name": name,
            "translation": numbers(&at.translation.to_array()),
            "rotation": quaternion(at.rotation),
        });
        if extension.as_object().is_some_and(|object| !object.is_empty()) {
            node["extensions"] = json!({ BODIES: extension });
        }
        let index = self.editor.push("nodes", node)?;
        let bone = self.editor.entry("nodes", self.nodes[body])?;
        let children = bone.entry("children").or_insert_with(|| json!([]));
        let children =
            children.as_array_mut().ok_or_else(|| Error::malformed("must be an array", "children"))?;
        children.push(index.into());
        Ok(index)
    }

    /// Adds a property of the extension to a node.
    fn extend(&mut self, node: usize, key: &str, value: Value) -> Result<()> {
        let node = self.editor.entry("nodes", node)?;
        let extensions = node.entry("extensions").or_insert_with(|| json!({}));
        extensions[BODIES][key] = value;
        Ok(())
    }

    fn finish(mut self, joints: Vec<Value>, other_chunks: &[u8]) -> Result<KhrFile> {
        let ellipses = self.def.joints.iter().filter(|joint| is_elliptic(&joint.kind)).count();
        if ellipses > 0 {
            self.notes.push(format!(
                "{ellipses} elliptic cones are limited by a circle and by each axis here; exactly in `extras.sinew`"
            ));
        }
        if (self.def.unit_scale - 1.0).abs() > 0.05 {
            let unit = self.def.unit_scale;
            self.notes.push(format!(
                "a unit of the file is {unit} m: a reader that assumes metres gets another size"
            ));
        }
        let body = BodySettings::default().material;
        let system = |body: usize| format!("{} {body}", self.def.bodies[body].bone);
        let filters: Vec<Value> = (0..self.def.bodies.len())
            .map(|body| {
                let others = self.def.disabled_pairs.iter().filter_map(|&(a, b)| match body {
                    _ if a == body => Some(system(b)),
                    _ if b == body => Some(system(a)),
                    _ => None,
                });
                let others: Vec<String> = others.collect();
                json!({"collisionSystems": [system(body)], "notCollideWithSystems": others})
            })
            .collect();
        let material = json!({
            "staticFriction": number(body.friction),
            "dynamicFriction": number(body.friction),
            "restitution": number(body.restitution),
        });
        let mut physics = json!({"physicsMaterials": [material], "collisionFilters": filters});
        if !joints.is_empty() {
            physics["physicsJoints"] = joints.into();
        }
        self.editor.extension(BODIES, physics)?;
        self.editor.extension(SHAPES, json!({"shapes": self.shapes}))?;
        Ok(KhrFile { bytes: self.editor.finish(other_chunks)?, notes: self.notes })
    }
}

fn quaternion(r: Rotation) -> Value {
    numbers(&[r.x, r.y, r.z, r.w])
}

fn kind_name(kind: &JointKind) -> &'static str {
    match kind {
        JointKind::Ball { .. } => "ball",
        JointKind::Hinge { .. } => "hinge",
        JointKind::Universal { .. } => "universal",
        _ => "fixed",
    }
}

fn is_elliptic(kind: &JointKind) -> bool {
    match kind {
        JointKind::Ball { limit: Some(limit) } | JointKind::Universal { limit: Some(limit) } => {
            let widest = widest(limit);
            [limit.swing_y, limit.swing_z].iter().any(|range| -range.lo < widest || range.hi < widest)
        }
        _ => false,
    }
}

/// The largest half-angle of a cone, radians.
fn widest(limit: &SwingTwistLimit) -> f32 {
    let [y, z] = [limit.swing_y, limit.swing_z].map(|range| max(-range.lo, range.hi));
    max(y, z)
}

/// Returns the limits of a joint in the draft's form: no translation, and the limits of the rotations that are not
/// free.
fn limits(kind: &JointKind) -> Vec<Value> {
    let about = |axis: usize, range: Range| json!({"angularAxes": [axis], "min": number(range.lo), "max": number(range.hi)});
    let shut = |axes: Value| json!({"angularAxes": axes, "min": 0.0, "max": 0.0});
    let mut limits = vec![json!({"linearAxes": [0, 1, 2], "min": 0.0, "max": 0.0})];
    let swing = |limit: &SwingTwistLimit| {
        let cone = json!({"angularAxes": [1, 2], "min": 0.0, "max": number(widest(limit))});
        [cone, about(1, limit.swing_y), about(2, limit.swing_z)]
    };
    match kind {
        JointKind::Ball { limit } => {
            if let Some(limit) = limit {
                limits.extend(swing(limit));
                limits.push(about(0, limit.twist));
            }
        }
        JointKind::Universal { limit } => {
            limits.push(shut(json!([0])));
            limits.extend(limit.iter().flat_map(swing));
        }
        JointKind::Hinge { limit } => {
            limits.push(shut(json!([1, 2])));
            limits.extend(limit.map(|range| about(0, range)));
        }
        _ => limits.push(shut(json!([0, 1, 2]))),
    }
    limits
}
