//! Convex covers: the polytope that touches a set of points in given directions and so contains it.

use nalgebra::{Matrix3, Point3, Vector3};
use robotc_core::model::TriMesh;

use super::circle;

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

/// The convex polytope bounded by the planes that touch `points` in `directions`; the directions must enclose space.
pub(crate) fn enclosing(points: &[Point3<f64>], directions: &[Vector3<f64>]) -> TriMesh {
    let planes: Vec<(Vector3<f64>, f64)> = directions
        .iter()
        .map(|n| (*n, points.iter().map(|p| n.dot(&p.coords)).fold(f64::NEG_INFINITY, f64::max)))
        .collect();
    let mut vertices: Vec<Point3<f64>> = Vec::new();
    for i in 0..planes.len() {
        for j in i + 1..planes.len() {
            for k in j + 1..planes.len() {
                let [a, b, c] = [planes[i], planes[j], planes[k]];
                let normals = Matrix3::from_rows(&[a.0.transpose(), b.0.transpose(), c.0.transpose()]);
                if normals.determinant().abs() < 1e-6 {
                    continue;
                }
                let Some(inverse) = normals.try_inverse() else { continue };
                let corner = Point3::from(inverse * Vector3::new(a.1, b.1, c.1));
                let is_inside = planes.iter().all(|(n, d)| n.dot(&corner.coords) <= d + 1e-7);
                if is_inside && vertices.iter().all(|v| (v - corner).norm() > 1e-5) {
                    vertices.push(corner);
                }
            }
        }
    }
    let mut faces = Vec::new();
    for (normal, distance) in &planes {
        let mut corners: Vec<u32> = (0..vertices.len() as u32)
            .filter(|v| (normal.dot(&vertices[*v as usize].coords) - distance).abs() < 2e-6)
            .collect();
        if corners.len() < 3 {
            continue;
        }
        let middle =
            corners.iter().map(|v| vertices[*v as usize].coords).sum::<Vector3<f64>>() / corners.len() as f64;
        let x_axis = (vertices[corners[0] as usize].coords - middle).normalize();
        let y_axis = normal.cross(&x_axis);
        let angle = |v: &u32| {
            let r = vertices[*v as usize].coords - middle;
            libm::atan2(r.dot(&y_axis), r.dot(&x_axis))
        };
        corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
        faces.extend((1..corners.len() - 1).map(|i| [corners[0], corners[i], corners[i + 1]]));
    }
    TriMesh { vertices, faces }
}
