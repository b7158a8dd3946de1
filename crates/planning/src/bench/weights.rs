//! What the weights of the metric are worth: planning times with those of the knowledge base and with equal ones (thesis table 4.8).

use robotc_core::Seed;
use serde::Serialize;

use crate::budget::Budget;
use crate::edge::EdgeChecker;
use crate::goal::FixedGoals;
use crate::manipulation::{Manipulation, ManipulationOptions};
use crate::rrt::{RrtConnect, RrtOptions};
use crate::scene::{RobotChecker, Rules};
use crate::space::{Axis, Space};

/// The figures of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WeightsReport {
    /// Name of the task.
    pub scene: String,
    /// Problems: pairs of free configurations of the arm among the things of the task, far from each other.
    pub problems: usize,
    /// Of these, solved with the weights, and with equal ones.
    pub solved: [usize; 2],
    /// Mean seconds with the weights, and with equal ones; over what both solved.
    pub mean_s: [f64; 2],
    /// States looked at, mean.
    pub states: [f64; 2],
    /// Mean seconds with the weights by that with equal ones.
    pub ratio: f64,
}

/// Plans between random configurations with both metrics in turn. Both have the same diameter, so that the same step is the same share of
/// the space.
pub fn measure_weights(
    problem: &Manipulation<'_>,
    planner: &ManipulationOptions,
    problems: usize,
    seed: Seed,
    now: &dyn Fn() -> f64,
) -> WeightsReport {
    let arm = problem.arm;
    let weighted = arm.space().clone();
    let plain = Space::new(weighted.axes().iter().map(|a| Axis { weight: 1.0, ..*a }).collect());
    let scale = weighted.diameter() / plain.diameter();
    let equal = Space::new(weighted.axes().iter().map(|a| Axis { weight: scale, ..*a }).collect());
    let spaces = [&weighted, &equal];
    let rules = Rules { margin: planner.margin, ..Rules::default() };
    let checker = |space| {
        RobotChecker::new(
            problem.scene,
            space,
            arm.dofs(),
            &problem.task.start,
            rules.clone(),
            planner.resolution,
        )
    };
    let mut rng = seed.split("problems").rng();
    let mut free = || loop {
        let q = weighted.sample(&mut rng);
        if checker(&weighted).state(&q).is_ok() {
            return q;
        }
    };
    let (mut solved, mut seconds, mut states, mut both) = ([0; 2], [0.0; 2], [0.0; 2], 0);
    for number in 0..problems {
        let (from, to) = (free(), free());
        let runs = spaces.map(|space| {
            let (mut robot, mut goals) = (checker(space), FixedGoals::new(vec![to.clone()]));
            let options = RrtOptions { max_iterations: 4000, ..planner.rrt };
            let start = now();
            let rng = &mut seed.split("search").at(number as u64).rng();
            let budget = Budget::unlimited();
            let found = RrtConnect::new(&from).run(&mut robot, None, &mut goals, &options, &budget, rng);
            (found.is_ok(), now() - start, robot.states())
        });
        let all = runs.iter().all(|run| run.0);
        both += usize::from(all);
        for (k, (found, time, looked)) in runs.into_iter().enumerate() {
            solved[k] += usize::from(found);
            if all {
                seconds[k] += time;
                states[k] += looked as f64;
            }
        }
    }
    let count = both.max(1) as f64;
    WeightsReport {
        scene: problem.task.name.clone(),
        problems,
        solved,
        mean_s: seconds.map(|s| s / count),
        states: states.map(|s| s / count),
        ratio: seconds[0] / seconds[1].max(f64::MIN_POSITIVE),
    }
}
