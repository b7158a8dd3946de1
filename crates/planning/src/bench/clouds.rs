//! Problems as a depth camera that misses nothing would see them: every scene as one cloud of points.
//!
//! That planners are measured on such clouds is due to Ramsey, Kingston, Thomason and Kavraki, "Collision-affording point trees" (2024).

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use nalgebra::Point3;
use robotc_core::Pose;
use robotc_core::geom::{CloudError, PointCloud};
use robotc_core::model::{Geometry, Origin, Shape};

use super::problems::{Obstacle, ProblemSet};

/// Radius of the balls about points on a surface for each metre between neighbours: they overlap, also across squares of points.
pub const RADIUS_FOR_SPACING: f64 = 0.75;

impl ProblemSet {
    /// The same problems among points: in the place of all obstacles of a problem, one cloud of points on their surfaces that are no
    /// more than `spacing` metres apart, with balls that leave no hole.
    pub fn as_clouds(&self, spacing: f64) -> Result<Self, CloudError> {
        let mut set = self.clone();
        for problem in &mut set.problems {
            let mut points = Vec::new();
            for obstacle in &problem.obstacles {
                for element in obstacle.geometry.iter() {
                    let root_from_shape = obstacle.root_from_obstacle * element.origin.pose();
                    on_surface(&element.shape, spacing, |p| points.push(root_from_shape * p));
                }
            }
            if points.is_empty() {
                continue;
            }
            let cloud = Arc::new(PointCloud::new(points, RADIUS_FOR_SPACING * spacing)?);
            let shape = Shape::Cloud { cloud, uri: String::new() };
            let geometry = Arc::new(vec![Geometry { origin: Origin::default(), shape, colour: None }]);
            problem.obstacles =
                vec![Obstacle { name: "cloud".into(), geometry, root_from_obstacle: Pose::identity() }];
        }
        Ok(set)
    }
}

/// Pieces that a length is cut into so that none is longer than `spacing`.
fn pieces(length: f64, spacing: f64) -> usize {
    (length / spacing).ceil().max(1.0) as usize
}

/// From one end to the other, both included, in steps no longer than `spacing`.
fn along(length: f64, spacing: f64) -> impl Iterator<Item = f64> + Clone {
    let n = pieces(length, spacing);
    (0..=n).map(move |i| length * (i as f64 / n as f64 - 0.5))
}

/// A ring about z at a height.
fn ring(radius: f64, z: f64, spacing: f64, each: &mut impl FnMut(Point3<f64>)) {
    let n = pieces(TAU * radius, spacing);
    for i in 0..n {
        let angle = TAU * i as f64 / n as f64;
        each(Point3::new(radius * libm::cos(angle), radius * libm::sin(angle), z));
    }
}

/// Points on the surface of a primitive, in its frame; nothing of other shapes.
fn on_surface(shape: &Shape, spacing: f64, mut each: impl FnMut(Point3<f64>)) {
    match *shape {
        Shape::Box { size } => {
            for axis in 0..3 {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                for side in [-0.5, 0.5] {
                    for a in along(size[u], spacing) {
                        for b in along(size[v], spacing) {
                            let mut point = Point3::origin();
                            (point[axis], point[u], point[v]) = (side * size[axis], a, b);
                            each(point);
                        }
                    }
                }
            }
        }
        Shape::Cylinder { radius, length } => {
            along(length, spacing).for_each(|z| ring(radius, z, spacing, &mut each));
            let rings = pieces(radius, spacing);
            for i in 0..rings {
                for end in [-0.5, 0.5] {
                    ring(radius * i as f64 / rings as f64, end * length, spacing, &mut each);
                }
            }
        }
        Shape::Sphere { radius } => {
            let rings = pieces(PI * radius, spacing);
            for i in 0..=rings {
                let angle = PI * i as f64 / rings as f64;
                ring(radius * libm::sin(angle), radius * libm::cos(angle), spacing, &mut each);
            }
        }
        Shape::Capsule { .. } | Shape::Mesh { .. } | Shape::Cloud { .. } | Shape::HeightField { .. } => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;
    use robotc_core::geom::{Pile, box_part};

    #[test]
    fn nothing_gets_through_a_surface() {
        let shapes = [
            Shape::Box { size: [0.3, 0.2, 0.017] },
            Shape::Cylinder { radius: 0.07, length: 0.25 },
            Shape::Sphere { radius: 0.11 },
        ];
        let mut rng = Seed::new(5).rng();
        let dot = box_part(nalgebra::Vector3::repeat(1e-6));
        for shape in shapes {
            let mut points = Vec::new();
            on_surface(&shape, 0.01, |p| points.push(p));
            let pile = Pile::Cloud(Arc::new(PointCloud::new(points, 0.01 * RADIUS_FOR_SPACING).unwrap()));
            for _ in 0..500 {
                let d = rng.direction().into_inner();
                let on = match shape {
                    Shape::Box { size } => {
                        let far = (0..3).map(|k| 0.5 * size[k] / d[k].abs()).fold(f64::INFINITY, f64::min);
                        d * far
                    }
                    Shape::Cylinder { radius, length } => {
                        d * (radius / d.x.hypot(d.y)).min(0.5 * length / d.z.abs())
                    }
                    _ => d * 0.11,
                };
                assert!(pile.is_within(&dot, &Pose::from(-on), 0.0), "{shape:?} {on}");
            }
        }
    }
}
