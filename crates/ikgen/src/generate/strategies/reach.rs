//! Three revolute joints that bring a point to a place.
//!
//! `e1 e2 e3 start = goal`. With `v(q3)` the place of the point as seen from axis 2, and `p12` the step from axis 1 to axis 2,
//! the turn about axis 2 must satisfy two equations that are linear in the cosine and sine of `q3`:
//!
//! ```text
//! p12 . R2 v = (|goal|^2 - |p12|^2 - |v|^2) / 2
//! h1  . R2 v = h1 . (goal - p12)
//! ```
//!
//! (Pieper, 1968, in the notation of products of exponentials.) Where axes 1 and 2 are parallel or meet, one of the two
//! does not contain `q2` and gives `q3` alone; otherwise both together give `R2 v`, and its length is a conic in the
//! cosine and sine of `q3`.

use nalgebra::Vector3;

use crate::generate::builder::{Builder, Move, Scalar, Turn, Vector};
use crate::generate::facts::{Axis, feet, foot, parallel};

/// An axis whose constants may depend on given values.
#[derive(Clone, Copy)]
pub(in crate::generate) struct Line<'b> {
    pub(in crate::generate) direction: Vector<'b>,
    pub(in crate::generate) point: Vector<'b>,
}

impl<'b> Line<'b> {
    pub(in crate::generate) fn constant(b: &'b Builder, axis: &Axis) -> Self {
        Self { direction: b.vector(&axis.direction), point: b.vector(&axis.point) }
    }

    /// The line carried along by a motion about `axis`.
    pub(in crate::generate) fn moved(self, b: &'b Builder, axis: &Axis, step: Move<'b>) -> Self {
        Self { direction: step.rotate(b, axis, self.direction), point: step.apply(b, axis, self.point) }
    }

    /// The same line, turning the other way.
    pub(super) fn flipped(self) -> Self {
        Self { direction: -self.direction, ..self }
    }
}

/// How the first two axes of a reach lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pair {
    Parallel,
    Meeting,
    Skew,
}

/// How two axes lie; moves their points to the feet of the common normal, or onto the meeting point.
pub(super) fn classify(first: &mut Axis, second: &mut Axis, tolerance: f64) -> Pair {
    if parallel(first, second, tolerance.max(1e-9)) {
        first.point = foot(first, &second.point);
        return Pair::Parallel;
    }
    let (a, b) = feet(first, second);
    if (a - b).norm() < tolerance {
        // The first axis stays where it is; the second is moved onto it.
        first.point = a;
        second.point = a;
        return Pair::Meeting;
    }
    first.point = a;
    second.point = b;
    Pair::Skew
}

/// A vector that depends on the cosine and sine of one angle.
#[derive(Clone, Copy)]
struct Swing<'b> {
    still: Vector<'b>,
    cos: Vector<'b>,
    sin: Vector<'b>,
}

impl<'b> Swing<'b> {
    fn dot(&self, u: Vector<'b>) -> Form<'b> {
        Form { still: u.dot(self.still), cos: u.dot(self.cos), sin: u.dot(self.sin) }
    }

    fn at(&self, t: Turn<'b>) -> Vector<'b> {
        self.still + self.cos * t.cos + self.sin * t.sin
    }
}

/// `still + cos c + sin s`.
#[derive(Clone, Copy)]
struct Form<'b> {
    still: Scalar<'b>,
    cos: Scalar<'b>,
    sin: Scalar<'b>,
}

impl<'b> Form<'b> {
    fn plus(self, other: Self, factor: Scalar<'b>) -> Self {
        Self {
            still: self.still + other.still * factor,
            cos: self.cos + other.cos * factor,
            sin: self.sin + other.sin * factor,
        }
    }

    fn at(&self, t: Turn<'b>) -> Scalar<'b> {
        self.still + self.cos * t.cos + self.sin * t.sin
    }

    /// Adds the coefficients of `sign * self^2` to those of a conic.
    fn add_square(&self, sign: f64, q: &mut [Scalar<'b>; 6]) {
        let Form { still, cos, sin } = *self;
        let terms =
            [cos * cos, cos * sin * 2.0, sin * sin, cos * still * 2.0, sin * still * 2.0, still * still];
        for (sum, term) in q.iter_mut().zip(terms) {
            *sum = *sum + term * sign;
        }
    }
}

/// The turns of three axes, base to tip, that bring `start` to `goal`; `second` is the direction of axis 2 as numbers.
pub(super) fn reach<'b>(
    b: &'b Builder,
    names: [&str; 3],
    axes: [Line<'b>; 3],
    second: &Vector3<f64>,
    pair: Pair,
    start: Vector<'b>,
    goal: Vector<'b>,
) -> [Turn<'b>; 3] {
    let [h1, h2, h3] = axes.map(|a| a.direction);
    let p12 = axes[1].point - axes[0].point;
    let p23 = axes[2].point - axes[1].point;
    let p34 = start - axes[2].point;
    let goal = goal - axes[0].point;
    let along = p34.along(h3);
    let v = Swing { still: p23 + along, cos: p34 - along, sin: h3.cross(p34) };
    let square = Form {
        still: p23.square() + p34.square() + p23.dot(along) * 2.0,
        cos: p23.dot(v.cos) * 2.0,
        sin: p23.dot(v.sin) * 2.0,
    };
    let half = b.constant(0.5);
    // Two equations, u_k . R2 v = right_k, less the part of v along axis 2, which the turn leaves alone.
    let zero = b.constant(0.0);
    let square_right =
        Form { still: (goal.square() - p12.square()) * half, cos: zero, sin: zero }.plus(square, -half);
    let axis_right = Form { still: h1.dot(goal) - h1.dot(p12), cos: zero, sin: zero };
    let (q3, q2, w);
    match pair {
        Pair::Parallel | Pair::Meeting => {
            let (equation, other, right) = if pair == Pair::Parallel {
                b.note("axes parallel: the height along them does not depend on the turn of the second");
                let height = v.dot(h1);
                (Form { still: height.still - axis_right.still, ..height }, p12, square_right)
            } else {
                b.note("axes meet: the distance from their common point does not depend on the turn of the second");
                (Form { still: square.still - goal.square(), ..square }, h1, axis_right)
            };
            q3 = b.circle(names[2], equation.cos, equation.sin, -equation.still);
            w = v.at(q3);
            let across = w - w.along(h2);
            let right = right.at(q3) - other.dot(w.along(h2));
            q2 = b.circle(names[1], other.dot(across), other.dot(h2.cross(w)), right);
        }
        Pair::Skew => {
            b.note("axes skew: two linear equations give the turned vector, its length a conic");
            let e1 = if second.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
            let e1 = (e1 - second * second.dot(&e1)).normalize().map(crate::generate::facts::tidy);
            let (e1, e2) = (b.vector(&e1), b.vector(&second.cross(&e1)));
            let height = v.dot(h2);
            let rights = [square_right.plus(height, -p12.dot(h2)), axis_right.plus(height, -h1.dot(h2))];
            let [a, c] = [p12.dot(e1), p12.dot(e2)];
            let [d, f] = [h1.dot(e1), h1.dot(e2)];
            // Cramer, undivided: det * (x, y) = R2 v in the plane across axis 2.
            let det = a * f - c * d;
            let x = scaled(rights[0], f).plus(rights[1], -c);
            let y = scaled(rights[1], a).plus(rights[0], -d);
            let (v1, v2) = (v.dot(e1), v.dot(e2));
            let mut q = [zero; 6];
            x.add_square(1.0, &mut q);
            y.add_square(1.0, &mut q);
            scaled(v1, det).add_square(-1.0, &mut q);
            scaled(v2, det).add_square(-1.0, &mut q);
            q3 = b.conic(names[2], q);
            w = v.at(q3);
            let (x, y, v1, v2) = (x.at(q3) * det, y.at(q3) * det, v1.at(q3), v2.at(q3));
            q2 = b.align(names[1], v1 * x + v2 * y, v1 * y - v2 * x);
        }
    }
    let reached = p12 + w.turned(h2, q2);
    let reached = reached - reached.along(h1);
    let q1 = b.align(names[0], reached.dot(goal), h1.dot(reached.cross(goal)));
    [q1, q2, q3]
}

fn scaled<'b>(form: Form<'b>, factor: Scalar<'b>) -> Form<'b> {
    Form { still: form.still * factor, cos: form.cos * factor, sin: form.sin * factor }
}
