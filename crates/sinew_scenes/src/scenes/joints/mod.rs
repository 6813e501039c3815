//! Pendulums, linkages, motors, springs, chains, nets, trees.

pub(super) mod chains;
pub(super) mod linkages;
pub(super) mod motors;
pub(super) mod nets;
pub(super) mod pendulums;
pub(super) mod springs;
pub(super) mod strings;
pub(super) mod trees;
