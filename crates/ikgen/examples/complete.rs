//! Whether all solutions that are not singular are found where many poses are: a table in Markdown.
//!
//! `cargo run --release -p robotc-ikgen --example complete -- FOLDER [POSES] [FILTER...]`: POSES poses of each set, of the arms whose name
//! contains one of the words.

#![allow(clippy::print_stdout, clippy::print_stderr)]

use std::path::Path;
use std::time::Instant;

use robotc_core::Seed;
use robotc_ikgen::report::complete::completeness;
use robotc_ikgen::report::{poses, prove_set};
use robotc_ikgen::{Options, compile};

mod collection;
mod processor;

/// Least singular value of the Jacobian where a solution counts as regular.
const REGULAR: f64 = 1e-4;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = Path::new(arguments.first().map_or("../shared/data/arms", String::as_str));
    let count = arguments.get(1).and_then(|n| n.parse().ok()).unwrap_or(300);
    println!(
        "| arm | set | poses | regular solutions | lost | at poses | median | mean |\n|---|---|---:|---:|---:|---:|---:|---:|"
    );
    let words = arguments.get(2..).unwrap_or_default();
    for (name, chain) in collection::arms(folder, "") {
        if !words.is_empty() && !words.iter().any(|word| name.contains(word)) {
            continue;
        }
        let Ok(compiled) = compile(&chain, &Options::default()) else { continue };
        let solver = compiled.solver();
        let clock = Instant::now();
        let now = || clock.elapsed().as_secs_f64();
        for set in poses::sets(&chain, &compiled.free, count, Seed::new(1).split("ikgen proof")) {
            let processor = || processor::seconds().unwrap_or(0.0);
            let start = processor();
            let report = prove_set(&chain, &solver, &set, &now);
            let mean = (processor() - start) / set.vectors.len().max(1) as f64 * 1e6;
            let found = completeness(&chain, &solver, &set.vectors, REGULAR);
            println!(
                "| {name} | {} | {} | {} | {} | {} | {:.0} us | {mean:.0} us |",
                set.name,
                set.vectors.len(),
                found.solutions,
                found.lost,
                found.poses,
                report.median_ns * 1e-3
            );
        }
    }
}
