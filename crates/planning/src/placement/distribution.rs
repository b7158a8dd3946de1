//! Places of the base from which a pose of the tool is likely to be within reach.

use std::f64::consts::PI;
use std::sync::Arc;

use nalgebra::{UnitVector3, Vector3};
use robotc_core::Pose;
use robotc_core::rng::Rng;
use serde::{Deserialize, Serialize};

use crate::arm::ArmModel;

/// A place to stand that may be good.
#[derive(Debug, Clone, PartialEq)]
pub struct Stand {
    /// x, y and heading of the base.
    pub base: [f64; 3],
    /// Joint values of the arm that put the tool somewhere near the pose asked for, where such are known.
    pub posture: Option<Vec<f64>>,
}

impl Stand {
    /// A place of which nothing else is known.
    pub fn at(base: [f64; 3]) -> Self {
        Self { base, posture: None }
    }
}

/// A distribution of bases on the floor for a pose of the tool: what inverse reachability knows.
pub trait BaseDistribution {
    /// How much of its workspace the arm has for this pose; zero when it is out of reach from everywhere. Poses are chosen in
    /// proportion to it. Asked once for a pose, and only when it may be the next.
    fn mass(&mut self, arm: usize, world_from_tool: &Pose) -> f64;

    /// A place, drawn the more often the more configurations reach the pose from there; `None` when it is out of reach from
    /// everywhere, or when none was found this time and another pose may be luckier.
    fn draw(&mut self, arm: usize, world_from_tool: &Pose, rng: &mut Rng) -> Option<Stand>;
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

    fn draw(&mut self, _: usize, world_from_tool: &Pose, rng: &mut Rng) -> Option<Stand> {
        let at = world_from_tool.translation.vector;
        let (distance, angle) = (self.radius * rng.unit().sqrt(), rng.range(-PI, PI));
        let heading = rng.range(-PI, PI);
        Some(Stand::at([at.x + distance * libm::cos(angle), at.y + distance * libm::sin(angle), heading]))
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
///
/// Each place comes with the posture of its sample, so that it can be given up before inverse kinematics when the arm would be
/// in an obstacle. Cheap to clone: samples are shared.
#[derive(Debug, Clone)]
pub struct InverseSamples {
    options: InverseSamplesOptions,
    arms: Arc<Vec<Samples>>,
    /// Samples that serve poses asked for before: drawing asks for the same poses again and again.
    asked: Vec<Asked>,
}

/// Samples of an arm in slabs of height, in each by their tilt.
#[derive(Debug, Clone)]
struct Samples {
    /// Height of a slab, metres, and the number of the lowest one.
    slab: f64,
    lowest: i64,
    /// For each slab, the position of its first sample; then the number of all.
    starts: Vec<usize>,
    /// The vertical in the tool frame. What decides whether a sample serves a pose is stored by itself.
    ups: Vec<UnitVector3<f64>>,
    heights: Vec<f64>,
    samples: Vec<Sample>,
}

#[derive(Debug, Clone)]
struct Sample {
    base_from_tool: Pose,
    weight: f64,
    posture: Vec<f64>,
}

impl Sample {
    fn height(&self) -> f64 {
        self.base_from_tool.translation.z
    }

    fn up_in_tool(&self) -> UnitVector3<f64> {
        self.base_from_tool.rotation.inverse() * Vector3::z_axis()
    }
}

impl Samples {
    fn new(mut samples: Vec<Sample>, slab: f64) -> Self {
        let number = |sample: &Sample| (sample.height() / slab).floor() as i64;
        let key = |sample: &Sample| (number(sample), sample.up_in_tool().z);
        samples.sort_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        let lowest = samples.first().map_or(0, number);
        let highest = samples.last().map_or(-1, number);
        let starts = (lowest..=highest + 1).map(|at| samples.partition_point(|s| number(s) < at)).collect();
        let ups = samples.iter().map(Sample::up_in_tool).collect();
        let heights = samples.iter().map(Sample::height).collect();
        Self { slab, lowest, starts, ups, heights, samples }
    }

    /// Positions of the samples that are no farther from a height, and from a tilt, than `options` say.
    fn serving(&self, height: f64, up: &UnitVector3<f64>, options: &InverseSamplesOptions) -> Vec<usize> {
        let slab = |height: f64| ((height / self.slab).floor() as i64 - self.lowest).max(0) as usize;
        let (low, high) = (height - options.height, height + options.height);
        let least = libm::cos(options.tilt);
        // Heights of the vertical at this tilt.
        let tilt = libm::acos(up.z.clamp(-1.0, 1.0));
        let from = libm::cos((tilt + options.tilt).min(PI)) - 1e-9;
        let to = libm::cos((tilt - options.tilt).max(0.0)) + 1e-9;
        let mut serving = Vec::new();
        for two in self.starts.windows(2).take(slab(high) + 1).skip(slab(low)) {
            let ups = &self.ups[two[0]..two[1]];
            let first = two[0] + ups.partition_point(|up| up.z < from);
            let end = two[0] + ups.partition_point(|up| up.z <= to);
            let serves = |&i: &usize| self.ups[i].dot(up) >= least && (low..=high).contains(&self.heights[i]);
            serving.extend((first..end).filter(serves));
        }
        serving
    }
}

/// Samples that serve a pose.
#[derive(Debug, Clone)]
struct Asked {
    arm: usize,
    world_from_tool: Pose,
    /// Position of each, and the sum of weights up to it.
    found: Vec<(usize, f64)>,
}

impl InverseSamples {
    /// Samples of these arms, each given as it stands when the base is at the origin and looks along x.
    pub fn of_arms(arms: &[&ArmModel], options: &InverseSamplesOptions, rng: &mut Rng) -> Self {
        let sample = |arm: &ArmModel, rng: &mut Rng| {
            let posture = arm.space().sample(rng);
            let jacobian = arm.tool_jacobian(&posture);
            Sample {
                base_from_tool: arm.world_from_tool(&posture),
                weight: (&jacobian * jacobian.transpose()).determinant().max(0.0).sqrt(),
                posture,
            }
        };
        let of_arm = |arm: &&ArmModel| {
            let mut samples: Vec<Sample> = (0..options.count).map(|_| sample(arm, rng)).collect();
            samples.retain(|sample| sample.weight > 0.0);
            Samples::new(samples, options.height.max(1e-3))
        };
        let arms = Arc::new(arms.iter().map(of_arm).collect());
        Self { options: *options, arms, asked: Vec::new() }
    }

    /// The same without postures that are no good wherever the base is, say for a self-collision. `keep` tells for each posture of
    /// an arm whether it is good.
    pub fn retain(&self, mut keep: impl FnMut(usize, &[&[f64]]) -> Vec<bool>) -> Self {
        let kept = |(number, all): (usize, &Samples)| {
            let postures: Vec<&[f64]> = all.samples.iter().map(|s| s.posture.as_slice()).collect();
            let kept = all.samples.iter().zip(keep(number, &postures)).filter(|(_, keep)| *keep);
            Samples::new(kept.map(|(sample, _)| sample.clone()).collect(), all.slab)
        };
        let arms = Arc::new(self.arms.iter().enumerate().map(kept).collect());
        Self { options: self.options, arms, asked: Vec::new() }
    }

    /// Samples that serve a pose, each with the sum of weights up to it.
    fn matches(&mut self, arm: usize, world_from_tool: &Pose) -> &[(usize, f64)] {
        let known = |asked: &Asked| asked.arm == arm && asked.world_from_tool == *world_from_tool;
        let at = self.asked.iter().position(known).unwrap_or_else(|| {
            let up = world_from_tool.rotation.inverse() * Vector3::z_axis();
            let all = &self.arms[arm];
            let serving = all.serving(world_from_tool.translation.vector.z, &up, &self.options);
            let summed = serving.into_iter().scan(0.0, |sum, i| {
                *sum += all.samples[i].weight;
                Some((i, *sum))
            });
            let found = summed.collect();
            self.asked.push(Asked { arm, world_from_tool: *world_from_tool, found });
            self.asked.len() - 1
        });
        &self.asked[at].found
    }
}

impl BaseDistribution for InverseSamples {
    fn mass(&mut self, arm: usize, world_from_tool: &Pose) -> f64 {
        let count = self.options.count.max(1) as f64;
        self.matches(arm, world_from_tool).last().map_or(0.0, |(_, sum)| sum / count)
    }

    fn draw(&mut self, arm: usize, world_from_tool: &Pose, rng: &mut Rng) -> Option<Stand> {
        let matches = self.matches(arm, world_from_tool);
        let (_, sum) = *matches.last()?;
        let at = sum * rng.unit();
        let (sample, _) = matches[matches.partition_point(|(_, up_to)| *up_to <= at).min(matches.len() - 1)];
        let Sample { base_from_tool, posture, .. } = &self.arms[arm].samples[sample];
        let ahead = world_from_tool.rotation * (base_from_tool.rotation.inverse() * Vector3::x());
        let heading = libm::atan2(ahead.y, ahead.x);
        // The base stands upright where the tool is above the same point of the floor.
        let (sine, cosine) = (libm::sin(heading), libm::cos(heading));
        let (tool, reach) = (world_from_tool.translation.vector, base_from_tool.translation.vector);
        let spread = self.options.spread;
        let x = tool.x - (cosine * reach.x - sine * reach.y) + spread * rng.normal();
        let y = tool.y - (sine * reach.x + cosine * reach.y) + spread * rng.normal();
        Some(Stand { base: [x, y, heading], posture: Some(posture.clone()) })
    }
}
