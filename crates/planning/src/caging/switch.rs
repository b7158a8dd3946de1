//! Disjoint sets of grasps: when one gets no farther, another takes over (thesis section 3.4, pushing and pulling).

use std::fmt;

use robotc_core::Seed;

use super::randomized::{CageStart, RandomizedOptions, randomized_search};
use super::task::{ArticulatedTask, CagedState, CagingFailure, CagingFailureReason, CagingStatistics};
use crate::budget::Budget;

/// A part of the object's way in grasps of one set.
#[derive(Debug, Clone, PartialEq)]
pub struct CageStage {
    /// Number of the set.
    pub set: usize,
    /// States from where the object was left by the stage before.
    pub states: Vec<CagedState>,
    /// What it took.
    pub statistics: CagingStatistics,
}

/// Why the object does not get to its goal in any set.
#[derive(Debug, Clone, PartialEq)]
pub struct CageSwitchFailure {
    /// The part of the way that was found.
    pub stages: Vec<CageStage>,
    /// What became of each set at the last step reached, in the order of trying.
    pub sets: Vec<(usize, CagingFailure)>,
}

impl fmt::Display for CageSwitchFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let step = self.stages.last().and_then(|s| s.states.last()).map_or(0, |s| s.step);
        write!(f, "no set of grasps moves the object on from step {step}")?;
        for (set, failure) in &self.sets {
            write!(f, "; set {set}: {failure}")?;
        }
        Ok(())
    }
}

/// Moves the object to its goal in stages, each in grasps of one of several sets.
///
/// All tasks are of the same object; each knows one set of grasps. A stage goes as far as its set can, and sets are tried
/// in random order. Between two stages the arm lets go and moves freely from the last state of one to the first of the next;
/// that motion is planned apart.
pub fn open_with_sets<T: ArticulatedTask>(
    tasks: &mut [T],
    options: &RandomizedOptions,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<Vec<CageStage>, CageSwitchFailure> {
    let mut stages: Vec<CageStage> = Vec::new();
    let mut step = 0;
    loop {
        let stage_seed = seed.at(stages.len() as u64);
        let mut order: Vec<usize> = (0..tasks.len()).collect();
        stage_seed.rng().shuffle(&mut order);
        let mut sets = Vec::new();
        let mut advanced = false;
        for set in order {
            let task = &mut tasks[set];
            let mut rng = stage_seed.at(set as u64).rng();
            match randomized_search(task, &CageStart::Step(step), options, budget, &mut rng) {
                Ok(solution) => {
                    stages.push(CageStage { set, states: solution.states, statistics: solution.statistics });
                    return Ok(stages);
                }
                Err(failure) => {
                    let reached = failure.partial.last().map(|s| s.step);
                    let interrupted = matches!(failure.reason, CagingFailureReason::Interrupted(_));
                    let nearer = reached.filter(|&r| task.remaining(r) < task.remaining(step));
                    if let (Some(reached), false) = (nearer, interrupted) {
                        step = reached;
                        stages.push(CageStage {
                            set,
                            states: failure.partial,
                            statistics: failure.statistics,
                        });
                        advanced = true;
                        break;
                    }
                    sets.push((set, failure));
                    if interrupted {
                        return Err(CageSwitchFailure { stages, sets });
                    }
                }
            }
        }
        if !advanced {
            return Err(CageSwitchFailure { stages, sets });
        }
    }
}
