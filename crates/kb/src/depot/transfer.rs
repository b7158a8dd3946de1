//! Artefacts between a store and a depot.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{Depot, DepotError};
use crate::graph::{Graph, NodeIdx};
use crate::key::Key;
use crate::resolve::Knowledge;
use crate::store::{ArchiveError, Store, StoreError};

fn name(key: &Key) -> String {
    format!("artefacts/{key}")
}

/// Why an artefact could not be moved.
#[derive(Debug, thiserror::Error)]
pub enum TransferError {
    /// The depot failed.
    #[error(transparent)]
    Depot(#[from] DepotError),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// What the depot has is wrong.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
}

/// Puts an artefact of the store into the depot, unless it is there.
pub fn put_away(store: &Store, depot: &dyn Depot, key: &Key) -> Result<(), TransferError> {
    if depot.get(&name(key))?.is_none() {
        depot.put(&name(key), &store.pack(&BTreeSet::from([*key]))?.0)?;
    }
    Ok(())
}

/// Brings an artefact into the store: `true` when the depot had it. It is verified before it is stored.
pub fn bring(store: &Store, depot: &dyn Depot, key: &Key) -> Result<bool, TransferError> {
    let Some(bytes) = depot.get(&name(key))? else { return Ok(false) };
    store.import(&store.writer()?, &bytes)?;
    Ok(true)
}

/// What is known of a graph when all that the depot has of a node and of what it needs was brought into the store.
pub fn fetch_inputs(
    graph: &Arc<Graph>,
    store: &Arc<Store>,
    depot: &dyn Depot,
    node: NodeIdx,
) -> Result<Knowledge, TransferError> {
    let mut needed = vec![false; graph.nodes().len()];
    needed[node.index()] = true;
    // Inputs come before what is computed from them.
    for index in graph.indices().collect::<Vec<_>>().into_iter().rev() {
        if needed[index.index()] {
            graph.node(index).inputs.iter().for_each(|input| needed[input.index()] = true);
        }
    }
    loop {
        let knowledge = Knowledge::resolve(graph, store)?;
        let mut brought = false;
        for index in graph.indices().filter(|index| needed[index.index()]) {
            if knowledge.known(index).is_none()
                && let Some(record) = knowledge.key_record(index)
            {
                brought |= bring(store, depot, &record.key())?;
            }
        }
        // What came in may have completed the keys of others.
        if !brought {
            return Ok(knowledge);
        }
    }
}
