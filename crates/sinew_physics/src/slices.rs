//! Exclusive access to the items of a slice from several threads.
#![allow(unsafe_code)]

use crate::runner::TaskRunner;
use core::sync::atomic::{AtomicUsize, Ordering};

struct Shared<T>(*mut T);

// SAFETY: items are only reached through the claimed indices below, each by one thread, and T may change threads.
unsafe impl<T: Send> Sync for Shared<T> {}

impl<T> Shared<T> {
    fn at(&self, i: usize) -> *mut T {
        self.0.wrapping_add(i)
    }
}

/// Calls `work` once for every item, spread over `runner`'s threads.
///
/// DETERMINISM: which thread takes which item varies, so `work` must depend on its item alone.
pub(crate) fn for_each_mut<T: Send>(runner: &dyn TaskRunner, items: &mut [T], work: impl Fn(&mut T) + Sync) {
    let count = items.len();
    let next = AtomicUsize::new(0);
    let shared = Shared(items.as_mut_ptr());
    let task = || {
        let i = next.fetch_add(1, Ordering::Relaxed);
        if i < count {
            // SAFETY: `fetch_add` hands out every index once, so no two calls hold the same item, whatever the
            // runner does; `items` is borrowed exclusively until `run` has returned.
            work(unsafe { &mut *shared.at(i) });
        }
    };
    runner.run(count, &task);
    // A runner that made too few calls must not lose work.
    while next.load(Ordering::Relaxed) < count {
        task();
    }
}
