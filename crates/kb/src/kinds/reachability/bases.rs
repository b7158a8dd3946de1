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
/// A base is drawn uniformly from the disc that holds them all, until one is clear and the map says yes: questions to the map are
/// so fast that this is over before a distribution is made. Only for poses of which this finds little a distribution is made, and
/// kept (thesis, section 4.5).
pub struct MapBases<'a> {
    arms: Vec<MountedArm<'a>>,
    around: Option<(&'a Floor, &'a Prism)>,
    masses: Vec<(usize, Pose, f64)>,
    placements: Vec<(usize, Pose, Placements)>,
}

/// Bases from which the mass of a pose is guessed.
const GUESSED: u32 = 24;

/// Bases until one is clear and reaches.
const TRIES: usize = 300;

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

    /// A base anywhere in the disc, if it is clear and the map says yes.
    fn try_one(&self, arm: usize, target: &Target, radius: f64, rng: &mut Rng) -> Option<Placement> {
        let (distance, angle) = (radius * rng.unit().sqrt(), rng.range(-PI, PI));
        let p = target.world_from_tip.translation.vector;
        let position = [p.x + distance * libm::cos(angle), p.y + distance * libm::sin(angle)];
        let placement = Placement { position, yaw: rng.range(-PI, PI), target: 0, mount: 0 };
        if !self.is_clear(&placement) {
            return None;
        }
        let MountedArm { map, mounts, .. } = &self.arms[arm];
        let mobile_from_tip = placement.world_from_mobile().inv_mul(&target.world_from_tip);
        let reached = |mount: &Pose| map.verdict(&mount.inv_mul(&mobile_from_tip)) == Verdict::Yes;
        mounts.iter().any(reached).then_some(placement)
    }

    /// The area of the bases of a pose, as far as a few of them tell; zero only when there is none.
    fn guess(&self, arm: usize, world_from_tool: &Pose) -> f64 {
        let target = self.target(arm, world_from_tool);
        let Some(radius) = self.radius(arm, &target) else { return 0.0 };
        let mut rng = Seed::new(0).split("bases of a pose").rng();
        let found = (0..GUESSED).filter(|_| self.try_one(arm, &target, radius, &mut rng).is_some()).count();
        let MountedArm { map, mounts, .. } = &self.arms[arm];
        if found == 0 && Placements::new(map, &[target], mounts, Trust::Whole).is_empty() {
            return 0.0;
        }
        (found as f64).max(0.25) / f64::from(GUESSED) * PI * radius * radius
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
        let found = (0..TRIES).find_map(|_| self.try_one(arm, &target, radius, rng)).or_else(|| {
            let is_this =
                |(number, pose, _): &(usize, Pose, Placements)| *number == arm && pose == world_from_tool;
            let entry = self.placements.iter().position(is_this).unwrap_or_else(|| {
                let MountedArm { map, mounts, .. } = &self.arms[arm];
                let mut placements = Placements::new(map, &[target], mounts, Trust::Whole);
                if let Some((floor, base)) = self.around {
                    placements.prune(|placement| floor.is_clear(base, placement));
                }
                self.placements.push((arm, *world_from_tool, placements));
                self.placements.len() - 1
            });
            self.placements[entry].2.sample_where(rng, TRIES, |placement| self.is_clear(placement))
        })?;
        Some([found.position[0], found.position[1], found.yaw])
    }
}
