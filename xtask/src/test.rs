//! `cargo xtask test`: everything continuous integration checks, in the order that fails fastest.

use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, bail};

/// Runs all checks; stops at the first that fails.
pub(crate) fn run(_args: &[String]) -> anyhow::Result<()> {
    let steps: &[(&str, &[&str])] = &[
        ("format", &["cargo", "fmt", "--all", "--check"]),
        ("lints", &["cargo", "clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"]),
        ("tests", &["cargo", "test", "--workspace", "--locked"]),
    ];
    let mut times = Vec::new();
    crate::tidy::run(&[])?;
    crate::browser::prepare();
    for (name, command) in steps {
        let start = Instant::now();
        println!("== {name}: {}", command.join(" "));
        execute(command)?;
        times.push(format!("{name} {:.0} s", start.elapsed().as_secs_f64()));
    }
    let start = Instant::now();
    println!("== python");
    crate::python::run(&[])?;
    times.push(format!("python {:.0} s", start.elapsed().as_secs_f64()));
    println!("== all passed: {}", times.join(", "));
    Ok(())
}

/// The folder of the workspace.
pub(crate) fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Runs a program in the workspace folder; an error if it fails.
pub(crate) fn execute(command: &[&str]) -> anyhow::Result<()> {
    let status = Command::new(command[0])
        .args(&command[1..])
        .current_dir(root())
        .status()
        .with_context(|| format!("could not start {}", command[0]))?;
    if !status.success() {
        bail!("failed: {}", command.join(" "));
    }
    Ok(())
}
