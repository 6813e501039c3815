//! Counts of what the sweeps of an island go through in a step.

use crate::solver::pass::Pass;

/// Counts of what the sweeps of a step have gone through: cheap enough to be added up whether somebody asks or not.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::solver) struct Tally {
    pub substeps: u64,
    /// Rows that were not skipped.
    pub visits: u64,
    /// Rows of `relax`, once for each substep.
    pub(super) pass_rows: u64,
    /// Rows gone through, sweep by sweep.
    pub(super) solve_rows: u64,
    pub(super) relax_rows: u64,
}

impl Tally {
    /// A sweep of a pass, the `number`th from 1, over so many rows.
    pub fn sweep(&mut self, pass: Pass, number: usize, rows: usize) {
        let rows = rows as u64;
        match pass {
            Pass::Solve => self.solve_rows += rows,
            Pass::Relax => self.relax_rows += rows,
            Pass::Restitution => {}
        }
        if pass == Pass::Relax && number == 1 {
            self.pass_rows += rows;
        }
    }
}
