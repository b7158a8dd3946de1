//! Compiles every arm of a folder with an `INDEX.tsv`, proves it, and prints a table in Markdown: what was solved of each set,
//! then class and time of each arm, or the reason why it is refused. `cargo xtask ik-zoo` stores it.
//!
//! `cargo run --release -p robotc-ikgen --example zoo -- FOLDER [POSES] [FILTER] [--detail] [--no-snap] [--singular=N] [--types=N]
//! [--calibrated=N]`: only
//! arms whose name contains FILTER; details are all sets, the search and the program; without snapping arms are solved as they are
//! described; the random set has POSES, the singular ones N, or as many; a second table has all parameterisations of some arms, N random
//! poses each, a third one calibrated arms. POSES may be 0 for these alone. Robots of the thesis that have no URDF are those of the tests.

#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::path::Path;
use std::time::Instant;

use robotc_core::{Seed, SerialChain};
use robotc_ikgen::report::poses::{PoseSet, random};
use robotc_ikgen::report::{ProofOptions, Report, SetReport, prove, prove_set};
use robotc_ikgen::{GoalType, Options, compile};

#[allow(dead_code)]
#[path = "../../tests/ikgen/arms.rs"]
mod arms;
mod calibrated;
#[path = "../collection/mod.rs"]
mod collection;
#[path = "../processor/mod.rs"]
mod processor;
mod types;

use calibrated::Calibrated;
use types::Types;

fn main() {
    let (options, arguments): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|a| a.starts_with("--"));
    let folder = Path::new(arguments.first().map_or("../shared/data/arms", String::as_str));
    let poses = arguments.get(1).and_then(|n| n.parse().ok()).unwrap_or(200);
    let filter = arguments.get(2).map_or("", String::as_str);
    let mut arms: Vec<(String, Report)> = Vec::new();
    let number = |option: &str| options.iter().find_map(|o| o.strip_prefix(option)?.parse::<usize>().ok());
    let mut of_types = number("--types=").map(Types::new);
    let mut of_calibrated = number("--calibrated=").map(Calibrated::new);
    let clock = Instant::now();
    let now = || clock.elapsed().as_secs_f64();
    for (name, chain) in collection::arms(folder, filter) {
        eprintln!("{name}");
        if let Some(table) = &mut of_types {
            table.add(&name, &chain);
        }
        if let Some(table) = &mut of_calibrated {
            table.add(&name, &chain, &now);
        }
        if poses > 0 {
            arms.push((name, arm(&chain, poses, &options)));
        }
    }
    let of_the_thesis = if poses > 0 { arms::of_the_thesis() } else { Vec::new() };
    for chain in of_the_thesis.into_iter().filter(|chain| chain.name.contains(filter)) {
        eprintln!("{}", chain.name);
        arms.push((chain.name.clone(), arm(&chain, poses, &options)));
    }
    if poses > 0 {
        summary(&arms, poses);
        table(&arms);
    }
    if let Some(table) = of_types {
        table.print();
    }
    if let Some(table) = of_calibrated {
        table.print();
    }
}

fn arm(chain: &SerialChain, poses: usize, options: &[String]) -> Report {
    let set = |name: &str| options.iter().any(|o| o == name);
    let tolerance = if set("--no-snap") { 0.0 } else { Options::default().tolerance };
    let clock = Instant::now();
    let now = || clock.elapsed().as_secs_f64();
    let start = processor::seconds().unwrap_or_else(now);
    let result = compile(chain, &Options { tolerance, ..Options::default() });
    let seconds = processor::seconds().unwrap_or_else(now) - start;
    let (report, trace, program) = match &result {
        Err(refusal) => {
            (Report::refused(refusal, GoalType::default(), seconds), &refusal.trace, String::new())
        }
        Ok(compiled) => {
            let singular = options.iter().find_map(|o| o.strip_prefix("--singular=")?.parse().ok());
            let singular = singular.unwrap_or(poses);
            let mut report = prove(compiled, seconds, &ProofOptions { poses: singular, seed: 1 }, &now);
            if singular != poses {
                let mut rng = Seed::new(2).split("ikgen zoo").rng();
                let vectors = (0..poses).map(|_| random(chain, &mut rng)).collect();
                let set = PoseSet { name: "random", regular: true, vectors };
                report.sets[0] = prove_set(chain, &compiled.solver(), &set, &now);
            }
            (report, &compiled.trace, compiled.text())
        }
    };
    if set("--detail") {
        report.sets.iter().for_each(|set| println!("{set:?}"));
        trace.iter().for_each(|line| println!("{line}"));
        println!("{program}");
    }
    report
}

fn summary(arms: &[(String, Report)], poses: usize) {
    let solved = arms.iter().filter(|(_, r)| r.emitted).count();
    println!("# Every arm of a collection\n");
    println!(
        "`cargo xtask ik-zoo FOLDER {poses}`: {solved} of {} arms solved, {poses} poses a set at most.\n",
        arms.len()
    );
    println!("| set | solved | recovered | wrong |\n|---|---|---|---|");
    for name in ["random", "wrist", "elbow", "shoulder", "zero", "grid90", "near"] {
        let sum = |f: fn(&SetReport) -> usize| -> usize {
            arms.iter().filter_map(|(_, r)| r.set(name)).map(f).sum()
        };
        let recovered = if name == "random" { sum(|s| s.recovered).to_string() } else { "-".into() };
        println!(
            "| {name} | {} of {} | {recovered} | {} |",
            sum(|s| s.solved),
            sum(|s| s.poses),
            sum(|s| s.wrong)
        );
    }
    println!();
}

fn table(arms: &[(String, Report)]) {
    println!(
        "*Missing*: poses of a set without a solution, and random joint vectors that were not among the answers. Times are those of a"
    );
    println!(
        "random pose: all solutions, with the check, by the bytecode; *singular* is the slowest singular set, as a multiple. *Generated in* \
         counts processor time.\n"
    );
    println!(
        "| arm | class, or why it is refused | missing | wrong | median | singular | generated in | Rust |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for (name, r) in arms {
        if r.sets.is_empty() {
            println!("| {name} | refused: {} | | | | | {:.2} s | |", r.reason, r.generation_s);
            continue;
        }
        let mut missing: Vec<String> = Vec::new();
        for s in &r.sets {
            if s.solved < s.poses {
                missing.push(format!("{} {}", s.name, s.poses - s.solved));
            }
            if s.name == "random" && s.recovered < s.solved {
                missing.push(format!("recovered {}", s.solved - s.recovered));
            }
        }
        let wrong: usize = r.sets.iter().map(|s| s.wrong).sum();
        let median = r.set("random").map_or(0.0, |s| s.median_ns / 1e3);
        // A set of one pose has no median to speak of.
        let singular = r.sets.iter().filter(|s| s.name != "random" && s.poses > 1).map(|s| s.median_ns / 1e3);
        let slowest = singular.fold(0.0, f64::max) / median;
        println!(
            "| {name} | {} | {} | {wrong} | {median:.1} us | {slowest:.1}x | {:.2} s | {} KB |",
            r.class,
            missing.join(", "),
            r.generation_s,
            r.source_bytes / 1000
        );
    }
}
