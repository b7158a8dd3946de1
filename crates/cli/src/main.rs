//! The `robotc` command line. This crate, and the Python one, are the only ones that print, render diagnostics,
//! read the environment or choose a number of threads.

mod args;
mod commands;
mod input;
mod knowledge;
mod output;
mod progress;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    let args = args::Args::parse();
    let outcome = output::configure_threads(args.threads).and_then(|()| commands::run(args.command));
    output::exit_code(outcome)
}
