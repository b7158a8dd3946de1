//! A point that opens a door in the plane, and the test arm at a cupboard.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use robotc_core::ids::Idx;
use robotc_core::{BodyIdx, Configuration, Pose, Robot, Seed};

use super::*;
use crate::arm::ArmModel;
use crate::budget::{Budget, Interrupt};
use crate::edge::{EdgeChecker, Obstruction};
use crate::mechanism::{Mechanism, MechanismMotion};
use crate::scene::{RobotChecker, Rules, Scene};
use crate::space::{Axis, Space};
use crate::testbed::{self, Limits, REST};
use crate::toy::Toy;

/// A door in the plane that a point may hold anywhere in a disc around the handle: the grasps are a grid of offsets.
struct PlanarDoor {
    toy: Toy,
    angles: Vec<f64>,
    offsets: Vec<[f64; 2]>,
    adjacent: Vec<Vec<usize>>,
}

const HINGE: [f64; 2] = [5.0, 2.0];
const LEVER: f64 = 4.0;

impl PlanarDoor {
    /// From lying to the right to standing up; offsets up to `play` in either direction.
    fn new(play: i32, boxes: Vec<([f64; 2], [f64; 2])>) -> Self {
        let grid = -play..=play;
        let offsets: Vec<[f64; 2]> = grid
            .clone()
            .flat_map(|i| grid.clone().map(move |k| [0.3 * f64::from(i), 0.3 * f64::from(k)]))
            .collect();
        let near = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).abs() < 0.31 && (a[1] - b[1]).abs() < 0.31;
        let adjacent =
            offsets.iter().map(|a| (0..offsets.len()).filter(|&b| near(a, &offsets[b])).collect()).collect();
        Self { toy: Toy::new(boxes, 0.02), angles: Mechanism::steps(0.0, FRAC_PI_2, 25), offsets, adjacent }
    }

    fn point(&self, step: usize, grasp: usize) -> Vec<f64> {
        let (sin, cos) = self.angles[step].sin_cos();
        let [x, y] = self.offsets[grasp];
        vec![HINGE[0] + (LEVER + x) * cos - y * sin, HINGE[1] + (LEVER + x) * sin + y * cos]
    }
}

impl ArticulatedTask for PlanarDoor {
    fn arm_space(&self) -> &Space {
        self.toy.space()
    }
    fn steps(&self) -> usize {
        self.angles.len()
    }
    fn grasps(&self) -> usize {
        self.offsets.len()
    }
    fn is_contact(&self, grasp: usize) -> bool {
        self.offsets[grasp][1] <= -0.25
    }
    fn adjacent(&self, grasp: usize) -> &[usize] {
        &self.adjacent[grasp]
    }
    fn solutions(&mut self, step: usize, grasp: usize, _: Option<&[f64]>) -> Vec<Vec<f64>> {
        let q = self.point(step, grasp);
        if self.toy.state(&q).is_ok() { vec![q] } else { vec![] }
    }
    fn motion(&mut self, from: &CagedState, to: &CagedState) -> Result<(), Obstruction> {
        self.toy.edge(&from.q, &to.q).map_err(|blocked| blocked.by)
    }
    fn longest_motion(&self) -> f64 {
        0.9
    }
}

/// The same door for searches that look at collisions late; counts the states and motions that they look at.
struct LazyDoor {
    door: PlanarDoor,
    looks: usize,
}

impl ArticulatedTask for LazyDoor {
    fn arm_space(&self) -> &Space {
        self.door.arm_space()
    }
    fn steps(&self) -> usize {
        self.door.steps()
    }
    fn grasps(&self) -> usize {
        self.door.grasps()
    }
    fn is_contact(&self, grasp: usize) -> bool {
        self.door.is_contact(grasp)
    }
    fn adjacent(&self, grasp: usize) -> &[usize] {
        self.door.adjacent(grasp)
    }
    fn solutions(&mut self, step: usize, grasp: usize, near: Option<&[f64]>) -> Vec<Vec<f64>> {
        self.looks += 1;
        self.door.solutions(step, grasp, near)
    }
    fn candidates(&mut self, step: usize, grasp: usize, _: Option<&[f64]>) -> Vec<Vec<f64>> {
        vec![self.door.point(step, grasp)]
    }
    fn free(&mut self, state: &CagedState) -> Result<(), Obstruction> {
        self.looks += 1;
        self.door.toy.state(&state.q).map(|_| ())
    }
    fn motion(&mut self, from: &CagedState, to: &CagedState) -> Result<(), Obstruction> {
        self.looks += 1;
        self.door.motion(from, to)
    }
    fn longest_motion(&self) -> f64 {
        self.door.longest_motion()
    }
}

/// What every solution must be: from the first step to the last, within the cage, without jumps, in contact at the end.
fn check<T: ArticulatedTask>(task: &mut T, states: &[CagedState]) {
    let (first, last) = (&states[0], &states[states.len() - 1]);
    assert_eq!((first.step, last.step), (0, task.steps() - 1));
    assert!(task.is_contact(last.grasp));
    for pair in states.windows(2) {
        assert!(pair[0].step.abs_diff(pair[1].step) <= 1);
        assert!(task.adjacent(pair[0].grasp).contains(&pair[1].grasp));
        assert!(task.arm_space().distance(&pair[0].q, &pair[1].q) <= task.longest_motion());
        task.motion(&pair[0], &pair[1]).unwrap();
    }
}

fn randomized<T: ArticulatedTask>(task: &mut T, seed: u64) -> Result<CagingSolution, CagingFailure> {
    let options = RandomizedOptions::default();
    randomized_search(task, &CageStart::Step(0), &options, &Budget::unlimited(), &mut Seed::new(seed).rng())
}

/// Two posts on the handle's arc, one that must be passed inside and one outside.
fn slalom() -> Vec<([f64; 2], [f64; 2])> {
    let at = |angle: f64, r: f64| [HINGE[0] + r * angle.cos(), HINGE[1] + r * angle.sin()];
    let post = |[x, y]: [f64; 2]| ([x - 0.35, y - 0.35], [x + 0.35, y + 0.35]);
    vec![post(at(0.5, LEVER + 0.25)), post(at(1.1, LEVER - 0.25))]
}

#[test]
fn a_cage_leaves_room_that_a_firm_grasp_has_not() {
    let mut door = PlanarDoor::new(2, slalom());
    let found = discrete_search(&mut door, &Budget::unlimited()).unwrap();
    check(&mut door, &found.states);
    assert_eq!(found.states.len(), 25);
    for seed in 0..10 {
        let found = randomized(&mut door, seed).unwrap_or_else(|e| panic!("{e}"));
        check(&mut door, &found.states);
    }
    for seed in (0..4).map(Seed::new) {
        let options = RandomizedOptions::default();
        let search = |door: &mut PlanarDoor| restarted_search(door, &options, &Budget::unlimited(), seed);
        let found = search(&mut door).unwrap_or_else(|e| panic!("{e}"));
        check(&mut door, &found.states);
        assert_eq!(search(&mut door), Ok(found));
    }
    assert!(discrete_search(&mut FixedGrasp::firm(&mut door), &Budget::unlimited()).is_err());
    let fixed = discrete_search(&mut FixedGrasp::new(&mut door), &Budget::unlimited()).unwrap_err();
    assert_eq!(fixed.reason, CagingFailureReason::NoPath);
    assert!(randomized(&mut FixedGrasp::new(&mut door), 1).is_err());
    // Without the posts any of them will do.
    let mut open = PlanarDoor::new(2, vec![]);
    assert!(discrete_search(&mut FixedGrasp::new(&mut open), &Budget::unlimited()).is_ok());
}

#[test]
fn looking_at_collisions_late_finds_the_same_and_looks_less() {
    let at = |angle: f64, r: f64| [HINGE[0] + r * angle.cos(), HINGE[1] + r * angle.sin()];
    let mut outcomes = [0, 0];
    for case in 0..60 {
        let mut rng = Seed::new(case).rng();
        let mut post = || {
            let [x, y] = at(rng.range(0.1, 1.4), LEVER + rng.range(-0.8, 0.8));
            let half = rng.range(0.1, 0.5);
            ([x - half, y - half], [x + half, y + half])
        };
        let posts: Vec<_> = (0..4).map(|_| post()).collect();
        let eager = discrete_search(&mut PlanarDoor::new(2, posts.clone()), &Budget::unlimited());
        let mut lazy = LazyDoor { door: PlanarDoor::new(2, posts), looks: 0 };
        let found = discrete_search(&mut lazy, &Budget::unlimited());
        assert_eq!(found.is_ok(), eager.is_ok(), "case {case}");
        outcomes[usize::from(found.is_ok())] += 1;
        let looks = lazy.looks;
        if let Ok(found) = found {
            check(&mut lazy, &found.states);
            // All states that the eager one looks at: 25 grasps at 25 steps.
            assert!(looks < 25 * 25, "case {case}: {looks}");
            let drawn = randomized(&mut lazy, case).unwrap_or_else(|e| panic!("case {case}: {e}"));
            check(&mut lazy, &drawn.states);
        } else {
            assert!(randomized(&mut lazy, case).is_err(), "case {case}");
        }
    }
    assert!(outcomes.iter().all(|&count| count >= 5), "{outcomes:?}");
}

#[test]
fn searches_repeat_by_seed_and_start_in_a_given_state() {
    let mut door = PlanarDoor::new(2, slalom());
    assert_eq!(randomized(&mut door, 4), randomized(&mut door, 4));
    let start = CagedState { step: 3, grasp: 7, q: door.point(3, 7) };
    let found = randomized_search(
        &mut door,
        &CageStart::State(start.clone()),
        &RandomizedOptions::default(),
        &Budget::unlimited(),
        &mut Seed::new(1).rng(),
    )
    .unwrap();
    assert_eq!(found.states[0], start);
}

#[test]
fn failures_say_why() {
    // A wall across the whole arc.
    let wall = vec![([5.0, 4.5], [10.0, 5.0])];
    let mut blocked = PlanarDoor::new(1, wall);
    let failure = discrete_search(&mut blocked, &Budget::unlimited()).unwrap_err();
    assert!(matches!(failure.reason, CagingFailureReason::NoPath | CagingFailureReason::OutOfReach { .. }));
    let failure = randomized(&mut blocked, 1).unwrap_err();
    assert_eq!(failure.reason, CagingFailureReason::NoPath);
    assert!(failure.statistics.blocked.contains_key(&Obstruction::Contact(0)));
    assert!(failure.partial.last().unwrap().step > 5, "as far as the wall");

    // All grasps in contact are covered at the goal.
    let mut covered = PlanarDoor::new(1, vec![([5.2, 5.0], [6.0, 7.0])]);
    let failure = discrete_search(&mut covered, &Budget::unlimited()).unwrap_err();
    assert_eq!(failure.reason, CagingFailureReason::NoContact);

    // The start is covered.
    let mut covered = PlanarDoor::new(1, vec![([8.0, 1.0], [10.0, 3.0])]);
    let failure = discrete_search(&mut covered, &Budget::unlimited()).unwrap_err();
    assert_eq!(failure.reason, CagingFailureReason::OutOfReach { step: 0 });
    assert_eq!(randomized(&mut covered, 1).unwrap_err().reason, failure.reason);

    let spent = || Some(Interrupt::Cancelled);
    let stopped = discrete_search(&mut PlanarDoor::new(1, vec![]), &Budget::new(&spent)).unwrap_err();
    assert_eq!(stopped.reason, CagingFailureReason::Interrupted(Interrupt::Cancelled));
}

#[test]
fn another_set_takes_over_where_one_stalls() {
    // Outside of the post, then inside of it: neither side alone gets through.
    let sides = |sign: f64| {
        let mut door = PlanarDoor::new(2, slalom());
        let keep: Vec<bool> = door.offsets.iter().map(|o| o[0] * sign > 0.1).collect();
        for (grasp, adjacent) in door.adjacent.iter_mut().enumerate() {
            adjacent.retain(|&other| keep[other] && keep[grasp]);
        }
        // Grasps of the other side are out of reach.
        for (grasp, keep) in keep.iter().enumerate() {
            if !keep {
                door.offsets[grasp] = [100.0, 100.0];
            }
        }
        door
    };
    let mut sets = [sides(1.0), sides(-1.0)];
    for set in &mut sets {
        assert!(randomized(set, 1).is_err());
    }
    let stages =
        open_with_sets(&mut sets, &RandomizedOptions::default(), &Budget::unlimited(), Seed::new(1)).unwrap();
    assert_eq!(stages.iter().map(|s| s.set).collect::<Vec<_>>(), [1, 0]);
    assert_eq!(stages[0].states.last().unwrap().step, stages[1].states[0].step);
    // A thick wall stops both.
    let mut sets = [1, 2].map(|play| PlanarDoor::new(play, vec![([5.0, 3.0], [10.0, 5.2])]));
    let failure =
        open_with_sets(&mut sets, &RandomizedOptions::default(), &Budget::unlimited(), Seed::new(1))
            .unwrap_err();
    assert_eq!(failure.sets.len(), 2);
    assert!(failure.to_string().contains("no set of grasps moves the object on"), "{failure}");
}

#[test]
fn a_search_may_begin_in_given_states_alone() {
    let mut door = PlanarDoor::new(2, slalom());
    let free = discrete_search(&mut door, &Budget::unlimited()).unwrap();
    let starts = [free.states[0].clone()];
    let found = discrete_search(&mut StartingAt::new(&mut door, &starts), &Budget::unlimited()).unwrap();
    assert_eq!(found.states[0], starts[0]);
    check(&mut door, &found.states);
    let nowhere = discrete_search(&mut StartingAt::new(&mut door, &[]), &Budget::unlimited()).unwrap_err();
    assert_eq!(nowhere.reason, CagingFailureReason::OutOfReach { step: 0 });
}

#[test]
fn one_grasp_does_no_more_than_all_that_are_kept() {
    let mut door = PlanarDoor::new(1, vec![]);
    let mut firm = |grasp| discrete_search(&mut FixedGrasp::one(&mut door, grasp), &Budget::unlimited());
    let found = firm(0).unwrap();
    assert!(found.states.iter().all(|state| state.grasp == 0));
    let mut door = PlanarDoor::new(2, slalom());
    for grasp in 0..door.grasps() {
        assert!(discrete_search(&mut FixedGrasp::one(&mut door, grasp), &Budget::unlimited()).is_err());
    }
}

/// Distance of the handle from the middle of its panel. In the frame of a door x is along the panel, y out of it, z along
/// the hinge; the lever is the handle's x.
const HANDLE: f64 = 0.06;

/// A gripper around the handle of a door: turned and tilted about it, higher and lower; in contact when nearly straight.
fn handle_cage(lever: f64) -> Vec<CageGrasp> {
    let straight = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -FRAC_PI_2);
    let mut grasps = Vec::new();
    for yaw in -4..=4_i32 {
        for pitch in -2..=2_i32 {
            for height in -1..=1 {
                let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.26 * f64::from(yaw))
                    * straight
                    * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.3 * f64::from(pitch));
                let at = Translation3::new(lever, HANDLE, 0.025 * f64::from(height));
                grasps.push(CageGrasp {
                    part_from_tool: Pose::from_parts(at, rotation),
                    contact: yaw.abs() <= 3,
                });
            }
        }
    }
    grasps
}

/// A door whose closed panel faces the robot from `x` metres away, hinge at the right, at `y`.
fn cupboard(x: f64, y: f64, z: f64, angle: f64) -> Mechanism {
    let quarter = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2);
    Mechanism {
        world_from_axis: Pose::from_parts(Translation3::new(x, y, z), quarter),
        motion: MechanismMotion::Hinge,
        range: (0.0, angle),
    }
}

const STEPS: usize = 15;
/// Positions of the door for each step: so near to each other that they stand for all in between.
const SUBSTEPS: usize = 4;

fn positions(mechanism: &Mechanism) -> Vec<Pose> {
    let values = Mechanism::steps(mechanism.range.0, mechanism.range.1, (STEPS - 1) * SUBSTEPS + 1);
    values.into_iter().map(|value| mechanism.world_from_part(value)).collect()
}

fn steps(mechanism: &Mechanism) -> Vec<ObjectStep> {
    let step = |value| ObjectStep { value, world_from_part: mechanism.world_from_part(value) };
    Mechanism::steps(mechanism.range.0, mechanism.range.1, STEPS).into_iter().map(step).collect()
}

/// The arm beside a door at the nearest of some positions.
struct DoorChecker<'a> {
    space: Space,
    checkers: Vec<RobotChecker<'a>>,
    range: (f64, f64),
}

impl EdgeChecker for DoorChecker<'_> {
    fn space(&self) -> &Space {
        &self.space
    }
    fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction> {
        let (value, joints) = q.split_last().unwrap();
        let fraction = (value - self.range.0) / (self.range.1 - self.range.0);
        let position = (fraction * (self.checkers.len() - 1) as f64).round() as usize;
        self.checkers[position].state(joints)
    }
    fn travel(&self, difference: &[f64]) -> f64 {
        let (value, joints) = difference.split_last().unwrap();
        let positions = value.abs() / (self.range.1 - self.range.0) * (self.checkers.len() - 1) as f64;
        self.checkers[0].travel(joints).max(positions * self.resolution())
    }
    fn resolution(&self) -> f64 {
        self.checkers[0].resolution()
    }
}

fn rest(arm: &ArmModel) -> Vec<f64> {
    let fixed = &REST[..];
    if arm.free_variables().is_empty() { fixed.to_vec() } else { [&[0.0], fixed].concat() }
}

/// The arm with the gripper half closed, a cupboard with a door and its handle: one scene for each position of the door.
fn scenes(rail: bool, mechanism: &Mechanism, lever: f64) -> (Vec<Scene>, Configuration) {
    let robot = testbed::robot(rail);
    let mut q = testbed::rest(&robot);
    q.set(&robot.grippers[0].dofs, &[0.02]);
    let hinge = mechanism.world_from_axis.translation.vector;
    // Panel and handle are placed later; the cupboard stands behind the closed door.
    let boxes = [
        ([lever + 0.02, 0.02, 0.4], [0.0; 3]),
        ([0.02, 0.02, 0.12], [0.0; 3]),
        ([0.3, lever + 0.06, 0.4], [hinge.x + 0.18, hinge.y + 0.5 * lever + 0.03, hinge.z]),
    ];
    let scene = testbed::scene(&robot, &boxes);
    let panel = Pose::translation(0.5 * lever + 0.02, 0.0, 0.0);
    let handle = Pose::translation(lever, HANDLE, 0.0);
    let placed = |world_from_part: Pose| {
        scene
            .with_body_at(BodyIdx::new(0), world_from_part * panel)
            .with_body_at(BodyIdx::new(1), world_from_part * handle)
    };
    (positions(mechanism).into_iter().map(placed).collect(), q)
}

/// In each scene the gripper may touch the handle, and nothing else anything.
fn checker<'a>(
    robot: &Robot,
    arm: &'a ArmModel,
    scenes: &'a [Scene],
    q: &Configuration,
    mechanism: &Mechanism,
) -> DoorChecker<'a> {
    let gripper = ["hand", "left", "right"].iter().filter_map(|n| robot.model.link_named(n)).collect();
    let rules = Rules { target: Some(BodyIdx::new(1)), gripper, ..Rules::default() };
    let checker =
        |scene| RobotChecker::new(scene, arm.space(), arm.dofs(), q, rules.clone(), 0.02).without_clearance();
    let value = Axis::bounded(mechanism.range.0, mechanism.range.1);
    let axes = arm.space().axes().iter().copied().chain([value]).collect();
    let checkers = scenes.iter().map(checker).collect();
    DoorChecker { space: Space::new(axes), checkers, range: mechanism.range }
}

#[test]
fn an_arm_opens_a_cupboard_without_touching_anything_but_the_handle() {
    for rail in [false, true] {
        let robot = testbed::robot(rail);
        let arm = testbed::arm(rail);
        let mechanism = cupboard(0.8, -0.17, 0.45, 1.4);
        let (scenes, q) = scenes(rail, &mechanism, 0.34);
        let checker = checker(&robot, &arm, &scenes, &q, &mechanism);
        let (grasps, options) = (handle_cage(0.34), CagedObjectOptions::default());
        let mut task =
            CagedObject::new(&arm, &grasps, steps(&mechanism), checker, &rest(&arm), options).unwrap();
        for seed in 0..3 {
            let found =
                randomized(&mut task, seed).unwrap_or_else(|e| panic!("rail {rail}: {e} {:?}", e.statistics));
            check(&mut task, &found.states);
            for state in &found.states {
                let gap =
                    arm.world_from_tool(&state.q).inv_mul(&task.world_from_tool(state.step, state.grasp));
                assert!(gap.translation.vector.norm() < 1e-6 && gap.rotation.angle() < 1e-6);
            }
        }
        if !rail {
            let found = discrete_search(&mut task, &Budget::unlimited()).unwrap_or_else(|e| panic!("{e}"));
            check(&mut task, &found.states);
        }
    }
}

/// How many of a grid of cupboards the arm opens: relaxed (discrete, randomised), and with any one grasp kept firm.
fn feasible(rail: bool, lever: f64, angle: f64, grid: &[(f64, f64)]) -> [usize; 3] {
    let (robot, arm) = (testbed::robot(rail), testbed::arm(rail));
    let grasps = handle_cage(lever);
    let mut counts = [0; 3];
    for &(x, y) in grid {
        let mechanism = cupboard(x, y, 0.45, angle);
        let (scenes, q) = scenes(rail, &mechanism, lever);
        let checker = checker(&robot, &arm, &scenes, &q, &mechanism);
        let options = CagedObjectOptions::default();
        let mut task =
            CagedObject::new(&arm, &grasps, steps(&mechanism), checker, &rest(&arm), options).unwrap();
        let relaxed = discrete_search(&mut task, &Budget::unlimited()).is_ok();
        let fixed = discrete_search(&mut FixedGrasp::new(&mut task), &Budget::unlimited()).is_ok();
        counts[0] += usize::from(relaxed);
        counts[1] += usize::from(randomized(&mut task, 1).is_ok());
        counts[2] += usize::from(fixed);
    }
    counts
}

#[test]
fn the_region_from_which_a_door_can_be_opened_grows() {
    // Where the hinge may stand, for a door that is opened by 115 degrees.
    let grid: Vec<(f64, f64)> =
        (0..24).map(|i| (0.3 + 0.25 * f64::from(i % 4), -0.95 + 0.25 * f64::from(i / 4))).collect();
    let [discrete, randomized, firm] = feasible(false, 0.34, 2.0, &grid);
    assert!(5 * discrete >= 6 * firm && discrete > 5, "{discrete} {randomized} {firm}");
    assert!(randomized <= discrete && randomized + 2 >= discrete, "{discrete} {randomized} {firm}");
}

#[test]
fn bad_tasks_are_refused() {
    let arm = testbed::arm(false);
    let (grasps, steps) = (handle_cage(0.34), steps(&cupboard(0.8, -0.17, 0.45, 1.4)));
    let make = |grasps, steps: &[ObjectStep]| {
        let options = CagedObjectOptions::default();
        CagedObject::new(&arm, grasps, steps.to_vec(), Limits::new(&arm), &REST, options).err()
    };
    assert_eq!(make(&grasps, &steps), None);
    assert_eq!(make(&[], &steps), Some(CagedObjectError::NoGrasps));
    assert_eq!(make(&grasps, &[]), Some(CagedObjectError::NoSteps));
}
