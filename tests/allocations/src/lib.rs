//! An allocator that counts, to show that a hot path does not allocate and what a value keeps.
//!
//! A test binary that uses this crate has its allocator. The count is kept per thread, so tests that run side by side do
//! not disturb each other.
#![allow(unsafe_code, reason = "an allocator cannot be written without it")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
    /// Octets allocated and not freed by this thread.
    static HELD: Cell<i64> = const { Cell::new(0) };
    /// The most of these since [`taken_by`] began.
    static MOST: Cell<i64> = const { Cell::new(0) };
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn count() {
    // a thread that ends has no counter any more
    let _ = COUNT.try_with(|count| count.set(count.get() + 1));
}

fn hold(octets: usize, sign: i64) {
    let octets = i64::try_from(octets).unwrap_or(i64::MAX);
    let _ = HELD.try_with(|held| {
        held.set(held.get() + sign * octets);
        let _ = MOST.try_with(|most| most.set(most.get().max(held.get())));
    });
}

// SAFETY: hands everything to the system allocator unchanged; the counter needs no allocation itself.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        hold(layout.size(), 1);
        // SAFETY: same contract.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        hold(layout.size(), 1);
        // SAFETY: same contract.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        hold(layout.size(), -1);
        // SAFETY: same contract.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        hold(layout.size(), -1);
        hold(size, 1);
        // SAFETY: same contract.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

/// Allocations that `work` makes in this thread; growing one counts as well.
///
/// ```
/// assert_eq!(allocations::made_by(|| drop(std::hint::black_box(Box::new(1)))), 1);
/// ```
pub fn made_by(work: impl FnOnce()) -> u64 {
    let before = COUNT.with(Cell::get);
    work();
    COUNT.with(Cell::get) - before
}

/// What `work` returns, and the octets on the heap that it keeps.
///
/// ```
/// let (list, octets) = allocations::kept_by(|| vec![0_u64; 4]);
/// assert_eq!((list.len(), octets), (4, 32));
/// ```
pub fn kept_by<T>(work: impl FnOnce() -> T) -> (T, i64) {
    let (value, memory) = taken_by(work);
    (value, memory.kept)
}

/// Octets on the heap that some work took.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// Still there at its end.
    pub kept: i64,
    /// At the moment when they were the most.
    pub most: i64,
}

/// What `work` returns, and the memory that it takes. Not for work within work that is measured.
///
/// ```
/// let (list, memory) = allocations::taken_by(|| {
///     drop(std::hint::black_box(vec![0_u64; 100]));
///     vec![0_u64; 4]
/// });
/// assert_eq!((list.len(), memory.kept, memory.most), (4, 32, 800));
/// ```
pub fn taken_by<T>(work: impl FnOnce() -> T) -> (T, Memory) {
    let before = HELD.with(Cell::get);
    MOST.with(|most| most.set(before));
    let value = work();
    let memory = Memory {
        kept: HELD.with(Cell::get) - before,
        most: MOST.with(Cell::get) - before,
    };
    (value, memory)
}

#[cfg(test)]
mod tests {
    use std::hint::black_box;

    use super::{kept_by, made_by};

    #[test]
    fn what_is_freed_is_not_kept() {
        let grown = kept_by(|| {
            let mut list = black_box(Vec::<u8>::with_capacity(10));
            list.reserve_exact(100);
            drop(black_box(vec![0_u8; 1000]));
            list
        });
        assert_eq!((grown.0.capacity(), grown.1), (100, 100));
    }

    #[test]
    fn the_counter_counts() {
        assert_eq!(made_by(|| drop(black_box(vec![1_u8; 10]))), 1);
        assert_eq!(made_by(|| drop(black_box(vec![0_u8; 10]))), 1);
        let grows = || {
            let mut list = black_box(Vec::<u8>::with_capacity(1));
            list.reserve_exact(100);
            drop(black_box(list));
        };
        assert_eq!(made_by(grows), 2);
        let nothing = || {
            black_box(1);
        };
        assert_eq!(made_by(nothing), 0);
    }
}
