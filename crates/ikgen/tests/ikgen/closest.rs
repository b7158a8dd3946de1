//! Least-squares answers: as near as the arm comes, and told apart from solutions.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use robotc_core::ik::{IkSolutions, InverseKinematics, Limits, Preferences};
use robotc_core::model::SerialChain;
use robotc_core::{Pose, Seed};
use robotc_ikgen::run::ClosestOptions;
use robotc_ikgen::{GoalType, Options, compile};

use crate::arms;

/// What is made least, by the chain's own forward kinematics.
fn cost(chain: &SerialChain, joints: &[f64], pose: &Pose, radian: f64) -> f64 {
    let reached = chain.forward(joints);
    let position = (reached.translation.vector - pose.translation.vector).norm_squared();
    let turn = |p: &Pose| p.rotation.to_rotation_matrix().into_inner();
    position + 0.5 * radian * radian * (turn(&reached) - turn(pose)).norm_squared()
}

#[test]
fn an_arm_reaches_towards_what_is_too_far() {
    let up = [0.0, 0.0, 1.0];
    let joints = [(up, [0.0; 3]), (up, [0.5, 0.0, 0.0]), (up, [0.9, 0.0, 0.0])];
    let chain = arms::chain("planar", &joints, [1.0, 0.0, 0.0]);
    let options = Options { goal: GoalType::TranslationXY2D, ..Options::default() };
    let solver = compile(&chain, &options).unwrap().solver();
    let free = vec![0.0; solver.free_variables().len()];
    let mut rng = Seed::new(1).rng();
    for _ in 0..20 {
        let (away, angle) = (rng.range(1.1, 3.0), rng.range(-2.9, 2.9));
        let pose = Pose::translation(away * angle.cos(), away * angle.sin(), 0.0);
        let mut none = IkSolutions::new();
        solver.solve(&pose, &free, &mut none);
        assert!(none.is_empty());
        let found =
            solver.solve_closest(&pose, &free, &Preferences::default(), &ClosestOptions::default()).unwrap();
        // Stretched towards it.
        let [turn, elbow, wrist] = found[0].joints[..] else { panic!("three joints") };
        assert!((turn - angle).abs() < 1e-5 && elbow.abs() < 1e-5 && wrist.abs() < 1e-5, "{found:?}");
        assert!((found[0].position_error - (away - 1.0)).abs() < 1e-9 && !found[0].exact);
    }
}

#[test]
fn nothing_near_the_answer_is_better() {
    for chain in [arms::kr6(), arms::ur5(), arms::panda()] {
        let solver = compile(&chain, &Options::default()).unwrap().solver();
        let options = ClosestOptions::default();
        let free = vec![0.3; solver.free_variables().len()];
        let mut rng = Seed::new(2).rng();
        for _ in 0..5 {
            let pose =
                Pose::from_parts(Translation3::from(rng.direction().into_inner() * 2.5), rng.rotation());
            let found = solver.solve_closest(&pose, &free, &Preferences::default(), &options).unwrap();
            let best = &found[0];
            let least = cost(&chain, &best.joints, &pose, options.radian);
            assert!(!best.exact && best.position_error > 0.1, "{}: {best:?}", chain.name);
            let turn = chain.forward(&best.joints).rotation.angle_to(&pose.rotation);
            assert!((turn - best.rotation_error).abs() < 1e-7, "{turn} {best:?}");
            // Not anywhere else either, as far as many random joint vectors tell, and not close by.
            for i in 0..4000 {
                let near = if i % 2 == 0 { 1e-3 } else { 10.0 };
                let pairs = best.joints.iter().zip(&chain.variables);
                let other: Vec<f64> =
                    pairs.map(|(x, v)| (x + rng.range(-near, near)).clamp(v.lower, v.upper)).collect();
                let there = cost(&chain, &other, &pose, options.radian);
                assert!(there > least - 1e-9, "{}: {there} {least}", chain.name);
            }
            let costs: Vec<f64> =
                found.iter().map(|f| cost(&chain, &f.joints, &pose, options.radian)).collect();
            assert!(costs.is_sorted_by(|a, b| *a <= b + 1e-9), "{costs:?}");
        }
    }
}

#[test]
fn solutions_come_as_they_are_and_limits_are_kept() {
    let chain = arms::ur5();
    let solver = compile(&chain, &Options::default()).unwrap().solver();
    let (options, all) = (ClosestOptions::default(), Preferences::default());
    let joints = [0.3, -1.2, 1.4, 0.5, 0.9, 2.0];
    let pose = chain.forward(&joints);
    let mut solutions = IkSolutions::new();
    solver.solve_preferred(&pose, &[], &all, &mut solutions).unwrap();
    let exact = solver.solve_closest(&pose, &[], &all, &options).unwrap();
    assert!(solutions.iter().eq(exact.iter().map(|c| &c.joints[..])) && exact.iter().all(|c| c.exact));
    // The joint vector itself is out of bounds now, and so is every other one.
    let limits: Vec<[f64; 2]> =
        [[0.4, 1.0], [-1.0, 0.0], [1.5, 2.0], [0.6, 1.0], [1.0, 1.5], [2.1, 2.4]].into();
    let within = Preferences { limits: Limits::Given(limits.clone()), max_solutions: 3, ..all };
    let found = solver.solve_closest(&pose, &[], &within, &options).unwrap();
    assert!((1..=3).contains(&found.len()) && !found[0].exact);
    for (x, [low, high]) in found[0].joints.iter().zip(&limits) {
        assert!(low <= x && x <= high);
    }
    assert_eq!(found, solver.solve_closest(&pose, &[], &within, &options).unwrap());
}

#[test]
fn five_joints_come_as_near_to_a_whole_pose_as_they_can() {
    let mut chain = arms::kr6();
    chain.name = "five".into();
    let last = chain.joints.pop().unwrap();
    chain.variables.pop();
    chain.last_from_tip = last.previous_from_joint * chain.last_from_tip;
    let solver = compile(&chain, &Options::default()).unwrap().solver();
    let mut rng = Seed::new(5).rng();
    for _ in 0..10 {
        let joints: Vec<f64> = (0..5).map(|_| rng.range(-1.2, 1.2)).collect();
        let reached = chain.forward(&joints);
        // Turned a little about the axis that is missing: no solution, but one nearby.
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.02);
        let pose = reached * Pose::from_parts(Translation3::identity(), turn);
        let near = Preferences { near: Some(joints), ..Preferences::default() };
        let found = solver.solve_closest(&pose, &[], &near, &ClosestOptions::default()).unwrap();
        assert!(!found[0].exact && found[0].rotation_error <= 0.02 + 1e-9, "{found:?}");
    }
}

#[test]
fn a_pose_that_is_no_pose_has_no_answer() {
    let solver = compile(&arms::kr6(), &Options::default()).unwrap().solver();
    let pose = Pose::translation(f64::NAN, 0.0, 0.0);
    let found = solver.solve_closest(&pose, &[], &Preferences::default(), &ClosestOptions::default());
    assert_eq!(found, Ok(Vec::new()));
}
