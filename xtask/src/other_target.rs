//! `cargo xtask other-target [NATIVE FOREIGN]`: the same artefacts on another processor.
//!
//! `robotc` is built for this machine and for 64-bit ARM, whose programs QEMU runs (`qemu-aarch64`); the linker is that of
//! `aarch64-linux-gnu-gcc`, the standard library `rustup target add aarch64-unknown-linux-gnu`. Both compile small tasks, which have
//! every kind of artefact that a task has by itself, into stores of their own. Their lock files have to be the same text: every key
//! and every byte.
//!
//! With two programs nothing is built.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use anyhow::{Context, ensure};

use crate::workspace::{execute, root};

const TARGET: &str = "aarch64-unknown-linux-gnu";
const LINKER: &str = "aarch64-linux-gnu-gcc";
const EMULATOR: &[&str] = &["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu"];

/// Tasks, and what makes them small: emulation takes some thirty times as long.
const TASKS: &[(&str, &[&str])] = &[
    ("crates/cli/tests/fixtures/tidy.task.toml", &[]),
    (
        "specs/tasks/mug_and_cabinet.task.toml",
        &["reachability.step=0.3", "grasp_set.approaches=500", "caging_set.approaches=300"],
    ),
    ("specs/tasks/mug_to_shelf_wam.task.toml", &["reachability.step=0.3", "grasp_set.approaches=500"]),
];

/// Builds both programs unless they are given, compiles with both, and compares.
pub(crate) fn run(args: &[String]) -> anyhow::Result<()> {
    let (native, foreign) = match args {
        [native, foreign] => (std::path::absolute(native)?, std::path::absolute(foreign)?),
        _ => build()?,
    };
    let folder = tempfile::tempdir()?;
    for (task, small) in TASKS {
        let (expected, fast) = compile(&[], &native, task, small, &folder.path().join("native"))?;
        let (found, slow) = compile(EMULATOR, &foreign, task, small, &folder.path().join("foreign"))?;
        let differing: Vec<&str> =
            expected.lines().zip(found.lines()).filter(|(a, b)| a != b).map(|(a, _)| a).collect();
        ensure!(
            expected == found,
            "{task}: {} artefacts differ on {TARGET}:\n{}",
            differing.len(),
            differing.join("\n")
        );
        let artefacts = expected.lines().filter(|line| line.split(' ').count() == 4).count();
        println!("{task}: {artefacts} artefacts are the same ({fast:.0} s here, {slow:.0} s on {TARGET})");
    }
    Ok(())
}

fn build() -> anyhow::Result<(PathBuf, PathBuf)> {
    let build = ["cargo", "build", "--release", "--locked", "-p", "robotc"];
    execute(&build)?;
    let mut command = Command::new(build[0]);
    command.args(&build[1..]).args(["--target", TARGET]).current_dir(root());
    command.env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER", LINKER);
    let built = command.status().context("could not start cargo")?;
    ensure!(
        built.success(),
        "robotc does not build for {TARGET}; it takes {LINKER} and the standard library"
    );
    let target = root().join("target");
    Ok((target.join("release/robotc"), target.join(TARGET).join("release/robotc")))
}

/// The lock file of a task, and the seconds that it took.
fn compile(
    emulator: &[&str],
    program: &Path,
    task: &str,
    small: &[&str],
    folder: &Path,
) -> anyhow::Result<(String, f64)> {
    std::fs::create_dir_all(folder)?;
    let lock = folder.join("robotc.lock");
    let words: Vec<&std::ffi::OsStr> =
        emulator.iter().map(|word| word.as_ref()).chain([program.as_os_str()]).collect();
    let mut command = Command::new(words[0]);
    command.args(&words[1..]).env("ROBOTC_STORE", folder.join("store")).stdout(Stdio::null());
    command.arg("compile").arg("--lock").arg(&lock);
    small.iter().for_each(|setting| _ = command.args(["--set", setting]));
    let start = Instant::now();
    let status = command.arg(root().join(task)).stderr(Stdio::null()).status();
    let status = status.with_context(|| format!("could not start {}", words[0].display()))?;
    ensure!(status.success(), "{} does not compile {task}", program.display());
    let seconds = start.elapsed().as_secs_f64();
    let text = std::fs::read_to_string(&lock)?;
    std::fs::remove_file(&lock)?;
    Ok((text, seconds))
}
