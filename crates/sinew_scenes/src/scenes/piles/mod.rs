//! Stacks, walls, arches, heaps, and loads on them.

pub(super) mod arch;
pub(super) mod blocks;
pub(super) mod crowds;
pub(super) mod laden;
pub(super) mod settling;
pub(super) mod stacks;
