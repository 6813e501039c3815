//! Objects kept beside a world, with their own deeds: none here. The lives of the ragdoll crate use the same files and have
//! characters in this place.

use crate::actor::Twin;
use crate::deeds::Deed;
use crate::numbers::Temper;
use crate::watch::Fault;
use core::ops::Range;
use sinew_physics::World;

/// Types whose public methods the lives call.
pub const CALLED: &[&str] = &["World"];
/// Deeds besides those of the world, and names of those that begin a life.
pub const DEEDS: &[&[Deed]] = &[];
pub const MAKERS: &[&str] = &[];
/// Steps with deeds.
pub const BUSY: Range<u32> = 20..100;

/// Objects kept beside a world.
pub struct Extension;

impl Extension {
    pub fn new() -> Self {
        Self
    }

    /// The same beside a copy of the world.
    pub fn twin(&self, _: Twin) -> Self {
        Self
    }

    pub fn before_step(&mut self, _: &mut World) {}

    pub fn after_step(&mut self, _: &mut World) {}

    /// Returns the bytes of its state.
    pub fn state(&self) -> Vec<u8> {
        Vec::new()
    }

    /// Returns the events of the last step.
    pub fn events(&self) -> String {
        String::new()
    }

    /// True if it releases energy that nothing counts.
    pub fn drives(&self) -> bool {
        false
    }

    /// Checks it after a step; `quiet`: steps since the last deed.
    ///
    /// # Errors
    /// If a check fails.
    pub fn look(&mut self, _: &World, _: Temper, _quiet: u32) -> Result<(), Fault> {
        Ok(())
    }

    /// Removes all of it from the world.
    pub fn empty(&mut self, _: &mut World) {}
}
