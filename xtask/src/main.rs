//! All automation of this repository: `cargo xtask ci | tidy | golden`.
#![forbid(unsafe_code)]

mod ci;
mod command;
mod contract;
mod golden;
mod tidy;

use clap::{Parser, Subcommand};

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Automation of the Sinew repository")]
struct Xtask {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Everything that must hold before a change is merged, but for `cargo test --workspace`
    Ci(ci::Ci),
    /// The rules of the house that no compiler checks
    Tidy(tidy::Tidy),
    /// State hashes of all scenes, against the committed ones
    Golden(golden::Golden),
}

fn main() -> anyhow::Result<()> {
    match Xtask::parse().task {
        Task::Ci(ci) => ci.run(),
        Task::Tidy(tidy) => tidy.run(),
        Task::Golden(golden) => golden.run(),
    }
}
