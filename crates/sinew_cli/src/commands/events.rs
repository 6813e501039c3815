//! `sinew events`: events of clips.

use crate::commands::clip_choice::choose_clips;
use crate::failure::{Failure, Result};
use crate::input::files::{Outputs, must_end_in, never_over};
use crate::input::motion::Motion;
use crate::input::settings_arg::unit;
use crate::report::table::{Table, counted, shown};
use crate::report::{Report, number};
use clap::Subcommand;
use serde_json::{Value, json};
use sinew::anim::ClipEvent;
use sinew::anim::contact::{NoFootsteps, footsteps};
use sinew::formats::write_events;
use std::path::PathBuf;

/// Commands of `sinew events`.
#[derive(Subcommand)]
pub enum Events {
    Detect(Detect),
}

impl Events {
    /// Runs the command.
    pub fn run(&self) -> Result<Report> {
        match self {
            Self::Detect(command) => command.run(),
        }
    }
}

/// Propose footstep events: times at which a foot lands, detected from its height and speed
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew events detect walk.bvh
  sinew events detect walk.bvh -o walk.events.json
  sinew events detect character.glb --clip Walk --json

Events live in NAME.events.json beside the clip, where every command finds them, or in the glTF animation's \
extras.sinew_events, where 'sinew convert' puts them. Those that are there already stay.")]
pub struct Detect {
    /// A file with clips: glTF, GLB, VRM, VRMA, BVH, FBX or DeepMimic
    file: PathBuf,
    /// Only this clip, by name, or by number from 0 if it has none; repeatable
    #[arg(long = "clip", value_name = "NAME")]
    clips: Vec<String>,
    /// Length of one unit of the file: m, dm, cm, mm, in, ft, or metres as a number; by default it is guessed
    #[arg(long, value_name = "UNIT", value_parser = unit, allow_negative_numbers = true)]
    unit: Option<f32>,
    /// Events file to write; NAME.events.json beside NAME.glb is read with it
    #[arg(short, long, value_name = "OUT.events.json")]
    output: Option<PathBuf>,
}

/// Name of a footstep's event.
const FOOTSTEP: &str = "footstep";
/// Footsteps of one foot closer together than this count as one, seconds.
const SAME_STEP: f32 = 0.15;

impl Detect {
    /// Runs the command: reads the clips, detects footsteps and writes the events.
    pub fn run(&self) -> Result<Report> {
        self.output.iter().try_for_each(|output| must_end_in(output, &["json"]))?;
        never_over([self.file.as_path()], self.output.as_deref())?;
        let motion = Motion::load_in(&self.file, self.unit)?;
        let failed = |why| Failure::of_file(&motion.name, why);
        let analysis = motion.analysis.as_ref().ok_or(NoFootsteps::NotHumanoid).map_err(failed)?;
        let rig = &motion.file.rig;
        let chosen = choose_clips(&motion, &self.clips)?;
        let mut found = Vec::new();
        for &index in &chosen {
            let steps = footsteps(rig, analysis, &motion.file.clips[index]).map_err(failed)?;
            found.push(new_steps(&motion.file.events[index], steps.events));
        }
        let mut outputs = Outputs::default();
        if let Some(path) = &self.output {
            let mut events = motion.file.events.clone();
            for (&index, steps) in chosen.iter().zip(&found) {
                events[index].extend(steps.iter().cloned());
                events[index].sort_by(|a, b| a.time.total_cmp(&b.time));
            }
            outputs.add(path, write_events(&motion.file.clips, &events).into_bytes());
        }
        outputs.write()?;
        Ok(self.report(&motion, &chosen, &found, &outputs))
    }

    fn report(
        &self,
        motion: &Motion,
        chosen: &[usize],
        found: &[Vec<ClipEvent>],
        outputs: &Outputs,
    ) -> Report {
        let paths: Vec<String> = outputs.paths().map(|path| path.display().to_string()).collect();
        let names = chosen.iter().map(|&index| &motion.file.clips[index].name);
        let mut table = Table::titled(&["clip", "seconds", "event", "payload"]);
        let mut clips: Vec<Value> = Vec::new();
        for (name, events) in names.zip(found) {
            for event in events {
                let time = format!("{:.3}", event.time);
                table.row([shown(name), time, event.name.clone(), event.payload.clone()]);
            }
            let json =
                |e: &ClipEvent| json!({"time_s": number(e.time), "name": e.name, "payload": e.payload});
            clips.push(json!({"name": name, "events": events.iter().map(json).collect::<Vec<_>>()}));
        }
        let steps: usize = found.iter().map(Vec::len).sum();
        let mut text = format!(
            "{}: {} in {}\n",
            shown(&motion.name),
            counted(steps, "footstep", "footsteps"),
            counted(chosen.len(), "clip", "clips")
        );
        if steps > 0 {
            text += &table.to_text();
        }
        for path in &paths {
            text += &format!("wrote {path}\n");
        }
        Report { json: json!({"file": motion.name, "clips": clips, "outputs": paths}), text }
    }
}

/// Returns the steps without an existing event, without repeats.
fn new_steps(there: &[ClipEvent], steps: Vec<ClipEvent>) -> Vec<ClipEvent> {
    let mut known: Vec<(String, f32)> = there
        .iter()
        .filter(|event| event.name == FOOTSTEP)
        .map(|event| (event.payload.clone(), event.time))
        .collect();
    let mut is_new = |step: &ClipEvent| {
        let same =
            |(foot, time): &(String, f32)| *foot == step.payload && (time - step.time).abs() < SAME_STEP;
        let is_new = !known.iter().any(same);
        known.push((step.payload.clone(), step.time));
        is_new
    };
    steps.into_iter().filter(|step| is_new(step)).collect()
}
