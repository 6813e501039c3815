//! Counts of a step's work outside islands, reported to a profiler.

use crate::contact::Contact;
use crate::stage::{Counter, Profiler};
use crate::world::World;

impl World {
    /// Reports the counts of the last step from its final contacts, without the contacts of bodies that fell asleep in
    /// that step.
    pub(crate) fn report_counts(&self, profiler: &dyn Profiler) {
        if !profiler.is_counting() {
            return;
        }
        let shapes: usize = self.bodies.iter().map(|(_, body)| body.shapes.len()).sum();
        let pairs = || self.contacts.chunk_by(|one, other| one.key.is_of_pair(other.key));
        let has_points = |parts: &&[Contact]| parts.iter().any(|contact| contact.manifold.count > 0);
        profiler.count(Counter::Shapes, shapes as u64);
        profiler.count(Counter::Pairs, pairs().count() as u64);
        profiler.count(Counter::PairsWithPoints, pairs().filter(has_points).count() as u64);
    }
}
