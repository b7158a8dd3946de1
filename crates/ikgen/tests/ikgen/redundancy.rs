//! Intervals of the free value, against dense sampling.

use std::f64::consts::PI;

use robotc_core::Seed;
use robotc_core::ik::{IkSolutions, Limits, Preferences};
use robotc_core::model::{ChainVariable, SerialChain};
use robotc_ikgen::check;
use robotc_ikgen::run::{Completeness, RedundancyOptions, Side};
use robotc_ikgen::{GoalType, Options, Solver, compile};

use crate::arms;
use crate::real_arms::real;

/// Points of a dense sampling.
const POINTS: usize = 1000;

fn limited(mut chain: SerialChain) -> SerialChain {
    let limits = [(-2.9, 2.9), (-1.8, 1.8), (-2.9, 2.9), (-2.6, 2.7), (-2.8, 2.8), (-1.9, 2.6), (-2.5, 2.9)];
    for (variable, (lower, upper)) in chain.variables.iter_mut().zip(limits) {
        (variable.lower, variable.upper) = (lower, upper);
    }
    chain
}

fn has_solution(solver: &Solver, pose: &robotc_core::Pose, value: f64, preferences: &Preferences) -> bool {
    let mut out = IkSolutions::new();
    solver.solve_preferred(pose, &[value], preferences, &mut out).unwrap();
    !out.is_empty()
}

/// Sampling finds no solution outside of the intervals, and inside of them one everywhere.
fn agrees(chain: &SerialChain, goal: GoalType, poses: usize) -> (usize, f64) {
    let compiled = compile(chain, &Options { goal, ..Options::default() }).unwrap();
    let solver = compiled.solver();
    let mut rng = Seed::new(21).rng();
    let (mut ends, mut widest) = (0, 0f64);
    let within = |v: &ChainVariable| (v.lower.max(-PI), v.upper.min(PI));
    for _ in 0..poses {
        let draw = |v| {
            let (low, high) = within(v);
            rng.range(low, high)
        };
        let vector: Vec<f64> = chain.variables.iter().map(draw).collect();
        let pose = chain.forward(&vector);
        let preferences = Preferences::default();
        let found =
            solver.free_intervals(&pose, &[0.0], 0, &preferences, &RedundancyOptions::default()).unwrap();
        let own = compiled.free[0];
        assert!(found.contains(vector[own]), "{}: {} {found:?}", chain.name, vector[own]);
        let (low, high) = within(&chain.variables[own]);
        let near = match found.completeness {
            Completeness::Complete => 1e-9,
            Completeness::ToWidth(width) => width,
            Completeness::Sampled(step) => step,
        };
        widest = widest.max(near);
        let from_end = |x: f64| {
            found.intervals.iter().flatten().map(|end| (x - end).abs()).fold(f64::INFINITY, f64::min)
        };
        for k in 0..POINTS {
            let x = low + (high - low) * (k as f64 + 0.5) / POINTS as f64;
            if from_end(x) > near {
                let holds = has_solution(&solver, &pose, x, &preferences);
                assert_eq!(holds, found.contains(x), "{}: {x} {found:?}", chain.name);
            }
        }
        for [low, high] in &found.intervals {
            assert!(low <= high);
            for end in [low, high] {
                assert!(has_solution(&solver, &pose, *end, &preferences), "{}: {end} {found:?}", chain.name);
            }
        }
        assert!(found.intervals.is_sorted_by(|a, b| a[1] < b[0]));
        for value in found.spread(9).into_iter().filter(|x| from_end(*x) > near) {
            assert!(has_solution(&solver, &pose, value, &preferences), "{}: {value} {found:?}", chain.name);
        }
        let seed = rng.range(-3.0, 3.0);
        let nearest = found.nearest(seed).unwrap();
        assert!(found.contains(nearest) && (found.contains(seed) == (nearest == seed)));
        ends += found.intervals.len();
    }
    (ends, widest)
}

#[test]
fn intervals_are_what_sampling_finds() {
    let (count, width) = agrees(&limited(arms::iiwa()), GoalType::Transform6D, 20);
    assert!(count >= 20 && width == 1e-9, "{count} {width}");
    for chain in [arms::panda(), arms::fetch()] {
        let (count, width) = agrees(&limited(chain.clone()), GoalType::Transform6D, 6);
        println!("{}: {count} intervals of 6 poses, to {width:e}", chain.name);
        assert!(count >= 6 && width <= 1e-5, "{} {count} {width}", chain.name);
    }
    let (count, width) = agrees(&limited(arms::wam4()), GoalType::Translation3D, 6);
    assert!(count >= 6 && width <= 1e-5, "{count} {width}");
}

/// Arms of seven joints that no structure helps: no three axes meet, they meet only nearly, or all but line up by rounded angles.
const GENERAL: [(&str, &str, &str); 5] = [
    ("flexiv_rizon4", "world", "flange"),
    ("kinova_gen3_7dof", "world", "gen3_bracelet_link"),
    ("ufactory_xarm7", "world", "link_eef"),
    ("neuromeka_indyrp2", "world", "tcp"),
    ("yaskawa_csda10f", "torso_link_b1", "arm_right_link_tool0"),
];

#[test]
fn intervals_are_complete_where_axes_meet_nearly_or_not() {
    for (file, base, tip) in GENERAL {
        let Some(chain) = real(file, base, tip) else { return };
        let (count, width) = agrees(&chain, GoalType::Transform6D, 2);
        println!("{}: {count} intervals of 2 poses, to {width:e}", chain.name);
        assert!(count >= 2 && width <= 1e-4, "{} {count} {width}", chain.name);
    }
}

#[test]
fn limits_are_those_that_are_asked_for() {
    let chain = limited(arms::panda());
    let solver = compile(&chain, &Options::default()).unwrap().solver();
    let vector = [0.1, -0.4, 0.3, 1.8, 0.2, 1.7, 0.5];
    let pose = chain.forward(&vector);
    let options = RedundancyOptions::default();
    let of = |limits: Limits| {
        let preferences = Preferences { limits, ..Preferences::default() };
        solver.free_intervals(&pose, &[0.0], 0, &preferences, &options).unwrap()
    };
    let narrow = of(Limits::Given(vector.iter().map(|x| [x - 0.05, x + 0.05]).collect()));
    let described = of(Limits::Described);
    let all = of(Limits::Ignored);
    assert!(0.0 < narrow.measure() && narrow.measure() <= 0.1);
    assert!(narrow.measure() < described.measure() && described.measure() <= all.measure());
    assert!(narrow.contains(0.5) && described.contains(0.5) && all.contains(0.5));
    let mut rng = Seed::new(1).rng();
    assert!((0..50).all(|_| described.contains(described.draw(&mut rng).unwrap())));
    let far = robotc_core::Pose::translation(9.0, 0.0, 0.0);
    let none = solver.free_intervals(&far, &[0.0], 0, &Preferences::default(), &options).unwrap();
    assert!(none.is_empty() && none.nearest(0.0).is_none() && none.spread(3).is_empty());
}

/// Arms with spherical shoulder and wrist whose descriptions are exact.
const SPHERICAL: [(&str, &str, &str); 4] = [
    ("barrett_wam7", "world", "wam/wrist_palm_link"),
    ("kuka_lwr4", "box", "lwr_7_link_dummy"),
    ("schunk_lwa4d", "world", "arm_ee_link"),
    ("yaskawa_sia10d", "world", "link_t"),
];

/// Every solution of the intervals is one, and every solution is of the intervals.
fn swivels(chain: &SerialChain, vectors: &[Vec<f64>]) -> [usize; 2] {
    let compiled = compile(chain, &Options::default()).unwrap();
    let solver = compiled.solver();
    let preferences = Preferences::default();
    let (mut intervals, mut aligned) = (0, 0);
    for vector in vectors {
        let pose = chain.forward(vector);
        let branches = solver.swivel(&pose, &preferences).unwrap().expect("shoulder and wrist are spherical");
        for branch in &branches {
            aligned += usize::from([branch.shoulder, branch.wrist].contains(&Side::Aligned));
            assert!(branch.intervals.is_sorted_by(|a, b| a[0] <= a[1] && a[1] < b[0]));
            for [low, high] in &branch.intervals {
                intervals += 1;
                for k in 0..=20 {
                    let psi = low + (high - low) * f64::from(k) / 20.0;
                    // Rounding at an end.
                    let Some(joints) = branch.joints(psi.min(*high)) else {
                        assert!(k == 0 || k == 20, "{}: {psi} {branch:?}", chain.name);
                        continue;
                    };
                    let error = check::distance(chain, &joints, &pose);
                    assert!(error < 1e-9, "{}: {error:e} {vector:?} {branch:?}", chain.name);
                    for (value, variable) in joints.iter().zip(&chain.variables) {
                        assert!(variable.lower <= *value && *value <= variable.upper);
                    }
                }
            }
        }
        let reached = |joint: usize, value: f64| {
            let own = branches.iter().flat_map(|b| b.joint_intervals(joint)).collect::<Vec<_>>();
            own.iter().any(|[low, high]| low - 1e-9 <= value && value <= high + 1e-9)
        };
        for (joint, value) in vector.iter().enumerate() {
            assert!(reached(joint, *value), "{}: joint {joint} {vector:?} {branches:#?}", chain.name);
        }
    }
    [intervals, aligned]
}

/// No sample of the free joint leads nearer to a joint vector than the search does.
#[test]
fn the_nearest_solution_of_all_is_found() {
    let mut rng = Seed::new(8).rng();
    for chain in [limited(arms::iiwa()), limited(arms::panda())] {
        let solver = compile(&chain, &Options::default()).unwrap().solver();
        let ranges = robotc_core::ik::VariableRange::of(&chain);
        let options = RedundancyOptions::default();
        for _ in 0..5 {
            let mut inside = || chain.variables.iter().map(|v| rng.range(v.lower, v.upper)).collect();
            let (vector, near): (Vec<f64>, Vec<f64>) = (inside(), inside());
            let pose = chain.forward(&vector);
            let preferences = Preferences { near: Some(near.clone()), ..Preferences::default() };
            let found = solver.solve_nearest(&pose, &[0.0], 0, &preferences, &options).unwrap().unwrap();
            // What is beyond a limit by rounding is moved onto it.
            assert!(check::distance(&chain, &found, &pose) < 1e-8);
            let away = |q: &[f64]| preferences.squared_distance(&ranges, q, &near);
            let mut out = IkSolutions::new();
            let intervals =
                solver.solve_spread(&pose, &[0.0], 0, 500, &preferences, &options, &mut out).unwrap();
            assert!(out.len() >= 500 && out.iter().all(|q| intervals.contains(q[6])));
            let least = out.iter().map(away).fold(f64::INFINITY, f64::min);
            assert!(away(&found) <= least + 1e-9, "{}: {} {least}", chain.name, away(&found));
            // From where it is the arm stays.
            let home = Preferences { near: Some(vector.clone()), ..Preferences::default() };
            let stays = solver.solve_nearest(&pose, &[0.0], 0, &home, &options).unwrap().unwrap();
            assert!(stays.iter().zip(&vector).all(|(a, b)| (a - b).abs() < 1e-6));
        }
    }
}

#[test]
fn swivel_angles_are_all_there_are() {
    let mut rng = Seed::new(5).rng();
    let chain = limited(arms::iiwa());
    let inside = |rng: &mut robotc_core::rng::Rng, chain: &SerialChain| -> Vec<f64> {
        chain.variables.iter().map(|v| rng.range(v.lower.max(-3.1), v.upper.min(3.1))).collect()
    };
    let vectors: Vec<Vec<f64>> = (0..200).map(|_| inside(&mut rng, &chain)).collect();
    let [intervals, aligned] = swivels(&chain, &vectors);
    assert!(intervals > 400 && aligned == 0, "{intervals} {aligned}");
    // Axes that line up: each of the second, fourth and sixth joint, and several at once.
    let singular: Vec<Vec<f64>> = (0..70)
        .map(|i| {
            let mut vector = inside(&mut rng, &chain);
            let lined_up: &[usize] = [&[1][..], &[3], &[5], &[1, 5], &[1, 3], &[3, 5], &[1, 3, 5]][i % 7];
            lined_up.iter().for_each(|v| vector[*v] = 0.0);
            vector
        })
        .collect();
    let [intervals, aligned] = swivels(&chain, &singular);
    assert!(intervals > 70 && aligned >= 60, "{intervals} {aligned}");
    for (file, base, tip) in SPHERICAL {
        let Some(chain) = real(file, base, tip) else { return };
        let vectors: Vec<Vec<f64>> = (0..20).map(|_| inside(&mut rng, &chain)).collect();
        assert!(swivels(&chain, &vectors)[0] >= 20, "{file}");
    }
}
