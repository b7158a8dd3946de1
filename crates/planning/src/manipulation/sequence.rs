//! The whole task: goal after goal, and for each the free motions between its straight ones.

use std::fmt;

use robotc_core::ids::Idx;
use robotc_core::task::{Article, Goal};
use robotc_core::{BodyIdx, Configuration, Pose, Seed};
use thiserror::Error;

use super::destinations::destination_poses;
use super::driving::{Targets, plan_driving};
use super::free_motion::{FreeMotion, start_rules};
use super::maker::Maker;
use super::opening::{ArticleWay, plan_opening};
use super::options::ManipulationOptions;
use super::picks::{Pick, PickSampler, placings, upright};
use super::placings::{Destinations, Placing, PlacingSampler};
use super::plan::{
    Choice, Event, GoalFailure, Held, Nearest, OpenChoice, PlaceChoice, Plan, Segment, SegmentKind,
    SkippedGoal, Stage, Tried,
};
use super::problem::{GoalContext, Manipulation, finger_space, gripper_links};
use super::rejections::{Filter, Rejections, none_usable};
use super::stretch::cause;
use crate::budget::{Budget, Interrupt};
use crate::constraint::Constraint;
use crate::grasp::Grasp;
use crate::rrt::{RrtConnect, RrtFailureReason, RrtStatistics};
use crate::scene::Scene;

/// Told what the planner does, for progress, timing and display. All methods do nothing unless overridden.
pub trait Observer {
    /// Planning for a goal of the task begins.
    fn goal(&mut self, _goal: usize) {}

    /// A search for a free motion ended; its forests are in the joint space of the arm.
    fn searched(&mut self, _goal: usize, _kind: SegmentKind, _search: &RrtConnect, _done: &RrtStatistics) {}

    /// A segment of the plan is final.
    fn segment(&mut self, _segment: &Segment) {}
}

impl Observer for () {}

/// Why there is no plan at all.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PlanFailure {
    /// The arm has no gripper.
    #[error("arm {0} has no gripper")]
    NoGripper(String),
    /// The budget ended before the first goal was reached.
    #[error("no plan was found: {}", Reasons(.skipped))]
    Interrupted {
        /// Why.
        interrupt: Interrupt,
        /// What had been tried for each goal.
        skipped: Vec<SkippedGoal>,
    },
    /// No goal can be reached.
    #[error("{}", Reasons(.0))]
    NoGoal(Vec<SkippedGoal>),
}

struct Reasons<'a>(&'a [SkippedGoal]);

impl fmt::Display for Reasons<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, skipped) in self.0.iter().enumerate() {
            write!(f, "{}{}", if i == 0 { "" } else { "; " }, skipped.reason)?;
        }
        Ok(())
    }
}

/// A goal's plan and the situation after it.
pub(super) struct Reached {
    pub(super) segments: Vec<Segment>,
    pub(super) choice: Choice,
    pub(super) q: Configuration,
}

/// Plans all goals of the task, in order; one that fails is tried again after the others, when they have made room.
///
/// The plan holds what could be reached, and says what could not and why; it is an error when that is everything. The
/// result depends on inputs and seed alone unless the budget ends it.
pub fn pick_and_place(
    problem: &Manipulation<'_>,
    options: &ManipulationOptions,
    budget: &Budget<'_>,
    seed: Seed,
    observer: &mut dyn Observer,
) -> Result<Plan, PlanFailure> {
    let robot = &*problem.task.robot;
    let arm = &robot.arms[problem.task.arm];
    let gripper = arm.gripper.ok_or_else(|| PlanFailure::NoGripper(arm.name.clone()))?;
    let links = gripper_links(robot, gripper);
    let fingers = finger_space(robot, gripper);

    let mut scene = problem.scene.clone();
    let mut q = problem.start.clone();
    let mut values: Vec<f64> = problem.task.articles.iter().map(Article::value).collect();
    let mut plan = Plan::default();
    let mut pending: Vec<usize> = (0..problem.task.goals.len()).collect();
    for round in 0.. {
        let mut missed: Vec<SkippedGoal> = Vec::new();
        let before = pending.len();
        for &number in &pending {
            observer.goal(number);
            // A base that drives may have taken the arm along.
            let arm = problem.arm_at(&q);
            let problem = Manipulation { arm: &arm, ..*problem };
            let cx = GoalContext {
                problem,
                options,
                number,
                object: match problem.task.goals[number] {
                    Goal::Place { object, .. } => object,
                    Goal::Open { article, .. } => problem.handle_of(article),
                },
                gripper,
                gripper_links: &links,
                finger_space: &fingers,
            };
            let seed = seed.split("goal").at(number as u64).at(round);
            let reached = match problem.task.goals[number] {
                Goal::Place { .. } => {
                    plan_goal(&cx, &scene, &q, budget, seed, observer).or_else(|missed| {
                        let mut there = |cx: &GoalContext<'_>, q: &Configuration, seed: Seed| {
                            // What is shown of searches is drawn where the robot stands at first.
                            plan_goal(cx, &scene, q, budget, seed, &mut ())
                        };
                        let seed = seed.split("drive");
                        let targets = Targets::of_grasps(&cx, &scene, seed.split("destinations"));
                        plan_driving(&cx, &scene, &q, (missed, targets), budget, seed, &mut there)
                    })
                }
                Goal::Open { article, to } => {
                    let way = ArticleWay { article, from: values[article], to };
                    plan_opening(&cx, &scene, &q, way, budget, seed, observer).or_else(|missed| {
                        let mut there = |cx: &GoalContext<'_>, q: &Configuration, seed: Seed| {
                            plan_opening(cx, &scene, q, way, budget, seed, &mut ())
                        };
                        let seed = seed.split("drive");
                        let targets = Targets::of_grips(&cx, &scene, way);
                        plan_driving(&cx, &scene, &q, (missed, targets), budget, seed, &mut there)
                    })
                }
            };
            match reached {
                Ok(reached) => {
                    reached.segments.iter().for_each(|s| observer.segment(s));
                    match reached.choice {
                        Choice::Place(PlaceChoice { object, world_from_object, .. }) => {
                            scene.place(BodyIdx::new(object), world_from_object);
                        }
                        Choice::Open(OpenChoice { article, value, .. }) => {
                            values[article] = value;
                            problem.move_article(&mut scene, article, value);
                        }
                    }
                    q = reached.q;
                    plan.segments.extend(reached.segments);
                    plan.choices.push(reached.choice);
                }
                Err(reason) => missed.push(SkippedGoal { goal: number, reason: *reason }),
            }
        }
        pending = missed.iter().map(|m| m.goal).collect();
        let interrupted = missed.iter().any(|m| m.reason.interrupt.is_some());
        if pending.is_empty() || pending.len() == before || interrupted {
            plan.skipped = missed;
            break;
        }
    }
    let skipped = match plan.choices.is_empty() {
        true => std::mem::take(&mut plan.skipped),
        false => vec![],
    };
    match skipped.iter().find_map(|s| s.reason.interrupt) {
        Some(interrupt) => Err(PlanFailure::Interrupted { interrupt, skipped }),
        None if !skipped.is_empty() => Err(PlanFailure::NoGoal(skipped)),
        None => Ok(plan),
    }
}

/// Plans one goal from configuration `q`.
fn plan_goal(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    budget: &Budget<'_>,
    seed: Seed,
    observer: &mut dyn Observer,
) -> Result<Reached, Box<GoalFailure>> {
    stands_free(cx, scene)?;
    let Goal::Place { destination, keep_upright, .. } = cx.goal() else {
        unreachable!("goals to place an object come here")
    };
    let set = cx.problem.grasps[cx.object];
    let poses = destination_poses(destination, cx.options.destinations, &mut seed.split("destination").rng());
    let mut destinations = Destinations::new(poses);
    let mut sampler =
        PickSampler::new(*cx, scene, set, &mut destinations, q, *keep_upright, seed.split("grasps").rng());
    let mut rng = seed.split("search").rng();
    let start = cx.arm_values(q);
    let mut carries = Carries::default();
    for _ in 0..cx.options.attempts {
        let rules = start_rules(cx, scene, q, &start);
        let mut reach = FreeMotion { cx, scene, q, rules, constraint: None, kind: SegmentKind::Reach };
        let solution = match reach.search(&start, &mut sampler, budget, &mut rng, observer) {
            Ok(solution) => solution,
            Err(failure) => {
                let mut missed = reach.failed(&failure);
                let Tried { known, looked_at, .. } = sampler.tried();
                let no_goal = failure.statistics.goals == 0;
                if no_goal && missed.interrupt.is_some() {
                    missed.stage = Stage::Grasps;
                    missed.message = format!("{looked_at} of {known} looked at");
                } else if failure.reason == RrtFailureReason::NoGoal {
                    (missed.stage, missed.message) = match &carries.last {
                        Some(message) => (Stage::Carry, message.clone()),
                        None => (Stage::Grasps, none_usable(known)),
                    };
                }
                return Err(carries.conclude(missed, &sampler));
            }
        };
        let pick = sampler.found[solution.goal].clone();
        let grasp = &set.grasps[pick.grasp];
        let carried = plan_carry(
            cx,
            scene,
            q,
            grasp,
            &pick,
            *keep_upright,
            sampler.destinations,
            budget,
            &mut rng,
            observer,
        );
        match carried {
            Ok((carry_path, placing)) => {
                let reach_path = reach.smoothed(solution.path, budget, &mut rng);
                let rejections = sampler.rejections.clone();
                let motions = Motions { reach: reach_path, pick, carry: carry_path, placing };
                return Ok(motions.into_segments(cx, scene, q, grasp, rejections));
            }
            Err(missed) if missed.interrupt.is_some() => return Err(carries.conclude(missed, &sampler)),
            Err(missed) => {
                carries.add(*missed);
                sampler.drop_grasp(pick.grasp);
            }
        }
    }
    let mut missed = GoalFailure::new(cx.object_name(), Stage::Carry);
    missed.message = carries.last.clone().unwrap_or_default();
    Err(carries.conclude(missed, &sampler))
}

/// The free motions with the object that were not found, each with another grasp.
#[derive(Default)]
struct Carries {
    rejections: Rejections,
    nearest: Option<Nearest>,
    /// What ended the last one.
    last: Option<String>,
}

impl Carries {
    fn add(&mut self, missed: GoalFailure) {
        self.rejections.merge(&missed.rejections);
        self.rejections.add(Filter::Path);
        self.nearest = nearer(self.nearest, missed.nearest);
        self.last = Some(missed.message);
    }

    /// The failure that ends planning for the goal, with the counts of everything before it.
    fn conclude(&self, mut missed: Box<GoalFailure>, sampler: &PickSampler<'_, '_>) -> Box<GoalFailure> {
        missed.tried = sampler.tried();
        missed.rejections.merge(&sampler.rejections);
        missed.rejections.merge(&self.rejections);
        missed.nearest = nearer(missed.nearest, self.nearest);
        missed
    }
}

fn nearer(a: Option<Nearest>, b: Option<Nearest>) -> Option<Nearest> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.distance < a.distance { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Whether the object could be lifted at all: nothing else overlaps it where it stands.
fn stands_free(cx: &GoalContext<'_>, scene: &Scene) -> Result<(), Box<GoalFailure>> {
    let world_from_object = *scene.world_from_body(cx.body());
    scene.body_against_bodies(cx.body(), world_from_object, cx.sink()).map_err(|touch| {
        let mut failure = GoalFailure::new(cx.object_name(), Stage::Start);
        failure.message = "it overlaps with something where it stands".into();
        failure.rejections.add_because(Filter::Standing, cause(scene, touch.into()));
        failure
    })
}

/// Free motion with the object from the end of the lift to the start of a lowering, smoothed.
fn plan_carry(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    grasp: &Grasp,
    pick: &Pick,
    keep_upright: Option<f64>,
    destinations: &mut Destinations,
    budget: &Budget<'_>,
    rng: &mut robotc_core::rng::Rng,
    observer: &mut dyn Observer,
) -> Result<(Vec<Vec<f64>>, Placing), Box<GoalFailure>> {
    let from = &pick.lift[pick.lift.len() - 1];
    let constraint = keep_upright.map(|tilt| upright(cx, grasp, tilt));
    let constraint = constraint.as_ref().map(|u| u as &dyn Constraint);
    let closed = cx.with_fingers(q, &grasp.closed);
    let mut placings = placings(cx, scene, grasp, from, q);
    placings.constraint = constraint;
    placings.found.push(pick.placing.clone());
    let mut rejections = Rejections::default();
    let mut placing_rng = rng.clone();
    let mut sampler = PlacingSampler {
        placings: &mut placings,
        destinations,
        rejections: &mut rejections,
        rng: &mut placing_rng,
        handed_out: 0,
    };
    let rules = cx.free(Some(cx.grip(&grasp.object_from_tool)));
    let mut carry = FreeMotion { cx, scene, q: &closed, rules, constraint, kind: SegmentKind::Carry };
    match carry.search(from, &mut sampler, budget, rng, observer) {
        Ok(solution) => {
            let path = carry.smoothed(solution.path, budget, rng);
            Ok((path, placings.found.swap_remove(solution.goal)))
        }
        Err(failure) => {
            let mut missed = carry.failed(&failure);
            missed.rejections.merge(&rejections);
            Err(missed)
        }
    }
}

/// All paths of one goal.
struct Motions {
    reach: Vec<Vec<f64>>,
    pick: Pick,
    carry: Vec<Vec<f64>>,
    placing: Placing,
}

impl Motions {
    fn into_segments(
        self,
        cx: &GoalContext<'_>,
        scene: &Scene,
        q: &Configuration,
        grasp: &Grasp,
        rejections: Rejections,
    ) -> Reached {
        let Motions { reach, pick, carry, placing } = self;
        let gripper = cx.gripper();
        let grip = cx.grip(&grasp.object_from_tool);
        let mut at_grasp = cx.with_fingers(q, &grasp.closed);
        at_grasp.set(cx.problem.arm.dofs(), &pick.lift[0]);
        let gap = cx.options.fine_margin();
        let held = Held {
            object: cx.object,
            link: grip.link,
            link_from_object: grip.link_from_body,
            touching: scene.links_touching(&at_grasp, cx.gripper_links, cx.body(), gap),
        };
        let now = q.select(&gripper.dofs);
        let preshape = &gripper.preshapes[grasp.preshape].values;
        let world_from_object: Pose = placing.world_from_object;
        let there = scene.with_body_at(cx.body(), world_from_object);
        let mut made = Maker::new(cx, q);

        made.arm(SegmentKind::Reach, &reach, scene, cx.free(None), None);
        if now != *preshape {
            made.fingers(SegmentKind::Preshape, &now, preshape, scene, None);
        }
        made.arm(SegmentKind::Approach, &pick.approach, scene, cx.touching(), None);
        made.fingers(SegmentKind::Grasp, preshape, &grasp.closed, scene, None);
        made.event(Event::Attach(held.clone()));
        let standing = cx.standing(grip.clone());
        let carrying = cx.free(Some(grip));
        made.arm(SegmentKind::Lift, &pick.lift, scene, standing.clone(), Some(&held));
        made.arm(SegmentKind::Carry, &carry, scene, carrying, Some(&held));
        made.arm(SegmentKind::Lower, &placing.lower, scene, standing, Some(&held));
        made.event(Event::Detach { object: cx.object, world_from_object });
        made.fingers(SegmentKind::Release, &grasp.closed, preshape, &there, None);
        made.arm(SegmentKind::Retreat, &placing.retreat, &there, cx.touching(), None);

        let choice = Choice::Place(PlaceChoice {
            goal: cx.number,
            object: cx.object,
            grasp: pick.grasp,
            world_from_object,
            rejections,
        });
        Reached { segments: made.segments, choice, q: made.q }
    }
}
