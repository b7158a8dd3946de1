//! An arm on wheels that goes to a grasp: BiSpace, a single tree pulled by the Jacobian, and RRT-Connect to sampled configurations
//! (thesis table 3.3).

use nalgebra::{Point3, Vector3};
use robotc_core::geom::Aabb;
use robotc_core::ids::Idx;
use robotc_core::{BodyIdx, LinkIdx, LinkPoses, Pose, Seed};
use serde::Serialize;

use crate::arm::ArmModel;
use crate::bispace::{
    BiSpaceOptions, JacobianOptions, MobileArm, ToolFailure, ToolFailureReason, ToolSolution,
    TwoStageOptions, bispace, rrt_jt, two_stage,
};
use crate::budget::{Budget, Interrupt};
use crate::edge::walk_path;
use crate::manipulation::{Manipulation, ManipulationOptions, gripper_links};
use crate::scene::{MobileChecker, Movers, Rules, Scene};

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MobileBenchOptions {
    /// Position in the task of the object that the tool goes to.
    pub object: usize,
    /// How far the base may be from where it starts and from the object, metres beyond the box around both.
    pub floor: f64,
    /// Most grasps that are goals, the best of those at which the gripper alone is free.
    pub grasps: usize,
    /// Runs of each search.
    pub seeds: u64,
    /// Seconds after which a run starts again; their time counts.
    pub restart: f64,
    /// Seconds of a run in all.
    pub seconds: f64,
}

impl Default for MobileBenchOptions {
    fn default() -> Self {
        Self { object: 0, floor: 2.0, grasps: 40, seeds: 16, restart: 3.0, seconds: 30.0 }
    }
}

/// The figures of a search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MobileFigures {
    /// `bispace`, `rrt_jt` or `two_stage`.
    pub search: &'static str,
    /// Runs that reached the object, each path proven at half of the resolution.
    pub solved: u64,
    /// Mean seconds, restarts and failures included.
    pub mean_s: f64,
    /// Median seconds.
    pub median_s: f64,
    /// States looked at, mean.
    pub states: f64,
}

/// The figures of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MobileReport {
    /// Name of the task.
    pub scene: String,
    /// Coordinates of base and arm.
    pub joints: usize,
    /// Goals of the tool.
    pub goals: usize,
    /// Runs of each search.
    pub seeds: u64,
    /// BiSpace, RRT-JT, two stages.
    pub searches: Vec<MobileFigures>,
}

/// Plans the task's robot, as if it stood on wheels, from where it is to a grasp of an object. `None` without a gripper or without a
/// grasp that is free.
pub fn measure_mobile(
    problem: &Manipulation<'_>,
    planner: &ManipulationOptions,
    options: &MobileBenchOptions,
    now: &dyn Fn() -> f64,
    done: &mut dyn FnMut(u64, u64),
) -> Option<MobileReport> {
    let task = problem.task;
    let gripper = task.robot.arms[task.arm].gripper?;
    let hand = Hand::new(problem, gripper, options.object, planner.fine_margin());
    let goals = hand.goals(problem, options, planner.approach);
    if goals.is_empty() {
        return None;
    }
    let arm = at_origin(problem);
    let [start, floor] = start_and_floor(problem, options);
    let floor = ([floor[0], floor[1]], [floor[2], floor[3]]);
    let rules = Rules { margin: planner.margin, gripper: hand.links.clone(), ..Rules::default() };
    let from = [start.as_slice(), &task.start.select(arm.dofs())].concat();
    let checker = |resolution: f64, rules: &Rules| {
        MobileChecker::new(
            problem.scene,
            floor,
            arm.space(),
            arm.dofs(),
            &task.start,
            rules.clone(),
            resolution,
        )
    };
    let base_height = task.world_from_robot.translation.z;
    let bounds = Aabb {
        low: Point3::new(floor.0[0], floor.0[1], base_height - arm.reach()),
        high: Point3::new(floor.1[0], floor.1[1], base_height + arm.reach()),
    };
    let names = ["bispace", "rrt_jt", "two_stage"];
    let mut runs: [Vec<(bool, f64, u64)>; 3] = Default::default();
    for seed in 0..options.seeds {
        // The searches take turns, so that what else the machine does falls on all of them.
        for (number, runs) in runs.iter_mut().enumerate() {
            let began = now();
            let (mut states, mut solved) = (0, None);
            for restart in 0.. {
                let attempt = now();
                let interrupt = || (now() - attempt > options.restart).then_some(Interrupt::TimeUp);
                let budget = Budget::new(&interrupt);
                let mut check = |a: &Pose, b: &Pose| hand.moves(a, b);
                let mut workspace = MobileArm::new(&arm, bounds, 0.3, &mut check);
                let mut robot = checker(planner.resolution, &rules);
                let seed = Seed::new(seed).at(restart);
                let found: Result<ToolSolution, ToolFailure> = match number {
                    0 => bispace(
                        &mut workspace,
                        &mut robot,
                        &from,
                        &goals,
                        &BiSpaceOptions::default(),
                        &budget,
                        &mut seed.rng(),
                    ),
                    1 => rrt_jt(
                        &mut workspace,
                        &mut robot,
                        &from,
                        &goals,
                        &JacobianOptions::default(),
                        &budget,
                        &mut seed.rng(),
                    ),
                    _ => two_stage(
                        &mut workspace,
                        &mut robot,
                        &from,
                        &goals,
                        &TwoStageOptions::default(),
                        &budget,
                        seed,
                    ),
                };
                states += robot.states();
                match found {
                    Ok(found) => solved = Some(found),
                    Err(failure) => {
                        let start_is_bad = matches!(failure.reason, ToolFailureReason::Start(_));
                        if !start_is_bad && now() - began < options.seconds {
                            continue;
                        }
                    }
                }
                break;
            }
            let seconds = now() - began;
            let bare = Rules { margin: 0.0, ..rules.clone() };
            let proven = solved
                .is_some_and(|s| walk_path(&mut checker(0.5 * planner.resolution, &bare), &s.path).is_ok());
            runs.push((proven, seconds, states));
        }
        done(seed + 1, options.seeds);
    }
    let searches = names.into_iter().zip(&runs).map(|(search, runs)| figures(search, runs)).collect();
    Some(MobileReport {
        scene: task.name.clone(),
        joints: from.len(),
        goals: goals.len(),
        seeds: options.seeds,
        searches,
    })
}

fn figures(search: &'static str, runs: &[(bool, f64, u64)]) -> MobileFigures {
    let count = runs.len().max(1) as f64;
    let mut seconds: Vec<f64> = runs.iter().map(|r| r.1).collect();
    seconds.sort_by(f64::total_cmp);
    MobileFigures {
        search,
        solved: runs.iter().filter(|r| r.0).count() as u64,
        mean_s: seconds.iter().sum::<f64>() / count,
        median_s: seconds.get(seconds.len() / 2).copied().unwrap_or(0.0),
        states: runs.iter().map(|r| r.2 as f64).sum::<f64>() / count,
    }
}

/// The arm as it stands when the base is at the origin and looks along x, at its height.
pub(super) fn at_origin(problem: &Manipulation<'_>) -> ArmModel {
    let world_from_robot = &problem.task.world_from_robot;
    let height = Pose::translation(0.0, 0.0, world_from_robot.translation.z);
    problem.arm.standing_at(world_from_robot, &height)
}

/// x, y and heading of the base; and the floor as smallest x and y, largest x and y.
pub(super) fn start_and_floor(problem: &Manipulation<'_>, options: &MobileBenchOptions) -> [Vec<f64>; 2] {
    let robot = &problem.task.world_from_robot;
    let ahead = robot.rotation * Vector3::x();
    let at = robot.translation.vector;
    let object = problem.scene.world_from_body(BodyIdx::new(options.object)).translation.vector;
    let low = [0, 1].map(|i| at[i].min(object[i]) - options.floor);
    let high = [0, 1].map(|i| at[i].max(object[i]) + options.floor);
    [vec![at.x, at.y, libm::atan2(ahead.y, ahead.x)], [low, high].concat()]
}

/// The gripper alone, open.
pub(super) struct Hand<'a> {
    scene: &'a Scene,
    pub(super) links: Vec<LinkIdx>,
    poses: LinkPoses,
    palm: LinkIdx,
    palm_from_tool: Pose,
    rules: Rules,
}

/// Farthest that the gripper moves between two looks, metres.
const LOOK: f64 = 0.02;

impl<'a> Hand<'a> {
    pub(super) fn new(problem: &Manipulation<'a>, gripper: usize, object: usize, margin: f64) -> Self {
        let robot = &problem.task.robot;
        let links = gripper_links(robot, gripper);
        let mut q = problem.task.start.clone();
        if let Some(open) = robot.grippers[gripper].preshapes.first() {
            q.set(&robot.grippers[gripper].dofs, &open.values);
        }
        let mut poses = LinkPoses::default();
        problem.kinematics.link_poses(&q, &mut poses);
        let target = Some(BodyIdx::new(object));
        let rules = Rules { margin, target, gripper: links.clone(), ..Rules::default() };
        let (palm, palm_from_tool) = (robot.grippers[gripper].palm, robot.grippers[gripper].palm_from_tool);
        Self { scene: problem.scene, links, poses, palm, palm_from_tool, rules }
    }

    fn is_free(&self, world_from_tool: &Pose) -> bool {
        let world_from_palm = world_from_tool * self.palm_from_tool.inverse();
        let world_from_root = world_from_palm * self.poses.root_from(self.palm).inverse();
        let movers = Movers::of(&self.links);
        self.scene.against_bodies(&world_from_root, &self.poses, &movers, &self.rules, 0.0).is_ok()
    }

    fn moves(&self, from: &Pose, to: &Pose) -> bool {
        let way = (to.translation.vector - from.translation.vector).norm();
        let looks = (way / LOOK).ceil().max(1.0) as usize;
        (1..=looks).all(|k| {
            let t = k as f64 / looks as f64;
            let at = from.translation.vector.lerp(&to.translation.vector, t);
            let turn = from.rotation.try_slerp(&to.rotation, t, 1e-12).unwrap_or(to.rotation);
            self.is_free(&Pose::from_parts(at.into(), turn))
        })
    }

    /// Poses backed off from grasps, where the gripper is free.
    pub(super) fn goals(
        &self,
        problem: &Manipulation<'_>,
        options: &MobileBenchOptions,
        back: f64,
    ) -> Vec<Pose> {
        let world_from_object = self.scene.world_from_body(BodyIdx::new(options.object));
        let grasps = problem.grasps[options.object].grasps.iter();
        let poses = grasps.map(|grasp| world_from_object * grasp.object_from_backed_off(back));
        poses.filter(|pose| self.is_free(pose)).take(options.grasps).collect()
    }
}
