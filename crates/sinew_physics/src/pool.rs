//! Threads that wait for work, for [`Threads`](crate::runner::Threads).
//!
//! A batch is on the stack of its caller. Workers reach the batch by a pointer guarded by one word, the *gate*, which
//! stores whether a batch is open, its number, and the number of workers inside. A worker enters only by incrementing
//! that number while the gate is open. The caller does not return before it has closed the gate and the number is 0.
#![allow(unsafe_code)]

use core::any::Any;
use core::hint::spin_loop;
use core::sync::atomic::{AtomicBool, AtomicPtr, AtomicU64, AtomicUsize, Ordering};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, JoinHandle};

/// Number of polls of the gate before a thread sleeps: some 10 to 40 µs. That exceeds the gap between two batches of a
/// stage and is about the cost of waking.
const SPINS: u32 = 1_000;

/// Bits of the gate for the number of workers inside.
const INSIDE: u64 = (1 << 30) - 1;
/// Gate flag: the caller sleeps until the last worker has left.
const AWAITED: u64 = 1 << 30;
/// Gate flag: a batch is open.
const OPEN: u64 = 1 << 31;
/// Gate field: the number of the batch, in the upper bits, so that no worker enters the same batch twice.
const ONE_BATCH: u64 = 1 << 32;

/// A number of calls of one task.
struct Batch<'a> {
    task: &'a (dyn Fn() + Sync),
    count: usize,
    /// Number of calls begun, or more.
    begun: AtomicUsize,
    /// Payload of the first call that panicked.
    panic: Mutex<Option<Box<dyn Any + Send>>>,
}

impl Batch<'_> {
    /// Takes calls until none are left. A panic ends the batch.
    fn work(&self) {
        while self.begun.fetch_add(1, Ordering::Relaxed) < self.count {
            if let Err(payload) = catch_unwind(AssertUnwindSafe(self.task)) {
                // Half the range: increments cannot overflow it, and it exceeds every count.
                self.begun.store(usize::MAX / 2, Ordering::Relaxed);
                self.panic.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(payload);
                return;
            }
        }
    }
}

/// State that the threads of a pool share.
#[derive(Default)]
struct Shared {
    gate: AtomicU64,
    /// Pointer to the batch, while the gate is open or workers are inside.
    batch: AtomicPtr<Batch<'static>>,
    /// True while a batch runs; a nested batch runs on its caller's thread alone.
    is_busy: AtomicBool,
    /// True when the workers must end.
    is_closing: AtomicBool,
    /// Number of workers that sleep or are about to sleep.
    asleep: AtomicUsize,
    /// Mutex that sleepers hold while they poll the gate; it holds no data.
    sleep: Mutex<()>,
    wake: Condvar,
    /// Mutex for waiting until the last worker has left; it holds no data.
    wait: Mutex<()>,
    out: Condvar,
}

fn lock(mutex: &Mutex<()>) -> MutexGuard<'_, ()> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    /// Opens `batch` to workers, makes calls on this thread too, and waits until all workers have left.
    fn run(&self, batch: &Batch<'_>, workers: usize) {
        self.batch.store(core::ptr::from_ref(batch).cast_mut().cast(), Ordering::Relaxed);
        // No worker is inside, and no other thread opens the gate.
        let number = self.gate.load(Ordering::Relaxed) & !(OPEN | AWAITED | INSIDE);
        // SeqCst, as for `asleep`: this thread reads that a worker sleeps, or the worker reads that the gate is open.
        self.gate.store(number.wrapping_add(ONE_BATCH) | OPEN, Ordering::SeqCst);
        if self.asleep.load(Ordering::SeqCst) > 0 {
            // A thread about to sleep holds this mutex from its last poll of the gate on; it must not wake into a held
            // lock.
            drop(lock(&self.sleep));
            for _ in 0..workers.min(batch.count - 1) {
                self.wake.notify_one();
            }
        }
        batch.work();
        self.gate.fetch_and(!OPEN, Ordering::AcqRel);
        self.wait_until_out();
    }

    fn wait_until_out(&self) {
        for _ in 0..SPINS {
            if self.gate.load(Ordering::Acquire) & INSIDE == 0 {
                return;
            }
            spin_loop();
        }
        let mut waiting = lock(&self.wait);
        if self.gate.fetch_or(AWAITED, Ordering::AcqRel) & INSIDE == 0 {
            return; // the next batch clears the mark
        }
        while self.gate.load(Ordering::Acquire) & INSIDE != 0 {
            waiting = self.out.wait(waiting).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Runs batches until shutdown: the loop of a worker.
    fn serve(&self) {
        let mut last = 0;
        while let Some(number) = self.enter_next(last) {
            last = number;
            let batch = self.batch.load(Ordering::Relaxed);
            // SAFETY: this worker is inside, by a compare-exchange (Acquire) on a gate that was open, so the pointer is
            // the one stored before the gate was opened (SeqCst store). The caller of `run` keeps the batch alive and
            // in place until this worker leaves: even if a call panics (`work` catches panics), it does not return
            // until no thread is inside. Nothing of the batch is used after `leave`.
            unsafe { &*batch }.work();
            self.leave();
        }
    }

    /// Waits for a batch with a number other than `last` and enters; returns its number, or `None` at shutdown.
    fn enter_next(&self, last: u64) -> Option<u64> {
        for _ in 0..SPINS {
            if let Some(number) = self.try_enter(last) {
                return Some(number);
            }
            if self.is_closing.load(Ordering::Relaxed) {
                return None;
            }
            spin_loop();
        }
        let mut sleeping = lock(&self.sleep);
        self.asleep.fetch_add(1, Ordering::SeqCst);
        let entered = loop {
            if let Some(number) = self.try_enter(last) {
                break Some(number);
            }
            if self.is_closing.load(Ordering::SeqCst) {
                break None;
            }
            sleeping = self.wake.wait(sleeping).unwrap_or_else(PoisonError::into_inner);
        };
        self.asleep.fetch_sub(1, Ordering::SeqCst);
        entered
    }

    /// Enters if the gate is open and the batch's number differs from `last`; returns the number of the batch.
    fn try_enter(&self, last: u64) -> Option<u64> {
        let mut gate = self.gate.load(Ordering::SeqCst);
        loop {
            let number = gate & !(OPEN | AWAITED | INSIDE);
            if gate & OPEN == 0 || number == last {
                return None;
            }
            match self.gate.compare_exchange_weak(gate, gate + 1, Ordering::AcqRel, Ordering::SeqCst) {
                Ok(_) => return Some(number),
                Err(now) => gate = now,
            }
        }
    }

    fn leave(&self) {
        let before = self.gate.fetch_sub(1, Ordering::AcqRel);
        if before & (INSIDE | AWAITED) == 1 | AWAITED {
            let _out = lock(&self.wait);
            self.out.notify_all();
        }
    }
}

/// Threads that sleep until there is work. They end when the pool is dropped.
pub(crate) struct Pool {
    shared: Arc<Shared>,
    workers: Vec<JoinHandle<()>>,
}

impl Pool {
    /// Creates a pool with `workers` threads in addition to the caller's, or as many as the system allows.
    pub fn new(workers: usize) -> Self {
        let shared = Arc::new(Shared::default());
        let start = |number: usize| {
            let shared = shared.clone();
            thread::Builder::new().name(format!("sinew-{number}")).spawn(move || shared.serve()).ok()
        };
        let workers = (1..=workers).map_while(start).collect();
        Self { shared, workers }
    }

    /// Number of threads in addition to the caller's.
    pub fn workers(&self) -> usize {
        self.workers.len()
    }

    /// Calls `task` `count` times; while the pool is busy, on this thread alone.
    ///
    /// # Panics
    /// If a call panics, with the payload of that panic, after all running calls have ended; remaining calls are
    /// skipped.
    pub fn run(&self, count: usize, task: &(dyn Fn() + Sync)) {
        let is_alone = count <= 1 || self.workers.is_empty();
        if is_alone || self.shared.is_busy.swap(true, Ordering::Acquire) {
            return (0..count).for_each(|_| task());
        }
        let batch = Batch { task, count, begun: AtomicUsize::new(0), panic: Mutex::default() };
        self.shared.run(&batch, self.workers.len());
        self.shared.is_busy.store(false, Ordering::Release);
        if let Some(payload) = batch.panic.into_inner().unwrap_or_else(PoisonError::into_inner) {
            resume_unwind(payload);
        }
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        self.shared.is_closing.store(true, Ordering::SeqCst);
        drop(lock(&self.shared.sleep));
        self.shared.wake.notify_all();
        for worker in self.workers.drain(..) {
            // The worker catches panics of calls, and nothing else in the worker panics.
            let _ = worker.join();
        }
    }
}
