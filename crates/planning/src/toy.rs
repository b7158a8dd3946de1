//! A point among boxes in the plane: the space every planner is tested on.

use crate::edge::{EdgeChecker, Obstruction};
use crate::space::{Axis, Space};

/// A point in a 10 x 10 square with rectangular obstacles.
pub(crate) struct Toy {
    space: Space,
    resolution: f64,
    /// Lower and upper corners.
    boxes: Vec<([f64; 2], [f64; 2])>,
    /// A point this near to a box counts as touching it.
    pub(crate) padding: f64,
    /// Whether states report their distance to the nearest box.
    pub(crate) clearance: bool,
    /// All states asked for.
    pub(crate) seen: Vec<[f64; 2]>,
}

impl Toy {
    pub(crate) fn new(boxes: Vec<([f64; 2], [f64; 2])>, resolution: f64) -> Self {
        let space = Space::new(vec![Axis::bounded(0.0, 10.0); 2]);
        Self { space, resolution, boxes, padding: 0.0, clearance: true, seen: Vec::new() }
    }

    /// A wall from x = 4 to x = 5 that leaves a gap at the top: y > 9.
    pub(crate) fn wall(resolution: f64) -> Self {
        Self::new(vec![([4.0, 0.0], [5.0, 9.0])], resolution)
    }

    /// A closed room around (8, 8).
    pub(crate) fn room(resolution: f64) -> Self {
        let walls = vec![
            ([6.0, 6.0], [10.0, 6.5]),
            ([6.0, 9.5], [10.0, 10.0]),
            ([6.0, 6.0], [6.5, 10.0]),
            ([9.5, 6.0], [10.0, 10.0]),
        ];
        Self::new(walls, resolution)
    }

    fn distance_to_box(q: &[f64], (low, high): &([f64; 2], [f64; 2])) -> f64 {
        let gap = |i: usize| (low[i] - q[i]).max(q[i] - high[i]).max(0.0);
        gap(0).hypot(gap(1))
    }
}

impl EdgeChecker for Toy {
    fn space(&self) -> &Space {
        &self.space
    }

    fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction> {
        self.seen.push([q[0], q[1]]);
        if !self.space.contains(q) {
            return Err(Obstruction::Bounds);
        }
        let mut clearance = f64::INFINITY;
        for (i, obstacle) in self.boxes.iter().enumerate() {
            let distance = Self::distance_to_box(q, obstacle) - self.padding;
            if distance <= 0.0 {
                return Err(Obstruction::Contact(i as u32));
            }
            clearance = clearance.min(distance);
        }
        Ok(if self.clearance { clearance } else { 0.0 })
    }

    fn travel(&self, difference: &[f64]) -> f64 {
        difference[0].hypot(difference[1])
    }

    fn resolution(&self) -> f64 {
        self.resolution
    }
}
