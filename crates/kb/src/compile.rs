//! Computing what a graph lacks.
//!
//! Nodes whose inputs are known run in parallel on rayon's pool. Each artefact is checked and stored as soon as it is
//! computed, so that an interrupted run is resumed by the next. One process computes at a time; another waits, and
//! then finds most of its work done.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use crate::context::{Context, Shard};
use crate::depot::{Depot, bring, offer, pieces};
use crate::explain::{Reason, reason};
use crate::graph::{Graph, NodeIdx};
use crate::observer::{BuildError, Event, Observer};
use crate::record::KeyRecord;
use crate::resolve::{Knowledge, Known};
use crate::store::{NewArtefact, Store, StoreError, Writer};

/// The program, as artefacts record it.
const PROVENANCE: &str = concat!("robotc ", env!("CARGO_PKG_VERSION"));

/// What became of a node.
#[derive(Debug)]
pub enum Outcome {
    /// It was there.
    Reused,
    /// It was computed.
    Built(Reason),
    /// It could not be computed.
    Failed(BuildError),
    /// An input could not be computed.
    Blocked(NodeIdx),
    /// The caller asked to stop before its turn came.
    Cancelled,
}

/// What compiling did.
pub struct CompileReport {
    /// What became of each node, in the order of the graph.
    pub outcomes: Vec<Outcome>,
    /// The artefacts, for loading.
    pub knowledge: Knowledge,
}

impl CompileReport {
    /// Whether everything is known.
    pub fn complete(&self) -> bool {
        self.outcomes.iter().all(|o| matches!(o, Outcome::Reused | Outcome::Built(_)))
    }

    /// The nodes that were computed, with the reasons.
    pub fn built(&self) -> impl Iterator<Item = (NodeIdx, &Reason)> {
        self.knowledge.graph().indices().zip(&self.outcomes).filter_map(|(node, outcome)| match outcome {
            Outcome::Built(reason) => Some((node, reason)),
            _ => None,
        })
    }

    /// The nodes that could not be computed, with the errors.
    pub fn failed(&self) -> impl Iterator<Item = (NodeIdx, &BuildError)> {
        self.knowledge.graph().indices().zip(&self.outcomes).filter_map(|(node, outcome)| match outcome {
            Outcome::Failed(error) => Some((node, error)),
            _ => None,
        })
    }
}

/// Computes every artefact of `graph` that `store` lacks, or holds damaged.
///
/// A node that fails does not stop others that do not need it. The error is one of the store as a whole.
pub fn compile(
    graph: &Arc<Graph>,
    store: &Arc<Store>,
    observer: &dyn Observer,
) -> Result<CompileReport, StoreError> {
    let knowledge = Knowledge::unresolved(graph, store);
    let mut outcomes: Vec<OnceLock<Outcome>> = graph.nodes().iter().map(|_| OnceLock::new()).collect();
    for node in graph.indices() {
        if let Some(record) = knowledge.key_record(node)
            && let Found::Whole(known) = find(store, &record)?
        {
            knowledge.settle(node, known);
            outcomes[node.index()] = Outcome::Reused.into();
        }
    }
    if outcomes.iter().any(|outcome| outcome.get().is_none()) {
        let writer = match store.try_writer()? {
            Some(writer) => writer,
            None => {
                observer.event(Event::Waiting);
                store.writer()?
            }
        };
        Run { knowledge: &knowledge, observer, writer, outcomes: &outcomes }.compute();
    }
    remember(&knowledge)?;
    let settled = |outcome: OnceLock<Outcome>| outcome.into_inner().unwrap_or(Outcome::Cancelled);
    Ok(CompileReport { outcomes: outcomes.into_iter().map(settled).collect(), knowledge })
}

/// Records which keys are now in use for the subjects of the graph.
fn remember(knowledge: &Knowledge) -> Result<(), StoreError> {
    let (graph, store) = (knowledge.graph(), knowledge.store());
    let mut changed = Vec::new();
    for (index, node) in graph.indices().zip(graph.nodes()) {
        let Some(known) = knowledge.known(index) else { continue };
        for subject in &node.subjects {
            if store.latest(node.kind_name(), subject)? != Some(known.key) {
                changed.push((node.kind_name(), subject.as_str(), known.key));
            }
        }
    }
    if changed.is_empty() { Ok(()) } else { store.set_latest(&changed) }
}

/// What a store has under a key.
enum Found {
    Whole(Known),
    Gone,
    Damaged,
    Nothing,
}

fn find(store: &Store, record: &KeyRecord) -> Result<Found, StoreError> {
    let key = record.key();
    let Some(content) = store.lookup(&key)? else { return Ok(Found::Nothing) };
    match store.read(&content) {
        Ok(_) => Ok(Found::Whole(Known { key, content })),
        Err(StoreError::Missing(_)) => Ok(Found::Gone),
        Err(StoreError::Damaged(_)) => Ok(Found::Damaged),
        Err(error) => Err(error),
    }
}

/// The nodes of a graph that are being computed.
struct Run<'a> {
    knowledge: &'a Knowledge,
    observer: &'a dyn Observer,
    writer: Writer,
    outcomes: &'a [OnceLock<Outcome>],
}

impl Run<'_> {
    fn compute(&self) {
        let graph = self.knowledge.graph();
        let open = |node: NodeIdx| self.outcomes[node.index()].get().is_none();
        let mut dependants: Vec<Vec<NodeIdx>> = vec![Vec::new(); graph.nodes().len()];
        let mut waits_for = Vec::new();
        for node in graph.indices() {
            let mut inputs: Vec<NodeIdx> = graph.node(node).inputs.clone();
            inputs.sort();
            inputs.dedup();
            inputs.retain(|&input| open(input));
            for input in &inputs {
                dependants[input.index()].push(node);
            }
            waits_for.push(AtomicUsize::new(inputs.len()));
        }
        rayon::scope(|scope| {
            let ready =
                graph.indices().filter(|&n| open(n) && waits_for[n.index()].load(Ordering::Relaxed) == 0);
            // Collected first: nodes that finish meanwhile would otherwise be seen twice.
            for node in ready.collect::<Vec<_>>() {
                self.spawn(scope, node, &dependants, &waits_for);
            }
        });
    }

    fn spawn<'s>(
        &'s self,
        scope: &rayon::Scope<'s>,
        node: NodeIdx,
        dependants: &'s [Vec<NodeIdx>],
        waits_for: &'s [AtomicUsize],
    ) {
        scope.spawn(move |scope| {
            if self.observer.cancelled() {
                return;
            }
            let outcome = self.settle(node);
            let set = self.outcomes[node.index()].set(outcome);
            assert!(set.is_ok(), "a node is computed once");
            for &dependant in &dependants[node.index()] {
                if waits_for[dependant.index()].fetch_sub(1, Ordering::AcqRel) == 1 {
                    self.spawn(scope, dependant, dependants, waits_for);
                }
            }
        });
    }

    fn settle(&self, index: NodeIdx) -> Outcome {
        let graph = self.knowledge.graph();
        let node = graph.node(index);
        if let Some(&input) = node.inputs.iter().find(|&&input| self.knowledge.known(input).is_none()) {
            return Outcome::Blocked(input);
        }
        let (kind, subject) = (node.kind_name(), node.subjects[0].as_str());
        let depot = self.knowledge.store();
        let built =
            build_node(self.knowledge, index, &**depot, Shard::WHOLE, self.observer, || Ok(&self.writer));
        match built {
            Ok(None) => Outcome::Reused,
            Ok(Some(reason)) => Outcome::Built(reason),
            Err(BuildError::Cancelled) => Outcome::Cancelled,
            Err(error) => {
                self.observer.event(Event::Failed { kind, subject, error: &error });
                Outcome::Failed(error)
            }
        }
    }
}

/// Computes and stores the artefact of a node whose inputs are known, or the shard of it that falls to this process.
///
/// `None` when it was there, or in the depot that the store is shared in. The last process to finish its shard puts the pieces together; the others get
/// [`BuildError::Unfinished`]. Pieces are kept in `depot`. `writer` is asked for when there is something to store.
pub fn build_node<W: std::ops::Deref<Target = Writer>>(
    knowledge: &Knowledge,
    index: NodeIdx,
    depot: &dyn Depot,
    shard: Shard,
    observer: &dyn Observer,
    writer: impl Fn() -> Result<W, StoreError>,
) -> Result<Option<Reason>, BuildError> {
    let node = knowledge.graph().node(index);
    let store = knowledge.store();
    let (kind, subject) = (node.kind_name(), node.subjects[0].as_str());
    let record = knowledge.key_record(index).expect("all inputs of the node are known");
    let key = record.key();
    let reason = match find(store, &record)? {
        Found::Whole(known) => {
            knowledge.settle(index, known);
            return Ok(None);
        }
        Found::Gone => Reason::Gone,
        Found::Damaged => Reason::Damaged,
        Found::Nothing => reason(store, subject, &record)?,
    };
    if let Some(shared) = store.shared()
        && let Some(content) = bring(store, &*writer()?, shared, &key)?
    {
        knowledge.settle(index, Known { key, content });
        observer.event(Event::Brought { kind, subject });
        return Ok(None);
    }
    observer.event(Event::Started { kind, subject, reason: &reason });
    let context = Context { knowledge, key, kind, subject, depot, shard, observer };
    let bytes = node.kind.build(&*node.work, &context)?;
    let text = reason.to_string();
    let artefact =
        NewArtefact { record: &record, subject, reason: &text, provenance: PROVENANCE, bytes: &bytes };
    if let Some(shared) = store.shared() {
        // First, so that whatever is here is there.
        offer(shared, artefact.archived())?;
    }
    let content = store.publish(&*writer()?, &artefact)?;
    pieces::remove(depot, &key)?;
    knowledge.settle(index, Known { key, content });
    observer.event(Event::Stored { kind, subject, size: bytes.len() });
    Ok(Some(reason))
}
