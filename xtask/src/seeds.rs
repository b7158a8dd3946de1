//! `cargo xtask seeds PROGRAM COUNT TASK...`: plans each task with many seeds and prints a table of times and successes.
//!
//! PROGRAM is a release build of `robotc`. What the tasks need is compiled first and is not part of the times. Where the
//! system tells, the processor time of the whole program is a column as well: it says more than the clock on a machine
//! that others use too.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, bail};

/// Runs the campaign; the table is Markdown.
pub(crate) fn run(args: &[String]) -> anyhow::Result<()> {
    let [program, count, tasks @ ..] = args else {
        bail!("usage: cargo xtask seeds PROGRAM COUNT TASK...");
    };
    let count: u64 = count.parse().context("COUNT is a number")?;
    let folder = std::env::temp_dir().join(format!("robotc-seeds-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    println!(
        "| task | seeds | planned, certified, executed | median | 90 % | worst | processor, median | worst |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for task in tasks {
        let mut times = Vec::new();
        let mut processor = Vec::new();
        let mut failures = Vec::new();
        let report = folder.join("report.json");
        plan(program, task, 1, &report)?;
        for seed in 1..=count {
            let before = children_seconds();
            let outcome = plan(program, task, seed, &report)?;
            processor.extend(children_seconds().zip(before).map(|(after, before)| after - before));
            match outcome {
                (None, seconds) => times.push(seconds),
                (Some(reason), _) => failures.push(format!("seed {seed}: {reason}")),
            }
        }
        times.sort_by(f64::total_cmp);
        processor.sort_by(f64::total_cmp);
        let of = |times: &[f64], share: f64| match times.len() {
            0 => "-".to_owned(),
            n => format!("{:.0} ms", times[((n - 1) as f64 * share).round() as usize] * 1e3),
        };
        let at = |share| of(&times, share);
        let (usual, most_work) = (of(&processor, 0.5), of(&processor, 1.0));
        let name = Path::new(task).file_name().map_or(task.clone(), |n| n.to_string_lossy().into_owned());
        let (median, most, worst) = (at(0.5), at(0.9), at(1.0));
        let planned = times.len();
        println!("| {name} | {count} | {planned} | {median} | {most} | {worst} | {usual} | {most_work} |");
        failures.iter().for_each(|failure| eprintln!("{name}: {failure}"));
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}

/// Seconds that finished children of this process have spent in user code, in steps of 10 ms; `None` where the system
/// has no `/proc`.
fn children_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The second field is the name in brackets, which may contain spaces; this is the 16th.
    let ticks: f64 = stat.rsplit_once(')')?.1.split_whitespace().nth(13)?.parse().ok()?;
    Some(ticks / 100.0)
}

/// Plans once: the reason of a failure, and the seconds that planning took.
fn plan(program: &str, task: &str, seed: u64, report: &Path) -> anyhow::Result<(Option<String>, f64)> {
    let run = Command::new(program)
        .args(["run", task, "--seed", &seed.to_string(), "--report"])
        .arg(report)
        .output()
        .with_context(|| format!("could not start {program}"))?;
    let text = std::fs::read_to_string(report)
        .with_context(|| format!("no report: {}", String::from_utf8_lossy(&run.stderr)))?;
    let field = |key: &str| {
        let start = text.find(&format!("\"{key}\": "))? + key.len() + 4;
        let line = text[start..].lines().next()?;
        Some(line.trim_end_matches(',').trim_matches('"').to_owned())
    };
    let seconds = field("plan_seconds").and_then(|s| s.parse().ok()).context("a report has plan_seconds")?;
    let outcome = field("outcome").context("a report has an outcome")?;
    Ok(((outcome != "success").then_some(outcome), seconds))
}
