//! The command `peers`: one engine, one scene, one JSON object.
#![deny(unsafe_code)]

use clap::{Parser, Subcommand};
use serde_json::{Value, json};
use sinew_peers::engines::{self, ENGINES, Entry};
use sinew_peers::run::{Judging, run};
use sinew_peers::scenes::{self, SCENES, Scene};
use std::process::ExitCode;

/// The same scenes on Sinew and on other engines.
#[derive(Parser)]
#[command(version)]
struct Peers {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Names of engines and scenes.
    List,
    /// Version, flags and settings of the engines in this binary.
    Versions,
    /// Runs a scene on an engine, on one thread.
    Run {
        /// As `peers list` names it.
        #[arg(long, value_parser = parse_engine)]
        engine: &'static Entry,
        /// As `peers list` names it.
        #[arg(long, value_parser = parse_scene)]
        scene: &'static Scene,
        /// Instead of as many as the scene says.
        #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
        steps: Option<u32>,
        /// Run it again, untimed, and look at what the time bought.
        #[arg(long)]
        quality: bool,
    },
}

fn parse_engine(name: &str) -> Result<&'static Entry, String> {
    engines::find(name).ok_or_else(|| format!("`peers list` has no engine {name}"))
}

fn parse_scene(name: &str) -> Result<&'static Scene, String> {
    scenes::find(name).ok_or_else(|| format!("`peers list` has no scene {name}"))
}

fn main() -> ExitCode {
    let report = match Peers::parse().command {
        Command::List => list(),
        Command::Versions => versions(),
        Command::Run { engine: Entry { name, engine: None }, .. } => {
            eprintln!(
                "error: this binary was built without {name}: see the features in bench/peers/Cargo.toml"
            );
            return ExitCode::from(2);
        }
        Command::Run { engine: Entry { engine: Some(engine), .. }, scene, steps, quality } => {
            let judging = if quality { Judging::On } else { Judging::Off };
            run(*engine, scene, steps.map(|steps| steps as usize), judging)
        }
    };
    println!("{report}");
    ExitCode::SUCCESS
}

fn list() -> Value {
    let engine = |entry: &Entry| {
        let fields = entry.engine.map_or(&[][..], |engine| engine.fields());
        let fields: Vec<&str> = fields.iter().map(|field| field.name()).collect();
        json!({ "name": entry.name, "built": entry.engine.is_some(), "fields": fields })
    };
    let scene =
        |scene: &Scene| json!({ "name": scene.name, "about": scene.about, "field": scene.field.name() });
    json!({
        "engines": ENGINES.iter().map(engine).collect::<Vec<_>>(),
        "scenes": SCENES.iter().map(scene).collect::<Vec<_>>(),
    })
}

fn versions() -> Value {
    let built = ENGINES.iter().filter_map(|entry| entry.engine);
    json!({ "engines": built.map(|engine| engine.describe().to_json()).collect::<Vec<_>>() })
}
