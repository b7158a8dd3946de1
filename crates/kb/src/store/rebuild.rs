//! Making a lost or damaged database again from the files beside it.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::SystemTime;

use rusqlite::params;

use super::{NewArtefact, Store, blobs, insert};
use super::{StoreError, cards, schema};
use crate::key::{ContentHash, Key};

/// What a rebuild found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Rebuilt {
    /// Number of artefacts that are known again.
    pub artefacts: usize,
    /// Number of cards that are damaged, or whose content is: these artefacts have to be computed again.
    pub lost: usize,
}

impl Store {
    /// Makes the database of the store in `folder` again from its cards and contents, all of which are verified. The old
    /// one, if there is one, is not read; it is replaced in one step, so that a crash leaves the old or the new.
    ///
    /// Which artefact is in use for a subject is not on the cards: the one that was computed last counts as such until
    /// the next compilation. That matters to the collection of garbage alone.
    pub fn rebuild(folder: &Path) -> Result<Rebuilt, StoreError> {
        Self::make_folders(folder)?;
        let _writer = Self::wait_for_writer(folder)?;
        rebuild(folder)
    }
}

/// As [`Store::rebuild`], for the holder of the writer's lock.
pub(super) fn rebuild(folder: &Path) -> Result<Rebuilt, StoreError> {
    let io = |path: &Path| {
        let path = path.to_owned();
        move |error| StoreError::Io { path, error }
    };
    let temporary = folder.join("temporary");
    let made = tempfile::NamedTempFile::new_in(&temporary).map_err(io(&temporary))?.into_temp_path();
    let mut result = Rebuilt::default();
    {
        let mut connection = schema::open(&made)?;
        let transaction = connection.transaction()?;
        let mut latest: BTreeMap<(String, String), (SystemTime, Key)> = BTreeMap::new();
        for (path, key) in blobs::files::<Key>(folder, cards::SHELVES)? {
            let whole = key.and_then(|key| Some((key, whole_card(folder, &key)?)));
            let Some((key, (card, bytes))) = whole else {
                result.lost += 1;
                continue;
            };
            let artefact = NewArtefact {
                record: &card.record,
                subject: &card.subject,
                reason: &card.reason,
                provenance: &card.provenance,
                bytes: &bytes,
            };
            insert(&transaction, &artefact, &key, &card.content(), card.bytes.is_some())?;
            result.artefacts += 1;
            let written = path.metadata().and_then(|m| m.modified()).unwrap_or(SystemTime::UNIX_EPOCH);
            let subject = (card.record.kind.clone(), card.subject.clone());
            let newest = latest.entry(subject).or_insert((written, key));
            *newest = (*newest).max((written, key));
        }
        for ((kind, subject), (_, key)) in latest {
            transaction.execute(
                "INSERT INTO latest (kind, subject, key) VALUES (?1, ?2, ?3)",
                params![kind, subject, key.as_bytes()],
            )?;
        }
        transaction.commit()?;
        // All into one file, which then takes the place of the old one.
        connection.pragma_update(None, "journal_mode", "delete")?;
    }
    let database = folder.join(schema::FILE);
    for suffix in ["-wal", "-shm"] {
        let path = folder.join(format!("{}{suffix}", schema::FILE));
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(io(&path)(error)),
            _ => {}
        }
    }
    made.persist(&database).map_err(|error| io(&database)(error.error))?;
    blobs::sync_folder(folder).map_err(io(folder))?;
    Ok(result)
}

/// A card with its content, both compared with their names, and accepted by their kind if this program has it.
fn whole_card(folder: &Path, key: &Key) -> Option<(cards::Card, Vec<u8>)> {
    let card = cards::read(folder, key)?;
    let bytes = match &card.bytes {
        Some(bytes) => bytes.clone(),
        None => blobs::read(folder, &card.content()).ok()?,
    };
    let kind = crate::kinds::find(&card.record.kind).filter(|kind| kind.info().format == card.record.format);
    let decodes = kind.is_none_or(|kind| kind.decode(&bytes).is_ok());
    (decodes && ContentHash::of(&bytes) == card.content()).then_some((card, bytes))
}
