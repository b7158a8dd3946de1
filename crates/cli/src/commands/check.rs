//! `robotc check`: everything that is wrong with specifications, at once.

use std::path::PathBuf;

use clap::Args;
use robotc_core::Sources;
use robotc_core::spec;
use robotc_core::urdf::MeshPolicy;
use robotc_kb::os::OsSystem;

use crate::description::DescriptionArgs;
use crate::output::{Failure, Outcome, print, report};

/// Check specifications and robot descriptions
#[derive(Args)]
#[command(
    after_help = "Examples:\n  robotc check specs/robots/*.robot.toml specs/tasks/*.task.toml\n  robotc check arm.urdf\n\n\
    Files may be robot and task specifications, URDF, xacro and SRDF files, and MoveIt's joint_limits.yaml."
)]
pub(crate) struct Check {
    /// Files of any of these kinds
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    reading: DescriptionArgs,
}

pub(crate) fn run(args: &Check) -> Outcome {
    let table = robotc_kb::kinds::parameter_table();
    let load = args.reading.options(MeshPolicy::SkipAway);
    let mut failed = false;
    for file in &args.files {
        let mut sources = Sources::new();
        let (summary, found) = spec::check(&OsSystem, &mut sources, file, &table, &load);
        report(&found, &sources);
        match summary {
            Some(summary) => {
                print(&format!("{}: {} {}", file.display(), summary.what, summary.name));
                summary.facts.iter().for_each(|fact| print(&format!("  {fact}")));
            }
            None => failed = true,
        }
    }
    if failed { Err(Failure::Reported) } else { Ok(()) }
}
