//! Contents too large for the database: files named by their hash.

use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::StoreError;
use crate::key::ContentHash;

/// Contents below this many bytes go into the database, where SQLite reads them faster than a file system does.
pub(super) const INLINE_BELOW: usize = 64 * 1024;

/// Where a content has its file.
pub(super) fn path(folder: &Path, content: &ContentHash) -> PathBuf {
    on_shelf(folder, "blobs", &content.to_string())
}

/// Where a file named by a hash is: on the shelf of the first two digits.
pub(super) fn on_shelf(folder: &Path, shelves: &str, name: &str) -> PathBuf {
    folder.join(shelves).join(&name[..2]).join(&name[2..])
}

/// Writes a content that needs a file; returns whether it belongs into the database instead.
pub(super) fn write(folder: &Path, content: &ContentHash, bytes: &[u8]) -> Result<bool, StoreError> {
    if bytes.len() < INLINE_BELOW {
        return Ok(true);
    }
    write_file(folder, &path(folder, content), bytes)?;
    Ok(false)
}

/// Writes a file on a shelf of the store, whole or not at all.
pub(super) fn write_file(folder: &Path, target: &Path, bytes: &[u8]) -> Result<(), StoreError> {
    let shelf = target.parent().expect("a file of the store is on a shelf");
    let shelves = shelf.parent().expect("a shelf is in a folder of the store");
    let write = || -> std::io::Result<()> {
        fs::create_dir_all(shelf)?;
        let mut file = tempfile::NamedTempFile::new_in(folder.join("temporary"))?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(target)?;
        // The names must be on the disk before the database refers to them.
        sync_folder(shelf)?;
        sync_folder(shelves)
    };
    write().map_err(|error| StoreError::Io { path: target.to_owned(), error })
}

/// Reads a content's file.
pub(super) fn read(folder: &Path, content: &ContentHash) -> Result<Vec<u8>, StoreError> {
    let path = path(folder, content);
    fs::read(&path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => StoreError::Missing(*content),
        _ => StoreError::Io { path, error },
    })
}

/// All files on the shelves of a folder (`blobs` or `cards`), with the hash each is named by, sorted; `None` for names that
/// are no hash.
pub(super) fn files<H: FromStr>(
    folder: &Path,
    shelves: &str,
) -> Result<Vec<(PathBuf, Option<H>)>, StoreError> {
    let mut found = Vec::new();
    for shelf in entries(&folder.join(shelves))? {
        let prefix = shelf.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if !shelf.is_dir() {
            found.push((shelf, None));
            continue;
        }
        for file in entries(&shelf)? {
            let rest = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let name = format!("{prefix}{rest}").parse().ok();
            found.push((file, name));
        }
    }
    Ok(found)
}

/// Files that a crash left half written. Only meaningful for the holder of the writer's lock.
pub(super) fn temporary(folder: &Path) -> Result<Vec<PathBuf>, StoreError> {
    entries(&folder.join("temporary"))
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, StoreError> {
    let list = || -> std::io::Result<Vec<PathBuf>> {
        let mut paths =
            fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>()?;
        paths.sort();
        Ok(paths)
    };
    list().map_err(|error| StoreError::Io { path: folder.to_owned(), error })
}

#[cfg(unix)]
pub(super) fn sync_folder(folder: &Path) -> std::io::Result<()> {
    File::open(folder)?.sync_all()
}

#[cfg(not(unix))]
pub(super) fn sync_folder(_folder: &Path) -> std::io::Result<()> {
    // Elsewhere a folder cannot be opened as a file, and a rename is written through by the file system's journal.
    Ok(())
}
