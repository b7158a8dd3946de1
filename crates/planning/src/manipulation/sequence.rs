//! The whole task: goal after goal, and for each the free motions between its straight ones.

use std::fmt;

use robotc_core::ids::Idx;
use robotc_core::task::{Article, Goal, Task};
use robotc_core::{BodyIdx, Configuration, Seed};
use thiserror::Error;

use super::carrying::plan_place_elsewhere;
use super::driving::plan_driving;
use super::opening::{ArticleWay, plan_opening};
use super::options::ManipulationOptions;
use super::pick_up::plan_place;
use super::places::Targets;
use super::plan::{Choice, OpenChoice, PlaceChoice, Plan, Segment, SegmentKind, SkippedGoal};
use super::problem::{GoalContext, Manipulation, finger_space, gripper_links};
use crate::budget::{Budget, Interrupt};
use crate::rrt::{RrtConnect, RrtStatistics};

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

/// Rounds without any progress after which the goals that are left are given up, where some were reached: other draws of destinations may
/// fit into what room is left.
const STALLED: u32 = 2;

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
    let mut stalled = 0;
    for round in 0.. {
        let mut missed: Vec<SkippedGoal> = Vec::new();
        let before = pending.len();
        for &number in &pending {
            observer.goal(number);
            // A base that drives may have taken the arm along.
            let arm = problem.arm_at(&q);
            let done = taken(problem.task, &plan, number);
            let problem = Manipulation { arm: &arm, ..*problem };
            let cx = GoalContext {
                problem,
                options,
                number,
                object: match problem.task.goals[number] {
                    Goal::Place { ref targets, .. } => targets[0].object,
                    Goal::Open { article, .. } => problem.handle_of(article),
                },
                done: &done,
                gripper,
                gripper_links: &links,
                finger_space: &fingers,
            };
            let seed = seed.split("goal").at(number as u64).at(round);
            let reached = match problem.task.goals[number] {
                Goal::Place { .. } => plan_place(&cx, &scene, &q, budget, seed, observer)
                    .or_else(|missed| plan_place_elsewhere(&cx, &scene, &q, missed, budget, seed)),
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
        stalled += u32::from(pending.len() == before);
        if pending.is_empty() || interrupted || plan.choices.is_empty() || stalled > STALLED {
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

/// Objects that a goal with a choice leaves alone: those that other goals have put down, or that another goal asks for by name.
fn taken(task: &Task, plan: &Plan, number: usize) -> Vec<usize> {
    let others = task.goals.iter().enumerate().filter(|(other, _)| *other != number);
    let named = others.filter_map(|(_, goal)| match goal.targets() {
        [target] => Some(target.object),
        _ => None,
    });
    let put_down = plan.choices.iter().filter_map(|choice| match choice {
        Choice::Place(choice) => Some(choice.object),
        Choice::Open(_) => None,
    });
    named.chain(put_down).collect()
}
