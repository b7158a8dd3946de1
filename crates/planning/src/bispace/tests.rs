//! The three searches on four floors, and a real arm on wheels.

use std::fmt::Write;
use std::path::Path;

use nalgebra::Point3;
use robotc_core::geom::Aabb;
use robotc_core::{Pose, Seed};

use super::planar::{Floor, Planar, Tool, floors};
use super::*;
use crate::budget::{Budget, Interrupt};
use crate::edge::{EdgeChecker, Obstruction, walk_path};
use crate::scene::{MobileChecker, Rules};
use crate::testbed::{self, REST};

/// A solution with the number of states that the checker looked at.
type Run = (Result<ToolSolution, ToolFailure>, u64);

fn run_bispace(floor: &Floor, options: &BiSpaceOptions, seed: u64) -> Run {
    let (mut robot, mut tool) = (Planar::new(floor), Tool::new(floor));
    let mut rng = Seed::new(seed).rng();
    let budget = Budget::unlimited();
    let found = bispace(&mut tool, &mut robot, &floor.start, &[floor.goal], options, &budget, &mut rng);
    (found, robot.looked)
}

fn run_jacobian(floor: &Floor, seed: u64) -> Run {
    let (mut robot, mut tool) = (Planar::new(floor), Tool::new(floor));
    let mut rng = Seed::new(seed).rng();
    let (options, budget) = (JacobianOptions::default(), Budget::unlimited());
    let found = rrt_jt(&mut tool, &mut robot, &floor.start, &[floor.goal], &options, &budget, &mut rng);
    (found, robot.looked)
}

fn run_two_stage(floor: &Floor, seed: u64) -> Run {
    let (mut robot, mut tool) = (Planar::new(floor), Tool::new(floor));
    let (options, budget) = (TwoStageOptions::default(), Budget::unlimited());
    let seed = Seed::new(seed);
    let found = two_stage(&mut tool, &mut robot, &floor.start, &[floor.goal], &options, &budget, seed);
    (found, robot.looked)
}

/// Valid edges from the start to a tool at the goal.
fn check(floor: &Floor, solution: &ToolSolution, tolerance: f64) {
    assert_eq!(solution.path[0], floor.start);
    let mut exact = Planar::new(floor);
    exact.padding = 0.0;
    walk_path(&mut exact, &solution.path).unwrap();
    let tool = Tool::new(floor);
    let end = tool.point(solution.path.last().unwrap());
    assert!(tool.distance(&end, &floor.goal) <= tolerance, "{end:?}");
}

/// Runs all searches on all floors; the table is kept in a file, so that changes of the searches show what they cost.
#[test]
fn bispace_looks_at_fewer_states_than_a_single_tree() {
    const SEEDS: u64 = 12;
    let mut table = format!("States looked at until the tool is at its goal, for {SEEDS} seeds.\n\n");
    let _ = writeln!(table, "{:16} {:10} {:>6} {:>6} {:>6}", "floor", "search", "median", "mean", "most");
    for floor in floors() {
        let mut bench = |name: &str, run: &dyn Fn(u64) -> Run| -> u64 {
            let mut looked: Vec<u64> = (0..SEEDS)
                .map(|seed| {
                    let (found, looked) = run(seed);
                    check(&floor, &found.unwrap_or_else(|e| panic!("{name} on {}: {e}", floor.name)), 0.02);
                    looked
                })
                .collect();
            looked.sort();
            let (median, sum) = (looked[looked.len() / 2], looked.iter().sum::<u64>());
            let most = looked[looked.len() - 1];
            let _ = writeln!(table, "{:16} {name:10} {median:6} {:6} {most:6}", floor.name, sum / SEEDS);
            sum
        };
        let bispace = bench("bispace", &|seed| run_bispace(&floor, &BiSpaceOptions::default(), seed));
        let jacobian = bench("rrt_jt", &|seed| run_jacobian(&floor, seed));
        bench("two_stage", &|seed| run_two_stage(&floor, seed));
        assert!(bispace < jacobian, "{}: {bispace} against {jacobian}", floor.name);
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/tool_goals.txt");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&file, &table).expect("the golden file can be written");
    }
    assert_eq!(table, std::fs::read_to_string(&file).expect("the golden file is there"));
}

#[test]
fn all_variants_find_their_way() {
    let base = BiSpaceOptions::default();
    let variants = [
        // Without inverse kinematics more must be tried near the goal.
        BiSpaceOptions {
            inverse: None,
            follow: FollowOptions { samples: 12, patience: 20, stalls: 2, ..base.follow },
            ..base
        },
        BiSpaceOptions { support: 0, ..base },
        BiSpaceOptions { metric: TreeMetric::Mixed, ..base },
        BiSpaceOptions { probability: FollowProbability::Near(0.2), ..base },
        BiSpaceOptions { follow: FollowOptions { inflation: 1.4, samples: 12, ..base.follow }, ..base },
    ];
    for floor in &floors()[..2] {
        for options in &variants {
            let found = run_bispace(floor, options, 1).0.unwrap_or_else(|e| panic!("{options:?}: {e}"));
            check(floor, &found, 0.02);
        }
    }
    assert_eq!(run_bispace(&floors()[2], &base, 5), run_bispace(&floors()[2], &base, 5));
}

/// The test arm on wheels in front of a shelf behind a table.
#[test]
fn a_mobile_arm_reaches_into_a_shelf() {
    let robot = testbed::robot(false);
    let arm = testbed::arm(false);
    let boxes = [
        ([0.05, 3.0, 1.2], [1.5, -1.6, 0.6]),
        ([0.6, 1.0, 0.05], [3.6, 0.0, 0.3]),
        ([0.6, 1.0, 0.05], [3.6, 0.0, 0.9]),
        ([0.05, 1.0, 0.9], [3.9, 0.0, 0.45]),
    ];
    let scene = testbed::scene(&robot, &boxes);
    let floor = ([-1.0, -3.0], [5.0, 3.0]);
    let rules = Rules { margin: 0.01, ..Rules::default() };
    let rest = testbed::rest(&robot);
    let checker = || MobileChecker::new(&scene, floor, arm.space(), arm.dofs(), &rest, rules.clone(), 0.02);
    // Between the boards, pointing in.
    let goal = Pose::translation(3.5, 0.1, 0.6);
    let start: Vec<f64> = [&[0.0, -1.5, 0.0], &REST[..]].concat();
    let bounds = Aabb { low: Point3::new(-1.0, -3.0, 0.1), high: Point3::new(5.0, 3.0, 1.5) };
    let inside = |p: &Pose, (size, at): &([f64; 3], [f64; 3])| {
        (0..3).all(|i| (p.translation.vector[i] - at[i]).abs() < 0.5 * size[i] + 0.03)
    };
    let budget = Budget::unlimited();
    let mut exact =
        MobileChecker::new(&scene, floor, arm.space(), arm.dofs(), &rest, Rules::default(), 0.005);
    let mut looked = [0; 3];
    for seed in (0..8).map(Seed::new) {
        for (number, looked) in looked.iter_mut().enumerate() {
            let mut tool_check = |a: &Pose, b: &Pose| {
                let middle = a.translation.vector.lerp(&b.translation.vector, 0.5).into();
                let middle = Pose::from_parts(middle, b.rotation);
                [middle, *b].iter().all(|p| boxes.iter().all(|b| !inside(p, b)))
            };
            let mut workspace = MobileArm::new(&arm, bounds, 0.3, &mut tool_check);
            let (mut robot, mut rng) = (checker(), seed.rng());
            let (w, r, goals) = (&mut workspace, &mut robot, &[goal]);
            let found = match number {
                0 => bispace(w, r, &start, goals, &BiSpaceOptions::default(), &budget, &mut rng),
                1 => rrt_jt(w, r, &start, goals, &JacobianOptions::default(), &budget, &mut rng),
                _ => two_stage(w, r, &start, goals, &TwoStageOptions::default(), &budget, seed),
            };
            let found = found.unwrap_or_else(|e| panic!("{number}: {e} {:?}", e.statistics));
            let end = workspace.point(found.path.last().unwrap());
            assert!(workspace.distance(&end, &goal) < 0.02, "{end}");
            walk_path(&mut exact, &found.path).unwrap();
            *looked += robot.states();
        }
    }
    let [bispace, jacobian, two_stage] = looked;
    assert!(bispace < jacobian && bispace < 2 * two_stage, "{looked:?}");
}

#[test]
fn failures_say_why() {
    let mut floor = floors().remove(0);
    let options = BiSpaceOptions { max_iterations: 50, ..BiSpaceOptions::default() };
    // The goal is in the wall of the shelf.
    floor.goal = [9.65, 5.0, 0.0];
    let failure = run_bispace(&floor, &options, 1).0.unwrap_err();
    assert_eq!((failure.reason, failure.statistics.iterations), (ToolFailureReason::Iterations, 50));
    assert!(failure.to_string().contains("the tool came within"), "{failure}");
    assert_eq!(run_two_stage(&floor, 1).0.unwrap_err().reason, ToolFailureReason::NoGoal);
    floor.start[0] = 9.0;
    let failure = run_bispace(&floor, &options, 1).0.unwrap_err();
    assert!(matches!(failure.reason, ToolFailureReason::Start(Obstruction::Contact(_))));

    let floor = floors().remove(0);
    let (mut robot, mut tool) = (Planar::new(&floor), Tool::new(&floor));
    let spent = || Some(Interrupt::TimeUp);
    let (budget, mut rng) = (Budget::new(&spent), Seed::new(1).rng());
    let failure =
        bispace(&mut tool, &mut robot, &floor.start, &[floor.goal], &options, &budget, &mut rng).unwrap_err();
    assert_eq!(failure.reason, ToolFailureReason::Interrupted(Interrupt::TimeUp));
    let budget = Budget::unlimited();
    let failure = bispace(&mut tool, &mut robot, &floor.start, &[], &options, &budget, &mut rng).unwrap_err();
    assert_eq!(failure.reason, ToolFailureReason::NoGoal);
}

#[test]
fn the_pull_goes_where_the_distance_falls() {
    let floor = floors().remove(0);
    let tool = Tool::new(&floor);
    let mut rng = Seed::new(1).rng();
    for _ in 0..100 {
        let q = Planar::new(&floor).space().sample(&mut rng);
        let goal = tool.sample(&mut rng);
        let pull = tool.pull(&q, &goal);
        let moved: Vec<f64> = q.iter().zip(&pull).map(|(x, d)| x + 0.01 * d).collect();
        // The sum of a distance and a turn need not fall along the gradient of the sum of their squares; that sum does.
        let square = |q: &[f64]| {
            let p = tool.point(q);
            let turn = tool.distance(&[0.0, 0.0, p[2]], &[0.0, 0.0, goal[2]]);
            (p[0] - goal[0]).powi(2) + (p[1] - goal[1]).powi(2) + turn * turn
        };
        assert!(square(&moved) < square(&q));
    }
}
