//! Triangle meshes from STL, OBJ and COLLADA files.
//!
//! The readers are our own: they give double precision, place every instance of a COLLADA scene, and never panic on a
//! bad file.

mod dae;
mod format;
mod obj;
mod repair;
mod stl;

pub use format::MeshFormat;
pub use repair::Repairs;

use std::sync::Arc;

use thiserror::Error;

use crate::model::TriMesh;

/// Which way is up in the file's own coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UpAxis {
    /// The x axis.
    X,
    /// The y axis.
    Y,
    /// The z axis.
    Z,
}

/// A mesh as read.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadedMesh {
    /// The triangles; at least one. COLLADA units and node transforms are applied, so COLLADA comes in metres; STL and
    /// OBJ come in whatever unit they were written in. The axes are the file's: see `up`.
    pub mesh: Arc<TriMesh>,
    /// What the file turned out to be.
    pub format: MeshFormat,
    /// What a COLLADA file declares; `None` for the other formats and when it declares nothing.
    ///
    /// It is not applied: descriptions of robots mean the coordinates as they stand, whatever the file declares (RViz
    /// and MoveIt undo the turn that their importer makes).
    pub up: Option<UpAxis>,
    /// What had to be dropped.
    pub repairs: Repairs,
}

/// Why a file gives no mesh.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
pub enum MeshError {
    /// The content is no mesh format known here.
    #[error("not an STL, OBJ or COLLADA file")]
    UnknownFormat,
    /// The file ends early or contradicts itself.
    #[error("{0}")]
    Malformed(String),
    /// A coordinate is not a finite number.
    #[error("vertex {0} has a coordinate that is not a finite number")]
    NotFinite(usize),
    /// No triangle with an area is left.
    #[error("holds no triangles")]
    Empty,
    /// More triangles than any robot needs: an error, or an attack.
    #[error("holds more than {0} triangles")]
    TooLarge(usize),
}

/// Most triangles of one mesh.
const MOST_FACES: usize = 10_000_000;

/// Reads a mesh. The content decides the format; `extension` (without its dot, any case) decides when that is silent.
pub fn read(bytes: &[u8], extension: &str) -> Result<LoadedMesh, MeshError> {
    let format = MeshFormat::of(bytes, extension).ok_or(MeshError::UnknownFormat)?;
    let (raw, up) = match format {
        MeshFormat::Stl => (stl::read(bytes)?, None),
        MeshFormat::Obj => (obj::read(bytes)?, None),
        MeshFormat::Dae => dae::read(bytes)?,
    };
    let (mesh, repairs) = repair::repaired(raw)?;
    Ok(LoadedMesh { mesh: Arc::new(mesh), format, up, repairs })
}
