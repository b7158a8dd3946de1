//! Development tasks: `cargo xtask NAME`. One file per task, one line each in [`TASKS`].

mod assets;
mod browser;
mod depots;
mod docs;
mod fuzz;
mod ik_bench;
mod ik_zoo;
mod kill;
mod other_target;
mod python;
mod seeds;
mod test;
mod tidy;
mod workspace;

use std::process::ExitCode;

/// A task: what it is called, what it does, and its code (arguments after the name are passed on).
type Task = (&'static str, &'static str, fn(&[String]) -> anyhow::Result<()>);

const TASKS: &[Task] = &[
    ("assets", "write the geometry in specs/, or --check it", assets::run),
    ("depots", "build through buckets and databases, workers being killed: [TRIALS]", depots::run),
    ("fuzz", "fuzz the readers: [TARGET...] [--seconds N]", fuzz::run),
    ("ik-bench", "time generated solvers beside published ones: [POSES]", ik_bench::run),
    ("ik-zoo", "inverse kinematics of every arm of a folder: [FOLDER] [POSES]", ik_zoo::run),
    ("kill", "kill compilations at random moments: [TRIALS] [PROGRAM]", kill::run),
    (
        "other-target",
        "compile on this machine and on 64-bit ARM, and compare: [NATIVE FOREIGN]",
        other_target::run,
    ),
    ("python", "build the Python wheel and run its tests, [ARGUMENTS OF PYTEST]", python::run),
    ("seeds", "planning times and successes over many seeds", seeds::run),
    ("test", "all tests: format, lints, Rust, Python", test::run),
    ("tidy", "architecture invariants that text can show", tidy::run),
];

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    match dispatch(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn dispatch(args: &[String]) -> anyhow::Result<()> {
    let name = args.first().map_or("", String::as_str);
    if let Some((_, _, task)) = TASKS.iter().find(|(task, _, _)| *task == name) {
        return task(&args[1..]);
    }
    let list: Vec<String> = TASKS.iter().map(|(name, what, _)| format!("  {name:12} {what}")).collect();
    anyhow::bail!("no task `{name}`; tasks are:\n{}", list.join("\n"))
}
