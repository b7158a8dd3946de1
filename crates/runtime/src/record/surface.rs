//! Surfaces as they are drawn: triangles with a normal at each corner.

use std::collections::HashMap;

use nalgebra::{Point3, Vector3};
use robotc_core::model::TriMesh;

/// Cosine of the crease angle, 36 degrees: faces that meet at a sharper edge keep their own normals.
const CREASE_COSINE: f64 = 0.81;

/// A triangle mesh with normals, in its own frame.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Surface {
    /// Vertex positions, metres.
    pub positions: Vec<[f32; 3]>,
    /// Unit normal of each vertex.
    pub normals: Vec<[f32; 3]>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// The surface of a mesh: smooth where faces meet at less than the crease angle, sharp elsewhere.
    ///
    /// Corners at the same place are one, whether the file shared them or not. Faces without area are left out. The
    /// normal of a corner is the mean over the faces around it that are within the crease angle of its own face,
    /// weighted by area.
    pub fn smoothed(mesh: &TriMesh) -> Self {
        let (welded, corner_ids) = weld(&mesh.vertices);
        let faces: Vec<[u32; 3]> = mesh.faces.iter().map(|f| f.map(|v| corner_ids[v as usize])).collect();
        let area_vectors: Vec<Vector3<f64>> =
            (0..mesh.faces.len()).map(|face| mesh.area_vector(face)).collect();
        let unit_normals: Vec<Option<Vector3<f64>>> =
            area_vectors.iter().map(|n| n.try_normalize(1e-16)).collect();

        let mut faces_around = vec![Vec::new(); welded.len()];
        for (face, corners) in faces.iter().enumerate() {
            if unit_normals[face].is_some() {
                for &corner in corners {
                    faces_around[corner as usize].push(face);
                }
            }
        }

        let mut surface = Self::default();
        let mut vertex_of: HashMap<(u32, [i16; 3]), u32> = HashMap::new();
        for (face, corners) in faces.iter().enumerate() {
            let Some(own) = unit_normals[face] else { continue };
            let triangle = corners.map(|corner| {
                let around = faces_around[corner as usize].iter();
                let smooth =
                    around.filter(|&&f| unit_normals[f].is_some_and(|n| n.dot(&own) > CREASE_COSINE));
                let sum: Vector3<f64> = smooth.map(|&f| area_vectors[f]).sum();
                let normal = sum.try_normalize(1e-16).unwrap_or(own);
                let rounded = [0, 1, 2].map(|axis| (normal[axis] * 4096.0).round() as i16);
                *vertex_of
                    .entry((corner, rounded))
                    .or_insert_with(|| surface.push_vertex(&welded[corner as usize], &normal))
            });
            surface.triangles.push(triangle);
        }
        surface
    }

    /// Adds a vertex and returns its index.
    pub(super) fn push_vertex(&mut self, position: &Point3<f64>, normal: &Vector3<f64>) -> u32 {
        self.positions.push([position.x as f32, position.y as f32, position.z as f32]);
        self.normals.push([normal.x as f32, normal.y as f32, normal.z as f32]);
        self.positions.len() as u32 - 1
    }

    /// Lowest and highest corner of the box around the vertices; `None` without vertices.
    pub fn bounds(&self) -> Option<([f32; 3], [f32; 3])> {
        let first = *self.positions.first()?;
        Some(self.positions.iter().fold((first, first), |(mut low, mut high), p| {
            for axis in 0..3 {
                low[axis] = low[axis].min(p[axis]);
                high[axis] = high[axis].max(p[axis]);
            }
            (low, high)
        }))
    }
}

/// The distinct places among `vertices`, and which of them each vertex is at.
fn weld(vertices: &[Point3<f64>]) -> (Vec<Point3<f64>>, Vec<u32>) {
    let mut places = Vec::new();
    let mut place_of: HashMap<[u32; 3], u32> = HashMap::new();
    let ids = vertices
        .iter()
        .map(|v| {
            // Adding zero makes -0 and 0 one place.
            let key = [v.x, v.y, v.z].map(|x| (x as f32 + 0.0).to_bits());
            *place_of.entry(key).or_insert_with(|| {
                places.push(*v);
                places.len() as u32 - 1
            })
        })
        .collect();
    (places, ids)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two unit squares that share the y axis and meet at `angle` from flat, given as a soup of triangles.
    fn fold(angle: f64) -> TriMesh {
        let (s, c) = (libm::sin(angle), libm::cos(angle));
        let p = Point3::new;
        let corners = [
            [p(-1.0, 0.0, 0.0), p(0.0, 0.0, 0.0), p(0.0, 1.0, 0.0)],
            [p(-1.0, 0.0, 0.0), p(0.0, 1.0, 0.0), p(-1.0, 1.0, 0.0)],
            [p(0.0, 0.0, 0.0), p(c, 0.0, s), p(c, 1.0, s)],
            [p(0.0, 0.0, 0.0), p(c, 1.0, s), p(-0.0, 1.0, 0.0)],
        ];
        let faces = (0..4).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        TriMesh { vertices: corners.concat(), faces }
    }

    #[test]
    fn gentle_folds_share_vertices_and_sharp_ones_do_not() {
        for (angle, expected) in [(0.0, 6), (0.3, 6), (1.0, 8), (1.6, 8)] {
            let surface = Surface::smoothed(&fold(angle));
            assert_eq!(surface.positions.len(), expected, "fold of {angle} rad");
            assert_eq!(surface.triangles.len(), 4);
        }
    }

    #[test]
    fn normals_are_unit_and_faces_without_area_are_left_out() {
        let mut mesh = fold(0.5);
        mesh.faces.push([0, 0, 1]);
        let surface = Surface::smoothed(&mesh);
        assert_eq!(surface.triangles.len(), 4);
        for n in &surface.normals {
            assert!((n.iter().map(|x| x * x).sum::<f32>() - 1.0).abs() < 1e-5);
        }
    }
}
