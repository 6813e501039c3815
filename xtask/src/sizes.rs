//! Size of the library in a page: the table in the guide's chapter on performance.

use crate::command;
use crate::targets::{self, BROWSER};
use anyhow::{Context, Result};
use std::fs;
use std::path::Path;
use std::process::Command;

/// `cargo xtask sizes`: builds the physics alone and the library for WebAssembly and prints the table. Takes about ten
/// minutes.
#[derive(clap::Args)]
pub struct Sizes {
    /// Optimisation levels
    #[arg(long, value_delimiter = ',', default_values_t = ['s', 'z'])]
    opt: Vec<char>,
}

/// A program that steps a world with bodies.
const PHYSICS: &str = r#"use sinew_physics::{BodyDef, Shape, World, WorldDef};
use std::cell::RefCell;
thread_local! { static WORLD: RefCell<World> = RefCell::new(World::new(WorldDef::default())); }
#[unsafe(no_mangle)]
pub extern "C" fn add(x: f32, y: f32, z: f32) {
    WORLD.with_borrow_mut(|world| {
        world.add_body(&BodyDef::fixed(Shape::HalfSpace));
        world.add_body(&BodyDef::dynamic(Shape::sphere(0.5)).at([x, y, z].into()));
    });
}
#[unsafe(no_mangle)]
pub extern "C" fn step() -> f32 {
    WORLD.with_borrow_mut(|world| {
        world.step();
        world.body_ids().map(|id| world.transform(id).translation.y).sum()
    })
}
"#;

/// A program that steps a character from the bytes of a GLB, with built-in motions if the file has none.
const CHARACTER: &str = r#"use sinew::formats::{ReadOptions, no_files, read_gltf};
use sinew::prelude::*;
use std::cell::RefCell;
use std::sync::Arc;
thread_local! { static HERO: RefCell<Option<(World, Character)>> = const { RefCell::new(None) }; }
fn hero(bytes: &[u8]) -> Option<(World, Character)> {
    let document = read_gltf(bytes, ReadOptions::default(), &mut no_files).ok()?;
    let analysis = analyze(&document.rig).ok()?;
    let (ragdoll, _) = build(&document.rig, &analysis, &BuildOptions::default()).ok()?;
    let mut def = CharacterDef::new(document.rig, ragdoll, &analysis.bind_model);
    let motions = MotionSet { clips: document.clips, ..MotionSet::default() };
    sinew::motions::set_motions_with_builtin(&mut def, &analysis, motions).ok()?;
    let mut world = World::new(WorldDef::default());
    world.add_body(&BodyDef::fixed(Shape::HalfSpace));
    let hero = Character::spawn(&mut world, &Arc::new(def), Transform::IDENTITY);
    Some((world, hero))
}
/// # Safety
/// `bytes` must point to `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn load(bytes: *const u8, length: usize) -> bool {
    let bytes = unsafe { core::slice::from_raw_parts(bytes, length) };
    HERO.with_borrow_mut(|here| { *here = hero(bytes); here.is_some() })
}
#[unsafe(no_mangle)]
pub extern "C" fn step() -> f32 {
    HERO.with_borrow_mut(|here| {
        let Some((world, hero)) = here else { return 0.0 };
        world.step();
        hero.update(world);
        hero.pose()[0].translation.y
    })
}
"#;

/// Measured crates, each with a typical program of a page.
const PROGRAMS: &[(&str, &str)] = &[("sinew_physics", PHYSICS), ("sinew", CHARACTER)];

impl Sizes {
    /// Prints the table.
    ///
    /// # Errors
    /// If a program does not compile, or `gzip` is missing.
    pub fn run(&self) -> Result<()> {
        targets::add(BROWSER)?;
        println!("| crate | simd128 | opt-level | bytes | gzip -9 |\n|---|---|---|---|---|");
        for (flags, simd) in [("", "no"), ("-C target-feature=+simd128", "yes")] {
            for &opt in &self.opt {
                for (name, program) in PROGRAMS {
                    let [plain, packed] =
                        measure(name, program, flags, opt).with_context(|| name.to_string())?;
                    println!("| `{name}` | {simd} | `{opt}` | {plain} | {packed} |");
                }
            }
        }
        Ok(())
    }
}

/// Returns the bytes of a program, and its bytes after `gzip -9`.
fn measure(name: &str, program: &str, flags: &str, opt: char) -> Result<[usize; 2]> {
    let folder = command::target().join("sizes").join(name);
    fs::create_dir_all(folder.join("src"))?;
    fs::write(folder.join("src/lib.rs"), program)?;
    let path = command::root().join("crates").join(name);
    let manifest = format!(
        "[package]\nname = \"page\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[lib]\ncrate-type = [\"cdylib\"]\n\n\
         [dependencies]\n{name} = {{ path = {path:?} }}\n\n[profile.release]\nopt-level = \"{opt}\"\nlto = \"fat\"\n\
         codegen-units = 1\nstrip = true\npanic = \"abort\"\n\n[workspace]\n"
    );
    fs::write(folder.join("Cargo.toml"), manifest)?;
    let built = command::target().join("sizes").join(format!("{opt}{}", flags.len()));
    let mut build = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    build.args(["build", "--quiet", "--release", "--target", BROWSER]).current_dir(&folder);
    command::run(build.arg("--target-dir").arg(&built).env("RUSTFLAGS", flags))?;
    let page = built.join(BROWSER).join("release/page.wasm");
    Ok([fs::read(&page)?.len(), packed(&page)?])
}

fn packed(file: &Path) -> Result<usize> {
    let out = Command::new("gzip").args(["-9", "-c"]).arg(file).output().context("gzip")?;
    Ok(out.stdout.len())
}
