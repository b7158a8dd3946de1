//! Many short searches instead of a long one.

use robotc_core::Seed;

use super::randomized::{CageStart, RandomizedOptions, randomized_search};
use super::task::{
    ArticulatedTask, CagedState, CagingFailure, CagingFailureReason, CagingSolution, CagingStatistics,
};
use crate::budget::Budget;

/// Shares of the draws that the searches of each round get.
const ROUNDS: [f64; 3] = [0.002, 0.01, 0.1];

/// Starts of each grasp.
const STARTS: usize = 2;

/// Searches from many states at the first step, a short time from each at first and longer in the next round.
///
/// Most of what can be opened at all is opened soon from some state; times of searches from one state have long tails.
pub fn restarted_search<T: ArticulatedTask + ?Sized>(
    task: &mut T,
    options: &RandomizedOptions,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<CagingSolution, CagingFailure> {
    let mut grasps: Vec<usize> = (0..task.grasps()).collect();
    let mut rng = seed.split("grasps").rng();
    rng.shuffle(&mut grasps);
    // What is in contact may be kept to the end.
    grasps.sort_by_key(|&grasp| !task.is_contact(grasp));
    let mut starts: Vec<CagedState> = Vec::new();
    let mut all = CagingStatistics::default();
    let mut partial: Vec<CagedState> = Vec::new();
    let fail = |reason, partial, statistics| Err(CagingFailure { reason, partial, statistics });
    for (round, share) in ROUNDS.into_iter().enumerate() {
        let max_draws = (share * f64::from(options.max_draws)).ceil() as u32;
        let options = RandomizedOptions { max_draws, ..*options };
        let mut number = 0;
        let mut next_grasp = grasps.iter();
        loop {
            if number == starts.len() {
                if round > 0 {
                    break;
                }
                let Some(&grasp) = next_grasp.next() else { break };
                if let Err(interrupt) = budget.check() {
                    return fail(CagingFailureReason::Interrupted(interrupt), partial, all);
                }
                all.inverse_calls += 1;
                let mut found = task.solutions(0, grasp, None);
                all.states += found.len() as u32;
                rng.shuffle(&mut found);
                starts.extend(found.into_iter().take(STARTS).map(|q| CagedState { step: 0, grasp, q }));
                continue;
            }
            let from = CageStart::State(starts[number].clone());
            let mut rng = seed.split("search").at(number as u64).at(round as u64).rng();
            number += 1;
            match randomized_search(task, &from, &options, budget, &mut rng) {
                Ok(solution) => return Ok(solution),
                Err(failure) => {
                    all.inverse_calls += failure.statistics.inverse_calls;
                    all.states += failure.statistics.states;
                    all.motions += failure.statistics.motions;
                    for (by, count) in failure.statistics.blocked {
                        *all.blocked.entry(by).or_insert(0) += count;
                    }
                    if failure.partial.len() > partial.len() {
                        partial = failure.partial;
                    }
                    if matches!(failure.reason, CagingFailureReason::Interrupted(_)) {
                        return fail(failure.reason, partial, all);
                    }
                }
            }
        }
        if starts.is_empty() {
            return fail(CagingFailureReason::OutOfReach { step: 0 }, partial, all);
        }
    }
    fail(CagingFailureReason::Iterations, partial, all)
}
