//! Inverse reachability for planners that place a base: maps as a distribution of bases.

use std::f64::consts::PI;

use robotc_core::rng::Rng;
use robotc_core::{Pose, Seed};
use robotc_planning::placement::{BaseDistribution, Prism};

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
/// A few bases are drawn uniformly from the disc that holds them all: where every third reaches and is clear, one is found before a
/// distribution is made. For other poses that is made, and kept (thesis, section 4.5): of its samples all reach, and the first that is
/// clear is taken. Only where hardly any is, its cells are pruned.
pub struct MapBases<'a> {
    arms: Vec<MountedArm<'a>>,
    around: Option<(&'a Floor, &'a Prism)>,
    masses: Vec<(usize, Pose, f64)>,
    placements: Vec<Made>,
}

/// The distribution of a pose.
struct Made {
    arm: usize,
    world_from_tool: Pose,
    placements: Placements,
    pruned: bool,
}

/// Bases from which the mass of a pose is guessed.
const GUESSED: u32 = 12;

/// Uniform bases until one is clear and reaches: as many as take about as long as making a distribution.
const UNIFORM: usize = 24;

/// Samples of a distribution until one is clear.
const TRIES: usize = 100;

impl<'a> MapBases<'a> {
    /// Bases for these arms, on a floor with obstacles or on an empty one.
    pub fn new(arms: Vec<MountedArm<'a>>, around: Option<(&'a Floor, &'a Prism)>) -> Self {
        Self { arms, around, masses: Vec::new(), placements: Vec::new() }
    }

    fn is_clear(&self, placement: &Placement) -> bool {
        self.around.is_none_or(|(floor, base)| floor.is_clear(base, placement))
    }

    fn target(&self, arm: usize, world_from_tool: &Pose) -> Target {
        Target { world_from_tip: world_from_tool * self.arms[arm].tool_from_tip, weight: 1.0 }
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

    /// A base anywhere in the disc, if the map says yes.
    fn try_one(&self, arm: usize, target: &Target, radius: f64, rng: &mut Rng) -> Option<Placement> {
        let (distance, angle) = (radius * rng.unit().sqrt(), rng.range(-PI, PI));
        let p = target.world_from_tip.translation.vector;
        let position = [p.x + distance * libm::cos(angle), p.y + distance * libm::sin(angle)];
        let placement = Placement { position, yaw: rng.range(-PI, PI), target: 0, mount: 0 };
        let MountedArm { map, mounts, .. } = &self.arms[arm];
        let mobile_from_tip = placement.world_from_mobile().inv_mul(&target.world_from_tip);
        let reached = |mount: &Pose| map.verdict(&mount.inv_mul(&mobile_from_tip)) == Verdict::Yes;
        mounts.iter().any(reached).then_some(placement)
    }

    /// The area of the bases of a pose, obstacles apart, as far as a few of them tell; zero only when there is none.
    fn guess(&mut self, arm: usize, world_from_tool: &Pose) -> f64 {
        let target = self.target(arm, world_from_tool);
        let Some(radius) = self.radius(arm, &target) else { return 0.0 };
        let mut rng = Seed::new(0).split("bases of a pose").rng();
        let found = (0..GUESSED).filter(|_| self.try_one(arm, &target, radius, &mut rng).is_some()).count();
        if found == 0 {
            let made = self.made(arm, world_from_tool);
            if self.placements[made].placements.is_empty() {
                return 0.0;
            }
        }
        (found as f64).max(0.25) / f64::from(GUESSED) * PI * radius * radius
    }

    /// Position of the distribution of a pose, which is made unless it was before.
    fn made(&mut self, arm: usize, world_from_tool: &Pose) -> usize {
        let is_this = |made: &Made| made.arm == arm && made.world_from_tool == *world_from_tool;
        self.placements.iter().position(is_this).unwrap_or_else(|| {
            let MountedArm { map, mounts, .. } = &self.arms[arm];
            let target = self.target(arm, world_from_tool);
            let placements = Placements::new(map, &[target], mounts, Trust::Whole);
            self.placements.push(Made { arm, world_from_tool: *world_from_tool, placements, pruned: false });
            self.placements.len() - 1
        })
    }
}

impl BaseDistribution for MapBases<'_> {
    fn mass(&mut self, arm: usize, world_from_tool: &Pose) -> f64 {
        let known = self.masses.iter().find(|(number, pose, _)| *number == arm && pose == world_from_tool);
        if let Some((_, _, mass)) = known {
            return *mass;
        }
        let mass = self.guess(arm, world_from_tool);
        self.masses.push((arm, *world_from_tool, mass));
        mass
    }

    fn draw(&mut self, arm: usize, world_from_tool: &Pose, rng: &mut Rng) -> Option<[f64; 3]> {
        let target = self.target(arm, world_from_tool);
        let radius = self.radius(arm, &target)?;
        let found = (0..UNIFORM)
            .find_map(|_| {
                self.try_one(arm, &target, radius, rng).filter(|placement| self.is_clear(placement))
            })
            .or_else(|| self.draw_made(arm, world_from_tool, rng))?;
        Some([found.position[0], found.position[1], found.yaw])
    }
}

impl MapBases<'_> {
    /// A clear sample of the distribution of a pose, which is pruned when there are few.
    fn draw_made(&mut self, arm: usize, world_from_tool: &Pose, rng: &mut Rng) -> Option<Placement> {
        let made = self.made(arm, world_from_tool);
        let clear = |this: &Self, rng: &mut Rng| {
            this.placements[made].placements.sample_where(rng, TRIES, |placement| this.is_clear(placement))
        };
        let found = clear(self, rng);
        if found.is_some() || self.placements[made].pruned {
            return found;
        }
        if let (Some((floor, base)), made) = (self.around, &mut self.placements[made]) {
            made.placements.prune(|placement| floor.is_clear(base, placement));
        }
        self.placements[made].pruned = true;
        clear(self, rng)
    }
}
