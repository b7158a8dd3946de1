//! The example with a knowledge base, and without one.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;

use robotc_core::{Sources, spec};
use robotc_kb::os::OsSystem;
use robotc_kb::{Graph, Project, Store};

fn task() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/tasks/block.task.toml")
}

fn embedded(store: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_robotc-embedded")).arg(task()).arg(store).output().expect("it starts")
}

/// What `robotc compile` does.
fn compile(store: &Path) {
    let mut sources = Sources::new();
    let parameters = robotc_kb::kinds::parameter_table();
    let (spec, found) = spec::load_task(&OsSystem, &mut sources, &task(), &parameters);
    let spec = spec.unwrap_or_else(|| panic!("{}", found.to_plain_text(&sources)));
    let graph = Graph::plan(&Project::of_task(&spec)).expect("the task can be planned");
    let store = Store::open(store).expect("the store opens");
    let report = robotc_kb::compile(&Arc::new(graph), &Arc::new(store), &()).expect("the store works");
    assert!(report.complete());
}

#[test]
fn plans_with_a_knowledge_base_and_names_what_it_lacks() {
    let store = tempfile::tempdir().expect("a folder");
    let without = embedded(store.path());
    let message = String::from_utf8_lossy(&without.stderr);
    assert!(!without.status.success());
    for part in ["lacks", "grasp_set", "ik_solver", "robotc compile"] {
        assert!(message.contains(part), "no `{part}` in: {message}");
    }

    compile(store.path());
    let with = embedded(store.path());
    assert!(with.status.success(), "{}", String::from_utf8_lossy(&with.stderr));
    let text = String::from_utf8_lossy(&with.stdout);
    let first_words: Vec<&str> = text.lines().filter_map(|line| line.split_whitespace().next()).collect();
    let kinds = ["reach", "approach", "grasp", "lift", "carry", "lower", "release", "retreat"];
    assert_eq!(first_words[..kinds.len()], kinds, "{text}");
    assert!(text.trim_end().ends_with("s of motion"), "{text}");
}
