//! Many processes build one specification together, and the result is what one process makes alone.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

const TASK: &str = "tidy.task.toml";

/// The `robotc` under test, in a folder, with a knowledge base in it.
fn robotc(folder: &Path, store: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_robotc"));
    command.current_dir(folder).env("ROBOTC_STORE", folder.join(store)).args(["--threads", "1"]);
    command.args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn succeeds(command: &mut Command) -> String {
    let Output { status, stdout, stderr } = command.output().expect("robotc starts");
    assert!(status.success(), "{}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).expect("robotc prints text")
}

fn workshop() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    for entry in std::fs::read_dir(fixtures).expect("the fixtures") {
        let path: PathBuf = entry.expect("an entry").path();
        std::fs::copy(&path, folder.path().join(path.file_name().expect("a file"))).expect("a copy");
    }
    folder
}

/// Steps in the order of the plan: recipe and number of shards.
fn steps(folder: &Path) -> Vec<(String, usize)> {
    let text = succeeds(&mut robotc(folder, "store", &["plan-build", TASK, "--json"]));
    let plan: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let step = |step: &serde_json::Value| {
        (
            step["recipe"].as_str().expect("a recipe").to_owned(),
            step["shards"].as_u64().expect("a number") as usize,
        )
    };
    plan["steps"].as_array().expect("steps").iter().map(step).collect()
}

/// Kind, subject, key and content of every artefact, once all are computed.
fn artefacts(folder: &Path, store: &str) -> String {
    let lock = format!("{store}.lock");
    let compiled = succeeds(&mut robotc(folder, store, &["compile", TASK, "--lock", &lock]));
    assert!(compiled.contains("all up to date") || store == "alone", "{compiled}");
    std::fs::read_to_string(folder.join(lock)).expect("the lock")
}

fn spawn(folder: &Path, worker: usize, recipe: &str, shard: &str) -> Child {
    let arguments = ["build", TASK, "--node", recipe, "--shard", shard, "--depot", "depot"];
    robotc(folder, &format!("worker{worker}"), &arguments).spawn().expect("robotc starts")
}

#[test]
fn shards_give_what_one_process_gives_even_when_workers_die() {
    let alone = workshop();
    let expected = artefacts(alone.path(), "alone");
    for (shards, deadly) in [(1, false), (3, false), (7, true)] {
        let shared = workshop();
        let folder = shared.path();
        for (recipe, most) in steps(folder) {
            let shards = most.min(shards);
            // Every worker has a store of its own, as if on a machine of its own: they meet in the depot only.
            let mut workers: BTreeMap<usize, Child> =
                (0..shards).map(|i| (i, spawn(folder, i, &recipe, &format!("{i}/{shards}")))).collect();
            if deadly && shards > 1 {
                let victim = workers.get_mut(&2).expect("seven workers");
                victim.kill().expect("it can be killed");
                victim.wait().expect("it ends");
                workers.insert(2, spawn(folder, 2, &recipe, &format!("2/{shards}")));
            }
            for (_, worker) in workers {
                let output = worker.wait_with_output().expect("it ends");
                assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            }
        }
        // A newcomer needs nothing but the depot.
        for (recipe, _) in steps(folder) {
            succeeds(&mut robotc(
                folder,
                "newcomer",
                &["build", TASK, "--node", &recipe, "--depot", "depot"],
            ));
        }
        assert_eq!(artefacts(folder, "newcomer"), expected, "{shards} shards");
        assert!(succeeds(&mut robotc(folder, "newcomer", &["kb", "verify"])).starts_with("whole"));
    }
}

#[cfg(unix)]
#[test]
fn the_slurm_script_builds_everything() {
    use std::os::unix::fs::PermissionsExt;

    let shared = workshop();
    let folder = shared.path();
    let tools = folder.join("tools");
    std::fs::create_dir(&tools).expect("a folder");
    // Stands for Slurm: runs the tasks of an array at once, in this process.
    let sbatch = r#"#!/bin/bash
set -eu
while [[ "$1" == --* ]]; do
    [[ "$1" == --array=0-* ]] && last="${1#--array=0-}"
    shift
done
for i in $(seq 0 "$last"); do SLURM_ARRAY_TASK_ID=$i bash "$@" >> tasks.log 2>&1; done
echo 1
"#;
    let program = tools.join("sbatch");
    std::fs::write(&program, sbatch).expect("a script");
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).expect("it can be run");
    let script =
        succeeds(&mut robotc(folder, "store", &["plan-build", TASK, "--format", "slurm", "--shards", "2"]));
    std::fs::write(folder.join("build.sh"), script).expect("a script");

    let robotc_folder = Path::new(env!("CARGO_BIN_EXE_robotc")).parent().expect("a folder").to_owned();
    let mut path = std::env::join_paths([tools.clone(), robotc_folder]).expect("paths");
    path.push(":");
    path.push(std::env::var_os("PATH").unwrap_or_default());
    let mut bash = Command::new("bash");
    bash.arg("build.sh").current_dir(folder).env("PATH", path).env("ROBOTC_STORE", folder.join("store"));
    bash.stdout(Stdio::piped()).stderr(Stdio::piped());
    succeeds(&mut bash);
    let compiled = succeeds(&mut robotc(folder, "store", &["compile", TASK]));
    assert!(compiled.contains("all up to date"), "{compiled}");
}
