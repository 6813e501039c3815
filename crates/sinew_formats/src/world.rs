//! World files, version 1: a level or a set-up of bodies, written by hand or by `sinew boxes`. The reference is
//! `docs/world.md`.
//!
//! ```json
//! {
//!   "sinew": "world",
//!   "version": 1,
//!   "materials": { "ice": { "friction": 0.05 } },
//!   "bodies": [
//!     { "name": "ground", "shapes": [{ "type": "half_space" }] },
//!     {
//!       "name": "ramp",
//!       "position": [0, 1, 2],
//!       "rotation": { "axis": [1, 0, 0], "degrees": 20 },
//!       "shapes": [{ "type": "box", "half_extents": [1, 0.1, 2], "material": "ice" }]
//!     },
//!     {
//!       "name": "dumb-bell",
//!       "kind": "dynamic",
//!       "position": [0, 3, 2],
//!       "linear_velocity": [0, 0, -1],
//!       "shapes": [
//!         { "type": "capsule", "half_height": 0.3, "radius": 0.02, "density": 7800 },
//!         { "type": "sphere", "radius": 0.1, "position": [0, 0.3, 0], "material": { "restitution": 0.4 } },
//!         { "type": "sphere", "radius": 0.1, "position": [0, -0.3, 0] }
//!       ]
//!     }
//!   ]
//! }
//! ```
//!
//! Metres, kilograms, seconds, +Y up. A **body** requires only `shapes`:
//! - `kind`: `static` (default), `kinematic` or `dynamic`; `name` is a comment for people.
//! - `position` (default the origin), `rotation`: a unit quaternion `[x, y, z, w]` or `{ "axis", "degrees" }`.
//! - `linear_velocity` (m/s), `angular_velocity` (rad/s), `linear_damping`, `angular_damping` (1/s), all 0 by default;
//!   `gravity_scale`, default 1; `sleeping`, whether it may, default true; `quality`: `fast`, `balanced` or
//!   `exact`, default the world's; `user_data`, a whole number.
//! - `mass`: `{ "kg", "center", "inertia": [xx, yy, zz, yz, xz, xy] }`; without it from the shapes' densities.
//!
//! A **shape** has a `type`: `box` with `half_extents`, `sphere` with `radius`, `capsule` with `half_height` (of the
//! segment along y, without the caps) and `radius`, or `half_space`, everything below y = 0, for static bodies. A `mesh` has
//! `vertices` (a list of `[x, y, z]`) and `triangles` (a list of three indices each, counter-clockwise seen from outside); a
//! `height_field` has `columns` and `rows` of vertices, `spacing` `[x, z]`, `heights`, row after row, and `holes`, cells by
//! `column + row × (columns − 1)`. Both are surfaces without a mass of their own. Also a
//! `position` and `rotation` in the body's frame, a `density` (kg/m³, default 1000), a `material` and a `filter`
//! `{ "layers", "mask", "group" }`. With `"sensor": true` it reports overlaps and does not push. `contacts` is `"push"`
//! (default), `"ghost"`, or `{ "one_way": { "direction", "tolerance" } }`.
//!
//! A **material** is the name of an entry of `materials`, or such an entry itself: `friction` (default 0.6),
//! `static_friction` (default the same), `restitution` (0..=1, default 0), `rolling` (metres, default 0), `surface_velocity`
//! (m/s) and `surface_spin` (rad/s) in the shape's frame, `tag`, a whole number, and `combine`, the rules for
//! `friction`, `restitution` and `rolling`: `average`, `geometric_mean`, `minimum`, `multiply`, `maximum`.
//!
//! A key that is not listed here is an error, so that a typing error is not ignored silently.
//!
//! ```
//! use sinew_formats::{read_world, write_world};
//! use sinew_physics::{BodyDef, Shape};
//!
//! let bodies = [BodyDef::fixed(Shape::HalfSpace), BodyDef::dynamic(Shape::sphere(0.5))];
//! assert_eq!(read_world(write_world(&bodies).as_bytes())?, bodies); // to the last bit
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use crate::container::json::{self, At, number, numbers};
use crate::error::Result;
use crate::material::{read_filter, read_material, read_rule, write_material, write_rule};
use crate::parts::{self, POSE_KEYS, SHAPE_KEYS};
use serde_json::{Map, Value, json};
use sinew_math::{Transform, Vec3};
use sinew_physics::{BodyDef, BodyKind, Filter, Quality, Sensing, Shape, ShapeDef, Sleeping};

const VERSION: usize = 1;

const BODY_KEYS: [&str; 13] = [
    "name",
    "kind",
    "linear_velocity",
    "angular_velocity",
    "linear_damping",
    "angular_damping",
    "gravity_scale",
    "sleeping",
    "quality",
    "user_data",
    "mass",
    "shapes",
    "comment",
];

const SURFACE_KEYS: [&str; 6] = ["density", "material", "filter", "sensor", "contacts", "comment"];

/// Reads the bodies of a world file, in file order.
///
/// # Errors
/// Returns an error that names the location, such as `bodies[3].shapes[0].half_extents[1]`: sizes that are not
/// positive, non-finite numbers, unknown keys, types and materials, a half-space on a moving body, a later version.
pub fn read_world(bytes: &[u8]) -> Result<Vec<BodyDef>> {
    let value = json::parse(bytes)?;
    let root = At::root(&value);
    json::check_header(root, "world", VERSION)?;
    root.only(&["sinew", "version", "comment", "materials", "bodies"])?;
    let materials = root.get("materials")?;
    root.need("bodies")?.items()?.into_iter().map(|at| read_body(at, materials)).collect()
}

fn read_body(at: At<'_>, materials: Option<At<'_>>) -> Result<BodyDef> {
    at.only(&[&BODY_KEYS[..], &POSE_KEYS].concat())?;
    let kind = match at.get("kind")? {
        None => BodyKind::Static,
        Some(kind) => match kind.str()? {
            "static" => BodyKind::Static,
            "kinematic" => BodyKind::Kinematic,
            "dynamic" => BodyKind::Dynamic,
            _ => return Err(kind.malformed("must be static, kinematic or dynamic")),
        },
    };
    let mut shapes = Vec::new();
    for shape_at in at.need("shapes")?.items()? {
        let shape = read_shape(shape_at, materials)?;
        if shape.shape == Shape::HalfSpace && kind != BodyKind::Static {
            return Err(shape_at.malformed("only a static body can be a half_space"));
        }
        shapes.push(shape);
    }
    let mass = at.get("mass")?.map(parts::read_mass).transpose()?;
    if kind == BodyKind::Dynamic
        && mass.is_none()
        && !shapes.iter().any(|s| s.density > 0.0 && s.shape.is_solid())
    {
        return Err(at.malformed("a dynamic body needs a mass, or a solid shape with a density above 0"));
    }
    let pose = parts::read_pose(at)?;
    Ok(BodyDef {
        kind,
        position: pose.translation,
        rotation: pose.rotation,
        linear_velocity: parts::read_vector(at, "linear_velocity")?,
        angular_velocity: parts::read_vector(at, "angular_velocity")?,
        linear_damping: at.get("linear_damping")?.map_or(Ok(0.0), At::not_negative)?,
        angular_damping: at.get("angular_damping")?.map_or(Ok(0.0), At::not_negative)?,
        gravity_scale: at.get("gravity_scale")?.map_or(Ok(1.0), At::f32)?,
        shapes,
        mass,
        sleeping: match at.get("sleeping")?.map(At::bool).transpose()? {
            Some(false) => Sleeping::Off,
            Some(true) | None => Sleeping::On,
        },
        quality: at.get("quality")?.map(read_quality).transpose()?,
        user_data: at.get("user_data")?.map_or(Ok(0), At::u64)?,
    })
}

/// Words for the qualities in files.
const QUALITIES: [(&str, Quality); 3] =
    [("fast", Quality::Fast), ("balanced", Quality::Balanced), ("exact", Quality::Exact)];

fn read_quality(at: At<'_>) -> Result<Quality> {
    let word = at.str()?;
    let found = QUALITIES.iter().find(|(name, _)| *name == word);
    found.map(|&(_, quality)| quality).ok_or_else(|| at.malformed("must be fast, balanced or exact"))
}

fn read_shape(at: At<'_>, materials: Option<At<'_>>) -> Result<ShapeDef> {
    at.only(&[&SHAPE_KEYS[..], &POSE_KEYS, &SURFACE_KEYS].concat())?;
    let default = ShapeDef::new(parts::read_shape(at)?);
    Ok(ShapeDef {
        body_from_shape: parts::read_pose(at)?,
        density: at.get("density")?.map_or(Ok(default.density), At::not_negative)?,
        material: match at.get("material")? {
            Some(material) => read_material(material, materials)?,
            None => default.material,
        },
        filter: at.get("filter")?.map_or(Ok(default.filter), read_filter)?,
        sensing: match at.get("sensor")?.map_or(Ok(false), At::bool)? {
            true => Sensing::Sensor,
            false => Sensing::Solid,
        },
        rule: at.get("contacts")?.map_or(Ok(default.rule), read_rule)?,
        ..default
    })
}

/// Returns the text of a world file with these bodies, without default values. It reads back as equal bodies.
///
/// # Panics
/// If a number is not finite, or a shape has a modifier, because a file cannot store functions.
pub fn write_world(bodies: &[BodyDef]) -> String {
    let bodies: Vec<Value> = bodies.iter().map(write_body).collect();
    json::to_text(&json!({"sinew": "world", "version": VERSION, "bodies": bodies}))
}

fn write_body(body: &BodyDef) -> Value {
    let mut object = Map::new();
    let kind = match body.kind {
        BodyKind::Static => "static",
        BodyKind::Kinematic => "kinematic",
        BodyKind::Dynamic => "dynamic",
    };
    object.insert("kind".into(), kind.into());
    parts::write_pose(Transform::new(body.position, body.rotation), &mut object);
    for (key, vector) in
        [("linear_velocity", body.linear_velocity), ("angular_velocity", body.angular_velocity)]
    {
        if vector != Vec3::ZERO {
            object.insert(key.into(), numbers(&vector.to_array()));
        }
    }
    put(&mut object, "linear_damping", body.linear_damping, 0.0);
    put(&mut object, "angular_damping", body.angular_damping, 0.0);
    put(&mut object, "gravity_scale", body.gravity_scale, 1.0);
    if body.sleeping == Sleeping::Off {
        object.insert("sleeping".into(), false.into());
    }
    if let Some((name, _)) = QUALITIES.iter().find(|(_, quality)| Some(*quality) == body.quality) {
        object.insert("quality".into(), (*name).into());
    }
    if body.user_data != 0 {
        object.insert("user_data".into(), body.user_data.into());
    }
    if let Some(mass) = &body.mass {
        object.insert("mass".into(), parts::write_mass(mass));
    }
    object.insert("shapes".into(), body.shapes.iter().map(write_shape).collect());
    object.into()
}

fn write_shape(def: &ShapeDef) -> Value {
    let mut object = Map::new();
    let default = ShapeDef::new(def.shape.clone());
    parts::write_shape(&def.shape, &mut object);
    parts::write_pose(def.body_from_shape, &mut object);
    put(&mut object, "density", def.density, default.density);
    if def.material != default.material {
        object.insert("material".into(), write_material(&def.material));
    }
    if def.filter != default.filter {
        let Filter { layers, mask, group } = def.filter;
        object.insert("filter".into(), json!({"layers": layers, "mask": mask, "group": group}));
    }
    if def.sensing == Sensing::Sensor {
        object.insert("sensor".into(), true.into());
    }
    if let Some(rule) = write_rule(def.rule) {
        object.insert("contacts".into(), rule);
    }
    object.into()
}

/// Writes a number unless it is the default.
fn put(object: &mut Map<String, Value>, key: &str, x: f32, default: f32) {
    if x.to_bits() != default.to_bits() {
        object.insert(key.into(), number(x));
    }
}
