//! Where two bodies stay apart, as a table over the few joints between them.
//!
//! Neighbours, say a forearm and a hand, are always close; spheres would have to look at them closely in every
//! configuration. What they do depends on two or three joints, so that it can be found once: a cell of joint values is
//! marked when the bodies are farther apart in its middle than the joints can bring them together within it.

use std::sync::Arc;

use robotc_core::geom::{ConvexParts, any_within};
use robotc_core::{DofIdx, Kinematics, LinkIdx, Pose, TypedVec};

use super::mechanism::{LaneRobot, Pair};

/// Cells of joint values, with how many below each are not proven apart.
#[derive(Debug, Clone)]
pub(super) struct Apart {
    axes: Vec<Axis>,
    /// For each corner of cells, the number of open cells below it in all coordinates.
    open_below: Vec<u32>,
}

#[derive(Debug, Clone)]
struct Axis {
    /// Which degree of freedom.
    column: usize,
    lower: f64,
    upper: f64,
    cells: usize,
}

/// Cells along each axis, by the number of axes.
const CELLS: [usize; 3] = [1024, 256, 32];

/// Pieces of a motion that are looked at one by one when all of it at once is not proven.
const PIECES: usize = 8;

impl LaneRobot {
    /// The same robot with a table for each pair of neighbouring links of where they stay apart. It takes some tens of milliseconds, and
    /// motions are then proven in up to half of the time. `parts` belong to the links and `dofs` are those of the robot.
    pub fn with_tables(
        mut self,
        kinematics: &Kinematics,
        dofs: &[DofIdx],
        parts: &TypedVec<LinkIdx, Arc<ConvexParts>>,
    ) -> Self {
        let limits = kinematics.model().dofs();
        let ranges: Vec<(f64, f64)> = dofs.iter().map(|&dof| limits[dof].sampling_range()).collect();
        for i in 0..self.pairs.len() {
            self.pairs[i].apart = Apart::of(&self, &self.pairs[i], parts, &ranges).map(Arc::new);
        }
        self
    }
}

impl Apart {
    /// The table of a pair; `None` when more than three degrees of freedom are between the two, or nothing is proven.
    /// `ranges` are the bounds of the degrees of freedom.
    pub(super) fn of(
        robot: &LaneRobot,
        pair: &Pair,
        parts: &TypedVec<LinkIdx, Arc<ConvexParts>>,
        ranges: &[(f64, f64)],
    ) -> Option<Self> {
        let mut columns: Vec<usize> =
            pair.closing.iter().map(|&(step, _)| robot.steps[step].column).collect();
        columns.sort_unstable();
        columns.dedup();
        let cells = *CELLS.get(columns.len().checked_sub(1)?)?;
        let axis = |&column: &usize| Axis { column, lower: ranges[column].0, upper: ranges[column].1, cells };
        let axes: Vec<Axis> = columns.iter().map(axis).collect();
        let link = |body: usize| robot.bodies[body].link.map(|link| &*parts[link]);
        let speed = |axis: &Axis| -> f64 {
            let by = pair.closing.iter().filter(|(step, _)| robot.steps[*step].column == axis.column);
            by.map(|&(step, distance)| robot.steps[step].factor.abs() * distance).sum()
        };
        let mut search = Search {
            robot,
            pair,
            parts: [link(pair.a)?, link(pair.b)?],
            speeds: axes.iter().map(speed).collect(),
            open: vec![true; cells.pow(axes.len() as u32)],
            axes: &axes,
            values: vec![0.0; ranges.len()],
            frames: Vec::new(),
        };
        search.settle(&vec![(0, cells); axes.len()]);
        let open = search.open;
        let open_below = sums(&open, cells, axes.len());
        open.contains(&false).then_some(Self { axes, open_below })
    }

    /// The same table where so many other coordinates come first.
    pub(super) fn behind(&self, others: usize) -> Self {
        let mut table = self.clone();
        table.axes.iter_mut().for_each(|axis| axis.column += others);
        table
    }

    /// Whether cells are so small that what is open is all but touching.
    pub(super) fn is_fine(&self) -> bool {
        self.axes.len() < CELLS.len()
    }

    /// Whether the two stay apart all along the motion by `difference` from `from`. "Yes" is certain.
    pub(super) fn holds(&self, from: &[f64], difference: &[f64]) -> bool {
        self.holds_within(from, difference, 0.0, 1.0)
            || (0..PIECES).all(|i| {
                let share = 1.0 / PIECES as f64;
                self.holds_within(from, difference, i as f64 * share, (i + 1) as f64 * share)
            })
    }

    /// Whether the two are apart in a state. "Yes" is certain.
    pub(super) fn holds_at(&self, state: &[f64]) -> bool {
        // Nothing is moved, so that any difference will do.
        self.holds_within(state, state, 0.0, 0.0)
    }

    /// Whether the two stay apart within a stretch of the motion, from one fraction of it to another. "Yes" is certain.
    pub(super) fn holds_within(&self, from: &[f64], difference: &[f64], start: f64, end: f64) -> bool {
        let mut corners = [(0, 0); CELLS.len()];
        for (corner, axis) in corners.iter_mut().zip(&self.axes) {
            let at = |t: f64| from[axis.column] + t * difference[axis.column];
            let (low, high) = (at(start).min(at(end)), at(start).max(at(end)));
            // What is out of the table by more than rounding is not known.
            if low < axis.lower - ROUNDING || high > axis.upper + ROUNDING {
                return false;
            }
            let cell = |x: f64| (x - axis.lower) / (axis.upper - axis.lower) * axis.cells as f64;
            let first = (cell(low - ROUNDING).max(0.0) as usize).min(axis.cells - 1);
            let last = (cell(high + ROUNDING).max(0.0) as usize).min(axis.cells - 1);
            *corner = (first, last + 1);
        }
        // Inclusion and exclusion over the corners of the box of cells.
        let mut open = 0_i64;
        for choice in 0..1_usize << self.axes.len() {
            let (mut index, mut sign) = (0, 1);
            for (i, axis) in self.axes.iter().enumerate() {
                let upper = choice >> i & 1 == 1;
                index = index * (axis.cells + 1) + if upper { corners[i].1 } else { corners[i].0 };
                sign *= if upper { 1 } else { -1 };
            }
            open += sign * i64::from(self.open_below[index]);
        }
        open == 0
    }
}

/// Joint values this close to the border of a cell count as on both sides.
const ROUNDING: f64 = 1e-9;

struct Search<'a> {
    robot: &'a LaneRobot,
    pair: &'a Pair,
    parts: [&'a ConvexParts; 2],
    axes: &'a [Axis],
    /// For each axis, how fast it brings the two together at most.
    speeds: Vec<f64>,
    open: Vec<bool>,
    values: Vec<f64>,
    frames: Vec<Pose>,
}

impl Search<'_> {
    /// Marks the cells of a box: first to last of each axis, the last one left out.
    fn settle(&mut self, cells: &[(usize, usize)]) {
        let mut travel = 0.0;
        for ((axis, speed), &(first, end)) in self.axes.iter().zip(&self.speeds).zip(cells) {
            let width = (axis.upper - axis.lower) / axis.cells as f64;
            self.values[axis.column] = axis.lower + width * 0.5 * (first + end) as f64;
            travel += speed * 0.5 * width * (end - first) as f64;
        }
        self.robot.poses(&self.values, &mut self.frames);
        let pose = |body: usize| {
            let body = &self.robot.bodies[body];
            self.frames[body.frame] * body.frame_from_body
        };
        let (root_from_a, root_from_b) = (pose(self.pair.a), pose(self.pair.b));
        let [a, b] = self.parts;
        let near = |far: f64| any_within(a, &root_from_a, b, &root_from_b, far);
        if !near(travel * (1.0 + 1e-6) + 1e-6) {
            self.mark(cells, 0, 0);
            return;
        }
        // The widest side is halved, unless all are single cells.
        let mut widest: Option<(usize, f64)> = None;
        for (i, &(first, end)) in cells.iter().enumerate() {
            let width = self.speeds[i] * (end - first) as f64 / self.axes[i].cells as f64
                * (self.axes[i].upper - self.axes[i].lower);
            if end - first > 1 && widest.is_none_or(|(_, w)| width > w) {
                widest = Some((i, width));
            }
        }
        if let Some((axis, _)) = widest {
            let (first, end) = cells[axis];
            let middle = first + (end - first) / 2;
            for half in [(first, middle), (middle, end)] {
                let mut cells = cells.to_vec();
                cells[axis] = half;
                self.settle(&cells);
            }
        }
    }

    /// Marks the cells of a box as apart.
    fn mark(&mut self, cells: &[(usize, usize)], axis: usize, index: usize) {
        if axis == cells.len() {
            self.open[index] = false;
            return;
        }
        for cell in cells[axis].0..cells[axis].1 {
            self.mark(cells, axis + 1, index * self.axes[axis].cells + cell);
        }
    }
}

/// Number of open cells below each corner.
fn sums(open: &[bool], cells: usize, axes: usize) -> Vec<u32> {
    let side = cells + 1;
    let mut below = vec![0_u32; side.pow(axes as u32)];
    for (index, _) in open.iter().enumerate().filter(|(_, open)| **open) {
        let (mut rest, mut corner, mut scale) = (index, 0, 1);
        for _ in 0..axes {
            corner += (rest % cells + 1) * scale;
            rest /= cells;
            scale *= side;
        }
        below[corner] = 1;
    }
    let mut stride = 1;
    for _ in 0..axes {
        for corner in 0..below.len() {
            if corner / stride % side > 0 {
                below[corner] += below[corner - stride];
            }
        }
        stride *= side;
    }
    below
}
