//! Interface to the host's threads: the step only states the number of independent tasks.

use crate::pool::Pool;
use std::sync::Arc;

/// Runs independent tasks, on any number of threads.
///
/// The division of work never depends on the number of threads, so every runner gives the same bits.
pub trait TaskRunner: Sync {
    /// Calls `task` `count` times, on any threads, in any order, and returns when all calls have returned. The task
    /// itself decides which work a call does.
    fn run(&self, count: usize, task: &(dyn Fn() + Sync));
}

/// Runs all calls on the calling thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl TaskRunner for Serial {
    fn run(&self, count: usize, task: &(dyn Fn() + Sync)) {
        for _ in 0..count {
            task();
        }
    }
}

/// A fixed number of threads, for hosts without a thread pool. The threads start once, wait between batches, and end
/// when the last clone is dropped.
///
/// Only one batch uses the threads at a time. A batch that starts while another runs (within a task, or on another host
/// thread) runs on its caller's thread alone. A panic in a task ends its batch and continues in the caller.
#[derive(Clone)]
pub struct Threads {
    pool: Arc<Pool>,
}

impl Threads {
    /// Starts threads for `count` in all, including the caller's; 0 counts as 1. If the system provides fewer (wasm:
    /// none), batches use those.
    pub fn new(count: usize) -> Self {
        Self { pool: Arc::new(Pool::new(count.saturating_sub(1))) }
    }

    /// Number of threads, including the caller's.
    pub fn count(&self) -> usize {
        self.pool.workers() + 1
    }
}

impl core::fmt::Debug for Threads {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Threads").field("count", &self.count()).finish()
    }
}

impl TaskRunner for Threads {
    fn run(&self, count: usize, task: &(dyn Fn() + Sync)) {
        self.pool.run(count, task);
    }
}
