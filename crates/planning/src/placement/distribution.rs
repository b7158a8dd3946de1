//! Places of the base from which a pose of the tool is likely to be within reach.

use std::f64::consts::PI;

use nalgebra::{UnitVector3, Vector3};
use robotc_core::Pose;
use robotc_core::rng::Rng;
use serde::{Deserialize, Serialize};

use crate::arm::ArmModel;

/// A distribution of bases on the floor for a pose of the tool: what inverse reachability knows.
pub trait BaseDistribution {
    /// How much of its workspace the arm has for this pose; zero when it is out of reach from everywhere. Poses are chosen in
    /// proportion to it.
    fn mass(&mut self, arm: usize, world_from_tool: &Pose) -> f64;

    /// x, y and heading of a base, drawn the more often the more configurations reach the pose from there; `None` when it is
    /// out of reach from everywhere, or when none was found this time and another pose may be luckier.
    fn draw(&mut self, arm: usize, world_from_tool: &Pose, rng: &mut Rng) -> Option<[f64; 3]>;
}

/// Any place within a radius around the tool, any heading: what informed distributions are compared with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UniformBases {
    /// Largest distance of the base from below the tool, metres.
    pub radius: f64,
}

impl BaseDistribution for UniformBases {
    fn mass(&mut self, _: usize, _: &Pose) -> f64 {
        1.0
    }

    fn draw(&mut self, _: usize, world_from_tool: &Pose, rng: &mut Rng) -> Option<[f64; 3]> {
        let at = world_from_tool.translation.vector;
        let (distance, angle) = (self.radius * rng.unit().sqrt(), rng.range(-PI, PI));
        let heading = rng.range(-PI, PI);
        Some([at.x + distance * libm::cos(angle), at.y + distance * libm::sin(angle), heading])
    }
}

/// Parameters of [`InverseSamples`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct InverseSamplesOptions {
    /// Configurations drawn of each arm.
    pub count: usize,
    /// A sample stands for poses that are no more than this higher or lower, metres.
    pub height: f64,
    /// ... and tilted by no more than this, radians.
    pub tilt: f64,
    /// Standard deviation of the noise on x and y of the base, metres: it fills the gaps between samples.
    pub spread: f64,
}

impl Default for InverseSamplesOptions {
    fn default() -> Self {
        Self { count: 20_000, height: 0.05, tilt: 0.2, spread: 0.02 }
    }
}

/// Inverse reachability from random configurations of the arms, free of self-collision or not: a base that stands upright
/// can be turned and shifted on the floor, so a configuration serves every pose of the tool of the same height and tilt.
///
/// Random joint values crowd where the arm is singular; samples are weighted by the manipulability of the arm (Yoshikawa,
/// 1985), the volume of tool motions that unit joint motions make, so that all poses that the arm reaches count the same.
#[derive(Debug, Clone)]
pub struct InverseSamples {
    options: InverseSamplesOptions,
    arms: Vec<Vec<Sample>>,
    /// Samples that serve poses asked for before, each with the sum of weights up to it: drawing asks for the same poses
    /// again and again.
    last: Vec<(usize, Pose, Vec<(usize, f64)>)>,
}

#[derive(Debug, Clone)]
struct Sample {
    height: f64,
    /// The vertical in the tool frame.
    up_in_tool: UnitVector3<f64>,
    base_from_tool: Pose,
    weight: f64,
}

impl InverseSamples {
    /// Samples of these arms, each given as it stands when the base is at the origin and looks along x.
    pub fn of_arms(arms: &[&ArmModel], options: &InverseSamplesOptions, rng: &mut Rng) -> Self {
        let sample = |arm: &ArmModel, rng: &mut Rng| {
            let q = arm.space().sample(rng);
            let base_from_tool = arm.world_from_tool(&q);
            let jacobian = arm.tool_jacobian(&q);
            let up = base_from_tool.rotation.inverse() * Vector3::z();
            Sample {
                height: base_from_tool.translation.z,
                up_in_tool: UnitVector3::new_normalize(up),
                base_from_tool,
                weight: (&jacobian * jacobian.transpose()).determinant().max(0.0).sqrt(),
            }
        };
        let of_arm = |arm: &&ArmModel| {
            let mut samples: Vec<Sample> = (0..options.count).map(|_| sample(arm, rng)).collect();
            // Those that serve a pose are a range of heights.
            samples.sort_by(|a, b| a.height.total_cmp(&b.height));
            samples
        };
        let arms = arms.iter().map(of_arm).collect();
        Self { options: *options, arms, last: Vec::new() }
    }

    /// Samples that serve a pose, each with the sum of weights up to it.
    fn matches(&mut self, arm: usize, world_from_tool: &Pose) -> &[(usize, f64)] {
        let known = self.last.iter().position(|(a, pose, _)| *a == arm && pose == world_from_tool);
        let entry = known.unwrap_or_else(|| {
            let up = UnitVector3::new_normalize(world_from_tool.rotation.inverse() * Vector3::z());
            let least = libm::cos(self.options.tilt);
            let (samples, height) = (&self.arms[arm], world_from_tool.translation.z);
            let first = samples.partition_point(|s| s.height < height - self.options.height);
            let end = samples.partition_point(|s| s.height <= height + self.options.height);
            let mut sum = 0.0;
            let mut found = Vec::new();
            for (i, sample) in samples.iter().enumerate().take(end).skip(first) {
                if sample.weight > 0.0 && sample.up_in_tool.dot(&up) >= least {
                    sum += sample.weight;
                    found.push((i, sum));
                }
            }
            self.last.push((arm, *world_from_tool, found));
            self.last.len() - 1
        });
        &self.last[entry].2
    }
}

impl BaseDistribution for InverseSamples {
    fn mass(&mut self, arm: usize, world_from_tool: &Pose) -> f64 {
        let count = self.options.count.max(1) as f64;
        self.matches(arm, world_from_tool).last().map_or(0.0, |(_, sum)| sum / count)
    }

    fn draw(&mut self, arm: usize, world_from_tool: &Pose, rng: &mut Rng) -> Option<[f64; 3]> {
        let matches = self.matches(arm, world_from_tool);
        let (_, sum) = *matches.last()?;
        let at = sum * rng.unit();
        let (sample, _) = matches[matches.partition_point(|(_, up_to)| *up_to <= at)];
        let world_from_base = world_from_tool * self.arms[arm][sample].base_from_tool.inverse();
        let ahead = world_from_base.rotation * Vector3::x();
        let at = world_from_base.translation.vector;
        let spread = self.options.spread;
        Some([at.x + spread * rng.normal(), at.y + spread * rng.normal(), libm::atan2(ahead.y, ahead.x)])
    }
}
