//! A store, or part of one, in one file.
//!
//! Format: the line `robotc knowledge base 1`, then postcard: the artefacts by key, then the contents by hash, then 32
//! bytes of BLAKE3 over all that came before. Equal artefacts give equal files.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::StoreError;
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

/// Artefacts on their way between stores.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Archive {
    artefacts: Vec<Archived>,
}

/// An artefact of an [`Archive`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Archived {
    /// What its key is made of.
    pub record: KeyRecord,
    /// What it was about when it was computed.
    pub subject: String,
    /// The program that computed it.
    pub provenance: String,
    /// Its stored form.
    pub bytes: Arc<[u8]>,
}

#[cfg(feature = "build")]
impl super::NewArtefact<'_> {
    /// The artefact as archives hold it.
    pub(crate) fn archived(&self) -> Archived {
        Archived {
            record: self.record.clone(),
            subject: self.subject.to_owned(),
            provenance: self.provenance.to_owned(),
            bytes: self.bytes.into(),
        }
    }
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

impl Archive {
    /// An archive of these artefacts.
    pub fn new(mut artefacts: Vec<Archived>) -> Self {
        artefacts.sort_by_cached_key(|artefact| artefact.record.key());
        Self { artefacts }
    }

    /// The artefacts, by key.
    pub fn artefacts(&self) -> &[Archived] {
        &self.artefacts
    }

    /// The file.
    pub fn encode(&self) -> Vec<u8> {
        let mut contents = BTreeMap::new();
        let mut entries = Vec::new();
        for artefact in &self.artefacts {
            let content = ContentHash::of(&artefact.bytes);
            contents.entry(content).or_insert_with(|| artefact.bytes.to_vec());
            entries.push(Entry {
                key: *artefact.record.key().as_bytes(),
                subject: artefact.subject.clone(),
                content: *content.as_bytes(),
                record: artefact.record.encode(),
                provenance: artefact.provenance.clone(),
            });
        }
        Self::sealed(&codec::encode(&Body { entries, contents: contents.into_values().collect() }))
    }

    /// The file with this body, right or wrong, behind the header and before the seal.
    pub fn sealed(body: &[u8]) -> Vec<u8> {
        let mut file = [HEADER, body].concat();
        let seal = blake3::hash(&file);
        file.extend_from_slice(seal.as_bytes());
        file
    }

    /// The artefacts of a file. All of it is verified: the seal, each record against its key, each content against its name,
    /// and that its kind decodes it.
    pub fn read(file: &[u8]) -> Result<Self, ArchiveError> {
        let Body { entries, contents } = open(file)?;
        let contents: BTreeMap<ContentHash, Arc<[u8]>> =
            contents.into_iter().map(|bytes| (ContentHash::of(&bytes), bytes.into())).collect();
        let mut artefacts = Vec::new();
        for entry in entries {
            let key = Key::from_bytes(entry.key);
            let wrong = |reason: String| ArchiveError::WrongArtefact { key, reason };
            let record = KeyRecord::decode(&entry.record).map_err(|error| wrong(error.to_string()))?;
            if record.key() != key {
                return Err(wrong("what its key is made of gives another key".into()));
            }
            let bytes = contents
                .get(&ContentHash::from_bytes(entry.content))
                .ok_or_else(|| wrong("its content is not in the archive".into()))?;
            let kind = crate::kinds::find(&record.kind).filter(|kind| kind.info().format == record.format);
            if let Some(Err(error)) = kind.map(|kind| kind.decode(bytes)) {
                return Err(wrong(error.to_string()));
            }
            let Entry { subject, provenance, .. } = entry;
            artefacts.push(Archived { record, subject, provenance, bytes: bytes.clone() });
        }
        Ok(Self::new(artefacts))
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
