//! Facts about clips and their events for `sinew inspect`.

use crate::input::motion::Motion;
use crate::report::table::{Table, shown};
use crate::report::{number, numbers};
use serde_json::{Value, json};
use sinew::anim::{
    BuiltClip, Clip, ClipBuildOptions, ClipEvent, RigAnalysis, Role, Wrap, local_to_model, sample,
};
use sinew::math::{Affine, Rotation, Vec3};

/// A clip and its measurements.
pub struct ClipFacts<'a> {
    clip: &'a Clip,
    events: &'a [ClipEvent],
    keys: usize,
    /// The playable clip, or the reason why the clip cannot be played.
    built: Result<BuiltClip, String>,
    /// Displacement of the body by the clip, if the unit is known.
    way: Option<Way>,
}

/// Displacement of a body by a clip: its end relative to its start.
struct Way {
    /// Translation in metres, character axes.
    shift: Vec3,
    /// Rotation about the vertical, radians.
    turn: f32,
}

impl<'a> ClipFacts<'a> {
    /// Measures the clips of a file.
    pub fn of(motion: &'a Motion) -> Vec<Self> {
        let Motion { file, analysis, .. } = motion;
        let facts = |(clip, events): (&'a Clip, &'a Vec<ClipEvent>)| {
            let built = BuiltClip::build(clip, &file.rig, &ClipBuildOptions::default());
            let analysis = analysis.as_ref().filter(|_| built.is_ok());
            Self {
                clip,
                events,
                keys: clip.channels.iter().map(|channel| channel.times.len()).sum(),
                built: built.map_err(|error| error.to_string()),
                way: analysis.and_then(|analysis| way(motion, clip, analysis)),
            }
        };
        file.clips.iter().zip(&file.events).map(facts).collect()
    }

    pub fn to_json(&self) -> Value {
        let built = self.built.as_ref().ok();
        let bound = built.map(BuiltClip::error_bound);
        let event = |event: &ClipEvent| json!({"time_s": number(event.time), "name": event.name, "payload": event.payload});
        json!({
            "name": self.clip.name,
            "duration_s": number(self.clip.duration),
            "channels": self.clip.channels.len(),
            "keys": self.keys,
            "built_bytes": built.map(BuiltClip::bytes),
            "error_deg": bound.map(|bound| number(bound.rotation.to_degrees())),
            "error_units": bound.map(|bound| number(bound.translation)),
            "root_motion_m": self.way.as_ref().map(|way| numbers(&way.shift.to_array())),
            "root_turn_deg": self.way.as_ref().map(|way| number(way.turn.to_degrees())),
            "events": self.events.iter().map(event).collect::<Vec<_>>(),
        })
    }

    /// Returns the reason why the clip cannot be played, if there is one.
    pub fn warning(&self) -> Option<String> {
        let why = self.built.as_ref().err()?;
        Some(format!("clip {} cannot be played: {why}", shown(&self.clip.name)))
    }
}

/// Returns the displacement from the first to the last pose of a clip, measured at the joint that carries the
/// body.
fn way(motion: &Motion, clip: &Clip, analysis: &RigAnalysis) -> Option<Way> {
    let rig = &motion.file.rig;
    let carrier = analysis.joint_with(Role::Hips).or_else(|| analysis.kept.first().map(|bone| bone.joint))?;
    let mut pose: Vec<_> = rig.joints.iter().map(|joint| joint.rest).collect();
    let mut model = Vec::new();
    let [start, end] = [0.0, clip.duration].map(|time| {
        sample(clip, rig, time, Wrap::Clamp, &mut pose);
        local_to_model(rig, &pose, &Affine::IDENTITY, &mut model);
        analysis.character_from_file() * model[carrier]
    });
    let turned: Rotation = end.to_rigid().rotation * start.to_rigid().rotation.inverse();
    let way = Way { shift: end.translation - start.translation, turn: turned.twist_angle(Vec3::Y) };
    way.shift.is_finite().then_some(way)
}

/// Returns the clips as a table, numbered as `--clip` and `--get-up` count them.
pub fn clip_table(facts: &[ClipFacts<'_>]) -> Table {
    let mut table =
        Table::titled(&["#", "name", "seconds", "channels", "keys", "built", "error (°, units)", "moves"]);
    for (number, ClipFacts { clip, keys, built, way, .. }) in facts.iter().enumerate() {
        let (size, error) = built.as_ref().map_or(("-".to_owned(), "-".to_owned()), |built| {
            let bound = built.error_bound();
            (kib(built.bytes()), format!("{:.3}, {:.0e}", bound.rotation.to_degrees(), bound.translation))
        });
        let way = way.as_ref().map_or(String::new(), Way::to_text);
        let (seconds, channels) = (format!("{:.2}", clip.duration), clip.channels.len().to_string());
        let (number, keys) = (number.to_string(), keys.to_string());
        table.row([number, shown(&clip.name), seconds, channels, keys, size, error, way]);
    }
    table
}

/// Returns the events in the clips as a table; `None` if there are none.
pub fn event_table(facts: &[ClipFacts<'_>]) -> Option<Table> {
    let mut table = Table::titled(&["clip", "seconds", "event", "payload"]);
    for ClipFacts { clip, events, .. } in facts {
        for event in *events {
            let time = format!("{:.3}", event.time);
            table.row([shown(&clip.name), time, shown(&event.name), shown(&event.payload)]);
        }
    }
    facts.iter().any(|facts| !facts.events.is_empty()).then_some(table)
}

impl Way {
    fn to_text(&self) -> String {
        let (ground, turn) =
            ((self.shift.x * self.shift.x + self.shift.z * self.shift.z).sqrt(), self.turn.to_degrees());
        let far = if ground >= 0.005 { format!("{ground:.2} m") } else { "on the spot".to_owned() };
        if turn.abs() >= 1.0 { format!("{far}, turns {turn:.0}°") } else { far }
    }
}

fn kib(bytes: usize) -> String {
    format!("{:.1} KiB", bytes as f64 / 1024.0)
}
