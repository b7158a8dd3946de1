//! Several searches for the same motion at once.
//!
//! Search times have a heavy tail: of several searches with different seeds, the first to arrive is rarely slow. Which of them
//! counts is decided by how often they asked their budget, once an iteration, and then by number, never by the clock, so that the
//! path is the same with any number of threads.

use std::cell::Cell;
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use robotc_core::Seed;

use super::{MotionFailure, MotionPlan, SearchOptions, find_motion};
use crate::budget::{Budget, Interrupt};
use crate::edge::EdgeChecker;

/// Who races.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Race {
    /// Searches, each with a stream of its own; at least one.
    pub racers: u32,
    /// Iterations that the first search has for itself. It wins when it arrives in as many, so that a motion which is easily found
    /// costs no more than without a race.
    pub head_start: u32,
}

impl Default for Race {
    fn default() -> Self {
        Self { racers: 2, head_start: 200 }
    }
}

/// Finds a path from `start` to `goal` by several [racing](race()) searches, each with a stream of `seed`.
///
/// Each of the `others` has a thread of its own beside the caller's; all checkers are of the same robot and world.
pub fn race_motion<C: EdgeChecker + Send>(
    checker: &mut C,
    others: &mut [C],
    racing: Race,
    start: &[f64],
    goal: &[f64],
    options: &SearchOptions,
    interrupt: &(dyn Fn() -> Option<Interrupt> + Sync),
    seed: Seed,
) -> Result<MotionPlan, MotionFailure> {
    let search = |checker: &mut C, racer: u32, budget: &Budget<'_>| {
        find_motion(checker, start, goal, options, budget, seed.at(u64::from(racer)))
    };
    race(checker, others, racing, &search, interrupt)
}

/// The result of the first search, if it arrives within its head start, else of the one that takes the fewest iterations, the first of
/// equals. A search ends when another one has arrived in fewer; when none arrives, the failure is that of the first one.
///
/// `search` is given what its thread works with, the number of the search, and a budget that it asks in every iteration. Each of the
/// `others` has a thread of its own beside the caller's. `interrupt` is asked by all searches in every iteration.
pub fn race<W: Send, T: Send, E: Send>(
    worker: &mut W,
    others: &mut [W],
    racing: Race,
    search: &(dyn Fn(&mut W, u32, &Budget<'_>) -> Result<T, E> + Sync),
    interrupt: &(dyn Fn() -> Option<Interrupt> + Sync),
) -> Result<T, E> {
    let next = AtomicUsize::new(1);
    let fewest = AtomicU32::new(u32::MAX);
    let arrived = Mutex::new(None);
    let failed = Mutex::new(None);
    let run = |worker: &mut W, racer: usize, started: &dyn Fn(u32)| {
        let own = if racer == 0 { racing.head_start } else { 0 };
        let iterations = Cell::new(0);
        let overtaken = || iterations.get() > fewest.load(Ordering::Relaxed).max(own);
        let stop = || {
            iterations.set(iterations.get() + 1);
            started(iterations.get());
            if overtaken() { Some(Interrupt::Cancelled) } else { interrupt() }
        };
        match search(worker, racer as u32, &Budget::new(&stop)) {
            Ok(found) => {
                // Nobody arrives in less than nothing.
                let counted = if iterations.get() <= own { 0 } else { iterations.get() };
                fewest.fetch_min(counted, Ordering::Relaxed);
                keep_first(&arrived, (counted, racer), found);
            }
            Err(_) if overtaken() => {}
            Err(failure) => keep_first(&failed, (0, racer), failure),
        }
    };
    let rest = |worker: &mut W| {
        loop {
            let racer = next.fetch_add(1, Ordering::Relaxed);
            if racer >= racing.racers as usize || fewest.load(Ordering::Relaxed) == 0 {
                return;
            }
            run(worker, racer, &|_| {});
        }
    };
    std::thread::scope(|scope| {
        let waiting = Cell::new(Some(others));
        let head_start_is_over = |iterations: u32| {
            if iterations > racing.head_start && racing.racers > 1 {
                for worker in waiting.take().into_iter().flatten() {
                    scope.spawn(|| rest(worker));
                }
            }
        };
        run(worker, 0, &head_start_is_over);
        rest(worker);
    });
    match (first_of(arrived), first_of(failed)) {
        (Some(found), _) => Ok(found),
        (None, Some(failure)) => Err(failure),
        (None, None) => unreachable!("a search is overtaken only by one that arrived"),
    }
}

/// Keeps what comes first in an order.
fn keep_first<T>(kept: &Mutex<Option<((u32, usize), T)>>, order: (u32, usize), value: T) {
    let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
    if kept.as_ref().is_none_or(|(before, _)| order < *before) {
        *kept = Some((order, value));
    }
}

fn first_of<T>(kept: Mutex<Option<((u32, usize), T)>>) -> Option<T> {
    kept.into_inner().unwrap_or_else(PoisonError::into_inner).map(|(_, value)| value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edge::{Obstruction, walk_path};
    use crate::toy::Toy;

    /// Of the searches in these tests some arrive sooner, and some later.
    const HEAD_START: u32 = 150;

    fn toys(count: usize) -> Vec<Toy> {
        let padded = || {
            let mut toy = Toy::wall(0.05);
            toy.padding = 0.025;
            toy
        };
        (0..count).map(|_| padded()).collect()
    }

    fn race(threads: usize, racers: u32, goal: [f64; 2], seed: u64) -> Result<MotionPlan, MotionFailure> {
        let options = SearchOptions { max_iterations: 3000, ..SearchOptions::default() };
        let (first, others) = (&mut toys(1)[0], &mut toys(threads - 1));
        let racing = Race { racers, head_start: HEAD_START };
        race_motion(first, others, racing, &[1.0, 1.0], &goal, &options, &|| None, Seed::new(seed))
    }

    #[test]
    fn the_path_is_the_same_with_any_number_of_threads_and_takes_the_fewest_iterations() {
        let (mut sooner, mut within) = (0, 0);
        for seed in 0..20 {
            let found = race(1, 4, [9.0, 1.0], seed).unwrap();
            for threads in [2, 3, 6] {
                assert_eq!(race(threads, 4, [9.0, 1.0], seed).unwrap(), found);
            }
            walk_path(&mut Toy::wall(0.01), &found.path).unwrap();
            let alone = race(2, 1, [9.0, 1.0], seed).unwrap();
            assert!(found.iterations <= alone.iterations);
            if alone.iterations <= HEAD_START {
                assert_eq!(found, alone, "it had arrived before the others started");
                within += 1;
            }
            sooner += usize::from(found.iterations < alone.iterations);
        }
        assert!(sooner > 5 && within > 0, "{sooner}, {within}");
    }

    #[test]
    fn a_race_that_nobody_can_win_says_why() {
        let covered = race(2, 3, [4.5, 1.0], 1);
        assert_eq!(covered, Err(MotionFailure::Goal(Obstruction::Contact(0))));
        let (options, spent) = (SearchOptions::default(), || Some(Interrupt::TimeUp));
        let (first, others) = (&mut toys(1)[0], &mut toys(1));
        let stopped = race_motion(
            first,
            others,
            Race::default(),
            &[1.0; 2],
            &[9.0, 1.0],
            &options,
            &spent,
            Seed::new(1),
        );
        assert_eq!(stopped, Err(MotionFailure::Interrupted(Interrupt::TimeUp, 0)));
    }
}
