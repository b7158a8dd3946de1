//! The fastest speed along a path under velocity and acceleration limits.
//!
//! With x the squared speed and u the acceleration along the path, a joint's acceleration is q' u + q'' x, linear in
//! both. A backward pass finds at each grid point the largest x from which the rest can still be driven; a forward
//! pass takes the largest u that keeps below (reachability analysis of Pham and Pham, "A new approach to time-optimal
//! path parameterization based on reachability analysis", 2018). u is constant on each interval and q'' too, so each
//! joint's acceleration is linear there and limits at both ends of an interval hold all along it.

use robotc_core::trajectory::TrajectoryPoint;

use super::MotionLimits;
use super::blend::Interval;
use super::timed::TimedPath;

/// a u + b x <= c with c >= 0: u = x = 0 always satisfies it.
#[derive(Clone, Copy)]
struct Row {
    a: f64,
    b: f64,
    c: f64,
}

/// The fastest motion along the intervals, at rest at both ends.
pub(super) fn fastest(grid: &[Interval], limits: &MotionLimits) -> TimedPath {
    let speed_limits = squared_speed_limits(grid, limits);
    let rows: Vec<Vec<Row>> = grid.iter().map(|interval| acceleration_rows(interval, limits)).collect();

    // Largest squared speed at each grid point from which the end can be reached at rest.
    let mut highest = speed_limits.clone();
    highest[grid.len()] = 0.0;
    for k in (0..grid.len()).rev() {
        let h = 2.0 * grid[k].length;
        let (stay, stop) = (Row { a: h, b: 1.0, c: highest[k + 1] }, Row { a: -h, b: -1.0, c: 0.0 });
        let all = rows[k].iter().copied().chain([stay, stop]);
        highest[k] = largest_x(speed_limits[k], all);
    }

    let mut squared = vec![0.0; grid.len() + 1];
    for (k, interval) in grid.iter().enumerate() {
        let x = squared[k];
        let (_, high) = range_of_u(x, rows[k].iter().copied());
        squared[k + 1] = (x + 2.0 * interval.length * high.u).clamp(0.0, highest[k + 1]);
    }
    timed(grid, &squared)
}

/// Knots at the grid points of a motion with these squared speeds.
fn timed(grid: &[Interval], squared: &[f64]) -> TimedPath {
    let mut timed = TimedPath::default();
    let mut time = 0.0;
    for (k, interval) in grid.iter().enumerate() {
        let (x0, x1) = (squared[k], squared[k + 1]);
        let u = (x1 - x0) / (2.0 * interval.length);
        timed.push(time, knot(&interval.start, &interval.direction, &interval.curvature, x0, u));
        time += 2.0 * interval.length / (x0.sqrt() + x1.sqrt());
        if k + 1 == grid.len() {
            timed.push(time, knot(&interval.end(), &interval.end_direction(), &interval.curvature, x1, u));
        }
    }
    timed
}

fn knot(q: &[f64], direction: &[f64], curvature: &[f64], x: f64, u: f64) -> TrajectoryPoint {
    TrajectoryPoint {
        positions: q.to_vec(),
        velocities: direction.iter().map(|d| d * x.sqrt()).collect(),
        accelerations: direction.iter().zip(curvature).map(|(d, c)| d * u + c * x).collect(),
    }
}

/// Largest squared speed at each grid point such that no joint is too fast on the intervals beside it.
fn squared_speed_limits(grid: &[Interval], limits: &MotionLimits) -> Vec<f64> {
    let mut squared = vec![f64::INFINITY; grid.len() + 1];
    for (k, interval) in grid.iter().enumerate() {
        let end = interval.end_direction();
        // |q'| is linear on the interval, so its ends bound it.
        let most = |i: usize| interval.direction[i].abs().max(end[i].abs()).max(1e-12);
        let speed = (0..end.len()).map(|i| limits.velocity[i] / most(i)).fold(f64::INFINITY, f64::min);
        squared[k] = squared[k].min(speed * speed);
        squared[k + 1] = squared[k + 1].min(speed * speed);
    }
    squared
}

/// The acceleration limits of all joints at both ends of an interval.
fn acceleration_rows(interval: &Interval, limits: &MotionLimits) -> Vec<Row> {
    let mut rows = Vec::with_capacity(4 * limits.acceleration.len());
    for (i, &c) in limits.acceleration.iter().enumerate() {
        let b = interval.curvature[i];
        // At the end, x has grown by 2 u ds and q' by q'' ds.
        for a in [interval.direction[i], interval.direction[i] + 3.0 * interval.length * b] {
            rows.push(Row { a, b, c });
            rows.push(Row { a: -a, b: -b, c });
        }
    }
    rows
}

/// A bound on u at one x, and how it changes with x.
#[derive(Clone, Copy)]
struct Bound {
    u: f64,
    slope: f64,
}

/// Smallest and largest u that all rows allow at `x`.
fn range_of_u(x: f64, rows: impl Iterator<Item = Row>) -> (Bound, Bound) {
    let mut low = Bound { u: f64::NEG_INFINITY, slope: 0.0 };
    let mut high = Bound { u: f64::INFINITY, slope: 0.0 };
    for Row { a, b, c } in rows {
        let bound = Bound { u: (c - b * x) / a, slope: -b / a };
        if a > FLAT && bound.u < high.u {
            high = bound;
        }
        if a < -FLAT && bound.u > low.u {
            low = bound;
        }
    }
    (low, high)
}

/// Coefficients of u smaller than this leave u free.
const FLAT: f64 = 1e-12;

/// The largest x, up to `limit`, for which some u satisfies all rows.
///
/// The width of the range of u is concave and piecewise linear in x, and not negative at zero: Newton's method from
/// the right ends at its root after as many steps as there are pieces.
fn largest_x(limit: f64, rows: impl Iterator<Item = Row> + Clone) -> f64 {
    let mut x = limit;
    for Row { a, b, c } in rows.clone() {
        if a.abs() <= FLAT && b > 0.0 {
            x = x.min(c / b);
        }
    }
    for _ in 0..64 {
        let (low, high) = range_of_u(x, rows.clone());
        let width = high.u - low.u;
        let slope = high.slope - low.slope;
        if width >= 0.0 || slope >= 0.0 {
            break;
        }
        let next = x - width / slope;
        if next >= x {
            break;
        }
        x = next.max(0.0);
    }
    x
}
