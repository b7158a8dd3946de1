//! All parameterisations of some arms.

use robotc_core::SerialChain;
use robotc_ikgen::report::{ProofOptions, prove};
use robotc_ikgen::{GoalType, Options, compile};

/// Four, five, six and seven joints, of different classes.
const ARMS: [&str; 10] = [
    "trossen_px100",
    "kawasaki_duaro",
    "neuronics_katana_450_6m90a",
    "fanuc_lrmate200ic5h",
    "kuka_kr5_arc",
    "ur_ur5e",
    "ufactory_xarm6",
    "franka_panda",
    "kuka_lwr4",
    "fetch_fetch",
];

/// The table, arm by arm.
pub(crate) struct Types {
    poses: usize,
    columns: Vec<(String, Vec<String>)>,
}

impl Types {
    /// With so many poses of each.
    pub(crate) fn new(poses: usize) -> Self {
        Self { poses, columns: Vec::new() }
    }

    /// Tries all parameterisations, if the arm is one of those.
    pub(crate) fn add(&mut self, name: &str, chain: &SerialChain) {
        if ARMS.contains(&name) {
            let cells = GoalType::ALL.map(|goal| outcome(chain, goal, self.poses));
            self.columns.push((name.into(), cells.to_vec()));
        }
    }

    pub(crate) fn print(&self) {
        println!("\n## Parameterisations\n");
        println!(
            "{} random poses each: *all*, where each was solved and its joint vector among the answers, else how many were solved and \
             how many recovered; - where the type does not suit the chain.\n",
            self.poses
        );
        let names: Vec<&str> = self.columns.iter().map(|(name, _)| name.as_str()).collect();
        println!("| type | {} |\n|---|{}", names.join(" | "), "---|".repeat(names.len()));
        for (k, goal) in GoalType::ALL.into_iter().enumerate() {
            let cells: Vec<&str> = self.columns.iter().map(|(_, cells)| cells[k].as_str()).collect();
            println!("| {} | {} |", goal.name(), cells.join(" | "));
        }
    }
}

/// What came of a parameterisation of an arm.
fn outcome(chain: &SerialChain, goal: GoalType, poses: usize) -> String {
    let Ok(compiled) = compile(chain, &Options { goal, ..Options::default() }) else { return "-".into() };
    let report = prove(&compiled, 0.0, &ProofOptions { poses, seed: 3 }, &|| 0.0);
    let Some(set) = report.set("random") else { return "-".into() };
    let wrong = if set.wrong > 0 { format!(", {} wrong", set.wrong) } else { String::new() };
    if set.recovered == set.poses && set.solved == set.poses {
        format!("all{wrong}")
    } else {
        format!("{} / {}{wrong}", set.solved, set.recovered)
    }
}
