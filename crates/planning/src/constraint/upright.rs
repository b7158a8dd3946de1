//! A held object that must not be spilt.

use nalgebra::{Matrix2, Matrix2xX, Vector2, Vector3};
use robotc_core::Pose;

use super::Constraint;
use crate::arm::ArmModel;

/// The z axis of a held object stays near the vertical.
#[derive(Clone)]
pub struct Upright<'a> {
    /// The arm that holds it.
    pub arm: &'a ArmModel,
    /// The object in the tool frame.
    pub tool_from_object: Pose,
    /// Largest angle between the object's z axis and the world's, radians.
    pub tilt: f64,
}

/// This fraction of the allowed tilt is kept in reserve for the states between those that are looked at.
const RESERVE: f64 = 0.1;

/// Projection aims at this fraction of the allowed tilt, so that edges between projected states hold too.
const AIM: f64 = 0.5;

/// Newton steps of a projection; it converges in three or four, or not at all.
const STEPS: usize = 12;

impl Upright<'_> {
    /// The object's z axis in the world at `q`.
    fn axis_in_world(&self, q: &[f64]) -> Vector3<f64> {
        (self.arm.world_from_tool(q) * self.tool_from_object).rotation * Vector3::z()
    }

    fn limit(&self) -> f64 {
        (1.0 - RESERVE) * self.tilt
    }

    /// Angle between the object's z axis and the world's at `q`, radians.
    pub fn tilt_at(&self, q: &[f64]) -> f64 {
        let axis = self.axis_in_world(q);
        axis.x.hypot(axis.y).atan2(axis.z)
    }
}

impl Constraint for Upright<'_> {
    fn holds(&self, q: &[f64]) -> bool {
        self.tilt_at(q) <= self.limit()
    }

    fn size(&self, difference: &[f64]) -> f64 {
        // No joint turns the object faster than itself, and a state is within half a motion of one of its ends.
        0.5 * difference.iter().map(|d| d.abs()).sum::<f64>() / (RESERVE * self.tilt)
    }

    fn project(&self, q: &mut [f64]) -> bool {
        for _ in 0..STEPS {
            let axis = self.axis_in_world(q);
            let sine = axis.x.hypot(axis.y);
            let tilt = sine.atan2(axis.z);
            if tilt <= self.limit() {
                return true;
            }
            // Turn about the horizontal axis that takes z back up; upside down, any will do.
            let direction =
                if sine > 1e-9 { Vector2::new(axis.y, -axis.x) / sine } else { Vector2::new(1.0, 0.0) };
            let turn = direction * (tilt - AIM * self.tilt);
            let jacobian: Matrix2xX<f64> = self.arm.tool_jacobian(q).fixed_rows::<2>(3).into_owned();
            let gram = &jacobian * jacobian.transpose() + Matrix2::identity() * 1e-6;
            let Some(inverse) = gram.try_inverse() else { return false };
            let step = jacobian.transpose() * (inverse * turn);
            let longest = step.amax();
            // Far from upright the linear model overshoots.
            let scale = if longest > 1.0 { 1.0 / longest } else { 1.0 };
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
    use robotc_core::Seed;

    #[test]
    fn projected_states_are_upright_and_most_projections_succeed() {
        for rail in [false, true] {
            let arm = testbed::arm(rail);
            let start = if rail { [&[0.0], &REST[..]].concat() } else { REST.to_vec() };
            let upright_in_world = Pose::from_parts(
                arm.world_from_tool(&start).translation,
                nalgebra::UnitQuaternion::identity(),
            );
            let tool_from_object = arm.world_from_tool(&start).inverse() * upright_in_world;
            let upright = Upright { arm: &arm, tool_from_object, tilt: 0.1 };
            assert!(upright.holds(&start));
            let mut rng = Seed::new(3).rng();
            let mut succeeded = 0;
            for _ in 0..200 {
                let mut q = arm.space().sample(&mut rng);
                if upright.project(&mut q) {
                    succeeded += 1;
                    assert!(upright.tilt_at(&q) <= 0.1 && arm.space().contains(&q));
                }
            }
            assert!(succeeded > 120, "{succeeded}");
        }
    }
}
