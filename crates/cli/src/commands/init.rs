//! `robotc init`: a first robot specification for a description.

use std::path::PathBuf;

use clap::Args;
use robotc_core::Sources;
use robotc_core::spec::{self, InitOptions};
use robotc_core::urdf::{LoadOptions, MeshPolicy};
use robotc_kb::os::OsSystem;

use super::compile::write_whole;
use crate::description::DescriptionArgs;
use crate::output::{Failure, Outcome, print_text, report, say};

/// Write a commented robot specification for a URDF or xacro file, with guesses to be checked
#[derive(Args)]
#[command(
    after_help = "Examples:\n  robotc init arm.urdf -o arm.robot.toml\n  robotc init arm.urdf --srdf arm.srdf"
)]
pub(crate) struct Init {
    /// URDF or xacro file
    description: PathBuf,
    /// SRDF with groups, end effectors and disabled pairs
    #[arg(long, value_name = "FILE")]
    srdf: Option<PathBuf>,
    /// MoveIt's joint_limits.yaml
    #[arg(long, value_name = "FILE")]
    joint_limits: Option<PathBuf>,
    #[command(flatten)]
    reading: DescriptionArgs,
    /// File to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

pub(crate) fn run(args: &Init) -> Outcome {
    let mut sources = Sources::new();
    let LoadOptions { packages, arguments, .. } = args.reading.options(MeshPolicy::SkipAway);
    let options = InitOptions {
        description: args.description.clone(),
        srdf: args.srdf.clone(),
        joint_limits: args.joint_limits.clone(),
        packages,
        arguments,
        folder: args.output.as_ref().and_then(|path| path.parent()).map(PathBuf::from).unwrap_or_default(),
        here: std::env::current_dir().unwrap_or_default(),
    };
    let (text, found) = spec::init(&OsSystem, &mut sources, &options);
    report(&found, &sources);
    let text = text.ok_or(Failure::Reported)?;
    match &args.output {
        None => print_text(&text),
        Some(path) if path.exists() => {
            return Err(Failure::Input(format!("{} is there already; remove it first", path.display())));
        }
        Some(path) => {
            write_whole(path, text.as_bytes())?;
            say(&format!("wrote {}; read its comments and check the guesses", path.display()));
        }
    }
    Ok(())
}
