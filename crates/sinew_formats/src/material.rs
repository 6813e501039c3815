//! Properties of shapes in a world file in addition to geometry: materials, filters, contact rules.

use crate::container::json::{At, number, numbers};
use crate::error::{Result, quoted};
use crate::parts;
use serde_json::{Map, Value, json};
use sinew_math::Vec3;
use sinew_physics::{Combine, CombineRules, ContactRule, Filter, Material, OneWay, Yields};

pub(crate) const MATERIAL_KEYS: [&str; 9] = [
    "friction",
    "static_friction",
    "restitution",
    "rolling",
    "surface_velocity",
    "surface_spin",
    "combine",
    "tag",
    "comment",
];

const RULES: [(&str, Combine); 5] = [
    ("average", Combine::Average),
    ("geometric_mean", Combine::GeometricMean),
    ("minimum", Combine::Minimum),
    ("multiply", Combine::Multiply),
    ("maximum", Combine::Maximum),
];

/// Reads a material, given as an object or by name.
pub(crate) fn read_material(at: At<'_>, materials: Option<At<'_>>) -> Result<Material> {
    let at = match at.value().as_str() {
        None => at,
        Some(name) => {
            let named = materials.map(|m| m.get(name)).transpose()?.flatten();
            named.ok_or_else(|| at.malformed(format!("there is no material {}", quoted(name))))?
        }
    };
    at.only(&MATERIAL_KEYS)?;
    let default = Material::DEFAULT;
    let friction = at.get("friction")?.map_or(Ok(default.friction), At::not_negative)?;
    Ok(Material {
        friction,
        static_friction: at
            .get("static_friction")?
            .map(|at| read_static_friction(at, friction))
            .transpose()?,
        restitution: at.get("restitution")?.map_or(Ok(default.restitution), read_restitution)?,
        rolling: at.get("rolling")?.map_or(Ok(default.rolling), At::not_negative)?,
        surface_velocity: parts::read_vector(at, "surface_velocity")?,
        surface_spin: parts::read_vector(at, "surface_spin")?,
        combine: at.get("combine")?.map_or(Ok(default.combine), read_rules)?,
        tag: at.get("tag")?.map_or(Ok(default.tag), read_bits)?,
    })
}

fn read_static_friction(at: At<'_>, friction: f32) -> Result<f32> {
    let hold = at.not_negative()?;
    if hold < friction { Err(at.malformed("must not be less than `friction`")) } else { Ok(hold) }
}

fn read_restitution(at: At<'_>) -> Result<f32> {
    let restitution = at.not_negative()?;
    if restitution > 1.0 { Err(at.malformed("must not be more than 1")) } else { Ok(restitution) }
}

fn read_rules(at: At<'_>) -> Result<CombineRules> {
    at.only(&["friction", "restitution", "rolling"])?;
    let rule = |key: &str| -> Result<Option<Combine>> {
        let Some(at) = at.get(key)? else { return Ok(None) };
        let name = at.str()?;
        let known = RULES.iter().find(|(known, _)| *known == name);
        let known = known.ok_or_else(|| {
            let names = RULES.map(|(name, _)| name).join(", ");
            at.malformed(format!("unknown rule {}; known are {names}", quoted(name)))
        })?;
        Ok(Some(known.1))
    };
    Ok(CombineRules {
        friction: rule("friction")?,
        restitution: rule("restitution")?,
        rolling: rule("rolling")?,
    })
}

fn read_bits(at: At<'_>) -> Result<u32> {
    u32::try_from(at.usize()?).map_err(|_| at.malformed("must fit 32 bits"))
}

/// Converts a material to JSON, without default values.
pub(crate) fn write_material(material: &Material) -> Value {
    let default = Material::DEFAULT;
    let mut object = Map::new();
    for (key, x, default) in [
        ("friction", material.friction, default.friction),
        ("restitution", material.restitution, default.restitution),
        ("rolling", material.rolling, default.rolling),
    ] {
        if x.to_bits() != default.to_bits() {
            object.insert(key.into(), number(x));
        }
    }
    if let Some(hold) = material.static_friction {
        object.insert("static_friction".into(), number(hold));
    }
    for (key, vector) in
        [("surface_velocity", material.surface_velocity), ("surface_spin", material.surface_spin)]
    {
        if vector != Vec3::ZERO {
            object.insert(key.into(), numbers(&vector.to_array()));
        }
    }
    if material.combine != default.combine {
        object.insert("combine".into(), write_rules(material.combine));
    }
    if material.tag != default.tag {
        object.insert("tag".into(), material.tag.into());
    }
    object.into()
}

fn write_rules(rules: CombineRules) -> Value {
    let mut object = Map::new();
    let CombineRules { friction, restitution, rolling } = rules;
    for (key, rule) in [("friction", friction), ("restitution", restitution), ("rolling", rolling)] {
        if let Some((name, _)) = RULES.iter().find(|(_, known)| rule == Some(*known)) {
            object.insert(key.into(), (*name).into());
        }
    }
    object.into()
}

pub(crate) fn read_filter(at: At<'_>) -> Result<Filter> {
    at.only(&["layers", "mask", "group"])?;
    let default = Filter::default();
    let bits = |key: &str, default: u32| at.get(key)?.map_or(Ok(default), read_bits);
    let group = match at.get("group")? {
        None => default.group,
        Some(at) => {
            let whole = at.value().as_i64().and_then(|n| i32::try_from(n).ok());
            whole.ok_or_else(|| at.malformed("must be a whole number of 32 bits"))?
        }
    };
    Ok(Filter { layers: bits("layers", default.layers)?, mask: bits("mask", default.mask)?, group })
}

/// Reads a contact rule: `"push"`, `"ghost"`, `{ "one_way": … }`, or `{ "yields": … }`.
pub(crate) fn read_rule(at: At<'_>) -> Result<ContactRule> {
    match at.value().as_str() {
        Some("push") => return Ok(ContactRule::Push),
        Some("ghost") => return Ok(ContactRule::Ghost),
        Some(_) => return Err(at.malformed("must be push, ghost, or an object with `one_way` or `yields`")),
        None => {}
    }
    at.only(&["one_way", "yields"])?;
    if let Some(at) = at.get("yields")? {
        at.only(&["max_force", "max_impulse"])?;
        let default = Yields::default();
        let number = |key: &str, default| at.get(key)?.map_or(Ok(default), At::not_negative);
        return Ok(ContactRule::Yields(Yields {
            max_force: number("max_force", default.max_force)?,
            max_impulse: number("max_impulse", default.max_impulse)?,
        }));
    }
    let at = at.need("one_way")?;
    at.only(&["direction", "tolerance"])?;
    let default = OneWay::default();
    let direction = at.numbers_or("direction", default.direction.to_array())?;
    let tolerance = at.get("tolerance")?.map_or(Ok(default.tolerance), At::not_negative)?;
    let rule = ContactRule::OneWay(OneWay { direction: Vec3::from_array(direction), tolerance });
    rule.check().map_err(|error| at.malformed(error.what()))?;
    Ok(rule)
}

/// Converts a contact rule to JSON; `None` for the default.
///
/// # Panics
/// If the rule has a modifier, because a file cannot store functions.
pub(crate) fn write_rule(rule: ContactRule) -> Option<Value> {
    match rule {
        ContactRule::Push => None,
        ContactRule::Ghost => Some("ghost".into()),
        ContactRule::OneWay(OneWay { direction, tolerance }) => Some(json!({
            "one_way": { "direction": numbers(&direction.to_array()), "tolerance": number(tolerance) }
        })),
        ContactRule::Yields(Yields { max_force, max_impulse }) => Some(json!({
            "yields": { "max_force": number(max_force), "max_impulse": number(max_impulse) }
        })),
        ContactRule::Modified { .. } => panic!("a world file does not hold functions"),
    }
}
