//! What is known of the cells of a reachability map, and the questions it answers by itself.

use robotc_core::Pose;
use robotc_planning::Reachability;
use serde::{Deserialize, Serialize};

use super::arm::{ArmAlone, Scratch};
use super::azimuth::{SECTORS, Sectors};
use super::grid::{Grid, Seen};

/// What a map says of a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Not reached: no probe of the cell is, nor any of the random configurations that were tried.
    No,
    /// Reached: every probe of the cell is.
    Yes,
    /// Part of the cell is reached. Exact inverse kinematics tells.
    Mixed,
}

/// What is known of a cell.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cell {
    /// Azimuths at which all probes of the cell are reached.
    pub whole: Sectors,
    /// Azimuths at which some pose of the cell may be reached. Holds `whole`.
    pub part: Sectors,
    /// How much of the arm's freedom reaches the centre: 0 (the centre is not reached) to [`FULL`] (every value of the free
    /// joints that was tried).
    pub density: u8,
    /// Values of the free joints that reach some of a cell that is not reached as a whole: what exact inverse kinematics tries
    /// first. Zero for other cells, and for arms without free joints.
    pub witness: u8,
}

/// Largest [`Cell::density`].
pub const FULL: u8 = 15;

/// The reachability of an arm.
///
/// Most cells are the same at all azimuths, and are told by two bits; those that differ have their azimuths in a table.
#[derive(Debug, Clone, PartialEq)]
pub struct ReachabilityMap {
    /// Where the cells lie.
    pub grid: Grid,
    /// Number of poses of a cell that were looked at before it was called reached as a whole.
    pub probes: u8,
    /// 32 cells a block.
    blocks: Vec<Block>,
    /// For each cell that is not `No`, ascending: [`Cell::density`] and [`Cell::witness`].
    details: Vec<[u8; 2]>,
    /// For each `Varies` cell, ascending: whole and part.
    azimuths: Vec<[Sectors; 2]>,
}

/// 32 cells: what a question reads of them lies together.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Block {
    /// Two bits for each cell.
    word: u64,
    /// How many cells before these are not `No`.
    some_before: u32,
    /// How many cells before these are `Varies`.
    varying_before: u32,
}

/// The two bits of a cell.
const NO: u64 = 0;
const YES: u64 = 1;
const MIXED: u64 = 2;
const VARIES: u64 = 3;

/// The lower bit of every cell of a word.
const LOWER: u64 = 0x5555_5555_5555_5555;

impl ReachabilityMap {
    /// A map of these cells; `None` when their number is not that of the grid.
    pub fn new(grid: Grid, probes: u8, cells: impl Iterator<Item = Cell>) -> Option<Self> {
        let count = grid.len();
        let mut blocks = vec![Block::default(); count.div_ceil(32)];
        let (mut details, mut azimuths) = (Vec::new(), Vec::new());
        let mut i = 0;
        for cell in cells {
            let bits = match (cell.whole, cell.part) {
                (_, Sectors::NONE) => NO,
                (Sectors::ALL, Sectors::ALL) => YES,
                (Sectors::NONE, Sectors::ALL) => MIXED,
                _ => VARIES,
            };
            if i == count {
                return None;
            }
            blocks[i / 32].word |= bits << (2 * (i % 32));
            if bits != NO {
                details.push([cell.density.min(FULL), if bits == YES { 0 } else { cell.witness }]);
            }
            if bits == VARIES {
                azimuths.push([cell.whole.and(cell.part), cell.part]);
            }
            i += 1;
        }
        let (mut some_before, mut varying_before) = (0, 0);
        for block in &mut blocks {
            *block = Block { some_before, varying_before, ..*block };
            some_before += some(block.word).count_ones();
            varying_before += varying(block.word).count_ones();
        }
        (i == count).then_some(Self { grid, probes, blocks, details, azimuths })
    }

    /// What is known of a cell.
    pub fn cell(&self, cell: usize) -> Cell {
        let Block { word, some_before, varying_before } = self.blocks[cell / 32];
        let shift = 2 * (cell % 32);
        let below = (1_u64 << shift) - 1;
        let (whole, part) = match word >> shift & 3 {
            NO => return Cell::default(),
            YES => (Sectors::ALL, Sectors::ALL),
            MIXED => (Sectors::NONE, Sectors::ALL),
            _ => {
                let varies = (varying_before + (varying(word) & below).count_ones()) as usize;
                let [whole, part] = self.azimuths[varies];
                (whole, part)
            }
        };
        let some_before = some_before + (some(word) & below).count_ones();
        let [density, witness] = self.details[some_before as usize];
        Cell { whole, part, density, witness }
    }

    /// All cells, ascending.
    pub fn cells(&self) -> impl ExactSizeIterator<Item = Cell> + '_ {
        (0..self.grid.len()).map(|cell| self.cell(cell))
    }

    /// Whether a tip pose is reached. Nothing is solved and nothing allocated.
    pub fn verdict(&self, base_from_tip: &Pose) -> Verdict {
        self.grid.see(base_from_tip).map_or(Verdict::No, |seen| self.verdict_at(&seen))
    }

    /// As [`verdict`](Self::verdict), of a pose seen from the axis.
    pub fn verdict_at(&self, seen: &Seen) -> Verdict {
        let Block { word, varying_before, .. } = self.blocks[seen.cell / 32];
        let shift = 2 * (seen.cell % 32);
        match word >> shift & 3 {
            NO => Verdict::No,
            YES => Verdict::Yes,
            MIXED => Verdict::Mixed,
            _ => {
                let below = (varying(word) & ((1 << shift) - 1)).count_ones();
                let [whole, part] = self.azimuths[(varying_before + below) as usize];
                let sector = seen.sector();
                if whole.contains(sector) {
                    Verdict::Yes
                } else if part.contains(sector) {
                    Verdict::Mixed
                } else {
                    Verdict::No
                }
            }
        }
    }

    /// A joint vector of the map's arm that reaches a tip pose within limits and without self-collision; `None` when there is
    /// none as far as the map and exact inverse kinematics know.
    ///
    /// Of a redundant arm, of which `samples` evenly spaced values of each free joint are tried, those known for the cell come
    /// first, in place of the farthest, and the others by their distance from them. What the map says no to is not solved for.
    pub fn reach(
        &self,
        arm: &ArmAlone,
        base_from_tip: &Pose,
        samples: usize,
        scratch: &mut Scratch,
    ) -> Option<Vec<f64>> {
        let seen = self.grid.see(base_from_tip)?;
        match self.verdict_at(&seen) {
            Verdict::No => None,
            Verdict::Yes => arm.reach(base_from_tip, samples, scratch),
            Verdict::Mixed => {
                let about = self.grid.symmetric.then(|| libm::atan2(seen.towards.1, seen.towards.0));
                arm.reach_from(base_from_tip, self.cell(seen.cell).witness, about, samples, scratch)
            }
        }
    }

    /// The mean density over all rotations of each place, for each sector of azimuths: 0 (nothing is reached there) to 1.
    /// What is drawn of a map.
    pub fn densities(&self) -> Vec<[f64; SECTORS as usize]> {
        let rotations = self.grid.rotations().len();
        let of_place = |place: usize| {
            let mut sums = [0.0; SECTORS as usize];
            for cell in (0..rotations).map(|rotation| self.cell(place * rotations + rotation)) {
                if cell.part.is_empty() {
                    continue;
                }
                for (sector, sum) in sums.iter_mut().enumerate() {
                    *sum += f64::from(cell.part.0 >> sector & 1) * weight(&cell);
                }
            }
            sums.map(|sum| sum / rotations as f64)
        };
        (0..self.grid.places()).map(of_place).collect()
    }

    /// Number of cells of which something, everything, and a part that depends on the azimuth is reached.
    pub fn counts(&self) -> [usize; 3] {
        let yes = |word: u64| (word & !(word >> 1) & LOWER).count_ones() as usize;
        [self.details.len(), self.blocks.iter().map(|block| yes(block.word)).sum(), self.azimuths.len()]
    }
}

impl Reachability for ReachabilityMap {
    /// How much of the arm's freedom reaches the centre of the pose's cell. A cell that is reached in parts and not at its
    /// centre counts as little as one value of the free joints; a pose that is not reached counts nothing.
    fn density(&self, base_from_tip: &Pose) -> f64 {
        let Some(seen) = self.grid.see(base_from_tip) else { return 0.0 };
        match self.verdict_at(&seen) {
            Verdict::No => 0.0,
            Verdict::Yes | Verdict::Mixed => weight(&self.cell(seen.cell)),
        }
    }
}

/// The weight of a cell of which something is reached: 0 to 1.
pub(super) fn weight(cell: &Cell) -> f64 {
    f64::from(cell.density.max(1)) / f64::from(FULL)
}

/// The lower bits of the cells that are not `No`.
fn some(word: u64) -> u64 {
    (word | word >> 1) & LOWER
}

/// The lower bits of the cells that are `Varies`.
fn varying(word: u64) -> u64 {
    word & word >> 1 & LOWER
}

#[cfg(test)]
mod tests {
    use robotc_core::Seed;

    use super::*;

    #[test]
    fn cells_are_found_again() {
        let grid = Grid { base_from_axis: Pose::identity(), step: 0.1, radial: 3, level: 0, symmetric: true };
        let mut rng = Seed::new(3).rng();
        let mut cells = Vec::new();
        for _ in 0..grid.len() {
            let part = Sectors(rng.bits() as u32);
            let some = (part, part.and(Sectors(rng.bits() as u32)));
            let (part, whole) = [
                (Sectors::NONE, Sectors::NONE),
                (Sectors::ALL, Sectors::ALL),
                (Sectors::ALL, Sectors::NONE),
                some,
            ][rng.below(4)];
            let density = if part.is_empty() { 0 } else { rng.below(16) as u8 };
            let witness = if part.is_empty() || (whole, part) == (Sectors::ALL, Sectors::ALL) {
                0
            } else {
                rng.bits() as u8
            };
            cells.push(Cell { whole, part, density, witness });
        }
        let map =
            ReachabilityMap::new(grid.clone(), 1, cells.iter().copied()).expect("as many as in the grid");
        assert!(map.cells().eq(cells.iter().copied()));
        for (i, cell) in cells.iter().enumerate() {
            for azimuth in [0.1, 2.0, 4.0] {
                let pose = grid.turned(&grid.centre(i), azimuth);
                let sector = Sectors::at(azimuth);
                let expected = match (cell.whole.contains(sector), cell.part.contains(sector)) {
                    (true, _) => Verdict::Yes,
                    (false, true) => Verdict::Mixed,
                    (false, false) => Verdict::No,
                };
                assert_eq!(map.verdict(&pose), expected);
            }
        }
        assert!(ReachabilityMap::new(grid.clone(), 1, cells.iter().copied().skip(1)).is_none());
        assert!(ReachabilityMap::new(grid, 1, cells.iter().chain(&cells[..1]).copied()).is_none());
    }
}
