//! Kinematic execution of a plan: a simulated controller that follows trajectories, and what the world does meanwhile.

use robotc_core::ids::Idx;
use robotc_core::task::{Article, Goal, Task};
use robotc_core::{BodyIdx, Configuration, Pose, World};
use robotc_planning::manipulation::{Choice, Event, Plan, SegmentKind};
use thiserror::Error;

/// The state of the world at one tick of the controller.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Seconds since the start.
    pub time: f64,
    /// Joint values.
    pub q: Configuration,
    /// Where each object of the task is, in their order.
    pub world_from_objects: Vec<Pose>,
    /// The value of the joint of each article of the task, in their order.
    pub articles: Vec<f64>,
}

/// A stretch of the execution.
#[derive(Debug, Clone, PartialEq)]
pub struct ExecutedSegment {
    /// What it was for.
    pub kind: SegmentKind,
    /// Position in `Task::goals` of the goal it served.
    pub goal: usize,
    /// Name of the object or article that it moves.
    pub about: String,
    /// Seconds since the start when it began and ended.
    pub span: [f64; 2],
}

/// What happened.
#[derive(Debug, Clone)]
pub struct Execution {
    /// Ticks in order of time; the first is the start, the last the end.
    pub ticks: Vec<Tick>,
    /// Segments in order of time.
    pub segments: Vec<ExecutedSegment>,
    /// The world at the end.
    pub world: World,
}

/// Why an execution stopped.
#[derive(Debug, Clone, Error, PartialEq)]
pub enum ExecutionError {
    /// The plan asks the arm to be somewhere else than it is.
    #[error("segment {segment} ({kind}) starts {distance:.3} rad or m away from where the robot is")]
    Jump {
        /// Position in the plan.
        segment: usize,
        /// Its kind.
        kind: SegmentKind,
        /// Largest difference of a joint.
        distance: f64,
    },
    /// The plan lets go of something that is not held.
    #[error("segment {segment} puts {object} down, which is not held")]
    NotHeld {
        /// Position in the plan.
        segment: usize,
        /// Name of the object.
        object: String,
    },
}

/// Largest difference between where a motion starts and where the robot is.
const JUMP: f64 = 1e-6;

impl Execution {
    /// Seconds in all.
    pub fn duration(&self) -> f64 {
        self.ticks.last().map_or(0.0, |tick| tick.time)
    }

    /// Goals of the task whose object or article did not end up where the task allows it, with the distance in metres from the
    /// place the plan chose, or that of the article's joint from its goal.
    pub fn missed_goals(&self, task: &Task, plan: &Plan) -> Vec<(usize, f64)> {
        let mut missed = Vec::new();
        for number in 0..task.goals.len() {
            let off = match plan.choices.iter().find(|c| c.goal() == number) {
                None => f64::INFINITY,
                Some(Choice::Place(choice)) => {
                    let at = self.world.bodies()[BodyIdx::new(choice.object)].world_from_body;
                    (choice.world_from_object.translation.vector - at.translation.vector).norm()
                }
                Some(Choice::Open(choice)) => {
                    let at = self.ticks.last().map_or(f64::INFINITY, |tick| tick.articles[choice.article]);
                    // An earlier of several goals of one article is history.
                    let newer = |goal: &Goal| matches!(goal, Goal::Open { article, .. } if *article == choice.article);
                    match task.goals[number + 1..].iter().any(newer) {
                        true => 0.0,
                        false => (at - choice.value).abs(),
                    }
                }
            };
            if off > 1e-4 {
                missed.push((number, off));
            }
        }
        missed
    }
}

/// Follows a plan from the start `world` (objects of the task first), `rate` ticks a second.
///
/// The robot does exactly what the trajectories say; what the gripper holds moves with it, everything else stays.
pub fn execute(mut world: World, task: &Task, plan: &Plan, rate: f64) -> Result<Execution, ExecutionError> {
    let mut ticks = Vec::new();
    let mut segments = Vec::new();
    let mut start = world.time();
    let mut articles: Vec<f64> = task.articles.iter().map(Article::value).collect();
    ticks.push(tick(&world, task, &articles));
    for (number, segment) in plan.segments.iter().enumerate() {
        let trajectory = &segment.trajectory;
        let here = world.q().select(trajectory.dofs());
        let distance = here.iter().zip(trajectory.start()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if distance > JUMP {
            return Err(ExecutionError::Jump { segment: number, kind: segment.kind, distance });
        }
        let duration = trajectory.duration();
        let steps = (duration * rate).ceil().max(1.0) as usize;
        for step in 1..=steps {
            let at = duration * step as f64 / steps as f64;
            let mut q = world.q().clone();
            q.set(trajectory.dofs(), &trajectory.sample(at).positions);
            world.set_q(q);
            world.set_time(start + at);
            if let Some(motion) = &segment.article {
                let value = motion.values.sample(at).positions[0];
                articles[motion.article] = value;
                for (obstacle, world_from_body) in task.articles[motion.article].moved_bodies(value) {
                    world.place(BodyIdx::new(task.objects.len() + obstacle), world_from_body);
                }
            }
            if step == steps {
                apply(&mut world, task, number, segment.event.as_ref())?;
            }
            if duration > 0.0 {
                ticks.push(tick(&world, task, &articles));
            }
        }
        let end = start + duration;
        let about = plan.name_of(task, segment.goal).to_owned();
        segments.push(ExecutedSegment { kind: segment.kind, goal: segment.goal, about, span: [start, end] });
        start = end;
    }
    Ok(Execution { ticks, segments, world })
}

fn apply(
    world: &mut World,
    task: &Task,
    segment: usize,
    event: Option<&Event>,
) -> Result<(), ExecutionError> {
    match event {
        None => {}
        Some(Event::Attach(held)) => {
            world.grab(BodyIdx::new(held.object), held.link, held.touching.clone());
        }
        Some(Event::Detach { object, world_from_object }) => {
            let body = BodyIdx::new(*object);
            if !world.grabs().iter().any(|grab| grab.body == body) {
                return Err(ExecutionError::NotHeld { segment, object: task.objects[*object].name.clone() });
            }
            world.place(body, *world_from_object);
        }
    }
    Ok(())
}

fn tick(world: &World, task: &Task, articles: &[f64]) -> Tick {
    let place = |i: usize| world.bodies()[BodyIdx::new(i)].world_from_body;
    Tick {
        time: world.time(),
        q: world.q().clone(),
        world_from_objects: (0..task.objects.len()).map(place).collect(),
        articles: articles.to_vec(),
    }
}
