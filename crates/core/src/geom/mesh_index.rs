//! Rays against triangle meshes, and nearest points on them.

use std::sync::Arc;

use nalgebra::{Point3, Unit, Vector3};

use super::Aabb;
use super::bvh::Bvh;
use crate::model::TriMesh;

/// Where a ray meets a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    /// Distance along the ray in lengths of its direction.
    pub at: f64,
    /// The point, in the mesh's frame.
    pub point: Point3<f64>,
    /// Unit normal of the face by the right-hand rule: against the ray where it enters a mesh whose faces are
    /// outward, along it where it leaves.
    pub normal: Unit<Vector3<f64>>,
    /// The face.
    pub face: u32,
}

/// The point of a mesh nearest to some other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestPoint {
    /// The point, in the mesh's frame.
    pub point: Point3<f64>,
    /// Its distance, metres.
    pub distance: f64,
    /// A face it lies on.
    pub face: u32,
}

/// A triangle mesh ready for queries. Immutable; clones share their data. Faces without area are left out; face
/// numbers are those of the mesh it was made from.
#[derive(Debug, Clone)]
pub struct MeshIndex(Arc<Data>);

#[derive(Debug)]
struct Data {
    triangles: Vec<[Point3<f64>; 3]>,
    faces: Vec<u32>,
    tree: Bvh,
}

impl MeshIndex {
    /// The index of a mesh. Faces that refer to missing vertices are left out.
    pub fn new(mesh: &TriMesh) -> Self {
        let mut triangles = Vec::with_capacity(mesh.faces.len());
        let mut faces = Vec::with_capacity(mesh.faces.len());
        for (i, face) in mesh.faces.iter().enumerate() {
            if face.iter().any(|&v| v as usize >= mesh.vertices.len()) {
                continue;
            }
            let area = mesh.area_vector(i).norm();
            if area > 0.0 && area.is_finite() {
                triangles.push(mesh.triangle(i));
                faces.push(i as u32);
            }
        }
        Self::of_triangles(triangles, faces)
    }

    pub(super) fn of_triangles(triangles: Vec<[Point3<f64>; 3]>, faces: Vec<u32>) -> Self {
        let boxes: Vec<Aabb> =
            triangles.iter().map(|t| Aabb::of_points(t).expect("a triangle has points")).collect();
        let tree = Bvh::new(&boxes);
        Self(Arc::new(Data { triangles, faces, tree }))
    }

    /// Whether there is no face to hit.
    pub fn is_empty(&self) -> bool {
        self.0.triangles.is_empty()
    }

    /// The first hit of the ray within `limit` lengths of its direction. Both sides of a face count.
    pub fn first_hit(&self, origin: &Point3<f64>, direction: &Vector3<f64>, limit: f64) -> Option<RayHit> {
        let mut best: Option<(f64, u32)> = None;
        self.0.tree.ray(origin, direction, limit, |item, limit| {
            match ray_triangle(origin, direction, &self.0.triangles[item as usize]) {
                // Equal distances go to the lower face, so that the tree's shape does not show.
                Some(at) if at <= limit && best.is_none_or(|b| (at, item) < b) => {
                    best = Some((at, item));
                    at
                }
                _ => limit,
            }
        });
        best.map(|(at, item)| self.hit(origin, direction, at, item))
    }

    /// All hits of the ray within `limit` lengths of its direction, nearest first; a ray through an edge hits both
    /// of its faces.
    pub fn all_hits(&self, origin: &Point3<f64>, direction: &Vector3<f64>, limit: f64) -> Vec<RayHit> {
        let mut found = Vec::new();
        self.0.tree.ray(origin, direction, limit, |item, _| {
            if let Some(at) = ray_triangle(origin, direction, &self.0.triangles[item as usize])
                && at <= limit
            {
                found.push((at, item));
            }
            limit
        });
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.into_iter().map(|(at, item)| self.hit(origin, direction, at, item)).collect()
    }

    fn hit(&self, origin: &Point3<f64>, direction: &Vector3<f64>, at: f64, item: u32) -> RayHit {
        let [a, b, c] = &self.0.triangles[item as usize];
        let normal = Unit::new_normalize((b - a).cross(&(c - a)));
        RayHit { at, point: origin + direction * at, normal, face: self.0.faces[item as usize] }
    }

    /// The nearest point of the mesh within `limit` metres of `point`.
    pub fn nearest(&self, point: &Point3<f64>, limit: f64) -> Option<NearestPoint> {
        self.near_enough(point, limit, -1.0)
    }

    /// The nearest point within `limit` metres, or any that is within `enough`.
    pub(super) fn near_enough(&self, point: &Point3<f64>, limit: f64, enough: f64) -> Option<NearestPoint> {
        let mut best: Option<(f64, u32, Point3<f64>)> = None;
        self.0.tree.near(point, limit, |item, limit| {
            let candidate = nearest_on_triangle(point, &self.0.triangles[item as usize]);
            let distance = (candidate - point).norm();
            if distance <= limit && best.is_none_or(|b| (distance, item) < (b.0, b.1)) {
                best = Some((distance, item, candidate));
                return if distance <= enough { -1.0 } else { distance };
            }
            limit
        });
        best.map(|(distance, item, point)| NearestPoint {
            point,
            distance,
            face: self.0.faces[item as usize],
        })
    }
}

/// Distance along the ray to the triangle, edges included (Moller and Trumbore 1997, both sides).
fn ray_triangle(origin: &Point3<f64>, direction: &Vector3<f64>, triangle: &[Point3<f64>; 3]) -> Option<f64> {
    let [a, b, c] = triangle;
    let (ab, ac) = (b - a, c - a);
    let p = direction.cross(&ac);
    let determinant = ab.dot(&p);
    if determinant == 0.0 {
        return None;
    }
    let to_origin = origin - a;
    let u = to_origin.dot(&p) / determinant;
    let q = to_origin.cross(&ab);
    let v = direction.dot(&q) / determinant;
    // A hair beyond the edges, so that no ray slips between two faces.
    const EDGE: f64 = 1e-12;
    if u < -EDGE || v < -EDGE || u + v > 1.0 + EDGE {
        return None;
    }
    let at = ac.dot(&q) / determinant;
    (at >= 0.0).then_some(at)
}

/// The nearest point of a triangle, by the regions of its corners, edges and face (Ericson 2005, section 5.1.5).
pub(super) fn nearest_on_triangle(point: &Point3<f64>, triangle: &[Point3<f64>; 3]) -> Point3<f64> {
    let [a, b, c] = triangle;
    let (ab, ac) = (b - a, c - a);
    let ap = point - a;
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return *a;
    }
    let bp = point - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return *b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = point - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return *c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let sum = va + vb + vc;
    a + ab * (vb / sum) + ac * (vc / sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::{Rng, Seed};
    use parry3d_f64::math::Vector;
    use parry3d_f64::query::{PointQuery, Ray, RayCast};

    fn soup(rng: &mut Rng, faces: usize) -> TriMesh {
        let mut point = |c: Vector3<f64>| Point3::from(c + rng.direction().into_inner() * 0.2);
        let mut mesh = TriMesh::default();
        for i in 0..faces as u32 {
            let centre = point(Vector3::new(0.0, 0.0, f64::from(i % 7) * 0.1)).coords;
            mesh.vertices.extend([point(centre), point(centre), point(centre)]);
            mesh.faces.push([3 * i, 3 * i + 1, 3 * i + 2]);
        }
        mesh
    }

    #[test]
    fn rays_and_nearest_points_agree_with_the_library() {
        let mut rng = Seed::new(5).rng();
        let mesh = soup(&mut rng, 200);
        let index = MeshIndex::new(&mesh);
        let to = |p: &Point3<f64>| Vector::new(p.x, p.y, p.z);
        let reference =
            parry3d_f64::shape::TriMesh::new(mesh.vertices.iter().map(to).collect(), mesh.faces.clone())
                .expect("a mesh with faces");
        let mut hits = 0;
        for _ in 0..500 {
            let origin = Point3::from(rng.direction().into_inner() * rng.range(0.0, 1.5));
            let direction = rng.direction().into_inner() * 2.0;
            let ray = Ray::new(to(&origin), to(&Point3::from(direction)));
            let expected = reference.cast_local_ray(&ray, 10.0, false);
            let found = index.first_hit(&origin, &direction, 10.0);
            assert_eq!(found.map(|h| (h.at * 1e9).round()), expected.map(|t| (t * 1e9).round()));
            let all = index.all_hits(&origin, &direction, 10.0);
            assert_eq!(all.first(), found.as_ref());
            let brute =
                (0..200).filter(|&f| ray_triangle(&origin, &direction, &mesh.triangle(f)).is_some()).count();
            assert_eq!(all.len(), brute);
            hits += brute;
            let nearest = index.nearest(&origin, f64::INFINITY).expect("the mesh has faces");
            let expected = reference.distance_to_local_point(to(&origin), false);
            assert!((nearest.distance - expected).abs() < 1e-9);
            assert!(index.nearest(&origin, nearest.distance * 0.99).is_none());
        }
        assert!(hits > 100, "the test must hit something: {hits}");
    }

    #[test]
    fn faces_without_area_or_vertices_are_left_out() {
        let mesh = TriMesh {
            vertices: vec![Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)],
            faces: vec![[0, 0, 1], [0, 1, 9], [0, 1, 2]],
        };
        let index = MeshIndex::new(&mesh);
        let hit = index.first_hit(&Point3::new(0.2, 0.2, 1.0), &-Vector3::z(), 2.0).expect("hits");
        assert_eq!((hit.face, hit.at), (2, 1.0));
        assert!(MeshIndex::new(&TriMesh::default()).is_empty());
    }
}
