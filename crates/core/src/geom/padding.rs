//! Convex parts grown by a margin, as half spaces: what points near a robot are tested against.
//!
//! Pushing out the faces alone would let sharp corners grow far beyond the margin. So each edge and each corner has a plane too, along
//! the mean of the normals about it (thesis, section 4.6).

use std::collections::BTreeMap;

use nalgebra::{Point3, Unit, Vector3};

use super::hull::facet_normal;
use super::{ConvexPart, ConvexParts, Plane};
use crate::Pose;

/// Half spaces whose intersection holds everything within a margin of a convex part.
#[derive(Debug, Clone, PartialEq)]
pub struct PaddedPart {
    planes: Vec<Plane>,
    centre: Point3<f64>,
    radius: f64,
}

impl PaddedPart {
    /// The part grown by `margin`, metres: a plane for each face, then each sharp edge, then each corner.
    pub fn new(part: &ConvexPart, margin: f64) -> Self {
        let mut normals: Vec<Vector3<f64>> = part.planes().iter().map(|p| p.normal.into_inner()).collect();
        normals.extend(part.edges().iter().map(|edge| edge.normals[0] + edge.normals[1]));
        let mut about: BTreeMap<u32, Vec<Vector3<f64>>> = BTreeMap::new();
        for triangle in part.triangles() {
            let Some(normal) = facet_normal(part.points(), triangle) else { continue };
            for corner in triangle {
                let known = about.entry(*corner).or_default();
                // Triangles of one face count once.
                if known.iter().all(|n| n.dot(&normal) < 1.0 - 1e-9) {
                    known.push(normal);
                }
            }
        }
        normals.extend(
            about.values().filter(|faces| faces.len() > 2).map(|faces| faces.iter().sum::<Vector3<f64>>()),
        );
        let plane = |normal: Vector3<f64>| {
            let normal = Unit::try_new(normal, 1e-9)?;
            let support = part.support(&normal);
            Some(Plane { normal, offset: normal.dot(&support.coords) + margin })
        };
        let planes = normals.into_iter().filter_map(plane).collect();
        let (centre, radius) = part.bounding_sphere();
        // No corner of the intersection is farther out than where the planes about one corner of a cube meet.
        Self { planes, centre, radius: radius + 2.0 * margin.max(0.0) }
    }

    /// The half spaces: the points below all planes.
    pub fn planes(&self) -> &[Plane] {
        &self.planes
    }

    /// Whether the point is inside; not looked at closely beyond the ball about the part and twice the margin.
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        (point - self.centre).norm_squared() <= self.radius * self.radius
            && self.planes.iter().all(|plane| plane.height(point) <= 0.0)
    }
}

/// The parts of a body grown by a margin.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PaddedParts {
    parts: Vec<PaddedPart>,
}

impl PaddedParts {
    /// All parts grown by `margin`, metres.
    pub fn new(parts: &ConvexParts, margin: f64) -> Self {
        Self { parts: parts.iter().map(|part| PaddedPart::new(part, margin)).collect() }
    }

    /// The parts.
    pub fn as_slice(&self) -> &[PaddedPart] {
        &self.parts
    }

    /// Whether some part contains the point.
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        self.parts.iter().any(|part| part.contains(point))
    }
}

/// For each point, whether it lies outside of all bodies: of what a sensor sees, all that is not the robot itself or what is
/// known already (thesis, section 5.1). Bodies come with where they are in the frame of the points.
pub fn outside_of_bodies<'a>(
    points: &[Point3<f64>],
    bodies: impl IntoIterator<Item = (&'a PaddedParts, Pose)>,
) -> Vec<bool> {
    let mut outside = vec![true; points.len()];
    for (parts, world_from_body) in bodies {
        let body_from_world = world_from_body.inverse();
        for (outside, point) in outside.iter_mut().zip(points) {
            *outside = *outside && !parts.contains(&(body_from_world * point));
        }
    }
    outside
}

#[cfg(test)]
mod tests {
    use super::super::{box_part, cylinder_part};
    use super::*;
    use crate::rng::Seed;

    #[test]
    fn a_padded_box_has_a_plane_for_each_face_edge_and_corner() {
        let part = box_part(Vector3::new(0.2, 0.3, 0.4));
        let padded = PaddedPart::new(&part, 0.01);
        assert_eq!(padded.planes().len(), 6 + 12 + 8);
        assert!(padded.contains(&Point3::new(0.1099, 0.0, 0.0)));
        assert!(!padded.contains(&Point3::new(0.1101, 0.0, 0.0)));
        // The corner of the pushed-out faces is cut off.
        assert!(!padded.contains(&Point3::new(0.1099, 0.1599, 0.2099)));
    }

    #[test]
    fn everything_within_the_margin_is_inside_and_little_else() {
        let mut rng = Seed::new(3).rng();
        let parts = [box_part(Vector3::new(0.1, 0.3, 0.05)), cylinder_part(0.05, 0.2)];
        let margin = 0.008;
        for part in &parts {
            let padded = PaddedPart::new(part, margin);
            for _ in 0..3000 {
                let (a, b) = (rng.below(part.points().len()), rng.below(part.points().len()));
                let on = nalgebra::center(&part.points()[a], &part.points()[b]);
                let near = on + rng.direction().into_inner() * (rng.unit() * margin);
                assert!(padded.contains(&near));
                let p = part.points()[a] + rng.direction().into_inner() * (3.0 * margin * rng.unit());
                let ball = super::super::box_part(Vector3::repeat(1e-9));
                let at = Pose::translation(p.x, p.y, p.z);
                let distance = super::super::distance(part, &Pose::identity(), &ball, &at).distance;
                assert!(distance < 1.3 * margin || !padded.contains(&p), "{distance}");
            }
        }
    }

    #[test]
    fn points_on_bodies_are_pruned_where_the_bodies_are() {
        let parts = ConvexParts::new(vec![box_part(Vector3::repeat(0.1))]);
        let padded = PaddedParts::new(&parts, 0.005);
        let points = [Point3::new(1.0, 0.0, 0.054), Point3::new(1.0, 0.0, 0.056), Point3::origin()];
        let bodies = [(&padded, Pose::translation(1.0, 0.0, 0.0))];
        assert_eq!(outside_of_bodies(&points, bodies), [false, true, true]);
        assert_eq!(outside_of_bodies(&points, []), [true; 3]);
    }
}
