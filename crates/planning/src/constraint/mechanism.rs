//! The tool holds a door or a drawer and goes where it goes.

use std::f64::consts::PI;

use robotc_core::Pose;

use super::{Constraint, RegionError, RegionTolerance, TaskRegion};
use crate::arm::ArmModel;
use crate::mechanism::{Mechanism, MechanismMotion};

/// A firm grasp of the moving part of a mechanism: one degree of freedom is left to the tool.
///
/// The relaxed alternative is to let the grasp change on the way, see [`caging`](crate::caging).
#[derive(Clone)]
pub struct HeldMechanism<'a> {
    region: TaskRegion<'a>,
    motion: MechanismMotion,
}

impl<'a> HeldMechanism<'a> {
    /// The arm holds `mechanism` with the moving part at `tool_from_part`.
    ///
    /// A hinge turns less than half a turn to either side.
    pub fn new(
        arm: &'a ArmModel,
        mechanism: &Mechanism,
        tool_from_part: &Pose,
        tolerance: RegionTolerance,
    ) -> Result<Self, RegionError> {
        let (mut low, mut high) = ([0.0; 6], [0.0; 6]);
        let (from, to) = mechanism.range;
        match mechanism.motion {
            MechanismMotion::Hinge => (low[5], high[5]) = (from.max(-PI), to.min(PI)),
            MechanismMotion::Slide => (low[2], high[2]) = (from, to),
        }
        let region = TaskRegion::new(arm, &mechanism.world_from_axis, tool_from_part, low, high, tolerance)?;
        Ok(Self { region, motion: mechanism.motion })
    }

    /// The value of the mechanism when the tool is as at `q`: radians or metres.
    pub fn value_at(&self, q: &[f64]) -> f64 {
        let displacement = self.region.displacement(q);
        match self.motion {
            MechanismMotion::Hinge => displacement[5],
            MechanismMotion::Slide => displacement[2],
        }
    }
}

impl Constraint for HeldMechanism<'_> {
    fn holds(&self, q: &[f64]) -> bool {
        self.region.holds(q)
    }

    fn size(&self, difference: &[f64]) -> f64 {
        self.region.size(difference)
    }

    fn project(&self, q: &mut [f64]) -> bool {
        self.region.project(q)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::Budget;
    use crate::edge::{EdgeChecker, walk_path};
    use crate::goal::FixedGoals;
    use crate::rrt::{RrtConnect, RrtOptions};
    use crate::testbed::{self, REST};
    use robotc_core::Seed;
    use robotc_core::ik::IkSolutions;

    /// A mechanism held by the arm at rest, its axis `offset` away from the tool.
    fn held(arm: &ArmModel, start: &[f64], motion: MechanismMotion, to: f64) -> (Mechanism, Pose) {
        let world_from_tool = arm.world_from_tool(start);
        let p = world_from_tool.translation.vector;
        let world_from_axis = match motion {
            // A vertical hinge to the left of the tool.
            MechanismMotion::Hinge => Pose::translation(p.x, p.y + 0.3, p.z),
            // A drawer that opens towards the robot: z points to it.
            MechanismMotion::Slide => {
                let turn = nalgebra::UnitQuaternion::from_axis_angle(
                    &nalgebra::Vector3::y_axis(),
                    -std::f64::consts::FRAC_PI_2,
                );
                Pose::from_parts(p.into(), turn)
            }
        };
        let mechanism = Mechanism { world_from_axis, motion, range: (0.0, to) };
        (mechanism, world_from_tool.inverse() * world_from_axis)
    }

    #[test]
    fn a_held_door_and_a_held_drawer_open_along_their_axes() {
        for (motion, to) in [(MechanismMotion::Hinge, -0.5), (MechanismMotion::Slide, 0.15)] {
            for rail in [false, true] {
                let arm = testbed::arm(rail);
                let start = if rail { [&[0.1], &REST[..]].concat() } else { REST.to_vec() };
                let (mut mechanism, tool_from_part) = held(&arm, &start, motion, to);
                mechanism.range = (to.min(0.0), to.max(0.0));
                let constraint =
                    HeldMechanism::new(&arm, &mechanism, &tool_from_part, RegionTolerance::default())
                        .unwrap();
                let world_from_tool = mechanism.world_from_part(to) * tool_from_part.inverse();
                let free = vec![0.1; arm.free_variables().len()];
                let (goals, _) = arm.inverse(&world_from_tool, &free, &start, &mut IkSolutions::new());
                let mut checker = testbed::Limits::new(&arm).with_constraint(&constraint);
                let mut search = RrtConnect::new(&start);
                let options = RrtOptions { step: 0.02, max_iterations: 3000, ..RrtOptions::default() };
                let solution = search
                    .run(
                        &mut checker,
                        Some(&constraint),
                        &mut FixedGoals::new(goals),
                        &options,
                        &Budget::unlimited(),
                        &mut Seed::new(1).rng(),
                    )
                    .unwrap_or_else(|e| panic!("{motion:?} rail {rail}: {e}"));
                walk_path(&mut checker, &solution.path).unwrap();
                let mut farthest: f64 = 0.0;
                for pair in solution.path.windows(2) {
                    for k in 0..=8 {
                        let q = checker.space().interpolate(&pair[0], &pair[1], f64::from(k) / 8.0);
                        let part = arm.world_from_tool(&q) * tool_from_part;
                        let value = constraint.value_at(&q);
                        let gap = mechanism.world_from_part(value).inverse() * part;
                        // Between the states that are looked at, the whole tolerance may be used.
                        assert!(gap.translation.vector.amax() <= 0.005 + 1e-9, "{gap}");
                        assert!(gap.rotation.angle() <= 3.0 * 0.02, "{gap}");
                        farthest = farthest.max(value / to);
                    }
                }
                assert!(farthest > 0.999, "{farthest}");
            }
        }
    }
}
