//! A frame on the tool stays within bounds of a frame in the world.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{DMatrix, DVector, Matrix3, Vector3, Vector6};
use robotc_core::Pose;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::Constraint;
use crate::arm::ArmModel;

/// How far a frame may be outside of its bounds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RegionTolerance {
    /// For x, y and z, metres.
    pub linear: f64,
    /// For roll, pitch and yaw, radians.
    pub angular: f64,
}

impl Default for RegionTolerance {
    fn default() -> Self {
        Self { linear: 0.005, angular: 0.02 }
    }
}

/// Why bounds make no region.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum RegionError {
    /// A lower bound is above its upper bound, or one is not a number.
    #[error("bound {0} of the region is empty")]
    Empty(usize),
    /// Roll and yaw mean nothing where the pitch is a quarter turn.
    #[error("the pitch of a region may not come near a quarter turn unless roll, pitch and yaw are all free")]
    Pitch,
}

/// A task-space region (Berenson, Srinivasa and Kuffner, "Task space regions", 2011): six intervals for the displacement
/// of a frame that moves with the tool from a frame that stands in the world.
///
/// The displacement is x, y, z and then roll, pitch, yaw (turns about x, y and z of the region's frame, in this order).
/// An interval of a whole turn, or from minus infinity to infinity, is no bound.
#[derive(Clone)]
pub struct TaskRegion<'a> {
    arm: &'a ArmModel,
    region_from_world: Pose,
    tool_from_frame: Pose,
    low: Vector6<f64>,
    high: Vector6<f64>,
    tolerance: RegionTolerance,
    /// Metres that the frame's origin moves for each unit of each joint, at most.
    travel: Vec<f64>,
    /// Largest change of an angle of the displacement for each radian of turning.
    turning: f64,
}

/// This fraction of the tolerance is kept in reserve for the states between those that are looked at.
const RESERVE: f64 = 0.25;

/// Projection ends within this fraction of the tolerance, so that edges between projected states hold too.
const AIM: f64 = 0.2;

/// Newton steps of a projection.
const STEPS: usize = 20;

/// Pitch farther from zero than this is too near to a quarter turn.
const LARGEST_PITCH: f64 = 1.4;

impl<'a> TaskRegion<'a> {
    /// The region `low` to `high` around `world_from_region`, for the frame `tool_from_frame`.
    pub fn new(
        arm: &'a ArmModel,
        world_from_region: &Pose,
        tool_from_frame: &Pose,
        low: [f64; 6],
        high: [f64; 6],
        tolerance: RegionTolerance,
    ) -> Result<Self, RegionError> {
        // A comparison that NaN fails too.
        if let Some(i) = (0..6).find(|&i| low[i] > high[i] || low[i].is_nan() || high[i].is_nan()) {
            return Err(RegionError::Empty(i));
        }
        let pitch = low[4].abs().max(high[4].abs());
        let turns_freely = (3..6).all(|i| high[i] - low[i] >= TAU);
        if !turns_freely && pitch + tolerance.angular > LARGEST_PITCH {
            return Err(RegionError::Pitch);
        }
        let turning = if turns_freely { 0.0 } else { 1.0 / libm::cos(pitch + tolerance.angular) };
        Ok(Self {
            arm,
            region_from_world: world_from_region.inverse(),
            tool_from_frame: *tool_from_frame,
            low: Vector6::from(low),
            high: Vector6::from(high),
            tolerance,
            travel: arm.point_travel(&tool_from_frame.translation.vector.into()),
            turning,
        })
    }

    /// The displacement at `q`; yaw and roll are those of their aliases nearest to the bounds.
    pub fn displacement(&self, q: &[f64]) -> Vector6<f64> {
        let pose = self.region_from_world * self.arm.world_from_tool(q) * self.tool_from_frame;
        let (roll, pitch, yaw) = pose.rotation.euler_angles();
        let t = pose.translation.vector;
        let mut d = Vector6::new(t.x, t.y, t.z, roll, pitch, yaw);
        for i in [3, 5] {
            let excess = |x: &f64| (self.low[i] - x).max(x - self.high[i]);
            let aliases = [d[i], d[i] + TAU, d[i] - TAU];
            d[i] = aliases.into_iter().min_by(|a, b| excess(a).total_cmp(&excess(b))).unwrap_or(d[i]);
        }
        d
    }

    /// How far a displacement is outside, signed; zero inside.
    fn excess(&self, displacement: &Vector6<f64>) -> Vector6<f64> {
        let mut excess = Vector6::zeros();
        for i in 0..6 {
            let d = displacement[i];
            if !self.is_free(i) {
                excess[i] = (d - self.high[i]).max(0.0) + (d - self.low[i]).min(0.0);
            }
        }
        excess
    }

    fn is_free(&self, i: usize) -> bool {
        self.high[i] - self.low[i] >= if i < 3 { f64::INFINITY } else { TAU }
    }

    fn within(&self, excess: &Vector6<f64>, fraction: f64) -> bool {
        (0..6).all(|i| {
            let tolerance = if i < 3 { self.tolerance.linear } else { self.tolerance.angular };
            excess[i].abs() <= fraction * tolerance
        })
    }

    /// Derivative of the displacement at `q`, one column for each variable.
    fn jacobian(&self, q: &[f64], displacement: &Vector6<f64>) -> DMatrix<f64> {
        let world_from_tool = self.arm.world_from_tool(q);
        let lever = world_from_tool.rotation * self.tool_from_frame.translation.vector;
        let turn = self.region_from_world.rotation;
        let rates = angle_rates(displacement);
        let of_tool = self.arm.tool_jacobian(q);
        let mut jacobian = DMatrix::zeros(6, q.len());
        for column in 0..q.len() {
            let linear: Vector3<f64> = of_tool.fixed_view::<3, 1>(0, column).into_owned();
            let angular: Vector3<f64> = of_tool.fixed_view::<3, 1>(3, column).into_owned();
            let moved = turn * (linear + angular.cross(&lever));
            jacobian.fixed_view_mut::<3, 1>(0, column).copy_from(&moved);
            jacobian.fixed_view_mut::<3, 1>(3, column).copy_from(&(rates * (turn * angular)));
        }
        jacobian
    }
}

/// Rates of roll, pitch and yaw from the angular velocity in the region's frame.
fn angle_rates(displacement: &Vector6<f64>) -> Matrix3<f64> {
    let (sin_yaw, cos_yaw) = libm::sincos(displacement[5]);
    let pitch = displacement[4].clamp(-FRAC_PI_2 + 1e-3, FRAC_PI_2 - 1e-3);
    let (sin_pitch, cos_pitch) = libm::sincos(pitch);
    Matrix3::new(
        cos_yaw / cos_pitch,
        sin_yaw / cos_pitch,
        0.0,
        -sin_yaw,
        cos_yaw,
        0.0,
        cos_yaw * sin_pitch / cos_pitch,
        sin_yaw * sin_pitch / cos_pitch,
        1.0,
    )
}

impl Constraint for TaskRegion<'_> {
    fn holds(&self, q: &[f64]) -> bool {
        self.within(&self.excess(&self.displacement(q)), 1.0 - RESERVE)
    }

    fn size(&self, difference: &[f64]) -> f64 {
        // A state is within half a motion of one of its ends.
        let linear: f64 = self.travel.iter().zip(difference).map(|(t, d)| t * d.abs()).sum();
        let angular: f64 = difference.iter().map(|d| d.abs()).sum();
        let moves = 0.5 * linear / (RESERVE * self.tolerance.linear);
        let turns = 0.5 * self.turning * angular / (RESERVE * self.tolerance.angular);
        moves.max(turns)
    }

    fn project(&self, q: &mut [f64]) -> bool {
        for _ in 0..STEPS {
            let displacement = self.displacement(q);
            let excess = self.excess(&displacement);
            if self.within(&excess, AIM) {
                return true;
            }
            // What is inside of its bounds is left free to move; what has no room never is.
            let rows: Vec<usize> =
                (0..6).filter(|&i| excess[i] != 0.0 || self.low[i] == self.high[i]).collect();
            let jacobian = self.jacobian(q, &displacement).select_rows(rows.iter());
            let wanted = DVector::from_iterator(rows.len(), rows.iter().map(|&i| -excess[i]));
            let gram = &jacobian * jacobian.transpose() + DMatrix::identity(rows.len(), rows.len()) * 1e-6;
            let Some(cholesky) = gram.cholesky() else { return false };
            let step = jacobian.transpose() * cholesky.solve(&wanted);
            let longest = step.amax();
            // Far away the linear model overshoots.
            let scale = if longest > 0.5 { 0.5 / longest } else { 1.0 };
            for (x, d) in q.iter_mut().zip(step.iter()) {
                *x += scale * d;
            }
            self.arm.space().clamp(q);
        }
        self.holds(q)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testbed::{self, REST};
    use proptest::prelude::*;
    use robotc_core::Seed;

    const ANY: f64 = f64::INFINITY;

    fn box_region(arm: &ArmModel) -> TaskRegion<'_> {
        // Between two heights, in a corridor, level, any heading.
        TaskRegion::new(
            arm,
            &Pose::translation(0.5, 0.0, 0.4),
            &Pose::translation(0.05, 0.0, 0.0),
            [-ANY, -0.2, -0.1, -0.1, -0.1, -TAU],
            [ANY, 0.2, 0.1, 0.1, 0.1, TAU],
            RegionTolerance::default(),
        )
        .unwrap()
    }

    #[test]
    fn projected_states_are_in_the_region() {
        for rail in [false, true] {
            let arm = testbed::arm(rail);
            let region = box_region(&arm);
            let mut rng = Seed::new(3).rng();
            let mut succeeded = 0;
            for _ in 0..200 {
                let mut q = arm.space().sample(&mut rng);
                if region.project(&mut q) {
                    succeeded += 1;
                    let d = region.displacement(&q);
                    assert!(d[1].abs() <= 0.205 && d[2].abs() <= 0.105, "{d}");
                    assert!(d[3].abs() <= 0.12 && d[4].abs() <= 0.12, "{d}");
                    assert!(arm.space().contains(&q));
                }
            }
            assert!(succeeded > 100, "{succeeded}");
        }
    }

    #[test]
    fn bounds_that_make_no_region_are_refused() {
        let arm = testbed::arm(false);
        let region = |low, high| {
            TaskRegion::new(&arm, &Pose::identity(), &Pose::identity(), low, high, RegionTolerance::default())
                .err()
        };
        assert_eq!(region([0.0, 1.0, 0.0, 0.0, 0.0, 0.0], [0.0; 6]), Some(RegionError::Empty(1)));
        assert_eq!(region([0.0; 6], [0.0, 0.0, f64::NAN, 0.0, 0.0, 0.0]), Some(RegionError::Empty(2)));
        assert_eq!(region([-1.5; 6], [1.5; 6]), Some(RegionError::Pitch));
        assert_eq!(region([-ANY; 6], [ANY; 6]), None);
    }

    #[test]
    fn the_jacobian_is_the_derivative_of_the_displacement() {
        let arm = testbed::arm(false);
        let region = box_region(&arm);
        let q = [0.2, -1.4, 1.7, 0.3, 1.0, 0.4];
        let jacobian = region.jacobian(&q, &region.displacement(&q));
        for i in 0..6 {
            let moved = |d: f64| {
                let mut q = q;
                q[i] += d;
                region.displacement(&q)
            };
            let derivative = (moved(1e-6) - moved(-1e-6)) / 2e-6;
            assert!((derivative - jacobian.column(i)).norm() < 1e-5, "{i}: {derivative} {jacobian}");
        }
    }

    proptest! {
        #![proptest_config(crate::properties::cases(64))]
        #[test]
        fn motions_of_size_one_stay_within_the_tolerance(
            d in prop::array::uniform6(-1.0..1.0f64),
            t in 0.0..1.0f64,
        ) {
            let arm = testbed::arm(false);
            let mut a = REST.to_vec();
            let region = box_region(&arm);
            prop_assert!(region.project(&mut a));
            let scale = 1.0 / region.size(&d);
            let b: Vec<f64> = a.iter().zip(&d).map(|(a, d)| a + scale * d).collect();
            if region.holds(&b) {
                let q = arm.space().interpolate(&a, &b, t);
                let excess = region.excess(&region.displacement(&q));
                prop_assert!(region.within(&excess, 1.0), "{excess}");
            }
        }
    }
}
