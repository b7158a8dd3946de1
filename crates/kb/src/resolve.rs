//! What a store knows of a graph: which artefacts are there, and loading them.

use std::any::Any;
use std::sync::{Arc, OnceLock};

use thiserror::Error;

use crate::depot::{TransferError, bring};
use crate::graph::{Dep, Graph, NodeIdx};
use crate::key::{ContentHash, Key};
use crate::kind::{DecodeError, Kind};
use crate::record::KeyRecord;
use crate::store::{Store, StoreError};

/// The artefact of a node: the key that its inputs gave it, and the bytes that came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Known {
    /// Names the computation.
    pub key: Key,
    /// Names the bytes.
    pub content: ContentHash,
}

/// Why an artefact could not be loaded.
#[derive(Debug, Error)]
pub enum LoadError {
    /// The project has no such artefact.
    #[error("the project has no {kind} of {subject}")]
    NotPlanned {
        /// The kind.
        kind: &'static str,
        /// The subject.
        subject: String,
    },
    /// It has not been computed.
    #[error("{0} is not in the knowledge base; compile the specification first")]
    NotBuilt(String),
    /// It cannot be read.
    #[error("{title} cannot be loaded: {error}; compile the specification again")]
    Store {
        /// The artefact.
        title: String,
        /// What is wrong.
        error: Box<StoreError>,
    },
    /// Its bytes cannot be decoded, though they are what was stored.
    #[error("{title} cannot be loaded: {error}")]
    Decode {
        /// The artefact.
        title: String,
        /// What is wrong.
        error: DecodeError,
    },
}

/// A graph with a store: artefacts are verified and decoded when first asked for, and kept.
pub struct Knowledge {
    graph: Arc<Graph>,
    store: Arc<Store>,
    known: Vec<OnceLock<Known>>,
    loaded: Vec<OnceLock<Arc<dyn Any + Send + Sync>>>,
}

impl Knowledge {
    /// Looks up which artefacts of the graph the store has. Reads no artefact; brings those that only a depot has which the
    /// store is [`shared_in`](Store::shared_in).
    pub fn resolve(graph: &Arc<Graph>, store: &Arc<Store>) -> Result<Self, TransferError> {
        let knowledge = Self::unresolved(graph, store);
        for node in graph.indices() {
            if let Some(record) = knowledge.key_record(node) {
                let key = record.key();
                let content = match (store.lookup(&key)?, store.shared()) {
                    (None, Some(depot)) => bring(store, &store.writer()?, depot, &key)?,
                    (content, _) => content,
                };
                if let Some(content) = content {
                    knowledge.settle(node, Known { key, content });
                }
            }
        }
        Ok(knowledge)
    }

    pub(crate) fn unresolved(graph: &Arc<Graph>, store: &Arc<Store>) -> Self {
        let count = graph.nodes().len();
        Self {
            graph: graph.clone(),
            store: store.clone(),
            known: (0..count).map(|_| OnceLock::new()).collect(),
            loaded: (0..count).map(|_| OnceLock::new()).collect(),
        }
    }

    pub(crate) fn settle(&self, node: NodeIdx, known: Known) {
        let set = self.known[node.index()].set(known);
        assert!(set.is_ok(), "a node is settled once");
    }

    /// The graph.
    pub fn graph(&self) -> &Arc<Graph> {
        &self.graph
    }

    /// The store.
    pub fn store(&self) -> &Arc<Store> {
        &self.store
    }

    /// Key and content of a node's artefact, if it has been computed.
    pub fn known(&self, node: NodeIdx) -> Option<Known> {
        self.known[node.index()].get().copied()
    }

    /// What the key of a node is made of; `None` while an input has not been computed.
    pub fn key_record(&self, node: NodeIdx) -> Option<KeyRecord> {
        let node = self.graph.node(node);
        let contents: Option<Vec<ContentHash>> =
            node.inputs.iter().map(|&input| self.known(input).map(|known| known.content)).collect();
        Some(node.key_record(&contents?))
    }

    /// The nodes that have not been computed, inputs first.
    pub fn missing(&self) -> Vec<NodeIdx> {
        self.graph.indices().filter(|&node| self.known(node).is_none()).collect()
    }

    /// The artefact of kind `K` about a subject.
    pub fn load<K: Kind>(&self, subject: &K::Subject) -> Result<Arc<K::Artefact>, LoadError> {
        let dep = self.graph.find::<K>(subject).ok_or_else(|| {
            let subject = crate::project::Subject::label(subject, self.graph.project());
            LoadError::NotPlanned { kind: K::NAME, subject }
        })?;
        self.load_node(&dep)
    }

    /// The artefact of a node.
    pub fn load_node<K: Kind>(&self, dep: &Dep<K>) -> Result<Arc<K::Artefact>, LoadError> {
        let slot = &self.loaded[dep.node().index()];
        let artefact = match slot.get() {
            Some(artefact) => artefact.clone(),
            None => {
                // Two threads may decode the same artefact at once; both then use the first.
                let decoded = self.decode(dep.node())?;
                slot.get_or_init(|| decoded).clone()
            }
        };
        Ok(artefact.downcast().expect("a node holds an artefact of its own kind"))
    }

    fn decode(&self, node: NodeIdx) -> Result<Arc<dyn Any + Send + Sync>, LoadError> {
        let title = || self.graph.node(node).title();
        let known = self.known(node).ok_or_else(|| LoadError::NotBuilt(title()))?;
        let bytes = self
            .store
            .read(&known.content)
            .map_err(|error| LoadError::Store { title: title(), error: Box::new(error) })?;
        let decoded = self.graph.node(node).kind.decode(&bytes);
        decoded.map_err(|error| LoadError::Decode { title: title(), error })
    }
}
