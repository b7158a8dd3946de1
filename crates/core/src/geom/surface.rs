//! The surface of visual or collision elements as one mesh.

use nalgebra::Vector3;

use super::{box_part, capsule_part, cylinder_part, sphere_part};
use crate::model::{Geometry, Shape, TriMesh};

/// Points of a cloud and samples of a height field of which a surface is made, at most.
pub const MOST_SHOWN: usize = 10_000;

/// All elements as one mesh in the frame they are given in, in order. Round shapes become the polytopes around them.
pub fn surface(elements: &[Geometry]) -> TriMesh {
    let mut all = TriMesh::default();
    for element in elements {
        let mesh = match &element.shape {
            Shape::Box { size } => box_part(Vector3::from(*size)).mesh(),
            Shape::Cylinder { radius, length } => cylinder_part(*radius, *length).mesh(),
            Shape::Capsule { radius, length } => capsule_part(*radius, *length).mesh(),
            Shape::Sphere { radius } => sphere_part(*radius).mesh(),
            Shape::Mesh { mesh, .. } => mesh.as_ref().clone(),
            Shape::Cloud { cloud, .. } => cloud.mesh(MOST_SHOWN),
            Shape::HeightField { field, .. } => field.mesh(MOST_SHOWN),
        };
        all.append(&mesh.transformed(&element.origin.pose()));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Origin;

    #[test]
    fn elements_are_placed_and_joined() {
        let at = |x: f64, shape| Geometry {
            origin: Origin { xyz: [x, 0.0, 0.0], rpy: [0.0; 3] },
            shape,
            colour: None,
        };
        let mesh =
            surface(&[at(1.0, Shape::Box { size: [0.2; 3] }), at(-1.0, Shape::Sphere { radius: 0.1 })]);
        let (low, high) = mesh.bounds().unwrap();
        assert!((high.x - 1.1).abs() < 1e-12 && low.x <= -1.1 && low.x > -1.13, "{low} {high}");
        assert!(mesh.faces.iter().flatten().all(|&v| (v as usize) < mesh.vertices.len()));
    }
}
