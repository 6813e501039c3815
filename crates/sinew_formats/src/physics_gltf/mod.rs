//! Reads physics in glTF files as a model of bodies and joints like those of [MJCF](crate::mjcf):
//! `KHR_physics_rigid_bodies` with `KHR_implicit_shapes` (drafts of October 2025), and `OMI_physics_body`,
//! `OMI_physics_shape` and `OMI_physics_joint`.
//!
//! The reader supports `motion` (mass, centre, inertia, velocities, gravity factor, static and kinematic bodies),
//! sphere, box, capsule and cylinder colliders on a body's node or any node below it, friction and restitution of
//! materials, and joints with limits in their six directions. Colliders without a body above them belong to the world.
//! Cones in files written by [`write_khr`](crate::write_khr) are restored exactly, from `extras.sinew`.
//!
//! Unsupported content is skipped and listed in [`MjcfModel::notes`]: mesh and hull colliders, triggers, filters,
//! motors, soft limits, non-uniform scale. Lengths are in metres.
//!
//! ```
//! use sinew_formats::read_physics_gltf;
//! use sinew_physics::{World, WorldDef};
//!
//! let text = r#"{"asset": {"version": "2.0"}, "nodes": [{"name": "ball", "translation": [0, 3, 0], "extensions":
//! {"OMI_physics_body": {"motion": {"type": "dynamic", "mass": 2}, "collider": {"shape": 0}}}}], "extensions":
//! {"OMI_physics_shape": {"shapes": [{"type": "sphere", "sphere": {"radius": 0.5}}]}}}"#; let model =
//! read_physics_gltf(text.as_bytes())?; let mut world = World::new(WorldDef::default()); let ball = model.spawn(&mut
//! world).bodies[model.body("ball").expect("the model has this body")]; assert_eq!((world.mass(ball).mass,
//! world.transform(ball).translation.y), (2.0, 3.0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::container::glb;
use crate::container::json::{self, At};
use crate::error::{Result, quoted};
use crate::mjcf::bodies::{MOST_BODIES, check_mass};
use crate::mjcf::notes::Notes;
use crate::mjcf::{MjcfBody, MjcfJoint, MjcfModel};
use core::f32::consts::PI;
use sinew_math::{Affine, Mat3, Range, Rotation, SwingTwistLimit, Sym3, Transform, Vec3, max, min};
use sinew_physics::{
    AxisMotion, BodyDef, BodyKind, JointCollision, JointKind, MassProperties, Material, Shape, ShapeDef,
    SixDof,
};

/// Largest number of nodes in a file; each may have a collider.
const MOST_NODES: usize = 100_000;
/// Largest coordinate, metres.
const FARTHEST: f32 = 1e6;
/// Mass, kg, and moments, kg·m², of a dynamic body with neither mass nor shape.
const UNKNOWN: (f32, f32) = (1.0, 0.016);
/// Density of bodies without a mass, kg/m³.
const DENSITY: f32 = 1000.0;

/// A node with its transform.
struct Node<'a> {
    at: At<'a>,
    parent: Option<usize>,
    world: Affine,
    /// Index of the node's body; 0 is the world.
    body: usize,
}

/// Reads the physics of a glTF or GLB file; buffers are not needed.
///
/// Names the location of the error: invalid JSON; numbers, indices and kinds that the formats do not allow; cycles of
/// nodes; a file without physics; more than 100,000 nodes or 1,024 bodies.
pub fn read_physics_gltf(bytes: &[u8]) -> Result<MjcfModel> {
    let json = if glb::is_glb(bytes) { glb::parse(bytes)?.json } else { bytes };
    let value = json::parse(json)?;
    let root = At::root(&value);
    let mut notes = Notes::default();
    let mut nodes = read_nodes(root)?;
    let stands = BodyDef { kind: BodyKind::Static, ..BodyDef::default() };
    let mut bodies = vec![MjcfBody { name: "world".to_owned(), def: stands }];
    for index in 0..nodes.len() {
        read_body(&mut nodes, index, &mut bodies)?;
    }
    let shapes = [extension(root, "KHR_implicit_shapes")?, extension(root, "OMI_physics_shape")?];
    let shapes = shapes.into_iter().flatten().next().map_or(Ok(Vec::new()), |of| of.list("shapes"))?;
    let lists = Lists { shapes, materials: list(root, "KHR_physics_rigid_bodies", "physicsMaterials")? };
    for (index, node) in nodes.iter().enumerate() {
        let body = &mut bodies[body_of(&nodes, index)].def;
        read_collider(node, &lists, body, &mut notes)?;
    }
    weigh(&nodes, &mut bodies)?;
    let joints = read_joints(root, &nodes, &bodies, &mut notes)?;
    if bodies.len() == 1 && bodies[0].def.shapes.is_empty() {
        return Err(
            root.unsupported("no node has physics: neither KHR_physics_rigid_bodies nor OMI_physics_body")
        );
    }
    let name = root.get("asset")?.map_or(String::new(), At::name);
    Ok(MjcfModel {
        name,
        gravity: Vec3::new(0.0, -9.81, 0.0),
        bodies,
        joints,
        excluded_pairs: Vec::new(),
        keyframes: Vec::new(),
        notes: notes.into_sentences(),
    })
}

/// Lists that colliders reference.
struct Lists<'a> {
    shapes: Vec<At<'a>>,
    materials: Vec<At<'a>>,
}

fn extension<'a>(of: At<'a>, name: &str) -> Result<Option<At<'a>>> {
    of.get("extensions")?.map_or(Ok(None), |extensions| extensions.get(name))
}

fn list<'a>(root: At<'a>, name: &str, key: &str) -> Result<Vec<At<'a>>> {
    extension(root, name)?.map_or(Ok(Vec::new()), |of| of.list(key))
}

/// Returns the physics extension of a node, of either family; `None` without one.
fn physics(node: At<'_>) -> Result<Option<At<'_>>> {
    Ok(extension(node, "KHR_physics_rigid_bodies")?.or(extension(node, "OMI_physics_body")?))
}

fn read_nodes(root: At<'_>) -> Result<Vec<Node<'_>>> {
    let list = root.list("nodes")?;
    if list.len() > MOST_NODES {
        return Err(root.unsupported(format!("more than {MOST_NODES} nodes")));
    }
    let mut nodes: Vec<Node<'_>> =
        list.iter().map(|&at| Node { at, parent: None, world: Affine::IDENTITY, body: 0 }).collect();
    let mut below: Vec<Vec<usize>> = Vec::new();
    for (index, at) in list.iter().enumerate() {
        let mut own = Vec::new();
        for child in at.list("children")? {
            let number = child.index(list.len(), "nodes")?;
            if nodes[number].parent.replace(index).is_some() {
                return Err(child.malformed(format!("node {number} has two parents")));
            }
            own.push(number);
        }
        below.push(own);
    }
    // Uses a list of open nodes instead of recursion, so that a deep file cannot overflow the stack.
    let mut open: Vec<usize> = (0..nodes.len()).filter(|&node| nodes[node].parent.is_none()).collect();
    let mut seen = 0;
    while let Some(index) = open.pop() {
        let above = nodes[index].parent.map_or(Affine::IDENTITY, |parent| nodes[parent].world);
        let world = above * local(list[index])?;
        if !world.is_finite() || world.translation.length() > FARTHEST {
            return Err(list[index].malformed(format!("it is not within {FARTHEST} m")));
        }
        nodes[index].world = world;
        seen += 1;
        open.extend(&below[index]);
    }
    if seen < nodes.len() { Err(root.malformed("nodes form a circle")) } else { Ok(nodes) }
}

fn local(node: At<'_>) -> Result<Affine> {
    if let Some(matrix) = node.get("matrix")? {
        let m: [f32; 16] = matrix.numbers()?;
        let column = |k: usize| Vec3::new(m[4 * k], m[4 * k + 1], m[4 * k + 2]);
        return Ok(Affine {
            linear: Mat3::from_cols(column(0), column(1), column(2)),
            translation: column(3),
        });
    }
    let rotation = unit(node, "rotation")?;
    let scale = Vec3::from_array(node.numbers_or("scale", [1.0; 3])?);
    let translation = Vec3::from_array(node.numbers_or("translation", [0.0; 3])?);
    Ok(Affine::from_scale_rotation_translation(scale, rotation, translation))
}

/// Reads an optional quaternion.
fn unit(of: At<'_>, key: &str) -> Result<Rotation> {
    let [x, y, z, w] = of.numbers_or(key, [0.0, 0.0, 0.0, 1.0])?;
    let rotation = Rotation { x, y, z, w };
    let length = rotation.length();
    if length > 1e-6 && length.is_finite() {
        Ok(rotation.normalize())
    } else {
        Err(of.malformed(format!("`{key}` must not be zero")))
    }
}

/// Returns position and rotation of a node, without scale.
fn rigid(world: &Affine) -> Transform {
    let place = world.to_rigid();
    Transform::new(place.translation, place.rotation.normalize())
}

/// Returns the body of a node: its own, or that of the nearest ancestor with one; 0 without one.
fn body_of(nodes: &[Node<'_>], index: usize) -> usize {
    let above = |&at: &usize| nodes[at].parent;
    core::iter::successors(Some(index), above).map(|at| nodes[at].body).find(|&body| body != 0).unwrap_or(0)
}

fn read_body(nodes: &mut [Node<'_>], index: usize, bodies: &mut Vec<MjcfBody>) -> Result<()> {
    let node = &nodes[index];
    let Some(motion) = physics(node.at)?.map_or(Ok(None), |physics| physics.get("motion"))? else {
        return Ok(());
    };
    let kind = match motion.get("type")?.map(At::str).transpose()? {
        Some("static") => BodyKind::Static,
        Some("kinematic") => BodyKind::Kinematic,
        Some("dynamic") | None => match motion.get("isKinematic")?.map_or(Ok(false), At::bool)? {
            true => BodyKind::Kinematic,
            false => BodyKind::Dynamic,
        },
        Some(other) => return Err(motion.malformed(format!("no motion is {}", quoted(other)))),
    };
    if bodies.len() > MOST_BODIES {
        return Err(motion.unsupported(format!("more than {MOST_BODIES} bodies")));
    }
    let at = rigid(&node.world);
    let velocity =
        |key: &str| Ok::<_, crate::Error>(at.rotation * Vec3::from_array(motion.numbers_or(key, [0.0; 3])?));
    let moves = kind != BodyKind::Static;
    let def = BodyDef {
        kind,
        position: at.translation,
        rotation: at.rotation,
        linear_velocity: if moves { velocity("linearVelocity")? } else { Vec3::ZERO },
        angular_velocity: if moves { velocity("angularVelocity")? } else { Vec3::ZERO },
        gravity_scale: motion.get("gravityFactor")?.map_or(Ok(1.0), At::f32)?,
        user_data: bodies.len() as u64,
        ..BodyDef::default()
    };
    let name = node.at.name();
    nodes[index].body = bodies.len();
    bodies.push(MjcfBody { name, def });
    Ok(())
}

fn read_collider(node: &Node<'_>, lists: &Lists<'_>, body: &mut BodyDef, notes: &mut Notes) -> Result<()> {
    let Some(physics) = physics(node.at)? else { return Ok(()) };
    if physics.get("trigger")?.is_some() {
        notes.left_out("triggers");
    }
    let Some(collider) = physics.get("collider")? else { return Ok(()) };
    if collider.get("collisionFilter")?.is_some() {
        notes.left_out("filters of collision");
    }
    let geometry = collider.get("geometry")?.unwrap_or(collider);
    let Some(number) = geometry.get("shape")? else {
        notes.left_out("meshes that collide");
        return Ok(());
    };
    let of = lists.shapes[number.index(lists.shapes.len(), "shapes")?];
    let columns =
        [node.world.linear.x_axis, node.world.linear.y_axis, node.world.linear.z_axis].map(Vec3::length);
    let scale = (columns[0] + columns[1] + columns[2]) / 3.0;
    if columns.iter().any(|length| (length - scale).abs() > 1e-3 * scale) {
        notes.left_out("scales that differ by axis");
    }
    let Some(shape) = read_shape(of, scale, notes)? else { return Ok(()) };
    let material = match collider.get("physicsMaterial")? {
        Some(number) if !lists.materials.is_empty() => {
            read_material(lists.materials[number.index(lists.materials.len(), "materials")?])?
        }
        _ => Material::default(),
    };
    let world_from_body = Transform::new(body.position, body.rotation);
    let body_from_shape = world_from_body.inverse() * rigid(&node.world);
    let body_from_shape = Transform::new(body_from_shape.translation, body_from_shape.rotation.normalize());
    body.shapes.push(ShapeDef { body_from_shape, material, density: DENSITY, ..ShapeDef::new(shape) });
    Ok(())
}

fn read_material(of: At<'_>) -> Result<Material> {
    let number = |key: &str, else_: f32| of.get(key)?.map_or(Ok(else_), At::not_negative);
    let friction = number("dynamicFriction", 0.6)?;
    Ok(Material { friction, restitution: min(number("restitution", 0.0)?, 1.0), ..Material::default() })
}

/// Reads a shape and scales it; `None` for an unsupported kind.
fn read_shape(of: At<'_>, scale: f32, notes: &mut Notes) -> Result<Option<Shape>> {
    let kind = of.need("type")?;
    let sizes = of.get(kind.str()?)?;
    let number =
        |key: &str| sizes.map_or(Ok(None), |sizes| sizes.get(key))?.map(At::not_negative).transpose();
    let size = |key: &str, else_: f32| Ok::<f32, crate::Error>(number(key)?.unwrap_or(else_) * scale);
    let radii = || {
        let one = number("radius")?;
        let both =
            [number("radiusBottom")?, number("radiusTop")?].map(|own| own.or(one).unwrap_or(0.25) * scale);
        Ok::<[f32; 2], crate::Error>(both)
    };
    let shape = match kind.str()? {
        "sphere" => Shape::Sphere { radius: size("radius", 0.5)? },
        "box" => {
            let full: [f32; 3] = sizes.map_or(Ok([1.0; 3]), |sizes| sizes.numbers_or("size", [1.0; 3]))?;
            Shape::Box { half_extents: Vec3::from_array(full) * (0.5 * scale) }
        }
        "capsule" => {
            let ([radius_bottom, radius_top], half_height) = (radii()?, 0.5 * size("height", 0.5)?);
            if radius_bottom == radius_top {
                Shape::Capsule { half_height, radius: radius_bottom }
            } else {
                Shape::TaperedCapsule { half_height, radius_bottom, radius_top }
            }
        }
        "cylinder" => {
            let ([bottom, top], half_height) = (radii()?, 0.5 * size("height", 0.5)?);
            if top == 0.0 {
                Shape::Cone { half_height, radius: bottom }
            } else {
                if bottom != top {
                    notes.left_out("tapers of cylinders");
                }
                Shape::Cylinder { half_height, radius: max(bottom, top) }
            }
        }
        "convex" | "trimesh" | "plane" => {
            notes.left_out("meshes that collide");
            return Ok(None);
        }
        other => return Err(kind.malformed(format!("no shape is {}", quoted(other)))),
    };
    shape.check().map_err(|error| of.malformed(error.what()))?;
    Ok(Some(shape))
}

/// Sets the mass of dynamic bodies, given in the file or computed from their shapes.
fn weigh(nodes: &[Node<'_>], bodies: &mut [MjcfBody]) -> Result<()> {
    for node in nodes.iter().filter(|node| node.body != 0) {
        let body = &mut bodies[node.body].def;
        let Some(motion) = physics(node.at)?.map_or(Ok(None), |physics| physics.get("motion"))? else {
            continue;
        };
        if body.kind != BodyKind::Dynamic {
            continue;
        }
        let mut mass = body.shapes.iter().fold(MassProperties::default(), |sum, shape| {
            sum.combine(&shape.shape.mass_properties(shape.density).transformed(&shape.body_from_shape))
        });
        if check_mass(&mass).is_err() {
            let inertia = Sym3::from_diagonal(Vec3::splat(UNKNOWN.1));
            mass = MassProperties { mass: UNKNOWN.0, center: Vec3::ZERO, inertia };
        }
        if let Some(given) = motion.get("mass")? {
            let given = given.not_negative()?;
            if given > 0.0 {
                mass = mass.scaled_to(given);
            }
        }
        if motion.get("centerOfMass")?.is_some() {
            mass.center = Vec3::from_array(motion.numbers_or("centerOfMass", [0.0; 3])?);
        }
        let moments = Vec3::from_array(motion.numbers_or("inertiaDiagonal", [0.0; 3])?);
        if moments != Vec3::ZERO {
            let turned = Transform::new(Vec3::ZERO, unit(motion, "inertiaOrientation")?);
            let own =
                MassProperties { mass: mass.mass, center: Vec3::ZERO, inertia: Sym3::from_diagonal(moments) };
            mass.inertia = own.transformed(&turned).inertia;
        }
        check_mass(&mass).map_err(|what| motion.malformed(what))?;
        body.mass = Some(mass);
    }
    Ok(())
}

fn read_joints(
    root: At<'_>,
    nodes: &[Node<'_>],
    bodies: &[MjcfBody],
    notes: &mut Notes,
) -> Result<Vec<MjcfJoint>> {
    let khr = list(root, "KHR_physics_rigid_bodies", "physicsJoints")?;
    let omi = list(root, "OMI_physics_joint", "physicsJoints")?;
    let mut joints = Vec::new();
    for (index, node) in nodes.iter().enumerate() {
        let of_khr =
            extension(node.at, "KHR_physics_rigid_bodies")?.map_or(Ok(None), |of| of.get("joint"))?;
        let (at, known) = match (of_khr, extension(node.at, "OMI_physics_joint")?) {
            (Some(at), _) => (at, &khr),
            (None, Some(at)) => (at, &omi),
            (None, None) => continue,
        };
        if joints.len() >= 4 * MOST_BODIES {
            return Err(at.unsupported(format!("more than {} joints", 4 * MOST_BODIES)));
        }
        let other = at.need("connectedNode")?.index(nodes.len(), "nodes")?;
        let settings = known[at.need("joint")?.index(known.len(), "joints")?];
        let (parent, child) = (body_of(nodes, index), body_of(nodes, other));
        let moves = |body: usize| bodies[body].def.kind == BodyKind::Dynamic;
        if parent == child || !(moves(parent) || moves(child)) {
            notes.left_out("joints within one body, or between bodies that nothing moves");
            continue;
        }
        let frame = |body: usize, node: usize| {
            let def = &bodies[body].def;
            let seen = Transform::new(def.position, def.rotation).inverse() * rigid(&nodes[node].world);
            Transform::new(seen.translation, seen.rotation.normalize())
        };
        let collides = at.get("enableCollision")?.map_or(Ok(false), At::bool)?;
        // Settings of a ragdoll joint that the drafts cannot represent.
        let exact = settings.get("extras")?.map_or(Ok(None), |extras| extras.get("sinew"))?;
        let (kind, friction_torque) = match exact {
            Some(exact) => (
                crate::ragdoll::read_kind(exact)?,
                exact.get("friction_torque")?.map_or(Ok(0.0), At::not_negative)?,
            ),
            None => (kind_of(settings, notes)?, 0.0),
        };
        joints.push(MjcfJoint {
            name: node.at.name(),
            parent,
            child,
            frame_a: frame(parent, index),
            frame_b: frame(child, other),
            kind,
            spring: None,
            friction_torque,
            collision: if collides { JointCollision::Enabled } else { JointCollision::Disabled },
        });
    }
    Ok(joints)
}

/// Returns the joint kind that a joint's limits in the six directions allow.
fn kind_of(settings: At<'_>, notes: &mut Notes) -> Result<JointKind> {
    let (mut linear, mut angular) = ([AxisMotion::Free; 3], [AxisMotion::Free; 3]);
    for limit in settings.list("limits")? {
        if limit.get("stiffness")?.is_some() {
            notes.left_out("softness of limits");
        }
        let bound = |key: &str, else_: f32| limit.get(key)?.map_or(Ok(else_), At::f32);
        let (lo, hi) = (bound("min", f32::NEG_INFINITY)?, bound("max", f32::INFINITY)?);
        if lo > hi {
            return Err(limit.malformed("`min` is above `max`"));
        }
        for (key, motions, most) in [("linearAxes", &mut linear, FARTHEST), ("angularAxes", &mut angular, PI)]
        {
            let axes = limit.list(key)?;
            // Several axes may share one limit of the distance from the centre.
            let range = if axes.len() > 1 { Range { lo: -hi, hi } } else { Range { lo, hi } };
            let (lo, hi) = (max(range.lo, -most), min(range.hi, most));
            for axis in axes {
                let motion = &mut motions[axis.index(3, "axes")?];
                *motion =
                    narrowed(*motion, lo, hi, most).ok_or_else(|| limit.malformed("it leaves nothing"))?;
            }
        }
    }
    if settings.list("drives")?.is_empty() {
        return Ok(simplest(linear, angular));
    }
    notes.left_out("motors");
    Ok(simplest(linear, angular))
}

/// Intersects a motion with another range; `None` if the intersection is empty.
fn narrowed(motion: AxisMotion, lo: f32, hi: f32, most: f32) -> Option<AxisMotion> {
    let (lo, hi) = match motion {
        AxisMotion::Locked => return Some(AxisMotion::Locked),
        AxisMotion::Free => (lo, hi),
        AxisMotion::Limited(range) => (max(lo, range.lo), min(hi, range.hi)),
    };
    if lo == hi {
        Some(AxisMotion::Locked)
    } else if lo > hi || lo.is_nan() || hi.is_nan() {
        None
    } else if lo <= -most && hi >= most {
        Some(AxisMotion::Free)
    } else {
        Some(AxisMotion::Limited(Range { lo, hi }))
    }
}

/// Returns the simplest joint with these motions.
fn simplest(linear: [AxisMotion; 3], angular: [AxisMotion; 3]) -> JointKind {
    use AxisMotion::{Free, Limited, Locked};
    let range = |motion: AxisMotion| match motion {
        Limited(range) => Some(range),
        Free | Locked => None,
    };
    // The range of a swing must include zero.
    let swing = |motion: AxisMotion| match motion {
        Limited(Range { lo, hi }) => Limited(Range { lo: min(lo, 0.0), hi: max(hi, 0.0) }),
        other => other,
    };
    let [x, y, z] = [angular[0], swing(angular[1]), swing(angular[2])];
    let whole = |motion: AxisMotion| range(motion).unwrap_or(Range { lo: -PI, hi: PI });
    let limit = SwingTwistLimit { swing_y: whole(y), swing_z: whole(z), twist: whole(x) };
    match (linear, [x, y, z]) {
        ([Locked, Locked, Locked], [Locked, Locked, Locked]) => JointKind::Fixed,
        ([Locked, Locked, Locked], [x, Locked, Locked]) => JointKind::Hinge { limit: range(x) },
        ([Locked, Locked, Locked], [Free, Free, Free]) => JointKind::Ball { limit: None },
        ([Locked, Locked, Locked], [Free | Limited(_), Free | Limited(_), Free | Limited(_)]) => {
            JointKind::Ball { limit: Some(limit) }
        }
        ([Locked, Locked, Locked], [Locked, Free | Limited(_), Free | Limited(_)]) => {
            JointKind::Universal { limit: Some(limit) }
        }
        ([x, Locked, Locked], [Locked, Locked, Locked]) => JointKind::Slider { limit: range(x) },
        (linear, [twist, swing_y, swing_z]) => JointKind::SixDof(SixDof { linear, twist, swing_y, swing_z }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ReadOptions, no_files, read_gltf, write_gltf, write_khr};
    use sinew_physics::{World, WorldDef};

    const ROPE: &str = r#"{"asset": {"version": "2.0"}, "nodes": [
        {"name": "ceiling", "children": [1, 2], "translation": [0, 2, 0], "extensions": {"OMI_physics_body": {"motion": {"type": "static"}}}},
        {"extensions": {"OMI_physics_body": {"collider": {"shape": 0}}}},
        {"translation": [0, -0.25, 0], "extensions": {"OMI_physics_joint": {"connectedNode": 5, "joint": 0}}},
        {"name": "bob", "children": [4, 5], "translation": [0, 1.25, 0], "extensions": {"OMI_physics_body": {"motion": {"type": "dynamic", "mass": 3}}}},
        {"rotation": [0, 0, 0.70710678, 0.70710678], "scale": [2, 2, 2], "extensions": {"OMI_physics_body": {"collider": {"shape": 1}}}},
        {"translation": [0, 0.5, 0]}],
        "extensions": {"OMI_physics_shape": {"shapes": [{"type": "box", "box": {"size": [0.5, 0.5, 0.5]}},
            {"type": "capsule", "capsule": {"radius": 0.05, "height": 0.5}}]},
            "OMI_physics_joint": {"physicsJoints": [{"limits": [{"linearAxes": [0, 1, 2], "min": 0, "max": 0},
            {"angularAxes": [1, 2], "max": 0.4}, {"angularAxes": [0], "min": -0.1, "max": 0.2}]}]}}}"#;

    #[test]
    fn omi_bodies_shapes_and_joints_are_read() {
        let model = read_physics_gltf(ROPE.as_bytes()).expect("the file is valid");
        assert_eq!(model.bodies.len(), 3);
        let bob = &model.bodies[2].def;
        assert_eq!(bob.mass.expect("the mass is given").mass, 3.0);
        let Shape::Capsule { half_height, radius } = bob.shapes[0].shape else { panic!("{:?}", bob.shapes) };
        assert!((half_height - 0.5).abs() < 1e-6 && (radius - 0.1).abs() < 1e-6, "twice its size");
        let JointKind::Ball { limit: Some(limit) } = model.joints[0].kind else {
            panic!("{:?}", model.joints[0])
        };
        assert_eq!((limit.swing_y, limit.twist), (Range { lo: -0.4, hi: 0.4 }, Range { lo: -0.1, hi: 0.2 }));
        let mut world = World::new(WorldDef::default());
        let there = model.spawn(&mut world);
        (0..120).for_each(|_| world.step());
        assert!(world.joint_gap(there.joints[0]) < 1e-4);
    }

    #[test]
    fn written_ragdoll_reads_back_equal() {
        let def = sinew::mannequin::character();
        let bytes = write_gltf(&def.rig, &[]).expect("the rig can be written as glTF");
        let document = read_gltf(&bytes, ReadOptions::default(), &mut no_files).expect("and read");
        let analysis = sinew_anim::analyze(&document.rig).expect("the rig has a skin");
        let ragdoll = def.ragdoll.clone().for_rig(&document.rig).expect("the ragdoll fits the rig");
        let written =
            write_khr(&document, &analysis.bind_model, &ragdoll).expect("the file has no physics yet");
        let model = read_physics_gltf(&written.bytes).expect("the file is valid");
        assert_eq!(model.bodies.len(), ragdoll.bodies.len() + 1);
        for body in &ragdoll.bodies {
            let own = &model.bodies[model.body(&body.bone).expect("by its name")].def;
            assert!((own.mass.expect("the mass is given").mass - body.mass.mass).abs() < 1e-4);
            assert_eq!(own.shapes.len(), 1);
        }
        let names =
            |joint: &MjcfJoint| [joint.parent, joint.child].map(|body| model.bodies[body].name.clone());
        for joint in &ragdoll.joints {
            let own = [joint.parent, joint.child].map(|body| ragdoll.bodies[body].bone.clone());
            let there =
                model.joints.iter().find(|other| names(other) == own).expect("the model has this joint");
            let widest = |kind: &JointKind| match kind {
                JointKind::Ball { limit: Some(limit) } => limit.swing_y.hi,
                JointKind::Hinge { limit: Some(range) } => range.hi,
                _ => 0.0,
            };
            assert!((widest(&there.kind) - widest(&joint.kind)).abs() < 1e-4, "{own:?}: {:?}", there.kind);
        }
        let mut world = World::new(WorldDef::default());
        let there = model.spawn(&mut world);
        let gap = there.joints.iter().map(|&joint| world.joint_gap(joint)).fold(0.0, max);
        assert!(gap < 1e-3, "{gap}");
    }

    #[test]
    fn errors_are_one_line_with_a_place() {
        for (right, wrong, words) in [
            ("\"shape\": 1", "\"shape\": 9", "index 9 is out of range"),
            ("\"joint\": 0", "\"joint\": 4", "out of range"),
            ("\"radius\": 0.05", "\"radius\": -1", "must not be negative"),
            ("\"max\": 0.2", "\"max\": -0.2", "`min` is above `max`"),
            ("\"children\": [1, 2]", "\"children\": [0, 2]", "circle"),
            ("[0, 1.25, 0]", "[0, 1e30, 0]", "not within"),
            ("\"mass\": 3", "\"mass\": -3", "negative"),
            ("\"type\": \"box\"", "\"type\": \"blob\"", "no shape is `blob`"),
        ] {
            let error = read_physics_gltf(ROPE.replacen(right, wrong, 1).as_bytes()).expect_err(wrong);
            let text = error.to_string();
            assert!(text.contains(words) && text.ends_with(')') && !text.contains('\n'), "{wrong}: {text}");
        }
    }

    #[test]
    fn damaged_files_do_not_panic() {
        for end in 0..ROPE.len() {
            let _ = read_physics_gltf(&ROPE.as_bytes()[..end]);
            let mut changed = ROPE.as_bytes().to_vec();
            changed[end] ^= 0x11;
            if let Ok(model) = read_physics_gltf(&changed) {
                model.spawn(&mut World::new(WorldDef::default()));
            }
        }
    }
}
