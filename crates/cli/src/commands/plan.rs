//! `robotc plan`: solves a problem of free motion that is written down as a document.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use robotc_kb::Project;
use robotc_planning::problem::MOST_RACERS;
use robotc_planning::{PlanningProblem, Registry};
use robotc_runtime::motion::interrupted;
use robotc_runtime::{Motion, Session};
use serde::Serialize;

use super::compile::write_whole;
use crate::knowledge::{self, StoreArgs};
use crate::output::{Failure, Outcome, print, say, warn_of_unknown_keys};
use crate::settings::Settings;

/// Plan a free motion of a task's arm from a problem document
#[derive(Args)]
#[command(after_help = "Examples:\n  robotc plan pick.task.toml --template problem.json\n  \
    robotc plan pick.task.toml problem.json --output motion.json\n  \
    robotc plan pick.task.toml problem.json --validate motion.json\n\n\
    A problem is JSON: goals (joint values, or poses of the tool), constraint, what is held, where things are, margin, seed, \
    limits and post-processing. See docs/guides/planners.md.")]
pub(crate) struct Plan {
    /// A `*.task.toml` file: the robot and what stands around it
    task: PathBuf,
    /// The problem
    #[arg(required_unless_present = "template")]
    problem: Option<PathBuf>,
    /// Write the path, and the timed motion along it
    #[arg(long, value_name = "FILE.json")]
    output: Option<PathBuf>,
    /// Searches that race, each with a stream of its own, on as many threads as there are; instead of the problem's `race`
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MOST_RACERS)))]
    race: Option<u32>,
    /// Do not plan: tell where a path (the key `path` of a file) first meets something
    #[arg(long, value_name = "FILE.json", conflicts_with = "output")]
    validate: Option<PathBuf>,
    /// Write a problem with all defaults and no goal
    #[arg(long, value_name = "FILE.json", conflicts_with_all = ["problem", "output", "validate"])]
    template: Option<PathBuf>,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    store: StoreArgs,
}

pub(crate) fn run(args: &Plan) -> Outcome {
    let spec = crate::input::task(&args.task, &args.settings)?;
    let graph = knowledge::plan(&Project::of_task(&spec))?;
    let compiled = knowledge::compile(&graph, &args.store.open()?)?;
    let session = Session::open(&compiled.knowledge).map_err(|error| Failure::Input(error.to_string()))?;
    if let Some(path) = &args.template {
        write_whole(path, (session.motion_problem().write() + "\n").as_bytes())?;
        say(&format!("wrote {}", path.display()));
        return Ok(());
    }
    let file = args.problem.as_deref().unwrap_or(Path::new(""));
    let wrong = |error: &dyn std::fmt::Display| Failure::Input(format!("{}: {error}", file.display()));
    let text = read(file)?;
    let mut problem = session.read_problem(&text).map_err(|error| wrong(&error))?;
    warn_of_unknown_keys(file, &text, &problem);
    problem.race = args.race.unwrap_or(problem.race);
    match &args.validate {
        Some(path) => validate(&session, &problem, path),
        None => plan(&session, &problem, args.output.as_deref()),
    }
}

fn read(path: &Path) -> Outcome<String> {
    std::fs::read_to_string(path).map_err(|error| Failure::Input(format!("{}: {error}", path.display())))
}

fn plan(session: &Session, problem: &PlanningProblem, output: Option<&Path>) -> Outcome {
    let start = Instant::now();
    let interrupt = || interrupted(problem, start.elapsed().as_secs_f64(), knowledge::interrupted());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let motion = session.solve_motion(problem, &Registry::standard(), threads, &interrupt);
    let motion = motion.map_err(|error| Failure::Input(error.to_string()))?;
    let seconds = start.elapsed().as_secs_f64();
    let Motion { solved, trajectory } = &motion;
    print(&format!(
        "goal {}: {} states, length {:.3} found, {:.3} smoothed, {:.2} s of motion",
        solved.goal,
        solved.path.len(),
        solved.length_found,
        solved.length,
        trajectory.duration()
    ));
    say(&format!("planned in {seconds:.3} s"));
    if let Some(path) = output {
        let text =
            serde_json::to_string(&Output::of(&motion)).expect("plain numbers always have a JSON form");
        write_whole(path, (text + "\n").as_bytes())?;
        say(&format!("wrote {}", path.display()));
    }
    Ok(())
}

fn validate(session: &Session, problem: &PlanningProblem, file: &Path) -> Outcome {
    #[derive(serde::Deserialize)]
    struct Given {
        path: Vec<Vec<f64>>,
    }
    let wrong = |error: &dyn std::fmt::Display| Failure::Input(format!("{}: {error}", file.display()));
    let given: Given = serde_json::from_str(&read(file)?).map_err(|error| wrong(&error))?;
    match session.validate_path(problem, &given.path).map_err(|error| wrong(&error))? {
        None => {
            print("free");
            Ok(())
        }
        Some(contact) => Err(Failure::Input(format!(
            "motion {} of the path, {:.1} % along: {}, {:.1} mm deep",
            contact.edge,
            100.0 * contact.fraction,
            contact.message,
            1000.0 * contact.depth
        ))),
    }
}

/// The file of `--output`.
#[derive(Serialize)]
struct Output<'a> {
    /// Joints, in the order of all values.
    names: &'a [String],
    goal: usize,
    /// States from start to goal, straight in between.
    path: &'a [Vec<f64>],
    /// Knots of the timed motion, seconds.
    times: &'a [f64],
    positions: Vec<&'a [f64]>,
    velocities: Vec<&'a [f64]>,
}

impl<'a> Output<'a> {
    fn of(motion: &'a Motion) -> Self {
        let Motion { solved, trajectory } = motion;
        Self {
            names: trajectory.names(),
            goal: solved.goal,
            path: &solved.path,
            times: trajectory.times(),
            positions: trajectory.knots().iter().map(|k| k.positions.as_slice()).collect(),
            velocities: trajectory.knots().iter().map(|k| k.velocities.as_slice()).collect(),
        }
    }
}
