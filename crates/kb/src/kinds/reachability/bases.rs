//! Inverse reachability for planners that place a base: maps as a distribution of bases.

use robotc_core::Pose;
use robotc_core::rng::Rng;
use robotc_planning::placement::{BaseDistribution, Prism};

use super::floor::Floor;
use super::map::ReachabilityMap;
use super::placement::{Placements, Target, Trust};

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

/// Bases from which maps say that arms reach, and whose footprint is clear of obstacles. Distributions are made when a pose
/// is first asked for, and kept (thesis, section 4.5: lazily).
pub struct MapBases<'a> {
    arms: Vec<MountedArm<'a>>,
    around: Option<(&'a Floor, &'a Prism)>,
    known: Vec<(usize, Pose, Placements)>,
}

impl<'a> MapBases<'a> {
    /// Bases for these arms, on a floor with obstacles or on an empty one.
    pub fn new(arms: Vec<MountedArm<'a>>, around: Option<(&'a Floor, &'a Prism)>) -> Self {
        Self { arms, around, known: Vec::new() }
    }

    fn placements(&mut self, number: usize, world_from_tool: &Pose) -> &Placements {
        let known = self.known.iter().position(|(arm, pose, _)| *arm == number && pose == world_from_tool);
        let entry = known.unwrap_or_else(|| {
            let arm = &self.arms[number];
            let target = Target { world_from_tip: world_from_tool * arm.tool_from_tip, weight: 1.0 };
            let mut placements = Placements::new(arm.map, &[target], &arm.mounts, Trust::Whole);
            if let Some((floor, base)) = self.around {
                placements.prune(|placement| floor.is_clear(base, placement));
            }
            self.known.push((number, *world_from_tool, placements));
            self.known.len() - 1
        });
        &self.known[entry].2
    }
}

impl BaseDistribution for MapBases<'_> {
    fn mass(&mut self, arm: usize, world_from_tool: &Pose) -> f64 {
        self.placements(arm, world_from_tool).mass()
    }

    fn draw(&mut self, arm: usize, world_from_tool: &Pose, rng: &mut Rng) -> Option<[f64; 3]> {
        let around = self.around;
        let placements = self.placements(arm, world_from_tool);
        // Where only some of a cell's bases are clear, another one is drawn.
        const TRIES: usize = 16;
        let clear = |placement: &_| around.is_none_or(|(floor, base)| floor.is_clear(base, placement));
        let placement = placements.sample_where(rng, TRIES, clear).or_else(|| placements.sample(rng))?;
        Some([placement.position[0], placement.position[1], placement.yaw])
    }
}
