//! Where to stand: the first place for a base from which a grasp is free, found by inverse reachability and at random (thesis section
//! 4.4, algorithm 3.11).

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use robotc_core::ik::IkSolutions;
use robotc_core::{LinkIdx, Pose, Seed};
use serde::Serialize;

use super::mobile::{Hand, MobileBenchOptions, at_origin, start_and_floor};
use crate::arm::ArmModel;
use crate::budget::Budget;
use crate::edge::{EdgeChecker, Obstruction};
use crate::goal::{GoalDraw, GoalSampler};
use crate::lanes::{LaneChecker, LaneMemory, LaneRobot, Sight, Width};
use crate::manipulation::{Manipulation, ManipulationOptions};
use crate::placement::{
    BaseDistribution, BasePlacement, InverseSamples, InverseSamplesOptions, PlacementArm, PlacementOptions,
    PlacementProblem, PlacementRejections, Stand, UniformBases,
};
use crate::scene::{Carriage, MobileChecker, Rules, Scene};

/// The figures of one way to draw places.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlacementFigures {
    /// `inverse` or `uniform`.
    pub bases: &'static str,
    /// Runs that found a place.
    pub solved: u64,
    /// Median milliseconds to the first place, its configuration free.
    pub median_ms: f64,
    /// Mean milliseconds.
    pub mean_ms: f64,
    /// Places tried, mean.
    pub places: f64,
    /// Of these, those given up for the posture that they came with.
    pub sifted: f64,
    /// ... those where the base is not free.
    pub bases_not_free: f64,
    /// ... those from which no solution is within limits.
    pub out_of_reach: f64,
    /// Configurations that are not free, mean.
    pub touching: f64,
}

/// A run: whether it found a place, milliseconds, and what was rejected.
type Run = (bool, f64, PlacementRejections);

/// The figures of a scene.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlacementReport {
    /// Name of the task.
    pub scene: String,
    /// Grasps that may be reached.
    pub grasps: usize,
    /// Milliseconds to draw the samples of the arm, and to cover its links with spheres, once for a robot.
    pub prepare_ms: f64,
    /// Inverse reachability, and anywhere within reach.
    pub bases: Vec<PlacementFigures>,
    /// Mean milliseconds at random by those with inverse reachability.
    pub times_faster: f64,
}

/// Looks for the first place with both distributions in turn. `robot` is that of the problem, for checks in lanes.
pub fn measure_placement(
    problem: &Manipulation<'_>,
    robot: &LaneRobot,
    planner: &ManipulationOptions,
    options: &MobileBenchOptions,
    now: &dyn Fn() -> f64,
) -> Option<PlacementReport> {
    let task = problem.task;
    let gripper = task.robot.arms[task.arm].gripper?;
    let hand = Hand::new(problem, gripper, options.object, planner.fine_margin());
    let grasps = hand.goals(problem, options, planner.approach);
    if grasps.is_empty() {
        return None;
    }
    let arm = at_origin(problem);
    let began = now();
    let [_, floor] = start_and_floor(problem, options);
    let floor = ([floor[0], floor[1]], [floor[2], floor[3]]);
    let height = problem.scene.world_from_robot().translation.z;
    let scene = problem.scene.standing_at(Pose::translation(0.0, 0.0, height));
    let (mut memory, rest) = (LaneMemory::default(), task.start.select(arm.dofs()));
    let samples =
        InverseSamples::of_arms(&[&arm], &InverseSamplesOptions::default(), &mut Seed::new(1).rng());
    let mut alone = LaneChecker::new(robot, problem.scene, arm.space(), 0.0, Width::widest(), &mut memory);
    let samples = samples.retain(|_, postures| alone.apart(postures.iter().copied()));
    let robot = robot.on_wheels(floor);
    let prepare_ms = 1e3 * (now() - began);
    let rules = Rules { margin: planner.margin, gripper: hand.links.clone(), ..Rules::default() };
    let moved: Vec<LinkIdx> = {
        let model = &task.robot.model;
        let moves = |link: &LinkIdx| model.dofs_moving(*link).iter().any(|dof| arm.dofs().contains(dof));
        model.links().indices().filter(moves).collect()
    };
    let arms = [PlacementArm { cost: 1.0, grasps: grasps.clone() }];
    let whole = MobileChecker::new(
        problem.scene,
        floor,
        arm.space(),
        arm.dofs(),
        &task.start,
        rules.clone(),
        planner.resolution,
    );
    let carriage = whole.carriage(&|link| !moved.contains(&link));
    let mut runs: [Vec<Run>; 2] = Default::default();
    for seed in 0..options.seeds {
        for (number, runs) in runs.iter_mut().enumerate() {
            let mut inverse = samples.clone();
            let mut uniform = UniformBases { radius: arm.reach() };
            let bases: &mut dyn BaseDistribution = if number == 0 { &mut inverse } else { &mut uniform };
            let start = now();
            let lanes =
                LaneChecker::with_rules(&robot, &scene, whole.space(), &rules, Width::widest(), &mut memory);
            let (scratch, scene) = (IkSolutions::new(), problem.scene);
            let mut cell = Cell { arm: &arm, scene, carriage: &carriage, lanes, rest: &rest, scratch };
            let mut sampler =
                BasePlacement::new(&mut cell, bases, &arms, PlacementOptions::default(), Seed::new(seed));
            let found = loop {
                match sampler.draw(&Budget::unlimited()) {
                    Ok(GoalDraw::Pending) => {}
                    Ok(GoalDraw::Goal(_)) => break true,
                    Ok(GoalDraw::Exhausted) | Err(_) => break false,
                }
            };
            let rejections = std::mem::take(&mut sampler.rejections);
            runs.push((found, 1e3 * (now() - start), rejections));
        }
    }
    let [inverse, uniform] = runs.map(|runs| figures(&runs));
    let times_faster = uniform.mean_ms / inverse.mean_ms.max(f64::MIN_POSITIVE);
    let bases = vec![
        PlacementFigures { bases: "inverse", ..inverse },
        PlacementFigures { bases: "uniform", ..uniform },
    ];
    Some(PlacementReport { scene: task.name.clone(), grasps: grasps.len(), prepare_ms, bases, times_faster })
}

fn figures(runs: &[Run]) -> PlacementFigures {
    let count = runs.len().max(1) as f64;
    let mean = |of: &dyn Fn(&PlacementRejections) -> u32| {
        runs.iter().map(|run| f64::from(of(&run.2))).sum::<f64>() / count
    };
    let mut times: Vec<f64> = runs.iter().map(|run| run.1).collect();
    times.sort_by(f64::total_cmp);
    PlacementFigures {
        bases: "",
        solved: runs.iter().filter(|run| run.0).count() as u64,
        median_ms: times.get(times.len() / 2).copied().unwrap_or(0.0),
        mean_ms: times.iter().sum::<f64>() / count,
        places: mean(&|r| r.places),
        sifted: mean(&|r| r.sifted),
        bases_not_free: mean(&|r| r.bases),
        out_of_reach: mean(&|r| r.out_of_reach),
        touching: mean(&|r| r.configurations),
    }
}

/// The robot on wheels among the things of the task.
struct Cell<'a> {
    arm: &'a ArmModel,
    scene: &'a Scene,
    /// Links that stand still on the base.
    carriage: &'a Carriage,
    lanes: LaneChecker<'a>,
    rest: &'a [f64],
    scratch: IkSolutions,
}

impl PlacementProblem for Cell<'_> {
    fn grasp_is_free(&mut self, _: usize, _: usize) -> Result<(), Obstruction> {
        // Only free ones are goals.
        Ok(())
    }

    fn base_is_free(&mut self, _: usize, base: &[f64; 3]) -> Result<(), Obstruction> {
        self.carriage.is_free(self.scene, base)
    }

    fn sift(&mut self, stands: &[Stand]) -> Vec<Option<Obstruction>> {
        let state = |stand: &Stand| [&stand.base[..], stand.posture.as_deref().unwrap_or(self.rest)].concat();
        let states: Vec<Vec<f64>> = stands.iter().map(state).collect();
        let touched = |sight| if let Sight::Blocked(by) = sight { Some(by) } else { None };
        self.lanes.glances(states.iter().map(Vec::as_slice)).into_iter().map(touched).collect()
    }

    fn solutions(&mut self, _: usize, stand: &Stand, world_from_tool: &Pose) -> Vec<Vec<f64>> {
        let base = &stand.base;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), base[2]);
        let world_from_base = Pose::from_parts(Translation3::new(base[0], base[1], 0.0), turn);
        let near = stand.posture.as_deref().unwrap_or(self.rest);
        let free: Vec<f64> = self.arm.free_variables().iter().map(|&v| near[v]).collect();
        let base_from_tool = world_from_base.inv_mul(world_from_tool);
        let (found, _) = self.arm.inverse(&base_from_tool, &free, near, &mut self.scratch);
        found.into_iter().map(|q| [&base[..], &q].concat()).collect()
    }

    fn is_free(&mut self, q: &[f64]) -> Result<(), Obstruction> {
        self.lanes.state(q).map(|_| ())
    }

    fn first_free(&mut self, all: &[Vec<f64>]) -> (Option<usize>, Vec<Obstruction>) {
        self.lanes.first_free(all.iter().map(Vec::as_slice))
    }
}
