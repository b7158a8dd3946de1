//! `robotc schema`: the JSON Schema of a specification format, for editors.

use clap::{Args, ValueEnum};
use robotc_core::spec::{SpecKind, json_schema};

use crate::output::{Outcome, print_text};

/// Print the JSON Schema of a specification format
#[derive(Args)]
#[command(after_help = "Example:\n  robotc schema robot > robot.schema.json")]
pub(crate) struct Schema {
    /// The format
    format: Format,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// `*.robot.toml`
    Robot,
    /// `*.task.toml`
    Task,
}

pub(crate) fn run(args: &Schema) -> Outcome {
    let kind = match args.format {
        Format::Robot => SpecKind::Robot,
        Format::Task => SpecKind::Task,
    };
    print_text(&json_schema(kind, &robotc_kb::kinds::parameter_table()));
    Ok(())
}
