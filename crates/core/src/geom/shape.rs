//! Described shapes as convex parts.

use nalgebra::Vector3;

use super::{ConvexParts, DecomposeOptions, HullError};
use super::{box_part, capsule_part, cylinder_part, decompose, sphere_part};
use crate::model::{Geometry, Shape};

/// Convex parts that cover a shape, in the shape's own frame: one for a primitive, as many as needed for a mesh, none
/// for what is a [`Pile`](super::Pile).
///
/// Fails when a mesh has no vertex or a coordinate that is not a finite number.
pub fn parts_of_shape(shape: &Shape, options: &DecomposeOptions) -> Result<ConvexParts, HullError> {
    Ok(match shape {
        Shape::Box { size } => ConvexParts::new(vec![box_part(Vector3::from(*size))]),
        Shape::Cylinder { radius, length } => ConvexParts::new(vec![cylinder_part(*radius, *length)]),
        Shape::Capsule { radius, length } => ConvexParts::new(vec![capsule_part(*radius, *length)]),
        Shape::Sphere { radius } => ConvexParts::new(vec![sphere_part(*radius)]),
        Shape::Mesh { mesh, .. } => decompose(mesh, options)?,
        Shape::Cloud { .. } | Shape::HeightField { .. } => ConvexParts::default(),
    })
}

/// Convex parts that cover all these shapes, in the frame their origins refer to (of the link or of the object); in
/// the order of `geometry`.
pub fn parts_of(geometry: &[Geometry], options: &DecomposeOptions) -> Result<ConvexParts, HullError> {
    let mut all = ConvexParts::default();
    for g in geometry {
        all.extend(parts_of_shape(&g.shape, options)?.transformed(&g.origin.pose()));
    }
    Ok(all)
}
