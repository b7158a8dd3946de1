//! `robotc build`: one artefact of a specification, or a shard of it, for schedulers that run many at once.

use std::path::PathBuf;

use clap::Args;
use robotc_kb::depot::{self, Depot, DepotError, TransferError};
use robotc_kb::{BuildError, Graph, Key, NodeIdx, Shard, build_node};

use crate::knowledge::{self, Display, StoreArgs};
use crate::output::{Failure, Outcome, print};

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
    /// Folder in which workers exchange artefacts and pieces
    #[arg(long, value_name = "DIR")]
    depot: Option<String>,
    #[command(flatten)]
    store: StoreArgs,
}

pub(crate) fn run(args: &Build) -> Outcome {
    let graph = knowledge::plan(&crate::input::project(&args.file)?)?;
    let store = args.store.open()?;
    let node = find(&graph, &args.node)?;
    let title = graph.node(node).title();
    let depot = args.depot.as_deref().map(depot::open).transpose()?;
    let exchange: &dyn Depot = match &depot {
        Some(depot) => &**depot,
        None => &*store,
    };
    let knowledge = depot::fetch_inputs(&graph, &store, exchange, node)?;
    if let Some(&input) = graph.node(node).inputs.iter().find(|&&input| knowledge.known(input).is_none()) {
        let input = graph.node(input);
        return Err(Failure::Environment(format!(
            "{title} needs {}, which is not there yet: build {} first",
            input.title(),
            input.recipe.short()
        )));
    }
    let display = Display::new();
    let built = match knowledge.known(node) {
        Some(_) => Ok(None),
        None => build_node(&knowledge, node, exchange, args.shard, &display, || store.writer().map(Box::new)),
    };
    drop(display);
    match built {
        Ok(reason) => {
            let key: Key = knowledge.known(node).expect("it was built or there").key;
            if depot.is_some() {
                depot::put_away(&store, exchange, &key)?;
            }
            print(&match reason {
                Some(_) => format!("{title}: computed, key {}", key.short()),
                None => format!("{title}: there, key {}", key.short()),
            });
            Ok(())
        }
        Err(error @ BuildError::Unfinished { .. }) => {
            print(&format!("{title}: shard {} is done; {error}", args.shard));
            Ok(())
        }
        Err(BuildError::Cancelled) => {
            Err(Failure::Environment("interrupted; finished pieces are kept".into()))
        }
        Err(error) => Err(Failure::Input(format!("{title}: {error}"))),
    }
}

fn find(graph: &Graph, recipe: &str) -> Outcome<NodeIdx> {
    let matches = |&node: &NodeIdx| graph.node(node).recipe.to_string().starts_with(recipe);
    let found: Vec<NodeIdx> = graph.indices().filter(matches).collect();
    match found[..] {
        [node] => Ok(node),
        [] => Err(Failure::Input(format!("no artefact has recipe {recipe}; `robotc plan-build` lists them"))),
        _ => Err(Failure::Input(format!("{} recipes begin with {recipe}; give more digits", found.len()))),
    }
}

impl From<DepotError> for Failure {
    fn from(error: DepotError) -> Self {
        Self::Environment(error.to_string())
    }
}

impl From<TransferError> for Failure {
    fn from(error: TransferError) -> Self {
        Self::Environment(error.to_string())
    }
}
