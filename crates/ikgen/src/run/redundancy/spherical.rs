//! Arms with a spherical shoulder, an elbow and a spherical wrist: all joint values that reach a pose, as functions of the swivel angle.
//!
//! The distance between the points where the first three and the last three axes meet gives the elbow. What is left is to turn
//! the arm about the line between them by the swivel angle `psi`: rotations of shoulder and wrist are then linear in `cos psi` and
//! `sin psi`, and of three joints with right angles between them the outer ones are `atan2`, the middle one is `acos` of such functions
//! (Shimizu, Kakuya, Yoon, Kitagaki and Kosuge, "Analytical inverse kinematic computation for 7-DOF redundant manipulators with
//! joint limits and its application to redundancy resolution", 2008; here for any directions of the axes at zero).

use std::f64::consts::PI;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use robotc_core::Pose;

use super::sinusoid::{Sinusoid, Turning, principal};
use crate::kernel::chain::Frame;
use crate::run::TrueChain;

/// Axes meet and stand at right angles when they do to this, metres and radians: answers are exact to 1e-9.
const EXACT: f64 = 1e-10;

/// Where the outer axes of three line up to this, radians, only the sum or the difference of their joints matters.
const ALIGNED: f64 = 1e-9;

/// An arm of this kind: axes as they lie at zero, in the base frame.
#[derive(Debug, Clone)]
pub(super) struct SphericalArm {
    axes: [Vector3<f64>; 7],
    shoulder: Vector3<f64>,
    elbow: Vector3<f64>,
    wrist: Vector3<f64>,
    tip: Frame,
}

/// How the angle between the outer axes of three joints opens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// The middle joint is on the positive side of where the outer axes line up.
    Positive,
    /// On the negative side.
    Negative,
    /// The outer axes are lined up: only the sum or the difference of their joints matters.
    Aligned,
}

/// A joint value as a function of the swivel angle.
#[derive(Debug, Clone, Copy)]
pub(super) enum Angle {
    Constant(f64),
    /// The angle of the vector `(x, y)`.
    Direction {
        x: Sinusoid,
        y: Sinusoid,
    },
    /// `start + sign acos(cosine)`; the sine is the length of a vector.
    Opening {
        start: f64,
        sign: f64,
        cosine: Sinusoid,
        sine: [Sinusoid; 2],
    },
}

impl Angle {
    /// In [-pi, pi].
    pub(super) fn at(self, psi: f64) -> f64 {
        match self {
            Self::Constant(angle) => angle,
            Self::Direction { x, y } => libm::atan2(y.at(psi), x.at(psi)),
            Self::Opening { start, sign, cosine, sine } => {
                let sine = libm::hypot(sine[0].at(psi), sine[1].at(psi));
                principal(start + sign * libm::atan2(sine, cosine.at(psi)))
            }
        }
    }

    /// As [`at`](Self::at), coming from the side of `towards`: where the vector vanishes only its direction on the way is known.
    pub(super) fn beside(self, psi: f64, towards: f64) -> f64 {
        match self {
            Self::Direction { x, y } if libm::hypot(x.at(psi), y.at(psi)) < ALIGNED => {
                let sign = (towards - psi).signum();
                libm::atan2(sign * y.slope().at(psi), sign * x.slope().at(psi))
            }
            _ => self.at(psi),
        }
    }

    /// Swivel angles at which it may have this value.
    pub(super) fn crossings(self, value: f64) -> Vec<f64> {
        match self {
            Self::Constant(_) => Vec::new(),
            Self::Direction { x, y } => y.times(libm::cos(value)).minus(x.times(libm::sin(value))).roots(),
            Self::Opening { start, cosine, .. } => {
                cosine.minus(Sinusoid::constant(libm::cos(value - start))).roots()
            }
        }
    }

    /// Swivel angles between which it moves one way.
    pub(super) fn turning_points(self) -> Vec<f64> {
        match self {
            Self::Constant(_) => Vec::new(),
            Self::Opening { cosine, .. } => cosine.extrema().to_vec(),
            Self::Direction { x, y } => Sinusoid {
                still: y.sin * x.cos - y.cos * x.sin,
                cos: x.still * y.sin - y.still * x.sin,
                sin: y.still * x.cos - x.still * y.cos,
            }
            .roots(),
        }
    }

    /// Positive where it grows with the swivel angle, negative where it falls.
    pub(super) fn sense(self, psi: f64) -> f64 {
        match self {
            Self::Constant(_) => 0.0,
            Self::Direction { x, y } => y.slope().at(psi) * x.at(psi) - y.at(psi) * x.slope().at(psi),
            Self::Opening { sign, cosine, .. } => -sign * cosine.slope().at(psi),
        }
    }
}

/// What the joints of three axes that meet do for one side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spread {
    pub(super) side: Side,
    /// The only swivel angle at which this side is taken; otherwise it is taken at every one.
    pub(super) only_at: Option<f64>,
    pub(super) first: Angle,
    pub(super) middle: Angle,
    /// When aligned, the value of the last joint where the first one is zero.
    pub(super) last: Angle,
    /// When aligned, by how much the last joint turns back for each turn of the first one: 1 or -1.
    pub(super) back: f64,
    /// Swivel angles at which outer joints jump by half a turn.
    pub(super) jumps: [Option<f64>; 2],
}

impl SphericalArm {
    /// The arm, if a chain is one.
    pub(super) fn of(chain: &TrueChain) -> Option<Self> {
        let (lines, tip) = chain.lines()?;
        let axes: [Vector3<f64>; 7] =
            lines.iter().map(|line| line.direction.into()).collect::<Vec<_>>().try_into().ok()?;
        let points: Vec<Vector3<f64>> = lines.iter().map(|line| line.point.into()).collect();
        let at_right_angles = |i: usize| axes[i].dot(&axes[i + 1]).abs() < EXACT;
        if ![0, 1, 4, 5].into_iter().all(at_right_angles) {
            return None;
        }
        let meet = |first: usize| {
            // The axes of the first two are at right angles.
            let (a, b) = (axes[first], axes[first + 1]);
            let across = a.cross(&b);
            let along = (points[first + 1] - points[first]).cross(&b).dot(&across);
            let point = points[first] + a * along;
            let near = |i: usize| (point - points[i]).cross(&axes[i]).norm() < EXACT;
            (first..first + 3).all(near).then_some(point)
        };
        let (shoulder, wrist) = (meet(0)?, meet(4)?);
        let elbow = points[3] + axes[3] * axes[3].dot(&(shoulder - points[3]));
        Some(Self { axes, shoulder, elbow, wrist, tip })
    }

    /// For each elbow angle its value and what shoulder and wrist do; `None` where the wrist is on the shoulder and everything can
    /// turn about it.
    pub(super) fn elbows(&self, base_from_tip: &Pose) -> Option<Vec<(f64, Vec<Spread>, Vec<Spread>)>> {
        let tip = &self.tip;
        let at_zero = Matrix3::from_fn(|i, j| tip.rotation[i][j]);
        let turn = base_from_tip.rotation.to_rotation_matrix().into_inner() * at_zero.transpose();
        let wrist = base_from_tip.translation.vector + turn * (self.wrist - Vector3::from(tip.position));
        let reach = wrist - self.shoulder;
        let line = Unit::try_new(reach, 1e-6)?;
        let bend = Unit::new_unchecked(self.axes[3]);
        // |elbow + R4 (wrist - elbow) - shoulder| = |reach|
        let (upper, lower) = (self.elbow - self.shoulder, self.wrist - self.elbow);
        let along = bend.dot(&lower);
        let across = lower - bend.into_inner() * along;
        let distance = Sinusoid {
            still: upper.norm_squared() + lower.norm_squared() + 2.0 * along * upper.dot(&bend)
                - reach.norm_squared(),
            cos: 2.0 * upper.dot(&across),
            sin: 2.0 * upper.dot(&bend.cross(&across)),
        };
        let mut angles = distance.roots();
        angles.dedup();
        // The plane of the arm holds the first axis where the swivel angle is zero.
        let first = self.axes[0];
        let level = [first, self.axes[1]].map(|a| a.cross(&line)).into_iter().find(|n| n.norm() > 1e-6)?;
        let mut found = Vec::new();
        for angle in angles {
            let bent = Rotation3::from_axis_angle(&bend, angle);
            let before = Unit::try_new(upper + bent * lower, 1e-9)?;
            let normal = bend.into_inner() - before.into_inner() * before.dot(&bend);
            let before = frame_of(&before, &normal)?;
            let shoulder = Turning::about(&line, &(frame_of(&line, &level)? * before.transpose()));
            let wrist = shoulder.back_between(&bent.matrix().transpose(), &turn);
            found.push((angle, spreads(&self.axes[..3], &shoulder), spreads(&self.axes[4..], &wrist)));
        }
        Some(found)
    }
}

/// The right-handed frame whose first vector is `along` and whose second one is in the direction of `side`, which is at right angles to it.
fn frame_of(along: &Vector3<f64>, side: &Vector3<f64>) -> Option<Matrix3<f64>> {
    let side = side.try_normalize(1e-9)?;
    Some(Matrix3::from_columns(&[*along, side, along.cross(&side)]))
}

/// All ways in which three joints make these rotations.
///
/// With axes `a, b, c` and `theta` the angle of the middle joint from where `c` lies on `a`: `R c = cos(theta) a + sin(theta) (b x a)`
/// turned about `a`, and the same backwards for `c`.
fn spreads(axes: &[Vector3<f64>], rotation: &Turning) -> Vec<Spread> {
    let [a, b, c] = [axes[0], axes[1], axes[2]];
    let start = libm::atan2(a.dot(&b.cross(&c)), a.dot(&c));
    let cosine = rotation.form(&a, &c);
    let (first_x, first_y) = (rotation.form(&b.cross(&a), &c), rotation.form(&b, &c));
    let (last_x, last_y) = (rotation.form(&a, &c.cross(&b)), rotation.form(&a, &b));
    let sine = |psi: f64| libm::hypot(first_x.at(psi), first_y.at(psi));
    let always = [first_x, first_y].iter().all(|w| w.is_constant()) && sine(0.0) < ALIGNED;
    let lined_up: Vec<f64> = if always || cosine.is_constant() {
        Vec::new()
    } else {
        cosine.extrema().into_iter().filter(|psi| sine(*psi) < ALIGNED).collect()
    };
    let jumps = [lined_up.first().copied(), lined_up.get(1).copied()];
    let mut found = Vec::new();
    for (side, sign) in [(Side::Positive, 1.0), (Side::Negative, -1.0)] {
        if !always {
            found.push(Spread {
                side,
                only_at: None,
                first: Angle::Direction { x: first_x.times(sign), y: first_y.times(sign) },
                middle: Angle::Opening { start, sign, cosine, sine: [first_x, first_y] },
                last: Angle::Direction { x: last_x.times(sign), y: last_y.times(sign) },
                back: 0.0,
                jumps,
            });
        }
    }
    let aligned = |only_at: Option<f64>| {
        let same = cosine.at(only_at.unwrap_or(0.0)) > 0.0;
        let middle = principal(if same { start } else { start + PI });
        let unbent = Rotation3::from_axis_angle(&Unit::new_unchecked(b), middle);
        // R = Rb Rc where the first joint is at zero: Rc b is Rb^T R b.
        let (x, y) = (unbent * b, unbent * c.cross(&b));
        Spread {
            side: Side::Aligned,
            only_at,
            first: Angle::Constant(0.0),
            middle: Angle::Constant(middle),
            last: Angle::Direction { x: rotation.form(&x, &b), y: rotation.form(&y, &b) },
            back: if same { 1.0 } else { -1.0 },
            jumps: [None; 2],
        }
    };
    if always {
        found.push(aligned(None));
    }
    found.extend(lined_up.into_iter().map(|psi| aligned(Some(psi))));
    found
}
