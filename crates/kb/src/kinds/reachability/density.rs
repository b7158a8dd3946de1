//! Kernel density of reachability: how well the poses near a pose are reached (thesis, section 4.3).

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_planning::Reachability as _;

use super::grid::turned_back;
use super::map::{ReachabilityMap, weight};

/// A smooth view of a map.
///
/// The distance of two poses is (dtheta / h_theta)^2 + (dp / h_p)^2 with the angle between their rotations and the distance of
/// their positions; a cell weighs exp of minus that, and cells more than two bandwidths away are left out.
pub struct KernelDensity<'a> {
    map: &'a ReachabilityMap,
    rotations: Vec<UnitQuaternion<f64>>,
    rotation_width: f64,
    /// Offsets of a lattice of the map's step, in its axis frame, with their part of the exponent.
    offsets: Vec<(Vector3<f64>, f64)>,
}

/// How far the kernel sees, in bandwidths.
const CUT_OFF: f64 = 2.0;

impl<'a> KernelDensity<'a> {
    /// With bandwidths in metres and radians, both above zero. The thesis has 0.04 m and 0.25 rad; bandwidths well below the
    /// size of a cell see one cell.
    pub fn new(map: &'a ReachabilityMap, position_width: f64, rotation_width: f64) -> Self {
        let grid = map.grid.rotations();
        let rotations = (0..grid.len()).map(|cell| grid.rotation(cell)).collect();
        let step = map.grid.step;
        let reach = (CUT_OFF * position_width / step).floor() as i32;
        let line = || -reach..=reach;
        let mut offsets = Vec::new();
        for (x, y, z) in line().flat_map(|x| line().flat_map(move |y| line().map(move |z| (x, y, z)))) {
            let offset = Vector3::new(f64::from(x), f64::from(y), f64::from(z)) * step;
            let exponent = offset.norm_squared() / (position_width * position_width);
            if exponent <= CUT_OFF * CUT_OFF {
                offsets.push((offset, exponent));
            }
        }
        Self { map, rotations, rotation_width, offsets }
    }

    /// The mean density of the cells about a tip pose, each with its weight: 0 (nothing near is reached) to 1.
    pub fn at(&self, base_from_tip: &Pose) -> f64 {
        let grid = &self.map.grid;
        let axis_from_tip = grid.base_from_axis.inv_mul(base_from_tip);
        let (mut sum, mut all) = (0.0, 0.0);
        for (offset, from_position) in &self.offsets {
            let p = axis_from_tip.translation.vector + offset;
            let moved = Pose::from_parts(Translation3::from(p), axis_from_tip.rotation);
            let seen = grid.see_from_axis(&moved);
            let distance = (p.x * p.x + p.y * p.y).sqrt();
            let towards = if distance > 0.0 { (p.x / distance, p.y / distance) } else { (1.0, 0.0) };
            let turned = turned_back(towards) * axis_from_tip.rotation;
            for (i, centre) in self.rotations.iter().enumerate() {
                let away = turned.angle_to(centre) / self.rotation_width;
                let exponent = from_position + away * away;
                if exponent > CUT_OFF * CUT_OFF {
                    continue;
                }
                let kernel = libm::exp(-exponent);
                all += kernel;
                // Outside of the grid nothing is reached.
                let Some(seen) = seen else { continue };
                let cell = self.map.cell(seen.cell - seen.cell % self.rotations.len() + i);
                if cell.part.contains(seen.sector()) {
                    sum += kernel * weight(&cell);
                }
            }
        }
        if all > 0.0 { sum / all } else { self.map.density(base_from_tip) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::azimuth::Sectors;
    use super::super::grid::Grid;
    use super::super::map::{Cell, FULL};
    use super::*;

    #[test]
    fn the_density_falls_off_smoothly_at_the_edge_of_what_is_reached() {
        let grid = Grid { base_from_axis: Pose::identity(), step: 0.1, radial: 8, level: 1, symmetric: true };
        let full = Cell { whole: Sectors::ALL, part: Sectors::ALL, density: FULL, witness: 0 };
        let (count, rotations) = (grid.len(), grid.rotations().len());
        let cells = (0..count).map(|cell| match grid.corner(cell / rotations).0 < 0.45 {
            true => full,
            false => Cell::default(),
        });
        let map = ReachabilityMap::new(grid.clone(), 1, cells).expect("all cells");
        let density = KernelDensity::new(&map, 0.1, 0.4);
        let at = |x: f64| density.at(&Pose::translation(x, 0.0, 0.0));
        assert!((at(0.05) - 1.0).abs() < 1e-12);
        assert_eq!(at(0.75), 0.0);
        let line: Vec<f64> = (1..8).map(|k| at(0.05 + 0.1 * f64::from(k))).collect();
        assert!(line.windows(2).all(|pair| pair[0] >= pair[1]), "{line:?}");
        assert!(line[3] > 0.3 && line[3] < 1.0 && line[4] > 0.0 && line[4] < 0.7, "{line:?}");
    }
}
