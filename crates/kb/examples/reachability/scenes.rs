//! Base placements among obstacles: bases drawn from a map against bases drawn uniformly from the disc of the arm's reach.
//!
//! Both go through the same sampler and the same checks, in this order: is the hand free at the grasp, is the footprint
//! clear, does exact inverse kinematics with the same values of the free joints find a joint vector without self-collision
//! with which no link touches an obstacle, among the first few. The map's side starts cold in each trial. Rates are by
//! processor time.

use std::time::Instant;

use nalgebra::{Matrix3, Rotation3, Unit, UnitQuaternion, Vector3};
use robotc_core::geom::{ConvexParts, any_within, box_part};
use robotc_core::{LinkIdx, Pose, Seed};
use robotc_kb::kinds::ReachabilityMap;
use robotc_kb::kinds::reachability::{ArmAlone, Floor, FreeValues, MapBases, MountedArm, Placement, Scratch};
use robotc_planning::budget::Budget;
use robotc_planning::edge::Obstruction;
use robotc_planning::goal::{GoalDraw, GoalSampler};
use robotc_planning::placement::{
    BaseDistribution, BasePlacement, PlacementArm, PlacementOptions, PlacementProblem, Prism, Stand,
    UniformBases,
};

/// Trials of each scene in a block; the distributions take turns by blocks.
const TRIALS: u64 = 25;
const BLOCKS: u64 = 4;

/// Goals drawn in each trial.
const GOALS: [usize; 2] = [10, 100];

/// Grasps of the object, and how far the tip is from its middle, metres.
const GRASPS: usize = 40;
const DISTANCE: f64 = 0.12;

/// Values of each free joint that exact inverse kinematics tries.
const EXACT: usize = 16;

/// Solutions of a place that are tried against the furniture: where so many touch it, the others mostly do.
const TRIED: u32 = 8;

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

/// A robot among the boxes of a scene.
struct Problem<'a> {
    arm: &'a ArmAlone,
    obstacles: &'a ConvexParts,
    floor: &'a Floor,
    base: &'a Prism,
    mobile_from_base: Pose,
    base_from_root: Pose,
    free: FreeValues,
    scratch: Scratch,
    grasps: &'a [Pose],
    /// Links that the arm moves, but for the hand, which was looked at with the grasp.
    order: Vec<LinkIdx>,
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

    fn solutions(&mut self, _: usize, stand: &Stand, world_from_tip: &Pose) -> Vec<Vec<f64>> {
        let world_from_base = placement(&stand.base).world_from_mobile() * self.mobile_from_base;
        let base_from_tip = world_from_base.inv_mul(world_from_tip);
        let world_from_root = world_from_base * self.base_from_root;
        let (arm, obstacles, order) = (self.arm, self.obstacles, &mut self.order);
        let (mut tried, mut free) = (0, false);
        let free_of_obstacles = |_: &[f64], links: &robotc_core::LinkPoses| {
            let touches = |&link: &LinkIdx| {
                let world_from_link = world_from_root * links.root_from(link);
                any_within(&arm.shapes()[link], &world_from_link, obstacles, &Pose::identity(), 0.0)
            };
            // What touched last will mostly touch again.
            let touching = order.iter().position(touches);
            touching.into_iter().for_each(|at| order[..=at].rotate_right(1));
            (tried, free) = (tried + 1, touching.is_none());
            free || tried == TRIED
        };
        let found = arm.reach_where(&base_from_tip, &self.free, &mut self.scratch, free_of_obstacles);
        found.filter(|_| free).into_iter().collect()
    }

    fn is_free(&mut self, _: &[f64]) -> Result<(), Obstruction> {
        Ok(())
    }
}

/// The links between the base of the arm and its hand, from the hand on.
fn moved_links(arm: &ArmAlone) -> Vec<LinkIdx> {
    let model = arm.kinematics().model();
    let first = arm.chain().variables[0].dof;
    let moved = model.subtree(model.joints()[model.dofs()[first].joint].child);
    let mut links: Vec<LinkIdx> = moved.into_iter().filter(|link| *link != arm.tip()).collect();
    links.reverse();
    links
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

/// Draws goals in every trial of a block, and adds what that took.
fn block<D: BaseDistribution>(
    problem: &mut Problem<'_>,
    make: impl Fn() -> D,
    (number, goals): (u64, usize),
    outcome: &mut Outcome,
) {
    let start = super::processor_seconds();
    for seed in number * TRIALS..(number + 1) * TRIALS {
        trial(problem, &make, Seed::new(seed), goals, outcome);
    }
    outcome.seconds += super::processor_seconds() - start;
}

/// Draws goals, and adds how many there were.
fn trial<D: BaseDistribution>(
    problem: &mut Problem<'_>,
    make: impl Fn() -> D,
    seed: Seed,
    wanted: usize,
    outcome: &mut Outcome,
) {
    let arms = [PlacementArm { cost: 1.0, grasps: problem.grasps.to_vec() }];
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

/// Rows of a Markdown table: for each scene and number of goals the median time to the first goal by the clock, goals for each second
/// of processor time, and the share of places that are one, uniform and from the map, with the ratios.
pub(crate) fn rows(name: &str, arm: &ArmAlone, map: &ReachabilityMap, reach: f64) -> Vec<String> {
    let (base, mobile_from_base) = base();
    let mut rows = Vec::new();
    for scene in SCENES {
        let boxes = scene.boxes.iter().map(|(size, at)| {
            box_part(Vector3::from(*size)).transformed(&Pose::translation(at[0], at[1], at[2]))
        });
        let obstacles = ConvexParts::new(boxes.collect());
        let floor = Floor::new([(&obstacles, Pose::identity())], &base);
        let grasps = grasps(scene.object);
        let (free, scratch) = (arm.free_values(EXACT), Scratch::default());
        let mut problem = Problem {
            arm,
            obstacles: &obstacles,
            floor: &floor,
            base: &base,
            mobile_from_base,
            base_from_root: arm.root_from_base().inverse(),
            free,
            scratch,
            grasps: &grasps,
            order: moved_links(arm),
        };
        let radius = reach + mobile_from_base.translation.vector.xy().norm();
        for wanted in GOALS {
            let mut outcomes = [Outcome::default(), Outcome::default()];
            for number in 0..BLOCKS {
                let [uniform, mapped] = &mut outcomes;
                block(&mut problem, || UniformBases { radius }, (number, wanted), uniform);
                let mounted = || {
                    let (mounts, tool_from_tip) = (vec![mobile_from_base], Pose::identity());
                    MapBases::new(vec![MountedArm { map, mounts, tool_from_tip }], Some((&floor, &base)))
                };
                block(&mut problem, mounted, (number, wanted), mapped);
            }
            let first = |o: &Outcome| 1e3 * median(&o.first);
            let rate = |o: &Outcome| o.goals as f64 / o.seconds;
            let share = |o: &Outcome| 100.0 * o.goals as f64 / f64::from(o.places.max(1));
            let [uniform, mapped] = &outcomes;
            rows.push(format!(
                "| {name} | {} | {wanted} | {:.2} ms | {:.2} ms | {:.1} | {:.0} | {:.0} | {:.1} | {:.1} % | {:.1} % |",
                scene.name,
                first(uniform),
                first(mapped),
                first(uniform) / first(mapped),
                rate(uniform),
                rate(mapped),
                rate(mapped) / rate(uniform),
                share(uniform),
                share(mapped),
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
