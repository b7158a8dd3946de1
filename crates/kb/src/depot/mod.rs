//! Where processes, on one machine or on many, exchange finished artefacts and pieces of unfinished ones.
//!
//! A [`Depot`] holds objects by name, each whole or not there. Everything taken from it is verified: an artefact against
//! its key and its hash, a piece against its seal. So a depot needs no locks, and a worker may die at any time.
//!
//! ```text
//! artefacts/KEY        an artefact with the record of its key
//! pieces/KEY/NAME      a part of an artefact that is being computed
//! ```

mod folder;
#[cfg(feature = "build")]
pub(crate) mod pieces;
mod transfer;
#[cfg(feature = "build")]
mod worker;

use std::path::Path;

use thiserror::Error;

pub use folder::Folder;
pub use transfer::{TransferError, bring, fetch_inputs, put_away};
#[cfg(feature = "build")]
pub use worker::{Work, WorkError, work};

/// Why a depot could not be used.
#[derive(Debug, Error)]
#[error("{place}: {error}")]
pub struct DepotError {
    /// The object, as its depot calls it.
    pub place: String,
    /// What went wrong.
    pub error: std::io::Error,
}

/// A place for objects with names: words of letters, digits, `-` and `_`, joined by `/`.
pub trait Depot: Send + Sync {
    /// The object of this name; `None` when there is none.
    fn get(&self, name: &str) -> Result<Option<Vec<u8>>, DepotError>;

    /// Puts an object there, whole or not at all. One that is there already is replaced.
    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), DepotError>;

    /// Removes all objects whose names begin with `folder` and a slash; harmless when there are none.
    fn remove_all(&self, folder: &str) -> Result<(), DepotError>;
}

/// The depot at an address: a folder, which is made when it is missing.
pub fn open(address: &str) -> Result<Box<dyn Depot>, DepotError> {
    Ok(Box::new(Folder::open(Path::new(address))?))
}
