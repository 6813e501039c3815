//! What happens to a character, in words.

use sinew::ragdoll::{BakeInput, CharacterDef, Event, Locomotion};

/// What the character is doing from some time on, in a word or two for the corner of a picture.
pub type Phase = (f32, &'static str);

/// Seconds for which a hit is called one.
const HIT_SECONDS: f32 = 0.4;

/// The phases of a bake, in order of time.
pub fn phases(def: &CharacterDef, events: &[(f32, Event)]) -> Vec<Phase> {
    let upright = upright(def);
    let mut phases = vec![(0.0, upright)];
    for &(time, event) in events {
        match event {
            Event::Hit { .. } => phases.extend([(time, "hit"), (time + HIT_SECONDS, "falls")]),
            Event::WentLimp => phases.push((time, "falls")),
            Event::Settled { since } => phases.push((since, "lies still")),
            Event::GettingUp { .. } => phases.push((time, "gets up")),
            Event::Up => phases.push((time, upright)),
            Event::Touched | Event::NeverSettled => {}
        }
    }
    // Stable: of two at one time the later told one counts.
    phases.sort_by(|a, b| a.0.total_cmp(&b.0));
    phases
}

fn upright(def: &CharacterDef) -> &'static str {
    match (def.looped, def.locomotion) {
        (Some(_), Locomotion::Forward { .. }) => "walks",
        (Some(_), Locomotion::InPlace) => "animated",
        (None, _) => "stands",
    }
}

/// The events of a bake as sentences, in order of time.
pub fn told(input: &BakeInput<'_>, events: &[(f32, Event)]) -> Vec<(f32, String)> {
    let def = &input.character;
    let mut told = vec![(0.0, upright(def).to_owned())];
    let mut limp_already = false;
    for &(time, event) in events {
        let sentence = match event {
            Event::Hit { body } => hit_sentence(input, time, body),
            // A hit says it better.
            Event::WentLimp if events.iter().any(|other| is_hit_at(other, time)) => continue,
            Event::WentLimp => "goes limp".to_owned(),
            Event::Touched if limp_already => continue,
            Event::Touched => "touches the world".to_owned(),
            Event::Settled { since } => {
                told.push((since, "lies still".to_owned()));
                continue;
            }
            Event::NeverSettled => "does not come to rest".to_owned(),
            Event::GettingUp { clip: Some(clip) } => format!("gets up by '{}'", def.clips[clip].name),
            Event::GettingUp { clip: None } => "gets up".to_owned(),
            Event::Up => format!("{} again", upright(def)),
        };
        limp_already = matches!(event, Event::Touched);
        told.push((time, sentence));
    }
    told
}

fn is_hit_at(&(time, event): &(f32, Event), when: f32) -> bool {
    time == when && matches!(event, Event::Hit { .. })
}

fn hit_sentence(input: &BakeInput<'_>, time: f32, body: usize) -> String {
    let role = &input.character.ragdoll.bodies[body].role;
    let near =
        |hit: &&sinew::ragdoll::Hit| hit.body == body && (hit.time - time).abs() < 0.5 * input.world.dt();
    match input.hits.iter().find(near) {
        Some(hit) => format!("is hit on the {role} by {:.0} N·s", hit.impulse.length()),
        None => format!("is hit on the {role}"),
    }
}
