//! What is known beforehand about how well an arm reaches a pose: grasps are tried in its order.

use robotc_core::Pose;

use crate::arm::ArmModel;
use crate::grasp::GraspSet;

/// A model of an arm's reach, such as a precomputed map. It ranks and never rejects, so it may be coarse.
pub trait Reachability {
    /// How well the tip of the arm reaches a pose in the frame of its base: 0 (not at all, as far as is known) to 1.
    fn density(&self, base_from_tip: &Pose) -> f64;
}

/// Weight of a grasp with density zero: a coarse map may be wrong about it, so it is tried last and not left out.
const UNREACHED: f64 = 0.05;

/// Positions in `set`, in the order in which the grasps are worth trying with the object at `world_from_object`: by
/// falling product of score and reachability (thesis section 3.1). Equal ones keep their order.
pub(crate) fn ranking(
    set: &GraspSet,
    reachability: Option<&dyn Reachability>,
    arm: &ArmModel,
    world_from_object: &Pose,
) -> Vec<usize> {
    let mut order: Vec<usize> = (0..set.grasps.len()).collect();
    if let Some(map) = reachability {
        let (base_from_object, tool_from_tip) =
            (arm.base_from_world() * world_from_object, arm.tool_from_tip());
        let weight = |index: &usize| {
            let grasp = &set.grasps[*index];
            let density = map.density(&(base_from_object * grasp.object_from_tool * tool_from_tip));
            grasp.score * (UNREACHED + (1.0 - UNREACHED) * density)
        };
        let weights: Vec<f64> = order.iter().map(weight).collect();
        order.sort_by(|&a, &b| weights[b].total_cmp(&weights[a]));
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grasp::Grasp;
    use crate::testbed;
    use nalgebra::Vector3;

    /// Reaches what is in front of the base.
    struct Front;

    impl Reachability for Front {
        fn density(&self, base_from_tip: &Pose) -> f64 {
            f64::from(base_from_tip.translation.x > 0.0)
        }
    }

    #[test]
    fn grasps_that_are_reached_come_first() {
        let grasp = |x: f64, score| Grasp {
            preshape: 0,
            object_from_tool: Pose::translation(x, 0.0, 0.0),
            approach_in_object: Vector3::x_axis(),
            standoff: 0.0,
            closed: vec![],
            contacts: vec![],
            epsilon: 0.1,
            volume: None,
            steadiness: None,
            score,
        };
        let set = GraspSet::new("hand", "box", vec![grasp(-0.5, 0.9), grasp(0.5, 0.5), grasp(0.6, 0.8)]);
        let arm = testbed::arm(false);
        let order =
            |map: Option<&dyn Reachability>, x| ranking(&set, map, &arm, &Pose::translation(x, 0.0, 0.0));
        assert_eq!(order(None, 0.0), [0, 1, 2], "by score");
        assert_eq!(order(Some(&Front), 0.0), [1, 2, 0]);
        assert_eq!(order(Some(&Front), 5.0), [0, 1, 2], "all reached");
        assert_eq!(order(Some(&Front), -5.0), [0, 1, 2], "none is left out");
    }
}
