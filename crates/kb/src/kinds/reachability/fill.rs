//! Fills a reachability map.
//!
//! 1. Forward kinematics of random configurations finds parts of cells that the arm reaches, also beside their centres.
//! 2. Exact inverse kinematics is asked at the centre of every cell, for all values of the free joints; and, in cells of
//!    which something is reached, at more probes until one is not.
//!
//! The second step is long and is kept in pieces. The first is short; every process that takes part does it by itself.

use nalgebra::{Point3, UnitQuaternion};
use robotc_core::Seed;

use super::arm::{ArmAlone, Scratch};
use super::azimuth::Sectors;
use super::grid::Grid;
use super::map::{Cell, FULL, ReachabilityMap};
use super::probes::Probes;
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

/// Random configurations of one task, and tasks of one round. Rounds know what the rounds before found, so that most
/// configurations of the later ones need no collision test.
const CHUNK: usize = 1 << 13;
const ROUND: usize = 32;

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
    let free = match grid.symmetric {
        true => turning.free_values(effort.free_samples, 0.0),
        false => arm.free_values(effort.free_samples),
    };
    let look = Look { arm, turning, grid: &grid, probes: &probes, free: &free };
    let places: Vec<usize> = (0..grid.places()).collect();

    let mut parts = vec![Sectors::NONE; grid.len()];
    let chunks: Vec<usize> = (0..effort.configurations.div_ceil(CHUNK)).collect();
    let seed = context.seed().split("configurations");
    for round in chunks.chunks(ROUND) {
        let hits = context.map(round, |_, &chunk| {
            let count = CHUNK.min(effort.configurations - chunk * CHUNK);
            look.configurations(seed.at(chunk as u64), count, &parts)
        })?;
        for (cell, azimuths) in hits.into_iter().flatten() {
            parts[cell] = parts[cell].or(azimuths);
        }
    }

    let count = grid.rotations().len();
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
    free: &'a [Vec<f64>],
}

impl Look<'_> {
    /// The cells of a place, of which these parts are known to be reached.
    fn place(&self, place: usize, sphere: &ReachSphere, parts: &[Sectors]) -> Vec<Cell> {
        let mut scratch = Scratch::default();
        let cells = parts.iter().zip(&self.probes.rotations);
        cells.map(|(&part, rotations)| self.cell(place, rotations, sphere, part, &mut scratch)).collect()
    }

    fn cell(
        &self,
        place: usize,
        rotations: &[UnitQuaternion<f64>],
        sphere: &ReachSphere,
        part: Sectors,
        scratch: &mut Scratch,
    ) -> Cell {
        let centre = self.grid.pose(place, self.probes.shares[0], &rotations[0]);
        let away = (Point3::from(centre.translation.vector) - sphere.centre_in_base).norm();
        let found = match away <= sphere.radius + 1e-9 {
            true => self.azimuths(&centre, true, scratch),
            false => Azimuths::default(),
        };
        let density = (usize::from(FULL) * found.count).div_ceil(self.free.len()) as u8;
        let mut cell = Cell { whole: found.whole, part: found.part.or(part), density };
        for (share, rotation) in self.probes.shares.iter().zip(rotations).skip(1) {
            if cell.part.is_empty() || (cell.whole.is_empty() && cell.part == Sectors::ALL) {
                break;
            }
            let found = self.azimuths(&self.grid.pose(place, *share, rotation), false, scratch);
            cell.whole = cell.whole.and(found.whole);
            cell.part = cell.part.or(found.part);
        }
        // Between probes the azimuths of a cell's poses vary a little.
        cell.part = cell.part.widened();
        cell
    }

    /// Cells in which the tip is at random configurations, with the azimuths; only what adds to `known`.
    fn configurations(&self, seed: Seed, count: usize, known: &[Sectors]) -> Vec<(usize, Sectors)> {
        let chain = self.arm.chain();
        let mut scratch = Scratch::default();
        let mut rng = seed.rng();
        let mut found = Vec::new();
        let range = |v: &robotc_core::model::ChainVariable| match (v.lower.is_finite(), v.upper.is_finite()) {
            (true, true) => (v.lower, v.upper),
            _ => (-std::f64::consts::PI, std::f64::consts::PI),
        };
        let mut joints = vec![0.0; chain.variables.len()];
        for _ in 0..count {
            for (joint, variable) in joints.iter_mut().zip(&chain.variables) {
                let (low, high) = range(variable);
                *joint = rng.range(low, high);
            }
            let Some(seen) = self.grid.see(&chain.forward(&joints)) else { continue };
            let part = known[seen.cell];
            if self.grid.symmetric {
                joints[0] -= libm::atan2(seen.towards.1, seen.towards.0);
                let (_, turns) = self.turning.turns(joints[0]);
                if !part.contains(turns) {
                    found.push((seen.cell, self.turning.azimuths_of(&joints, &mut scratch)));
                }
            } else if !part.contains(seen.sector()) && !self.arm.collides(&joints, &mut scratch) {
                found.push((seen.cell, seen.sector()));
            }
        }
        found
    }

    fn azimuths(&self, base_from_tip: &robotc_core::Pose, count: bool, scratch: &mut Scratch) -> Azimuths {
        if self.grid.symmetric {
            return self.turning.azimuths(base_from_tip, self.free, count, scratch);
        }
        // Without symmetry every sector is looked at by itself, at its centre.
        let mut found = Azimuths::default();
        for (sector, azimuth) in Sectors::ALL.centres() {
            let pose = self.grid.turned(base_from_tip, azimuth);
            if self.arm.reach_with(&pose, self.free, scratch).is_some() {
                found.whole = found.whole.or(sector);
                found.count = self.free.len();
            }
        }
        found.part = found.whole;
        found
    }
}
