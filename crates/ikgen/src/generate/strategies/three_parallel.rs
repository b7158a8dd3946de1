//! Six joints of which the second, third and fourth are parallel.
//!
//! Along the common direction `h` the three do nothing, which leaves two equations for `q1` and `q5`: the height of a point of axis
//! 6, and the angle between `h` and axis 6. What remains in the plane across `h` is a triangle. Turned round, the same serves
//! chains whose third, fourth and fifth axes are parallel.

use robotc_core::model::ChainMotion;

use super::orient::{across, angle_between};
use crate::generate::builder::{Builder, Move, Turn, Vector};
use crate::generate::facts::{feet, foot, parallel};
use crate::generate::problem::{Motion, Problem};

/// Squared sine of the angle below which axis 6 may be taken as parallel to the three, where nothing else is found.
const NEARLY_PARALLEL: f64 = 1e-6;

pub(super) fn write(problem: &mut Problem, b: &Builder) -> Result<String, String> {
    if problem.axes.iter().any(|a| a.motion != ChainMotion::Revolute) {
        return Err("a joint slides".into());
    }
    let tolerance = problem.tolerance();
    let near = tolerance.max(1e-9);
    let a = &mut problem.axes;
    if !parallel(&a[1], &a[2], near) || !parallel(&a[2], &a[3], near) {
        return Err("axes 2, 3 and 4 are not parallel".into());
    }
    if !problem.given.is_empty() {
        return Err("a given joint lies between the unknown ones".into());
    }
    if parallel(&a[0], &a[1], 0.02) || parallel(&a[4], &a[3], 0.02) || parallel(&a[4], &a[5], 0.02) {
        return Err("more axes are parallel".into());
    }
    let h = a[1].direction;
    for axis in &mut a[2..4] {
        axis.direction = h * h.dot(&axis.direction).signum();
    }
    let (p5, p6) = feet(&a[4], &a[5]);
    if (p5 - p6).norm() > tolerance {
        return Err("axes 5 and 6 do not meet".into());
    }
    (a[4].point, a[5].point) = (p5, p5);
    a[3].point = foot(&a[3], &p5);
    for i in [2, 1] {
        a[i].point = foot(&a[i], &a[i + 1].point);
    }
    for i in 1..3 {
        if (a[i].point - a[i + 1].point).norm() < tolerance.max(1e-6) {
            return Err("two of the parallel axes coincide".into());
        }
    }
    a[0].point = foot(&a[0], &a[1].point);

    let axes = problem.axes.clone();
    let names: Vec<String> = (0..6).map(|i| problem.name(i)).collect();
    let goal = problem.goal(b);
    let direction = |i: usize| b.vector(&axes[i].direction);
    let point = |i: usize| b.vector(&axes[i].point);
    let hv = b.vector(&h);

    b.note("height of the meeting point of axes 5 and 6 along the parallel axes: joint 1 alone");
    let (h1, place) = (direction(0), goal.apply(b, point(5)) - point(0));
    let still = place.along(h1);
    let q1 = b.circle(
        &names[0],
        hv.dot(place - still),
        -hv.dot(h1.cross(place)),
        hv.dot(point(4)) - hv.dot(point(0)) - hv.dot(still),
    );

    b.note("angle between the parallel axes and axis 6: joint 5");
    let last = goal.rotate(b, direction(5)).turned_back(h1, q1);
    let q5 = angle_between(b, &names[4], [&h, &axes[4].direction, &axes[5].direction], last);

    b.note("direction of the parallel axes as seen from the tip: joint 6");
    let from = hv.turned_back(direction(4), q5);
    let to = goal.inverse().rotate(b, hv.turned(h1, q1));
    let h6 = direction(5);
    let across_6 = from - from.along(h6);
    let (x, y) = (across_6.dot(to), -h6.dot(across_6.cross(to)));
    let rest = Rest { problem, b, names: &names, goal: &goal, q1, q5 };
    let aligned = from.cross(h6).square();
    b.fallback(
        || {
            let q6 = b.align(&names[5], x, y);
            rest.plane(q6);
        },
        || b.if_zero(aligned, NEARLY_PARALLEL, || rest.aligned_wrist(), || {}),
    );
    Ok("axes 5 and 6 meeting".into())
}

/// What remains once joints 1 and 5 are known.
struct Rest<'b, 'p> {
    problem: &'p Problem,
    b: &'b Builder,
    names: &'p [String],
    goal: &'p Motion<'b>,
    q1: Turn<'b>,
    q5: Turn<'b>,
}

impl<'b> Rest<'b, '_> {
    fn direction(&self, i: usize) -> Vector<'b> {
        self.b.vector(&self.problem.axes[i].direction)
    }

    fn point(&self, i: usize) -> Vector<'b> {
        self.b.vector(&self.problem.axes[i].point)
    }

    /// `R1^T (G x - p1) + p1 - p2` without the part along the parallel axes: where a point of the tip side is to be, as seen
    /// from axis 2.
    fn seen_from_axis_2(&self, place: Vector<'b>) -> Vector<'b> {
        let p1 = self.point(0);
        let seen = (place - p1).turned_back(self.direction(0), self.q1) + p1 - self.point(1);
        seen - seen.along(self.direction(1))
    }

    /// A point of axis 4 carried back over joint 5, relative to the meeting point of axes 5 and 6.
    fn elbow_side(&self) -> Vector<'b> {
        (self.point(3) - self.point(4)).turned_back(self.direction(4), self.q5)
    }

    /// Axis 6 is parallel to the three: `q6` is free within what the triangle of axes 2, 3 and 4 can reach, and
    /// is put in the middle of that.
    fn aligned_wrist(&self) {
        let b = self.b;
        b.note("axis 6 is parallel too: any value of joint 6 for which axes 2, 3 and 4 close the triangle");
        let (centre, h6) = (self.point(5), self.direction(5));
        let arm = self.elbow_side();
        let along = arm.along(h6);
        let still = self.seen_from_axis_2(self.goal.apply(b, centre + along));
        let turn_only = |v: Vector<'b>| {
            let v = self.goal.rotate(b, v).turned_back(self.direction(0), self.q1);
            v - v.along(self.direction(1))
        };
        // R6^T swings the other way.
        let (cos, sin) = (turn_only(arm - along), turn_only(-h6.cross(arm)));
        let (x, y) = (still.dot(cos) * 2.0, still.dot(sin) * 2.0);
        let mean = still.square() + cos.square();
        let swing = (x * x + y * y).sqrt();
        let (short, long) = self.sides();
        let nearest = (mean - swing).max(b.constant((long - short).powi(2)));
        let farthest = (mean + swing).min(b.constant((long + short).powi(2)));
        let q6 = b.circle(&self.names[5], x, y, (nearest + farthest) * 0.5 - mean);
        self.plane(q6);
    }

    fn sides(&self) -> (f64, f64) {
        let a = &self.problem.axes;
        let (p, q) = ((a[2].point - a[1].point).norm(), (a[3].point - a[2].point).norm());
        (p.min(q), p.max(q))
    }

    /// The triangle of axes 2, 3 and 4.
    fn plane(&self, q6: Turn<'b>) {
        let b = self.b;
        let axes = &self.problem.axes;
        b.note("the triangle of axes 2, 3 and 4");
        let centre = self.point(5);
        let back = self.elbow_side().turned_back(self.direction(5), q6);
        let u = self.seen_from_axis_2(self.goal.apply(b, centre + back));
        let (p23, p34) = (self.point(2) - self.point(1), self.point(3) - self.point(2));
        let h3 = self.direction(2);
        let constant = p23.square() + p34.square();
        let q3 =
            b.circle(&self.names[2], p23.dot(p34) * 2.0, p23.dot(h3.cross(p34)) * 2.0, u.square() - constant);
        let arm = p23 + p34.turned(h3, q3);
        let q2 = b.align(&self.names[1], arm.dot(u), self.direction(1).dot(arm.cross(u)));
        // R2 R3 R4 = R1^T G R6^T R5^T, seen on a vector across the parallel axes.
        let side = across(&axes[1].direction);
        let v = b.vector(&side).turned_back(self.direction(4), self.q5).turned_back(self.direction(5), q6);
        let v = self
            .goal
            .rotate(b, v)
            .turned_back(self.direction(0), self.q1)
            .turned_back(self.direction(1), q2)
            .turned_back(h3, q3);
        let q4 =
            b.align(&self.names[3], v.dot(b.vector(&side)), v.dot(b.vector(&axes[3].direction.cross(&side))));
        let turns = [self.q1, q2, q3, q4, self.q5, q6];
        self.problem.emit(b, &turns.map(Move::Turn));
    }
}
