//! Lines: paths, trees, axes and grasp marks.

use nalgebra::Point3;
use robotc_core::Pose;

/// Segments of one width; each end has a colour, and a time before which it is drawn faintly.
#[derive(Debug, Clone, PartialEq)]
pub struct LineSet {
    /// Ends of segments, in the node's frame, metres.
    pub points: Vec<[f32; 3]>,
    /// Red, green, blue, opacity of each point, sRGB in 0..=1; one entry means one colour for all.
    pub colours: Vec<[f32; 4]>,
    /// When the tool came to each point, seconds; empty when points have no time.
    pub times: Vec<f32>,
    /// Indices of the two points of each segment.
    pub segments: Vec<[u32; 2]>,
    /// Width on the screen, pixels.
    pub width: f32,
}

impl LineSet {
    /// No segments yet, in one colour.
    pub fn new(colour: [f32; 4], width: f32) -> Self {
        Self { points: Vec::new(), colours: vec![colour], times: Vec::new(), segments: Vec::new(), width }
    }

    /// A line through points in order.
    pub fn polyline(points: impl IntoIterator<Item = Point3<f64>>, colour: [f32; 4], width: f32) -> Self {
        let mut lines = Self::new(colour, width);
        lines.add_polyline(points);
        lines
    }

    /// A line through points in order, each with the time it was reached.
    pub fn timed_polyline(
        points: impl IntoIterator<Item = (f64, Point3<f64>)>,
        colour: [f32; 4],
        width: f32,
    ) -> Self {
        let (times, points): (Vec<f32>, Vec<Point3<f64>>) =
            points.into_iter().map(|(t, p)| (t as f32, p)).unzip();
        let mut lines = Self::polyline(points, colour, width);
        lines.times = times;
        lines
    }

    /// Adds a line through points in order.
    pub fn add_polyline(&mut self, points: impl IntoIterator<Item = Point3<f64>>) {
        let first = self.points.len() as u32;
        self.points.extend(points.into_iter().map(|p| single(&p)));
        let end = self.points.len() as u32;
        self.segments.extend((first + 1..end).map(|i| [i - 1, i]));
    }

    /// Adds one segment.
    pub fn add_segment(&mut self, from: &Point3<f64>, to: &Point3<f64>) {
        self.add_polyline([*from, *to]);
    }

    /// Coordinate axes of this length, metres: x red, y green, z blue.
    pub fn axes(length: f64) -> Self {
        let mut lines = Self::new([1.0; 4], 3.0);
        lines.colours.clear();
        let colours = [[0.90, 0.22, 0.21, 1.0], [0.26, 0.70, 0.29, 1.0], [0.16, 0.45, 0.95, 1.0]];
        for (axis, colour) in colours.into_iter().enumerate() {
            let mut end = Point3::origin();
            end[axis] = length;
            lines.add_segment(&Point3::origin(), &end);
            lines.colours.extend([colour, colour]);
        }
        lines
    }

    /// Two-pronged forks of a gripper at tool poses: prongs `opening` apart that reach back from the tool by `depth`,
    /// both in metres, with a handle as long.
    ///
    /// The tool's z axis is taken as the approach and its y axis as the direction in which the prongs close.
    pub fn forks<'a>(
        parent_from_tool: impl IntoIterator<Item = &'a Pose>,
        opening: f64,
        depth: f64,
        colour: [f32; 4],
    ) -> Self {
        let mut lines = Self::new(colour, 1.5);
        let half = opening / 2.0;
        let p = |y: f64, z: f64| Point3::new(0.0, y, z);
        for pose in parent_from_tool {
            lines.add_polyline(
                [p(-half, 0.0), p(-half, -depth), p(half, -depth), p(half, 0.0)].map(|q| pose * q),
            );
            lines.add_segment(&(pose * p(0.0, -depth)), &(pose * p(0.0, -2.0 * depth)));
        }
        lines
    }

    /// The colour of a point.
    pub fn colour(&self, point: usize) -> [f32; 4] {
        self.colours.get(point).or(self.colours.first()).copied().unwrap_or([1.0; 4])
    }
}

/// A point in single precision, for drawing.
fn single(p: &Point3<f64>) -> [f32; 3] {
    [p.x as f32, p.y as f32, p.z as f32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polyline_joins_neighbours_and_starts_anew_each_time() {
        let mut lines = LineSet::new([1.0; 4], 1.0);
        let p = |x: f64| Point3::new(x, 0.0, 0.0);
        lines.add_polyline([p(0.0), p(1.0), p(2.0)]);
        lines.add_polyline([p(5.0)]);
        lines.add_polyline([p(7.0), p(8.0)]);
        assert_eq!(lines.segments, [[0, 1], [1, 2], [4, 5]]);
    }

    #[test]
    fn forks_lie_in_the_closing_plane_behind_the_tool() {
        let forks = LineSet::forks([&Pose::identity()], 0.08, 0.04, [1.0; 4]);
        assert!(forks.points.iter().all(|p| p[0] == 0.0 && p[1].abs() <= 0.04 && p[2] <= 0.0));
        assert_eq!(forks.segments.len(), 4);
    }
}
