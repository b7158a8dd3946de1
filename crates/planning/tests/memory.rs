//! What a query takes of memory: after one query to warm up, a search allocates nothing but its trees, which grow by doubling.
#![allow(unsafe_code, reason = "what is allocated is counted by an allocator")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;

use robotc_core::model::{DynamicLimits, Geometry, JointMotion, Origin, RobotBuilder, RobotModel, Shape};
use robotc_core::srdf::Srdf;
use robotc_core::{Pose, Seed};
use robotc_planning::bench::{BenchRobot, Obstacle, Problem};
use robotc_planning::lanes::Width;
use robotc_planning::motion::{SearchOptions, find_motion};
use robotc_planning::{Budget, Interrupt, LaneChecker, LaneMemory, MotionFailure};

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

fn geometry(xyz: [f64; 3], size: [f64; 3]) -> Vec<Geometry> {
    vec![Geometry { origin: Origin { xyz, rpy: [0.0; 3] }, shape: Shape::Box { size }, colour: None }]
}

/// Six links in a row, joints about z and y in turn.
fn arm() -> RobotModel {
    let mut builder = RobotBuilder::new("arm");
    builder.link("base", vec![], geometry([0.0, 0.0, 0.05], [0.2, 0.2, 0.1]), None);
    for i in 0..6 {
        let (parent, child) =
            if i == 0 { ("base".into(), "l0".into()) } else { (format!("l{}", i - 1), format!("l{i}")) };
        builder.link(&*child, vec![], geometry([0.0, 0.0, 0.12], [0.05, 0.05, 0.14]), None);
        let origin = Origin { xyz: [0.0, 0.0, 0.24], rpy: [0.0; 3] };
        let axis = if i % 2 == 0 { [0.0, 0.0, 1.0] } else { [0.0, 1.0, 0.0] };
        let limits = (-2.0, 2.0, false, DynamicLimits::DEFAULT);
        builder.moving(&format!("j{i}"), JointMotion::Revolute, &parent, &child, origin, axis, limits, None);
    }
    builder.build().unwrap()
}

/// From one compartment of a shelf to another one.
fn problem() -> Problem {
    let board = |i: usize, centre: [f64; 3], size: [f64; 3]| Obstacle {
        name: format!("board {i}"),
        geometry: Arc::new(geometry([0.0; 3], size)),
        root_from_obstacle: Pose::translation(centre[0], centre[1], centre[2]),
    };
    let boards = [
        ([0.75, 0.0, 0.85], [0.4, 1.2, 0.03]),
        ([0.75, 0.0, 0.45], [0.4, 1.2, 0.03]),
        ([0.75, 0.0, 0.65], [0.4, 0.03, 0.4]),
        ([0.75, 0.6, 0.65], [0.4, 0.03, 0.4]),
        ([0.75, -0.6, 0.65], [0.4, 0.03, 0.4]),
    ];
    Problem {
        scene: "shelf".into(),
        index: 0,
        start: vec![0.45, 1.2, 0.0, 0.4, 0.0, 0.0],
        goal: vec![-0.45, 1.2, 0.0, 0.4, 0.0, 0.0],
        other_joints: vec![],
        obstacles: boards.iter().enumerate().map(|(i, (centre, size))| board(i, *centre, *size)).collect(),
    }
}

#[test]
fn a_search_allocates_nothing_but_its_trees_and_stops_when_told() {
    let srdf = Srdf {
        name: "arm".into(),
        groups: vec![],
        end_effectors: vec![],
        states: vec![],
        disabled_pairs: vec![],
        passive_joints: vec![],
    };
    let joints: Vec<String> = (0..6).map(|i| format!("j{i}")).collect();
    let robot = BenchRobot::new(Arc::new(arm()), &srdf, &joints).unwrap();
    let problem = problem();
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
