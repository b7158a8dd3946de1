//! Driving to where a goal can be reached from: folded above its footprint, a base goes to a place that is known to be good for
//! the arm (thesis section 3.6).

use robotc_core::robot::{Base, Robot};
use robotc_core::task::Goal;
use robotc_core::{Configuration, DofIdx, Pose, Seed};

use super::folding::fold;
use super::free_motion::start_rules;
use super::maker::Maker;
use super::places::{ReachedBases, Standing, Targets};
use super::plan::{GoalFailure, SegmentKind, Stage};
use super::problem::{GoalContext, Manipulation, motion_limits};
use super::sequence::Reached;
use crate::budget::Budget;
use crate::goal::FixedGoals;
use crate::placement::{BasePlacement, PlacementArm, PlacementOptions, Prism};
use crate::rrt::RrtConnect;
use crate::scene::{RobotChecker, Rules, Scene};
use crate::smooth::smooth;
use crate::space::{Axis, Space};
use crate::timing::MotionLimits;

/// Places from which a goal is tried.
pub(super) const PLACES: u64 = 20;

/// How places are looked for.
pub(super) const PLACEMENT: PlacementOptions = PlacementOptions { places: 20, max_places: 4000 };

/// A base that drives by joints of the robot's description: x, y and heading in the frame of its root.
pub(super) struct Drive {
    pub(super) dofs: [DofIdx; 3],
    pub(super) prism: Prism,
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
    pub(super) fn world_from_arm(&self, q: &Configuration) -> Pose {
        let base = self.task.robot.arms[self.task.arm].base;
        self.scene.world_from_robot() * self.kinematics.root_from_link(q, base)
    }
}

/// Shares of the draws that searches for a way of a door or a drawer get at each place, stage by stage: what can be opened from a place
/// is mostly opened soon, and another place is worth more than a long search from one that is no good.
/// At first there are none but those that go straight on, at the first few places alone.
const STAGES: [f64; 4] = [0.0, 0.002, 0.02, 0.1];

/// Places at which ways straight on come before all others.
const FIRST_PLACES: u64 = 6;

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
    let fold = fold(cx, scene, q, &drive, None, budget, seed.split("fold"))?;
    let mut folded = q.clone();
    folded.set(cx.problem.arm.dofs(), &fold[fold.len() - 1]);
    let arms = [PlacementArm { cost: 1.0, grasps: targets.grasps.clone() }];
    let rng = seed.split("free").rng();
    let mut standing = Standing::new(cx, scene, &targets, None, &drive, &folded, rng);
    let mut bases = ReachedBases { cx, drive: &drive, targets: &targets };
    let mut places = BasePlacement::new(&mut standing, &mut bases, &arms, PLACEMENT, seed.split("places"));
    let mut last = missed;
    // Only searches for a way of an article are long or short.
    let stages = if matches!(cx.goal(), Goal::Open { .. }) { 0..STAGES.len() } else { 1..2 };
    let mut known: Vec<Place> = Vec::new();
    let mut tried = 0;
    for stage in stages {
        let most = if stage == 0 { FIRST_PLACES } else { PLACES };
        let mut options = cx.options.clone();
        options.caging_search.max_draws =
            (STAGES[stage] * f64::from(options.caging_search.max_draws)).ceil() as u32;
        let mut number = 0;
        loop {
            if number == known.len() {
                if stage > 1 || tried == most {
                    break;
                }
                let drawn = places.next_base(budget).map_err(|interrupt| last.interrupted(interrupt))?;
                let Some(base) = drawn else { break };
                tried += 1;
                let seed = seed.split("place").at(tried);
                let rules = cx.free(None);
                let Some(path) = drive_to(cx, scene, &drive, &folded, &base, rules, budget, seed) else {
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
            // What is looked at first is looked at again in the same order.
            let seed = seed.split("stage").at(stage.saturating_sub(1) as u64);
            match there(&here, stands, seed) {
                Ok(reached) => {
                    let mut made = Maker::new(cx, q);
                    if fold.len() > 1 {
                        made.arm(SegmentKind::Fold, &fold, scene, start_rules(cx, scene, q, &fold[0]), None);
                    }
                    made.drive(&drive, path, scene, cx.free(None), None);
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

/// A path of the folded robot, and of what it holds, to a place; `None` when there is none.
pub(super) fn drive_to(
    cx: &GoalContext<'_>,
    scene: &Scene,
    drive: &Drive,
    folded: &Configuration,
    place: &[f64; 3],
    rules: Rules,
    budget: &Budget<'_>,
    seed: Seed,
) -> Option<Vec<Vec<f64>>> {
    let resolution = cx.options.resolution;
    let mut checker = RobotChecker::new(scene, &drive.space, &drive.dofs, folded, rules, resolution);
    let mut rng = seed.split("drive").rng();
    let mut goals = FixedGoals::new(vec![place.to_vec()]);
    let found = RrtConnect::new(&folded.select(&drive.dofs))
        .run(&mut checker, None, &mut goals, &cx.options.rrt, budget, &mut rng)
        .ok()?;
    Some(smooth(&mut checker, found.path, &cx.options.smoothers, budget, &mut rng))
}
