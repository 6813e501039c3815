//! Doubts about the size and the mass that were guessed.

use crate::def::RagdollDef;

/// Mass that a human may have, kg.
const HUMAN: core::ops::RangeInclusive<f32> = 3.0..=500.0;
/// Mass that a creature may have, kg: from a small bird's to that of the heaviest dinosaur on two legs.
const CREATURE: core::ops::RangeInclusive<f32> = 0.1..=8000.0;

/// Why hardly any body has this mass, a sentence; `None` if there are such. Where the size of a file's unit is guessed, that
/// is what is wrong as a rule, and a verdict on the ragdoll says little.
pub fn implausible(def: &RagdollDef) -> Option<String> {
    let human = def.bodies.iter().any(|body| body.role == "hips");
    let (kind, range) = if human { ("human", HUMAN) } else { ("creature", CREATURE) };
    if range.contains(&def.total_mass) {
        return None;
    }
    let (mass, height) = (in_words(def.total_mass), def.height);
    let (least, most) = (in_words(*range.start()), in_words(*range.end()));
    Some(format!(
        "mass of {mass} at a height of {height:.3} m: hardly any {kind} weighs less than {least} or more than {most}"
    ))
}

/// A mass with its unit, to three digits.
fn in_words(kg: f32) -> String {
    let (value, unit) = match kg {
        kg if kg >= 1000.0 => (kg / 1000.0, "t"),
        kg if kg >= 1.0 => (kg, "kg"),
        kg => (1000.0 * kg, "g"),
    };
    let tenths = (10.0 * value).round() / 10.0;
    format!("{tenths} {unit}")
}
