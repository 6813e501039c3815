//! Objects that are kept next to a world, and their deeds. There are none here; the ragdoll crate replaces this file by
//! one with characters.

use crate::actor::Twin;
use crate::deeds::Deed;
use crate::numbers::Temper;
use crate::watch::Fault;
use core::ops::Range;
use sinew_physics::World;

/// Types whose public methods the lives call.
pub const CALLED: &[&str] = &["World"];
/// Additional deeds, and the names of the deeds that create the initial objects.
pub const DEEDS: &[&[Deed]] = &[];
pub const MAKERS: &[&str] = &[];
/// Range of the number of steps in which a life does deeds.
pub const BUSY: Range<u32> = 20..100;

/// Objects kept next to a world.
pub struct Extension;

impl Extension {
    pub fn new() -> Self {
        Self
    }

    /// Returns the objects for a copy of the world.
    pub fn twin(&self, _: Twin) -> Self {
        Self
    }

    pub fn before_step(&mut self, _: &mut World) {}

    pub fn after_step(&mut self, _: &mut World) {}

    /// Returns the bytes of the objects' state.
    pub fn state(&self) -> Vec<u8> {
        Vec::new()
    }

    /// Returns the events of the last step.
    pub fn events(&self) -> String {
        String::new()
    }

    /// Returns whether the objects release energy that the checks do not count.
    pub fn drives(&self) -> bool {
        false
    }

    /// Checks the objects after a step; `quiet` is the number of steps since the last deed.
    ///
    /// # Errors
    /// If a check fails.
    pub fn look(&mut self, _: &World, _: Temper, _quiet: u32) -> Result<(), Fault> {
        Ok(())
    }

    /// Removes all of the objects from the world.
    pub fn empty(&mut self, _: &mut World) {}
}
