//! Islands as work for threads.

use crate::islands::Island;
use crate::project::{Surroundings, TakenGroup};
use crate::runner::TaskRunner;
use crate::solver::{IslandSolution, IslandSolver, Solution, split_off};
use std::sync::{Mutex, PoisonError};

/// Memory in which islands are solved, one after the other: it comes to be as large as the largest needs it, and stays warm
/// in the cache. Nothing in it lasts from one island to the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Workspace {
    pub solver: IslandSolver,
    pub surroundings: Surroundings,
}

/// The unit of work: an island, and all that its substeps write.
pub(crate) struct Task<'a> {
    pub island: Island<'a>,
    pub groups: &'a mut [TakenGroup],
    pub solution: IslandSolution<'a>,
    pub workspace: Workspace,
}

/// Islands that are still to be solved, with the room for what will come of them.
pub(crate) struct Queue<'a, I> {
    islands: I,
    groups: &'a mut [TakenGroup],
    solution: IslandSolution<'a>,
    idle: &'a mut Vec<Workspace>,
}

impl<'a, I: Iterator<Item = Island<'a>> + Send> Queue<'a, I> {
    /// `groups` and `solution` hold what belongs to the islands in their order.
    pub fn new(
        islands: I,
        groups: &'a mut [TakenGroup],
        solution: &'a mut Solution,
        idle: &'a mut Vec<Workspace>,
    ) -> Self {
        Self { islands, groups, solution: solution.as_mut(), idle }
    }

    /// Calls `work` once for each of the `count` islands, spread over `runner`'s threads.
    ///
    /// DETERMINISM: which thread takes which island, and in which workspace, varies, so `work` must depend on neither.
    pub fn run(self, runner: &dyn TaskRunner, count: usize, work: impl Fn(&mut Task<'_>) + Sync) {
        let queue = Mutex::new(self);
        let lock = || queue.lock().unwrap_or_else(PoisonError::into_inner);
        let work_on_next = || {
            let next = lock().next();
            let Some(mut task) = next else { return false };
            work(&mut task);
            lock().idle.push(task.workspace);
            true
        };
        runner.run(count, &|| {
            work_on_next();
        });
        // A runner that made too few calls must not lose work.
        while work_on_next() {}
    }

    fn next(&mut self) -> Option<Task<'a>> {
        let island = self.islands.next()?;
        Some(Task {
            island,
            groups: split_off(&mut self.groups, island.groups.len()),
            solution: self.solution.split_off(&island),
            workspace: self.idle.pop().unwrap_or_default(),
        })
    }
}
