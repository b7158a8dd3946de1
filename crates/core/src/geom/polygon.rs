//! Convex polygons in a plane: outlines on the floor, shapes in an image.

use nalgebra::{Point2, Vector2};

/// The half plane of points with `normal . p <= offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfPlane {
    /// Outward normal, of any length but zero.
    pub normal: Vector2<f64>,
    /// Where its border is, in units of the normal's length.
    pub offset: f64,
}

impl HalfPlane {
    /// The points that are not left of the way from `a` to `b`.
    pub fn right_of(a: &Point2<f64>, b: &Point2<f64>) -> Self {
        let along = b - a;
        let normal = Vector2::new(-along.y, along.x);
        Self { normal, offset: normal.dot(&a.coords) }
    }

    /// How far a point is outside, in units of the normal's length; negative inside.
    pub fn height(&self, point: &Point2<f64>) -> f64 {
        self.normal.dot(&point.coords) - self.offset
    }
}

/// A convex polygon: corners counter-clockwise, no three of them in a line. With fewer than three corners it has no area.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ConvexPolygon {
    corners: Vec<Point2<f64>>,
}

impl ConvexPolygon {
    /// The convex hull of points (Andrew's monotone chain); its first corner is the lowest in x, then in y.
    pub fn hull_of(points: impl IntoIterator<Item = Point2<f64>>) -> Self {
        let mut points: Vec<Point2<f64>> = points.into_iter().collect();
        points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        points.dedup();
        if points.len() < 3 {
            return Self { corners: points };
        }
        let mut corners = chain(points.iter());
        corners.extend(chain(points.iter().rev()));
        Self { corners }
    }

    /// These corners, if they go counter-clockwise round a convex polygon, or are none.
    pub fn from_corners(corners: Vec<Point2<f64>>) -> Option<Self> {
        let polygon = Self { corners };
        let size = polygon.corners.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
        let rounding = 1e-9 * size * size;
        let left =
            |(a, b): (Point2<f64>, Point2<f64>)| polygon.corners.iter().all(|p| turn(&a, &b, p) >= -rounding);
        let is_convex = size.is_finite() && polygon.edges().all(left);
        (polygon.corners.is_empty() || is_convex && polygon.area() > 0.0).then_some(polygon)
    }

    /// A rectangle along the axes.
    pub fn rectangle(low: Point2<f64>, high: Point2<f64>) -> Self {
        Self::hull_of([low, Point2::new(high.x, low.y), high, Point2::new(low.x, high.y)])
    }

    /// Corners, counter-clockwise.
    pub fn corners(&self) -> &[Point2<f64>] {
        &self.corners
    }

    /// Edges, counter-clockwise: from each corner to the next.
    pub fn edges(&self) -> impl Iterator<Item = (Point2<f64>, Point2<f64>)> + Clone {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|(a, b)| (*a, *b))
    }

    /// Area, never negative.
    pub fn area(&self) -> f64 {
        let Some(&first) = self.corners.first() else { return 0.0 };
        let twice: f64 = self.corners.windows(2).map(|pair| turn(&first, &pair[0], &pair[1])).sum();
        0.5 * twice.max(0.0)
    }

    /// Centre of the area; of the corners where there is no area, and nothing where there are none.
    pub fn centre(&self) -> Option<Point2<f64>> {
        let first = *self.corners.first()?;
        let (mut weight, mut sum) = (0.0, Vector2::zeros());
        for pair in self.corners.windows(2) {
            let area = turn(&first, &pair[0], &pair[1]);
            weight += area;
            sum += (pair[0] - first + (pair[1] - first)) * (area / 3.0);
        }
        if weight > 0.0 {
            return Some(first + sum / weight);
        }
        let mean = self.corners.iter().map(|p| p.coords).sum::<Vector2<f64>>() / self.corners.len() as f64;
        Some(Point2::from(mean))
    }

    /// Whether a point is inside or on the border.
    pub fn contains(&self, point: &Point2<f64>) -> bool {
        self.corners.len() > 2 && self.edges().all(|(a, b)| turn(&a, &b, point) >= 0.0)
    }

    /// Whether some line has this polygon on one side and `other` on the other; touching is not apart.
    pub fn is_apart_from(&self, other: &Self) -> bool {
        let separates = |a: &Self, b: &Self| {
            a.edges().any(|(from, to)| from != to && b.corners.iter().all(|p| turn(&from, &to, p) < 0.0))
        };
        separates(self, other) || separates(other, self)
    }

    /// What lies in a half plane.
    pub fn clipped(&self, half: &HalfPlane) -> Self {
        let mut corners = Vec::with_capacity(self.corners.len() + 1);
        for (a, b) in self.edges() {
            let (at_a, at_b) = (half.height(&a), half.height(&b));
            if at_a <= 0.0 {
                corners.push(a);
            }
            if at_a.min(at_b) < 0.0 && at_a.max(at_b) > 0.0 {
                corners.push(a + (b - a) * (at_a / (at_a - at_b)));
            }
        }
        Self { corners }
    }

    /// What two polygons share.
    pub fn shared_with(&self, other: &Self) -> Self {
        if other.corners.len() < 3 {
            return Self::default();
        }
        other.edges().fold(self.clone(), |left, (a, b)| left.clipped(&HalfPlane::right_of(&b, &a)))
    }
}

/// Half of a hull: the corners where a way along sorted points turns left, the last left out.
fn chain<'a>(points: impl Iterator<Item = &'a Point2<f64>>) -> Vec<Point2<f64>> {
    let mut chain: Vec<Point2<f64>> = Vec::new();
    for point in points {
        while chain.len() > 1 && turn(&chain[chain.len() - 2], &chain[chain.len() - 1], point) <= 0.0 {
            chain.pop();
        }
        chain.push(*point);
    }
    chain.pop();
    chain
}

/// Twice the area of a triangle, positive when it goes round counter-clockwise.
fn turn(a: &Point2<f64>, b: &Point2<f64>, c: &Point2<f64>) -> f64 {
    (b - a).perp(&(c - a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Seed;

    fn cloud(seed: u64, count: usize) -> Vec<Point2<f64>> {
        let mut rng = Seed::new(seed).rng();
        (0..count).map(|_| Point2::new(rng.range(-1.0, 1.0), rng.range(-2.0, 0.5))).collect()
    }

    #[test]
    fn a_hull_holds_its_points_and_clips_share_its_area() {
        for seed in 0..50 {
            let points = cloud(seed, 3 + seed as usize % 20);
            let hull = ConvexPolygon::hull_of(points.iter().copied());
            let centre = hull.centre().expect("it has corners");
            assert!(hull.contains(&centre));
            // A point on the border may fall out by the last digit.
            let inwards = |p: &Point2<f64>| centre + (p - centre) * (1.0 - 1e-12);
            assert!(points.iter().all(|p| hull.contains(&inwards(p))));
            let half = HalfPlane::right_of(&points[0], &points[1]);
            let other = HalfPlane { normal: -half.normal, offset: -half.offset };
            let parts = hull.clipped(&half).area() + hull.clipped(&other).area();
            assert!((parts - hull.area()).abs() < 1e-12, "{parts} of {}", hull.area());
        }
    }

    #[test]
    fn what_is_shared_is_empty_where_polygons_are_apart() {
        for seed in 0..100 {
            let a = ConvexPolygon::hull_of(cloud(seed, 5));
            let shift = Vector2::new(seed as f64 * 0.03, seed as f64 * 0.02);
            let b = ConvexPolygon::hull_of(cloud(seed + 1000, 6).into_iter().map(|p| p + shift));
            let shared = a.shared_with(&b).area();
            assert_eq!(a.is_apart_from(&b), shared == 0.0, "{shared}");
            assert!((shared - b.shared_with(&a).area()).abs() < 1e-12);
        }
    }

    #[test]
    fn a_rectangle_has_the_area_and_centre_it_should() {
        let rectangle = ConvexPolygon::rectangle(Point2::new(1.0, 2.0), Point2::new(4.0, 4.0));
        assert_eq!((rectangle.area(), rectangle.centre()), (6.0, Some(Point2::new(2.5, 3.0))));
        assert_eq!(ConvexPolygon::default().centre(), None);
        assert!(!ConvexPolygon::default().contains(&Point2::origin()));
    }
}
