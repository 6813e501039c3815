//! Reads robot models in URDF as a model of bodies and joints like those of [MJCF](crate::mjcf).
//!
//! The reader supports links with `<inertial>` and `<collision>` shapes (box, sphere, cylinder, capsule), and joints of
//! type `revolute`, `continuous`, `prismatic`, `fixed`, `floating` and Bullet's `spherical`, with `<origin>`, `<axis>`,
//! `<limit>` and `<dynamics>`. Units are metres and kilograms. The file's z axis (up) becomes y, its x axis stays x.
//! The links keep the file's own axes.
//!
//! Unsupported content is skipped and listed in [`MjcfModel::notes`]: visuals, mesh colliders, transmissions, mimic
//! joints, effort and velocity limits, safety controllers, Gazebo's and other extensions. Content that would change the
//! model if skipped is an error: planar joints, links with two parent joints, cycles.
//!
//! - **The root link** is free; a root named `world` stands.
//! - **Links without mass** between joints get one of a gram, because files use them as frames; a note reports it. The
//!   root frame of most robots is such a link.
//! - **Collision** of links with a joint between them is off, as most simulators have it; `<dynamics>` damping is a
//!   spring without stiffness, friction the joint's.
//!
//! ```
//! use sinew_formats::read_urdf;
//! use sinew_physics::{World, WorldDef};
//!
//! let text = r#"<robot name="lever"><link name="world"/><link name="arm">
//!     <inertial><origin xyz="0 0 0.5"/><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
//!     <collision><origin xyz="0 0 0.5"/><geometry><cylinder radius="0.05" length="1"/></geometry></collision></link>
//!     <joint name="hinge" type="revolute"><parent link="world"/><child link="arm"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/>
//!     <limit lower="-1" upper="1" effort="10" velocity="1"/></joint></robot>"#;
//! let model = read_urdf(text.as_bytes())?;
//! let mut world = World::new(WorldDef::default());
//! let bodies = model.spawn(&mut world).bodies;
//! let arm = bodies[model.body("arm").expect("the model has this body")];
//! assert!((world.center_of_mass(arm).y - 1.5).abs() < 1e-5); // z up became y up
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::error::{Error, Result, quoted};
use crate::mjcf::bodies::{MOST_BODIES, check_mass};
use crate::mjcf::notes::Notes;
use crate::mjcf::xml::{self, Element, Value, children, malformed, unsupported};
use crate::mjcf::{MjcfBody, MjcfJoint, MjcfModel};
use core::f32::consts::{FRAC_PI_2, PI};
use sinew_math::{Range, Rotation, Sym3, Transform, Vec3};
use sinew_physics::{
    BodyDef, BodyKind, JointCollision, JointKind, MassProperties, Shape, ShapeDef, Softness, Spring,
};
use std::collections::BTreeMap;

/// Name of a root link that is fixed.
const WORLD: &str = "world";
/// Mass, kg, and moments, kg·m², of a link without inertial data, such as a frame.
const FRAME: (f32, f32) = (1e-3, 1e-6);

/// A link of the file.
struct Link<'a> {
    name: &'a str,
    mass: Option<MassProperties>,
    shapes: Vec<ShapeDef>,
}

/// A joint of the file.
struct Joint<'a> {
    element: Element<'a>,
    name: &'a str,
    parent: usize,
    child: usize,
    /// The child's frame in the parent's frame, at joint position zero.
    parent_from_child: Transform,
    kind: Kind,
    damping: f32,
    friction: f32,
}

enum Kind {
    Floating,
    /// Kind of the joint, and direction of the joint frame's x axis in the child.
    Held(JointKind, Vec3),
}

/// Reads a URDF file.
///
/// # Errors
/// Returns an error that names line and column: invalid XML, or XML that is not URDF; invalid names, numbers and types;
/// unsupported content that would change the model; more than 4 MiB or 1,024 links.
pub fn read_urdf(bytes: &[u8]) -> Result<MjcfModel> {
    // Some programs write the terminating zero byte of a C string to the file.
    let document = xml::parse(bytes.strip_suffix(&[0]).unwrap_or(bytes))?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        let what = format!("not a URDF file: begins with {}", quoted(root.tag_name().name()));
        return Err(malformed(root, what));
    }
    let mut notes = Notes::default();
    let (links, by_name) = read_links(root, &mut notes)?;
    let joints = read_joints(root, &by_name, &mut notes)?;
    let order = ordered(root, &links, &joints)?;
    let name = root.attribute("name").unwrap_or_default().to_owned();
    Ok(model(name, links, &joints, &order, notes))
}

fn read_links<'a>(root: Element<'a>, notes: &mut Notes) -> Result<(Vec<Link<'a>>, BTreeMap<&'a str, usize>)> {
    let (mut links, mut by_name) = (Vec::new(), BTreeMap::new());
    for (tag, element) in children(root) {
        match tag {
            "link" => {
                if links.len() == MOST_BODIES {
                    return Err(unsupported(element, format!("more than {MOST_BODIES} links")));
                }
                let name = need(element, "name")?;
                if by_name.insert(name.text(), links.len()).is_some() {
                    return Err(name.malformed(format!("two links are named {}", quoted(name.text()))));
                }
                links.push(read_link(element, name.text(), notes)?);
            }
            "joint" | "material" => {}
            "transmission" => notes.left_out("transmissions"),
            _ => notes.left_out("extensions"),
        }
    }
    if links.is_empty() {
        Err(malformed(root, "a robot has at least one link"))
    } else {
        Ok((links, by_name))
    }
}

fn need<'a>(element: Element<'a>, key: &str) -> Result<Value<'a>> {
    Value::of(element, key).ok_or_else(|| malformed(element, format!("`{key}` is missing")))
}

fn child<'a>(element: Element<'a>, tag: &str) -> Option<Element<'a>> {
    children(element).find(|(name, _)| *name == tag).map(|(_, child)| child)
}

fn need_child<'a>(element: Element<'a>, tag: &str) -> Result<Element<'a>> {
    child(element, tag).ok_or_else(|| malformed(element, format!("<{tag}> is missing")))
}

/// Reads the pose of `<origin>` in an element; the identity without one.
fn origin(element: Element<'_>) -> Result<Transform> {
    let Some(origin) = child(element, "origin") else { return Ok(Transform::IDENTITY) };
    let three = |key: &str| Value::of(origin, key).map_or(Ok([0.0; 3]), Value::numbers);
    let [roll, pitch, yaw] = three("rpy")?;
    let about = Rotation::from_axis_angle;
    let rotation = about(Vec3::Z, yaw) * about(Vec3::Y, pitch) * about(Vec3::X, roll);
    Ok(Transform::new(Vec3::from_array(three("xyz")?), rotation.normalize()))
}

fn read_link<'a>(element: Element<'a>, name: &'a str, notes: &mut Notes) -> Result<Link<'a>> {
    let mut link = Link { name, mass: None, shapes: Vec::new() };
    for (tag, part) in children(element) {
        match tag {
            "inertial" => link.mass = read_inertial(part, notes)?,
            "collision" => link.shapes.extend(read_collision(part, notes)?),
            "visual" => notes.left_out("visuals"),
            _ => notes.left_out("extensions"),
        }
    }
    Ok(link)
}

/// Reads the mass of a link in the link's frame; `None` for a mass of 0.
fn read_inertial(element: Element<'_>, notes: &mut Notes) -> Result<Option<MassProperties>> {
    let mass = need(need_child(element, "mass")?, "value")?.not_negative()?;
    if mass == 0.0 {
        return Ok(None);
    }
    let inertia = need_child(element, "inertia")?;
    let of = |key: &str| Value::of(inertia, key).map_or(Ok(0.0), Value::number);
    let inertia = Sym3 {
        diagonal: Vec3::new(of("ixx")?, of("iyy")?, of("izz")?),
        off: Vec3::new(of("iyz")?, of("ixz")?, of("ixy")?),
    };
    let own = MassProperties { mass, center: Vec3::ZERO, inertia };
    if check_mass(&own).is_err() {
        notes.left_out("impossible inertias");
        return Ok(Some(MassProperties {
            inertia: Sym3::from_diagonal(Vec3::splat(FRAME.1 / FRAME.0 * mass)),
            ..own
        }));
    }
    Ok(Some(own.transformed(&origin(element)?)))
}

/// Reads a collision shape; `None` for an unsupported kind.
fn read_collision(element: Element<'_>, notes: &mut Notes) -> Result<Option<ShapeDef>> {
    let geometry = need_child(element, "geometry")?;
    let Some((tag, of)) = children(geometry).next() else {
        return Err(malformed(geometry, "it has no shape"));
    };
    let number = |key: &str| need(of, key)?.not_negative();
    // Round shapes are along z in the file, and along y in Sinew.
    let upright = Transform::new(Vec3::ZERO, Rotation::from_axis_angle(Vec3::X, FRAC_PI_2));
    let (shape, turned) = match tag {
        "box" => {
            let [x, y, z] = need(of, "size")?.numbers()?;
            (Shape::Box { half_extents: Vec3::new(x, y, z) * 0.5 }, Transform::IDENTITY)
        }
        "sphere" => (Shape::Sphere { radius: number("radius")? }, Transform::IDENTITY),
        "cylinder" => {
            (Shape::Cylinder { radius: number("radius")?, half_height: 0.5 * number("length")? }, upright)
        }
        "capsule" => {
            (Shape::Capsule { radius: number("radius")?, half_height: 0.5 * number("length")? }, upright)
        }
        "mesh" => {
            notes.left_out("meshes that collide");
            return Ok(None);
        }
        _ => return Err(unsupported(of, format!("a shape {} is not read", quoted(tag)))),
    };
    shape.check().map_err(|error| malformed(of, error.what()))?;
    Ok(Some(ShapeDef { body_from_shape: origin(element)? * turned, ..ShapeDef::new(shape) }))
}

fn read_joints<'a>(
    root: Element<'a>,
    by_name: &BTreeMap<&'a str, usize>,
    notes: &mut Notes,
) -> Result<Vec<Joint<'a>>> {
    let mut joints = Vec::new();
    for (_, element) in children(root).filter(|(tag, _)| *tag == "joint") {
        if joints.len() == MOST_BODIES {
            return Err(unsupported(element, format!("more than {MOST_BODIES} joints")));
        }
        let link = |tag: &str| {
            let name = need(need_child(element, tag)?, "link")?;
            let found = by_name.get(name.text()).copied();
            found.ok_or_else(|| name.malformed(format!("no link {}", quoted(name.text()))))
        };
        if child(element, "mimic").is_some() {
            notes.left_out("mimics");
        }
        let dynamics = child(element, "dynamics");
        let number = |key: &str| {
            let value = dynamics.and_then(|dynamics| Value::of(dynamics, key));
            value.map_or(Ok(0.0), Value::not_negative)
        };
        joints.push(Joint {
            element,
            name: element.attribute("name").unwrap_or_default(),
            parent: link("parent")?,
            child: link("child")?,
            parent_from_child: origin(element)?,
            kind: read_kind(element)?,
            damping: number("damping")?,
            friction: number("friction")?,
        });
    }
    Ok(joints)
}

fn read_kind(element: Element<'_>) -> Result<Kind> {
    let axis = match child(element, "axis") {
        Some(axis) => {
            let value = need(axis, "xyz")?;
            let axis = Vec3::from_array(value.numbers()?);
            let length = axis.length();
            if length < 1e-6 {
                return Err(value.malformed("an axis must not be zero"));
            }
            axis / length
        }
        None => Vec3::X,
    };
    let range = |most: f32| -> Result<Option<Range>> {
        let Some(limit) = child(element, "limit") else { return Ok(None) };
        let of = |key: &str| Value::of(limit, key).map_or(Ok(0.0), Value::number);
        let (lo, hi) = (of("lower")?, of("upper")?);
        if lo > hi {
            return Err(malformed(limit, "`lower` is above `upper`"));
        }
        // A hinge with a range of a full turn or more is unlimited.
        Ok((lo > -most || hi < most)
            .then_some(Range { lo: sinew_math::max(lo, -most), hi: sinew_math::min(hi, most) }))
    };
    let kind = need(element, "type")?;
    let joint = match kind.text() {
        "revolute" => JointKind::Hinge { limit: range(PI)? },
        "continuous" => JointKind::Hinge { limit: None },
        "prismatic" => JointKind::Slider { limit: range(f32::INFINITY)? },
        "fixed" => JointKind::Fixed,
        "spherical" => JointKind::Ball { limit: None },
        "floating" => return Ok(Kind::Floating),
        "planar" => return Err(kind.unsupported("planar joints are not read")),
        other => return Err(kind.malformed(format!("no joint is {}", quoted(other)))),
    };
    if let JointKind::Hinge { limit: Some(range) } | JointKind::Slider { limit: Some(range) } = joint
        && range.lo > range.hi
    {
        return Err(malformed(element, "its limits are empty"));
    }
    Ok(Kind::Held(joint, axis))
}

/// Returns the links with the joint to their parent, parents before children.
fn ordered<'a>(
    root: Element<'a>,
    links: &[Link<'a>],
    joints: &[Joint<'a>],
) -> Result<Vec<(usize, Option<usize>)>> {
    let mut above: Vec<Option<usize>> = vec![None; links.len()];
    for (index, joint) in joints.iter().enumerate() {
        if above[joint.child].replace(index).is_some() {
            let what = format!("link {} has two parents", quoted(links[joint.child].name));
            return Err(unsupported(joint.element, what));
        }
    }
    let mut below: Vec<Vec<usize>> = vec![Vec::new(); links.len()];
    joints.iter().for_each(|joint| below[joint.parent].push(joint.child));
    let mut order = Vec::with_capacity(links.len());
    // Uses a list of open links instead of recursion, so that a deep file cannot overflow the stack.
    let mut open: Vec<usize> = (0..links.len()).rev().filter(|&link| above[link].is_none()).collect();
    while let Some(link) = open.pop() {
        order.push((link, above[link]));
        open.extend(below[link].iter().rev());
    }
    if order.len() < links.len() {
        let stray = (0..links.len()).find(|link| order.iter().all(|(other, _)| other != link));
        let name = stray.map_or("", |link| links[link].name);
        return Err(Error::malformed(format!("link {} is its own ancestor", quoted(name)), xml::place(root)));
    }
    Ok(order)
}

fn model(
    name: String,
    mut links: Vec<Link<'_>>,
    joints: &[Joint<'_>],
    order: &[(usize, Option<usize>)],
    mut notes: Notes,
) -> MjcfModel {
    let y_up = Transform::new(Vec3::ZERO, Rotation::from_axis_angle(Vec3::X, -FRAC_PI_2));
    let stands = BodyDef { kind: BodyKind::Static, rotation: y_up.rotation, ..BodyDef::default() };
    let mut bodies = vec![MjcfBody { name: WORLD.to_owned(), def: stands }];
    let mut made = Vec::new();
    // Index of each link's body, and its pose.
    let mut placed = vec![(0, y_up); links.len()];
    for &(link, above) in order {
        let own = &mut links[link];
        let above = above.map(|joint| &joints[joint]);
        if above.is_none() && own.name == WORLD {
            bodies[0].def.shapes = core::mem::take(&mut own.shapes);
            continue;
        }
        let at = above.map_or(y_up, |joint| placed[joint.parent].1 * joint.parent_from_child);
        let at = Transform::new(at.translation, at.rotation.normalize());
        placed[link] = (bodies.len(), at);
        let mass = own.mass.unwrap_or_else(|| {
            notes.left_out("links without mass, which got a gram");
            let inertia = Sym3::from_diagonal(Vec3::splat(FRAME.1));
            MassProperties { mass: FRAME.0, center: Vec3::ZERO, inertia }
        });
        if let Some(joint) = above {
            made.extend(joined(joint, placed[joint.parent].0, bodies.len()));
        }
        let def = BodyDef {
            kind: BodyKind::Dynamic,
            position: at.translation,
            rotation: at.rotation,
            user_data: bodies.len() as u64,
            mass: Some(mass),
            shapes: core::mem::take(&mut own.shapes),
            ..BodyDef::default()
        };
        bodies.push(MjcfBody { name: own.name.to_owned(), def });
    }
    MjcfModel {
        name,
        gravity: Vec3::new(0.0, -9.81, 0.0),
        bodies,
        joints: made,
        excluded_pairs: Vec::new(),
        keyframes: Vec::new(),
        notes: notes.into_sentences(),
    }
}

/// Returns the joint between two bodies; `None` for a floating child.
fn joined(joint: &Joint<'_>, parent: usize, child: usize) -> Option<MjcfJoint> {
    let Kind::Held(kind, axis) = joint.kind else { return None };
    let frame_b = Transform::new(Vec3::ZERO, Rotation::from_arc(Vec3::X, axis));
    let softness = Softness::Stiffness { stiffness: 0.0, damping: joint.damping };
    let spring = (joint.damping > 0.0).then_some(Spring { softness, rest: Transform::IDENTITY });
    Some(MjcfJoint {
        name: joint.name.to_owned(),
        parent,
        child,
        frame_a: joint.parent_from_child * frame_b,
        frame_b,
        kind,
        spring,
        friction_torque: joint.friction,
        collision: JointCollision::Disabled,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_physics::{World, WorldDef};

    const ARM: &str = r#"<robot name="arm"><link name="base"><inertial><mass value="3"/>
        <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
        <collision><geometry><box size="0.4 0.2 0.1"/></geometry></collision></link>
        <link name="upper"><inertial><origin xyz="0.2 0 0"/><mass value="1"/>
        <inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
        <collision><origin xyz="0.2 0 0" rpy="0 1.5707963 0"/><geometry><cylinder radius="0.05" length="0.4"/></geometry></collision></link>
        <link name="tip"/>
        <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0.2 0 0.05"/>
        <axis xyz="0 1 0"/><limit lower="-0.5" upper="1.2" effort="1" velocity="1"/><dynamics damping="0.1" friction="0.2"/></joint>
        <joint name="end" type="fixed"><parent link="upper"/><child link="tip"/><origin xyz="0.4 0 0"/></joint></robot>"#;

    #[test]
    fn links_joints_limits_and_masses_match_the_file() {
        let model = read_urdf(ARM.as_bytes()).expect("the file is valid");
        let names: Vec<&str> = model.bodies.iter().map(|body| body.name.as_str()).collect();
        assert_eq!(names, ["world", "base", "upper", "tip"]);
        let shoulder = &model.joints[0];
        assert_eq!((shoulder.parent, shoulder.child, shoulder.friction_torque), (1, 2, 0.2));
        assert_eq!(shoulder.kind, JointKind::Hinge { limit: Some(Range { lo: -0.5, hi: 1.2 }) });
        assert!((shoulder.frame_b.rotation * Vec3::X - Vec3::Y).length() < 1e-6);
        assert!(model.notes.iter().any(|note| note.contains("without mass")), "{:?}", model.notes);
        let mut world = World::new(WorldDef { gravity: Vec3::ZERO, ..WorldDef::default() });
        let there = model.spawn(&mut world);
        // The x axis stays, z becomes y.
        let tip = world.transform(there.bodies[3]).translation;
        assert!((tip - Vec3::new(0.6, 0.05, 0.0)).length() < 1e-5, "{tip}");
        (0..60).for_each(|_| world.step());
        assert!(there.joints.iter().all(|&joint| world.joint_gap(joint) < 1e-4));
        let middle = world.bounds(there.bodies[2]).center();
        assert!(
            (middle - Vec3::new(0.4, 0.05, 0.0)).length() < 0.02,
            "the shape lies along the arm: {middle}"
        );
    }

    #[test]
    fn errors_are_one_line_with_a_place() {
        for (wrong, right, words) in [
            ("child link=\"upper\"", "child link=\"wing\"", "no link `wing`"),
            ("lower=\"-0.5\"", "lower=\"2\"", "above `upper`"),
            ("axis xyz=\"0 1 0\"", "axis xyz=\"0 0 0\"", "an axis must not be zero"),
            ("type=\"revolute\"", "type=\"planar\"", "planar joints are not read"),
            ("mass value=\"1\"", "mass value=\"nan\"", "not within"),
            ("<parent link=\"base\"/>", "<parent link=\"tip\"/>", "is its own ancestor"),
            ("radius=\"0.05\"", "radius=\"0\"", "line"),
        ] {
            let error = read_urdf(ARM.replace(wrong, right).as_bytes()).expect_err(right).to_string();
            assert!(
                error.contains(words) && error.contains("line") && !error.contains('\n'),
                "{right}: {error}"
            );
        }
    }

    #[test]
    fn damaged_files_do_not_panic() {
        let bytes = ARM.as_bytes();
        for end in 0..bytes.len() {
            let _ = read_urdf(&bytes[..end]);
            let mut changed = bytes.to_vec();
            changed[end] ^= 0x15;
            let _ = read_urdf(&changed);
        }
    }
}
