//! Prisms along z.

use nalgebra::Point3;
use robotc_core::model::TriMesh;

use super::{Ring, skin};

/// A prism over a counter-clockwise outline; all of the outline must be visible from `eye`.
pub(crate) fn prism(outline: &[[f64; 2]], eye: [f64; 2], low: f64, high: f64) -> TriMesh {
    let mut mesh = skin(&[flat(outline, low), flat(outline, high)]);
    let caps = mesh.vertices.len() - 2;
    mesh.vertices[caps] = Point3::new(eye[0], eye[1], low);
    mesh.vertices[caps + 1] = Point3::new(eye[0], eye[1], high);
    mesh
}

/// A prism with a hole: two outlines with the same number of corners, both counter-clockwise.
pub(crate) fn annulus(outside: &[[f64; 2]], inside: &[[f64; 2]], low: f64, high: f64) -> TriMesh {
    let rings = [flat(outside, low), flat(outside, high), flat(inside, high), flat(inside, low)];
    let around = outside.len() as u32;
    let mut mesh = TriMesh { vertices: rings.concat(), faces: Vec::new() };
    for ring in 0..4 {
        let (from, to) = (ring * around, (ring + 1) % 4 * around);
        for i in 0..around {
            let j = (i + 1) % around;
            mesh.faces.push([from + i, from + j, to + j]);
            mesh.faces.push([from + i, to + j, to + i]);
        }
    }
    mesh
}

fn flat(outline: &[[f64; 2]], z: f64) -> Ring {
    outline.iter().map(|[x, y]| Point3::new(*x, *y, z)).collect()
}
