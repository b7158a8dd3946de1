//! `robotc graph`: the artefacts of a specification and what each is computed from.

use std::path::PathBuf;

use clap::Args;

use crate::knowledge;
use crate::output::{Outcome, print, print_text};
use crate::settings::Settings;

/// Show the graph of artefacts of a specification
#[derive(Args)]
#[command(
    after_help = "Examples:\n  robotc graph mug.task.toml\n  robotc graph --dot mug.task.toml | dot -Tsvg > graph.svg"
)]
pub(crate) struct Graph {
    /// A `*.robot.toml` or `*.task.toml` file
    file: PathBuf,
    /// In the language of Graphviz
    #[arg(long)]
    dot: bool,
    /// Show all parameters, also those that have their default values
    #[arg(long)]
    parameters: bool,
    #[command(flatten)]
    settings: Settings,
}

pub(crate) fn run(args: &Graph) -> Outcome {
    let graph = knowledge::plan(&crate::input::project(&args.file, &args.settings)?)?;
    if args.dot {
        print_text(&graph.to_dot());
        return Ok(());
    }
    for node in graph.nodes() {
        print(&format!("{} {} ({})", node.kind_name(), node.subjects.join(", "), node.recipe.short()));
        let table = node.kind.info().parameters;
        for (info, (value, default)) in table.iter().zip(node.parameters.iter().zip(&node.defaults)) {
            if args.parameters || value != default {
                print(&format!("    {} = {}", info.name, robotc_kb::parameters::show(value)));
            }
        }
        for input in &node.inputs {
            print(&format!("    from {}", graph.node(*input).title()));
        }
    }
    Ok(())
}
