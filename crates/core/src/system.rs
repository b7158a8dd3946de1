//! The one door to files and clock, so that the core stays pure and tests run in memory.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use thiserror::Error;

use crate::mesh::{self, LoadedMesh, MeshError};

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

/// Why a file gives no mesh.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
pub enum MeshFileError {
    /// It could not be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// It holds none.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Files as seen by the compiler.
pub trait System: Send + Sync {
    /// The bytes of the file at `path`.
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadError>;

    /// Whether `path` names an existing file or folder.
    fn exists(&self, path: &Path) -> bool;

    /// The mesh in the file at `path`. The content decides the format, or the path's extension when that is silent.
    fn mesh(&self, path: &Path) -> Result<Arc<LoadedMesh>, MeshFileError> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        Ok(Arc::new(mesh::read(&self.read(path)?, extension)?))
    }
}

/// What reading a mesh gave, once that is known.
type KnownMesh = Arc<OnceLock<Result<Arc<LoadedMesh>, MeshFileError>>>;

/// Another system whose meshes are read once: several specifications of one command often share a robot.
#[derive(Debug, Default)]
pub struct MeshesOnce<S> {
    system: S,
    meshes: Mutex<BTreeMap<PathBuf, KnownMesh>>,
}

impl<S: System> System for MeshesOnce<S> {
    fn read(&self, path: &Path) -> Result<Vec<u8>, ReadError> {
        self.system.read(path)
    }

    fn exists(&self, path: &Path) -> bool {
        self.system.exists(path)
    }

    fn mesh(&self, path: &Path) -> Result<Arc<LoadedMesh>, MeshFileError> {
        let mut meshes = self.meshes.lock().unwrap_or_else(PoisonError::into_inner);
        let known = meshes.entry(path.to_owned()).or_default().clone();
        drop(meshes);
        known.get_or_init(|| self.system.mesh(path)).clone()
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_is_read_once_and_so_is_what_is_none() {
        let mut files = MemorySystem::new();
        files.insert("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        files.insert("b.obj", "v 0 0 0\n");
        let once = MeshesOnce { system: files, meshes: Mutex::default() };
        let first = once.mesh(Path::new("a.obj")).unwrap();
        assert!(Arc::ptr_eq(&first, &once.mesh(Path::new("a.obj")).unwrap()));
        assert_eq!(once.mesh(Path::new("b.obj")), Err(MeshFileError::Mesh(MeshError::Empty)));
        assert_eq!(once.mesh(Path::new("c.obj")), Err(MeshFileError::Read(ReadError::NotFound)));
        assert_eq!(once.meshes.lock().unwrap().len(), 3);
    }
}
