//! Air, water, blasts.

pub(super) mod air;
pub(super) mod blasts;
pub(super) mod water;
