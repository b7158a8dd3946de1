//! `robotc.lock`: which artefacts specifications have, for people to commit and compare.
//!
//! A section for each specification, headed by its path in brackets, with one line for each of its artefacts: kind,
//! subject, key and content, separated by spaces and sorted. A section is what the last compilation of its specification
//! gave, no more: artefacts that are gone from it are gone from the lock. Since every line holds the content of an
//! artefact, the keys of a whole graph follow from a section alone: [`Locked::differences`] needs no store and computes
//! nothing.

use std::collections::BTreeMap;
use std::fmt;
use std::fmt::Write as _;

use thiserror::Error;

use crate::graph::Graph;
use crate::key::{ContentHash, Key};
use crate::resolve::{Knowledge, Known};

const HEADER: &str = "# Artefacts of the knowledge base: kind, subject, key, content. Written by `robotc compile`; commit it.\n";

/// The sections of a lock file, by the path of their specification.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LockFile {
    sections: BTreeMap<String, Locked>,
}

/// The artefacts of one specification, by kind and subject.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Locked {
    lines: BTreeMap<(String, String), Known>,
}

/// A line that is not one of a lock file.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
#[error("line {line} is neither `[specification]` nor `kind subject key content` below one")]
pub struct LockError {
    /// Number of the line, from 1.
    pub line: usize,
}

/// One difference between a section and its specification as it is now.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Difference {
    /// The kind.
    pub kind: String,
    /// The subject.
    pub subject: String,
    /// What is different.
    pub drift: Drift,
}

/// What is different about an artefact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Drift {
    /// The section does not have it.
    New,
    /// The specification does not have it any more.
    Gone,
    /// What it is computed from changed.
    Key {
        /// In the section.
        before: Key,
        /// Of the specification.
        now: Key,
    },
    /// It was computed from the same and came out different.
    Content {
        /// In the section.
        before: ContentHash,
        /// As it was computed.
        now: ContentHash,
    },
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}: ", self.kind, self.subject)?;
        match self.drift {
            Drift::New => f.write_str("new"),
            Drift::Gone => f.write_str("gone"),
            Drift::Key { before, now } => write!(f, "key {} -> {}", before.short(), now.short()),
            Drift::Content { before, now } => {
                write!(f, "same key, but content {} -> {}", before.short(), now.short())
            }
        }
    }
}

impl LockFile {
    /// Reads a lock file.
    pub fn parse(text: &str) -> Result<Self, LockError> {
        let mut sections: BTreeMap<String, Locked> = BTreeMap::new();
        let mut open: Option<&mut Locked> = None;
        for (number, line) in text.lines().enumerate() {
            if line.trim().is_empty() || line.starts_with('#') {
                continue;
            }
            if let Some(path) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
                open = Some(sections.entry(path.to_owned()).or_default());
                continue;
            }
            let wrong = LockError { line: number + 1 };
            let (subject, known) = parse_line(line).ok_or(wrong.clone())?;
            open.as_mut().ok_or(wrong)?.lines.insert(subject, known);
        }
        Ok(Self { sections })
    }

    /// The text of the file.
    pub fn to_text(&self) -> String {
        let mut text = HEADER.to_owned();
        for (path, section) in &self.sections {
            write!(text, "\n[{path}]\n{section}").expect("a string takes all text");
        }
        text
    }

    /// What is locked for a specification.
    pub fn section(&self, path: &str) -> Option<&Locked> {
        self.sections.get(path)
    }

    /// Locks these artefacts for a specification, instead of what it had before.
    pub fn set(&mut self, path: &str, artefacts: Locked) {
        self.sections.insert(path.to_owned(), artefacts);
    }

    /// Drops the sections whose path `keep` refuses, and returns these paths.
    pub fn prune(&mut self, keep: impl Fn(&str) -> bool) -> Vec<String> {
        let gone: Vec<String> = self.sections.keys().filter(|path| !keep(path)).cloned().collect();
        self.sections.retain(|path, _| !gone.contains(path));
        gone
    }

    /// All keys: roots of what must be kept.
    pub fn keys(&self) -> Vec<Key> {
        self.sections.values().flat_map(Locked::keys).collect()
    }
}

impl Locked {
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

    /// How the keys of `graph` differ from those locked; none when a compilation would compute what was locked. Nothing
    /// is read and nothing computed: contents are taken from the section. What is computed from an artefact that
    /// differs is left out, since its key is not known before that is computed.
    pub fn differences(&self, graph: &Graph) -> Vec<Difference> {
        let mut found = Vec::new();
        let mut contents: Vec<Option<ContentHash>> = Vec::new();
        let mut seen = std::collections::BTreeSet::new();
        for node in graph.nodes() {
            let inputs: Option<Vec<ContentHash>> =
                node.inputs.iter().map(|input| contents[input.index()]).collect();
            let now = inputs.map(|inputs| node.key_record(&inputs).key());
            let mut content = None;
            for subject in &node.subjects {
                let line = (node.kind_name().to_owned(), subject.clone());
                let drift = match (self.lines.get(&line), now) {
                    (None, _) => Some(Drift::New),
                    (Some(_), None) => None,
                    (Some(known), Some(now)) if known.key == now => {
                        content = Some(known.content);
                        None
                    }
                    (Some(known), Some(now)) => Some(Drift::Key { before: known.key, now }),
                };
                found.extend(drift.map(|drift| Difference::of(&line, drift)));
                seen.insert(line);
            }
            contents.push(content);
        }
        let gone = self.lines.keys().filter(|line| !seen.contains(line));
        found.extend(gone.map(|line| Difference::of(line, Drift::Gone)));
        found
    }

    /// How `now`, which was computed, differs from this.
    pub fn changes(&self, now: &Self) -> Vec<Difference> {
        let mut found = Vec::new();
        for (line, after) in &now.lines {
            let drift = match self.lines.get(line) {
                None => Drift::New,
                Some(before) if before == after => continue,
                Some(before) if before.key == after.key => {
                    Drift::Content { before: before.content, now: after.content }
                }
                Some(before) => Drift::Key { before: before.key, now: after.key },
            };
            found.push(Difference::of(line, drift));
        }
        let gone = self.lines.keys().filter(|line| !now.lines.contains_key(line));
        found.extend(gone.map(|line| Difference::of(line, Drift::Gone)));
        found
    }

    /// All keys, by kind and subject.
    pub fn keys(&self) -> Vec<Key> {
        self.lines.values().map(|known| known.key).collect()
    }
}

impl fmt::Display for Locked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for ((kind, subject), known) in &self.lines {
            writeln!(f, "{kind} {subject} {} {}", known.key, known.content)?;
        }
        Ok(())
    }
}

impl Difference {
    fn of((kind, subject): &(String, String), drift: Drift) -> Self {
        Self { kind: kind.clone(), subject: subject.clone(), drift }
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

    fn known(key: u8, content: u8) -> Known {
        Known { key: Key::from_bytes([key; 32]), content: ContentHash::from_bytes([content; 32]) }
    }

    fn section(lines: &[(&str, &str, u8, u8)]) -> Locked {
        let line = |&(kind, subject, key, content): &(&str, &str, u8, u8)| {
            ((kind.into(), subject.into()), known(key, content))
        };
        Locked { lines: lines.iter().map(line).collect() }
    }

    #[test]
    fn the_text_reads_back() {
        let mut file = LockFile::default();
        file.set("tasks/b c.task.toml", section(&[("ik", "robot/arm", 1, 2), ("grasps", "hand+mug", 2, 3)]));
        file.set("a.robot.toml", section(&[("ik", "robot/arm", 1, 2)]));
        assert_eq!(LockFile::parse(&file.to_text()), Ok(file));
        for bad in ["ik arm", "ik arm xyz abc", "a b c d e", "[half"] {
            let text = format!("[a.robot.toml]\n# comment\n\n{bad}\n");
            assert_eq!(LockFile::parse(&text), Err(LockError { line: 4 }), "{bad}");
        }
        let line = section(&[("ik", "a", 1, 2)]).to_string();
        assert_eq!(LockFile::parse(&line), Err(LockError { line: 1 }), "a line outside of a section");
    }

    #[test]
    fn sections_are_replaced_whole_and_pruned() {
        let mut file = LockFile::default();
        file.set("a", section(&[("ik", "a", 1, 2), ("ik", "b", 2, 3)]));
        file.set("b", section(&[("ik", "a", 1, 2)]));
        file.set("a", section(&[("ik", "b", 9, 3)]));
        assert_eq!(file.section("a"), Some(&section(&[("ik", "b", 9, 3)])));
        assert_eq!(file.prune(|path| path == "a"), ["b"]);
        assert_eq!(file.keys(), [Key::from_bytes([9; 32])]);
    }

    #[test]
    fn changes_are_named() {
        let old = section(&[("ik", "a", 1, 1), ("ik", "b", 2, 2), ("ik", "c", 3, 3), ("ik", "d", 4, 4)]);
        let new = section(&[("ik", "a", 1, 1), ("ik", "b", 2, 9), ("ik", "c", 8, 3), ("ik", "e", 5, 5)]);
        let found: Vec<String> = old.changes(&new).iter().map(Difference::to_string).collect();
        let expected = [
            "ik b: same key, but content 020202020202 -> 090909090909",
            "ik c: key 030303030303 -> 080808080808",
            "ik e: new",
            "ik d: gone",
        ];
        assert_eq!(found, expected);
        assert!(new.changes(&new).is_empty());
    }
}
