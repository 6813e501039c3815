//! Machine on which the results are measured.

use std::fmt;
use std::fs;
use std::process::Command;
use std::thread;

/// Known properties of a machine.
#[derive(Clone, Debug)]
pub struct Machine {
    processor: String,
    cores: usize,
    compiler: String,
    /// Average load over a minute at the time of measurement.
    load: Option<String>,
}

impl Machine {
    /// Returns the present machine.
    pub fn this() -> Self {
        let cpu = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = cpu.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
        let load = fs::read_to_string("/proc/loadavg").ok();
        Self {
            processor: model.map_or(std::env::consts::ARCH, |(_, model)| model).to_owned(),
            cores: thread::available_parallelism().map_or(1, core::num::NonZero::get),
            compiler: printed("rustc", &["--version"]),
            load: load.and_then(|load| load.split_whitespace().next().map(str::to_owned)),
        }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} cores of {}, {}.", self.cores, self.processor, self.compiler)?;
        if let Some(load) = &self.load {
            writeln!(
                f,
                "{load} processes wanted to run while this was measured: times of a busy machine scatter, their ratios less so,\n\
                 because engines take turns, round by round. Differences under 20 % are none."
            )?;
        }
        Ok(())
    }
}

/// Returns the commit in the working tree.
pub fn revision() -> String {
    let commit = printed("git", &["show", "--no-patch", "--format=%h of %cs", "HEAD"]);
    // The page that is being written does not count as a change.
    let but_the_page = format!(":(exclude){}", super::PAGE);
    let changes =
        printed("git", &["status", "--porcelain", "--untracked-files=no", "--", ".", &but_the_page]);
    if changes.is_empty() { commit } else { format!("{commit} with changes") }
}

/// Returns the output of a program; empty if the program is missing.
fn printed(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).current_dir(crate::command::root()).output();
    output.map_or(String::new(), |output| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
