//! Catalogues: what a depot holds, without looking into every object.

use super::{Depot, DepotError};
use crate::key::{ContentHash, Key};
use crate::store::Archived;

/// An artefact of a catalogue.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Entry {
    /// Name of the kind.
    pub kind: String,
    /// What it was about when it was computed.
    pub subject: String,
    /// Names the computation.
    pub key: Key,
    /// Names the bytes.
    pub content: ContentHash,
    /// Number of bytes.
    pub size: u64,
    /// The program that computed it.
    pub provenance: String,
}

impl Entry {
    /// The entry of an artefact.
    pub fn of(artefact: &Archived) -> Self {
        Self {
            kind: artefact.record.kind.clone(),
            subject: artefact.subject.clone(),
            key: artefact.record.key(),
            content: ContentHash::of(&artefact.bytes),
            size: artefact.bytes.len() as u64,
            provenance: artefact.provenance.clone(),
        }
    }
}

/// A depot whose artefacts are entered in the catalogue of another: objects in a bucket, and a database that knows which.
pub struct Catalogued {
    /// Where the objects are.
    pub objects: Box<dyn Depot>,
    /// Where they are entered; its own objects are not used.
    pub catalogue: Box<dyn Depot>,
}

impl Depot for Catalogued {
    fn get(&self, name: &str) -> Result<Option<Vec<u8>>, DepotError> {
        self.objects.get(name)
    }

    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), DepotError> {
        self.objects.put(name, bytes)
    }

    fn put_new(&self, name: &str, bytes: &[u8]) -> Result<bool, DepotError> {
        self.objects.put_new(name, bytes)
    }

    fn remove(&self, name: &str) -> Result<(), DepotError> {
        // The entry goes first: what is entered is there.
        self.catalogue.remove(name)?;
        self.objects.remove(name)
    }

    fn remove_all(&self, folder: &str) -> Result<(), DepotError> {
        self.objects.remove_all(folder)
    }

    fn names(&self, folder: &str) -> Result<Vec<String>, DepotError> {
        self.objects.names(folder)
    }

    fn enter(&self, entry: &Entry) -> Result<Entry, DepotError> {
        self.catalogue.enter(entry)
    }

    fn entries(&self) -> Result<Option<Vec<Entry>>, DepotError> {
        self.catalogue.entries()
    }
}
