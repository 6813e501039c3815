//! The pool of `Threads` makes every call of any batch, and joins its threads when it is dropped.

use core::sync::atomic::{AtomicUsize, Ordering};
use sinew_math::Random;
use sinew_physics::{TaskRunner, Threads};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::thread;
use std::time::Duration;

/// Returns the number of calls that a batch of `count` makes.
fn calls(threads: &Threads, count: usize) -> usize {
    let made = AtomicUsize::new(0);
    threads.run(count, &|| _ = made.fetch_add(1, Ordering::Relaxed));
    made.into_inner()
}

#[test]
fn each_batch_makes_every_call() {
    for of in [0, 1, 2, 3, 8] {
        let threads = Threads::new(of);
        assert_eq!(threads.count(), of.max(1));
        for count in [0, 1, 2, 3, 7, 8, 9, 1_000] {
            assert_eq!(calls(&threads, count), count, "{of} threads");
        }
    }
}

/// Runs batches of all sizes, immediately after each other and after pauses in which the workers fall asleep.
#[test]
fn random_batches_lose_no_call() {
    let threads = Threads::new(4);
    let mut random = Random::new(5);
    for round in 0..20_000 {
        let count = (random.unit() * random.unit() * 40.0) as usize;
        let sum = Mutex::new(0);
        let next = AtomicUsize::new(0);
        threads.run(count, &|| {
            let piece = next.fetch_add(1, Ordering::Relaxed);
            *sum.lock().expect("no call may panic") += piece;
        });
        assert_eq!(*sum.lock().expect("no call may panic"), count * count.saturating_sub(1) / 2);
        if round % 1_000 == 0 {
            thread::sleep(Duration::from_millis(2));
        }
    }
}

#[test]
fn calls_of_a_batch_run_at_the_same_time() {
    let threads = Threads::new(2);
    let met = AtomicUsize::new(0);
    // Neither of the two calls returns before both have begun.
    threads.run(2, &|| {
        met.fetch_add(1, Ordering::SeqCst);
        while met.load(Ordering::SeqCst) < 2 {
            thread::yield_now();
        }
    });
}

/// When no calls are left, the caller sleeps until the last call has returned.
#[test]
fn batch_returns_after_its_longest_call() {
    let threads = Threads::new(3);
    for _ in 0..20 {
        let (begun, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
        threads.run(3, &|| {
            if begun.fetch_add(1, Ordering::SeqCst) > 0 {
                thread::sleep(Duration::from_millis(1));
            }
            done.fetch_add(1, Ordering::SeqCst);
        });
        assert_eq!(done.into_inner(), 3);
    }
}

#[test]
fn panic_reaches_the_caller_and_the_pool_stays_usable() {
    let threads = Threads::new(3);
    let mut random = Random::new(9);
    for _ in 0..300 {
        let count = 1 + (random.unit() * 20.0) as usize;
        let bad = (random.unit() * count as f32) as usize;
        let next = AtomicUsize::new(0);
        let batch = || {
            threads.run(count, &|| {
                let piece = next.fetch_add(1, Ordering::Relaxed);
                // `resume_unwind` panics without calling the hook, which would print a message.
                if piece == bad {
                    std::panic::resume_unwind(Box::new(piece));
                }
            });
        };
        let payload =
            catch_unwind(AssertUnwindSafe(batch)).expect_err("the panic of a call must reach the caller");
        assert_eq!(payload.downcast_ref::<usize>(), Some(&bad));
        assert_eq!(calls(&threads, 50), 50);
    }
}

#[test]
fn batches_within_calls_are_made_in_full() {
    let threads = Threads::new(3);
    let inner = AtomicUsize::new(0);
    threads.run(40, &|| {
        inner.fetch_add(calls(&threads, 5), Ordering::Relaxed);
    });
    assert_eq!(inner.into_inner(), 200);
}

#[test]
fn several_threads_of_the_host_may_share_a_pool() {
    let threads = Threads::new(2);
    thread::scope(|scope| {
        for _ in 0..3 {
            let threads = threads.clone();
            scope.spawn(move || (0..500).for_each(|_| assert_eq!(calls(&threads, 7), 7)));
        }
    });
}

#[test]
fn a_pool_can_be_dropped_at_any_time() {
    for round in 0..200 {
        let threads = Threads::new(1 + round % 5);
        if round % 2 == 0 {
            assert_eq!(calls(&threads, round), round);
        }
        if round % 20 == 0 {
            // The workers of the pool are asleep now.
            thread::sleep(Duration::from_millis(2));
        }
        drop(threads);
    }
}
