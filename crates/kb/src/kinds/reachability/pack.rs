//! The stored form of a reachability map.

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use robotc_core::Pose;
use serde::{Deserialize, Serialize};

use super::azimuth::Sectors;
use super::grid::Grid;
use super::map::{Cell, FULL, ReachabilityMap};
use crate::codec;
use crate::kind::DecodeError;

/// Most cells that a map may have: what a decoder may be made to allocate.
const MOST_CELLS: usize = 1 << 26;

/// Cells are stored as runs of equal ones. A cell is its position in `kinds`, which are sorted; `runs` holds, in turns, such
/// a position and a length.
#[derive(Serialize, Deserialize)]
struct Stored {
    position: [f64; 3],
    rotation: [f64; 4],
    step: f64,
    radial: u32,
    level: u32,
    symmetric: bool,
    probes: u8,
    kinds: Vec<(u32, u32, u8)>,
    runs: Vec<u32>,
    /// Of all cells that are reached in part and not as a whole; none for an arm without free joints.
    witnesses: Vec<u8>,
}

/// Whether a cell is reached, and not as a whole at all azimuths.
fn in_part(whole: Sectors, part: Sectors) -> bool {
    !part.is_empty() && whole != Sectors::ALL
}

/// The bytes of a map.
pub(super) fn encode(map: &ReachabilityMap) -> Vec<u8> {
    let plain = |cell: Cell| (cell.whole.0, cell.part.0, cell.density);
    let mut uses: std::collections::BTreeMap<(u32, u32, u8), u64> = std::collections::BTreeMap::new();
    let mut runs: Vec<((u32, u32, u8), u32)> = Vec::new();
    for cell in map.cells().map(plain) {
        match runs.last_mut() {
            Some((last, length)) if *last == cell && *length < u32::MAX => *length += 1,
            _ => {
                runs.push((cell, 1));
                *uses.entry(cell).or_default() += 1;
            }
        }
    }
    // Frequent kinds first, so that they have short numbers; kinds in order where they are equally frequent.
    let mut kinds: Vec<((u32, u32, u8), u64)> = uses.into_iter().collect();
    kinds.sort_by_key(|&(kind, count)| (std::cmp::Reverse(count), kind));
    let numbers: std::collections::BTreeMap<_, u32> =
        kinds.iter().enumerate().map(|(i, &(kind, _))| (kind, i as u32)).collect();
    let witnesses: Vec<u8> =
        map.cells().filter(|cell| in_part(cell.whole, cell.part)).map(|cell| cell.witness).collect();
    let pose = map.grid.base_from_axis;
    codec::encode(&Stored {
        position: pose.translation.vector.into(),
        rotation: pose.rotation.coords.into(),
        step: map.grid.step,
        radial: map.grid.radial as u32,
        level: map.grid.level,
        symmetric: map.grid.symmetric,
        probes: map.probes,
        kinds: kinds.into_iter().map(|(kind, _)| kind).collect(),
        runs: runs.into_iter().flat_map(|(kind, length)| [numbers[&kind], length]).collect(),
        witnesses: if witnesses.iter().any(|w| *w != 0) { witnesses } else { Vec::new() },
    })
}

/// The map of these bytes.
pub(super) fn decode(bytes: &[u8]) -> Result<ReachabilityMap, DecodeError> {
    let s: Stored = codec::decode(bytes)?;
    if !s.position.iter().chain(&s.rotation).chain([&s.step]).all(|x| x.is_finite()) || s.step <= 0.0 {
        return Err(DecodeError::new("a number is not finite"));
    }
    let rotation = UnitQuaternion::new_unchecked(Quaternion::from(s.rotation));
    if (rotation.norm() - 1.0).abs() > 1e-9 {
        return Err(DecodeError::new("a rotation is not of unit length"));
    }
    if s.level >= robotc_core::so3::LEVELS || s.radial == 0 || s.radial > 1 << 12 {
        return Err(DecodeError::new("the grid is too large"));
    }
    let base_from_axis = Pose::from_parts(Translation3::from(s.position), rotation);
    let (radial, level, symmetric) = (s.radial as usize, s.level, s.symmetric);
    let grid = Grid { base_from_axis, step: s.step, radial, level, symmetric };
    let (runs, rest) = s.runs.as_chunks::<2>();
    let total = runs.iter().map(|run| u64::from(run[1])).sum::<u64>();
    if grid.len() > MOST_CELLS || total != grid.len() as u64 || !rest.is_empty() {
        return Err(DecodeError::new("there are not as many cells as the grid has"));
    }
    let cell = |&(whole, part, density): &(u32, u32, u8)| {
        let cell = Cell { whole: Sectors(whole), part: Sectors(part), density, witness: 0 };
        let consistent = cell.part.contains(cell.whole) && density <= FULL;
        (consistent && (!cell.part.is_empty() || density == 0)).then_some(cell)
    };
    let kinds: Option<Vec<Cell>> = s.kinds.iter().map(cell).collect();
    let kinds = kinds.ok_or_else(|| DecodeError::new("a cell contradicts itself"))?;
    if runs.iter().any(|run| run[0] as usize >= kinds.len()) {
        return Err(DecodeError::new("a cell is of no kind"));
    }
    let in_parts = |run: &&[u32; 2]| in_part(kinds[run[0] as usize].whole, kinds[run[0] as usize].part);
    let witnessed: usize = runs.iter().filter(in_parts).map(|run| run[1] as usize).sum();
    if !s.witnesses.is_empty() && s.witnesses.len() != witnessed {
        return Err(DecodeError::new("there are not as many witnesses as cells in part"));
    }
    let mut witnesses = s.witnesses.into_iter();
    let cells = runs.iter().flat_map(|run| std::iter::repeat_n(kinds[run[0] as usize], run[1] as usize));
    let cells = cells.map(|cell| match in_part(cell.whole, cell.part) {
        true => Cell { witness: witnesses.next().unwrap_or(0), ..cell },
        false => cell,
    });
    ReachabilityMap::new(grid, s.probes, cells).ok_or_else(|| DecodeError::new("tables do not fit together"))
}
