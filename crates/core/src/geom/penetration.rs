//! How deep two overlapping polytopes are in each other: exact, by the faces of their difference.

use nalgebra::{Isometry3, Vector3};

use super::ConvexPart;

/// The shortest way out.
pub(super) struct Exit {
    /// Unit direction, in the frame of a: moving b along it by `depth` separates the parts.
    pub(super) normal: Vector3<f64>,
    /// How far, metres; negative when the parts are apart along `normal`.
    pub(super) depth: f64,
}

/// The shortest translation of b that separates it from a.
///
/// Faces of the difference a - b are a face of one part against a corner of the other, or an edge against an edge;
/// an edge pair counts only when the arcs of their face normals cross on the unit sphere (van den Bergen 2003).
pub(super) fn shortest_exit(a: &ConvexPart, b: &ConvexPart, a_from_b: &Isometry3<f64>) -> Exit {
    let rotation = *a_from_b.rotation.to_rotation_matrix().matrix();
    let shift = a_from_b.translation.vector;
    let b_support =
        |direction: &Vector3<f64>| rotation * b.support(&rotation.tr_mul(direction)).coords + shift;
    let mut best = Exit { normal: Vector3::z(), depth: f64::INFINITY };
    let mut consider = |normal: Vector3<f64>, depth: f64| {
        if depth < best.depth {
            best = Exit { normal, depth };
        }
    };
    for plane in a.planes() {
        let normal = plane.normal.into_inner();
        consider(normal, plane.offset - normal.dot(&b_support(&-normal)));
    }
    for plane in b.planes() {
        let normal = -(rotation * plane.normal.into_inner());
        let b_height = plane.offset - normal.dot(&shift);
        consider(normal, normal.dot(&a.support(&normal).coords) + b_height);
    }
    let b_edges: Vec<_> = b
        .edges()
        .iter()
        .map(|e| {
            let [p, q] = e.ends.map(|i| rotation * b.points()[i as usize].coords + shift);
            (p, q - p, e.normals.map(|n| -(rotation * n)))
        })
        .collect();
    let middle_a = a.points().iter().map(|p| p.coords).sum::<Vector3<f64>>() / a.points().len() as f64;
    for edge in a.edges() {
        let [p, q] = edge.ends.map(|i| a.points()[i as usize].coords);
        let [n0, n1] = edge.normals;
        let along = q - p;
        let arc = n1.cross(&n0);
        for (b_start, b_along, [m0, m1]) in &b_edges {
            let (m0_side, m1_side) = (m0.dot(&arc), m1.dot(&arc));
            if m0_side * m1_side >= 0.0 {
                continue;
            }
            let b_arc = m1.cross(m0);
            let (n0_side, n1_side) = (n0.dot(&b_arc), n1.dot(&b_arc));
            if n0_side * n1_side >= 0.0 || m0_side * n1_side <= 0.0 {
                continue;
            }
            let Some(normal) = along.cross(b_along).try_normalize(1e-9 * along.norm() * b_along.norm())
            else {
                continue;
            };
            let normal = if normal.dot(&(p - middle_a)) < 0.0 { -normal } else { normal };
            consider(normal, normal.dot(&(p - b_start)));
        }
    }
    best
}
