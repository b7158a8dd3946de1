//! `robotc bench weights`.

use clap::Args;
use robotc_core::Seed;
use robotc_planning::bench;

use super::page::Page;
use super::table::Table;
use super::{TaskArgs, clock, open, publish};
use crate::output::{Outcome, print};

/// Compare planning times with the weights of the knowledge base and with equal ones
#[derive(Args)]
#[command(
    after_help = "Example:\n  robotc bench weights pick.task.toml --problems 50 --report weights.json\n\n\
    Times are those of the processor, over what both solved."
)]
pub(in super::super) struct Weights {
    #[command(flatten)]
    task: TaskArgs,
    /// Pairs of random configurations to plan between
    #[arg(long, value_name = "N", default_value_t = 30)]
    problems: usize,
}

pub(in super::super) fn weights(args: &Weights) -> Outcome {
    let session = open(&args.task)?;
    let (planner, now) = (session.options(), clock::processor());
    let seed = Seed::new(session.task().seed);
    let report = session.with_problem(|p| bench::measure_weights(p, &planner, args.problems, seed, &now));
    let about = format!("{}: {} problems, ratio {:.2}", report.scene, report.problems, report.ratio);
    print(&about);
    let names = ["weighted", "equal"];
    let mut table = Table::new(&["metric", "solved", "mean ms", "states"]);
    for (k, name) in names.into_iter().enumerate() {
        table.row([
            name.into(),
            report.solved[k].to_string(),
            format!("{:.1}", 1e3 * report.mean_s[k]),
            format!("{:.0}", report.states[k]),
        ]);
    }
    publish(&args.task, &table, &report, || {
        let groups = [(report.scene.clone(), report.mean_s.map(|s| 1e3 * s).to_vec())];
        Page::new("Weights of the metric", &about).bars("Time to a path, mean", "ms", &names, &groups)
    })
}
