//! Shorter paths: states left out, corners cut, random points joined.

use robotc_core::Seed;
use robotc_core::rng::Rng;

use crate::budget::Budget;
use crate::edge::{EdgeChecker, Patience};
use crate::space::Space;

/// What makes a path shorter, round by round.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShortenOptions {
    /// Most rounds; each leaves out states, joins random points and cuts corners.
    pub rounds: u32,
    /// Pairs of random points that a round tries to join.
    pub shortcuts: u32,
    /// The last round is one that saves less than this share of the length.
    pub least_gain: f64,
    /// Whether motions that pass narrowly are worth their time.
    pub patience: Patience,
}

impl Default for ShortenOptions {
    fn default() -> Self {
        Self { rounds: 6, shortcuts: 12, least_gain: 0.01, patience: Patience::Thorough }
    }
}

/// How far from a corner it is cut, as shares of the shorter of its sides; tried in this order.
const CUTS: [f64; 3] = [1.0, 0.5, 0.2];

pub(super) fn run<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    mut path: Vec<Vec<f64>>,
    options: &ShortenOptions,
    budget: &Budget<'_>,
    seed: Seed,
) -> Vec<Vec<f64>> {
    let mut rng = seed.rng();
    let mut length = checker.space().length(&path);
    for _ in 0..options.rounds {
        if path.len() < 3 || budget.check().is_err() {
            break;
        }
        leave_out(checker, &mut path, budget);
        join(checker, &mut path, options.shortcuts, budget, &mut rng);
        cut_corners(checker, &mut path, budget);
        let before = std::mem::replace(&mut length, checker.space().length(&path));
        if length > (1.0 - options.least_gain) * before {
            break;
        }
    }
    path
}

/// From each state, goes straight to the farthest later state that can be reached.
fn leave_out<C: EdgeChecker + ?Sized>(checker: &mut C, path: &mut Vec<Vec<f64>>, budget: &Budget<'_>) {
    let mut at = 0;
    while at + 2 < path.len() {
        for far in (at + 2..path.len()).rev() {
            if budget.check().is_err() {
                return;
            }
            if checker.edge(&path[at], &path[far]).is_ok() {
                path.drain(at + 1..far);
                break;
            }
        }
        at += 1;
    }
}

/// Joins random points of the path.
fn join<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    path: &mut Vec<Vec<f64>>,
    attempts: u32,
    budget: &Budget<'_>,
    rng: &mut Rng,
) {
    for _ in 0..attempts {
        if path.len() < 3 || budget.check().is_err() {
            return;
        }
        let length = checker.space().length(path);
        let (s, t) = (rng.unit() * length, rng.unit() * length);
        let (edge_a, a) = checker.space().point_at(path, s.min(t));
        let (edge_b, b) = checker.space().point_at(path, s.max(t));
        if edge_a == edge_b {
            continue;
        }
        let space = checker.space();
        let along = space.distance(&a, &path[edge_a + 1])
            + space.length(&path[edge_a + 1..=edge_b])
            + space.distance(&path[edge_b], &b);
        let saved = along - space.distance(&a, &b);
        if saved > 1e-3 * length && checker.edge(&a, &b).is_ok() {
            path.splice(edge_a + 1..=edge_b, [a, b]);
        }
    }
}

/// Replaces corners by straight motions between points on their sides, as far from the corner as possible. The rest of each
/// side is part of a motion that is free.
fn cut_corners<C: EdgeChecker + ?Sized>(checker: &mut C, path: &mut Vec<Vec<f64>>, budget: &Budget<'_>) {
    let mut corner = 1;
    while corner + 1 < path.len() {
        let space = checker.space();
        let before = space.distance(&path[corner - 1], &path[corner]);
        let after = space.distance(&path[corner], &path[corner + 1]);
        let side = before.min(after);
        let mut cut = None;
        for share in CUTS {
            if side == 0.0 || budget.check().is_err() {
                break;
            }
            let space = checker.space();
            let (s, t) = (share * side / before, share * side / after);
            let a = space.interpolate(&path[corner], &path[corner - 1], s);
            let b = space.interpolate(&path[corner], &path[corner + 1], t);
            let saved = 2.0 * share * side - space.distance(&a, &b);
            if saved < 1e-3 * (before + after) {
                break;
            }
            if checker.edge(&a, &b).is_ok() {
                cut = Some((a, b));
                break;
            }
        }
        match cut {
            Some((a, b)) => {
                path.splice(corner..=corner, [a, b]);
                corner += 2;
            }
            None => corner += 1,
        }
    }
    drop_repeated(checker.space(), path);
}

/// Leaves out states that are where the one before them is: sides that were cut off whole.
fn drop_repeated(space: &Space, path: &mut Vec<Vec<f64>>) {
    let mut i = 1;
    while i + 1 < path.len() {
        if space.squared_distance(&path[i - 1], &path[i]) < 1e-24
            || space.squared_distance(&path[i], &path[i + 1]) < 1e-24
        {
            path.remove(i);
        } else {
            i += 1;
        }
    }
}
