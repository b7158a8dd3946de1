//! `cargo xtask ik-bench [POSES]`: generated solvers beside published ones, in a workspace of its own; the table goes to
//! `docs/campaigns/ik-bench.md`. Those that are published for Python follow where they can be installed.

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
    cargo(&folder, &[&compare[..], &["--write", table]].concat())?;
    from_python(&folder, table)
}

/// Published for Python, with the versions that are compared.
const PACKAGES: [&str; 3] = ["numpy", "ssik==8.2.0", "EAIK==1.2.2"];

/// Poses of a set there: some of the solvers take milliseconds.
const FEW: &str = "200";

fn from_python(folder: &Path, table: &str) -> anyhow::Result<()> {
    let home = folder.join("target/python");
    let python = home.join("bin/python");
    let runs = |command: &mut Command| command.status().is_ok_and(|status| status.success());
    let made = python.exists() || runs(Command::new("python3").args(["-m", "venv"]).arg(&home));
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    if !made || !runs(Command::new(&python).args(install).args(PACKAGES)) {
        println!("left out: {} cannot be installed here", PACKAGES.join(", "));
        return Ok(());
    }
    let status = Command::new(python).arg(folder.join("peers.py")).args([FEW, "--write", table]).status()?;
    ensure!(status.success(), "peers.py failed");
    Ok(())
}

fn cargo(folder: &Path, args: &[&str]) -> anyhow::Result<()> {
    let status = Command::new("cargo").args(args).current_dir(folder).status()?;
    ensure!(status.success(), "cargo {} failed", args.join(" "));
    Ok(())
}
