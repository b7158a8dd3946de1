//! Intervals of the free value, against dense sampling.

use robotc_core::Seed;
use robotc_core::ik::{IkSolutions, Limits, Preferences};
use robotc_core::model::SerialChain;
use robotc_ikgen::run::{Completeness, RedundancyOptions};
use robotc_ikgen::{GoalType, Options, Solver, compile};

use crate::arms;

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
    for _ in 0..poses {
        let vector: Vec<f64> = chain.variables.iter().map(|v| rng.range(v.lower, v.upper)).collect();
        let pose = chain.forward(&vector);
        let preferences = Preferences::default();
        let found =
            solver.free_intervals(&pose, &[0.0], 0, &preferences, &RedundancyOptions::default()).unwrap();
        let own = compiled.free[0];
        assert!(found.contains(vector[own]), "{}: {} {found:?}", chain.name, vector[own]);
        let (low, high) = (chain.variables[own].lower, chain.variables[own].upper);
        let near = match found.completeness {
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
        for value in found.spread(9) {
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
    for chain in [arms::panda(), arms::iiwa(), arms::fetch()] {
        let (count, width) = agrees(&limited(chain.clone()), GoalType::Transform6D, 6);
        println!("{}: {count} intervals of 6 poses, to {width:e}", chain.name);
        assert!(count >= 6 && width <= 1e-5, "{} {count} {width}", chain.name);
    }
    let (count, width) = agrees(&limited(arms::wam4()), GoalType::Translation3D, 6);
    assert!(count >= 6 && width <= 1e-5, "{count} {width}");
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
