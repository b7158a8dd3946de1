//! Limits, aliases, order and number of the returned solutions.

use robotc_core::Seed;
use robotc_core::ik::{Aliases, IkSolutions, InverseKinematics, Limits, Preferences};
use robotc_ikgen::report::poses;
use robotc_ikgen::run::Engine;
use robotc_ikgen::{Options, check, compile};

use crate::arms;

#[test]
fn within_limits_is_what_the_unlimited_solver_finds_there() {
    for mut chain in [arms::kr6(), arms::ur5(), arms::xarm6()] {
        let n = chain.variables.len();
        for (v, variable) in chain.variables.iter_mut().enumerate() {
            (variable.lower, variable.upper) = if v % 2 == 0 { (-2.0, 2.5) } else { (-6.0, 5.0) };
        }
        let solver = compile(&chain, &Options::default()).unwrap().solver();
        let mut rng = Seed::new(4).rng();
        let (mut all, mut kept) = (IkSolutions::new(), IkSolutions::new());
        let every = Preferences { aliases: Aliases::All, ..Preferences::default() };
        let mut aliases = 0;
        for _ in 0..100 {
            let start: Vec<f64> = chain.variables.iter().map(|v| rng.range(v.lower, v.upper)).collect();
            let pose = chain.forward(&start);
            solver.solve(&pose, &[], &mut all);
            solver.solve_preferred(&pose, &[], &Preferences::default(), &mut kept).unwrap();
            let inside =
                |q: &&[f64]| q.iter().zip(solver.ranges()).all(|(x, range)| range.nearest(*x, 0.0).is_some());
            assert_eq!(kept.len(), all.iter().filter(inside).count());

            solver.solve_preferred(&pose, &[], &every, &mut kept).unwrap();
            aliases += kept.len();
            for q in kept.iter() {
                assert!(check::distance(&chain, q, &pose) < 1e-9);
                assert!(q.iter().zip(&chain.variables).all(|(x, v)| v.lower <= *x && *x <= v.upper));
            }
            let itself = |q: &[f64]| q.iter().zip(&start).all(|(a, b)| (a - b).abs() < 1e-6);
            assert!(kept.iter().any(itself), "{start:?}");

            // Nearest first, and the generating vector is nearest to itself.
            let near = Preferences { near: Some(start.clone()), ..every.clone() };
            solver.solve_preferred(&pose, &[], &near, &mut kept).unwrap();
            let first = kept.iter().next().unwrap();
            assert!(itself(first), "{} {start:?} {first:?}", chain.name);
            let cost = |q: &[f64]| q.iter().zip(&start).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
            let costs: Vec<f64> = kept.iter().map(cost).collect();
            assert!(costs.is_sorted_by(|a, b| *a <= b + 1e-12));
            let one = Preferences { max_solutions: 1, ..near };
            let first = first.to_vec();
            solver.solve_preferred(&pose, &[], &one, &mut kept).unwrap();
            assert_eq!(kept.iter().collect::<Vec<_>>(), [&first[..]]);
        }
        assert!(aliases > 100 * n, "{aliases}");
    }
}

#[test]
fn a_stopped_search_gives_the_first_solutions() {
    for chain in arms::all() {
        let compiled = compile(&chain, &Options::default()).unwrap();
        for engine in [Engine::Bytecode, Engine::Interpreter] {
            let solver = compiled.solver().with_engine(engine);
            let mut rng = Seed::new(6).rng();
            let (mut all, mut some) = (IkSolutions::new(), IkSolutions::new());
            for _ in 0..10 {
                let vector = poses::random(&chain, &mut rng);
                let free: Vec<f64> = compiled.free.iter().map(|v| vector[*v]).collect();
                let pose = chain.forward(&vector);
                solver.solve(&pose, &free, &mut all);
                for most in [1, 3] {
                    let first = Preferences {
                        max_solutions: most,
                        limits: Limits::Ignored,
                        ..Preferences::default()
                    };
                    solver.solve_preferred(&pose, &free, &first, &mut some).unwrap();
                    assert!(some.iter().eq(all.iter().take(most)), "{}", chain.name);
                }
            }
        }
    }
}
