//! The one door to files and clock, so that the core stays pure and tests run in memory.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Why a file could not be read.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
pub enum ReadError {
    /// No file has this path.
    #[error("no such file")]
    NotFound,
    /// The path names a file that the operating system would not read.
    #[error("{0}")]
    Unreadable(String),
}

/// Files as seen by the compiler.
pub trait System: Send + Sync {
    /// The bytes of the file at `path`.
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadError>;

    /// Whether `path` names an existing file or folder.
    fn exists(&self, path: &Path) -> bool;
}

/// Files held in memory, for tests and for callers that have the text already.
#[derive(Debug, Clone, Default)]
pub struct MemorySystem {
    files: BTreeMap<PathBuf, Vec<u8>>,
}

impl MemorySystem {
    /// No files.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds or replaces a file.
    pub fn insert(&mut self, path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) {
        self.files.insert(path.into(), bytes.into());
    }
}

impl System for MemorySystem {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadError> {
        self.files.get(path).cloned().ok_or(ReadError::NotFound)
    }

    fn exists(&self, path: &Path) -> bool {
        self.files.keys().any(|file| file.starts_with(path))
    }
}
