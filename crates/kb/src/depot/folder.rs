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

    fn write(&self, name: &str, bytes: &[u8], replace: bool) -> io::Result<()> {
        let path = self.file(name);
        let parent = path.parent().unwrap_or(&self.path);
        // Another process may have finished the artefact and removed the folder in between.
        for last in [false, true] {
            fs::create_dir_all(parent)?;
            match write_whole(parent, &path, bytes, replace) {
                Err(error) if error.kind() == ErrorKind::NotFound && !last => {}
                result => return result,
            }
        }
        Ok(())
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
        self.write(name, bytes, true).map_err(|error| failed(&self.file(name), error))
    }

    fn put_new(&self, name: &str, bytes: &[u8]) -> Result<bool, DepotError> {
        match self.write(name, bytes, false) {
            Ok(()) => Ok(true),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => Ok(false),
            Err(error) => Err(failed(&self.file(name), error)),
        }
    }

    fn remove(&self, name: &str) -> Result<(), DepotError> {
        let path = self.file(name);
        match fs::remove_file(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(failed(&path, error)),
            _ => Ok(()),
        }
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

    fn names(&self, folder: &str) -> Result<Vec<String>, DepotError> {
        let path = self.file(folder);
        match names(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
            names => names.map_err(|error| failed(&path, error)),
        }
    }
}

fn write_whole(parent: &Path, path: &Path, bytes: &[u8], replace: bool) -> io::Result<()> {
    // Hidden, so that it is no object yet.
    let mut file = tempfile::Builder::new().prefix(".").tempfile_in(parent)?;
    file.write_all(bytes)?;
    if replace {
        file.persist(path)?
    } else {
        file.persist_noclobber(path)?
    };
    Ok(())
}

fn names(folder: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_file()
            && let Ok(name) = entry.file_name().into_string()
            && !name.starts_with('.')
        {
            names.push(name);
        }
    }
    names.sort();
    Ok(names)
}

/// A store keeps the pieces of what it is computing beside its artefacts.
impl Depot for crate::Store {
    fn get(&self, name: &str) -> Result<Option<Vec<u8>>, DepotError> {
        self.beside().get(name)
    }

    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), DepotError> {
        self.beside().put(name, bytes)
    }

    fn put_new(&self, name: &str, bytes: &[u8]) -> Result<bool, DepotError> {
        self.beside().put_new(name, bytes)
    }

    fn remove(&self, name: &str) -> Result<(), DepotError> {
        self.beside().remove(name)
    }

    fn remove_all(&self, folder: &str) -> Result<(), DepotError> {
        self.beside().remove_all(folder)
    }

    fn names(&self, folder: &str) -> Result<Vec<String>, DepotError> {
        self.beside().names(folder)
    }
}

impl crate::Store {
    fn beside(&self) -> Folder {
        Folder { path: self.folder().to_owned() }
    }
}
