//! A rehearsal of a release: everything that a machine can check or build, then the steps left to a person.

use crate::command;
use anyhow::{Context, Result, bail};
use std::env;
use std::fs;
use std::process::Command;

/// Manifests that repeat the version of the workspace, each with the start of its line.
const VERSIONED: [(&str, &str); 5] = [
    ("Cargo.toml", "version = "),
    ("bindings/Cargo.toml", "version = "),
    ("integrations/bevy_sinew/Cargo.toml", "version = "),
    ("integrations/blender/sinew_blender/blender_manifest.toml", "version = "),
    ("bindings/web/package/package.json", "\"version\": "),
];

/// `cargo xtask release`.
#[derive(clap::Args)]
#[command(after_help = "Example: cargo xtask release --dry-run")]
pub struct Release {
    /// Publish nothing; there is no other mode yet, so that no release happens by accident
    #[arg(long, required = true)]
    dry_run: bool,
    /// Leave out the wheel, the npm package and the extension for Blender, which need Python, Node and a network
    #[arg(long)]
    crates_only: bool,
}

impl Release {
    /// # Errors
    /// If versions differ, the change log has no entry, a crate cannot be packed, or an artifact cannot be built.
    pub fn run(&self) -> Result<()> {
        debug_assert!(self.dry_run, "the argument is required");
        let version = same_version()?;
        is_logged(&version)?;
        let mut left = vec!["`cargo xtask ci --full` on a machine with two idle cores".to_owned()];
        left.extend(compare_api()?);
        let publish =
            ["publish", "--workspace", "--exclude", "xtask", "--exclude", "needs_data", "--dry-run"];
        command::run(
            command::cargo(&publish)
                .args(["--allow-dirty", "--target-dir"])
                .arg(command::target().join("packages")),
        )?;
        if !self.crates_only {
            for artifact in ["npm", "blender"] {
                command::run(Command::new(env::current_exe()?).arg(artifact))?;
            }
        }
        left.extend([
            format!("`CHANGELOG.md`: \"Unreleased\" becomes {version} with its day"),
            "`repository` in the manifests".to_owned(),
            format!("`git tag v{version}`; `cargo publish --workspace --exclude xtask --exclude needs_data`"),
            "`cargo publish` in `integrations/bevy_sinew`".to_owned(),
            "wheels of `target/blender/wheels` to PyPI, `npm publish out/npm/sinew-physics.tgz`, the zip of `target/blender`".to_owned(),
        ]);
        println!("Version {version} is ready except for these manual steps:");
        left.iter().enumerate().for_each(|(number, step)| println!("{}. {step}", number + 1));
        Ok(())
    }
}

/// Returns the version of the workspace, which all manifests must repeat.
fn same_version() -> Result<String> {
    let mut versions = Vec::new();
    for (manifest, start) in VERSIONED {
        let text = fs::read_to_string(command::root().join(manifest)).with_context(|| manifest.to_owned())?;
        versions
            .push((manifest, version_in(&text, start).with_context(|| format!("{manifest}: no version"))?));
    }
    let version = versions[0].1.clone();
    if let Some((manifest, other)) = versions.iter().find(|(_, other)| *other != version) {
        bail!("{manifest}: version {other}, not {version}");
    }
    Ok(version)
}

/// Returns the number in quotation marks on the first line with this start.
fn version_in(manifest: &str, start: &str) -> Option<String> {
    let rest = manifest.lines().find_map(|line| line.trim_start().strip_prefix(start))?;
    Some(rest.split('"').nth(1)?.to_owned())
}

/// Checks that the change log names the version or has unreleased changes.
fn is_logged(version: &str) -> Result<()> {
    let log = fs::read_to_string(command::root().join("CHANGELOG.md"))?;
    if !log.lines().any(|line| line == "## Unreleased" || line.starts_with(&format!("## {version}"))) {
        bail!("CHANGELOG.md: neither \"Unreleased\" nor {version}");
    }
    Ok(())
}

/// Compares public names with the last tag; returns the step that is left where there is no tool or no tag.
fn compare_api() -> Result<Option<String>> {
    let tags = command::output(Command::new("git").args(["tag", "--list", "v*", "--sort=-version:refname"]))?;
    let Some(last) = tags.lines().next() else {
        return Ok(Some(
            "no tag to compare the API with: this release is the baseline of `cargo semver-checks`"
                .to_owned(),
        ));
    };
    if !command::answers("cargo-semver-checks") {
        return Ok(Some(format!("`cargo install --locked cargo-semver-checks`, then compare with {last}")));
    }
    let check = [
        "semver-checks",
        "--workspace",
        "--exclude",
        "xtask",
        "--exclude",
        "needs_data",
        "--baseline-rev",
        last,
    ];
    command::run(&mut command::cargo(&check))?;
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn manifests_repeat_the_version() {
        let version = same_version().expect("all manifests agree");
        is_logged(&version).expect("the change log is kept");
    }

    #[test]
    fn version_is_read_from_toml_and_json() {
        assert_eq!(version_in("[a]\nversion = \"1.2.3\"\n", "version = ").as_deref(), Some("1.2.3"));
        assert_eq!(version_in("{\n  \"version\": \"1.2.3\",\n", "\"version\": ").as_deref(), Some("1.2.3"));
        assert_eq!(version_in("name = 1", "version = "), None);
    }
}
