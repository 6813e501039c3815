//! All automation of this repository: `cargo xtask check | ci | tidy | golden | book | ragdolls | wild | bench | new-user | sizes | bindings | blender | npm | release | web | fuzz | lives | soak`.
#![forbid(unsafe_code)]

mod bench;
mod bindings;
mod blender;
mod book;
mod chapters;
mod check;
mod ci;
mod command;
mod contract;
mod formulas;
mod fuzz;
mod golden;
mod landing;
mod new_user;
mod npm;
mod ragdolls;
mod release;
mod searches;
mod sizes;
mod spawns;
mod targets;
mod tidy;
mod web;
mod wild;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Automation of the Sinew repository")]
struct Xtask {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Format, lints, rules and tests of what changed: before a commit
    Check(check::Check),
    /// Everything that must hold before a change is merged, but for `cargo test --workspace`
    Ci(ci::Ci),
    /// The rules of the house that no compiler checks
    Tidy(tidy::Tidy),
    /// State hashes of all scenes, against the committed ones
    Golden(golden::Golden),
    /// The pictures of docs/guide/src/book.md, drawn anew
    Book(book::Book),
    /// The quality of the ragdolls of many rigs, into docs/ragdoll-quality.md
    Ragdolls(ragdolls::Ragdolls),
    /// What is seen in characters from anywhere, how they fall, and pictures of them, into out/wild
    Wild(wild::Wild),
    /// Time and quality beside other engines, into docs/benchmarks.md; or instructions of the kernels
    Bench(bench::Bench),
    /// What README and guide print, built and run in an empty folder outside the workspace
    NewUser(new_user::NewUser),
    /// Size of the library in a page, for the table of the guide
    Sizes(sizes::Sizes),
    /// The libraries for C and Python, built, installed and tried as their users have them
    Bindings(bindings::Bindings),
    /// The npm package `sinew-physics`, built, packed and tried as its users have it
    Npm(npm::Npm),
    /// The extension for Blender as a zip; and its trial in Blender's module for Python
    Blender(blender::Blender),
    /// A rehearsal of a release: versions, packages, artifacts, and the steps that are left to a person
    Release(release::Release),
    /// The viewer as a page, a folder of static files; and its trial in a browser
    Web(web::Web),
    /// Bytes from nowhere against the readers, and clips against the runtime
    Fuzz(fuzz::Fuzz),
    /// Random lives, from where the last run ended
    Lives(searches::Lives),
    /// An hour of game, watched from step to step
    Soak(searches::Soak),
}

fn main() -> ExitCode {
    // Without the backtrace that anyhow adds where RUST_BACKTRACE is set: what was found must not scroll away.
    run().unwrap_or_else(|error| {
        eprintln!("Error: {error:#}");
        ExitCode::FAILURE
    })
}

fn run() -> anyhow::Result<ExitCode> {
    match Xtask::parse().task {
        Task::Check(check) => check.run()?,
        Task::Ci(ci) => ci.run()?,
        Task::Tidy(tidy) => tidy.run()?,
        Task::Golden(golden) => golden.run()?,
        Task::NewUser(user) => user.run()?,
        Task::Sizes(sizes) => sizes.run()?,
        Task::Bindings(bindings) => bindings.run()?,
        Task::Blender(blender) => blender.run()?,
        Task::Book(book) => book.run()?,
        Task::Ragdolls(ragdolls) => ragdolls.run()?,
        Task::Wild(wild) => wild.run()?,
        Task::Fuzz(fuzz) => fuzz.run()?,
        Task::Lives(lives) => lives.run()?,
        Task::Soak(soak) => soak.run()?,
        Task::Npm(npm) => npm.run()?,
        Task::Release(release) => release.run()?,
        Task::Web(web) => web.run()?,
        Task::Bench(bench) => return bench.run(),
    }
    Ok(ExitCode::SUCCESS)
}
