//! Where cells of a reachability map are looked at.

use nalgebra::UnitQuaternion;
use robotc_core::Seed;
use robotc_core::rng::Rng;
use robotc_core::so3::RotationGrid;

/// Where a cell is looked at: at its centre first, then at points spread over it.
#[derive(Debug, Clone)]
pub(super) struct Probes {
    /// Shares of a place, as `Grid::pose` takes them.
    pub(super) shares: Vec<(f64, f64)>,
    /// For each rotation cell, as many rotations that fall in it, uniformly distributed.
    pub(super) rotations: Vec<Vec<UnitQuaternion<f64>>>,
}

impl Probes {
    /// `count` points for each cell; the same for all cells but for the rotation.
    pub(super) fn new(grid: &RotationGrid, count: usize) -> Self {
        // The R2 sequence: the golden ratio's two-dimensional relative.
        const A: f64 = 0.754_877_666_246_692_8;
        const B: f64 = 0.569_840_290_998_053_3;
        let share = |k: usize| ((0.5 + A * k as f64).fract(), (0.5 + B * k as f64).fract());
        let mut rotations: Vec<Vec<_>> = (0..grid.len()).map(|cell| vec![grid.rotation(cell)]).collect();
        let mut short = if count > 1 { rotations.len() } else { 0 };
        let mut rng: Rng = Seed::new(0).split("reachability probes").rng();
        while short > 0 {
            let rotation = rng.rotation();
            let cell = &mut rotations[grid.cell(&rotation)];
            if cell.len() < count {
                cell.push(rotation);
                short -= usize::from(cell.len() == count);
            }
        }
        Self { shares: (0..count).map(share).collect(), rotations }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Translation3;
    use robotc_core::Pose;

    use super::super::grid::Grid;
    use super::*;

    fn grid() -> Grid {
        let turn = UnitQuaternion::from_euler_angles(0.3, 0.2, 0.1);
        let base_from_axis = Pose::from_parts(Translation3::new(0.1, 0.2, 0.3), turn);
        Grid { base_from_axis, step: 0.1, radial: 5, level: 0, symmetric: true }
    }

    #[test]
    fn every_probe_is_seen_in_its_cell_at_any_azimuth() {
        let grid = grid();
        let rotations = grid.rotations();
        let probes = Probes::new(&rotations, 4);
        for cell in (0..grid.len()).step_by(7) {
            let (place, rotation) = (cell / rotations.len(), cell % rotations.len());
            for (share, turn) in probes.shares.iter().zip(&probes.rotations[rotation]) {
                let pose = grid.pose(place, *share, turn);
                for azimuth in [0.0, 1.0, 2.0, 3.1, -1.5, -3.1] {
                    let seen = grid.see(&grid.turned(&pose, azimuth)).expect("inside");
                    assert_eq!(seen.cell, cell);
                    let found = libm::atan2(seen.towards.1, seen.towards.0);
                    assert!((found - azimuth).abs() < 1e-9, "{found} {azimuth}");
                }
            }
            let centre = grid.pose(place, probes.shares[0], &probes.rotations[rotation][0]);
            assert_eq!(centre, grid.centre(cell));
        }
    }
}
