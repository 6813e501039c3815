//! Threads come from the host: the step only says how many independent tasks there are.

/// Runs independent tasks, on as many threads as it likes.
///
/// How work is split never depends on the number of threads, so every runner gives the same bits.
pub trait TaskRunner: Sync {
    /// Calls `task` `count` times, on any threads, in any order, and returns when all calls have returned.
    /// Which call does which piece of work is not the runner's business.
    fn run(&self, count: usize, task: &(dyn Fn() + Sync));
}

/// Everything on the calling thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl TaskRunner for Serial {
    fn run(&self, count: usize, task: &(dyn Fn() + Sync)) {
        for _ in 0..count {
            task();
        }
    }
}

/// A fixed number of threads, started for each batch of work: simple, for hosts without a pool of their own.
#[derive(Clone, Copy, Debug)]
pub struct Threads {
    count: usize,
}

impl Threads {
    /// `count` threads, the caller's included; 0 counts as 1.
    pub fn new(count: usize) -> Self {
        Self { count: count.max(1) }
    }
}

impl TaskRunner for Threads {
    fn run(&self, count: usize, task: &(dyn Fn() + Sync)) {
        let threads = usize::min(self.count, count);
        if threads <= 1 {
            return Serial.run(count, task);
        }
        let share = |thread: usize| (count * (thread + 1) / threads) - (count * thread / threads);
        std::thread::scope(|scope| {
            for thread in 1..threads {
                scope.spawn(move || Serial.run(share(thread), task));
            }
            Serial.run(share(0), task);
        });
    }
}
