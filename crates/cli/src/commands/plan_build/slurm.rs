//! A shell script for Slurm: job arrays, level by level of the graph.

use std::fmt::Write as _;

use super::Workflow;

pub(super) fn text(workflow: &Workflow<'_>) -> String {
    let arrays = arrays(workflow);
    let mut text = String::from(
        "#!/bin/bash\n# Written by `robotc plan-build`; submit all of it with `bash build.sh`.\nset -eu\n\n\
         # Job arrays, one after the other. Each line is a task.\n",
    );
    for (number, tasks) in arrays.iter().enumerate() {
        let lines: String = tasks.iter().map(|task| format!("    \"{task}\"\n")).collect();
        write!(text, "array{number}=(\n{lines})\n").expect("a string takes everything");
    }
    let numbers: Vec<String> = (0..arrays.len()).map(|number| number.to_string()).collect();
    text += &format!(
        r#"
if [ "$#" -eq 2 ]; then # A task of an array.
    declare -n tasks="array$1"
    exec {command} ${{tasks[$SLURM_ARRAY_TASK_ID]}}
fi
after=""
for number in {numbers}; do
    declare -n tasks="array$number"
    job=$(sbatch --parsable $after --array=0-$((${{#tasks[@]}} - 1)) "$0" "$number" task)
    after="--dependency=afterok:$job"
done
"#,
        command = workflow.command(),
        numbers = numbers.join(" "),
    );
    text
}

/// The tasks of each array: all shards of a level, then putting together what was shared.
fn arrays(workflow: &Workflow<'_>) -> Vec<Vec<String>> {
    let levels = workflow.steps.iter().map(|step| step.level + 1).max().unwrap_or(0);
    let mut arrays = Vec::new();
    for level in 0..levels {
        let (mut all, mut shared) = (Vec::new(), Vec::new());
        for step in workflow.steps.iter().filter(|step| step.level == level) {
            let whole = format!("--node {}", step.recipe);
            match workflow.shards_of(step) {
                1 => all.push(whole),
                shards => {
                    all.extend((0..shards).map(|i| format!("{whole} --shard {i}/{shards}")));
                    shared.push(whole);
                }
            }
        }
        arrays.push(all);
        arrays.extend((!shared.is_empty()).then_some(shared));
    }
    arrays
}
