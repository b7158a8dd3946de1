//! The tasks of `tests/vendor` from their files to the finished motion: every object of every task is grasped, carried
//! and put where it should be.
#![allow(clippy::print_stderr, reason = "a skipped test says so")]

use std::path::Path;
use std::sync::Arc;

use robotc_core::spec::{self, ParameterValue, TaskSpec};
use robotc_core::{Seed, Sources};
use robotc_kb::os::OsSystem;
use robotc_kb::{Event, Graph, Observer, Project, Store};
use robotc_planning::Budget;
use robotc_runtime::{Session, execute};

/// Approaches tried for a gripper that has to fit an object exactly; few of them close on it.
const TWO_FINGERS: i64 = 8000;
/// The same for a hand that closes on most things from most sides.
const THREE_FINGERS: i64 = 1500;

struct Silent;

impl Observer for Silent {
    fn event(&self, _: Event<'_>) {}
}

/// The task with a map that is coarser than usual and this many approaches tried for grasps, for the time they take.
fn coarse(task: &Path, approaches: i64) -> TaskSpec {
    let mut sources = Sources::new();
    let table = robotc_kb::kinds::parameter_table();
    let (spec, found) = spec::load_task(&OsSystem, &mut sources, task, &table);
    let mut spec = spec.unwrap_or_else(|| panic!("{}", found.to_plain_text(&sources)));
    let mut set = |kind: &str, name: &str, value| {
        spec.parameters.kinds.entry(kind.into()).or_default().insert(name.into(), value);
    };
    set("grasp_set", "approaches", ParameterValue::Integer(approaches));
    set("reachability", "step", ParameterValue::Number(0.2));
    spec
}

fn runs_to_the_end(task: &str, approaches: i64) {
    // The specifications name the shared folder by a path relative to themselves.
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    if !repository.join("../shared/data").is_dir() {
        eprintln!("skipped: shared data not present");
        return;
    }
    let spec = coarse(&repository.join("tests/vendor").join(task), approaches);
    let graph = Arc::new(Graph::plan(&Project::of_task(&spec)).expect("artefacts of a checked task"));
    let folder = tempfile::tempdir().expect("a folder");
    let store = Arc::new(Store::open(folder.path()).expect("an empty knowledge base"));
    let compiled = robotc_kb::compile(&graph, &store, &Silent).expect("a store that can be written");
    assert!(
        compiled.complete(),
        "{:?}",
        compiled.failed().map(|(_, error)| error.to_string()).collect::<Vec<_>>()
    );

    let session = Session::open(&compiled.knowledge).expect("a complete knowledge base");
    let options = session.options();
    for seed in 1..=3 {
        let plan = session
            .plan(&options, &Budget::unlimited(), Seed::new(seed), &mut ())
            .unwrap_or_else(|error| panic!("{task}, seed {seed}: {error}"));
        let skipped: Vec<String> = plan.skipped.iter().map(|s| s.reason.to_string()).collect();
        assert!(plan.is_complete(), "{task}, seed {seed}: {}", skipped.join("; "));
        let execution = execute(session.world(), session.task(), &plan, 250.0).expect("a plan that joins");
        assert_eq!(execution.missed_goals(session.task(), &plan), [], "{task}, seed {seed}");
        // What is held is touched by a finger on either side of it.
        let attached = plan.segments.iter().filter_map(|segment| match &segment.event {
            Some(robotc_planning::manipulation::Event::Attach(held)) => Some(&held.touching),
            _ => None,
        });
        assert!(attached.clone().all(|links| links.len() >= 2), "{task}, seed {seed}");
        assert_eq!(attached.count(), session.task().goals.len());
    }
}

#[test]
fn a_panda_puts_a_mug_on_a_shelf() {
    runs_to_the_end("mug_to_shelf_panda.task.toml", TWO_FINGERS);
}

#[test]
fn a_wam_puts_a_mug_on_a_shelf() {
    runs_to_the_end("mug_to_shelf_wam.task.toml", THREE_FINGERS);
}

#[test]
fn a_panda_clears_five_parts() {
    runs_to_the_end("parts_to_bin_panda.task.toml", TWO_FINGERS);
}

#[test]
fn a_wam_clears_five_things() {
    runs_to_the_end("parts_to_bin_wam.task.toml", THREE_FINGERS);
}
