//! Work counts of an island's step, for profilers that collect counts.

use crate::solver::IslandSolver;
use crate::solver::articulation::tree::Link;
use crate::solver::body::SolverBody;
use crate::solver::boundary::tally::Tally;
use crate::solver::contact_rows::ManifoldRows;
use crate::solver::joint::SolverJoint;
use crate::solver::limits::row::LimitRow;
use crate::spatial::Vec6;
use crate::stage::{Counter, Profiler};

/// Passes over all arrays in a substep: one before and one after poses change.
const PER_SUBSTEP: u64 = 2;
/// Passes over all arrays in the rest of the step: `prepare` and `store`.
const PER_STEP: u64 = 2;

impl IslandSolver {
    /// Reports the counts of the step to a profiler at the end of the step.
    pub(in crate::solver) fn report_counts(&self, profiler: &dyn Profiler) {
        if !profiler.is_counting() {
            return;
        }
        let Tally { substeps, visits, pass_rows, solve_rows, relax_rows } = self.tally;
        let resident = self.resident_bytes();
        let row = (size_of::<ManifoldRows>() + 2 * size_of::<Vec6>()) as u64;
        let points: usize = self.manifolds.iter().map(|rows| rows.manifold.count).sum();
        let in_lanes = self.contacts.tally();
        for (counter, by) in [
            (Counter::Bodies, self.links.len() as u64),
            (Counter::BodySubsteps, self.links.len() as u64 * substeps),
            (Counter::Joints, self.joints.len() as u64),
            (Counter::Manifolds, self.manifolds.len() as u64 + in_lanes.manifolds),
            (Counter::Points, points as u64 + in_lanes.points),
            (Counter::LimitRows, self.limits.len() as u64),
            (Counter::PassRows, pass_rows),
            (Counter::SolveRows, solve_rows),
            (Counter::RelaxRows, relax_rows),
            (Counter::Visits, visits + in_lanes.visits),
            (Counter::ResidentBytes, resident),
            (
                Counter::TouchedBytes,
                resident * (PER_STEP + PER_SUBSTEP * substeps) + visits * row + in_lanes.visited_bytes,
            ),
        ] {
            profiler.count(counter, by);
        }
    }

    /// Size of bodies, velocities, joints, manifolds, limits, links, responses and row columns, bytes.
    fn resident_bytes(&self) -> u64 {
        let bytes = self.bodies.len() * size_of::<SolverBody>()
            + self.velocities.len() * size_of::<Vec6>()
            + self.joints.len() * size_of::<SolverJoint>()
            + self.manifolds.len() * size_of::<ManifoldRows>()
            + self.limits.len() * size_of::<LimitRow>()
            + self.links.len() * size_of::<Link>()
            + self.batches.bytes()
            + self.contacts.bytes()
            + self.response.bytes()
            + self.response_cache.bytes()
            + self.limit_blocks.bytes();
        bytes as u64
    }
}
