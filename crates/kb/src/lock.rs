//! `robotc.lock`: which artefacts a set of specifications has, for people to commit and compare.
//!
//! One line per artefact: kind, subject, key and content, separated by spaces and sorted. `compile --locked` fails when a
//! line would change.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use thiserror::Error;

use crate::key::{ContentHash, Key};
use crate::resolve::{Knowledge, Known};

const HEADER: &str = "# Artefacts of the knowledge base: kind, subject, key, content. Written by `robotc compile`; commit it.\n";

/// The lines of a lock file, by kind and subject.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LockFile {
    lines: BTreeMap<(String, String), Known>,
}

/// A line that is not one of a lock file.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
#[error("line {line} is not `kind subject key content`")]
pub struct LockError {
    /// Number of the line, from 1.
    pub line: usize,
}

/// One difference between two lock files.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LockChange {
    /// The kind.
    pub kind: String,
    /// The subject.
    pub subject: String,
    /// Before; `None` when the line is new.
    pub before: Option<Known>,
    /// Now; `None` when the line is gone.
    pub now: Option<Known>,
}

impl LockFile {
    /// Reads a lock file.
    pub fn parse(text: &str) -> Result<Self, LockError> {
        let mut lines = BTreeMap::new();
        for (number, line) in text.lines().enumerate() {
            if line.trim().is_empty() || line.starts_with('#') {
                continue;
            }
            let (subject, known) = parse_line(line).ok_or(LockError { line: number + 1 })?;
            lines.insert(subject, known);
        }
        Ok(Self { lines })
    }

    /// The text of the file.
    pub fn to_text(&self) -> String {
        let mut text = HEADER.to_owned();
        for ((kind, subject), known) in &self.lines {
            writeln!(text, "{kind} {subject} {} {}", known.key, known.content)
                .expect("a string takes all text");
        }
        text
    }

    /// The artefacts of one graph.
    pub fn of(knowledge: &Knowledge) -> Self {
        let graph = knowledge.graph();
        let mut lines = BTreeMap::new();
        for (index, node) in graph.indices().zip(graph.nodes()) {
            for subject in &node.subjects {
                if let Some(known) = knowledge.known(index) {
                    lines.insert((node.kind_name().to_owned(), subject.clone()), known);
                }
            }
        }
        Self { lines }
    }

    /// These lines, replaced and completed by those of `newer`. Lines of other specifications stay.
    pub fn updated(&self, newer: &Self) -> Self {
        let mut lines = self.lines.clone();
        lines.extend(newer.lines.clone());
        Self { lines }
    }

    /// What `newer` changes or adds.
    pub fn changes(&self, newer: &Self) -> Vec<LockChange> {
        let updated = self.updated(newer);
        let changed = |((kind, subject), now): (&(String, String), &Known)| {
            let before = self.lines.get(&(kind.clone(), subject.clone())).copied();
            let change = LockChange { kind: kind.clone(), subject: subject.clone(), before, now: Some(*now) };
            (before != Some(*now)).then_some(change)
        };
        updated.lines.iter().filter_map(changed).collect()
    }

    /// All keys: roots of what must be kept.
    pub fn keys(&self) -> Vec<Key> {
        self.lines.values().map(|known| known.key).collect()
    }

    /// Whether there is no line.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }
}

fn parse_line(line: &str) -> Option<((String, String), Known)> {
    let mut words = line.split(' ');
    let (kind, subject) = (words.next()?, words.next()?);
    let key: Key = words.next()?.parse().ok()?;
    let content: ContentHash = words.next()?.parse().ok()?;
    let complete = words.next().is_none() && !kind.is_empty() && !subject.is_empty();
    complete.then(|| ((kind.to_owned(), subject.to_owned()), Known { key, content }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(byte: u8) -> Known {
        Known { key: Key::from_bytes([byte; 32]), content: ContentHash::from_bytes([byte + 1; 32]) }
    }

    fn lock(lines: &[(&str, &str, u8)]) -> LockFile {
        let line = |&(kind, subject, byte): &(&str, &str, u8)| ((kind.into(), subject.into()), known(byte));
        LockFile { lines: lines.iter().map(line).collect() }
    }

    #[test]
    fn the_text_reads_back() {
        let file = lock(&[("ik", "robot/arm", 1), ("grasps", "hand+mug", 2)]);
        assert_eq!(LockFile::parse(&file.to_text()), Ok(file));
        for bad in ["ik arm", "ik arm xyz abc", "  ", "a b c d e"] {
            let text = format!("# comment\n{bad}\n");
            let expected =
                if bad.trim().is_empty() { Ok(LockFile::default()) } else { Err(LockError { line: 2 }) };
            assert_eq!(LockFile::parse(&text), expected, "{bad}");
        }
    }

    #[test]
    fn lines_of_other_specifications_stay() {
        let old = lock(&[("ik", "a", 1), ("ik", "b", 2)]);
        let new = lock(&[("ik", "b", 3), ("ik", "c", 4)]);
        assert_eq!(old.updated(&new), lock(&[("ik", "a", 1), ("ik", "b", 3), ("ik", "c", 4)]));
        let subjects: Vec<String> = old.changes(&new).into_iter().map(|c| c.subject).collect();
        assert_eq!(subjects, ["b", "c"]);
        assert!(new.changes(&new).is_empty());
    }
}
