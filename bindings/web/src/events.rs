//! Events of steps, kept until JavaScript reads them.

use crate::values::{object, vector};
use js_sys::Array;
use sinew::math::Vec3;
use sinew::physics::{BodyId, JointId, World};
use sinew::ragdoll::{Character, CharacterEvent};
use wasm_bindgen::JsValue;

/// An event of a step.
pub enum Told {
    /// Two bodies began or stopped touching, or one entered or left a sensor.
    Pair(&'static str, BodyId, BodyId),
    /// Two bodies hit each other at high speed.
    Hit { bodies: [BodyId; 2], point: Vec3, normal: Vec3, speed: f32, impulse: f32 },
    /// A joint broke.
    Broken(JointId),
    /// The state of a body became non-finite, so it was removed from the simulation.
    Quarantined(BodyId),
    /// An event of a character, by its index in the world, with name and payload of a clip event.
    Character(usize, CharacterEvent, Option<Box<(String, String)>>),
}

/// Adds the events of the last step of a world.
pub fn of_world(world: &World, told: &mut Vec<Told>) {
    let events = world.events();
    for (name, pairs) in [
        ("begin", &events.begin),
        ("end", &events.end),
        ("sensorBegin", &events.sensor_begin),
        ("sensorEnd", &events.sensor_end),
    ] {
        told.extend(pairs.iter().map(|&(a, b)| Told::Pair(name, a, b)));
    }
    told.extend(events.hits.iter().map(|hit| Told::Hit {
        bodies: [hit.a.body, hit.b.body],
        point: hit.point,
        normal: hit.normal,
        speed: hit.approach,
        impulse: hit.impulse,
    }));
    told.extend(events.broken.iter().map(|&joint| Told::Broken(joint)));
    told.extend(events.quarantined.iter().map(|&body| Told::Quarantined(body)));
}

/// Adds the events of a character's last update.
pub fn of_character(index: usize, character: &Character, told: &mut Vec<Told>) {
    let set = character.def().set();
    told.extend(character.events().iter().map(|&event| {
        let named = match event {
            CharacterEvent::Clip(fired) => {
                let event = set.event(&fired);
                Some(Box::new((event.name.clone(), event.payload.clone())))
            }
            _ => None,
        };
        Told::Character(index, event, named)
    }));
}

/// Converts the events to objects.
pub fn to_js(told: &[Told], characters: impl Fn(usize) -> Option<Vec<String>>) -> Array {
    told.iter().map(|told| one(told, &characters)).collect()
}

fn bits(id: BodyId) -> JsValue {
    id.to_bits().into()
}

fn one(told: &Told, roles: &impl Fn(usize) -> Option<Vec<String>>) -> JsValue {
    match *told {
        Told::Pair(name, a, b) => object([("type", name.into()), ("a", bits(a)), ("b", bits(b))]),
        Told::Hit { bodies: [a, b], point, normal, speed, impulse } => object([
            ("type", "hit".into()),
            ("a", bits(a)),
            ("b", bits(b)),
            ("point", vector(point)),
            ("normal", vector(normal)),
            ("speed", speed.into()),
            ("impulse", impulse.into()),
        ]),
        Told::Broken(joint) => object([("type", "broken".into()), ("joint", joint.to_bits().into())]),
        Told::Quarantined(body) => object([("type", "quarantined".into()), ("body", bits(body))]),
        Told::Character(index, event, ref named) => {
            let roles = roles(index).unwrap_or_default();
            let role = |body: usize| roles.get(body).map_or(JsValue::UNDEFINED, |role| role.into());
            let object = of_event(event, named.as_deref(), role);
            _ = js_sys::Reflect::set(&object, &"character".into(), &(index as u32).into());
            object
        }
    }
}

fn of_event(
    event: CharacterEvent,
    named: Option<&(String, String)>,
    role: impl Fn(usize) -> JsValue,
) -> JsValue {
    use CharacterEvent as E;
    let plain = |name: &str| object([("type", name.into())]);
    let at = |name: &str, body: usize| object([("type", name.into()), ("bone", role(body))]);
    match event {
        E::Hit { body } => at("pushed", body),
        E::Struck { body, impulse } => {
            object([("type", "struck".into()), ("bone", role(body)), ("impulse", impulse.into())])
        }
        E::Flinched { body } => at("flinched", body),
        E::Recovered => plain("recovered"),
        E::Powered => plain("powered"),
        E::Clip(_) => {
            let (name, payload) = named.cloned().unwrap_or_default();
            object([("type", "clip".into()), ("name", name.into()), ("payload", payload.into())])
        }
        E::Contact { body, other, begins } => {
            let name = if begins { "touch" } else { "part" };
            object([("type", name.into()), ("bone", role(body)), ("other", bits(other))])
        }
        E::LetGo { body, held } => {
            object([("type", "letGo".into()), ("bone", role(body)), ("held", bits(held))])
        }
        E::Stumbled => plain("stumbled"),
        E::Caught { steps } => object([("type", "caught".into()), ("steps", steps.into())]),
        E::Detached { body } => at("detached", body),
        E::WentLimp => plain("limp"),
        E::Touched => plain("landed"),
        E::Settled { since } => object([("type", "settled".into()), ("since", since.into())]),
        E::NeverSettled => plain("neverSettled"),
        E::Preparing { rolls } => object([("type", "preparing".into()), ("rolls", rolls.into())]),
        E::GettingUp { .. } => plain("gettingUp"),
        E::Up => plain("up"),
    }
}
