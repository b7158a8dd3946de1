//! `robotc plan-build`: what a specification needs, for schedulers on one machine or many.

mod slurm;
mod snakemake;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use robotc_kb::Graph;
use robotc_kb::context::PIECES;
use serde::Serialize;

use crate::knowledge;
use crate::output::{Outcome, print};
use crate::settings::Settings;

/// List the artefacts of a specification with what each needs, or write a workflow that computes them
#[derive(Args)]
#[command(after_help = "Examples:\n  robotc plan-build mug.task.toml --format json\n  \
    robotc plan-build mug.task.toml --format snakemake --depot /shared/depot > Snakefile\n  \
    robotc plan-build mug.task.toml --format slurm --shards 16 > build.sh && bash build.sh\n\n\
    Nothing is computed. Recipes are known beforehand; `robotc build` computes one.")]
pub(crate) struct PlanBuild {
    /// A `*.robot.toml` or `*.task.toml` file
    file: PathBuf,
    /// What to write
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    /// The same as --format json
    #[arg(long)]
    json: bool,
    /// Processes that share each large artefact, in a workflow
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=PIECES as i64))]
    shards: u32,
    /// Folder or address at which the workers of a workflow exchange artefacts and pieces
    #[arg(long, value_name = "WHERE", default_value = "depot")]
    depot: String,
    #[command(flatten)]
    settings: Settings,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// A line for each artefact
    Text,
    /// The graph as JSON
    Json,
    /// A Snakefile
    Snakemake,
    /// A shell script that submits job arrays to Slurm
    Slurm,
}

/// An artefact to be computed.
#[derive(Serialize)]
struct Step {
    recipe: String,
    kind: &'static str,
    subjects: Vec<String>,
    /// Recipes of what it is computed from.
    inputs: Vec<String>,
    /// Most shards that share the work.
    shards: usize,
    /// Length of the longest chain of inputs below it.
    level: usize,
}

/// What a workflow is written from.
struct Workflow<'a> {
    file: String,
    depot: &'a str,
    settings: &'a Settings,
    /// Processes for each artefact that can be shared.
    shards: usize,
    /// Inputs come before what is computed from them.
    steps: Vec<Step>,
}

impl Workflow<'_> {
    /// The command of a step, without its shard.
    fn command(&self) -> String {
        let mut command = format!("robotc build {} --depot {}", quoted(&self.file), quoted(self.depot));
        for setting in self.settings.words() {
            command += &format!(" --set {}", quoted(&setting));
        }
        command
    }

    fn shards_of(&self, step: &Step) -> usize {
        self.shards.min(step.shards)
    }
}

pub(crate) fn run(args: &PlanBuild) -> Outcome {
    let graph = knowledge::plan(&crate::input::project(&args.file, &args.settings)?)?;
    let workflow = Workflow {
        file: args.file.display().to_string(),
        depot: &args.depot,
        settings: &args.settings,
        shards: args.shards as usize,
        steps: steps(&graph),
    };
    match if args.json { Format::Json } else { args.format } {
        Format::Text => {
            for step in &workflow.steps {
                let shards = if step.shards > 1 { "  in shards" } else { "" };
                print(&format!(
                    "{}  {} of {}{shards}",
                    &step.recipe[..12],
                    step.kind,
                    step.subjects.join(", ")
                ));
            }
        }
        Format::Json => {
            let text = serde_json::to_string_pretty(&serde_json::json!({ "steps": workflow.steps }));
            print(&text.expect("plain values always have a JSON form"));
        }
        Format::Snakemake => print(snakemake::text(&workflow).trim_end()),
        Format::Slurm => print(slurm::text(&workflow).trim_end()),
    }
    Ok(())
}

fn steps(graph: &Graph) -> Vec<Step> {
    let step = |(node, &level): (&robotc_kb::graph::Node, &usize)| {
        let mut inputs: Vec<String> =
            node.inputs.iter().map(|&input| graph.node(input).recipe.to_string()).collect();
        inputs.sort();
        inputs.dedup();
        Step {
            recipe: node.recipe.to_string(),
            kind: node.kind_name(),
            subjects: node.subjects.clone(),
            inputs,
            shards: if node.kind.info().in_pieces { PIECES } else { 1 },
            level,
        }
    };
    graph.nodes().iter().zip(&graph.levels()).map(step).collect()
}

/// A word for a POSIX shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "/._-=:@%+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_survive_the_shell() {
        for (word, expected) in
            [("a/b.task.toml", "a/b.task.toml"), ("my task", "'my task'"), ("it's", r"'it'\''s'"), ("", "''")]
        {
            assert_eq!(quoted(word), expected);
        }
    }
}
