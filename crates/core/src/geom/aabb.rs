//! Axis-aligned boxes.

use nalgebra::{Point3, Vector3};

use crate::Pose;

/// An axis-aligned box: everything between two corners, faces included. Metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Lowest corner.
    pub low: Point3<f64>,
    /// Highest corner.
    pub high: Point3<f64>,
}

impl Aabb {
    /// The smallest box around these points; `None` without points.
    pub fn of_points<'a>(points: impl IntoIterator<Item = &'a Point3<f64>>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = *points.next()?;
        let point_box = Self { low: first, high: first };
        Some(points.fold(point_box, |b, p| Self { low: b.low.inf(p), high: b.high.sup(p) }))
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    /// The box with every face moved outwards by `margin` metres.
    pub fn padded(&self, margin: f64) -> Self {
        let margin = Vector3::repeat(margin);
        Self { low: self.low - margin, high: self.high + margin }
    }

    /// Whether the boxes share a point.
    pub fn intersects(&self, other: &Self) -> bool {
        (0..3).all(|k| self.low[k] <= other.high[k] && other.low[k] <= self.high[k])
    }

    /// Whether the point is inside or on a face.
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        (0..3).all(|k| self.low[k] <= point[k] && point[k] <= self.high[k])
    }

    /// Middle of the box.
    pub fn centre(&self) -> Point3<f64> {
        nalgebra::center(&self.low, &self.high)
    }

    /// Edge lengths.
    pub fn size(&self) -> Vector3<f64> {
        self.high - self.low
    }

    /// Length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        self.size().norm()
    }

    /// The smallest box around this one moved by `target_from_box`.
    pub fn transformed(&self, target_from_box: &Pose) -> Self {
        let centre = target_from_box * self.centre();
        let rotation = target_from_box.rotation.to_rotation_matrix();
        let half = rotation.matrix().abs() * (self.size() * 0.5);
        Self { low: centre - half, high: centre + half }
    }

    /// Distance from the point to the box; zero inside.
    pub fn distance_to(&self, point: &Point3<f64>) -> f64 {
        (self.low - point).sup(&(point - self.high)).sup(&Vector3::zeros()).norm()
    }

    /// Distance between the boxes; zero when they share a point.
    pub fn distance_between(&self, other: &Self) -> f64 {
        (self.low - other.high).sup(&(other.low - self.high)).sup(&Vector3::zeros()).norm()
    }

    /// The interval of `t` in which `origin + t * direction` is inside, cut to `range`; `None` when empty.
    ///
    /// `inverse` holds the reciprocals of the direction's components; infinities are fine.
    pub(super) fn ray_interval(
        &self,
        origin: &Point3<f64>,
        inverse: &Vector3<f64>,
        range: (f64, f64),
    ) -> Option<(f64, f64)> {
        let (mut enter, mut leave) = range;
        for k in 0..3 {
            if inverse[k].is_infinite() {
                if origin[k] < self.low[k] || origin[k] > self.high[k] {
                    return None;
                }
                continue;
            }
            let a = (self.low[k] - origin[k]) * inverse[k];
            let b = (self.high[k] - origin[k]) * inverse[k];
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        (enter <= leave).then_some((enter, leave))
    }
}
