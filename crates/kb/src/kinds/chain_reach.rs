//! How far the tip of an arm can get: a sphere that holds every position it can have.

use nalgebra::{Point3, Vector3};
use robotc_core::Pose;
use robotc_core::model::{ChainMotion, SerialChain};

use crate::codec;
use crate::graph::{PlanError, Planner};
use crate::kind::{DecodeError, Kind, Portability};
use crate::parameters::NoParameters;
use crate::project::OfArm;
use crate::projection::{Limits, Mechanism};
use crate::record::Parts;

/// The kind; its artefact is a [`ReachSphere`].
///
/// A point on each axis is chosen, the tip being the last. Turning a joint leaves the distance between its point and the
/// next as it is, so the tip stays within the sum of these distances of the first point (thesis, section 4.3). Where the
/// thesis takes the closest points between consecutive axes, the points here are those that make the sum smallest.
pub struct ChainReach;

/// A sphere that holds the tip of an arm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReachSphere {
    /// Centre in the frame of the arm's base link; on the first axis.
    pub centre_in_base: Point3<f64>,
    /// Radius, metres.
    pub radius: f64,
}

impl Kind for ChainReach {
    const NAME: &'static str = "chain_reach";
    const FORMAT: u32 = 1;
    const ALGORITHM: u32 = 1;
    const PORTABILITY: Portability = Portability::Portable;
    const DOC: &'static str =
        "A sphere that holds every position of an arm's tip. It bounds and scales the reachability map.";

    type Subject = OfArm;
    type Inputs = Mechanism;
    type Parameters = NoParameters;
    type Artefact = ReachSphere;

    fn inputs(planner: &mut Planner<'_>, subject: &OfArm) -> Result<Mechanism, PlanError> {
        let robot = planner.project().robot();
        let arm = &robot.arms[subject.0];
        Ok(Mechanism::chain(&robot.model, arm.base, arm.tip, Limits::Sliding)?)
    }

    fn key_parts(inputs: &Mechanism, parts: &mut Parts) {
        inputs.key_parts(parts);
    }

    fn defaults(_inputs: &Mechanism) -> NoParameters {
        NoParameters
    }

    fn encode(artefact: &ReachSphere) -> Vec<u8> {
        let c = artefact.centre_in_base;
        codec::encode(&[c.x, c.y, c.z, artefact.radius])
    }

    fn decode(bytes: &[u8]) -> Result<ReachSphere, DecodeError> {
        let [x, y, z, radius]: [f64; 4] = codec::decode(bytes)?;
        if ![x, y, z, radius].iter().all(|v| v.is_finite()) || radius < 0.0 {
            return Err(DecodeError::new("not a sphere"));
        }
        Ok(ReachSphere { centre_in_base: Point3::new(x, y, z), radius })
    }

    fn summary(artefact: &ReachSphere) -> String {
        let c = artefact.centre_in_base;
        format!("radius {:.3} m about ({:.3}, {:.3}, {:.3})", artefact.radius, c.x, c.y, c.z)
    }
}

/// Passes over the points; each makes the sum smaller, and any number of them gives a sphere that holds.
const SWEEPS: usize = 64;

/// The sphere of a chain, in the frame of its base; `None` when a sliding joint has no limits.
pub(super) fn sphere(chain: &SerialChain) -> Option<ReachSphere> {
    let mut axes = Vec::new();
    let mut slides = 0.0;
    let mut base_from_joint = Pose::identity();
    for joint in &chain.joints {
        base_from_joint *= joint.previous_from_joint;
        axes.push(Line {
            anchor: Point3::from(base_from_joint.translation.vector),
            direction: base_from_joint.rotation * joint.axis.into_inner(),
        });
        if joint.motion == ChainMotion::Prismatic {
            let variable = &chain.variables[joint.variable];
            let ends = [variable.lower, variable.upper].map(|x| joint.multiplier * x + joint.offset);
            let farthest = ends[0].abs().max(ends[1].abs());
            if !farthest.is_finite() {
                return None;
            }
            slides += farthest;
        }
    }
    let tip = base_from_joint * chain.last_from_tip * Point3::origin();
    let points = shortest_path(&axes, tip);
    let radius = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum::<f64>() + slides;
    Some(ReachSphere { centre_in_base: points[0], radius })
}

/// A line through `anchor` along the unit vector `direction`.
struct Line {
    anchor: Point3<f64>,
    direction: Vector3<f64>,
}

impl Line {
    fn at(&self, t: f64) -> Point3<f64> {
        self.anchor + self.direction * t
    }

    /// Where on the line the foot of `point` lies, and how far `point` is from it.
    fn foot(&self, point: &Point3<f64>) -> (f64, f64) {
        let t = (point - self.anchor).dot(&self.direction);
        (t, (point - self.at(t)).norm())
    }
}

/// A point on each line and then `tip`, so that the path through them is as short as some sweeps make it.
fn shortest_path(lines: &[Line], tip: Point3<f64>) -> Vec<Point3<f64>> {
    let mut points: Vec<Point3<f64>> = lines.iter().map(|line| line.anchor).chain([tip]).collect();
    for _ in 0..SWEEPS {
        for (i, line) in lines.iter().enumerate() {
            let (t_next, d_next) = line.foot(&points[i + 1]);
            let t = match i {
                0 => t_next,
                _ => {
                    // As light finds its way: the path from the last point to the next, unfolded about the line.
                    let (t_last, d_last) = line.foot(&points[i - 1]);
                    let sum = d_last + d_next;
                    if sum > 0.0 { (t_last * d_next + t_next * d_last) / sum } else { t_next }
                }
            };
            points[i] = line.at(t);
        }
    }
    points
}

#[cfg(feature = "build")]
mod build {
    use robotc_core::ids::{Idx, LinkIdx};
    use robotc_core::model::{Configuration, Kinematics};

    use super::*;
    use crate::kind::{Build, BuildError, Context};

    impl Build for ChainReach {
        fn build(
            inputs: &Mechanism,
            _parameters: &NoParameters,
            _context: &Context<'_>,
        ) -> Result<ReachSphere, BuildError> {
            sphere(&chain(inputs)?)
                .ok_or_else(|| BuildError::Impossible("a sliding joint of the arm has no limits".into()))
        }

        fn check(
            artefact: &ReachSphere,
            inputs: &Mechanism,
            _parameters: &NoParameters,
            context: &Context<'_>,
        ) -> Result<(), BuildError> {
            const SAMPLES: usize = 1000;
            let model = inputs.model();
            let kinematics = Kinematics::new(model.clone());
            let mut rng = context.seed().split("check").rng();
            for _ in 0..SAMPLES {
                let draw = |dof: &robotc_core::model::Dof| {
                    let (low, high) = dof.sampling_range();
                    rng.range(low, high)
                };
                let q = Configuration::from_values(model.dofs().iter().map(draw).collect());
                let tip = kinematics.root_from_link(&q, inputs.tip()) * Point3::origin();
                let distance = (tip - artefact.centre_in_base).norm();
                if distance > artefact.radius + 1e-9 {
                    return Err(BuildError::Check(format!(
                        "the tip gets {distance} m from the centre at {q:?}"
                    )));
                }
            }
            Ok(())
        }
    }

    fn chain(inputs: &Mechanism) -> Result<SerialChain, BuildError> {
        let kinematics = Kinematics::new(inputs.model().clone());
        SerialChain::between(&kinematics, LinkIdx::new(0), inputs.tip())
            .map_err(|error| BuildError::Impossible(error.to_string()))
    }
}
