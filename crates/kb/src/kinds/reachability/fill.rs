//! Fills a reachability map.
//!
//! 1. Forward kinematics of random configurations finds parts of cells that the arm reaches, also beside their centres.
//! 2. Exact inverse kinematics is asked at the centre of every cell, for all values of the free joints; and, in cells of
//!    which something is reached, at more probes until one is not.
//!
//! The second step is long and is kept in pieces. The first is short; every process that takes part does it by itself.

use nalgebra::Point3;
use robotc_core::Pose;
use robotc_ikgen::run::Batch;

use super::arm::{ArmAlone, Scratch};
use super::azimuth::Sectors;
use super::freedom::{FreeValues, byte_of};
use super::grid::Grid;
use super::map::{Cell, FULL, ReachabilityMap};
use super::probes::Probes;
use super::sweep::{self, Part};
use super::turning::{Azimuths, Turning};
use crate::kind::{BuildError, Context};
use crate::kinds::ReachSphere;

/// How hard to look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Effort {
    /// Values tried for each free joint, evenly over its range.
    pub(super) free_samples: usize,
    /// Poses of a cell that have to be reached before all of it counts as reached.
    pub(super) probes: usize,
    /// Random configurations.
    pub(super) configurations: usize,
}

/// Looks at all cells.
pub(super) fn fill(
    arm: &ArmAlone,
    sphere: &ReachSphere,
    grid: Grid,
    effort: &Effort,
    context: &Context<'_>,
) -> Result<ReachabilityMap, BuildError> {
    let rotations = grid.rotations();
    let probes = Probes::new(&rotations, effort.probes);
    let turning = Turning::new(arm);
    let parts = sweep::parts(arm, &turning, &grid, effort.configurations, context)?;
    let ranges = arm.ranges_about(grid.symmetric.then_some(0.0));
    let free = FreeValues::evenly(&ranges, effort.free_samples);
    let look = Look { arm, turning, grid: &grid, probes: &probes, ranges: &ranges, free: &free };
    let places: Vec<usize> = (0..grid.places()).collect();
    let count = rotations.len();
    let cells = context.map_in_pieces("places", &places, |_, &place| {
        look.place(place, sphere, &parts[place * count..(place + 1) * count])
    })?;
    let made = ReachabilityMap::new(grid.clone(), effort.probes as u8, cells.into_iter().flatten());
    Ok(made.expect("every place has a cell for each rotation"))
}

struct Look<'a> {
    arm: &'a ArmAlone,
    turning: Turning<'a>,
    grid: &'a Grid,
    probes: &'a Probes,
    ranges: &'a [(f64, f64)],
    free: &'a FreeValues,
}

/// A cell that is being looked at.
struct Open {
    rotation: usize,
    cell: Cell,
    /// Rows of the free values, those first with which more of the centre is reached.
    order: Vec<u16>,
}

/// A probe of a cell that is being looked at.
struct Asked {
    /// Position among the open cells.
    open: usize,
    pose: Pose,
    found: Azimuths,
}

/// Rotations of a place whose centres are looked at together.
const CHUNK: usize = 64;

impl Look<'_> {
    /// The cells of a place, of which these parts are known to be reached.
    fn place(&self, place: usize, sphere: &ReachSphere, parts: &[Part]) -> Vec<Cell> {
        let mut scratch = Scratch::default();
        let mut batch = Batch::default();
        let mut cells: Vec<Cell> = parts
            .iter()
            .map(|part| Cell { part: part.azimuths, witness: part.witness, ..Cell::default() })
            .collect();
        let mut open = Vec::new();
        for first in (0..cells.len()).step_by(CHUNK) {
            let rotations = first..(first + CHUNK).min(cells.len());
            self.centres(place, rotations, sphere, &mut cells, &mut open, (&mut batch, &mut scratch));
        }
        for probe in 1..self.probes.shares.len() {
            // Nothing more is learned of cells that are known to be reached somewhere at all azimuths, and nowhere as a whole.
            open.retain(|open| {
                let cell = &open.cell;
                let nowhere_whole = cell.whole.is_empty() && cell.part == Sectors::ALL;
                !cell.part.is_empty() && !nowhere_whole
            });
            self.probe(place, probe, &mut open, (&mut batch, &mut scratch));
            for open in &open {
                cells[open.rotation] = open.cell;
            }
        }
        // Between probes the azimuths of a cell's poses vary a little.
        cells.iter_mut().for_each(|cell| cell.part = cell.part.widened());
        cells
    }

    /// Looks at the centres of some cells with all values of the free joints.
    fn centres(
        &self,
        place: usize,
        rotations: std::ops::Range<usize>,
        sphere: &ReachSphere,
        cells: &mut [Cell],
        open: &mut Vec<Open>,
        (batch, scratch): (&mut Batch, &mut Scratch),
    ) {
        let rows = self.free.len();
        let centre = |rotation: usize| {
            self.grid.pose(place, self.probes.shares[0], &self.probes.rotations[rotation][0])
        };
        let position = Point3::from(centre(rotations.start).translation.vector);
        let within = (position - sphere.centre_in_base).norm() <= sphere.radius + 1e-9;
        let poses: Vec<Pose> = rotations.clone().map(centre).collect();
        if within && self.grid.symmetric {
            let repeated: Vec<Pose> =
                poses.iter().flat_map(|pose| std::iter::repeat_n(*pose, rows)).collect();
            let values: Vec<f64> =
                poses.iter().flat_map(|_| (0..rows).flat_map(|row| self.free.row(row))).copied().collect();
            self.arm.solver.solve_batch_once(&repeated, &values, batch);
        }
        let mut gains = vec![0; rows];
        for (i, rotation) in rotations.enumerate() {
            let cell = &mut cells[rotation];
            let mut found = Azimuths::default();
            let mut count = 0;
            match within {
                false => {}
                true if self.grid.symmetric => {
                    for (row, gain) in gains.iter_mut().enumerate() {
                        let before = found.whole.count();
                        let solutions = batch.solutions(i * rows + row);
                        let reached = self.turning.add(solutions, Sectors::ALL, true, &mut found, scratch);
                        count += usize::from(reached);
                        *gain = 2 * (found.whole.count() - before) + u32::from(reached);
                    }
                }
                true => {
                    found = self.sector_by_sector(&poses[i], scratch);
                    count = if found.whole.is_empty() { 0 } else { rows };
                }
            }
            cell.density = (usize::from(FULL) * count).div_ceil(rows) as u8;
            cell.whole = found.whole;
            cell.part = cell.part.or(found.part);
            let mut order: Vec<u16> = (0..rows as u16).collect();
            order.sort_by_key(|row| std::cmp::Reverse(gains[usize::from(*row)]));
            if count > 0 && self.grid.symmetric {
                cell.witness = byte_of(self.free.row(usize::from(order[0])), self.ranges);
            }
            gains.fill(0);
            open.push(Open { rotation, cell: *cell, order });
        }
    }

    /// Looks at one probe of each open cell, with one row of the free values after the other until enough is known.
    fn probe(
        &self,
        place: usize,
        probe: usize,
        open: &mut [Open],
        (batch, scratch): (&mut Batch, &mut Scratch),
    ) {
        let share = self.probes.shares[probe];
        let pose = |open: &Open| self.grid.pose(place, share, &self.probes.rotations[open.rotation][probe]);
        let mut asked: Vec<Asked> = open
            .iter()
            .enumerate()
            .map(|(i, o)| {
                let found = Azimuths { whole: Sectors::NONE, part: o.cell.part };
                Asked { open: i, pose: pose(o), found }
            })
            .collect();
        if !self.grid.symmetric {
            for asked in &mut asked {
                asked.found = self.sector_by_sector(&asked.pose, scratch);
            }
        }
        let rows = if self.grid.symmetric { self.free.len() } else { 0 };
        let mut live: Vec<usize> = (0..asked.len()).collect();
        for turn in 0..rows {
            let row = |i: &usize| usize::from(open[asked[*i].open].order[turn]);
            let poses: Vec<Pose> = live.iter().map(|&i| asked[i].pose).collect();
            let values: Vec<f64> = live.iter().flat_map(|i| self.free.row(row(i))).copied().collect();
            self.arm.solver.solve_batch_once(&poses, &values, batch);
            for (solved, &i) in live.iter().enumerate() {
                let Asked { open: o, found, .. } = &mut asked[i];
                self.turning.add(batch.solutions(solved), open[*o].cell.whole, false, found, scratch);
            }
            // Of a cell that is reached as a whole somewhere, the parts beside that are not worth more solving.
            live.retain(|&i| {
                let whole = open[asked[i].open].cell.whole;
                whole.is_empty() || !asked[i].found.whole.contains(whole)
            });
        }
        for Asked { open: o, found, .. } in asked {
            let cell = &mut open[o].cell;
            cell.whole = cell.whole.and(found.whole);
            cell.part = cell.part.or(found.part);
        }
    }

    /// Without symmetry every sector is looked at by itself, at its centre.
    fn sector_by_sector(&self, base_from_tip: &Pose, scratch: &mut Scratch) -> Azimuths {
        let mut found = Azimuths::default();
        for (sector, azimuth) in Sectors::ALL.centres() {
            let pose = self.grid.turned(base_from_tip, azimuth);
            if self.arm.reach_with(&pose, self.free, scratch).is_some() {
                found.whole = found.whole.or(sector);
            }
        }
        found.part = found.whole;
        found
    }
}
