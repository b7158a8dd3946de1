//! Each class of chains, over random and singular poses.

use robotc_core::Seed;
use robotc_core::ik::{IkSolutions, InverseKinematics};
use robotc_core::model::{ChainMotion, ChainVariable, SerialChain};
use robotc_ikgen::report::{ProofOptions, poses, prove};
use robotc_ikgen::run::Batch;
use robotc_ikgen::{Compiled, Options, Solver, check, compile};

use crate::arms;

#[test]
fn every_pose_of_every_class_is_solved_and_nothing_is_wrong() {
    for chain in arms::all() {
        let compiled = compile(&chain, &Options::default()).unwrap_or_else(|r| panic!("{}: {r}", chain.name));
        let report = prove(&compiled, 0.0, &ProofOptions { poses: 300, seed: 5 }, &|| 0.0);
        assert!(report.emitted, "{}: {}", chain.name, report.reason);
        for set in &report.sets {
            let what = format!("{} ({}): {set:?}", chain.name, report.class);
            assert_eq!(set.solved, set.poses, "{what}");
            assert_eq!(set.wrong, 0, "{what}");
            if set.name == "random" {
                assert_eq!(set.recovered, set.poses, "{what}");
            }
        }
    }
}

#[test]
fn classes_are_named() {
    let class = |chain| compile(&chain, &Options::default()).unwrap().class;
    assert_eq!(class(arms::kr6()), "6R spherical wrist, axes 2 and 3 parallel");
    assert_eq!(class(arms::skew()), "6R spherical wrist, general shoulder");
    assert_eq!(class(arms::ur5()), "6R three parallel axes 2-3-4, axes 5 and 6 meeting");
    assert_eq!(class(arms::panda()), "7R spherical shoulder, axes 1 and 2 meeting (from the tip), j7 given");
    assert!(class(arms::fetch()).ends_with("j3 given"), "{}", class(arms::fetch()));
}

#[test]
fn chains_without_a_triple_are_solved_in_general() {
    let mut chain = arms::ur5();
    chain.joints[3].axis = nalgebra::Unit::new_normalize(nalgebra::Vector3::new(0.3, 1.0, 0.0));
    let compiled = compile(&chain, &Options::default()).unwrap();
    assert!(compiled.class.starts_with("6R general, eliminated to degree"), "{}", compiled.class);
    let report = prove(&compiled, 0.0, &ProofOptions { poses: 500, seed: 1 }, &|| 0.0);
    let random = report.set("random").unwrap();
    assert_eq!((random.solved, random.recovered, random.wrong), (500, 500, 0));
}

#[test]
fn offset_wrists_are_solved_everywhere_on_the_grid_of_right_angles() {
    let compiled = compile(&arms::crx10(), &Options::default()).unwrap();
    assert_eq!(compiled.class, "6R offset wrist, axes 1 to 4 in a plane");
    let solver = compiled.solver();
    for set in poses::sets(compiled.chain(), &[], 4096, Seed::new(1)) {
        if set.name == "grid90" || set.name == "random" {
            let report = robotc_ikgen::report::prove_set(compiled.chain(), &solver, &set, &|| 0.0);
            assert_eq!((report.solved, report.wrong), (4096, 0), "{report:?}");
            assert!(!set.regular || report.recovered == 4096, "{report:?}");
        }
    }
}

/// A chain of so many turning joints without any relation between their axes.
fn crooked(joints: usize) -> SerialChain {
    let mut rng = Seed::new(8).rng();
    let axes: Vec<([f64; 3], [f64; 3])> = (0..joints)
        .map(|_| (rng.direction().into_inner().into(), std::array::from_fn(|_| rng.range(-0.4, 0.4))))
        .collect();
    arms::chain("crooked", &axes, [0.3, 0.2, 0.1])
}

#[test]
fn chains_that_no_strategy_fits_are_refused_with_a_reason() {
    let turns_and_slides = {
        let mut chain = crooked(7);
        chain.joints[4].motion = ChainMotion::Prismatic;
        arms::following(chain, 4, 2, 0.1)
    };
    let five_at_once =
        [6, 5, 4, 3].into_iter().fold(crooked(10), |c, joint| arms::following(c, joint, 1, 0.5));
    let refused = [
        (
            arms::sliding(arms::skew(), &[1, 3]),
            "RPRPRR: joints 2, 4 each slide or move several joints, and no equation holds only one of them",
        ),
        (turns_and_slides, "RRRRPRR: joint 3 turns one joint and slides another"),
        (five_at_once, "10R: joint 2 moves 5 joints, 4 at most"),
        (crooked(13), "13R: name the free joints, 7 of them"),
    ];
    for (chain, reason) in refused {
        let refusal = compile(&chain, &Options::default()).unwrap_err();
        assert_eq!(refusal.reason, reason);
        assert!(chain.variables.len() > 6 || !refusal.trace.is_empty());
    }
}

#[test]
fn of_thirteen_joints_seven_are_named() {
    let options = Options { free: Some((6..13).collect()), ..Options::default() };
    solved_everywhere(&compile(&crooked(13), &options).unwrap());
}

#[test]
fn the_caller_chooses_the_free_joint() {
    let options = Options { free: Some(vec![2]), ..Options::default() };
    let compiled = compile(&arms::iiwa(), &options).unwrap();
    assert_eq!(compiled.free, [2]);
    let nonsense = Options { free: Some(vec![9]), ..Options::default() };
    assert!(compile(&arms::iiwa(), &nonsense).is_err());
}

#[test]
fn a_single_joint_is_solved() {
    let chain = arms::chain("knuckle", &[([0.0, 1.0, 0.0], [0.02, 0.0, 0.05])], [0.06, 0.0, 0.09]);
    solved_everywhere(&compile(&chain, &Options::default()).unwrap());
}

#[test]
fn an_arm_of_four_joints_may_fold_onto_its_shoulder() {
    let up = [0.0, 0.0, 1.0];
    let across = [0.0, 1.0, 0.0];
    let joints = [
        (up, [0.0, 0.0, 0.157]),
        (across, [0.0, 0.0016, 0.2755]),
        (across, [0.0, 0.0, 0.5655]),
        (up, [0.0, -0.007, 0.6886]),
    ];
    solved_everywhere(
        &compile(&arms::chain("micro", &joints, [0.0, -0.007, 0.6886]), &Options::default()).unwrap(),
    );
}

#[test]
fn of_many_joints_those_to_give_are_chosen() {
    let mut rail = arms::panda();
    let mut first = arms::panda().joints[0].clone();
    first.name = "rail".into();
    first.motion = ChainMotion::Prismatic;
    first.axis = nalgebra::Vector3::y_axis();
    first.previous_from_joint = robotc_core::Pose::identity();
    for joint in &mut rail.joints {
        joint.variable += 1;
    }
    let variable =
        ChainVariable { name: "rail".into(), lower: -1.0, upper: 1.0, ..rail.variables[0].clone() };
    rail.joints.insert(0, first);
    rail.variables.insert(0, variable);
    let compiled = compile(&rail, &Options::default()).unwrap();
    assert_eq!(compiled.free.len(), 2);
    solved_everywhere(&compiled);
}

/// Every pose of every set has solutions, and none is wrong.
fn solved_everywhere(compiled: &Compiled) {
    let report = prove(compiled, 0.0, &ProofOptions { poses: 300, seed: 5 }, &|| 0.0);
    assert!(report.emitted, "{}", report.reason);
    for set in &report.sets {
        assert_eq!((set.solved, set.wrong), (set.poses, 0), "{}: {set:?}", report.class);
    }
}

#[test]
fn rounded_descriptions_are_snapped_and_solved_exactly() {
    let mut chain = arms::ur5();
    for (i, joint) in chain.joints.iter_mut().enumerate() {
        let tilt = 3e-5 * (i as f64 - 2.5);
        joint.previous_from_joint.rotation *= nalgebra::UnitQuaternion::from_euler_angles(tilt, 0.0, -tilt);
    }
    let compiled = compile(&chain, &Options::default()).unwrap();
    assert!(compiled.snap > 1e-5 && compiled.snap < 1e-3, "{}", compiled.snap);
    let set = &poses::sets(&chain, &[], 200, Seed::new(3))[0];
    let report = robotc_ikgen::report::prove_set(&chain, &compiled.solver(), set, &|| 0.0);
    assert_eq!((report.solved, report.wrong), (200, 0), "{report:?}");
    let exact = Options { tolerance: 0.0, ..Options::default() };
    let unsnapped = compile(&chain, &exact).unwrap();
    assert!(unsnapped.class.starts_with("6R general"), "{}", unsnapped.class);
}

#[test]
fn a_program_serves_a_recalibrated_chain() {
    let compiled = compile(&arms::kr6(), &Options::default()).unwrap();
    let mut measured = arms::kr6();
    measured.joints[2].previous_from_joint.translation.vector.x += 2e-4;
    measured.joints[4].previous_from_joint.translation.vector.y -= 1e-4;
    let solver = Solver::from_text(&compiled.text(), &measured).unwrap();
    let set = &poses::sets(&measured, &[], 200, Seed::new(3))[0];
    let report = robotc_ikgen::report::prove_set(&measured, &solver, set, &|| 0.0);
    assert_eq!(report.wrong, 0);
    assert_eq!((report.solved, report.recovered), (200, 200), "{report:?}");
}

/// Nothing is wrong, and every branch is found: those too that the nominal arm has not, or has far away, near its folds.
#[test]
fn calibrated_arms_are_solved_through_the_nominal_one() {
    for chain in [arms::kr6(), arms::ur5(), arms::panda()] {
        let compiled = compile(&chain, &Options::default()).unwrap();
        let mut rng = Seed::new(9).rng();
        let (mut poses, mut solved, mut recovered) = (0, 0, 0);
        for _ in 0..10 {
            let measured = arms::calibrated(chain.clone(), &mut rng);
            let solver = Solver::new(compiled.program.clone(), &measured).unwrap();
            let set = poses::PoseSet {
                name: "random",
                regular: true,
                vectors: (0..50).map(|_| poses::random(&measured, &mut rng)).collect(),
            };
            let report = robotc_ikgen::report::prove_set(&measured, &solver, &set, &|| 0.0);
            assert_eq!(report.wrong, 0);
            (poses, solved, recovered) =
                (poses + report.poses, solved + report.solved, recovered + report.recovered);
        }
        println!("{}: {solved} solved, {recovered} recovered of {poses}", chain.name);
        assert_eq!((solved, recovered), (poses, poses), "{}", chain.name);
    }
}

#[test]
fn the_robots_of_the_thesis_are_solved() {
    for chain in arms::of_the_thesis() {
        let compiled = compile(&chain, &Options::default()).unwrap_or_else(|r| panic!("{}: {r}", chain.name));
        let report = prove(&compiled, 0.0, &ProofOptions { poses: 60, seed: 4 }, &|| 0.0);
        assert!(report.emitted, "{}: {}", chain.name, report.reason);
        for set in &report.sets {
            assert_eq!((set.solved, set.wrong), (set.poses, 0), "{}: {set:?}", chain.name);
            assert!(set.name != "random" || set.recovered == set.poses, "{}: {set:?}", chain.name);
        }
    }
}

#[test]
fn batches_give_the_bits_of_single_poses() {
    for chain in arms::all() {
        let compiled = compile(&chain, &Options::default()).unwrap();
        let solver = compiled.solver();
        for set in poses::sets(&chain, &compiled.free, 21, Seed::new(12)) {
            let mut base_from_tip: Vec<_> = set.vectors.iter().map(|v| chain.forward(v)).collect();
            base_from_tip.push(robotc_core::Pose::translation(9.0, 0.0, 0.0));
            let given = set.vectors.iter().flat_map(|v| compiled.free.iter().map(|k| v[*k]));
            let free: Vec<f64> = given.chain(compiled.free.iter().map(|_| 0.0)).collect();
            let (mut batch, mut out) = (Batch::default(), IkSolutions::new());
            solver.solve_batch(&base_from_tip, &free, &mut batch);
            assert_eq!(batch.len(), base_from_tip.len());
            for (i, pose) in base_from_tip.iter().enumerate() {
                let n = compiled.free.len();
                solver.solve(pose, &free[i * n..(i + 1) * n], &mut out);
                assert!(batch.solutions(i).eq(out.iter()), "{} {} {i}", chain.name, set.name);
            }
        }
    }
}

#[test]
fn poses_out_of_reach_and_nonsense_have_no_solution() {
    let compiled = compile(&arms::kr6(), &Options::default()).unwrap();
    let solver = compiled.solver();
    let mut out = IkSolutions::new();
    solver.solve(&robotc_core::Pose::translation(5.0, 0.0, 0.0), &[], &mut out);
    assert!(out.is_empty());
    solver.solve(&robotc_core::Pose::translation(f64::NAN, 0.0, 0.0), &[], &mut out);
    assert!(out.is_empty());
}

#[test]
fn solutions_are_distinct_and_principal() {
    let chain = arms::kr6();
    let solver = compile(&chain, &Options::default()).unwrap().solver();
    let mut out = IkSolutions::new();
    for vector in &poses::sets(&chain, &[], 100, Seed::new(2))[0].vectors {
        solver.solve(&chain.forward(vector), &[], &mut out);
        let all: Vec<&[f64]> = out.iter().collect();
        for (i, a) in all.iter().enumerate() {
            assert!(a.iter().all(|x| *x > -std::f64::consts::PI && *x <= std::f64::consts::PI));
            assert!(all[..i].iter().all(|b| !check::same(a, b, &[false; 6], 1e-7)));
        }
    }
}
