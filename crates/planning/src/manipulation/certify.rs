//! An independent look at a finished plan: replays it densely and believes nothing that the planner found.

use robotc_core::ids::Idx;
use robotc_core::task::{Article, Goal};
use robotc_core::trajectory::TrajectoryPoint;
use robotc_core::{BodyIdx, Configuration, Trajectory};
use thiserror::Error;

use super::options::ManipulationOptions;
use super::plan::{ArticleMotion, Choice, Event, Held, OpenChoice, Plan, Segment, SegmentKind};
use super::problem::{Manipulation, allowed_sink, gripper_links, motion_limits};
use crate::caging::Cage;
use crate::edge::EdgeChecker;
use crate::mechanism::Mechanism;
use crate::scene::{Along, Grip, MovingArticle, RobotChecker, Rules, Scene};
use crate::space::{Axis, Space};
use crate::timing::{TimeLaw, jerk_use, limit_use};

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
/// than [`ManipulationOptions::certified_step`] between two states that are looked at, or proven by the clearance of the one looked at
/// before), held objects stay as upright as asked and end up where the plan says.
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
    let mut values: Vec<f64> = problem.task.articles.iter().map(Article::value).collect();
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
        let limits = motion_limits(&robot.model, trajectory.dofs());
        if limit_use(trajectory.times(), trajectory.knots(), &limits) > LIMIT_USE {
            return Err(wrong(0.0, "a speed limit is exceeded".into()));
        }
        if options.timing.law != TimeLaw::AlongPath
            && jerk_use(trajectory.times(), trajectory.knots(), &limits) > LIMIT_USE
        {
            return Err(wrong(0.0, "a limit of the jerk is exceeded".into()));
        }
        let object = plan.object_of(segment.goal);
        let rules = rules(problem, options, segment, object, &links);
        states += match &segment.article {
            None => replay(problem, &scene, &q, segment, rules, resolution),
            Some(motion) => {
                let from = std::mem::replace(&mut values[motion.article], motion.values.end()[0]);
                let begins = Situation { scene: &scene, q: &q, value: from };
                replay_article(problem, options, begins, segment, motion, rules)
            }
        }
        .map_err(|(time, message)| wrong(time, message))?;
        if let Some(motion) = &segment.article {
            problem.move_article(&mut scene, motion.article, values[motion.article]);
        }
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
    for choice in &plan.choices {
        if let Choice::Place(choice) = choice {
            let targets = problem.task.goals[choice.goal].targets();
            let target = targets.iter().find(|target| target.object == choice.object);
            if !target.is_some_and(|target| target.destination.admits(&choice.world_from_object)) {
                let (segment, kind) = (plan.segments.len(), SegmentKind::Release);
                let message = "an object is put where the goal does not want it".into();
                return Err(Uncertified { segment, kind, time: 0.0, message });
            }
        }
        if let Choice::Open(OpenChoice { goal, article, .. }) = *choice
            && let Goal::Open { to, .. } = problem.task.goals[goal]
            && (values[article] - to).abs() > PLACED
        {
            let (segment, kind) = (plan.segments.len(), SegmentKind::Open);
            let message = format!("the joint of the article ends at {:.4}", values[article]);
            return Err(Uncertified { segment, kind, time: 0.0, message });
        }
    }
    Ok(states)
}

/// What may touch what during a segment, derived from its kind alone.
fn rules(
    problem: &Manipulation<'_>,
    options: &ManipulationOptions,
    segment: &Segment,
    object: Option<usize>,
    links: &[robotc_core::LinkIdx],
) -> Rules {
    let (target, give) = match problem.task.goals[segment.goal] {
        Goal::Place { .. } => (object.map(BodyIdx::new), None),
        Goal::Open { article, .. } => (Some(BodyIdx::new(problem.handle_of(article))), Some(options.give)),
    };
    let held = segment.held.as_ref().map(|h| Grip {
        body: BodyIdx::new(h.object),
        link: h.link,
        link_from_body: h.link_from_object,
    });
    let near = matches!(
        segment.kind,
        SegmentKind::Approach
            | SegmentKind::Grasp
            | SegmentKind::Open
            | SegmentKind::Release
            | SegmentKind::Retreat
    );
    let sink = match &segment.held {
        Some(held) if matches!(segment.kind, SegmentKind::Lift | SegmentKind::Lower) => {
            Some(allowed_sink(problem, options, held.object))
        }
        _ => None,
    };
    Rules { margin: 0.0, held, gripper: links.to_vec(), target: target.filter(|_| near), give, sink }
}

/// Looks at the motion: what is carried upright in steps of the resolution, collisions as often as the room that is left asks for.
fn replay(
    problem: &Manipulation<'_>,
    scene: &Scene,
    q: &Configuration,
    segment: &Segment,
    rules: Rules,
    resolution: f64,
) -> Result<u64, (f64, String)> {
    let trajectory = &segment.trajectory;
    let space = replay_space(problem, trajectory);
    let keep_upright = match problem.task.goals[segment.goal] {
        Goal::Place { keep_upright, .. } => keep_upright,
        Goal::Open { .. } => None,
    };
    let mut checker = RobotChecker::new(scene, &space, trajectory.dofs(), q, rules, resolution);
    let straight = matches!(segment.kind, SegmentKind::Lift | SegmentKind::Lower);
    if let (Some(tilt), Some(held), false) = (keep_upright, &segment.held, straight) {
        let sample = |time: f64| trajectory.sample(time).positions;
        let mut full = q.clone();
        for (time, at) in dense_states(&checker, trajectory.times(), &sample, resolution) {
            full.set(trajectory.dofs(), &at);
            let root_from_link = problem.kinematics.root_from_link(&full, held.link);
            let axis = (scene.world_from_robot() * root_from_link * held.link_from_object).rotation
                * nalgebra::Vector3::z();
            if axis.x.hypot(axis.y).atan2(axis.z) > tilt + 1e-6 {
                return Err((time, "the held object tilts too far".into()));
            }
        }
    }
    checker.all_along(&Along::new(trajectory)).map_err(|(time, by)| (time, checker.describe(by)))?;
    Ok(checker.states())
}

/// Where a segment begins.
struct Situation<'s> {
    scene: &'s Scene,
    q: &'s Configuration,
    /// The value of the article that moves.
    value: f64,
}

/// Looks at the motion of robot and article: joins, limits of the article's joint, contacts, and whether the gripper stays in
/// the cage.
fn replay_article(
    problem: &Manipulation<'_>,
    options: &ManipulationOptions,
    begins: Situation<'_>,
    segment: &Segment,
    motion: &ArticleMotion,
    rules: Rules,
) -> Result<u64, (f64, String)> {
    let (trajectory, values) = (&segment.trajectory, &motion.values);
    let article = &problem.task.articles[motion.article];
    let wrong = |message: &str| Err((0.0, message.to_owned()));
    if (values.start()[0] - begins.value).abs() > JUMP {
        return wrong("the article is not where its motion starts");
    }
    if values.times() != trajectory.times() || values.dofs() != [article.dof] {
        return wrong("the motions of robot and article do not belong together");
    }
    let limits = motion_limits(&article.model, values.dofs());
    if limit_use(values.times(), values.knots(), &limits) > LIMIT_USE {
        return wrong("a speed limit of the article is exceeded");
    }
    let Some(mechanism) = Mechanism::of_article(article) else {
        return wrong("the article's joint neither turns nor slides");
    };
    let joints = replay_space(problem, trajectory);
    let (scene, dofs, step) = (begins.scene, trajectory.dofs(), options.certified_step);
    let moving = MovingArticle::new(scene, article, problem.task.objects.len());
    let space = moving.space(&joints);
    let mut checker = RobotChecker::with_article(scene, &space, (dofs, moving), begins.q, rules, step);
    let arm = problem.arm_at(begins.q);
    let opens = values.end()[0] > values.start()[0];
    let cages: Vec<&Cage> =
        problem.cages[motion.article].iter().filter(|cage| cage.hold.moves(opens)).collect();
    let mut within: Option<&Cage> = None;
    let sample = |time: f64| [trajectory.sample(time).positions, values.sample(time).positions].concat();
    for (time, at) in dense_states(&checker, trajectory.times(), &sample, step) {
        let mut q = begins.q.clone();
        q.set(dofs, &at[..dofs.len()]);
        let part = mechanism.world_from_part(at[dofs.len()]);
        let tool = arm.world_from_tool(&q.select(arm.dofs()));
        let part_from_tool = part.inv_mul(&tool);
        let near = |cage: &&Cage| {
            let grip = &cage.grasp.part_from_tool;
            (grip.translation.vector - part_from_tool.translation.vector).norm() <= options.caging.shift
                && grip.rotation.angle_to(&part_from_tool.rotation) <= options.caging.turn
        };
        // Mostly it is still near to the same grip.
        if !within.is_some_and(|cage| near(&cage)) {
            within = cages.iter().copied().find(near);
        }
        if within.is_none() {
            return Err((time, "the gripper leaves the cage".into()));
        }
    }
    let both = together(trajectory, values);
    checker.all_along(&Along::new(&both)).map_err(|(time, by)| (time, checker.describe(by)))?;
    Ok(checker.states())
}

/// Two motions with the same times as one.
fn together(one: &Trajectory, other: &Trajectory) -> Trajectory {
    let knot = |(one, other): (&TrajectoryPoint, &TrajectoryPoint)| TrajectoryPoint {
        positions: [one.positions.as_slice(), &other.positions].concat(),
        velocities: [one.velocities.as_slice(), &other.velocities].concat(),
        accelerations: [one.accelerations.as_slice(), &other.accelerations].concat(),
    };
    let knots = one.knots().iter().zip(other.knots()).map(knot).collect();
    let (dofs, names) = ([one.dofs(), other.dofs()].concat(), [one.names(), other.names()].concat());
    Trajectory::new(dofs, names, one.times().to_vec(), knots).expect("both have these times")
}

/// The space of the joints that a trajectory moves.
fn replay_space(problem: &Manipulation<'_>, trajectory: &Trajectory) -> Space {
    let axis = |dof: &robotc_core::DofIdx| {
        let d = &problem.task.robot.model.dofs()[*dof];
        // Values of limits may be exceeded by rounding.
        Axis { lower: d.lower - 1e-9, upper: d.upper + 1e-9, wraps: d.continuous, weight: 1.0 }
    };
    Space::new(trajectory.dofs().iter().map(axis).collect())
}

/// Times and states of a motion so that no point travels more than the resolution in between: the first, the last, and as few
/// as that takes. Travel is that from one of `times` to the next.
fn dense_states<C: EdgeChecker>(
    checker: &C,
    times: &[f64],
    sample: &dyn Fn(f64) -> Vec<f64>,
    resolution: f64,
) -> Vec<(f64, Vec<f64>)> {
    let mut states = vec![(0.0, sample(0.0))];
    let mut from = states[0].1.clone();
    // Travelled since the last of them.
    let mut since = 0.0;
    for t in times.windows(2) {
        let to = sample(t[1]);
        let difference: Vec<f64> = from.iter().zip(&to).map(|(a, b)| b - a).collect();
        let travel = checker.travel(&difference);
        if since + travel <= resolution {
            since += travel;
            from = to;
            continue;
        }
        if since > 0.0 {
            states.push((t[0], from));
        }
        if travel <= resolution {
            since = travel;
            from = to;
            continue;
        }
        since = 0.0;
        let pieces = (travel / resolution).ceil() as usize;
        for i in 1..pieces {
            let time = t[0] + (t[1] - t[0]) * i as f64 / pieces as f64;
            states.push((time, sample(time)));
        }
        states.push((t[1], to.clone()));
        from = to;
    }
    if since > 0.0 {
        states.push((times[times.len() - 1], from));
    }
    states
}
