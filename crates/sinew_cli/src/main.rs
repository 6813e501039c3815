//! The `sinew` command line. Each command is a struct in a separate file.
#![forbid(unsafe_code)]

mod commands;
mod cpu_clock;
mod failure;
mod fall;
mod input;
mod judge;
mod render;
mod report;

use clap::builder::styling::{AnsiColor, Styles};
use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, FromArgMatches, Parser};
use commands::Command;
use failure::Failure;
use std::io::{self, Write};
use std::process::ExitCode;

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold());

const AFTER_HELP: &str = "\
Start here:
  sinew demo                                 a mannequin walks, falls, gets up
  sinew inspect hero.glb                     what is in your file
  sinew bake hero.glb -o fall.glb            a fall, written back as a clip
  sinew ragdoll doctor hero.glb              what is wrong with its ragdoll
  sinew boxes house.glb -o house.json        a world to fall in, from a mesh
  sinew convert a.bvh b.glb --onto hero.glb  captured motion on your character
  sinew view                                 a window: look, pull, throw, pause

A file that is read may be -, which is standard input.";

/// Physics for characters: simulates how a rigged character falls, collides, reacts to hits, gets up and walks on.
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
    let arguments = with_negative_numbers(Sinew::command()).try_get_matches();
    let Sinew { json, command } = match arguments.and_then(|arguments| Sinew::from_arg_matches(&arguments)) {
        Ok(arguments) => arguments,
        Err(problem) => return help_or_usage(&problem),
    };
    match command.run() {
        Ok(report) => print(&report.shown(json), ExitCode::SUCCESS),
        Err(Failure::Missed { report, what }) => {
            let code = print(&report.shown(json), ExitCode::FAILURE);
            eprintln!("error: {what}");
            code
        }
        Err(failure) => {
            eprintln!("error: {failure}");
            match failure.to_json() {
                Some(object) if json => print(&report::one_object(&object), failure.exit_code()),
                _ => failure.exit_code(),
            }
        }
    }
}

/// Returns the command, with `-1` accepted as a value after every option, so that the parser of that value reports
/// the error.
fn with_negative_numbers(command: clap::Command) -> clap::Command {
    let accept = |arg: clap::Arg| {
        let takes = arg.get_action().takes_values();
        if takes { arg.allow_negative_numbers(true) } else { arg }
    };
    command.mut_args(accept).mut_subcommands(with_negative_numbers)
}

/// Prints help or the version to stdout, argument errors to stderr.
fn help_or_usage(problem: &clap::Error) -> ExitCode {
    let code = ExitCode::from(u8::try_from(problem.exit_code()).unwrap_or(2));
    let code = written(problem.print().and_then(|()| io::stdout().flush()), code);
    if let Some(ContextValue::String(name)) = problem.get(ContextKind::InvalidSubcommand)
        && ["build", "doctor", "export"].contains(&name.as_str())
    {
        eprintln!("\n  tip: the command is 'sinew ragdoll {name}'");
    }
    code
}

/// Writes text to stdout; returns the process's exit code if all of it is written.
fn print(text: &str, code: ExitCode) -> ExitCode {
    let mut out = io::stdout().lock();
    written(out.write_all(text.as_bytes()).and_then(|()| out.flush()), code)
}

/// Returns the exit code after a write. A reader that stops reading is not an error of the command.
fn written(outcome: io::Result<()>, code: ExitCode) -> ExitCode {
    match outcome {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            eprintln!("error: standard output: cannot write: {error}");
            ExitCode::FAILURE
        }
        _ => code,
    }
}
