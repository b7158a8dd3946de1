//! Where and how a held object is put down: destinations times inverse kinematics, lazily.

use nalgebra::Vector3;
use robotc_core::ik::IkSolutions;
use robotc_core::rng::Rng;
use robotc_core::{Configuration, Pose};

use super::picks::hand_is_free;
use super::problem::GoalContext;
use super::rejections::{Filter, Rejections};
use super::stretch::{back_off, cause, fine_checker, fingers_move, raise, state_is_free};
use crate::budget::{Budget, Interrupt};
use crate::constraint::Constraint;
use crate::goal::{GoalDraw, GoalSampler};
use crate::grasp::Grasp;
use crate::scene::Scene;

/// The destinations of a goal, with what is known of them whatever the grasp.
#[derive(Clone)]
pub(super) struct Destinations {
    poses: Vec<Pose>,
    /// The scene with the object there; `None` while unknown, `Some(None)` when the place is occupied.
    scenes: Vec<Option<Option<Scene>>>,
}

impl Destinations {
    pub(super) fn new(poses: Vec<Pose>) -> Self {
        let scenes = vec![None; poses.len()];
        Self { poses, scenes }
    }

    /// How many are known, and how many were looked at.
    pub(super) fn counts(&self) -> [usize; 2] {
        [self.poses.len(), self.scenes.iter().filter(|scene| scene.is_some()).count()]
    }

    /// `world_from_object` of one of them.
    pub(super) fn pose(&self, index: usize) -> &Pose {
        &self.poses[index]
    }

    /// The scene with the object there; `None` when the place is occupied.
    pub(super) fn scene(
        &mut self,
        index: usize,
        cx: &GoalContext<'_>,
        scene: &Scene,
        rejections: &mut Rejections,
    ) -> Option<&Scene> {
        if self.scenes[index].is_none() {
            let pose = self.poses[index];
            let free = scene.body_against_bodies(cx.body(), pose, cx.sink());
            self.scenes[index] = Some(match free {
                Ok(()) => Some(scene.with_body_at(cx.body(), pose)),
                Err(touch) => {
                    rejections.add_because(Filter::Destination, cause(scene, touch.into()));
                    None
                }
            });
        }
        self.scenes[index].as_ref().and_then(|s| s.as_ref())
    }
}

/// A way to put the object down.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Placing {
    pub(super) world_from_object: Pose,
    /// Arm configurations from above the destination down to it.
    pub(super) lower: Vec<Vec<f64>>,
    /// From there back to where free motion is possible.
    pub(super) retreat: Vec<Vec<f64>>,
}

/// Placings of an object held by one grasp, in lazy order: destinations first, then free values of the arm.
pub(super) struct Placings<'a, 's> {
    pub(super) cx: GoalContext<'a>,
    pub(super) scene: &'s Scene,
    pub(super) grasp: &'s Grasp,
    /// Where the arm comes from: solutions near it are tried first.
    pub(super) near: Vec<f64>,
    /// The robot's other joints.
    pub(super) q: Configuration,
    pub(super) constraint: Option<&'s dyn Constraint>,
    /// Which destination, and which round of free values, comes next.
    pub(super) next: usize,
    /// Branches of the present destination still to be tried, the next one last.
    pub(super) branches: Vec<(usize, Vec<f64>)>,
    pub(super) found: Vec<Placing>,
}

/// A sampler of [`Placings`] with what it shares with the search for grasps.
pub(super) struct PlacingSampler<'p, 'a, 's> {
    pub(super) placings: &'p mut Placings<'a, 's>,
    pub(super) destinations: &'p mut Destinations,
    pub(super) rejections: &'p mut Rejections,
    pub(super) rng: &'p mut Rng,
    /// Placings found before that are handed out first.
    pub(super) handed_out: usize,
}

impl PlacingSampler<'_, '_, '_> {
    /// Looks at one more candidate: `None` when there are none left, else whether it is good.
    pub(super) fn try_next(&mut self) -> Option<bool> {
        let p = &mut *self.placings;
        let cx = p.cx;
        if let Some((destination, q)) = p.branches.pop() {
            let placing = self.check(destination, &q);
            let good = placing.is_some();
            self.placings.found.extend(placing);
            return Some(good);
        }
        let free_variables = cx.problem.arm.free_variables();
        let rounds = if free_variables.is_empty() { 1 } else { cx.options.free_samples as usize };
        let (round, index) = (p.next / self.destinations.poses.len(), p.next % self.destinations.poses.len());
        if round >= rounds {
            return None;
        }
        p.next += 1;
        let world_from_tool = self.destinations.poses[index] * p.grasp.object_from_tool;
        let Some(there) = self.destinations.scene(index, &cx, p.scene, self.rejections) else {
            return Some(false);
        };
        if round == 0
            && let Err(cause) = hand_is_free(&cx, there, p.grasp, &world_from_tool)
        {
            self.rejections.add_because(Filter::HandAtDestination, cause);
            return Some(false);
        }
        let free = free_values(&cx, round, &p.near, self.rng);
        let mut scratch = IkSolutions::new();
        let (solutions, outside) = cx.problem.arm.inverse(&world_from_tool, &free, &p.near, &mut scratch);
        if solutions.is_empty() {
            let filter = if outside > 0 { Filter::DestinationLimits } else { Filter::DestinationOutOfReach };
            self.rejections.add(filter);
            return Some(false);
        }
        p.branches = solutions.into_iter().take(cx.options.branches).map(|q| (index, q)).rev().collect();
        Some(false)
    }

    fn check(&mut self, destination: usize, at: &[f64]) -> Option<Placing> {
        let p = &*self.placings;
        let cx = p.cx;
        let world_from_object = self.destinations.poses[destination];
        let closed = cx.with_fingers(&p.q, &p.grasp.closed);
        let open = cx.with_fingers(&p.q, &cx.gripper().preshapes[p.grasp.preshape].values);
        let held = cx.grip(&p.grasp.object_from_tool);
        let rules = cx.standing(held);
        if p.constraint.is_some_and(|c| !c.holds(at)) {
            self.rejections.add(Filter::Constraint);
            return None;
        }
        let checked = state_is_free(&mut fine_checker(&cx, p.scene, &closed, rules.clone()), at);
        if let Err(cause) = checked {
            self.rejections.add_because(Filter::ArmAtDestination, cause);
            return None;
        }
        let mut lower = match raise(&cx, p.scene, &closed, at, &rules) {
            Ok(path) => path,
            Err(cause) => {
                self.rejections.add_because(Filter::Lower, cause);
                return None;
            }
        };
        lower.reverse();
        let there = self.destinations.scene(destination, &cx, p.scene, self.rejections)?;
        let direction: Vector3<f64> = -(world_from_object.rotation * p.grasp.approach_in_object.into_inner());
        let retreat = state_is_free(&mut fine_checker(&cx, there, &open, cx.touching()), at)
            .and_then(|()| {
                let now = open.select(&cx.gripper().dofs);
                fingers_move(&cx, there, &p.q, at, &p.grasp.closed, &now, cx.touching())
            })
            .and_then(|()| back_off(&cx, there, &open, at, &direction));
        match retreat {
            Ok(retreat) => Some(Placing { world_from_object, lower, retreat }),
            Err(cause) => {
                self.rejections.add_because(Filter::Retreat, cause);
                None
            }
        }
    }
}

impl GoalSampler for PlacingSampler<'_, '_, '_> {
    fn draw(&mut self, budget: &Budget<'_>) -> Result<GoalDraw, Interrupt> {
        budget.check()?;
        if self.handed_out == self.placings.found.len() {
            match self.try_next() {
                None => return Ok(GoalDraw::Exhausted),
                Some(false) => return Ok(GoalDraw::Pending),
                Some(true) => {}
            }
        }
        let placing = &self.placings.found[self.handed_out];
        self.handed_out += 1;
        Ok(GoalDraw::Goal(placing.lower[0].clone()))
    }
}

/// Values of the free variables for one round: those of `near` first, then random ones within the limits.
pub(super) fn free_values(cx: &GoalContext<'_>, round: usize, near: &[f64], rng: &mut Rng) -> Vec<f64> {
    let arm = cx.problem.arm;
    let free = arm.free_variables();
    if round == 0 {
        return free.iter().map(|&v| near[v]).collect();
    }
    let sample = arm.space().sample(rng);
    free.iter().map(|&v| sample[v]).collect()
}
