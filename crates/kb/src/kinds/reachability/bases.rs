//! Inverse reachability for planners that place a base: maps as a distribution of bases.

use std::f64::consts::PI;

use robotc_core::Pose;
use robotc_core::rng::Rng;
use robotc_planning::placement::{BaseDistribution, Prism, Stand};

use super::floor::Floor;
use super::map::{ReachabilityMap, Verdict};
use super::placement::{Placement, Placements, Target, Trust};

/// An arm on a base that drives.
#[derive(Debug, Clone)]
pub struct MountedArm<'a> {
    /// What it reaches.
    pub map: &'a ReachabilityMap,
    /// `mobile_from_base`: where the arm's base is on what drives, for each position of a torso.
    pub mounts: Vec<Pose>,
    /// From the tool that grasps are given for to the tip of the arm.
    pub tool_from_tip: Pose,
}

/// Bases from which maps say that arms reach, and whose footprint is clear of obstacles.
///
/// They are drawn uniformly from the disc that holds them all until the map says yes and the footprint is clear. A draw gives up
/// soon, so that another pose is tried: those with many such bases are drawn the more often, and what obstacles leave of a pose counts,
/// not what there would be without them. Where hardly any base is good, the distribution of the pose is made and pruned
/// (thesis, section 4.5), and drawn from as often as bases would have been found.
pub struct MapBases<'a> {
    arms: Vec<MountedArm<'a>>,
    around: Option<(&'a Floor, &'a Prism)>,
    poses: Vec<Asked>,
}

/// What is known of a pose.
struct Asked {
    arm: usize,
    world_from_tool: Pose,
    target: Target,
    /// Radius of a disc that holds all bases that reach it; `None` when there is none.
    radius: Option<f64>,
    /// Bases drawn since the last good one.
    missed: u32,
    /// Bases of the pose, and how often one is found where [`TRIES`] are drawn.
    made: Option<(Placements, f64)>,
}

/// Bases drawn for one pose before another is tried.
const TRIES: u32 = 8;

/// Bases drawn in vain before a distribution is made and pruned: they take about as long.
const PATIENCE: u32 = 4000;

impl<'a> MapBases<'a> {
    /// Bases for these arms, on a floor with obstacles or on an empty one.
    pub fn new(arms: Vec<MountedArm<'a>>, around: Option<(&'a Floor, &'a Prism)>) -> Self {
        Self { arms, around, poses: Vec::new() }
    }

    fn is_clear(&self, placement: &Placement) -> bool {
        self.around.is_none_or(|(floor, base)| floor.is_clear(base, placement))
    }

    /// Radius of a disc about the target that holds all bases that reach it; `None` when there is none.
    fn radius(&self, arm: usize, target: &Target) -> Option<f64> {
        let MountedArm { map, mounts, .. } = &self.arms[arm];
        let reach = map.grid.radial as f64 * map.grid.step;
        let of_mount = |mount: &Pose| {
            let centre = (mount * map.grid.base_from_axis).translation.vector;
            let height = target.world_from_tip.translation.vector.z - centre.z;
            let level = reach * reach - height * height;
            (level > 0.0).then(|| level.sqrt() + centre.xy().norm())
        };
        mounts.iter().filter_map(of_mount).reduce(f64::max)
    }

    /// Position of what is known of a pose.
    fn asked(&mut self, arm: usize, world_from_tool: &Pose) -> usize {
        let is_this = |asked: &Asked| asked.arm == arm && asked.world_from_tool == *world_from_tool;
        self.poses.iter().position(is_this).unwrap_or_else(|| {
            let world_from_tip = world_from_tool * self.arms[arm].tool_from_tip;
            let target = Target { world_from_tip, weight: 1.0 };
            let radius = self.radius(arm, &target);
            let world_from_tool = *world_from_tool;
            self.poses.push(Asked { arm, world_from_tool, target, radius, missed: 0, made: None });
            self.poses.len() - 1
        })
    }

    /// A base anywhere in the disc, if the map says yes and it is clear.
    fn try_one(&self, asked: &Asked, radius: f64, rng: &mut Rng) -> Option<Placement> {
        let (distance, angle) = (radius * rng.unit().sqrt(), rng.range(-PI, PI));
        let p = asked.target.world_from_tip.translation.vector;
        let position = [p.x + distance * libm::cos(angle), p.y + distance * libm::sin(angle)];
        let placement = Placement { position, yaw: rng.range(-PI, PI), target: 0, mount: 0 };
        let MountedArm { map, mounts, .. } = &self.arms[asked.arm];
        let mobile_from_tip = placement.world_from_mobile().inv_mul(&asked.target.world_from_tip);
        let reached = |mount: &Pose| map.verdict(&mount.inv_mul(&mobile_from_tip)) == Verdict::Yes;
        (mounts.iter().any(reached) && self.is_clear(&placement)).then_some(placement)
    }

    /// The bases of a pose that are clear, and how often one is found where [`TRIES`] are drawn.
    fn make(&self, asked: &Asked, radius: f64) -> (Placements, f64) {
        let MountedArm { map, mounts, .. } = &self.arms[asked.arm];
        let mut placements = Placements::new(map, &[asked.target], mounts, Trust::Whole);
        if let Some((floor, base)) = self.around {
            placements.prune(|placement| floor.is_clear(base, placement));
        }
        let share = (placements.mass() / (PI * radius * radius)).min(1.0);
        (placements, 1.0 - (1.0 - share).powi(TRIES as i32))
    }
}

impl BaseDistribution for MapBases<'_> {
    fn mass(&mut self, arm: usize, world_from_tool: &Pose) -> f64 {
        let asked = self.asked(arm, world_from_tool);
        if self.poses[asked].radius.is_some() { 1.0 } else { 0.0 }
    }

    fn draw(&mut self, arm: usize, world_from_tool: &Pose, rng: &mut Rng) -> Option<Stand> {
        let at = self.asked(arm, world_from_tool);
        let asked = &self.poses[at];
        let radius = asked.radius?;
        let stand = |found: Placement| Stand::at([found.position[0], found.position[1], found.yaw]);
        if asked.missed >= PATIENCE && asked.made.is_none() {
            self.poses[at].made = Some(self.make(asked, radius));
        }
        let asked = &self.poses[at];
        if let Some((placements, often)) = &asked.made {
            if rng.unit() >= *often {
                return None;
            }
            return placements.sample_where(rng, 100, |placement| self.is_clear(placement)).map(stand);
        }
        let found = (0..TRIES).find_map(|_| self.try_one(asked, radius, rng));
        self.poses[at].missed = if found.is_some() { 0 } else { self.poses[at].missed + TRIES };
        found.map(stand)
    }
}
