//! Folding the arm, and what it holds, above the footprint of the base (thesis algorithm 3.12).

use nalgebra::Point3;
use robotc_core::{Configuration, LinkIdx, Seed};

use super::driving::Drive;
use super::free_motion::{FreeMotion, start_rules};
use super::plan::{GoalFailure, SegmentKind};
use super::problem::GoalContext;
use crate::budget::Budget;
use crate::constraint::Constraint;
use crate::placement::{NavigationPosture, PostureOptions, PrismBodies};
use crate::rrt::RrtFailureReason;
use crate::scene::{Grip, RobotChecker, Scene};

/// What is in the hand while the arm folds.
#[derive(Clone, Copy)]
pub(super) struct Load<'a> {
    pub(super) grip: &'a Grip,
    /// How it has to be held on the way.
    pub(super) constraint: Option<&'a dyn Constraint>,
}

/// How far a load may stick out of the space above the footprint, as shares of its diagonal, tried in turn: what is too large to fit is
/// carried as far inside as can be. Driving looks at the load itself, wherever it is.
const OVERHANG: [f64; 4] = [0.0, 0.15, 0.3, 0.6];

/// A path of the arm into a posture in which the robot may drive; the start alone when it is in one.
pub(super) fn fold(
    cx: &GoalContext<'_>,
    scene: &Scene,
    q: &Configuration,
    drive: &Drive,
    load: Option<Load<'_>>,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<Vec<Vec<f64>>, Box<GoalFailure>> {
    let (robot, arm) = (cx.robot(), cx.problem.arm);
    let bodies = bodies(cx, scene, q, drive, load);
    let start = cx.arm_values(q);
    if bodies.excess(&drive.prism, &start) <= 0.0 {
        return Ok(vec![start]);
    }
    let preset = robot.arms[cx.problem.task.arm].home.clone().unwrap_or_else(|| start.clone());
    let resolution = cx.options.resolution;
    let (constraint, rules) = match load {
        None => (None, start_rules(cx, scene, q, &start)),
        Some(load) => (load.constraint, cx.free(Some(load.grip.clone()))),
    };
    let held = load.map(|load| load.grip.clone());
    let size = load.map_or(0.0, |load| scene.body_diagonal(load.grip.body));
    let mut rng = seed.split("search").rng();
    let mut missed = None;
    for (number, share) in OVERHANG.iter().enumerate() {
        if number > 0 && load.is_none() {
            break;
        }
        let excess = |q: &[f64]| bodies.excess(&drive.prism, q) - share * size;
        let mut checker =
            RobotChecker::new(scene, arm.space(), arm.dofs(), q, cx.free(held.clone()), resolution)
                .with_constraint(constraint);
        let seed = seed.split("postures").at(number as u64);
        let mut postures =
            NavigationPosture::new(&mut checker, &excess, &preset, PostureOptions::default(), seed)
                .with_constraint(constraint);
        let rules = rules.clone();
        let mut motion = FreeMotion { cx, scene, q, rules, constraint, kind: SegmentKind::Fold };
        match motion.search(&start, &mut postures, budget, &mut rng, &mut ()) {
            Ok(solution) => return Ok(motion.smoothed(solution.path, budget, &mut rng)),
            Err(failure) => {
                let mut failed = motion.failed(&failure);
                failed.message = format!("the arm cannot be folded to drive: {}", failed.message);
                missed = Some(failed);
                if failure.reason != RrtFailureReason::NoGoal {
                    break;
                }
            }
        }
    }
    Err(missed.expect("one search at least was made"))
}

/// The corners of everything that the arm moves, load included.
fn bodies<'a>(
    cx: &GoalContext<'a>,
    scene: &Scene,
    q: &Configuration,
    drive: &Drive,
    load: Option<Load<'_>>,
) -> PrismBodies<'a> {
    let (model, arm) = (&cx.robot().model, cx.problem.arm);
    // The prism is in the frame of the base, which is that of the root when the base has not moved.
    let mut at_origin = q.clone();
    at_origin.set(&drive.dofs, &[0.0; 3]);
    let moved = |link: &LinkIdx| arm.dofs().iter().any(|dof| model.dofs_moving(*link).contains(dof));
    let mut corners: Vec<(LinkIdx, Vec<Point3<f64>>)> = Vec::new();
    for link in model.links().indices().filter(moved) {
        corners.push((link, scene.link_parts(link).flat_map(|part| part.points().iter().copied()).collect()));
    }
    if let Some(Load { grip, .. }) = load {
        let parts = scene.body_parts(grip.body);
        let points = parts.flat_map(|part| part.points().iter().map(|p| grip.link_from_body * p));
        corners.push((grip.link, points.collect()));
    }
    PrismBodies { kinematics: cx.problem.kinematics, q: at_origin, dofs: arm.dofs(), corners }
}
