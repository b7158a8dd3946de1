//! A depot in a PostgreSQL database: objects, and a catalogue that can be asked in SQL.
//!
//! ```text
//! robotc.object      name, bytes
//! robotc.artefact    key, kind, subject, content, size, provenance, made: one row for each artefact
//! ```

use std::io;
use std::sync::{Mutex, MutexGuard, PoisonError};

use postgres::types::ToSql;
use postgres::{Client, Config, Error, NoTls, Row};

use super::transfer::FOLDER;
use super::{Depot, DepotError, Entry, Settings};
use crate::key::{ContentHash, Key};

/// Made when they are missing. The lock keeps two processes from making them at the same time, which PostgreSQL refuses.
const TABLES: &str = "
    BEGIN;
    SELECT pg_advisory_xact_lock(7021957);
    CREATE SCHEMA IF NOT EXISTS robotc;
    CREATE TABLE IF NOT EXISTS robotc.object (name text PRIMARY KEY, bytes bytea NOT NULL);
    ALTER TABLE robotc.object ALTER COLUMN bytes SET STORAGE EXTERNAL;
    CREATE TABLE IF NOT EXISTS robotc.artefact (
        key        text PRIMARY KEY,
        kind       text NOT NULL,
        subject    text NOT NULL,
        content    text NOT NULL,
        size       bigint NOT NULL,
        provenance text NOT NULL,
        made       timestamptz NOT NULL DEFAULT now()
    );
    CREATE INDEX IF NOT EXISTS artefact_by_subject ON robotc.artefact (kind, subject);
    COMMIT;
";

/// What to look for before making tables, which needs rights that a reader may lack.
const THERE: &str =
    "SELECT to_regclass('robotc.object') IS NOT NULL AND to_regclass('robotc.artefact') IS NOT NULL";

/// A database. One statement runs at a time; a connection that was lost is made again.
pub(super) struct Database {
    config: Config,
    place: String,
    client: Mutex<Client>,
}

impl Database {
    /// The database at an address such as `postgres://user@host/database`. The password is that of the address or
    /// `PGPASSWORD`. Connections are not encrypted.
    pub(super) fn open(address: &str, settings: &Settings) -> Result<Self, DepotError> {
        // The password stays out of messages.
        let place = address.rsplit_once('@').map_or(address, |(_, host)| host).to_owned();
        let failed = |error| failed(&place, error);
        let mut config: Config = address.parse().map_err(failed)?;
        if config.get_password().is_none()
            && let Some((_, password)) = settings.iter().find(|(name, _)| name == "PGPASSWORD")
        {
            config.password(password);
        }
        let mut client = config.connect(NoTls).map_err(failed)?;
        if !client.query_one(THERE, &[]).map_err(failed)?.get::<_, bool>(0) {
            client.batch_execute(TABLES).map_err(failed)?;
        }
        Ok(Self { config, place, client: Mutex::new(client) })
    }

    fn rows(&self, statement: &str, values: &[&(dyn ToSql + Sync)]) -> Result<Vec<Row>, DepotError> {
        let mut client = self.client();
        let mut result = client.query(statement, values);
        // Every statement of this file may be run twice.
        if result.is_err() && client.is_closed() {
            *client = self.config.connect(NoTls).map_err(|error| failed(&self.place, error))?;
            result = client.query(statement, values);
        }
        result.map_err(|error| failed(&self.place, error))
    }

    fn client(&self) -> MutexGuard<'_, Client> {
        self.client.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn failed(place: &str, error: Error) -> DepotError {
    // The cause says more than "db error".
    let text = std::error::Error::source(&error).map_or_else(|| error.to_string(), |cause| cause.to_string());
    DepotError { place: place.to_owned(), error: io::Error::other(text) }
}

impl Depot for Database {
    fn get(&self, name: &str) -> Result<Option<Vec<u8>>, DepotError> {
        let rows = self.rows("SELECT bytes FROM robotc.object WHERE name = $1", &[&name])?;
        Ok(rows.first().map(|row| row.get(0)))
    }

    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), DepotError> {
        let statement = "INSERT INTO robotc.object (name, bytes) VALUES ($1, $2)
                         ON CONFLICT (name) DO UPDATE SET bytes = excluded.bytes";
        self.rows(statement, &[&name, &bytes]).map(drop)
    }

    fn put_new(&self, name: &str, bytes: &[u8]) -> Result<bool, DepotError> {
        let statement = "INSERT INTO robotc.object (name, bytes) VALUES ($1, $2)
                         ON CONFLICT (name) DO NOTHING RETURNING true";
        Ok(!self.rows(statement, &[&name, &bytes])?.is_empty())
    }

    fn remove(&self, name: &str) -> Result<(), DepotError> {
        if let Some(key) = name.strip_prefix(FOLDER).and_then(|rest| rest.strip_prefix('/')) {
            self.rows("DELETE FROM robotc.artefact WHERE key = $1", &[&key])?;
        }
        self.rows("DELETE FROM robotc.object WHERE name = $1", &[&name]).map(drop)
    }

    fn remove_all(&self, folder: &str) -> Result<(), DepotError> {
        self.rows("DELETE FROM robotc.object WHERE starts_with(name, $1 || '/')", &[&folder]).map(drop)
    }

    fn names(&self, folder: &str) -> Result<Vec<String>, DepotError> {
        let statement = "SELECT substr(name, length($1) + 2) AS rest FROM robotc.object
                         WHERE starts_with(name, $1 || '/') AND strpos(substr(name, length($1) + 2), '/') = 0
                         ORDER BY name COLLATE \"C\"";
        Ok(self.rows(statement, &[&folder])?.iter().map(|row| row.get(0)).collect())
    }

    fn enter(&self, entry: &Entry) -> Result<Entry, DepotError> {
        let (key, content) = (entry.key.to_string(), entry.content.to_string());
        let statement = "INSERT INTO robotc.artefact (key, kind, subject, content, size, provenance)
                         VALUES ($1, $2, $3, $4, $5, $6) ON CONFLICT (key) DO NOTHING";
        let size = entry.size as i64;
        self.rows(statement, &[&key, &entry.kind, &entry.subject, &content, &size, &entry.provenance])?;
        let statement = format!("{ENTRIES} WHERE key = $1");
        let entered = self.rows(&statement, &[&key])?.first().and_then(read);
        Ok(entered.unwrap_or_else(|| entry.clone()))
    }

    fn entries(&self) -> Result<Option<Vec<Entry>>, DepotError> {
        let mut entries: Vec<Entry> = self.rows(ENTRIES, &[])?.iter().filter_map(read).collect();
        entries.sort();
        Ok(Some(entries))
    }
}

const ENTRIES: &str = "SELECT kind, subject, key, content, size, provenance FROM robotc.artefact";

/// The entry of a row; `None` when someone else wrote it.
fn read(row: &Row) -> Option<Entry> {
    Some(Entry {
        kind: row.get(0),
        subject: row.get(1),
        key: row.get::<_, &str>(2).parse::<Key>().ok()?,
        content: row.get::<_, &str>(3).parse::<ContentHash>().ok()?,
        size: row.get::<_, i64>(4).unsigned_abs(),
        provenance: row.get(5),
    })
}
