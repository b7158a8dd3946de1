//! `robotc run`: from a task specification to a robot that has done it, in a kinematic simulation.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use robotc_core::Seed;
use robotc_kb::{Knowledge, Project};
use robotc_planning::manipulation::{Choice, ManipulationOptions, Plan};
use robotc_planning::{Budget, Interrupt};
use robotc_runtime::film::{TreeKeeper, film};
use robotc_runtime::record::Recording;
use robotc_runtime::{Execution, MotionTable, Session, execute, view};
use serde::Serialize;

use super::compile::write_whole;
use crate::knowledge::{self, StoreArgs};
use crate::output::{Failure, Outcome, count, print, say, warn_of_unknown_keys};
use crate::settings::Settings;

/// Compile what a task needs, plan it, and run it in a kinematic simulation
#[derive(Args)]
#[command(after_help = "Examples:\n  robotc run specs/tasks/mug_to_shelf.task.toml --view out.html\n  \
    robotc run pick.task.toml --seed 7 --trajectory motion.csv --report run.json\n\n\
    The page of --view opens offline in any browser; the file of --glb in any glTF viewer.")]
pub(crate) struct Run {
    /// A `*.task.toml` file
    task: PathBuf,
    /// Write a 3-D replay as one HTML file
    #[arg(long, value_name = "FILE.html")]
    view: Option<PathBuf>,
    /// Write the replay as binary glTF with its animation
    #[arg(long, value_name = "FILE.glb")]
    glb: Option<PathBuf>,
    /// Write the motion of all joints: names, times, positions, velocities, accelerations
    #[arg(long, value_name = "FILE.json|FILE.csv")]
    trajectory: Option<PathBuf>,
    /// Write times, lengths, seed, artefacts and outcome
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    /// Seed of the planner [default: that of the task]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Longest time to plan, seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0)]
    time_limit: f64,
    /// Change options of the planner: JSON with some of the keys that --write-options writes
    #[arg(long, value_name = "FILE.json")]
    options: Option<PathBuf>,
    /// Write all options of the planner
    #[arg(long, value_name = "FILE.json")]
    write_options: Option<PathBuf>,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    store: StoreArgs,
}

/// Ticks a second of the simulated controller.
const CONTROL_RATE: f64 = 250.0;

pub(crate) fn run(args: &Run) -> Outcome {
    check_outputs(args)?;
    let mut clock = Clock::default();
    let spec = clock.stage("check", || crate::input::task(&args.task, &args.settings))?;
    let project = Project::of_task(&spec);
    let store = args.store.open()?;
    let graph = knowledge::plan(&project)?;
    let compiled = clock.stage("compile", || knowledge::compile(&graph, &store))?;
    match compiled.built().count() {
        0 => say(&format!("knowledge base: {}, all up to date", count(graph.nodes().len(), "artefact"))),
        built => {
            say(&format!("knowledge base: {}, {built} computed", count(graph.nodes().len(), "artefact")))
        }
    }
    let session = clock.stage("load", || Session::open(&compiled.knowledge));
    let session = session.map_err(|error| Failure::Input(error.to_string()))?;
    let seed = args.seed.unwrap_or(session.task().seed);

    let options = options(args, &session)?;
    let mut trees = TreeKeeper::default();
    let planned = clock.stage("plan", || {
        let start = Instant::now();
        let interrupt = || {
            if knowledge::interrupted() {
                Some(Interrupt::Cancelled)
            } else {
                (start.elapsed().as_secs_f64() > args.time_limit).then_some(Interrupt::TimeUp)
            }
        };
        session.plan(&options, &Budget::new(&interrupt), Seed::new(seed), &mut trees)
    });
    let done = planned.map_err(|error| error.to_string()).and_then(|plan| {
        let execution =
            clock.stage("execute", || execute(session.world(), session.task(), &plan, CONTROL_RATE));
        Ok((execution.map_err(|error| error.to_string())?, plan))
    });
    let outcome = match &done {
        Err(reason) => reason.clone(),
        Ok((execution, plan)) => verdict(&session, execution, plan),
    };
    if let Ok((execution, plan)) = &done {
        write_results(args, &session, execution, plan, &trees, seed, &mut clock)?;
    }
    if let Some(path) = &args.report {
        let report = Report::new(&outcome, &clock, seed, &compiled.knowledge, &session, done.as_ref().ok());
        let text = serde_json::to_string_pretty(&report).expect("plain values always have a JSON form");
        write_whole(path, (text + "\n").as_bytes())?;
        say(&format!("wrote {}", path.display()));
    }
    clock.print();
    if knowledge::interrupted() && done.is_err() {
        return Err(Failure::Environment("interrupted".into()));
    }
    if outcome == SUCCESS {
        print(SUCCESS);
        Ok(())
    } else {
        Err(Failure::Input(outcome))
    }
}

/// The options of the robot with what the user changed.
fn options(args: &Run, session: &Session) -> Outcome<ManipulationOptions> {
    let mut options = session.options();
    if let Some(path) = &args.options {
        let wrong = |error: &dyn std::fmt::Display| Failure::Input(format!("{}: {error}", path.display()));
        let text = std::fs::read_to_string(path).map_err(|error| wrong(&error))?;
        options = options.with_document(&text).map_err(|error| wrong(&error))?;
        warn_of_unknown_keys(path, &text, &options);
    }
    if let Some(path) = &args.write_options {
        write_whole(path, (options.document() + "\n").as_bytes())?;
        say(&format!("wrote {}", path.display()));
    }
    Ok(options)
}

const SUCCESS: &str = "success";

/// `success`, or what is missing.
fn verdict(session: &Session, execution: &Execution, plan: &Plan) -> String {
    if !plan.skipped.is_empty() {
        let reasons: Vec<String> = plan.skipped.iter().map(|skipped| skipped.reason.to_string()).collect();
        return format!("{} not reached: {}", count(plan.skipped.len(), "goal"), reasons.join("; "));
    }
    match execution.missed_goals(session.task(), plan).first() {
        Some((goal, off)) => format!("goal {goal} missed by {off:.4} m"),
        None => SUCCESS.to_owned(),
    }
}

fn write_results(
    args: &Run,
    session: &Session,
    execution: &Execution,
    plan: &Plan,
    trees: &TreeKeeper,
    seed: u64,
    clock: &mut Clock,
) -> Outcome {
    for segment in &execution.segments {
        let [start, end] = segment.span;
        print(&format!("{start:7.2} s  {:8} {:5.2} s", segment.kind.to_string(), end - start));
    }
    for choice in &plan.choices {
        let taken = plan.name_of(session.task(), choice.goal());
        choice.passed_over().iter().for_each(|other| print(&format!("took {taken}, not {other}")));
    }
    print(&format!("{}, {:.2} s of motion", accomplished(plan), execution.duration()));
    if args.view.is_some() || args.glb.is_some() {
        let recording = clock.stage("film", || recording(session, execution, plan, trees, seed));
        if let Some(path) = &args.view {
            write_whole(path, view::html(&recording).as_bytes())?;
            say(&format!("wrote {}; open it in a browser", path.display()));
        }
        if let Some(path) = &args.glb {
            write_whole(path, &view::glb(&recording))?;
            say(&format!("wrote {}", path.display()));
        }
    }
    if let Some(path) = &args.trajectory {
        let table = MotionTable::of(&session.task().robot.model, &session.task().start, plan);
        let csv = path.extension().is_some_and(|extension| extension == "csv");
        write_whole(path, if csv { table.to_csv() } else { table.to_json() }.as_bytes())?;
        say(&format!("wrote {}", path.display()));
    }
    Ok(())
}

/// How many objects were put down, and articles moved.
fn accomplished(plan: &Plan) -> String {
    let placed = plan.choices.iter().filter(|choice| matches!(choice, Choice::Place(_))).count();
    let moved = plan.choices.len() - placed;
    let counts = [(placed, "object"), (moved, "article")].into_iter().filter(|(n, _)| *n > 0);
    counts.map(|(n, what)| count(n, what)).collect::<Vec<_>>().join(", ")
}

fn recording(
    session: &Session,
    execution: &Execution,
    plan: &Plan,
    trees: &TreeKeeper,
    seed: u64,
) -> Recording {
    let mut recording = film(session, execution, trees);
    recording
        .add_fact("robot", session.task().robot.model.name())
        .add_fact("done", accomplished(plan))
        .add_fact("motion", format!("{:.1} s", execution.duration()))
        .add_fact("seed", seed);
    recording
}

/// Seconds of each stage, in order.
#[derive(Default)]
struct Clock {
    stages: Vec<StageTime>,
}

#[derive(Serialize)]
struct StageTime {
    name: &'static str,
    seconds: f64,
}

impl Clock {
    fn stage<R>(&mut self, name: &'static str, work: impl FnOnce() -> R) -> R {
        let start = Instant::now();
        let result = work();
        self.stages.push(StageTime { name, seconds: start.elapsed().as_secs_f64() });
        result
    }

    fn seconds(&self, name: &str) -> f64 {
        self.stages.iter().filter(|s| s.name == name).map(|s| s.seconds).sum()
    }

    fn print(&self) {
        let all: Vec<String> = self.stages.iter().map(|s| format!("{} {:.3} s", s.name, s.seconds)).collect();
        say(&all.join(", "));
    }
}

/// The file of `--report`.
#[derive(Serialize)]
struct Report<'a> {
    outcome: &'a str,
    stages: &'a [StageTime],
    plan_seconds: f64,
    seed: u64,
    motion_seconds: f64,
    segments: Vec<SegmentReport>,
    choices: Vec<ChoiceReport>,
    artefacts: Vec<ArtefactReport>,
}

#[derive(Serialize)]
struct SegmentReport {
    kind: String,
    goal: usize,
    seconds: f64,
    /// Length of the path of the joints, radians and metres.
    joint_length: f64,
    /// Length of the path of the tool, metres; zero for motions of fingers or base alone.
    tool_length: f64,
}

/// What was taken for a goal, and of each other object that would have done what came of it.
#[derive(Serialize)]
struct ChoiceReport {
    goal: usize,
    object: String,
    passed_over: Vec<String>,
}

#[derive(Serialize)]
struct ArtefactReport {
    kind: &'static str,
    subject: String,
    key: String,
    content: String,
}

impl<'a> Report<'a> {
    fn new(
        outcome: &'a str,
        clock: &'a Clock,
        seed: u64,
        knowledge: &Knowledge,
        session: &Session,
        done: Option<&(Execution, Plan)>,
    ) -> Self {
        let graph = knowledge.graph();
        let mut artefacts = Vec::new();
        for index in graph.indices() {
            let (node, known) = (graph.node(index), knowledge.known(index));
            for subject in &node.subjects {
                artefacts.push(ArtefactReport {
                    kind: node.kind_name(),
                    subject: subject.clone(),
                    key: known.map_or_else(String::new, |k| k.key.to_string()),
                    content: known.map_or_else(String::new, |k| k.content.to_string()),
                });
            }
        }
        let segments = done.map_or_else(Vec::new, |(_, plan)| segments(session, plan));
        let choices = done.map_or_else(Vec::new, |(_, plan)| choices(session, plan));
        let motion_seconds = done.map_or(0.0, |(execution, _)| execution.duration());
        let plan_seconds = clock.seconds("plan");
        Self {
            outcome,
            stages: &clock.stages,
            plan_seconds,
            seed,
            motion_seconds,
            segments,
            choices,
            artefacts,
        }
    }
}

fn choices(session: &Session, plan: &Plan) -> Vec<ChoiceReport> {
    let report = |choice: &Choice| ChoiceReport {
        goal: choice.goal(),
        object: plan.name_of(session.task(), choice.goal()).to_owned(),
        passed_over: choice.passed_over().iter().map(ToString::to_string).collect(),
    };
    plan.choices.iter().map(report).collect()
}

fn segments(session: &Session, plan: &Plan) -> Vec<SegmentReport> {
    let arm = session.arm();
    let report = |segment: &robotc_planning::manipulation::Segment| {
        let knots = segment.trajectory.knots();
        let norm = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        let tool = |q: &[f64]| arm.world_from_tool(q).translation.vector;
        let without_arm = !segment.trajectory.dofs().starts_with(arm.dofs());
        let tool_length = |w: &[robotc_core::trajectory::TrajectoryPoint]| {
            if without_arm { 0.0 } else { (tool(&w[1].positions) - tool(&w[0].positions)).norm() }
        };
        SegmentReport {
            kind: segment.kind.to_string(),
            goal: segment.goal,
            seconds: segment.trajectory.duration(),
            joint_length: knots.windows(2).map(|w| norm(&w[0].positions, &w[1].positions)).sum(),
            tool_length: knots.windows(2).map(tool_length).sum(),
        }
    };
    plan.segments.iter().map(report).collect()
}

/// Refuses outputs that could not be written, before long work begins.
fn check_outputs(args: &Run) -> Outcome {
    for path in [&args.view, &args.glb, &args.trajectory, &args.report].into_iter().flatten() {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if !folder.is_dir() {
            return Err(Failure::Input(format!(
                "{}: there is no folder {}",
                path.display(),
                folder.display()
            )));
        }
    }
    Ok(())
}
