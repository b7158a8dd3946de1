//! The lock file of the shipped tasks: what is in it is what compiling them gives.
//!
//! `BLESS=1 cargo test -p robotc --test lock` compiles all of them and writes it anew.

use std::path::{Path, PathBuf};
use std::process::Command;

use robotc_core::Sources;
use robotc_core::spec;
use robotc_kb::os::OsSystem;
use robotc_kb::{Graph, LockFile, Project};

/// Compiled in whole against the lock file: contents can be compared with no others in reasonable time.
const WHOLE: &str = "mug_to_shelf.task.toml";

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../specs/tasks")
}

/// The shipped tasks, in the order of their names.
fn tasks() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder()).expect("the shipped tasks");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|file| file.to_string_lossy().ends_with(".task.toml"));
    files.sort();
    files
}

/// Runs `robotc compile` with an empty knowledge base.
fn compile(arguments: &[&str], files: &[PathBuf]) {
    let store = tempfile::tempdir().expect("a folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_robotc"));
    command.env("ROBOTC_STORE", store.path()).arg("compile").args(arguments).args(files);
    let output = command.output().expect("robotc starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn the_lock_file_is_up_to_date() {
    if std::env::var_os("BLESS").is_some() {
        return compile(&[], &tasks());
    }
    let text = std::fs::read_to_string(folder().join("robotc.lock")).expect("a committed lock file");
    let lock = LockFile::parse(&text).expect("a lock file");
    let parameters = robotc_kb::kinds::parameter_table();
    for task in tasks() {
        let mut sources = Sources::new();
        let (spec, found) = spec::load_task(&OsSystem, &mut sources, &task, &parameters);
        let spec = spec.unwrap_or_else(|| panic!("{}", found.to_plain_text(&sources)));
        let graph = Graph::plan(&Project::of_task(&spec)).expect("artefacts of a checked task");
        let name = task.file_name().expect("a file").to_string_lossy();
        let section = lock.section(&name).unwrap_or_else(|| panic!("{name} is not locked"));
        let differences: Vec<String> = section.differences(&graph).iter().map(ToString::to_string).collect();
        assert!(differences.is_empty(), "{name}: {}; bless the lock file", differences.join("; "));
    }
    compile(&["--locked"], &[folder().join(WHOLE)]);
}
