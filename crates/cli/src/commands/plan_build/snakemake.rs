//! A Snakefile: one rule for each artefact, one for the shards of each that can be shared.

use std::fmt::Write as _;

use super::{Step, Workflow};

pub(super) fn text(workflow: &Workflow<'_>) -> String {
    let mut text = String::from("# Written by `robotc plan-build`; run it with `snakemake --cores all`.\n\n");
    let all: Vec<String> =
        workflow.steps.iter().map(|step| format!("        \"{}\",\n", done(step))).collect();
    write!(text, "rule all:\n    input:\n{}", all.concat()).expect("a string takes everything");
    for step in &workflow.steps {
        text += &rule(workflow, step);
    }
    text
}

/// The file that says that a step is done.
fn done(step: &Step) -> String {
    format!("done/{}", step.recipe)
}

fn rule(workflow: &Workflow<'_>, step: &Step) -> String {
    let name = format!("{}_{}", step.kind, &step.recipe[..8]);
    let command =
        format!("{} --node {}", workflow.command(), step.recipe).replace('\\', "\\\\").replace('"', "\\\"");
    let inputs: String = step.inputs.iter().map(|recipe| format!("        \"done/{recipe}\",\n")).collect();
    let inputs = if inputs.is_empty() { inputs } else { format!("    input:\n{inputs}") };
    let about = step.subjects.join(", ");
    let shards = workflow.shards_of(step);
    if shards == 1 {
        return format!(
            "\n# {} of {about}\nrule {name}:\n{inputs}    output: touch(\"{}\")\n    shell: \"{command}\"\n",
            step.kind,
            done(step)
        );
    }
    format!(
        "\n# {kind} of {about}\nrule {name}_shard:\n{inputs}    output: touch(\"{done}.{{shard}}\")\n    \
         shell: \"{command} --shard {{wildcards.shard}}/{shards}\"\n\n\
         rule {name}:\n    input: expand(\"{done}.{{shard}}\", shard=range({shards}))\n    output: touch(\"{done}\")\n    \
         shell: \"{command}\"\n",
        kind = step.kind,
        done = done(step),
    )
}
