//! Why an artefact was computed: what differs between two keys.

use std::fmt;

use crate::graph::{Graph, NodeIdx};
use crate::key::Key;
use crate::record::{KeyRecord, Part, Source};
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
        // A parameter is the same wherever its value comes from.
        let named = |o: &Part| part.source == Source::Parameter || o.name == part.name;
        let same_name = |o: &&Part| o.source == part.source && o.role == part.role && named(o);
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

#[cfg(test)]
mod tests {
    use super::*;

    fn part(source: Source, role: &str, name: &str, digest: u8) -> Part {
        let shown = (source == Source::Parameter).then(|| format!("0.{digest}"));
        Part { source, role: role.into(), name: name.into(), shown, digest: [digest; 32] }
    }

    fn record() -> KeyRecord {
        KeyRecord {
            kind: "grasp_set".into(),
            format: 1,
            algorithm: 2,
            target: None,
            parts: vec![
                part(Source::Specification, "limits", "joint_3", 1),
                part(Source::Parameter, "friction", "", 4),
                part(Source::Artefact, "convex_parts", "robot/link", 5),
            ],
        }
    }

    #[test]
    fn every_difference_changes_the_key_and_is_named() {
        let cases: &[(fn(&mut KeyRecord), &[&str])] = &[
            (|_| {}, &[]),
            (|r| r.format = 2, &["format of the kind 1 -> 2"]),
            (|r| r.algorithm = 3, &["algorithm of the kind 2 -> 3"]),
            (|r| r.target = Some("x".into()), &["target any -> x"]),
            (|r| r.parts[0].digest = [9; 32], &["limits of joint_3"]),
            (|r| r.parts[1] = part(Source::Parameter, "friction", "", 5), &["parameter friction 0.4 -> 0.5"]),
            (
                |r| r.parts[1] = part(Source::Parameter, "friction", "kitchen/mug", 5),
                &["friction of kitchen/mug 0.4 -> 0.5"],
            ),
            (|r| r.parts[2].digest = [9; 32], &["convex_parts of robot/link"]),
            (|r| drop(r.parts.remove(0)), &["limits of joint_3 removed"]),
            (
                |r| r.parts.push(part(Source::Specification, "limits", "joint_4", 7)),
                &["limits of joint_4 added"],
            ),
            (|r| r.parts.swap(0, 1), &["order of the parts"]),
        ];
        for (edit, expected) in cases {
            let mut now = record();
            edit(&mut now);
            let found: Vec<String> = changes(&record(), &now).iter().map(Change::to_string).collect();
            assert_eq!(found, *expected);
            assert_eq!(record().key() == now.key(), expected.is_empty());
            assert_eq!(record().recipe() == now.recipe(), expected.is_empty());
        }
    }

    #[test]
    fn names_are_not_part_of_the_key() {
        let mut renamed = record();
        renamed.parts[0].name = "elbow".into();
        assert_eq!(record().key(), renamed.key());
        assert!(changes(&record(), &renamed).is_empty());
    }
}
