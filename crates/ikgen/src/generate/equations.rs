//! Scalar equations of a loop, and which unknowns are in them.
//!
//! With some motions of `e_1 ... e_n = G` left and the others taken to the right, what both sides make of a point or a direction is
//! equal: its height along a direction, its angle to one, its distance from a point. Taken at the axes and where axes meet, many of
//! these equations hold few unknowns. (The sets of equations of Diankov's thesis, section 4.1, with the constants of the chain in
//! place of symbols.)

use nalgebra::Vector3;
use robotc_core::model::ChainMotion;
use robotc_core::rng::Rng;

use super::builder::{Builder, Move, Scalar, Vector};
use super::facts::{Axis, feet, parallel, tidy};
use super::problem::Motion;

/// How far a joint has moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// By an angle, as cosine and sine.
    Turn(f64, f64),
    /// By a length.
    Slide(f64),
}

impl Step {
    /// A random one.
    pub fn random(motion: ChainMotion, rng: &mut Rng) -> Self {
        let x = rng.range(-std::f64::consts::PI, std::f64::consts::PI);
        match motion {
            ChainMotion::Revolute => Step::Turn(libm::cos(x), libm::sin(x)),
            ChainMotion::Prismatic => Step::Slide(0.3 * x),
        }
    }

    fn back(self) -> Self {
        match self {
            Step::Turn(c, s) => Step::Turn(c, -s),
            Step::Slide(x) => Step::Slide(-x),
        }
    }

    fn rotate(self, axis: &Axis, v: Vector3<f64>) -> Vector3<f64> {
        let Step::Turn(c, s) = self else { return v };
        let along = axis.direction * axis.direction.dot(&v);
        along + (v - along) * c + axis.direction.cross(&v) * s
    }

    fn apply(self, axis: &Axis, p: Vector3<f64>) -> Vector3<f64> {
        match self {
            Step::Turn(..) => axis.point + self.rotate(axis, p - axis.point),
            Step::Slide(x) => p + axis.direction * x,
        }
    }
}

/// What is compared on both sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measure {
    /// Height of a point along a direction.
    Height(Vector3<f64>, Vector3<f64>),
    /// Cosine of the angle between a direction and an image of another.
    Angle(Vector3<f64>, Vector3<f64>),
    /// Squared distance of the image of the second point from the first.
    Distance(Vector3<f64>, Vector3<f64>),
}

impl Measure {
    /// What it is, in a word.
    pub fn name(&self) -> &'static str {
        match self {
            Measure::Height(..) => "height",
            Measure::Angle(..) => "angle",
            Measure::Distance(..) => "distance",
        }
    }
}

/// An equation between the two sides of a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equation {
    /// The motions `from..to` stay on the left.
    pub from: usize,
    /// End of that range.
    pub to: usize,
    /// What is compared.
    pub measure: Measure,
}

/// A value of each variable, and the motion from the tip's pose at zero to the pose that is wanted.
#[derive(Debug, Clone)]
pub struct State<'a> {
    /// The axes of the loop.
    pub axes: &'a [Axis],
    /// Steps of the variables.
    pub steps: Vec<Step>,
    /// Steps of the variables at which the wanted pose is reached.
    pub goal: &'a [Step],
}

impl State<'_> {
    /// An image of a point (or direction) on the left side or the right.
    fn image(&self, from: usize, to: usize, left: bool, point: bool, x: Vector3<f64>) -> Vector3<f64> {
        let act = |x, axis: &Axis, step: Step| if point { step.apply(axis, x) } else { step.rotate(axis, x) };
        let of = |axis: &Axis| self.steps[axis.variable];
        if left {
            return self.axes[from..to].iter().rev().fold(x, |x, a| act(x, a, of(a)));
        }
        let x = self.axes[to..].iter().fold(x, |x, a| act(x, a, of(a).back()));
        let x = self.axes.iter().rev().fold(x, |x, a| act(x, a, self.goal[a.variable]));
        self.axes[..from].iter().fold(x, |x, a| act(x, a, of(a).back()))
    }

    /// Left side less right side.
    pub fn gap(&self, e: &Equation) -> f64 {
        let side = |left| match e.measure {
            Measure::Height(u, p) => u.dot(&self.image(e.from, e.to, left, true, p)),
            Measure::Angle(u, v) => u.dot(&self.image(e.from, e.to, left, false, v)),
            Measure::Distance(c, p) => (self.image(e.from, e.to, left, true, p) - c).norm_squared(),
        };
        side(true) - side(false)
    }
}

/// All equations of a loop of these axes.
pub fn all(axes: &[Axis]) -> Vec<Equation> {
    let (points, directions) = (points(axes), directions(axes));
    let mut found = Vec::new();
    for from in 0..=axes.len() {
        for to in from..=axes.len() {
            let mut add = |measure| found.push(Equation { from, to, measure });
            for u in &directions {
                points.iter().for_each(|p| add(Measure::Height(*u, *p)));
                directions.iter().for_each(|v| add(Measure::Angle(*u, *v)));
            }
            for c in &points {
                points.iter().for_each(|p| add(Measure::Distance(*c, *p)));
            }
        }
    }
    found
}

/// Points of turning axes: where neighbours are nearest to each other.
fn points(axes: &[Axis]) -> Vec<Vector3<f64>> {
    let mut found: Vec<Vector3<f64>> = Vec::new();
    let mut add = |p: Vector3<f64>| {
        if found.iter().all(|q| (p - q).norm() > 1e-9) {
            found.push(p);
        }
    };
    let turning: Vec<&Axis> = axes.iter().filter(|a| a.motion == ChainMotion::Revolute).collect();
    for pair in turning.windows(2) {
        if !parallel(pair[0], pair[1], 1e-6) {
            let (a, b) = feet(pair[0], pair[1]);
            add(a);
            add(b);
        }
    }
    axes.iter().for_each(|a| add(a.point));
    found
}

/// Directions of the axes, those across two of them, and those of the base.
fn directions(axes: &[Axis]) -> Vec<Vector3<f64>> {
    let mut found: Vec<Vector3<f64>> = Vec::new();
    let mut add = |d: Vector3<f64>| {
        let n = d.norm();
        if n > 1e-3 && found.iter().all(|e| e.cross(&d).norm() > 1e-9 * n) {
            found.push((d / n).map(tidy));
        }
    };
    axes.iter().for_each(|a| add(a.direction));
    [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().for_each(&mut add);
    axes.windows(2).for_each(|pair| add(pair[0].direction.cross(&pair[1].direction)));
    found
}

impl Equation {
    /// Whether a variable moves something on one side.
    pub fn moves(&self, axes: &[Axis], left: bool, variable: usize) -> bool {
        let inside = |i: usize| (self.from..self.to).contains(&i);
        axes.iter().enumerate().any(|(i, a)| a.variable == variable && inside(i) == left)
    }

    /// One side as an expression, with these motions of the variables.
    pub fn side<'b>(
        &self,
        left: bool,
        b: &'b Builder,
        axes: &[Axis],
        moves: &[Move<'b>],
        goal: &Motion<'b>,
    ) -> Scalar<'b> {
        let image = |point: bool, x: &Vector3<f64>| {
            let act = |x: Vector<'b>, axis: &Axis, step: Move<'b>| {
                if point { step.apply(b, axis, x) } else { step.rotate(b, axis, x) }
            };
            let of = |axis: &Axis| moves[axis.variable];
            let x = b.vector(x);
            if left {
                return axes[self.from..self.to].iter().rev().fold(x, |x, a| act(x, a, of(a)));
            }
            let x = axes[self.to..].iter().fold(x, |x, a| act(x, a, of(a).back()));
            let x = if point { goal.apply(b, x) } else { goal.rotate(b, x) };
            axes[..self.from].iter().fold(x, |x, a| act(x, a, of(a).back()))
        };
        match &self.measure {
            Measure::Height(u, p) => b.vector(u).dot(image(true, p)),
            Measure::Angle(u, v) => b.vector(u).dot(image(false, v)),
            Measure::Distance(c, p) => (image(true, p) - b.vector(c)).square(),
        }
    }
}
