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
    let mut tried = Tried::default();
    for &grasp in &grasps {
        if !task.is_contact(grasp)
            || f64::from(tried.statistics.motions) > KEPT * f64::from(options.max_draws)
        {
            break;
        }
        if let Some(end) = tried.by(discrete_search(&mut FixedGrasp::one(task, grasp), budget)) {
            return end;
        }
    }
    let most = (EXHAUSTIVE * f64::from(options.max_draws)) as u32;
    if let Some(end) = tried.by(discrete_search_within(task, most, budget)) {
        return end;
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
                    return tried.ended(CagingFailureReason::Interrupted(interrupt));
                }
                tried.statistics.inverse_calls += 1;
                let mut found = task.candidates(0, grasp, None);
                tried.statistics.states += found.len() as u32;
                rng.shuffle(&mut found);
                let found = found.into_iter().map(|q| CagedState { step: 0, grasp, q });
                starts.extend(found.filter(|state| task.free(state).is_ok()).take(STARTS));
                continue;
            }
            let from = CageStart::State(starts[number].clone());
            let mut rng = seed.split("search").at(number as u64).at(round as u64).rng();
            number += 1;
            if let Some(end) = tried.by(randomized_search(task, &from, &options, budget, &mut rng)) {
                return end;
            }
        }
        if starts.is_empty() {
            return tried.ended(CagingFailureReason::OutOfReach { step: 0 });
        }
    }
    tried.ended(CagingFailureReason::Iterations)
}

/// What searches did so far that found no way.
#[derive(Default)]
struct Tried {
    statistics: CagingStatistics,
    /// The longest way that one of them got.
    partial: Vec<CagedState>,
}

impl Tried {
    /// Counts one more search; its outcome, if that is the end: a way was found, or nobody wants one any more.
    fn by(
        &mut self,
        outcome: Result<CagingSolution, CagingFailure>,
    ) -> Option<Result<CagingSolution, CagingFailure>> {
        let failure = match outcome {
            Ok(solution) => return Some(Ok(solution)),
            Err(failure) => failure,
        };
        self.statistics.add(&failure.statistics);
        if failure.partial.len() > self.partial.len() {
            self.partial = failure.partial;
        }
        let interrupted = matches!(failure.reason, CagingFailureReason::Interrupted(_));
        interrupted.then(|| std::mem::take(self).ended(failure.reason))
    }

    fn ended(self, reason: CagingFailureReason) -> Result<CagingSolution, CagingFailure> {
        Err(CagingFailure { reason, partial: self.partial, statistics: self.statistics })
    }
}
