//! `robotc build`: one artefact of a specification, or a shard of it, for schedulers that run many at once.

use std::path::PathBuf;

use clap::Args;
use robotc_kb::depot::{self, Depot, Work, WorkError};
use robotc_kb::{BuildError, Shard};

use crate::knowledge::{self, Display, StoreArgs};
use crate::output::{Failure, Outcome, print};
use crate::settings::Settings;

/// Compute one artefact, or a shard of it: what `robotc plan-build` lists
#[derive(Args)]
#[command(after_help = "Examples:\n  robotc build mug.task.toml --node 3fa0 --depot /shared/depot\n  \
    robotc build mug.task.toml --node 3fa0 --shard 2/8 --depot /shared/depot\n\n\
    Run the shards anywhere, in any order, as often as you like: what is done is not done again, and whoever \
    finds all pieces puts them together.")]
pub(crate) struct Build {
    /// A `*.robot.toml` or `*.task.toml` file
    file: PathBuf,
    /// The recipe of the artefact, or its first digits
    #[arg(long, value_name = "RECIPE")]
    node: String,
    /// Compute only every n-th piece, beginning with number i
    #[arg(long, value_name = "I/N", default_value = "0/1", hide_default_value = true)]
    shard: Shard,
    /// Folder or address at which workers exchange artefacts and pieces; that of a shared knowledge base unless given
    #[arg(long, value_name = "WHERE")]
    depot: Option<String>,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    store: StoreArgs,
}

pub(crate) fn run(args: &Build) -> Outcome {
    let graph = knowledge::plan(&crate::input::project(&args.file, &args.settings)?)?;
    let node = match graph.with_recipe(&args.node)[..] {
        [node] => node,
        [] => {
            let wanted = &args.node;
            return Err(Failure::Input(format!(
                "no artefact has recipe {wanted}; `robotc plan-build` lists them"
            )));
        }
        ref several => {
            let count = several.len();
            return Err(Failure::Input(format!(
                "{count} recipes begin with {}; give more digits",
                args.node
            )));
        }
    };
    let title = graph.node(node).title();
    let store = args.store.open()?;
    let given = args.depot.as_deref().map(knowledge::open_depot).transpose()?;
    let depot: &dyn Depot = given.as_deref().or(store.shared()).unwrap_or(&*store);
    let display = Display::new();
    let worked = depot::work(&graph, &store, depot, node, args.shard, &display);
    drop(display);
    match worked {
        Ok(Work::There(key)) => print(&format!("{title}: there, key {}", key.short())),
        Ok(Work::Computed(key)) => print(&format!("{title}: computed, key {}", key.short())),
        Ok(Work::Shard { missing, pieces }) => {
            let shard = args.shard;
            print(&format!(
                "{title}: shard {shard} is done; {missing} of {pieces} pieces are left to others"
            ));
        }
        Err(WorkError::Build { error: BuildError::Cancelled, .. }) => {
            return Err(Failure::Environment("interrupted; finished pieces are kept".into()));
        }
        Err(error @ WorkError::Build { .. }) => return Err(Failure::Input(error.to_string())),
        Err(error) => return Err(Failure::Environment(error.to_string())),
    }
    Ok(())
}
