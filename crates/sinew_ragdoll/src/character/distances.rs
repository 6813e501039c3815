//! Level of detail by distance.

use sinew_math::max;

/// Interaction of a character with its world while clips move it, in ascending order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Detail {
    /// No interaction: the character's clips are paused, nothing stops or carries it, and an update costs nothing.
    Frozen,
    /// A mover and clips; rays and contacts do not find the character's limbs.
    Keyed,
    /// In addition hit bodies, which do not flinch: hits below the threshold are only reported.
    HitBodies,
    /// Full interaction. Default.
    #[default]
    Full,
}

/// Distances at which [`Detail`] changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distances {
    /// Largest distance of full detail, metres. Default 15.
    pub full: f32,
    /// Largest distance of hit bodies, metres. Default 40.
    pub hit_bodies: f32,
    /// Largest distance of keyed characters, metres; farther ones are frozen. Default 120.
    pub keyed: f32,
    /// Hysteresis: share by which a distance must be exceeded for less detail. Default 0.1.
    pub slack: f32,
}

impl Default for Distances {
    fn default() -> Self {
        Self { full: 15.0, hit_bodies: 40.0, keyed: 120.0, slack: 0.1 }
    }
}

impl Distances {
    /// Returns the detail at a distance, metres, for a character that has the detail `now`. `NaN` counts as far away.
    pub fn detail(&self, distance: f32, now: Detail) -> Detail {
        let up_to = |limit: f32, detail: Detail| {
            let limit = if now >= detail { limit * (1.0 + max(self.slack, 0.0)) } else { limit };
            distance <= limit
        };
        if up_to(self.full, Detail::Full) {
            Detail::Full
        } else if up_to(self.hit_bodies, Detail::HitBodies) {
            Detail::HitBodies
        } else if up_to(self.keyed, Detail::Keyed) {
            Detail::Keyed
        } else {
            Detail::Frozen
        }
    }
}
