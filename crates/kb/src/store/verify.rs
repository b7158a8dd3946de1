//! Checking a whole store.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::params;

use super::{NewArtefact, Store, StoreError, Writer, blobs, cards};
use crate::key::{ContentHash, Key};
use crate::record::KeyRecord;

/// Something wrong with a store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Finding {
    /// SQLite finds its file damaged; the text is its own.
    Database(String),
    /// The bytes of an artefact are gone.
    Missing(Key, ContentHash),
    /// The bytes of an artefact are not what their name says.
    Damaged(Key, ContentHash),
    /// What a key is made of does not give the key.
    WrongKey(Key),
    /// The bytes are whole but their kind does not accept them; the text says why.
    Undecodable(Key, String),
    /// The artefact is whole, but has no whole card from which the database could be made again.
    NoCard(Key),
}

impl Finding {
    /// The artefact that the finding is about.
    pub fn key(&self) -> Option<Key> {
        match self {
            Self::Database(_) => None,
            Self::Missing(key, _)
            | Self::Damaged(key, _)
            | Self::WrongKey(key)
            | Self::Undecodable(key, _)
            | Self::NoCard(key) => Some(*key),
        }
    }
}

/// What a check of a store found.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Verification {
    /// What is wrong; empty when the store is whole.
    pub findings: Vec<Finding>,
    /// Number of artefacts checked.
    pub artefacts: usize,
    /// Number of bytes compared with their names.
    pub bytes: u64,
    /// Files that nothing refers to: harmless, left by a crash, removed by a collection of garbage.
    pub leftovers: usize,
}

/// What a repair did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Repair {
    /// Number of cards written again.
    pub cards: usize,
    /// Number of artefacts forgotten.
    pub forgotten: usize,
}

impl Store {
    /// Checks everything: the database, every record against its key, every content against its name, and that its
    /// kind decodes it, where this program has the kind in that format.
    pub fn verify(&self) -> Result<Verification, StoreError> {
        let mut result = Verification::default();
        result.findings.extend(self.check_database()?);
        let mut checked: BTreeMap<ContentHash, Option<Vec<u8>>> = BTreeMap::new();
        for (key, content, record) in self.raw_records()? {
            result.artefacts += 1;
            let record = match KeyRecord::decode(&record) {
                Ok(record) if record.key() == key => record,
                _ => {
                    result.findings.push(Finding::WrongKey(key));
                    continue;
                }
            };
            let bytes = match self.read(&content) {
                Ok(bytes) => bytes,
                Err(StoreError::Missing(_)) => {
                    result.findings.push(Finding::Missing(key, content));
                    continue;
                }
                Err(StoreError::Damaged(_)) => {
                    result.findings.push(Finding::Damaged(key, content));
                    continue;
                }
                Err(error) => return Err(error),
            };
            if checked.insert(content, None).is_none() {
                result.bytes += bytes.len() as u64;
            }
            let kind = crate::kinds::find(&record.kind).filter(|kind| kind.info().format == record.format);
            if let Some(Err(error)) = kind.map(|kind| kind.decode(&bytes)) {
                result.findings.push(Finding::Undecodable(key, error.to_string()));
            } else if cards::read(&self.folder, &key).is_none_or(|card| card.content() != content) {
                result.findings.push(Finding::NoCard(key));
            }
        }
        result.leftovers = self.leftovers()?.len();
        Ok(result)
    }

    /// Mends what [`verify`](Self::verify) found: cards are written again, and artefacts that cannot be used are forgotten,
    /// so that the next compilation makes them again. A damaged database is left to [`rebuild`](Self::rebuild).
    pub fn repair(&self, _writer: &Writer, findings: &[Finding]) -> Result<Repair, StoreError> {
        let mut done = Repair::default();
        let mut unusable = Vec::new();
        for finding in findings {
            match finding {
                Finding::NoCard(key) => {
                    self.write_card(key)?;
                    done.cards += 1;
                }
                other => unusable.extend(other.key()),
            }
        }
        self.forget(&unusable)?;
        done.forgotten = unusable.len();
        Ok(done)
    }

    fn write_card(&self, key: &Key) -> Result<(), StoreError> {
        let listed = self.list()?.into_iter().find(|artefact| artefact.key == *key);
        let (Some(listed), Some(record)) = (listed, self.record(key)?) else { return Ok(()) };
        let bytes = self.read(&listed.content)?;
        let artefact = NewArtefact {
            record: &record,
            subject: &listed.subject,
            reason: &listed.reason,
            provenance: &listed.provenance,
            bytes: &bytes,
        };
        let inline = bytes.len() < blobs::INLINE_BELOW;
        cards::write(&self.folder, &cards::Card::of(&artefact, &listed.content, inline))
    }

    fn forget(&self, keys: &[Key]) -> Result<(), StoreError> {
        let mut connection = self.connection();
        let transaction = connection.transaction()?;
        for key in keys {
            transaction.execute("DELETE FROM artefact WHERE key = ?1", params![key.as_bytes()])?;
        }
        transaction.commit()?;
        Ok(())
    }

    fn check_database(&self) -> Result<Vec<Finding>, StoreError> {
        let connection = self.connection();
        let mut query = connection.prepare("PRAGMA integrity_check")?;
        let lines = query.query_map([], |row| row.get::<_, String>(0))?;
        let mut findings = Vec::new();
        for line in lines {
            match line {
                Ok(line) if line == "ok" => {}
                Ok(line) => findings.push(Finding::Database(line)),
                Err(error) => findings.push(Finding::Database(error.to_string())),
            }
        }
        Ok(findings)
    }

    fn raw_records(&self) -> Result<Vec<(Key, ContentHash, Vec<u8>)>, StoreError> {
        let connection = self.connection();
        let mut query = connection.prepare("SELECT key, content, record FROM artefact ORDER BY key")?;
        let rows = query.query_map([], |row| {
            Ok((Key::from_bytes(row.get(0)?), ContentHash::from_bytes(row.get(1)?), row.get(2)?))
        })?;
        Ok(rows.collect::<Result<_, _>>()?)
    }

    /// Files of the store that its database does not refer to.
    pub(super) fn leftovers(&self) -> Result<Vec<std::path::PathBuf>, StoreError> {
        let named: BTreeSet<ContentHash> = {
            let connection = self.connection();
            let mut query = connection.prepare("SELECT content FROM blob WHERE bytes IS NULL")?;
            let rows = query.query_map([], |row| row.get(0).map(ContentHash::from_bytes))?;
            rows.collect::<Result<_, _>>()?
        };
        let mut found = blobs::temporary(&self.folder)?;
        let stray = |content: &Option<ContentHash>| content.is_none_or(|content| !named.contains(&content));
        let contents = blobs::files(&self.folder, "blobs")?;
        found.extend(contents.into_iter().filter(|(_, content)| stray(content)).map(|(path, _)| path));
        let keys: BTreeSet<Key> = self.list()?.into_iter().map(|artefact| artefact.key).collect();
        let stray = |key: &Option<Key>| key.is_none_or(|key| !keys.contains(&key));
        let cards = blobs::files(&self.folder, cards::SHELVES)?;
        found.extend(cards.into_iter().filter(|(_, key)| stray(key)).map(|(path, _)| path));
        Ok(found)
    }
}
