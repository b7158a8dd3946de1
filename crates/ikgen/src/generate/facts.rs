//! What is known of a chain before any equation is written: its axes at zero, snapped to the ideal ones nearby.

use nalgebra::{Matrix3, Vector3};
use robotc_core::Pose;
use robotc_core::model::{ChainMotion, SerialChain};

/// A joint axis in the base frame with all variables at zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// Unit direction; a positive value turns or slides along it.
    pub direction: Vector3<f64>,
    /// A point on it, metres.
    pub point: Vector3<f64>,
    /// How the joint moves.
    pub motion: ChainMotion,
    /// The variable that moves it.
    pub variable: usize,
    /// How far, for each unit of the variable: positive, and one unless the joint follows another.
    pub ratio: f64,
}

/// The axes of a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Facts {
    /// As described, base to tip.
    pub described: Vec<Axis>,
    /// Snapped.
    pub ideal: Vec<Axis>,
    /// Rotation from the base to the frame in which the axes are given: the identity when they look simple in the base frame.
    pub canonical_from_base: nalgebra::UnitQuaternion<f64>,
    /// `canonical_from_tip` with all variables at zero.
    pub tip: Pose,
    /// Radians and metres within which relations between axes count as meant.
    pub tolerance: f64,
}

impl Facts {
    /// The facts of a chain whose joints each have a variable of their own; `None` for coupled joints.
    pub fn new(chain: &SerialChain, tolerance: f64) -> Option<Self> {
        let facts = Self::coupled(chain, tolerance)?;
        (facts.ideal.len() == chain.variables.len()).then_some(facts)
    }

    /// The facts of a chain in which several joints may move by the same amount, or by the opposite; `None` for other ratios.
    pub fn coupled(chain: &SerialChain, tolerance: f64) -> Option<Self> {
        let facts = Self::geared(chain, tolerance);
        facts.described.iter().all(|a| a.ratio == 1.0).then_some(facts)
    }

    /// The facts of any chain.
    pub fn geared(chain: &SerialChain, tolerance: f64) -> Self {
        let axes = axes_at_zero(chain);
        let tip = chain.forward(&vec![0.0; chain.variables.len()]);
        let identity = nalgebra::UnitQuaternion::identity();
        let simple = |axes: &[Axis]| axes.iter().all(|a| simple_direction(&a.direction, tolerance).is_some());
        let turn = if simple(&axes) { identity } else { canonical_turn(&axes) };
        let described: Vec<Axis> = axes
            .iter()
            .map(|a| Axis { direction: turn * a.direction, point: turn * a.point, ..*a })
            .collect();
        let ideal = ideal_axes(&described, tolerance);
        let tip = Pose::from_parts(nalgebra::Translation3::identity(), turn) * tip;
        Self { described, ideal, canonical_from_base: turn, tip, tolerance }
    }
}

/// Largest difference between two lists of axes: radians of direction, metres between lines where it matters, at
/// the points of the ideal ones.
pub fn snap_between(described: &[Axis], ideal: &[Axis]) -> f64 {
    described
        .iter()
        .zip(ideal)
        .map(|(d, i)| {
            let turn = d.direction.cross(&i.direction).norm();
            let gap = if d.motion == ChainMotion::Revolute {
                (i.point - d.point).cross(&d.direction).norm()
            } else {
                0.0
            };
            turn.max(gap)
        })
        .fold(0.0, f64::max)
}

fn axes_at_zero(chain: &SerialChain) -> Vec<Axis> {
    let mut axes = Vec::new();
    let mut at = Pose::identity();
    for joint in &chain.joints {
        at *= joint.previous_from_joint;
        let direction = at.rotation * joint.axis.into_inner();
        axes.push(Axis {
            direction: if joint.multiplier < 0.0 { -direction } else { direction },
            point: at.translation.vector,
            motion: joint.motion,
            variable: joint.variable,
            ratio: joint.multiplier.abs(),
        });
        at *= match joint.motion {
            ChainMotion::Revolute => Pose::from_parts(
                nalgebra::Translation3::identity(),
                nalgebra::UnitQuaternion::from_axis_angle(&joint.axis, joint.offset),
            ),
            ChainMotion::Prismatic => Pose::from_parts(
                nalgebra::Translation3::from(joint.axis.into_inner() * joint.offset),
                nalgebra::UnitQuaternion::identity(),
            ),
        };
    }
    axes
}

/// The turn that makes the first axis z and the next other direction lie in the xz plane.
fn canonical_turn(axes: &[Axis]) -> nalgebra::UnitQuaternion<f64> {
    let z = axes[0].direction;
    let other = axes.iter().map(|a| a.direction).find(|d| d.cross(&z).norm() > 0.1);
    let other = other.unwrap_or_else(|| if z.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() });
    let x = (other - z * z.dot(&other)).normalize();
    let y = z.cross(&x);
    let rotation = Matrix3::from_rows(&[x.transpose(), y.transpose(), z.transpose()]);
    nalgebra::UnitQuaternion::from_rotation_matrix(&nalgebra::Rotation3::from_matrix_unchecked(rotation))
}

fn ideal_axes(described: &[Axis], tolerance: f64) -> Vec<Axis> {
    let mut ideal: Vec<Axis> = Vec::new();
    for axis in described {
        let mut direction = axis.direction;
        if let Some(simple) = simple_direction(&direction, tolerance) {
            direction = simple;
        } else if let Some(other) =
            ideal.iter().find(|other| other.direction.cross(&direction).norm() < tolerance)
        {
            direction = other.direction * other.direction.dot(&direction).signum();
        }
        ideal.push(Axis { direction, point: axis.point.map(tidy), ..*axis });
    }
    ideal
}

/// A direction whose coordinates are all 0, 1, 1/2 or half of a small root, if one is near.
fn simple_direction(d: &Vector3<f64>, tolerance: f64) -> Option<Vector3<f64>> {
    let simple = [0.0, 0.5, std::f64::consts::FRAC_1_SQRT_2, 0.75_f64.sqrt(), 1.0];
    let snapped = d.map(|x| {
        let nearest = simple
            .into_iter()
            .fold(9.0, |best: f64, s| if (x.abs() - s).abs() < (x.abs() - best).abs() { s } else { best });
        nearest.copysign(x) + 0.0
    });
    let fits = (snapped - d).norm() < tolerance && (snapped.norm() - 1.0).abs() < 1e-12;
    fits.then_some(snapped)
}

/// Removes rounding of the last digits, so that constants that are equal by design are equal.
pub fn tidy(x: f64) -> f64 {
    let rounded = (x * 1e10).round() / 1e10;
    if (rounded - x).abs() < 1e-14 { rounded } else { x }
}

/// Whether two axes are parallel, within `tolerance` radians.
pub fn parallel(a: &Axis, b: &Axis, tolerance: f64) -> bool {
    a.direction.cross(&b.direction).norm() < tolerance
}

/// Feet of the common normal of two axes that are not parallel.
pub fn feet(a: &Axis, b: &Axis) -> (Vector3<f64>, Vector3<f64>) {
    let n = a.direction.cross(&b.direction);
    let d = b.point - a.point;
    let s = d.cross(&b.direction).dot(&n) / n.norm_squared();
    let t = d.cross(&a.direction).dot(&n) / n.norm_squared();
    ((a.point + a.direction * s).map(tidy), (b.point + b.direction * t).map(tidy))
}

/// The point of `axis` nearest to `point`.
pub fn foot(axis: &Axis, point: &Vector3<f64>) -> Vector3<f64> {
    (axis.point + axis.direction * axis.direction.dot(&(point - axis.point))).map(tidy)
}

/// The point where all these axes meet, within `tolerance` metres.
pub fn meeting_point(axes: &[Axis], tolerance: f64) -> Option<Vector3<f64>> {
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for axis in axes {
        let across = Matrix3::identity() - axis.direction * axis.direction.transpose();
        matrix += across;
        right += across * axis.point;
    }
    // Far from singular unless all are parallel.
    if matrix.determinant().abs() < 1e-6 {
        return None;
    }
    let point = matrix.try_inverse()? * right;
    let near = |a: &Axis| (point - a.point).cross(&a.direction).norm() < tolerance;
    axes.iter().all(near).then(|| point.map(tidy))
}
