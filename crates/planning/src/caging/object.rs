//! The caging task of an arm and a door, a drawer, a lever.

use robotc_core::Pose;
use robotc_core::ik::IkSolutions;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::task::{ArticulatedTask, CagedState};
use crate::arm::ArmModel;
use crate::edge::{EdgeChecker, Obstruction};
use crate::space::Space;

/// A pose of the gripper that keeps the object from getting away.
#[derive(Debug, Clone, PartialEq)]
pub struct CageGrasp {
    /// The tool frame in the frame of the moving part.
    pub part_from_tool: Pose,
    /// Whether the gripper also touches it, so that it cannot move at all.
    pub contact: bool,
}

/// Parameters of a caging task.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CagedObjectOptions {
    /// Farthest two grasps are apart between which the gripper changes in one motion, metres.
    pub shift: f64,
    /// The same for their orientations, radians.
    pub turn: f64,
    /// Longest motion of the arm between neighbouring states, in its metric.
    pub longest_motion: f64,
    /// Values of each free joint that are tried over its whole range.
    pub free_samples: usize,
    /// Spacing of the values of free joints that are tried around a given configuration, radians or metres; three to
    /// either side.
    pub free_step: f64,
    /// Configurations kept for a grasp at a step.
    pub branches: usize,
}

impl Default for CagedObjectOptions {
    fn default() -> Self {
        Self { shift: 0.03, turn: 0.4, longest_motion: 0.6, free_samples: 8, free_step: 0.05, branches: 8 }
    }
}

/// Why there is no caging task.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum CagedObjectError {
    /// There are no grasps.
    #[error("the set of caging grasps is empty")]
    NoGrasps,
    /// Positions of the object and checkers do not belong together.
    #[error(
        "{positions} positions of the object need as many checkers, and one more than a multiple of {substeps}"
    )]
    Positions {
        /// Number of positions.
        positions: usize,
        /// Positions for each step.
        substeps: usize,
    },
}

/// An arm that moves a part of a mechanism through given positions.
pub struct CagedObject<'a, C> {
    arm: &'a ArmModel,
    grasps: &'a [CageGrasp],
    adjacent: Vec<Vec<usize>>,
    world_from_part: Vec<Pose>,
    checkers: Vec<C>,
    substeps: usize,
    rest: Vec<f64>,
    options: CagedObjectOptions,
    scratch: IkSolutions,
}

impl<'a, C: EdgeChecker> CagedObject<'a, C> {
    /// A task with a step at every `substeps`-th of the positions, first and last included.
    ///
    /// `checkers` check the arm with the object at each of the positions, which are so near to each other that their states
    /// stand for all in between. Joint angles are those nearest to `rest` where there is no nearer configuration to keep to.
    pub fn new(
        arm: &'a ArmModel,
        grasps: &'a [CageGrasp],
        world_from_part: Vec<Pose>,
        checkers: Vec<C>,
        substeps: usize,
        rest: &[f64],
        options: CagedObjectOptions,
    ) -> Result<Self, CagedObjectError> {
        if grasps.is_empty() {
            return Err(CagedObjectError::NoGrasps);
        }
        let (positions, substeps) = (world_from_part.len(), substeps.max(1));
        if positions == 0 || positions != checkers.len() || (positions - 1) % substeps != 0 {
            return Err(CagedObjectError::Positions { positions, substeps });
        }
        let near = |a: &CageGrasp, b: &CageGrasp| {
            let gap = a.part_from_tool.inv_mul(&b.part_from_tool);
            gap.translation.vector.norm() <= options.shift && gap.rotation.angle() <= options.turn
        };
        let adjacent =
            grasps.iter().map(|a| (0..grasps.len()).filter(|&b| near(a, &grasps[b])).collect()).collect();
        let (rest, scratch) = (rest.to_vec(), IkSolutions::new());
        Ok(Self { arm, grasps, adjacent, world_from_part, checkers, substeps, rest, options, scratch })
    }

    /// `world_from_tool` of a grasp at a step.
    pub fn world_from_tool(&self, step: usize, grasp: usize) -> Pose {
        self.world_from_part[step * self.substeps] * self.grasps[grasp].part_from_tool
    }

    /// Values of the free joints to try.
    fn free_values(&self, near: Option<&[f64]>) -> Vec<Vec<f64>> {
        let mut all: Vec<Vec<f64>> = vec![vec![]];
        for &variable in self.arm.free_variables() {
            let axis = &self.arm.space().axes()[variable];
            let values: Vec<f64> = match near {
                Some(near) => [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0]
                    .map(|k| near[variable] + k * self.options.free_step)
                    .into(),
                None => {
                    let (low, high) = if axis.wraps {
                        (-std::f64::consts::PI, std::f64::consts::PI)
                    } else {
                        (axis.lower, axis.upper)
                    };
                    let count = self.options.free_samples.max(1);
                    (0..count).map(|k| low + (high - low) * (k as f64 + 0.5) / count as f64).collect()
                }
            };
            let values: Vec<f64> =
                values.into_iter().filter(|v| axis.wraps || (axis.lower..=axis.upper).contains(v)).collect();
            all = all
                .iter()
                .flat_map(|head| values.iter().map(move |&v| [head.as_slice(), &[v]].concat()))
                .collect();
        }
        all
    }
}

impl<C: EdgeChecker> ArticulatedTask for CagedObject<'_, C> {
    fn arm_space(&self) -> &Space {
        self.arm.space()
    }

    fn steps(&self) -> usize {
        (self.world_from_part.len() - 1) / self.substeps + 1
    }

    fn grasps(&self) -> usize {
        self.grasps.len()
    }

    fn is_contact(&self, grasp: usize) -> bool {
        self.grasps[grasp].contact
    }

    fn adjacent(&self, grasp: usize) -> &[usize] {
        &self.adjacent[grasp]
    }

    fn solutions(&mut self, step: usize, grasp: usize, near: Option<&[f64]>) -> Vec<Vec<f64>> {
        let world_from_tool = self.world_from_tool(step, grasp);
        let mut found = Vec::new();
        for free in self.free_values(near) {
            let reference = near.unwrap_or(&self.rest);
            let (solutions, _) = self.arm.inverse(&world_from_tool, &free, reference, &mut self.scratch);
            for q in solutions {
                let distance = self.arm.space().distance(&q, reference);
                // What is too far for a motion needs no check.
                if near.is_none() || distance <= self.options.longest_motion {
                    found.push((distance, q));
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let checker = &mut self.checkers[step * self.substeps];
        let free = |q: &Vec<f64>| checker.state(q).is_ok();
        // Over the whole range of a redundant arm all values count: neighbours at other steps are found among them.
        let whole_range = near.is_none() && !self.arm.free_variables().is_empty();
        let most = if whole_range { usize::MAX } else { self.options.branches };
        found.into_iter().map(|(_, q)| q).filter(free).take(most).collect()
    }

    fn motion(&mut self, from: &CagedState, to: &CagedState) -> Result<(), Obstruction> {
        let (first, last) = ((from.step * self.substeps) as f64, (to.step * self.substeps) as f64);
        let space = self.arm.space();
        let checker = &self.checkers[from.step * self.substeps];
        let travel = checker.travel(&space.difference(&from.q, &to.q));
        let looks = (last - first).abs().max((travel / checker.resolution()).ceil()).max(1.0);
        for k in 1..=looks as usize {
            let t = k as f64 / looks;
            let position = (first + t * (last - first)).round() as usize;
            self.checkers[position].state(&space.interpolate(&from.q, &to.q, t))?;
        }
        Ok(())
    }

    fn longest_motion(&self) -> f64 {
        self.options.longest_motion
    }
}
