//! Shorter paths: post-processors that run one after the other.

use robotc_core::rng::Rng;
use serde::{Deserialize, Serialize};

use crate::budget::Budget;
use crate::edge::EdgeChecker;

/// One pass over a path. Passes keep the ends, never make the path longer, and add only edges that were checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Smoother {
    /// Leaves out states: from each, goes straight to the farthest later state that can be reached.
    Skip,
    /// Joins random points of the path.
    Shortcut {
        /// How many pairs of points to try.
        attempts: u32,
        /// Failures in a row after which the pass ends.
        patience: u32,
    },
}

/// Skip, shortcut, skip: what is run when nothing else is asked for.
pub const DEFAULT_SMOOTHERS: [Smoother; 3] =
    [Smoother::Skip, Smoother::Shortcut { attempts: 40, patience: 12 }, Smoother::Skip];

/// Runs the passes over a valid path until all are done or the budget ends; either way the path returned is valid.
pub fn smooth<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    path: Vec<Vec<f64>>,
    passes: &[Smoother],
    budget: &Budget<'_>,
    rng: &mut Rng,
) -> Vec<Vec<f64>> {
    let mut path = path;
    for pass in passes {
        match *pass {
            Smoother::Skip => skip(checker, &mut path, budget),
            Smoother::Shortcut { attempts, patience } => {
                shortcut(checker, &mut path, attempts, patience, budget, rng);
            }
        }
    }
    path
}

fn skip<C: EdgeChecker + ?Sized>(checker: &mut C, path: &mut Vec<Vec<f64>>, budget: &Budget<'_>) {
    let mut at = 0;
    while at + 2 < path.len() {
        let mut far = path.len() - 1;
        while far > at + 1 {
            if budget.check().is_err() {
                return;
            }
            if checker.edge(&path[at], &path[far]).is_ok() {
                path.drain(at + 1..far);
                break;
            }
            far -= 1;
        }
        at += 1;
    }
}

fn shortcut<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    path: &mut Vec<Vec<f64>>,
    attempts: u32,
    patience: u32,
    budget: &Budget<'_>,
    rng: &mut Rng,
) {
    let mut failures = 0;
    for _ in 0..attempts {
        if path.len() < 3 || failures >= patience || budget.check().is_err() {
            return;
        }
        let length = checker.space().length(path);
        let (s, t) = (rng.unit() * length, rng.unit() * length);
        let (edge_a, a) = checker.space().point_at(path, s.min(t));
        let (edge_b, b) = checker.space().point_at(path, s.max(t));
        if edge_a == edge_b {
            continue;
        }
        let mut detour = vec![a.clone()];
        detour.extend_from_slice(&path[edge_a + 1..=edge_b]);
        detour.push(b.clone());
        let saved = checker.space().length(&detour) - checker.space().distance(&a, &b);
        if saved > 1e-3 * length && checker.edge(&a, &b).is_ok() {
            path.splice(edge_a + 1..=edge_b, [a, b]);
            failures = 0;
        } else {
            failures += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edge::walk_path;
    use crate::toy::Toy;
    use robotc_core::Seed;

    fn detour() -> Vec<Vec<f64>> {
        vec![
            vec![1.0, 1.0],
            vec![0.5, 5.0],
            vec![3.0, 6.0],
            vec![2.0, 9.5],
            vec![6.0, 9.8],
            vec![5.5, 5.0],
            vec![9.0, 1.0],
        ]
    }

    #[test]
    fn paths_get_shorter_and_stay_valid() {
        let shortest = {
            // Over the corners (4, 9) and (5, 9) of the wall.
            let corners = [[1.0, 1.0], [4.0, 9.0], [5.0, 9.0], [9.0, 1.0]].map(|p| p.to_vec());
            Toy::wall(0.05).space().length(&corners)
        };
        for seed in 0..20 {
            let mut toy = Toy::wall(0.05);
            toy.padding = 0.025;
            let passes =
                [Smoother::Skip, Smoother::Shortcut { attempts: 200, patience: 100 }, Smoother::Skip];
            let path = smooth(&mut toy, detour(), &passes, &Budget::unlimited(), &mut Seed::new(seed).rng());
            assert_eq!((&path[0], path.last().unwrap()), (&detour()[0], &detour()[6]));
            walk_path(&mut Toy::wall(0.001), &path).unwrap();
            let length = toy.space().length(&path);
            assert!(length >= shortest && length < 1.1 * shortest, "{length} against {shortest}");
        }
    }

    #[test]
    fn a_spent_budget_changes_nothing() {
        let spent = || Some(crate::budget::Interrupt::TimeUp);
        let (mut toy, mut rng) = (Toy::wall(0.05), Seed::new(1).rng());
        let path = smooth(&mut toy, detour(), &DEFAULT_SMOOTHERS, &Budget::new(&spent), &mut rng);
        assert_eq!(path, detour());
    }
}
