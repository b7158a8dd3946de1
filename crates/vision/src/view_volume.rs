//! The space behind a convex polygon of an image.

use nalgebra::{Point2, Point3, Unit};
use robotc_core::Pose;
use robotc_core::geom::{ConvexPolygon, Plane};

use crate::Pinhole;

/// The pyramid of points that a camera sees inside of a convex polygon of its image, as outward planes through the
/// camera's centre, one for each edge (thesis, equations 5.3 to 5.6; the offset of a moved plane, equation 5.5, lacks the
/// rotation there). A polygon without area gives a volume without points.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewVolume {
    planes: Vec<Plane>,
}

impl ViewVolume {
    /// In the camera's frame.
    pub fn new(camera: &Pinhole, polygon: &ConvexPolygon) -> Self {
        let plane = |(a, b): (Point2<f64>, Point2<f64>)| {
            let outward = camera.ray(&b).cross(&camera.ray(&a));
            Plane { normal: Unit::new_normalize(outward), offset: 0.0 }
        };
        let has_area = polygon.area() > 0.0;
        let planes = polygon.edges().filter(|_| has_area).map(plane).collect();
        Self { planes }
    }

    /// The volume of a camera that stands somewhere; `margin` metres are taken off along every plane, since neither the
    /// camera nor what it looks at is exactly where it is thought to be.
    pub fn placed(&self, a_from_camera: &Pose, margin: f64) -> Self {
        let place = |plane: &Plane| {
            let normal = a_from_camera.rotation * plane.normal;
            let offset = plane.offset + normal.dot(&a_from_camera.translation.vector) - margin;
            Plane { normal, offset }
        };
        Self { planes: self.planes.iter().map(place).collect() }
    }

    /// The planes, in the order of the polygon's edges.
    pub fn planes(&self) -> &[Plane] {
        &self.planes
    }

    /// Whether a point is seen. What is convex is seen when its corners are.
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        !self.planes.is_empty() && self.planes.iter().all(|plane| plane.height(point) <= 0.0)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use robotc_core::Seed;

    use super::*;

    #[test]
    fn a_point_is_in_the_volume_when_its_pixel_is_in_the_polygon() {
        let camera = Pinhole { size: [640, 480], focal: [510.0, 490.0], centre: [300.0, 250.0] };
        let corners = [[20.0, 30.0], [600.0, 100.0], [500.0, 470.0], [100.0, 400.0]];
        let polygon = ConvexPolygon::hull_of(corners.map(Point2::from));
        let world_from_camera = Pose::new(Vector3::new(0.3, -0.2, 1.0), Vector3::new(0.4, 2.0, -0.3));
        let volume = ViewVolume::new(&camera, &polygon).placed(&world_from_camera, 0.0);
        let mut rng = Seed::new(3).rng();
        let mut seen = 0;
        for _ in 0..5000 {
            let mut draw = |bound: f64| rng.range(-bound, bound);
            let p_in_camera = Point3::new(draw(1.5), draw(1.5), draw(2.0));
            let expected = p_in_camera.z > 0.0 && polygon.contains(&camera.pixel(&p_in_camera));
            assert_eq!(volume.contains(&(world_from_camera * p_in_camera)), expected, "{p_in_camera}");
            seen += usize::from(expected);
        }
        assert!(seen > 200, "{seen}");
    }

    #[test]
    fn a_margin_keeps_points_off_the_border() {
        let camera = Pinhole { size: [200, 200], focal: [100.0, 100.0], centre: [100.0, 100.0] };
        let volume = ViewVolume::new(&camera, &camera.image());
        // The border is at 45 degrees: a point a metre ahead is 0.1 m from it when 0.1414 m inside.
        let placed = volume.placed(&Pose::identity(), 0.1);
        assert!(
            placed.contains(&Point3::new(0.858, 0.0, 1.0)) && !placed.contains(&Point3::new(0.859, 0.0, 1.0))
        );
        assert!(!ViewVolume::new(&camera, &ConvexPolygon::default()).contains(&Point3::new(0.0, 0.0, 1.0)));
    }
}
