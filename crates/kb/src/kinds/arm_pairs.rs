//! Which links an arm alone can bring together.

use robotc_core::LinkIdx;
use robotc_core::ids::Idx;

use super::SelfCollisionPairs;
use crate::codec;
use crate::graph::{Dep, PlanError, Planner};
use crate::kind::{DecodeError, Kind, Portability};
use crate::parameters::NoParameters;
use crate::project::{OfArm, OfRobot};
use crate::projection::{Limits, Mechanism};
use crate::record::Parts;

/// The kind; its artefact is a list of [`LinkPairs`].
///
/// The pairs of [`SelfCollisionPairs`] that have to be tested and whose links both belong to the arm in the sense of
/// [`Mechanism::arm`]. It takes no time, and stops changes: a finger that is edited computes the table of the whole robot
/// again, but what is known of the arm alone comes out as it was, and nothing that reads it is computed again.
pub struct ArmPairs;

/// Pairs of links by position in [`Mechanism::arm`]; lower first, ascending.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct LinkPairs(pub Vec<(LinkIdx, LinkIdx)>);

/// The links of an arm, and the pairs of the robot.
#[cfg_attr(not(feature = "build"), expect(dead_code, reason = "artefacts that only generators load"))]
pub struct Inputs {
    links: Vec<LinkIdx>,
    pairs: Dep<SelfCollisionPairs>,
}

impl Kind for ArmPairs {
    const NAME: &'static str = "arm_pairs";
    const FORMAT: u32 = 1;
    const ALGORITHM: u32 = 1;
    const PORTABILITY: Portability = Portability::Portable;
    const DOC: &'static str = "The pairs of links that an arm alone can bring together. It keeps edits of hands away from the reachability map.";

    type Subject = OfArm;
    type Inputs = Inputs;
    type Parameters = NoParameters;
    type Artefact = LinkPairs;

    fn inputs(planner: &mut Planner<'_>, subject: &OfArm) -> Result<Inputs, PlanError> {
        let robot = planner.project().robot();
        let arm = &robot.arms[subject.0];
        let (_, _, links) = Mechanism::arm(&robot.model, arm.base, arm.tip, Limits::Dropped)?;
        Ok(Inputs { links, pairs: planner.need::<SelfCollisionPairs>(&OfRobot)? })
    }

    fn key_parts(inputs: &Inputs, parts: &mut Parts) {
        let Inputs { links, pairs: _ } = inputs;
        let links: Vec<usize> = links.iter().map(|link| link.index()).collect();
        parts.add("links of the arm", "", &links);
    }

    fn defaults(_inputs: &Inputs) -> NoParameters {
        NoParameters
    }

    fn encode(artefact: &LinkPairs) -> Vec<u8> {
        let row = |&(a, b): &(LinkIdx, LinkIdx)| (a.index() as u32, b.index() as u32);
        codec::encode(&artefact.0.iter().map(row).collect::<Vec<_>>())
    }

    fn decode(bytes: &[u8]) -> Result<LinkPairs, DecodeError> {
        let rows: Vec<(u32, u32)> = codec::decode(bytes)?;
        if rows.iter().any(|(a, b)| a >= b) || rows.windows(2).any(|w| w[0] >= w[1]) {
            return Err(DecodeError::new("pairs are not in order"));
        }
        let link = |i: u32| LinkIdx::new(i as usize);
        Ok(LinkPairs(rows.into_iter().map(|(a, b)| (link(a), link(b))).collect()))
    }

    fn summary(artefact: &LinkPairs) -> String {
        format!("{} pairs of links can touch", artefact.0.len())
    }
}

#[cfg(feature = "build")]
mod build {
    use super::*;
    use crate::kind::{Build, BuildError, Context};

    impl Build for ArmPairs {
        fn build(
            inputs: &Inputs,
            _parameters: &NoParameters,
            context: &Context<'_>,
        ) -> Result<LinkPairs, BuildError> {
            let place = |link| inputs.links.iter().position(|&l| l == link).map(LinkIdx::new);
            let table = context.load(&inputs.pairs)?;
            let mut pairs: Vec<_> =
                table.tested().filter_map(|(a, b)| Some((place(a)?, place(b)?))).collect();
            pairs.sort();
            Ok(LinkPairs(pairs))
        }

        /// Every pair is one of the robot's, and none is missing.
        fn check(
            artefact: &LinkPairs,
            inputs: &Inputs,
            _parameters: &NoParameters,
            context: &Context<'_>,
        ) -> Result<(), BuildError> {
            let table = context.load(&inputs.pairs)?;
            let ours = |link: LinkIdx| inputs.links.contains(&link);
            let expected: Vec<_> = table.tested().filter(|&(a, b)| ours(a) && ours(b)).collect();
            let of_robot = |link: LinkIdx| inputs.links.get(link.index()).copied();
            let found: Option<Vec<_>> =
                artefact.0.iter().map(|&(a, b)| Some((of_robot(a)?, of_robot(b)?))).collect();
            if found.is_some_and(|found| found == expected) {
                Ok(())
            } else {
                Err(BuildError::Check("the pairs are not those of the robot".into()))
            }
        }
    }
}
