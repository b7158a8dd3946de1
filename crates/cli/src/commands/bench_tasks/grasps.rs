//! `robotc bench grasps`.

use clap::Args;
use robotc_planning::bench::{self, GraspBenchOptions, GraspReport};

use super::page::Page;
use super::table::Table;
use super::{TaskArgs, clock, open, publish};
use crate::output::{Failure, Outcome};
use crate::progress::Progress;

/// Find out how long it takes to know one way to pick an object up and put it down
#[derive(Args)]
#[command(
    after_help = "Example:\n  robotc bench grasps mug.task.toml --grasps 1000 --destinations 100 --report grasps.json\n\n\
    A grasp is usable when approach, lift, lowering and retreat are free, each on one branch of inverse kinematics. Times are \
    those of the processor, from nothing to the first usable grasp."
)]
pub(in super::super) struct Grasps {
    #[command(flatten)]
    task: TaskArgs,
    /// Grasps of each object, at most
    #[arg(long, value_name = "N", default_value_t = GraspBenchOptions::default().grasps)]
    grasps: usize,
    /// Destinations of each goal, at most
    #[arg(long, value_name = "N", default_value_t = GraspBenchOptions::default().destinations)]
    destinations: usize,
    /// Runs of each goal, each with other destinations
    #[arg(long, value_name = "K", default_value_t = GraspBenchOptions::default().seeds)]
    seeds: u64,
}

pub(in super::super) fn grasps(args: &Grasps) -> Outcome {
    let session = open(&args.task)?;
    let planner = session.options();
    let options =
        GraspBenchOptions { grasps: args.grasps, destinations: args.destinations, seeds: args.seeds };
    let mut progress = Progress::new();
    let mut done = |n: usize, all: usize| progress.update("goals", n as f64 / all as f64);
    let reports = session
        .with_problem(|p| bench::measure_grasps(p, &planner, &options, &clock::processor(), &mut done));
    drop(progress);
    if reports.is_empty() {
        return Err(Failure::Input(format!("{} puts nothing down", args.task.task.display())));
    }
    let mut table = Table::new(&[
        "object",
        "grasps",
        "places",
        "found",
        "median ms",
        "95 % ms",
        "max ms",
        "looked at",
        "places",
        "all",
        "ms",
    ]);
    for report in &reports {
        row(&mut table, report);
    }
    publish(&args.task, &table, &reports, || page(&session.task().name, &reports))
}

fn row(table: &mut Table, report: &GraspReport) {
    let [median, most, max] = report.first_ms.map(|ms| format!("{ms:.3}"));
    let [grasps, places] = report.looked_at.map(|n| format!("{n:.1}"));
    let [runs, found] = report.runs;
    table.row([
        report.object.clone(),
        report.known[0].to_string(),
        report.known[1].to_string(),
        format!("{found}/{runs}"),
        median,
        most,
        max,
        grasps,
        places,
        report.all.0.to_string(),
        format!("{:.0}", report.all.1),
    ]);
}

fn page(task: &str, reports: &[GraspReport]) -> Page {
    let about = "Milliseconds of the processor from nothing to a grasp for which approach, lift, lowering and retreat are free, among \
        all grasps and destinations.";
    let groups: Vec<(String, Vec<f64>)> =
        reports.iter().map(|r| (r.object.clone(), r.first_ms.to_vec())).collect();
    let all: Vec<(String, Vec<f64>)> = reports.iter().map(|r| (r.object.clone(), vec![r.all.1])).collect();
    Page::new(&format!("Grasps of {task}"), about)
        .bars("The first usable grasp", "ms", &["median", "95 %", "longest"], &groups)
        .bars("All of them", "ms", &["all"], &all)
}
