//! Real files behind the core's [`System`].

use std::io::ErrorKind;
use std::path::Path;

use robotc_core::System;
use robotc_core::system::ReadError;

/// The operating system's files.
#[derive(Debug, Clone, Copy, Default)]
pub struct OsSystem;

impl System for OsSystem {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadError> {
        std::fs::read(path).map_err(|error| match error.kind() {
            ErrorKind::NotFound => ReadError::NotFound,
            _ => ReadError::Unreadable(error.to_string()),
        })
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }
}
