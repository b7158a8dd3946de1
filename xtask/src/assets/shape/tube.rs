//! Tubes: an oval carried along a plane curve.

use nalgebra::{Point3, Vector3};
use robotc_core::model::TriMesh;

use super::{Ring, circle, skin};

/// Carries an oval along a path in the x-z plane; `half` is half its width along y and half its thickness in the
/// plane of the path.
pub(crate) fn tube(path: &[[f64; 2]], half: [f64; 2], around: usize) -> TriMesh {
    let point = |i: usize| Point3::new(path[i][0], 0.0, path[i][1]);
    let rings: Vec<Ring> = (0..path.len())
        .map(|i| {
            let along = (point((i + 1).min(path.len() - 1)) - point(i.saturating_sub(1))).normalize();
            let across = Vector3::y();
            let out = along.cross(&across);
            circle(around).map(|[c, s]| point(i) + across * (half[0] * s) - out * (half[1] * c)).collect()
        })
        .collect();
    skin(&rings)
}
