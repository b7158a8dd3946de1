//! Balls that cover a link or an object, in a tree: what vectorised collision checks compute with.

use nalgebra::Point3;
use robotc_core::geom::{SphereCover as Cover, SphereNode};

use super::ConvexParts;
use crate::codec;
use crate::graph::{Dep, PlanError, Planner};
use crate::kind::{DecodeError, Kind, Portability};
use crate::project::{OfShape, Project, Subject};
use crate::record::Parts;

/// The kind; its artefact is a [`SphereCover`](robotc_core::geom::SphereCover) in the frame of the link or object.
///
/// The balls together contain its convex parts, and each knows how large a ball about the same point is inside
/// of them: what touches no ball is free, what touches an inner one is not, and only the rest is looked at more closely.
pub struct SphereCover;

crate::parameters! {
    /// Parameters of [`SphereCover`].
    pub struct CoverParameters {
        /// How far a ball may stand out of the part that it covers, as a fraction of the radius of a ball around that.
        overshoot: f64 [""] in 0.005..=1.0 = auto "0.06 for links, 0.5 for objects";
        /// It may stand out this far in any case: small parts then take few balls.
        least: f64 ["m"] in 0.0001..=1.0 = auto "0.003 for links, 0.01 for objects";
    }
}

/// The convex parts of a link or an object.
pub struct Inputs {
    #[cfg_attr(not(feature = "build"), expect(dead_code, reason = "artefacts that only generators load"))]
    parts: Dep<ConvexParts>,
    /// Of what is carried, which gets few balls.
    carried: bool,
}

/// Centre, outer and inner radius, and the position of the first node that is not below.
type StoredNode = ([f64; 5], u32);

impl Kind for SphereCover {
    const NAME: &'static str = "sphere_cover";
    const FORMAT: u32 = 1;
    const ALGORITHM: u32 = 1;
    const PORTABILITY: Portability = Portability::Portable;
    const DOC: &'static str = "A tree of balls that covers a link or an object that can be held. Vectorised collision checks look at it before \
        anything else.";

    type Subject = OfShape;
    type Inputs = Inputs;
    type Parameters = CoverParameters;
    type Artefact = Cover;

    fn subjects(project: &Project) -> Vec<OfShape> {
        // What stands around is compared by its convex parts.
        OfShape::all(project).into_iter().filter(|shape| !matches!(shape, OfShape::Obstacle(_))).collect()
    }

    fn inputs(planner: &mut Planner<'_>, subject: &OfShape) -> Result<Inputs, PlanError> {
        let carried = matches!(subject, OfShape::Object(_));
        Ok(Inputs { parts: planner.need::<ConvexParts>(subject)?, carried })
    }

    fn key_parts(inputs: &Inputs, _parts: &mut Parts) {
        // Artefacts are added by the planner; who is carried matters for the defaults alone.
        let Inputs { parts: _, carried: _ } = inputs;
    }

    fn defaults(inputs: &Inputs) -> CoverParameters {
        match inputs.carried {
            false => CoverParameters { overshoot: 0.06, least: 0.003 },
            true => CoverParameters { overshoot: 0.5, least: 0.01 },
        }
    }

    fn encode(artefact: &Cover) -> Vec<u8> {
        let stored = |node: &SphereNode| -> StoredNode {
            let c = node.centre;
            ([c.x, c.y, c.z, node.outer, node.inner], node.next)
        };
        codec::encode(&artefact.nodes().iter().map(stored).collect::<Vec<_>>())
    }

    fn decode(bytes: &[u8]) -> Result<Cover, DecodeError> {
        let stored: Vec<StoredNode> = codec::decode(bytes)?;
        let node = |([x, y, z, outer, inner], next): StoredNode| SphereNode {
            centre: Point3::new(x, y, z),
            outer,
            inner,
            next,
        };
        Cover::from_nodes(stored.into_iter().map(node).collect())
            .ok_or_else(|| DecodeError::new("the balls form no tree"))
    }

    fn summary(artefact: &Cover) -> String {
        let (balls, most) = (artefact.leaves().count(), 1e3 * artefact.overshoot());
        format!("{balls} balls that stand out by {most:.1} mm at most")
    }
}

#[cfg(feature = "build")]
mod build {
    use robotc_core::geom::CoverOptions;

    use super::*;
    use crate::kind::{Build, BuildError, Context};

    /// Random points of each part that have to be covered.
    const SAMPLES: u64 = 400;

    impl Build for SphereCover {
        fn build(
            inputs: &Inputs,
            parameters: &CoverParameters,
            context: &Context<'_>,
        ) -> Result<Cover, BuildError> {
            let options = CoverOptions { overshoot: parameters.overshoot, least: parameters.least };
            Ok(Cover::of(&*context.load(&inputs.parts)?, &options))
        }

        /// Corners and random points of the parts are covered, and inner balls are inside of a part.
        fn check(
            artefact: &Cover,
            inputs: &Inputs,
            _parameters: &CoverParameters,
            context: &Context<'_>,
        ) -> Result<(), BuildError> {
            let parts = context.load(&inputs.parts)?;
            let slack = 1e-9 * (1.0 + parts.bounds().map_or(0.0, |bounds| bounds.diagonal()));
            let covered = |p: &Point3<f64>| {
                artefact.leaves().any(|ball| (p - ball.centre).norm() <= ball.outer + slack)
            };
            for (i, part) in parts.iter().enumerate() {
                let corners = part.points();
                let mut rng = context.seed().split("points").at(i as u64).rng();
                let mixture = |_| {
                    // Of up to four corners, so that many lie on faces and edges.
                    let chosen =
                        (0..=rng.below(4)).map(|_| (corners[rng.below(corners.len())], rng.unit() + 1e-9));
                    let chosen: Vec<_> = chosen.collect();
                    let total: f64 = chosen.iter().map(|(_, weight)| weight).sum();
                    let sum =
                        chosen.iter().map(|(p, weight)| p.coords * *weight).sum::<nalgebra::Vector3<f64>>();
                    Point3::from(sum / total)
                };
                let samples: Vec<Point3<f64>> = (0..SAMPLES).map(mixture).collect();
                if let Some(bare) = corners.iter().chain(&samples).find(|p| !covered(p)) {
                    return Err(BuildError::Check(format!("{bare} of part {i} is not covered")));
                }
            }
            let deep =
                |ball: &SphereNode| ball.inner == 0.0 || parts.height(&ball.centre) <= slack - ball.inner;
            if !artefact.leaves().all(deep) {
                return Err(BuildError::Check("an inner ball stands out".into()));
            }
            Ok(())
        }
    }
}
