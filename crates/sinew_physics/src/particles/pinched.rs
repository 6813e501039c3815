//! Contacts of two shapes through pinched particles of a group, and the resulting pressure on the particles.
//!
//! A particle of a few grams cannot carry a body: its own contacts with two shapes would push it from one into the
//! other. Such shapes therefore have separate contacts, with a point at each particle between them, solved with all
//! other contacts; see [`crate::step::pinched`]. The particle stays where it is pinched, with friction against the
//! shapes.

use crate::contact::{Contact, ContactKey};
use crate::particles::tuning::{LEAST_NIP, PINCHING};
use sinew_math::max;

/// True if a particle is held between two pressing surfaces. `friction` is the smaller coefficient of the two, `cosine`
/// that of the angle between their normals.
///
/// Both surfaces press along the bisector of their normals, which must be within both friction cones: half the angle
/// between the surfaces, the nip angle of roller mills, is at most the friction angle. Surfaces that do not face each
/// other never press a particle, however rough they are.
pub(crate) fn is_nipped(cosine: f32, friction: f32) -> bool {
    let slope = max(friction, LEAST_NIP);
    // Square of the cosine of half the angle between the surfaces.
    cosine < PINCHING && 0.5 * (1.0 - cosine) * (1.0 + slope * slope) >= 1.0
}

/// Contacts through pinched particles of a group.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pinched {
    /// Contacts of the last step, in the order found, without those of removed shapes.
    pub contacts: Vec<Contact>,
    /// Force that presses each particle from two sides, N.
    pub loads: Vec<f32>,
}

impl Pinched {
    /// Drops contacts for which `goes` is true.
    pub fn forget(&mut self, goes: impl Fn(&ContactKey) -> bool) {
        self.contacts.retain(|contact| !goes(&contact.key));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opposing_surfaces_nip_up_to_the_friction_angle() {
        // The opening angles are 30° and 160°, and the slope is that of 21.8°.
        assert!(is_nipped(-0.866, 0.4) && !is_nipped(-0.1737, 0.4));
        // Surfaces that face the same way never press a particle, however rough.
        assert!(!is_nipped(0.999_999_94, 1e4) && !is_nipped(0.5, 1e4) && is_nipped(-0.5, 1e4));
        assert!(is_nipped(-1.0, 0.0));
    }
}
