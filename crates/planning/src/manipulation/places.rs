//! Where a base may stand so that the arm reaches what it has to (thesis algorithm 3.11).

use std::f64::consts::PI;

use robotc_core::ik::IkSolutions;
use robotc_core::rng::Rng;
use robotc_core::{Configuration, Pose, Seed};

use super::driving::Drive;
use super::opening::{ArticleWay, as_grasp};
use super::picks::{hand_check, hand_is_free};
use super::placings::{Destinations, free_values};
use super::problem::GoalContext;
use super::rejections::Rejections;
use super::stretch::{fine_checker, state_is_free};
use crate::edge::{EdgeChecker, Obstruction};
use crate::grasp::Grasp;
use crate::mechanism::Mechanism;
use crate::placement::{BaseDistribution, PlacementProblem, Stand};
use crate::scene::{Grip, RobotChecker, Scene};

/// Draws of a place before the map of the arm's reach is not asked any more.
const DRAWS: usize = 300;

/// Draws after which no place is thought to be within reach of both object and destination.
const SHARED_DRAWS: usize = 3000;

/// Where the tool has to be able to get to.
#[derive(Clone, Default)]
pub(super) struct Targets {
    /// Grasps of what is there now.
    hands: Vec<Grasp>,
    /// `world_from_tool` of each, with the object where it is.
    pub(super) grasps: Vec<Pose>,
    /// The tool in the frame that `destinations` are of, for each, in the same order.
    part_from_tool: Vec<Pose>,
    /// Which of the objects each belongs to, in the same order.
    object: Vec<usize>,
    /// Where the frame of each object gets to: the grasp has to be within reach there, too.
    destinations: Vec<Vec<Pose>>,
}

impl Targets {
    /// Of objects of which any one is to be placed.
    pub(super) fn of_grasps(cx: &GoalContext<'_>, scene: &Scene, seed: Seed) -> Self {
        let mut all = Self::default();
        for (number, cx) in cx.of_targets().iter().enumerate() {
            let world_from_object = scene.world_from_body(cx.body());
            for grasp in &cx.problem.grasps[cx.object].grasps {
                all.hands.push(grasp.clone());
                all.grasps.push(world_from_object * grasp.object_from_tool);
                all.part_from_tool.push(grasp.object_from_tool);
                all.object.push(number);
            }
            all.destinations.push(cx.destination().map_or_else(Vec::new, |destination| {
                super::destination_poses(destination, cx.options.destinations, &mut seed.rng())
            }));
        }
        all
    }

    /// The same grasps, wherever what they hold is going.
    pub(super) fn without_destinations(self) -> Self {
        Self { destinations: vec![vec![]; self.destinations.len()], ..self }
    }

    /// Of an object in the hand: its destinations.
    pub(super) fn of_destinations(grasp: &Grasp, destinations: &Destinations) -> Self {
        let count = destinations.counts()[0];
        let pose = |index| destinations.pose(index) * grasp.object_from_tool;
        Self {
            hands: vec![grasp.clone(); count],
            grasps: (0..count).map(pose).collect(),
            part_from_tool: vec![grasp.object_from_tool; count],
            object: vec![0; count],
            destinations: vec![vec![]],
        }
    }

    /// Of an article that is to be moved: its handle goes all the way.
    pub(super) fn of_grips(cx: &GoalContext<'_>, scene: &Scene, way: ArticleWay) -> Self {
        let article = &cx.problem.task.articles[way.article];
        let cages = cx.problem.cages.get(way.article).copied().unwrap_or_default();
        let usable = cages.iter().filter(|cage| cage.hold.moves(way.to > way.from));
        let part_from_tool: Vec<Pose> = usable.clone().map(|cage| cage.grasp.part_from_tool).collect();
        let Some(mechanism) = Mechanism::of_article(article) else {
            return Self::default();
        };
        let now = mechanism.world_from_part(way.from);
        let hands = usable.map(|cage| as_grasp(cx, scene, cage, &now)).collect();
        let grasps: Vec<Pose> = part_from_tool.iter().map(|tool| now * tool).collect();
        let at = |share: f64| mechanism.world_from_part(way.from + share * (way.to - way.from));
        let object = vec![0; grasps.len()];
        Self { hands, grasps, part_from_tool, object, destinations: vec![[0.5, 1.0].map(at).into()] }
    }
}

/// Bases from which the map of the arm's reach says that a grasp and, with it, a destination are within reach.
pub(super) struct ReachedBases<'c, 'a> {
    pub(super) cx: &'c GoalContext<'a>,
    pub(super) drive: &'c Drive,
    pub(super) targets: &'c Targets,
}

impl ReachedBases<'_, '_> {
    /// How well the arm of a robot whose base stands at `base` reaches a pose of the tool; without a map, 1 within its length.
    fn density(&self, base: &[f64; 3], world_from_tool: &Pose) -> f64 {
        let problem = &self.cx.problem;
        let mut q = problem.start.clone();
        q.set(&self.drive.dofs, base);
        let base_from_tool = problem.world_from_arm(&q).inv_mul(world_from_tool);
        match problem.reachability {
            Some(map) => map.density(&(base_from_tool * problem.arm.tool_from_tip())),
            None => f64::from(base_from_tool.translation.vector.norm() <= problem.arm.reach()),
        }
    }

    /// Any place within the arm's reach of a pose of the tool.
    fn around(&self, world_from_tool: &Pose, rng: &mut Rng) -> [f64; 3] {
        let problem = &self.cx.problem;
        let at = problem.scene.world_from_robot().inv_mul(world_from_tool).translation.vector;
        let (distance, angle) = (problem.arm.reach() * rng.unit().sqrt(), rng.range(-PI, PI));
        let (x, y) = (at.x + distance * libm::cos(angle), at.y + distance * libm::sin(angle));
        [x, y, rng.range(-PI, PI)]
    }

    /// Whether a destination, drawn at random, is within reach from `base` with this grasp.
    fn puts_down(&self, base: &[f64; 3], grasp: usize, rng: &mut Rng) -> bool {
        let Targets { part_from_tool, object, destinations, .. } = self.targets;
        let destinations = &destinations[object[grasp]];
        let reached = |at: &Pose| self.density(base, &(at * part_from_tool[grasp])) > 0.0;
        destinations.is_empty() || reached(&destinations[rng.below(destinations.len())])
    }

    /// Whether the map knows a place from which a grasp and a destination are both within reach.
    pub(super) fn share_a_place(&self, rng: &mut Rng) -> bool {
        let grasps = &self.targets.grasps;
        (0..if grasps.is_empty() { 0 } else { SHARED_DRAWS }).any(|_| {
            let grasp = rng.below(grasps.len());
            let base = self.around(&grasps[grasp], rng);
            self.density(&base, &grasps[grasp]) > 0.0 && self.puts_down(&base, grasp, rng)
        })
    }
}

impl BaseDistribution for ReachedBases<'_, '_> {
    fn mass(&mut self, _: usize, _: &Pose) -> f64 {
        1.0
    }

    fn draw(&mut self, _: usize, world_from_tool: &Pose, rng: &mut Rng) -> Option<Stand> {
        let grasp = self.targets.grasps.iter().position(|grasp| grasp == world_from_tool)?;
        let mut last = None;
        for _ in 0..DRAWS {
            let base = self.around(world_from_tool, rng);
            last = Some(base);
            if self.density(&base, world_from_tool) > 0.0 && self.puts_down(&base, grasp, rng) {
                return Some(Stand::at(base));
            }
        }
        // A coarse map may be wrong.
        last.map(Stand::at)
    }
}

/// The robot and its surroundings, as far as placing the base needs them.
pub(super) struct Standing<'c, 'a> {
    /// The goal, for each of its objects.
    cxs: Vec<GoalContext<'a>>,
    scene: &'c Scene,
    targets: &'c Targets,
    /// What is in the hand already, to be put down: poses of the tool are those of its destinations.
    load: Option<Unloading>,
    drive: &'c Drive,
    folded: &'c Configuration,
    rng: Rng,
    /// The object that was asked about last.
    object: usize,
}

/// An object in the hand, and where it may go.
pub(super) struct Unloading {
    pub(super) grip: Grip,
    pub(super) destinations: Destinations,
    /// Destinations that are occupied.
    pub(super) rejections: Rejections,
}

impl<'c, 'a> Standing<'c, 'a> {
    /// The robot with its arm as in `folded`; what it holds is one object, the one of `cx`.
    pub(super) fn new(
        cx: &GoalContext<'a>,
        scene: &'c Scene,
        targets: &'c Targets,
        load: Option<Unloading>,
        drive: &'c Drive,
        folded: &'c Configuration,
        rng: Rng,
    ) -> Self {
        let cxs = if load.is_some() { vec![*cx] } else { cx.of_targets() };
        Self { cxs, scene, targets, load, drive, folded, rng, object: 0 }
    }

    fn cx(&self) -> &GoalContext<'a> {
        &self.cxs[self.object]
    }

    fn at(&self, base: &[f64; 3]) -> Configuration {
        let mut q = self.folded.clone();
        q.set(&self.drive.dofs, base);
        q
    }

    fn grip(&self) -> Option<Grip> {
        self.load.as_ref().map(|load| load.grip.clone())
    }
}

impl PlacementProblem for Standing<'_, '_> {
    fn grasp_is_free(&mut self, _: usize, number: usize) -> Result<(), Obstruction> {
        self.object = self.targets.object[number];
        let Self { cxs, scene, targets, load, object, .. } = self;
        let (cx, grasp) = (&cxs[*object], &targets.hands[number]);
        let free = match load {
            None => {
                let world_from_tool = scene.world_from_body(cx.body()) * grasp.object_from_tool;
                hand_check(cx, scene, grasp, &world_from_tool).is_ok()
            }
            Some(Unloading { destinations, rejections, .. }) => {
                let world_from_tool = destinations.pose(number) * grasp.object_from_tool;
                let there = destinations.scene(number, cx, scene, rejections);
                there.is_some_and(|there| hand_is_free(cx, there, grasp, &world_from_tool).is_ok())
            }
        };
        if free { Ok(()) } else { Err(Obstruction::Constraint) }
    }

    fn base_is_free(&mut self, _: usize, base: &[f64; 3]) -> Result<(), Obstruction> {
        let (cx, scene, drive, folded) = (self.cx(), self.scene, self.drive, self.folded);
        let (rules, resolution) = (cx.free(self.grip()), cx.options.resolution);
        let mut checker = RobotChecker::new(scene, &drive.space, &drive.dofs, folded, rules, resolution);
        checker.state(base).map(|_| ())
    }

    fn solutions(&mut self, _: usize, stand: &Stand, world_from_tool: &Pose) -> Vec<Vec<f64>> {
        let base = &stand.base;
        if let Some(grasp) = self.targets.grasps.iter().position(|grasp| grasp == world_from_tool) {
            self.object = self.targets.object[grasp];
        }
        let cx = *self.cx();
        let arm = cx.problem.arm_at(&self.at(base));
        let near = cx.arm_values(self.folded);
        let rounds = if arm.free_variables().is_empty() { 1 } else { cx.options.free_samples as usize };
        let mut scratch = IkSolutions::new();
        let mut found = Vec::new();
        for round in 0..rounds {
            let free = free_values(&cx, round, &near, &mut self.rng);
            let (solutions, _) = arm.inverse(world_from_tool, &free, &near, &mut scratch);
            found.extend(solutions.into_iter().map(|q| [base.as_slice(), &q].concat()));
        }
        found
    }

    fn is_free(&mut self, q: &[f64]) -> Result<(), Obstruction> {
        let (base, arm) = q.split_at(3);
        let stands = self.at(&[base[0], base[1], base[2]]);
        let cx = self.cx();
        let (q, rules) = match self.grip() {
            None => (cx.with_fingers(&stands, &cx.gripper().preshapes[0].values), cx.touching()),
            // The fingers are closed since the object was taken.
            Some(grip) => (stands, cx.standing(grip)),
        };
        state_is_free(&mut fine_checker(cx, self.scene, &q, rules), arm).map_err(|_| Obstruction::Constraint)
    }
}
