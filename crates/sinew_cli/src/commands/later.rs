//! Commands of the contract that a later release brings: known by name, so that they are told from typing errors.

use crate::failure::{Failure, Result};
use crate::report::Report;

/// Any arguments.
#[derive(clap::Args)]
pub struct Later {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    arguments: Vec<String>,
}

/// Says that the command, by its full name, is not there yet.
pub fn refuse(command: &str) -> Result<Report> {
    Err(Failure::Usage(format!("'{command}' comes with a later release")))
}
