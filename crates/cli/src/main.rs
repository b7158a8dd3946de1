//! The `robotc` command line. This crate, and the Python one, are the only ones that print, render diagnostics,
//! read the environment or choose a number of threads.

mod args;
mod chain;
mod commands;
mod description;
mod input;
mod knowledge;
mod output;
mod progress;
mod settings;

use std::process::ExitCode;

use clap::Parser;

fn main() -> ExitCode {
    let args = match args::Args::try_parse() {
        Ok(args) => args,
        Err(shown) => {
            // Help and version are answers; anything else is wrong input.
            let code = u8::from(shown.use_stderr());
            let _ = shown.print();
            return ExitCode::from(code);
        }
    };
    let outcome = output::configure_threads(args.threads).and_then(|()| commands::run(args.command));
    output::exit_code(outcome)
}
