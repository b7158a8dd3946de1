//! One file per command; one line each in [`Command`] and [`run`].

mod explain;
mod schema;

use clap::Subcommand;

use crate::output::Outcome;

#[derive(Subcommand)]
pub(crate) enum Command {
    Explain(explain::Explain),
    Schema(schema::Schema),
}

/// Does what the command line asks for.
pub(crate) fn run(command: Command) -> Outcome {
    match command {
        Command::Explain(args) => explain::run(&args),
        Command::Schema(args) => schema::run(&args),
    }
}
