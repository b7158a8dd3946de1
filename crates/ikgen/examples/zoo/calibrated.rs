//! Arms that are not quite as described, solved by the programs of those that are.

use robotc_core::{Seed, SerialChain};

use robotc_ikgen::report::poses::{PoseSet, random};
use robotc_ikgen::report::prove_set;
use robotc_ikgen::{Options, RustOptions, Solver, compile};

use super::arms::calibrated;

/// Of different classes.
const ARMS: [&str; 10] = [
    "kuka_kr10r1420",
    "ur_ur5e",
    "franka_panda",
    "kuka_lwr4",
    "fetch_fetch",
    "kawada_hironx",
    "jaka_pro7",
    "yaskawa_hc10",
    "ufactory_xarm6",
    "ufactory_xarm7",
];

/// Variants of each arm.
const VARIANTS: usize = 10;

/// The table, arm by arm.
pub(crate) struct Calibrated {
    poses: usize,
    rows: Vec<String>,
}

impl Calibrated {
    /// With so many poses of each variant.
    pub(crate) fn new(poses: usize) -> Self {
        Self { poses, rows: Vec::new() }
    }

    /// Measures an arm, if it is one of those. `now` counts seconds.
    pub(crate) fn add(&mut self, name: &str, chain: &SerialChain, now: &dyn Fn() -> f64) {
        if !ARMS.contains(&name) {
            return;
        }
        let compiled =
            compile(chain, &Options::default()).expect("the collection has only arms that are solved");
        let mut rng = Seed::new(1).split(name).rng();
        let (mut solved, mut recovered, mut wrong, mut medians) = (0, 0, 0, Vec::new());
        for _ in 0..VARIANTS {
            let measured = calibrated(chain.clone(), &mut rng);
            let solver = Solver::new(compiled.program.clone(), &measured).expect("it is of the same kind");
            let vectors = (0..self.poses).map(|_| random(&measured, &mut rng)).collect();
            let set = PoseSet { name: "random", regular: true, vectors };
            let report = prove_set(&measured, &solver, &set, now);
            solved += report.solved;
            recovered += report.recovered;
            wrong += report.wrong;
            medians.push(report.median_ns);
        }
        medians.sort_by(f64::total_cmp);
        let bytes = |calibrated| {
            let options = RustOptions { calibrated, ..RustOptions::default() };
            compiled.rust_source(&options).len() / 1000
        };
        self.rows.push(format!(
            "| {name} | {solved} of {} | {recovered} | {wrong} | {:.0} us | {} | {} |",
            VARIANTS * self.poses,
            medians[VARIANTS / 2] / 1e3,
            bytes(false),
            bytes(true)
        ));
    }

    pub(crate) fn print(&self) {
        println!("\n## Calibrated arms\n");
        println!(
            "{VARIANTS} variants of each arm, whose axes are off by up to 7 mrad and whose origins by up to 1 mm, {} random poses each, solved by \
             the nominal arm's program and the general solver on the arm as it is. *Rust*: thousands of bytes of the source, as it is, and \
             with `--calibrated`, which gives the same bits as the run-time library.\n",
            self.poses
        );
        println!(
            "| arm | solved | recovered | wrong | median | Rust | calibrated |\n|---|---|---|---|---|---|---|"
        );
        self.rows.iter().for_each(|row| println!("{row}"));
    }
}
