//! Values and calls as Rust code, for the program that reproduces a failure.

use core::fmt::Debug;
use sinew_physics::*;

/// A value that can be written as Rust code.
pub trait Code {
    fn code(&self) -> String;
}

impl<T: Debug> Code for T {
    fn code(&self) -> String {
        rusty(&format!("{self:?}"))
    }
}

/// Returns the code of an argument of a call, borrowed if the deed borrows it.
pub fn argument(written: &str, value: &dyn Debug) -> String {
    let borrowed = if written.starts_with('&') { "&" } else { "" };
    format!("{borrowed}{}", rusty(&format!("{value:?}")))
}

/// Entries `(enum, names of variants, text after the name)`. The text is empty, `(` or ` {`.
const VARIANTS: &[(&str, &str, &str)] = &[
    ("BodyKind", "Static Kinematic Dynamic", ""),
    ("Sleeping", "On Off", ""),
    ("Quality", "Fast Balanced Exact", ""),
    ("Sensing", "Solid Sensor", ""),
    ("ContactRule", "Push Ghost", ""),
    ("ContactRule", "OneWay Yields", "("),
    ("ContactRule", "Modified", " {"),
    ("Combine", "Average GeometricMean Minimum Multiply Maximum", ""),
    ("Shape", "HalfSpace", ""),
    ("Shape", "Box Sphere Capsule TaperedCapsule Cylinder Cone", " {"),
    ("JointKind", "Fixed", ""),
    ("JointKind", "Ball Hinge Universal Slider Distance", " {"),
    ("JointKind", "SixDof", "("),
    ("AxisMotion", "Locked Free", ""),
    ("AxisMotion", "Limited", "("),
    ("Softness", "Stiffness Frequency", " {"),
    ("Gains", "Velocity", ""),
    ("Gains", "Position", "("),
    ("MassUpdate", "FromShapes Keep", ""),
    ("FieldKind", "Uniform Point Mutual Wind Drag Buoyancy", "("),
    ("FieldKind", "Custom", " {"),
    ("Region", "Everywhere", ""),
    ("Region", "Inside", " {"),
    ("particles::SpringScheme", "Explicit Implicit Projected", ""),
    ("particles::AttachmentTarget", "Body World", " {"),
    ("particles::AttachmentTarget", "World", "("),
    ("particles::Resists", "Both Stretch", ""),
];

/// Entries `(field, enum)` for enums whose variants share their names with variants of other enums.
const FIELDS: &[(&str, &str)] = &[
    ("state", "JointState"),
    ("collision", "JointCollision"),
    ("fade", "Fade"),
    ("occlusion", "Occlusion"),
    ("frame", "ForceFrame"),
];

/// Names of the fields that are vectors, not arrays.
const LISTS: &str =
    " shapes particles springs bends tethers volumes triangles faces attachments backstops passes ";

/// Converts the output of `Debug` to Rust code.
pub fn rusty(text: &str) -> String {
    let mut out = String::new();
    let (mut rest, mut field) = (text, "");
    while let Some(first) = rest.chars().next() {
        let is_word = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if first.is_ascii_digit() {
            let number = |c: char| !(is_word(c) || c == '.' || c == '-');
            let end = rest.find(number).unwrap_or(rest.len());
            out += &rest[..end];
            rest = &rest[end..];
        } else if is_word(first) {
            let end = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
            let word = &rest[..end];
            rest = &rest[end..];
            if rest.starts_with(": ") {
                field = word;
                out += word;
                if LISTS.contains(&format!(" {word} "))
                    && rest.starts_with(": [")
                    && !(word == "particles" && rest[3..].starts_with(|c: char| c.is_ascii_digit()))
                {
                    out += ": vec![";
                    rest = &rest[3..];
                }
            } else if word == "ForceId" && rest.starts_with(" {") {
                let end = rest.find('}').map_or(rest.len(), |end| end + 1);
                let number = |c: char| c.is_ascii_digit() || c == 'v';
                let id: Vec<&str> = rest[2..end].split(|c| !number(c)).filter(|part| is_id(part)).collect();
                out += &format!("force_{}", id.join("_"));
                rest = &rest[end..];
            } else if let Some(kind) = word.strip_suffix("Id").filter(|_| rest.starts_with(' ')) {
                let end = rest[1..].find(|c| !is_word(c)).map_or(rest.len(), |end| end + 1);
                let id = &rest[1..end];
                if id.starts_with('{') || id.is_empty() {
                    out += word;
                } else {
                    out += &format!("{}_{id}", kind.to_lowercase());
                    rest = &rest[end..];
                }
            } else {
                out += &name(word, field, rest);
            }
        } else {
            out.push(first);
            rest = &rest[first.len_utf8()..];
        }
    }
    out
}

fn is_id(part: &str) -> bool {
    part.starts_with(|c: char| c.is_ascii_digit())
}

/// Returns the code for a word that is neither a field nor a number.
fn name(word: &str, field: &str, rest: &str) -> String {
    match word {
        "Vec3" => return "Vec3::new".to_owned(),
        "inf" => return "f32::INFINITY".to_owned(),
        "NaN" => return "f32::NAN".to_owned(),
        _ => {}
    }
    let of_field = FIELDS.iter().find(|(of, _)| *of == field && !rest.starts_with([':', '(']));
    if let Some((_, kind)) = of_field.filter(|_| word != "Some") {
        return format!("{kind}::{word}");
    }
    let follows = |what: &str| match what {
        "" => !rest.starts_with('(') && !rest.starts_with(" {"),
        what => rest.starts_with(what),
    };
    let variant = VARIANTS
        .iter()
        .find(|(_, words, what)| follows(what) && words.split(' ').any(|variant| variant == word));
    variant.map_or_else(|| word.to_owned(), |(kind, ..)| format!("{kind}::{word}"))
}

/// Returns a shape as a call of its constructor.
fn shape(shape: &Shape) -> String {
    match shape {
        Shape::Hull(hull) => format!("Shape::hull(&{}).expect(\"a hull\")", hull.vertices().code()),
        shape => shape.code(),
    }
}

/// Returns the fields whose values differ from the default, as `name: value, `.
macro_rules! changed {
    ($value:expr, $default:expr, $($field:ident),*) => {{
        let mut text = String::new();
        $(if $value.$field != $default.$field {
            text += &format!("{}: {}, ", stringify!($field), rusty(&format!("{}: {:?}", stringify!($field), $value.$field)).split_once(": ").expect("a field").1);
        })*
        text
    }};
}

pub fn shape_def(def: &ShapeDef) -> String {
    let plain = ShapeDef::new(def.shape.clone());
    let fields = changed!(def, plain, body_from_shape, density, material, filter, sensing, rule);
    let plain = format!("ShapeDef::new({})", shape(&def.shape));
    if fields.is_empty() { plain } else { format!("ShapeDef {{ {fields}..{plain} }}") }
}

pub fn body_def(def: &BodyDef) -> String {
    let plain = BodyDef::default();
    let fields = changed!(
        def,
        plain,
        kind,
        position,
        rotation,
        linear_velocity,
        angular_velocity,
        linear_damping,
        angular_damping,
        gravity_scale,
        mass,
        sleeping,
        quality,
        user_data
    );
    let shapes: Vec<String> = def.shapes.iter().map(shape_def).collect();
    format!("BodyDef {{ {fields}shapes: vec![{}], ..BodyDef::default() }}", shapes.join(", "))
}

pub fn joint_def(def: &JointDef) -> String {
    let plain = JointDef::between(def.body_a, def.body_b, def.frame_a, def.frame_b, def.kind);
    let fields = changed!(
        def,
        plain,
        weld,
        limit_softness,
        soft_zone,
        spring,
        motor,
        friction_torque,
        strength,
        collision,
        state
    );
    let ends = format!("{}, {}", def.body_a.code(), def.body_b.code());
    let frames = format!("{}, {}", def.frame_a.code(), def.frame_b.code());
    let plain = format!("JointDef::between({ends}, {frames}, {})", def.kind.code());
    if fields.is_empty() { plain } else { format!("JointDef {{ {fields}..{plain} }}") }
}

pub fn world_def(def: &WorldDef) -> String {
    let plain = WorldDef::default();
    let fields = changed!(
        def,
        plain,
        gravity,
        step_nanoseconds,
        substeps,
        quality,
        catch_up_steps,
        sleeping,
        max_speed,
        max_turn,
        hit_speed
    );
    format!("WorldDef {{ {fields}..WorldDef::default() }}")
}
