//! Counts of the rows that an island's sweeps visit in a step.

use crate::solver::pass::Pass;

/// Counts of the sweeps of a step. They are cheap enough to be always collected.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::solver) struct Tally {
    pub substeps: u64,
    /// Number of rows that were not skipped.
    pub visits: u64,
    /// Rows of `relax`, counted once for each substep.
    pub(super) pass_rows: u64,
    /// Rows of `solve`, counted in each sweep.
    pub(super) solve_rows: u64,
    pub(super) relax_rows: u64,
}

impl Tally {
    /// Counts sweep number `number` (from 1) of a pass, over `rows` rows.
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
