//! Visible and collision shapes of the shipped descriptions.

use nalgebra::Point3;
use robotc_core::diag::Sources;
use robotc_core::geom::ConvexPart;
use robotc_core::model::{Geometry, Shape};
use robotc_core::urdf::{self, LoadOptions, MeshPolicy};

use crate::{Disk, files, load, specs};

#[test]
fn descriptions_load_without_a_finding() {
    let descriptions = files(&specs(), ".urdf");
    assert!(descriptions.len() >= 3);
    for path in descriptions {
        let mut sources = Sources::default();
        let (model, found) = urdf::load(&Disk, &mut sources, &path, &LoadOptions::default());
        assert!(found.is_empty(), "{}", found.to_plain_text(&sources));
        assert!(model.is_some());
    }
}

/// How far points are outside a shape, or minus how deep inside; metres (a lower bound beside edges).
fn heights(geometry: &Geometry, points: &[Point3<f64>]) -> Vec<f64> {
    let pose = geometry.origin.pose();
    let local = points.iter().map(|p| pose.inverse_transform_point(p));
    match &geometry.shape {
        Shape::Box { size } => local
            .map(|p| (0..3).map(|i| p[i].abs() - size[i] / 2.0).fold(f64::NEG_INFINITY, f64::max))
            .collect(),
        Shape::Cylinder { radius, length } => {
            local.map(|p| (p.x.hypot(p.y) - radius).max(p.z.abs() - length / 2.0)).collect()
        }
        Shape::Capsule { radius, length } => {
            local.map(|p| p.x.hypot(p.y).hypot((p.z.abs() - length / 2.0).max(0.0)) - radius).collect()
        }
        Shape::Sphere { radius } => local.map(|p| p.coords.norm() - radius).collect(),
        Shape::Mesh { mesh, uri } => {
            let part = ConvexPart::hull_of(&mesh.vertices).expect(uri);
            local.map(|p| part.height(&p)).collect()
        }
        Shape::Cloud { .. } | Shape::HeightField { .. } => unreachable!("links are not measured"),
    }
}

#[test]
fn collision_meshes_are_convex() {
    for path in files(&specs(), ".urdf") {
        let model = load(&path, MeshPolicy::Load);
        for link in model.links().iter() {
            for geometry in &link.collisions {
                let Shape::Mesh { mesh, uri } = &geometry.shape else { continue };
                let volume: f64 = (0..mesh.faces.len())
                    .map(|face| {
                        let [a, b, c] = mesh.triangle(face);
                        a.coords.dot(&b.coords.cross(&c.coords)) / 6.0
                    })
                    .sum();
                let hull = ConvexPart::hull_of(&mesh.vertices).expect(uri);
                assert!((volume / hull.volume() - 1.0).abs() < 1e-3, "{uri}: {volume} of {}", hull.volume());
            }
        }
    }
}

#[test]
fn collision_shapes_contain_what_is_seen() {
    for path in files(&specs(), ".urdf") {
        let model = load(&path, MeshPolicy::Load);
        for link in model.links().iter() {
            for visual in &link.visuals {
                let vertices = corners(visual);
                let by_shape: Vec<Vec<f64>> = link.collisions.iter().map(|c| heights(c, &vertices)).collect();
                for (i, vertex) in vertices.iter().enumerate() {
                    let out = by_shape.iter().map(|heights| heights[i]).fold(f64::INFINITY, f64::min);
                    assert!(out < 1e-3, "{}: {vertex} is seen {out} m outside", link.name);
                }
            }
        }
    }
}

/// Corners of the shapes, enough of them to see how far they reach.
pub(crate) fn corners(geometry: &Geometry) -> Vec<Point3<f64>> {
    let pose = geometry.origin.pose();
    let local: Vec<Point3<f64>> = match &geometry.shape {
        Shape::Mesh { mesh, .. } => mesh.vertices.clone(),
        Shape::Box { size } => {
            let [a, b, c] = size.map(|s| s / 2.0);
            (0..8).map(|i| Point3::new(sign(i, 0) * a, sign(i, 1) * b, sign(i, 2) * c)).collect()
        }
        Shape::Cylinder { radius, length } => (0..32)
            .map(|i| {
                let angle = std::f64::consts::TAU * f64::from(i / 2) / 16.0;
                Point3::new(radius * angle.cos(), radius * angle.sin(), sign(i, 0) * length / 2.0)
            })
            .collect(),
        Shape::Capsule { .. } | Shape::Sphere { .. } | Shape::Cloud { .. } | Shape::HeightField { .. } => {
            Vec::new()
        }
    };
    local.iter().map(|p| pose * p).collect()
}

fn sign(bits: i32, bit: i32) -> f64 {
    if bits >> bit & 1 == 1 { 1.0 } else { -1.0 }
}

#[test]
fn collision_shapes_keep_close_to_what_is_seen() {
    for path in files(&specs(), ".urdf") {
        let model = load(&path, MeshPolicy::Load);
        for link in model.links().iter() {
            let seen: Vec<Point3<f64>> = link.visuals.iter().flat_map(corners).collect();
            let touched: Vec<Point3<f64>> = link.collisions.iter().flat_map(corners).collect();
            if touched.is_empty() {
                continue;
            }
            let hull = ConvexPart::hull_of(&seen).expect("a link that is touched is seen");
            for p in &touched {
                let gap = seen.iter().map(|v| (v - p).norm()).fold(f64::INFINITY, f64::min);
                let out = hull.height(p);
                assert!(gap < 0.06 && out < 0.04, "{}: {p} is {gap} m, {out} m off", link.name);
            }
        }
    }
}
