//! What a convex part hides of an image.

use nalgebra::Point3;
use robotc_core::Pose;
use robotc_core::geom::{ConvexPart, ConvexPolygon};

use crate::Pinhole;

/// The outline of what of a part is at least `near` metres in front of the camera, inside the image; `None` when that is
/// nothing. `near` is above zero.
pub fn silhouette(
    camera: &Pinhole,
    part: &ConvexPart,
    camera_from_part: &Pose,
    near: f64,
) -> Option<ConvexPolygon> {
    let points: Vec<Point3<f64>> = part.points().iter().map(|p| camera_from_part * p).collect();
    let mut seen: Vec<Point3<f64>> = points.iter().filter(|p| p.z >= near).copied().collect();
    for &[a, b, c] in part.triangles() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let (from, to) = (points[from as usize], points[to as usize]);
            // Each edge belongs to two triangles, once in either direction.
            if from.z < near && to.z > near {
                seen.push(from + (to - from) * ((near - from.z) / (to.z - from.z)));
            }
        }
    }
    let outline = ConvexPolygon::hull_of(seen.iter().map(|p| camera.pixel(p))).shared_with(&camera.image());
    (outline.area() > 0.0).then_some(outline)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point2, Vector3};
    use robotc_core::geom::box_part;

    use super::*;

    const CAMERA: Pinhole = Pinhole { size: [640, 480], focal: [500.0, 500.0], centre: [320.0, 240.0] };

    #[test]
    fn a_box_before_the_camera_hides_its_front_face() {
        let part = box_part(Vector3::new(0.1, 0.05, 0.2));
        let outline = silhouette(&CAMERA, &part, &Pose::translation(0.0, 0.0, 0.5), 0.01).expect("seen");
        // Half sizes 50 and 25 mm at 0.4 m: 62.5 and 31.25 pixels.
        let expected = ConvexPolygon::rectangle(Point2::new(257.5, 208.75), Point2::new(382.5, 271.25));
        assert!((outline.area() - expected.area()).abs() < 1e-9);
        assert!((outline.shared_with(&expected).area() - expected.area()).abs() < 1e-9);
    }

    #[test]
    fn what_is_behind_or_beside_hides_nothing_and_what_is_around_hides_all() {
        let part = box_part(Vector3::new(0.1, 0.1, 0.1));
        for beside in [Vector3::new(0.0, 0.0, -0.2), Vector3::new(1.0, 0.0, 0.3)] {
            assert_eq!(silhouette(&CAMERA, &part, &Pose::new(beside, Vector3::zeros()), 0.01), None);
        }
        let all = silhouette(&CAMERA, &box_part(Vector3::new(3.0, 3.0, 1.0)), &Pose::identity(), 0.01);
        assert_eq!(all.map(|outline| outline.area()), Some(640.0 * 480.0));
    }
}
