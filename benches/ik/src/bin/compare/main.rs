//! Times all solvers of an arm on the same poses, interleaved in one process, and judges their answers by one checker.
//!
//! `compare [POSES] [--only ARM] [--write FILE.md]`

mod contender;
#[path = "../../../generated/mod.rs"]
mod generated;
mod ours;
mod peers;
mod table;
mod trial;

use robotc_core::Seed;
use robotc_ik_bench::{ARMS, Arm, CRX, KR6, UR5E};
use robotc_ikgen::report::poses;
use robotc_ikgen::{Compiled, Options, compile};

use contender::{Contender, Task};
use peers::{Class, Crx, IkGeo, Opw};
use trial::{Entrant, Row};

fn main() -> std::io::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let after = |flag: &str| arguments.iter().position(|a| a == flag).and_then(|i| arguments.get(i + 1));
    let count = arguments.first().and_then(|n| n.parse().ok()).unwrap_or(2000);
    let mut rows = Vec::new();
    for arm in ARMS.into_iter().filter(|arm| after("--only").is_none_or(|name| name == arm.name)) {
        let Ok(compiled) = compile(&arm.chain(), &Options::default()) else { continue };
        eprintln!("{}: {}", arm.name, compiled.class);
        rows.extend(race(arm, &compiled, count));
    }
    let text = table::markdown(&rows, count);
    println!("{text}");
    match after("--write") {
        Some(path) => std::fs::write(path, text),
        None => Ok(()),
    }
}

/// All solvers of an arm on all sets of poses.
fn race(arm: &Arm, compiled: &Compiled, count: usize) -> Vec<Row> {
    let mut entrants: Vec<Entrant> = generated::all()
        .into_iter()
        .filter(|g| g.arm == arm.name)
        .map(|g| Entrant { name: format!("robotc {}", g.flavour), solver: g.solver })
        .collect();
    entrants.extend(ours::entrants(compiled));
    let mut peer = |name: &str, solver: Box<dyn Contender>| {
        entrants.push(Entrant { name: name.into(), solver });
    };
    if arm.name == KR6.name {
        peer("ik-geo", Box::new(IkGeo::new(arm, &Class::SphericalTwoParallel)));
        peer("rs-opw-kinematics", Box::new(Opw::kr6()));
    } else if arm.name == UR5E.name {
        peer("ik-geo", Box::new(IkGeo::new(arm, &Class::ThreeParallelTwoIntersecting)));
    } else if arm.name == CRX.name {
        peer("crx-kinematics", Box::new(Crx::new_10ia()));
    } else if arm.axes.len() == 7 {
        // What a given joint of seven is measured by: the six joints of the KR 6.
        peer("ik-geo on kr6", Box::new(IkGeo::new(&KR6, &Class::SphericalTwoParallel)));
    }
    let chain = compiled.chain();
    let mut rows = Vec::new();
    for set in poses::sets(chain, &compiled.free, count, Seed::new(7)) {
        let tasks: Vec<Task> = set.vectors.iter().map(|joints| task(compiled, joints)).collect();
        if !tasks.is_empty() {
            let judged = arm.axes.len() == 6;
            rows.extend(trial::run(arm, chain, &set, &tasks, &mut entrants, judged));
        }
    }
    rows
}

fn task(compiled: &Compiled, joints: &[f64]) -> Task {
    let pose = compiled.chain().forward(joints);
    Task {
        joints: joints.to_vec(),
        rotation: pose.rotation.to_rotation_matrix().into_inner(),
        position: pose.translation.vector,
        free: compiled.free.iter().map(|v| joints[*v]).collect(),
    }
}
