//! A named scenario.

use super::instance::Instance;
use super::setting::{Setting, Settings, Setup};

/// A named scenario.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// Name of the scene for `sinew run`.
    pub name: &'static str,
    /// One line for people.
    pub about: &'static str,
    /// Steps of 1/60 s after which its expectations hold.
    pub steps: u32,
    pub(crate) settings: &'static [Setting],
    pub(crate) build: fn(&Setup<'_>) -> Instance,
}

impl Scene {
    /// Its settings, all at their defaults.
    pub fn settings(&self) -> Settings {
        Settings::new(self.settings)
    }

    /// Builds it.
    ///
    /// # Panics
    /// If the settings are those of another scene, or one that has to be set is not: see [`Settings::check`].
    pub fn start(&self, settings: &Settings) -> Instance {
        self.start_under(settings, 1.0)
    }

    /// Builds it in a world whose gravity is wrong by a factor, while its expectations remain those of the right one:
    /// they must fail wherever gravity matters.
    ///
    /// # Panics
    /// If the settings are those of another scene.
    pub fn start_under(&self, settings: &Settings, gravity_factor: f32) -> Instance {
        (self.build)(&Setup { settings, gravity_factor })
    }
}
