//! Checking a whole store.

use std::collections::BTreeMap;

use rusqlite::params;

use super::{Store, StoreError, Writer, blobs};
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
}

impl Finding {
    /// The artefact that the finding is about.
    pub fn key(&self) -> Option<Key> {
        match self {
            Self::Database(_) => None,
            Self::Missing(key, _)
            | Self::Damaged(key, _)
            | Self::WrongKey(key)
            | Self::Undecodable(key, _) => Some(*key),
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
            }
        }
        result.leftovers = self.leftovers()?.len();
        Ok(result)
    }

    /// Forgets artefacts that cannot be used, so that the next compilation makes them again.
    pub fn forget(&self, _writer: &Writer, keys: &[Key]) -> Result<(), StoreError> {
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
        let named: std::collections::BTreeSet<ContentHash> = {
            let connection = self.connection();
            let mut query = connection.prepare("SELECT content FROM blob WHERE bytes IS NULL")?;
            let rows = query.query_map([], |row| row.get(0).map(ContentHash::from_bytes))?;
            rows.collect::<Result<_, _>>()?
        };
        let mut found = blobs::temporary(&self.folder)?;
        for (path, content) in blobs::files(&self.folder)? {
            if content.is_none_or(|content| !named.contains(&content)) {
                found.push(path);
            }
        }
        Ok(found)
    }
}
