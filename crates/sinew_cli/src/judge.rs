//! Judges a character for `ragdoll build` and `bake`: its drops, a baked run, and the skin in both.

use crate::commands::bake::{GetUps, Motions, actor, as_in_file};
use crate::failure::Result;
use crate::fall::Fall;
use crate::input::files::CharacterFile;
use crate::report::skin_report::{Life, SkinReport};
use sinew::anim::KeyBound;
use sinew::math::{Transform, Vec3};
use sinew::physics::{BodyDef, Shape};
use sinew::ragdoll::quality::{Doubt, Fault, faults_of_bake, faults_of_ragdoll, judge, toppled};
use sinew::ragdoll::{BakeInput, DropReport, RagdollDef, SkinQuality, Verdict};
use std::sync::Arc;

/// Time at which a character without hits goes limp, seconds.
pub const LIMP_AT: f32 = 0.5;
/// Default length of a bake, seconds.
pub const SECONDS: f32 = 8.0;

/// Verdict on a character, with its reasons.
pub struct Judgement {
    pub verdict: Verdict,
    /// Metrics beyond their thresholds, one sentence each.
    pub reasons: Vec<String>,
    pub skin: SkinReport,
}

/// Judges drops and a baked run of a character, including a reason to doubt its mass.
pub fn judge_life(
    character: &CharacterFile,
    tested: &DropReport,
    life: Life<'_>,
    doubt: Option<&Doubt>,
) -> Judgement {
    let def = &life.fall.input.character.ragdoll;
    let of_drops = |[drop, wall]: &[_; 2]| {
        let (verdict, mut reasons) = judge(drop, wall);
        // Remove the entry for unmeasured metrics.
        reasons.pop();
        (verdict, reasons)
    };
    let figures = [tested.drop, tested.wall];
    let (mut verdict, mut reasons) =
        doubt.map_or_else(|| of_drops(&figures), |doubt| doubt.judge(figures, of_drops));
    verdict = Verdict::min(verdict, life.fall.verdict);
    for reason in &life.fall.reasons {
        if !reasons.contains(reason) {
            reasons.push(format!("baked: {reason}"));
        }
    }
    let mut faults = faults_of_ragdoll(&character.document.rig, def);
    faults.extend(faults_of_bake(life.fall.input, &life.fall.baked));
    let stays_down = |why: &str| Fault { at_most: Verdict::Usable, reason: why.to_owned() };
    faults.extend(life.stays_down.map(stays_down));
    let skin = SkinReport::of(character, def, tested, Some(life));
    faults.extend(skin.rising.faults(def.height));
    Fault::weigh(&faults, &mut verdict, &mut reasons);
    verdict = SkinQuality::verdict(&skin.flaws, verdict);
    reasons.extend(skin.flaws.iter().map(|flaw| format!("skin: {flaw}")));
    Judgement { verdict, reasons, skin }
}

/// Bakes a character with the defaults of `bake`: on a floor, with its own clips or the built-in ones.
///
/// # Errors
/// If a clip cannot be played.
pub fn with_default_life<T>(
    character: &CharacterFile,
    def: &RagdollDef,
    doubt: Option<&Doubt>,
    see: impl FnOnce(Life<'_>) -> T,
) -> Result<T> {
    let motions = Motions::gather(character, &[], None)?;
    let (falls, gets_up_by) = actor(character, def.clone(), motions, GetUps::Any)?;
    let ground = [BodyDef::fixed(Shape::HalfSpace)];
    let up = character.analysis.hints.up.unwrap_or(Vec3::Y);
    let input = BakeInput {
        world_from_character: as_in_file(Transform::IDENTITY, &falls, up),
        bodies: &ground,
        limp_at: Some(LIMP_AT),
        seconds: SECONDS,
        key_bound: KeyBound::ALL_KEYS,
        ..BakeInput::new(Arc::new(falls))
    };
    let fall = Fall::simulate(&input, doubt);
    let pushed = toppled(&input, &fall.baked);
    let fall = pushed.as_ref().map_or(fall, |pushed| Fall::simulate(pushed, doubt));
    let stays_down = gets_up_by.flaw();
    Ok(see(Life { fall: &fall, floor: Some(0.0), stays_down: stays_down.as_deref() }))
}
