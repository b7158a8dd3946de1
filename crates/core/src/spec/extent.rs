//! The exact axis-aligned extent of shapes.

use nalgebra::{Point3, Vector3};

use crate::Pose;
use crate::geom::{Aabb, Pile};
use crate::model::{Geometry, Shape};

/// The smallest axis-aligned box, in a frame, around shapes whose common frame stands at `frame_from_shapes`; `None`
/// when they have no extent.
pub(super) fn extent(shapes: &[Geometry], frame_from_shapes: &Pose) -> Option<Aabb> {
    shapes.iter().filter_map(|shape| of_shape(shape, frame_from_shapes)).reduce(|a, b| a.union(&b))
}

fn of_shape(geometry: &Geometry, frame_from_parent: &Pose) -> Option<Aabb> {
    let frame_from_shape = frame_from_parent * geometry.origin.pose();
    let rotation = frame_from_shape.rotation.to_rotation_matrix().into_inner();
    let axis: Vector3<f64> = rotation.column(2).into();
    let half: Vector3<f64> = match &geometry.shape {
        Shape::Mesh { mesh, .. } => {
            let points: Vec<Point3<f64>> = mesh.vertices.iter().map(|v| frame_from_shape * v).collect();
            return Aabb::of_points(&points);
        }
        Shape::Cloud { .. } | Shape::HeightField { .. } => {
            return Pile::of_shape(&geometry.shape).map(|pile| pile.bounds().transformed(&frame_from_shape));
        }
        Shape::Box { size } => rotation.abs() * (Vector3::from(*size) / 2.0),
        Shape::Sphere { radius } => Vector3::repeat(*radius),
        // A disc across `axis` reaches sqrt(1 - axis_k^2) of its radius along k.
        Shape::Cylinder { radius, length } => {
            axis.abs() * (length / 2.0) + axis.map(|a| (1.0 - a * a).max(0.0).sqrt()) * *radius
        }
        Shape::Capsule { radius, length } => axis.abs() * (length / 2.0) + Vector3::repeat(*radius),
    };
    let centre = Point3::from(frame_from_shape.translation.vector);
    Some(Aabb { low: centre - half, high: centre + half })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Origin;

    fn size(shape: Shape, rpy: [f64; 3]) -> [f64; 3] {
        let geometry = Geometry { origin: Origin { xyz: [1.0, 2.0, 3.0], rpy }, shape, colour: None };
        let bounds = extent(&[geometry], &Pose::translation(-1.0, -2.0, -3.0)).unwrap();
        assert!(bounds.centre().coords.norm() < 1e-12);
        bounds.size().into()
    }

    #[test]
    fn primitives_have_exact_extents() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let check = |shape: Shape, rpy, expected: [f64; 3]| {
            let found = size(shape.clone(), rpy);
            let close = found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12);
            assert!(close, "{shape:?} {rpy:?}: {found:?}");
        };
        let cylinder = Shape::Cylinder { radius: 0.1, length: 0.6 };
        check(Shape::Box { size: [0.1, 0.2, 0.3] }, [0.0, 0.0, quarter], [0.2, 0.1, 0.3]);
        check(cylinder.clone(), [0.0; 3], [0.2, 0.2, 0.6]);
        check(cylinder, [quarter, 0.0, 0.0], [0.2, 0.6, 0.2]);
        check(Shape::Capsule { radius: 0.1, length: 0.6 }, [0.0, quarter, 0.0], [0.8, 0.2, 0.2]);
        check(Shape::Sphere { radius: 0.1 }, [0.3, 0.2, 0.1], [0.2; 3]);
    }
}
