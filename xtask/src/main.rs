//! All automation of this repository: `cargo xtask check | ci | tidy | golden | book | ragdolls | wild | bench |
//! new-user | sizes | bindings | blender | npm | release | web | fuzz | lives | soak | sample`.
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
mod sample;
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
    /// Format, lints, rules and tests of changed crates: before a commit
    Check(check::Check),
    /// All checks before a merge, besides `cargo test --workspace`
    Ci(ci::Ci),
    /// Project rules that the compiler does not check
    Tidy(tidy::Tidy),
    /// State hashes of all scenes, against the committed ones
    Golden(golden::Golden),
    /// Draw the pictures of docs/guide/src/book.md
    Book(book::Book),
    /// Measure the ragdolls of many rigs, into docs/ragdoll-quality.md
    Ragdolls(ragdolls::Ragdolls),
    /// Recognise, build, drop and picture many characters, into out/wild
    Wild(wild::Wild),
    /// Time and quality beside other engines, into docs/benchmarks.md; or instructions of the kernels
    Bench(bench::Bench),
    /// Build and run the programs of README and guide in an empty folder
    NewUser(new_user::NewUser),
    /// Size of the library in a page, for the guide
    Sizes(sizes::Sizes),
    /// Build, install and test the libraries for C and Python
    Bindings(bindings::Bindings),
    /// Build, pack and test the npm package `sinew-physics`
    Npm(npm::Npm),
    /// The extension for Blender as a zip, and its test in Blender's Python module
    Blender(blender::Blender),
    /// Rehearse a release: versions, packages, artifacts, and the steps left to a person
    Release(release::Release),
    /// The viewer as a page of static files, and its test in a browser
    Web(web::Web),
    /// Fuzz the readers
    Fuzz(fuzz::Fuzz),
    /// Random call sequences, from the seed at which the last run ended
    Lives(searches::Lives),
    /// An hour of simulated time in all scenes, checked after each step
    Soak(searches::Soak),
    /// Draw random comments, messages, test names and page lines, to be judged by a reader
    Sample(sample::Sample),
}

fn main() -> ExitCode {
    // No backtrace from anyhow with RUST_BACKTRACE: it would hide the findings.
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
        Task::Sample(sample) => sample.run()?,
        Task::Npm(npm) => npm.run()?,
        Task::Release(release) => release.run()?,
        Task::Web(web) => web.run()?,
        Task::Bench(bench) => return bench.run(),
    }
    Ok(ExitCode::SUCCESS)
}
