//! Compiles every arm of a folder with an `INDEX.tsv` and prints a table: class, or the reason why not, and the proof.
//!
//! `cargo run --release -p robotc-ikgen --example zoo -- FOLDER [POSES] [FILTER]`

#![allow(clippy::print_stdout)]

use std::path::Path;
use std::time::Instant;

use robotc_core::system::{ReadError, System};
use robotc_core::urdf::{LoadOptions, MeshPolicy, load};
use robotc_core::{Kinematics, SerialChain, Sources};
use robotc_ikgen::report::{ProofOptions, prove};
use robotc_ikgen::{Options, compile};

struct Files;

impl System for Files {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadError> {
        std::fs::read(path).map_err(|e| ReadError::Unreadable(e.to_string()))
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }
}

fn chain(path: &Path, base: &str, tip: &str) -> Option<SerialChain> {
    let options = LoadOptions { meshes: MeshPolicy::Ignore, ..LoadOptions::default() };
    let (model, _) = load(&Files, &mut Sources::new(), path, &options);
    let kinematics = Kinematics::new(model?.into());
    let link = |name: &str| kinematics.model().link_named(name);
    SerialChain::between(&kinematics, link(base)?, link(tip)?).ok()
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = Path::new(arguments.first().map_or("../shared/data/arms", String::as_str));
    let poses = arguments.get(1).and_then(|n| n.parse().ok()).unwrap_or(200);
    let filter = arguments.get(2).map_or("", String::as_str);
    let index = std::fs::read_to_string(folder.join("INDEX.tsv")).expect("the folder has an INDEX.tsv");
    let clock = Instant::now();
    let now = || clock.elapsed().as_secs_f64();
    let (mut arms, mut solved) = (0, 0);
    for line in index.lines().skip(1) {
        let field: Vec<&str> = line.split('\t').collect();
        if !field[0].contains(filter) {
            continue;
        }
        arms += 1;
        let name = field[0].trim_end_matches(".urdf");
        let Some(chain) = chain(&folder.join(field[0]), field[4], field[5]) else {
            println!("{name:32} no chain from {} to {}", field[4], field[5]);
            continue;
        };
        let start = now();
        let result = compile(&chain, &Options::default());
        let seconds = now() - start;
        match result {
            Err(refusal) => {
                println!("{name:32} REFUSED {} [{}]", refusal.reason, field[7]);
                if arguments.len() > 3 {
                    refusal.trace.iter().for_each(|l| println!("    {l}"));
                }
            }
            Ok(compiled) => {
                let report = prove(&compiled, seconds, &ProofOptions { poses, seed: 1 }, &now);
                solved += usize::from(report.emitted);
                println!(
                    "{name:32} {} | snap {:.1e} | {:.0} ms | {} B {}",
                    report.class,
                    report.snap_max,
                    1e3 * seconds,
                    report.source_bytes,
                    report.reason
                );
                for s in report.sets.iter().filter(|s| s.poses > 0) {
                    let flag = if s.solved < s.poses || s.wrong > 0 { "  <--" } else { "" };
                    println!(
                        "    {:9} solved {}/{} recovered {} wrong {} error {:.1e} mean {:.2} median {:.0} ns p99 {:.0} ns{flag}",
                        s.name,
                        s.solved,
                        s.poses,
                        s.recovered,
                        s.wrong,
                        s.max_error,
                        s.mean_solutions,
                        s.median_ns,
                        s.p99_ns
                    );
                }
                if arguments.len() > 3 {
                    println!("{}", compiled.text());
                    compiled.trace.iter().for_each(|l| println!("    {l}"));
                }
            }
        }
    }
    println!("{solved} of {arms} arms solved");
}
