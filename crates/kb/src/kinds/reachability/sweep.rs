//! Parts of cells that an arm reaches, from random configurations.
//!
//! Where the last joint is one by itself, a configuration is swept over its range: one forward kinematics gives many tip
//! poses, each of which falls into another cell.

use std::f64::consts::{PI, TAU};

use nalgebra::UnitQuaternion;
use robotc_core::ik::InverseKinematics as _;
use robotc_core::model::{ChainMotion, ChainVariable};
use robotc_core::{Pose, Seed};

use super::arm::{ArmAlone, Scratch};
use super::azimuth::Sectors;
use super::freedom::byte_of;
use super::grid::Grid;
use super::turning::Turning;
use crate::kind::{BuildError, Context};

/// What is known of a cell.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Part {
    /// Azimuths at which some pose of it is reached.
    pub(super) azimuths: Sectors,
    /// Values of the free joints that reach it.
    pub(super) witness: u8,
}

/// Random configurations of one task, and tasks of the first round. Rounds know what the rounds before found, so that most
/// configurations of the later ones, which are longer, need no collision test.
const CHUNK: usize = 1 << 13;
const ROUND: usize = 32;

/// Values of the last joint for each draw of the others.
const SWEEP: usize = 8;

/// The parts of the cells of a grid that are found by so many configurations.
pub(super) fn parts(
    arm: &ArmAlone,
    turning: &Turning<'_>,
    grid: &Grid,
    configurations: usize,
    context: &Context<'_>,
) -> Result<Vec<Part>, BuildError> {
    let mut parts = vec![Part::default(); grid.len()];
    let sweep = Sweep::new(arm);
    let seed = context.seed().split("configurations");
    let chunks: Vec<usize> = (0..configurations.div_ceil(CHUNK)).collect();
    let mut done = 0;
    while done < chunks.len() {
        let round = &chunks[done..chunks.len().min(done + done.max(ROUND))];
        let hits = context.map(round, |_, &chunk| {
            let count = CHUNK.min(configurations - chunk * CHUNK);
            let draw = Draw { arm, turning, grid, sweep: &sweep, known: &parts };
            draw.hits(seed.at(chunk as u64), count)
        })?;
        done += round.len();
        for (cell, hit) in hits.into_iter().flatten() {
            let part = &mut parts[cell];
            if part.azimuths.is_empty() {
                part.witness = hit.witness;
            }
            part.azimuths = part.azimuths.or(hit.azimuths);
        }
    }
    Ok(parts)
}

/// How the tip moves with the last joint alone.
struct Sweep {
    /// Difference of the values of the last joint from the first one of a sweep, with `tip_from_moved_tip`.
    steps: Vec<(f64, Pose)>,
}

impl Sweep {
    fn new(arm: &ArmAlone) -> Self {
        let chain = arm.chain();
        let still = Self { steps: vec![(0.0, Pose::identity())] };
        let Some(last) = chain.joints.last() else { return still };
        let others = &chain.joints[..chain.joints.len() - 1];
        if last.variable == 0 || others.iter().any(|joint| joint.variable == last.variable) {
            return still;
        }
        let (low, high) = range(&chain.variables[last.variable]);
        let step = |k: usize| {
            let value = (high - low) * k as f64 / SWEEP as f64;
            let motion = match last.motion {
                ChainMotion::Revolute => {
                    let turn = UnitQuaternion::from_axis_angle(&last.axis, last.multiplier * value);
                    Pose::from_parts(Default::default(), turn)
                }
                ChainMotion::Prismatic => Pose::from_parts(
                    (last.axis.into_inner() * (last.multiplier * value)).into(),
                    Default::default(),
                ),
            };
            (value, chain.last_from_tip.inverse() * motion * chain.last_from_tip)
        };
        Self { steps: (0..SWEEP).map(step).collect() }
    }
}

fn range(variable: &ChainVariable) -> (f64, f64) {
    match variable.lower.is_finite() && variable.upper.is_finite() {
        true => (variable.lower, variable.upper),
        false => (-PI, PI),
    }
}

struct Draw<'a> {
    arm: &'a ArmAlone,
    turning: &'a Turning<'a>,
    grid: &'a Grid,
    sweep: &'a Sweep,
    known: &'a [Part],
}

impl Draw<'_> {
    /// Cells in which the tip is at random configurations, with the azimuths; only what adds to what is known.
    fn hits(&self, seed: Seed, count: usize) -> Vec<(usize, Part)> {
        let chain = self.arm.chain();
        let mut scratch = Scratch::default();
        let mut rng = seed.rng();
        let mut found = Vec::new();
        let ranges: Vec<(f64, f64)> = chain.variables.iter().map(range).collect();
        let swept = chain.joints.last().map_or(0, |joint| joint.variable);
        let mut joints = vec![0.0; chain.variables.len()];
        for _ in 0..count.div_ceil(self.sweep.steps.len()) {
            for (joint, (low, high)) in joints.iter_mut().zip(&ranges) {
                *joint = rng.range(*low, *high);
            }
            // A sweep starts in the first part of the range, so that all of it stays within.
            let low = ranges[swept].0;
            let start = low + (joints[swept] - low) / self.sweep.steps.len() as f64;
            joints[swept] = start;
            let axis_from_tip = self.grid.base_from_axis.inv_mul(&chain.forward(&joints));
            let turned = joints[0];
            for (value, tip_from_moved) in &self.sweep.steps {
                let Some(seen) = self.grid.see_from_axis(&(axis_from_tip * tip_from_moved)) else { continue };
                let known = self.known[seen.cell].azimuths;
                if known == Sectors::ALL {
                    continue;
                }
                joints[0] = turned;
                joints[swept] = start + value;
                if !self.grid.symmetric {
                    let sector = seen.sector();
                    if !known.contains(sector) && !self.arm.collides(&joints, &mut scratch) {
                        found.push((seen.cell, Part { azimuths: sector, witness: self.witness(&joints) }));
                    }
                    continue;
                }
                let azimuth = libm::atan2(seen.towards.1, seen.towards.0);
                joints[0] -= azimuth;
                let (_, turns) = self.turning.turns(joints[0]);
                if !known.contains(turns) {
                    let azimuths = self.turning.azimuths_of(&joints, &mut scratch);
                    found.push((seen.cell, Part { azimuths, witness: self.witness(&joints) }));
                }
            }
        }
        found
    }

    /// The values of the free joints as a byte; a free first joint is seen from the azimuth.
    fn witness(&self, joints: &[f64]) -> u8 {
        let free = self.arm.solver.free_variables();
        let ranges = self.arm.ranges_about(self.grid.symmetric.then_some(0.0));
        let turned = self.grid.symmetric && free.first() == Some(&0);
        let mut values: Vec<f64> = free.iter().map(|&variable| joints[variable]).collect();
        if turned {
            values[0] = (values[0] + PI).rem_euclid(TAU) - PI;
        }
        byte_of(&values, &ranges)
    }
}
