//! The space around a surface that a ball can reach from far away.

use std::collections::VecDeque;

use nalgebra::{Point3, Vector3};

use super::super::{Aabb, MeshIndex};

/// Edge of a cell, as a fraction of the ball's diameter.
const CELL: f64 = 0.5;

/// A cell is open when its centre is farther than this from the surface, as a fraction of the ball's diameter. A point a
/// whole diameter off is then in an open cell (centres are within 0.44 of it), and no wall lies between two open
/// neighbours (one of their centres would be within 0.25 of it).
const OPEN: f64 = 0.5;

/// Cells of a grid that a ball reaches from outside. A surface need not be closed for this to make sense: a ball does
/// not pass a crack, and it does enter a vessel made of a single sheet.
pub(super) struct Outside {
    low: Point3<f64>,
    cell: f64,
    counts: [usize; 3],
    reached: Vec<bool>,
}

impl Outside {
    /// Floods the box around `surface`, starting from its walls, with a ball of this diameter.
    pub(super) fn new(surface: &MeshIndex, bounds: &Aabb, diameter: f64) -> Self {
        let cell = CELL * diameter;
        let bounds = bounds.padded(2.0 * diameter);
        let counts = [0, 1, 2].map(|k| (bounds.size()[k] / cell).ceil().max(1.0) as usize);
        let mut grid = Self { low: bounds.low, cell, counts, reached: vec![false; counts.iter().product()] };
        let mut seen = grid.reached.clone();
        let mut front = VecDeque::from([[0, 0, 0]]);
        seen[0] = true;
        // The padding is free all around, so one corner reaches every wall.
        while let Some(at) = front.pop_front() {
            let index = grid.index(at);
            if surface.near_enough(&grid.centre(at), OPEN * diameter, OPEN * diameter).is_some() {
                continue;
            }
            grid.reached[index] = true;
            for k in 0..3 {
                let before = at[k].checked_sub(1);
                let after = (at[k] + 1 < counts[k]).then_some(at[k] + 1);
                for moved in [before, after].into_iter().flatten() {
                    let mut next = at;
                    next[k] = moved;
                    let index = grid.index(next);
                    if !std::mem::replace(&mut seen[index], true) {
                        front.push_back(next);
                    }
                }
            }
        }
        grid
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (i * self.counts[1] + j) * self.counts[2] + k
    }

    fn centre(&self, at: [usize; 3]) -> Point3<f64> {
        self.low + Vector3::from(at.map(|i| (i as f64 + 0.5) * self.cell))
    }

    /// Whether the ball reaches the cell of this point; it does beyond the grid.
    pub(super) fn reaches(&self, point: &Point3<f64>) -> bool {
        let mut at = [0; 3];
        for k in 0..3 {
            let position = ((point[k] - self.low[k]) / self.cell).floor();
            if position < 0.0 || position >= self.counts[k] as f64 {
                return true;
            }
            at[k] = position as usize;
        }
        self.reached[self.index(at)]
    }
}
