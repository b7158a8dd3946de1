//! Many short searches instead of a long one.

use robotc_core::Seed;

use super::discrete::{discrete_search, discrete_search_within};
use super::fixed::FixedGrasp;
use super::randomized::{CageStart, RandomizedOptions, randomized_search};
use super::task::{
    ArticulatedTask, CagedState, CagingFailure, CagingFailureReason, CagingSolution, CagingStatistics,
};
use crate::budget::Budget;

/// Shares of the draws that the searches of each round get.
const ROUNDS: [f64; 3] = [0.002, 0.01, 0.1];

/// Share of the draws that may be motions looked at with one grasp kept all the way.
const KEPT: f64 = 0.04;
/// Share of the draws that may be inverse kinematics and motions of the exhaustive search.
const EXHAUSTIVE: f64 = 0.4;

/// Starts of each grasp.
const STARTS: usize = 2;

/// Tries each grasp in contact by itself, then all of them [exhaustively](discrete_search) for a while, then searches at random
/// from many states at the first step, a short time from each at first and longer in the next round.
///
/// A grasp that cannot be kept all the way is mostly out of reach somewhere, and that is soon known. Most of what can be opened
/// at all is opened soon from some state; times of searches from one state have long tails.
pub fn restarted_search<T: ArticulatedTask + ?Sized>(
    task: &mut T,
    options: &RandomizedOptions,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<CagingSolution, CagingFailure> {
    let mut grasps: Vec<usize> = (0..task.grasps()).filter(|&grasp| task.is_usable(grasp)).collect();
    let mut rng = seed.split("grasps").rng();
    rng.shuffle(&mut grasps);
    // What is in contact may be kept to the end.
    grasps.sort_by_key(|&grasp| !task.is_contact(grasp));
    let mut starts: Vec<CagedState> = Vec::new();
    let mut all = CagingStatistics::default();
    let mut partial: Vec<CagedState> = Vec::new();
    let fail = |reason, partial, statistics| Err(CagingFailure { reason, partial, statistics });
    for &grasp in &grasps {
        if !task.is_contact(grasp) || f64::from(all.motions) > KEPT * f64::from(options.max_draws) {
            break;
        }
        match discrete_search(&mut FixedGrasp::one(task, grasp), budget) {
            Ok(solution) => return Ok(solution),
            Err(failure) => {
                all.add(&failure.statistics);
                if matches!(failure.reason, CagingFailureReason::Interrupted(_)) {
                    return fail(failure.reason, partial, all);
                }
            }
        }
    }
    match discrete_search_within(task, (EXHAUSTIVE * f64::from(options.max_draws)) as u32, budget) {
        Ok(solution) => return Ok(solution),
        Err(failure) => {
            all.add(&failure.statistics);
            if matches!(failure.reason, CagingFailureReason::Interrupted(_)) {
                return fail(failure.reason, partial, all);
            }
        }
    }
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
                let mut found = task.candidates(0, grasp, None);
                all.states += found.len() as u32;
                rng.shuffle(&mut found);
                let found = found.into_iter().map(|q| CagedState { step: 0, grasp, q });
                starts.extend(found.filter(|state| task.free(state).is_ok()).take(STARTS));
                continue;
            }
            let from = CageStart::State(starts[number].clone());
            let mut rng = seed.split("search").at(number as u64).at(round as u64).rng();
            number += 1;
            match randomized_search(task, &from, &options, budget, &mut rng) {
                Ok(solution) => return Ok(solution),
                Err(failure) => {
                    all.add(&failure.statistics);
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
