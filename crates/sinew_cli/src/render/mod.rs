//! Rendering: pictures and films of what commands work on.

pub(crate) mod bones;
pub(crate) mod film;
pub(crate) mod framing;
pub(crate) mod show;
pub(crate) mod skin;
