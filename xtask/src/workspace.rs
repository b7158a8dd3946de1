//! The workspace that the tasks work in.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, bail};

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
