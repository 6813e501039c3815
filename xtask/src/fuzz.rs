//! Fuzzing of the readers: every target of `fuzz/`, one after the other.

use crate::command;
use anyhow::{Result, bail};

const FOLDER: &str = "fuzz";

/// `cargo xtask fuzz`: fuzzes each target for a while.
///
/// Failures are in fuzz/artifacts; the corpus is in fuzz/corpus, from which the next run continues. The corpus starts
/// with the files in fuzz/seeds, and in `../shared/data` if there are any.
#[derive(clap::Args)]
#[command(after_help = "Example: cargo xtask fuzz --target bvh --seconds 600")]
pub struct Fuzz {
    /// Only this target
    #[arg(long = "target", value_name = "NAME")]
    targets: Vec<String>,
    /// How long each target runs
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(1..))]
    seconds: u32,
}

/// A target, the folder of its first inputs besides fuzz/seeds, and the largest input in bytes.
struct Target {
    name: &'static str,
    seeds: &'static str,
    longest: u32,
}

const TARGETS: &[Target] = &[
    Target { name: "animator", seeds: "", longest: 4_096 },
    Target { name: "bvh", seeds: "../shared/data/mocap", longest: 16_384 },
    Target { name: "clip", seeds: "", longest: 4_096 },
    Target { name: "deepmimic", seeds: "../shared/data/mocap", longest: 16_384 },
    Target { name: "draco", seeds: "", longest: 4_096 },
    Target { name: "events", seeds: "", longest: 4_096 },
    Target { name: "fbx", seeds: "", longest: 16_384 },
    Target { name: "gltf", seeds: "../shared/data/rigs", longest: 65_536 },
    Target { name: "jolt", seeds: "../shared/data/peers/jolt", longest: 32_768 },
    Target { name: "physics_gltf", seeds: "../shared/data/peers/omi_physics_joint", longest: 32_768 },
    Target { name: "ragdoll", seeds: "", longest: 16_384 },
    Target { name: "roles", seeds: "", longest: 2_048 },
    Target { name: "settings", seeds: "", longest: 4_096 },
    Target { name: "urdf", seeds: "../shared/data/robots", longest: 16_384 },
];

impl Fuzz {
    /// If a target fails, with its name; or if there is no such target, or no `cargo fuzz`.
    pub fn run(&self) -> Result<()> {
        if let Some(name) =
            self.targets.iter().find(|name| TARGETS.iter().all(|target| target.name != **name))
        {
            let names: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
            bail!("no target `{name}`; there are {}", names.join(", "));
        }
        if command::output(&mut command::cargo(&["fuzz", "--version"])).is_err() {
            bail!("`cargo fuzz` is missing: `cargo install cargo-fuzz`");
        }
        let wanted =
            |target: &&Target| self.targets.is_empty() || self.targets.iter().any(|name| name == target.name);
        let broken: Vec<&str> = TARGETS
            .iter()
            .filter(wanted)
            .filter(|target| self.fuzz(target).is_err())
            .map(|target| target.name)
            .collect();
        if !broken.is_empty() {
            bail!("broken: {}; see {FOLDER}/artifacts", broken.join(", "));
        }
        Ok(())
    }

    fn fuzz(&self, target: &Target) -> Result<()> {
        let corpus = format!("{FOLDER}/corpus/{}", target.name);
        std::fs::create_dir_all(command::root().join(&corpus))?;
        // The fuzzer needs unstable flags.
        let mut fuzz = command::cargo(&["fuzz", "run", "--fuzz-dir", FOLDER, "--target-dir"]);
        fuzz.arg(command::target().join("fuzz")).args([target.name, &corpus]);
        let own = format!("{FOLDER}/seeds/{}", target.name);
        for seeds in [own.as_str(), target.seeds] {
            if !seeds.is_empty() && command::root().join(seeds).is_dir() {
                fuzz.arg(seeds);
            }
        }
        fuzz.args(["--", &format!("-max_total_time={}", self.seconds)]);
        fuzz.args([
            format!("-max_len={}", target.longest),
            "-timeout=10".into(),
            "-rss_limit_mb=1024".into(),
        ]);
        command::run(fuzz.env("RUSTC_BOOTSTRAP", "1"))
    }
}
