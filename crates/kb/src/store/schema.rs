//! The database of a store: tables and how it is opened.

use std::path::Path;

use rusqlite::{Connection, TransactionBehavior};

use super::StoreError;

/// Name of the database in the folder of the store.
pub(super) const FILE: &str = "robotc.db";

/// Raised when the tables change; a store of another format is refused, never converted: it can be computed again.
const FORMAT: i64 = 1;

const TABLES: &str = "
    CREATE TABLE blob (
        content BLOB NOT NULL PRIMARY KEY,
        bytes   BLOB                        -- null: in a file of its own
    );
    CREATE TABLE artefact (
        key        BLOB NOT NULL PRIMARY KEY,
        kind       TEXT NOT NULL,
        subject    TEXT NOT NULL,
        content    BLOB NOT NULL REFERENCES blob (content),
        size       INTEGER NOT NULL,
        record     BLOB NOT NULL,           -- what the key is made of
        reason     TEXT NOT NULL,
        provenance TEXT NOT NULL
    );
    CREATE INDEX artefact_by_content ON artefact (content);
    CREATE TABLE latest (                   -- which key is in use for what
        kind    TEXT NOT NULL,
        subject TEXT NOT NULL,
        key     BLOB NOT NULL,
        PRIMARY KEY (kind, subject)
    ) WITHOUT ROWID;
";

/// How long a statement waits for another process, milliseconds.
const BUSY_MS: u32 = 30_000;

/// How long to wait before trying again to open, milliseconds.
const PAUSE_MS: u32 = 10;

/// Opens the database, made if there is none.
pub(super) fn open(path: &Path) -> Result<Connection, StoreError> {
    // A connection has to be alone to change the journal, and SQLite refuses at once where it would wait otherwise.
    for _ in 0..BUSY_MS / PAUSE_MS {
        match try_open(path) {
            Err(StoreError::Database(error)) if is_busy(&error) => {
                std::thread::sleep(std::time::Duration::from_millis(u64::from(PAUSE_MS)));
            }
            result => return result,
        }
    }
    try_open(path)
}

fn is_busy(error: &rusqlite::Error) -> bool {
    error.sqlite_error_code() == Some(rusqlite::ErrorCode::DatabaseBusy)
}

fn try_open(path: &Path) -> Result<Connection, StoreError> {
    let mut connection = Connection::open(path)?;
    connection.busy_timeout(std::time::Duration::from_millis(u64::from(BUSY_MS)))?;
    // WAL: readers never wait for the writer. FULL: a committed transaction survives a power cut.
    connection.pragma_update(None, "journal_mode", "wal")?;
    connection.pragma_update(None, "synchronous", "full")?;
    connection.set_prepared_statement_cache_capacity(32);
    if version(&connection)? == 0 {
        // Two processes may make the same store at once: the second finds the tables made.
        let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
        if version(&transaction)? == 0 {
            transaction.execute_batch(TABLES)?;
            transaction.pragma_update(None, "user_version", FORMAT)?;
        }
        transaction.commit()?;
    }
    match version(&connection)? {
        FORMAT => Ok(connection),
        found => Err(StoreError::Format { found, expected: FORMAT }),
    }
}

fn version(connection: &Connection) -> Result<i64, StoreError> {
    Ok(connection.pragma_query_value(None, "user_version", |row| row.get(0))?)
}
