//! A scene of the registry.

use super::instance::Instance;
use super::setting::{Setting, Settings, Setup};

/// Topic of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Chapter {
    /// Bodies that nothing touches.
    FreeMotion,
    /// Air, water, blasts.
    Fields,
    /// Pendulums, chains, nets.
    Joints,
    /// Friction, rolling, impacts.
    Contacts,
    /// Ropes, cloth, blobs.
    Particles,
    /// Stacks and heaps.
    Piles,
    /// Limp and driven ragdolls.
    Ragdolls,
    /// Clips, movers, simulated characters.
    Characters,
    /// Worlds to look around in.
    Shows,
}

impl Chapter {
    /// Title of the chapter.
    pub fn title(self) -> &'static str {
        match self {
            Self::FreeMotion => "Free motion",
            Self::Fields => "Fields",
            Self::Joints => "Joints",
            Self::Contacts => "Contacts",
            Self::Particles => "Particles and springs",
            Self::Piles => "Piles",
            Self::Ragdolls => "Ragdolls",
            Self::Characters => "Characters",
            Self::Shows => "Shows",
        }
    }
}

/// A named scenario.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// Chapter that contains the scene.
    pub chapter: Chapter,
    /// Name of the scene for `sinew run`.
    pub name: &'static str,
    /// Description for people, one line.
    pub about: &'static str,
    /// Steps of 1/60 s after which the scene's expectations hold.
    pub steps: u32,
    pub(crate) settings: &'static [Setting],
    pub(crate) build: fn(&Setup<'_>) -> Instance,
}

impl Scene {
    /// The scene's settings at their defaults.
    pub fn settings(&self) -> Settings {
        Settings::new(self.settings)
    }

    /// Builds the scene.
    ///
    /// # Panics
    /// If the settings are of another scene, or a required one is missing: see [`Settings::check`].
    pub fn start(&self, settings: &Settings) -> Instance {
        self.start_under(settings, 1.0)
    }

    /// Builds the scene in a world with gravity scaled by a factor, with the expectations of the unscaled gravity. The
    /// expectations must fail wherever gravity matters.
    ///
    /// # Panics
    /// If the settings are those of another scene.
    pub fn start_under(&self, settings: &Settings, gravity_factor: f32) -> Instance {
        (self.build)(&Setup { settings, gravity_factor })
    }
}
