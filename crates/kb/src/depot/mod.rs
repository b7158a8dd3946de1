//! Where processes, on one machine or on many, exchange finished artefacts and pieces of unfinished ones.
//!
//! A [`Depot`] holds objects by name, each whole or not there. Everything taken from it is verified: an artefact against
//! its key and its hash, a piece against its seal. So a depot needs no locks, and a worker may die at any time.
//!
//! ```text
//! artefacts/KEY        an artefact with the record of its key
//! pieces/KEY/NAME      a part of an artefact that is being computed
//! ```
//!
//! A depot is a folder, a bucket (feature `cloud`) or a database (feature `postgres`); [`open`] tells them apart by their
//! addresses. A [`Store`](crate::Store) that is [`shared_in`](crate::Store::shared_in) one is a near copy of it.

#[cfg(feature = "cloud")]
mod bucket;
mod catalogue;
#[cfg(feature = "postgres")]
mod database;
mod folder;
#[cfg(feature = "build")]
pub(crate) mod pieces;
mod transfer;
#[cfg(feature = "build")]
mod worker;

use std::io;
use std::path::Path;

use thiserror::Error;

pub use catalogue::{Catalogued, Entry};
pub use folder::Folder;
#[cfg(feature = "build")]
pub(crate) use transfer::offer;
pub use transfer::{
    Inventory, TransferError, bring, bring_all, catalogue, fetch_inputs, put_away, remove, verify,
};
#[cfg(feature = "build")]
pub use worker::{Work, WorkError, work};

/// Why a depot could not be used.
#[derive(Debug, Error)]
#[error("{place}: {error}")]
pub struct DepotError {
    /// The object, as its depot calls it.
    pub place: String,
    /// What went wrong.
    pub error: io::Error,
}

/// A place for objects with names: words of letters, digits, `-` and `_`, joined by `/`.
pub trait Depot: Send + Sync {
    /// The object of this name; `None` when there is none.
    fn get(&self, name: &str) -> Result<Option<Vec<u8>>, DepotError>;

    /// Puts an object there, whole or not at all. One that is there already is replaced.
    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), DepotError>;

    /// Puts an object there unless there is one of this name: `false` when there is. Of several processes at once, one
    /// gets `true`.
    fn put_new(&self, name: &str, bytes: &[u8]) -> Result<bool, DepotError>;

    /// Removes an object; harmless when there is none.
    fn remove(&self, name: &str) -> Result<(), DepotError>;

    /// Removes all objects whose names begin with `folder` and a slash; harmless when there are none.
    fn remove_all(&self, folder: &str) -> Result<(), DepotError>;

    /// What follows `folder` and a slash in the names of objects, where no further slash does; in order.
    fn names(&self, folder: &str) -> Result<Vec<String>, DepotError>;

    /// Enters an artefact in the catalogue, if there is one. Entering it twice is harmless. Returns the entry that the
    /// catalogue had under its key before, or this one.
    fn enter(&self, entry: &Entry) -> Result<Entry, DepotError> {
        Ok(entry.clone())
    }

    /// All artefacts that were entered and not removed, by kind, subject and key; `None` without a catalogue.
    fn entries(&self) -> Result<Option<Vec<Entry>>, DepotError> {
        Ok(None)
    }
}

/// Names and values that depots other than folders may need, such as `AWS_ACCESS_KEY_ID` or `PGPASSWORD`: the environment
/// of a program, as a rule.
pub type Settings = [(String, String)];

/// Whether an address is of a depot that is no folder: whether it has a scheme, as in `s3://bucket/name`.
pub fn is_address(text: &str) -> bool {
    text.contains("://")
}

/// The depot at an address.
///
/// - a path: a folder, which is made when it is missing;
/// - `postgres://user@host/database`: that database (feature `postgres`);
/// - `s3://bucket/name`, `az://`, `gs://`, `file://`, `memory://`: what the crate `object_store` has behind that address
///   (feature `cloud`);
/// - any of these, a comma, and the address of a database: objects there, entered in the catalogue of that database.
pub fn open(address: &str, settings: &Settings) -> Result<Box<dyn Depot>, DepotError> {
    if let Some((objects, catalogue)) = ["postgres://", "postgresql://"].iter().find_map(|scheme| {
        let at = address.find(&format!(",{scheme}"))?;
        Some((&address[..at], &address[at + 1..]))
    }) {
        let (objects, catalogue) = (open(objects, settings)?, database(catalogue, settings)?);
        return Ok(Box::new(Catalogued { objects, catalogue }));
    }
    match address.split_once("://") {
        None => Ok(Box::new(Folder::open(Path::new(address))?)),
        Some(("postgres" | "postgresql", _)) => database(address, settings),
        Some(_) => bucket(address, settings),
    }
}

#[cfg(feature = "postgres")]
fn database(address: &str, settings: &Settings) -> Result<Box<dyn Depot>, DepotError> {
    Ok(Box::new(database::Database::open(address, settings)?))
}

#[cfg(not(feature = "postgres"))]
fn database(address: &str, _settings: &Settings) -> Result<Box<dyn Depot>, DepotError> {
    Err(left_out(address, "postgres"))
}

#[cfg(feature = "cloud")]
fn bucket(address: &str, settings: &Settings) -> Result<Box<dyn Depot>, DepotError> {
    Ok(Box::new(bucket::Bucket::open(address, settings)?))
}

#[cfg(not(feature = "cloud"))]
fn bucket(address: &str, _settings: &Settings) -> Result<Box<dyn Depot>, DepotError> {
    Err(left_out(address, "cloud"))
}

#[cfg(not(all(feature = "cloud", feature = "postgres")))]
fn left_out(address: &str, feature: &str) -> DepotError {
    let why = format!("this program was built without its feature `{feature}`");
    DepotError { place: address.to_owned(), error: io::Error::new(io::ErrorKind::Unsupported, why) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What every depot does.
    fn keeps_its_promises(depot: &dyn Depot) {
        assert_eq!(depot.get("a/b").unwrap(), None);
        assert_eq!(depot.names("a").unwrap(), Vec::<String>::new());
        assert!(depot.put_new("a/b", b"one").unwrap());
        assert!(!depot.put_new("a/b", b"two").unwrap());
        assert_eq!(depot.get("a/b").unwrap().as_deref(), Some(&b"one"[..]));
        depot.put("a/b", b"").unwrap();
        assert_eq!(depot.get("a/b").unwrap().as_deref(), Some(&b""[..]));
        for name in ["a/c", "a/deeper/d", "a/deeper/e", "ab/c"] {
            depot.put(name, name.as_bytes()).unwrap();
        }
        assert_eq!(depot.names("a").unwrap(), ["b", "c"]);
        depot.remove("a/b").unwrap();
        depot.remove("a/b").unwrap();
        assert_eq!(depot.names("a").unwrap(), ["c"]);
        depot.remove_all("a/deeper").unwrap();
        depot.remove_all("a/deeper").unwrap();
        assert_eq!(depot.names("a/deeper").unwrap(), Vec::<String>::new());
        assert_eq!(depot.get("ab/c").unwrap().as_deref(), Some(&b"ab/c"[..]));
    }

    #[test]
    fn folders_keep_their_promises() {
        let folder = tempfile::tempdir().unwrap();
        keeps_its_promises(&*open(folder.path().to_str().unwrap(), &[]).unwrap());
    }

    #[cfg(feature = "cloud")]
    #[test]
    fn buckets_keep_their_promises() {
        let folder = tempfile::tempdir().unwrap();
        keeps_its_promises(&*open("memory:///", &[]).unwrap());
        keeps_its_promises(&*open(&format!("file://{}", folder.path().display()), &[]).unwrap());
        assert!(open("nowhere://", &[]).is_err());
    }

    #[cfg(not(feature = "cloud"))]
    #[test]
    fn what_was_left_out_is_told() {
        let error = open("s3://bucket/kb", &[]).err().unwrap();
        assert_eq!(error.to_string(), "s3://bucket/kb: this program was built without its feature `cloud`");
    }
}
