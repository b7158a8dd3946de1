//! Artefacts out of a store into an [`Archive`], and back.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::params;

use super::{Archive, ArchiveError, Archived, Listed, NewArtefact, Store, StoreError, Writer, garbage};
use crate::key::{ContentHash, Key};

/// What an export or an import moved.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Transfer {
    /// Number of artefacts.
    pub artefacts: usize,
    /// Of these, those that the store did not have.
    pub new: usize,
    /// Bytes of their contents.
    pub bytes: u64,
}

impl Store {
    /// The artefacts of these keys with all that they were computed from, or everything when `roots` is `None`.
    pub fn export(&self, roots: Option<&[Key]>) -> Result<(Vec<u8>, Transfer), StoreError> {
        let all = self.list()?;
        let wanted: BTreeSet<Key> = match roots {
            None => all.iter().map(|a| a.key).collect(),
            Some(roots) => {
                let mut open = roots.to_vec();
                let mut wanted = BTreeSet::new();
                while let Some(key) = open.pop() {
                    if let Some(record) = self.record(&key)?
                        && wanted.insert(key)
                    {
                        let inputs = garbage::inputs(&record);
                        open.extend(all.iter().filter(|a| inputs.contains(&a.content)).map(|a| a.key));
                    }
                }
                wanted
            }
        };
        self.pack(&wanted)
    }

    /// The artefacts of exactly these keys, those that the store has.
    pub fn pack(&self, keys: &BTreeSet<Key>) -> Result<(Vec<u8>, Transfer), StoreError> {
        let artefacts = self.gather(keys)?;
        let contents: BTreeMap<ContentHash, u64> =
            artefacts.iter().map(|a| (ContentHash::of(&a.bytes), a.bytes.len() as u64)).collect();
        let count = artefacts.len();
        let transfer = Transfer { artefacts: count, new: count, bytes: contents.values().sum() };
        Ok((Archive::new(artefacts).encode(), transfer))
    }

    /// Reads the artefacts of exactly these keys, those that the store has.
    pub(crate) fn gather(&self, keys: &BTreeSet<Key>) -> Result<Vec<Archived>, StoreError> {
        let read = |Listed { key, content, subject, provenance, .. }| {
            let record = self.record(&key)?.ok_or(StoreError::Missing(content))?;
            Ok(Archived { record, subject, provenance, bytes: self.read(&content)?.into() })
        };
        self.list()?.into_iter().filter(|a| keys.contains(&a.key)).map(read).collect()
    }

    /// Adds the artefacts of an archive, all of which is verified first ([`Archive::read`]).
    pub fn import(&self, writer: &Writer, file: &[u8]) -> Result<Transfer, ArchiveError> {
        Ok(self.take(writer, Archive::read(file)?.artefacts())?)
    }

    /// Adds verified artefacts.
    pub(crate) fn take(&self, writer: &Writer, artefacts: &[Archived]) -> Result<Transfer, StoreError> {
        let mut transfer = Transfer { artefacts: artefacts.len(), ..Transfer::default() };
        for Archived { record, subject, provenance, bytes } in artefacts {
            let (key, content) = (record.key(), ContentHash::of(bytes));
            if self.lookup(&key)? == Some(content) && self.read(&content).is_ok() {
                continue;
            }
            let artefact = NewArtefact { record, subject, reason: "imported", provenance, bytes };
            self.publish(writer, &artefact)?;
            self.keep_as_latest(&record.kind, subject, key)?;
            transfer.new += 1;
            transfer.bytes += bytes.len() as u64;
        }
        Ok(transfer)
    }

    /// Marks an imported artefact as in use, unless another is, so that a collection of garbage leaves it.
    fn keep_as_latest(&self, kind: &str, subject: &str, key: Key) -> Result<(), StoreError> {
        let connection = self.connection();
        connection.execute(
            "INSERT OR IGNORE INTO latest (kind, subject, key) VALUES (?1, ?2, ?3)",
            params![kind, subject, key.as_bytes()],
        )?;
        Ok(())
    }
}
