//! Which tip poses an arm reaches.

mod map;
#[cfg(feature = "build")]
mod search;

use map::Grid;
pub use map::ReachabilityMap;

use robotc_core::ids::{Idx, LinkIdx};
use robotc_core::model::{ChainMotion, SerialChain};
use robotc_core::{Kinematics, Pose};
use serde::{Deserialize, Serialize};

use crate::codec;
use crate::graph::{Dep, PlanError, Planner};
use crate::kind::{DecodeError, Kind, Portability};
use crate::kinds::{ConvexParts, IkSolver, SelfCollisionPairs};
use crate::parameters::round_step;
use crate::project::{OfArm, OfRobot, OfShape, Project};
use crate::projection::{Limits, Mechanism};
use crate::record::Parts;

/// The kind; its artefact is a [`ReachabilityMap`].
///
/// Exact inverse kinematics at the centre of every cell, within joint limits and free of self-collision (thesis section
/// 4.3). Arms whose first joint slides have none.
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
    }
}

/// What a map is computed from.
#[cfg_attr(not(feature = "build"), expect(dead_code, reason = "artefacts that only generators load"))]
pub struct Inputs {
    mechanism: Mechanism,
    base: LinkIdx,
    tip: LinkIdx,
    solver: Dep<IkSolver>,
    pairs: Dep<SelfCollisionPairs>,
    bodies: Vec<(LinkIdx, Dep<ConvexParts>)>,
}

impl Inputs {
    fn chain(&self) -> SerialChain {
        let kinematics = Kinematics::new(self.mechanism.model().clone());
        SerialChain::between(&kinematics, self.base, self.tip).expect("the solver was planned for this chain")
    }
}

impl Kind for Reachability {
    const NAME: &'static str = "reachability";
    const FORMAT: u32 = 1;
    const ALGORITHM: u32 = 1;
    const PORTABILITY: Portability = Portability::Portable;
    const IN_PIECES: bool = true;
    const DOC: &'static str = "Which poses of its tip an arm reaches, seen from its first axis. Grasps are ranked by it before anything is solved.";

    type Subject = OfArm;
    type Inputs = Inputs;
    type Parameters = ReachabilityParameters;
    type Artefact = ReachabilityMap;

    fn subjects(project: &Project) -> Vec<OfArm> {
        let robot = project.robot();
        let turns_first = |arm: &OfArm| {
            let arm = &robot.arms[arm.0];
            let kinematics = Kinematics::new(robot.model.clone());
            SerialChain::between(&kinematics, arm.base, arm.tip)
                .is_ok_and(|chain| chain.joints[0].motion == ChainMotion::Revolute)
        };
        <OfArm as crate::project::Subject>::all(project).into_iter().filter(turns_first).collect()
    }

    fn inputs(planner: &mut Planner<'_>, subject: &OfArm) -> Result<Inputs, PlanError> {
        let robot = planner.project().robot();
        let arm = &robot.arms[subject.0];
        let solver = planner.need::<IkSolver>(subject)?;
        let pairs = planner.need::<SelfCollisionPairs>(&OfRobot)?;
        let mut bodies = Vec::new();
        for shape in <OfShape as crate::project::Subject>::all(planner.project()) {
            if let OfShape::Link(link) = shape {
                bodies.push((link, planner.need::<ConvexParts>(&shape)?));
            }
        }
        let mechanism = Mechanism::whole(&robot.model, Limits::Kept);
        Ok(Inputs { mechanism, base: arm.base, tip: arm.tip, solver, pairs, bodies })
    }

    fn key_parts(inputs: &Inputs, parts: &mut Parts) {
        let Inputs { mechanism, base, tip, solver: _, pairs: _, bodies } = inputs;
        mechanism.key_parts(parts);
        parts.add("chain", "", &(base.index(), tip.index()));
        let bodies: Vec<usize> = bodies.iter().map(|(link, _)| link.index()).collect();
        parts.add("links with shapes", "", &bodies);
    }

    fn defaults(inputs: &Inputs) -> ReachabilityParameters {
        let step = round_step(map::reach(&inputs.chain()) / 15.0);
        ReachabilityParameters { step, ..ReachabilityParameters::constants() }
    }

    fn encode(map: &ReachabilityMap) -> Vec<u8> {
        let pose = map.grid.base_from_axis;
        codec::encode(&Stored {
            position: pose.translation.vector.into(),
            rotation: pose.rotation.coords.into(),
            step: map.grid.step,
            radial: map.grid.radial as u32,
            vertical: map.grid.vertical as u32,
            lowest: map.grid.lowest,
            level: map.grid.level,
            tries: map.tries,
            counts: map.counts.clone(),
            witnesses: map.witnesses.clone(),
            variables: map.variables as u32,
            first_limits: [map.first_limits.0, map.first_limits.1],
        })
    }

    fn decode(bytes: &[u8]) -> Result<ReachabilityMap, DecodeError> {
        let s: Stored = codec::decode(bytes)?;
        let numbers = s.position.iter().chain(&s.rotation).chain([&s.step, &s.lowest]);
        if !numbers.clone().all(|x| x.is_finite())
            || s.step <= 0.0
            || s.first_limits.iter().any(|x| x.is_nan())
            || s.witnesses.iter().any(|x| !x.is_finite())
        {
            return Err(DecodeError::new("a number is not finite"));
        }
        if s.level > 6 || s.radial > 1 << 16 || s.vertical > 1 << 16 {
            return Err(DecodeError::new("the grid is too large"));
        }
        let rotation = nalgebra::UnitQuaternion::new_unchecked(nalgebra::Quaternion::from(s.rotation));
        if (rotation.norm() - 1.0).abs() > 1e-9 {
            return Err(DecodeError::new("a rotation is not of unit length"));
        }
        let grid = Grid {
            base_from_axis: Pose::from_parts(nalgebra::Translation3::from(s.position), rotation),
            step: s.step,
            radial: s.radial as usize,
            vertical: s.vertical as usize,
            lowest: s.lowest,
            level: s.level,
        };
        let limits = (s.first_limits[0], s.first_limits[1]);
        ReachabilityMap::new(grid, s.tries, s.counts, s.witnesses, s.variables as usize, limits)
            .ok_or_else(|| DecodeError::new("tables do not fit together"))
    }

    fn summary(map: &ReachabilityMap) -> String {
        let (reached, all) = (map.reached(), map.grid.len());
        format!("{reached} of {all} cells of {:.0} mm reached", map.grid.step * 1e3)
    }
}

#[derive(Serialize, Deserialize)]
struct Stored {
    position: [f64; 3],
    rotation: [f64; 4],
    step: f64,
    radial: u32,
    vertical: u32,
    lowest: f64,
    level: u32,
    tries: u8,
    counts: Vec<u8>,
    witnesses: Vec<f32>,
    variables: u32,
    first_limits: [f64; 2],
}

#[cfg(feature = "build")]
mod build {
    use std::sync::Arc;

    use robotc_core::geom::{ConvexParts as Parts3, any_within};
    use robotc_core::{Configuration, LinkPoses, TypedVec};
    use robotc_ikgen::Solver;

    use super::search::{Search, SearchOptions, witness_is_true};
    use super::*;
    use crate::kind::{Build, BuildError, Context};

    /// Witnesses looked at again by the check, evenly over all.
    const CHECKED: usize = 2000;

    impl Build for Reachability {
        fn build(
            inputs: &Inputs,
            parameters: &ReachabilityParameters,
            context: &Context<'_>,
        ) -> Result<ReachabilityMap, BuildError> {
            let chain = inputs.chain();
            let program = context.load(&inputs.solver)?;
            let solver = Solver::new((*program).clone(), &chain)
                .map_err(|error| BuildError::Impossible(error.to_string()))?;
            let grid = Grid::of(&chain, parameters.step, parameters.level)
                .ok_or_else(|| BuildError::Impossible("the first joint of the arm does not turn".into()))?;
            let model = inputs.mechanism.model();
            let kinematics = Kinematics::new(model.clone());
            let mut links: TypedVec<LinkIdx, Arc<Parts3>> =
                model.links().iter().map(|_| Default::default()).collect();
            for (link, dep) in &inputs.bodies {
                links[*link] = context.load(dep)?;
            }
            let pairs: Vec<_> = context.load(&inputs.pairs)?.tested().collect();
            let dofs: Vec<_> = chain.variables.iter().map(|v| v.dof).collect();
            let neutral = Configuration::neutral(model);
            let collides = |joints: &[f64]| {
                let mut q = neutral.clone();
                q.set(&dofs, joints);
                let mut poses = LinkPoses::default();
                kinematics.link_poses(&q, &mut poses);
                let touch = |&(a, b): &(LinkIdx, LinkIdx)| {
                    any_within(&links[a], poses.root_from(a), &links[b], poses.root_from(b), 0.0)
                };
                pairs.iter().any(touch)
            };
            let options = SearchOptions { free_samples: parameters.free_samples as usize };
            let rows: Vec<usize> = (0..grid.radial).collect();
            let search = Search::new(&chain, &solver, grid, &options, collides);
            let filled = context.map_in_pieces("rows", &rows, |_, &r| search.row(r))?;
            Ok(search.assemble(filled))
        }

        fn check(
            map: &ReachabilityMap,
            inputs: &Inputs,
            _parameters: &ReachabilityParameters,
            _context: &Context<'_>,
        ) -> Result<(), BuildError> {
            let chain = inputs.chain();
            let reached: Vec<usize> = (0..map.counts.len()).filter(|&cell| map.counts[cell] > 0).collect();
            let stride = (reached.len() / CHECKED).max(1);
            match reached.iter().step_by(stride).find(|&&cell| !witness_is_true(&chain, map, cell)) {
                Some(cell) => Err(BuildError::Check(format!("the witness of cell {cell} does not reach it"))),
                None => Ok(()),
            }
        }
    }
}
