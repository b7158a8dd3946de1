//! One file per command; one line each in [`Command`] and [`run`].

mod compile;
mod explain;
mod graph;
mod kb;
mod schema;

use clap::Subcommand;

use crate::output::Outcome;

#[derive(Subcommand)]
pub(crate) enum Command {
    Compile(compile::Compile),
    Explain(explain::Explain),
    Graph(graph::Graph),
    Kb(kb::Kb),
    Schema(schema::Schema),
}

/// Does what the command line asks for.
pub(crate) fn run(command: Command) -> Outcome {
    match command {
        Command::Compile(args) => compile::run(&args),
        Command::Explain(args) => explain::run(&args),
        Command::Graph(args) => graph::run(&args),
        Command::Kb(args) => kb::run(&args),
        Command::Schema(args) => schema::run(&args),
    }
}
