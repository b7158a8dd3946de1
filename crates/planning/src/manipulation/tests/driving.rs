//! Whole plans with the test arm on wheels.

use nalgebra::Point3;

use super::super::driving::Drive;
use super::super::folding::{Load, fold};
use super::super::problem::{GoalContext, finger_space};
use super::*;
use crate::scene::Grip;

fn mobile_bench(table: f64, moves: &[([f64; 2], Goal)], obstacles: &[([f64; 3], [f64; 3])]) -> Bench {
    let robot = testbed::mobile_robot();
    let arm = testbed::arm_of(&robot, Arc::new(testbed::ClosedForm { rail: false }));
    bench_of(robot, arm, table, moves, obstacles)
}

#[test]
fn what_is_out_of_reach_is_driven_to() {
    let moves = [([3.0, -0.2], anywhere([3.0, 0.2], 0.3))];
    // A wall in between that ends on the right.
    let wall = ([0.1, 3.0, 0.6], [1.5, 1.0, 0.3]);
    let mobile = mobile_bench(3.0, &moves, &[wall]);
    for seed in 0..3 {
        let plan = run(&mobile, seed, &Budget::unlimited()).unwrap_or_else(|e| panic!("{e}"));
        assert!(plan.is_complete());
        let kinds: Vec<SegmentKind> = plan.segments.iter().map(|s| s.kind).collect();
        use SegmentKind::*;
        // At rest the arm is above the footprint already.
        assert_eq!(kinds, [Drive, Reach, Approach, Grasp, Lift, Carry, Lower, Release, Retreat]);
        let drive = &plan.segments[0].trajectory;
        assert!(drive.start() == [0.0; 3] && drive.end()[0] > 1.5, "behind the wall: {:?}", drive.end());
        let beside = |y: f64| !(-0.5..=2.5).contains(&y);
        assert!(drive.knots().iter().any(|knot| beside(knot.positions[1])), "round it");
    }
    // The same arm, bolted down.
    let fixed = bench_of(testbed::robot(false), testbed::arm(false), 3.0, &moves, &[wall]);
    let failure = run(&fixed, 0, &Budget::unlimited()).unwrap_err().to_string();
    assert!(failure.contains("grasp out of reach"), "{failure}");
    // Within reach nothing drives.
    let near = mobile_bench(0.7, &[([0.6, -0.2], anywhere([0.6, 0.2], 0.3))], &[]);
    let plan = run(&near, 0, &Budget::unlimited()).unwrap();
    assert!(plan.segments.iter().all(|s| s.kind != SegmentKind::Drive));
}

/// How far the farthest corner of the box in the hand is outside of the footprint at `q`, metres; the base at the origin.
fn box_beyond_footprint(bench: &Bench, q: &robotc_core::Configuration, grip: &Grip) -> f64 {
    let root_from_box = bench.kinematics.root_from_link(q, grip.link) * grip.link_from_body;
    let half = SIZE.map(|size| 0.5 * size);
    let corner = |k: usize| [0, 1, 2].map(|i| if k >> i & 1 == 1 { half[i] } else { -half[i] });
    let beyond = |k: usize| {
        let p = root_from_box * Point3::from(corner(k));
        // The footprint of the test robot is half a metre to each side.
        p.x.abs().max(p.y.abs()) - 0.5
    };
    (0..8).map(beyond).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn an_object_is_carried_to_a_table_too_far_away() {
    // Six metres between the tables, and a wall that ends on the right.
    let far = ([0.7, 1.4, 0.05], [-3.0, 0.0, TABLE - 0.025]);
    let wall = ([0.1, 3.0, 1.2], [0.0, 2.2, 0.6]);
    for (seed, tilt) in [(0, None), (1, None), (2, Some(0.2))] {
        let targets = anywhere([-3.0, 0.2], 0.3).targets().to_vec();
        let goal = Goal::Place { targets, keep_upright: tilt };
        let bench =
            mobile_bench(3.0, &[([3.0, -0.2], goal)], &[far, ([0.1, 0.1, 0.1], [0.0, 1.0, 1.5]), wall]);
        let plan = run(&bench, seed, &Budget::unlimited()).unwrap_or_else(|e| panic!("{e}"));
        assert!(plan.is_complete());
        let loaded: Vec<&Segment> = plan.segments.iter().filter(|s| s.held.is_some()).collect();
        let kinds: Vec<SegmentKind> = loaded.iter().map(|s| s.kind).collect();
        use SegmentKind::*;
        assert_eq!(kinds, [Lift, Fold, Drive, Carry, Lower], "the box stays in the hand");
        let drive = &loaded[2].trajectory;
        assert!(drive.start()[0] > 1.5 && drive.end()[0] < -1.5, "{:?}", drive.end());
        // While it drives, the box is above the footprint.
        let held = loaded[2].held.as_ref().unwrap();
        let grip = Grip {
            body: robotc_core::BodyIdx::new(0),
            link: held.link,
            link_from_body: held.link_from_object,
        };
        let mut q = bench.task.start.clone();
        q.set(loaded[1].trajectory.dofs(), loaded[1].trajectory.end());
        assert!(box_beyond_footprint(&bench, &q, &grip) <= 1e-9);
        let Choice::Place(choice) = &plan.choices[0] else { panic!("an object is put down") };
        assert!((choice.world_from_object.translation.x + 3.0).abs() < 0.16);
    }
}

#[test]
fn an_arm_folds_with_what_it_holds() {
    let bench = mobile_bench(3.0, &[([3.0, -0.2], anywhere([3.0, 0.2], 0.3))], &[]);
    let (links, fingers) = (gripper_links(&bench.task.robot, 0), finger_space(&bench.task.robot, 0));
    let (sets, options) = ([&bench.grasps], options(&bench));
    let cx = GoalContext {
        problem: problem(&bench, &sets),
        options: &options,
        number: 0,
        object: 0,
        done: &[],
        gripper: 0,
        gripper_links: &links,
        finger_space: &fingers,
    };
    let drive = Drive::of(&bench.task.robot).unwrap();
    // Stretched out in front, wherever the base stands.
    let mut q = bench.task.start.clone();
    q.set(&drive.dofs, &[0.3, -0.4, 1.0]);
    q.set(bench.arm.dofs(), &[0.0, -0.3, 0.6, 0.0, 0.0, 0.0]);
    let budget = Budget::unlimited();
    let empty = fold(&cx, &bench.scene, &q, &drive, None, &budget, Seed::new(1)).unwrap();
    assert!(empty.len() > 1 && empty[0] == q.select(bench.arm.dofs()));
    let end = |path: &[Vec<f64>]| {
        let mut q = bench.task.start.clone();
        q.set(bench.arm.dofs(), &path[path.len() - 1]);
        q
    };
    // Folded is folded: nothing moves.
    let mut folded = q.clone();
    folded.set(bench.arm.dofs(), &empty[empty.len() - 1]);
    let again = fold(&cx, &bench.scene, &folded, &drive, None, &budget, Seed::new(2)).unwrap();
    assert_eq!(again, vec![empty[empty.len() - 1].clone()]);

    // Held by its end, the box reaches far beyond the fingers.
    let grasp = &bench.grasps.grasps[0];
    let long = Pose::translation(-0.3, 0.0, 0.0) * grasp.object_from_tool;
    let grip = cx.grip(&long);
    let open = |rules| RobotChecker::new(&bench.scene, bench.arm.space(), bench.arm.dofs(), &q, rules, 0.02);
    for seed in 0..4 {
        let load = Load { grip: &grip, constraint: None };
        let path = fold(&cx, &bench.scene, &q, &drive, Some(load), &budget, Seed::new(seed)).unwrap();
        assert!(box_beyond_footprint(&bench, &end(&path), &grip) <= 1e-9, "{seed}");
        let mut checker = open(cx.free(Some(grip.clone())));
        crate::edge::walk_path(&mut checker, &path).unwrap();
    }
}
