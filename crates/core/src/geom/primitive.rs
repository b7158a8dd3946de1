//! Boxes, cylinders, capsules and spheres as polytopes that contain them.

use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};

use super::ConvexPart;

/// Sides of the prism around a cylinder: it reaches 1.9 % beyond the radius.
const CYLINDER_SIDES: usize = 16;

/// Subdivisions of each icosahedron edge for a sphere (92 corners); it reaches about 5 % beyond the radius.
const SPHERE_FREQUENCY: usize = 3;

/// The same for the caps of a capsule; about 10 %.
const CAP_FREQUENCY: usize = 2;

/// The smallest extent of a primitive, metres: thinner ones are taken to be this thick.
const MIN_EXTENT: f64 = 1e-6;

/// The centred box with these full edge lengths, exact.
pub fn box_part(size: Vector3<f64>) -> ConvexPart {
    let half = size.map(|x| at_least_min(x) * 0.5);
    let corners: Vec<Point3<f64>> = (0..8)
        .map(|i| {
            let sign = |k: usize| if i >> k & 1 == 0 { -1.0 } else { 1.0 };
            Point3::new(sign(0) * half.x, sign(1) * half.y, sign(2) * half.z)
        })
        .collect();
    hull(&corners)
}

/// A 16-sided prism around the centred cylinder along z with this radius and full length.
pub fn cylinder_part(radius: f64, length: f64) -> ConvexPart {
    let radius = at_least_min(radius) / libm::cos(TAU / (2 * CYLINDER_SIDES) as f64);
    let half = at_least_min(length) * 0.5;
    let corners: Vec<Point3<f64>> = (0..CYLINDER_SIDES)
        .flat_map(|i| {
            let angle = TAU * i as f64 / CYLINDER_SIDES as f64;
            let (x, y) = (radius * libm::cos(angle), radius * libm::sin(angle));
            [Point3::new(x, y, -half), Point3::new(x, y, half)]
        })
        .collect();
    hull(&corners)
}

/// A polytope of 92 corners around the centred sphere.
pub fn sphere_part(radius: f64) -> ConvexPart {
    hull(&around_sphere(at_least_min(radius), SPHERE_FREQUENCY))
}

/// A polytope around the centred capsule along z; `length` is that of the cylinder, without the caps.
pub fn capsule_part(radius: f64, length: f64) -> ConvexPart {
    let half = Vector3::z() * (length.max(0.0) * 0.5);
    let sphere = around_sphere(at_least_min(radius), CAP_FREQUENCY);
    let corners: Vec<_> = sphere.iter().flat_map(|p| [p - half, p + half]).collect();
    hull(&corners)
}

fn hull(points: &[Point3<f64>]) -> ConvexPart {
    ConvexPart::hull_of(points).expect("primitives have finite corners")
}

/// Sizes come from checked descriptions; what is not a positive number there is made harmless here.
fn at_least_min(x: f64) -> f64 {
    if x.is_finite() { x.abs().max(MIN_EXTENT) } else { MIN_EXTENT }
}

/// Corners of a geodesic polytope with the sphere of this radius inside it.
fn around_sphere(radius: f64, frequency: usize) -> Vec<Point3<f64>> {
    let unit = geodesic(frequency);
    let polytope = hull(&unit);
    let inscribed = polytope.planes().iter().map(|p| p.offset).fold(f64::INFINITY, f64::min);
    unit.iter().map(|p| p * (radius / inscribed)).collect()
}

/// Points on the unit sphere: the faces of an icosahedron, each edge cut into `frequency` pieces.
fn geodesic(frequency: usize) -> Vec<Point3<f64>> {
    let g = (1.0 + 5.0_f64.sqrt()) * 0.5;
    let corners: Vec<Point3<f64>> = [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)]
        .iter()
        .flat_map(|&(a, b)| [Point3::new(0.0, a, b), Point3::new(a, b, 0.0), Point3::new(b, 0.0, a)])
        .collect();
    let n = frequency as f64;
    let mut points: Vec<Point3<f64>> = Vec::new();
    let icosahedron = hull(&corners);
    for triangle in icosahedron.triangles() {
        let [a, b, c] = triangle.map(|i| icosahedron.points()[i as usize].coords);
        for i in 0..=frequency {
            for j in 0..=frequency - i {
                let k = frequency - i - j;
                let v = (a * (i as f64 / n) + b * (j as f64 / n) + c * (k as f64 / n)).normalize();
                if !points.iter().any(|p| (p.coords - v).norm() < 1e-9) {
                    points.push(Point3::from(v));
                }
            }
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seed;

    /// Every sampled surface point of the true shape is inside; no corner is farther out than `excess`.
    fn check(part: &ConvexPart, surface: impl Fn(Vector3<f64>) -> Point3<f64>, excess: f64) {
        let mut rng = Seed::new(9).rng();
        for _ in 0..2000 {
            let p = surface(rng.direction().into_inner());
            assert!(part.height(&p) <= 1e-12, "{p} sticks out by {}", part.height(&p));
        }
        let farthest = part.points().iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
        assert!(farthest < excess, "{farthest}");
    }

    #[test]
    fn primitives_contain_their_shapes_and_little_more() {
        check(&sphere_part(0.5), |d| Point3::from(d * 0.5), 0.5 * 1.06);
        assert_eq!(sphere_part(0.5).points().len(), 92);
        let rim = |d: Vector3<f64>| {
            let flat = Vector3::new(d.x, d.y, 0.0).normalize() * 0.2;
            Point3::new(flat.x, flat.y, 0.35 * d.z.signum())
        };
        check(&cylinder_part(0.2, 0.7), rim, (0.2 * 1.02_f64).hypot(0.35));
        assert_eq!(cylinder_part(0.2, 0.7).points().len(), 32);
        let cap = |d: Vector3<f64>| Point3::from(d * 0.1 + Vector3::z() * 0.3 * d.z.signum());
        check(&capsule_part(0.1, 0.6), cap, 0.3 + 0.1 * 1.15);
    }
}
