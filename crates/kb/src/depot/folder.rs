//! A depot in a folder, such as one on a disk that several machines see.

use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use super::{Depot, DepotError};

/// Objects as files. A file gets its name when it is complete, which the file systems of networks keep to as well.
#[derive(Debug, Clone)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// The depot in a folder; made when it is missing.
    pub fn open(path: &Path) -> Result<Self, DepotError> {
        fs::create_dir_all(path).map_err(|error| failed(path, error))?;
        Ok(Self { path: path.to_owned() })
    }

    fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }
}

fn failed(path: &Path, error: io::Error) -> DepotError {
    DepotError { place: path.display().to_string(), error }
}

impl Depot for Folder {
    fn get(&self, name: &str) -> Result<Option<Vec<u8>>, DepotError> {
        let path = self.file(name);
        match fs::read(&path) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(failed(&path, error)),
        }
    }

    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), DepotError> {
        let path = self.file(name);
        let parent = path.parent().unwrap_or(&self.path);
        let write = || -> io::Result<()> {
            // Another process may have finished the artefact and removed the folder in between.
            for last in [false, true] {
                fs::create_dir_all(parent)?;
                match write_whole(parent, &path, bytes) {
                    Err(error) if error.kind() == ErrorKind::NotFound && !last => {}
                    result => return result,
                }
            }
            Ok(())
        };
        write().map_err(|error| failed(&path, error))
    }

    fn remove_all(&self, folder: &str) -> Result<(), DepotError> {
        let path = self.file(folder);
        match fs::remove_dir_all(&path) {
            // What another process puts there or removes meanwhile is its own business.
            Err(error) if !matches!(error.kind(), ErrorKind::NotFound | ErrorKind::DirectoryNotEmpty) => {
                Err(failed(&path, error))
            }
            _ => Ok(()),
        }
    }
}

fn write_whole(parent: &Path, path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = tempfile::NamedTempFile::new_in(parent)?;
    file.write_all(bytes)?;
    file.persist(path)?;
    Ok(())
}

/// A store keeps the pieces of what it is computing beside its artefacts.
impl Depot for crate::Store {
    fn get(&self, name: &str) -> Result<Option<Vec<u8>>, DepotError> {
        self.beside().get(name)
    }

    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), DepotError> {
        self.beside().put(name, bytes)
    }

    fn remove_all(&self, folder: &str) -> Result<(), DepotError> {
        self.beside().remove_all(folder)
    }
}

impl crate::Store {
    fn beside(&self) -> Folder {
        Folder { path: self.folder().to_owned() }
    }
}
