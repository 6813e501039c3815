//! Exclusive access to the items of a slice from several threads.
#![allow(unsafe_code)]

use crate::runner::TaskRunner;
use core::marker::PhantomData;
use core::sync::atomic::{AtomicU32, AtomicU64, AtomicUsize, Ordering};
use sinew_math::lanes::WIDTH;

/// Largest number of items that a thread claims at once. Two threads that claim single items spend more time on the
/// counter than on light items.
const MOST_CLAIMED: usize = 32;
/// Smallest number of claims for a short list, so that no thread waits long for the last claim of another.
const CLAIMS: usize = 16;

/// The items of a slice, shared by threads that each access different ones.
pub(crate) struct SharedRows<'a, T> {
    start: *mut T,
    len: usize,
    of: PhantomData<&'a mut [T]>,
}

impl<T> Clone for SharedRows<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for SharedRows<'_, T> {}

// SAFETY: the caller of `new` promises that no item is written by one thread while another reads or writes it, and T
// may change threads.
unsafe impl<T: Send> Send for SharedRows<'_, T> {}
// SAFETY: as above.
unsafe impl<T: Send> Sync for SharedRows<'_, T> {}

/// Eight indices that are known to be below a length, for use with all rows of at least that length.
#[derive(Clone, Copy)]
pub(crate) struct Places {
    at: [u32; WIDTH],
    len: usize,
}

impl Places {
    /// Checks indices into rows of length `len`.
    ///
    /// # Panics
    /// If any index is out of range.
    #[inline(always)]
    pub fn new(at: [u32; WIDTH], len: usize) -> Self {
        let mut last = 0;
        for at in at {
            last = u32::max(last, at);
        }
        assert!((last as usize) < len);
        Self { at, len }
    }
}

impl<'a, T> SharedRows<'a, T> {
    /// Returns the item at the `k`-th of eight indices.
    ///
    /// # Panics
    /// If there are fewer items than when the indices were checked, or `k` is out of range.
    #[inline(always)]
    pub fn at(&self, places: &Places, k: usize) -> &T {
        assert!(places.len <= self.len);
        // SAFETY: all indices are below their length, and the caller of `new` promised that no thread writes the item
        // meanwhile.
        unsafe { &*self.start.add(places.at[k] as usize) }
    }

    /// Returns the item at the `k`-th of eight indices, mutable.
    ///
    /// # Panics
    /// If there are fewer items than when the indices were checked, or `k` is out of range.
    #[inline(always)]
    pub fn at_mut(&mut self, places: &Places, k: usize) -> &mut T {
        assert!(places.len <= self.len);
        // SAFETY: all indices are below their length, and the caller of `new` promised that no other thread reads or
        // writes the item meanwhile.
        unsafe { &mut *self.start.add(places.at[k] as usize) }
    }

    /// Number of items.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Shares the items of a slice between copies of the result.
    ///
    /// # Safety
    /// While copies are in use, no item may be written through one of them while a reference to it from another exists,
    /// on this thread or another.
    pub unsafe fn new(items: &'a mut [T]) -> Self {
        Self { start: items.as_mut_ptr(), len: items.len(), of: PhantomData }
    }

    /// Returns item number `i`.
    ///
    /// # Panics
    /// If there are no more than `i` items.
    #[inline(always)]
    pub fn get(&self, i: usize) -> &T {
        assert!(i < self.len);
        // SAFETY: the item is inside the slice, and the caller of `new` promised that no thread writes it meanwhile.
        unsafe { &*self.start.add(i) }
    }

    /// Returns item number `i`, mutable.
    ///
    /// # Panics
    /// If there are no more than `i` items.
    #[inline(always)]
    pub fn get_mut(&mut self, i: usize) -> &mut T {
        assert!(i < self.len);
        // SAFETY: the item is inside the slice, and the caller of `new` promised that no other thread reads or writes
        // it meanwhile.
        unsafe { &mut *self.start.add(i) }
    }
}

/// Calls `work` once for every item, spread over `runner`'s threads.
///
/// DETERMINISM: the thread of an item varies, so `work` must depend on its item alone.
pub(crate) fn for_each_mut<T: Send>(runner: &dyn TaskRunner, items: &mut [T], work: impl Fn(&mut T) + Sync) {
    let count = items.len();
    let claim = usize::min(usize::max(count / CLAIMS, 1), MOST_CLAIMED);
    let next = AtomicUsize::new(0);
    // SAFETY: `fetch_add` hands out every index once, so no two calls hold the same item, for any runner; `items`
    // is borrowed exclusively until `run` has returned.
    let rows = unsafe { SharedRows::new(items) };
    let task = || {
        let mut rows = rows;
        let first = next.fetch_add(claim, Ordering::Relaxed);
        for i in first..usize::min(first.saturating_add(claim), count) {
            work(rows.get_mut(i));
        }
    };
    runner.run(count.div_ceil(claim), &task);
    // If the runner made too few calls, this thread does the remaining work.
    while next.load(Ordering::Relaxed) < count {
        task();
    }
}

/// Largest number of items of [`for_each_near`].
pub(crate) const MOST_NEAR: usize = u64::BITS as usize;

/// Largest number of threads that take part in [`for_each_near`].
const MOST_CALLS: usize = 16;

/// Like [`for_each_mut`], for at most [`MOST_NEAR`] items whose neighbours share memory: each thread starts at the item
/// where it started in the previous call of this length, and continues with free neighbours.
pub(crate) fn for_each_near<T: Send>(runner: &dyn TaskRunner, items: &mut [T], work: impl Fn(&mut T) + Sync) {
    let count = items.len();
    assert!(count <= MOST_NEAR);
    let (taken, entered) = (AtomicU64::new(0), AtomicU32::new(0));
    // SAFETY: `fetch_or` sets the bit of an item once, so no two calls hold the same item, for any runner; `items` is
    // borrowed exclusively until `run` has returned.
    let rows = unsafe { SharedRows::new(items) };
    let task = || {
        let mut rows = rows;
        if taken.load(Ordering::Relaxed).count_ones() as usize == count {
            return;
        }
        // Threads start far from each other: the second at the middle, the next two at the quarters. The caller starts
        // first, because the other threads are delayed.
        let number = entered.fetch_add(1, Ordering::Relaxed);
        let share = (u64::from(number.reverse_bits()) * count as u64) >> u32::BITS;
        let start = share as usize;
        for i in (start..count).chain(0..start) {
            let bit = 1 << i;
            if taken.load(Ordering::Relaxed) & bit == 0 && taken.fetch_or(bit, Ordering::Relaxed) & bit == 0 {
                work(rows.get_mut(i));
            }
        }
    };
    runner.run(usize::min(count, MOST_CALLS), &task);
    // If the runner made no call, this thread does the work.
    task();
}

/// Takes the first `count` of the remaining items.
pub(crate) fn split_off<'a, T>(left: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    left.split_off_mut(..count).expect("there is room for each island")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runner::{Serial, Threads};

    #[test]
    fn each_item_is_worked_on_once() {
        let threads = Threads::new(3);
        for count in (0..200).chain([1_000, 4_097]) {
            for runner in [&Serial as &dyn TaskRunner, &threads] {
                let mut items = vec![0; count];
                for_each_mut(runner, &mut items, |item| *item += 1);
                assert!(items.iter().all(|&item| item == 1), "{count} items");
                items.truncate(MOST_NEAR);
                for_each_near(runner, &mut items, |item| *item += 1);
                assert!(items.iter().all(|&item| item == 2), "{count} items");
            }
        }
    }
}
