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

/// How a way of the object is searched for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WaySearch {
    /// Randomised A*, soon done where many ways lead to the goal.
    #[default]
    Randomized,
    /// All grasps at all steps, which also tells that there is no way; for arms without free joints, others are searched as above.
    Discrete,
}

/// Parameters of a caging task.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CagedObjectOptions {
    /// Farthest two grasps are apart between which the gripper changes in one motion, metres.
    pub shift: f64,
    /// The same for their orientations, radians.
    pub turn: f64,
    /// Longest motion of the arm between neighbouring states, as a share of the diameter of its space.
    pub longest_motion: f64,
    /// Values of each free joint that are tried over its whole range.
    pub free_samples: usize,
    /// Spacing of the values of free joints that are tried around a given configuration, radians or metres; three to
    /// either side.
    pub free_step: f64,
    /// Configurations kept of those near to a given one.
    pub branches: usize,
    /// Farthest that the tool may be, half way between two states, from half way between their poses: more means that the arm goes a
    /// way round. Metres.
    pub drift: f64,
    /// How goals of tasks search for a way.
    pub search: WaySearch,
}

impl Default for CagedObjectOptions {
    fn default() -> Self {
        Self {
            shift: 0.03,
            turn: 0.4,
            longest_motion: 0.04,
            free_samples: 16,
            free_step: 0.05,
            branches: 3,
            drift: 0.01,
            search: WaySearch::Randomized,
        }
    }
}

/// Why there is no caging task.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum CagedObjectError {
    /// There are no grasps.
    #[error("the set of caging grasps is empty")]
    NoGrasps,
    /// There are no steps.
    #[error("the object has no steps to go through")]
    NoSteps,
}

/// One of the configurations that the object goes through.
#[derive(Debug, Clone, PartialEq)]
pub struct ObjectStep {
    /// The value of its joint.
    pub value: f64,
    /// Where its moving part is then.
    pub world_from_part: Pose,
}

/// An arm that moves a part of a mechanism through given steps.
///
/// Motions are straight in the joints of the arm, the fingers and the mechanism at once.
pub struct CagedObject<'a, C> {
    arm: &'a ArmModel,
    grasps: &'a [CageGrasp],
    fingers: Vec<Vec<f64>>,
    adjacent: Vec<Vec<usize>>,
    steps: Vec<ObjectStep>,
    checker: C,
    rest: Vec<f64>,
    longest_motion: f64,
    options: CagedObjectOptions,
    scratch: IkSolutions,
}

impl<'a, C: EdgeChecker> CagedObject<'a, C> {
    /// A task with these steps, the present one first and the goal last.
    ///
    /// The states of `checker` are the joints of the arm and then the value of the object. Joint angles are those nearest to
    /// `rest` where there is no nearer configuration to keep to.
    pub fn new(
        arm: &'a ArmModel,
        grasps: &'a [CageGrasp],
        steps: Vec<ObjectStep>,
        checker: C,
        rest: &[f64],
        options: CagedObjectOptions,
    ) -> Result<Self, CagedObjectError> {
        if grasps.is_empty() {
            return Err(CagedObjectError::NoGrasps);
        }
        if steps.is_empty() {
            return Err(CagedObjectError::NoSteps);
        }
        let near = |a: &CageGrasp, b: &CageGrasp| {
            let (a, b) = (&a.part_from_tool, &b.part_from_tool);
            (a.translation.vector - b.translation.vector).norm() <= options.shift
                && a.rotation.angle_to(&b.rotation) <= options.turn
        };
        let adjacent =
            grasps.iter().map(|a| (0..grasps.len()).filter(|&b| near(a, &grasps[b])).collect()).collect();
        let longest_motion = options.longest_motion * arm.space().diameter();
        let (rest, scratch) = (rest.to_vec(), IkSolutions::new());
        let fingers = Vec::new();
        Ok(Self { arm, grasps, fingers, adjacent, steps, checker, rest, longest_motion, options, scratch })
    }

    /// The same task with fingers that have values of their own in each grasp: the states of the checker are the joints of the
    /// arm, those of the fingers, and the value of the object.
    pub fn with_fingers(mut self, fingers: Vec<Vec<f64>>) -> Self {
        self.fingers = fingers;
        self
    }

    /// A state as the checker sees it.
    pub fn whole(&self, state: &CagedState) -> Vec<f64> {
        let fingers = self.fingers.get(state.grasp).map_or(&[][..], |fingers| fingers);
        [state.q.as_slice(), fingers, &[self.steps[state.step].value]].concat()
    }

    /// The checker.
    pub fn checker(&mut self) -> &mut C {
        &mut self.checker
    }

    /// `world_from_tool` of a grasp at a step.
    pub fn world_from_tool(&self, step: usize, grasp: usize) -> Pose {
        self.steps[step].world_from_part * self.grasps[grasp].part_from_tool
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
        self.steps.len()
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
        // Over the whole range all count: neighbours at other steps are found among them.
        let most = if near.is_none() { usize::MAX } else { self.options.branches };
        let mut free = Vec::new();
        for q in self.candidates(step, grasp, near) {
            let state = CagedState { step, grasp, q };
            if self.free(&state).is_ok() {
                free.push(state.q);
            }
            if free.len() == most {
                break;
            }
        }
        free
    }

    fn candidates(&mut self, step: usize, grasp: usize, near: Option<&[f64]>) -> Vec<Vec<f64>> {
        if let Some(near) = near {
            let mut all = Vec::new();
            self.take_candidate(step, grasp, near, &mut |q| {
                all.push(q);
                false
            });
            return all;
        }
        let world_from_tool = self.world_from_tool(step, grasp);
        let mut found = Vec::new();
        for free in self.free_values(None) {
            let (solutions, _) = self.arm.inverse(&world_from_tool, &free, &self.rest, &mut self.scratch);
            let space = self.arm.space();
            found.extend(solutions.into_iter().map(|q| (space.distance(&q, &self.rest), q)));
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        found.into_iter().map(|(_, q)| q).collect()
    }

    /// Values of the free joints farther away are tried when nothing nearer is taken: no configuration with them is nearer.
    fn take_candidate(
        &mut self,
        step: usize,
        grasp: usize,
        near: &[f64],
        take: &mut dyn FnMut(Vec<f64>) -> bool,
    ) -> bool {
        let (world_from_tool, space) = (self.world_from_tool(step, grasp), self.arm.space());
        let at_least = |free: Vec<f64>| {
            let mut q = near.to_vec();
            self.arm.free_variables().iter().zip(&free).for_each(|(&variable, &value)| q[variable] = value);
            (space.distance(&q, near), free)
        };
        let mut values: Vec<_> = self.free_values(Some(near)).into_iter().map(at_least).collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        // What is too far for a motion is of no use.
        values.retain(|(distance, _)| *distance <= self.longest_motion);
        // Found but not shown, the farthest first.
        let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
        for (number, (_, free)) in values.iter().enumerate() {
            let (solutions, _) = self.arm.inverse(&world_from_tool, free, near, &mut self.scratch);
            let with_distance = solutions.into_iter().map(|q| (space.distance(&q, near), q));
            found.extend(with_distance.filter(|(distance, _)| *distance <= self.longest_motion));
            found.sort_by(|a, b| b.0.total_cmp(&a.0));
            let next = values.get(number + 1).map_or(f64::INFINITY, |(distance, _)| *distance);
            while let Some((_, q)) = found.pop_if(|(distance, _)| *distance < next) {
                if take(q) {
                    return true;
                }
            }
        }
        false
    }

    fn free(&mut self, state: &CagedState) -> Result<(), Obstruction> {
        let whole = self.whole(state);
        self.checker.is_free(&whole)
    }

    fn motion(&mut self, from: &CagedState, to: &CagedState) -> Result<(), Obstruction> {
        let middle = self.arm.space().interpolate(&from.q, &to.q, 0.5);
        let at = |state: &CagedState| self.world_from_tool(state.step, state.grasp).translation.vector;
        let expected = 0.5 * (at(from) + at(to));
        if (self.arm.world_from_tool(&middle).translation.vector - expected).norm() > self.options.drift {
            return Err(Obstruction::Constraint);
        }
        let (from, to) = (self.whole(from), self.whole(to));
        self.checker.edge(&from, &to).map_err(|blocked| blocked.by)
    }

    fn longest_motion(&self) -> f64 {
        self.longest_motion
    }
}
