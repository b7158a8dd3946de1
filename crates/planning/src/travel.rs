//! How far a motion of the joints can move any point of the robot.

use robotc_core::model::{Drive, JointMotion};
use robotc_core::{DofIdx, Kinematics, LinkIdx, Pose};

/// For each moving body, metres that any of its points travels for each unit of each joint, at most, in any
/// configuration.
///
/// A point of a body is never farther from a joint's axis than the bones between them are long, so a joint motion of
/// d moves it by no more than that length times d; several joints add up. Bounds proven this way hold for the whole
/// motion, not only for its start (Schwarzer, Saha and Latombe, "Exact collision checking of robot paths", 2002).
#[derive(Debug, Clone, PartialEq)]
pub struct TravelBounds {
    dofs: Vec<DofIdx>,
    /// One row for each body, one factor for each degree of freedom.
    rows: Vec<Vec<f64>>,
}

impl TravelBounds {
    /// Bounds of nothing yet, for motions of these degrees of freedom.
    pub fn new(dofs: &[DofIdx]) -> Self {
        Self { dofs: dofs.to_vec(), rows: Vec::new() }
    }

    /// Adds a body fixed to `link` whose points are within `radius` metres of the link frame's origin; returns its row:
    /// how far each degree of freedom moves it at most.
    pub fn add(&mut self, kinematics: &Kinematics, link: LinkIdx, radius: f64) -> Vec<f64> {
        let row = self.row(kinematics, link, radius);
        let dominated = |by: &Vec<f64>| row.iter().zip(by).all(|(a, b)| a <= b);
        if !self.rows.iter().any(dominated) {
            self.rows.push(row.clone());
        }
        row
    }

    /// Adds one more coordinate, which moves anything by no more than `travel` metres for each unit.
    pub(crate) fn add_coordinate(&mut self, travel: f64) {
        self.rows.iter_mut().for_each(|row| row.push(travel));
    }

    /// The farthest that any point of a body fixed to `link`, within `radius` of its origin, is from the root's origin.
    pub fn reach(&self, kinematics: &Kinematics, link: LinkIdx, radius: f64) -> f64 {
        self.row_and_reach(kinematics, link, radius).1
    }

    fn row(&self, kinematics: &Kinematics, link: LinkIdx, radius: f64) -> Vec<f64> {
        self.row_and_reach(kinematics, link, radius).0
    }

    fn row_and_reach(&self, kinematics: &Kinematics, link: LinkIdx, radius: f64) -> (Vec<f64>, f64) {
        let model = kinematics.model();
        let mut row = vec![0.0; self.dofs.len()];
        // Distance from the origin of the link reached so far to any point of the body.
        let mut reach = radius;
        let mut at = link;
        while let Some(index) = model.links()[at].parent_joint {
            let joint = &model.joints()[index];
            let (factor, offset) = match joint.drive {
                Drive::Mimic { multiplier, offset, .. } => (multiplier.abs(), offset.abs()),
                _ => (1.0, 0.0),
            };
            let dof = model.driving_dof(index);
            let column = dof.and_then(|d| self.dofs.iter().position(|&own| own == d));
            let correction = kinematics.calibration().joint(index);
            match joint.motion {
                JointMotion::Fixed => {}
                JointMotion::Revolute => {
                    if let Some(c) = column {
                        row[c] += factor * reach;
                    }
                }
                JointMotion::Prismatic => {
                    if let Some(c) = column {
                        row[c] += factor;
                    }
                    let limits = dof.map(|d| &model.dofs()[d]);
                    let farthest = limits.map_or(0.0, |d| d.lower.abs().max(d.upper.abs()));
                    let zero = correction.map_or(0.0, |c| c.value_offset.abs());
                    reach += factor * farthest + offset + zero;
                }
            }
            let moved = correction.map_or_else(Pose::identity, |c| c.joint_from_corrected);
            reach += (joint.parent_from_joint() * moved).translation.vector.norm();
            at = joint.parent;
        }
        (row, reach)
    }

    /// The part of [`travel`](Self::travel) that a body with this row travels at most, whatever the motion.
    pub fn pace(&self, row: &[f64]) -> f64 {
        let against = |all: &Vec<f64>| {
            let ratio = |(&own, &all): (&f64, &f64)| if own == 0.0 { 0.0 } else { own / all };
            row.iter().zip(all).map(ratio).fold(0.0, f64::max)
        };
        self.rows.iter().map(against).fold(f64::INFINITY, f64::min)
    }

    /// The most that any point of any body travels in the straight motion by `difference`, metres.
    pub fn travel(&self, difference: &[f64]) -> f64 {
        let of = |row: &Vec<f64>| row.iter().zip(difference).map(|(r, d)| r * d.abs()).sum::<f64>();
        self.rows.iter().map(of).fold(0.0, f64::max)
    }

    /// For each degree of freedom, the most that it moves any body: natural weights of the metric.
    pub fn weights(&self) -> Vec<f64> {
        (0..self.dofs.len()).map(|i| self.rows.iter().map(|r| r[i]).fold(0.0, f64::max)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testbed;
    use nalgebra::Point3;
    use robotc_core::Seed;

    #[test]
    fn no_point_travels_farther_than_the_bound() {
        let robot = testbed::robot(true);
        let kinematics = Kinematics::new(robot.model.clone());
        let dofs = &robot.arms[0].dofs;
        let link = robot.model.link_named("left").unwrap();
        let mut bounds = TravelBounds::new(dofs);
        bounds.add(&kinematics, link, 0.2);
        let fore_row = bounds.add(&kinematics, robot.model.link_named("fore").unwrap(), 0.3);
        let mut rng = Seed::new(4).rng();
        let mut tightest = 0.0_f64;
        for _ in 0..300 {
            let mut draw = |scale: f64| -> Vec<f64> {
                dofs.iter()
                    .map(|&d| {
                        let (low, high) = robot.model.dofs()[d].sampling_range();
                        scale * rng.range(low, high)
                    })
                    .collect()
            };
            let (from, step) = (draw(1.0), draw(0.05));
            let point = Point3::from(rng.direction().into_inner() * 0.2);
            let mut q = testbed::rest(&robot);
            let mut at = |t: f64| {
                let values: Vec<f64> = from.iter().zip(&step).map(|(a, d)| a + t * d).collect();
                q.set(dofs, &values);
                kinematics.root_from_link(&q, link) * point
            };
            let moved = nalgebra::distance(&at(0.0), &at(1.0));
            let bound = bounds.travel(&step);
            assert!(moved <= bound + 1e-12, "{moved} {bound}");
            tightest = tightest.max(moved / bound);
            // A body nearer to the base travels no more than its pace.
            let moved_fore: f64 = fore_row.iter().zip(&step).map(|(r, d)| r * d.abs()).sum();
            assert!(moved_fore <= bounds.pace(&fore_row) * bound + 1e-12);
        }
        // The rail moves both alike, so the pace is the whole; without the rail it is less.
        assert_eq!(bounds.pace(&fore_row), 1.0);
        let turning = |row: &[f64]| row[1..].to_vec();
        let without_rail = TravelBounds { dofs: dofs[1..].to_vec(), rows: vec![turning(&bounds.rows[0])] };
        assert!(without_rail.pace(&turning(&fore_row)) < 0.9);
        assert!(tightest > 0.5, "the bound is not absurdly loose: {tightest}");
    }
}
