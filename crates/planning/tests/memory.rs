//! What a query takes of memory: after one query to warm up, a search allocates nothing but its trees, which grow by doubling.
#![allow(unsafe_code, reason = "what is allocated is counted by an allocator")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use robotc_core::Seed;
use robotc_planning::lanes::Width;
use robotc_planning::motion::{SearchOptions, find_motion};
use robotc_planning::{Budget, Interrupt, LaneChecker, LaneMemory, MotionFailure};

mod shelf;

/// The system's allocator, which counts for each thread.
struct Counting;

thread_local! {
    static CALLS: Cell<usize> = const { Cell::new(0) };
    static LIVE: Cell<isize> = const { Cell::new(0) };
    static PEAK: Cell<isize> = const { Cell::new(0) };
}

fn count(change: isize) {
    let _ = LIVE.try_with(|live| {
        live.set(live.get() + change);
        let _ = PEAK.try_with(|peak| peak.set(peak.get().max(live.get())));
    });
    if change > 0 {
        let _ = CALLS.try_with(|calls| calls.set(calls.get() + 1));
    }
}

// SAFETY: all requests are passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size() as isize);
        // SAFETY: the caller keeps the contract of this very method.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(-(layout.size() as isize));
        // SAFETY: the caller keeps the contract of this very method.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// What a piece of work allocated: calls, and the most bytes at once.
fn measured<R>(work: impl FnOnce() -> R) -> (R, usize, isize) {
    let (calls, live) = (CALLS.get(), LIVE.get());
    PEAK.set(live);
    let result = work();
    (result, CALLS.get() - calls, PEAK.get() - live)
}

#[test]
fn a_search_allocates_nothing_but_its_trees_and_stops_when_told() {
    let (robot, problem) = (shelf::robot(), shelf::problem());
    let stage = robot.stage(&problem, None).unwrap();
    let mut memory = LaneMemory::default();
    let options = SearchOptions { max_iterations: 20_000, ..SearchOptions::default() };
    let mut query = |seed: u64, options: &SearchOptions, budget: &Budget<'_>| {
        let width = Width::widest();
        let mut checker = LaneChecker::new(&stage.lanes, &stage.scene, &robot.space, 0.0, width, &mut memory);
        let (start, goal) = (&problem.start, &problem.goal);
        measured(|| find_motion(&mut checker, start, goal, options, budget, Seed::new(seed)))
    };
    let unlimited = Budget::unlimited();
    for seed in 0..5 {
        query(seed, &options, &unlimited).0.unwrap();
    }
    let mut most_iterations = 0;
    for seed in 5..40 {
        let (found, calls, peak) = query(seed, &options, &unlimited);
        let found = found.unwrap();
        most_iterations = most_iterations.max(found.iterations);
        // Some thirty vectors that double until they hold all nodes, and the states of the path.
        assert!(calls < 500 + 2 * found.path.len(), "{calls} calls in {} iterations", found.iterations);
        assert!(peak < 512 << 10, "{peak} bytes in {} iterations", found.iterations);
    }
    assert!(most_iterations > 300, "{most_iterations}");

    // Limits are kept to the iteration.
    let few = SearchOptions { max_iterations: 7, ..options };
    assert_eq!(query(5, &few, &unlimited).0, Err(MotionFailure::Iterations(7)));
    let asked = Cell::new(0);
    let spent = || {
        asked.set(asked.get() + 1);
        (asked.get() > 5).then_some(Interrupt::TimeUp)
    };
    let stopped = query(5, &options, &Budget::new(&spent)).0;
    assert_eq!(stopped, Err(MotionFailure::Interrupted(Interrupt::TimeUp, 5)));
}
