//! An application with a planner inside: it opens a knowledge base that `robotc compile` made, plans, and prints the
//! motion. It can compile nothing: no generator is linked.

use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;

use robotc_core::{Seed, Sources, spec};
use robotc_kb::os::OsSystem;
use robotc_kb::{Graph, Knowledge, Project, Store};
use robotc_planning::Budget;
use robotc_runtime::Session;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [task, store] = arguments.as_slice() else {
        eprintln!("usage: robotc-embedded TASK.task.toml STORE");
        return ExitCode::FAILURE;
    };
    match plan(Path::new(task), Path::new(store)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn plan(task: &Path, store: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let knowledge = open(task, store)?;
    let session = Session::open(&knowledge)?;
    let seed = Seed::new(session.task().seed);
    let options = session.options();
    let plan = session.plan(&options, &Budget::unlimited(), seed, &mut ())?;

    // What the controller of a robot would be given: joint values over time, a segment at a time.
    for segment in &plan.segments {
        let knots = segment.trajectory.knots();
        println!("{:8} {:6.2} s  {:4} knots", segment.kind, segment.trajectory.duration(), knots.len());
    }
    for skipped in &plan.skipped {
        println!("left out: {}", skipped.reason);
    }
    println!("{:.2} s of motion", plan.duration());
    Ok(())
}

/// All artefacts of the task, from the knowledge base; an error that names those that are missing.
fn open(task: &Path, store: &Path) -> Result<Knowledge, Box<dyn std::error::Error>> {
    let mut sources = Sources::new();
    let parameters = robotc_kb::kinds::parameter_table();
    let (spec, found) = spec::load_task(&OsSystem, &mut sources, task, &parameters);
    let spec = spec.ok_or_else(|| found.to_plain_text(&sources))?;
    let graph = Arc::new(Graph::plan(&Project::of_task(&spec))?);
    let knowledge = Knowledge::resolve(&graph, &Arc::new(Store::open(store)?))?;

    let missing: Vec<String> =
        knowledge.missing().iter().map(|&i| format!("  {}", graph.node(i).title())).collect();
    if !missing.is_empty() {
        let (task, store) = (task.display(), store.display());
        let command = format!("robotc compile {task} --store {store}");
        let list = missing.join("\n");
        return Err(
            format!("the knowledge base {store} lacks\n{list}\nmake it complete with `{command}`").into()
        );
    }
    Ok(knowledge)
}
