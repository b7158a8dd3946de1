//! Rounding corners with parabolas.
//!
//! A blend that starts a distance h before a corner and ends h after it is a quadratic Bezier curve whose derivative
//! by the distance s runs linearly from the one direction to the other: position and direction are continuous, and the
//! second derivative is constant on every piece. That is what lets the speed profile prove its limits.

use crate::edge::EdgeChecker;
use crate::space::Space;

/// A piece with constant second derivative: q(s) = start + direction s + curvature s^2 / 2.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    start: Vec<f64>,
    direction: Vec<f64>,
    curvature: Vec<f64>,
    length: f64,
}

/// One interval of a subdivided path.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Interval {
    /// State at its start.
    pub(super) start: Vec<f64>,
    /// dq/ds at its start.
    pub(super) direction: Vec<f64>,
    /// d2q/ds2, constant.
    pub(super) curvature: Vec<f64>,
    /// Length in s.
    pub(super) length: f64,
}

impl Interval {
    /// State at its end.
    pub(super) fn end(&self) -> Vec<f64> {
        let s = self.length;
        let along = |i: usize| self.start[i] + s * (self.direction[i] + 0.5 * s * self.curvature[i]);
        (0..self.start.len()).map(along).collect()
    }

    /// dq/ds at its end.
    pub(super) fn end_direction(&self) -> Vec<f64> {
        (0..self.start.len()).map(|i| self.direction[i] + self.length * self.curvature[i]).collect()
    }
}

/// A blend takes no more than this share of a leg. Two blends then leave a straight piece between them that is not so
/// short that rounding errors, divided by its squared duration, look like accelerations.
const LEG_SHARE: f64 = 0.49;

/// Pieces of a path between its stops: each section is smooth, between sections the motion rests.
///
/// `path` is unwrapped, without repeated states.
pub(super) fn round_corners<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    path: &[Vec<f64>],
    blend: f64,
) -> Vec<Vec<Piece>> {
    let space = checker.space().clone();
    let longest = blend * space.diameter();
    let legs: Vec<(Vec<f64>, f64)> = path.windows(2).map(|w| leg(&space, &w[0], &w[1])).collect();
    let mut sections = Vec::new();
    let mut section = Vec::new();
    // Where the current leg starts: its corner, or the end of the blend over it.
    let mut cut_before = 0.0;
    for (i, (direction, length)) in legs.iter().enumerate() {
        let corner = &path[i + 1];
        let half = legs.get(i + 1).and_then(|(next, next_length)| {
            let limit = longest.min(LEG_SHARE * length).min(LEG_SHARE * next_length);
            free_blend(checker, corner, direction, next, limit, 1e-3 * longest)
        });
        let cut_after = half.unwrap_or(0.0);
        let straight = length - cut_before - cut_after;
        if straight > 1e-12 {
            let start = offset(&path[i], direction, cut_before);
            let curvature = vec![0.0; start.len()];
            section.push(Piece { start, direction: direction.clone(), curvature, length: straight });
        }
        match (half, legs.get(i + 1)) {
            (Some(half), Some((next, _))) if half > 0.0 => {
                let curvature = next.iter().zip(direction).map(|(b, a)| (b - a) / (2.0 * half)).collect();
                let start = offset(corner, direction, -half);
                section.push(Piece { start, direction: direction.clone(), curvature, length: 2.0 * half });
            }
            (Some(_), _) => {}
            (None, _) => sections.push(std::mem::take(&mut section)),
        }
        cut_before = cut_after;
    }
    sections.retain(|s| !s.is_empty());
    sections
}

/// Cuts pieces into about `count` intervals, at least four for each blend.
pub(super) fn subdivide(section: &[Piece], count: u32) -> Vec<Interval> {
    let total: f64 = section.iter().map(|p| p.length).sum();
    let mut intervals = Vec::new();
    for piece in section {
        let least = if piece.curvature.iter().all(|c| *c == 0.0) { 1.0 } else { 4.0 };
        let n = (f64::from(count) * piece.length / total).ceil().max(least);
        let length = piece.length / n;
        for k in 0..n as usize {
            let s = k as f64 * length;
            let start = Interval {
                start: piece.start.clone(),
                direction: piece.direction.clone(),
                curvature: piece.curvature.clone(),
                length: s,
            };
            intervals.push(Interval {
                start: start.end(),
                direction: start.end_direction(),
                curvature: piece.curvature.clone(),
                length,
            });
        }
    }
    intervals
}

/// Direction of unit length in the metric, and length.
fn leg(space: &Space, from: &[f64], to: &[f64]) -> (Vec<f64>, f64) {
    let length = space.distance(from, to);
    (from.iter().zip(to).map(|(a, b)| (b - a) / length).collect(), length)
}

fn offset(q: &[f64], direction: &[f64], distance: f64) -> Vec<f64> {
    q.iter().zip(direction).map(|(x, d)| x + distance * d).collect()
}

/// Half the length of the largest blend that is free, up to `limit`; zero when the corner is straight; `None` when no
/// blend of at least `least` is free.
fn free_blend<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    corner: &[f64],
    before: &[f64],
    after: &[f64],
    limit: f64,
    least: f64,
) -> Option<f64> {
    let turn: Vec<f64> = after.iter().zip(before).map(|(b, a)| b - a).collect();
    if turn.iter().all(|t| t.abs() < 1e-9) {
        return Some(0.0);
    }
    let sharpness = checker.travel(&turn);
    let resolution = checker.resolution();
    let mut half = limit;
    while half >= least.min(limit) && half > 1e-9 {
        // The curve leaves the path by a quarter of `half * sharpness` at most, and n chords by that over n^2: by a
        // sixteenth of the resolution.
        let chords = 2.0 * (half * sharpness / resolution).sqrt();
        if chords_are_free(checker, corner, before, after, half, chords.ceil().max(1.0)) {
            return Some(half);
        }
        half *= 0.5;
    }
    None
}

fn chords_are_free<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    corner: &[f64],
    before: &[f64],
    after: &[f64],
    half: f64,
    chords: f64,
) -> bool {
    // Bezier curve with control points corner - half * before, corner, corner + half * after.
    let at = |t: f64| -> Vec<f64> {
        let (a, b) = (-half * (1.0 - t) * (1.0 - t), half * t * t);
        (0..corner.len()).map(|i| corner[i] + a * before[i] + b * after[i]).collect()
    };
    let mut from = at(0.0);
    (1..=chords as usize).all(|k| {
        let to = at(k as f64 / chords);
        let free = checker.edge(&from, &to).is_ok();
        from = to;
        free
    })
}
