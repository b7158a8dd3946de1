//! How long it takes to know one way to pick an object up and put it down (thesis algorithms 3.4 to 3.6).

use robotc_core::Seed;
use serde::Serialize;

use crate::budget::Budget;
use crate::grasp::GraspSet;
use crate::manipulation::{Manipulation, ManipulationOptions, UsableGrasps, usable_grasps};

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GraspBenchOptions {
    /// Most grasps of each object, the best of its set.
    pub grasps: usize,
    /// Most destinations of each goal.
    pub destinations: usize,
    /// Runs of each goal, each with other destinations.
    pub seeds: u64,
}

impl Default for GraspBenchOptions {
    fn default() -> Self {
        Self { grasps: 1000, destinations: 100, seeds: 32 }
    }
}

/// The figures of a goal.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GraspReport {
    /// Name of the object.
    pub object: String,
    /// Grasps known, and destinations.
    pub known: [usize; 2],
    /// Runs, and how many of them found a grasp.
    pub runs: [u64; 2],
    /// Milliseconds to the first usable grasp: median, 95th percentile and longest.
    pub first_ms: [f64; 3],
    /// Grasps looked at for it, and destinations, mean.
    pub looked_at: [f64; 2],
    /// Usable grasps when all are looked at, and milliseconds that takes; each grasp counts once for each branch of inverse kinematics.
    pub all: (usize, f64),
}

/// Looks for the first usable grasp of every goal of the task that puts something down, and once for all of them.
///
/// `now` gives seconds. What is timed is the whole call, the ranking of the grasps included.
pub fn measure_grasps(
    problem: &Manipulation<'_>,
    planner: &ManipulationOptions,
    options: &GraspBenchOptions,
    now: &dyn Fn() -> f64,
    done: &mut dyn FnMut(usize, usize),
) -> Vec<GraspReport> {
    let best = |set: &&GraspSet| {
        let grasps = set.grasps.iter().take(options.grasps).cloned().collect();
        GraspSet { grasps, ..(*set).clone() }
    };
    let sets: Vec<GraspSet> = problem.grasps.iter().map(best).collect();
    let sets: Vec<&GraspSet> = sets.iter().collect();
    let problem = Manipulation { grasps: &sets, ..*problem };
    let planner = ManipulationOptions { destinations: options.destinations, ..planner.clone() };
    let mut reports = Vec::new();
    for (number, goal) in problem.task.goals.iter().enumerate() {
        let [target, ..] = goal.targets() else { continue };
        let look = |most: usize, seed: u64| {
            let start = now();
            let budget = Budget::unlimited();
            let found = usable_grasps(&problem, &planner, number, most, &budget, Seed::new(seed));
            let milliseconds = 1e3 * (now() - start);
            found.ok().flatten().map(|found| (found, milliseconds))
        };
        let runs: Vec<(UsableGrasps, f64)> = (0..options.seeds).filter_map(|seed| look(1, seed)).collect();
        if let (Some((all, all_ms)), false) = (look(usize::MAX, 0), runs.is_empty()) {
            let object = &problem.task.objects[target.object].name;
            reports.push(report(object, &runs, (all.found.len(), all_ms)));
        }
        done(number + 1, problem.task.goals.len());
    }
    reports
}

/// Of at least one run.
fn report(object: &str, runs: &[(UsableGrasps, f64)], all: (usize, f64)) -> GraspReport {
    let mut times: Vec<f64> = runs.iter().map(|run| run.1).collect();
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() as f64 * share) as usize).min(times.len() - 1)];
    let mean = |of: &dyn Fn(&UsableGrasps) -> usize| {
        runs.iter().map(|(found, _)| of(found) as f64).sum::<f64>() / runs.len() as f64
    };
    let (first, _) = &runs[0];
    GraspReport {
        object: object.to_owned(),
        known: [first.tried.known, first.destinations[0]],
        runs: [runs.len() as u64, runs.iter().filter(|(found, _)| !found.found.is_empty()).count() as u64],
        first_ms: [at(0.5), at(0.95), at(1.0)],
        looked_at: [mean(&|found| found.tried.looked_at), mean(&|found| found.destinations[1])],
        all,
    }
}
