//! From candidates to solutions: each is checked on the true chain, polished where it must be, and kept if it is new.

use super::chain::{EXACT, Frame, Link, MAX_JOINTS, TOLERANCE, forward, polish};
use super::math::{angle_of, cos_sin};

/// Solutions closer than this in every variable (radians modulo a turn, metres) are the same one.
pub const SAME: f64 = 1e-7;

/// Slacks of the further attempts at a pose that gave no solution: at poses where several axes line up at once, rounding
/// alone can hide the roots of an equation.
pub const WIDER: [f64; 2] = [1e-5, 2e-3];

/// Wrong candidates of one attempt after which the rest is not looked at. Only attempts with wide slack at poses that cannot
/// be reached come near it; without it they could take milliseconds.
pub const MOST_MISSES: usize = 256;

/// The chain that solutions must satisfy.
#[derive(Clone, Copy, Debug)]
pub struct Arm<'a> {
    /// Moving joints, base to tip.
    pub links: &'a [Link],
    /// Pose of the tip in the frame after the last joint.
    pub last_from_tip: &'a Frame,
    /// For each variable, whether it is a length.
    pub slides: &'a [bool],
    /// For each variable, whether the caller gave it.
    pub held: &'a [bool],
}

/// Whether a candidate that misses by the roots of these squares (rotation, position) needs no polish.
pub fn is_exact(misses: [f64; 2]) -> bool {
    misses[0] <= EXACT * EXACT && misses[1] <= EXACT * EXACT
}

impl Arm<'_> {
    /// `base_from_tip` for the `[cos, sin]` or `[length, _]` of each variable.
    pub fn forward_steps(&self, steps: &[[f64; 2]]) -> Frame {
        let mut moves = [[0.0; 2]; MAX_JOINTS];
        for (link, step) in self.links.iter().zip(&mut moves) {
            let [x, y] = steps[link.variable];
            *step = if link.ratio == 1.0 {
                [x, y]
            } else if link.slides {
                [link.ratio * x, 0.0]
            } else {
                cos_sin(link.ratio * angle_of(y, x))
            };
        }
        forward(self.links, self.last_from_tip, &moves[..self.links.len()])
    }

    /// `base_from_tip` at these variable values.
    pub fn forward_values(&self, values: &[f64]) -> Frame {
        let mut steps = [[0.0; 2]; MAX_JOINTS];
        for (i, value) in values.iter().enumerate() {
            steps[i] = if self.slides[i] { [*value, 0.0] } else { cos_sin(*value) };
        }
        self.forward_steps(&steps[..values.len()])
    }

    /// Turns a candidate into variable values that reach the pose; says whether they do.
    ///
    /// `values` holds the given ones on entry.
    pub fn settle(&self, base_from_tip: &Frame, steps: &[[f64; 2]], values: &mut [f64]) -> bool {
        let distance = self.forward_steps(steps).distance(base_from_tip);
        if !(distance < f64::INFINITY) {
            return false;
        }
        for i in 0..values.len() {
            if !self.held[i] {
                values[i] = if self.slides[i] { steps[i][0] } else { angle_of(steps[i][1], steps[i][0]) };
            }
        }
        if distance <= EXACT {
            return true;
        }
        if !(polish(self.links, self.last_from_tip, base_from_tip, values, self.held) < TOLERANCE) {
            return false;
        }
        for i in 0..values.len() {
            if self.is_round(i) && !self.held[i] {
                values[i] = principal(values[i]);
            }
        }
        true
    }

    /// Whether a full turn of a variable changes nothing: not of a length, nor where a joint follows by a part of the angle.
    pub fn is_round(&self, variable: usize) -> bool {
        !self.slides[variable]
            && self.links.iter().all(|l| l.variable != variable || l.ratio == (l.ratio as i64) as f64)
    }

    /// Whether two solutions are the same one.
    pub fn same(&self, a: &[f64], b: &[f64]) -> bool {
        for i in 0..a.len() {
            let gap = (a[i] - b[i]).abs();
            let turned = (gap - core::f64::consts::TAU).abs();
            if gap >= SAME && (turned >= SAME || !self.is_round(i)) {
                return false;
            }
        }
        true
    }
}

/// The same angle in (-pi, pi].
fn principal(angle: f64) -> f64 {
    use core::f64::consts::{PI, TAU};
    let mut turned = angle;
    while turned > PI {
        turned -= TAU;
    }
    while turned <= -PI {
        turned += TAU;
    }
    turned
}
