//! The engines, each a file. Calls into C and C++ are in `crate::ffi`, the only module with `unsafe`.

#[cfg(feature = "box3d")]
mod box3d;
#[cfg(feature = "jolt")]
mod jolt;
#[cfg(feature = "ozz")]
mod ozz;
#[cfg(feature = "rapier")]
pub(crate) mod rapier;
mod sinew;

use crate::engine::Engine;

/// An engine by its name, which this binary may lack.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Name on the command line.
    pub name: &'static str,
    /// The engine; `None` if this binary was built without it.
    pub engine: Option<&'static dyn Engine>,
}

/// All engines, ours first.
pub const ENGINES: &[Entry] = &[
    Entry { name: "sinew", engine: Some(&sinew::Sinew) },
    #[cfg(feature = "rapier")]
    Entry { name: rapier::NAME, engine: Some(&rapier::Rapier) },
    #[cfg(not(feature = "rapier"))]
    Entry { name: "rapier", engine: None },
    #[cfg(feature = "box3d")]
    Entry { name: "box3d", engine: Some(&box3d::Box3d) },
    #[cfg(not(feature = "box3d"))]
    Entry { name: "box3d", engine: None },
    #[cfg(feature = "jolt")]
    Entry { name: "jolt", engine: Some(&jolt::Jolt) },
    #[cfg(not(feature = "jolt"))]
    Entry { name: "jolt", engine: None },
    #[cfg(feature = "ozz")]
    Entry { name: "ozz", engine: Some(&ozz::Ozz) },
    #[cfg(not(feature = "ozz"))]
    Entry { name: "ozz", engine: None },
];

/// Returns the engine of that name.
pub fn find(name: &str) -> Option<&'static Entry> {
    ENGINES.iter().find(|entry| entry.name == name)
}
