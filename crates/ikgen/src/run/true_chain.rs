//! The chain whose pose a solution must reach: constants given at load, not part of the program.

use nalgebra::{UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_core::model::{ChainMotion, SerialChain};

use super::frame;
use crate::kernel::candidate::Arm;
use crate::kernel::chain::{Frame, Link, MAX_JOINTS};
use crate::kernel::vector::Line;

/// A serial chain in the form of the kernel: every axis is the z axis of its joint frame, offsets are folded in.
#[derive(Debug, Clone, PartialEq)]
pub struct TrueChain {
    pub(crate) links: Vec<Link>,
    pub(crate) last_from_tip: Frame,
    pub(crate) variables: usize,
    /// Whether each variable is a length.
    pub(crate) slides: Vec<bool>,
}

impl TrueChain {
    /// The kernel's form of a chain; `None` when it has more than [`MAX_JOINTS`] joints.
    pub fn new(chain: &SerialChain) -> Option<Self> {
        if chain.joints.len() > MAX_JOINTS || chain.joints.is_empty() {
            return None;
        }
        let mut links = Vec::new();
        let mut slides = vec![false; chain.variables.len()];
        // From the z-aligned frame after the previous joint to the described one.
        let mut aligned_from_described = Pose::identity();
        for joint in &chain.joints {
            let flip = if joint.multiplier == -1.0 { -1.0 } else { 1.0 };
            let axis = joint.axis.into_inner() * flip;
            let described_from_aligned =
                Pose::from_parts(nalgebra::Translation3::identity(), turn_z_to(&axis));
            let slides_here = joint.motion == ChainMotion::Prismatic;
            links.push(Link {
                previous_from_joint: frame(
                    &(aligned_from_described * joint.previous_from_joint * described_from_aligned),
                ),
                slides: slides_here,
                variable: joint.variable,
                ratio: joint.multiplier * flip,
            });
            slides[joint.variable] = slides_here;
            let z = Vector3::z_axis();
            let offset = joint.offset * flip;
            let after = match joint.motion {
                ChainMotion::Revolute => Pose::from_parts(
                    nalgebra::Translation3::identity(),
                    UnitQuaternion::from_axis_angle(&z, offset),
                ),
                ChainMotion::Prismatic => Pose::translation(0.0, 0.0, offset),
            };
            aligned_from_described = after * described_from_aligned.inverse();
        }
        let last_from_tip = frame(&(aligned_from_described * chain.last_from_tip));
        Some(Self { links, last_from_tip, variables: chain.variables.len(), slides })
    }

    /// The numbers that generated sources take as a chain: of the frame of each joint, from base to tip, and then of the tip, the rotation
    /// row by row and the position (metres). For calibrated arms, whose constants are data.
    pub fn constants(&self) -> Vec<f64> {
        let frames = self.links.iter().map(|link| &link.previous_from_joint).chain([&self.last_from_tip]);
        frames.flat_map(|f| f.rotation.as_flattened().iter().chain(&f.position).copied()).collect()
    }

    /// The lines about which its joints turn at zero, and the pose of the tip there, in the base frame; `None` unless all joints turn, each by a
    /// variable of its own, in order.
    pub(crate) fn lines(&self) -> Option<(Vec<Line>, Frame)> {
        let plain = |(i, link): (usize, &Link)| !link.slides && link.variable == i && link.ratio == 1.0;
        if !self.links.iter().enumerate().all(plain) {
            return None;
        }
        let mut at =
            Frame { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], position: [0.0; 3] };
        let lines = self.links.iter().map(|link| {
            at = at.times(&link.previous_from_joint);
            Line { direction: at.rotation.map(|row| row[2]), point: at.position }
        });
        let lines = lines.collect();
        Some((lines, at.times(&self.last_from_tip)))
    }

    /// The chain as the kernel's functions take it.
    pub(crate) fn arm<'a>(&'a self, held: &'a [bool]) -> Arm<'a> {
        Arm { links: &self.links, last_from_tip: &self.last_from_tip, slides: &self.slides, held }
    }
}

/// A rotation that takes the z axis to `axis`.
fn turn_z_to(axis: &Vector3<f64>) -> UnitQuaternion<f64> {
    UnitQuaternion::rotation_between(&Vector3::z(), axis)
        .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI))
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;
    use robotc_core::ids::Idx;
    use robotc_core::model::{ChainJoint, ChainVariable};

    #[test]
    fn agrees_with_the_chain_as_described() {
        let mut rng = Seed::new(11).rng();
        let variables = (0..5)
            .map(|i| ChainVariable {
                name: format!("j{i}"),
                dof: robotc_core::DofIdx::new(i),
                lower: -3.0,
                upper: 3.0,
            })
            .collect();
        let multipliers = [1.0, -1.0, 1.0, 0.5, 1.0, 1.0];
        let joints = (0..6)
            .map(|i| ChainJoint {
                name: format!("j{i}"),
                motion: if i == 2 { ChainMotion::Prismatic } else { ChainMotion::Revolute },
                previous_from_joint: Pose::from_parts(
                    nalgebra::Translation3::from(rng.direction().into_inner()),
                    rng.rotation(),
                ),
                axis: if i == 4 { -Vector3::z_axis() } else { rng.direction() },
                variable: [0, 1, 2, 3, 4, 0][i],
                multiplier: multipliers[i],
                offset: 0.1 * i as f64,
            })
            .collect();
        let last_from_tip = Pose::from_parts(nalgebra::Translation3::new(0.1, 0.2, 0.3), rng.rotation());
        let chain = SerialChain { name: "test".into(), joints, variables, last_from_tip };
        let kernel = TrueChain::new(&chain).unwrap();
        for _ in 0..50 {
            let values: Vec<f64> = (0..5).map(|_| rng.range(-3.0, 3.0)).collect();
            let expected = frame(&chain.forward(&values));
            let arm = kernel.arm(&[false; 5]);
            assert!(arm.forward_values(&values).distance(&expected) < 1e-14);
        }
    }
}
