//! A gripper that comes in on a shape and closes on it: what grasps and cages share.

#[cfg(feature = "build")]
pub(crate) mod advance;
#[cfg(feature = "build")]
pub(crate) mod hand;
#[cfg(all(test, feature = "build"))]
pub(crate) mod jaws;
#[cfg(feature = "build")]
pub(crate) mod strategy;
#[cfg(feature = "build")]
pub(crate) mod surface;

use nalgebra::{Point3, Vector3};
use robotc_core::ids::{Idx, LinkIdx};
use robotc_core::model::Origin;
use robotc_core::robot::{Gripper, Hold};

use crate::graph::{Dep, PlanError, Planner};
use crate::kinds::ConvexParts;
use crate::project::OfShape;
use crate::projection::Mechanism;
use crate::record::Parts;

/// What artefacts read of a gripper.
pub(crate) struct GripperInputs {
    /// Its links and joints.
    pub(crate) mechanism: Mechanism,
    /// With indices of `mechanism`.
    pub(crate) gripper: Gripper,
    /// `palm_from_tool` as written.
    tool: Origin,
    /// Convex parts of its links.
    #[cfg_attr(not(feature = "build"), expect(dead_code, reason = "artefacts that only generators load"))]
    parts: Vec<(LinkIdx, Dep<ConvexParts>)>,
}

impl GripperInputs {
    /// Of a gripper of the project's robot, by position.
    pub(crate) fn plan(planner: &mut Planner<'_>, gripper: usize) -> Result<Self, PlanError> {
        let robot = planner.project().robot();
        let (mechanism, reduced, links) = Mechanism::hand(&robot.model, &robot.grippers[gripper])?;
        let mut parts = Vec::new();
        for (i, &link) in links.iter().enumerate() {
            if !robot.model.links()[link].collisions.is_empty() {
                parts.push((LinkIdx::new(i), planner.need::<ConvexParts>(&OfShape::Link(link))?));
            }
        }
        let tool = *planner.project().tool(gripper);
        Ok(Self { mechanism, gripper: reduced, tool, parts })
    }

    /// Adds all of it to a key; the planner adds the artefacts.
    pub(crate) fn key_parts(&self, parts: &mut Parts) {
        let Self { mechanism, gripper, tool, parts: _ } = self;
        mechanism.key_parts(parts);
        let approach: [f64; 3] = gripper.approach_in_tool.into_inner().into();
        parts.add("tool", "", &(*tool, approach));
        let fingers: Vec<usize> = gripper.fingers.iter().map(|l| l.index()).collect();
        let dofs: Vec<usize> = gripper.dofs.iter().map(|d| d.index()).collect();
        parts.add("fingers", "", &(fingers, dofs, gripper.closing.clone()));
        // Only what attracts, or has a fixed jaw, says so: keys of other hands are as they were before there were any.
        if gripper.hold == Hold::Attract {
            parts.add("hold", "", &1u32);
        }
        let fixed: Vec<usize> =
            gripper.fixed_jaw(self.mechanism.model()).iter().map(|link| link.index()).collect();
        if !fixed.is_empty() {
            parts.add("fixed jaw", "", &fixed);
        }
        for preshape in &gripper.preshapes {
            parts.add("preshape", &preshape.name, &preshape.values);
        }
    }

    /// The length of its longest bone, that to the tool included: a measure of its size, metres.
    pub(crate) fn size(&self) -> f64 {
        let bones = self.mechanism.model().joints().iter().map(|j| Vector3::from(j.origin.xyz).norm());
        bones.fold(0.0, f64::max).max(self.gripper.palm_from_tool.translation.vector.norm())
    }
}

/// Length of the diagonal of the box around the points.
pub(crate) fn diagonal(points: &[Point3<f64>]) -> f64 {
    robotc_core::geom::Aabb::of_points(points).map_or(0.0, |bounds| bounds.diagonal())
}

#[cfg(feature = "build")]
mod build {
    use std::sync::Arc;

    use robotc_core::geom;
    use robotc_core::model::Kinematics;

    use super::hand::Hand;
    use super::*;
    use crate::kind::{BuildError, Context};

    /// The loaded parts of a gripper's links.
    pub(crate) struct GripperShapes {
        kinematics: Kinematics,
        parts: Vec<(LinkIdx, Arc<geom::ConvexParts>)>,
    }

    impl GripperInputs {
        /// Loads the parts of its links.
        pub(crate) fn load(&self, context: &Context<'_>) -> Result<GripperShapes, BuildError> {
            let parts = self.parts.iter().map(|(link, dep)| Ok((*link, context.load(dep)?)));
            let parts = parts.collect::<Result<_, BuildError>>()?;
            Ok(GripperShapes { kinematics: Kinematics::new(self.mechanism.model().clone()), parts })
        }

        /// The gripper with its shapes.
        pub(crate) fn hand<'a>(&'a self, shapes: &'a GripperShapes) -> Hand<'a> {
            let parts_of = |link: LinkIdx| {
                shapes.parts.iter().find(|(known, _)| *known == link).map(|(_, parts)| &**parts)
            };
            Hand::new(&shapes.kinematics, &self.gripper, parts_of)
        }
    }
}
