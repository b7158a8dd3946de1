//! Whole plans with the test arm: a table, a wall, boxes to move.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use robotc_core::geom::{ConvexParts, box_part};
use robotc_core::ids::Idx;
use robotc_core::model::Shape;
use robotc_core::robot::Robot;
use robotc_core::task::{Destination, Goal, Object, Target, Task};
use robotc_core::world::World;
use robotc_core::{Kinematics, LinkIdx, Pose, Seed, TypedVec};

use super::*;
use crate::arm::ArmModel;
use crate::budget::{Budget, Interrupt};
use crate::edge::{EdgeChecker, walk_edge};
use crate::grasp::{Grasp, GraspSet};
use crate::scene::{RobotChecker, Rules, Scene};
use crate::testbed;

mod driving;
mod several;

/// Top of the table.
const TABLE: f64 = 0.125;
const SIZE: [f64; 3] = [0.05, 0.05, 0.12];
/// Objects stand a hair above the table.
const STANDING: f64 = TABLE + 0.06 + 1e-4;

struct Bench {
    task: Task,
    kinematics: Kinematics,
    arm: ArmModel,
    scene: Scene,
    grasps: GraspSet,
}

/// Grasps from above and from four sides, at several heights and turns.
fn grasps() -> GraspSet {
    let mut all = Vec::new();
    for k in 0..4 {
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), TAU * f64::from(k) / 4.0);
        let down = yaw * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2);
        for (rotation, height, score) in [(down, 0.03, 0.5), (yaw, 0.0, 0.9), (yaw, 0.02, 0.8)] {
            all.push(Grasp {
                preshape: 0,
                object_from_tool: Pose::from_parts(nalgebra::Translation3::new(0.0, 0.0, height), rotation),
                approach_in_object: nalgebra::Unit::new_normalize(rotation * Vector3::x()),
                standoff: 0.0,
                closed: vec![0.5 * SIZE[1]],
                contacts: vec![],
                epsilon: 0.1,
                volume: None,
                steadiness: None,
                score,
            });
        }
    }
    GraspSet::new("hand", "box", all)
}

fn link_parts(robot: &robotc_core::Robot) -> TypedVec<LinkIdx, Arc<ConvexParts>> {
    let part = |g: &robotc_core::model::Geometry| match g.shape {
        Shape::Box { size } => box_part(Vector3::from(size)).transformed(&g.origin.pose()),
        _ => panic!("the test arm is made of boxes"),
    };
    robot.model.links().iter().map(|l| Arc::new(l.collisions.iter().map(part).collect())).collect()
}

/// Boxes at these places, to be moved to those; obstacles by size and centre.
fn bench(rail: bool, moves: &[([f64; 2], Goal)], obstacles: &[([f64; 3], [f64; 3])]) -> Bench {
    bench_of(testbed::robot(rail), testbed::arm(rail), 0.7, moves, obstacles)
}

/// The same for a robot of one's own and a table at this distance.
fn bench_of(
    robot: Robot,
    arm: ArmModel,
    table: f64,
    moves: &[([f64; 2], Goal)],
    obstacles: &[([f64; 3], [f64; 3])],
) -> Bench {
    let robot = Arc::new(robot);
    let kinematics = Kinematics::new(robot.model.clone());
    let standing = |[x, y]: [f64; 2]| Pose::translation(x, y, STANDING);
    let table = ([0.7, 1.4, 0.05], [table, 0.0, TABLE - 0.025]);
    let parts = |size: [f64; 3]| Arc::new(ConvexParts::new(vec![box_part(Vector3::from(size))]));
    let mut world = World::new(kinematics.clone(), Pose::identity(), testbed::rest(&robot));
    let mut body_parts = TypedVec::new();
    let mut objects = Vec::new();
    for (i, (at, _)) in moves.iter().enumerate() {
        let (name, geometry, world_from_object) = (format!("box{i}"), Arc::new(vec![]), standing(*at));
        world.add(&name, geometry.clone(), world_from_object);
        body_parts.push(parts(SIZE));
        objects.push(Object { name, geometry, mass: 0.1, friction: 0.5, world_from_object });
    }
    for (i, (size, at)) in [&table].into_iter().chain(obstacles).enumerate() {
        let name = if i == 0 { "table".into() } else { format!("wall{i}") };
        world.add(&name, Arc::new(vec![]), Pose::translation(at[0], at[1], at[2]));
        body_parts.push(parts(*size));
    }
    let links: Vec<LinkIdx> = robot.model.links().indices().collect();
    let self_pairs = links
        .iter()
        .flat_map(|&a| links.iter().map(move |&b| (a, b)))
        .filter(|pair| pair.0 < pair.1 && !robot.ignored_pairs.contains(pair))
        .collect();
    let start = testbed::rest(&robot);
    Bench {
        scene: Scene::new(&world, &link_parts(&robot), &body_parts, self_pairs),
        task: Task {
            name: "test".into(),
            robot,
            arm: 0,
            world_from_robot: Pose::identity(),
            start,
            objects,
            obstacles: vec![],
            articles: vec![],
            goals: moves.iter().map(|(_, goal)| goal.clone()).collect(),
            seed: 1,
        },
        arm,
        kinematics,
        grasps: grasps(),
    }
}

fn place(object: usize, [x, y]: [f64; 2], any_yaw: bool, keep_upright: Option<f64>) -> Goal {
    let world_from_object = Pose::translation(x, y, STANDING);
    let destination = Destination::Pose { world_from_object, any_yaw };
    Goal::Place { targets: vec![Target { object, destination }], keep_upright }
}

fn problem<'a>(bench: &'a Bench, grasps: &'a [&'a GraspSet]) -> Manipulation<'a> {
    Manipulation {
        task: &bench.task,
        kinematics: &bench.kinematics,
        arm: &bench.arm,
        scene: &bench.scene,
        grasps,
        cages: &[],
        reachability: None,
        start: &bench.task.start,
    }
}

fn run(bench: &Bench, seed: u64, budget: &Budget<'_>) -> Result<Plan, PlanFailure> {
    run_with(bench, &options(bench), seed, budget)
}

fn run_with(
    bench: &Bench,
    options: &ManipulationOptions,
    seed: u64,
    budget: &Budget<'_>,
) -> Result<Plan, PlanFailure> {
    let grasps: Vec<&GraspSet> = bench.task.objects.iter().map(|_| &bench.grasps).collect();
    let problem = problem(bench, &grasps);
    let plan = pick_and_place(&problem, options, budget, Seed::new(seed), &mut ())?;
    certify(&problem, options, &plan).unwrap_or_else(|e| panic!("{e}"));
    Ok(plan)
}

fn options(bench: &Bench) -> ManipulationOptions {
    let links = gripper_links(&bench.task.robot, 0);
    ManipulationOptions::new(&Measures::of(&bench.arm, &bench.scene, &bench.task.start, &links))
}

const WALL: ([f64; 3], [f64; 3]) = ([0.5, 0.03, 0.25], [0.65, 0.0, TABLE + 0.125]);

#[test]
fn a_box_goes_over_a_wall() {
    for rail in [false, true] {
        let bench = bench(rail, &[([0.6, -0.2], place(0, [0.6, 0.22], true, None))], &[WALL]);
        for seed in 0..5 {
            let plan = run(&bench, seed, &Budget::unlimited()).unwrap_or_else(|e| panic!("{e}"));
            assert!(plan.is_complete());
            let kinds: Vec<SegmentKind> = plan.segments.iter().map(|s| s.kind).collect();
            use SegmentKind::*;
            assert_eq!(kinds, [Reach, Approach, Grasp, Lift, Carry, Lower, Release, Retreat]);
            let Choice::Place(choice) = &plan.choices[0] else { panic!("an object is put down") };
            let put = choice.world_from_object.translation.vector;
            assert!((put - Vector3::new(0.6, 0.22, STANDING)).norm() < 1e-12);
            assert!(plan.duration() > 1.0 && plan.duration() < 30.0, "{}", plan.duration());
        }
    }
}

/// Reaches with the palm on this side of the object.
struct Behind;

impl crate::reachability::Reachability for Behind {
    fn density(&self, base_from_tip: &Pose) -> f64 {
        f64::from(base_from_tip.translation.x < 0.55)
    }
}

#[test]
fn grasps_with_room_and_within_reach_are_tried_first() {
    // By score, the set has four low ones from the side (from behind, the right, the front, the left), four higher ones, and
    // four from above.
    let order = |obstacles: &[([f64; 3], [f64; 3])], map: Option<&dyn crate::reachability::Reachability>| {
        let bench = bench(false, &[([0.6, 0.0], place(0, [0.6, 0.2], true, None))], obstacles);
        let sets = [&bench.grasps];
        let problem = Manipulation { reachability: map, ..problem(&bench, &sets) };
        let gripper = &bench.task.robot.grippers[0];
        let objects = [(robotc_core::BodyIdx::new(0), &bench.grasps)];
        let order = ranking::ranking(&problem, gripper, &bench.scene, &objects);
        order.into_iter().map(|(_, grasp)| grasp).collect::<Vec<usize>>()
    };
    let heights = [8, 9, 10, 11, 4, 5, 6, 7, 0, 1, 2, 3];
    assert_eq!(order(&[], None), heights, "the palm has most room above the table");
    let wall = ([0.5, 0.05, 0.25], [0.6, -0.15, TABLE + 0.125]);
    assert_eq!(order(&[wall], None)[10..], [1, 5], "last those for which the palm would be in the wall");
    assert_eq!(order(&[], Some(&Behind))[..2], [4, 0], "of all, those within reach");
}

#[test]
fn the_jerk_is_limited_where_that_is_asked_for() {
    // The certificate looks at the jerk of every segment.
    let bench = bench(false, &[([0.6, -0.2], place(0, [0.6, 0.22], true, None))], &[WALL]);
    let duration = |law| {
        let timing = crate::timing::TimingOptions { law, ..Default::default() };
        let options = ManipulationOptions { timing, ..options(&bench) };
        run_with(&bench, &options, 1, &Budget::unlimited()).unwrap_or_else(|e| panic!("{e}")).duration()
    };
    use crate::timing::TimeLaw;
    let [along, limited, stopping] =
        [TimeLaw::AlongPath, TimeLaw::AlongPathLimitedJerk, TimeLaw::PointToPoint].map(duration);
    assert!(along < limited && limited < stopping, "{along} {limited} {stopping}");
}

#[test]
fn plans_repeat_by_seed() {
    let bench = bench(true, &[([0.6, -0.2], place(0, [0.6, 0.22], true, None))], &[WALL]);
    let plan = |seed| run(&bench, seed, &Budget::unlimited()).unwrap();
    assert_eq!(plan(7), plan(7));
    assert_ne!(plan(7), plan(8));
}

#[test]
fn the_object_stays_upright() {
    // Certification looks at the tilt of every state of the carry.
    let bench = bench(false, &[([0.6, -0.2], place(0, [0.6, 0.22], true, Some(0.15)))], &[WALL]);
    for seed in 0..5 {
        assert!(run(&bench, seed, &Budget::unlimited()).unwrap_or_else(|e| panic!("{e}")).is_complete());
    }
}

#[test]
fn an_occupied_place_is_cleared_by_a_later_goal() {
    // Box 0 belongs where box 1 stands, so box 1 has to go first.
    let moves =
        [([0.6, -0.2], place(0, [0.6, 0.2], true, None)), ([0.6, 0.2], place(1, [0.6, 0.45], true, None))];
    let plan = run(&bench(false, &moves, &[]), 1, &Budget::unlimited()).unwrap_or_else(|e| panic!("{e}"));
    assert!(plan.is_complete());
    assert_eq!(plan.choices.iter().map(Choice::goal).collect::<Vec<_>>(), [1, 0]);
}

#[test]
fn regions_are_filled_one_by_one() {
    let region = Destination::Region {
        world_from_region: Pose::translation(0.6, 0.25, TABLE),
        size: [0.25, 0.25],
        origin_height: STANDING - TABLE,
    };
    let target = |object| Target { object, destination: region.clone() };
    let goal = |object| Goal::Place { targets: vec![target(object)], keep_upright: None };
    let moves = [([0.55, -0.1], goal(0)), ([0.6, -0.25], goal(1)), ([0.5, -0.4], goal(2))];
    let plan = run(&bench(false, &moves, &[]), 3, &Budget::unlimited()).unwrap_or_else(|e| panic!("{e}"));
    assert!(plan.is_complete());
    assert_eq!(plan.choices.len(), 3);
}

#[test]
fn failures_name_filters_and_culprits() {
    // Too far away.
    let far = bench(false, &[([0.6, -0.2], place(0, [0.6, 1.6], true, None))], &[]);
    let failure = run(&far, 1, &Budget::unlimited()).unwrap_err();
    let PlanFailure::NoGoal(skipped) = &failure else { panic!("{failure}") };
    let counts = &skipped[0].reason.rejections.counts;
    assert!(counts.contains_key(&Filter::DestinationOutOfReach), "{failure}");

    // Something stands on the destination.
    let blocked = ([0.1, 0.1, 0.1], [0.6, 0.22, TABLE + 0.05]);
    let occupied = bench(false, &[([0.6, -0.2], place(0, [0.6, 0.22], false, None))], &[blocked]);
    let failure = run(&occupied, 1, &Budget::unlimited()).unwrap_err();
    assert!(failure.to_string().contains("box0 touches wall1"), "{failure}");

    // Boxed in on all sides and above.
    let lid = ([0.2, 0.2, 0.02], [0.6, -0.2, TABLE + 0.14]);
    let boxed = bench(
        false,
        &[([0.6, -0.2], place(0, [0.6, 0.22], true, None))],
        &[
            lid,
            ([0.02, 0.2, 0.13], [0.52, -0.2, TABLE + 0.065]),
            ([0.02, 0.2, 0.13], [0.68, -0.2, TABLE + 0.065]),
            ([0.2, 0.02, 0.13], [0.6, -0.28, TABLE + 0.065]),
            ([0.2, 0.02, 0.13], [0.6, -0.12, TABLE + 0.065]),
        ],
    );
    let failure = run(&boxed, 1, &Budget::unlimited()).unwrap_err();
    assert!(failure.to_string().contains("gripper not free at the grasp: 12"), "{failure}");
}

#[test]
fn a_spent_budget_ends_planning() {
    let bench = bench(false, &[([0.6, -0.2], place(0, [0.6, 0.22], true, None))], &[WALL]);
    let spent = || Some(Interrupt::Cancelled);
    let failure = run(&bench, 1, &Budget::new(&spent)).unwrap_err();
    let PlanFailure::Interrupted { interrupt: Interrupt::Cancelled, skipped } = failure else {
        panic!("{failure}")
    };
    assert_eq!(skipped.len(), 1);
    assert_eq!(skipped[0].reason.tried, Tried { known: 12, looked_at: 0, usable: 0 });
}

#[test]
fn running_out_of_time_tells_what_was_tried() {
    // Every grasp is rejected for the lid, and the time is up after eight questions.
    let lid = ([0.3, 0.3, 0.02], [0.6, -0.2, TABLE + 0.14]);
    let lidded = bench(false, &[([0.6, -0.2], place(0, [0.6, 0.22], true, None))], &[lid]);
    let asked = std::cell::Cell::new(0);
    let after_a_while = || {
        asked.set(asked.get() + 1);
        (asked.get() > 8).then_some(Interrupt::TimeUp)
    };
    let failure = run(&lidded, 1, &Budget::new(&after_a_while)).unwrap_err();
    let PlanFailure::Interrupted { interrupt: Interrupt::TimeUp, skipped } = &failure else {
        panic!("{failure}")
    };
    let GoalFailure { tried, rejections, interrupt, .. } = &skipped[0].reason;
    assert_eq!(*interrupt, Some(Interrupt::TimeUp));
    assert!(tried.known == 12 && (1..12).contains(&tried.looked_at), "{tried:?}");
    assert!(rejections.contacts().keys().any(|(_, other)| *other == "wall1"), "{failure}");
    let said = failure.to_string();
    assert!(
        said.starts_with("no plan was found: the time limit was reached while looking for a grasp of box0: "),
        "{said}"
    );
    assert!(said.contains("touches wall1"), "{said}");
}

#[test]
fn a_search_without_a_way_tells_how_near_it_came() {
    // A wall between object and goal, and a ceiling over both.
    let walls = [([1.4, 0.02, 1.2], [0.85, 0.0, TABLE + 0.6]), ([1.2, 1.2, 0.02], [0.0, 0.0, 1.1])];
    let mut split = bench(false, &[([0.6, -0.25], place(0, [0.6, 0.25], true, None))], &walls);
    split.task.start.set(&split.arm.dofs()[..1], &[-0.5]);
    let problem_options = ManipulationOptions {
        rrt: crate::rrt::RrtOptions { max_iterations: 60, ..Default::default() },
        attempts: 2,
        ..options(&split)
    };
    let failure = run_with(&split, &problem_options, 1, &Budget::unlimited()).unwrap_err();
    let PlanFailure::NoGoal(skipped) = &failure else { panic!("{failure}") };
    let GoalFailure { stage, tried, rejections, nearest, .. } = &skipped[0].reason;
    assert_eq!(*stage, Stage::Carry, "{failure}");
    assert!(tried.usable >= 2 && rejections.counts[&Filter::Path] == 2, "{failure}");
    assert!(rejections.edges.keys().any(|cause| cause.to_string().ends_with("touches wall1")), "{failure}");
    let nearest = nearest.expect("a search was made");
    assert!(nearest.distance > 0.02 && nearest.distance < 1.0, "{failure}");
}

#[test]
fn an_object_in_a_wall_is_refused_by_name() {
    let wall = ([0.1, 0.1, 0.1], [0.6, -0.26, TABLE + 0.05]);
    let stuck = bench(false, &[([0.6, -0.2], place(0, [0.6, 0.22], true, None))], &[wall]);
    let failure = run(&stuck, 1, &Budget::unlimited()).unwrap_err().to_string();
    assert!(failure.starts_with("box0 cannot be picked up"), "{failure}");
    assert!(failure.contains("box0 touches wall1"), "{failure}");
}

#[test]
fn what_the_planner_takes_for_free_near_objects_is_free_at_a_finer_look() {
    // Motions of the arm past a small plate, at all distances from grazing to clear of it.
    let mut rng = Seed::new(11).rng();
    let (mut free, mut missed_without_margin) = (0, 0);
    for _ in 0..300 {
        let from: Vec<f64> = testbed::REST.iter().map(|x| x + rng.range(-0.4, 0.4)).collect();
        let to: Vec<f64> = from.iter().map(|x| x + rng.range(-0.15, 0.15)).collect();
        let middle: Vec<f64> = from.iter().zip(&to).map(|(a, b)| 0.5 * (a + b)).collect();
        let tool = testbed::arm(false).world_from_tool(&middle).translation.vector;
        let plate = [0, 1, 2].map(|i| tool[i] + rng.range(-0.09, 0.09));
        let bench = bench(
            false,
            &[([0.4, -0.6], place(0, [0.6, 0.22], true, None))],
            &[([0.002, 0.06, 0.04], plate)],
        );
        let grasps = [&bench.grasps];
        // Coarse, so that what happens between two looks matters.
        let options = ManipulationOptions { fine_resolution: 0.03, ..options(&bench) };
        let links = gripper_links(&bench.task.robot, 0);
        let fingers = super::problem::finger_space(&bench.task.robot, 0);
        let cx = super::problem::GoalContext {
            problem: problem(&bench, &grasps),
            options: &options,
            number: 0,
            object: 0,
            done: &[],
            gripper: 0,
            gripper_links: &links,
            finger_space: &fingers,
        };
        let is_free = |rules: &Rules, resolution| {
            let (arm, q) = (&bench.arm, &bench.task.start);
            let mut checker =
                RobotChecker::new(&bench.scene, arm.space(), arm.dofs(), q, rules.clone(), resolution);
            checker.state(&from).is_ok() && walk_edge(&mut checker, &from, &to).is_ok()
        };
        let no_margin = Rules { margin: 0.0, ..cx.touching() };
        let truth = is_free(&no_margin, 1e-4);
        if is_free(&cx.touching(), options.fine_resolution) {
            free += 1;
            assert!(truth, "the plate at {plate:?} is touched");
        }
        missed_without_margin += u32::from(!truth && is_free(&no_margin, options.fine_resolution));
    }
    assert!(free > 50 && missed_without_margin > 0, "{free} {missed_without_margin}");
}

/// The box may stand anywhere in a square.
fn anywhere([x, y]: [f64; 2], side: f64) -> Goal {
    let world_from_region = Pose::translation(x, y, TABLE + 1e-4);
    let destination = Destination::Region { world_from_region, size: [side; 2], origin_height: 0.06 };
    Goal::Place { targets: vec![Target { object: 0, destination }], keep_upright: None }
}

#[test]
fn the_first_usable_grasp_of_a_thousand_is_found_without_looking_at_the_others() {
    let bench = bench(false, &[([0.6, -0.2], anywhere([0.6, 0.2], 0.3))], &[]);
    let few = grasps().grasps;
    let shifted = |k: usize| {
        let mut grasp = few[k % few.len()].clone();
        grasp.object_from_tool.translation.vector.z += 1e-5 * (k / few.len()) as f64;
        grasp
    };
    let set = GraspSet::new("hand", "box", (0..1000).map(shifted).collect());
    let options = ManipulationOptions { destinations: 100, ..options(&bench) };
    let look = |most| {
        let sets = [&set];
        let problem = problem(&bench, &sets);
        usable_grasps(&problem, &options, 0, most, &Budget::unlimited(), Seed::new(1)).unwrap().unwrap()
    };
    let first = look(1);
    assert_eq!((first.found.len(), first.tried.known, first.destinations[0]), (1, 1000, 100));
    assert!(first.tried.looked_at <= 50 && first.destinations[1] <= 10, "{first:?}");
    let more = look(5);
    assert_eq!((more.found.len(), &more.found[0]), (5, &first.found[0]), "it goes on where it was");
    assert!(more.tried.looked_at > first.tried.looked_at);
    for usable in &more.found {
        let object_from_tool = set.grasps[usable.grasp].object_from_tool;
        let off = |q: &[f64], world_from_object: &Pose| {
            let reached = bench.arm.world_from_tool(q);
            (reached.to_homogeneous() - (world_from_object * object_from_tool).to_homogeneous()).norm()
        };
        assert!(off(&usable.at_grasp, &bench.task.objects[0].world_from_object) < 1e-6);
        assert!(off(&usable.at_destination, &usable.world_from_object) < 1e-6);
    }
}
