//! `robotc bench`: how fast planning and collision checks are, on given problems.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use clap::{Args, Subcommand};
use robotc_core::geom::PointCloud;
use robotc_core::model::Shape;
use robotc_core::urdf::{self, MeshPolicy};
use robotc_core::{Sources, srdf};
use robotc_kb::os::OsSystem;
use robotc_planning::bench::{self, BenchOptions, BenchRobot, ProblemSet, Report, Summary};
use robotc_planning::motion::{SAMPLINGS, Sampling};

use super::bench_tasks;
use super::compile::write_whole;
use crate::description::DescriptionArgs;
use crate::output::{Failure, Outcome, print, say};
use crate::progress::Progress;

/// Measure planning and collision checks on given problems
#[derive(Args)]
pub(crate) struct Bench {
    #[command(subcommand)]
    what: What,
}

#[derive(Subcommand)]
enum What {
    Bispace(bench_tasks::BiSpace),
    Caging(bench_tasks::Caging),
    Checks(Checks),
    Grasps(bench_tasks::Grasps),
    Motion(Motion),
    Placement(bench_tasks::Placement),
    Weights(bench_tasks::Weights),
}

/// Files that problems are about.
#[derive(Args)]
struct Input {
    /// Problems: a JSON file, or one compressed by xz
    problems: PathBuf,
    /// Robot description
    #[arg(long, value_name = "FILE")]
    urdf: PathBuf,
    /// Its semantic description: pairs of links that need no test
    #[arg(long, value_name = "FILE")]
    srdf: PathBuf,
    /// Give the obstacles of each problem as one cloud of points on their surfaces, no more than this far apart, metres
    #[arg(long, value_name = "SPACING", value_parser = spacing)]
    cloud: Option<f64>,
    #[command(flatten)]
    reading: DescriptionArgs,
    /// File for all figures
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
}

/// Count configurations checked per second, in lanes and one at a time
#[derive(Args)]
#[command(
    after_help = "Example:\n  robotc bench checks problems.json.xz --urdf arm.urdf --srdf arm.srdf\n\n\
    All checkers look at the same free motions in the first problem of each family of scenes.\n\
    A look is a test by spheres; a proof holds until the next configuration."
)]
struct Checks {
    #[command(flatten)]
    input: Input,
}

/// Plan every problem of a file and report times, path lengths and proofs
#[derive(Args)]
#[command(after_help = "Example:\n  robotc bench motion problems.json.xz --urdf arm.urdf --srdf arm.srdf \
    --report report.json\n\n\
    Problems are those of MotionBenchMaker in a flat JSON form. A problem is valid when its start and goal are free, with \
    every collision element of the robot as its convex hull; a path counts as certified when code that the planner does \
    not use proves all of it free.")]
struct Motion {
    #[command(flatten)]
    input: Input,
    /// Plan each problem this often, each time with another seed
    #[arg(long, value_name = "K", default_value_t = BenchOptions::default().seeds)]
    seeds: u32,
    /// Searches that race for the first path, each on a thread of its own; the path does not depend on which thread is faster
    #[arg(long, value_name = "N", default_value_t = BenchOptions::default().racers, value_parser = clap::value_parser!(u32).range(1..=64))]
    race: u32,
    /// How states are drawn that searches grow towards
    #[arg(long, value_name = "NAME", default_value = SAMPLINGS[0].name, value_parser = SAMPLINGS.each_ref().map(|s| s.name))]
    sampling: String,
    /// Iterations after which a search gives up
    #[arg(long, value_name = "N", default_value_t = BenchOptions::default().motion.search.max_iterations)]
    iterations: u32,
}

pub(crate) fn run(args: &Bench) -> Outcome {
    match &args.what {
        What::Bispace(args) => bench_tasks::bispace(args),
        What::Caging(args) => bench_tasks::caging(args),
        What::Grasps(args) => bench_tasks::grasps(args),
        What::Placement(args) => bench_tasks::placement(args),
        What::Weights(args) => bench_tasks::weights(args),
        What::Checks(args) => checks(args),
        What::Motion(args) => motion(args),
    }
}

fn checks(args: &Checks) -> Outcome {
    let set = problems(&args.input)?;
    let clock = Instant::now();
    let now = || clock.elapsed().as_secs_f64();
    let (robot, _) = robot(&args.input, &set, &now)?;
    let rates = bench::measure_checks(&robot, &set, &now);
    let rates = rates.map_err(|error| Failure::Input(error.to_string()))?;
    print(&format!("{}: configurations per second, thousands", set.robot));
    for rate in &rates {
        let list = |rates: &[(usize, f64)]| {
            let each = rates.iter().map(|(lanes, rate)| format!("{lanes} lanes {:6.0}", rate / 1e3));
            each.collect::<Vec<_>>().join(", ")
        };
        let best = rate.looks.iter().map(|(_, rate)| *rate).fold(0.0, f64::max);
        print(&format!(
            "{:16} {:2} obstacles: looks {}; proofs {}; one at a time {:5.1}: looks {:.0} times",
            rate.scene,
            rate.obstacles,
            list(&rate.looks),
            list(&rate.lanes),
            rate.scalar / 1e3,
            best / rate.scalar
        ));
    }
    write_report(&args.input, &rates)
}

fn write_report(input: &Input, report: &impl serde::Serialize) -> Outcome {
    if let Some(path) = &input.report {
        let text = serde_json::to_string_pretty(report).expect("plain values always have a JSON form");
        write_whole(path, (text + "\n").as_bytes())?;
        say(&format!("wrote {}", path.display()));
    }
    Ok(())
}

fn motion(args: &Motion) -> Outcome {
    let set = problems(&args.input)?;
    let clock = Instant::now();
    let now = || clock.elapsed().as_secs_f64();
    let (robot, ready_s) = robot(&args.input, &set, &now)?;
    let mut options = BenchOptions { seeds: args.seeds, racers: args.race, ..BenchOptions::default() };
    options.motion.search.max_iterations = args.iterations;
    options.motion.search.sampling = Sampling::named(&args.sampling).unwrap_or_default();
    let mut progress = Progress::new();
    let (mut done, total) = (0, set.problems.len());
    let mut finished = |row: &bench::Row| {
        done += 1;
        progress.update(&row.scene, f64::from(done) / total.max(1) as f64);
    };
    let report = bench::run(&robot, &set, ready_s, &options, &now, &mut finished);
    let report = report.map_err(|error| Failure::Input(error.to_string()))?;
    drop(progress);
    show(&report);
    write_report(&args.input, &report)
}

/// The robot that problems are about, and the seconds from its files to ready.
fn robot(input: &Input, set: &ProblemSet, now: &dyn Fn() -> f64) -> Outcome<(BenchRobot, f64)> {
    let start = now();
    let mut sources = Sources::new();
    let (model, found) =
        urdf::load(&OsSystem, &mut sources, &input.urdf, &input.reading.options(MeshPolicy::default()));
    let model = Arc::new(crate::input::accept(model, &found, &sources)?);
    let (srdf, found) = srdf::load(&OsSystem, &mut sources, &input.srdf, None);
    let srdf = crate::input::accept(srdf, &found, &sources)?;
    let robot = BenchRobot::new(model, &srdf, &set.joints);
    Ok((robot.map_err(|error| Failure::Input(error.to_string()))?, now() - start))
}

fn spacing(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|x| (1e-4..=1.0).contains(x));
    value.ok_or_else(|| "it has to be between 0.0001 and 1".to_owned())
}

/// The problems that are asked for: as they are, or among points.
fn problems(input: &Input) -> Outcome<ProblemSet> {
    let set = read_problems(&input.problems)?;
    let Some(spacing) = input.cloud else { return Ok(set) };
    let set = set.as_clouds(spacing).map_err(|error| Failure::Input(error.to_string()))?;
    let mut points: Vec<usize> = clouds(&set).map(|cloud| cloud.points().len()).collect();
    points.sort_unstable();
    if let Some(cloud) = clouds(&set).find(|cloud| cloud.points().len() == points[points.len() / 2]) {
        let (again, radius) = (cloud.points().to_vec(), cloud.radius());
        let clock = Instant::now();
        let made = PointCloud::new(again, radius).is_ok();
        let milliseconds = clock.elapsed().as_secs_f64() * 1e3;
        debug_assert!(made);
        print(&format!(
            "clouds of {} to {} points, made in {milliseconds:.2} ms for {} of them",
            points[0],
            points[points.len() - 1],
            points[points.len() / 2],
        ));
    }
    Ok(set)
}

/// All clouds among the obstacles.
fn clouds(set: &ProblemSet) -> impl Iterator<Item = &PointCloud> {
    let obstacles = set.problems.iter().flat_map(|problem| &problem.obstacles);
    obstacles.flat_map(|obstacle| obstacle.geometry.iter()).filter_map(|element| match &element.shape {
        Shape::Cloud { cloud, .. } => Some(&**cloud),
        _ => None,
    })
}

/// Problems from a file, unpacked when its name ends in `.xz`.
fn read_problems(path: &Path) -> Outcome<ProblemSet> {
    let wrong = |message: String| Failure::Input(format!("{}: {message}", path.display()));
    let mut file = File::open(path).map_err(|error| wrong(error.to_string()))?;
    let mut text = String::new();
    let read = match path.extension().is_some_and(|extension| extension == "xz") {
        true => lzma_rust2::XzReader::new(file, true).read_to_string(&mut text),
        false => file.read_to_string(&mut text),
    };
    read.map_err(|error| wrong(error.to_string()))?;
    ProblemSet::parse(&text).map_err(|error| wrong(error.to_string()))
}

fn show(report: &Report) {
    print(&format!("{}: ready in {:.2} s, {} seeds", report.robot, report.ready_s, report.seeds));
    print(
        "scene             valid solved proven   plan us: median      p95      max  total: median      p95   cost simplified",
    );
    let row = |name: &str, s: &Summary| {
        print(&format!(
            "{name:16} {:3}/{:3} {:6} {:6} {:17.0} {:8.0} {:8.0} {:14.0} {:8.0} {:6.2} {:10.2}",
            s.valid,
            s.problems,
            s.solved,
            s.certified,
            s.plan_us_median,
            s.plan_us_p95,
            s.plan_us_max,
            s.total_us_median,
            s.total_us_p95,
            s.cost_mean,
            s.cost_simplified_mean
        ));
    };
    report.scenes.iter().for_each(|scene| row(&scene.scene, &scene.summary));
    row("all", &report.summary);
}
