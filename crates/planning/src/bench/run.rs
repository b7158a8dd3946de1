//! Planning every problem of a set.

use std::sync::Arc;

use robotc_core::Seed;

use super::problems::{Problem, ProblemSet};
use super::report::{Report, Row, quantile};
use super::robot::{BenchError, BenchRobot, Stage};
use crate::budget::Budget;
use crate::certify::certify_path;
use crate::edge::EdgeChecker;
use crate::lanes::{LaneChecker, LaneMemory, LaneRobot, LaneStatistics, Width};
use crate::motion::{MotionOptions, Race, find_motion, race_motion, shorten_motion};
use crate::scene::{RobotChecker, Rules};

/// What a benchmark does.
#[derive(Debug, Clone, Copy)]
pub struct BenchOptions {
    /// How often each problem is planned, each time with another seed.
    pub seeds: u32,
    /// How to plan.
    pub motion: MotionOptions,
    /// Searches that race for the first path of each problem, each on a thread of its own; 1 is no race.
    pub racers: u32,
    /// Lanes of the collision checks; paths do not depend on it.
    pub width: Width,
}

impl Default for BenchOptions {
    fn default() -> Self {
        Self { seeds: 1, motion: MotionOptions::default(), racers: 1, width: Width::widest() }
    }
}

/// Room between bodies without which a path is not taken for proven, metres.
const LEAST_ROOM: f64 = 1e-6;

/// Plans every problem of a set. `now` gives seconds since any moment; `progress` hears of each finished row.
pub fn run(
    robot: &BenchRobot,
    set: &ProblemSet,
    ready_s: f64,
    options: &BenchOptions,
    now: &dyn Fn() -> f64,
    progress: &mut dyn FnMut(&Row),
) -> Result<Report, BenchError> {
    let mut rows = Vec::with_capacity(set.problems.len());
    let mut memory: Vec<LaneMemory> = (0..options.racers.max(1)).map(|_| LaneMemory::default()).collect();
    let mut lanes: Option<Arc<LaneRobot>> = None;
    let mut others: Option<&[(String, f64)]> = None;
    for problem in &set.problems {
        // The robot is prepared again only when joints that are not planned for have moved.
        if others != Some(&problem.other_joints) {
            lanes = None;
            others = Some(&problem.other_joints);
        }
        let stage = robot.stage(problem, lanes.take())?;
        lanes = Some(stage.lanes.clone());
        let row = plan_problem(robot, &stage, &within_limits(robot, problem), options, now, &mut memory);
        progress(&row);
        rows.push(row);
    }
    Ok(Report::new(&set.robot, options.seeds, ready_s, rows))
}

/// The problem with values that are a rounding beyond a limit moved onto it.
fn within_limits(robot: &BenchRobot, problem: &Problem) -> Problem {
    let mut problem = problem.clone();
    for q in [&mut problem.start, &mut problem.goal] {
        let mut inside = q.clone();
        robot.space.clamp(&mut inside);
        if robot.space.distance(q, &inside) < ROUNDED {
            *q = inside;
        }
    }
    problem
}

/// Limits and problems are written with six digits, radians or metres.
const ROUNDED: f64 = 1e-5;

/// What came of one call.
struct Attempt {
    plan_us: f64,
    total_us: f64,
    statistics: LaneStatistics,
    iterations: u32,
    /// Or why there is no path.
    found: Result<Found, String>,
}

struct Found {
    cost: f64,
    simplified: Vec<Vec<f64>>,
}

fn plan_problem(
    robot: &BenchRobot,
    stage: &Stage,
    problem: &Problem,
    options: &BenchOptions,
    now: &dyn Fn() -> f64,
    memory: &mut [LaneMemory],
) -> Row {
    let mut exact = checker(robot, stage);
    let mut wrong = |name: &str, q: &[f64]| {
        let obstruction = exact.state(q).err()?;
        Some(format!("{name}: {}", exact.describe(obstruction)))
    };
    let mut reason = wrong("start", &problem.start).or_else(|| wrong("goal", &problem.goal));
    let valid = reason.is_none();
    let mut attempts = Vec::new();
    let mut certified = valid;
    if valid {
        for seed in 0..options.seeds.max(1) {
            let seed = Seed::new(u64::from(seed));
            let attempt = attempt(robot, stage, problem, options, seed, now, memory);
            certified &= attempt
                .found
                .as_ref()
                .is_ok_and(|found| certify_path(&mut exact, &found.simplified, LEAST_ROOM).is_ok());
            if let Err(failure) = &attempt.found {
                reason = Some(failure.clone());
            }
            attempts.push(attempt);
        }
    }
    let median = |of: &dyn Fn(&Attempt) -> Option<f64>| {
        let mut values: Vec<f64> = attempts.iter().filter_map(of).collect();
        values.sort_by(f64::total_cmp);
        (!values.is_empty()).then(|| quantile(&values, 0.5))
    };
    let length = |path: &[Vec<f64>]| robot.space.length(path);
    Row {
        scene: problem.scene.clone(),
        index: problem.index,
        valid,
        solved: valid && attempts.iter().all(|a| a.found.is_ok()),
        certified,
        plan_us: median(&|a| Some(a.plan_us)).unwrap_or(0.0),
        total_us: median(&|a| Some(a.total_us)).unwrap_or(0.0),
        cost: median(&|a| a.found.as_ref().ok().map(|f| f.cost)),
        cost_simplified: median(&|a| a.found.as_ref().ok().map(|f| length(&f.simplified))),
        checks: median(&|a| Some((a.statistics.looks + a.statistics.stretches) as f64)).unwrap_or(0.0) as u64,
        distances: median(&|a| Some(a.statistics.distances as f64)).unwrap_or(0.0) as u64,
        iterations: median(&|a| Some(f64::from(a.iterations))).unwrap_or(0.0) as u64,
        reason,
    }
}

/// The scalar checker with exact geometry.
pub(super) fn checker<'a>(robot: &'a BenchRobot, stage: &'a Stage) -> RobotChecker<'a> {
    RobotChecker::new(&stage.scene, &robot.space, &robot.dofs, stage.world.q(), Rules::default(), RESOLUTION)
}

/// Largest travel between two looked at states, metres.
const RESOLUTION: f64 = 0.01;

fn attempt(
    robot: &BenchRobot,
    stage: &Stage,
    problem: &Problem,
    options: &BenchOptions,
    seed: Seed,
    now: &dyn Fn() -> f64,
    memory: &mut [LaneMemory],
) -> Attempt {
    let start = now();
    let micros = || (now() - start) * 1e6;
    let checker =
        |memory| LaneChecker::new(&stage.lanes, &stage.scene, &robot.space, 0.0, options.width, memory);
    let mut checkers: Vec<LaneChecker<'_>> = memory.iter_mut().map(checker).collect();
    let (checker, others) = checkers.split_first_mut().expect("there is one search at least");
    let (budget, motion) = (Budget::unlimited(), &options.motion);
    let (from, to) = (&problem.start, &problem.goal);
    let stream = seed.split("search");
    let found = match others.len() {
        0 => find_motion(checker, from, to, &motion.search, &budget, stream),
        _ => {
            let race = Race { racers: options.racers, ..Race::default() };
            race_motion(checker, others, race, from, to, &motion.search, &|| None, stream)
        }
    };
    let plan_us = micros();
    let iterations = found.as_ref().map_or(0, |found| found.iterations);
    let found = found.map_err(|failure| failure.to_string()).map(|found| {
        let cost = robot.space.length(&found.path);
        let seed = seed.split("shorten");
        let simplified = shorten_motion(checker, found.path, &motion.shorten, &budget, seed);
        Found { cost, simplified }
    });
    Attempt { plan_us, total_us: micros(), statistics: checker.statistics(), iterations, found }
}
