//! Describes the run of a character in words.

use crate::report::table::shown;
use sinew::ragdoll::{BakeInput, CharacterDef, CharacterEvent, Locomotion, Opening};

/// Start time (s) and name of a phase: one or two words for the corner of a picture.
pub type Phase = (f32, String);

/// Seconds for which the caption names a hit.
pub const HIT_SECONDS: f32 = 0.4;

const RESTS: &str = "stands in its rest pose";

/// Returns the phases of a bake, in order of time.
pub fn phases(def: &CharacterDef, events: &[(f32, CharacterEvent)]) -> Vec<Phase> {
    let mut phases = vec![(0.0, at_first(def))];
    let mut add = |time: f32, what: &str| phases.push((time, what.to_owned()));
    for &(time, event) in events {
        match event {
            CharacterEvent::Hit { .. } => {
                add(time, "is hit");
                add(time + HIT_SECONDS, "falls");
            }
            CharacterEvent::WentLimp => add(time, "falls"),
            CharacterEvent::Settled { since } => add(since, "lies still"),
            CharacterEvent::Preparing { rolls: true } => add(time, "rolls over"),
            CharacterEvent::Preparing { rolls: false } | CharacterEvent::GettingUp { .. } => {
                add(time, "gets up");
            }
            CharacterEvent::Up => add(time, &upright(def)),
            CharacterEvent::Stumbled => add(time, "stumbles"),
            CharacterEvent::Caught { .. } => add(time, &upright(def)),
            CharacterEvent::Flinched { .. }
            | CharacterEvent::Touched
            | CharacterEvent::NeverSettled
            | CharacterEvent::Struck { .. } => {}
            CharacterEvent::Recovered
            | CharacterEvent::Powered
            | CharacterEvent::Clip(_)
            | CharacterEvent::Contact { .. }
            | CharacterEvent::Detached { .. }
            | CharacterEvent::LetGo { .. } => {}
        }
    }
    // The sort is stable, so of two events at one time the later entry in the list is used.
    phases.sort_by(|a, b| a.0.total_cmp(&b.0));
    phases
}

/// Returns the phase before any event.
fn at_first(def: &CharacterDef) -> String {
    match def.motions().opening {
        Opening::Looped => upright(def),
        Opening::Rest => RESTS.to_owned(),
    }
}

fn upright(def: &CharacterDef) -> String {
    match (def.motions().looped.map(|clip| def.motions().clips[clip].name.as_str()), def.motions().locomotion)
    {
        (Some(_), Locomotion::Forward { .. }) => "walks".to_owned(),
        (Some(""), _) => "plays a clip without a name".to_owned(),
        (Some(clip), _) => format!("plays clip {}", shown(clip)),
        (None, _) => RESTS.to_owned(),
    }
}

/// Returns the events of a bake as sentences, in order of time.
pub fn moments(input: &BakeInput<'_>, events: &[(f32, CharacterEvent)]) -> Vec<(f32, String)> {
    let def = &input.character;
    let mut moments = vec![(0.0, at_first(def))];
    for &(time, event) in events {
        let sentence = match event {
            CharacterEvent::Hit { body } => hit_sentence(input, time, body),
            // Left out at a hit, which describes the fall better, and where the character goes limp while it stands on
            // the ground.
            CharacterEvent::WentLimp if events.iter().any(|other| is_hit_at(other, time)) => continue,
            CharacterEvent::Touched
            | CharacterEvent::Struck { .. }
            | CharacterEvent::Recovered
            | CharacterEvent::Powered => continue,
            CharacterEvent::Clip(_) | CharacterEvent::Contact { .. } | CharacterEvent::LetGo { .. } => {
                continue;
            }
            CharacterEvent::Flinched { body } => {
                format!("flinches at {}", input.character.ragdoll.bodies[body].role)
            }
            CharacterEvent::Detached { body } => {
                format!("loses its {}", input.character.ragdoll.bodies[body].role)
            }
            CharacterEvent::Stumbled => "stumbles".to_owned(),
            CharacterEvent::Caught { steps } => format!("has caught itself after {steps} steps"),
            CharacterEvent::WentLimp => "goes limp".to_owned(),
            CharacterEvent::Settled { since } => {
                moments.push((since, "comes to rest".to_owned()));
                continue;
            }
            CharacterEvent::NeverSettled => "does not come to rest".to_owned(),
            CharacterEvent::Preparing { rolls: true } => "rolls over".to_owned(),
            CharacterEvent::Preparing { rolls: false } => "gathers its limbs".to_owned(),
            CharacterEvent::GettingUp { clip: Some(clip) } => {
                format!("gets up by clip {}", shown(&def.motions().clips[clip].name))
            }
            CharacterEvent::GettingUp { clip: None } => "gets up".to_owned(),
            CharacterEvent::Up if def.motions().opening == Opening::Rest => upright(def),
            CharacterEvent::Up => format!("{} again", upright(def)),
        };
        moments.push((time, sentence));
    }
    moments
}

fn is_hit_at(&(time, event): &(f32, CharacterEvent), when: f32) -> bool {
    time == when && matches!(event, CharacterEvent::Hit { .. })
}

fn hit_sentence(input: &BakeInput<'_>, time: f32, body: usize) -> String {
    let role = &input.character.ragdoll.bodies[body].role;
    let near =
        |hit: &&sinew::ragdoll::BakeHit| hit.body == body && (hit.time - time).abs() < 0.5 * input.world.dt();
    match input.hits.iter().find(near) {
        Some(hit) => format!("is hit on the {role} by {:.0} N·s", hit.impulse.length()),
        None => format!("is hit on the {role}"),
    }
}
