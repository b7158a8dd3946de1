//! Why an artefact was computed: what differs between two keys.

use std::fmt;

use crate::graph::{Graph, NodeIdx};
use crate::key::Key;
use crate::record::{KeyRecord, Part};
use crate::resolve::Knowledge;
use crate::store::{Store, StoreError};

/// Why an artefact has to be computed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Reason {
    /// Nothing of this kind is known about this subject.
    First,
    /// These parts of the key differ from when it was last computed for this subject.
    Changed(Vec<Change>),
    /// It was computed before, but its bytes are gone.
    Gone,
    /// It was computed before, but its bytes are damaged.
    Damaged,
}

/// One difference between two keys.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Change {
    /// What differs, such as `limits of joint_3`.
    pub what: String,
    /// Value before and after, where they are short enough to show.
    pub values: Option<(String, String)>,
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.values {
            None => f.write_str(&self.what),
            Some((before, after)) => write!(f, "{} {before} -> {after}", self.what),
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::First => f.write_str("never computed for this subject"),
            Self::Gone => f.write_str("its bytes are gone"),
            Self::Damaged => f.write_str("its bytes were damaged"),
            Self::Changed(changes) => {
                const SHOWN: usize = 4;
                let list: Vec<String> = changes.iter().take(SHOWN).map(Change::to_string).collect();
                write!(f, "changed: {}", list.join(", "))?;
                match changes.len().saturating_sub(SHOWN) {
                    0 => Ok(()),
                    more => write!(f, ", and {more} more"),
                }
            }
        }
    }
}

/// What differs between two keys of the same kind, in the order of the new one; what was removed comes last.
pub fn changes(before: &KeyRecord, now: &KeyRecord) -> Vec<Change> {
    let mut found = Vec::new();
    let mut number = |what: &str, before: String, now: String| {
        if before != now {
            found.push(Change { what: what.to_owned(), values: Some((before, now)) });
        }
    };
    let target = |record: &KeyRecord| record.target.clone().unwrap_or_else(|| "any".to_owned());
    number("format of the kind", before.format.to_string(), now.format.to_string());
    number("algorithm of the kind", before.algorithm.to_string(), now.algorithm.to_string());
    number("target", target(before), target(now));

    // Parts that are equal but for their names are not changes.
    let mut old: Vec<&Part> = before.parts.iter().collect();
    let mut new: Vec<&Part> = Vec::new();
    for part in &now.parts {
        let same = |o: &&Part| o.source == part.source && o.role == part.role && o.digest == part.digest;
        match old.iter().position(same) {
            Some(i) => drop(old.remove(i)),
            None => new.push(part),
        }
    }
    for part in new {
        let same_name = |o: &&Part| o.source == part.source && o.role == part.role && o.name == part.name;
        let values = old.iter().position(same_name).map(|i| old.remove(i)).map(|o| (&o.shown, &part.shown));
        found.push(match values {
            Some((Some(before), Some(now))) => {
                Change { what: part.label(), values: Some((before.clone(), now.clone())) }
            }
            Some(_) => Change { what: part.label(), values: None },
            None => Change { what: format!("{} added", part.label()), values: None },
        });
    }
    found.extend(old.iter().map(|o| Change { what: format!("{} removed", o.label()), values: None }));
    if found.is_empty() && before.key() != now.key() {
        found.push(Change { what: "order of the parts".to_owned(), values: None });
    }
    found
}

/// Why a node whose key is `now` and is not in the store has to be computed.
pub(crate) fn reason(store: &Store, subject: &str, now: &KeyRecord) -> Result<Reason, StoreError> {
    let before = match store.latest(&now.kind, subject)? {
        Some(key) => store.record(&key)?,
        None => None,
    };
    Ok(before.map_or(Reason::First, |before| Reason::Changed(changes(&before, now))))
}

/// What compiling would do with a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fate {
    /// It is there; with the key, and why it was computed.
    Reused(Key, String),
    /// It would be computed, for this reason.
    Computed(Reason),
    /// An input would be computed first; should that give the same bytes as before, the node is reused.
    Waits(NodeIdx),
}

/// What compiling would do with each node of a graph, inputs first. Contents are read and verified.
pub fn explain(knowledge: &Knowledge) -> Result<Vec<Fate>, StoreError> {
    let (graph, store) = (knowledge.graph(), knowledge.store());
    let mut fates: Vec<Fate> = Vec::new();
    let reasons = store.list()?;
    for node in graph.indices() {
        fates.push(fate(knowledge, graph, store, &reasons, &fates, node)?);
    }
    Ok(fates)
}

fn fate(
    knowledge: &Knowledge,
    graph: &Graph,
    store: &Store,
    listed: &[crate::store::Listed],
    fates: &[Fate],
    node: NodeIdx,
) -> Result<Fate, StoreError> {
    let inputs = &graph.node(node).inputs;
    let computed = |input: &&NodeIdx| !matches!(fates[input.index()], Fate::Reused(..));
    if let Some(&input) = inputs.iter().find(computed) {
        return Ok(Fate::Waits(input));
    }
    let Some(known) = knowledge.known(node) else {
        let record = knowledge.key_record(node).expect("all inputs of the node are known");
        return Ok(Fate::Computed(reason(store, &graph.node(node).subjects[0], &record)?));
    };
    match store.read(&known.content) {
        Ok(_) => {
            let why = listed.iter().find(|l| l.key == known.key).map_or("", |l| &l.reason);
            Ok(Fate::Reused(known.key, why.to_owned()))
        }
        Err(StoreError::Missing(_)) => Ok(Fate::Computed(Reason::Gone)),
        Err(StoreError::Damaged(_)) => Ok(Fate::Computed(Reason::Damaged)),
        Err(error) => Err(error),
    }
}
