//! The stage `store`: copies the arrays of one island's solver to the results for the world.

use super::solution::{IslandSolution, SolvedBody, SolvedJoint};
use crate::body::Velocity;
use crate::solver::IslandSolver;
use crate::solver::body::SolverBody;
use crate::solver::boundary::solution::SolvedContact;
use crate::spatial::{angular, linear};
use crate::stage::Profiler;

impl IslandSolver {
    /// Writes the results of the island.
    pub fn store(&self, solution: &mut IslandSolution<'_>, profiler: &dyn Profiler) {
        self.report_counts(profiler);
        for ((solved, body), v) in solution.bodies.iter_mut().zip(&self.bodies).zip(&self.velocities) {
            let velocity = Velocity { linear: linear(v), angular: angular(v) };
            let SolverBody { index, pose, is_limited, .. } = *body;
            *solved = SolvedBody { index, pose, velocity, is_limited };
        }
        for (solved, joint) in solution.joints.iter_mut().zip(&self.joints) {
            *solved = SolvedJoint {
                index: joint.index,
                limits: joint.limits.map(|limit| limit.of_substeps(1.0 / self.stretch)),
                force: joint.force,
                warm_impulse: joint.warm_impulse.map(|impulse| impulse / self.stretch),
                saturated: joint.saturated,
                mass: joint.mass,
                reaction: joint.reaction,
            };
        }
        solution.work.fill(self.work);
        if self.is_in_lanes() {
            self.contacts.store(self.stretch, solution.contacts);
            return;
        }
        for (solved, rows) in solution.contacts.iter_mut().zip(&self.manifolds) {
            *solved = SolvedContact {
                index: rows.contact,
                found: rows.found(),
                memory: rows.memory.of_substeps(1.0 / self.stretch),
            };
        }
    }
}
