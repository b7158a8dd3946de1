//! Benches over a task: doors opened from everywhere, arms on wheels, weights of the metric.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use robotc_core::Seed;
use robotc_core::task::Goal;
use robotc_kb::Project;
use robotc_planning::bench::{self, CagingBenchOptions, CagingReport, MobileBenchOptions};
use robotc_runtime::Session;
use serde::Serialize;

use super::compile::write_whole;
use crate::knowledge::{self, StoreArgs};
use crate::output::{Failure, Outcome, print, say};
use crate::progress::Progress;
use crate::settings::Settings;

/// Find from where an arm can open the doors and drawers of a task, in firm grasps and in loose ones
#[derive(Args)]
#[command(
    after_help = "Example:\n  robotc bench caging cabinet.task.toml --places 9 --report caging.json\n\n\
    The article of each goal to open is put all around the robot, with nothing else in the way. Counted is from where it can be \
    opened when any one firm grip is kept, and when loose grips may change within the cage; all end in contact."
)]
pub(super) struct Caging {
    /// A `*.task.toml` file with goals to open
    task: PathBuf,
    /// Places along each side of a square around the robot
    #[arg(long, value_name = "N", default_value_t = CagingBenchOptions::default().places)]
    places: usize,
    /// Headings of the article at each place
    #[arg(long, value_name = "N", default_value_t = CagingBenchOptions::default().headings)]
    headings: usize,
    /// Loose grips that are used, at most
    #[arg(long, value_name = "N", default_value_t = CagingBenchOptions::default().grips)]
    grips: usize,
    /// Longest time of each search
    #[arg(long, value_name = "SECONDS", default_value_t = CagingBenchOptions::default().seconds)]
    seconds: f64,
    /// File for all figures
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    #[command(flatten)]
    store: StoreArgs,
}

/// Compare three searches for an arm on wheels that goes to an object: BiSpace, RRT-JT, and RRT-Connect to sampled goals
#[derive(Args)]
#[command(
    after_help = "Example:\n  robotc bench bispace shelf.task.toml --seeds 16 --report bispace.json\n\n\
    The robot of the task is taken as if it stood on wheels; goals are grasps of its first object. Restarts count."
)]
pub(super) struct BiSpace {
    /// A `*.task.toml` file
    task: PathBuf,
    /// Runs of each search
    #[arg(long, value_name = "K", default_value_t = MobileBenchOptions::default().seeds)]
    seeds: u64,
    /// Seconds after which a run starts again
    #[arg(long, value_name = "SECONDS", default_value_t = MobileBenchOptions::default().restart)]
    restart: f64,
    /// File for all figures
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    #[command(flatten)]
    store: StoreArgs,
}

/// Compare two ways to find a first place to stand for an arm on wheels: inverse reachability, and anywhere within reach
#[derive(Args)]
#[command(
    after_help = "Example:\n  robotc bench placement shelf.task.toml --seeds 16 --report placement.json"
)]
pub(super) struct Placement {
    /// A `*.task.toml` file
    task: PathBuf,
    /// Runs of each
    #[arg(long, value_name = "K", default_value_t = MobileBenchOptions::default().seeds)]
    seeds: u64,
    /// File for all figures
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    #[command(flatten)]
    store: StoreArgs,
}

/// Compare planning times with the weights of the knowledge base and with equal ones
#[derive(Args)]
#[command(after_help = "Example:\n  robotc bench weights pick.task.toml --problems 50 --report weights.json")]
pub(super) struct Weights {
    /// A `*.task.toml` file
    task: PathBuf,
    /// Pairs of random configurations to plan between
    #[arg(long, value_name = "N", default_value_t = 30)]
    problems: usize,
    /// File for all figures
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    #[command(flatten)]
    store: StoreArgs,
}

fn open(task: &Path, store: &StoreArgs) -> Outcome<Session> {
    let spec = crate::input::task(task, &Settings::default())?;
    let graph = knowledge::plan(&Project::of_task(&spec))?;
    let compiled = knowledge::compile(&graph, &store.open()?)?;
    Session::open(&compiled.knowledge).map_err(|error| Failure::Input(error.to_string()))
}

fn write(path: Option<&Path>, report: &impl Serialize) -> Outcome {
    if let Some(path) = path {
        let text = serde_json::to_string_pretty(report).expect("plain values always have a JSON form");
        write_whole(path, (text + "\n").as_bytes())?;
        say(&format!("wrote {}", path.display()));
    }
    Ok(())
}

pub(super) fn caging(args: &Caging) -> Outcome {
    let session = open(&args.task, &args.store)?;
    let (clock, planner) = (Instant::now(), session.options());
    let now = || clock.elapsed().as_secs_f64();
    let options = CagingBenchOptions {
        places: args.places,
        headings: args.headings,
        grips: args.grips,
        seconds: args.seconds,
        ..CagingBenchOptions::default()
    };
    let mut reports = Vec::new();
    for goal in &session.task().goals {
        let Goal::Open { article, to } = *goal else { continue };
        let mut progress = Progress::new();
        let name = session.task().name_of(goal).to_owned();
        let mut done = |n: usize, all: usize| progress.update(&name, n as f64 / all as f64);
        let report = session
            .with_problem(|p| bench::measure_caging(p, &planner, (article, to), &options, &now, &mut done));
        drop(progress);
        reports.extend(report);
    }
    if reports.is_empty() {
        return Err(Failure::Input(format!("{} opens nothing", args.task.display())));
    }
    print(
        "article      joints grips places | opened: firm discrete randomized | times firm | within 2 s  median s  95 % s",
    );
    reports.iter().for_each(show);
    write(args.report.as_deref(), &reports)
}

fn show(report: &CagingReport) {
    let [firm, discrete, randomized] = report.opened;
    let times = |n: usize| if firm > 0 { format!("{:.2}", n as f64 / firm as f64) } else { "-".into() };
    print(&format!(
        "{:12} {:6} {:5} {:6} | {firm:12} {discrete:8} {randomized:10} | {:>4} {:>5} | {:8.0} % {:9.3} {:7.3}",
        report.article,
        report.joints,
        report.grips,
        report.places.len(),
        times(discrete),
        times(randomized),
        100.0 * report.within_two_seconds,
        report.seconds[0],
        report.seconds[1]
    ));
}

pub(super) fn bispace(args: &BiSpace) -> Outcome {
    let session = open(&args.task, &args.store)?;
    let (clock, planner) = (Instant::now(), session.options());
    let now = || clock.elapsed().as_secs_f64();
    let options =
        MobileBenchOptions { seeds: args.seeds, restart: args.restart, ..MobileBenchOptions::default() };
    let mut progress = Progress::new();
    let mut done = |n: u64, all: u64| progress.update("runs", n as f64 / all as f64);
    let report = session.with_problem(|p| bench::measure_mobile(p, &planner, &options, &now, &mut done));
    drop(progress);
    let report = report.ok_or_else(|| Failure::Input("no grasp of the object is free".into()))?;
    print(&format!(
        "{}: {} coordinates, {} goals, {} runs",
        report.scene, report.joints, report.goals, report.seeds
    ));
    print("search     solved   mean s  median s    states");
    for s in &report.searches {
        print(&format!(
            "{:10} {:6} {:8.3} {:9.3} {:9.0}",
            s.search, s.solved, s.mean_s, s.median_s, s.states
        ));
    }
    write(args.report.as_deref(), &report)
}

pub(super) fn placement(args: &Placement) -> Outcome {
    let session = open(&args.task, &args.store)?;
    let (clock, planner) = (Instant::now(), session.options());
    let now = || clock.elapsed().as_secs_f64();
    let options = MobileBenchOptions { seeds: args.seeds, ..MobileBenchOptions::default() };
    let report = session.with_problem(|p| bench::measure_placement(p, &planner, &options, &now));
    let report = report.ok_or_else(|| Failure::Input("no grasp of the object is free".into()))?;
    print(&format!(
        "{}: {} grasps, {} runs, samples drawn in {:.0} ms",
        report.scene, report.grasps, args.seeds, report.prepare_ms
    ));
    print("bases    solved  median ms  mean ms  places");
    for b in &report.bases {
        print(&format!(
            "{:8} {:6} {:10.2} {:8.2} {:7.1}",
            b.bases, b.solved, b.median_ms, b.mean_ms, b.places
        ));
    }
    print(&format!("{:.1} times as fast", report.times_faster));
    write(args.report.as_deref(), &report)
}

pub(super) fn weights(args: &Weights) -> Outcome {
    let session = open(&args.task, &args.store)?;
    let (clock, planner) = (Instant::now(), session.options());
    let now = || clock.elapsed().as_secs_f64();
    let seed = Seed::new(session.task().seed);
    let report = session.with_problem(|p| bench::measure_weights(p, &planner, args.problems, seed, &now));
    print(&format!(
        "{}: {} problems; weighted {} solved, {:.1} ms, {:.0} states; equal {} solved, {:.1} ms, {:.0} states; ratio {:.2}",
        report.scene,
        report.problems,
        report.solved[0],
        1e3 * report.mean_s[0],
        report.states[0],
        report.solved[1],
        1e3 * report.mean_s[1],
        report.states[1],
        report.ratio
    ));
    write(args.report.as_deref(), &report)
}
