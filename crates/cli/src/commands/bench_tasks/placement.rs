//! `robotc bench placement`.

use clap::Args;
use robotc_planning::bench::{self, MobileBenchOptions};

use super::page::Page;
use super::table::Table;
use super::{TaskArgs, clock, open, publish};
use crate::output::{Failure, Outcome, print};

/// Compare two ways to find a first place to stand for an arm on wheels: inverse reachability, and anywhere within reach
#[derive(Args)]
#[command(
    after_help = "Example:\n  robotc bench placement shelf.task.toml --seeds 16 --report placement.json\n\n\
    Times are those of the processor."
)]
pub(in super::super) struct Placement {
    #[command(flatten)]
    task: TaskArgs,
    /// Runs of each
    #[arg(long, value_name = "K", default_value_t = MobileBenchOptions::default().seeds)]
    seeds: u64,
}

pub(in super::super) fn placement(args: &Placement) -> Outcome {
    let session = open(&args.task)?;
    let planner = session.options();
    let options = MobileBenchOptions { seeds: args.seeds, ..MobileBenchOptions::default() };
    let now = clock::processor();
    let robot = session.lane_robot();
    let report = session.with_problem(|p| bench::measure_placement(p, &robot, &planner, &options, &now));
    let report = report.ok_or_else(|| Failure::Input("no grasp of the object is free".into()))?;
    let about = format!(
        "{}: {} grasps, {} runs, samples drawn in {:.0} ms",
        report.scene, report.grasps, args.seeds, report.prepare_ms
    );
    print(&about);
    let mut table = Table::new(&[
        "bases",
        "solved",
        "median ms",
        "mean ms",
        "places",
        "sifted",
        "base not free",
        "out of reach",
        "touching",
    ]);
    for b in &report.bases {
        table.row([
            b.bases.into(),
            b.solved.to_string(),
            format!("{:.2}", b.median_ms),
            format!("{:.2}", b.mean_ms),
            format!("{:.1}", b.places),
            format!("{:.1}", b.sifted),
            format!("{:.1}", b.bases_not_free),
            format!("{:.1}", b.out_of_reach),
            format!("{:.1}", b.touching),
        ]);
    }
    publish(&args.task, &table, &report, || {
        let groups = |of: &dyn Fn(&bench::PlacementFigures) -> Vec<f64>| -> Vec<(String, Vec<f64>)> {
            report.bases.iter().map(|b| (b.bases.to_owned(), of(b))).collect()
        };
        Page::new("Places to stand", &about)
            .bars(
                "Time to the first place",
                "ms",
                &["mean", "median"],
                &groups(&|b| vec![b.mean_ms, b.median_ms]),
            )
            .bars("Places tried", "", &["mean"], &groups(&|b| vec![b.places]))
    })?;
    print(&format!("{:.1} times as fast", report.times_faster));
    Ok(())
}
