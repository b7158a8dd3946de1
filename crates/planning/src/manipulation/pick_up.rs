//! From where the robot stands to an object in its hand, with something in mind for it.

use robotc_core::rng::Rng;
use robotc_core::{Configuration, Seed};

use super::free_motion::{FreeMotion, start_rules};
use super::maker::Maker;
use super::picks::{Lifted, Pick, PickSampler, Target};
use super::plan::{
    Choice, Event, GoalFailure, Held, Nearest, PassedOver, PlaceChoice, SegmentKind, Stage, Tried,
};
use super::problem::GoalContext;
use super::put_down::put_down;
use super::rejections::{Filter, Rejections, none_usable};
use super::sequence::{Observer, Reached};
use super::stretch::cause;
use crate::budget::Budget;
use crate::grasp::Grasp;
use crate::rrt::RrtFailureReason;
use crate::scene::Scene;

/// How an object comes into the hand.
pub(super) struct PickedUp {
    /// Position in the task.
    pub(super) object: usize,
    reach: Vec<Vec<f64>>,
    pick: Pick,
    rejections: Rejections,
    passed_over: Vec<PassedOver>,
}

/// Plans a goal to place an object from configuration `q`, without driving.
pub(super) fn plan_place(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    budget: &Budget<'_>,
    seed: Seed,
    observer: &mut dyn Observer,
) -> Result<Reached, Box<GoalFailure>> {
    let mut then =
        |pick: &Pick, sampler: &mut PickSampler<'_, '_>, rng: &mut Rng, watch: &mut dyn Observer| {
            let Target { cx, set, destinations, .. } = &mut sampler.targets[pick.target];
            let (grasp, from) = (&set.grasps[pick.grasp], &pick.lift[pick.lift.len() - 1]);
            put_down(cx, scene, q, grasp, from, pick.placing.as_ref(), destinations, budget, rng, watch)
        };
    let (picked, put) = pick_up(cx, scene, q, Lifted::PutDown, budget, seed, observer, &mut then)?;
    let cx = &GoalContext { object: picked.object, ..*cx };
    let mut made = Maker::new(cx, q);
    let (grasp, held) = picked.segments(cx, scene, q, &mut made);
    let world_from_object = put.into_segments(cx, scene, grasp, &held, &mut made);
    Ok(picked.reached(cx, world_from_object, made))
}

/// Plans to take the object into the hand and to do `then` with it; grasps for which that fails are dropped.
pub(super) fn pick_up<T>(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    lifted: Lifted,
    budget: &Budget<'_>,
    seed: Seed,
    observer: &mut dyn Observer,
    then: &mut dyn FnMut(
        &Pick,
        &mut PickSampler<'_, '_>,
        &mut Rng,
        &mut dyn Observer,
    ) -> Result<T, Box<GoalFailure>>,
) -> Result<(PickedUp, T), Box<GoalFailure>> {
    let targets = standing_free(cx, scene, seed.split("destination"))?;
    let mut sampler = PickSampler::new(targets, scene, q, lifted, seed.split("grasps").rng());
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
        match then(&pick, &mut sampler, &mut rng, observer) {
            Ok(done) => {
                let reach = reach.smoothed(solution.path, budget, &mut rng);
                let rejections = sampler.targets[pick.target].rejections.clone();
                let passed_over = sampler.passed_over(Some(pick.target));
                let object = sampler.targets[pick.target].cx.object;
                return Ok((PickedUp { object, reach, pick, rejections, passed_over }, done));
            }
            Err(missed) if missed.interrupt.is_some() => return Err(carries.conclude(missed, &sampler)),
            Err(missed) => {
                carries.add(*missed);
                sampler.drop_grasp(pick.target, pick.grasp);
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
        sampler.targets.iter().for_each(|target| missed.rejections.merge(&target.rejections));
        if sampler.targets.len() > 1 {
            missed.passed_over = sampler.passed_over(None);
        }
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

/// The objects of the goal that can be lifted at all: nothing else overlaps them where they stand.
fn standing_free<'a>(
    cx: &GoalContext<'a>,
    scene: &Scene,
    seed: Seed,
) -> Result<Vec<Target<'a>>, Box<GoalFailure>> {
    let mut failure = GoalFailure::new(cx.object_name(), Stage::Start);
    failure.message = "all that would do were put down for other goals".into();
    let mut free = Vec::new();
    for cx in cx.of_targets() {
        let world_from_object = *scene.world_from_body(cx.body());
        match scene.body_against_bodies(cx.body(), world_from_object, cx.sink()) {
            Ok(()) => free.push(Target::new(cx, seed)),
            Err(touch) => {
                failure.message = "it overlaps with something where it stands".into();
                failure.rejections.add_because(Filter::Standing, cause(scene, touch.into()));
            }
        }
    }
    if free.is_empty() { Err(failure) } else { Ok(free) }
}

impl PickedUp {
    /// The segments up to the end of the lift: the grasp, and what is then held.
    pub(super) fn segments<'a>(
        &self,
        cx: &GoalContext<'a>,
        scene: &Scene,
        q: &Configuration,
        made: &mut Maker<'_, '_>,
    ) -> (&'a Grasp, Held) {
        let Self { reach, pick, .. } = self;
        let grasp = &cx.problem.grasps[cx.object].grasps[pick.grasp];
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
        made.arm(SegmentKind::Reach, reach, scene, cx.free(None), None);
        if now != *preshape {
            made.fingers(SegmentKind::Preshape, &now, preshape, scene, None);
        }
        made.arm(SegmentKind::Approach, &pick.approach, scene, cx.touching(), None);
        made.fingers(SegmentKind::Grasp, preshape, &grasp.closed, scene, None);
        made.event(Event::Attach(held.clone()));
        made.arm(SegmentKind::Lift, &pick.lift, scene, cx.standing(grip), Some(&held));
        (grasp, held)
    }

    /// The goal as it is reached when the object is put down there.
    pub(super) fn reached(
        self,
        cx: &GoalContext<'_>,
        world_from_object: robotc_core::Pose,
        made: Maker<'_, '_>,
    ) -> Reached {
        let choice = Choice::Place(PlaceChoice {
            goal: cx.number,
            object: cx.object,
            grasp: self.pick.grasp,
            world_from_object,
            rejections: self.rejections,
            passed_over: self.passed_over,
        });
        Reached { segments: made.segments, choice, q: made.q }
    }
}
