//! Six joints that move in a plane through axis 1, with a wrist whose centre is beside axis 5 (FANUC CRX).
//!
//! Axes 1 and 2 meet in O, axes 3 and 4 in E, axes 4 and 5 in W, axes 5 and 6 in C; axes 2 and 3 are parallel; and O, E and W lie in a
//! plane with axis 1. The pose gives C. For a turn `q6` it gives the direction `u` of axis 5 too, and with it `W = C + d u`: what is left
//! is a triangle O E W in the plane of axis 1 and W, in which E must lie so that axis 4 is at a right angle to `u`. (Abbes and
//! Poisson, 2024, search `q6` for that numerically.) With `w = W - O`, `A = |w|^2`, `h` the direction of axis 1, and
//! the sides `a = |O E|` and `b = |E W|`, it reads, both signs of the elbow multiplied,
//!
//! ```text
//! (u.w)^2 ((A + b^2 - a^2)^2 - (2 b h.w)^2) + (A - (a - b)^2) (A - (a + b)^2) (u.h) g = 0
//! g = (u.h) (|C - O|^2 - d^2) - 2 (h.(C - O)) (u.w)
//! ```
//!
//! after a factor A, without roots of interest, has been divided out. Each letter is of first degree in the cosine and sine
//! of `q6`, so this is of fourth: at most eight angles, each with two values of `q1` and their elbows.

use std::cmp::Ordering;

use robotc_core::model::ChainMotion;

use crate::generate::builder::{Builder, Move, Scalar, Turn, Vector};
use crate::generate::facts::{feet, foot, parallel};
use crate::generate::problem::{Motion, Problem};

/// Square of the distance of W from axis 1, in units of the reach, below which W tells the plane of the arm badly: other equations
/// are asked too.
const NEAR: f64 = 1e-8;

/// The same, below which W does not tell it at all.
const ON: f64 = 1e-20;

/// Cosine of the angle between axes 4 and 5, which are at a right angle, beyond which a triangle is the wrong one.
const WRONG: f64 = 3e-3;

pub(super) fn write(problem: &mut Problem, b: &Builder) -> Result<String, String> {
    if problem.axes.iter().any(|a| a.motion != ChainMotion::Revolute) {
        return Err("a joint slides".into());
    }
    if !problem.given.is_empty() {
        return Err("a given joint lies between the unknown ones".into());
    }
    let sides = sides(problem)?;
    let names: Vec<String> = (0..6).map(|i| problem.name(i)).collect();
    let goal = problem.goal(b);
    let axes = &problem.axes;
    let direction = |i: usize| b.vector(&axes[i].direction);
    let h1 = direction(0);

    b.note("the centre of axes 5 and 6, and axis 5 on the circle round it");
    let centre = goal.apply(b, b.vector(&axes[5].point)) - b.vector(&axes[0].point);
    let (cos, sin) = (goal.rotate(b, direction(4)), goal.rotate(b, direction(4).cross(direction(5))));
    // In units of the reach.
    let unit = 1.0 / (sides.upper + sides.lower + sides.offset.abs());
    let (upper, lower, offset) = (sides.upper * unit, sides.lower * unit, sides.offset * unit);
    let number = |x: f64| b.constant(x);
    let near = centre * number(unit);
    let zero = number(0.0);
    let along = Waves::first(zero, near.dot(cos), near.dot(sin));
    let (square, height) = (near.square(), h1.dot(near));
    // u.w, u.h, h.w and A.
    let reach = along.plus(number(offset));
    let rise = Waves::first(zero, h1.dot(cos), h1.dot(sin));
    let over = rise.times_number(number(offset)).plus(height);
    let far = along.times_number(number(2.0 * offset)).plus(square + number(offset * offset));
    let side = far.plus(number(lower * lower - upper * upper));
    let twice = over.times_number(number(2.0 * lower));
    let edges = far.plus(number(-(upper - lower).powi(2))).times(&far.plus(number(-(upper + lower).powi(2))));
    let g = rise
        .times_number(square - number(offset * offset))
        .sum(&reach.times_number(height * number(-2.0)), number(1.0));
    let first =
        reach.times(&reach).times(&side.sum(&twice, number(-1.0)).times(&side.sum(&twice, number(1.0))));
    let equation = first.sum(&edges.times(&rise.times(&g)), number(1.0));
    let arm = Arm { problem, b, names: &names, goal: &goal, centre, cos, sin, offset: sides.offset };
    let found = || {
        b.note("joint 6: axis 4, from the elbow to the wrist, at a right angle to axis 5");
        let rest = arm.triangle(b.octic(&names[5], &equation.numbers()));
        let beside = h1.cross(rest.wrist).square() * (unit * unit);
        b.aside(|| b.if_zero(beside, NEAR, || rest.turn_about_vertical(), || {}));
        b.if_zero(beside, ON, || {}, || rest.plane_of());
    };
    if (upper - lower).abs() < problem.tolerance().max(1e-6) {
        // The arm may fold up.
        let least = along.0[1].map(|x| x * x);
        let least = square + number(offset * offset) - (least[0] + least[1]).sqrt() * (2.0 * offset.abs());
        let folded = || {
            b.note("the wrist may be at the shoulder: joint 6 brings it as near as it can");
            let side = -sides.offset.signum();
            let [x, y] = along.0[1].map(|x| x * side);
            arm.triangle(b.align(&names[5], x, y)).folded();
        };
        b.fallback(found, || b.if_zero(least, NEAR, folded, || {}));
    } else {
        found();
    }
    Ok("axes 1 to 4 in a plane".into())
}

/// Lengths of the arm.
struct Sides {
    /// From O to E.
    upper: f64,
    /// From E to W.
    lower: f64,
    /// From C to W along axis 5.
    offset: f64,
}

/// Moves the points of the axes to where they meet, if they meet as they must.
fn sides(problem: &mut Problem) -> Result<Sides, String> {
    let tolerance = problem.tolerance();
    let a = &mut problem.axes;
    if !parallel(&a[1], &a[2], tolerance.max(1e-9)) {
        return Err("axes 2 and 3 are not parallel".into());
    }
    for (i, j) in [(0, 1), (2, 3), (3, 4), (4, 5)] {
        if a[i].direction.dot(&a[j].direction).abs() > 1e-12 {
            return Err(format!("axes {} and {} are not at a right angle", i + 1, j + 1));
        }
    }
    let h = a[1].direction;
    a[2].direction = h * h.dot(&a[2].direction).signum();
    let meet = |i: usize, j: usize| {
        let (p, q) = feet(&a[i], &a[j]);
        let words = format!("axes {} and {} do not meet", i + 1, j + 1);
        if (p - q).norm() > tolerance { Err(words) } else { Ok(p) }
    };
    let [shoulder, elbow, wrist, centre] = [meet(0, 1)?, meet(3, 2)?, meet(3, 4)?, meet(4, 5)?];
    if h.dot(&(elbow - shoulder)).abs() > tolerance {
        return Err("axis 4 passes beside the plane of axis 1".into());
    }
    let points = [shoulder, shoulder, foot(&a[2], &elbow), elbow, wrist, centre];
    for (axis, point) in a.iter_mut().zip(points) {
        axis.point = point;
    }
    let sides = Sides {
        upper: (elbow - shoulder).norm(),
        lower: (wrist - elbow).norm(),
        offset: a[4].direction.dot(&(wrist - centre)),
    };
    if sides.upper.min(sides.lower) < tolerance.max(1e-6) {
        return Err("the shoulder or the wrist lies on the elbow".into());
    }
    Ok(sides)
}

/// What the pose says.
struct Arm<'b, 'p> {
    problem: &'p Problem,
    b: &'b Builder,
    names: &'p [String],
    goal: &'p Motion<'b>,
    /// From O to C.
    centre: Vector<'b>,
    /// Axis 5 by cosine and sine of joint 6.
    cos: Vector<'b>,
    sin: Vector<'b>,
    offset: f64,
}

impl<'b, 'p> Arm<'b, 'p> {
    /// Joint 3, for a turn of joint 6.
    fn triangle(&self, q6: Turn<'b>) -> Rest<'b, 'p> {
        let (b, axes) = (self.b, &self.problem.axes);
        let axis5 = self.cos * q6.cos + self.sin * q6.sin;
        let wrist = self.centre + axis5 * b.constant(self.offset);
        b.note("the triangle of shoulder, elbow and wrist: joint 3");
        let [p12, p23] = [(1, 2), (2, 4)].map(|(i, j)| b.vector(&(axes[j].point - axes[i].point)));
        let [h3, h4, h6] = [2, 3, 5].map(|i| b.vector(&axes[i].direction));
        let (x, y) = (p12.dot(p23) * 2.0, p12.dot(h3.cross(p23)) * 2.0);
        let q3 = b.circle(&self.names[2], x, y, wrist.square() - (p12.square() + p23.square()));
        Rest {
            problem: self.problem,
            b,
            names: self.names,
            wrist,
            axis5,
            axis6: self.goal.rotate(b, h6),
            q3,
            q6,
            arm: p12 + p23.turned(h3, q3),
            forearm: h4.turned(h3, q3),
        }
    }
}

/// What remains once joints 3 and 6 are known.
struct Rest<'b, 'p> {
    problem: &'p Problem,
    b: &'b Builder,
    names: &'p [String],
    /// From O to where W is to be.
    wrist: Vector<'b>,
    /// Directions that axes 5 and 6 are to have.
    axis5: Vector<'b>,
    axis6: Vector<'b>,
    q3: Turn<'b>,
    q6: Turn<'b>,
    /// From O to W, with joints 1 and 2 at zero.
    arm: Vector<'b>,
    /// Direction of axis 4, with joints 1 and 2 at zero.
    forearm: Vector<'b>,
}

impl<'b> Rest<'b, '_> {
    fn direction(&self, i: usize) -> Vector<'b> {
        self.b.vector(&self.problem.axes[i].direction)
    }

    /// Joint 1 turns the plane of the arm to W, joint 2 the arm in it.
    fn plane_of(&self) {
        let (b, h1, h2, wrist) = (self.b, self.direction(0), self.direction(1), self.wrist);
        b.note("the plane of the arm through the wrist: joint 1");
        let q1 = b.circle(&self.names[0], h2.dot(wrist), -h2.dot(h1.cross(wrist)), b.constant(0.0));
        let seen = wrist.turned_back(h1, q1);
        let q2 = b.align(&self.names[1], self.arm.dot(seen), h2.dot(self.arm.cross(seen)));
        self.wrist(q1, q2);
    }

    /// W is on axis 1: joint 1 turns axis 4 to where axis 5 wants it.
    fn turn_about_vertical(&self) {
        let (b, h1, h2) = (self.b, self.direction(0), self.direction(1));
        b.note("the wrist is above or below the shoulder: joint 1 from the right angle of axes 4 and 5");
        let seen = self.wrist.along(h1);
        let q2 = b.align(&self.names[1], self.arm.dot(seen), h2.dot(self.arm.cross(seen)));
        let forearm = self.forearm.turned(h2, q2);
        let along = forearm.along(h1);
        let (x, y) = ((forearm - along).dot(self.axis5), h1.cross(forearm).dot(self.axis5));
        let q1 = b.circle(&self.names[0], x, y, -along.dot(self.axis5));
        self.wrist(q1, q2);
    }

    /// W is at O: any plane will do, in which joint 2 turns axis 4 to where axis 5 wants it.
    fn folded(&self) {
        let (b, h1, h2) = (self.b, self.direction(0), self.direction(1));
        b.note("the wrist is at the shoulder: any plane of the arm; joint 2 from the right angle of axes 4 and 5");
        let zero = b.constant(0.0);
        let q1 = b.align(&self.names[0], zero, zero);
        let axis5 = self.axis5.turned_back(h1, q1);
        let (x, y) = (self.forearm.dot(axis5), h2.cross(self.forearm).dot(axis5));
        let q2 = b.circle(&self.names[1], x, y, zero);
        self.wrist(q1, q2);
    }

    /// Joints 4 and 5, if axes 4 and 5 are at a right angle.
    fn wrist(&self, q1: Turn<'b>, q2: Turn<'b>) {
        let b = self.b;
        let [h1, h2, h3, h4, h5] = [0, 1, 2, 3, 4].map(|i| self.direction(i));
        let axis4 = self.forearm.turned(h2, q2).turned(h1, q1);
        let finish = || {
            b.note("what is left of the rotation: joints 4 and 5");
            let back = |v: Vector<'b>| v.turned_back(h1, q1).turned_back(h2, q2).turned_back(h3, self.q3);
            let seen = back(self.axis5);
            let q4 = b.align(&self.names[3], h5.dot(seen), h4.dot(h5.cross(seen)));
            let h6 = self.direction(5);
            let seen = back(self.axis6).turned_back(h4, q4);
            let q5 = b.align(&self.names[4], h6.dot(seen), h5.dot(h6.cross(seen)));
            self.problem.emit(b, &[q1, q2, self.q3, q4, q5, self.q6].map(Move::Turn));
        };
        b.if_zero(axis4.dot(self.axis5), WRONG, finish, || {});
    }
}

/// A sum of waves: for each multiple of the angle the factor of its cosine and of its sine, from zero up.
struct Waves<'b>(Vec<[Scalar<'b>; 2]>);

impl<'b> Waves<'b> {
    fn first(still: Scalar<'b>, cos: Scalar<'b>, sin: Scalar<'b>) -> Self {
        Self(vec![[still, still * 0.0], [cos, sin]])
    }

    fn plus(&self, number: Scalar<'b>) -> Self {
        let mut out = self.0.clone();
        out[0][0] = out[0][0] + number;
        Self(out)
    }

    fn times_number(&self, number: Scalar<'b>) -> Self {
        Self(self.0.iter().map(|wave| wave.map(|x| x * number)).collect())
    }

    /// This and a multiple of another of the same degree.
    fn sum(&self, other: &Self, factor: Scalar<'b>) -> Self {
        let add = |(a, b): (&[Scalar<'b>; 2], &[Scalar<'b>; 2])| [a[0] + b[0] * factor, a[1] + b[1] * factor];
        Self(self.0.iter().zip(&other.0).map(add).collect())
    }

    /// By `2 Re(x e^(i j q)) Re(y e^(i k q)) = Re(x y e^(i (j + k) q)) + Re(x conj(y) e^(i (j - k) q))`.
    fn times(&self, other: &Self) -> Self {
        let zero = self.0[0][1];
        let mut out = vec![[zero; 2]; self.0.len() + other.0.len() - 1];
        for (j, [a, b]) in self.0.iter().enumerate() {
            for (k, [c, d]) in other.0.iter().enumerate() {
                let (ac, bd, ad, bc) = (*a * *c, *b * *d, *a * *d, *b * *c);
                let mut add = |at: usize, [x, y]: [Scalar<'b>; 2]| out[at] = [out[at][0] + x, out[at][1] + y];
                if j == 0 || k == 0 {
                    add(j + k, [ac, ad + bc]);
                    continue;
                }
                add(j + k, [(ac - bd) * 0.5, (ad + bc) * 0.5]);
                let difference = (ac + bd) * 0.5;
                match j.cmp(&k) {
                    Ordering::Less => add(k - j, [difference, (ad - bc) * 0.5]),
                    Ordering::Equal => add(0, [difference, zero]),
                    Ordering::Greater => add(j - k, [difference, (bc - ad) * 0.5]),
                }
            }
        }
        Self(out)
    }

    /// In the order of [`Builder::octic`].
    fn numbers(&self) -> [Scalar<'b>; 9] {
        std::array::from_fn(|i| if i == 0 { self.0[0][0] } else { self.0[i.div_ceil(2)][1 - i % 2] })
    }
}
