//! `robotc ik`: inverse kinematics of one chain, without any specification.

use std::path::{Path, PathBuf};
use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

use clap::{Args, ValueEnum};
use robotc_core::ik::{IkSolutions, InverseKinematics as _, Preferences};
use robotc_core::urdf::MeshPolicy;
use robotc_core::{Pose, Seed, SerialChain, diag};
use robotc_ikgen::backend::{COptions, RustOptions};
use robotc_ikgen::generate::natural;
use robotc_ikgen::report::{ProofOptions, Report, prove};
use robotc_ikgen::run::RedundancyOptions;
use robotc_ikgen::{Compiled, GoalType, Options, Refusal, compile_watched};
use robotc_runtime::picture::IkPicture;
use robotc_runtime::view;

use super::compile::write_whole;
use crate::chain::{self, Arm, Ends, unknown};
use crate::description::DescriptionArgs;
use crate::output::{Failure, Outcome, print, say};

/// Compile and prove the inverse kinematics of a chain of a URDF
#[derive(Args)]
#[command(
    after_help = "Examples:\n  robotc ik arm.urdf\n  robotc ik arm.urdf --base base_link --tip tool0\n  \
    robotc ik arm.urdf --base base_link --tip tool0 -o arm_ik.rs --report arm_ik.json\n  \
    robotc ik arm.urdf --base base_link --tip tool0 -o arm_ik.c\n  \
    robotc ik arm.urdf --base base_link --tip tool0 --view solutions.html\n  \
    robotc ik welder.urdf --base base_link --tip torch --type translationdirection5d\n\n\
    The source is one Rust file without dependencies that needs neither std nor memory allocation, or a C99 source with its \
    header. It is written only when the solver passed its proof."
)]
pub(crate) struct Ik {
    /// URDF or xacro file; its meshes are not needed
    urdf: PathBuf,
    /// Link where the chain starts [default: that of the arm with most joints]
    #[arg(long, value_name = "LINK")]
    base: Option<String>,
    /// Link where it ends [default: that of the arm with most joints, before its gripper]
    #[arg(long, value_name = "LINK")]
    tip: Option<String>,
    /// What the solver is asked for: transform6d, rotation3d, translation3d, direction3d, ray4d, lookat3d, translationdirection5d,
    /// translationxy2d, translationxyorientation3d, translationlocalglobal6d, translation{x,y,z}axisangle4d,
    /// translation{xaxisangleznorm,yaxisanglexnorm,zaxisangleynorm}4d, or auto: what the joints suggest
    #[arg(long = "type", value_name = "NAME", default_value = "transform6d", hide_default_value = true, value_parser = goal_type)]
    goal: Goal,
    #[command(flatten)]
    reading: DescriptionArgs,
    /// Joints whose values the caller gives, separated by commas [default: chosen when there are seven joints]
    #[arg(long, value_name = "JOINT", value_delimiter = ',')]
    free: Option<Vec<String>>,
    /// File for the generated source; of C the header is written beside it
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Language of the source [default: by the ending of the file: .rs, .c or .ik]
    #[arg(long, value_enum, requires = "output")]
    language: Option<Language>,
    /// Let Rust use the square root of std: faster
    #[arg(long)]
    std: bool,
    /// Let the source find every branch of a calibrated arm too, whose constants it is given at run time: some 50 KB more
    #[arg(long, requires = "output")]
    calibrated: bool,
    /// File for the proof
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    /// Poses of each set of the proof
    #[arg(long, value_name = "N", default_value_t = 1000)]
    poses: usize,
    /// Seed of the poses
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Largest difference between the described chain and an ideal one that may be solved in its place, metres and
    /// radians; answers are always exact for the described chain
    #[arg(long, value_name = "X", default_value_t = Options::default().tolerance)]
    tolerance: f64,
    /// Solve the chain exactly as described: the same as --tolerance 0
    #[arg(long, conflicts_with = "tolerance")]
    no_snap: bool,
    /// Seconds that the search for a solver may take
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    budget: f64,
    /// Show what was tried
    #[arg(long)]
    explain: bool,
    /// File for a 3-D page with all solutions of a pose side by side
    #[arg(long, value_name = "FILE.html")]
    view: Option<PathBuf>,
    /// Joint values of that pose, separated by commas, radians and metres [default: a drawn pose with many solutions]; of a chain with a
    /// free joint the values are told that this may have there
    #[arg(long, value_name = "Q", value_delimiter = ',', allow_hyphen_values = true)]
    at: Option<Vec<f64>>,
}

/// The argument `--type`.
#[derive(Debug, Clone, Copy)]
enum Goal {
    Auto,
    Type(GoalType),
}

fn goal_type(name: &str) -> Result<Goal, String> {
    if name == "auto" {
        return Ok(Goal::Auto);
    }
    let known = GoalType::ALL.map(GoalType::name);
    GoalType::from_name(name).map(Goal::Type).ok_or_else(|| match diag::nearest(name, known) {
        Some(near) => format!("did you mean {near}?"),
        None => format!("there are auto, {}", known.join(", ")),
    })
}

/// What a solver is written in: one Rust file, C99 source and header, or the solution program that the run-time library loads.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Language {
    Rust,
    C,
    Program,
}

pub(crate) fn run(args: &Ik) -> Outcome {
    // Meshes are for looking at alone.
    let meshes = if args.view.is_some() { MeshPolicy::SkipMissing } else { MeshPolicy::Ignore };
    let ends = Ends { base: args.base.as_deref(), tip: args.tip.as_deref() };
    let Arm { kinematics, base, chain } = chain::load(&args.urdf, &args.reading.options(meshes), ends)?;
    if !args.tolerance.is_finite() || args.tolerance < 0.0 {
        return Err(Failure::Input("--tolerance cannot be negative".into()));
    }
    if args.budget.is_nan() || args.budget <= 0.0 {
        return Err(Failure::Input("--budget must be more than 0".into()));
    }
    let goal = match args.goal {
        Goal::Auto => natural(&chain),
        Goal::Type(goal) => goal,
    };
    let options = Options {
        goal,
        tolerance: if args.no_snap { 0.0 } else { args.tolerance },
        free: args.free.as_ref().map(|names| free_variables(&chain, names)).transpose()?,
        ..Options::default()
    };
    let clock = Instant::now();
    let result = compile_within(&chain, &options, args.budget);
    let generation_s = clock.elapsed().as_secs_f64();
    let (report, trace, compiled) = match &result {
        Ok(compiled) => {
            let proof = ProofOptions { poses: args.poses.max(1), seed: args.seed };
            let now = || clock.elapsed().as_secs_f64();
            (prove(compiled, generation_s, &proof, &now), &compiled.trace, Some(compiled))
        }
        Err(refusal) => (Report::refused(refusal, goal, generation_s), &refusal.trace, None),
    };
    if args.explain {
        trace.iter().for_each(|line| print(line));
    }
    if let Some(path) = &args.report {
        let text = serde_json::to_string_pretty(&report).expect("plain values always have a JSON form");
        write_whole(path, (text + "\n").as_bytes())?;
    }
    let Some(compiled) = compiled.filter(|_| report.emitted) else {
        return Err(Failure::Input(format!("{}: {}", chain.name, report.reason)));
    };
    show(&chain, &report);
    if let Some(path) = &args.output {
        write_source(path, compiled, args)?;
    }
    if args.view.is_none() && args.at.is_none() {
        return Ok(());
    }
    let values = shown_values(compiled, args)?;
    let base_from_tip = compiled.longer_chain().forward(&values);
    let free: Vec<f64> = compiled.free.iter().map(|v| values[*v]).collect();
    if let [own] = compiled.free[..]
        && let Some(joint) = chain.variables.get(own)
    {
        show_intervals(compiled, &base_from_tip, &free, &joint.name);
    }
    if let Some(path) = &args.view {
        let mut found = IkSolutions::new();
        compiled.solver().solve(&base_from_tip, &free, &mut found);
        let solutions: Vec<Vec<f64>> = found.iter().map(<[f64]>::to_vec).collect();
        let picture =
            IkPicture { kinematics: &kinematics, chain: &chain, base, base_from_tip, solutions: &solutions };
        write_whole(path, view::html(&picture.draw()).as_bytes())?;
        say(&format!("wrote {}; open it in a browser", path.display()));
    }
    Ok(())
}

/// Says which values the free joint may have at a pose.
fn show_intervals(compiled: &Compiled, base_from_tip: &Pose, free: &[f64], joint: &str) {
    let options = RedundancyOptions::default();
    let found = compiled.solver().free_intervals(base_from_tip, free, 0, &Preferences::default(), &options);
    let Ok(found) = found else { return };
    let intervals: Vec<String> =
        found.intervals.iter().map(|[low, high]| format!("[{low:.4}, {high:.4}]")).collect();
    let values = if intervals.is_empty() { "no value".into() } else { intervals.join(" ") };
    print(&format!("{joint} there, within limits: {values}, {}", found.completeness));
}

/// Compiles on another thread, which is left behind when the seconds are over.
fn compile_within(chain: &SerialChain, options: &Options, seconds: f64) -> Result<Compiled, Refusal> {
    enum News {
        Tried(String),
        Done(Box<Result<Compiled, Refusal>>),
    }
    let (send, receive) = std::sync::mpsc::channel();
    let work = (chain.clone(), options.clone());
    let worker = std::thread::spawn(move || {
        // Whoever asked may not wait any more.
        let watch = |line: &str| drop(send.send(News::Tried(line.into())));
        let result = compile_watched(&work.0, &work.1, &watch);
        drop(send.send(News::Done(Box::new(result))));
    });
    let start = Instant::now();
    let budget = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
    let mut trace: Vec<String> = Vec::new();
    loop {
        match receive.recv_timeout(budget.saturating_sub(start.elapsed())) {
            Ok(News::Tried(line)) => trace.push(line),
            Ok(News::Done(result)) => return *result,
            Err(RecvTimeoutError::Timeout) => break,
            // It ended without an answer: it broke, and so does this one.
            Err(RecvTimeoutError::Disconnected) => {
                if let Err(panic) = worker.join() {
                    std::panic::resume_unwind(panic);
                }
                break;
            }
        }
    }
    // Where unknowns are found one by one, what could not be is known.
    let left = trace.iter().rev().find(|line| line.contains("no equation holds only one"));
    let told = left.or(trace.last()).map_or("nothing was tried yet".into(), |line| {
        format!("of {} attempts the last that tells: {line}", trace.len())
    });
    let reason = format!(
        "no solver was found within {seconds} s; {told}; --budget allows more, --free or --type may ask for less"
    );
    Err(Refusal { reason, trace })
}

/// Values whose pose is shown: those that were given, or of some drawn within limits those whose pose has most solutions.
fn shown_values(compiled: &Compiled, args: &Ik) -> Outcome<Vec<f64>> {
    let longer = compiled.longer_chain();
    let own = compiled.chain().variables.len();
    // Joints that the goal adds turn nothing.
    let rest = compiled.program.goal.at_rest();
    if let Some(values) = &args.at {
        if values.len() != own || values.iter().any(|x| !x.is_finite()) {
            return Err(Failure::Input(format!("--at takes {own} numbers, one for each joint")));
        }
        return Ok(values.iter().copied().chain(rest).collect());
    }
    let solver = compiled.solver();
    let mut rng = Seed::new(args.seed).split("shown pose").rng();
    let mut found = IkSolutions::new();
    let mut most = (0, Vec::new());
    for _ in 0..50 {
        let range = |x: f64| if x.is_finite() { x.clamp(-3.1, 3.1) } else { 3.1_f64.copysign(x) };
        let limits = longer.variables[..own].iter().map(|v| (range(v.lower), range(v.upper)));
        let drawn: Vec<f64> = limits.map(|(low, high)| rng.range(low, high)).chain(rest.clone()).collect();
        let free: Vec<f64> = compiled.free.iter().map(|v| drawn[*v]).collect();
        solver.solve(&longer.forward(&drawn), &free, &mut found);
        if most.1.is_empty() || found.len() > most.0 {
            most = (found.len(), drawn);
        }
    }
    Ok(most.1)
}

fn free_variables(chain: &SerialChain, names: &[String]) -> Outcome<Vec<usize>> {
    let mut free = Vec::new();
    for name in names {
        let known = chain.variables.iter().map(|v| v.name.as_str());
        let position = chain.variables.iter().position(|v| v.name == *name);
        free.push(position.ok_or_else(|| unknown("joint of the chain", name, known))?);
    }
    free.sort_unstable();
    free.dedup();
    Ok(free)
}

fn show(chain: &SerialChain, report: &Report) {
    print(&format!("{}: {}", chain.name, report.class));
    if let Some(goal) = GoalType::from_name(&report.kind).filter(|goal| *goal != GoalType::default()) {
        print(&format!("{}: {}", goal.name(), goal.meaning()));
    }
    if !report.free_joints.is_empty() {
        print(&format!("free joints: {}", report.free_joints.join(", ")));
    }
    if report.snap_max > 0.0 {
        print(&format!("snapped by {:.2e} to the ideal chain; answers are polished", report.snap_max));
    }
    print(&format!("generated in {:.2} s, {} bytes of Rust", report.generation_s, report.source_bytes));
    print("set        poses  solved  recovered  wrong  max error  solutions  median");
    for set in &report.sets {
        // Elsewhere the joint vector may be one of infinitely many.
        let recovered = if set.name == "random" { set.recovered.to_string() } else { "-".into() };
        print(&format!(
            "{:9} {:6}  {:6}  {recovered:>9}  {:5}  {:9.1e}  {:9.2}  {:4.1} us",
            set.name,
            set.poses,
            set.solved,
            set.wrong,
            set.max_error,
            set.mean_solutions,
            set.median_ns / 1e3
        ));
    }
}

fn write_source(path: &Path, compiled: &Compiled, args: &Ik) -> Outcome {
    let ending = path.extension().and_then(|extension| extension.to_str());
    let language = match (args.language, ending) {
        (Some(language), _) => language,
        (None, Some("rs")) => Language::Rust,
        (None, Some("c")) => Language::C,
        (None, Some("ik")) => Language::Program,
        _ => {
            let path = path.display();
            return Err(Failure::Input(format!(
                "{path}: the name must end in .rs, .c or .ik, or --language be given"
            )));
        }
    };
    let write = |path: &Path, text: &str| {
        write_whole(path, text.as_bytes())?;
        say(&format!("wrote {}", path.display()));
        Ok(())
    };
    match language {
        Language::Rust => {
            write(path, &compiled.rust_source(&RustOptions { std: args.std, calibrated: args.calibrated }))
        }
        Language::Program => write(path, &compiled.text()),
        Language::C => {
            let stem = path.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
            let source = compiled
                .c_source(&stem, &COptions { calibrated: args.calibrated })
                .map_err(|error| Failure::Input(error.to_string()))?;
            write(&path.with_extension("h"), &source.header)?;
            write(path, &source.source)
        }
    }
}
