//! Renders pictures and films for commands.

pub(crate) mod bones;
pub(crate) mod film;
pub(crate) mod framing;
pub(crate) mod show;
pub(crate) mod skin;
