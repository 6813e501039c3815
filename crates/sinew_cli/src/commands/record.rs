//! `sinew record`: records a running scene.

use crate::failure::Result;
use crate::input::files::{Outputs, must_end_in};
use crate::input::scene_choice::choose;
use crate::report::Report;
use crate::report::progress::Progress;
use serde_json::json;
use sinew_scenes::recording::Recorder;
use std::path::PathBuf;

/// Record a named scene: the inputs before each step, the hash of the state after it, and poses at intervals
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew record stairs -o stairs.sinewrec
  sinew record pendulum -o p.sinewrec --steps 600 --set amplitude=60
  sinew replay stairs.sinewrec --verify

The window of 'sinew view' records what hands do: its button 'Save recording' writes such a file.")]
pub struct Record {
    /// Name of the scene
    scene: String,
    /// Recording to write
    #[arg(short, long, value_name = "OUT.sinewrec")]
    output: PathBuf,
    /// Number of steps of 1/60 s; by default the scene's own length
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    steps: Option<u32>,
    /// Change a setting of the scene; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE")]
    settings: Vec<String>,
}

impl Record {
    /// Runs the scene and writes the recording.
    pub fn run(&self) -> Result<Report> {
        must_end_in(&self.output, &["sinewrec"])?;
        let (scene, settings) = choose(&self.scene, &self.settings)?;
        let steps = self.steps.unwrap_or(scene.steps);
        let mut recorder = Recorder::of(scene.start(&settings), scene.name, &self.settings);
        let progress = Progress::new("recording", steps as usize);
        for _ in 0..steps {
            recorder.step();
            progress.step();
        }
        let hash = format!("{:016x}", recorder.instance().world().hash());
        let recording = recorder.finish();
        let mut outputs = Outputs::default();
        outputs.add(&self.output, recording.to_bytes());
        outputs.write()?;
        let path = self.output.display().to_string();
        let text = format!(
            "{}: {steps} steps, {} key frames, state {hash}\nwrote {path}\n",
            scene.name,
            recording.key_frames.len()
        );
        let json = json!({
            "scene": scene.name,
            "steps": steps,
            "key_frames": recording.key_frames.len(),
            "hash": hash,
            "outputs": [path],
        });
        Ok(Report { json, text })
    }
}
