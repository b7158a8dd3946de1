//! The command line as users see it.

use clap::Parser;

use crate::commands::Command;

/// Compiles robot and task specifications to a knowledge base, inverse kinematics, and programs that plan and execute.
#[derive(Parser)]
#[command(
    name = "robotc",
    version,
    propagate_version = true,
    after_help = "Exit codes: 0 done, 1 the input is wrong, 2 the environment failed, 101 a bug in robotc."
)]
pub(crate) struct Args {
    /// Number of threads for compiling; results do not depend on it [default: all cores]
    #[arg(long, global = true, value_name = "N")]
    pub(crate) threads: Option<usize>,
    #[command(subcommand)]
    pub(crate) command: Command,
}
