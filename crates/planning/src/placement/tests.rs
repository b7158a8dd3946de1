//! Places for the test arm on wheels, and postures above its footprint.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use robotc_core::ik::IkSolutions;
use robotc_core::{Kinematics, Pose, Seed};

use super::*;
use crate::arm::ArmModel;
use crate::budget::{Budget, Interrupt};
use crate::edge::{EdgeChecker, Obstruction, walk_path};
use crate::goal::{GoalDraw, GoalSampler};
use crate::rrt::{RrtConnect, RrtOptions};
use crate::scene::{Carriage, MobileChecker, Rules, Scene};
use crate::testbed::{self, REST};

/// The test arm, its base and gripper, among boxes.
struct Cell<'a> {
    arm: &'a ArmModel,
    checker: MobileChecker<'a>,
    carriage: Carriage,
    scene: &'a Scene,
    /// Grasps at which the gripper is not free.
    covered: Vec<usize>,
    asked: u32,
}

impl PlacementProblem for Cell<'_> {
    fn grasp_is_free(&mut self, _: usize, grasp: usize) -> Result<(), Obstruction> {
        self.asked += 1;
        if self.covered.contains(&grasp) { Err(Obstruction::Contact(99)) } else { Ok(()) }
    }
    fn base_is_free(&mut self, _: usize, base: &[f64; 3]) -> Result<(), Obstruction> {
        self.carriage.is_free(self.scene, base)
    }
    fn solutions(&mut self, _: usize, stand: &Stand, world_from_tool: &Pose) -> Vec<Vec<f64>> {
        let base = &stand.base;
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), base[2]);
        let world_from_base = Pose::from_parts(Translation3::new(base[0], base[1], 0.0), turn);
        let base_from_tool = world_from_base.inv_mul(world_from_tool);
        let (found, _) = self.arm.inverse(&base_from_tool, &[], &REST, &mut IkSolutions::new());
        found.into_iter().map(|q| [&base[..], &q].concat()).collect()
    }
    fn is_free(&mut self, q: &[f64]) -> Result<(), Obstruction> {
        self.checker.state(q).map(|_| ())
    }
}

fn scene() -> Scene {
    // A counter with something in the middle, and a pillar.
    let boxes = [
        ([0.8, 1.6, 0.375], [2.0, 0.0, 0.1875]),
        ([0.05, 0.05, 0.1], [2.0, 0.2, 0.43]),
        ([0.4, 0.4, 2.0], [1.1, 0.6, 1.0]),
    ];
    testbed::scene(&testbed::robot(false), &boxes)
}

fn with_cell<R>(scene: &Scene, arm: &ArmModel, f: impl FnOnce(&mut Cell<'_>) -> R) -> R {
    let robot = testbed::robot(false);
    let rules = Rules { margin: 0.005, ..Rules::default() };
    let floor = ([-1.0, -3.0], [5.0, 3.0]);
    let checker =
        MobileChecker::new(scene, floor, arm.space(), arm.dofs(), &testbed::rest(&robot), rules, 0.01);
    let base = robot.model.link_named("base").unwrap();
    let carriage = checker.carriage(&|link| link == base);
    f(&mut Cell { arm, checker, carriage, scene, covered: vec![], asked: 0 })
}

/// Beside the thing on the counter, from above and from four sides.
fn grasps() -> Vec<Pose> {
    let at = Translation3::new(2.0, 0.05, 0.55);
    let mut all: Vec<Pose> = (0..4)
        .map(|k| {
            let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2 * f64::from(k));
            Pose::from_parts(at, yaw)
        })
        .collect();
    all.push(Pose::from_parts(at, UnitQuaternion::from_axis_angle(&Vector3::y_axis(), FRAC_PI_2)));
    // Far above: hopeless.
    all.push(Pose::translation(2.0, 0.0, 3.0));
    all
}

/// Goals, places tried for them, and rejections.
fn sample(
    distribution: &mut dyn BaseDistribution,
    covered: &[usize],
    count: usize,
    seed: u64,
) -> (Vec<Placement>, PlacementRejections) {
    let (scene, arm) = (scene(), testbed::arm(false));
    let arms = [PlacementArm { cost: 1.0, grasps: grasps() }];
    with_cell(&scene, &arm, |cell| {
        cell.covered = covered.to_vec();
        let options = PlacementOptions { max_places: 4000, ..PlacementOptions::default() };
        let mut sampler = BasePlacement::new(cell, distribution, &arms, options, Seed::new(seed));
        loop {
            match sampler.draw(&Budget::unlimited()).unwrap() {
                GoalDraw::Exhausted => break,
                GoalDraw::Goal(_) if sampler.placements.len() == count => break,
                _ => {}
            }
        }
        (sampler.placements.clone(), sampler.rejections.clone())
    })
}

fn inverse_samples(seed: u64) -> InverseSamples {
    let arm = testbed::arm(false);
    InverseSamples::of_arms(&[&arm], &InverseSamplesOptions::default(), &mut Seed::new(seed).rng())
}

#[test]
fn placements_reach_their_grasps_and_are_free() {
    let arm = testbed::arm(false);
    // So many that every grasp is drawn.
    let (placements, rejections) = sample(&mut inverse_samples(1), &[0], 80, 1);
    assert_eq!(placements.len(), 80);
    assert_eq!((rejections.grasps, rejections.hopeless), (1, 1), "{rejections}");
    let scene = scene();
    with_cell(&scene, &arm, |cell| {
        for p in &placements {
            assert!(p.grasp != 0 && p.grasp != 5);
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), p.base[2]);
            let world_from_base = Pose::from_parts(Translation3::new(p.base[0], p.base[1], 0.0), turn);
            let tool = world_from_base * arm.world_from_tool(&p.q[3..]);
            assert!((tool.to_homogeneous() - grasps()[p.grasp].to_homogeneous()).norm() < 1e-6);
            cell.is_free(&p.q).unwrap();
        }
    });
}

#[test]
fn inverse_reachability_beats_random_places() {
    let (mut places, mut misses) = ([0, 0], [0, 0]);
    for seed in 0..5 {
        let mut uniform = UniformBases { radius: 1.2 };
        let distributions: [&mut dyn BaseDistribution; 2] = [&mut inverse_samples(7), &mut uniform];
        for (k, distribution) in distributions.into_iter().enumerate() {
            let (found, rejections) = sample(distribution, &[], 10, seed);
            assert_eq!(found.len(), 10, "{rejections}");
            places[k] += rejections.places;
            misses[k] += rejections.out_of_reach;
        }
    }
    assert!(4 * places[0] < 3 * places[1], "{places:?}");
    assert!(10 * misses[0] < misses[1], "{misses:?}");
}

#[test]
fn a_robot_drives_to_a_place_and_failures_say_why() {
    let (scene, arm) = (scene(), testbed::arm(false));
    let arms = [PlacementArm { cost: 1.0, grasps: grasps() }];
    let mut distribution = inverse_samples(3);
    let placement = sample(&mut distribution, &[], 1, 4).0.remove(0);
    with_cell(&scene, &arm, |cell| {
        let start = [&[0.0, -1.0, 0.0], &REST[..]].concat();
        let mut goals = crate::goal::FixedGoals::new(vec![placement.q.clone()]);
        let (options, budget) = (RrtOptions::default(), Budget::unlimited());
        let mut search = RrtConnect::new(&start);
        let rng = &mut Seed::new(1).rng();
        let found = search
            .run(&mut cell.checker, None, &mut goals, &options, &budget, rng)
            .unwrap_or_else(|e| panic!("{e}"));
        walk_path(&mut cell.checker, &found.path).unwrap();
    });
    // All grasps are covered.
    let (none, rejections) = sample(&mut distribution, &[0, 1, 2, 3, 4], 1, 1);
    assert!(none.is_empty() && rejections.grasps == 5, "{rejections}");
    assert_eq!(rejections.blocked[&Obstruction::Contact(99)], 5);
    with_cell(&scene, &arm, |cell| {
        let spent = || Some(Interrupt::Cancelled);
        let options = PlacementOptions::default();
        let mut sampler = BasePlacement::new(cell, &mut distribution, &arms, options, Seed::new(1));
        assert_eq!(sampler.draw(&Budget::new(&spent)), Err(Interrupt::Cancelled));
    });
}

#[test]
fn a_prism_knows_inside_from_outside() {
    let footprint = vec![[0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5]];
    let prism = Prism { footprint, heights: (0.0, 1.0) };
    assert!((prism.excess(&Point3::new(0.0, 0.0, 0.5)) + 0.5).abs() < 1e-12);
    assert!((prism.excess(&Point3::new(0.7, 0.0, 0.5)) - 0.2).abs() < 1e-12);
    assert!((prism.excess(&Point3::new(0.0, -0.4, 1.3)) - 0.3).abs() < 1e-12);
    assert!((prism.excess(&Point3::new(-0.6, 0.0, -0.3)) - 0.3).abs() < 1e-12);
}

#[test]
fn an_arm_folds_itself_above_its_footprint() {
    let robot = testbed::robot(false);
    let arm = testbed::arm(false);
    let kinematics = Kinematics::new(robot.model.clone());
    let scene = testbed::scene(&robot, &[]);
    let q = testbed::rest(&robot);
    let mut checker = testbed::checker(&scene, &arm, &q);
    let corners = ["fore", "wrist2", "hand"]
        .iter()
        .map(|name| (robot.model.link_named(name).unwrap(), vec![Point3::origin()]))
        // What the gripper holds sticks out of it.
        .chain([(
            robot.model.link_named("hand").unwrap(),
            vec![Point3::new(0.3, 0.1, 0.0), Point3::new(0.3, -0.1, 0.0)],
        )])
        .collect();
    let bodies = PrismBodies { kinematics: &kinematics, q: q.clone(), dofs: arm.dofs(), corners };
    let prism = Prism {
        footprint: vec![[0.35, -0.35], [0.35, 0.35], [-0.35, 0.35], [-0.35, -0.35]],
        heights: (0.1, 1.6),
    };
    let excess = |q: &[f64]| bodies.excess(&prism, q);
    assert!(excess(&REST) > 0.1, "at rest the arm sticks out");
    let mut goals =
        NavigationPosture::new(&mut checker, &excess, &REST, PostureOptions::default(), Seed::new(1));
    let mut found = Vec::new();
    while found.len() < 5 {
        match goals.draw(&Budget::unlimited()).unwrap() {
            GoalDraw::Goal(q) => found.push(q),
            GoalDraw::Pending => {}
            GoalDraw::Exhausted => panic!("{} outside, {} not free", goals.outside, goals.blocked),
        }
    }
    for q in &found {
        assert!(excess(q) <= 0.0 && checker.state(q).is_ok());
    }
    // A search draws them as it goes.
    let mut goals =
        NavigationPosture::new(&mut checker, &excess, &found[0], PostureOptions::default(), Seed::new(1));
    assert_eq!(
        goals.draw(&Budget::unlimited()),
        Ok(GoalDraw::Goal(found[0].clone())),
        "a good preset comes first"
    );
}

/// A point on the plane is the base, another one the hand: it reaches as far as 2 from it.
struct Points {
    toy: crate::toy::Toy,
}

impl PlacementProblem for Points {
    fn grasp_is_free(&mut self, _: usize, _: usize) -> Result<(), Obstruction> {
        Ok(())
    }
    fn base_is_free(&mut self, _: usize, base: &[f64; 3]) -> Result<(), Obstruction> {
        self.toy.state(&base[..2]).map(|_| ())
    }
    fn solutions(&mut self, _: usize, stand: &Stand, world_from_tool: &Pose) -> Vec<Vec<f64>> {
        let base = &stand.base;
        let at = world_from_tool.translation.vector;
        let near = (at.x - base[0]).hypot(at.y - base[1]) <= 2.0;
        if near { vec![vec![base[0], base[1], at.x, at.y]] } else { vec![] }
    }
    fn is_free(&mut self, q: &[f64]) -> Result<(), Obstruction> {
        self.toy.edge(&q[..2], &q[2..]).map_err(|blocked| blocked.by)
    }
}

#[test]
fn points_on_a_plane_are_placed_where_they_see_their_target() {
    // Behind a wall from x = 4 to 5: whoever stands on its left does not see the target.
    let mut points = Points { toy: crate::toy::Toy::wall(0.02) };
    let arms = [PlacementArm { cost: 1.0, grasps: vec![Pose::translation(5.5, 4.0, 0.0)] }];
    let mut anywhere = UniformBases { radius: 2.5 };
    let options = PlacementOptions { max_places: 500, ..PlacementOptions::default() };
    let mut sampler = BasePlacement::new(&mut points, &mut anywhere, &arms, options, Seed::new(1));
    while sampler.draw(&Budget::unlimited()).unwrap() != GoalDraw::Exhausted {}
    let PlacementRejections { bases, out_of_reach, configurations, places, .. } = sampler.rejections.clone();
    let placements = sampler.placements.clone();
    assert!(bases > 0 && out_of_reach > 0 && configurations > 0);
    assert_eq!(placements.len() as u32 + bases + out_of_reach + configurations, places);
    assert!(placements.iter().all(|p| p.base[0] > 5.0 && (p.base[0] - 5.5).hypot(p.base[1] - 4.0) <= 2.0));
}

#[test]
fn points_on_a_plane_fold_into_a_prism_and_onto_a_constraint() {
    /// On the diagonal.
    struct Diagonal;
    impl crate::constraint::Constraint for Diagonal {
        fn holds(&self, q: &[f64]) -> bool {
            (q[0] - q[1]).abs() < 1e-9
        }
        fn size(&self, difference: &[f64]) -> f64 {
            difference[0].hypot(difference[1])
        }
        fn project(&self, q: &mut [f64]) -> bool {
            let mean = 0.5 * (q[0] + q[1]);
            q.fill(mean);
            true
        }
    }
    // Within 0 to 3, of which a box covers the middle.
    let mut toy = crate::toy::Toy::new(vec![([1.0, 1.0], [2.0, 2.0])], 0.05);
    let prism =
        Prism { footprint: vec![[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]], heights: (-1.0, 1.0) };
    let excess = |q: &[f64]| prism.excess(&Point3::new(q[0], q[1], 0.0));
    for constraint in [None, Some(&Diagonal as &dyn crate::constraint::Constraint)] {
        let options = PostureOptions { largest: 6.0, ..PostureOptions::default() };
        let mut goals = NavigationPosture::new(&mut toy, &excess, &[5.0, 4.0], options, Seed::new(1))
            .with_constraint(constraint);
        let mut found = Vec::new();
        loop {
            match goals.draw(&Budget::unlimited()).unwrap() {
                GoalDraw::Goal(q) => found.push(q),
                GoalDraw::Pending => {}
                GoalDraw::Exhausted => break,
            }
        }
        let (outside, blocked) = (goals.outside, goals.blocked);
        assert!(found.len() > 20 && blocked > 0, "{} {outside} {blocked}", found.len());
        for q in &found {
            assert!(
                excess(q) <= 0.0 && toy.state(q).is_ok() && constraint.is_none_or(|c| c.holds(q)),
                "{q:?}"
            );
        }
    }
}
