//! Where the cells of a reachability map lie.
//!
//! An arm whose first joint turns sees the world alike in all directions about that axis, so cells are (distance from
//! the axis, height along it, rotation seen from the azimuth): 72 times fewer than in the full space. Rotations lie on the
//! grid of `core::so3` (thesis, section 4.3).

use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_core::model::{ChainMotion, SerialChain};
use robotc_core::so3::RotationGrid;

use super::azimuth::Sectors;
use crate::kinds::ReachSphere;

/// The cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// `base_from_axis`: z along the first joint's axis, origin in the middle of what the arm reaches.
    pub base_from_axis: Pose,
    /// Edge of a cell, metres.
    pub step: f64,
    /// Number of cells outwards from the axis; twice as many lie along it, half of them below the origin.
    pub radial: usize,
    /// Level of the rotation grid.
    pub level: u32,
    /// Whether the first joint turns about the axis, so that a turn of a pose about it is a turn of that joint.
    pub symmetric: bool,
}

/// A pose seen from the axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// The cell.
    pub cell: usize,
    /// Cosine and sine of the azimuth of the tip about the axis.
    pub towards: (f64, f64),
}

impl Seen {
    /// The sector of the tip's azimuth.
    pub fn sector(&self) -> Sectors {
        Sectors::towards(self.towards.1, self.towards.0)
    }
}

impl Grid {
    /// A grid that holds every tip pose of `chain`, whose positions are in `sphere`. Its axis is that of the first joint
    /// if that turns, and else the z axis of the base.
    pub fn of(chain: &SerialChain, sphere: &ReachSphere, step: f64, level: u32) -> Self {
        let first = &chain.joints[0];
        let alone = chain.joints.iter().skip(1).all(|joint| joint.variable != first.variable);
        let symmetric = first.motion == ChainMotion::Revolute && first.multiplier == 1.0 && alone;
        let rotation = if symmetric {
            let align = UnitQuaternion::rotation_between(&Vector3::z_axis(), &first.axis)
                .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
            first.previous_from_joint.rotation * align
        } else {
            UnitQuaternion::identity()
        };
        // One cell more, so that a tip on the sphere is not lost by rounding.
        let radial = ((sphere.radius + 1e-9) / step).ceil() as usize + 1;
        let base_from_axis = Pose::from_parts(Translation3::from(sphere.centre_in_base.coords), rotation);
        Self { base_from_axis, step, radial, level, symmetric }
    }

    /// The rotation grid.
    pub fn rotations(&self) -> RotationGrid {
        RotationGrid::new(self.level)
    }

    /// Number of places: pairs of distance and height.
    pub fn places(&self) -> usize {
        2 * self.radial * self.radial
    }

    /// Number of cells. Index = place * rotations + rotation; place = radial * vertical cells + vertical.
    pub fn len(&self) -> usize {
        self.places() * self.rotations().len()
    }

    /// A grid always has cells.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Distance from the axis and height along it at which a place begins, metres.
    pub fn corner(&self, place: usize) -> (f64, f64) {
        let vertical = 2 * self.radial;
        let below = self.radial as f64;
        ((place / vertical) as f64 * self.step, ((place % vertical) as f64 - below) * self.step)
    }

    /// `base_from_tip` at the centre of a cell, at azimuth zero.
    pub fn centre(&self, cell: usize) -> Pose {
        let rotations = self.rotations();
        let (place, rotation) = (cell / rotations.len(), cell % rotations.len());
        self.pose(place, (0.5, 0.5), &rotations.rotation(rotation))
    }

    /// `base_from_tip` at azimuth zero, so far into a place as `share` says (each 0 to 1), turned so.
    pub fn pose(&self, place: usize, share: (f64, f64), rotation: &UnitQuaternion<f64>) -> Pose {
        let (r, z) = self.corner(place);
        let translation = Translation3::new(r + share.0 * self.step, 0.0, z + share.1 * self.step);
        self.base_from_axis * Pose::from_parts(translation, *rotation)
    }

    /// The same pose at another azimuth.
    pub fn turned(&self, base_from_tip: &Pose, azimuth: f64) -> Pose {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), azimuth);
        self.base_from_axis * turn * self.base_from_axis.inv_mul(base_from_tip)
    }

    /// The cell of a tip pose, or `None` outside of the grid.
    pub fn see(&self, base_from_tip: &Pose) -> Option<Seen> {
        self.see_from_axis(&self.base_from_axis.inv_mul(base_from_tip))
    }

    /// The cell of `axis_from_tip`, or `None` outside of the grid.
    pub fn see_from_axis(&self, axis_from_tip: &Pose) -> Option<Seen> {
        let p = &axis_from_tip.translation.vector;
        let distance = (p.x * p.x + p.y * p.y).sqrt();
        let place = self.place(distance, p.z)?;
        let towards = if distance > 0.0 { (p.x / distance, p.y / distance) } else { (1.0, 0.0) };
        let turned = turned_back(towards) * axis_from_tip.rotation;
        let rotations = self.rotations();
        Some(Seen { cell: place * rotations.len() + rotations.cell(&turned), towards })
    }

    /// The place at a distance from the axis and a height along it.
    pub fn place(&self, distance: f64, height: f64) -> Option<usize> {
        let cells = 1.0 / self.step;
        // Above zero, the conversion to an integer rounds down.
        let (radial, vertical) = (distance * cells, height * cells + self.radial as f64);
        let inside = radial < self.radial as f64 && vertical >= 0.0 && vertical < 2.0 * self.radial as f64;
        inside.then(|| radial as usize * 2 * self.radial + vertical as usize)
    }
}

/// The turn about z by minus the azimuth with this cosine and sine.
pub(super) fn turned_back((cosine, sine): (f64, f64)) -> UnitQuaternion<f64> {
    // Half of the angle without trigonometry; the larger half is computed, the other follows from it.
    let (half_cos, half_sin) = if cosine >= 0.0 {
        let c = (0.5 * (1.0 + cosine)).sqrt();
        (c, 0.5 * sine / c)
    } else {
        let s = (0.5 * (1.0 - cosine)).sqrt().copysign(sine);
        (0.5 * sine / s, s)
    };
    UnitQuaternion::new_unchecked(Quaternion::new(half_cos, 0.0, 0.0, -half_sin))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_back_undoes_the_azimuth() {
        for k in 0..64 {
            let azimuth = f64::from(k) * 0.1 - 3.2;
            let (sine, cosine) = azimuth.sin_cos();
            let expected = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -azimuth);
            assert!(turned_back((cosine, sine)).angle_to(&expected) < 1e-9);
        }
    }
}
