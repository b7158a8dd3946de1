//! The search behind [`Solver::free_intervals`]: which values of a free variable have solutions: cells that are known to be inside or outside, and what is in between.

use std::f64::consts::PI;

use robotc_core::Pose;
use robotc_core::ik::{IkSolutions, Preferences, VariableRange};
use robotc_core::model::ChainMotion;

use super::general::Seven;
use super::interval::Interval;
use super::{RedundancyOptions, bounds, united};
use crate::GoalType;
use crate::run::{Solver, frame};

/// Points that are tried where intervals say nothing.
pub(super) const POINTS: usize = 400;

/// What a cell is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum State {
    Inside,
    Outside,
    Unknown,
}

pub(super) struct Cell {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) state: State,
}

/// Width of the widest cell of unknown state.
pub(super) fn widest_unknown(cells: &[Cell]) -> f64 {
    cells.iter().filter(|c| c.state == State::Unknown).map(|c| c.high - c.low).fold(0.0, f64::max)
}

pub(super) struct Search<'a> {
    pub(super) solver: &'a Solver,
    pub(super) base_from_tip: &'a Pose,
    pub(super) free: &'a [f64],
    pub(super) k: usize,
    pub(super) ranges: &'a [VariableRange],
    pub(super) first: Preferences,
}

impl Search<'_> {
    /// Whether there is a solution at a value.
    fn holds(&self, value: f64) -> bool {
        let mut free = self.free.to_vec();
        free[self.k] = value;
        let mut out = IkSolutions::new();
        let done = self.solver.solve_preferred(self.base_from_tip, &free, &self.first, &mut out);
        done.is_ok() && !out.is_empty()
    }

    /// What can be said of all values of a cell.
    fn state(&self, low: f64, high: f64) -> State {
        let program = self.solver.program();
        let mut free: Vec<Interval> = self.free.iter().map(|x| Interval::point(*x)).collect();
        free[self.k] = Interval { low, high };
        let Ok(branches) = bounds::branches(program, &frame(self.base_from_tip), &free, program.slack) else {
            return State::Unknown;
        };
        let mut state = State::Outside;
        for branch in &branches {
            match self.keeps_limits(branch, 100.0 * program.slack) {
                // A program may offer what is none: the solver has the last word.
                Some(true) if self.holds(0.5 * (low + high)) => return State::Inside,
                Some(false) => {}
                _ => state = State::Unknown,
            }
        }
        state
    }

    /// Whether all solutions of a branch keep the limits, or none does.
    fn keeps_limits(&self, branch: &[Interval], slack: f64) -> Option<bool> {
        let mut all = Some(true);
        for (v, (range, value)) in self.ranges.iter().zip(branch).enumerate() {
            if self.solver.program().free.contains(&v) || range.is_continuous() {
                continue;
            }
            // The slack of limits, and rounding of the bounds.
            let value = value.wider(slack + 1e-12);
            let turns = if range.motion == ChainMotion::Revolute { -3..=3 } else { 0..=0 };
            let aliases = turns.map(|t| value.plus(Interval::point(2.0 * PI * f64::from(t))));
            let mut here = Some(false);
            for alias in aliases {
                if range.lower <= alias.low && alias.high <= range.upper {
                    here = Some(true);
                    break;
                }
                if alias.high >= range.lower - 2e-9 && alias.low <= range.upper + 2e-9 {
                    here = None;
                }
            }
            match here {
                Some(false) => return Some(false),
                Some(true) => {}
                None => all = None,
            }
        }
        all
    }

    /// Cells of known state, and those of unknown state that are narrower than `width` or for which `most` did not suffice.
    pub(super) fn cells(&self, low: f64, high: f64, width: f64, most: usize) -> Vec<Cell> {
        let first = 64;
        let step = (high - low) / first as f64;
        let mut open: Vec<[f64; 2]> = (0..first)
            .rev()
            .map(|k| [low + step * k as f64, if k + 1 == first { high } else { low + step * (k + 1) as f64 }])
            .collect();
        let mut cells: Vec<Cell> = Vec::new();
        let mut looked = 0;
        while let Some([low, high]) = open.pop() {
            looked += 1;
            let state = self.state(low, high);
            if state == State::Unknown && high - low > width && looked < most {
                let middle = 0.5 * (low + high);
                open.push([middle, high]);
                open.push([low, middle]);
                continue;
            }
            match cells.last_mut() {
                Some(last) if last.state == state => last.high = high,
                _ => cells.push(Cell { low, high, state }),
            }
        }
        cells
    }

    /// Cells between values at which the number of solutions within limits may change; `None` unless seven joints turn.
    pub(super) fn between_changes(
        &self,
        [low, high]: [f64; 2],
        options: &RedundancyOptions,
    ) -> Option<Vec<Cell>> {
        let program = self.solver.program();
        if program.goal != GoalType::Transform6D || self.free.len() != 1 {
            return None;
        }
        let given = program.free[0];
        let seven = Seven::of(&self.solver.chain, self.base_from_tip)?;
        let unsteady = seven.unsteady(given, [low, high], options.width);
        let mut changes: Vec<[f64; 2]> = seven
            .crossings(self.solver, self.base_from_tip, given, self.ranges)
            .into_iter()
            .filter(|x| low < *x && *x < high)
            .map(|x| [x, x])
            .collect();
        changes.extend(&unsteady);
        changes.push([high, high]);
        let mut cells = Vec::new();
        let mut from = low;
        for [start, end] in united(changes) {
            if start > from {
                // One value would do; three tell when a crossing was lost.
                let holds = [0.5, 0.01, 0.99].map(|part| self.holds(from + part * (start - from)));
                let state = match holds {
                    [true, true, true] => State::Inside,
                    [false, false, false] => State::Outside,
                    _ => State::Unknown,
                };
                cells.push(Cell { low: from, high: start, state });
            }
            if end > start {
                cells.push(Cell { low: start, high: end, state: State::Unknown });
            }
            from = end;
        }
        Some(cells)
    }

    /// Cells between points at which the solver was asked.
    pub(super) fn points(&self, low: f64, high: f64) -> Vec<Cell> {
        let at = |k: usize| if k == POINTS { high } else { low + (high - low) / POINTS as f64 * k as f64 };
        let mut cells: Vec<Cell> = Vec::new();
        let mut before = self.holds(low);
        for k in 0..POINTS {
            let after = self.holds(at(k + 1));
            let state = match (before, after) {
                (true, true) => State::Inside,
                (false, false) => State::Outside,
                _ => State::Unknown,
            };
            before = after;
            match cells.last_mut() {
                Some(last) if last.state == state && state != State::Unknown => last.high = at(k + 1),
                _ => cells.push(Cell { low: at(k), high: at(k + 1), state }),
            }
        }
        cells
    }

    /// The intervals that cells make; inside of unknown ones the solver is asked.
    pub(super) fn intervals(&self, cells: &[Cell]) -> Vec<[f64; 2]> {
        let whole = cells.last().map_or(0.0, |c| c.high) - cells.first().map_or(0.0, |c| c.low);
        let step = (whole / POINTS as f64).max(f64::MIN_POSITIVE);
        let mut found: Vec<[f64; 2]> = Vec::new();
        let mut add = |low: f64, high: f64| match found.last_mut() {
            Some(last) if last[1] >= low => last[1] = last[1].max(high),
            _ => found.push([low, high]),
        };
        for cell in cells {
            match cell.state {
                State::Outside => {}
                State::Inside => add(cell.low, cell.high),
                State::Unknown => {
                    let parts = ((cell.high - cell.low) / step).ceil().max(4.0) as usize;
                    let at = |i: usize| cell.low + (cell.high - cell.low) * (i as f64 / parts as f64);
                    let holds: Vec<bool> = (0..=parts).map(|i| self.holds(at(i))).collect();
                    for i in 0..parts {
                        match (holds[i], holds[i + 1]) {
                            (true, true) => add(at(i), at(i + 1)),
                            (true, false) => add(at(i), self.end(at(i), at(i + 1))),
                            (false, true) => add(self.end(at(i + 1), at(i)), at(i + 1)),
                            (false, false) => {}
                        }
                    }
                }
            }
        }
        found
    }

    /// The last value with a solution on the way from one that has one to one that has none.
    fn end(&self, mut inside: f64, mut outside: f64) -> f64 {
        for _ in 0..60 {
            let middle = 0.5 * (inside + outside);
            if middle == inside || middle == outside || (inside - outside).abs() < 1e-12 {
                break;
            }
            if self.holds(middle) { inside = middle } else { outside = middle }
        }
        inside
    }
}
