//! Triangle meshes as loaded: vertices and faces, in metres.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};

/// A triangle mesh in metres, in the frame of whatever refers to it. Faces are counter-clockwise seen from outside
/// when the file says so; nothing promises that the surface is closed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriMesh {
    /// Vertex positions.
    pub vertices: Vec<Point3<f64>>,
    /// Vertex indices of each triangle.
    pub faces: Vec<[u32; 3]>,
}

impl TriMesh {
    /// The three corners of a face.
    pub fn triangle(&self, face: usize) -> [Point3<f64>; 3] {
        self.faces[face].map(|v| self.vertices[v as usize])
    }

    /// Twice the area vector of a face: normal direction by the right-hand rule.
    pub fn area_vector(&self, face: usize) -> Vector3<f64> {
        let [a, b, c] = self.triangle(face);
        (b - a).cross(&(c - a))
    }

    /// Lowest and highest corner of the axis-aligned box of the vertices; `None` without vertices.
    pub fn bounds(&self) -> Option<(Point3<f64>, Point3<f64>)> {
        let first = *self.vertices.first()?;
        Some(self.vertices.iter().fold((first, first), |(low, high), v| (low.inf(v), high.sup(v))))
    }

    /// Whether the faces close a surface: each edge is passed as often one way as the other. Vertices at the same place count as
    /// one, and edges without length not at all.
    pub fn is_closed(&self) -> bool {
        // Adding zero makes one of the two zeros.
        let place = |v: u32| self.vertices[v as usize].coords.map(|x| (x + 0.0).to_bits());
        let mut passed: BTreeMap<[[u64; 3]; 2], i64> = BTreeMap::new();
        for face in &self.faces {
            let corners: [[u64; 3]; 3] = face.map(|v| place(v).into());
            for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i], corners[j])) {
                if a < b {
                    *passed.entry([a, b]).or_default() += 1;
                } else if b < a {
                    *passed.entry([b, a]).or_default() -= 1;
                }
            }
        }
        passed.values().all(|sum| *sum == 0)
    }

    /// The same mesh with every vertex multiplied by `factors`; faces are turned when the product mirrors.
    pub fn scaled(&self, factors: Vector3<f64>) -> Self {
        let vertices = self.vertices.iter().map(|v| Point3::from(v.coords.component_mul(&factors))).collect();
        let mirrored = factors.x * factors.y * factors.z < 0.0;
        let faces =
            self.faces.iter().map(|&[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] }).collect();
        Self { vertices, faces }
    }

    /// The same mesh moved by `pose`.
    pub fn transformed(&self, pose: &crate::Pose) -> Self {
        Self { vertices: self.vertices.iter().map(|v| pose * v).collect(), faces: self.faces.clone() }
    }

    /// Appends the triangles of `other`.
    pub fn append(&mut self, other: &Self) {
        let offset = self.vertices.len() as u32;
        self.vertices.extend_from_slice(&other.vertices);
        self.faces.extend(other.faces.iter().map(|f| f.map(|v| v + offset)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::box_part;

    #[test]
    fn a_box_is_closed_until_it_loses_a_face_or_one_is_turned() {
        let mut mesh = box_part(Vector3::new(1.0, 2.0, 3.0)).mesh();
        assert!(mesh.is_closed());
        // Every face with corners of its own, as in an STL file.
        let loose = TriMesh {
            vertices: (0..mesh.faces.len()).flat_map(|face| mesh.triangle(face)).collect(),
            faces: (0..mesh.faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        };
        assert!(loose.is_closed());
        mesh.faces[0].swap(0, 1);
        assert!(!mesh.is_closed());
        mesh.faces.remove(0);
        assert!(!mesh.is_closed());
        assert!(TriMesh::default().is_closed());
    }
}
