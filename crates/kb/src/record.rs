//! What a key was made of: labelled hashes, kept beside the artefact so that a rebuild can be explained.

use serde::{Deserialize, Serialize};

use crate::codec::{self, DecodeError};
use crate::key::{Canonical, Key, KeyHasher, NotFinite, RecipeId};

/// Where a part of a key comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Source {
    /// A projection of the robot or the task.
    Specification,
    /// A parameter of the kind.
    Parameter,
    /// Another artefact.
    Artefact,
}

/// A labelled part of a key.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// Where it comes from.
    pub source: Source,
    /// What it is, such as `limits`; part of the key.
    pub role: String,
    /// What people call it, such as the name of a joint, or of the object that a parameter's value comes from; not part of the key, so that renaming rebuilds nothing.
    pub name: String,
    /// The value, when it is short enough to show; not part of the key.
    pub shown: Option<String>,
    /// Hash of the value, the recipe or the content.
    pub digest: [u8; 32],
}

impl Part {
    /// `limits of joint_3`, `parameter rolls`, `friction of kitchen/mug`, `convex_parts of panda/link_2`.
    pub fn label(&self) -> String {
        match (self.source, self.name.as_str()) {
            (Source::Parameter, "") => format!("parameter {}", self.role),
            (_, "") => self.role.clone(),
            (_, name) => format!("{} of {name}", self.role),
        }
    }
}

/// Collects the parts of a specification that an artefact reads.
#[derive(Debug, Default)]
pub struct Parts {
    items: Vec<Part>,
    refused: Option<String>,
}

impl Parts {
    /// Adds a value. `role` says what it is and is hashed; `name` is for people and is not.
    pub fn add<T: Canonical + ?Sized>(&mut self, role: &'static str, name: impl Into<String>, value: &T) {
        let name = name.into();
        match digest(value) {
            Ok(digest) => {
                let source = Source::Specification;
                self.items.push(Part { source, role: role.to_owned(), name, shown: None, digest });
            }
            Err(NotFinite) => {
                self.refused.get_or_insert(format!("{role} of {name}"));
            }
        }
    }

    /// The parts, or the label of the first that holds a number which is not finite.
    pub(crate) fn finish(self) -> Result<Vec<Part>, String> {
        match self.refused {
            None => Ok(self.items),
            Some(label) => Err(label),
        }
    }
}

/// The hash of one value of a key.
pub(crate) fn digest<T: Canonical + ?Sized>(value: &T) -> Result<[u8; 32], NotFinite> {
    KeyHasher::new("robotc kb 1 part").add(value).finish()
}

/// All that a key is made of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyRecord {
    /// Name of the kind.
    pub kind: String,
    /// Its format.
    pub format: u32,
    /// Its algorithm revision.
    pub algorithm: u32,
    /// Processor and system, for kinds whose bytes depend on them.
    pub target: Option<String>,
    /// Specification, then parameters, then artefacts; each in the order of the kind.
    pub parts: Vec<Part>,
}

impl KeyRecord {
    /// The key, when the artefact parts hold content hashes.
    pub fn key(&self) -> Key {
        Key::from_bytes(self.hash("robotc kb 1 action key"))
    }

    /// The recipe id, when the artefact parts hold recipe ids.
    pub fn recipe(&self) -> RecipeId {
        RecipeId::from_bytes(self.hash("robotc kb 1 recipe id"))
    }

    fn hash(&self, domain: &'static str) -> [u8; 32] {
        let mut hasher = KeyHasher::new(domain);
        hasher.add(&self.kind).add(&self.format).add(&self.algorithm).add(&self.target);
        hasher.sequence(self.parts.len());
        for part in &self.parts {
            let source: u32 = match part.source {
                Source::Specification => 0,
                Source::Parameter => 1,
                Source::Artefact => 2,
            };
            hasher.add(&source).add(&part.role).bytes(&part.digest);
        }
        hasher.finish().expect("a record holds hashes and words, no numbers")
    }

    /// The stored form.
    pub fn encode(&self) -> Vec<u8> {
        codec::encode(self)
    }

    /// The record of a stored form.
    pub fn decode(bytes: &[u8]) -> Result<Self, DecodeError> {
        codec::decode(bytes)
    }
}
