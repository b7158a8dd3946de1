//! Solids as triangle meshes: bodies of revolution, lofts, tubes, prisms, boxes. Everything is built of rings.
//!
//! Lengths are metres. Sines and powers come from `libm`, so that the files are the same on every machine.

mod lathe;
mod loft;
mod polytope;
mod prism;
mod tube;

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::Point3;
use robotc_core::Pose;
use robotc_core::model::{Origin, TriMesh};

pub(crate) use lathe::{drum, lathe};
pub(crate) use loft::{Loft, Section, rounded_box};
pub(crate) use polytope::{directions, enclosing};
pub(crate) use prism::{annulus, prism};
pub(crate) use tube::tube;

/// A closed curve of points, counter-clockwise seen from where the solid goes.
pub(crate) type Ring = Vec<Point3<f64>>;

/// The surface through `rings`, closed at both ends. All rings have the same number of points; the first and the
/// last may be flat (a cap is added) or shrunk to a point.
pub(crate) fn skin(rings: &[Ring]) -> TriMesh {
    let around = rings[0].len();
    let mut mesh = TriMesh::default();
    let mut starts = Vec::new();
    for ring in rings {
        let is_pole = ring.iter().all(|p| (p - ring[0]).norm() < 1e-9);
        starts.push((mesh.vertices.len() as u32, if is_pole { 1 } else { around as u32 }));
        mesh.vertices.extend(&ring[..if is_pole { 1 } else { around }]);
    }
    for pair in starts.windows(2) {
        let [(low, low_count), (high, high_count)] = [pair[0], pair[1]];
        for i in 0..around as u32 {
            let j = (i + 1) % around as u32;
            let (a, b) = (low + i % low_count, low + j % low_count);
            let (c, d) = (high + j % high_count, high + i % high_count);
            if a != b {
                mesh.faces.push([a, b, c]);
            }
            if c != d {
                mesh.faces.push([a, c, d]);
            }
        }
    }
    let ends = [(starts[0], true), (starts[starts.len() - 1], false)];
    for ((start, count), is_first) in ends {
        if count > 1 {
            cap(&mut mesh, start, count, is_first);
        }
    }
    mesh
}

/// A fan over a ring, about its middle.
fn cap(mesh: &mut TriMesh, start: u32, count: u32, is_first: bool) {
    let sum = (start..start + count).fold(Point3::origin(), |sum, i| sum + mesh.vertices[i as usize].coords);
    let middle = mesh.vertices.len() as u32;
    mesh.vertices.push(sum / f64::from(count));
    for i in 0..count {
        let (a, b) = (start + i, start + (i + 1) % count);
        mesh.faces.push(if is_first { [b, a, middle] } else { [a, b, middle] });
    }
}

/// `count` directions on the unit circle, from the x axis on.
pub(crate) fn circle(count: usize) -> impl Iterator<Item = [f64; 2]> {
    (0..count).map(move |i| {
        let angle = TAU * i as f64 / count as f64;
        [libm::cos(angle), libm::sin(angle)]
    })
}

/// A pose from translation and roll, pitch, yaw, as description files write it.
pub(crate) fn at(xyz: [f64; 3], rpy: [f64; 3]) -> Pose {
    Origin { xyz, rpy }.pose()
}

/// Moved without turning.
pub(crate) fn moved(mesh: &TriMesh, xyz: [f64; 3]) -> TriMesh {
    mesh.transformed(&at(xyz, [0.0; 3]))
}

/// Turned so that z becomes x: (x, y, z) goes to (z, y, -x).
pub(crate) fn along_x(mesh: &TriMesh) -> TriMesh {
    mesh.transformed(&at([0.0; 3], [0.0, FRAC_PI_2, 0.0]))
}

/// Turned so that z becomes y: (x, y, z) goes to (x, z, -y).
pub(crate) fn along_y(mesh: &TriMesh) -> TriMesh {
    mesh.transformed(&at([0.0; 3], [-FRAC_PI_2, 0.0, 0.0]))
}

/// Turned so that z becomes -y: (x, y, z) goes to (x, -z, y).
pub(crate) fn along_minus_y(mesh: &TriMesh) -> TriMesh {
    mesh.transformed(&at([0.0; 3], [FRAC_PI_2, 0.0, 0.0]))
}

/// Turned so that z becomes -x: (x, y, z) goes to (-z, y, x).
pub(crate) fn along_minus_x(mesh: &TriMesh) -> TriMesh {
    mesh.transformed(&at([0.0; 3], [0.0, -FRAC_PI_2, 0.0]))
}

/// The triangles that reach into a range of heights.
pub(crate) fn between(mesh: &TriMesh, low: f64, high: f64) -> TriMesh {
    let is_in = |v: u32| (low..high).contains(&mesh.vertices[v as usize].z);
    let faces: Vec<_> = mesh.faces.iter().copied().filter(|face| face.iter().any(|v| is_in(*v))).collect();
    let vertices = faces.iter().flatten().map(|v| mesh.vertices[*v as usize]).collect();
    TriMesh { vertices, faces: (0..faces.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect() }
}

/// Several meshes as one.
pub(crate) fn join(meshes: impl IntoIterator<Item = TriMesh>) -> TriMesh {
    let mut all = TriMesh::default();
    meshes.into_iter().for_each(|mesh| all.append(&mesh));
    all
}
