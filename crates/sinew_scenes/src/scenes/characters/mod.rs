//! Characters that play clips and walk about.

pub(super) mod arena;
pub(super) mod blending;
pub(super) mod brawl;
pub(super) mod callbacks;
pub(super) mod cape;
pub(super) mod hair;
pub(super) mod mocap;
pub(super) mod movers;
pub(super) mod skirt;
pub(super) mod street;
pub(super) mod transitions;
pub(super) mod walking;
mod worn;
