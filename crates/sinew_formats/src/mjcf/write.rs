//! Writes a ragdoll as an MJCF model: bodies in a tree, hinges with ranges.

use core::fmt::Write as _;
use sinew_math::{Rotation, Sym3, Transform, Vec3, min};
use sinew_physics::{JointKind, MassProperties, Shape};
use sinew_ragdoll::doctor::limit_reach;
use sinew_ragdoll::{RagdollBodyDef, RagdollDef};

/// Text of a model, with notes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MjcfText {
    /// The file.
    pub text: String,
    /// Notes on what the format cannot represent, one sentence each.
    pub notes: Vec<String>,
}

/// Writes the ragdoll in its bind pose on a plane, facing +x with z up, as MJCF. `name` is the name of the model.
///
/// A ball joint becomes three hinges, a universal joint two. The range of each is that from the bind pose while the
/// other hinges are at rest: a box where the ragdoll's limit is an ellipse. Coordinates are 0 in the bind pose, except
/// for hinge joints, which keep their own angle (`ref`). Tapered capsules get their mean radius, cones become their
/// cylinder and hulls their bounding box. Masses and inertias are unchanged.
///
/// # Panics
/// If the joints are not in the order of the bodies, or a number is not finite.
pub fn write_mjcf(def: &RagdollDef, name: &str) -> MjcfText {
    let mut writer = Writer { def, names: names(def), out: String::new(), notes: Vec::new() };
    writer.line(0, &format!("<mujoco model=\"{}\">", escaped(name)));
    writer.line(1, "<!-- metres, kilograms, radians; written by sinew ragdoll export -->");
    writer.line(1, "<compiler angle=\"radian\" autolimits=\"true\"/>");
    writer.line(1, "<option integrator=\"implicitfast\" timestep=\"0.002\"/>");
    writer.line(1, "<worldbody>");
    writer.line(2, "<geom name=\"floor\" type=\"plane\" size=\"10 10 0.1\"/>");
    writer.body(0, 2);
    writer.line(1, "</worldbody>");
    if !def.disabled_pairs.is_empty() {
        writer.line(1, "<contact>");
        for &(a, b) in &def.disabled_pairs {
            let line = format!("<exclude body1=\"{}\" body2=\"{}\"/>", writer.names[a], writer.names[b]);
            writer.line(2, &line);
        }
        writer.line(1, "</contact>");
    }
    writer.line(0, "</mujoco>");
    let hinges = def
        .joints
        .iter()
        .filter(|joint| matches!(joint.kind, JointKind::Ball { .. } | JointKind::Universal { .. }));
    let hinges = hinges.count();
    if hinges > 0 {
        writer.notes.push(format!(
            "{hinges} joints became hinges at right angles, whose ranges are a box and not an ellipse"
        ));
    }
    MjcfText { text: writer.out, notes: writer.notes }
}

/// Returns unique names of bodies.
fn names(def: &RagdollDef) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for body in &def.bodies {
        let plain = escaped(if body.bone.is_empty() { "bone" } else { &body.bone });
        let mut name = plain.clone();
        let mut count = 1;
        while names.contains(&name) || matches!(name.as_str(), "world" | "floor") {
            count += 1;
            name = format!("{plain}#{count}");
        }
        names.push(name);
    }
    names
}

/// Returns the text escaped for an attribute.
fn escaped(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push('_'),
            c => out.push(c),
        }
    }
    out
}

struct Writer<'a> {
    def: &'a RagdollDef,
    names: Vec<String>,
    out: String,
    notes: Vec<String>,
}

impl Writer<'_> {
    fn line(&mut self, indent: usize, text: &str) {
        self.out.push_str(&"  ".repeat(indent));
        self.out.push_str(text);
        self.out.push('\n');
    }

    /// Writes a body with its descendants.
    fn body(&mut self, index: usize, indent: usize) {
        let body = &self.def.bodies[index];
        let joint = index.checked_sub(1).map(|joint| self.def.joints[joint]);
        let place = match joint {
            Some(joint) => {
                let parent = self.def.bodies[joint.parent].character_from_body;
                parent.inverse() * body.character_from_body
            }
            None => self.lifted() * facing_x() * body.character_from_body,
        };
        self.line(indent, &format!("<body name=\"{}\"{}>", self.names[index], pose(place)));
        if joint.is_some() {
            self.joint(index - 1, indent + 1);
        } else {
            self.line(indent + 1, "<freejoint name=\"root\"/>");
        }
        self.line(indent + 1, &inertial(&body.mass));
        let geom = self.geom(index);
        self.line(indent + 1, &geom);
        for child in index + 1..self.def.bodies.len() {
            if self.def.joints[child - 1].parent == index {
                self.body(child, indent + 1);
            }
        }
        self.line(indent, "</body>");
    }

    /// Returns the height by which the ragdoll is raised so that no shape is in the floor; shapes may extend below the
    /// soles of the skin.
    fn lifted(&self) -> Transform {
        let lowest = |body: &RagdollBodyDef| body.shape.aabb(&body.character_from_body).min.y;
        Transform::from_translation(Vec3::Y * -self.def.bodies.iter().map(lowest).fold(0.0, min))
    }

    fn joint(&mut self, index: usize, indent: usize) {
        let joint = &self.def.joints[index];
        let name = &self.names[joint.child];
        let rotation = |body: usize| self.def.bodies[body].character_from_body.rotation;
        let on_parent = rotation(joint.parent) * joint.frame_parent.rotation;
        let bind = on_parent.inverse() * (rotation(joint.child) * joint.frame_child.rotation);
        let at = numbers(&file_axes(joint.frame_child.translation).to_array());
        let friction = if joint.friction_torque > 0.0 {
            format!(" frictionloss=\"{}\"", joint.friction_torque)
        } else {
            String::new()
        };
        let hinge = |suffix: &str, axis: Vec3, range: Option<[f32; 2]>, reference: f32| {
            let axis = numbers(&file_axes(joint.frame_child.rotation * axis).to_array());
            let range = range.map_or(String::new(), |range| format!(" range=\"{}\"", numbers(&range)));
            let reference = if reference == 0.0 { String::new() } else { format!(" ref=\"{reference}\"") };
            format!(
                "<joint name=\"{name}{suffix}\" pos=\"{at}\" axis=\"{axis}\"{range}{reference}{friction}/>"
            )
        };
        let free = |axis: Vec3, is_limited: bool| {
            is_limited.then(|| [-limit_reach(&joint.kind, bind, -axis), limit_reach(&joint.kind, bind, axis)])
        };
        let lines = match joint.kind {
            JointKind::Hinge { limit } => {
                let angle = sinew_math::limits::hinge_angle(bind);
                vec![hinge("", Vec3::X, limit.map(|range| [range.lo, range.hi]), angle)]
            }
            // The twist comes last, so that it is exactly the last hinge.
            JointKind::Ball { limit } => [("_y", Vec3::Y), ("_z", Vec3::Z), ("_x", Vec3::X)]
                .map(|(suffix, axis)| hinge(suffix, axis, free(axis, limit.is_some()), 0.0))
                .to_vec(),
            JointKind::Universal { limit } => [("_y", Vec3::Y), ("_z", Vec3::Z)]
                .map(|(suffix, axis)| hinge(suffix, axis, free(axis, limit.is_some()), 0.0))
                .to_vec(),
            _ => Vec::new(),
        };
        for line in lines {
            self.line(indent, &line);
        }
    }

    /// Writes the shape of a body; its y is the file's z.
    fn geom(&mut self, index: usize) -> String {
        let body = &self.def.bodies[index];
        let mut at = Vec3::ZERO;
        let mut note = |what: &str| self.notes.push(format!("{} of `{}`", what, self.names[index]));
        let (kind, size) = match body.shape {
            Shape::Sphere { radius } => ("sphere", vec![radius]),
            Shape::Box { half_extents: h } => ("box", vec![h.x, h.z, h.y]),
            Shape::Capsule { half_height: 0.0, radius } => ("sphere", vec![radius]),
            Shape::Capsule { half_height, radius } => ("capsule", vec![radius, half_height]),
            Shape::Cylinder { half_height, radius } => ("cylinder", vec![radius, half_height]),
            Shape::TaperedCapsule { half_height, radius_bottom, radius_top } => {
                note("a tapered capsule became a capsule of the mean radius");
                ("capsule", vec![0.5 * (radius_bottom + radius_top), half_height])
            }
            Shape::Cone { half_height, radius } => {
                note("a cone became a cylinder");
                ("cylinder", vec![radius, half_height])
            }
            ref other => {
                note("a hull became a box");
                let bounds = other.aabb(&Transform::IDENTITY);
                at = (bounds.min + bounds.max) * 0.5;
                let h = (bounds.max - bounds.min) * 0.5;
                ("box", vec![h.x, h.z, h.y])
            }
        };
        let at = if at == Vec3::ZERO {
            String::new()
        } else {
            format!(" pos=\"{}\"", numbers(&file_axes(at).to_array()))
        };
        format!("<geom type=\"{kind}\" size=\"{}\"{at}/>", numbers(&size))
    }
}

/// Rotates from the character's axes (+Z forward) to the file's forward (+x), with +Y up.
fn facing_x() -> Transform {
    Transform::new(Vec3::ZERO, Rotation::from_axis_angle(Vec3::Y, core::f32::consts::FRAC_PI_2))
}

/// Converts from y up to z up, the inverse of the reader's rotation.
fn file_axes(v: Vec3) -> Vec3 {
    Vec3::new(v.x, -v.z, v.y)
}

fn pose(at: Transform) -> String {
    let r = at.rotation.normalize();
    let place = numbers(&file_axes(at.translation).to_array());
    format!(" pos=\"{place}\" quat=\"{}\"", numbers(&[r.w, r.x, -r.z, r.y]))
}

/// Returns the inertia. If rounding made the sum of the smaller moments less than the largest, which MuJoCo rejects,
/// the smaller moments are slightly increased.
fn solid(inertia: Sym3) -> Sym3 {
    let (moments, axes) = inertia.eigen();
    let missing = 1.0005 * moments.x - (moments.y + moments.z);
    if missing <= 0.0 {
        return inertia;
    }
    Sym3::from_rotated_diagonal(axes, moments + Vec3::new(0.0, 0.5 * missing, 0.5 * missing))
}

/// Writes the inertia in the file's axes: their z is our y, their y our −z.
fn inertial(mass: &MassProperties) -> String {
    let inertia = solid(mass.inertia);
    let (d, o) = (inertia.diagonal, inertia.off);
    // fullinertia is xx, yy, zz, xy, xz, yz.
    let full = [d.x, d.z, d.y, -o.y, o.z, -o.x];
    let center = numbers(&file_axes(mass.center).to_array());
    format!("<inertial pos=\"{center}\" mass=\"{}\" fullinertia=\"{}\"/>", mass.mass, numbers(&full))
}

/// Formats numbers for an attribute.
///
/// # Panics
/// If a number is not finite.
fn numbers(xs: &[f32]) -> String {
    let mut out = String::new();
    for (index, x) in xs.iter().enumerate() {
        assert!(x.is_finite(), "a model holds finite numbers, not {x}");
        // Adding zero turns −0 into 0.
        let _ = write!(out, "{}{}", if index > 0 { " " } else { "" }, x + 0.0);
    }
    out
}
