//! Joints that follow others, and sliding joints between turning ones, anywhere in a chain.

use robotc_core::Seed;
use robotc_core::ik::{IkSolutions, Preferences, VariableRange};
use robotc_core::model::{ChainMotion, SerialChain};
use robotc_ikgen::report::{ProofOptions, poses, prove};
use robotc_ikgen::{Compiled, Options, check, compile};

use crate::arms::{self, chain, following, sliding};

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// A painter: a wrist of three oblique axes of which the middle one is two joints that turn in opposite directions (ABB IRB 5400).
fn painter() -> SerialChain {
    let slanted = |angle: f64| [angle.cos(), 0.0, -angle.sin()];
    let axes = [
        (Z, [0.0, 0.0, 0.0]),
        (Y, [0.3, 0.0, 0.66]),
        (Y, [0.3, 0.0, 1.86]),
        (X, [1.6, 0.0, 2.046]),
        (slanted(0.6109), [1.7083, 0.0, 2.046]),
        (slanted(-0.6109), [1.838, 0.0, 2.046]),
        (X, [1.92, 0.0, 2.046]),
    ];
    following(chain("painter", &axes, [2.0, 0.02, 2.046]), 5, 4, -1.0)
}

/// An arm without any relation between its axes and one joint more, which may follow.
fn crooked(name: &str) -> SerialChain {
    let axes = [
        (Z, [0.0, 0.0, 0.3]),
        ([0.1, 1.0, 0.2], [0.1, 0.05, 0.5]),
        ([1.0, 0.3, 0.1], [0.4, 0.1, 0.6]),
        ([0.2, 1.0, -0.3], [0.5, 0.0, 0.75]),
        (X, [0.8, 0.02, 0.7]),
        (Y, [0.85, 0.0, 0.73]),
        ([1.0, 0.0, 0.5], [0.95, 0.05, 0.7]),
    ];
    chain(name, &axes, [1.05, 0.0, 0.7])
}

/// A skew arm whose joint slides.
fn lengthened(joint: usize) -> SerialChain {
    let mut arm = sliding(arms::skew(), &[joint]);
    arm.name = format!("skew, joint {} sliding", joint + 1);
    arm
}

fn chains() -> Vec<SerialChain> {
    let telescope = |mut arm: SerialChain, multiplier| {
        for joint in [2, 3] {
            arm.joints[joint].motion = ChainMotion::Prismatic;
        }
        following(arm, 3, 2, multiplier)
    };
    let mut five = crooked("five and one that follows");
    five.joints.pop();
    five.variables.pop();
    vec![
        painter(),
        following(crooked("a neighbour by half"), 4, 3, 0.5),
        following(crooked("far off, the opposite"), 5, 1, -1.0),
        following(crooked("two joints between, twice"), 4, 1, 2.0),
        telescope(crooked("two slides"), 0.5),
        following(five, 2, 1, 1.0),
        lengthened(1),
        lengthened(4),
    ]
}

/// Compared by all back ends: an angle and a length.
pub(crate) fn two_kinds() -> Vec<Compiled> {
    let named = |chain: SerialChain, name: &str| {
        compile(&SerialChain { name: name.into(), ..chain }, &options()).unwrap()
    };
    vec![named(chains().swap_remove(1), "by_half"), named(lengthened(4), "sliding")]
}

/// Fewer trials than usual: a sweep takes a millisecond.
fn options() -> Options {
    Options { trial_poses: 12, ..Options::default() }
}

#[test]
fn chains_with_one_unknown_that_moves_others_are_solved_everywhere() {
    for chain in chains() {
        let compiled =
            compile(&chain, &options()).unwrap_or_else(|r| panic!("{}: {r}\n{:#?}", chain.name, r.trace));
        let report = prove(&compiled, 0.0, &ProofOptions { poses: 30, seed: 5 }, &|| 0.0);
        assert!(report.emitted, "{}: {}", chain.name, report.reason);
        for set in &report.sets {
            let what = format!("{} ({}): {set:?}", chain.name, report.class);
            assert_eq!((set.solved, set.wrong), (set.poses, 0), "{what}");
            assert!(set.name != "random" || set.recovered == set.poses, "{what}");
        }
    }
}

/// A joint that follows by half is somewhere else after a full turn: its variable has no aliases.
#[test]
fn an_angle_that_another_joint_follows_by_half_has_no_aliases() {
    let mut chain = chains().swap_remove(1);
    chain.variables.iter_mut().for_each(|v| (v.lower, v.upper) = (-7.0, 7.0));
    assert_eq!(VariableRange::of(&chain)[3].motion, ChainMotion::Prismatic);
    let solver = compile(&chain, &options()).unwrap().solver();
    let preferences = Preferences { aliases: robotc_core::ik::Aliases::All, ..Preferences::default() };
    let mut out = IkSolutions::new();
    for vector in &poses::sets(&chain, &[], 10, Seed::new(2))[0].vectors {
        let pose = chain.forward(vector);
        solver.solve_preferred(&pose, &[], &preferences, &mut out).unwrap();
        assert!(!out.is_empty());
        assert!(out.iter().all(|q| check::distance(&chain, q, &pose) < 1e-9));
    }
}
