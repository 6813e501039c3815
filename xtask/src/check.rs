//! Checks before a commit: format, lints, project rules, and tests of the changed crates.

use crate::{ci, command, tidy};
use anyhow::Result;
use std::process::Command;

/// `cargo xtask check`.
#[derive(clap::Args)]
pub struct Check {
    /// Commit to compare with; changes since then are tested, committed or not
    #[arg(long, value_name = "COMMIT", default_value = "HEAD")]
    since: String,
}

impl Check {
    /// Runs format, lints, project rules and the tests of changed crates, in this order, up to the first failure.
    ///
    /// # Errors
    /// If a check fails, or git fails.
    pub fn run(&self) -> Result<()> {
        let changed = self.changed()?;
        ci::fmt()?;
        ci::clippy()?;
        tidy::Tidy::CHECK.run()?;
        if changed.is_empty() {
            eprintln!("no crate changed since {}: no tests run", self.since);
            return Ok(());
        }
        let mut test = command::cargo(&["test", "--quiet"]);
        for package in &changed {
            test.args(["--package", package]);
        }
        command::run(&mut test)
    }

    /// Returns the crates with a changed, added or removed file, by name.
    fn changed(&self) -> Result<Vec<String>> {
        let mut git = Command::new("git");
        let tracked =
            command::output(git.current_dir(command::root()).args(["diff", "--name-only", &self.since]))?;
        let mut git = Command::new("git");
        let listed = ["ls-files", "--others", "--exclude-standard"];
        let untracked = command::output(git.current_dir(command::root()).args(listed))?;
        let mut packages: Vec<_> = tracked.lines().chain(untracked.lines()).filter_map(package_of).collect();
        packages.sort_unstable();
        packages.dedup();
        Ok(packages)
    }
}

/// Returns the crate of a file.
fn package_of(path: &str) -> Option<String> {
    match path.split('/').collect::<Vec<_>>()[..] {
        ["crates", package, _, ..] => Some(package.to_owned()),
        ["xtask", _, ..] => Some("xtask".to_owned()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::package_of;

    #[test]
    fn files_belong_to_crates() {
        assert_eq!(package_of("crates/sinew_math/src/lanes/mod.rs").as_deref(), Some("sinew_math"));
        assert_eq!(package_of("xtask/golden.txt").as_deref(), Some("xtask"));
        assert_eq!(package_of("docs/step.md"), None);
        assert_eq!(package_of("bench/peers/src/main.rs"), None);
    }
}
