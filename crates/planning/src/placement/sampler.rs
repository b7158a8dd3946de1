//! Goal configurations of a robot with a base (thesis algorithm 3.11).

use std::collections::BTreeMap;
use std::fmt;

use robotc_core::rng::Rng;
use robotc_core::{Pose, Seed};
use serde::{Deserialize, Serialize};

use super::distribution::BaseDistribution;
use crate::budget::{Budget, Interrupt};
use crate::edge::Obstruction;
use crate::goal::{GoalDraw, GoalSampler};

/// An arm that may do the work. Arms may overlap: the same chain with and without the joints of the torso.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacementArm {
    /// Cost of its inverse kinematics, positive; arms are chosen in proportion to one over it.
    pub cost: f64,
    /// `world_from_tool` of every grasp of every target that this arm can make.
    pub grasps: Vec<Pose>,
}

/// The robot and its surroundings, as far as placing the base needs them.
pub trait PlacementProblem {
    /// Whether the gripper alone may be at a grasp; asked once for each that is drawn.
    fn grasp_is_free(&mut self, arm: usize, grasp: usize) -> Result<(), Obstruction>;

    /// Whether the links that move with the base, but not with the arm, are free. Asked before any inverse kinematics.
    fn base_is_free(&mut self, arm: usize, base: &[f64; 3]) -> Result<(), Obstruction>;

    /// Configurations of the whole robot within the limits, with the base at `base` and the tool at `world_from_tool`.
    fn solutions(&mut self, arm: usize, base: &[f64; 3], world_from_tool: &Pose) -> Vec<Vec<f64>>;

    /// Whether a configuration is free.
    fn is_free(&mut self, q: &[f64]) -> Result<(), Obstruction>;
}

/// Parameters of the sampling.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct PlacementOptions {
    /// Places tried for each draw; what is not found by then is pending.
    pub places: u32,
    /// Places after which there are no more goals.
    pub max_places: u32,
}

impl Default for PlacementOptions {
    fn default() -> Self {
        Self { places: 20, max_places: 50_000 }
    }
}

/// So many draws that give no place count as one: they take that much less time.
const UNDRAWN: u32 = 100;

/// What is behind a goal.
#[derive(Debug, Clone, PartialEq)]
pub struct Placement {
    /// Position of the arm.
    pub arm: usize,
    /// Position among the grasps of the arm.
    pub grasp: usize,
    /// x, y and heading of the base.
    pub base: [f64; 3],
    /// The whole configuration.
    pub q: Vec<f64>,
}

/// What each filter rejected.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct PlacementRejections {
    /// Places tried.
    pub places: u32,
    /// Grasps at which the gripper is not free.
    pub grasps: u32,
    /// Grasps that are out of reach from everywhere.
    pub hopeless: u32,
    /// Times that no place was drawn for a grasp, and another grasp was chosen.
    pub undrawn: u32,
    /// Places where the base is not free.
    pub bases: u32,
    /// Places from which the grasp is out of reach after all.
    pub out_of_reach: u32,
    /// Configurations that are not free.
    pub configurations: u32,
    /// What touched.
    pub blocked: BTreeMap<Obstruction, u32>,
}

impl fmt::Display for PlacementRejections {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} places tried; grasps not free: {}, out of reach: {}; bases not free: {}; no inverse kinematics: {}; \
             configurations not free: {}",
            self.places, self.grasps, self.hopeless, self.bases, self.out_of_reach, self.configurations
        )
    }
}

/// Arms, grasps and places of the base, in proportion to how well the arms reach them; a sampler that never repeats a
/// rejected grasp and can be resumed.
pub struct BasePlacement<'a, P: ?Sized, D: ?Sized> {
    problem: &'a mut P,
    distribution: &'a mut D,
    arms: &'a [PlacementArm],
    options: PlacementOptions,
    rng: Rng,
    /// Grasps that are left, as arm, number and weight.
    left: Vec<(usize, usize, f64)>,
    /// Whether each of them was found free.
    checked: Vec<bool>,
    /// What is behind the goals handed out, in their order.
    pub placements: Vec<Placement>,
    /// What was rejected so far.
    pub rejections: PlacementRejections,
}

impl<'a, P: PlacementProblem + ?Sized, D: BaseDistribution + ?Sized> BasePlacement<'a, P, D> {
    /// Goals of these arms.
    pub fn new(
        problem: &'a mut P,
        distribution: &'a mut D,
        arms: &'a [PlacementArm],
        options: PlacementOptions,
        seed: Seed,
    ) -> Self {
        let mut rejections = PlacementRejections::default();
        let mut left = Vec::new();
        for (number, arm) in arms.iter().enumerate() {
            let masses: Vec<f64> = arm.grasps.iter().map(|g| distribution.mass(number, g)).collect();
            let sum: f64 = masses.iter().sum();
            for (grasp, mass) in masses.into_iter().enumerate() {
                if mass > 0.0 {
                    left.push((number, grasp, mass / sum / arm.cost.max(f64::MIN_POSITIVE)));
                } else {
                    rejections.hopeless += 1;
                }
            }
        }
        let checked = vec![false; left.len()];
        let placements = Vec::new();
        Self { problem, distribution, arms, options, rng: seed.rng(), left, checked, placements, rejections }
    }

    /// A grasp in proportion to the weights.
    fn choose(&mut self) -> usize {
        let sum: f64 = self.left.iter().map(|g| g.2).sum();
        let mut at = self.rng.unit() * sum;
        for (i, grasp) in self.left.iter().enumerate() {
            at -= grasp.2;
            if at < 0.0 {
                return i;
            }
        }
        self.left.len() - 1
    }

    /// One place; a goal if it is one.
    fn try_place(&mut self) -> Option<Placement> {
        let chosen = self.choose();
        let (arm, grasp, _) = self.left[chosen];
        if !self.checked[chosen] {
            let free = self.problem.grasp_is_free(arm, grasp);
            self.checked[chosen] = true;
            if let Err(by) = free {
                self.reject(by);
                self.rejections.grasps += 1;
                self.left.swap_remove(chosen);
                self.checked.swap_remove(chosen);
                return None;
            }
        }
        let world_from_tool = &self.arms[arm].grasps[grasp];
        let Some(base) = self.distribution.draw(arm, world_from_tool, &mut self.rng) else {
            self.rejections.undrawn += 1;
            return None;
        };
        self.rejections.places += 1;
        if let Err(by) = self.problem.base_is_free(arm, &base) {
            self.reject(by);
            self.rejections.bases += 1;
            return None;
        }
        let solutions = self.problem.solutions(arm, &base, world_from_tool);
        if solutions.is_empty() {
            self.rejections.out_of_reach += 1;
        }
        for q in solutions {
            match self.problem.is_free(&q) {
                Ok(()) => return Some(Placement { arm, grasp, base, q }),
                Err(by) => {
                    self.reject(by);
                    self.rejections.configurations += 1;
                }
            }
        }
        None
    }

    /// Draws until there is another place to stand: x, y and heading of the base. `None` when no more are drawn.
    pub fn next_base(&mut self, budget: &Budget<'_>) -> Result<Option<[f64; 3]>, Interrupt> {
        loop {
            match self.draw(budget)? {
                GoalDraw::Pending => {}
                GoalDraw::Goal(_) => return Ok(self.placements.last().map(|placement| placement.base)),
                GoalDraw::Exhausted => return Ok(None),
            }
        }
    }

    fn reject(&mut self, by: Obstruction) {
        *self.rejections.blocked.entry(by).or_insert(0) += 1;
    }
}

impl<P: PlacementProblem + ?Sized, D: BaseDistribution + ?Sized> GoalSampler for BasePlacement<'_, P, D> {
    fn draw(&mut self, budget: &Budget<'_>) -> Result<GoalDraw, Interrupt> {
        let end = self.rejections.places.saturating_add(self.options.places.max(1));
        while self.rejections.places < end {
            budget.check()?;
            let drawn = self.rejections.places.saturating_add(self.rejections.undrawn / UNDRAWN);
            if self.left.is_empty() || drawn >= self.options.max_places {
                return Ok(GoalDraw::Exhausted);
            }
            if let Some(placement) = self.try_place() {
                let q = placement.q.clone();
                self.placements.push(placement);
                return Ok(GoalDraw::Goal(q));
            }
        }
        Ok(GoalDraw::Pending)
    }
}
