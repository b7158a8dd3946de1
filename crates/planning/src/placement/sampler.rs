//! Goal configurations of a robot with a base (thesis algorithm 3.11).

use std::collections::BTreeMap;
use std::fmt;

use robotc_core::rng::Rng;
use robotc_core::{Pose, Seed};
use serde::{Deserialize, Serialize};

use super::distribution::{BaseDistribution, Stand};
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

    /// Of places that come with a posture, what is certainly touched with it from each, if anything: these are not looked at any more.
    /// Asked before anything else. Without a cheap answer there is none.
    fn sift(&mut self, stands: &[Stand]) -> Vec<Option<Obstruction>> {
        vec![None; stands.len()]
    }

    /// Configurations of the whole robot within the limits, with the base at a place and the tool at `world_from_tool`; those near
    /// the posture first, where there is one.
    fn solutions(&mut self, arm: usize, stand: &Stand, world_from_tool: &Pose) -> Vec<Vec<f64>>;

    /// Whether a configuration is free.
    fn is_free(&mut self, q: &[f64]) -> Result<(), Obstruction>;

    /// The first of these configurations that is free, and what is in the way of those before it.
    fn first_free(&mut self, all: &[Vec<f64>]) -> (Option<usize>, Vec<Obstruction>) {
        let mut blocked = Vec::new();
        for (i, q) in all.iter().enumerate() {
            match self.is_free(q) {
                Ok(()) => return (Some(i), blocked),
                Err(by) => blocked.push(by),
            }
        }
        (None, blocked)
    }
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

/// Places with a posture that are looked at together: as many as the widest lanes take.
const TOGETHER: usize = 16;

/// Of these, those for the same grasp: to find how well a grasp is reached takes as long as many draws.
const EACH: usize = 4;

/// Grasps are compared with the best one, which is found again whenever so many were chosen.
const WEIGHED: u32 = 16;

/// A posture is only near one that reaches, and what is in the way of the one may not be in the way of the other. So of every so many
/// places one is tried in any case.
const UNSIFTED: u32 = 128;

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
    /// Places from which the arm would certainly touch something in the posture that they came with.
    pub sifted: u32,
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
            self.places,
            self.grasps,
            self.hopeless,
            self.bases,
            self.out_of_reach,
            self.sifted + self.configurations
        )
    }
}

/// Arms, grasps and places of the base, in proportion to how well the arms reach them; a sampler that never repeats a
/// rejected grasp and can be resumed.
///
/// How well a grasp is reached is found when it is drawn for the first time, and then compared with the best one so far. What obstacles
/// leave of that is learned: a grasp counts by the share of its places that were goals, too.
pub struct BasePlacement<'a, P: ?Sized, D: ?Sized> {
    problem: &'a mut P,
    distribution: &'a mut D,
    arms: &'a [PlacementArm],
    options: PlacementOptions,
    rng: Rng,
    left: Vec<Left>,
    /// For each arm and each grasp.
    tallies: Vec<Vec<Tally>>,
    /// Places that came with a posture and are still to be tried, last one first.
    stands: Vec<(usize, usize, Stand)>,
    /// How many grasps were chosen.
    choices: u32,
    /// How many places were drawn with a posture.
    drawn: u32,
    /// What is behind the goals handed out, in their order.
    pub placements: Vec<Placement>,
    /// What was rejected so far.
    pub rejections: PlacementRejections,
}

/// What is left of an arm.
struct Left {
    arm: usize,
    grasps: Vec<LeftGrasp>,
    /// The largest worth that was found: mass, times the share of places that are goals.
    most: f64,
}

/// A grasp that was not rejected.
struct LeftGrasp {
    grasp: usize,
    /// Once it is known.
    mass: Option<f64>,
    /// Whether the gripper was found free.
    checked: bool,
}

/// What came of the places of a grasp.
#[derive(Debug, Clone, Copy, Default)]
struct Tally {
    places: u32,
    goals: u32,
}

impl Tally {
    /// The share of them that are goals; that of one more, as long as little is known.
    fn share(self) -> f64 {
        f64::from(self.goals + 1) / f64::from(self.places + 1)
    }
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
        let grasps = |arm: &PlacementArm| {
            let unknown = |grasp| LeftGrasp { grasp, mass: None, checked: false };
            (0..arm.grasps.len()).map(unknown).collect()
        };
        let left =
            arms.iter().enumerate().map(|(number, arm)| Left { arm: number, grasps: grasps(arm), most: 0.0 });
        Self {
            problem,
            distribution,
            arms,
            options,
            rng: seed.rng(),
            tallies: arms.iter().map(|arm| vec![Tally::default(); arm.grasps.len()]).collect(),
            left: left.filter(|left| !left.grasps.is_empty()).collect(),
            stands: Vec::new(),
            choices: 0,
            drawn: 0,
            placements: Vec::new(),
            rejections: PlacementRejections::default(),
        }
    }

    /// Position of an arm among those that are left.
    fn choose_arm(&mut self) -> usize {
        if self.left.len() == 1 {
            return 0;
        }
        let weight = |left: &Left| 1.0 / self.arms[left.arm].cost.max(f64::MIN_POSITIVE);
        let mut at = self.rng.unit() * self.left.iter().map(weight).sum::<f64>();
        let chosen = self.left.iter().position(|left| {
            at -= weight(left);
            at < 0.0
        });
        chosen.unwrap_or(self.left.len() - 1)
    }

    /// Finds the best grasps again, as far as grasps are known: what is worth less and less would be compared with what it was once.
    fn weigh(&mut self) {
        for Left { arm, grasps, most } in &mut self.left {
            let tallies = &self.tallies[*arm];
            let worth = |g: &LeftGrasp| g.mass.map(|mass| mass * tallies[g.grasp].share());
            *most = grasps.iter().filter_map(worth).fold(0.0, f64::max);
        }
    }

    /// An arm and a grasp of it that the gripper may take; `None` when none are left.
    fn choose(&mut self) -> Option<(usize, usize)> {
        self.choices = self.choices.wrapping_add(1);
        if self.choices.is_multiple_of(WEIGHED) {
            self.weigh();
        }
        while !self.left.is_empty() {
            let number = self.choose_arm();
            let chosen = self.rng.below(self.left[number].grasps.len());
            let left = &mut self.left[number];
            let (arm, LeftGrasp { grasp, mass, checked }) = (left.arm, &mut left.grasps[chosen]);
            let grasp = *grasp;
            let world_from_tool = &self.arms[arm].grasps[grasp];
            let known = *mass.get_or_insert_with(|| self.distribution.mass(arm, world_from_tool));
            let worth = known * self.tallies[arm][grasp].share();
            left.most = left.most.max(worth);
            let mut gone = known <= 0.0;
            if gone {
                self.rejections.hopeless += 1;
            } else if self.rng.unit() * left.most > worth {
                continue;
            } else if !*checked {
                *checked = true;
                if let Err(by) = self.problem.grasp_is_free(arm, grasp) {
                    gone = true;
                    self.rejections.grasps += 1;
                    self.reject(by);
                }
            }
            if !gone {
                return Some((arm, grasp));
            }
            self.left[number].grasps.swap_remove(chosen);
            if self.left[number].grasps.is_empty() {
                self.left.swap_remove(number);
            }
        }
        None
    }

    /// Another place with its arm and its grasp; `None` when none was drawn, or when none of those drawn is worth trying. Places
    /// with a posture are drawn and sifted together.
    fn next_stand(&mut self) -> Option<(usize, usize, Stand)> {
        if self.stands.is_empty() {
            self.draw_stands();
        }
        let next = self.stands.pop()?;
        self.rejections.places += 1;
        self.tallies[next.0][next.1].places += 1;
        Some(next)
    }

    /// Draws places that are worth trying, last one first.
    fn draw_stands(&mut self) {
        let (mut stands, mut of) = (Vec::new(), Vec::new());
        'drawing: while stands.len() < TOGETHER {
            let Some((arm, grasp)) = self.choose() else { break };
            let world_from_tool = &self.arms[arm].grasps[grasp];
            for _ in 0..EACH {
                let Some(stand) = self.distribution.draw(arm, world_from_tool, &mut self.rng) else {
                    self.rejections.undrawn += 1;
                    break 'drawing;
                };
                if stand.posture.is_none() && stands.is_empty() {
                    self.stands.push((arm, grasp, stand));
                    return;
                }
                stands.push(stand);
                of.push((arm, grasp));
            }
        }
        let touched = self.problem.sift(&stands);
        for (((arm, grasp), stand), touched) in of.into_iter().zip(stands).zip(touched).rev() {
            self.drawn = self.drawn.wrapping_add(1);
            let in_any_case = self.drawn.is_multiple_of(UNSIFTED);
            match touched.filter(|_| !in_any_case) {
                None => self.stands.push((arm, grasp, stand)),
                Some(by) => {
                    self.tallies[arm][grasp].places += 1;
                    self.rejections.places += 1;
                    self.rejections.sifted += 1;
                    self.reject(by);
                }
            }
        }
    }

    /// One place; a goal if it is one.
    fn try_place(&mut self) -> Option<Placement> {
        let (arm, grasp, stand) = self.next_stand()?;
        let base = stand.base;
        if let Err(by) = self.problem.base_is_free(arm, &base) {
            self.reject(by);
            self.rejections.bases += 1;
            return None;
        }
        let solutions = self.problem.solutions(arm, &stand, &self.arms[arm].grasps[grasp]);
        if solutions.is_empty() {
            self.rejections.out_of_reach += 1;
        }
        let (free, blocked) = self.problem.first_free(&solutions);
        self.rejections.configurations += blocked.len() as u32;
        blocked.into_iter().for_each(|by| self.reject(by));
        let q = solutions.into_iter().nth(free?)?;
        self.tallies[arm][grasp].goals += 1;
        Some(Placement { arm, grasp, base, q })
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
            if self.stands.is_empty() && (self.left.is_empty() || drawn >= self.options.max_places) {
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
