//! Base placements among obstacles: bases drawn from a map, and from samples of the arm with their postures, against bases drawn
//! uniformly from the disc of the arm's reach.
//!
//! All go through the same sampler and the same checks, in this order: is the hand free at the grasp, is the footprint
//! clear, does exact inverse kinematics find a joint vector with which no link touches another one or an obstacle, among the first
//! few. The free joints take the same values, or that of the posture. All sides start cold in each trial. Rates are by processor
//! time.

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use nalgebra::{Matrix3, Rotation3, Unit, UnitQuaternion, Vector3};
use robotc_core::geom::{ConvexParts, CoverOptions, SphereCover, any_within, box_part};
use robotc_core::ik::IkSolutions;
use robotc_core::model::{Geometry, Origin, Shape};
use robotc_core::{Configuration, DofIdx, Kinematics, Pose, Seed, SerialChain, TypedVec, World};
use robotc_ikgen::Solver;
use robotc_kb::Knowledge;
use robotc_kb::kinds::reachability::{ArmAlone, Floor, FreeValues, MapBases, MountedArm, Placement, Scratch};
use robotc_kb::kinds::{ArmPairs, IkSolver, ReachabilityMap};
use robotc_kb::project::OfArm;
use robotc_planning::arm::ArmModel;
use robotc_planning::budget::Budget;
use robotc_planning::edge::Obstruction;
use robotc_planning::goal::{GoalDraw, GoalSampler};
use robotc_planning::lanes::{LaneChecker, LaneMemory, LaneRobot, Sight, Width};
use robotc_planning::placement::{
    BaseDistribution, BasePlacement, InverseSamples, InverseSamplesOptions, PlacementArm, PlacementOptions,
    PlacementProblem, Prism, Stand, UniformBases,
};
use robotc_planning::scene::Scene as PlannedScene;
use robotc_planning::space::{Axis, Space};

/// Goals of all trials of a scene in a block; the distributions take turns by blocks.
const TOGETHER: usize = 2500;
const BLOCKS: u64 = 4;

/// Goals drawn in each trial.
const GOALS: [usize; 2] = [10, 100];

/// Grasps of the object, and how far the tip is from its middle, metres.
const GRASPS: usize = 40;
const DISTANCE: f64 = 0.12;

/// Values of each free joint that exact inverse kinematics tries.
const EXACT: usize = 16;

/// Solutions of a place that are tried: where so many touch something, the others mostly do. As many as the widest lanes take.
const TRIED: usize = 16;

/// A scene: where the object is, and boxes as size and centre; metres. What bases drive on is z = 0.
struct Scene {
    name: &'static str,
    object: [f64; 3],
    boxes: &'static [([f64; 3], [f64; 3])],
}

/// Furniture of the usual heights.
const SCENES: &[Scene] = &[
    Scene { name: "pedestal", object: [0.0, 0.0, 0.8], boxes: &[([0.3, 0.3, 0.7], [0.0, 0.0, 0.35])] },
    Scene {
        name: "counter along a wall",
        object: [0.0, 0.2, 1.0],
        boxes: &[([3.0, 0.6, 0.9], [0.0, 0.3, 0.45]), ([3.0, 0.1, 2.2], [0.0, 0.65, 1.1])],
    },
    Scene {
        name: "board of a shelf",
        object: [0.0, 0.15, 0.95],
        boxes: &[
            ([1.0, 0.4, 0.03], [0.0, 0.2, 0.45]),
            ([1.0, 0.4, 0.03], [0.0, 0.2, 0.85]),
            ([1.0, 0.4, 0.03], [0.0, 0.2, 1.35]),
            ([1.0, 0.02, 1.8], [0.0, 0.41, 0.9]),
            ([0.02, 0.4, 1.8], [-0.51, 0.2, 0.9]),
            ([0.02, 0.4, 1.8], [0.51, 0.2, 0.9]),
        ],
    },
    Scene {
        name: "corner of two counters",
        object: [-0.1, 0.25, 1.0],
        boxes: &[
            ([2.0, 0.6, 0.9], [0.7, 0.3, 0.45]),
            ([0.6, 2.0, 0.9], [-0.6, -0.4, 0.45]),
            ([2.6, 0.1, 2.2], [0.4, 0.65, 1.1]),
            ([0.1, 2.6, 2.2], [-0.95, -0.6, 1.1]),
        ],
    },
];

/// What drives: a box as wide as a door allows, with the arm on top.
fn base() -> (Prism, Pose) {
    let (x, y, top) = (0.35, 0.25, 0.55);
    let footprint = vec![[x, -y], [x, y], [-x, y], [-x, -y]];
    (Prism { footprint, heights: (0.0, top) }, Pose::translation(0.15, 0.0, top))
}

/// The arm as the lanes and the planners see it, its base where it is on what drives.
pub(crate) struct OnWheels {
    model: ArmModel,
    /// The arm's mechanism on wheels.
    driving: LaneRobot,
    mobile_from_root: Pose,
    space: Space,
    samples: InverseSamples,
}

/// What drives stays within this of the origin, metres.
const FLOOR: f64 = 3.0;

impl OnWheels {
    /// The first arm of a compiled robot.
    pub(crate) fn load(known: &Knowledge, arm: &ArmAlone) -> Result<Self, Box<dyn Error>> {
        let (_, mobile_from_base) = base();
        let robot = known.graph().project().robot();
        let kinematics = Kinematics::new(robot.model.clone());
        let chain = SerialChain::between(&kinematics, robot.arms[0].base, robot.arms[0].tip)?;
        let solver = Solver::new((*known.load::<IkSolver>(&OfArm(0))?).clone(), &chain)?;
        let (weights, q) = (vec![1.0; chain.variables.len()], Configuration::neutral(&robot.model));
        let at_root =
            ArmModel::new(robot, &kinematics, 0, Arc::new(solver), &weights, &Pose::identity(), &q)?;
        let world_from_robot = mobile_from_base * at_root.base_from_world();
        let model = at_root.standing_at(&Pose::identity(), &world_from_robot);

        let dofs: Vec<DofIdx> = arm.chain().variables.iter().map(|v| v.dof).collect();
        let neutral = Configuration::neutral(arm.kinematics().model());
        let cover = |parts: &Arc<ConvexParts>| Arc::new(SphereCover::of(parts, &CoverOptions::default()));
        let covers = arm.shapes().iter().map(cover).collect();
        let pairs = known.load::<ArmPairs>(&OfArm(0))?;
        let fixed = LaneRobot::new(arm.kinematics(), &dofs, &neutral, arm.shapes(), &covers, &pairs.0)
            .with_tables(arm.kinematics(), &dofs, arm.shapes());
        let mut axes = vec![Axis::bounded(-FLOOR, FLOOR), Axis::bounded(-FLOOR, FLOOR), Axis::wrapping()];
        axes.extend_from_slice(model.space().axes());

        let rng = &mut Seed::new(1).split("samples").rng();
        let samples = InverseSamples::of_arms(&[&model], &InverseSamplesOptions::default(), rng);
        let nothing = PlannedScene::new(
            &World::new(arm.kinematics().clone(), Pose::identity(), neutral),
            arm.shapes(),
            &Default::default(),
            pairs.0.clone(),
        );
        let mut memory = LaneMemory::default();
        let mut alone = LaneChecker::new(&fixed, &nothing, model.space(), 0.0, Width::widest(), &mut memory);
        let samples = samples.retain(|_, postures| alone.apart(postures.iter().copied()));
        Ok(Self {
            driving: fixed.on_wheels(([-FLOOR; 2], [FLOOR; 2])),
            mobile_from_root: mobile_from_base * arm.root_from_base().inverse(),
            space: Space::new(axes),
            model,
            samples,
        })
    }

    /// The boxes of a scene around it.
    fn among(&self, arm: &ArmAlone, boxes: &[([f64; 3], [f64; 3])]) -> PlannedScene {
        let above = Pose::translation(0.0, 0.0, self.mobile_from_root.translation.z);
        let neutral = Configuration::neutral(arm.kinematics().model());
        let mut world = World::new(arm.kinematics().clone(), above, neutral);
        let mut bodies = TypedVec::new();
        for (number, &(size, at)) in boxes.iter().enumerate() {
            let geometry = Geometry { origin: Origin::default(), shape: Shape::Box { size }, colour: None };
            let pose = Pose::translation(at[0], at[1], at[2]);
            world.add(&number.to_string(), Arc::new(vec![geometry]), pose);
            bodies.push(Arc::new(ConvexParts::new(vec![box_part(Vector3::from(size))])));
        }
        PlannedScene::new(&world, arm.shapes(), &bodies, vec![])
    }

    /// The state of base and arm, as the lanes see it.
    fn state(&self, base: &[f64; 3], joints: &[f64]) -> Vec<f64> {
        let world_from_root = placement(base).world_from_mobile() * self.mobile_from_root;
        let (at, ahead) = (world_from_root.translation, world_from_root.rotation * Vector3::x());
        [&[at.x, at.y, libm::atan2(ahead.y, ahead.x)], joints].concat()
    }
}

/// A robot among the boxes of a scene.
struct Problem<'a> {
    arm: &'a ArmAlone,
    wheels: &'a OnWheels,
    lanes: LaneChecker<'a>,
    obstacles: &'a ConvexParts,
    floor: &'a Floor,
    base: &'a Prism,
    mobile_from_base: Pose,
    free: FreeValues,
    scratch: Scratch,
    solutions: IkSolutions,
    /// Of the arm's tip, and of its tool.
    grasps: &'a [Pose],
    tool_grasps: &'a [Pose],
}

impl PlacementProblem for Problem<'_> {
    fn grasp_is_free(&mut self, _: usize, grasp: usize) -> Result<(), Obstruction> {
        let hand = &self.arm.shapes()[self.arm.tip()];
        let touches = any_within(hand, &self.grasps[grasp], self.obstacles, &Pose::identity(), 0.0);
        if touches { Err(Obstruction::Contact(0)) } else { Ok(()) }
    }

    fn base_is_free(&mut self, _: usize, base: &[f64; 3]) -> Result<(), Obstruction> {
        let clear = self.floor.is_clear(self.base, &placement(base));
        if clear { Ok(()) } else { Err(Obstruction::Contact(1)) }
    }

    fn sift(&mut self, stands: &[Stand]) -> Vec<Option<Obstruction>> {
        let clear = |stand: &Stand| self.floor.is_clear(self.base, &placement(&stand.base));
        let mut touched: Vec<Option<Obstruction>> =
            stands.iter().map(|stand| (!clear(stand)).then_some(Obstruction::Contact(1))).collect();
        let left: Vec<usize> = (0..stands.len()).filter(|&i| touched[i].is_none()).collect();
        let state = |&i: &usize| {
            let Stand { base, posture } = &stands[i];
            self.wheels.state(base, posture.as_deref().unwrap_or_default())
        };
        let states: Vec<Vec<f64>> = left.iter().map(state).collect();
        for (i, sight) in left.into_iter().zip(self.lanes.glances(states.iter().map(Vec::as_slice))) {
            touched[i] = if let Sight::Blocked(by) = sight { Some(by) } else { None };
        }
        touched
    }

    /// The first solution that touches nothing, if any.
    fn solutions(&mut self, _: usize, stand: &Stand, pose: &Pose) -> Vec<Vec<f64>> {
        let world_from_mobile = placement(&stand.base).world_from_mobile();
        let (wheels, lanes) = (self.wheels, &mut self.lanes);
        let mut free_one = |all: &[Vec<f64>]| {
            let states: Vec<Vec<f64>> = all.iter().map(|q| wheels.state(&stand.base, q)).collect();
            lanes.first_free(states.iter().map(Vec::as_slice)).0.map(|first| all[first].clone())
        };
        if let Some(near) = &stand.posture {
            let free: Vec<f64> = wheels.model.free_variables().iter().map(|&v| near[v]).collect();
            let (found, _) =
                wheels.model.inverse(&world_from_mobile.inv_mul(pose), &free, near, &mut self.solutions);
            return free_one(&found).into_iter().collect();
        }
        let base_from_tip = (world_from_mobile * self.mobile_from_base).inv_mul(pose);
        let (mut found, mut tried) = (None, 0);
        self.arm.reach_in_groups(&base_from_tip, &self.free, &mut self.scratch, |group| {
            let group = &group[..group.len().min(TRIED - tried)];
            found = free_one(group);
            tried += group.len();
            found.is_some() || tried == TRIED
        });
        found.into_iter().collect()
    }

    fn is_free(&mut self, _: &[f64]) -> Result<(), Obstruction> {
        Ok(())
    }
}

fn placement(base: &[f64; 3]) -> Placement {
    Placement { position: [base[0], base[1]], yaw: base[2], target: 0, mount: 0 }
}

/// Grasps of a ball at `object` from all sides but from below; the tip's z axis is the direction of approach.
fn grasps(object: [f64; 3]) -> Vec<Pose> {
    let mut rng = Seed::new(77).split("grasps of a ball").rng();
    let mut grasps = Vec::new();
    while grasps.len() < GRASPS {
        let approach = rng.direction();
        if approach.z > 0.2 {
            continue;
        }
        let across = Unit::new_normalize(approach.cross(&rng.direction()));
        let axes =
            Matrix3::from_columns(&[across.into_inner(), approach.cross(&across), approach.into_inner()]);
        let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
        let position = Vector3::from(object) - approach.into_inner() * DISTANCE;
        grasps.push(Pose::from_parts(position.into(), rotation));
    }
    grasps
}

/// What a distribution did in one trial.
#[derive(Default, Clone)]
struct Outcome {
    first: Vec<f64>,
    /// Processor time.
    seconds: f64,
    goals: usize,
    places: u32,
}

/// Draws goals in every trial of a block, and adds what that took. Distributions are asked about tips, or about `tools`.
fn block<D: BaseDistribution>(
    problem: &mut Problem<'_>,
    make: impl Fn() -> D,
    tools: bool,
    (number, goals): (u64, usize),
    outcome: &mut Outcome,
) {
    let trials = (TOGETHER / goals) as u64;
    let start = super::processor_seconds();
    for seed in number * trials..(number + 1) * trials {
        trial(problem, &make, tools, Seed::new(seed), goals, outcome);
    }
    outcome.seconds += super::processor_seconds() - start;
}

/// Draws goals, and adds how many there were.
fn trial<D: BaseDistribution>(
    problem: &mut Problem<'_>,
    make: impl Fn() -> D,
    tools: bool,
    seed: Seed,
    wanted: usize,
    outcome: &mut Outcome,
) {
    let grasps = if tools { problem.tool_grasps } else { problem.grasps };
    let arms = [PlacementArm { cost: 1.0, grasps: grasps.to_vec() }];
    let start = Instant::now();
    let mut distribution = make();
    let mut sampler =
        BasePlacement::new(problem, &mut distribution, &arms, PlacementOptions::default(), seed);
    let mut goals = 0;
    while goals < wanted {
        match sampler.draw(&Budget::unlimited()) {
            Ok(GoalDraw::Goal(_)) => {
                goals += 1;
                if goals == 1 {
                    outcome.first.push(start.elapsed().as_secs_f64());
                }
            }
            Ok(GoalDraw::Pending) => {}
            Ok(GoalDraw::Exhausted) | Err(_) => break,
        }
    }
    outcome.goals += goals;
    outcome.places += sampler.rejections.places;
}

/// Rows of a Markdown table: for each scene and number of goals, uniform, from the map, and from samples, the median time to the first
/// goal by the clock, goals for each second of processor time, and the share of places that are one; then how many times as fast the
/// map and the samples are.
pub(crate) fn rows(
    name: &str,
    arm: &ArmAlone,
    wheels: &OnWheels,
    map: &ReachabilityMap,
    reach: f64,
) -> Vec<String> {
    let (base, mobile_from_base) = base();
    let mut rows = Vec::new();
    for scene in SCENES {
        let boxes = scene.boxes.iter().map(|(size, at)| {
            box_part(Vector3::from(*size)).transformed(&Pose::translation(at[0], at[1], at[2]))
        });
        let obstacles = ConvexParts::new(boxes.collect());
        let floor = Floor::new([(&obstacles, Pose::identity())], &base);
        let grasps = grasps(scene.object);
        let tip_from_tool = wheels.model.tool_from_tip().inverse();
        let tool_grasps: Vec<Pose> = grasps.iter().map(|tip| tip * tip_from_tool).collect();
        let planned = wheels.among(arm, scene.boxes);
        let mut memory = LaneMemory::default();
        let (robot, space, width) = (&wheels.driving, &wheels.space, Width::widest());
        let mut problem = Problem {
            arm,
            wheels,
            lanes: LaneChecker::new(robot, &planned, space, 0.0, width, &mut memory),
            obstacles: &obstacles,
            floor: &floor,
            base: &base,
            mobile_from_base,
            free: arm.free_values(EXACT),
            scratch: Scratch::default(),
            solutions: IkSolutions::new(),
            grasps: &grasps,
            tool_grasps: &tool_grasps,
        };
        let radius = reach + mobile_from_base.translation.vector.xy().norm();
        for wanted in GOALS {
            let mut outcomes = [Outcome::default(), Outcome::default(), Outcome::default()];
            for number in 0..BLOCKS {
                let [uniform, mapped, sampled] = &mut outcomes;
                block(&mut problem, || UniformBases { radius }, false, (number, wanted), uniform);
                let mounted = || {
                    let (mounts, tool_from_tip) = (vec![mobile_from_base], Pose::identity());
                    MapBases::new(vec![MountedArm { map, mounts, tool_from_tip }], Some((&floor, &base)))
                };
                block(&mut problem, mounted, false, (number, wanted), mapped);
                block(&mut problem, || wheels.samples.clone(), true, (number, wanted), sampled);
            }
            let each = |of: &dyn Fn(&Outcome) -> String| outcomes.each_ref().map(of).join(" / ");
            let rate = |o: &Outcome| o.goals as f64 / o.seconds;
            rows.push(format!(
                "| {name} | {} | {wanted} | {} ms | {} | {} % | {:.1} | {:.1} |",
                scene.name,
                each(&|o| format!("{:.2}", 1e3 * median(&o.first))),
                each(&|o| format!("{:.0}", rate(o))),
                each(&|o| format!("{:.1}", 100.0 * o.goals as f64 / f64::from(o.places.max(1)))),
                rate(&outcomes[1]) / rate(&outcomes[0]),
                rate(&outcomes[2]) / rate(&outcomes[0]),
            ));
        }
    }
    rows
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}
