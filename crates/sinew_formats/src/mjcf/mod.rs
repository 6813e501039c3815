//! Reads robot and body models in MuJoCo's format MJCF: the subset for rigid bodies and joints.
//!
//! The reader supports bodies with their poses (`pos`, and `quat`, `axisangle`, `euler`, `xyaxes` or `zaxis`), geoms of
//! type plane, sphere, capsule and box (`size`, `fromto`, `density`, `mass`, `friction` of sliding and, with `condim`
//! 6, of rolling, restitution by the damping ratio of `solref`, `contype`, `conaffinity`), `<inertial>`, hinges, slides
//! and ball joints (`range`, `ref`, `stiffness`, `springref`, `damping`, `frictionloss`),
//! free joints, `childclass` and default classes, `<exclude>`, keyframes, and of `<compiler>`: `angle`, `eulerseq`,
//! `autolimits`, `inertiafromgeom`. Metres, kilograms; the file's z up becomes our y up, its x stays x.
//!
//! Features without a counterpart are omitted with a note in [`MjcfModel::notes`]: rotor inertia of joints, actuators,
//! sensors, tendons, equalities, softness of contacts and limits. Features that would change the bodies are errors:
//! included files, colliding meshes, slides together with hinges, `<frame>`, `<replicate>`.
//!
//! - **Bodies without joints** are fixed to their parent. They remain separate bodies with their own name and mass, on
//!   a fixed joint. As in MuJoCo, parts fixed to each other do not collide, nor does such a group with one jointed to
//!   it, unless that is the world.
//! - **Hinges of one body** become one joint, whose zero is the file's pose. They must be perpendicular. One is a
//!   hinge. Two are a joint that swings about the first and twists about the last, exactly. Three are a ball joint
//!   whose twist is exactly the last hinge and whose swings lie within an ellipse per quadrant where MuJoCo has a
//!   rectangle. If their anchors differ, the joint uses the mean; if their springs differ, it uses the softest.
//! - **Friction** of a pair is the geometric mean here, and the larger in MuJoCo.
//!
//! ```
//! use sinew_formats::read_mjcf;
//! use sinew_physics::{World, WorldDef};
//!
//! let text = r#"<mujoco model="pendulum"><worldbody><body name="bob" pos="0 0 2">
//!     <joint type="hinge" axis="0 1 0" pos="0 0 0.5"/><geom type="sphere" size="0.1" mass="1"/>
//! </body></worldbody></mujoco>"#;
//! let model = read_mjcf(text.as_bytes())?;
//! let mut world = World::new(WorldDef::default());
//! let bodies = model.spawn(&mut world).bodies;
//! let bob = bodies[model.body("bob").expect("the model has this body")];
//! assert_eq!(world.mass(bob).mass, 1.0);
//! assert!((world.transform(bob).translation.y - 2.0).abs() < 1e-6); // z up became y up
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub(crate) mod bodies;
mod compiler;
mod defaults;
mod geom;
mod joint;
mod keyframe;
pub(crate) mod notes;
mod ragdoll;
mod write;
pub(crate) mod xml;

pub use ragdoll::MjcfRagdoll;
pub use write::{MjcfText, write_mjcf};

use crate::error::{Result, quoted};
use bodies::{Reading, Tree};
use compiler::{Compiler, y_up};
use defaults::Classes;
use joint::{BodyJoint, Freedom};
use notes::Notes;
use sinew_math::{Transform, Vec3};
use sinew_physics::{BodyDef, BodyId, BodyKind, JointCollision, JointDef, JointId, JointKind, Spring, World};
use xml::{Element, Value, children, malformed, unsupported};

/// A model of bodies and joints, as plain data.
#[derive(Clone, Debug, PartialEq)]
pub struct MjcfModel {
    /// Name of the model, or `""`.
    pub name: String,
    /// Gravity, m/s², world axes. `spawn` does not set it.
    pub gravity: Vec3,
    /// Bodies, parents before children; the first, named `world`, is static and has the shapes that never move.
    pub bodies: Vec<MjcfBody>,
    /// Joints in the order of their children.
    pub joints: Vec<MjcfJoint>,
    /// Pairs of bodies without a joint, by index, that do not collide.
    pub excluded_pairs: Vec<(usize, usize)>,
    /// Named poses.
    pub keyframes: Vec<MjcfKeyframe>,
    /// Notes on omissions and changes, one sentence each.
    pub notes: Vec<String>,
}

/// A body of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct MjcfBody {
    /// Name in the file, or `""`.
    pub name: String,
    /// Definition of the body in the pose of the file. A dynamic body's mass is given; `user_data` is its index.
    pub def: BodyDef,
}

/// A joint of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct MjcfJoint {
    /// Names of the file's joints that were combined, joined by `+`; for a weld, the body's name.
    pub name: String,
    /// Index of the body that is nearer to the world.
    pub parent: usize,
    /// Index of the other body.
    pub child: usize,
    /// Joint frame in the parent's frame. Both frames coincide in the file's pose.
    pub frame_a: Transform,
    /// Joint frame in the child's frame.
    pub frame_b: Transform,
    /// Kind of the joint, which states the free motions.
    pub kind: JointKind,
    /// Spring with the smallest stiffness and the smallest damping of its hinges; `None` if both are 0.
    pub spring: Option<Spring>,
    /// Friction torque or force, N·m or N: the largest `frictionloss` of its hinges.
    pub friction_torque: f32,
    /// Collision of parent and child; they collide only if the parent never moves.
    pub collision: JointCollision,
}

/// A named pose, as differences from the file's pose.
#[derive(Clone, Debug, PartialEq)]
pub struct MjcfKeyframe {
    /// Name in the file, or `""`.
    pub name: String,
    /// Free bodies, by index, and their world poses.
    pub placed: Vec<(usize, Transform)>,
    /// Joints, by index, and the pose of `frame_b` relative to `frame_a`.
    pub moved: Vec<(usize, Transform)>,
}

/// Ids of a model that was added to a world.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MjcfInstance {
    /// Bodies in the order of the model.
    pub bodies: Vec<BodyId>,
    /// Joints in the order of the model.
    pub joints: Vec<JointId>,
}

/// Reads an MJCF file.
///
/// # Errors
/// Returns an error that names line and column: text that is not XML; elements, attributes and values that the format
/// does not allow there; unsupported features that would change the model; moving bodies without mass; more than 4 MiB,
/// 1,024 bodies or 32 nested default classes.
pub fn read_mjcf(bytes: &[u8]) -> Result<MjcfModel> {
    let document = xml::parse(bytes)?;
    let root = document.root_element();
    if root.tag_name().name() != "mujoco" {
        let what = format!("not an MJCF file: begins with {}", quoted(root.tag_name().name()));
        return Err(malformed(root, what));
    }
    let mut notes = Notes::default();
    check_sections(root, &mut notes)?;
    let compiler = Compiler::read(root, &mut notes)?;
    let mut reading = Reading { compiler, classes: Classes::read(root)?, notes: &mut notes };
    let tree = Tree::read(root, &mut reading)?;
    let joints = read_joints(&tree, &mut notes)?;
    let keyframes = keyframe::read(root, &tree, &joints)?;
    let excluded_pairs = excluded_pairs(root, &tree, &mut notes)?;
    let bodies = tree.links.into_iter().map(|link| MjcfBody { name: link.name, def: link.def }).collect();
    let name = root.attribute("model").unwrap_or_default().to_owned();
    let gravity = read_gravity(root)?;
    Ok(MjcfModel { name, gravity, bodies, joints, excluded_pairs, keyframes, notes: notes.into_sentences() })
}

/// Reads a model of bodies and joints as MJCF, URDF, or the physics of a glTF; the content of the file determines the
/// format.
///
/// # Errors
/// As [`read_mjcf`], [`read_urdf`](crate::read_urdf) and [`read_physics_gltf`](crate::read_physics_gltf).
pub fn read_model(bytes: &[u8]) -> Result<MjcfModel> {
    let first = bytes.iter().find(|byte| !byte.is_ascii_whitespace());
    if crate::container::glb::is_glb(bytes) || first == Some(&b'{') {
        return crate::read_physics_gltf(bytes);
    }
    let place = |tag: &[u8]| bytes.windows(tag.len()).position(|window| window == tag).unwrap_or(usize::MAX);
    if place(b"<robot") < place(b"<mujoco") { crate::read_urdf(bytes) } else { read_mjcf(bytes) }
}

/// Rejects sections that are not part of the format, and notes sections that are not read.
fn check_sections(root: Element<'_>, notes: &mut Notes) -> Result<()> {
    for (tag, section) in children(root) {
        let what = match tag {
            "actuator" => "actuators",
            "tendon" => "tendons",
            "equality" => "equalities",
            "sensor" => "sensors",
            "compiler" | "option" | "size" | "visual" | "statistic" | "asset" | "default" | "worldbody"
            | "contact" | "keyframe" | "custom" => continue,
            "include" => return Err(unsupported(section, "files that include others are not read")),
            "extension" | "deformable" => {
                return Err(unsupported(section, format!("{} is not read", quoted(tag))));
            }
            _ => return Err(malformed(section, format!("no section {}", quoted(tag)))),
        };
        children(section).for_each(|_| notes.left_out(what));
    }
    Ok(())
}

fn read_gravity(root: Element<'_>) -> Result<Vec3> {
    let options = children(root).filter(|(tag, _)| *tag == "option");
    let said = options.filter_map(|(_, option)| Value::of(option, "gravity")).next_back();
    Ok(y_up(Vec3::from_array(said.map_or(Ok([0.0, 0.0, -9.81]), Value::numbers)?)))
}

/// Returns the joints between moving bodies and their parents.
fn read_joints(tree: &Tree<'_>, notes: &mut Notes) -> Result<Vec<MjcfJoint>> {
    let mut joints = Vec::new();
    for (child, link) in tree.links.iter().enumerate() {
        let joint = match &link.freedom {
            _ if link.def.kind != BodyKind::Dynamic => continue,
            Freedom::Free => continue,
            Freedom::Welded => BodyJoint::WELD,
            Freedom::Ball(ball) => BodyJoint::of_ball(ball),
            Freedom::Slide(slide) => BodyJoint::of_slide(slide),
            Freedom::Hinges(hinges) => BodyJoint::of_hinges(hinges, link.element, notes)?,
        };
        let pose = |body: usize| {
            let def = &tree.links[body].def;
            Transform::new(def.position, def.rotation)
        };
        let parent_from_child = pose(link.parent).inverse() * pose(child);
        let of_world = tree.links[link.parent].weld == 0;
        joints.push(MjcfJoint {
            name: link.freedom.name().unwrap_or_else(|| link.name.clone()),
            parent: link.parent,
            child,
            frame_a: parent_from_child * joint.frame,
            frame_b: joint.frame,
            kind: joint.kind,
            spring: joint.spring,
            friction_torque: joint.friction,
            collision: if of_world { JointCollision::Enabled } else { JointCollision::Disabled },
        });
    }
    Ok(joints)
}

/// Returns the pairs that do not collide: those listed in `<exclude>`, and those that MuJoCo excludes itself, which are
/// parts fixed to each other and groups jointed to each other. A joint excludes its own pair.
fn excluded_pairs(root: Element<'_>, tree: &Tree<'_>, notes: &mut Notes) -> Result<Vec<(usize, usize)>> {
    let mut pairs = Vec::new();
    let contacts = children(root).filter(|(tag, _)| *tag == "contact");
    for (tag, element) in contacts.flat_map(|(_, section)| children(section)) {
        match tag {
            "exclude" => {
                let (a, b) = (tree.named_by(element, "body1")?, tree.named_by(element, "body2")?);
                if a != b {
                    pairs.push((usize::min(a, b), usize::max(a, b)));
                }
            }
            "pair" => notes.left_out("contact pairs"),
            _ => return Err(malformed(element, format!("unknown element {}", quoted(tag)))),
        }
    }
    let links = &tree.links;
    let above = |weld: usize| links[links[weld].parent].weld;
    for b in (0..links.len()).filter(|&b| links[b].weld != 0) {
        for a in (0..b).filter(|&a| links[a].weld != 0 && a != links[b].parent) {
            let (weld_a, weld_b) = (links[a].weld, links[b].weld);
            if weld_a == weld_b || weld_a == above(weld_b) || weld_b == above(weld_a) {
                pairs.push((a, b));
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    Ok(pairs)
}

impl MjcfModel {
    /// Index of the body of that name.
    pub fn body(&self, name: &str) -> Option<usize> {
        self.bodies.iter().position(|body| body.name == name)
    }

    /// Returns the keyframe of that name.
    pub fn keyframe(&self, name: &str) -> Option<&MjcfKeyframe> {
        self.keyframes.iter().find(|keyframe| keyframe.name == name)
    }

    /// Returns the world poses of all bodies in the pose of the file.
    pub fn rest_pose(&self) -> Vec<Transform> {
        self.bodies.iter().map(|body| Transform::new(body.def.position, body.def.rotation)).collect()
    }

    /// Returns the world poses of all bodies in a keyframe: joints are satisfied, but limits may be exceeded.
    ///
    /// # Panics
    /// If the keyframe belongs to another model.
    pub fn pose(&self, keyframe: &MjcfKeyframe) -> Vec<Transform> {
        let mut pose = self.rest_pose();
        for &(body, place) in &keyframe.placed {
            pose[body] = place;
        }
        let mut moves = vec![Transform::IDENTITY; self.joints.len()];
        for &(joint, moved) in &keyframe.moved {
            moves[joint] = moved;
        }
        // Joints are in the order of their children, and parents precede children.
        for (joint, moved) in self.joints.iter().zip(moves) {
            let placed = pose[joint.parent] * joint.frame_a * moved * joint.frame_b.inverse();
            pose[joint.child] = Transform::new(placed.translation, placed.rotation.normalize());
        }
        pose
    }

    /// Adds the model to a world, in the pose of the file.
    pub fn spawn(&self, world: &mut World) -> MjcfInstance {
        self.spawn_at(world, &self.rest_pose())
    }

    /// Adds the model to a world, each body at its given pose.
    ///
    /// # Panics
    /// If there is not one finite pose per body.
    pub fn spawn_at(&self, world: &mut World, pose: &[Transform]) -> MjcfInstance {
        assert_eq!(pose.len(), self.bodies.len(), "every body has a pose");
        let place = |(body, at): (&MjcfBody, &Transform)| {
            let def = BodyDef { position: at.translation, rotation: at.rotation, ..body.def.clone() };
            world.add_body(&def)
        };
        let bodies: Vec<BodyId> = self.bodies.iter().zip(pose).map(place).collect();
        for &(a, b) in &self.excluded_pairs {
            world.disable_pair(bodies[a], bodies[b]);
        }
        let join = |joint: &MjcfJoint| {
            let (parent, child) = (bodies[joint.parent], bodies[joint.child]);
            world.add_joint(&JointDef {
                spring: joint.spring,
                friction_torque: joint.friction_torque,
                collision: joint.collision,
                ..JointDef::between(parent, child, joint.frame_a, joint.frame_b, joint.kind)
            })
        };
        let joints = self.joints.iter().map(join).collect();
        MjcfInstance { bodies, joints }
    }
}
