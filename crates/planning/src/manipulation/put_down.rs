//! From an object in the hand to the object where it belongs.

use robotc_core::rng::Rng;
use robotc_core::task::Goal;
use robotc_core::{Configuration, Pose};

use super::free_motion::FreeMotion;
use super::maker::Maker;
use super::picks::{placings, upright};
use super::placings::{Destinations, Placing, PlacingSampler};
use super::plan::{Event, GoalFailure, Held, SegmentKind};
use super::problem::GoalContext;
use super::rejections::Rejections;
use super::sequence::Observer;
use crate::budget::Budget;
use crate::constraint::{Constraint, Upright};
use crate::grasp::Grasp;
use crate::scene::Scene;

/// How an object leaves the hand.
pub(super) struct PutDown {
    carry: Vec<Vec<f64>>,
    placing: Placing,
}

/// How the object has to be held on its way, in this grasp.
pub(super) fn kept_upright<'a>(cx: &GoalContext<'a>, grasp: &Grasp) -> Option<Upright<'a>> {
    match cx.goal() {
        Goal::Place { keep_upright, .. } => keep_upright.map(|tilt| upright(cx, grasp, tilt)),
        Goal::Open { .. } => None,
    }
}

/// Free motion with the object from the arm at `from` to the start of a lowering, smoothed. `known` is a placing that is good
/// already.
pub(super) fn put_down(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    grasp: &Grasp,
    from: &[f64],
    known: Option<&Placing>,
    destinations: &mut Destinations,
    budget: &Budget<'_>,
    rng: &mut Rng,
    observer: &mut dyn Observer,
) -> Result<PutDown, Box<GoalFailure>> {
    let constraint = kept_upright(cx, grasp);
    let constraint = constraint.as_ref().map(|u| u as &dyn Constraint);
    let closed = cx.with_fingers(q, &grasp.closed);
    let mut placings = placings(cx, scene, grasp, from, q);
    placings.constraint = constraint;
    placings.found.extend(known.cloned());
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
    let mut motion = FreeMotion { cx, scene, q: &closed, rules, constraint, kind: SegmentKind::Carry };
    match motion.search(from, &mut sampler, budget, rng, observer) {
        Ok(solution) => {
            let carry = motion.smoothed(solution.path, budget, rng);
            Ok(PutDown { carry, placing: placings.found.swap_remove(solution.goal) })
        }
        Err(failure) => {
            let mut missed = motion.failed(&failure);
            missed.rejections.merge(&rejections);
            Err(missed)
        }
    }
}

impl PutDown {
    /// The segments from the free motion to the retreat; returns where the object then stands.
    pub(super) fn into_segments(
        self,
        cx: &GoalContext<'_>,
        scene: &Scene,
        grasp: &Grasp,
        held: &Held,
        made: &mut Maker<'_, '_>,
    ) -> Pose {
        let Self { carry, placing: Placing { world_from_object, lower, retreat } } = self;
        let grip = cx.grip(&grasp.object_from_tool);
        let preshape = &cx.gripper().preshapes[grasp.preshape].values;
        let there = scene.with_body_at(cx.body(), world_from_object);
        made.arm(SegmentKind::Carry, &carry, scene, cx.free(Some(grip.clone())), Some(held));
        made.arm(SegmentKind::Lower, &lower, scene, cx.standing(grip), Some(held));
        made.event(Event::Detach { object: cx.object, world_from_object });
        made.fingers(SegmentKind::Release, &grasp.closed, preshape, &there, None);
        made.arm(SegmentKind::Retreat, &retreat, &there, cx.touching(), None);
        world_from_object
    }
}
