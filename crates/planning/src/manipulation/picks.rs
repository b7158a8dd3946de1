//! Grasps that can be reached, closed, lifted and put down: thesis algorithms 3.4, 3.5 and 3.6 as one lazy sampler.

use nalgebra::Vector3;
use robotc_core::ik::IkSolutions;
use robotc_core::rng::Rng;
use robotc_core::{BodyIdx, Configuration, LinkPoses, Pose, Seed};

use super::destinations::destination_poses;
use super::placings::{Destinations, Placing, PlacingSampler, Placings, free_values};
use super::plan::{PassedOver, Tried};
use super::problem::{GoalContext, Manipulation};
use super::put_down::kept_upright;
use super::ranking::ranking;
use super::rejections::{Cause, Filter, Rejections};
use super::stretch::{back_off, cause, fine_checker, fingers_move, raise, state_is_free};
use crate::budget::{Budget, Interrupt};
use crate::constraint::Upright;
use crate::goal::{GoalDraw, GoalSampler};
use crate::grasp::{Grasp, GraspSet};
use crate::scene::{Movers, Rules, Scene};

/// A grasp with all its straight motions.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pick {
    /// Position among the targets of the sampler.
    pub(super) target: usize,
    /// Position in the grasp set.
    pub(super) grasp: usize,
    /// Arm configurations from where free motion ends to the grasp.
    pub(super) approach: Vec<Vec<f64>>,
    /// From the grasp upwards.
    pub(super) lift: Vec<Vec<f64>>,
    /// One way to put the object down from where the robot stands.
    pub(super) placing: Option<Placing>,
}

/// What becomes of the object once it is lifted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Lifted {
    /// The arm puts it down from where the robot stands.
    PutDown,
    /// The base takes it to where it can be put down.
    TakenAway,
}

/// One of the objects that may be picked.
pub(super) struct Target<'a> {
    /// The goal, for this object.
    pub(super) cx: GoalContext<'a>,
    pub(super) set: &'a GraspSet,
    pub(super) destinations: Destinations,
    /// How many of its grasps were looked at, and gave picks.
    pub(super) tried: Tried,
    pub(super) rejections: Rejections,
}

impl<'a> Target<'a> {
    /// An object of the goal, with destinations drawn from `seed`.
    pub(super) fn new(cx: GoalContext<'a>, seed: Seed) -> Self {
        let set = cx.problem.grasps[cx.object];
        let poses = cx.destination().map_or_else(Vec::new, |destination| {
            destination_poses(destination, cx.options.destinations, &mut seed.rng())
        });
        let tried = Tried { known: set.grasps.len(), ..Tried::default() };
        Self { cx, set, destinations: Destinations::new(poses), tried, rejections: Rejections::default() }
    }
}

/// The state of a search for picks: the grasps of all targets are one set, in one order.
pub(super) struct PickSampler<'a, 's> {
    pub(super) targets: Vec<Target<'a>>,
    pub(super) scene: &'s Scene,
    /// The robot before the pick.
    q: Configuration,
    lifted: Lifted,
    rng: Rng,
    /// Grasps still in question, by rank: target and position in its set.
    alive: Vec<(usize, usize)>,
    /// Position in `alive`, and round of free values.
    cursor: usize,
    round: usize,
    /// Branches of the present grasp still to be tried, the next one last.
    branches: Vec<(usize, usize, Vec<f64>)>,
    pub(super) found: Vec<Pick>,
    /// How many of `found` the present search knows.
    handed_out: usize,
}

impl<'a, 's> PickSampler<'a, 's> {
    /// Picks of any of these targets, at least one, of one goal.
    pub(super) fn new(
        targets: Vec<Target<'a>>,
        scene: &'s Scene,
        q: &Configuration,
        lifted: Lifted,
        rng: Rng,
    ) -> Self {
        let objects: Vec<(BodyIdx, &GraspSet)> = targets.iter().map(|t| (t.cx.body(), t.set)).collect();
        let alive = targets
            .first()
            .map_or_else(Vec::new, |first| ranking(&first.cx.problem, first.cx.gripper(), scene, &objects));
        Self {
            targets,
            scene,
            q: q.clone(),
            lifted,
            rng,
            alive,
            cursor: 0,
            round: 0,
            branches: Vec::new(),
            found: Vec::new(),
            handed_out: 0,
        }
    }

    /// How many grasps were looked at, of all targets.
    pub(super) fn tried(&self) -> Tried {
        self.targets.iter().fold(Tried::default(), |sum, target| sum + target.tried)
    }

    /// The targets with what came of them, but for the one that was `taken`.
    pub(super) fn passed_over(&self, taken: Option<usize>) -> Vec<PassedOver> {
        let others = self.targets.iter().enumerate().filter(|(number, _)| Some(*number) != taken);
        others
            .map(|(_, target)| PassedOver {
                object: target.cx.object,
                name: target.cx.object_name().to_owned(),
                tried: target.tried,
                rejections: target.rejections.clone(),
            })
            .collect()
    }

    /// Takes a grasp out of the search; the other picks found are handed out again.
    pub(super) fn drop_grasp(&mut self, target: usize, grasp: usize) {
        self.found.retain(|pick| (pick.target, pick.grasp) != (target, grasp));
        self.handed_out = 0;
        self.branches.retain(|(t, g, _)| (*t, *g) != (target, grasp));
        if let Some(position) = self.alive.iter().position(|&known| known == (target, grasp)) {
            self.alive.remove(position);
            if position < self.cursor {
                self.cursor -= 1;
            }
        }
    }

    /// The next branch to try; `Ok(None)` when a grasp was rejected, `Err` when all are through.
    fn next_branch(&mut self) -> Result<Option<(usize, usize, Vec<f64>)>, ()> {
        if let Some(branch) = self.branches.pop() {
            return Ok(Some(branch));
        }
        let Some(GoalContext { problem: Manipulation { arm, .. }, options, .. }) =
            self.targets.first().map(|target| target.cx)
        else {
            return Err(());
        };
        let rounds = if arm.free_variables().is_empty() { 1 } else { options.free_samples as usize };
        if self.cursor >= self.alive.len() {
            self.round += 1;
            self.cursor = 0;
        }
        if self.round >= rounds || self.alive.is_empty() {
            return Err(());
        }
        let (number, index) = self.alive[self.cursor];
        let target = &mut self.targets[number];
        let cx = target.cx;
        let grasp = &target.set.grasps[index];
        target.tried.looked_at += usize::from(self.round == 0);
        let world_from_tool = self.scene.world_from_body(cx.body()) * grasp.object_from_tool;
        if self.round == 0
            && let Err((filter, cause)) = hand_check(&cx, self.scene, grasp, &world_from_tool)
        {
            target.rejections.add_because(filter, cause);
            self.alive.remove(self.cursor);
            return Ok(None);
        }
        self.cursor += 1;
        let near = cx.arm_values(&self.q);
        let free = free_values(&cx, self.round, &near, &mut self.rng);
        let mut scratch = IkSolutions::new();
        let (solutions, outside) = arm.inverse(&world_from_tool, &free, &near, &mut scratch);
        if solutions.is_empty() {
            target.rejections.add(if outside > 0 { Filter::GraspLimits } else { Filter::GraspOutOfReach });
            return Ok(None);
        }
        let best = solutions.into_iter().take(options.branches);
        self.branches = best.map(|q| (number, index, q)).rev().collect();
        Ok(None)
    }

    /// All straight motions of one branch.
    fn check(&mut self, number: usize, index: usize, at: &[f64]) -> Result<Pick, (Filter, Option<Cause>)> {
        let (cx, set) = (self.targets[number].cx, self.targets[number].set);
        let grasp = &set.grasps[index];
        let because = |filter| move |cause| (filter, Some(cause));
        let open = cx.with_fingers(&self.q, &cx.gripper().preshapes[grasp.preshape].values);
        state_is_free(&mut fine_checker(&cx, self.scene, &open, cx.touching()), at)
            .map_err(because(Filter::ArmAtGrasp))?;
        let world_from_object = self.scene.world_from_body(cx.body());
        let direction: Vector3<f64> = -(world_from_object.rotation * grasp.approach_in_object.into_inner());
        let mut approach =
            back_off(&cx, self.scene, &open, at, &direction).map_err(because(Filter::Approach))?;
        approach.reverse();
        // The arm comes with its fingers as they are now, and opens them before the approach.
        let far = &approach[0];
        let now = self.q.select(&cx.gripper().dofs);
        let preshape = &cx.gripper().preshapes[grasp.preshape].values;
        state_is_free(&mut fine_checker(&cx, self.scene, &self.q, cx.free(None)), far)
            .and_then(|()| fingers_move(&cx, self.scene, &self.q, far, &now, preshape, cx.free(None)))
            .map_err(because(Filter::Approach))?;
        fingers_move(&cx, self.scene, &self.q, at, preshape, &grasp.closed, cx.touching())
            .map_err(because(Filter::ClosedHand))?;

        let closed = cx.with_fingers(&self.q, &grasp.closed);
        let rules = cx.standing(cx.grip(&grasp.object_from_tool));
        state_is_free(&mut fine_checker(&cx, self.scene, &closed, rules.clone()), at)
            .map_err(because(Filter::Lift))?;
        let lift = raise(&cx, self.scene, &closed, at, &rules).map_err(because(Filter::Lift))?;

        if self.lifted == Lifted::TakenAway {
            return match self.targets[number].somewhere_free(self.scene, grasp) {
                true => Ok(Pick { target: number, grasp: index, approach, lift, placing: None }),
                false => Err((Filter::Destination, None)),
            };
        }
        let upright = kept_upright(&cx, grasp);
        let mut placings = placings(&cx, self.scene, grasp, &lift[lift.len() - 1], &self.q);
        placings.constraint = upright.as_ref().map(|u| u as _);
        let target = &mut self.targets[number];
        let mut sampler = PlacingSampler {
            placings: &mut placings,
            destinations: &mut target.destinations,
            rejections: &mut target.rejections,
            rng: &mut self.rng,
            handed_out: 0,
        };
        for _ in 0..cx.options.placings {
            match sampler.try_next() {
                Some(true) => break,
                Some(false) => {}
                None => break,
            }
        }
        match placings.found.pop() {
            Some(placing) => {
                Ok(Pick { target: number, grasp: index, approach, lift, placing: Some(placing) })
            }
            None => Err((Filter::Destination, None)),
        }
    }
}

impl Target<'_> {
    /// Whether the object and the gripper, without the arm, are free at one destination at least.
    fn somewhere_free(&mut self, scene: &Scene, grasp: &Grasp) -> bool {
        let Self { cx, destinations, rejections, .. } = self;
        (0..destinations.counts()[0]).any(|index| {
            let world_from_tool = destinations.pose(index) * grasp.object_from_tool;
            let Some(there) = destinations.scene(index, cx, scene, rejections) else { return false };
            match hand_is_free(cx, there, grasp, &world_from_tool) {
                Ok(()) => true,
                Err(cause) => {
                    rejections.add_because(Filter::HandAtDestination, cause);
                    false
                }
            }
        })
    }
}

impl GoalSampler for PickSampler<'_, '_> {
    fn draw(&mut self, budget: &Budget<'_>) -> Result<GoalDraw, Interrupt> {
        budget.check()?;
        if self.handed_out == self.found.len() {
            match self.next_branch() {
                Err(()) => return Ok(GoalDraw::Exhausted),
                Ok(None) => return Ok(GoalDraw::Pending),
                Ok(Some((number, index, at))) => match self.check(number, index, &at) {
                    Ok(pick) => {
                        self.targets[number].tried.usable += 1;
                        self.found.push(pick);
                    }
                    Err((filter, cause)) => {
                        let rejections = &mut self.targets[number].rejections;
                        match cause {
                            Some(cause) => rejections.add_because(filter, cause),
                            None => rejections.add(filter),
                        }
                        return Ok(GoalDraw::Pending);
                    }
                },
            }
        }
        let goal = self.found[self.handed_out].approach[0].clone();
        self.handed_out += 1;
        Ok(GoalDraw::Goal(goal))
    }
}

/// Whether the gripper alone is free at a grasp and on its approach, open and closed.
pub(super) fn hand_check(
    cx: &GoalContext<'_>,
    scene: &Scene,
    grasp: &Grasp,
    world_from_tool: &Pose,
) -> Result<(), (Filter, Cause)> {
    hand_is_free(cx, scene, grasp, world_from_tool).map_err(|r| (Filter::HandAtGrasp, r))?;
    hand_at(cx, scene, &grasp.closed, world_from_tool, &cx.touching()).map_err(|r| (Filter::ClosedHand, r))
}

/// A search for placings of the object held by `grasp`, with the arm coming from `near`.
pub(super) fn placings<'a, 's>(
    cx: &GoalContext<'a>,
    scene: &'s Scene,
    grasp: &'s Grasp,
    near: &[f64],
    q: &Configuration,
) -> Placings<'a, 's> {
    Placings {
        cx: *cx,
        scene,
        grasp,
        near: near.to_vec(),
        q: q.clone(),
        constraint: None,
        next: 0,
        branches: Vec::new(),
        found: Vec::new(),
    }
}

/// The constraint to keep the object within `tilt` of upright while held by `grasp`.
pub(super) fn upright<'a>(cx: &GoalContext<'a>, grasp: &Grasp, tilt: f64) -> Upright<'a> {
    Upright { arm: cx.problem.arm, tool_from_object: grasp.object_from_tool.inverse(), tilt }
}

/// Whether the open gripper alone, backed off along the approach by the contact distance and by the whole approach, and
/// at the grasp itself (where it may touch the object), is free (thesis algorithm 3.4).
pub(super) fn hand_is_free(
    cx: &GoalContext<'_>,
    scene: &Scene,
    grasp: &Grasp,
    world_from_tool: &Pose,
) -> Result<(), Cause> {
    let open = &cx.gripper().preshapes[grasp.preshape].values;
    hand_at(cx, scene, open, world_from_tool, &cx.touching())?;
    let clear = Rules { target: None, ..cx.touching() };
    let options = cx.options;
    let object_from_tool = &grasp.object_from_tool;
    let approach_in_tool = object_from_tool.rotation.inverse() * grasp.approach_in_object.into_inner();
    let spread = options.approach - options.contact;
    for fraction in [0.0, 0.5, 1.0] {
        let mut backed_off = *world_from_tool;
        let distance = options.contact + fraction * spread;
        backed_off.translation.vector -= world_from_tool.rotation * approach_in_tool * distance;
        hand_at(cx, scene, open, &backed_off, &clear)?;
    }
    Ok(())
}

/// Whether the gripper alone is free with its tool frame at `world_from_tool` and its fingers at `fingers`.
fn hand_at(
    cx: &GoalContext<'_>,
    scene: &Scene,
    fingers: &[f64],
    world_from_tool: &Pose,
    rules: &Rules,
) -> Result<(), Cause> {
    let gripper = cx.gripper();
    let kinematics = cx.problem.kinematics;
    let q = cx.with_fingers(cx.problem.start, fingers);
    let mut poses = LinkPoses::default();
    kinematics.link_poses(&q, &mut poses);
    // Carry the whole robot along, so that its palm is where the tool wants it; only the gripper is looked at.
    let world_from_palm = world_from_tool * gripper.palm_from_tool.inverse();
    let world_from_root = world_from_palm * poses.root_from(gripper.palm).inverse();
    let free = scene.against_bodies(&world_from_root, &poses, &Movers::of(cx.gripper_links), rules, 0.0);
    free.map(|_| ()).map_err(|touch| cause(scene, touch.into()))
}
