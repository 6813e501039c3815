//! The `sinew` command line: arguments in, report out. Each command is a struct in a file of its own.
#![forbid(unsafe_code)]

mod commands;
mod cpu_clock;
mod failure;
mod fall;
mod input;
mod judge;
mod render;
mod report;

use clap::Parser;
use clap::builder::styling::{AnsiColor, Styles};
use commands::Command;
use serde_json::Value;
use std::io::{self, Write};
use std::process::ExitCode;

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold());

const AFTER_HELP: &str = "\
Start here:
  sinew demo                                  a mannequin walks, is hit, falls down stairs, gets up
  sinew inspect character.glb                 what is in your file
  sinew bake character.glb -o fall.glb        let your character fall; written back as a clip
  sinew ragdoll doctor character.glb          what is wrong with its ragdoll, and what mends it
  sinew boxes house.glb -o house.json         a world to fall in, from a mesh
  sinew convert walk.bvh --onto character.glb -o walking.glb   captured motion on your character
  sinew view                                  a window: look at scenes, pull, throw, pause";

/// Physics for characters: give it a rigged file, and it falls, collides, is hit, gets up and walks on.
#[derive(Parser)]
#[command(name = "sinew", version, after_help = AFTER_HELP, styles = STYLES, max_term_width = 100)]
struct Sinew {
    /// Print one JSON object on stdout and nothing else
    #[arg(long, global = true)]
    json: bool,
    #[command(subcommand)]
    command: Command,
}

fn main() -> ExitCode {
    let Sinew { json, command } = Sinew::parse();
    match command.run() {
        Ok(report) => {
            print(&if json { one_object(&report.json) } else { report.text });
            ExitCode::SUCCESS
        }
        Err(failure) => {
            eprintln!("error: {failure}");
            if json && let Some(object) = failure.to_json() {
                print(&one_object(&object));
            }
            failure.exit_code()
        }
    }
}

fn one_object(value: &Value) -> String {
    format!("{value:#}\n")
}

/// To stdout. Whoever reads it may stop reading; that is no fault of the command.
fn print(text: &str) {
    let mut out = io::stdout().lock();
    // Nothing is left to tell and nobody to tell it to.
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}
