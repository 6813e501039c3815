//! Geoms: shapes of a body, with their part of its mass.

use super::compiler::{Compiler, ORIENTATIONS, y_up};
use super::defaults::Merged;
use super::notes::Notes;
use super::xml::{Value, malformed};
use crate::error::{Result, quoted};
use sinew_math::{Rotation, Transform, Vec3};
use sinew_physics::{Filter, MassProperties, Material, Shape, ShapeDef};

/// A geom in the frame of its body.
pub(super) struct Geom {
    /// Shape; `None` for a visual geom of an unsupported type.
    pub shape: Option<ShapeDef>,
    /// Mass; `None` if unknown.
    pub mass: Option<MassProperties>,
}

/// Segment along which a geom is placed.
struct Segment {
    body_from_shape: Transform,
    half_length: f32,
}

const UNREAD: [&str; 5] = ["solimp", "margin", "gap", "priority", "solmix"];

/// Motions that friction resists, by `condim`, as far as they are supported.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Resists {
    Sliding,
    /// Also rolling: the third number of `friction` counts.
    Rolling,
    Other,
}

const CONDIM: [(&str, Resists); 4] =
    [("1", Resists::Other), ("3", Resists::Sliding), ("4", Resists::Other), ("6", Resists::Rolling)];

impl Geom {
    /// Reads a geom from an element and the defaults of its class.
    pub fn read(geom: &Merged<'_, '_>, compiler: &Compiler, notes: &mut Notes) -> Result<Self> {
        for key in UNREAD.into_iter().filter(|key| geom.get(key).is_some()) {
            notes.left_out(key);
        }
        if let Some(value) = geom.get("shellinertia").filter(|value| value.text() != "false") {
            return Err(value.unsupported("mass is that of solid shapes only"));
        }
        let kind = geom.get("type").map_or("sphere", Value::text);
        let filter = read_filter(geom)?;
        if !matches!(kind, "plane" | "sphere" | "capsule" | "cylinder" | "box") {
            let at = |value: Value<'_>| value.unsupported(format!("{} is not read", quoted(kind)));
            if filter.layers != 0 {
                return Err(geom.get("type").map_or_else(|| malformed(geom.element, "no type"), at));
            }
            notes.left_out("shapes without contacts");
            return Ok(Self { shape: None, mass: None });
        }
        let segment = geom.get("fromto").map(Segment::read).transpose()?;
        if let (Some(value), "plane" | "sphere") = (geom.get("fromto"), kind) {
            return Err(value.malformed(format!("{} has no length", quoted(kind))));
        }
        let shape = read_shape(geom, kind, segment.as_ref())?;
        let body_from_shape = match segment {
            Some(segment) => segment.body_from_shape,
            None => read_pose(geom, compiler)?,
        };
        let density = read_density(geom, &shape)?;
        let material = read_material(geom, notes)?;
        let mass = shape.mass_properties(density).transformed(&body_from_shape);
        let def = ShapeDef { body_from_shape, density, material, filter, ..ShapeDef::new(shape) };
        Ok(Self { shape: Some(def), mass: Some(mass) })
    }
}

impl Segment {
    fn read(value: Value<'_>) -> Result<Self> {
        let [a, b, c, d, e, f] = value.numbers()?;
        let (from, to) = (y_up(Vec3::new(a, b, c)), y_up(Vec3::new(d, e, f)));
        let length = (to - from).length();
        if length < 1e-9 {
            return Err(value.malformed("both ends are the same"));
        }
        let rotation = Rotation::from_arc(Vec3::Y, (to - from) / length);
        let body_from_shape = Transform::new((from + to) * 0.5, rotation);
        Ok(Self { body_from_shape, half_length: 0.5 * length })
    }
}

fn read_pose(geom: &Merged<'_, '_>, compiler: &Compiler) -> Result<Transform> {
    let position = geom.get("pos").map_or(Ok([0.0; 3]), Value::numbers)?;
    let turned = geom.get_one(&ORIENTATIONS)?;
    let rotation = turned.map_or(Ok(Rotation::IDENTITY), |value| compiler.rotation(value))?;
    Ok(Transform::new(y_up(Vec3::from_array(position)), rotation))
}

fn read_shape(geom: &Merged<'_, '_>, kind: &str, segment: Option<&Segment>) -> Result<Shape> {
    if kind == "plane" {
        return Ok(Shape::HalfSpace);
    }
    let size = geom.get("size").ok_or_else(|| malformed(geom.element, "`size` is missing"))?;
    let list = size.list()?;
    let number = |at: usize| {
        list.get(at).copied().ok_or_else(|| size.malformed(format!("takes more than {at} numbers")))
    };
    let along = |at: usize| segment.map_or_else(|| number(at), |segment| Ok(segment.half_length));
    let shape = match kind {
        "sphere" => Shape::Sphere { radius: number(0)? },
        "capsule" => Shape::Capsule { radius: number(0)?, half_height: along(1)? },
        "cylinder" => Shape::Cylinder { radius: number(0)?, half_height: along(1)? },
        // The file's z is our y. A box along a segment is square.
        _ if segment.is_some() => Shape::Box { half_extents: Vec3::new(number(0)?, along(2)?, number(0)?) },
        _ => Shape::Box { half_extents: Vec3::new(number(0)?, number(2)?, number(1)?) },
    };
    shape.check().map_err(|error| size.malformed(error.what()))?;
    Ok(shape)
}

/// Returns the density, kg/m³, computed from the mass if the mass is given.
fn read_density(geom: &Merged<'_, '_>, shape: &Shape) -> Result<f32> {
    let volume = shape.volume();
    match geom.get("mass") {
        Some(mass) if volume > 0.0 => Ok(mass.not_negative()? / volume),
        _ => geom.get("density").map_or(Ok(1000.0), Value::not_negative),
    }
}

/// Reads sliding friction and, if the file enables it, rolling friction; restitution from `solref`.
fn read_material(geom: &Merged<'_, '_>, notes: &mut Notes) -> Result<Material> {
    let friction = geom.get("friction").map_or(Ok(vec![1.0]), Value::list)?;
    if friction.iter().any(|&coefficient| coefficient < 0.0) {
        return Err(malformed(geom.element, "friction must not be negative"));
    }
    let resists = geom.get("condim").map_or(Ok(Resists::Sliding), |value| value.word(&CONDIM))?;
    if resists == Resists::Other {
        notes.left_out("condim");
    }
    let rolling = match resists {
        Resists::Rolling => friction.get(2).copied().unwrap_or(1e-4),
        Resists::Sliding | Resists::Other => 0.0,
    };
    Ok(Material {
        friction: friction.first().copied().unwrap_or(1.0),
        restitution: geom.get("solref").map_or(Ok(0.0), read_restitution)?,
        rolling,
        ..Material::default()
    })
}

/// Computes the restitution of the damped spring that `solref` makes of a contact, over half a period: a point that
/// arrives with 1 m/s leaves with `exp(−πζ/√(1 − ζ²))`, or zero if the damping ratio ζ is 1 or more. Two positive
/// numbers are time constant and ζ; two negative ones are stiffness `k` and damping `b` per mass, with `ζ = b/(2√k)`.
fn read_restitution(solref: Value<'_>) -> Result<f32> {
    let (first, second) = match solref.list()?[..] {
        [] => return Ok(0.0),
        [first] => (first, 1.0),
        [first, second, ..] => (first, second),
    };
    let damping = if first > 0.0 { second } else { -second / (2.0 * (-first).sqrt()) };
    // The comparison is false for NaN, which then gives restitution 0.
    if !(0.0..1.0).contains(&damping) {
        return Ok(0.0);
    }
    let share = damping / (1.0 - damping * damping).sqrt();
    Ok(sinew_math::trig::exp(-core::f32::consts::PI * share))
}

/// Reads the filter. In MuJoCo two geoms collide if either's `contype` shares a bit with the other's `conaffinity`; our
/// two filters must both agree. Each filter therefore has one word in the lower half and the other in the upper half,
/// so that one side tests in one half, and the other in the other half.
fn read_filter(geom: &Merged<'_, '_>) -> Result<Filter> {
    let bits = |key: &str| match geom.get(key) {
        None => Ok(1),
        Some(value) => {
            let bits: Option<u16> = value.text().trim().parse().ok();
            bits.map(u32::from).ok_or_else(|| value.unsupported("takes a whole number from 0 to 65535"))
        }
    };
    let (kind, affinity) = (bits("contype")?, bits("conaffinity")?);
    Ok(Filter { layers: kind | affinity << 16, mask: affinity | kind << 16, group: 0 })
}
