//! A link's geometry: what is seen, in up to two colours, and convex covers of what is too curved for primitives.

use nalgebra::Vector3;
use robotc_core::model::TriMesh;

use super::shape::{directions, enclosing, join};

/// The meshes of a link.
#[derive(Debug, Default)]
pub(crate) struct Part {
    name: &'static str,
    shell: TriMesh,
    trim: TriMesh,
    covers: Vec<(&'static str, TriMesh)>,
}

impl Part {
    /// A link with a shell of the first colour.
    pub(crate) fn new(name: &'static str, shell: impl IntoIterator<Item = TriMesh>) -> Self {
        Self { name, shell: join(shell), ..Self::default() }
    }

    /// Adds details in a second colour.
    pub(crate) fn trim(mut self, trim: impl IntoIterator<Item = TriMesh>) -> Self {
        self.trim = join(trim);
        self
    }

    /// Adds a convex cover of `bodies`, with planes turned about `axis`; its file name ends with `suffix`.
    pub(crate) fn cover(mut self, suffix: &'static str, bodies: &[&TriMesh], axis: Vector3<f64>) -> Self {
        let points: Vec<_> = bodies.iter().flat_map(|body| body.vertices.iter().copied()).collect();
        self.covers.push((suffix, enclosing(&points, &directions(axis, 8))));
        self
    }

    /// File names without extension, and meshes.
    pub(crate) fn files(&self) -> impl Iterator<Item = (String, &TriMesh)> {
        let visible =
            [("", &self.shell), ("_trim", &self.trim)].into_iter().filter(|(_, mesh)| !mesh.faces.is_empty());
        let covers = self.covers.iter().map(|(suffix, mesh)| (*suffix, mesh));
        visible.chain(covers).map(|(suffix, mesh)| (format!("{}{suffix}", self.name), mesh))
    }
}
