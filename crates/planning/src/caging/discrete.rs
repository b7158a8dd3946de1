//! All grasps at all object steps, searched depth first from the goal back (thesis algorithm 3.7).

use super::task::{
    ArticulatedTask, CagedState, CagingFailure, CagingFailureReason, CagingSolution, CagingStatistics, joined,
};
use crate::budget::{Budget, Interrupt};

/// Finds a motion through all object steps in their order, first to last.
///
/// Exhaustive: a failure means that there is none at the resolution of the task's solutions. States from which the start
/// cannot be reached are remembered, so the time is bounded by the number of pairs of neighbouring solutions, not by the
/// number of ways through them.
pub fn discrete_search<T: ArticulatedTask + ?Sized>(
    task: &mut T,
    budget: &Budget<'_>,
) -> Result<CagingSolution, CagingFailure> {
    let mut search = Search {
        table: (0..task.steps()).map(|_| Step { by_grasp: vec![None; task.grasps()] }).collect(),
        task,
        statistics: CagingStatistics::default(),
        partial: Vec::new(),
    };
    let outcome = search.run(budget);
    let Search { statistics, partial, .. } = search;
    match outcome {
        Ok(states) => Ok(CagingSolution { states, statistics }),
        Err(reason) => Err(CagingFailure { reason, partial, statistics }),
    }
}

/// An arm configuration, and whether the search has been there.
#[derive(Debug, Clone)]
struct Candidate {
    q: Vec<f64>,
    seen: bool,
}

/// Solutions at one object step, computed when first asked for.
struct Step {
    by_grasp: Vec<Option<Vec<Candidate>>>,
}

struct Search<'t, T: ?Sized> {
    task: &'t mut T,
    table: Vec<Step>,
    statistics: CagingStatistics,
    partial: Vec<CagedState>,
}

/// A state on the way with the candidates for the state before it that are still to be tried, the best last.
struct Frame {
    state: CagedState,
    before: Vec<(usize, usize)>,
}

impl<T: ArticulatedTask + ?Sized> Search<'_, T> {
    fn run(&mut self, budget: &Budget<'_>) -> Result<Vec<CagedState>, CagingFailureReason> {
        let last = self.task.steps() - 1;
        // Where no grasp at all is within reach, there is no need to search.
        for step in 0..last {
            let mut reachable = false;
            for grasp in 0..self.task.grasps() {
                budget.check().map_err(CagingFailureReason::Interrupted)?;
                reachable = !self.candidates(step, grasp).is_empty();
                if reachable {
                    break;
                }
            }
            if !reachable {
                return Err(CagingFailureReason::OutOfReach { step });
            }
        }
        let mut reason = CagingFailureReason::NoContact;
        for grasp in 0..self.task.grasps() {
            if !self.task.is_contact(grasp) {
                continue;
            }
            for number in 0..self.candidates(last, grasp).len() {
                reason = CagingFailureReason::NoPath;
                let found =
                    self.back_from(grasp, number, budget).map_err(CagingFailureReason::Interrupted)?;
                if let Some(states) = found {
                    return Ok(states);
                }
            }
        }
        Err(reason)
    }

    fn candidates(&mut self, step: usize, grasp: usize) -> &mut Vec<Candidate> {
        let Self { task, table, statistics, .. } = self;
        table[step].by_grasp[grasp].get_or_insert_with(|| {
            statistics.inverse_calls += 1;
            let solutions = task.solutions(step, grasp, None);
            statistics.states += solutions.len() as u32;
            solutions.into_iter().map(|q| Candidate { q, seen: false }).collect()
        })
    }

    /// The way from the first step to this candidate of the last one.
    fn back_from(
        &mut self,
        grasp: usize,
        number: usize,
        budget: &Budget<'_>,
    ) -> Result<Option<Vec<CagedState>>, Interrupt> {
        let last = self.task.steps() - 1;
        let mut way = vec![self.enter(last, grasp, number)];
        while let Some(frame) = way.last_mut() {
            budget.check()?;
            if frame.state.step == 0 {
                return Ok(Some(way.into_iter().rev().map(|f| f.state).collect()));
            }
            let Some((grasp, number)) = frame.before.pop() else {
                way.pop();
                continue;
            };
            let after = frame.state.clone();
            let step = after.step - 1;
            let candidate = &self.candidates(step, grasp)[number];
            if candidate.seen {
                continue;
            }
            let state = CagedState { step, grasp, q: candidate.q.clone() };
            if joined(&mut *self.task, &state, &after, &mut self.statistics) {
                let frame = self.enter(step, grasp, number);
                way.push(frame);
                if way.len() > self.partial.len() {
                    self.partial = way.iter().rev().map(|f| f.state.clone()).collect();
                }
            }
        }
        Ok(None)
    }

    /// Marks a candidate as seen and lists those of the step before that are near to it, the nearest last.
    fn enter(&mut self, step: usize, grasp: usize, number: usize) -> Frame {
        let candidate = &mut self.candidates(step, grasp)[number];
        candidate.seen = true;
        let state = CagedState { step, grasp, q: candidate.q.clone() };
        let mut before = Vec::new();
        if step > 0 {
            for grasp in self.task.adjacent(grasp).to_vec() {
                for number in 0..self.candidates(step - 1, grasp).len() {
                    let candidate =
                        &self.table[step - 1].by_grasp[grasp].as_ref().expect("just asked for")[number];
                    let distance = self.task.arm_space().distance(&candidate.q, &state.q);
                    if !candidate.seen && distance <= self.task.longest_motion() {
                        before.push((distance, grasp, number));
                    }
                }
            }
        }
        before.sort_by(|a, b| b.0.total_cmp(&a.0));
        Frame { state, before: before.into_iter().map(|(_, grasp, number)| (grasp, number)).collect() }
    }
}
