//! The store: artefacts by content, and which key gave which content.
//!
//! A store is a folder:
//!
//! ```text
//! robotc.db            SQLite: keys, records, contents below 64 KiB
//! blobs/ab/cdef...     larger contents, each named by its hash
//! cards/ab/cdef...     what the database says of an artefact, named by its key
//! temporary/           contents being written
//! pieces/              parts of artefacts that are being computed
//! writer               locked by the process that builds, collects garbage or imports
//! ```
//!
//! It is whole after a crash at any moment: a content is written to a temporary file, flushed, renamed to its name and only
//! then recorded, on its card and in one transaction. What a crash can leave behind is a file that nothing refers to.
//! Everything read is compared with the hash that names it. A database that is lost is made again from the other files when
//! the store is opened; [`Store::rebuild`] does so for one that is damaged. Put it on a local disk: SQLite's write-ahead
//! log needs one.

mod archive;
mod blobs;
mod cards;
mod garbage;
mod rebuild;
mod schema;
mod transfer;
mod verify;

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard};

use rusqlite::{Connection, ErrorCode, OptionalExtension, Transaction, params};
use thiserror::Error;

pub use archive::{Archive, ArchiveError, Archived};
pub use garbage::Garbage;
pub use rebuild::Rebuilt;
pub use transfer::Transfer;
pub use verify::{Finding, Repair, Verification};

use crate::codec::DecodeError;
use crate::depot::Depot;
use crate::key::{ContentHash, Key};
use crate::record::KeyRecord;

/// Why a store could not do what was asked.
#[derive(Debug, Error)]
pub enum StoreError {
    /// The operating system would not read or write a file of the store.
    #[error("{path}: {error}")]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the operating system said.
        error: std::io::Error,
    },
    /// SQLite failed.
    #[error("the store's database: {0}")]
    Database(rusqlite::Error),
    /// The database is damaged.
    #[error("the store's database is damaged ({0}); `robotc kb rebuild` makes it again")]
    DamagedDatabase(rusqlite::Error),
    /// The folder holds a store of another version of this program.
    #[error("the store has format {found}, this program reads {expected}; use another folder for the store")]
    Format {
        /// Format of the store.
        found: i64,
        /// Format of this program.
        expected: i64,
    },
    /// A content that is recorded is not there.
    #[error("content {} is missing", .0.short())]
    Missing(ContentHash),
    /// A content is not what its name says.
    #[error("content {} is damaged", .0.short())]
    Damaged(ContentHash),
    /// A record cannot be read.
    #[error("the record of key {} is damaged: {error}", key.short())]
    DamagedRecord {
        /// The key.
        key: Key,
        /// What is wrong.
        error: DecodeError,
    },
    /// One key gave two contents: the kind is not deterministic.
    #[error(
        "{kind} with key {} gave content {} before and {} now: its computation does not repeat",
        key.short(), before.short(), now.short()
    )]
    NotRepeatable {
        /// The kind.
        kind: String,
        /// The key.
        key: Key,
        /// What the store holds.
        before: ContentHash,
        /// What was computed.
        now: ContentHash,
    },
}

impl From<rusqlite::Error> for StoreError {
    fn from(error: rusqlite::Error) -> Self {
        match error.sqlite_error_code() {
            Some(ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase) => Self::DamagedDatabase(error),
            _ => Self::Database(error),
        }
    }
}

/// An artefact as the store lists it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// Names the computation.
    pub key: Key,
    /// Name of the kind.
    pub kind: String,
    /// What it was about when it was computed.
    pub subject: String,
    /// Names the bytes.
    pub content: ContentHash,
    /// Number of bytes.
    pub size: u64,
    /// Why it was computed.
    pub reason: String,
    /// The program that computed it.
    pub provenance: String,
}

/// An artefact to be stored.
#[derive(Debug, Clone, Copy)]
pub struct NewArtefact<'a> {
    /// What its key is made of.
    pub record: &'a KeyRecord,
    /// What it is about.
    pub subject: &'a str,
    /// Why it was computed.
    pub reason: &'a str,
    /// The program that computed it.
    pub provenance: &'a str,
    /// Its stored form.
    pub bytes: &'a [u8],
}

/// A folder of artefacts. Shared by threads and by processes.
pub struct Store {
    folder: PathBuf,
    connection: Mutex<Connection>,
    shared: Option<Box<dyn Depot>>,
}

/// The right to write, held by one process at a time. Reading needs none.
pub struct Writer {
    _lock: File,
}

impl Store {
    /// Opens the store in a folder; makes an empty one when there is none. When only its database is gone, that is made
    /// again from the other files.
    pub fn open(folder: &Path) -> Result<Self, StoreError> {
        Self::make_folders(folder)?;
        let database = folder.join(schema::FILE);
        if !database.exists() && !blobs::files::<Key>(folder, cards::SHELVES)?.is_empty() {
            let _writer = Self::wait_for_writer(folder)?;
            // Another process may have been first.
            if !database.exists() {
                rebuild::rebuild(folder)?;
            }
        }
        let connection = schema::open(&database)?;
        Ok(Self { folder: folder.to_owned(), connection: Mutex::new(connection), shared: None })
    }

    fn make_folders(folder: &Path) -> Result<(), StoreError> {
        for part in ["blobs", cards::SHELVES, "temporary"] {
            let path = folder.join(part);
            std::fs::create_dir_all(&path).map_err(|error| StoreError::Io { path, error })?;
        }
        Ok(())
    }

    /// This store as the near copy of a depot: compiling and [`Knowledge::resolve`](crate::Knowledge::resolve) bring what
    /// it lacks from there, and compiling puts there what it computes before it stores it here.
    pub fn shared_in(self, depot: Box<dyn Depot>) -> Self {
        Self { shared: Some(depot), ..self }
    }

    /// The depot that this store is a near copy of.
    pub fn shared(&self) -> Option<&dyn Depot> {
        self.shared.as_deref()
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The right to write, or `None` when another process has it.
    pub fn try_writer(&self) -> Result<Option<Writer>, StoreError> {
        let (path, file) = Self::lock_file(&self.folder)?;
        match file.try_lock() {
            Ok(()) => Ok(Some(Writer { _lock: file })),
            Err(std::fs::TryLockError::WouldBlock) => Ok(None),
            Err(std::fs::TryLockError::Error(error)) => Err(StoreError::Io { path, error }),
        }
    }

    /// The right to write; waits while another process has it. The lock ends with the process that holds it, however
    /// that ends.
    pub fn writer(&self) -> Result<Writer, StoreError> {
        Self::wait_for_writer(&self.folder)
    }

    fn wait_for_writer(folder: &Path) -> Result<Writer, StoreError> {
        let (path, file) = Self::lock_file(folder)?;
        file.lock().map_err(|error| StoreError::Io { path, error })?;
        Ok(Writer { _lock: file })
    }

    fn lock_file(folder: &Path) -> Result<(PathBuf, File), StoreError> {
        let path = folder.join("writer");
        let file = File::options().create(true).truncate(false).write(true).open(&path);
        match file {
            Ok(file) => Ok((path, file)),
            Err(error) => Err(StoreError::Io { path, error }),
        }
    }

    /// The content that a key gave, whether or not its bytes are still there and whole.
    pub fn lookup(&self, key: &Key) -> Result<Option<ContentHash>, StoreError> {
        let connection = self.connection();
        let mut query = connection.prepare_cached("SELECT content FROM artefact WHERE key = ?1")?;
        Ok(query
            .query_row(params![key.as_bytes()], |row| row.get(0).map(ContentHash::from_bytes))
            .optional()?)
    }

    /// What a key is made of, for keys in the store.
    pub fn record(&self, key: &Key) -> Result<Option<KeyRecord>, StoreError> {
        let bytes: Option<Vec<u8>> = {
            let connection = self.connection();
            let mut query = connection.prepare_cached("SELECT record FROM artefact WHERE key = ?1")?;
            query.query_row(params![key.as_bytes()], |row| row.get(0)).optional()?
        };
        let damaged = |error| StoreError::DamagedRecord { key: *key, error };
        bytes.map(|bytes| KeyRecord::decode(&bytes).map_err(damaged)).transpose()
    }

    /// The key last used for a kind and a subject.
    pub fn latest(&self, kind: &str, subject: &str) -> Result<Option<Key>, StoreError> {
        let connection = self.connection();
        let mut query =
            connection.prepare_cached("SELECT key FROM latest WHERE kind = ?1 AND subject = ?2")?;
        Ok(query.query_row(params![kind, subject], |row| row.get(0).map(Key::from_bytes)).optional()?)
    }

    /// Remembers which keys are now in use, as (kind, subject, key).
    pub fn set_latest(&self, entries: &[(&str, &str, Key)]) -> Result<(), StoreError> {
        let mut connection = self.connection();
        let transaction = connection.transaction()?;
        for (kind, subject, key) in entries {
            transaction
                .prepare_cached("INSERT OR REPLACE INTO latest (kind, subject, key) VALUES (?1, ?2, ?3)")?
                .execute(params![kind, subject, key.as_bytes()])?;
        }
        transaction.commit()?;
        Ok(())
    }

    /// All artefacts, by kind, subject and key.
    pub fn list(&self) -> Result<Vec<Listed>, StoreError> {
        let connection = self.connection();
        let mut query = connection.prepare_cached(
            "SELECT key, kind, subject, content, size, reason, provenance FROM artefact
             ORDER BY kind, subject, key",
        )?;
        let rows = query.query_map([], |row| {
            Ok(Listed {
                key: Key::from_bytes(row.get(0)?),
                kind: row.get(1)?,
                subject: row.get(2)?,
                content: ContentHash::from_bytes(row.get(3)?),
                size: row.get::<_, i64>(4)?.unsigned_abs(),
                reason: row.get(5)?,
                provenance: row.get(6)?,
            })
        })?;
        Ok(rows.collect::<Result<_, _>>()?)
    }

    /// Stores an artefact. Storing it twice is harmless; a key that had another whole content is an error.
    pub fn publish(&self, _writer: &Writer, artefact: &NewArtefact<'_>) -> Result<ContentHash, StoreError> {
        let content = ContentHash::of(artefact.bytes);
        let key = artefact.record.key();
        if let Some(before) = self.lookup(&key)?
            && before != content
            && self.read(&before).is_ok()
        {
            let kind = artefact.record.kind.clone();
            return Err(StoreError::NotRepeatable { kind, key, before, now: content });
        }
        let inline = blobs::write(&self.folder, &content, artefact.bytes)?;
        cards::write(&self.folder, &cards::Card::of(artefact, &content, inline))?;
        let mut connection = self.connection();
        let transaction = connection.transaction()?;
        insert(&transaction, artefact, &key, &content, inline)?;
        transaction.commit()?;
        Ok(content)
    }

    /// The bytes of a content, compared with its name.
    pub fn read(&self, content: &ContentHash) -> Result<Vec<u8>, StoreError> {
        let inline: Option<Option<Vec<u8>>> = {
            let connection = self.connection();
            let mut query = connection.prepare_cached("SELECT bytes FROM blob WHERE content = ?1")?;
            query.query_row(params![content.as_bytes()], |row| row.get(0)).optional()?
        };
        let bytes = match inline {
            None => return Err(StoreError::Missing(*content)),
            Some(Some(bytes)) => bytes,
            Some(None) => blobs::read(&self.folder, content)?,
        };
        if ContentHash::of(&bytes) == *content { Ok(bytes) } else { Err(StoreError::Damaged(*content)) }
    }

    fn connection(&self) -> MutexGuard<'_, Connection> {
        // A panic of another thread cannot leave a transaction open: they roll back when dropped.
        self.connection.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// Records an artefact; `inline` puts its bytes into the database.
fn insert(
    transaction: &Transaction<'_>,
    artefact: &NewArtefact<'_>,
    key: &Key,
    content: &ContentHash,
    inline: bool,
) -> Result<(), StoreError> {
    transaction
        .prepare_cached("INSERT OR REPLACE INTO blob (content, bytes) VALUES (?1, ?2)")?
        .execute(params![content.as_bytes(), inline.then_some(artefact.bytes)])?;
    transaction
        .prepare_cached(
            "INSERT OR REPLACE INTO artefact (key, kind, subject, content, size, record, reason, provenance)
             VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
        )?
        .execute(params![
            key.as_bytes(),
            artefact.record.kind,
            artefact.subject,
            content.as_bytes(),
            artefact.bytes.len() as i64,
            artefact.record.encode(),
            artefact.reason,
            artefact.provenance,
        ])?;
    Ok(())
}
