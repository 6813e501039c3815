//! A character's fall and its result, shared by `bake` and `demo`.

use crate::cpu_clock::timed;
use crate::report::number;
use crate::report::quality_report::{quality_json, quality_text};
use crate::report::story;
use serde_json::{Map, Value, json};
use sinew::ragdoll::quality::{Doubt, FallQuality, judge_bake};
use sinew::ragdoll::{BakeInput, Baked, Verdict, bake};
use std::fmt::Write;
use std::path::Path;

/// A bake and its cost.
pub struct Fall<'a> {
    /// Input that was simulated.
    pub input: &'a BakeInput<'a>,
    /// Result of the bake.
    pub baked: Baked,
    /// Simulated seconds per second of processor time.
    pub realtime_factor: f64,
    /// Verdict on the fall.
    pub verdict: Verdict,
    /// Reasons for the verdict: metrics beyond their thresholds, one sentence each.
    pub reasons: Vec<String>,
}

impl<'a> Fall<'a> {
    /// Simulates and judges the fall. `doubt`: reason to doubt the mass, which lowers the verdict.
    pub fn simulate(input: &'a BakeInput<'a>, doubt: Option<&Doubt>) -> Self {
        let (baked, cpu_seconds) = timed(|| bake(input));
        let seconds = baked.steps as f64 * input.world.step_nanoseconds as f64 * 1e-9;
        // The measured time may be 0 for a short bake, because the clock is coarse.
        let realtime_factor = seconds / cpu_seconds.max(1e-6);
        let judge = |[quality]: &[FallQuality; 1]| judge_bake(quality);
        let figures = [baked.quality];
        let (verdict, reasons) = doubt.map_or_else(|| judge(&figures), |doubt| doubt.judge(figures, judge));
        Self { input, baked, realtime_factor, verdict, reasons }
    }

    /// Returns the metrics of the contract.
    pub fn to_json(&self, outputs: &[&Path]) -> Value {
        let outputs: Vec<String> = outputs.iter().map(|path| path.display().to_string()).collect();
        let mut object = Map::new();
        object.insert("seconds".into(), number(self.input.seconds));
        object.insert("frames".into(), self.baked.frames.len().into());
        object.insert("bodies".into(), self.baked.bodies.into());
        object.insert("realtime_factor".into(), json!(self.realtime_factor));
        let (bound, error) = (self.input.key_bound, self.baked.key_error);
        object.insert("keys".into(), self.baked.keys[1].into());
        object.insert("keys_of_all_frames".into(), self.baked.keys[0].into());
        object.insert("key_error_bound_m".into(), number(bound.distance));
        object.insert("key_error_bound_deg".into(), number(bound.angle.to_degrees()));
        object.insert("key_error_max_m".into(), number(error.distance));
        object.insert("key_error_max_deg".into(), number(error.angle.to_degrees()));
        object.append(&mut quality_json(&self.baked.quality));
        object.insert("verdict".into(), self.verdict.name().into());
        object.insert("reasons".into(), self.reasons.as_slice().into());
        let moments = story::moments(self.input, &self.baked.events);
        let events = moments.iter().map(|(time, what)| json!({ "at_s": number(*time), "what": what }));
        object.insert("events".into(), events.collect());
        object.insert("hash".into(), format!("{:016x}", self.baked.hash).into());
        object.insert("outputs".into(), outputs.into());
        object.into()
    }

    /// Returns the text of the events, the quality and the position.
    pub fn to_text(&self, outputs: &[&Path]) -> String {
        let mut text = String::new();
        for (time, what) in story::moments(self.input, &self.baked.events) {
            let _ = writeln!(text, "  {time:5.2} s  {what}");
        }
        text += "\nQuality\n";
        text += &quality_text(&self.baked.quality);
        let _ = writeln!(text, "  verdict: {}", self.verdict.name());
        for reason in &self.reasons {
            let _ = writeln!(text, "    {reason}");
        }
        let _ = writeln!(
            text,
            "\n{} s of {} bodies at {:.0} × real time, state {:016x}",
            self.input.seconds, self.baked.bodies, self.realtime_factor, self.baked.hash
        );
        text += &self.keys_text();
        for path in outputs {
            let _ = writeln!(text, "wrote {}", path.display());
        }
        text
    }

    /// Returns the number of the clip's keys, and the error of the key reduction, as text.
    fn keys_text(&self) -> String {
        let (bound, error, [all, keys]) = (self.input.key_bound, self.baked.key_error, self.baked.keys);
        if keys == all {
            return format!("{keys} keys, one for each frame\n");
        }
        format!(
            "{keys} of {all} keys: joints are off by {:.3} mm and {:.4}° at most, of {:.3} mm and {:.4}° allowed\n",
            1000.0 * error.distance,
            error.angle.to_degrees(),
            1000.0 * bound.distance,
            bound.angle.to_degrees(),
        )
    }
}
