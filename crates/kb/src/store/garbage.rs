//! Removing what nothing needs.

use std::collections::BTreeSet;

use rusqlite::params;

use super::{Listed, Store, StoreError, Writer};
use crate::key::{ContentHash, Key};
use crate::record::{KeyRecord, Source};

/// What a collection of garbage removes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Garbage {
    /// Artefacts that nothing needs.
    pub artefacts: Vec<Listed>,
    /// Files that nothing refers to.
    pub leftovers: usize,
    /// Bytes of contents that are freed.
    pub bytes: u64,
}

impl Store {
    /// What [`collect`](Self::collect) would remove.
    ///
    /// Kept are the artefacts last used for each subject, those of `roots` (such as the keys of lock files), and all that
    /// these were computed from.
    pub fn garbage(&self, roots: &[Key]) -> Result<Garbage, StoreError> {
        let all = self.list()?;
        let needed = self.needed(&all, roots)?;
        let kept: BTreeSet<ContentHash> =
            all.iter().filter(|a| needed.contains(&a.key)).map(|a| a.content).collect();
        let artefacts: Vec<Listed> = all.into_iter().filter(|a| !needed.contains(&a.key)).collect();
        let freed: BTreeSet<(ContentHash, u64)> =
            artefacts.iter().filter(|a| !kept.contains(&a.content)).map(|a| (a.content, a.size)).collect();
        let bytes = freed.iter().map(|(_, size)| size).sum();
        Ok(Garbage { artefacts, leftovers: self.leftovers()?.len(), bytes })
    }

    /// Removes what nothing needs, and returns what that was.
    pub fn collect(&self, _writer: &Writer, roots: &[Key]) -> Result<Garbage, StoreError> {
        let garbage = self.garbage(roots)?;
        {
            let mut connection = self.connection();
            let transaction = connection.transaction()?;
            for artefact in &garbage.artefacts {
                transaction
                    .execute("DELETE FROM artefact WHERE key = ?1", params![artefact.key.as_bytes()])?;
            }
            transaction
                .execute("DELETE FROM blob WHERE content NOT IN (SELECT content FROM artefact)", [])?;
            transaction.commit()?;
        }
        // Files go after the records that named them: a crash in between leaves files that nothing refers to.
        for path in self.leftovers()? {
            std::fs::remove_file(&path).map_err(|error| StoreError::Io { path, error })?;
        }
        self.connection().execute_batch("VACUUM")?;
        Ok(garbage)
    }

    fn needed(&self, all: &[Listed], roots: &[Key]) -> Result<BTreeSet<Key>, StoreError> {
        let mut open: Vec<Key> = roots.to_vec();
        {
            let connection = self.connection();
            let mut query = connection.prepare("SELECT key FROM latest")?;
            for key in query.query_map([], |row| row.get(0).map(Key::from_bytes))? {
                open.push(key?);
            }
        }
        let mut needed = BTreeSet::new();
        while let Some(key) = open.pop() {
            if needed.insert(key)
                && let Some(record) = self.record(&key)?
            {
                let inputs = inputs(&record);
                open.extend(all.iter().filter(|a| inputs.contains(&a.content)).map(|a| a.key));
            }
        }
        Ok(needed)
    }
}

/// The contents that an artefact was computed from.
pub(super) fn inputs(record: &KeyRecord) -> BTreeSet<ContentHash> {
    let artefacts = record.parts.iter().filter(|part| part.source == Source::Artefact);
    artefacts.map(|part| ContentHash::from_bytes(part.digest)).collect()
}
