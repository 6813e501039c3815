//! Contacts of two shapes through particles of a group that are pinched between them, and what those press the particles with.
//!
//! A particle of some grams cannot bear a body: its own contacts with the two would push it from the one into the other. So
//! bodies are held apart by contacts of their own, with a point on each particle that is between them, which are solved with
//! all others; see [`crate::step::pinched`]. The particle stays where it is pinched, and rubs with what it bears.

use crate::contact::{Contact, ContactKey};
use crate::particles::tuning::{LEAST_NIP, PINCHING};
use sinew_math::max;

/// True if a particle stays between two surfaces that press it, of which the slipperier has this friction; `cosine` is that of the angle between their normals.
///
/// What presses it from both goes along the middle of their normals, which must lie in both cones of friction: half the angle at which they open,
/// that of nip of roller mills, is no more than that of friction. Surfaces that do not face each other press it nowhere, however rough they are.
pub(crate) fn is_nipped(cosine: f32, friction: f32) -> bool {
    let slope = max(friction, LEAST_NIP);
    // Square of the cosine of half the angle at which they open.
    cosine < PINCHING && 0.5 * (1.0 - cosine) * (1.0 + slope * slope) >= 1.0
}

/// Pinched contacts of a group.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pinched {
    /// As the last step left them, in the order in which they were found, less those of shapes that are gone.
    pub contacts: Vec<Contact>,
    /// Force with which shapes press each particle from two sides, N.
    pub loads: Vec<f32>,
}

impl Pinched {
    /// Drops contacts of shapes that go.
    pub fn forget(&mut self, goes: impl Fn(&ContactKey) -> bool) {
        self.contacts.retain(|contact| !goes(&contact.key));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_faces_is_nipped_up_to_the_angle_of_friction() {
        // Half of 30° and of 80°, with the slope of 21.8°.
        assert!(is_nipped(-0.866, 0.4) && !is_nipped(-0.1737, 0.4));
        // What looks the same way presses nothing, however rough.
        assert!(!is_nipped(0.999_999_94, 1e4) && !is_nipped(0.5, 1e4) && is_nipped(-0.5, 1e4));
        assert!(is_nipped(-1.0, 0.0));
    }
}
