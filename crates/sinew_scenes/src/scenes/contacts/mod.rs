//! Friction, rolling, bounce, moving surfaces, boxes against each other.

pub(super) mod boxes;
pub(super) mod coin;
pub(super) mod impacts;
pub(super) mod incline;
pub(super) mod overhang;
pub(super) mod rolling;
pub(super) mod surfaces;
