//! Notes of a bake: events that did not happen, and the reasons.

use super::actor::GetsUpBy;
use super::place::Place;
use crate::report::table::shown;
use sinew::math::Vec3;
use sinew::physics::ray::Ray;
use sinew::physics::{BodyKinds, QueryFilter, World, WorldDef};
use sinew::ragdoll::{BakeInput, CharacterEvent};

/// Depth down to which ground is searched, metres.
const DEPTH: f32 = 1000.0;
/// Depth below the soles from which ground no longer counts as standing ground, metres.
const GAP: f32 = 0.3;

/// Returns all notes, one sentence each; `world` names the file of the bodies.
pub fn of_bake(
    input: &BakeInput<'_>,
    events: &[(f32, CharacterEvent)],
    gets_up_by: &GetsUpBy,
    world: Option<&str>,
) -> Vec<String> {
    let all = [
        late(input),
        ground(input, world),
        borrows(events, gets_up_by),
        stays_down(input, events, gets_up_by),
    ];
    all.into_iter().flatten().collect()
}

/// Returns a note on the position of a character that was searched because the user gave none.
pub fn stands_at(place: &Place, world: &str) -> Option<String> {
    let [x, y, z] = place.stands.translation.to_array();
    place.found.then(|| {
        format!(
            "it stands at {x:.2},{y:.2},{z:.2}, the free place nearest the middle of the largest walkable ground of {world}; \
             --at X,Y,Z sets another"
        )
    })
}

/// Returns a note on a push that was not requested.
pub fn is_pushed(input: &BakeInput<'_>) -> String {
    let time = input.limp_at.unwrap_or(0.0);
    format!(
        "limp alone it stays on its feet or kneels: it is pushed over at {time} s, its highest point by {:.1} m/s; --limp-at {time} leaves out the push, \
         --hit sets another",
        input.topple.length()
    )
}

/// Returns a note on motions that do not come from the file.
fn borrows(events: &[(f32, CharacterEvent)], gets_up_by: &GetsUpBy) -> Option<String> {
    let rises = events.iter().any(|(_, event)| matches!(event, CharacterEvent::GettingUp { .. }));
    match gets_up_by {
        GetsUpBy::Builtin if rises => Some(
            "it gets up by built-in motions, because it has no get-up clip: --clips adds some, \
             --no-builtin-motions leaves it lying"
                .to_owned(),
        ),
        GetsUpBy::Reversed(name) if rises => {
            Some(format!("it gets up by '{}' played backwards, because that clip ends lying", shown(name)))
        }
        _ => None,
    }
}

/// Returns a note on a fall that starts after the clip has ended.
fn late(input: &BakeInput<'_>) -> Option<String> {
    let time = input.limp_at.filter(|time| *time >= input.seconds)?;
    let end = input.seconds;
    Some(format!("--limp-at {time} s is not before the end, at {end} s (--seconds): it does not go limp"))
}

/// Returns a note if there is no ground near below the character.
fn ground(input: &BakeInput<'_>, file: Option<&str>) -> Option<String> {
    let mut world = World::new(WorldDef::default());
    for body in input.bodies {
        world.add_body(body);
    }
    let soles = input.world_from_character.translation;
    let height = input.character.ragdoll.height;
    let ray = Ray { origin: soles + Vec3::Y * (0.5 * height), direction: Vec3::Y * -DEPTH };
    let down = world.query().filter(QueryFilter::of(BodyKinds::STATIC)).first(&ray);
    let hit = down.filter(|hit| hit.start.is_none() && soles.y - hit.point.y > GAP)?;
    let ground = file.map_or("the floor".to_owned(), |file| format!("the ground of {file}"));
    Some(format!("{ground} is {:.2} m below the character: it falls once it is limp", soles.y - hit.point.y))
}

/// Returns the reason why a fallen character is not up at the end.
fn stays_down(
    input: &BakeInput<'_>,
    events: &[(f32, CharacterEvent)],
    gets_up_by: &GetsUpBy,
) -> Option<String> {
    let last = |wanted: fn(&CharacterEvent) -> bool| events.iter().rposition(|(_, event)| wanted(event));
    let fell = last(|event| matches!(event, CharacterEvent::WentLimp | CharacterEvent::Hit { .. }))?;
    let since = &events[fell..];
    let has = |wanted: fn(&CharacterEvent) -> bool| since.iter().any(|(_, event)| wanted(event));
    if has(|event| matches!(event, CharacterEvent::Up)) {
        return None;
    }
    let end = input.seconds;
    let touched = events.iter().any(|(_, event)| matches!(event, CharacterEvent::Touched));
    if touched && *gets_up_by == GetsUpBy::Unwanted {
        return None;
    }
    let why = if !touched {
        format!("it touches nothing until the end, at {end} s")
    } else if let GetsUpBy::Nothing(why) | GetsUpBy::Unfit(why) = gets_up_by {
        why.clone()
    } else if has(|event| matches!(event, CharacterEvent::GettingUp { .. })) {
        return Some(format!("it is still getting up at the end, at {end} s: --seconds gives it more time"));
    } else if has(|event| matches!(event, CharacterEvent::Settled { .. } | CharacterEvent::Preparing { .. }))
    {
        format!("it lies still, but the end comes first, at {end} s: --seconds gives it more time")
    } else {
        format!("it does not lie still before the end, at {end} s: --seconds gives it more time")
    };
    Some(format!("it does not get up: {why}"))
}
