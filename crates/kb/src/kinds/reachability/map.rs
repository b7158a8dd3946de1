//! The reachability map of an arm: for cells of tip poses, how much of the arm's freedom reaches their centre.
//!
//! An arm whose first joint turns sees the world alike in all directions about that axis, so cells are (distance from
//! the axis, height along it, rotation seen from the azimuth): 72 times fewer than in the full space (thesis section
//! 4.3 and algorithm 4.3 for the sampling; `core::so3` for the rotations).

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_core::model::{ChainMotion, SerialChain};
use robotc_core::so3::RotationGrid;
use robotc_planning::Reachability;

/// Where the cells lie.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// `base_from_axis`: z along the first joint's axis, origin in its joint frame.
    pub base_from_axis: Pose,
    /// Edge of a cell, metres.
    pub step: f64,
    /// Number of cells outwards from the axis.
    pub radial: usize,
    /// Number of cells along the axis.
    pub vertical: usize,
    /// Height of the lowest cell's lower side, metres along the axis.
    pub lowest: f64,
    /// Level of the rotation grid.
    pub level: u32,
}

/// A pose seen from the first axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// The cell.
    pub cell: usize,
    /// Azimuth of the tip about the axis, radians in (-pi, pi].
    pub azimuth: f64,
}

impl Grid {
    /// A grid that holds every pose that `chain` can reach; `None` when the first joint does not turn.
    pub fn of(chain: &SerialChain, step: f64, level: u32) -> Option<Self> {
        let first = chain.joints.first()?;
        if first.motion != ChainMotion::Revolute || first.multiplier != 1.0 {
            return None;
        }
        let align = UnitQuaternion::rotation_between(&Vector3::z_axis(), &first.axis)
            .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
        let base_from_axis = first.previous_from_joint * align;
        let reach = reach(chain) + step;
        let cells = (reach / step).ceil() as usize;
        Some(Self {
            base_from_axis,
            step,
            radial: cells,
            vertical: 2 * cells,
            lowest: -(cells as f64) * step,
            level,
        })
    }

    /// The rotation grid.
    pub fn rotations(&self) -> RotationGrid {
        RotationGrid::new(self.level)
    }

    /// Number of cells. Index = (radial * vertical cells + vertical) * rotations + rotation.
    pub fn len(&self) -> usize {
        self.radial * self.vertical * self.rotations().len()
    }

    /// A grid always has cells.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// `base_from_tip` at the centre of a cell, at azimuth zero.
    pub fn centre(&self, cell: usize) -> Pose {
        let rotations = self.rotations();
        let (place, rotation) = (cell / rotations.len(), cell % rotations.len());
        let r = ((place / self.vertical) as f64 + 0.5) * self.step;
        let z = self.lowest + ((place % self.vertical) as f64 + 0.5) * self.step;
        self.base_from_axis * Pose::from_parts(Translation3::new(r, 0.0, z), rotations.rotation(rotation))
    }

    /// The cell of a tip pose, or `None` outside of the grid.
    pub fn see(&self, base_from_tip: &Pose) -> Option<Seen> {
        let axis_from_tip = self.base_from_axis.inverse() * base_from_tip;
        let p = axis_from_tip.translation.vector;
        let azimuth = libm::atan2(p.y, p.x);
        let radial = (libm::hypot(p.x, p.y) / self.step) as usize;
        let vertical = ((p.z - self.lowest) / self.step).floor();
        if radial >= self.radial || vertical < 0.0 || vertical >= self.vertical as f64 {
            return None;
        }
        let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -azimuth) * axis_from_tip.rotation;
        let rotations = self.rotations();
        let place = radial * self.vertical + vertical as usize;
        Some(Seen { cell: place * rotations.len() + rotations.cell(&turned), azimuth })
    }
}

/// A bound on the distance of the tip from the first joint's origin, metres: all link offsets stretched out, and all
/// slides at their far end.
pub(super) fn reach(chain: &SerialChain) -> f64 {
    let offsets = chain.joints.iter().skip(1).map(|j| j.previous_from_joint.translation.vector.norm());
    let slides = chain.joints.iter().filter(|j| j.motion == ChainMotion::Prismatic).map(|j| {
        let v = &chain.variables[j.variable];
        let ends = [v.lower, v.upper].map(|x| (j.multiplier * x + j.offset).abs());
        ends[0].max(ends[1])
    });
    offsets.chain(slides).sum::<f64>() + chain.last_from_tip.translation.vector.norm()
}

/// What is known of the cells.
#[derive(Debug, Clone, PartialEq)]
pub struct ReachabilityMap {
    /// Where they lie.
    pub grid: Grid,
    /// Number of values of the free joints that were tried for each cell (1 without free joints).
    pub tries: u8,
    /// For each cell, the number of tries that reach its centre within limits and without self-collision.
    pub counts: Vec<u8>,
    /// For each cell with a count, ascending: one of the joint vectors found, at azimuth zero; flattened.
    pub witnesses: Vec<f32>,
    /// Number of joint values of a witness.
    pub variables: usize,
    /// Smallest and largest value of the first joint.
    pub first_limits: (f64, f64),
    /// Position of the first witness of each block of [`BLOCK`] cells.
    blocks: Vec<u32>,
}

/// Cells between stored witness positions.
const BLOCK: usize = 64;

impl Reachability for ReachabilityMap {
    /// Share of the tries that reach the centre of the pose's cell. Zero as well when the first joint cannot turn the
    /// witness to the pose's azimuth. A reached centre does not prove the whole cell.
    fn density(&self, base_from_tip: &Pose) -> f64 {
        let Some(seen) = self.grid.see(base_from_tip) else { return 0.0 };
        match self.witness_at(&seen) {
            Some(_) => f64::from(self.counts[seen.cell]) / f64::from(self.tries),
            None => 0.0,
        }
    }
}

impl ReachabilityMap {
    /// A map of these cells; `None` when the lengths do not fit together.
    pub fn new(
        grid: Grid,
        tries: u8,
        counts: Vec<u8>,
        witnesses: Vec<f32>,
        variables: usize,
        first_limits: (f64, f64),
    ) -> Option<Self> {
        let reached = counts.iter().filter(|c| **c > 0).count();
        let fits = counts.len() == grid.len()
            && witnesses.len() == reached.checked_mul(variables)?
            && tries > 0
            && variables > 0
            && counts.iter().all(|&c| c <= tries);
        if !fits {
            return None;
        }
        let mut blocks = Vec::with_capacity(counts.len() / BLOCK + 1);
        let mut before = 0;
        for block in counts.chunks(BLOCK) {
            blocks.push(before);
            before += block.iter().filter(|c| **c > 0).count() as u32;
        }
        Some(Self { grid, tries, counts, witnesses, variables, first_limits, blocks })
    }

    /// The stored joint vector of a pose's cell, its first joint turned to the pose's azimuth; `None` when the cell is
    /// not reached or the turn is outside of the limits. Reaches the centre of the cell, so it is near the pose.
    pub fn witness(&self, base_from_tip: &Pose) -> Option<Vec<f64>> {
        let seen = self.grid.see(base_from_tip)?;
        self.witness_at(&seen)
    }

    fn witness_at(&self, seen: &Seen) -> Option<Vec<f64>> {
        let mut joints = self.cell_witness(seen.cell)?;
        let (low, high) = self.first_limits;
        let turn = std::f64::consts::TAU;
        let value = joints[0] + seen.azimuth;
        joints[0] = [value, value - turn, value + turn].into_iter().find(|v| (low..=high).contains(v))?;
        Some(joints)
    }

    /// The joint vector that reaches the centre of a cell at azimuth zero, its first joint not limited.
    pub fn cell_witness(&self, cell: usize) -> Option<Vec<f64>> {
        if *self.counts.get(cell)? == 0 {
            return None;
        }
        let block = cell / BLOCK;
        let inside = self.counts[block * BLOCK..cell].iter().filter(|c| **c > 0).count();
        let at = (self.blocks[block] as usize + inside) * self.variables;
        Some(self.witnesses[at..at + self.variables].iter().map(|&x| f64::from(x)).collect())
    }

    /// Number of cells with a solution.
    pub fn reached(&self) -> usize {
        self.witnesses.len() / self.variables
    }
}
