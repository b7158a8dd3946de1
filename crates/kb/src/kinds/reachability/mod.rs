//! Which tip poses an arm reaches.

mod arm;
mod azimuth;
mod bases;
mod density;
#[cfg(feature = "build")]
mod fill;
mod floor;
mod freedom;
mod grid;
mod map;
mod pack;
mod placement;
#[cfg(feature = "build")]
mod probes;
#[cfg(feature = "build")]
mod sweep;
#[cfg(feature = "build")]
mod turning;

pub use arm::{ArmAlone, Scratch};
pub use azimuth::{SECTORS, Sectors};
pub use bases::{MapBases, MountedArm};
pub use density::KernelDensity;
pub use floor::Floor;
pub use freedom::FreeValues;
pub use grid::{Grid, Seen};
pub use map::{Cell, FULL, ReachabilityMap, Verdict};
pub use placement::{Placement, Placements, Target, Trust, verdicts};

use robotc_core::Kinematics;
use robotc_core::ids::{Idx, LinkIdx};
use robotc_core::model::SerialChain;

use crate::graph::{Dep, PlanError, Planner};
use crate::kind::{DecodeError, Kind, Portability};
use crate::kinds::{ArmPairs, ChainReach, ConvexParts, IkSolver, chain_reach};
use crate::parameters::round_step;
use crate::project::{OfArm, OfShape};
use crate::projection::{Limits, Mechanism};
use crate::record::Parts;

/// The kind; its artefact is a [`ReachabilityMap`].
///
/// Cells of tip poses are reached as a whole, not at all, or in part (thesis, section 4.3, where one number is kept for each
/// cell). What a cell is called rests on samples, not on a proof: on exact inverse kinematics at `probes` poses of it, and
/// on `configurations` random configurations of the arm. If a share s of a cell is not reached, it is called reached as a
/// whole with probability (1 - s)^probes.
///
/// Only the arm is read, in the sense of [`Mechanism::arm`]: its chain with limits, and the shapes of what is rigid with a
/// link of it, hence also the palm of a hand, but no fingers, whose posture the map cannot know.
pub struct Reachability;

crate::parameters! {
    /// Parameters of [`Reachability`].
    pub struct ReachabilityParameters {
        /// Edge of a cell.
        step: f64 ["m"] in 0.001..=10.0 = auto "at most a fifteenth of the arm's reach";
        /// Fineness of rotations: 72 x 8^level of them.
        level: u32 [""] in 0..=3 = 0;
        /// Values tried for each free joint of a redundant arm.
        free_samples: u32 [""] in 1..=64 = 8;
        /// Poses of a cell that have to be reached before all of it counts as reached.
        probes: u32 [""] in 1..=64 = 8;
        /// Random configurations that find what probes miss.
        configurations: u32 [""] in 0..=100000000 = 200000;
    }
}

/// What a map is computed from.
#[cfg_attr(not(feature = "build"), expect(dead_code, reason = "artefacts that only generators load"))]
pub struct Inputs {
    mechanism: Mechanism,
    /// Base and tip of the chain.
    ends: [LinkIdx; 2],
    sphere: Dep<ChainReach>,
    solver: Dep<IkSolver>,
    pairs: Dep<ArmPairs>,
    bodies: Vec<(LinkIdx, Dep<ConvexParts>)>,
}

impl Inputs {
    fn chain(&self) -> SerialChain {
        let kinematics = Kinematics::new(self.mechanism.model().clone());
        let [base, tip] = self.ends;
        SerialChain::between(&kinematics, base, tip).expect("the solver was planned for this chain")
    }
}

impl Kind for Reachability {
    const NAME: &'static str = "reachability";
    const FORMAT: u32 = 3;
    const ALGORITHM: u32 = 3;
    const PORTABILITY: Portability = Portability::Portable;
    const IN_PIECES: bool = true;
    const DOC: &'static str = "Which poses of its tip an arm reaches, seen from its first axis. Grasps are ranked by it before anything is solved.";

    type Subject = OfArm;
    type Inputs = Inputs;
    type Parameters = ReachabilityParameters;
    type Artefact = ReachabilityMap;

    fn inputs(planner: &mut Planner<'_>, subject: &OfArm) -> Result<Inputs, PlanError> {
        let robot = planner.project().robot();
        let arm = &robot.arms[subject.0];
        let (mechanism, ends, links) = Mechanism::arm(&robot.model, arm.base, arm.tip, Limits::Kept)?;
        let sphere = planner.need::<ChainReach>(subject)?;
        let solver = planner.need::<IkSolver>(subject)?;
        let pairs = planner.need::<ArmPairs>(subject)?;
        let mut bodies = Vec::new();
        for (i, &link) in links.iter().enumerate() {
            if !robot.model.links()[link].collisions.is_empty() {
                bodies.push((LinkIdx::new(i), planner.need::<ConvexParts>(&OfShape::Link(link))?));
            }
        }
        Ok(Inputs { mechanism, ends, sphere, solver, pairs, bodies })
    }

    fn key_parts(inputs: &Inputs, parts: &mut Parts) {
        let Inputs { mechanism, ends, sphere: _, solver: _, pairs: _, bodies } = inputs;
        mechanism.key_parts(parts);
        parts.add("chain", "", &(ends[0].index(), ends[1].index()));
        let bodies: Vec<usize> = bodies.iter().map(|(link, _)| link.index()).collect();
        parts.add("links with shapes", "", &bodies);
    }

    fn defaults(inputs: &Inputs) -> ReachabilityParameters {
        // Without limits of its slides an arm has no map; the step is then of no matter.
        let radius = chain_reach::sphere(&inputs.chain()).map_or(1.0, |sphere| sphere.radius);
        ReachabilityParameters { step: round_step(radius / 15.0), ..ReachabilityParameters::constants() }
    }

    fn encode(map: &ReachabilityMap) -> Vec<u8> {
        pack::encode(map)
    }

    fn decode(bytes: &[u8]) -> Result<ReachabilityMap, DecodeError> {
        pack::decode(bytes)
    }

    fn summary(map: &ReachabilityMap) -> String {
        let [some, yes, varies] = map.counts();
        let share = |count: usize| 100.0 * count as f64 / map.grid.len() as f64;
        format!(
            "{} cells of {:.0} mm: {:.1} % reached as a whole, {:.1} % in part, of these {:.1} % by azimuth",
            map.grid.len(),
            map.grid.step * 1e3,
            share(yes),
            share(some - yes),
            share(varies),
        )
    }
}

#[cfg(feature = "build")]
mod build {
    use std::sync::Arc;

    use robotc_core::TypedVec;
    use robotc_core::geom::ConvexParts as Parts3;

    use super::fill::{Effort, fill};
    use super::*;
    use crate::kind::{Build, BuildError, Context};

    /// Cells looked at again by the check, evenly over all.
    const CHECKED: usize = 2000;

    fn arm(inputs: &Inputs, context: &Context<'_>) -> Result<ArmAlone, BuildError> {
        let model = inputs.mechanism.model();
        let mut links: TypedVec<LinkIdx, Arc<Parts3>> =
            model.links().iter().map(|_| Default::default()).collect();
        for (link, dep) in &inputs.bodies {
            links[*link] = context.load(dep)?;
        }
        let (program, pairs) = (context.load(&inputs.solver)?, context.load(&inputs.pairs)?);
        ArmAlone::new(&inputs.mechanism, inputs.ends, &program, links, &pairs).map_err(BuildError::Impossible)
    }

    impl Build for Reachability {
        fn build(
            inputs: &Inputs,
            parameters: &ReachabilityParameters,
            context: &Context<'_>,
        ) -> Result<ReachabilityMap, BuildError> {
            let arm = arm(inputs, context)?;
            let sphere = context.load(&inputs.sphere)?;
            let grid = Grid::of(arm.chain(), &sphere, parameters.step, parameters.level);
            let effort = Effort {
                free_samples: parameters.free_samples as usize,
                probes: parameters.probes as usize,
                configurations: parameters.configurations as usize,
            };
            fill(&arm, &sphere, grid, &effort, context)
        }

        /// Cells that are reached as a whole, asked again at their centre and an azimuth in the middle of a sector, by
        /// joint vectors whose forward kinematics gets there.
        fn check(
            map: &ReachabilityMap,
            inputs: &Inputs,
            parameters: &ReachabilityParameters,
            context: &Context<'_>,
        ) -> Result<(), BuildError> {
            let arm = arm(inputs, context)?;
            let mut scratch = Scratch::default();
            let samples = parameters.free_samples as usize;
            let cells: Vec<usize> = (0..map.grid.len()).filter(|&c| !map.cell(c).whole.is_empty()).collect();
            for (i, &cell) in cells.iter().step_by((cells.len() / CHECKED).max(1)).enumerate() {
                let sectors: Vec<_> = map.cell(cell).whole.centres().collect();
                let (_, azimuth) = sectors[i % sectors.len()];
                let pose = map.grid.turned(&map.grid.centre(cell), azimuth);
                let ranges = arm.ranges_about(map.grid.symmetric.then_some(azimuth));
                let free = FreeValues::evenly(&ranges, samples);
                let reached = arm.reach_with(&pose, &free, &mut scratch).is_some_and(|joints| {
                    let off = pose.inv_mul(&arm.chain().forward(&joints));
                    off.translation.vector.norm() < 1e-6 && off.rotation.angle() < 1e-6
                });
                if !reached {
                    let place = format!("the centre of cell {cell} at azimuth {azimuth}");
                    return Err(BuildError::Check(format!("{place} is not reached, but the map says so")));
                }
            }
            Ok(())
        }
    }
}
