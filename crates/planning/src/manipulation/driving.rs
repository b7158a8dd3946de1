//! Driving to where a goal can be reached from: folded above its footprint, a base goes to a place that is known to be good for
//! the arm (thesis section 3.6).

use std::f64::consts::PI;

use robotc_core::ik::IkSolutions;
use robotc_core::rng::Rng;
use robotc_core::robot::{Base, Robot};
use robotc_core::task::Goal;
use robotc_core::{Configuration, DofIdx, LinkIdx, Pose, Seed};

use super::free_motion::{FreeMotion, start_rules};
use super::maker::Maker;
use super::opening::{ArticleWay, as_grasp};
use super::picks::hand_check;
use super::placings::free_values;
use super::plan::{GoalFailure, SegmentKind, Stage};
use super::problem::{GoalContext, Manipulation, motion_limits};
use super::sequence::Reached;
use super::stretch::{fine_checker, state_is_free};
use crate::budget::Budget;
use crate::edge::{EdgeChecker, Obstruction};
use crate::goal::{FixedGoals, GoalDraw, GoalSampler};
use crate::grasp::Grasp;
use crate::mechanism::Mechanism;
use crate::placement::{
    BaseDistribution, BasePlacement, NavigationPosture, PlacementArm, PlacementOptions, PlacementProblem,
    PostureOptions, Prism, PrismBodies,
};
use crate::rrt::RrtConnect;
use crate::scene::{RobotChecker, Scene};
use crate::smooth::smooth;
use crate::space::{Axis, Space};
use crate::timing::MotionLimits;

/// Places from which a goal is tried.
const PLACES: u64 = 20;

/// Draws of a place before the map of the arm's reach is not asked any more.
const DRAWS: usize = 300;

/// A base that drives by joints of the robot's description: x, y and heading in the frame of its root.
pub(super) struct Drive {
    pub(super) dofs: [DofIdx; 3],
    prism: Prism,
    pub(super) space: Space,
    pub(super) limits: MotionLimits,
}

impl Drive {
    /// `None` for robots that stay where they are.
    pub(super) fn of(robot: &Robot) -> Option<Self> {
        let Base::Planar { footprint, joints: Some(dofs), .. } = &robot.base else { return None };
        let size = footprint.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
        let axis = |(k, &dof): (usize, &DofIdx)| {
            let d = &robot.model.dofs()[dof];
            let weight = if k == 2 { size } else { 1.0 };
            Axis { lower: d.lower, upper: d.upper, wraps: d.continuous, weight }
        };
        Some(Self {
            dofs: *dofs,
            prism: Prism { footprint: footprint.clone(), heights: (f64::NEG_INFINITY, f64::INFINITY) },
            space: Space::new(dofs.iter().enumerate().map(axis).collect()),
            limits: motion_limits(&robot.model, dofs),
        })
    }
}

impl Manipulation<'_> {
    /// The arm as it stands with the base where it is in `q`.
    pub(super) fn arm_at(&self, q: &Configuration) -> crate::arm::ArmModel {
        self.arm.on(self.world_from_arm(q))
    }

    /// Where the base link of the arm is.
    fn world_from_arm(&self, q: &Configuration) -> Pose {
        let base = self.task.robot.arms[self.task.arm].base;
        self.scene.world_from_robot() * self.kinematics.root_from_link(q, base)
    }
}

/// Shares of the draws that searches for a way of a door or a drawer get at each place, stage by stage: what can be opened from a place
/// is mostly opened soon, and another place is worth more than a long search from one that is no good.
const STAGES: [f64; 3] = [0.002, 0.02, 0.1];

/// A place to stand, and how the base gets there.
struct Place {
    path: Vec<Vec<f64>>,
    stands: Configuration,
    seed: Seed,
}

/// Plans a goal that cannot be reached from where the robot stands: folds the arm, drives to one place after the other from which
/// `targets` are within reach, and does `there` what is to be done, which gets the situation at that place. `missed` says why it
/// cannot be done from here.
pub(super) fn plan_driving(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    (missed, targets): (Box<GoalFailure>, Targets),
    budget: &Budget<'_>,
    seed: Seed,
    there: &mut dyn FnMut(&GoalContext<'_>, &Configuration, Seed) -> Result<Reached, Box<GoalFailure>>,
) -> Result<Reached, Box<GoalFailure>> {
    let Some(drive) = Drive::of(cx.robot()) else { return Err(missed) };
    if missed.interrupt.is_some() || missed.stage == Stage::Start {
        return Err(missed);
    }
    let fold = fold(cx, scene, q, &drive, budget, seed.split("fold"))?;
    let mut folded = q.clone();
    folded.set(cx.problem.arm.dofs(), &fold[fold.len() - 1]);
    let arms = [PlacementArm { cost: 1.0, grasps: targets.grasps.clone() }];
    let (hands, rng) = (&targets.hands, seed.split("free").rng());
    let mut standing = Standing { cx, scene, hands, drive: &drive, folded: &folded, rng };
    let mut bases = ReachedBases { cx, drive: &drive, targets: &targets };
    let options = PlacementOptions { places: 20, max_places: 4000 };
    let mut places = BasePlacement::new(&mut standing, &mut bases, &arms, options, seed.split("places"));
    let mut last = missed;
    // Only searches for a way of an article are long or short.
    let stages = if matches!(cx.goal(), Goal::Open { .. }) { &STAGES[..] } else { &STAGES[..1] };
    let mut known: Vec<Place> = Vec::new();
    let mut tried = 0;
    for (stage, share) in stages.iter().enumerate() {
        let mut options = cx.options.clone();
        options.caging_search.max_draws = (share * f64::from(options.caging_search.max_draws)).ceil() as u32;
        let mut number = 0;
        loop {
            if number == known.len() {
                if stage > 0 || tried == PLACES {
                    break;
                }
                match places.draw(budget) {
                    Err(interrupt) => {
                        last.interrupt = Some(interrupt);
                        return Err(last);
                    }
                    Ok(GoalDraw::Pending) => continue,
                    Ok(GoalDraw::Exhausted) => break,
                    Ok(GoalDraw::Goal(_)) => tried += 1,
                }
                let Some(base) = places.placements.last().map(|placement| placement.base) else { break };
                let seed = seed.split("place").at(tried);
                let Some(path) = drive_to(cx, scene, &drive, &folded, &base, budget, seed) else {
                    last.message = "no way to drive to where it can be reached from".into();
                    continue;
                };
                let mut stands = folded.clone();
                stands.set(&drive.dofs, &path[path.len() - 1]);
                known.push(Place { path, stands, seed });
            }
            let Place { path, stands, seed } = &known[number];
            number += 1;
            let arm = cx.problem.arm_at(stands);
            let here =
                GoalContext { problem: Manipulation { arm: &arm, ..cx.problem }, options: &options, ..*cx };
            match there(&here, stands, seed.split("stage").at(stage as u64)) {
                Ok(reached) => {
                    let mut made = Maker::new(cx, q);
                    if fold.len() > 1 {
                        made.arm(SegmentKind::Fold, &fold, scene, start_rules(cx, scene, q, &fold[0]), None);
                    }
                    made.drive(&drive, path, scene);
                    let segments = made.segments.into_iter().chain(reached.segments).collect();
                    return Ok(Reached { segments, ..reached });
                }
                Err(failure) if failure.interrupt.is_some() => return Err(failure),
                Err(failure) => last = failure,
            }
        }
    }
    last.message = format!("{}; {tried} places to stand were tried: {}", last.message, places.rejections);
    Err(last)
}

/// A path of the arm into a posture in which the robot may drive; the start alone when it is in one.
fn fold(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    drive: &Drive,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<Vec<Vec<f64>>, Box<GoalFailure>> {
    let (robot, arm) = (cx.robot(), cx.problem.arm);
    // The prism is in the frame of the base, which is that of the root when the base has not moved.
    let mut at_origin = q.clone();
    at_origin.set(&drive.dofs, &[0.0; 3]);
    let moved = |link: &LinkIdx| arm.dofs().iter().any(|dof| robot.model.dofs_moving(*link).contains(dof));
    let corners = robot.model.links().indices().filter(moved).map(|link| {
        let points = scene.link_parts(link).flat_map(|part| part.points().iter().copied());
        (link, points.collect())
    });
    let bodies = PrismBodies {
        kinematics: cx.problem.kinematics,
        q: at_origin,
        dofs: arm.dofs(),
        corners: corners.collect(),
    };
    let excess = |q: &[f64]| bodies.excess(&drive.prism, q);
    let start = cx.arm_values(q);
    if excess(&start) <= 0.0 {
        return Ok(vec![start]);
    }
    let preset = robot.arms[cx.problem.task.arm].home.clone().unwrap_or_else(|| start.clone());
    let resolution = cx.options.resolution;
    let mut checker = RobotChecker::new(scene, arm.space(), arm.dofs(), q, cx.free(None), resolution);
    let options = PostureOptions::default();
    let mut postures =
        NavigationPosture::new(&mut checker, &excess, &preset, options, seed.split("postures"));
    let rules = start_rules(cx, scene, q, &start);
    let mut motion = FreeMotion { cx, scene, q, rules, constraint: None, kind: SegmentKind::Fold };
    let mut rng = seed.split("search").rng();
    match motion.search(&start, &mut postures, budget, &mut rng, &mut ()) {
        Ok(solution) => Ok(motion.smoothed(solution.path, budget, &mut rng)),
        Err(failure) => {
            let mut missed = motion.failed(&failure);
            missed.message = format!("the arm cannot be folded to drive: {}", missed.message);
            Err(missed)
        }
    }
}

/// A path of the folded robot to a place; `None` when there is none.
fn drive_to(
    cx: &GoalContext<'_>,
    scene: &Scene,
    drive: &Drive,
    folded: &Configuration,
    place: &[f64; 3],
    budget: &Budget<'_>,
    seed: Seed,
) -> Option<Vec<Vec<f64>>> {
    let resolution = cx.options.resolution;
    let mut checker = RobotChecker::new(scene, &drive.space, &drive.dofs, folded, cx.free(None), resolution);
    let mut rng = seed.split("drive").rng();
    let mut goals = FixedGoals::new(vec![place.to_vec()]);
    let found = RrtConnect::new(&folded.select(&drive.dofs))
        .run(&mut checker, None, &mut goals, &cx.options.rrt, budget, &mut rng)
        .ok()?;
    Some(smooth(&mut checker, found.path, &cx.options.smoothers, budget, &mut rng))
}

/// Where the tool has to be able to get to.
pub(super) struct Targets {
    /// Grasps of what is there now.
    hands: Vec<Grasp>,
    /// `world_from_tool` of each, with the object where it is.
    grasps: Vec<Pose>,
    /// The tool in the frame that `destinations` are of, for each, in the same order.
    part_from_tool: Vec<Pose>,
    /// Where the frame gets to: the grasp has to be within reach there, too.
    destinations: Vec<Pose>,
}

impl Targets {
    /// Of an object that is to be placed.
    pub(super) fn of_grasps(cx: &GoalContext<'_>, scene: &Scene, seed: Seed) -> Self {
        let hands = cx.problem.grasps[cx.object].grasps.clone();
        let world_from_object = scene.world_from_body(cx.body());
        let part_from_tool: Vec<Pose> = hands.iter().map(|grasp| grasp.object_from_tool).collect();
        let destinations = match cx.goal() {
            Goal::Place { destination, .. } => {
                super::destination_poses(destination, cx.options.destinations, &mut seed.rng())
            }
            Goal::Open { .. } => vec![],
        };
        let grasps = part_from_tool.iter().map(|tool| world_from_object * tool).collect();
        Self { hands, grasps, part_from_tool, destinations }
    }

    /// Of an article that is to be moved: its handle goes all the way.
    pub(super) fn of_grips(cx: &GoalContext<'_>, scene: &Scene, way: ArticleWay) -> Self {
        let article = &cx.problem.task.articles[way.article];
        let cages = cx.problem.cages.get(way.article).copied().unwrap_or_default();
        let usable = cages.iter().filter(|cage| cage.hold.moves(way.to > way.from));
        let part_from_tool: Vec<Pose> = usable.clone().map(|cage| cage.grasp.part_from_tool).collect();
        let Some(mechanism) = Mechanism::of_article(article) else {
            return Self { hands: vec![], grasps: vec![], part_from_tool: vec![], destinations: vec![] };
        };
        let now = mechanism.world_from_part(way.from);
        let hands = usable.map(|cage| as_grasp(cx, scene, cage, &now)).collect();
        let grasps = part_from_tool.iter().map(|tool| now * tool).collect();
        let at = |share: f64| mechanism.world_from_part(way.from + share * (way.to - way.from));
        Self { hands, grasps, part_from_tool, destinations: [0.5, 1.0].map(at).into() }
    }
}

/// Bases from which the map of the arm's reach says that a grasp and, with it, a destination are within reach.
struct ReachedBases<'c, 'a> {
    cx: &'c GoalContext<'a>,
    drive: &'c Drive,
    targets: &'c Targets,
}

impl ReachedBases<'_, '_> {
    /// How well the arm of a robot whose base stands at `base` reaches a pose of the tool; 1 when nothing is known.
    fn density(&self, base: &[f64; 3], world_from_tool: &Pose) -> f64 {
        let problem = &self.cx.problem;
        let Some(map) = problem.reachability else { return 1.0 };
        let mut q = problem.start.clone();
        q.set(&self.drive.dofs, base);
        let world_from_base = problem.world_from_arm(&q);
        map.density(&(world_from_base.inv_mul(world_from_tool) * problem.arm.tool_from_tip()))
    }
}

impl BaseDistribution for ReachedBases<'_, '_> {
    fn mass(&mut self, _: usize, _: &Pose) -> f64 {
        1.0
    }

    fn draw(&mut self, _: usize, world_from_tool: &Pose, rng: &mut Rng) -> Option<[f64; 3]> {
        let problem = &self.cx.problem;
        let root_from_tool = problem.scene.world_from_robot().inv_mul(world_from_tool);
        let at = root_from_tool.translation.vector;
        let grasp = self.targets.grasps.iter().position(|grasp| grasp == world_from_tool)?;
        let mut last = None;
        for _ in 0..DRAWS {
            let (distance, angle) = (problem.arm.reach() * rng.unit().sqrt(), rng.range(-PI, PI));
            let (x, y) = (at.x + distance * libm::cos(angle), at.y + distance * libm::sin(angle));
            let base = [x, y, rng.range(-PI, PI)];
            last = Some(base);
            if self.density(&base, world_from_tool) <= 0.0 {
                continue;
            }
            let Self { targets: Targets { part_from_tool, destinations, .. }, .. } = self;
            let puts_down =
                |destination: &Pose| self.density(&base, &(destination * part_from_tool[grasp])) > 0.0;
            if destinations.is_empty() || puts_down(&destinations[rng.below(destinations.len())]) {
                return Some(base);
            }
        }
        // A coarse map may be wrong.
        last
    }
}

/// The robot and its surroundings, as far as placing the base needs them.
struct Standing<'c, 'a> {
    cx: &'c GoalContext<'a>,
    scene: &'c Scene,
    /// What `grasps` of the targets are made of.
    hands: &'c [Grasp],
    drive: &'c Drive,
    folded: &'c Configuration,
    rng: Rng,
}

impl Standing<'_, '_> {
    fn at(&self, base: &[f64; 3]) -> Configuration {
        let mut q = self.folded.clone();
        q.set(&self.drive.dofs, base);
        q
    }
}

impl PlacementProblem for Standing<'_, '_> {
    fn grasp_is_free(&mut self, _: usize, grasp: usize) -> Result<(), Obstruction> {
        let grasp = &self.hands[grasp];
        let world_from_tool = self.scene.world_from_body(self.cx.body()) * grasp.object_from_tool;
        hand_check(self.cx, self.scene, grasp, &world_from_tool).map_err(|_| Obstruction::Constraint)
    }

    fn base_is_free(&mut self, _: usize, base: &[f64; 3]) -> Result<(), Obstruction> {
        let Self { cx, scene, drive, folded, .. } = *self;
        let mut checker =
            RobotChecker::new(scene, &drive.space, &drive.dofs, folded, cx.free(None), cx.options.resolution);
        checker.state(base).map(|_| ())
    }

    fn solutions(&mut self, _: usize, base: &[f64; 3], world_from_tool: &Pose) -> Vec<Vec<f64>> {
        let cx = self.cx;
        let arm = cx.problem.arm_at(&self.at(base));
        let near = cx.arm_values(self.folded);
        let rounds = if arm.free_variables().is_empty() { 1 } else { cx.options.free_samples as usize };
        let mut scratch = IkSolutions::new();
        let mut found = Vec::new();
        for round in 0..rounds {
            let free = free_values(cx, round, &near, &mut self.rng);
            let (solutions, _) = arm.inverse(world_from_tool, &free, &near, &mut scratch);
            found.extend(solutions.into_iter().map(|q| [base.as_slice(), &q].concat()));
        }
        found
    }

    fn is_free(&mut self, q: &[f64]) -> Result<(), Obstruction> {
        let (base, arm) = q.split_at(3);
        let stands = self.at(&[base[0], base[1], base[2]]);
        let open = self.cx.with_fingers(&stands, &self.cx.gripper().preshapes[0].values);
        let mut checker = fine_checker(self.cx, self.scene, &open, self.cx.touching());
        state_is_free(&mut checker, arm).map_err(|_| Obstruction::Constraint)
    }
}
