//! Contacts of two shapes through particles of a group that are pinched between them, and what those press the particles with.
//!
//! A particle of some grams cannot bear a body: its own contacts with the two would push it from the one into the other. So
//! bodies are held apart by contacts of their own, with a point on each particle that is between them, which are solved with
//! all others; see [`crate::step::pinched`]. The particle stays where it is pinched, and rubs with what it bears.

use crate::contact::Contact;
use crate::particles::tuning::LEAST_NIP;
use sinew_math::max;

/// True if a particle stays between two surfaces that press it, of which the slipperier has this friction; `cosine` is that of the angle between their normals.
///
/// What presses it from both goes along the middle of their normals, which must lie in both cones of friction: half the angle at which they open,
/// that of nip of roller mills, is no more than that of friction.
pub(crate) fn is_nipped(cosine: f32, friction: f32) -> bool {
    let slope = max(friction, LEAST_NIP);
    // Square of the cosine of half the angle at which they open.
    0.5 * (1.0 - cosine) * (1.0 + slope * slope) >= 1.0
}

/// Pinched contacts of a group.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pinched {
    /// As the last step left them, in the order in which they were found.
    pub contacts: Vec<Contact>,
    /// Force with which shapes press each particle from two sides, N.
    pub loads: Vec<f32>,
}
