//! Notes of a bake: what did not happen, and why.

use sinew::math::Vec3;
use sinew::physics::ray::Ray;
use sinew::physics::{BodyKinds, QueryFilter, World, WorldDef};
use sinew::ragdoll::{AfterSettling, BakeInput, Event};

/// Depth to which the ground is sought, metres.
const DEPTH: f32 = 1000.0;
/// Ground that is lower than this below the soles is no ground to stand on, metres.
const GAP: f32 = 0.3;

/// All of it, a sentence each; `world` names the file that the bodies come from.
pub fn of_bake(input: &BakeInput<'_>, events: &[(f32, Event)], world: Option<&str>) -> Vec<String> {
    [late(input), ground(input, world), stays_down(input, events)].into_iter().flatten().collect()
}

/// A fall that begins when the clip has ended.
fn late(input: &BakeInput<'_>) -> Option<String> {
    let time = input.limp_at.filter(|time| *time >= input.seconds)?;
    let end = input.seconds;
    Some(format!("--limp-at {time} s is not before the end, at {end} s (--seconds): it does not go limp"))
}

/// No ground under where the character stands, or none near.
fn ground(input: &BakeInput<'_>, file: Option<&str>) -> Option<String> {
    let file = file?;
    let mut world = World::new(WorldDef::default());
    for body in input.bodies {
        world.add_body(body);
    }
    let soles = input.world_from_character.translation;
    let height = input.character.ragdoll.height;
    let ray = Ray { origin: soles + Vec3::Y * (0.5 * height), direction: Vec3::Y * -DEPTH };
    let down = world.query().filter(QueryFilter::of(BodyKinds::STATIC)).first(&ray);
    match down {
        None => Some(format!(
            "{file} has no ground under the character, which stands at the origin: it falls without end"
        )),
        Some(hit) if hit.start.is_none() && soles.y - hit.point.y > GAP => Some(format!(
            "the ground of {file} is {:.2} m below the character, which stands at the origin",
            soles.y - hit.point.y
        )),
        Some(_) => None,
    }
}

/// Why a character that fell is not up again at the end.
fn stays_down(input: &BakeInput<'_>, events: &[(f32, Event)]) -> Option<String> {
    let last = |wanted: fn(&Event) -> bool| events.iter().rposition(|(_, event)| wanted(event));
    let fell = last(|event| matches!(event, Event::WentLimp | Event::Hit { .. }))?;
    let since = &events[fell..];
    let has = |wanted: fn(&Event) -> bool| since.iter().any(|(_, event)| wanted(event));
    if has(|event| matches!(event, Event::Up)) {
        return None;
    }
    let end = input.seconds;
    let touched = events.iter().any(|(_, event)| matches!(event, Event::Touched));
    let why = if !touched {
        format!("it touches nothing until the end, at {end} s")
    } else if input.character.after_settling == AfterSettling::StayDown {
        "no clip gets it up: name a file with one by --clips, called such as 'get up'".to_owned()
    } else if has(|event| matches!(event, Event::GettingUp { .. })) {
        format!("it is on its way up at the end, at {end} s: --seconds gives it more time")
    } else if has(|event| matches!(event, Event::Settled { .. } | Event::Preparing { .. })) {
        format!("it lies still, but the end comes first, at {end} s: --seconds gives it more time")
    } else {
        format!("it does not lie still before the end, at {end} s: --seconds gives it more time")
    };
    Some(format!("it does not get up: {why}"))
}
