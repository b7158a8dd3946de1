//! Free motions of a task's arm: problems as documents, solved, timed, and judged by whoever wants to.

use std::sync::Arc;

use robotc_core::ids::Idx;
use robotc_core::{BodyIdx, Configuration, LinkIdx, Pose, Trajectory};
use robotc_planning::edge::{Blocked, walk_edge};
use robotc_planning::lanes::{LaneChecker, LaneMemory, LaneRobot, Width};
use robotc_planning::manipulation::gripper_links;
use robotc_planning::motion::{Race, race};
use robotc_planning::pose_goals::PoseGoals;
use robotc_planning::problem::{
    PathFailureReason, PoseDocument, ProblemError, SolveFailure, Solved, solve_racer,
};
use robotc_planning::scene::{Grip, RobotChecker, Rules, Scene};
use robotc_planning::{
    Budget, Constraint, EdgeChecker, GoalSampler, Interrupt, Obstruction, PlanningProblem, Registry, Space,
    time_path,
};
use thiserror::Error;

use crate::session::{LinkShapes, Session};

/// A solved problem.
#[derive(Debug, Clone)]
pub struct Motion {
    /// The path, which goal it reaches, and what it took. Goals count in the order of the problem: configurations, then poses of the
    /// tool.
    pub solved: Solved,
    /// The fastest motion along it within the limits of the arm.
    pub trajectory: Trajectory,
}

/// Why a problem has no solution.
#[derive(Debug, Clone, Error)]
pub enum MotionError {
    /// The document is wrong.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// It names something that the task does not have.
    #[error("the task has no {what} {name}{hint}")]
    Unknown {
        /// What kind of thing.
        what: &'static str,
        /// Its name.
        name: String,
        /// The nearest known name, as a clause.
        hint: String,
    },
    /// There is no path; the message says what was in the way.
    #[error("{0}")]
    NoPath(String),
}

/// Where a path meets something first.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstContact {
    /// Number of the motion: from state `edge` to the next.
    pub edge: usize,
    /// How far along it, 0 to 1.
    pub fraction: f64,
    /// The configuration there.
    pub q: Vec<f64>,
    /// What moves: a link or a held object. Empty when nothing touches.
    pub link: String,
    /// What it touches: a body, or another link. Empty when nothing touches.
    pub body: String,
    /// How deep, metres.
    pub depth: f64,
    /// The same in words, or what else is wrong: a limit, the constraint.
    pub message: String,
}

/// The robot and the things around it as a problem says.
struct Situation {
    scene: Scene,
    q: Configuration,
    held: Option<Grip>,
}

impl Session {
    /// The problem of moving the arm from where the task starts, with defaults for everything else.
    pub fn motion_problem(&self) -> PlanningProblem {
        let start = self.task().start.select(self.arm().dofs());
        let mut problem = PlanningProblem::new(self.arm().space(), &start, vec![]);
        let options = self.options();
        problem.resolution = options.resolution;
        problem.margin = options.margin;
        problem
    }

    /// Reads a document; axes and start that it leaves out are those of the arm and of the task.
    pub fn read_problem(&self, text: &str) -> Result<PlanningProblem, ProblemError> {
        let mut problem = PlanningProblem::read_partial(text)?;
        let own = self.motion_problem();
        if problem.axes.is_empty() {
            problem.axes = own.axes;
        }
        if problem.start.is_empty() {
            problem.start = own.start;
        }
        problem.check()?;
        Ok(problem)
    }

    /// Solves a problem with the planner that it names. Motions are proven free in [lanes](robotc_planning::lanes), unless the problem
    /// has a constraint or asks for jitter: then they are looked at in steps of its resolution. Searches that race share up to
    /// `threads` threads. The result depends on the problem alone unless `interrupt` ends the search.
    pub fn solve_motion(
        &self,
        problem: &PlanningProblem,
        registry: &Registry,
        threads: usize,
        interrupt: &(dyn Fn() -> Option<Interrupt> + Sync),
    ) -> Result<Motion, MotionError> {
        problem.check()?;
        let situation = self.situation(problem)?;
        let space = self.space_of(problem)?;
        let constraint = self.constraint(problem)?;
        let constraint = constraint.as_deref();
        let poses: Vec<Pose> = problem
            .tool_goals
            .iter()
            .map(|p| p.pose().ok_or(ProblemError::Pose("tool_goals")))
            .collect::<Result<_, _>>()?;
        let step_by_step =
            || self.checker(&situation, (problem, &space), problem.margin, problem.resolution, constraint);
        let lanes = self.lanes(&situation, problem);
        let rules = self.rules(&situation, problem.margin);
        let (arm, rounds) = (self.arm(), self.options().free_samples as usize);
        let search = |memory: &mut LaneMemory, racer: u32, budget: &Budget<'_>| {
            let rng = problem.racer_seed(racer).split("goals").rng();
            let mut goals =
                PoseGoals::new(arm, step_by_step(), &problem.goals, &poses, &problem.start, rounds, rng);
            let sampler = (!poses.is_empty()).then_some(&mut goals as &mut dyn GoalSampler);
            let mut solved = match &lanes {
                Some(lanes) => {
                    let (scene, width) = (&situation.scene, Width::widest());
                    let mut checker = LaneChecker::with_rules(lanes, scene, &space, &rules, width, memory);
                    solve_racer(registry, problem, &mut checker, sampler, constraint, budget, racer)
                }
                None => {
                    solve_racer(registry, problem, &mut step_by_step(), sampler, constraint, budget, racer)
                }
            }?;
            if !poses.is_empty() {
                solved.goal = goals.numbers()[solved.goal];
            }
            Ok(solved)
        };
        let racing = Race { racers: problem.race, ..Race::default() };
        let workers = threads.clamp(1, problem.race as usize);
        let mut memory: Vec<LaneMemory> = (0..workers).map(|_| LaneMemory::default()).collect();
        let (first, others) = memory.split_first_mut().expect("there is one worker at least");
        let solved = race(first, others, racing, &search, interrupt);
        let solved = solved.map_err(|failure| self.explain(&situation, &failure))?;
        let timed = time_path(&mut step_by_step(), &solved.path, arm.limits(), &self.options().timing);
        let trajectory = timed
            .into_trajectory(arm.dofs().to_vec(), arm.names().to_vec())
            .expect("times of a timed path grow");
        Ok(Motion { solved, trajectory })
    }

    /// Where a path first meets something, exceeds a limit or leaves the constraint, looked at in steps of the certificate and
    /// without a margin; `None` when it does not.
    pub fn validate_path(
        &self,
        problem: &PlanningProblem,
        path: &[Vec<f64>],
    ) -> Result<Option<FirstContact>, MotionError> {
        let width = self.arm().dofs().len();
        if let Some((number, wrong)) = path.iter().enumerate().find(|(_, q)| q.len() != width) {
            let (what, found) = (format!("path[{number}]"), wrong.len());
            return Err(ProblemError::Dimension { what, found, expected: width }.into());
        }
        let situation = self.situation(problem)?;
        let space = self.space_of(problem)?;
        let constraint = self.constraint(problem)?;
        let step = self.options().certified_step;
        let mut checker =
            self.checker(&situation, (problem, &space), 0.0, step, constraint.as_deref()).without_clearance();
        let Some(first) = path.first() else { return Ok(None) };
        if let Err(by) = checker.state(first) {
            return Ok(Some(self.first_contact(&situation, 0, 0.0, first.clone(), by)));
        }
        for (edge, pair) in path.windows(2).enumerate() {
            if let Err(Blocked { fraction, by }) = walk_edge(&mut checker, &pair[0], &pair[1]) {
                let q = self.arm().space().interpolate(&pair[0], &pair[1], fraction);
                return Ok(Some(self.first_contact(&situation, edge, fraction, q, by)));
            }
        }
        Ok(None)
    }

    /// The space of the problem, whose limits and metric count, for the joints of the arm.
    fn space_of(&self, problem: &PlanningProblem) -> Result<Space, ProblemError> {
        let (found, expected) = (problem.axes.len(), self.arm().dofs().len());
        if found != expected {
            return Err(ProblemError::Dimension { what: "axes".into(), found, expected });
        }
        Ok(problem.space())
    }

    fn first_contact(
        &self,
        situation: &Situation,
        edge: usize,
        fraction: f64,
        q: Vec<f64>,
        by: Obstruction,
    ) -> FirstContact {
        let mut all = situation.q.clone();
        all.set(self.arm().dofs(), &q);
        let depth = situation.scene.depth(&all, situation.held.as_ref(), by).unwrap_or(0.0);
        let [link, body] = situation.scene.names(by).unwrap_or_default().map(str::to_owned);
        FirstContact { edge, fraction, q, link, body, depth, message: words(&situation.scene, by) }
    }

    fn checker<'s>(
        &'s self,
        situation: &'s Situation,
        (problem, space): (&PlanningProblem, &'s Space),
        margin: f64,
        resolution: f64,
        constraint: Option<&'s dyn Constraint>,
    ) -> RobotChecker<'s> {
        let rules = self.rules(situation, margin);
        let (arm, scene) = (self.arm(), &situation.scene);
        let checker = RobotChecker::new(scene, space, arm.dofs(), &situation.q, rules, resolution)
            .with_constraint(constraint);
        if problem.self_collisions { checker } else { checker.without_self_collisions() }
    }

    fn rules(&self, situation: &Situation, margin: f64) -> Rules {
        let robot = &self.task().robot;
        let gripper = robot.arms[self.task().arm].gripper.map_or_else(Vec::new, |g| gripper_links(robot, g));
        Rules { margin, held: situation.held.clone(), gripper, ..Rules::default() }
    }

    /// The robot for checks of its arm in lanes, all other joints as at the start; the links of the arm's gripper are its hand. Made when
    /// it is asked for first.
    pub fn lane_robot(&self) -> Arc<LaneRobot> {
        let LinkShapes { parts, covers, pairs, at_start } = self.link_shapes();
        let make = || {
            let (task, dofs) = (self.task(), self.arm().dofs());
            let gripper = task.robot.arms[task.arm].gripper;
            let hand = gripper.map_or_else(Vec::new, |g| gripper_links(&task.robot, g));
            let robot = LaneRobot::new(self.kinematics(), dofs, &task.start, parts, covers, pairs);
            Arc::new(robot.with_hand(&hand))
        };
        at_start.get_or_init(make).clone()
    }

    /// The robot for checks in lanes; `None` where states are more than free or not: a constraint holds for single states, and a
    /// start that is moved out of a contact asks how much room there is.
    fn lanes(&self, situation: &Situation, problem: &PlanningProblem) -> Option<Arc<LaneRobot>> {
        if problem.constraint.is_some() || problem.jitter.is_some() {
            return None;
        }
        let LinkShapes { parts, covers, pairs, .. } = self.link_shapes();
        let (q, scene) = (&situation.q, &situation.scene);
        let gripper = self.rules(situation, 0.0).gripper;
        let make = |pairs: &[(LinkIdx, LinkIdx)]| {
            let robot = LaneRobot::new(self.kinematics(), self.arm().dofs(), q, parts, covers, pairs);
            Arc::new(robot.with_hand(&gripper))
        };
        let robot = match problem.self_collisions {
            true if problem.situation.joints.is_empty() => self.lane_robot(),
            true => make(pairs),
            false => make(&[]),
        };
        let Some(grip) = &situation.held else { return Some(robot) };
        let cover = &self.object_covers()[grip.body.index()];
        let beside = |link| problem.self_collisions && gripper.binary_search(&link).is_err();
        Some(Arc::new(robot.holding(scene, grip, cover, beside)))
    }

    fn constraint(&self, problem: &PlanningProblem) -> Result<Option<Box<dyn Constraint + '_>>, MotionError> {
        let build = |document: &robotc_planning::problem::ConstraintDocument| document.build(self.arm());
        Ok(problem.constraint.as_ref().map(build).transpose()?)
    }

    fn situation(&self, problem: &PlanningProblem) -> Result<Situation, MotionError> {
        let task = self.task();
        let (mut scene, mut q) = (self.scene().clone(), task.start.clone());
        let names = task.objects.iter().map(|o| &o.name).chain(task.obstacles.iter().map(|o| &o.name));
        let names: Vec<&str> = names.map(String::as_str).collect();
        let body = |name: &str| named("body", name, &names).map(BodyIdx::new);
        let pose = |document: &PoseDocument| document.pose().ok_or(ProblemError::Pose("situation"));
        let document = &problem.situation;
        let model = &task.robot.model;
        let joints: Vec<&str> = model.dofs().iter().map(|dof| dof.name.as_str()).collect();
        for (name, &value) in &document.joints {
            q[robotc_core::DofIdx::new(named("joint", name, &joints)?)] = value;
        }
        let articles: Vec<&str> = task.articles.iter().map(|article| article.name.as_str()).collect();
        for (name, &value) in &document.articles {
            for (obstacle, place) in task.articles[named("article", name, &articles)?].moved_bodies(value) {
                scene.place(BodyIdx::new(task.objects.len() + obstacle), place);
            }
        }
        for (name, place) in &document.bodies {
            scene.place(body(name)?, pose(place)?);
        }
        let held = match (&document.held, task.robot.arms[task.arm].gripper) {
            (Some(held), Some(gripper)) => {
                let gripper = &task.robot.grippers[gripper];
                let link_from_body = gripper.palm_from_tool * pose(&held.tool_from_object)?;
                let objects: Vec<&str> = task.objects.iter().map(|object| object.name.as_str()).collect();
                let object = named("object", &held.object, &objects)?;
                Some(Grip { body: BodyIdx::new(object), link: gripper.palm, link_from_body })
            }
            _ => None,
        };
        Ok(Situation { scene, q, held })
    }

    /// A failure in words, with what was in the way most often.
    fn explain(&self, situation: &Situation, failure: &SolveFailure) -> MotionError {
        let SolveFailure::Search { failure: search, bad_goals } = failure else {
            return MotionError::NoPath(failure.to_string());
        };
        let mut text = search.to_string();
        if let PathFailureReason::Start(by) = &search.reason {
            text += &format!(": {}", words(&situation.scene, *by));
        }
        for (number, by) in bad_goals {
            text += &format!("; goal {number}: {}", words(&situation.scene, *by));
        }
        let mut blocked: Vec<_> = search.blocked.iter().collect();
        blocked.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
        for (by, count) in blocked.into_iter().take(3) {
            text += &format!("; {count} motions: {}", words(&situation.scene, *by));
        }
        MotionError::NoPath(text)
    }
}

fn words(scene: &Scene, by: Obstruction) -> String {
    match by {
        Obstruction::Bounds => "a joint limit is exceeded".into(),
        Obstruction::Constraint => "the path constraint is violated".into(),
        Obstruction::Contact(_) => scene.describe(by).unwrap_or_default(),
    }
}

fn named(what: &'static str, name: &str, known: &[&str]) -> Result<usize, MotionError> {
    known.iter().position(|other| *other == name).ok_or_else(|| {
        let near = robotc_core::diag::nearest(name, known.iter().copied());
        let hint = near.map_or(String::new(), |near| format!("; did you mean {near}?"));
        MotionError::Unknown { what, name: name.to_owned(), hint }
    })
}

/// Whether a search was told to stop, and why.
pub fn interrupted(problem: &PlanningProblem, elapsed: f64, cancelled: bool) -> Option<Interrupt> {
    if cancelled { Some(Interrupt::Cancelled) } else { problem.interrupt(elapsed) }
}
