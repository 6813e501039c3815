//! Cabin and showroom; frame rates and times.

pub(super) mod cabin;
pub(super) mod engine;
pub(super) mod showroom;
