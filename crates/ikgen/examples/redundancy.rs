//! Intervals of the free joint of every arm of a folder that has seven, against dense sampling: a table in Markdown.
//!
//! `cargo run --release -p robotc-ikgen --example redundancy -- FOLDER [POSES] [SAMPLES] [FILTER]`: POSES poses within limits of each arm whose
//! name contains FILTER, SAMPLES values of the free joint each.

#![allow(clippy::print_stdout, clippy::print_stderr)]

#[allow(dead_code)]
#[path = "../tests/ikgen/arms.rs"]
mod arms;
mod collection;

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use robotc_core::ik::{IkSolutions, Preferences};
use robotc_core::{Seed, SerialChain};
use robotc_ikgen::run::{Completeness, RedundancyOptions};
use robotc_ikgen::{Options, compile};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = Path::new(arguments.first().map_or("../shared/data/arms", String::as_str));
    let number = |i: usize, default: usize| arguments.get(i).and_then(|n| n.parse().ok()).unwrap_or(default);
    let (poses, samples) = (number(1, 10), number(2, 100_000));
    let filter = arguments.get(3).map_or("", String::as_str);
    println!(
        "| arm | class | result | intervals | samples | inside, none found | outside, found | per pose |"
    );
    println!("|---|---|---|---:|---:|---:|---:|---:|");
    let own = [arms::iiwa(), arms::panda()].into_iter().map(|chain| (chain.name.clone(), chain));
    let own = own.filter(|(name, _)| name.contains(filter));
    for (name, chain) in own.chain(collection::arms(folder, filter)) {
        if chain.variables.len() == 7 {
            eprintln!("{name}");
            row(&name, &chain, poses, samples);
        }
    }
}

fn row(name: &str, chain: &SerialChain, poses: usize, samples: usize) {
    let compiled = match compile(chain, &Options::default()) {
        Ok(compiled) => compiled,
        Err(refusal) => return println!("| {name} | refused: {refusal} | | | | | | |"),
    };
    let [own] = compiled.free[..] else { return };
    let solver = compiled.solver();
    let preferences = Preferences { max_solutions: 1, ..Preferences::default() };
    let mut rng = Seed::new(4).split("redundancy").rng();
    let mut out = IkSolutions::new();
    let mut results: BTreeMap<String, usize> = BTreeMap::new();
    let (mut intervals, mut lost, mut wrong, mut tried, mut seconds) = (0, 0, 0, 0, 0.0);
    for _ in 0..poses {
        let vector: Vec<f64> =
            chain.variables.iter().map(|v| rng.range(v.lower.max(-3.1), v.upper.min(3.1))).collect();
        let pose = chain.forward(&vector);
        let start = Instant::now();
        let found = solver.free_intervals(&pose, &[0.0], 0, &preferences, &RedundancyOptions::default());
        seconds += start.elapsed().as_secs_f64();
        let found = found.expect("the preferences fit");
        intervals += found.intervals.len();
        let near = match found.completeness {
            Completeness::Complete => 1e-9,
            Completeness::ToWidth(width) | Completeness::Sampled(width) => width,
        };
        let word = match found.completeness {
            Completeness::ToWidth(width) => {
                format!("complete to width {:.0e}", libm::pow(10.0, libm::ceil(libm::log10(width))))
            }
            other => other.to_string(),
        };
        *results.entry(word).or_default() += 1;
        let variable = &chain.variables[own];
        let (low, high) =
            (variable.lower.max(-std::f64::consts::PI), variable.upper.min(std::f64::consts::PI));
        for k in 0..samples {
            let x = low + (high - low) * (k as f64 + 0.5) / samples as f64;
            if found.intervals.iter().flatten().any(|end| (x - end).abs() <= near) {
                continue;
            }
            tried += 1;
            solver.solve_preferred(&pose, &[x], &preferences, &mut out).expect("the preferences fit");
            match (out.is_empty(), found.contains(x)) {
                (true, true) => lost += 1,
                (false, false) => wrong += 1,
                _ => {}
            }
        }
    }
    let results: Vec<String> = results.iter().map(|(word, count)| format!("{word}: {count}")).collect();
    println!(
        "| {name} | {} | {} | {intervals} | {tried} | {lost} | {wrong} | {:.2} ms |",
        compiled.class,
        results.join(", "),
        seconds * 1e3 / poses as f64
    );
}
