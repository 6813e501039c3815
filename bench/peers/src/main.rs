//! The command `peers`: runs one scene on one engine and prints one JSON object.
#![deny(unsafe_code)]

use clap::{Parser, Subcommand};
use serde_json::{Value, json};
use sinew_peers::engine::Effort;
use sinew_peers::engines::{self, ENGINES, Entry};
use sinew_peers::mjcf::mjcf;
use sinew_peers::resume::{resume, save};
use sinew_peers::run::{Judging, Start, run};
use sinew_peers::scenes::{self, Course, Field, SCENES, Scene, Work};
use sinew_peers::trace::Trace;
use sinew_peers::{limp, walks};
use std::path::PathBuf;
use std::process::ExitCode;

/// Runs the same scenes on Sinew and on other engines.
#[derive(Parser)]
#[command(version)]
struct Peers {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Lists the names of engines and scenes.
    List,
    /// Prints version, flags and settings of the engines in this binary.
    Versions,
    /// Time of each stage of Sinew's step on a scene, µs, and counts of its work.
    Trace {
        /// Name of a scene in `peers list` or `sinew scenes`.
        #[arg(long)]
        scene: String,
        /// Number of steps after the warm-up, instead of the rest of the scene.
        #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
        steps: Option<u32>,
        /// Steps before the measurement, instead of a third of the scene.
        #[arg(long)]
        warm_up: Option<u32>,
        /// With several threads only the wall time of the whole step is measured.
        #[arg(long, default_value_t = 1)]
        threads: usize,
    },
    /// Runs random walks of Sinew's mover and Rapier's controller on the same terrains; reports depths, sticks, steps
    /// climbed, and µs per move.
    Walks {
        /// Number of walks on each terrain.
        #[arg(long, default_value_t = 200)]
        count: usize,
        /// Folder with `house_2story_stairs.glb` and `kaykit_dungeon`; without it only the cabin and the clutter are used.
        #[arg(long, default_value = "../shared/data/worlds")]
        worlds: PathBuf,
    },
    /// A scene of our own ragdolls for MuJoCo: the humanoid, its starts, the obstacles.
    Mjcf {
        /// Name in `peers list`.
        #[arg(long, value_parser = parse_scene)]
        scene: &'static Scene,
        /// As for `run`.
        #[arg(long)]
        start: Option<u64>,
    },
    /// Writes the state of a scene of bodies after some steps of Sinew, for `resume`.
    Save {
        /// Name in `peers list`.
        #[arg(long, value_parser = parse_scene)]
        scene: &'static Scene,
        /// Number of steps before the state is written.
        #[arg(long)]
        steps: u32,
        /// As for `run`.
        #[arg(long)]
        start: Option<u64>,
        /// File to write.
        #[arg(short, long)]
        out: PathBuf,
    },
    /// Continues from a state that `save` wrote: two builds from one state, timed, or counted by callgrind (runs of few and of more steps, and their difference).
    Resume {
        /// File of `save`.
        state: PathBuf,
        /// Number of steps.
        #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
        steps: u32,
    },
    /// Falls of limp characters until they sleep: processor time beside simulated time.
    Limp {
        /// Rigs, as `sinew ragdoll build` reads them.
        #[arg(required = true)]
        files: Vec<PathBuf>,
        /// Falls of each, from random poses.
        #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..))]
        falls: u32,
    },
    /// Runs a scene on an engine, on one thread.
    Run {
        /// Name in `peers list`.
        #[arg(long, value_parser = parse_engine)]
        engine: &'static Entry,
        /// Name in `peers list`.
        #[arg(long, value_parser = parse_scene)]
        scene: &'static Scene,
        /// Number of steps, instead of the scene's.
        #[arg(long, value_parser = clap::value_parser!(u32).range(1..))]
        steps: Option<u32>,
        /// Seed for moving bodies by up to 0.1 mm from the scene's start.
        #[arg(long)]
        start: Option<u64>,
        /// Repeats the run untimed, and measures its quality.
        #[arg(long)]
        quality: bool,
        /// Work per step of scenes of bodies: fast, balanced or exact for Sinew, a number of substeps for a peer.
        #[arg(long)]
        effort: Option<Effort>,
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
        Command::Trace { scene, steps, warm_up, threads } => {
            match (Trace { scene: &scene, steps, warm_up, threads }).run() {
                Ok(trace) => trace,
                Err(error) => return failure(&error),
            }
        }
        Command::Save { scene, steps, start, out } => {
            match save(scene, start.map_or(Start::Own, Start::Perturbed), steps, &out) {
                Ok(saved) => saved,
                Err(error) => return failure(&error),
            }
        }
        Command::Resume { state, steps } => match resume(&state, steps) {
            Ok(resumed) => resumed,
            Err(error) => return failure(&error),
        },
        Command::Limp { files, falls } => limp::run(&files, falls),
        Command::Walks { count, worlds } => match walks::run(count, &worlds) {
            Ok(table) => table,
            Err(error) => return failure(&error.to_string()),
        },
        Command::Mjcf { scene, start } => match start.map_or(Start::Own, Start::Perturbed).of((scene.work)())
        {
            Work::Bodies(blueprint) if scene.field == Field::Figures => mjcf(&blueprint),
            _ => return failure(&format!("{} is not a scene of ragdolls", scene.name)),
        },
        Command::Run { engine: Entry { name, engine: None }, .. } => {
            return failure(&format!(
                "this binary was built without {name}: see the features in bench/peers/Cargo.toml"
            ));
        }
        Command::Run { engine: Entry { engine: Some(engine), .. }, scene, steps, start, quality, effort } => {
            let start = start.map_or(Start::Own, Start::Perturbed);
            let judging = if quality { Judging::On } else { Judging::Off };
            let how = (judging, effort.unwrap_or_default());
            run(*engine, scene, start, steps.map(|steps| steps as usize), how)
        }
    };
    println!("{report}");
    ExitCode::SUCCESS
}

fn failure(why: &str) -> ExitCode {
    eprintln!("error: {why}");
    ExitCode::from(2)
}

fn list() -> Value {
    let engine = |entry: &Entry| {
        let fields = entry.engine.map_or(&[][..], |engine| engine.fields());
        let fields: Vec<&str> = fields.iter().map(|field| field.name()).collect();
        json!({ "name": entry.name, "built": entry.engine.is_some(), "fields": fields })
    };
    let scene = |scene: &Scene| {
        json!({
            "name": scene.name,
            "about": scene.about,
            "field": scene.field.name(),
            "is_chaotic": scene.course == Course::Chaotic,
        })
    };
    json!({
        "engines": ENGINES.iter().map(engine).collect::<Vec<_>>(),
        "scenes": SCENES.iter().map(scene).collect::<Vec<_>>(),
    })
}

fn versions() -> Value {
    let built = ENGINES.iter().filter_map(|entry| entry.engine);
    json!({ "engines": built.map(|engine| engine.describe().to_json()).collect::<Vec<_>>() })
}
