//! RRT-Connect with restarts.
//!
//! Two trees grow in turn, the smaller one next, each step followed by an attempt to connect (Kuffner and LaValle,
//! "RRT-Connect", 2000). Search times have a heavy tail, so that searches start over after a number of iterations that
//! follows Luby's sequence (Luby, Sinclair and Zuckerman, "Optimal speedup of Las Vegas algorithms", 1993).

use robotc_core::Seed;
use robotc_core::rng::Rng;

use super::sampling::{Growth, Sampler, Sampling};
use super::tree::Tree;
use super::{MotionFailure, MotionPlan};
use crate::budget::Budget;
use crate::edge::{EdgeChecker, Patience};
use crate::space::Space;

/// Parameters of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchOptions {
    /// Longest edge of the trees, as a fraction of the diameter of the space.
    pub step: f64,
    /// How the states are drawn that trees grow towards.
    pub sampling: &'static Sampling,
    /// Iterations of the shortest run; others are 1, 1, 2, 1, 1, 2, 4, ... times as long.
    pub restart: u32,
    /// A node from which a step was blocked is extended only towards samples within this many steps (Yershova, Jaillet,
    /// Simeon and LaValle, "Dynamic-domain RRTs", 2005).
    pub domain: f64,
    /// Ways that look free are proven only when they are complete, until so many of a run were not free after all; then
    /// each motion is proven as it is added.
    pub hopes: u32,
    /// Iterations, over all runs, after which the search gives up. Those whose sample is outside of the domain cost next to nothing.
    pub max_iterations: u32,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self {
            step: 0.1,
            sampling: <&Sampling>::default(),
            restart: 40_000,
            domain: 3.0,
            hopes: 100,
            max_iterations: 4_000_000,
        }
    }
}

/// How far a tree got towards a state.
enum Reach {
    /// To the state itself.
    There(usize),
    /// To a node on the way.
    Short(usize),
    /// Not a single step.
    Blocked,
}

pub(super) fn run<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    start: &[f64],
    goal: &[f64],
    options: &SearchOptions,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<MotionPlan, MotionFailure> {
    let mut free = |patience: Patience, from: &[f64], to: &[f64]| {
        checker.set_patience(patience);
        checker.edge(from, to).is_ok()
    };
    if free(Patience::Hopeful, start, goal) && free(Patience::Thorough, start, goal) {
        return Ok(MotionPlan { path: vec![start.to_vec(), goal.to_vec()], iterations: 0 });
    }
    // Where an end itself is in doubt, the wary would not get away from it.
    let open = free(Patience::Wary, start, start) && free(Patience::Wary, goal, goal);
    let space = checker.space().clone();
    let mut search = Search {
        step: options.step * space.diameter(),
        space,
        from_start: Tree::new(checker.space()),
        from_goal: Tree::new(checker.space()),
        sample: start.to_vec(),
        next: start.to_vec(),
        glance: Patience::Hopeful,
        disappointments: 0,
        options,
    };
    let mut iterations = 0;
    for run in 0.. {
        search.from_start.plant(checker.space(), start);
        search.from_goal.plant(checker.space(), goal);
        search.disappointments = 0;
        // What only looks narrow to the wary is left to every other run.
        search.glance = if open && run % 2 == 0 { Patience::Wary } else { Patience::Hopeful };
        let seed = seed.at(run);
        let mut sampler = options.sampling.sampler(&search.space, seed.split("sampler"));
        let mut rng = seed.rng();
        let length = options.restart.saturating_mul(luby(run + 1)).max(1);
        for _ in 0..length {
            budget.check().map_err(|interrupt| MotionFailure::Interrupted(interrupt, iterations))?;
            if iterations >= options.max_iterations {
                return Err(MotionFailure::Iterations(iterations));
            }
            iterations += 1;
            if let Some(path) = search.iterate(checker, &mut *sampler, &mut rng) {
                return Ok(MotionPlan { path, iterations });
            }
        }
    }
    unreachable!("runs end by their iterations")
}

/// The n-th number, from 1 on, of Luby's sequence 1, 1, 2, 1, 1, 2, 4, ...
fn luby(n: u64) -> u32 {
    let mut n = n;
    loop {
        let bits = u64::BITS - n.leading_zeros();
        if n == (1 << bits) - 1 {
            return 1 << (bits - 1);
        }
        n -= (1 << (bits - 1)) - 1;
    }
}

struct Search<'a> {
    options: &'a SearchOptions,
    space: Space,
    step: f64,
    from_start: Tree,
    from_goal: Tree,
    sample: Vec<f64>,
    next: Vec<f64>,
    /// How this run looks at motions that are not proven yet.
    glance: Patience,
    /// Ways that looked free and were not, in this run.
    disappointments: u32,
}

impl Search<'_> {
    /// Grows the smaller tree by a step and tries to connect; a path when the trees meet.
    fn iterate<C: EdgeChecker + ?Sized>(
        &mut self,
        checker: &mut C,
        sampler: &mut dyn Sampler,
        rng: &mut Rng,
    ) -> Option<Vec<Vec<f64>>> {
        let hopeful = self.disappointments < self.options.hopes;
        checker.set_patience(if hopeful { self.glance } else { Patience::Thorough });
        let Self { options, space, step, from_start, from_goal, sample, next, disappointments, .. } = self;
        let forward = from_start.len() <= from_goal.len();
        let (grown, other) = if forward { (from_start, from_goal) } else { (from_goal, from_start) };
        let mut free = |q: &[f64]| checker.edge(q, q).is_ok();
        sampler.draw(&mut Growth { space, tree: grown, step: *step, free: &mut free }, rng, sample);
        let (near, distance) = grown.nearest(checker.space(), sample);
        if distance > *grown.domain(near) {
            return None;
        }
        let new = match extend(checker, grown, near, distance, sample, *step, !hopeful, next) {
            Reach::There(node) | Reach::Short(node) => node,
            Reach::Blocked => {
                *grown.domain(near) = options.domain * *step;
                return None;
            }
        };
        sample.copy_from_slice(grown.state(new));
        let (mut at, mut distance) = other.nearest(checker.space(), sample);
        loop {
            match extend(checker, other, at, distance, sample, *step, !hopeful, next) {
                Reach::Short(node) => (at, distance) = (node, distance - *step),
                Reach::Blocked => return None,
                Reach::There(met) => {
                    checker.set_patience(Patience::Thorough);
                    if !prove(checker, grown, new) || !prove(checker, other, met) {
                        *disappointments += 1;
                        return None;
                    }
                    let (mut path, rest) = (grown.to_root(new), other.to_root(met));
                    path.reverse();
                    // Both nodes are the same state; it is kept once.
                    path.extend(rest.into_iter().skip(1));
                    if !forward {
                        path.reverse();
                    }
                    return Some(path);
                }
            }
        }
    }
}

/// Proves the way from the root to a node, and prunes what hangs on a motion that is not free. Whether all of it is.
fn prove<C: EdgeChecker + ?Sized>(checker: &mut C, tree: &mut Tree, node: usize) -> bool {
    while let Some(unproven) = tree.first_unproven(node) {
        if checker.edge(tree.state(tree.parent(unproven)), tree.state(unproven)).is_err() {
            tree.prune(unproven);
            return false;
        }
        tree.prove(unproven);
    }
    true
}

/// A step from a node towards a state that is `distance` away.
fn extend<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    tree: &mut Tree,
    node: usize,
    distance: f64,
    towards: &[f64],
    step: f64,
    proven: bool,
    next: &mut Vec<f64>,
) -> Reach {
    let arrives = distance <= step;
    next.clear();
    if arrives {
        next.extend_from_slice(towards);
    } else {
        checker.space().interpolate_into(tree.state(node), towards, step / distance, next);
    }
    if checker.edge(tree.state(node), next).is_err() {
        return Reach::Blocked;
    }
    let new = tree.push(checker.space(), node, next, proven);
    if arrives { Reach::There(new) } else { Reach::Short(new) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_follow_lubys_sequence() {
        let first: Vec<u32> = (1..=15).map(luby).collect();
        assert_eq!(first, [1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1, 2, 4, 8]);
    }
}
