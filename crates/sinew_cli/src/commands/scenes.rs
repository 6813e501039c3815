//! `sinew scenes`: lists the scenes.

use crate::failure::Result;
use crate::report::{Report, number};
use serde_json::{Value, json};
use sinew_scenes::scenes::{Scene, registry};

/// List the scenes of 'sinew run', one per line, the name first
#[derive(clap::Args)]
#[command(after_help = "\
Example:
  sinew scenes
  sinew scenes --json | jq '.scenes[].settings'")]
pub struct Scenes {}

impl Scenes {
    /// Runs the command: lists the scenes.
    pub fn run(&self) -> Result<Report> {
        let width = registry().iter().map(|scene| scene.name.len()).max().unwrap_or(0);
        let line = |scene: &Scene| format!("{:width$}  {}\n", scene.name, scene.about);
        let scenes: Vec<Value> = registry().iter().map(scene_json).collect();
        Ok(Report { json: json!({"scenes": scenes}), text: registry().iter().map(line).collect() })
    }
}

fn scene_json(scene: &Scene) -> Value {
    let settings = scene.settings();
    let settings = settings.declared().iter().map(|setting| {
        json!({
            "key": setting.key,
            "about": setting.about,
            "default": number(setting.default),
            "takes": setting.domain.to_string(),
        })
    });
    json!({
        "name": scene.name,
        "about": scene.about,
        "steps": scene.steps,
        "settings": settings.collect::<Vec<_>>(),
    })
}
