//! Which grasps of an object can be used for a goal, asked without planning the free motions in between.

use robotc_core::{Pose, Seed};

use super::options::ManipulationOptions;
use super::picks::{Lifted, PickSampler, Target};
use super::plan::Tried;
use super::problem::{GoalContext, Manipulation, finger_space, gripper_links};
use super::rejections::Rejections;
use crate::budget::{Budget, Interrupt};
use crate::goal::{GoalDraw, GoalSampler};

/// A grasp for which approach, lift, lowering and retreat are free, each on one branch of inverse kinematics.
#[derive(Debug, Clone, PartialEq)]
pub struct UsableGrasp {
    /// Position in `Task::objects`.
    pub object: usize,
    /// Position in the object's grasp set.
    pub grasp: usize,
    /// The arm where the straight approach starts.
    pub approach: Vec<f64>,
    /// The arm at the grasp.
    pub at_grasp: Vec<f64>,
    /// Where the object can be put with it.
    pub world_from_object: Pose,
    /// The arm where the object stands there.
    pub at_destination: Vec<f64>,
}

/// What a look for usable grasps found.
#[derive(Debug, Clone, PartialEq)]
pub struct UsableGrasps {
    /// In the order in which they were found; a grasp may come once for each branch of inverse kinematics.
    pub found: Vec<UsableGrasp>,
    /// How many grasps were looked at.
    pub tried: Tried,
    /// Destinations known, and looked at.
    pub destinations: [usize; 2],
    /// What each filter rejected.
    pub rejections: Rejections,
    /// Whether there are no more.
    pub exhausted: bool,
}

/// Looks for the first `most` usable grasps of the objects of goal number `goal` of the task, in the order in which planning tries
/// them (thesis algorithms 3.4 to 3.6). `None` when the goal puts nothing down or the arm has no gripper.
///
/// Nothing is computed that the answer does not need: a grasp is looked at when all before it were rejected, a destination when a grasp has
/// passed everything else.
pub fn usable_grasps(
    problem: &Manipulation<'_>,
    options: &ManipulationOptions,
    goal: usize,
    most: usize,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<Option<UsableGrasps>, Interrupt> {
    let robot = &*problem.task.robot;
    let [first, ..] = problem.task.goals[goal].targets() else { return Ok(None) };
    let Some(gripper) = robot.arms[problem.task.arm].gripper else { return Ok(None) };
    let (links, fingers) = (gripper_links(robot, gripper), finger_space(robot, gripper));
    let cx = GoalContext {
        problem: *problem,
        options,
        number: goal,
        object: first.object,
        done: &[],
        gripper,
        gripper_links: &links,
        finger_space: &fingers,
    };
    let targets = cx.of_targets().into_iter().map(|cx| Target::new(cx, seed.split("destination"))).collect();
    let (q, rng) = (problem.start, seed.split("grasps").rng());
    let mut sampler = PickSampler::new(targets, problem.scene, q, Lifted::PutDown, rng);
    let mut exhausted = false;
    while sampler.found.len() < most && !exhausted {
        exhausted = sampler.draw(budget)? == GoalDraw::Exhausted;
    }
    let first = |path: &[Vec<f64>]| path[0].clone();
    let found = sampler.found.iter().filter_map(|pick| {
        let placing = pick.placing.as_ref()?;
        Some(UsableGrasp {
            object: sampler.targets[pick.target].cx.object,
            grasp: pick.grasp,
            approach: first(&pick.approach),
            at_grasp: first(&pick.lift),
            world_from_object: placing.world_from_object,
            at_destination: first(&placing.retreat),
        })
    });
    let found = found.collect();
    let (tried, mut rejections, mut destinations) = (sampler.tried(), Rejections::default(), [0, 0]);
    for target in &sampler.targets {
        rejections.merge(&target.rejections);
        let [known, looked_at] = target.destinations.counts();
        destinations = [destinations[0] + known, destinations[1] + looked_at];
    }
    Ok(Some(UsableGrasps { found, tried, destinations, rejections, exhausted }))
}
