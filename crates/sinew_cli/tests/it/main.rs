//! Tests of the binary from outside: arguments, exit code, stdout and stderr.

mod bake;
mod boxes;
mod contract;
mod convert;
mod corrections;
mod demo;
mod export;
mod garments;
mod manners;
mod ragdoll;
mod readme;
mod recordings;
mod refusals;
mod scenes;
mod sinew;
mod springs;
mod units;
mod usage;
mod verdicts;
mod view;
mod window;

/// The parser of `docs/contract.md` that `cargo xtask` uses to check the demo's report.
#[path = "../../../../xtask/src/contract.rs"]
#[allow(dead_code)] // xtask's tidy rule uses the rest of it
mod contract_table;

/// A small FBX file.
#[path = "../../../sinew_formats/tests/it/fbx_file.rs"]
#[allow(dead_code)] // the tests of formats use the rest of it
mod fbx_file;
