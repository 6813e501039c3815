//! Commands of the program. Each command is a struct in a separate file.

pub(crate) mod bake;
mod boxes;
mod clip_choice;
mod convert;
mod demo;
mod events;
mod inspect;
mod ragdoll_build;
mod ragdoll_doctor;
mod ragdoll_export;
mod record;
mod replay;
mod run;
mod scenes;
mod view;

use crate::failure::Result;
use crate::report::Report;
use clap::Subcommand;

/// Commands of `sinew`.
#[derive(Subcommand)]
pub enum Command {
    Demo(demo::Demo),
    Bake(Box<bake::Bake>),
    /// Build a ragdoll from a rigged file, diagnose one, or export one to other engines
    #[command(subcommand)]
    Ragdoll(Ragdoll),
    Boxes(boxes::Boxes),
    Inspect(inspect::Inspect),
    Run(run::Run),
    Scenes(scenes::Scenes),
    View(view::View),
    Convert(convert::Convert),
    /// Work on events of clips: propose footsteps
    #[command(subcommand)]
    Events(events::Events),
    Record(record::Record),
    Replay(replay::Replay),
}

/// Commands of `sinew ragdoll`.
#[derive(Subcommand)]
pub enum Ragdoll {
    Build(ragdoll_build::RagdollBuild),
    Doctor(ragdoll_doctor::RagdollDoctor),
    Export(ragdoll_export::RagdollExport),
}

impl Command {
    /// Runs the command.
    pub fn run(&self) -> Result<Report> {
        match self {
            Self::Demo(command) => command.run(),
            Self::Bake(command) => command.run(),
            Self::Ragdoll(Ragdoll::Build(command)) => command.run(),
            Self::Ragdoll(Ragdoll::Doctor(command)) => command.run(),
            Self::Ragdoll(Ragdoll::Export(command)) => command.run(),
            Self::Boxes(command) => command.run(),
            Self::Inspect(command) => command.run(),
            Self::Run(command) => command.run(),
            Self::Scenes(command) => command.run(),
            Self::View(command) => command.run(),
            Self::Convert(command) => command.run(),
            Self::Events(command) => command.run(),
            Self::Record(command) => command.run(),
            Self::Replay(command) => command.run(),
        }
    }
}
