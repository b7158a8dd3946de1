//! The loop equation in the form strategies work on: a product of motions equals the wanted motion.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use robotc_core::Pose;

use super::builder::{Builder, Move, Scalar, Turn, Vector};
use super::facts::{Axis, Facts, tidy};

/// An added joint is taken to be at zero when its cosine is this close to one; the check of solutions is exact.
pub(super) const OFF_ZERO: f64 = 1e-3;

/// `e_1 e_2 ... e_n = G`: unknown motions about axes given at zero, and the motion that takes the tip from its pose at zero
/// to the wanted one.
///
/// A problem may be turned round (`reversed`): then the product is that of the inverse motions, tip to base.
#[derive(Debug, Clone)]
pub struct Problem {
    /// The unknown axes, in the order of the product.
    pub axes: Vec<Axis>,
    /// Given motions between unknown ones: number of unknowns before each, and its axis; in the order of the product.
    pub given: Vec<(usize, Axis)>,
    /// Given motions before and after all unknown ones.
    outer: (Vec<Axis>, Vec<Axis>),
    reversed: bool,
    facts: Facts,
    free: Vec<usize>,
}

impl Problem {
    /// The problem of a chain with these variables given; `None` when no joint is left to find.
    pub fn new(facts: &Facts, free: &[usize]) -> Option<Self> {
        let mut axes = Vec::new();
        let mut given = Vec::new();
        let mut outer = (Vec::new(), Vec::new());
        let is_free = |a: &Axis| free.contains(&a.variable);
        let last_unknown = facts.ideal.iter().rposition(|a| !is_free(a))?;
        for (i, axis) in facts.ideal.iter().enumerate() {
            if !is_free(axis) {
                axes.push(*axis);
            } else if axes.is_empty() {
                outer.0.push(*axis);
            } else if i > last_unknown {
                outer.1.push(*axis);
            } else {
                given.push((axes.len(), *axis));
            }
        }
        Some(Self { axes, given, outer, reversed: false, facts: facts.clone(), free: free.to_vec() })
    }

    /// The same problem with joints added at the tip that must stay at zero.
    pub fn with_added(&self, added: &[Axis]) -> Self {
        let mut longer = self.clone();
        let variables = self.facts.ideal.len();
        let added = added.iter().enumerate().map(|(i, axis)| Axis { variable: variables + i, ..*axis });
        longer.axes.extend(added);
        longer
    }

    /// The same equation inverted: tip to base.
    pub fn reversed(&self) -> Self {
        let mut turned = self.clone();
        turned.axes.reverse();
        turned.given.reverse();
        let count = turned.axes.len();
        for axis in turned.axes.iter_mut().chain(turned.given.iter_mut().map(|(_, a)| a)) {
            axis.direction = -axis.direction;
        }
        for (before, _) in &mut turned.given {
            *before = count - *before;
        }
        turned.reversed = !self.reversed;
        turned
    }

    /// The given motion between unknown ones, of which some strategies can have one.
    pub fn one_given(&self) -> Result<Option<(usize, Axis)>, String> {
        match self.given[..] {
            [] => Ok(None),
            [only] => Ok(Some(only)),
            _ => Err("several given joints lie between the unknown ones".into()),
        }
    }

    /// Tolerance of relations between axes.
    pub fn tolerance(&self) -> f64 {
        self.facts.tolerance
    }

    /// How far the axes, as a strategy left them, are from the described ones.
    pub fn snap(&self) -> f64 {
        let sign = if self.reversed { -1.0 } else { 1.0 };
        let mut ideal = self.facts.ideal.clone();
        for axis in self.axes.iter().chain(self.given.iter().map(|(_, a)| a)) {
            // Added joints are not part of the description.
            let Some(same) = ideal.iter_mut().find(|a| a.variable == axis.variable) else { continue };
            *same = Axis { direction: axis.direction * sign, ..*axis };
        }
        super::facts::snap_between(&self.facts.described, &ideal)
    }

    /// The wanted motion `G` of this problem.
    pub fn goal<'b>(&self, b: &'b Builder) -> Motion<'b> {
        let given = |axis: &Axis| Factor::Joint(self.move_of(b, axis).back(), *axis);
        // Less the given motions at both ends.
        let mut factors: Vec<Factor<'b>> = self.outer.0.iter().rev().map(given).collect();
        factors.extend(goal_of(&self.facts, b).factors);
        factors.extend(self.outer.1.iter().rev().map(given));
        let motion = Motion { factors };
        if self.reversed { motion.inverse() } else { motion }
    }

    /// The motion of a given axis.
    pub fn move_of<'b>(&self, b: &'b Builder, axis: &Axis) -> Move<'b> {
        let k = self.free.iter().position(|v| *v == axis.variable).expect("only free axes are given");
        let value = b.free(k as u8);
        match axis.motion {
            robotc_core::model::ChainMotion::Revolute => Move::Turn(b.turn_of(value)),
            robotc_core::model::ChainMotion::Prismatic => Move::Slide(value),
        }
    }

    /// Emits a solution: the motion of each unknown axis, in the order of this problem. Added joints must be at zero.
    pub fn emit(&self, b: &Builder, moves: &[Move<'_>]) {
        let mut all: Vec<Option<Move<'_>>> = vec![None; self.facts.ideal.len()];
        let mut off_zero = b.constant(0.0);
        for (axis, step) in self.axes.iter().zip(moves) {
            match (all.get_mut(axis.variable), step) {
                (Some(slot), _) => *slot = Some(*step),
                (None, Move::Turn(t)) => off_zero = off_zero + (b.constant(1.0) - t.cos),
                (None, Move::Slide(x)) => off_zero = off_zero + *x * *x,
            }
        }
        let given = self.given.iter().map(|(_, a)| a);
        for axis in self.outer.0.iter().chain(&self.outer.1).chain(given) {
            all[axis.variable] = Some(self.move_of(b, axis));
        }
        let all: Vec<Move<'_>> =
            all.into_iter().map(|m| m.expect("every variable is unknown or given")).collect();
        if off_zero.as_constant().is_some() {
            b.emit(&all);
        } else {
            b.if_zero(off_zero, OFF_ZERO, || b.emit(&all), || {});
        }
    }

    /// Number of the joint of an unknown axis, from 1 at the base: names of its cosine and sine.
    pub fn name(&self, i: usize) -> String {
        (self.axes[i].variable + 1).to_string()
    }
}

/// The motion that takes the tip from its pose at zero to the wanted one: `canonical_from_tip` (wanted) times
/// `tip_from_canonical` (at zero).
pub fn goal_of<'b>(facts: &Facts, b: &'b Builder) -> Motion<'b> {
    let mut factors = Vec::new();
    let turn = facts.canonical_from_base;
    if turn != UnitQuaternion::identity() {
        factors.push(Factor::constant(b, &Pose::from_parts(Translation3::identity(), turn)));
    }
    factors.push(Factor::Rigid { rows: b.rotation(), position: b.position() });
    factors.push(Factor::constant(b, &facts.tip.inverse()));
    Motion { factors }
}

/// A rigid motion: a product of factors, the last of which acts first.
#[derive(Clone)]
pub struct Motion<'b> {
    factors: Vec<Factor<'b>>,
}

#[derive(Clone)]
enum Factor<'b> {
    Rigid { rows: [Vector<'b>; 3], position: Vector<'b> },
    Joint(Move<'b>, Axis),
}

impl<'b> Motion<'b> {
    /// A direction after the motion.
    pub fn rotate(&self, b: &'b Builder, v: Vector<'b>) -> Vector<'b> {
        self.factors.iter().rev().fold(v, |v, factor| match factor {
            Factor::Rigid { rows, .. } => Vector(rows.map(|row| row.dot(v))),
            Factor::Joint(step, axis) => step.rotate(b, axis, v),
        })
    }

    /// A point after the motion.
    pub fn apply(&self, b: &'b Builder, p: Vector<'b>) -> Vector<'b> {
        self.factors.iter().rev().fold(p, |p, factor| match factor {
            Factor::Rigid { rows, position } => Vector(rows.map(|row| row.dot(p))) + *position,
            Factor::Joint(step, axis) => step.apply(b, axis, p),
        })
    }

    /// The motion back.
    pub fn inverse(&self) -> Self {
        let factors = self.factors.iter().rev().map(|factor| match factor {
            Factor::Rigid { rows, position } => {
                let back = transpose(rows);
                Factor::Rigid { rows: back, position: -Vector(back.map(|row| row.dot(*position))) }
            }
            Factor::Joint(step, axis) => Factor::Joint(step.back(), *axis),
        });
        Self { factors: factors.collect() }
    }
}

impl<'b> Factor<'b> {
    fn constant(b: &'b Builder, pose: &Pose) -> Self {
        let m = pose.rotation.to_rotation_matrix();
        let rows =
            [0, 1, 2].map(|i| b.vector(&Vector3::new(tidy(m[(i, 0)]), tidy(m[(i, 1)]), tidy(m[(i, 2)]))));
        Factor::Rigid { rows, position: b.vector(&pose.translation.vector.map(tidy)) }
    }
}

impl<'b> Move<'b> {
    /// The opposite motion.
    pub fn back(self) -> Self {
        match self {
            Move::Turn(t) => Move::Turn(t.back()),
            Move::Slide(x) => Move::Slide(-x),
        }
    }

    /// A direction after this motion about `axis`.
    pub fn rotate(self, b: &'b Builder, axis: &Axis, v: Vector<'b>) -> Vector<'b> {
        match self {
            Move::Turn(t) => v.turned(b.vector(&axis.direction), t),
            Move::Slide(_) => v,
        }
    }

    /// A point after this motion about `axis`.
    pub fn apply(self, b: &'b Builder, axis: &Axis, p: Vector<'b>) -> Vector<'b> {
        match self {
            Move::Turn(t) => {
                let foot = b.vector(&axis.point);
                foot + (p - foot).turned(b.vector(&axis.direction), t)
            }
            Move::Slide(x) => p + b.vector(&axis.direction) * x,
        }
    }
}

impl<'b> From<Turn<'b>> for Move<'b> {
    fn from(turn: Turn<'b>) -> Self {
        Move::Turn(turn)
    }
}

impl<'b> From<Scalar<'b>> for Move<'b> {
    fn from(length: Scalar<'b>) -> Self {
        Move::Slide(length)
    }
}

fn transpose<'b>(m: &[Vector<'b>; 3]) -> [Vector<'b>; 3] {
    [0, 1, 2].map(|j| Vector([0, 1, 2].map(|i| m[i].0[j])))
}
