//! What one of many workers does: an artefact, or a shard of one, from what the depot has into the depot.

use std::sync::Arc;

use thiserror::Error;

use super::{Depot, TransferError, fetch_inputs, put_away};
use crate::compile::build_node;
use crate::context::Shard;
use crate::graph::{Graph, NodeIdx};
use crate::key::Key;
use crate::observer::{BuildError, Observer};
use crate::store::Store;

/// What a worker did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Work {
    /// The artefact was there.
    There(Key),
    /// It computed the artefact, or what was left of it.
    Computed(Key),
    /// It computed its shard; others have to do theirs.
    Shard {
        /// Pieces that are not there yet.
        missing: usize,
        /// Pieces in all.
        pieces: usize,
    },
}

/// Why a worker did nothing.
#[derive(Debug, Error)]
pub enum WorkError {
    /// An artefact that it needs is not there.
    #[error("{needs} needs {input}, which is not there yet; its recipe is {}", recipe.short())]
    Input {
        /// The artefact wanted.
        needs: String,
        /// The one that is missing.
        input: String,
        /// Recipe of the missing one.
        recipe: crate::key::RecipeId,
    },
    /// Something could not be moved.
    #[error(transparent)]
    Transfer(#[from] TransferError),
    /// The artefact could not be computed.
    #[error("{title}: {error}")]
    Build {
        /// The artefact.
        title: String,
        /// Why.
        error: BuildError,
    },
}

/// Computes an artefact or its shard, with what `depot` has, and puts it there. `store` is the worker's own.
pub fn work(
    graph: &Arc<Graph>,
    store: &Arc<Store>,
    depot: &dyn Depot,
    index: NodeIdx,
    shard: Shard,
    observer: &dyn Observer,
) -> Result<Work, WorkError> {
    let node = graph.node(index);
    let knowledge = fetch_inputs(graph, store, depot, index)?;
    let key = |what: fn(Key) -> Work| what(knowledge.known(index).expect("it is there now").key);
    let worked = if knowledge.known(index).is_some() {
        key(Work::There)
    } else {
        if let Some(&input) = node.inputs.iter().find(|&&input| knowledge.known(input).is_none()) {
            let input = graph.node(input);
            return Err(WorkError::Input { needs: node.title(), input: input.title(), recipe: input.recipe });
        }
        let writer = || store.writer().map(Box::new);
        match build_node(&knowledge, index, depot, shard, observer, writer) {
            Ok(Some(_)) => key(Work::Computed),
            Ok(None) => key(Work::There),
            Err(BuildError::Unfinished { missing, pieces }) => return Ok(Work::Shard { missing, pieces }),
            Err(error) => return Err(WorkError::Build { title: node.title(), error }),
        }
    };
    if let Work::There(key) | Work::Computed(key) = worked {
        put_away(store, depot, &key)?;
    }
    Ok(worked)
}
