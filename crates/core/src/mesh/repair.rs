//! From what a file holds to a mesh that geometry can rely on.

use std::collections::HashMap;

use nalgebra::Point3;

use super::MeshError;
use crate::model::TriMesh;

/// Vertices and faces as a file holds them; indices may point anywhere.
#[derive(Debug, Default)]
pub(super) struct RawMesh {
    pub(super) vertices: Vec<[f64; 3]>,
    pub(super) faces: Vec<[i64; 3]>,
}

impl RawMesh {
    /// Appends a triangle with corners of its own.
    pub(super) fn push_triangle(&mut self, corners: [[f64; 3]; 3]) {
        let first = self.vertices.len() as i64;
        self.vertices.extend(corners);
        self.faces.push([first, first + 1, first + 2]);
    }

    /// Appends a polygon of existing vertices as a fan.
    pub(super) fn push_polygon(&mut self, indices: &[i64]) {
        for i in 2..indices.len() {
            self.faces.push([indices[0], indices[i - 1], indices[i]]);
        }
    }
}

/// What was dropped from a mesh; all zero for a clean file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Repairs {
    /// Faces that named a vertex which does not exist.
    pub bad_indices: usize,
    /// Faces without area: two corners in one place.
    pub degenerate: usize,
}

impl Repairs {
    /// Whether anything was dropped that a user should know of: faces that name missing vertices.
    pub fn are_serious(&self) -> bool {
        self.bad_indices > 0
    }
}

/// The faces of `raw` that are triangles, over the vertices they use, equal vertices merged.
///
/// Vertices come in the order in which faces use them, so the result does not depend on unused ones.
pub(super) fn repaired(raw: RawMesh) -> Result<(TriMesh, Repairs), MeshError> {
    let mut repairs = Repairs::default();
    let mut mesh = TriMesh::default();
    let mut index_of: HashMap<[u64; 3], u32> = HashMap::with_capacity(raw.vertices.len());
    for face in &raw.faces {
        let corners = face.map(|i| usize::try_from(i).ok().and_then(|i| Some((i, *raw.vertices.get(i)?))));
        let [Some(a), Some(b), Some(c)] = corners else {
            repairs.bad_indices += 1;
            continue;
        };
        for (i, corner) in [a, b, c] {
            if !corner.iter().all(|x| x.is_finite()) {
                return Err(MeshError::NotFinite(i));
            }
        }
        if a.1 == b.1 || b.1 == c.1 || c.1 == a.1 {
            repairs.degenerate += 1;
            continue;
        }
        mesh.faces.push([a, b, c].map(|(_, corner)| {
            // Adding zero turns -0 into 0, so that both are one vertex.
            let corner = corner.map(|x| x + 0.0);
            *index_of.entry(corner.map(f64::to_bits)).or_insert_with(|| {
                mesh.vertices.push(Point3::from(corner));
                mesh.vertices.len() as u32 - 1
            })
        }));
    }
    if mesh.faces.is_empty() { Err(MeshError::Empty) } else { Ok((mesh, repairs)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_faces_are_dropped_and_counted() {
        let raw = RawMesh {
            vertices: vec![[9.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, 0.0, 0.0]],
            faces: vec![[1, 2, 3], [1, 2, 7], [1, 2, -1], [1, 4, 2], [3, 4, 2]],
        };
        let (mesh, repairs) = repaired(raw).unwrap();
        assert_eq!(repairs, Repairs { bad_indices: 2, degenerate: 1 });
        assert_eq!(mesh.faces, [[0, 1, 2], [2, 0, 1]]);
        assert_eq!(mesh.vertices.len(), 3);
    }

    #[test]
    fn not_a_number_is_refused() {
        let raw = RawMesh { vertices: vec![[f64::NAN; 3], [0.0; 3], [1.0; 3]], faces: vec![[0, 1, 2]] };
        assert_eq!(repaired(raw).unwrap_err(), MeshError::NotFinite(0));
        assert_eq!(repaired(RawMesh::default()).unwrap_err(), MeshError::Empty);
    }
}
