//! Every type of goal, on chains that it suits.

use nalgebra::Vector3;
use robotc_core::Seed;
use robotc_core::ik::{IkSolutions, InverseKinematics as _};
use robotc_core::model::SerialChain;
use robotc_ikgen::generate::natural;
use robotc_ikgen::goal::pose_along;
use robotc_ikgen::report::{ProofOptions, poses, prove};
use robotc_ikgen::{Compiled, GoalType, Options, Solver, compile};

use crate::arms::{self, chain, sliding};
use crate::real_arms::real;

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// Pan, shoulder and elbow of a common arm.
fn elbow() -> SerialChain {
    chain("elbow", &[(Z, [0.0, 0.0, 0.3]), (Y, [0.05, 0.0, 0.4]), (Y, [0.05, 0.03, 0.8])], [0.45, 0.03, 0.85])
}

/// Three axes without any relation.
fn odd() -> SerialChain {
    let axes =
        [(Z, [0.0, 0.0, 0.3]), ([0.2, 1.0, 0.1], [0.1, 0.05, 0.4]), ([1.0, 0.4, 0.1], [0.3, 0.0, 0.7])];
    chain("odd", &axes, [0.5, 0.2, 0.9])
}

/// Pan and tilt, with an eye that looks along x at zero.
fn head() -> SerialChain {
    chain("head", &[(Z, [0.0, 0.0, 1.0]), (Y, [0.02, 0.0, 1.1])], [0.1, 0.03, 1.15])
}

/// Two links in the plane.
fn plane2() -> SerialChain {
    chain("plane2", &[(Z, [0.0; 3]), (Z, [0.4, 0.0, 0.0])], [0.7, 0.0, 0.1])
}

/// Three links in the plane; the tip's x axis lies in it.
fn plane3() -> SerialChain {
    let mut arm =
        chain("plane3", &[(Z, [0.0; 3]), (Z, [0.4, 0.0, 0.0]), (Z, [0.7, 0.0, 0.0])], [0.8, 0.0, 0.1]);
    arm.last_from_tip.rotation = nalgebra::UnitQuaternion::from_euler_angles(0.4, 0.0, 0.0);
    arm
}

/// Five joints: pan, three parallel axes, roll; the tool is at an angle to the roll axis.
fn welder() -> SerialChain {
    let mut arm = arms::katana();
    arm.name = "welder".into();
    arm.last_from_tip.rotation = nalgebra::UnitQuaternion::from_euler_angles(0.0, 0.7, 0.0);
    arm
}

/// Five joints without any relation between the last three.
fn odd5() -> SerialChain {
    let mut arm = arms::skew();
    arm.name = "odd5".into();
    arm.joints.pop();
    arm.variables.pop();
    arm.last_from_tip = nalgebra::Isometry3::from_parts(
        nalgebra::Translation3::new(0.1, 0.05, 0.2),
        nalgebra::UnitQuaternion::from_euler_angles(0.3, 0.7, 0.2),
    );
    arm
}

/// Pan and three parallel axes.
fn pan_and_plane() -> SerialChain {
    let mut arm = arms::katana();
    arm.name = "pan_and_plane".into();
    arm.joints.pop();
    arm.variables.pop();
    arm.last_from_tip = nalgebra::Isometry3::from_parts(
        nalgebra::Translation3::new(0.12, 0.0, 0.0),
        nalgebra::UnitQuaternion::from_euler_angles(0.0, 1.2, 0.0),
    );
    arm
}

/// A gantry with a wrist of one joint.
fn gantry4() -> SerialChain {
    let at = [0.2, 0.1, 1.0];
    let mut arm =
        sliding(chain("gantry4", &[(X, at), (Y, at), (Z, at), (Y, at)], [0.3, 0.1, 1.0]), &[0, 1, 2]);
    arm.last_from_tip.rotation = nalgebra::UnitQuaternion::from_euler_angles(0.0, 0.4, 0.0);
    arm
}

fn wrist() -> SerialChain {
    let at = [0.0, 0.0, 0.5];
    chain("wrist", &[(Z, at), (Y, at), (X, at)], [0.1, 0.0, 0.5])
}

/// Two turns and a slide along a line across them, on a pan: a ray has four freedoms.
fn sprayer() -> SerialChain {
    let at = [0.1, 0.0, 0.6];
    let joints = [(X, [0.0; 3]), (Z, [0.0; 3]), (Z, at), (Y, at)];
    sliding(chain("sprayer", &joints, [0.2, 0.0, 0.6]), &[0, 1])
}

/// A solver for each way in which goal types differ: compared by all back ends.
pub(crate) fn one_of_each_kind() -> Vec<Compiled> {
    use GoalType::*;
    let named = |chain: SerialChain, goal: GoalType| {
        let name = format!("{}_{}", chain.name, goal.name());
        compiled(&SerialChain { name, ..chain }, goal)
    };
    vec![
        named(head(), Lookat3D),
        named(elbow(), TranslationLocalGlobal6D),
        named(gantry4(), TranslationXAxisAngle4D),
    ]
}

fn cases() -> Vec<(SerialChain, GoalType)> {
    use GoalType::*;
    vec![
        (elbow(), Translation3D),
        (odd(), Translation3D),
        (arms::wam4(), Translation3D),
        (arms::kr6(), Translation3D),
        (wrist(), Rotation3D),
        (head(), Direction3D),
        (head(), Lookat3D),
        (arms::kr6(), Rotation3D),
        (arms::kr6(), Direction3D),
        (arms::scara(), Translation3D),
        (sprayer(), Ray4D),
        (welder(), TranslationDirection5D),
        (odd5(), TranslationDirection5D),
        (arms::kr6(), TranslationDirection5D),
        (plane2(), TranslationXY2D),
        (plane3(), TranslationXYOrientation3D),
        (elbow(), TranslationLocalGlobal6D),
        (gantry4(), TranslationXAxisAngle4D),
        (gantry4(), TranslationYAxisAngle4D),
        (gantry4(), TranslationZAxisAngle4D),
        (pan_and_plane(), TranslationZAxisAngleYNorm4D),
    ]
}

fn compiled(chain: &SerialChain, goal: GoalType) -> Compiled {
    let options = Options { goal, ..Options::default() };
    compile(chain, &options).unwrap_or_else(|r| panic!("{} {}: {r}\n{:#?}", chain.name, goal.name(), r.trace))
}

#[test]
fn every_goal_of_every_type_is_solved_and_nothing_is_wrong() {
    for (chain, goal) in cases() {
        let report = prove(&compiled(&chain, goal), 0.0, &ProofOptions { poses: 200, seed: 5 }, &|| 0.0);
        assert!(report.emitted, "{} {}: {}", chain.name, goal.name(), report.reason);
        assert_eq!(report.kind, goal.name());
        for set in &report.sets {
            let what = format!("{} ({}): {set:?}", chain.name, report.class);
            assert_eq!((set.solved, set.wrong), (set.poses, 0), "{what}");
            assert!(set.name != "random" || set.recovered == set.poses, "{what}");
        }
    }
}

/// Rays of arms whose joints cannot be found one after the other, given joints in several places, more joints than the type needs, and a
/// tool that turns about the last joint.
#[test]
fn types_are_solved_where_the_unknowns_are_not_found_one_by_one() {
    use GoalType::*;
    let options = |goal| Options { goal, trial_poses: 12, ..Options::default() };
    for (chain, goal, poses) in [
        (arms::ur5(), Ray4D, 40),
        (arms::panda(), Ray4D, 40),
        (arms::kr6(), TranslationZAxisAngle4D, 100),
        (arms::iiwa(), TranslationLocalGlobal6D, 100),
        (arms::scara(), TranslationDirection5D, 200),
    ] {
        let compiled = compile(&chain, &options(goal)).unwrap_or_else(|r| panic!("{} {r}", chain.name));
        let report = prove(&compiled, 0.0, &ProofOptions { poses, seed: 7 }, &|| 0.0);
        assert!(report.emitted, "{} {}: {}", chain.name, goal.name(), report.reason);
        assert_eq!(report.sets.iter().map(|set| set.wrong).sum::<usize>(), 0, "{}", chain.name);
        let random = &report.sets[0];
        assert_eq!((random.solved, random.recovered), (poses, poses), "{}: {random:?}", report.class);
    }
}

/// The three turns of which only the sum shows in the angle are not told apart near singular poses as well as those of other arms.
#[test]
fn an_angle_to_the_vertical_of_a_planar_arm() {
    let compiled = compiled(&pan_and_plane(), GoalType::TranslationZAxisAngle4D);
    let report = prove(&compiled, 0.0, &ProofOptions { poses: 200, seed: 5 }, &|| 0.0);
    for set in &report.sets {
        assert!(set.wrong == 0 && set.solved * 100 >= set.poses * 98, "{set:?}");
        assert!(set.name != "random" || set.recovered == set.poses, "{set:?}");
    }
}

#[test]
fn what_the_type_does_not_use_of_a_pose_may_be_anything() {
    let mut out = IkSolutions::new();
    let arm = elbow();
    let solver = compiled(&arm, GoalType::Translation3D).solver();
    let place = arm.forward(&[0.3, -0.5, 1.1]);
    solver.solve(&place, &[], &mut out);
    let by_pose: Vec<Vec<f64>> = out.iter().map(<[f64]>::to_vec).collect();
    assert!((2..=4).contains(&by_pose.len()));
    solver.solve(&pose_along(&place.translation.vector, &-Vector3::z()), &[], &mut out);
    assert_eq!(out.len(), by_pose.len());
    for (a, b) in out.iter().zip(&by_pose) {
        assert_eq!(a.len(), 3);
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9), "{a:?} {b:?}");
    }
}

#[test]
fn a_head_looks_forward() {
    let head = head();
    let solver = compiled(&head, GoalType::Lookat3D).solver();
    let mut out = IkSolutions::new();
    solver.solve(&pose_along(&Vector3::new(2.0, 1.0, 0.5), &Vector3::z()), &[], &mut out);
    assert!(!out.is_empty());
    for q in out.iter() {
        let eye = head.forward(q);
        let off = Vector3::new(2.0, 1.0, 0.5) - eye.translation.vector;
        assert!((off.normalize() - eye.rotation * Vector3::z()).norm() < 1e-9);
    }
}

#[test]
fn a_point_of_the_tool_is_given_with_each_call() {
    let arm = elbow();
    let compiled = compiled(&arm, GoalType::TranslationLocalGlobal6D);
    assert_eq!(compiled.free, [3, 4, 5]);
    let loaded = Solver::from_text(&compiled.text(), &arm).unwrap();
    let mut out = IkSolutions::new();
    let point = nalgebra::Point3::new(0.1, -0.02, 0.3);
    let place = arm.forward(&[0.3, -0.5, 1.1]) * point;
    loaded.solve(&pose_along(&place.coords, &Vector3::x()), point.coords.as_slice(), &mut out);
    assert!(out.len() > 1);
    assert!(out.iter().all(|q| ((arm.forward(q) * point) - place).norm() < 1e-9));
}

#[test]
fn joints_that_a_goal_says_nothing_of_are_given() {
    // All that turns the tip of a planar arm is the sum of its joints.
    assert_eq!(compiled(&plane3(), GoalType::Rotation3D).free, [1, 2]);
    assert_eq!(compiled(&arms::wam4(), GoalType::Translation3D).free, [2]);
    let chosen = Options { goal: GoalType::Translation3D, free: Some(vec![0]), ..Options::default() };
    assert_eq!(compile(&arms::wam4(), &chosen).unwrap().free, [0]);
    let nonsense = Options { free: Some(vec![5]), ..chosen };
    assert!(compile(&arms::wam4(), &nonsense).is_err());
}

#[test]
fn the_natural_type_follows_from_the_freedom() {
    use GoalType::*;
    for (chain, goal) in [
        (arms::kr6(), Transform6D),
        (arms::iiwa(), Transform6D),
        (welder(), TranslationDirection5D),
        (arms::scara(), Transform6D),
        (pan_and_plane(), TranslationZAxisAngle4D),
        (elbow(), Translation3D),
        (wrist(), Rotation3D),
        (plane3(), TranslationXYOrientation3D),
        (head(), Direction3D),
        (plane2(), TranslationXY2D),
    ] {
        assert_eq!(natural(&chain), goal, "{}", chain.name);
    }
}

#[test]
fn of_roots_that_nearly_meet_none_is_lost() {
    let Some(chain) = real("franka_panda", "panda_link0", "panda_link8") else { return };
    let compiled = compile(&chain, &Options { goal: GoalType::Ray4D, ..Options::default() }).unwrap();
    let solver = compiled.solver();
    // Its rays come in pairs with the same slide, and at the last of these vectors another pair is 3 mm away.
    let sets = poses::sets(&chain, &compiled.free, 382, Seed::new(3));
    let mut out = IkSolutions::new();
    for q in &sets[0].vectors[340..] {
        let free: Vec<f64> = compiled.free.iter().map(|v| q[*v]).collect();
        solver.solve(&chain.forward(q), &free, &mut out);
        let itself = |s: &[f64]| s.iter().zip(q).all(|(a, b)| (a - b).cos() > 1.0 - 1e-12);
        assert!(out.iter().any(itself), "{q:?}");
    }
}
