//! Choosing the plane that cuts a piece best: the one that leaves the least hull volume on its two sides.

use nalgebra::{Matrix3, Point3, Vector3};

use super::super::quick_hull::hull_volume;
use super::piece::{CutPlane, Piece};

/// Planes tried along each axis before the best one is refined.
const PLANES: usize = 15;

/// Refined positions around the best plane: where vertices are.
const REFINED: usize = 12;

/// Directions in which the extreme points of each side are kept; the volume of their hull stands for that of the side.
const DIRECTIONS: usize = 48;

/// What an unequal cut costs, as a fraction of the piece's hull: decides when volumes do not.
const IMBALANCE: f64 = 0.06;

/// What a cut across a short side costs, as a fraction of the piece's hull.
const SHORT_SIDE: f64 = 0.04;

/// Points this near to a plane, as a fraction of the piece's extent along its normal, are on it.
const ON_PLANE: f64 = 1e-7;

/// The plane with the lowest cost among those across the mesh axes and the principal axes; `None` when the piece has
/// no extent.
pub(super) fn best_plane(piece: &Piece) -> Option<CutPlane> {
    let directions = spread_directions();
    let mut axes: Vec<Vector3<f64>> = vec![Vector3::x(), Vector3::y(), Vector3::z()];
    for axis in principal_axes(piece) {
        if axes.iter().all(|a| a.dot(&axis).abs() < 0.98) {
            axes.push(axis);
        }
    }
    let extents: Vec<(f64, f64)> = axes.iter().map(|axis| extent(piece, axis)).collect();
    let longest = extents.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    let mut best: Option<(f64, usize, f64)> = None;
    for (a, axis) in axes.iter().enumerate() {
        let (low, high) = extents[a];
        let step = (high - low) / (PLANES + 1) as f64;
        if step <= longest * 1e-4 {
            continue;
        }
        let short = SHORT_SIDE * (1.0 - (high - low) / longest);
        let uniform: Vec<f64> = (1..=PLANES).map(|i| low + step * i as f64).collect();
        let costs = costs(piece, axis, &uniform, &directions);
        let Some((k, cost)) = lowest(&costs) else { continue };
        if best.is_none_or(|b| cost + short < b.0) {
            best = Some((cost + short, a, uniform[k]));
        }
        let near = vertex_positions(piece, axis, uniform[k] - step, uniform[k] + step);
        let refined = self::costs(piece, axis, &near, &directions);
        if let Some((k, cost)) = lowest(&refined)
            && best.is_none_or(|b| cost + short < b.0)
        {
            best = Some((cost + short, a, near[k]));
        }
    }
    let (_, axis, offset) = best?;
    let (low, high) = extents[axis];
    Some(CutPlane { normal: axes[axis], offset, tolerance: ON_PLANE * (high - low) })
}

fn lowest(costs: &[f64]) -> Option<(usize, f64)> {
    costs.iter().copied().enumerate().filter(|c| c.1.is_finite()).reduce(|a, b| if b.1 < a.1 { b } else { a })
}

fn extent(piece: &Piece, axis: &Vector3<f64>) -> (f64, f64) {
    piece
        .vertices
        .iter()
        .map(|p| p.coords.dot(axis))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

/// At most [`REFINED`] distinct vertex positions strictly between the bounds, spread over their ranks.
fn vertex_positions(piece: &Piece, axis: &Vector3<f64>, low: f64, high: f64) -> Vec<f64> {
    let mut at: Vec<f64> =
        piece.vertices.iter().map(|p| p.coords.dot(axis)).filter(|x| *x > low && *x < high).collect();
    at.sort_by(f64::total_cmp);
    at.dedup_by(|b, a| *b - *a <= ON_PLANE * (high - low));
    let count = at.len().min(REFINED);
    let pick = |i: usize| at[i * (at.len() - 1) / (count - 1).max(1)];
    (0..count).map(pick).collect()
}

/// For each plane across `axis` at the ascending `positions`: hull volumes of both sides plus penalties, as a fraction
/// of the hull of the whole. Infinite when a side is empty.
fn costs(piece: &Piece, axis: &Vector3<f64>, positions: &[f64], directions: &[Vector3<f64>]) -> Vec<f64> {
    if positions.is_empty() {
        return Vec::new();
    }
    let n = positions.len();
    let heights: Vec<f64> = piece.vertices.iter().map(|p| p.coords.dot(axis)).collect();
    let (low, high) = extent(piece, axis);
    let tolerance = ON_PLANE * (high - low);
    // How far down and up the faces around each vertex reach.
    let mut reach: Vec<(f64, f64)> = heights.iter().map(|&h| (h, h)).collect();
    // Extremes of points that are below plane k but not below plane k - 1 (`below[k]`), above plane k but not above
    // plane k + 1 (`above[k]`), and on the cut of plane k.
    let blank = || vec![Extremes::new(directions.len()); n];
    let (mut below, mut above, mut on) = (blank(), blank(), blank());
    for face in &piece.faces {
        let face_heights = face.map(|v| heights[v as usize]);
        let (lowest, highest) = (
            face_heights[0].min(face_heights[1]).min(face_heights[2]),
            face_heights[0].max(face_heights[1]).max(face_heights[2]),
        );
        for &v in face {
            let r = &mut reach[v as usize];
            *r = (r.0.min(lowest), r.1.max(highest));
        }
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (a, b) = (face[i] as usize, face[j] as usize);
            let (ha, hb) = (heights[a], heights[b]);
            let (from, to) = (ha.min(hb) + tolerance, ha.max(hb) - tolerance);
            let first = positions.partition_point(|&p| p <= from);
            for k in first..n {
                if positions[k] >= to {
                    break;
                }
                let t = (positions[k] - ha) / (hb - ha);
                let point = piece.vertices[a] + (piece.vertices[b] - piece.vertices[a]) * t;
                on[k].add(&point, directions);
            }
        }
    }
    for (v, point) in piece.vertices.iter().enumerate() {
        let (h, (down, up)) = (heights[v], reach[v]);
        // Of the planes through the vertex, those that faces leave downwards have it below, upwards above.
        let first_above = positions.partition_point(|&p| p < h - tolerance);
        let first_beyond = positions.partition_point(|&p| p <= h + tolerance);
        let first_below = (first_above..first_beyond).find(|&k| down < positions[k] - tolerance);
        let last_above = (first_above..first_beyond).rev().find(|&k| up > positions[k] + tolerance);
        let first_below = first_below.unwrap_or(first_beyond);
        if first_below < n {
            below[first_below].add(point, directions);
        }
        if let Some(k) = last_above.or(first_above.checked_sub(1)) {
            above[k].add(point, directions);
        }
    }
    for k in 1..n {
        let (done, rest) = below.split_at_mut(k);
        rest[0].merge(&done[k - 1]);
    }
    for k in (1..n).rev() {
        let (rest, done) = above.split_at_mut(k);
        rest[k - 1].merge(&done[0]);
    }
    let mut all = below[n - 1].clone();
    all.merge(&above[0]);
    let whole = all.volume().max(f64::MIN_POSITIVE);
    (0..n)
        .map(|k| {
            if below[k].is_empty() || above[k].is_empty() {
                return f64::INFINITY;
            }
            below[k].merge(&on[k]);
            above[k].merge(&on[k]);
            let (a, b) = (below[k].volume() / whole, above[k].volume() / whole);
            a + b + IMBALANCE * (a - b).abs()
        })
        .collect()
}

/// The farthest point in each direction.
#[derive(Clone)]
struct Extremes(Vec<(f64, Point3<f64>)>);

impl Extremes {
    fn new(directions: usize) -> Self {
        Self(vec![(f64::NEG_INFINITY, Point3::origin()); directions])
    }

    fn is_empty(&self) -> bool {
        self.0.first().is_none_or(|e| e.0 == f64::NEG_INFINITY)
    }

    fn add(&mut self, point: &Point3<f64>, directions: &[Vector3<f64>]) {
        for (extreme, d) in self.0.iter_mut().zip(directions) {
            let height = d.x * point.x + d.y * point.y + d.z * point.z;
            if height > extreme.0 {
                *extreme = (height, *point);
            }
        }
    }

    fn merge(&mut self, other: &Self) {
        for (mine, theirs) in self.0.iter_mut().zip(&other.0) {
            if theirs.0 > mine.0 {
                *mine = *theirs;
            }
        }
    }

    fn volume(&self) -> f64 {
        if self.is_empty() {
            return 0.0;
        }
        let mut points: Vec<Point3<f64>> = self.0.iter().map(|e| e.1).collect();
        points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
        points.dedup();
        hull_volume(&points)
    }
}

/// Directions spread evenly over the sphere on a spiral.
fn spread_directions() -> Vec<Vector3<f64>> {
    let golden_angle = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..DIRECTIONS)
        .map(|i| {
            let z = 1.0 - (2 * i + 1) as f64 / DIRECTIONS as f64;
            let radius = (1.0 - z * z).sqrt();
            let angle = golden_angle * i as f64;
            Vector3::new(radius * libm::cos(angle), radius * libm::sin(angle), z)
        })
        .collect()
}

/// Axes of inertia of the surface.
fn principal_axes(piece: &Piece) -> [Vector3<f64>; 3] {
    let mut area_sum = 0.0;
    let mut first = Vector3::zeros();
    let mut second = Matrix3::zeros();
    for face in &piece.faces {
        let [a, b, c] = face.map(|v| piece.vertices[v as usize].coords);
        let area = (b - a).cross(&(c - a)).norm();
        let middle = (a + b + c) / 3.0;
        area_sum += area;
        first += middle * area;
        second += middle * middle.transpose() * area;
    }
    if area_sum <= 0.0 {
        return [Vector3::x(), Vector3::y(), Vector3::z()];
    }
    let mean = first / area_sum;
    let covariance = second / area_sum - mean * mean.transpose();
    let axes = covariance.symmetric_eigen().eigenvectors;
    [axes.column(0).into_owned(), axes.column(1).into_owned(), axes.column(2).into_owned()]
}
