//! State hashes of all scenes: equal in debug and release, on one thread and on several, and to the committed ones.

use crate::command::{self, Profile};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::Path;
use std::process::Command;

/// Committed hashes, one line per scene: name, steps, hash.
const PATH: &str = "xtask/golden.txt";

/// Number of steps for a scene whose hash is stored for the first time: ten seconds, enough for most to fall asleep.
const STEPS_DEFAULT: u32 = 600;

/// A build and a number of threads.
type Variant = (Profile, u32);

/// The variant that differs in both build and thread count, enough to detect a difference.
const DIAGONAL: &[Variant] = &[(Profile::Debug, 1), (Profile::Release, 2)];

/// Every combination of build and thread count, which identifies the cause of a difference.
const ALL: &[Variant] =
    &[(Profile::Debug, 1), (Profile::Debug, 2), (Profile::Release, 1), (Profile::Release, 2)];

/// `cargo xtask golden`: all builds and thread counts.
#[derive(clap::Args)]
pub struct Golden {
    /// Store the hashes of this build as the expected ones
    #[arg(long)]
    bless: bool,
}

impl Golden {
    /// # Errors
    /// If a hash differs from the committed one or between variants, or a scene does not run.
    pub fn run(&self) -> Result<()> {
        if !self.bless {
            return verify(ALL);
        }
        let previous = read()?;
        let found = observe(&previous, ALL)?;
        let lines: String = found.iter().map(|golden| format!("{golden}\n")).collect();
        fs::write(command::root().join(PATH), lines).context(PATH)
    }
}

/// Extent of the check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// Only the diagonal: debug on one thread, release on two.
    Diagonal,
    /// All builds × thread counts.
    All,
}

/// Runs the scenes and compares with the committed hashes.
///
/// # Errors
/// The errors of [`Golden::run`].
pub fn check(coverage: Coverage) -> Result<()> {
    verify(match coverage {
        Coverage::Diagonal => DIAGONAL,
        Coverage::All => ALL,
    })
}

fn verify(variants: &[Variant]) -> Result<()> {
    let committed = read()?;
    let differences = differences(&committed, &observe(&committed, variants)?);
    if !differences.is_empty() {
        bail!(
            "{}\nif that is intended: `cargo xtask golden --bless`, and a [bits] line in CHANGELOG.md",
            differences.join("\n")
        );
    }
    Ok(())
}

/// State of a scene after some steps.
#[derive(Clone, Debug, PartialEq, Eq)]
struct GoldenHash {
    scene: String,
    steps: u32,
    hash: String,
}

impl std::fmt::Display for GoldenHash {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {} {}", self.scene, self.steps, self.hash)
    }
}

/// Returns the committed steps and hash of a scene.
///
/// # Errors
/// If there is no such scene.
pub fn committed(scene: &str) -> Result<(u32, String)> {
    let found = read()?.into_iter().find(|golden| golden.scene == scene);
    found.map(|golden| (golden.steps, golden.hash)).with_context(|| format!("{PATH} has no `{scene}`"))
}

fn read() -> Result<Vec<GoldenHash>> {
    let path = command::root().join(PATH);
    parse(&fs::read_to_string(path).context(PATH)?)
}

fn parse(text: &str) -> Result<Vec<GoldenHash>> {
    let line = |(index, line): (usize, &str)| match line.split_whitespace().collect::<Vec<_>>()[..] {
        [scene, steps, hash] if steps.parse::<u32>().is_ok() => {
            Ok(GoldenHash { scene: scene.into(), steps: steps.parse()?, hash: hash.into() })
        }
        _ => bail!("{PATH}:{}: not `scene steps hash`", index + 1),
    };
    text.lines().enumerate().map(line).collect()
}

/// Returns the hashes of all scenes listed by the command line, for the steps in `known`.
fn observe(known: &[GoldenHash], variants: &[Variant]) -> Result<Vec<GoldenHash>> {
    let binaries =
        |profile| variants.iter().find(|&&(p, _)| p == profile).map(|_| command::build_sinew(profile));
    let debug = if variants == DIAGONAL {
        Some(command::sinew_of_tests()?)
    } else {
        binaries(Profile::Debug).transpose()?
    };
    let release = binaries(Profile::Release).transpose()?;
    let binary = |profile| match profile {
        Profile::Debug => debug.clone(),
        Profile::Release => release.clone(),
    };
    let any = binary(variants[0].0).context("no build to run")?;
    let mut observed = Vec::new();
    for scene in scenes(&any)? {
        let steps =
            known.iter().find(|golden| golden.scene == scene).map_or(STEPS_DEFAULT, |golden| golden.steps);
        let mut hashes = variants_at_once(variants, |profile, threads| {
            hash(&binary(profile).context("no build to run")?, &scene, steps, threads)
        })?;
        if hashes.iter().any(|hash| *hash != hashes[0]) {
            let shown = variants.iter().zip(&hashes);
            let shown: Vec<String> =
                shown.map(|((profile, threads), hash)| format!("{profile:?} × {threads}: {hash}")).collect();
            bail!("{scene}: builds disagree after {steps} steps: {}", shown.join(", "));
        }
        eprintln!("  {scene} {steps} {}", hashes[0]);
        observed.push(GoldenHash { scene, steps, hash: hashes.swap_remove(0) });
    }
    Ok(observed)
}

/// Runs all variants at the same time; returns their results in order.
fn variants_at_once(
    variants: &[Variant],
    run: impl Fn(Profile, u32) -> Result<String> + Sync,
) -> Result<Vec<String>> {
    std::thread::scope(|scope| {
        let started: Vec<_> = variants
            .iter()
            .map(|&(profile, threads)| {
                let run = &run;
                scope.spawn(move || run(profile, threads))
            })
            .collect();
        started.into_iter().map(|it| it.join().expect("no run may panic")).collect()
    })
}

fn scenes(binary: &Path) -> Result<Vec<String>> {
    let listed = command::output_json(Command::new(binary).args(["scenes", "--json"]))?;
    let scenes = listed["scenes"].as_array().context("`sinew scenes --json`: no `scenes`")?;
    let names: Option<Vec<String>> =
        scenes.iter().map(|scene| scene["name"].as_str().map(str::to_owned)).collect();
    names.context("`sinew scenes --json`: a scene without a name")
}

fn hash(binary: &Path, scene: &str, steps: u32, threads: u32) -> Result<String> {
    let mut run = Command::new(binary);
    run.args(["run", scene, "--json", "--steps", &steps.to_string(), "--threads", &threads.to_string()]);
    let report = command::output_json(&mut run)?;
    let hash = report["hash"].as_str().filter(|hash| hash.len() == 16);
    Ok(hash.with_context(|| format!("`sinew run {scene} --json`: no `hash` of 16 digits"))?.to_owned())
}

/// Returns one line per scene that is new, removed or different.
fn differences(committed: &[GoldenHash], found: &[GoldenHash]) -> Vec<String> {
    let of = |list: &[GoldenHash], scene: &str| list.iter().find(|golden| golden.scene == scene).cloned();
    let mut lines = Vec::new();
    for golden in found {
        match of(committed, &golden.scene) {
            None => lines.push(format!("{}: not in {PATH}", golden.scene)),
            Some(old) if old.hash != golden.hash => {
                lines.push(format!(
                    "{}: {} after {} steps, not {}",
                    golden.scene, golden.hash, golden.steps, old.hash
                ));
            }
            Some(_) => {}
        }
    }
    let gone = committed.iter().filter(|golden| of(found, &golden.scene).is_none());
    lines.extend(
        gone.map(|golden| format!("{}: in {PATH}, but `sinew scenes` does not list it", golden.scene)),
    );
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn added_removed_and_different_scenes_are_reported() {
        let committed = parse("a 10 aa\nb 20 bb\nc 30 cc\n").expect("well formed");
        assert_eq!(differences(&committed, &committed), [""; 0]);
        let found = parse("a 10 aa\nb 20 b0\nd 30 dd\n").expect("well formed");
        assert_eq!(
            differences(&committed, &found),
            [
                "b: b0 after 20 steps, not bb",
                "d: not in xtask/golden.txt",
                "c: in xtask/golden.txt, but `sinew scenes` does not list it"
            ]
        );
    }

    #[test]
    fn a_malformed_line_is_named() {
        let error = parse("a 10 aa\nb ten bb").expect_err("`ten` is no number");
        assert_eq!(error.to_string(), "xtask/golden.txt:2: not `scene steps hash`");
    }
}
