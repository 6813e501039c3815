//! Sinew for C: worlds, bodies, joints, queries, snapshots, ragdolls and characters behind opaque handles.
//!
//! The header is `include/sinew.h`, made of this file and those beside it by `cbindgen`; docs/c.md of the repository is its guide. No
//! panic passes the border: every function gives a [`SinewStatus`], and [`sinew_last_error`] a sentence.
// `forbid` cannot be lifted; the modules below are the list.
#![deny(unsafe_code)]

#[allow(unsafe_code)]
mod border;
#[allow(unsafe_code)]
mod character;
#[allow(unsafe_code)]
mod joint;
#[allow(unsafe_code)]
mod query;
#[allow(unsafe_code)]
mod ragdoll;
#[allow(unsafe_code)]
mod snapshot;
mod types;
#[allow(unsafe_code)]
mod world;

pub use border::*;
pub use character::*;
pub use joint::*;
pub use query::*;
pub use ragdoll::*;
pub use snapshot::*;
pub use types::*;
pub use world::*;
