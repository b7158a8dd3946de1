//! The pinhole camera.

use nalgebra::{Point2, Point3, Vector3};
use robotc_core::geom::ConvexPolygon;
use robotc_core::robot::Camera;

/// A camera without distortion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole {
    /// Width and height of the image, pixels.
    pub size: [u32; 2],
    /// Focal lengths along u and v, pixels.
    pub focal: [f64; 2],
    /// Where the optical axis meets the image, pixels.
    pub centre: [f64; 2],
}

impl Pinhole {
    /// The optics of a camera of a robot.
    pub fn of(camera: &Camera) -> Self {
        let [fx, fy, cx, cy] = camera.intrinsics;
        Self { size: camera.size, focal: [fx, fy], centre: [cx, cy] }
    }

    /// Where a point is seen, inside the image or not; it must lie in front of the camera, `z > 0`.
    pub fn pixel(&self, p_in_camera: &Point3<f64>) -> Point2<f64> {
        let [x, y] = [p_in_camera.x / p_in_camera.z, p_in_camera.y / p_in_camera.z];
        Point2::new(self.focal[0] * x + self.centre[0], self.focal[1] * y + self.centre[1])
    }

    /// The ray of points seen at a pixel: its direction in the camera's frame, one metre long along z.
    pub fn ray(&self, pixel: &Point2<f64>) -> Vector3<f64> {
        let along = |axis: usize| (pixel[axis] - self.centre[axis]) / self.focal[axis];
        Vector3::new(along(0), along(1), 1.0)
    }

    /// The border of the image.
    pub fn image(&self) -> ConvexPolygon {
        let [width, height] = self.size.map(f64::from);
        ConvexPolygon::rectangle(Point2::origin(), Point2::new(width, height))
    }
}
