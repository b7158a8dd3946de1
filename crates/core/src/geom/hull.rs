//! Convex hulls that do not fail: degenerate input is thickened, and the result is checked to cover its input.

use nalgebra::{Point3, Vector3};
use parry3d_f64::math::Vector;
use parry3d_f64::transformation::try_convex_hull;
use thiserror::Error;

use super::Aabb;

/// Why points have no convex hull.
#[derive(Debug, Clone, Copy, Error, PartialEq, Eq)]
pub enum HullError {
    /// There is no point.
    #[error("a convex part needs at least one point")]
    NoPoints,
    /// A coordinate is infinite or not a number.
    #[error("a coordinate is not a finite number")]
    NotFinite,
}

/// Points and outward triangles of a polytope.
pub(super) struct Hull {
    pub(super) points: Vec<Point3<f64>>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Hull {
    /// Volume, cubic metres.
    pub(super) fn volume(&self) -> f64 {
        let Some(&origin) = self.points.first() else { return 0.0 };
        let six_fold: f64 = self
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| self.points[i as usize] - origin);
                a.cross(&b).dot(&c)
            })
            .sum();
        six_fold / 6.0
    }

    /// Largest height of the point above a face; not positive inside.
    pub(super) fn height(&self, point: &Point3<f64>) -> f64 {
        let above = |t: &[u32; 3]| {
            let normal = facet_normal(&self.points, t)?;
            Some(normal.dot(&(point - self.points[t[0] as usize])))
        };
        self.triangles.iter().filter_map(above).fold(f64::NEG_INFINITY, f64::max)
    }
}

/// A triangle lower than this fraction of its longest edge has no normal to speak of: rounding would turn it.
const SLIVER: f64 = 1e-7;

/// Outward unit normal of a triangle; `None` for a sliver, whose neighbours' planes bound the polytope anyway.
pub(super) fn facet_normal(points: &[Point3<f64>], triangle: &[u32; 3]) -> Option<Vector3<f64>> {
    let [a, b, c] = triangle.map(|i| points[i as usize]);
    let normal = (b - a).cross(&(c - a));
    let edge = (b - a).norm_squared().max((c - a).norm_squared()).max((c - b).norm_squared());
    normal.try_normalize(SLIVER * edge)
}

/// Flat sets are given this thickness, as a fraction of their size: far above rounding, far below anything seen.
const MIN_THICKNESS: f64 = 1e-5;

/// Thickness in metres given to sets of no size.
const MIN_SIZE: f64 = 1e-6;

/// The convex hull of `points`: a proper polytope that contains all of them, also when they lie in a plane, on a
/// line or in one place (then it is thickened by a hundred-thousandth of its size, or a micrometre).
pub(super) fn convex_hull(points: &[Point3<f64>]) -> Result<Hull, HullError> {
    let bounds = Aabb::of_points(points).ok_or(HullError::NoPoints)?;
    if !points.iter().all(|p| p.coords.iter().all(|x| x.is_finite())) || !bounds.diagonal().is_finite() {
        return Err(HullError::NotFinite);
    }
    // Work near the origin at unit size: tolerances inside the library are absolute.
    let centre = bounds.centre();
    let scale = bounds.diagonal().max(MIN_SIZE);
    let local: Vec<Vector3<f64>> = points.iter().map(|p| (p - centre) / scale).collect();
    let spread = thickened(&local);
    let mut hull = guarded_hull(&spread).unwrap_or_else(|| enclosing_box(&spread));
    grow_to_cover(&mut hull, &local);
    for p in &mut hull.points {
        *p = centre + p.coords * scale;
    }
    Ok(hull)
}

/// The library's hull, when it is one: closed, outward, and covering its input to within 1e-6.
fn guarded_hull(points: &[Vector3<f64>]) -> Option<Hull> {
    // Exact input first; when numbers stand in the way, the same points on a coarser and coarser grid.
    for grid in [0.0, 1e-9, 1e-7, 1e-6] {
        let snapped = |x: f64| if grid == 0.0 { x } else { (x / grid).round() * grid };
        let mut input: Vec<[f64; 3]> = points.iter().map(|p| [p.x, p.y, p.z].map(snapped)).collect();
        input.sort_by(|a, b| a.partial_cmp(b).expect("finite coordinates are ordered"));
        input.dedup();
        let input: Vec<Vector> = input.iter().map(|&p| Vector::from_array(p)).collect();
        let attempt = std::panic::catch_unwind(|| try_convex_hull(&input));
        let Ok(Ok((vertices, triangles))) = attempt else { continue };
        let points_out = vertices.iter().map(|v| Point3::new(v.x, v.y, v.z)).collect();
        let hull = Hull { points: points_out, triangles };
        if is_closed(&hull) && excess(&hull, points) < 1.0 + 1e-6 {
            return Some(hull);
        }
    }
    None
}

/// Whether each directed edge has exactly one opposite, and Euler's formula holds.
pub(super) fn is_closed(hull: &Hull) -> bool {
    let mut edges: Vec<(u32, u32)> =
        hull.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
    let count = edges.len();
    edges.sort_unstable();
    edges.dedup();
    edges.len() == count
        && edges.iter().all(|&(a, b)| a != b && edges.binary_search(&(b, a)).is_ok())
        && hull.points.len() + hull.triangles.len() == count / 2 + 2
}

/// By which factor the hull must grow about its mean point to contain `points`; infinite when it has no volume.
fn excess(hull: &Hull, points: &[Vector3<f64>]) -> f64 {
    let middle = mean(&hull.points);
    let mut factor: f64 = 0.0;
    for triangle in &hull.triangles {
        let Some(normal) = facet_normal(&hull.points, triangle) else { continue };
        let offset = normal.dot(&(hull.points[triangle[0] as usize].coords - middle));
        if offset <= 0.0 {
            return f64::INFINITY;
        }
        for p in points {
            factor = factor.max(normal.dot(&(p - middle)) / offset);
        }
    }
    factor
}

/// Scales the hull about its mean point, by no more than needed, until it contains `points`.
pub(super) fn grow_to_cover(hull: &mut Hull, points: &[Vector3<f64>]) {
    let factor = excess(hull, points);
    if factor <= 1.0 || !factor.is_finite() {
        return;
    }
    let middle = mean(&hull.points);
    for p in &mut hull.points {
        *p = Point3::from(middle + (p.coords - middle) * (factor * (1.0 + 1e-12)));
    }
}

fn mean(points: &[Point3<f64>]) -> Vector3<f64> {
    points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / points.len() as f64
}

/// The points, or twice as many when they are flat: moved to both sides along each direction without extent.
fn thickened(points: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut out = points.to_vec();
    for axis in principal_frame(points) {
        let (low, high) = extent(&out, &axis);
        if high - low < MIN_THICKNESS {
            let shift = axis * (MIN_THICKNESS * 0.5);
            out = out.iter().flat_map(|p| [p - shift, p + shift]).collect();
        }
    }
    out
}

fn extent(points: &[Vector3<f64>], axis: &Vector3<f64>) -> (f64, f64) {
    points
        .iter()
        .map(|p| p.dot(axis))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

/// Orthonormal axes: along the farthest point from the first, along the farthest from that line, and the third.
fn principal_frame(points: &[Vector3<f64>]) -> [Vector3<f64>; 3] {
    let origin = points[0];
    let farthest = |project: &dyn Fn(Vector3<f64>) -> Vector3<f64>| {
        points
            .iter()
            .map(|p| project(p - origin))
            .fold(Vector3::zeros(), |best, v| if v.norm_squared() > best.norm_squared() { v } else { best })
    };
    let first = farthest(&|v| v).try_normalize(1e-12).unwrap_or_else(Vector3::x);
    let any = if first.x.abs() < 0.5 { Vector3::x() } else { Vector3::y() };
    let second = farthest(&|v| v - first * first.dot(&v));
    let second = second.try_normalize(1e-9).unwrap_or_else(|| first.cross(&any).normalize());
    let second = (second - first * first.dot(&second)).normalize();
    [first, second, first.cross(&second)]
}

/// The box around `points` in their own frame: what remains when no hull can be had.
fn enclosing_box(points: &[Vector3<f64>]) -> Hull {
    let axes = principal_frame(points);
    let extents = axes.map(|axis| extent(points, &axis));
    let corner = |i: usize| {
        let pick = |k: usize| if i >> k & 1 == 0 { extents[k].0 } else { extents[k].1 };
        Point3::from(axes[0] * pick(0) + axes[1] * pick(1) + axes[2] * pick(2))
    };
    Hull { points: (0..8).map(corner).collect(), triangles: BOX_TRIANGLES.to_vec() }
}

/// Outward triangles of a box whose corner `i` has the high coordinate `k` when bit `k` of `i` is set.
const BOX_TRIANGLES: [[u32; 3]; 12] = [
    [0, 4, 6],
    [0, 6, 2],
    [1, 3, 7],
    [1, 7, 5],
    [0, 1, 5],
    [0, 5, 4],
    [2, 6, 7],
    [2, 7, 3],
    [0, 2, 3],
    [0, 3, 1],
    [4, 5, 7],
    [4, 7, 6],
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seed;

    fn check(points: &[Point3<f64>]) {
        let hull = convex_hull(points).expect("finite points have a hull");
        assert!(is_closed(&hull));
        let coords: Vec<_> = points.iter().map(|p| p.coords).collect();
        let factor = excess(&hull, &coords);
        assert!(factor <= 1.0 + 1e-9, "covers its input: {factor}");
    }

    #[test]
    fn covers_points_of_any_shape() {
        let mut rng = Seed::new(3).rng();
        for case in 0..300 {
            let scale = [1e-3, 1.0, 100.0][case % 3];
            let flat = [1.0, if case % 2 == 0 { 0.0 } else { 1.0 }, if case % 5 < 2 { 0.0 } else { 1e-3 }];
            let turn = rng.rotation();
            let shift = Vector3::new(rng.range(-5.0, 5.0), 0.0, 3.0);
            let n = 1 + rng.below(60);
            let points: Vec<Point3<f64>> = (0..n)
                .map(|_| {
                    let mut v = Vector3::new(rng.normal(), rng.normal(), rng.normal());
                    if case % 7 == 0 {
                        v = v.map(|x| x.round()); // many duplicates and coplanar points
                    }
                    Point3::from(turn * (v.component_mul(&Vector3::from(flat)) * scale) + shift)
                })
                .collect();
            check(&points);
        }
    }

    #[test]
    fn the_fallback_box_is_closed_and_covers() {
        let mut rng = Seed::new(4).rng();
        let points: Vec<_> = (0..50).map(|_| rng.direction().into_inner()).collect();
        let hull = enclosing_box(&points);
        assert!(is_closed(&hull));
        assert!(excess(&hull, &points) <= 1.0 + 1e-9);
    }

    #[test]
    fn refuses_what_is_not_a_point_set() {
        assert_eq!(convex_hull(&[]).err(), Some(HullError::NoPoints));
        assert_eq!(convex_hull(&[Point3::new(f64::NAN, 0.0, 0.0)]).err(), Some(HullError::NotFinite));
    }
}
