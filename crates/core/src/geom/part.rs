//! One convex polytope.

use std::sync::{Arc, OnceLock};

use nalgebra::{Point3, Unit, Vector3};
use thiserror::Error;

use super::climb::Climb;
use super::hull::{Hull, HullError, convex_hull, facet_normal, is_closed};
use super::{Aabb, MeshIndex};
use crate::Pose;
use crate::model::TriMesh;

/// The half space of points with `normal . p <= offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Outward normal.
    pub normal: Unit<Vector3<f64>>,
    /// Signed distance of the plane from the origin along the normal, metres.
    pub offset: f64,
}

impl Plane {
    /// Signed distance of a point, positive outside; metres.
    pub fn height(&self, point: &Point3<f64>) -> f64 {
        self.normal.dot(&point.coords) - self.offset
    }
}

/// Why points and triangles are not a convex polytope.
#[derive(Debug, Clone, Copy, Error, PartialEq, Eq)]
pub enum PartError {
    /// A coordinate is infinite or not a number.
    #[error("a coordinate of a convex part is not a finite number")]
    NotFinite,
    /// A triangle refers to a point that does not exist.
    #[error("a triangle of a convex part refers to a point that does not exist")]
    BadIndex,
    /// The triangles do not form one closed surface that uses every point.
    #[error("the triangles of a convex part do not close its surface")]
    NotClosed,
    /// Some point lies outside the plane of a triangle.
    #[error("the surface of a convex part is not convex, or its triangles face inwards")]
    NotConvex,
}

/// An edge between two faces that are not in one plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct PartEdge {
    pub(super) ends: [u32; 2],
    pub(super) normals: [Vector3<f64>; 2],
}

#[derive(Debug)]
struct Data {
    points: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
    planes: Vec<Plane>,
    edges: Vec<PartEdge>,
    bounds: Aabb,
    centre: Point3<f64>,
    radius: f64,
    volume: f64,
    /// For parts with many corners, made when first asked for.
    climb: OnceLock<Climb>,
}

/// A convex polytope with volume: points, outward triangles and face planes, in metres, in the frame of whatever
/// owns it. Immutable; clones share their data.
#[derive(Debug, Clone)]
pub struct ConvexPart(Arc<Data>);

impl PartialEq for ConvexPart {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
            || (self.0.points == other.0.points && self.0.triangles == other.0.triangles)
    }
}

/// With more corners than this, support points are found by climbing along edges rather than by looking at all.
const MANY_CORNERS: usize = 64;

/// Triangles whose normals differ by less than this (sine of the angle) count as one face.
const COPLANAR: f64 = 1e-7;

/// How far a point may lie outside a face before [`ConvexPart::from_raw`] refuses it, as a fraction of the size.
const CONVEXITY_TOLERANCE: f64 = 1e-6;

impl ConvexPart {
    /// The convex hull of `points`. Covers every one of them; flat input is thickened a little, so that the result
    /// always has volume.
    pub fn hull_of(points: &[Point3<f64>]) -> Result<Self, HullError> {
        Ok(Self::from_hull(convex_hull(points)?))
    }

    /// A part from stored points and triangles, checked: finite, closed, convex, outward.
    pub fn from_raw(points: Vec<Point3<f64>>, triangles: Vec<[u32; 3]>) -> Result<Self, PartError> {
        let bounds = Aabb::of_points(&points).ok_or(PartError::NotClosed)?;
        let size = bounds.diagonal();
        if !size.is_finite() || !points.iter().all(|p| p.coords.iter().all(|x| x.is_finite())) {
            return Err(PartError::NotFinite);
        }
        if triangles.iter().flatten().any(|&i| i as usize >= points.len()) {
            return Err(PartError::BadIndex);
        }
        let mut used = vec![false; points.len()];
        triangles.iter().flatten().for_each(|&i| used[i as usize] = true);
        let hull = Hull { points, triangles };
        if !is_closed(&hull) || used.contains(&false) {
            return Err(PartError::NotClosed);
        }
        for triangle in &hull.triangles {
            let Some(normal) = facet_normal(&hull.points, triangle) else { continue };
            let a = hull.points[triangle[0] as usize];
            if hull.points.iter().any(|p| normal.dot(&(p - a)) > CONVEXITY_TOLERANCE * size) {
                return Err(PartError::NotConvex);
            }
        }
        // Of corners far enough apart it is infinite, or no number.
        if !hull.volume().is_finite() {
            return Err(PartError::NotFinite);
        }
        if hull.volume() <= 0.0 {
            return Err(PartError::NotConvex);
        }
        Ok(Self::from_hull(hull))
    }

    pub(super) fn from_hull(hull: Hull) -> Self {
        let volume = hull.volume();
        let Hull { points, triangles } = hull;
        let bounds = Aabb::of_points(&points).expect("a hull has points");
        let centre = bounds.centre();
        let radius = points.iter().map(|p| (p - centre).norm()).fold(0.0, f64::max);
        let normals = face_normals(&points, &triangles);
        let planes = face_planes(&points, &normals);
        let edges = sharp_edges(&triangles, &normals);
        let climb = OnceLock::new();
        Self(Arc::new(Data { points, triangles, planes, edges, bounds, centre, radius, volume, climb }))
    }

    /// Corners, each once.
    pub fn points(&self) -> &[Point3<f64>] {
        &self.0.points
    }

    /// Surface triangles, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.0.triangles
    }

    /// One plane for each flat face; the part is the set of points below all of them.
    pub fn planes(&self) -> &[Plane] {
        &self.0.planes
    }

    pub(super) fn edges(&self) -> &[PartEdge] {
        &self.0.edges
    }

    /// Axis-aligned box around the part.
    pub fn bounds(&self) -> &Aabb {
        &self.0.bounds
    }

    /// Centre and radius of a sphere around the part.
    pub fn bounding_sphere(&self) -> (Point3<f64>, f64) {
        (self.0.centre, self.0.radius)
    }

    /// Whether the point is inside or on the surface.
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        self.0.planes.iter().all(|plane| plane.height(point) <= 0.0)
    }

    /// The largest height of `point` above a face plane: negative inside, where its size is the distance to the
    /// surface; outside a lower bound of the distance. Metres.
    pub fn height(&self, point: &Point3<f64>) -> f64 {
        self.0.planes.iter().map(|plane| plane.height(point)).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The corner farthest along `direction`, to within rounding.
    pub fn support(&self, direction: &Vector3<f64>) -> &Point3<f64> {
        let points = &self.0.points;
        if points.len() > MANY_CORNERS {
            let climb = self.0.climb.get_or_init(|| Climb::new(points, &self.0.triangles));
            return &points[climb.farthest(points, direction)];
        }
        let mut best = 0;
        let mut best_height = f64::NEG_INFINITY;
        for (i, p) in points.iter().enumerate() {
            let height = p.x * direction.x + p.y * direction.y + p.z * direction.z;
            if height > best_height {
                best_height = height;
                best = i;
            }
        }
        &points[best]
    }

    /// The part moved by `target_from_part`.
    pub fn transformed(&self, target_from_part: &Pose) -> Self {
        let points = self.0.points.iter().map(|p| target_from_part * p).collect();
        Self::from_hull(Hull { points, triangles: self.0.triangles.clone() })
    }

    /// Its surface as a mesh.
    pub fn mesh(&self) -> TriMesh {
        TriMesh { vertices: self.0.points.clone(), faces: self.0.triangles.clone() }
    }

    /// Its surface ready for ray casts.
    pub fn index(&self) -> MeshIndex {
        MeshIndex::new(&self.mesh())
    }

    /// Volume, cubic metres.
    pub fn volume(&self) -> f64 {
        self.0.volume
    }
}

/// Unit normals of the triangles; a sliver takes the normal of a neighbour.
fn face_normals(points: &[Point3<f64>], triangles: &[[u32; 3]]) -> Vec<Vector3<f64>> {
    let own: Vec<Option<Vector3<f64>>> = triangles.iter().map(|t| facet_normal(points, t)).collect();
    let neighbour = |i: usize| {
        let shares_edge = |t: &[u32; 3]| t.iter().filter(|v| triangles[i].contains(v)).count() == 2;
        (0..triangles.len()).filter(|&j| shares_edge(&triangles[j])).find_map(|j| own[j])
    };
    let any = own.iter().copied().flatten().next().unwrap_or_else(Vector3::z);
    (0..triangles.len()).map(|i| own[i].or_else(|| neighbour(i)).unwrap_or(any)).collect()
}

/// One plane for each group of coplanar triangles, pushed out to hold every point.
fn face_planes(points: &[Point3<f64>], normals: &[Vector3<f64>]) -> Vec<Plane> {
    let mut distinct: Vec<Vector3<f64>> = Vec::new();
    for n in normals {
        if !distinct.iter().any(|d| (d - n).norm() < COPLANAR) {
            distinct.push(*n);
        }
    }
    distinct
        .into_iter()
        .map(|n| {
            let offset = points.iter().map(|p| n.dot(&p.coords)).fold(f64::NEG_INFINITY, f64::max);
            Plane { normal: Unit::new_unchecked(n), offset }
        })
        .collect()
}

/// Edges whose two faces differ, each once.
fn sharp_edges(triangles: &[[u32; 3]], normals: &[Vector3<f64>]) -> Vec<PartEdge> {
    let mut directed: Vec<(u32, u32, usize)> = Vec::with_capacity(triangles.len() * 3);
    for (face, &[a, b, c]) in triangles.iter().enumerate() {
        directed.extend([(a, b, face), (b, c, face), (c, a, face)]);
    }
    directed.sort_unstable();
    let mut edges = Vec::new();
    for &(a, b, face) in directed.iter().filter(|e| e.0 < e.1) {
        let opposite = directed.partition_point(|e| (e.0, e.1) < (b, a));
        let Some(&(_, _, other)) = directed.get(opposite) else { continue };
        if (normals[face] - normals[other]).norm() > COPLANAR {
            edges.push(PartEdge { ends: [a, b], normals: [normals[face], normals[other]] });
        }
    }
    edges
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_box() -> ConvexPart {
        super::super::box_part(Vector3::new(1.0, 2.0, 3.0))
    }

    #[test]
    fn a_box_has_six_planes_and_twelve_sharp_edges() {
        let part = unit_box();
        assert_eq!((part.points().len(), part.planes().len(), part.edges().len()), (8, 6, 12));
        assert!((part.volume() - 6.0).abs() < 1e-12);
        assert!(part.contains(&Point3::new(0.5, -1.0, 1.5)));
        assert!(!part.contains(&Point3::new(0.51, 0.0, 0.0)));
        assert!((part.height(&Point3::new(0.4, 0.0, 0.0)) + 0.1).abs() < 1e-12);
    }

    #[test]
    fn raw_parts_round_trip_and_are_checked() {
        let part = unit_box();
        let again = ConvexPart::from_raw(part.points().to_vec(), part.triangles().to_vec());
        assert_eq!(again.as_ref(), Ok(&part));
        let inside_out: Vec<_> = part.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
        assert_eq!(ConvexPart::from_raw(part.points().to_vec(), inside_out), Err(PartError::NotConvex));
        let open = part.triangles()[1..].to_vec();
        assert_eq!(ConvexPart::from_raw(part.points().to_vec(), open), Err(PartError::NotClosed));
        assert_eq!(ConvexPart::from_raw(vec![], vec![]), Err(PartError::NotClosed));
        let stray = vec![[0, 1, 99]];
        assert_eq!(ConvexPart::from_raw(part.points().to_vec(), stray), Err(PartError::BadIndex));
        let vast = part.points().iter().map(|p| p * 1e120).collect();
        assert_eq!(ConvexPart::from_raw(vast, part.triangles().to_vec()), Err(PartError::NotFinite));
        let mut dented = part.points().to_vec();
        dented[7] = Point3::new(-0.2, -0.4, -0.6);
        assert!(ConvexPart::from_raw(dented, part.triangles().to_vec()).is_err());
    }
}
