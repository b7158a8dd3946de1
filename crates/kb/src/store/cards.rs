//! Cards: a file for each artefact that says all that the database does, so that the database can be made again.
//!
//! Format: the line `robotc artefact 1`, then postcard: what the key is made of, subject, reason, program, name of the
//! content, and the content itself when it has no file of its own; then 32 bytes of BLAKE3 over all that came before.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::{NewArtefact, StoreError, blobs};
use crate::codec;
use crate::key::{ContentHash, Key};
use crate::record::KeyRecord;

/// The folder of the cards in a store.
pub(super) const SHELVES: &str = "cards";

const HEADER: &[u8] = b"robotc artefact 1\n";

/// What a card says.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Card {
    /// What the key is made of.
    pub(super) record: KeyRecord,
    /// What the artefact is about.
    pub(super) subject: String,
    /// Why it was computed.
    pub(super) reason: String,
    /// The program that computed it.
    pub(super) provenance: String,
    /// Names its bytes.
    content: [u8; 32],
    /// The bytes, unless they have a file of their own.
    pub(super) bytes: Option<Vec<u8>>,
}

impl Card {
    /// The card of an artefact.
    pub(super) fn of(artefact: &NewArtefact<'_>, content: &ContentHash, inline: bool) -> Self {
        Self {
            record: artefact.record.clone(),
            subject: artefact.subject.to_owned(),
            reason: artefact.reason.to_owned(),
            provenance: artefact.provenance.to_owned(),
            content: *content.as_bytes(),
            bytes: inline.then(|| artefact.bytes.to_vec()),
        }
    }

    /// Names the bytes.
    pub(super) fn content(&self) -> ContentHash {
        ContentHash::from_bytes(self.content)
    }
}

/// Where the card of a key is.
pub(super) fn path(folder: &Path, key: &Key) -> PathBuf {
    blobs::on_shelf(folder, SHELVES, &key.to_string())
}

/// Writes a card, whole or not at all.
pub(super) fn write(folder: &Path, card: &Card) -> Result<(), StoreError> {
    let mut file = HEADER.to_vec();
    file.extend(codec::encode(card));
    let seal = blake3::hash(&file);
    file.extend_from_slice(seal.as_bytes());
    blobs::write_file(folder, &path(folder, &card.record.key()), &file)
}

/// Reads the card of a key; `None` when it is not there, or not whole, or that of another key.
pub(super) fn read(folder: &Path, key: &Key) -> Option<Card> {
    let file = std::fs::read(path(folder, key)).ok()?;
    let (sealed, seal) = file.split_last_chunk::<32>()?;
    let body = sealed.strip_prefix(HEADER)?;
    if blake3::hash(sealed).as_bytes() != seal {
        return None;
    }
    codec::decode::<Card>(body).ok().filter(|card| card.record.key() == *key)
}
