//! How many configurations are checked each second, in lanes and one at a time.

use robotc_core::Seed;
use serde::Serialize;

use super::problems::ProblemSet;
use super::robot::{BenchError, BenchRobot};
use super::run::checker;
use crate::edge::{EdgeChecker, Patience};
use crate::lanes::{LaneChecker, LaneMemory, LaneStatistics, Width};

/// Check rates in one scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckRates {
    /// The family of scenes; its first problem is taken.
    pub scene: String,
    /// Bodies around the robot.
    pub obstacles: usize,
    /// Free motions that were checked.
    pub motions: usize,
    /// Configurations for each motion and checker.
    pub configurations: u64,
    /// For each number of lanes, configurations looked at per second, whole motions each time.
    pub looks: Vec<(usize, f64)>,
    /// For each number of lanes, configurations per second when each also proves the motion free until the next one.
    pub lanes: Vec<(usize, f64)>,
    /// Configurations per second of the scalar checker with convex parts, without the search for clearance.
    pub scalar: f64,
}

/// Motions that are checked.
const MOTIONS: usize = 64;

/// Length of a motion in the metric of the space.
const LENGTH: f64 = 1.0;

/// Times each motion is checked, so that the clock's grain does not matter.
const REPEATS: usize = 20;

/// Measures the first problem of each family of scenes, all checkers on the same free motions. `now` gives seconds since any
/// moment.
pub fn measure_checks(
    robot: &BenchRobot,
    set: &ProblemSet,
    now: &dyn Fn() -> f64,
) -> Result<Vec<CheckRates>, BenchError> {
    let mut rates: Vec<CheckRates> = Vec::new();
    let mut prepared = None;
    for problem in &set.problems {
        if rates.last().is_some_and(|last| last.scene == problem.scene) {
            continue;
        }
        let stage = robot.stage(problem, prepared.take())?;
        prepared = Some(stage.lanes.clone());
        let space = &robot.space;
        let mut memory = LaneMemory::default();
        let (lanes, scene) = (&*stage.lanes, &stage.scene);
        let mut rng = Seed::new(0).split(&problem.scene).rng();
        let mut motions = Vec::new();
        let mut found = LaneChecker::new(lanes, scene, space, 0.0, Width::widest(), &mut memory);
        for _ in 0..200 * MOTIONS {
            let from = space.sample(&mut rng);
            let to = space.sample_near(&from, LENGTH, &mut rng);
            if motions.len() < MOTIONS && found.state(&from).is_ok() && found.edge(&from, &to).is_ok() {
                motions.push((from, to));
            }
        }
        let (mut looks, mut by_width) = (Vec::new(), Vec::new());
        let mut configurations = 0;
        for width in Width::all() {
            let mut rate = |patience| {
                let mut checker = LaneChecker::new(lanes, scene, space, 0.0, width, &mut memory);
                checker.set_patience(patience);
                let start = now();
                for _ in 0..REPEATS {
                    for (from, to) in &motions {
                        let _ = checker.edge(from, to);
                    }
                }
                let seconds = (now() - start).max(f64::MIN_POSITIVE);
                let LaneStatistics { looks, stretches, .. } = checker.statistics();
                (looks + stretches, (width.lanes(), (looks + stretches) as f64 / seconds))
            };
            looks.push(rate(Patience::Hopeful).1);
            let (count, proofs) = rate(Patience::Thorough);
            configurations = count;
            by_width.push(proofs);
        }
        let mut scalar = checker(robot, &stage).without_clearance();
        let each = (configurations as usize / (REPEATS * motions.len().max(1))).max(1);
        let states: Vec<Vec<f64>> = motions
            .iter()
            .flat_map(|(from, to)| (0..each).map(move |i| (from, to, (i as f64 + 0.5) / each as f64)))
            .map(|(from, to, t)| space.interpolate(from, to, t))
            .collect();
        let start = now();
        for q in &states {
            let _ = scalar.state(q);
        }
        let seconds = now() - start;
        rates.push(CheckRates {
            scene: problem.scene.clone(),
            obstacles: problem.obstacles.len(),
            motions: motions.len(),
            configurations,
            looks,
            lanes: by_width,
            scalar: states.len() as f64 / seconds.max(f64::MIN_POSITIVE),
        });
    }
    Ok(rates)
}
