//! The drawn skin: its measurement, and its metrics as JSON by the contract and as text.

use crate::fall::Fall;
use crate::input::files::CharacterFile;
use crate::report::number;
use serde_json::{Value, json};
use sinew::CharacterSource;
use sinew::math::{Affine, Vec3};
use sinew::ragdoll::bake::Frame;
use sinew::ragdoll::build::takes;
use sinew::ragdoll::quality::{RisingQuality, measure_rising};
use sinew::ragdoll::skin::{Phase, Stage};
use sinew::ragdoll::{DropReport, Flaw, RagdollDef, SkinMeter, SkinQuality, State};

/// Largest number of bake frames measured per state, evenly spread; bounds the memory of a long bake.
const MOST_FRAMES: usize = 256;

/// Metrics of the skin, and its flaws.
pub struct SkinReport {
    pub figures: SkinQuality,
    pub flaws: Vec<Flaw>,
    pub rising: RisingQuality,
}

/// A character's baked run.
#[derive(Clone, Copy)]
pub struct Life<'a> {
    pub fall: &'a Fall<'a>,
    /// Height of the floor, metres, if the floor is level.
    pub floor: Option<f32>,
    /// Reason why the character stays down where it should get up, one sentence.
    pub stays_down: Option<&'a str>,
}

impl SkinReport {
    /// Measures the skin of a character in the poses of its drops and over its whole run.
    pub fn of(
        character: &CharacterFile,
        def: &RagdollDef,
        tested: &DropReport,
        life: Option<Life<'_>>,
    ) -> Self {
        let CharacterSource { document, analysis, .. } = &character.source;
        let moves = takes(&document.rig, &document.clips);
        let body = character.body();
        let mut meter = SkinMeter::new(&body, def, &analysis.bind_model, &moves);
        meter.follow_drops(&tested.falls);
        if let Some(life) = life {
            life.show(&mut meter);
        }
        let figures = meter.figures();
        let flaws = figures.flaws(def);
        let rising = life.map_or_else(RisingQuality::default, |life| {
            measure_rising(life.fall.input, &life.fall.baked, life.floor)
        });
        Self { figures, flaws, rising }
    }
}

impl Life<'_> {
    /// Measures the whole run: fall and preparation, clips before and after, standing and lying.
    fn show(&self, meter: &mut SkinMeter<'_>) {
        let frames = &self.fall.baked.frames;
        let is_body = |frame: &&Frame| matches!(frame.state, State::Limp | State::Preparing);
        let (bodies, clips): (Vec<&Frame>, Vec<&Frame>) = frames.iter().partition(is_body);
        for (phase, frames) in [(Phase::Fall, bodies), (Phase::Clip, clips)] {
            for frame in frames.iter().step_by(frames.len().div_ceil(MOST_FRAMES).max(1)) {
                meter.show(phase, &frame.pose);
            }
        }
        self.stand(meter);
        self.lay(meter);
    }

    /// Compares the lowest point with the floor while clips move the character: always on a level floor, only at the
    /// start in a world.
    fn stand(&self, meter: &mut SkinMeter<'_>) {
        let Fall { input, baked, .. } = self.fall;
        let fell = baked.frames.iter().position(|frame| frame.state != State::Animated);
        let stands = baked.frames.iter().take(fell.unwrap_or(baked.frames.len()));
        let count = if self.floor.is_some() { MOST_FRAMES } else { 1 };
        let start = self.floor.unwrap_or(input.world_from_character.translation.y);
        for frame in stands.take(count) {
            meter.stand(Stage::Standing, &frame.pose, &baked.world_from_model, start);
        }
        let (Some(fell), Some(floor)) = (fell, self.floor) else { return };
        for frame in baked.frames.iter().skip(fell) {
            let stage = match frame.state {
                State::GettingUp => Stage::Rising,
                State::Animated => Stage::Up,
                _ => continue,
            };
            meter.stand(stage, &frame.pose, &baked.world_from_model, floor);
        }
    }

    /// Measures the pose at rest; only on a level floor.
    fn lay(&self, meter: &mut SkinMeter<'_>) {
        let (Some(floor), baked) = (self.floor, &self.fall.baked) else { return };
        let Some(settled) = baked.quality.settled_s else { return };
        // The first limp frame at rest, because a character may be hit again later.
        let mut limp = baked.frames.iter().filter(|frame| frame.state == State::Limp);
        if let Some(frame) = limp.find(|frame| settled <= frame.time) {
            let down = Affine { translation: Vec3::Y * -floor, ..Affine::IDENTITY };
            meter.lay(&frame.pose, &(down * baked.world_from_model));
        }
    }
}

/// Returns the metrics under the keys of the contract.
pub fn skin_json(report: &SkinReport) -> Value {
    let SkinReport { figures: skin, rising, .. } = report;
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
        "standing_height_m": known(skin.standing_height_m),
        "rising_height_m": known(skin.rising_height_m),
        "up_height_m": known(skin.up_height_m),
        "rising_above_m": known(skin.rising_above_m),
        "clips_above_m": known(skin.clips_above_m),
        "foot_slide_m": known(rising.foot_slide_m),
        "pose_jump_m": known(rising.pose_jump_m),
        "snap_m_s": known(rising.snap_m_s),
        "unbalanced_s": known(rising.unbalanced_s),
        "contiguous": skin.contiguous,
        "airborne_s": known(skin.airborne_s),
        "size_m": number(skin.size),
    })
}

/// Returns the metrics in a few lines.
pub fn skin_text(report: &SkinReport) -> String {
    let SkinReport { figures: skin, rising, .. } = report;
    let (cm, percent) = (|meters: f32| 100.0 * meters, |share: f32| 100.0 * share);
    let stretch = |share: f32| cm(share * skin.size);
    let clips = match (skin.clips_stretch_p999, skin.clips_stretch_max) {
        (Some(p999), Some(max)) => format!("; the clips by {:.1} and {:.1} cm", stretch(p999), stretch(max)),
        _ => String::new(),
    };
    let height = |height: Option<f32>| height.map_or("unknown".to_owned(), |m| format!("{:+.1} cm", cm(m)));
    let slides = match (rising.foot_slide_m, rising.pose_jump_m) {
        (Some(slide), Some(jump)) => format!(
            "  getting up feet slide by {:.1} cm at most, the pose jumps by {:.1} cm\n",
            cm(slide),
            cm(jump)
        ),
        _ => String::new(),
    };
    format!(
        "The drawn skin\n  {:.1} % of it within {:.0} cm of its body; left and right differ by {:.1} cm; {}\n\
         \x20 it is stretched by {:.1} cm (1 ‰) and {:.1} cm at most{clips}\n\
         \x20 {:.2} m high, {:.2} m as drawn; lowest point at rest {}{}\n\
         \x20 lowest point standing {}, getting up {}, up again {}\n{}",
        percent(skin.covered_share),
        cm(skin.tolerance()),
        cm(skin.symmetry_error_m),
        if skin.contiguous {
            "every part is attached where it should be"
        } else {
            "parts are attached to the wrong body"
        },
        stretch(skin.edge_stretch_p999),
        stretch(skin.edge_stretch_max),
        skin.bind_height_m,
        skin.drawn_height_m,
        height(skin.rest_height_m),
        skin.airborne_s.map_or(String::new(), |seconds| format!("; {seconds:.2} s in the air when calm")),
        height(skin.standing_height_m),
        height(skin.rising_height_m),
        height(skin.up_height_m),
        slides,
    )
}
