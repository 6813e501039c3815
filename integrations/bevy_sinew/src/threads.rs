//! Runs tasks on Bevy's own threads.

use bevy_ecs::prelude::*;
#[cfg(feature = "reflect")]
use bevy_reflect::std_traits::ReflectDefault;
use bevy_tasks::ComputeTaskPool;
use core::cell::Cell;
use sinew_physics::{Serial, TaskRunner};

/// Threads for a step. The result does not depend on them.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "reflect", derive(bevy_reflect::Reflect), reflect(Resource, Default, Debug, PartialEq))]
pub enum StepThreads {
    /// Threads of Bevy's `ComputeTaskPool`, or one thread without a pool (an app without `TaskPoolPlugin`). Default.
    #[default]
    Bevy,
    /// The thread of the step's system.
    One,
}

/// Runs tasks on Bevy's `ComputeTaskPool`; the calling thread takes its share. A batch that starts within a task runs on its calling
/// thread: a thread that waits for one of Bevy's batches executes other tasks meanwhile, each of which would wait in turn, with growing
/// stack depth.
#[derive(Clone, Copy, Debug, Default)]
pub struct BevyTasks;

thread_local! {
    /// True while this thread runs a batch or a part of one.
    static BUSY: Cell<bool> = const { Cell::new(false) };
}

/// Marks this thread as busy until the value is dropped.
struct Busy(bool);

impl Busy {
    fn new() -> Self {
        Self(BUSY.replace(true))
    }
}

impl Drop for Busy {
    fn drop(&mut self) {
        BUSY.set(self.0);
    }
}

impl TaskRunner for BevyTasks {
    fn run(&self, count: usize, task: &(dyn Fn() + Sync)) {
        let pool = ComputeTaskPool::try_get().filter(|_| count > 1 && !BUSY.get());
        let Some(pool) = pool else { return Serial.run(count, task) };
        let _busy = Busy::new();
        pool.scope(|scope| {
            for _ in 1..count {
                scope.spawn(async {
                    let _busy = Busy::new();
                    task();
                });
            }
            task();
        });
    }
}
