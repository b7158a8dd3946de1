//! `cargo xtask ik-zoo [FOLDER] [POSES] [FILTER] [--singular=N] [--types=N] [--calibrated=N]`: compiles and proves inverse kinematics for
//! every arm of a folder, prints the tables and stores those of the whole folder as `docs/campaigns/zoo.md`.

use std::process::{Command, Stdio};

use anyhow::{Context, bail};

/// Runs the campaign.
pub(crate) fn run(args: &[String]) -> anyhow::Result<()> {
    let folder = args.first().map_or("../shared/data/arms", String::as_str);
    let poses = args.get(1).map_or("1000", String::as_str);
    let whole = poses.parse::<usize>().context("POSES is a number")? > 0
        && args.iter().skip(2).all(|argument| argument.starts_with("--"));
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let output = Command::new(cargo)
        .args(["run", "--release", "-q", "-p", "robotc-ikgen", "--example", "zoo", "--", folder, poses])
        .args(args.iter().skip(2))
        .stderr(Stdio::inherit())
        .output()
        .context("could not start cargo")?;
    if !output.status.success() {
        bail!("the campaign failed");
    }
    let table = String::from_utf8(output.stdout)?;
    if whole {
        std::fs::write("docs/campaigns/zoo.md", &table).context("run it in the root of the repository")?;
    }
    print!("{table}");
    Ok(())
}
