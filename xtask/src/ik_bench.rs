//! `cargo xtask ik-bench [POSES]`: generated solvers beside published ones, in a workspace of its own; the table goes to
//! `docs/campaigns/ik-bench.md`.

use std::path::Path;
use std::process::Command;

use anyhow::{Context as _, ensure};

pub(crate) fn run(args: &[String]) -> anyhow::Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("xtask lies in the workspace")?;
    let folder = root.join("benches/ik");
    let poses = args.first().map_or("2000", String::as_str);
    let table = root.join("docs/campaigns/ik-bench.md");
    let table = table.to_str().context("the path is not text")?;
    // The comparison includes what the generator writes.
    cargo(&folder, &["run", "--release", "--locked", "--bin", "generate"])?;
    let compare = ["run", "--release", "--locked", "--features", "compare", "--bin", "compare", "--", poses];
    cargo(&folder, &[&compare[..], &["--write", table]].concat())
}

fn cargo(folder: &Path, args: &[&str]) -> anyhow::Result<()> {
    let status = Command::new("cargo").args(args).current_dir(folder).status()?;
    ensure!(status.success(), "cargo {} failed", args.join(" "));
    Ok(())
}
