//! All grasps at all object steps, searched depth first from the goal back (thesis algorithm 3.7).

use std::collections::BTreeMap;

use super::task::{
    ArticulatedTask, CagedState, CagingFailure, CagingFailureReason, CagingSolution, CagingStatistics,
};
use crate::budget::{Budget, Interrupt};

/// Finds a motion through all object steps in their order, first to last.
///
/// Exhaustive: a failure means that there is none at the resolution of the task's solutions. States from which the start
/// cannot be reached are remembered. States and motions are looked at for collisions only once a whole way through them is
/// known, since most of them lead nowhere (Dellin and Srinivasa, "A unifying formalism for shortest path problems with expensive
/// edge evaluations via lazy best-first search", 2016).
pub fn discrete_search<T: ArticulatedTask + ?Sized>(
    task: &mut T,
    budget: &Budget<'_>,
) -> Result<CagingSolution, CagingFailure> {
    discrete_search_within(task, u32::MAX, budget)
}

/// The same search that gives up after so many inverse kinematics and motions.
pub(super) fn discrete_search_within<T: ArticulatedTask + ?Sized>(
    task: &mut T,
    most: u32,
    budget: &Budget<'_>,
) -> Result<CagingSolution, CagingFailure> {
    let mut search = Search {
        table: vec![BTreeMap::new(); task.steps()],
        task,
        known: BTreeMap::new(),
        most,
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

/// An arm configuration for a grasp at a step.
#[derive(Debug, Clone)]
struct Candidate {
    q: Vec<f64>,
    /// On the present way, or without a way from the start to it.
    seen: bool,
    /// `None` before it was looked at.
    free: Option<bool>,
}

/// Names a candidate: step, grasp, and number among those of both.
type Name = (usize, usize, usize);

struct Search<'t, T: ?Sized> {
    task: &'t mut T,
    /// Candidates of each step and grasp, computed when first asked for.
    table: Vec<BTreeMap<usize, Vec<Candidate>>>,
    /// Whether motions that were looked at are free.
    known: BTreeMap<(Name, Name), bool>,
    /// Inverse kinematics and motions after which the search gives up.
    most: u32,
    statistics: CagingStatistics,
    /// The longest way of free motions to the goal.
    partial: Vec<CagedState>,
}

/// A state on the way with the candidates for the state before it that are still to be tried, the best last.
struct Frame {
    name: Name,
    before: Vec<Name>,
    /// Whether `before` is of this grasp alone: what keeps the grasp is tried first.
    kept: bool,
}

impl<T: ArticulatedTask + ?Sized> Search<'_, T> {
    fn run(&mut self, budget: &Budget<'_>) -> Result<Vec<CagedState>, CagingFailureReason> {
        let last = self.task.steps() - 1;
        let usable: Vec<usize> = (0..self.task.grasps()).filter(|&g| self.task.is_usable(g)).collect();
        let contact: Vec<usize> = usable.iter().copied().filter(|&g| self.task.is_contact(g)).collect();
        // Where nothing is within reach, there is no need to search.
        if !self.reaches(last, &contact, budget)? {
            return Err(CagingFailureReason::NoContact);
        }
        for step in 0..last {
            if !self.reaches(step, &usable, budget)? {
                return Err(CagingFailureReason::OutOfReach { step });
            }
        }
        for grasp in contact {
            for number in 0..self.candidates(last, grasp).len() {
                if let Some(states) = self.back_from((last, grasp, number), budget)? {
                    return Ok(states);
                }
            }
        }
        let collides = |goal: &Candidate| goal.free == Some(false);
        Err(match self.table[last].values().flatten().all(collides) {
            true => CagingFailureReason::NoContact,
            false => CagingFailureReason::NoPath,
        })
    }

    /// Whether some of these grasps can be reached at a step.
    fn reaches(
        &mut self,
        step: usize,
        grasps: &[usize],
        budget: &Budget<'_>,
    ) -> Result<bool, CagingFailureReason> {
        for &grasp in grasps {
            budget.check().map_err(CagingFailureReason::Interrupted)?;
            if !self.candidates(step, grasp).is_empty() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    fn candidates(&mut self, step: usize, grasp: usize) -> &mut Vec<Candidate> {
        let Self { task, table, statistics, .. } = self;
        table[step].entry(grasp).or_insert_with(|| {
            statistics.inverse_calls += 1;
            let found = task.candidates(step, grasp, None);
            statistics.states += found.len() as u32;
            found.into_iter().map(|q| Candidate { q, seen: false, free: None }).collect()
        })
    }

    fn candidate(&mut self, (step, grasp, number): Name) -> &mut Candidate {
        &mut self.candidates(step, grasp)[number]
    }

    fn state(&mut self, name: Name) -> CagedState {
        CagedState { step: name.0, grasp: name.1, q: self.candidate(name).q.clone() }
    }

    /// The way from the first step to this candidate of the last one.
    fn back_from(
        &mut self,
        goal: Name,
        budget: &Budget<'_>,
    ) -> Result<Option<Vec<CagedState>>, CagingFailureReason> {
        let mut way = vec![self.enter(goal)];
        // So many of them, and the motions between them, are known to be free.
        let mut free = 0;
        while let Some(frame) = way.last_mut() {
            budget.check().map_err(CagingFailureReason::Interrupted)?;
            if self.statistics.inverse_calls + self.statistics.motions > self.most {
                return Err(CagingFailureReason::Iterations);
            }
            if frame.name.0 == 0 {
                let names: Vec<Name> = way.iter().map(|frame| frame.name).collect();
                free = self.look_at(&names, free, budget).map_err(CagingFailureReason::Interrupted)?;
                if free == way.len() {
                    return Ok(Some(names.into_iter().rev().map(|name| self.state(name)).collect()));
                }
                // What is beyond the obstruction may be reached from elsewhere; what collides itself may not.
                for frame in way.drain(free..) {
                    let candidate = self.candidate(frame.name);
                    candidate.seen = candidate.free == Some(false);
                }
                continue;
            }
            if let Some(name) = frame.before.pop() {
                if !self.candidate(name).seen && self.known.get(&(frame.name, name)) != Some(&false) {
                    let frame = self.enter(name);
                    way.push(frame);
                }
            } else if frame.kept {
                (frame.kept, frame.before) = (false, self.before(frame.name, false));
            } else {
                way.pop();
                free = free.min(way.len());
            }
        }
        Ok(None)
    }

    /// How many of the states from the goal back are free, and joined by free motions; the first `free` of them are.
    fn look_at(&mut self, names: &[Name], free: usize, budget: &Budget<'_>) -> Result<usize, Interrupt> {
        for (number, &name) in names.iter().enumerate().skip(free) {
            budget.check()?;
            let state = self.state(name);
            let is_free = match self.candidate(name).free {
                Some(known) => known,
                None => {
                    let outcome = self.task.free(&state);
                    self.statistics.passes(outcome)
                }
            };
            self.candidate(name).free = Some(is_free);
            let joined = is_free && (number == 0 || self.joined(name, names[number - 1]));
            if !joined {
                return Ok(number);
            }
            if number >= self.partial.len() {
                self.partial = names[..=number].iter().rev().map(|&name| self.state(name)).collect();
            }
        }
        Ok(names.len())
    }

    /// Whether the motion from a state to the one after it is free.
    fn joined(&mut self, from: Name, to: Name) -> bool {
        if let Some(&known) = self.known.get(&(to, from)) {
            return known;
        }
        let (before, after) = (self.state(from), self.state(to));
        self.statistics.motions += 1;
        let outcome = self.task.motion(&before, &after);
        let joined = self.statistics.passes(outcome);
        self.known.insert((to, from), joined);
        joined
    }

    /// Marks a candidate as seen.
    fn enter(&mut self, name: Name) -> Frame {
        self.candidate(name).seen = true;
        Frame { name, before: self.before(name, true), kept: true }
    }

    /// Candidates of the step before that are near to one, the nearest last: of the same grasp, or of the others that it may
    /// change to.
    fn before(&mut self, name: Name, kept: bool) -> Vec<Name> {
        let (step, own, _) = name;
        if step == 0 {
            return vec![];
        }
        let q = self.candidate(name).q.clone();
        let adjacent = self.task.adjacent(own).to_vec();
        let mut before = Vec::new();
        for grasp in adjacent.into_iter().filter(|&grasp| (grasp == own) == kept) {
            self.candidates(step - 1, grasp);
            for (number, candidate) in self.table[step - 1][&grasp].iter().enumerate() {
                let distance = self.task.arm_space().distance(&candidate.q, &q);
                if !candidate.seen && distance <= self.task.longest_motion() {
                    before.push((distance, (step - 1, grasp, number)));
                }
            }
        }
        before.sort_by(|a, b| b.0.total_cmp(&a.0));
        before.into_iter().map(|(_, name)| name).collect()
    }
}
