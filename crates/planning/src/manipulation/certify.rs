//! An independent look at a finished plan: replays it densely and believes nothing that the planner found.

use robotc_core::ids::Idx;
use robotc_core::task::Goal;
use robotc_core::{BodyIdx, Configuration, Trajectory};
use thiserror::Error;

use super::options::ManipulationOptions;
use super::plan::{Event, Held, Plan, Segment, SegmentKind};
use super::problem::{Manipulation, allowed_sink, gripper_links, motion_limits};
use crate::edge::EdgeChecker;
use crate::scene::{Grip, RobotChecker, Rules, Scene};
use crate::space::{Axis, Space};
use crate::timing::TimedPath;

/// What is wrong with a plan.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("segment {segment} ({kind}), {time:.3} s: {message}")]
pub struct Uncertified {
    /// Position in [`Plan::segments`].
    pub segment: usize,
    /// Its kind.
    pub kind: SegmentKind,
    /// Seconds from the start of the segment.
    pub time: f64,
    /// What is wrong.
    pub message: String,
}

/// Largest jump between the end of one segment and the start of the next, radians or metres.
const JUMP: f64 = 1e-6;

/// Largest use of a speed limit that counts as keeping it.
const LIMIT_USE: f64 = 1.0 + 1e-6;

/// Farthest that an object may be from where the plan says it is put, metres.
const PLACED: f64 = 1e-5;

/// Replays a plan from the start of the problem: segments join, limits hold, nothing collides (no point travels more
/// than [`ManipulationOptions::certified_step`] between two looks), held objects stay as upright as asked and end up where the plan says.
///
/// Returns the number of states looked at.
pub fn certify(
    problem: &Manipulation<'_>,
    options: &ManipulationOptions,
    plan: &Plan,
) -> Result<u64, Uncertified> {
    let resolution = options.certified_step;
    let robot = &*problem.task.robot;
    let gripper = robot.arms[problem.task.arm].gripper;
    let links = gripper.map_or_else(Vec::new, |g| gripper_links(robot, g));
    let mut scene = problem.scene.clone();
    let mut q = problem.start.clone();
    let mut held: Option<Held> = None;
    let mut states = 0;
    for (number, segment) in plan.segments.iter().enumerate() {
        let wrong = |time, message| Uncertified { segment: number, kind: segment.kind, time, message };
        let trajectory = &segment.trajectory;
        let here = q.select(trajectory.dofs());
        if here.iter().zip(trajectory.start()).any(|(a, b)| (a - b).abs() > JUMP) {
            return Err(wrong(0.0, "the motion does not start where the last one ended".into()));
        }
        if segment.held != held {
            return Err(wrong(0.0, "what is held does not follow from the events".into()));
        }
        let limits = motion_limits(robot, trajectory.dofs());
        let timed = TimedPath { times: trajectory.times().to_vec(), knots: trajectory.knots().to_vec() };
        if timed.limit_use(&limits) > LIMIT_USE {
            return Err(wrong(0.0, "a speed limit is exceeded".into()));
        }
        let rules = rules(problem, options, segment, &links);
        states += replay(problem, &scene, &q, segment, rules, resolution)
            .map_err(|(time, message)| wrong(time, message))?;
        q.set(trajectory.dofs(), trajectory.end());
        let end = trajectory.duration();
        match &segment.event {
            Some(Event::Attach(what)) => {
                let world_from_link =
                    scene.world_from_robot() * problem.kinematics.root_from_link(&q, what.link);
                let expected = world_from_link * what.link_from_object;
                let offset = expected
                    .inv_mul(scene.world_from_body(BodyIdx::new(what.object)))
                    .translation
                    .vector
                    .norm();
                if offset > PLACED {
                    return Err(wrong(end, "the object is not where it is picked up".into()));
                }
                held = Some(what.clone());
            }
            Some(Event::Detach { object, world_from_object }) => {
                let Some(what) = held.take().filter(|h| h.object == *object) else {
                    return Err(wrong(end, "an object is put down that is not held".into()));
                };
                let world_from_link =
                    scene.world_from_robot() * problem.kinematics.root_from_link(&q, what.link);
                let reached = world_from_link * what.link_from_object;
                if reached.inv_mul(world_from_object).translation.vector.norm() > PLACED {
                    return Err(wrong(end, "the object is not put where the plan says".into()));
                }
                scene.place(BodyIdx::new(*object), *world_from_object);
            }
            None => {}
        }
    }
    Ok(states)
}

/// What may touch what during a segment, derived from its kind alone.
fn rules(
    problem: &Manipulation<'_>,
    options: &ManipulationOptions,
    segment: &Segment,
    links: &[robotc_core::LinkIdx],
) -> Rules {
    let Goal::Place { object, .. } = problem.task.goals[segment.goal];
    let held = segment.held.as_ref().map(|h| Grip {
        body: BodyIdx::new(h.object),
        link: h.link,
        link_from_body: h.link_from_object,
    });
    let near = matches!(
        segment.kind,
        SegmentKind::Approach | SegmentKind::Grasp | SegmentKind::Release | SegmentKind::Retreat
    );
    let stands = matches!(segment.kind, SegmentKind::Lift | SegmentKind::Lower);
    Rules {
        margin: 0.0,
        held,
        gripper: links.to_vec(),
        target: near.then_some(BodyIdx::new(object)),
        sink: stands.then(|| allowed_sink(problem, options, object)),
    }
}

/// Looks at the motion in steps of the resolution, at every one.
fn replay(
    problem: &Manipulation<'_>,
    scene: &Scene,
    q: &Configuration,
    segment: &Segment,
    rules: Rules,
    resolution: f64,
) -> Result<u64, (f64, String)> {
    let trajectory = &segment.trajectory;
    let robot = &*problem.task.robot;
    let axis = |dof: &robotc_core::DofIdx| {
        let d = &robot.model.dofs()[*dof];
        // Values of limits may be exceeded by rounding.
        Axis { lower: d.lower - 1e-9, upper: d.upper + 1e-9, wraps: d.continuous, weight: 1.0 }
    };
    let space = Space::new(trajectory.dofs().iter().map(axis).collect());
    let Goal::Place { keep_upright, .. } = problem.task.goals[segment.goal];
    let mut checker =
        RobotChecker::new(scene, &space, trajectory.dofs(), q, rules, resolution).without_clearance();
    for (time, at) in dense_states(&checker, trajectory, resolution) {
        if let (Some(tilt), Some(held), SegmentKind::Carry) = (keep_upright, &segment.held, segment.kind) {
            let mut full = q.clone();
            full.set(trajectory.dofs(), &at);
            let root_from_link = problem.kinematics.root_from_link(&full, held.link);
            let axis = (scene.world_from_robot() * root_from_link * held.link_from_object).rotation
                * nalgebra::Vector3::z();
            if axis.x.hypot(axis.y).atan2(axis.z) > tilt + 1e-6 {
                return Err((time, "the held object tilts too far".into()));
            }
        }
        checker.state(&at).map_err(|by| (time, checker.describe(by)))?;
    }
    Ok(checker.states())
}

/// Times and positions along a trajectory so that no point travels more than the resolution in between; the ends are
/// among them.
fn dense_states(
    checker: &RobotChecker<'_>,
    trajectory: &Trajectory,
    resolution: f64,
) -> Vec<(f64, Vec<f64>)> {
    let (times, knots) = (trajectory.times(), trajectory.knots());
    let mut states = vec![(0.0, trajectory.start().to_vec())];
    for (t, k) in times.windows(2).zip(knots.windows(2)) {
        let difference: Vec<f64> = k[0].positions.iter().zip(&k[1].positions).map(|(a, b)| b - a).collect();
        let pieces = (checker.travel(&difference) / resolution).ceil().max(1.0) as usize;
        for i in 1..=pieces {
            let time = t[0] + (t[1] - t[0]) * i as f64 / pieces as f64;
            states.push((time, trajectory.sample(time).positions));
        }
    }
    states
}
