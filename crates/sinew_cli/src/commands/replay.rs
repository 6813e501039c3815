//! `sinew replay`: replays a recording and compares it with its recorded states or another recording.

use crate::failure::{Failure, Result};
use crate::input::source::{name, read_bytes};
use crate::report::Report;
use crate::report::progress::Progress;
use serde_json::json;
use sinew::math::Transform;
use sinew_scenes::recording::{Difference, Recording, Replay as Player, compare};
use std::path::{Path, PathBuf};

/// Replay a recording: check that it reaches the same states, and find where two recordings differ
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew replay stairs.sinewrec
  sinew replay stairs.sinewrec --verify
  sinew replay mine.sinewrec --diff theirs.sinewrec

Only the version that made a recording is known to have the same bits.")]
pub struct Replay {
    /// A recording
    file: PathBuf,
    /// Fail (exit code 1) at the first step whose state differs from the recorded one
    #[arg(long)]
    verify: bool,
    /// Report the first step and body that differ from another recording; exit code 1 if there is one
    #[arg(long, value_name = "OTHER.sinewrec")]
    diff: Option<PathBuf>,
}

/// Reads a recording from a file.
fn load(path: &Path) -> Result<Recording> {
    let name = name(path);
    Ok(Recording::read(&read_bytes(path)?).map_err(|error| error.with_file(name))?)
}

impl Replay {
    /// Runs the command: replays the recording.
    pub fn run(&self) -> Result<Report> {
        let name = name(&self.file);
        let recording = load(&self.file)?;
        if let Some(other) = &self.diff {
            return self.against(&recording, other);
        }
        let scene = recording.scene.clone();
        let made_by = recording.made_by.clone();
        let is_ours = made_by == env!("CARGO_PKG_VERSION");
        let mut player = Player::start(recording).map_err(|error| error.with_file(&name))?;
        let steps = player.recording().steps.len();
        let progress = Progress::new("replaying", steps);
        let mut diverged = player.misplaced().map(|_| 0);
        while diverged.is_none()
            && let Some(step) = player.step()
        {
            progress.step();
            // A state with the recorded hash but different poses is also a difference.
            let differs = step.found != step.recorded || player.misplaced().is_some();
            diverged = differs.then_some(step.step);
        }
        if let (Some(step), true) = (diverged, self.verify) {
            let why = if is_ours {
                "the same version".to_owned()
            } else {
                format!("version {made_by}, and this is {}", env!("CARGO_PKG_VERSION"))
            };
            let what = format!("reaches another state than recorded by {why}");
            return Err(Failure::at(name, what, format!("step {step}")));
        }
        let hash = format!("{:016x}", player.instance().world().hash());
        let outcome = match diverged {
            Some(step) => format!("differs from the recording from step {step} on"),
            None => "every state is as recorded".to_owned(),
        };
        let text =
            format!("{scene}, recorded by version {made_by}: {steps} steps, {outcome}; state {hash}\n");
        let json = json!({
            "scene": scene,
            "made_by": made_by,
            "steps": steps,
            "diverged_at": diverged,
            "hash": hash,
        });
        Ok(Report { json, text })
    }

    /// Reports the first difference between the recording and another.
    fn against(&self, recording: &Recording, other: &Path) -> Result<Report> {
        let name = name(&self.file);
        let others = load(other)?;
        let Some(difference) = compare(recording, &others) else {
            let steps = recording.steps.len();
            let text = format!("{steps} steps, all equal\n");
            let json = json!({
                "scene": recording.scene,
                "made_by": recording.made_by,
                "steps": steps,
                "diverged_at": null,
                "hash": null,
            });
            return Ok(Report { json, text });
        };
        let (what, place) = described(&difference);
        Err(Failure::at(name, format!("{what} {}", other.display()), place))
    }
}

/// Describes a difference: the text before the other file's name, and the location of the difference.
fn described(difference: &Difference) -> (String, String) {
    match difference {
        Difference::Scene => ("has another scene or other settings than".to_owned(), String::new()),
        Difference::Length { common } => {
            ("is equal as far as both go, but not as long as".to_owned(), format!("step {common}"))
        }
        Difference::State { step, body: None } => {
            ("differs, but not in the pose of a body, from".to_owned(), format!("step {step}"))
        }
        Difference::State { step, body: Some((id, [mine, theirs])) } => {
            let apart = (mine.translation - theirs.translation).length();
            let turned = mine.rotation.angle_to(theirs.rotation).to_degrees();
            let at = |place: &Transform| {
                let at = place.translation;
                format!("({:.4}, {:.4}, {:.4})", at.x, at.y, at.z)
            };
            let what = format!(
                "differs first in body {}, at {} and {}, {apart:.3e} m and {turned:.3e}° apart, from",
                id.to_bits() as u32,
                at(mine),
                at(theirs)
            );
            (what, format!("step {step}"))
        }
    }
}
