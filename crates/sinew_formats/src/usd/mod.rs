//! Writes a character, its motion and its ragdoll as a USD text file (`.usda`): UsdSkel for skeleton, skin and
//! animation, UsdPhysics for bodies, joints and limits.
//!
//! Lengths of the stage are in metres, +Y is up, and time codes are frames. `/Character` holds the rig in its file's unit, under a
//! transform that converts to metres. `/Physics` holds the bodies in the pose of the definition.
//!
//! Lost content is listed in [`UsdText::notes`]: textures and colours of the skin; hulls, which become bounding boxes; elliptic cone limits
//! (UsdPhysics limits each axis by itself); joint friction; rigid meshes attached to joints.
//!
//! ```
//! use sinew_formats::{UsdInput, write_usda};
//!
//! let def = sinew::mannequin::character();
//! let world_from_model = def.mapping().character_from_model();
//! let (rig, clip) = (&def.rig, &def.motions().clips[0]);
//! let written = write_usda(&UsdInput { rig, clip, fps: 30.0, world_from_model, ragdoll: Some(&def.ragdoll) });
//! assert!(written.text.starts_with("#usda 1.0") && written.text.contains("PhysicsRigidBodyAPI"));
//! ```

use crate::error::quoted;
use core::fmt::Write;
use sinew_anim::{Clip, LocalTransform, Rig, Wrap, local_to_model, rest_pose, sample::sample};
use sinew_math::{Affine, Range, Rotation, SwingTwistLimit, Transform, Vec3};
use sinew_physics::{JointKind, Shape};
use sinew_ragdoll::RagdollDef;
use std::collections::BTreeSet;

/// Text of a USD file, with notes on lost content.
#[derive(Clone, Debug, PartialEq)]
pub struct UsdText {
    /// The file.
    pub text: String,
    /// Notes on lost content, one sentence each.
    pub notes: Vec<String>,
}

/// Input of [`write_usda`].
#[derive(Clone, Copy, Debug)]
pub struct UsdInput<'a> {
    /// The rig.
    pub rig: &'a Rig,
    /// Motion of the rig.
    pub clip: &'a Clip,
    /// Frames per second, at least 1.
    pub fps: f32,
    /// Transform from the rig's model space to the world, metres.
    pub world_from_model: Affine,
    /// The ragdoll; `None` writes no physics.
    pub ragdoll: Option<&'a RagdollDef>,
}

/// Writes a character with its motion and its ragdoll.
///
/// # Panics
/// If the clip or the ragdoll does not belong to the rig, or `fps` is below 1.
pub fn write_usda(input: &UsdInput<'_>) -> UsdText {
    assert!(input.fps >= 1.0, "fps must be at least 1");
    let mut writer = Writer { out: String::new(), notes: Vec::new() };
    let last = (input.clip.duration * input.fps).round();
    writer.line(0, "#usda 1.0");
    writer.line(0, "(");
    for field in [
        "defaultPrim = \"Character\"".to_owned(),
        "doc = \"written by Sinew\"".to_owned(),
        format!("endTimeCode = {last}"),
        "kilogramsPerUnit = 1".to_owned(),
        "metersPerUnit = 1".to_owned(),
        "startTimeCode = 0".to_owned(),
        format!("timeCodesPerSecond = {}", input.fps),
        "upAxis = \"Y\"".to_owned(),
    ] {
        writer.line(1, &field);
    }
    writer.line(0, ")");
    writer.character(input, last as usize);
    if let Some(def) = input.ragdoll {
        writer.physics(def);
    }
    UsdText { text: writer.out, notes: writer.notes }
}

struct Writer {
    out: String,
    notes: Vec<String>,
}

/// Converts names to unique USD identifiers.
fn identifiers<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken = BTreeSet::new();
    names
        .map(|name| {
            let mut plain: String =
                name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
            if plain.is_empty() || plain.starts_with(|c: char| c.is_ascii_digit()) {
                plain.insert(0, '_');
            }
            let mut own = plain.clone();
            let mut number = 1;
            while !taken.insert(own.clone()) {
                number += 1;
                own = format!("{plain}_{number}");
            }
            own
        })
        .collect()
}

fn text(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    format!("\"{}\"", plain.replace('\\', "\\\\").replace('"', "\\\""))
}

fn list<T>(items: impl IntoIterator<Item = T>, show: impl Fn(T) -> String) -> String {
    let items: Vec<String> = items.into_iter().map(show).collect();
    format!("[{}]", items.join(", "))
}

fn vec3(v: Vec3) -> String {
    format!("({}, {}, {})", v.x, v.y, v.z)
}

fn quaternion(q: Rotation) -> String {
    format!("({}, {}, {}, {})", q.w, q.x, q.y, q.z)
}

/// Writes a matrix by rows in USD's convention, in which a row vector is multiplied from the left.
fn matrix(m: &Affine) -> String {
    let row = |v: Vec3, w: u8| format!("({}, {}, {}, {w})", v.x, v.y, v.z);
    let (l, t) = (&m.linear, m.translation);
    format!("({}, {}, {}, {})", row(l.x_axis, 0), row(l.y_axis, 0), row(l.z_axis, 0), row(t, 1))
}

impl Writer {
    fn line(&mut self, depth: usize, text: &str) {
        let _ = writeln!(self.out, "{:width$}{text}", "", width = 4 * depth);
    }

    fn open(&mut self, depth: usize, kind: &str, name: &str, schemas: &[&str]) {
        let head = format!("def {kind} \"{name}\"");
        if schemas.is_empty() {
            self.line(depth, &head);
        } else {
            self.line(depth, &format!("{head} ("));
            let schemas = list(schemas, |schema| format!("\"{schema}\""));
            self.line(depth + 1, &format!("prepend apiSchemas = {schemas}"));
            self.line(depth, ")");
        }
        self.line(depth, "{");
    }

    fn close(&mut self, depth: usize) {
        self.line(depth, "}");
    }

    fn character(&mut self, input: &UsdInput<'_>, last: usize) {
        let rig = input.rig;
        let own = identifiers(rig.joints.iter().map(|joint| joint.name.as_str()));
        let mut paths: Vec<String> = Vec::new();
        for (joint, name) in rig.joints.iter().zip(&own) {
            paths.push(joint.parent.map_or(name.clone(), |parent| format!("{}/{name}", paths[parent])));
        }
        let joints = format!("uniform token[] joints = {}", list(&paths, |path| format!("\"{path}\"")));
        self.open(0, "SkelRoot", "Character", &["SkelBindingAPI"]);
        self.line(1, &format!("matrix4d xformOp:transform = {}", matrix(&input.world_from_model)));
        self.line(1, "uniform token[] xformOpOrder = [\"xformOp:transform\"]");
        self.open(1, "Skeleton", "Skeleton", &["SkelBindingAPI"]);
        self.line(2, &joints);
        let names = list(&rig.joints, |joint| text(&joint.name));
        self.line(2, &format!("uniform token[] jointNames = {names}"));
        let bind = list(&bind_of(rig), matrix);
        self.line(2, &format!("uniform matrix4d[] bindTransforms = {bind}"));
        let rest = list(&rig.joints, |joint| matrix(&joint.rest.to_affine()));
        self.line(2, &format!("uniform matrix4d[] restTransforms = {rest}"));
        self.line(2, "rel skel:animationSource = </Character/Skeleton/Motion>");
        self.open(2, "SkelAnimation", "Motion", &[]);
        self.line(3, &joints);
        self.motion(input, last);
        self.close(2);
        self.close(1);
        self.meshes(rig);
        self.close(0);
    }

    fn motion(&mut self, input: &UsdInput<'_>, last: usize) {
        let mut pose = rest_pose(input.rig);
        let mut frames: Vec<Vec<LocalTransform>> = Vec::new();
        for frame in 0..=last {
            sample(input.clip, input.rig, frame as f32 / input.fps, Wrap::Clamp, &mut pose);
            frames.push(pose.clone());
        }
        let samples = |writer: &mut Self, head: &str, show: &dyn Fn(&LocalTransform) -> String| {
            writer.line(3, &format!("{head}.timeSamples = {{"));
            for (frame, pose) in frames.iter().enumerate() {
                writer.line(4, &format!("{frame}: {},", list(pose, show)));
            }
            writer.line(3, "}");
        };
        samples(self, "float3[] translations", &|joint| vec3(joint.translation));
        samples(self, "quatf[] rotations", &|joint| quaternion(joint.rotation));
        samples(self, "half3[] scales", &|joint| vec3(joint.scale));
    }

    fn meshes(&mut self, rig: &Rig) {
        let rigid = rig.meshes.iter().filter(|mesh| mesh.skin.is_none()).count();
        if rigid > 0 {
            self.notes.push(format!("{rigid} rigid meshes are left out"));
        }
        if !rig.meshes.is_empty() {
            self.notes.push("pictures and colours of the skin are left out".to_owned());
        }
        let names = identifiers(rig.meshes.iter().map(|mesh| mesh.name.as_str()));
        for (mesh, name) in rig.meshes.iter().zip(names) {
            let Some(skin) = mesh.skin.map(|skin| &rig.skins[skin]) else { continue };
            for (part, primitive) in mesh.primitives.iter().enumerate() {
                self.open(1, "Mesh", &format!("{name}_{part}"), &["SkelBindingAPI"]);
                let triangles = primitive.indices.len() / 3;
                self.line(2, &format!("int[] faceVertexCounts = {}", list(0..triangles, |_| "3".to_owned())));
                let corners = list(&primitive.indices, u32::to_string);
                self.line(2, &format!("int[] faceVertexIndices = {corners}"));
                self.line(2, &format!("point3f[] points = {}", list(&primitive.positions, |&at| vec3(at))));
                let slots = primitive.joints.iter().flatten();
                let joints = list(slots, |&slot| skin.joints[usize::from(slot)].to_string());
                let of_vertex =
                    "(\n            elementSize = 4\n            interpolation = \"vertex\"\n        )";
                self.line(2, &format!("int[] primvars:skel:jointIndices = {joints} {of_vertex}"));
                let weights = list(primitive.weights.iter().flatten(), f32::to_string);
                self.line(2, &format!("float[] primvars:skel:jointWeights = {weights} {of_vertex}"));
                self.line(2, "rel skel:skeleton = </Character/Skeleton>");
                self.line(2, "uniform token subdivisionScheme = \"none\"");
                self.close(1);
            }
        }
    }

    fn physics(&mut self, def: &RagdollDef) {
        let names = identifiers(def.bodies.iter().map(|body| body.bone.as_str()));
        self.open(0, "Scope", "Physics", &[]);
        self.open(1, "PhysicsScene", "Scene", &[]);
        self.line(2, "vector3f physics:gravityDirection = (0, -1, 0)");
        self.line(2, "float physics:gravityMagnitude = 9.81");
        self.close(1);
        for (index, name) in names.iter().enumerate() {
            self.body(def, index, name, &names);
        }
        for (joint, name) in (0..def.joints.len()).zip(&names[1..]) {
            self.joint(def, joint, name, &names);
        }
        self.close(0);
        if def.joints.iter().any(|joint| joint.friction_torque > 0.0) {
            self.notes.push("friction of joints is left out".to_owned());
        }
    }

    fn place(&mut self, depth: usize, at: &Transform) {
        self.line(depth, &format!("quatf xformOp:orient = {}", quaternion(at.rotation)));
        self.line(depth, &format!("double3 xformOp:translate = {}", vec3(at.translation)));
        self.line(depth, "uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:orient\"]");
    }

    fn body(&mut self, def: &RagdollDef, index: usize, name: &str, names: &[String]) {
        let body = &def.bodies[index];
        let mut schemas = vec!["PhysicsRigidBodyAPI", "PhysicsMassAPI"];
        let pairs = def.disabled_pairs.iter().filter(|pair| pair.0 == index);
        let others: Vec<String> = pairs.map(|pair| format!("</Physics/{}>", names[pair.1])).collect();
        if !others.is_empty() {
            schemas.push("PhysicsFilteredPairsAPI");
        }
        self.open(1, "Xform", name, &schemas);
        let (moments, axes) = body.mass.inertia.eigen();
        self.line(2, &format!("point3f physics:centerOfMass = {}", vec3(body.mass.center)));
        self.line(2, &format!("float3 physics:diagonalInertia = {}", vec3(moments)));
        self.line(2, &format!("float physics:mass = {}", body.mass.mass));
        self.line(2, &format!("quatf physics:principalAxes = {}", quaternion(axes)));
        if !others.is_empty() {
            self.line(2, &format!("rel physics:filteredPairs = [{}]", others.join(", ")));
        }
        self.place(2, &body.character_from_body);
        self.shape(&body.shape, &body.bone);
        self.close(1);
    }

    fn shape(&mut self, shape: &Shape, bone: &str) {
        let round = |writer: &mut Self, kind: &str, sizes: &[(&str, f32)]| {
            writer.open(2, kind, "Collider", &["PhysicsCollisionAPI"]);
            if kind != "Sphere" {
                writer.line(3, "uniform token axis = \"Y\"");
            }
            for (key, size) in sizes {
                writer.line(3, &format!("double {key} = {size}"));
            }
            writer.close(2);
        };
        match *shape {
            Shape::Sphere { radius } => round(self, "Sphere", &[("radius", radius)]),
            Shape::Capsule { half_height, radius } => {
                round(self, "Capsule", &[("height", 2.0 * half_height), ("radius", radius)]);
            }
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                let sizes = [
                    ("height", 2.0 * half_height),
                    ("radiusBottom", radius_bottom),
                    ("radiusTop", radius_top),
                ];
                round(self, "Capsule_1", &sizes);
            }
            Shape::Cylinder { half_height, radius } => {
                round(self, "Cylinder", &[("height", 2.0 * half_height), ("radius", radius)]);
            }
            Shape::Cone { half_height, radius } => {
                round(self, "Cone", &[("height", 2.0 * half_height), ("radius", radius)]);
            }
            ref other => {
                let bounds = other.aabb(&Transform::IDENTITY);
                if !matches!(other, Shape::Box { .. }) {
                    self.notes.push(format!("the shape of {} became the box around it", quoted(bone)));
                }
                self.open(2, "Cube", "Collider", &["PhysicsCollisionAPI"]);
                self.line(3, "double size = 1");
                self.line(3, &format!("double3 xformOp:translate = {}", vec3(bounds.center())));
                self.line(3, &format!("float3 xformOp:scale = {}", vec3(bounds.max - bounds.min)));
                self.line(3, "uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:scale\"]");
                self.close(2);
            }
        }
    }

    fn joint(&mut self, def: &RagdollDef, index: usize, name: &str, names: &[String]) {
        let joint = &def.joints[index];
        let shut = Range { lo: 1.0, hi: -1.0 };
        let mut limits: Vec<(&str, Range)> = ["transX", "transY", "transZ"].map(|axis| (axis, shut)).to_vec();
        let swing = |limit: &SwingTwistLimit| [("rotY", limit.swing_y), ("rotZ", limit.swing_z)];
        match &joint.kind {
            JointKind::Ball { limit } => limits.extend(
                limit.iter().flat_map(|limit| [("rotX", limit.twist)].into_iter().chain(swing(limit))),
            ),
            JointKind::Universal { limit } => {
                limits.push(("rotX", shut));
                limits.extend(limit.iter().flat_map(swing));
            }
            JointKind::Hinge { limit } => {
                limits.extend([("rotY", shut), ("rotZ", shut)]);
                limits.extend(limit.map(|range| ("rotX", range)));
            }
            _ => limits.extend([("rotX", shut), ("rotY", shut), ("rotZ", shut)]),
        }
        let schemas: Vec<String> = limits.iter().map(|(axis, _)| format!("PhysicsLimitAPI:{axis}")).collect();
        let schemas: Vec<&str> = schemas.iter().map(String::as_str).collect();
        self.open(1, "PhysicsJoint", &format!("{name}_joint"), &schemas);
        self.line(2, &format!("rel physics:body0 = </Physics/{}>", names[joint.parent]));
        self.line(2, &format!("rel physics:body1 = </Physics/{}>", names[joint.child]));
        for (side, frame) in [(0, &joint.frame_parent), (1, &joint.frame_child)] {
            self.line(2, &format!("point3f physics:localPos{side} = {}", vec3(frame.translation)));
            self.line(2, &format!("quatf physics:localRot{side} = {}", quaternion(frame.rotation)));
        }
        for (axis, Range { lo, hi }) in limits {
            let turns = axis.starts_with("rot") && lo <= hi;
            let shown = |angle: f32| if turns { angle.to_degrees() } else { angle };
            self.line(2, &format!("float limit:{axis}:physics:high = {}", shown(hi)));
            self.line(2, &format!("float limit:{axis}:physics:low = {}", shown(lo)));
        }
        self.close(1);
    }
}

/// Returns the bind pose of each joint in model space: that of its skin, or else the rest pose.
fn bind_of(rig: &Rig) -> Vec<Affine> {
    let mut bind = Vec::new();
    local_to_model(rig, &rest_pose(rig), &Affine::IDENTITY, &mut bind);
    for skin in &rig.skins {
        for (&joint, inverse) in skin.joints.iter().zip(&skin.inverse_bind) {
            let own = inverse.inverse();
            if own.is_finite() {
                bind[joint] = own;
            }
        }
    }
    bind
}
