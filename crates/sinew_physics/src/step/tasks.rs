//! Distribution of islands over threads.

use crate::context::StepContext;
use crate::island::Island;
use crate::runner::TaskRunner;
use crate::slices::split_off;
use crate::solver::boundary::groups::TakenGroup;
use crate::solver::{Grading, IslandSolution, IslandSolver, Pace, Solution, View};
use crate::step::phase::{Phase, solve};
use crate::step::project::Surroundings;
use std::sync::{Mutex, PoisonError};

/// Memory for solving islands one after the other: it grows to the largest island's size and stays in the cache. No
/// data persist between islands.
#[derive(Clone, Debug, Default)]
pub(crate) struct Workspace {
    pub solver: IslandSolver,
    pub surroundings: Surroundings,
}

/// Workspaces in which islands are solved.
pub(crate) enum Workspaces<'a> {
    /// Each task uses any free workspace; no content persists.
    Idle(&'a mut Vec<Workspace>),
    /// Each island uses its own workspace, in the order of islands, and its content persists.
    Own(&'a mut [Workspace]),
}

impl Workspaces<'_> {
    pub fn reborrow(&mut self) -> Workspaces<'_> {
        match self {
            Self::Idle(idle) => Workspaces::Idle(idle),
            Self::Own(own) => Workspaces::Own(own),
        }
    }

    fn take(&mut self, island: usize) -> Workspace {
        match self {
            Self::Idle(idle) => idle.pop().unwrap_or_default(),
            Self::Own(own) => core::mem::take(&mut own[island]),
        }
    }

    fn put_back(&mut self, island: usize, workspace: Workspace) {
        match self {
            Self::Idle(idle) => idle.push(workspace),
            Self::Own(own) => own[island] = workspace,
        }
    }
}

/// The unit of work: an island, and all data that its substeps write.
pub(crate) struct Task<'a> {
    /// Number of the island.
    number: usize,
    pub island: Island<'a>,
    pub groups: &'a mut [TakenGroup],
    pub solution: IslandSolution<'a>,
    pub workspace: Workspace,
}

impl Task<'_> {
    /// Runs the island's whole step with its own number of substeps. If long substeps overreach, runs it again from the
    /// start with the world's number.
    pub fn solve(&mut self, view: &View<'_>, context: &StepContext<'_>) {
        if !self.take_substeps(view, context) {
            let of_world = Pace { grading: Grading::None, ..view.pace };
            self.take_substeps(&View { pace: of_world, ..*view }, context);
        }
        solve(Phase::Store, self, view, context);
    }

    /// Runs all substeps from the start of the step, until one overreaches. Returns true if none did.
    fn take_substeps(&mut self, view: &View<'_>, context: &StepContext<'_>) -> bool {
        solve(Phase::Prepare, self, view, context);
        Phase::of_substeps(self.workspace.solver.substeps()).all(|phase| {
            solve(phase, self, view, context);
            !self.workspace.solver.overreaches()
        })
    }
}

/// Islands that are not solved yet, with space for their results.
pub(crate) struct Queue<'a, I> {
    islands: core::iter::Enumerate<I>,
    /// True for a queue of the large islands, false for one of all others.
    is_of_large: bool,
    groups: &'a mut [TakenGroup],
    solution: IslandSolution<'a>,
    workspaces: Workspaces<'a>,
}

impl<'a, I: Iterator<Item = Island<'a>> + Send> Queue<'a, I> {
    /// Creates a queue; `groups` and `solution` hold the islands' data in the order of islands.
    pub fn new(
        (islands, is_of_large): (I, bool),
        groups: &'a mut [TakenGroup],
        solution: &'a mut Solution,
        workspaces: Workspaces<'a>,
    ) -> Self {
        Self { islands: islands.enumerate(), is_of_large, groups, solution: solution.as_mut(), workspaces }
    }

    /// Calls `work` once for each of the `count` islands, spread over `runner`'s threads.
    ///
    /// DETERMINISM: the thread and workspace of an island vary, so `work` must depend on neither.
    pub fn run(self, runner: &dyn TaskRunner, count: usize, work: impl Fn(&mut Task<'_>) + Sync) {
        let queue = Mutex::new(self);
        let lock = || queue.lock().unwrap_or_else(PoisonError::into_inner);
        let work_on_next = || {
            let next = lock().next();
            let Some(mut task) = next else { return false };
            work(&mut task);
            lock().workspaces.put_back(task.number, task.workspace);
            true
        };
        runner.run(count, &|| {
            work_on_next();
        });
        // If the runner made too few calls, this thread does the remaining work.
        while work_on_next() {}
    }

    /// Returns the next island of this queue that was not solved in `flight`.
    fn next(&mut self) -> Option<Task<'a>> {
        loop {
            let (number, island) = self.islands.next()?;
            let solution = self.solution.split_off(&island);
            if island.is_flown {
                continue;
            }
            let groups = split_off(&mut self.groups, island.groups.len());
            if island.is_large() != self.is_of_large {
                continue;
            }
            return Some(Task { number, island, groups, solution, workspace: self.workspaces.take(number) });
        }
    }
}
