//! The drawn skin: measured, and its figures as the contract names them and as a person reads them.

use crate::fall::Fall;
use crate::input::files::CharacterFile;
use crate::report::number;
use serde_json::{Value, json};
use sinew::ragdoll::bake::Frame;
use sinew::ragdoll::build::takes;
use sinew::ragdoll::{DropReport, Flaw, RagdollDef, SkinMeter, SkinQuality, State, measure_skin};

/// Most frames of a bake that are looked at, evenly spread.
const MOST_FRAMES: usize = 256;

/// Figures of the skin, and what is wrong with it.
pub struct SkinReport {
    pub figures: SkinQuality,
    pub flaws: Vec<Flaw>,
}

impl SkinReport {
    /// Draws a character as its ragdoll fell.
    pub fn of(character: &CharacterFile, def: &RagdollDef, tested: &DropReport) -> Self {
        let CharacterFile { document, analysis, .. } = character;
        let moves = takes(&document.rig, &document.clips);
        let figures = measure_skin(&character.body(), def, &analysis.bind_model, &moves, &tested.falls);
        let flaws = figures.flaws(def);
        Self { figures, flaws }
    }

    /// Looks at the skin over the frames of a bake in which the character is limp; at where it lay only on a plain floor.
    pub fn of_bake(character: &CharacterFile, fall: &Fall<'_>, is_on_floor: bool) -> Self {
        let CharacterFile { document, analysis, .. } = character;
        let moves = takes(&document.rig, &document.clips);
        let (def, baked) = (&fall.input.character.ragdoll, &fall.baked);
        let body = character.body();
        let mut meter = SkinMeter::new(&body, def, &analysis.bind_model, &moves);
        let limp: Vec<&Frame> = baked.frames.iter().filter(|frame| frame.state == State::Limp).collect();
        // Of a bake of minutes a sample: memory goes with the frames.
        for frame in limp.iter().step_by(limp.len().div_ceil(MOST_FRAMES).max(1)) {
            meter.fell(&frame.pose);
        }
        let settled = baked.quality.settled_s.filter(|_| is_on_floor);
        // Later it may be hit again.
        let lying = limp.iter().find(|frame| settled.is_some_and(|settled| settled <= frame.time));
        if let Some(frame) = lying {
            meter.lay(&frame.pose, &baked.world_from_model);
        }
        let figures = meter.figures();
        let flaws = figures.flaws(def);
        Self { figures, flaws }
    }

    /// Adds what is wrong with the skin to a verdict on the bodies.
    pub fn judge(&self, tested: &mut DropReport) {
        tested.verdict = SkinQuality::verdict(&self.flaws, tested.verdict);
        // Before what was not measured, which stands last.
        let at = tested.reasons.len().saturating_sub(1);
        let said = self.flaws.iter().map(|flaw| format!("skin: {flaw}"));
        tested.reasons.splice(at..at, said);
    }
}

/// The figures under the keys of the contract.
pub fn skin_json(skin: &SkinQuality) -> Value {
    let known = |figure: Option<f32>| figure.map_or(Value::Null, number);
    json!({
        "covered_share": number(skin.covered_share),
        "edge_stretch_p999": number(skin.edge_stretch_p999),
        "edge_stretch_max": number(skin.edge_stretch_max),
        "clips_stretch_p999": known(skin.clips_stretch_p999),
        "clips_stretch_max": known(skin.clips_stretch_max),
        "symmetry_error_m": number(skin.symmetry_error_m),
        "bind_height_m": number(skin.bind_height_m),
        "drawn_height_m": number(skin.drawn_height_m),
        "rest_height_m": known(skin.rest_height_m),
        "contiguous": skin.contiguous,
        "airborne_s": known(skin.airborne_s),
        "size_m": number(skin.size),
    })
}

/// The figures in a few lines.
pub fn skin_text(skin: &SkinQuality) -> String {
    let (cm, percent) = (|meters: f32| 100.0 * meters, |share: f32| 100.0 * share);
    let stretch = |share: f32| cm(share * skin.size);
    let clips = match (skin.clips_stretch_p999, skin.clips_stretch_max) {
        (Some(p999), Some(max)) => format!("; the clips by {:.1} and {:.1} cm", stretch(p999), stretch(max)),
        _ => String::new(),
    };
    format!(
        "The drawn skin\n  {:.1} % of it within {:.0} cm of its body; left and right differ by {:.1} cm; {}\n\
         \x20 falls stretch it by {:.1} cm (1 ‰) and {:.1} cm at most{clips}\n\
         \x20 {:.2} m high, {:.2} m as drawn; lowest point at rest {}{}\n",
        percent(skin.covered_share),
        cm(skin.tolerance()),
        cm(skin.symmetry_error_m),
        if skin.contiguous {
            "every part hangs on what it grows from"
        } else {
            "parts hang elsewhere than they grow"
        },
        stretch(skin.edge_stretch_p999),
        stretch(skin.edge_stretch_max),
        skin.bind_height_m,
        skin.drawn_height_m,
        skin.rest_height_m.map_or("unknown".to_owned(), |height| format!("{:+.1} cm", cm(height))),
        skin.airborne_s.map_or(String::new(), |seconds| format!("; {seconds:.2} s in the air when calm")),
    )
}
