//! Deeds: calls that a game could make between two steps, chosen by random numbers from the current objects.

mod bodies;
mod joints;
mod others;
mod parts;
mod questions;
mod time;

use crate::actor::Actor;
use crate::extension;
use crate::numbers::Numbers;

/// Operation on a world with random arguments. It has no effect if the world has no object to which it applies.
pub struct Deed {
    pub name: &'static str,
    /// Relative frequency.
    pub weight: u32,
    pub run: fn(&mut Actor, &mut Numbers) -> Option<()>,
}

impl Deed {
    pub const fn new(
        name: &'static str,
        weight: u32,
        run: fn(&mut Actor, &mut Numbers) -> Option<()>,
    ) -> Self {
        Self { name, weight, run }
    }
}

/// Returns all deeds.
pub fn all() -> Vec<&'static Deed> {
    let of_the_world = [bodies::ALL, joints::ALL, others::ALL, questions::ALL, time::ALL];
    of_the_world.iter().chain(extension::DEEDS).copied().flatten().collect()
}

/// Names of the deeds that create the initial world.
pub const MAKERS: &[&str] =
    &["add_body", "add_body", "wall", "add_joint", "chain", "add_particles", "add_mover", "add_field"];
