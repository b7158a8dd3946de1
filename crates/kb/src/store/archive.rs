//! A store, or part of one, in one file.
//!
//! Format: the line `robotc knowledge base 1`, then postcard: the artefacts by key, then the contents by hash, then 32
//! bytes of BLAKE3 over all that came before. Equal artefacts give equal files.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::params;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{NewArtefact, Store, StoreError, Writer, garbage};
use crate::codec;
use crate::key::{ContentHash, Key};
use crate::record::KeyRecord;

const HEADER: &[u8] = b"robotc knowledge base 1\n";

/// Why an archive was refused. Nothing of it was stored.
#[derive(Debug, Error)]
pub enum ArchiveError {
    /// It is not an archive of this format.
    #[error("not an archive of a knowledge base, or one of another version")]
    NotAnArchive,
    /// It was cut short or changed.
    #[error("the archive is damaged")]
    Damaged,
    /// An artefact contradicts itself.
    #[error("the archive's artefact {} is wrong: {reason}", key.short())]
    WrongArtefact {
        /// Its key.
        key: Key,
        /// What is wrong.
        reason: String,
    },
    /// The store failed, or holds something else under the same key.
    #[error(transparent)]
    Store(#[from] StoreError),
}

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

#[derive(Serialize, Deserialize)]
struct Entry {
    key: [u8; 32],
    subject: String,
    content: [u8; 32],
    record: Vec<u8>,
    provenance: String,
}

#[derive(Serialize, Deserialize)]
struct Body {
    entries: Vec<Entry>,
    contents: Vec<Vec<u8>>,
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
        let mut entries = Vec::new();
        let mut contents = BTreeMap::new();
        for artefact in all.iter().filter(|a| wanted.contains(&a.key)) {
            let record = self.record(&artefact.key)?.ok_or(StoreError::Missing(artefact.content))?;
            entries.push(Entry {
                key: *artefact.key.as_bytes(),
                subject: artefact.subject.clone(),
                content: *artefact.content.as_bytes(),
                record: record.encode(),
                provenance: artefact.provenance.clone(),
            });
            contents.insert(artefact.content, self.read(&artefact.content)?);
        }
        entries.sort_by_key(|entry| entry.key);
        let bytes = contents.values().map(|c| c.len() as u64).sum();
        let transfer = Transfer { artefacts: entries.len(), new: entries.len(), bytes };
        let mut file = HEADER.to_vec();
        file.extend(codec::encode(&Body { entries, contents: contents.into_values().collect() }));
        let seal = blake3::hash(&file);
        file.extend_from_slice(seal.as_bytes());
        Ok((file, transfer))
    }

    /// Adds the artefacts of an archive. All of it is verified first: the seal, each record against its key, each content
    /// against its name, and that its kind decodes it.
    pub fn import(&self, writer: &Writer, file: &[u8]) -> Result<Transfer, ArchiveError> {
        let Body { entries, contents } = open(file)?;
        let contents: BTreeMap<ContentHash, Vec<u8>> =
            contents.into_iter().map(|bytes| (ContentHash::of(&bytes), bytes)).collect();
        let mut verified = Vec::new();
        for entry in &entries {
            let content = ContentHash::from_bytes(entry.content);
            let key = Key::from_bytes(entry.key);
            let wrong = |reason: String| ArchiveError::WrongArtefact { key, reason };
            let record = KeyRecord::decode(&entry.record).map_err(|error| wrong(error.to_string()))?;
            if record.key() != key {
                return Err(wrong("what its key is made of gives another key".into()));
            }
            let bytes =
                contents.get(&content).ok_or_else(|| wrong("its content is not in the archive".into()))?;
            let kind = crate::kinds::find(&record.kind).filter(|kind| kind.info().format == record.format);
            if let Some(Err(error)) = kind.map(|kind| kind.decode(bytes)) {
                return Err(wrong(error.to_string()));
            }
            verified.push((key, content, entry, record, bytes));
        }
        let mut transfer = Transfer { artefacts: entries.len(), ..Transfer::default() };
        for (key, content, entry, record, bytes) in verified {
            if self.lookup(&key)? == Some(content) && self.read(&content).is_ok() {
                continue;
            }
            let (subject, provenance) = (entry.subject.as_str(), entry.provenance.as_str());
            let artefact = NewArtefact { record: &record, subject, reason: "imported", provenance, bytes };
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

fn open(file: &[u8]) -> Result<Body, ArchiveError> {
    let rest = file.strip_prefix(HEADER).ok_or(ArchiveError::NotAnArchive)?;
    let (body, seal) = rest.split_last_chunk::<32>().ok_or(ArchiveError::Damaged)?;
    if blake3::hash(&file[..file.len() - seal.len()]).as_bytes() != seal {
        return Err(ArchiveError::Damaged);
    }
    codec::decode(body).map_err(|_| ArchiveError::Damaged)
}
