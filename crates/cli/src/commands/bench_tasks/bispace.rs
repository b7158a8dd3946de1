//! `robotc bench bispace`.

use clap::Args;
use robotc_planning::bench::{self, MobileBenchOptions, MobileReport};

use super::page::Page;
use super::table::Table;
use super::{TaskArgs, clock, open, publish};
use crate::output::{Failure, Outcome, print};
use crate::progress::Progress;

/// Compare three searches for an arm on wheels that goes to an object: BiSpace, RRT-JT, and RRT-Connect to sampled goals
#[derive(Args)]
#[command(
    after_help = "Example:\n  robotc bench bispace shelf.task.toml --seeds 16 --report bispace.json\n\n\
    The robot of the task is taken as if it stood on wheels; goals are grasps of its first object. Restarts count. Times are \
    those of the processor."
)]
pub(in super::super) struct BiSpace {
    #[command(flatten)]
    task: TaskArgs,
    /// Runs of each search
    #[arg(long, value_name = "K", default_value_t = MobileBenchOptions::default().seeds)]
    seeds: u64,
    /// Seconds after which a run starts again
    #[arg(long, value_name = "SECONDS", default_value_t = MobileBenchOptions::default().restart)]
    restart: f64,
}

pub(in super::super) fn bispace(args: &BiSpace) -> Outcome {
    let session = open(&args.task)?;
    let planner = session.options();
    let options =
        MobileBenchOptions { seeds: args.seeds, restart: args.restart, ..MobileBenchOptions::default() };
    let mut progress = Progress::new();
    let mut done = |n: u64, all: u64| progress.update("runs", n as f64 / all as f64);
    let report = session
        .with_problem(|p| bench::measure_mobile(p, &planner, &options, &clock::processor(), &mut done));
    drop(progress);
    let report = report.ok_or_else(|| Failure::Input("no grasp of the object is free".into()))?;
    let about = about(&report);
    print(&about);
    let mut table = Table::new(&["search", "solved", "mean ms", "median ms", "states"]);
    for s in &report.searches {
        table.row([
            s.search.into(),
            s.solved.to_string(),
            format!("{:.2}", 1e3 * s.mean_s),
            format!("{:.2}", 1e3 * s.median_s),
            format!("{:.0}", s.states),
        ]);
    }
    publish(&args.task, &table, &report, || {
        let groups: Vec<(String, Vec<f64>)> = report
            .searches
            .iter()
            .map(|s| (s.search.to_owned(), vec![1e3 * s.mean_s, 1e3 * s.median_s]))
            .collect();
        Page::new("An arm on wheels", &about).bars("Time to a path", "ms", &["mean", "median"], &groups)
    })
}

fn about(report: &MobileReport) -> String {
    let MobileReport { scene, joints, goals, seeds, .. } = report;
    format!("{scene}: {joints} coordinates, {goals} goals, {seeds} runs")
}
