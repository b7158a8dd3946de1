//! Doors, drawers and levers, moved in a loose grip on their handles (thesis section 3.4).
//!
//! Starts are drawn lazily: a grip, a branch of inverse kinematics, and a straight approach to it. From each a
//! [randomised search](crate::caging::randomized_search) looks for a way of the article, straight on in one grip at first and longer in
//! each round, since most of what can be opened at all is opened soon from some start.

use nalgebra::Unit;
use robotc_core::rng::Rng;
use robotc_core::{Configuration, DofIdx, Pose, Seed};

use super::free_motion::{FreeMotion, start_rules};
use super::maker::Maker;
use super::picks::hand_check;
use super::plan::{Choice, GoalFailure, OpenChoice, SegmentKind, Stage, Tried};
use super::problem::{GoalContext, with_fingers_space};
use super::rejections::{Cause, Filter, Rejections, none_usable};
use super::sequence::{Observer, Reached};
use super::stretch::{back_off, cause, fine_checker, fingers_move, state_is_free};
use crate::budget::{Budget, Interrupt};
use crate::caging::{
    ArticulatedTask, Cage, CageGrasp, CageStart, CagedObject, CagedState, CagingFailure, CagingFailureReason,
    CagingSolution, FixedGrasp, ObjectStep, RandomizedOptions, StartingAt, WaySearch, discrete_search,
    randomized_search,
};
use crate::cartesian::LineObstacle;
use crate::edge::Obstruction;
use crate::explore::{ExploreOptions, FixedMotion, make_way};
use crate::goal::FixedGoals;
use crate::grasp::Grasp;
use crate::mechanism::{Mechanism, MechanismMotion};
use crate::scene::{MovingArticle, RobotChecker, Scene};

/// From where to where an article moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct ArticleWay {
    /// Position in the task.
    pub(super) article: usize,
    pub(super) from: f64,
    pub(super) to: f64,
}

/// An article nearer to its goal than this, radians or metres, is there.
const THERE: f64 = 1e-6;

/// Shares of the draws of a search that each round gets, after a first one for ways straight on.
const ROUNDS: [f64; 4] = [0.002, 0.01, 0.1, 1.0];

/// Most starts that are searched from.
const STARTS: usize = 24;

/// Plans one goal to move an article, from configuration `q`.
pub(super) fn plan_opening(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    way: ArticleWay,
    budget: &Budget<'_>,
    seed: Seed,
    observer: &mut dyn Observer,
) -> Result<Reached, Box<GoalFailure>> {
    let article = &cx.problem.task.articles[way.article];
    if (way.to - way.from).abs() < THERE {
        let choice = way.choice(cx, vec![], Rejections::default());
        return Ok(Reached { segments: vec![], choice, q: q.clone() });
    }
    let Some(mechanism) = Mechanism::of_article(article) else {
        let mut missed = GoalFailure::new(cx.object_name(), Stage::Start);
        missed.message = "its joint neither turns nor slides".into();
        return Err(missed);
    };
    let cages = cx.problem.cages.get(way.article).copied().unwrap_or_default();
    let numbers: Vec<usize> = (0..cages.len()).filter(|&c| cages[c].hold.moves(way.to > way.from)).collect();
    let usable: Vec<&Cage> = numbers.iter().map(|&c| &cages[c]).collect();
    let grasps: Vec<CageGrasp> = usable.iter().map(|cage| cage.grasp.clone()).collect();
    let dofs: Vec<DofIdx> = [cx.problem.arm.dofs(), cx.gripper().dofs.as_slice()].concat();
    let joints = with_fingers_space(cx.problem.arm.space(), cx.finger_space);
    let moving = MovingArticle::new(scene, article, cx.problem.task.objects.len());
    let space = moving.space(&joints);
    let (rules, resolution) = (cx.touching(), cx.options.fine_resolution);
    let checker = RobotChecker::with_article(scene, &space, (&dofs, moving), q, rules, resolution);
    let (rest, steps) =
        (cx.arm_values(q), article_steps(&mechanism, way.from, way.to, cx.options.caging.shift, &grasps));
    let task = CagedObject::new(cx.problem.arm, &grasps, steps, checker, &rest, cx.options.caging);
    let Ok(task) = task else {
        let mut missed = GoalFailure::new(cx.object_name(), Stage::Grasps);
        missed.message = "no grip is known that moves it that way".into();
        return Err(missed);
    };
    let task = task.with_fingers(usable.iter().map(|cage| cage.loose.clone()).collect());
    let mut order: Vec<usize> = (0..usable.len()).collect();
    seed.split("grips").rng().shuffle(&mut order);
    // What holds both ways and in contact needs no change of grip; of what is left, what holds both ways.
    order.sort_by_key(|&grip| (usable[grip].hold, !usable[grip].grasp.contact));
    order.reverse();
    let world_from_part = mechanism.world_from_part(way.from);
    let rejections = Rejections::default();
    let mut opening = Opening {
        cx,
        scene,
        q,
        way,
        cages: usable,
        world_from_part,
        task,
        order,
        branches: vec![],
        rejections,
        looked_at: 0,
        usable: 0,
    };
    let (states, motions) = opening.search(budget, seed, observer)?;
    let mut made = Maker::new(cx, q);
    let cage_at = |state: &CagedState| opening.cages[state.grasp];
    let (first, last) = (&states[0], &states[states.len() - 1]);
    let preshape = |cage: &Cage| &cx.gripper().preshapes[cage.preshape].values;
    let mut fingers = q.select(&cx.gripper().dofs);
    if let Some(way) = &motions.making_way {
        made.arm(SegmentKind::Reach, way, scene, cx.free(None), None);
        made.fingers(SegmentKind::Preshape, &fingers, preshape(cage_at(first)), scene, None);
        fingers.clone_from(preshape(cage_at(first)));
    }
    made.arm(SegmentKind::Reach, &motions.reach, scene, cx.free(None), None);
    if fingers != *preshape(cage_at(first)) {
        made.fingers(SegmentKind::Preshape, &fingers, preshape(cage_at(first)), scene, None);
    }
    made.arm(SegmentKind::Approach, &motions.approach, scene, cx.touching(), None);
    made.fingers(SegmentKind::Grasp, preshape(cage_at(first)), &cage_at(first).loose, scene, None);
    let path: Vec<Vec<f64>> = states.iter().map(|state| opening.task.whole(state)).collect();
    let model = &cx.robot().model;
    let names = dofs.iter().map(|&d| model.dofs()[d].name.clone()).collect();
    let (release, after) = (cage_at(last), &motions.scene_after);
    let grips = states.iter().map(|state| numbers[state.grasp]).collect();
    made.with_article(opening.task.checker(), &path, (dofs.clone(), names), (way.article, article));
    made.fingers(SegmentKind::Release, &release.loose, preshape(release), after, None);
    made.arm(SegmentKind::Retreat, &motions.retreat, after, cx.touching(), None);
    let choice = way.choice(cx, grips, opening.rejections);
    Ok(Reached { segments: made.segments, choice, q: made.q })
}

impl ArticleWay {
    fn choice(&self, cx: &GoalContext<'_>, grips: Vec<usize>, rejections: Rejections) -> Choice {
        let Self { article, to, .. } = *self;
        Choice::Open(OpenChoice { goal: cx.number, article, value: to, grips, rejections })
    }
}

/// Steps of the article that move its grips by no more than `shift`, metres.
pub(crate) fn article_steps(
    mechanism: &Mechanism,
    from: f64,
    to: f64,
    shift: f64,
    grasps: &[CageGrasp],
) -> Vec<ObjectStep> {
    let lever = match mechanism.motion {
        MechanismMotion::Slide => 1.0,
        MechanismMotion::Hinge => {
            grasps.iter().map(|g| g.part_from_tool.translation.vector.xy().norm()).fold(0.0, f64::max)
        }
    };
    let count = (lever * (to - from).abs() / shift).ceil().max(1.0) as usize;
    let step = |value| ObjectStep { value, world_from_part: mechanism.world_from_part(value) };
    Mechanism::steps(from, to, count + 1).into_iter().map(step).collect()
}

/// A grip as a grasp of the handle, with the article's part at `world_from_part` in `scene`.
pub(super) fn as_grasp(cx: &GoalContext<'_>, scene: &Scene, cage: &Cage, world_from_part: &Pose) -> Grasp {
    let handle_from_part = scene.world_from_body(cx.body()).inv_mul(world_from_part);
    let object_from_tool = handle_from_part * cage.grasp.part_from_tool;
    let approach = object_from_tool.rotation * cx.gripper().approach_in_tool.into_inner();
    Grasp {
        preshape: cage.preshape,
        object_from_tool,
        approach_in_object: Unit::new_normalize(approach),
        standoff: 0.0,
        closed: cage.loose.clone(),
        contacts: vec![],
        epsilon: 0.0,
        volume: None,
        steadiness: None,
        score: 0.0,
    }
}

/// Motions before and after that of the article.
struct Motions {
    /// The arm makes way for the fingers to open, where they cannot do so at the end of the reach.
    making_way: Option<Vec<Vec<f64>>>,
    reach: Vec<Vec<f64>>,
    approach: Vec<Vec<f64>>,
    scene_after: Scene,
    retreat: Vec<Vec<f64>>,
}

/// The gripper round the handle, and how it gets there.
#[derive(Clone)]
struct Start {
    state: CagedState,
    approach: Vec<Vec<f64>>,
    /// Whether the fingers can open at the end of the reach.
    opens_there: bool,
}

/// How long ways are searched for before those from all other starts are.
struct Round {
    /// Only ways on which the grip stays what it is. They take a quarter of the draws of others and open most of what can be opened.
    straight: bool,
    draws: u32,
    /// Of random numbers.
    stream: u64,
}

/// A search for a way of an article.
struct Opening<'c, 'a, 't> {
    cx: &'c GoalContext<'a>,
    scene: &'c Scene,
    q: &'c Configuration,
    way: ArticleWay,
    cages: Vec<&'t Cage>,
    /// At the start.
    world_from_part: Pose,
    task: CagedObject<'t, RobotChecker<'t>>,
    /// Grips still to be looked at, the next one last.
    order: Vec<usize>,
    /// Configurations of the present grip still to be tried, the next one last.
    branches: Vec<CagedState>,
    rejections: Rejections,
    looked_at: usize,
    usable: usize,
}

impl Opening<'_, '_, '_> {
    fn search(
        &mut self,
        budget: &Budget<'_>,
        seed: Seed,
        observer: &mut dyn Observer,
    ) -> Result<(Vec<CagedState>, Motions), Box<GoalFailure>> {
        let exhaustive = self.cx.options.caging.search == WaySearch::Discrete;
        if exhaustive && self.cx.problem.arm.free_variables().is_empty() {
            return self.search_all(budget, seed, observer);
        }
        let mut starts: Vec<Start> = Vec::new();
        // The failure that is told: of the latest stage that was reached; of going straight on only when there is no other.
        let (mut last, mut first): (Option<Box<GoalFailure>>, Option<Box<GoalFailure>>) = (None, None);
        for (number, round) in self.rounds().into_iter().enumerate() {
            for start in 0..STARTS {
                if start == starts.len() {
                    match (number, self.next_start(budget)) {
                        (_, Err(interrupt)) => return Err(self.interrupted(interrupt)),
                        (0, Ok(Some(start))) => starts.push(start),
                        _ => break,
                    }
                }
                let seed = seed.split("starts").at(start as u64).at(round.stream);
                let start = starts[start].clone();
                let Some(found) = self.search_from(&start, &round, budget, seed) else { continue };
                let states = match found {
                    Ok(solution) => solution.states,
                    Err(failure) => {
                        let missed = self.stuck(&failure);
                        if missed.interrupt.is_some() {
                            return Err(missed);
                        }
                        let told = if round.straight { &mut first } else { &mut last };
                        told.get_or_insert(missed);
                        continue;
                    }
                };
                match self.around(&start, &states, budget, seed, observer) {
                    Ok(Some(motions)) => return Ok((states, motions)),
                    Ok(None) => {}
                    Err(missed) if missed.interrupt.is_some() => return Err(self.counted(missed)),
                    Err(missed) => last = Some(missed),
                }
            }
        }
        let missed = last.or(first).unwrap_or_else(|| {
            let mut missed = GoalFailure::new(self.cx.object_name(), Stage::Grasps);
            missed.message = none_usable(self.cages.len());
            missed
        });
        Err(self.counted(missed))
    }

    /// Straight on at first, one draw each step, then longer and longer; fewer draws than there are steps lead nowhere.
    fn rounds(&self) -> Vec<Round> {
        let most = f64::from(self.cx.options.caging_search.max_draws);
        let needed = self.task.steps() as u32 - 1;
        let straight = Round { straight: true, draws: needed, stream: ROUNDS.len() as u64 };
        let longer = (0..).zip(ROUNDS);
        let longer = longer.map(|(stream, share)| Round {
            straight: false,
            draws: (share * most).ceil() as u32,
            stream,
        });
        std::iter::once(straight).chain(longer.filter(|round| round.draws >= needed)).collect()
    }

    /// Searches for a way from one start; `None` where the round has nothing to look for from there.
    fn search_from(
        &mut self,
        start: &Start,
        round: &Round,
        budget: &Budget<'_>,
        seed: Seed,
    ) -> Option<Result<CagingSolution, CagingFailure>> {
        let usual = self.cx.options.caging_search;
        let options = RandomizedOptions { max_draws: round.draws, ..usual };
        let from = CageStart::State(start.state.clone());
        let mut rng = seed.split("caging").rng();
        if !round.straight {
            return Some(randomized_search(&mut self.task, &from, &options, budget, &mut rng));
        }
        if !self.task.is_contact(start.state.grasp) {
            return None;
        }
        let options = RandomizedOptions { children: 1, ..options };
        let mut firm = FixedGrasp::one(&mut self.task, start.state.grasp);
        Some(randomized_search(&mut firm, &from, &options, budget, &mut rng))
    }

    /// The exhaustive search from all grips that can be approached (thesis algorithm 3.7).
    fn search_all(
        &mut self,
        budget: &Budget<'_>,
        seed: Seed,
        observer: &mut dyn Observer,
    ) -> Result<(Vec<CagedState>, Motions), Box<GoalFailure>> {
        let mut starts: Vec<Start> = Vec::new();
        loop {
            match self.next_start(budget) {
                Ok(Some(start)) => starts.push(start),
                Ok(None) => break,
                Err(interrupt) => return Err(self.interrupted(interrupt)),
            }
        }
        let states: Vec<CagedState> = starts.iter().map(|start| start.state.clone()).collect();
        let found = discrete_search(&mut StartingAt::new(&mut self.task, &states), budget);
        let states = match found {
            Ok(solution) => solution.states,
            Err(failure) => {
                let missed = self.stuck(&failure);
                return Err(self.counted(missed));
            }
        };
        let start = starts.iter().find(|start| start.state == states[0]).expect("it begins in one of them");
        match self.around(start, &states, budget, seed, observer) {
            Ok(Some(motions)) => Ok((states, motions)),
            Ok(None) => {
                let mut missed = GoalFailure::new(self.cx.object_name(), Stage::Open);
                missed.message = "the gripper does not get off the handle at the end".into();
                Err(self.counted(missed))
            }
            Err(missed) => Err(self.counted(missed)),
        }
    }

    /// The next grip that can be approached; `None` when all are through.
    fn next_start(&mut self, budget: &Budget<'_>) -> Result<Option<Start>, Interrupt> {
        loop {
            budget.check()?;
            if let Some(state) = self.branches.pop() {
                match self.start(&state) {
                    Ok(start) => {
                        self.usable += 1;
                        // Another branch of the same grip is worth less than another grip.
                        self.branches.truncate(1);
                        return Ok(Some(start));
                    }
                    Err((filter, cause)) => self.rejections.add_because(filter, cause),
                }
                continue;
            }
            let Some(grip) = self.order.pop() else { return Ok(None) };
            self.looked_at += 1;
            let grasp = as_grasp(self.cx, self.scene, self.cages[grip], &self.world_from_part);
            let world_from_tool = self.world_from_part * self.cages[grip].grasp.part_from_tool;
            if let Err((filter, cause)) = hand_check(self.cx, self.scene, &grasp, &world_from_tool) {
                self.rejections.add_because(filter, cause);
                continue;
            }
            let within_reach = self.task.candidates(0, grip, None).into_iter();
            let states = within_reach.map(|q| CagedState { step: 0, grasp: grip, q });
            let free = states.filter(|state| self.task.free(state).is_ok());
            self.branches = free.take(self.cx.options.branches).collect();
            self.branches.reverse();
            if self.branches.is_empty() {
                self.rejections.add(Filter::GraspOutOfReach);
            }
        }
    }

    /// Against the approach of a grip with the arm at `at`, in the world.
    fn backwards(&self, at: &[f64]) -> nalgebra::Vector3<f64> {
        -(self.cx.problem.arm.world_from_tool(at).rotation * self.cx.gripper().approach_in_tool.into_inner())
    }

    fn start(&self, state: &CagedState) -> Result<Start, (Filter, Cause)> {
        let Self { cx, scene, q, .. } = *self;
        let cage = self.cages[state.grasp];
        let preshape = &cx.gripper().preshapes[cage.preshape].values;
        let open = cx.with_fingers(q, preshape);
        let at = &state.q;
        state_is_free(&mut fine_checker(cx, scene, &open, cx.touching()), at)
            .map_err(|cause| (Filter::ArmAtGrasp, cause))?;
        fingers_move(cx, scene, q, at, preshape, &cage.loose, cx.touching())
            .map_err(|cause| (Filter::ClosedHand, cause))?;
        let mut approach =
            back_off(cx, scene, &open, at, &self.backwards(at)).map_err(|cause| (Filter::Approach, cause))?;
        approach.reverse();
        let far = &approach[0];
        let now = q.select(&cx.gripper().dofs);
        let opens_there = state_is_free(&mut fine_checker(cx, scene, q, cx.free(None)), far)
            .and_then(|()| fingers_move(cx, scene, q, far, &now, preshape, cx.free(None)))
            .is_ok();
        Ok(Start { state: state.clone(), approach, opens_there })
    }

    /// The motions to a start and away from the end of a way; `None` when the gripper does not get off the handle.
    fn around(
        &mut self,
        start: &Start,
        states: &[CagedState],
        budget: &Budget<'_>,
        seed: Seed,
        observer: &mut dyn Observer,
    ) -> Result<Option<Motions>, Box<GoalFailure>> {
        let Self { cx, scene, q, .. } = *self;
        let last = &states[states.len() - 1];
        let cage = self.cages[last.grasp];
        let preshape = &cx.gripper().preshapes[cage.preshape].values;
        let mut scene_after = scene.clone();
        cx.problem.move_article(&mut scene_after, self.way.article, self.way.to);
        let open = cx.with_fingers(q, preshape);
        let off = fingers_move(cx, &scene_after, q, &last.q, &cage.loose, preshape, cx.touching())
            .and_then(|()| back_off(cx, &scene_after, &open, &last.q, &self.backwards(&last.q)));
        let retreat = match off {
            Ok(retreat) => retreat,
            Err(cause) => {
                self.rejections.add_because(Filter::Retreat, cause);
                return Ok(None);
            }
        };
        let mut from = cx.arm_values(q);
        let mut q = q.clone();
        let mut making_way = None;
        if !start.opens_there {
            let cage = self.cages[start.state.grasp];
            let Some(path) = self.make_way(cage, budget, seed) else { return Ok(None) };
            from.clone_from(&path[path.len() - 1]);
            q = cx.with_fingers(&q, &cx.gripper().preshapes[cage.preshape].values);
            making_way = Some(path);
        }
        let rules = start_rules(cx, scene, &q, &from);
        let mut reach = FreeMotion { cx, scene, q: &q, rules, constraint: None, kind: SegmentKind::Reach };
        let mut goals = FixedGoals::new(vec![start.approach[0].clone()]);
        let mut rng: Rng = seed.split("reach").rng();
        match reach.search(&from, &mut goals, budget, &mut rng, observer) {
            Ok(solution) => {
                let reach = reach.smoothed(solution.path, budget, &mut rng);
                let approach = start.approach.clone();
                Ok(Some(Motions { making_way, reach, approach, scene_after, retreat }))
            }
            Err(failure) => Err(reach.failed(&failure)),
        }
    }

    /// Moves the arm to where the fingers can open for a grip (thesis algorithms 3.9 and 3.10).
    fn make_way(&mut self, cage: &Cage, budget: &Budget<'_>, seed: Seed) -> Option<Vec<Vec<f64>>> {
        let Self { cx, scene, q, .. } = *self;
        let dofs: Vec<DofIdx> = [cx.problem.arm.dofs(), cx.gripper().dofs.as_slice()].concat();
        let space = with_fingers_space(cx.problem.arm.space(), cx.finger_space);
        let rules = start_rules(cx, scene, q, &cx.arm_values(q));
        let mut checker = RobotChecker::new(scene, &space, &dofs, q, rules, cx.options.resolution);
        let from = q.select(&dofs);
        let arm = cx.problem.arm.dofs().len();
        let fingers: Vec<usize> = (arm..dofs.len()).collect();
        let motion = FixedMotion::straight(&fingers, &from, &cx.gripper().preshapes[cage.preshape].values);
        let options = ExploreOptions::default();
        match make_way(&mut checker, &from, &motion, &options, budget, seed.split("way")) {
            Ok(solution) => {
                let mut path: Vec<Vec<f64>> = solution.path.iter().map(|q| q[..arm].to_vec()).collect();
                // The last state differs from the one before in the fingers alone.
                path.pop();
                Some(path)
            }
            Err(failure) => {
                for (by, _) in failure.statistics.refused {
                    self.rejections.add_because(Filter::Approach, cause(scene, by));
                }
                None
            }
        }
    }

    /// The failure of a search for a way.
    fn stuck(&mut self, failure: &CagingFailure) -> Box<GoalFailure> {
        for (&by, &count) in &failure.statistics.blocked {
            let why = match by {
                // The arm would have to go a way round.
                Obstruction::Constraint => Cause::Line(LineObstacle::BranchEnds),
                by => cause(self.scene, by),
            };
            *self.rejections.edges.entry(why).or_insert(0) += count;
        }
        let mut missed = GoalFailure::new(self.cx.object_name(), Stage::Open);
        missed.message = failure.to_string();
        if let CagingFailureReason::Interrupted(interrupt) = failure.reason {
            missed.interrupt = Some(interrupt);
            missed.message = format!("{} motions tried", failure.statistics.motions);
            return self.counted(missed);
        }
        missed
    }

    fn interrupted(&mut self, interrupt: Interrupt) -> Box<GoalFailure> {
        let mut missed = GoalFailure::new(self.cx.object_name(), Stage::Grasps);
        missed.interrupt = Some(interrupt);
        missed.message = format!("{} of {} looked at", self.looked_at, self.cages.len());
        self.counted(missed)
    }

    fn counted(&mut self, mut missed: Box<GoalFailure>) -> Box<GoalFailure> {
        missed.tried = Tried { known: self.cages.len(), looked_at: self.looked_at, usable: self.usable };
        missed.rejections.merge(&self.rejections);
        missed
    }
}
