//! Driving with an object in the hand, from where it is taken to where it can be put down (thesis section 3.6 and algorithm 3.12).

use robotc_core::{Configuration, Seed};

use super::driving::{Drive, PLACEMENT, PLACES, drive_to, plan_driving};
use super::folding::{Load, fold};
use super::maker::Maker;
use super::pick_up::{pick_up, plan_place};
use super::picks::{Lifted, Pick, PickSampler, Target};
use super::places::{ReachedBases, Standing, Targets, Unloading};
use super::placings::Destinations;
use super::plan::{GoalFailure, SegmentKind, Stage};
use super::problem::{GoalContext, Manipulation};
use super::put_down::{PutDown, kept_upright, put_down};
use super::rejections::Rejections;
use super::sequence::{Observer, Reached};
use crate::budget::Budget;
use crate::constraint::Constraint;
use crate::grasp::Grasp;
use crate::placement::{BasePlacement, PlacementArm};
use crate::scene::Scene;

/// Plans a goal to place an object that cannot be reached from where the robot stands, as `missed` says: from one place that is good for
/// the object and its destination, if there is one, or else from two, with the object in the hand in between.
pub(super) fn plan_place_elsewhere(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    missed: Box<GoalFailure>,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<Reached, Box<GoalFailure>> {
    let over = |missed: &GoalFailure| missed.interrupt.is_some() || missed.stage == Stage::Start;
    let Some(drive) = Drive::of(cx.robot()) else { return Err(missed) };
    if over(&missed) {
        return Err(missed);
    }
    let seed = seed.split("drive");
    let targets = Targets::of_grasps(cx, scene, seed.split("destinations"));
    let bases = ReachedBases { cx, drive: &drive, targets: &targets };
    let taken = targets.clone().without_destinations();
    if bases.share_a_place(&mut seed.split("shared").rng()) {
        let mut there = |cx: &GoalContext<'_>, q: &Configuration, seed: Seed| {
            // What is shown of searches is drawn where the robot stands at first.
            plan_place(cx, scene, q, budget, seed, &mut ())
        };
        match plan_driving(cx, scene, q, (missed, targets), budget, seed, &mut there) {
            Err(missed) if !over(&missed) => {}
            done => return done,
        }
    }
    let seed = seed.split("carry");
    let mut there =
        |cx: &GoalContext<'_>, q: &Configuration, seed: Seed| take_away(cx, scene, q, &drive, budget, seed);
    match there(cx, q, seed.split("here")) {
        Err(missed) if !over(&missed) => {
            plan_driving(cx, scene, q, (missed, taken), budget, seed, &mut there)
        }
        done => done,
    }
}

/// Plans to pick the object up from configuration `q`, to fold with it, to drive, and to put it down.
fn take_away(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    drive: &Drive,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<Reached, Box<GoalFailure>> {
    let mut then = |pick: &Pick, sampler: &mut PickSampler<'_, '_>, _: &mut _, _: &mut dyn Observer| {
        let Target { cx, set, destinations, .. } = &mut sampler.targets[pick.target];
        let grasp = &set.grasps[pick.grasp];
        let mut lifted = cx.with_fingers(q, &grasp.closed);
        lifted.set(cx.problem.arm.dofs(), &pick.lift[pick.lift.len() - 1]);
        let seed = seed.split("away").at(cx.object as u64).at(pick.grasp as u64);
        carry_off(cx, scene, &lifted, drive, grasp, destinations, budget, seed)
    };
    let (picked, away) = pick_up(cx, scene, q, Lifted::TakenAway, budget, seed, &mut (), &mut then)?;
    let cx = &GoalContext { object: picked.object, ..*cx };
    let mut made = Maker::new(cx, q);
    let (grasp, held) = picked.segments(cx, scene, q, &mut made);
    let carrying = cx.free(Some(cx.grip(&grasp.object_from_tool)));
    if away.fold.len() > 1 {
        made.arm(SegmentKind::Fold, &away.fold, scene, carrying.clone(), Some(&held));
    }
    made.drive(drive, &away.path, scene, carrying, Some(&held));
    let world_from_object = away.put.into_segments(cx, scene, grasp, &held, &mut made);
    Ok(picked.reached(cx, world_from_object, made))
}

/// The way of an object in the hand to its destination.
struct Away {
    /// The arm, into a posture in which the robot may drive with the object.
    fold: Vec<Vec<f64>>,
    /// The base.
    path: Vec<Vec<f64>>,
    put: PutDown,
}

/// Plans the way of the object that the robot has `lifted` in this grasp.
fn carry_off(
    cx: &GoalContext<'_>,
    scene: &Scene,
    lifted: &Configuration,
    drive: &Drive,
    grasp: &Grasp,
    destinations: &mut Destinations,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<Away, Box<GoalFailure>> {
    let grip = cx.grip(&grasp.object_from_tool);
    let upright = kept_upright(cx, grasp);
    let load = Load { grip: &grip, constraint: upright.as_ref().map(|u| u as &dyn Constraint) };
    let fold = fold(cx, scene, lifted, drive, Some(load), budget, seed.split("fold"))?;
    let from = &fold[fold.len() - 1];
    let mut folded = lifted.clone();
    folded.set(cx.problem.arm.dofs(), from);

    let targets = Targets::of_destinations(grasp, destinations);
    let arms = [PlacementArm { cost: 1.0, grasps: targets.grasps.clone() }];
    let (grip_there, rng) = (grip.clone(), seed.split("free").rng());
    let unloading =
        Unloading { grip: grip_there, destinations: destinations.clone(), rejections: Rejections::default() };
    let load = Some(unloading);
    let mut standing = Standing::new(cx, scene, &targets, load, drive, &folded, rng);
    let mut bases = ReachedBases { cx, drive, targets: &targets };
    let mut places = BasePlacement::new(&mut standing, &mut bases, &arms, PLACEMENT, seed.split("places"));
    let mut last = GoalFailure::new(cx.object_name(), Stage::Carry);
    last.message = "no place to stand was found".into();
    for tried in 0..PLACES {
        let drawn = places.next_base(budget).map_err(|interrupt| last.interrupted(interrupt))?;
        let Some(base) = drawn else { break };
        let (seed, rules) = (seed.split("place").at(tried), cx.free(Some(grip.clone())));
        let Some(path) = drive_to(cx, scene, drive, &folded, &base, rules, budget, seed) else {
            last.message = "no way to drive to where it can be put down from".into();
            continue;
        };
        let mut stands = folded.clone();
        stands.set(&drive.dofs, &path[path.len() - 1]);
        let arm = cx.problem.arm_at(&stands);
        let there = GoalContext { problem: Manipulation { arm: &arm, ..cx.problem }, ..*cx };
        let mut rng = seed.split("put").rng();
        match put_down(&there, scene, &stands, grasp, from, None, destinations, budget, &mut rng, &mut ()) {
            Ok(put) => return Ok(Away { fold, path, put }),
            Err(missed) if missed.interrupt.is_some() => return Err(missed),
            Err(missed) => last = missed,
        }
    }
    last.message = format!("{}; places to put it down from: {}", last.message, places.rejections);
    Err(last)
}
