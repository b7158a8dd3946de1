//! The Python wheel: an environment of its own, the wheel built into it, and its tests.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, bail};

/// What the environment holds. Versions are pinned so that a run repeats.
const PACKAGES: &[&str] = &[
    "maturin==1.16.0",
    "numpy==2.2.6; python_version < '3.11'",
    "numpy==2.3.5; python_version >= '3.11'",
    "pytest==8.4.2",
];

/// Builds the wheel and runs its tests; further arguments go to pytest.
pub(crate) fn run(args: &[String]) -> anyhow::Result<()> {
    let environment = environment()?;
    let python = environment.join("bin").join("python");
    let wheels = crate::workspace::root().join("target").join("wheels");
    if wheels.exists() {
        std::fs::remove_dir_all(&wheels)?;
    }
    call(
        Command::new(environment.join("bin").join("maturin"))
            .args([
                "build",
                "--locked",
                "--manifest-path",
                "crates/py/Cargo.toml",
                "--profile",
                "dev",
                "--out",
            ])
            .arg(&wheels)
            .env("VIRTUAL_ENV", &environment),
    )?;
    let wheel = std::fs::read_dir(&wheels)?
        .flatten()
        .map(|entry| entry.path())
        .find(|path| path.extension().is_some_and(|e| e == "whl"))
        .context("maturin made no wheel")?;
    call(
        Command::new(&python)
            .args(["-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps"])
            .arg(wheel),
    )?;
    call(Command::new(&python).args(["-m", "pytest", "--quiet", "crates/py/tests"]).args(args))
}

/// The environment's folder; made and filled when it is not there or its packages changed.
fn environment() -> anyhow::Result<PathBuf> {
    let folder = crate::workspace::root().join("target").join("python");
    let mark = folder.join("robotc-packages.txt");
    let wanted = PACKAGES.join("\n");
    if std::fs::read_to_string(&mark).is_ok_and(|installed| installed == wanted) {
        return Ok(folder);
    }
    call(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&folder))?;
    let python = folder.join("bin").join("python");
    call(
        Command::new(python)
            .args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"])
            .args(PACKAGES),
    )?;
    std::fs::write(mark, wanted)?;
    Ok(folder)
}

fn call(command: &mut Command) -> anyhow::Result<()> {
    let shown = format!("{command:?}");
    let status = command
        .current_dir(crate::workspace::root())
        .status()
        .with_context(|| format!("could not start {shown}"))?;
    if !status.success() {
        bail!("failed: {shown}");
    }
    Ok(())
}
