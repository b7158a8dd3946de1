//! Limits of time are kept to a millisecond: no planner works longer than that between two questions whether it may go on.

use std::cell::Cell;
use std::time::{Duration, Instant};

use robotc_core::Seed;
use robotc_planning::goal::FixedGoals;
use robotc_planning::lanes::Width;
use robotc_planning::motion::{SearchOptions, ShortenOptions, find_motion, shorten_motion};
use robotc_planning::rrt::{RrtConnect, RrtOptions};
use robotc_planning::scene::{RobotChecker, Rules};
use robotc_planning::smooth::{DEFAULT_SMOOTHERS, smooth};
use robotc_planning::{Budget, EdgeChecker, Interrupt, LaneChecker, LaneMemory};

mod shelf;

/// Longer than this no one may work without asking.
const LONGEST: Duration = Duration::from_millis(1);

/// Questions after which the answer is no.
const QUESTIONS: u32 = 300;

/// How often the same work is measured: other programs only make it longer, so that the shortest time counts.
const REPEATS: u32 = 40;

/// The longest time between two questions, the last one and the end of the work included.
fn longest_pause(mut work: impl FnMut(&Budget<'_>)) -> Duration {
    let pause = |_| {
        let (asked, last, longest) = (Cell::new(0), Cell::new(Instant::now()), Cell::new(Duration::ZERO));
        let note = || {
            let now = Instant::now();
            longest.set(longest.get().max(now - last.replace(now)));
        };
        let question = || {
            note();
            asked.set(asked.get() + 1);
            (asked.get() >= QUESTIONS).then_some(Interrupt::TimeUp)
        };
        work(&Budget::new(&question));
        note();
        longest.get()
    };
    (0..REPEATS).map(pause).min().expect("there are repeats")
}

#[test]
fn no_planner_works_longer_than_a_millisecond_without_asking() {
    let (robot, problem) = (shelf::robot(), shelf::problem());
    let stage = robot.stage(&problem, None).unwrap();
    let (start, goal) = (&problem.start, &problem.goal);
    let mut memory = LaneMemory::default();
    let mut lanes =
        LaneChecker::new(&stage.lanes, &stage.scene, &robot.space, 0.0, Width::widest(), &mut memory);
    let rules = Rules { margin: 0.005, ..Rules::default() };
    let mut scalar = RobotChecker::new(&stage.scene, &robot.space, &robot.dofs, stage.world.q(), rules, 0.01);
    let search = SearchOptions::default();
    for seed in (0..4).map(Seed::new) {
        let both: [(&str, &mut dyn EdgeChecker); 2] = [("in lanes", &mut lanes), ("one by one", &mut scalar)];
        for (how, checker) in both {
            let found = find_motion(checker, start, goal, &search, &Budget::unlimited(), seed).unwrap();
            let kept = |what: &str, pause: Duration| assert!(pause < LONGEST, "{what} {how}: {pause:?}");
            kept(
                "find_motion",
                longest_pause(|budget| drop(find_motion(checker, start, goal, &search, budget, seed))),
            );
            let options = ShortenOptions::default();
            kept(
                "shorten_motion",
                longest_pause(|budget| {
                    drop(shorten_motion(checker, found.path.clone(), &options, budget, seed));
                }),
            );
            kept(
                "RrtConnect",
                longest_pause(|budget| {
                    let goals = &mut FixedGoals::new(vec![goal.clone()]);
                    let (options, rng) = (RrtOptions::default(), &mut seed.rng());
                    drop(RrtConnect::new(start).run(checker, None, goals, &options, budget, rng));
                }),
            );
            kept(
                "smooth",
                longest_pause(|budget| {
                    let path = found.path.clone();
                    drop(smooth(checker, path, &DEFAULT_SMOOTHERS, budget, &mut seed.rng()));
                }),
            );
        }
    }
}
