//! Continua of solutions at singular poses.

use robotc_core::Seed;
use robotc_core::ik::{FamilyPath, IkSolutions, InverseKinematics, Limits, Preferences};
use robotc_core::model::SerialChain;
use robotc_ikgen::report::poses;
use robotc_ikgen::{Options, Solver, check, compile};

use crate::arms;

fn solver(chain: &SerialChain) -> Solver {
    compile(chain, &Options::default()).unwrap().solver()
}

/// Every member of every family reaches the pose, and its joints move as they should; how many lines and curves there are.
fn checked(chain: &SerialChain, solver: &Solver, vector: &[f64]) -> [usize; 2] {
    let pose = chain.forward(vector);
    let free: Vec<f64> = solver.free_variables().iter().map(|v| vector[*v]).collect();
    let mut out = IkSolutions::new();
    solver.solve_with_families(&pose, &free, &mut out);
    let solutions: Vec<Vec<f64>> = out.iter().map(<[f64]>::to_vec).collect();
    let mut count = [0, 0];
    for family in out.families() {
        let solution = &solutions[family.solution];
        let [low, high] = family.interval;
        assert!(low <= 0.0 && 0.0 <= high && high - low > 0.05, "{family:?}");
        assert_eq!(family.direction[family.leader()], 1.0);
        for k in 0..=20 {
            let t = low + (high - low) * f64::from(k) / 20.0;
            let Some(member) = solver.family_member(&pose, solution, family, t) else {
                panic!("{}: {t} of {family:?}", chain.name)
            };
            assert!(check::distance(chain, &member, &pose) < 1e-9, "{}: {t} {family:?}", chain.name);
            let led = member[family.leader()] - solution[family.leader()];
            assert!((led - t).abs() < 1e-9, "{}: {led} {t}", chain.name);
            assert!(free.iter().zip(solver.free_variables()).all(|(x, v)| member[*v] == *x));
        }
        assert!(solver.family_member(&pose, solution, family, high + 0.1).is_none());
        count[usize::from(family.path == FamilyPath::Curve)] += 1;
    }
    count
}

#[test]
fn a_stretched_wrist_is_a_line_of_two_joints() {
    let chain = arms::kr6();
    let solver = solver(&chain);
    let mut rng = Seed::new(3).rng();
    let mut out = IkSolutions::new();
    for _ in 0..20 {
        let mut vector = poses::random(&chain, &mut rng);
        vector[4] = 0.0;
        let [lines, _] = checked(&chain, &solver, &vector);
        assert!(lines >= 1);
        solver.solve_with_families(&chain.forward(&vector), &[], &mut out);
        let wrist = out.families().iter().any(|f| f.direction == [0.0, 0.0, 0.0, -1.0, 0.0, 1.0]);
        assert!(wrist, "{:?}", out.families());
    }
}

#[test]
fn families_are_found_where_axes_line_up_and_nowhere_else() {
    for chain in [arms::kr6(), arms::skew(), arms::ur5(), arms::iiwa(), arms::xarm6()] {
        let solver = solver(&chain);
        for set in poses::sets(&chain, solver.free_variables(), 12, Seed::new(8)) {
            let mut found = [0, 0];
            for vector in &set.vectors {
                let count = checked(&chain, &solver, vector);
                found = [found[0] + count[0], found[1] + count[1]];
            }
            let expected = match (&chain.name[..], set.name) {
                (_, "random") => found == [0, 0],
                ("kr6" | "skew", "wrist") => found[0] >= 12,
                ("ur5", "wrist") => found[1] >= 12,
                ("kr6", "shoulder") => found[1] >= 6,
                _ => true,
            };
            assert!(expected, "{} {}: {found:?}", chain.name, set.name);
        }
    }
}

#[test]
fn a_member_within_limits_is_found_where_the_representative_is_outside() {
    let chain = arms::kr6();
    let solver = solver(&chain);
    let mut rng = Seed::new(5).rng();
    let (mut all, mut kept) = (IkSolutions::new(), IkSolutions::new());
    let mut outside = 0;
    for _ in 0..40 {
        let mut vector = poses::random(&chain, &mut rng);
        vector[4] = 0.0;
        let pose = chain.forward(&vector);
        let box_around = |size: f64| vector.iter().map(|x| [x - size, x + size]).collect();
        let limits = Preferences { limits: Limits::Given(box_around(0.02)), ..Preferences::default() };
        solver.solve(&pose, &[], &mut all);
        let inside = |q: &[f64]| q.iter().zip(&vector).all(|(a, b)| (a - b).abs() < 0.02);
        outside += usize::from(!all.iter().any(inside));
        solver.solve_preferred(&pose, &[], &limits, &mut kept).unwrap();
        assert!(!kept.is_empty() && kept.iter().all(inside), "{vector:?}");
        let near = Preferences {
            near: Some(vector.clone()),
            max_solutions: 1,
            limits: Limits::Ignored,
            ..Preferences::default()
        };
        solver.solve_preferred(&pose, &[], &near, &mut kept).unwrap();
        let first = kept.iter().next().unwrap();
        assert!(check::distance(&chain, first, &pose) < 1e-9);
        assert!(first.iter().zip(&vector).all(|(a, b)| (a - b).abs() < 1e-5), "{vector:?} {first:?}");
    }
    assert!(outside > 30, "{outside}");
}
