//! Artefacts between a store and a depot.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{Depot, DepotError, Entry};
use crate::graph::{Graph, NodeIdx};
use crate::key::{ContentHash, Key};
use crate::resolve::Knowledge;
use crate::store::{Archive, Archived, Store, StoreError, Writer};

pub(super) const FOLDER: &str = "artefacts";

fn name(key: &Key) -> String {
    format!("{FOLDER}/{key}")
}

/// Why an artefact could not be moved.
#[derive(Debug, thiserror::Error)]
pub enum TransferError {
    /// The depot failed.
    #[error(transparent)]
    Depot(#[from] DepotError),
    /// The store failed, or one key has two contents.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Puts an artefact of the store into the depot, unless it is there whole.
pub fn put_away(store: &Store, depot: &dyn Depot, key: &Key) -> Result<(), TransferError> {
    for artefact in store.gather(&BTreeSet::from([*key]))? {
        offer(depot, artefact)?;
    }
    Ok(())
}

/// Puts an artefact into the depot, unless it is there whole. The error is [`StoreError::NotRepeatable`] when another
/// content is there under its key.
pub(crate) fn offer(depot: &dyn Depot, artefact: Archived) -> Result<(), TransferError> {
    let entry = Entry::of(&artefact);
    let name = name(&entry.key);
    let bytes = Archive::new(vec![artefact]).encode();
    let mut there = entry.clone();
    if !depot.put_new(&name, &bytes)? {
        match read(depot, &entry.key)? {
            Some(other) => there = Entry::of(&other),
            None => depot.put(&name, &bytes)?,
        }
    }
    // Entered when it is there, and again by whoever finds it there: its process may have died in between.
    let entered = depot.enter(&there)?;
    match [there, entered].into_iter().find(|other| other.content != entry.content) {
        None => Ok(()),
        Some(other) => Err(StoreError::NotRepeatable {
            kind: entry.kind,
            key: entry.key,
            before: other.content,
            now: entry.content,
        }
        .into()),
    }
}

/// The artefact that a depot has for a key; `None` unless it is there whole.
fn read(depot: &dyn Depot, key: &Key) -> Result<Option<Archived>, DepotError> {
    let Some(bytes) = depot.get(&name(key))? else { return Ok(None) };
    let archive = Archive::read(&bytes).ok();
    Ok(archive.and_then(|archive| match archive.artefacts() {
        [artefact] if artefact.record.key() == *key => Some(artefact.clone()),
        _ => None,
    }))
}

/// The keys of all artefacts of a depot.
fn keys(depot: &dyn Depot) -> Result<Vec<Key>, DepotError> {
    Ok(depot.names(FOLDER)?.iter().filter_map(|name| name.parse().ok()).collect())
}

/// Brings an artefact into the store: its content, or `None` when the depot does not have it whole.
pub fn bring(
    store: &Store,
    writer: &Writer,
    depot: &dyn Depot,
    key: &Key,
) -> Result<Option<ContentHash>, TransferError> {
    let Some(artefact) = read(depot, key)? else { return Ok(None) };
    let content = Entry::of(&artefact).content;
    store.take(writer, &[artefact])?;
    Ok(Some(content))
}

/// Brings every artefact of the depot that the store lacks; the number of those that are not whole.
pub fn bring_all(store: &Store, depot: &dyn Depot) -> Result<usize, TransferError> {
    let mut damaged = 0;
    for key in keys(depot)? {
        if store.lookup(&key)?.is_none() {
            damaged += usize::from(bring(store, &store.writer()?, depot, &key)?.is_none());
        }
    }
    Ok(damaged)
}

/// All artefacts of a depot, by kind, subject and key: from its catalogue, or by reading every one of them, without those
/// that are not whole.
pub fn catalogue(depot: &dyn Depot) -> Result<Vec<Entry>, DepotError> {
    if let Some(entries) = depot.entries()? {
        return Ok(entries);
    }
    let mut entries = Vec::new();
    for key in keys(depot)? {
        entries.extend(read(depot, &key)?.map(|artefact| Entry::of(&artefact)));
    }
    entries.sort();
    Ok(entries)
}

/// Removes an artefact from a depot and its catalogue.
pub fn remove(depot: &dyn Depot, key: &Key) -> Result<(), DepotError> {
    depot.remove(&name(key))
}

/// What a depot holds, looked into.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Inventory {
    /// Artefacts that are whole.
    pub whole: usize,
    /// Bytes of their contents.
    pub bytes: u64,
    /// Those that are not, or are not what the catalogue says.
    pub damaged: Vec<Key>,
    /// Those that the catalogue has and the depot has not.
    pub missing: Vec<Key>,
}

/// Reads everything that a depot holds, and compares it with its keys, its hashes and the catalogue.
pub fn verify(depot: &dyn Depot) -> Result<Inventory, DepotError> {
    let entries = depot.entries()?.unwrap_or_default();
    let entered = |key: &Key| entries.iter().find(|entry| entry.key == *key);
    let mut inventory = Inventory::default();
    let mut seen = BTreeSet::new();
    for key in keys(depot)? {
        seen.insert(key);
        match read(depot, &key)?.map(|artefact| Entry::of(&artefact)) {
            Some(entry) if entered(&key).is_none_or(|other| other.content == entry.content) => {
                inventory.whole += 1;
                inventory.bytes += entry.size;
            }
            _ => inventory.damaged.push(key),
        }
    }
    inventory.missing = entries.iter().map(|entry| entry.key).filter(|key| !seen.contains(key)).collect();
    Ok(inventory)
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
                brought |= bring(store, &store.writer()?, depot, &record.key())?.is_some();
            }
        }
        // What came in may have completed the keys of others.
        if !brought {
            return Ok(knowledge);
        }
    }
}
