//! Triangle meshes as loaded: vertices and faces, in metres.

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
