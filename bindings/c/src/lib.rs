//! Sinew for C: worlds, bodies, joints, queries, snapshots, ragdolls and characters behind opaque handles.
//!
//! The header `include/sinew.h` is generated from this file and its modules by `cbindgen`; docs/c.md of the repository is its guide.
//! No panic crosses the border: every function returns a [`SinewStatus`], and [`sinew_last_error`] returns the error text.
// `forbid` could not be overridden; the modules below that allow unsafe code are the complete list.
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
