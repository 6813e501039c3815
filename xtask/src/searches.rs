//! Searches for failures that continue from run to run, and a long run of all scenes.

use crate::command;
use anyhow::{Context, Result, bail};
use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Minutes between progress reports of a search.
const CHUNK: f64 = 5.0;

/// `cargo xtask lives`: random lives of worlds, or of characters in them, from the seed at which the last run ended.
///
/// Each chunk of five minutes adds a line to a file outside the repository: seeds, lives, calls, failures. The search
/// ends at the first chunk with a failure, and prints the failure as a short program.
#[derive(clap::Args)]
#[command(after_help = "Example: cargo xtask lives --of characters --minutes 60")]
pub struct Lives {
    /// Kind of call sequences
    #[arg(long, value_enum, default_value_t = Of::Worlds)]
    of: Of,
    /// First seed; by default the one after the last run
    #[arg(long, value_name = "SEED")]
    from: Option<u64>,
    /// Duration, minutes
    #[arg(long, value_name = "M", default_value_t = 20.0)]
    minutes: f64,
    /// Folder for the progress of each search; by default that of the user's state
    #[arg(long, value_name = "DIR")]
    progress: Option<PathBuf>,
}

/// Kind of search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Of {
    /// Worlds, by all calls of `World`
    Worlds,
    /// Worlds with characters, by all calls of both
    Characters,
    /// Worlds of up to 500 bodies, loaded into new ones at five moments each
    Strangers,
}

impl Of {
    /// Returns the name of the search's file, its package, test target and test.
    fn test(self) -> (&'static str, [&'static str; 3]) {
        match self {
            Self::Worlds => ("lives", ["sinew_physics", "lives", "lives_hold"]),
            Self::Characters => ("characters", ["sinew_ragdoll", "lives", "lives_hold"]),
            Self::Strangers => {
                ("strangers", ["sinew_physics", "it", "unrelated_worlds_have_the_same_future"])
            }
        }
    }
}

impl Lives {
    /// # Errors
    /// If a life fails, or the folder cannot be written.
    pub fn run(&self) -> Result<()> {
        let folder = self.progress.clone().map_or_else(folder_of_state, Ok)?;
        fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
        let (name, [package, target, test]) = self.of.test();
        let log = folder.join(format!("{name}.log"));
        let (start, time) = (Instant::now(), Duration::from_secs_f64(60.0 * self.minutes));
        let mut from = self.from;
        while start.elapsed() < time {
            let left = (time - start.elapsed()).as_secs_f64() / 60.0;
            let first = from.take().map_or_else(|| next_seed(&log), Ok)?;
            let mut run =
                command::cargo(&["test", "--release", "--package", package, "--test", target, "--"]);
            run.args(["--nocapture", test]).env("SINEW_LIVES", format!("{first}.."));
            run.env("SINEW_MINUTES", f64::min(left, CHUNK).to_string()).env("SINEW_LOG", &log);
            let outcome = command::run(&mut run);
            eprintln!("{}: {}", log.display(), last_line(&log)?);
            outcome?;
        }
        Ok(())
    }
}

/// Returns the folder for the state of the user's programs.
fn folder_of_state() -> Result<PathBuf> {
    let home = || env::var_os("HOME").map(|home| PathBuf::from(home).join(".local/state"));
    let state = env::var_os("XDG_STATE_HOME").map(PathBuf::from).or_else(home);
    Ok(state.context("neither XDG_STATE_HOME nor HOME is set: use --progress")?.join("sinew"))
}

fn last_line(log: &Path) -> Result<String> {
    if !log.exists() {
        return Ok(String::new());
    }
    let text = fs::read_to_string(log).with_context(|| log.display().to_string())?;
    Ok(text.lines().last().unwrap_or_default().to_owned())
}

/// Returns the seed after those of the last line, which begins with `seeds a..b`; 0 without one.
fn next_seed(log: &Path) -> Result<u64> {
    let line = last_line(log)?;
    if line.is_empty() {
        return Ok(0);
    }
    let end = line
        .strip_prefix("seeds ")
        .and_then(|rest| rest.split([',', ' ']).next()?.split_once("..")?.1.parse().ok());
    end.with_context(|| format!("{}: the last line does not begin with seeds: {line}", log.display()))
}

/// `cargo xtask soak`: an hour of scenes, checked in every step.
#[derive(clap::Args)]
#[command(after_help = "Example: cargo xtask soak --hours 0.5 --part brawl")]
pub struct Soak {
    /// Hours of simulated time, shared among the parts
    #[arg(long, value_name = "H", default_value_t = 1.0)]
    hours: f64,
    /// Only this part; repeatable
    #[arg(long = "part", value_name = "NAME")]
    parts: Vec<String>,
}

impl Soak {
    /// # Errors
    /// If a body is lost, a joint opens, a speed explodes or memory grows.
    pub fn run(&self) -> Result<()> {
        if !(self.hours > 0.0 && self.hours.is_finite()) {
            bail!("--hours must be a positive number, not {}", self.hours);
        }
        let mut run =
            command::cargo(&["run", "--release", "--package", "sinew_scenes", "--example", "soak", "--"]);
        command::run(run.arg(self.hours.to_string()).args(&self.parts))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_search_continues_where_it_ended() {
        let log = env::temp_dir().join(format!("sinew-search-{}.log", std::process::id()));
        assert_eq!(next_seed(&log).expect("a missing log gives the first seed"), 0);
        fs::write(&log, "seeds 0..60, 60 lives\nseeds 60..1790, 1730 lives\n")
            .expect("the file can be written");
        assert_eq!(next_seed(&log).expect("the log has lines"), 1790);
        fs::write(&log, "nothing\n").expect("the file can be written");
        assert!(next_seed(&log).is_err());
        fs::remove_file(&log).expect("the file can be removed");
    }
}
