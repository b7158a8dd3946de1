//! Convex covers: a polytope round a body, bounded by planes in given directions.

use nalgebra::{Matrix3, Point3, Vector3};
use robotc_core::geom::ConvexPart;
use robotc_core::model::TriMesh;

use super::circle;

/// Air between a body and its cover, metres; also the distance below which corners of the cover are one. Covers stay
/// light, and rounding their numbers does not cut into the body.
const MARGIN: f64 = 4e-4;

/// Directions of a cover: `around` at right angles to `axis`, as many at 45 degrees towards both ends, and the ends.
pub(crate) fn directions(axis: Vector3<f64>, around: usize) -> Vec<Vector3<f64>> {
    let axis = axis.normalize();
    let across =
        if axis.x.abs() < 0.9 { axis.cross(&Vector3::x()) } else { axis.cross(&Vector3::y()) }.normalize();
    let third = axis.cross(&across);
    let mut all = vec![axis, -axis];
    for [c, s] in circle(around) {
        let radial = across * c + third * s;
        all.extend([radial, (radial + axis).normalize(), (radial - axis).normalize()]);
    }
    all
}

/// The convex polytope bounded by the planes that touch `points` in `directions`, which must enclose space.
pub(crate) fn enclosing(points: &[Point3<f64>], directions: &[Vector3<f64>]) -> TriMesh {
    let reach = |n: &Vector3<f64>| points.iter().map(|p| n.dot(&p.coords)).fold(f64::NEG_INFINITY, f64::max);
    let planes: Vec<(Vector3<f64>, f64)> = directions.iter().map(|n| (*n, reach(n) + MARGIN)).collect();
    let mut corners: Vec<Point3<f64>> = Vec::new();
    for (i, a) in planes.iter().enumerate() {
        for (j, b) in planes.iter().enumerate().skip(i + 1) {
            for c in &planes[j + 1..] {
                let normals = Matrix3::from_rows(&[a.0.transpose(), b.0.transpose(), c.0.transpose()]);
                if normals.determinant().abs() < 1e-3 {
                    continue;
                }
                let Some(inverse) = normals.try_inverse() else { continue };
                let corner = Point3::from(inverse * Vector3::new(a.1, b.1, c.1));
                let is_inside = planes.iter().all(|(n, d)| n.dot(&corner.coords) <= d + 1e-7);
                if is_inside && corners.iter().all(|other| (other - corner).norm() > MARGIN) {
                    corners.push(corner);
                }
            }
        }
    }
    ConvexPart::hull_of(&corners).expect("planes enclose a body").mesh()
}
