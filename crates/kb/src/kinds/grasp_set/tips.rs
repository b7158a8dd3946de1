//! What holds without closing: magnets and suction cups, which touch with their tips (thesis, end of section 4.2, figure 4.16).
//!
//! Force closure says little about them, since a tip that pulls resists almost everything while it lies flat. What matters is
//! that it does: contacts as wide as the tips, whose normals agree. That they still are when the object is not quite where it should
//! be tells a wide flat region from a small bump that is hard to hit.

use nalgebra::{Point3, Unit, UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_planning::grasp::{Contact, tangents};

use crate::kinds::grip::hand::Hand;

/// What contacts of tips have to be like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TipOptions {
    /// Smallest width of the contacts as a share of that of the tips, in every direction across the approach.
    pub(super) footprint: f64,
    /// Largest angle of a contact's normal to their mean, radians.
    pub(super) agreement: f64,
}

/// Directions across the approach, over half a turn, in which widths are compared.
const DIRECTIONS: usize = 8;

/// The tips of a hand as seen along its approach.
pub(super) struct Tips {
    /// Directions across the approach, tool frame.
    across: [Vector3<f64>; DIRECTIONS],
    /// Width of all tips together along each of them, metres.
    widths: [f64; DIRECTIONS],
    options: TipOptions,
}

impl Tips {
    /// The front of each finger: what of it is no more than `give` metres behind its foremost point. With the hand's first preshape.
    pub(super) fn of(hand: &Hand, give: f64, options: TipOptions) -> Self {
        let gripper = hand.gripper();
        let tool_from_palm = gripper.palm_from_tool.inverse();
        let mut front: Vec<Point3<f64>> = Vec::new();
        for (link, palm_from_link) in
            hand.links.iter().zip(hand.palm_from_links(&gripper.preshapes[0].values))
        {
            if link.is_finger {
                let points: Vec<_> =
                    link.parts.points().map(|p| tool_from_palm * (palm_from_link * p)).collect();
                let ahead = |p: &Point3<f64>| gripper.approach_in_tool.dot(&p.coords);
                let foremost = points.iter().map(ahead).fold(f64::NEG_INFINITY, f64::max);
                front.extend(points.iter().filter(|p| ahead(p) >= foremost - give));
            }
        }
        let (u, v) = tangents(&gripper.approach_in_tool);
        let across = std::array::from_fn(|i| {
            let angle = std::f64::consts::PI * i as f64 / DIRECTIONS as f64;
            u * libm::cos(angle) + v * libm::sin(angle)
        });
        let widths = across.map(|direction| width(front.iter().copied(), &direction));
        Self { across, widths, options }
    }

    /// The smallest width of the tips, metres.
    pub(super) fn narrowest(&self) -> f64 {
        self.widths.into_iter().fold(f64::INFINITY, f64::min)
    }

    /// The tool turned about its origin to come in along the mean normal of the contacts, if it is near enough to that.
    pub(super) fn turned(
        &self,
        contacts: &[Contact],
        object_from_tool: &Pose,
        approach_in_tool: &Unit<Vector3<f64>>,
    ) -> Pose {
        let sum: Vector3<f64> = contacts.iter().map(|c| c.normal_in_object.into_inner()).sum();
        let approach = object_from_tool.rotation * approach_in_tool;
        let turn = UnitQuaternion::rotation_between(&approach, &sum).unwrap_or_default();
        if contacts.is_empty() || turn.angle() > self.options.agreement {
            return *object_from_tool;
        }
        Pose::from_parts(object_from_tool.translation, turn * object_from_tool.rotation)
    }

    /// Whether contacts are as wide as the tips and their normals agree.
    pub(super) fn lie_flat(&self, contacts: &[Contact], object_from_tool: &Pose) -> bool {
        let sum: Vector3<f64> = contacts.iter().map(|c| c.normal_in_object.into_inner()).sum();
        let Some(mean) = sum.try_normalize(1e-9) else { return false };
        let least = libm::cos(self.options.agreement);
        if contacts.iter().any(|c| c.normal_in_object.dot(&mean) < least) {
            return false;
        }
        let tool_from_object = object_from_tool.inverse();
        let mut places = self.across.iter().zip(self.widths);
        places.all(|(direction, of_tips)| {
            let points = contacts.iter().map(|c| tool_from_object * c.point_in_object);
            width(points, direction) >= self.options.footprint * of_tips
        })
    }
}

/// Extent of points along a direction.
fn width(points: impl Iterator<Item = Point3<f64>>, direction: &Vector3<f64>) -> f64 {
    let along = points.map(|p| direction.dot(&p.coords));
    let (low, high) =
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    (high - low).max(0.0)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use robotc_core::geom::{ConvexPart, ConvexParts, box_part};
    use robotc_core::ids::Idx;
    use robotc_core::model::{Kinematics, Origin, RobotBuilder, TriMesh};
    use robotc_core::robot::{Gripper, Hold, Preshape};
    use robotc_core::{LinkIdx, Seed};
    use robotc_planning::grasp::Grasp;

    use super::super::contacts::PatchOptions;
    use super::super::generate::{Candidate, GenerateOptions, Generator};
    use super::super::steadiness::SteadinessOptions;
    use super::*;
    use crate::kinds::grip::surface::ApproachOptions;

    /// A bar with two magnets of 10 mm x 10 mm, their centres 40 mm apart along y.
    fn magnets() -> (Kinematics, Gripper, Vec<(LinkIdx, ConvexParts)>) {
        let mut b = RobotBuilder::new("magnets");
        b.link("bar", vec![], vec![], None);
        for (name, y) in [("left", 0.02), ("right", -0.02)] {
            b.link(name, vec![], vec![], None);
            b.fixed(name, "bar", name, Origin { xyz: [0.0, y, 0.0], ..Origin::default() });
        }
        let model = Arc::new(b.build().unwrap());
        let tip =
            || box_part(Vector3::new(0.01, 0.01, 0.03)).transformed(&Pose::translation(0.0, 0.0, 0.035));
        let parts = vec![
            (LinkIdx::new(0), ConvexParts::new(vec![box_part(Vector3::new(0.02, 0.06, 0.04))])),
            (LinkIdx::new(1), ConvexParts::new(vec![tip()])),
            (LinkIdx::new(2), ConvexParts::new(vec![tip()])),
        ];
        let gripper = Gripper {
            name: "magnets".into(),
            palm: LinkIdx::new(0),
            palm_from_tool: Pose::translation(0.0, 0.0, 0.05),
            approach_in_tool: Vector3::z_axis(),
            hold: Hold::Attract,
            dofs: vec![],
            closing: vec![],
            fingers: vec![LinkIdx::new(1), LinkIdx::new(2)],
            preshapes: vec![Preshape { name: "open".into(), values: vec![] }],
        };
        (Kinematics::new(model), gripper, parts)
    }

    /// The grasps of an object made of convex parts that do not overlap: all with closure, and those that are steady.
    fn grasps_of(parts: Vec<ConvexPart>) -> (Vec<Candidate>, Vec<Grasp>) {
        let (kinematics, gripper, links) = magnets();
        let hand =
            Hand::new(&kinematics, &gripper, |l| links.iter().find(|(link, _)| *link == l).map(|(_, p)| p));
        let mut mesh = TriMesh::default();
        parts.iter().for_each(|part| mesh.append(&part.mesh()));
        let options = GenerateOptions {
            approaches: ApproachOptions {
                spacing: 0.01,
                rolls: 4,
                directions: 1,
                cone: 0.0,
                standoffs: vec![0.0],
                rays: vec![Vector3::zeros()],
                preshapes: 1,
                most: 100_000,
            },
            patch: PatchOptions { depth: 1e-3, gap: 1e-3, points: 6 },
            surface_spacing: 0.002,
            friction: 0.5,
            cone_edges: 8,
            least_epsilon: 1e-3,
            volumes: false,
            steadiness: SteadinessOptions { disturbance: 0.005, repeats: 8, slip: 0.7 },
            tips: TipOptions { footprint: 0.7, agreement: 0.3 },
        };
        let object = ConvexParts::new(parts);
        let generator =
            Generator::new(&hand, &mesh, &object, Point3::origin(), &options, Seed::new(1)).unwrap();
        let trials = generator.approaches.iter().map(|a| generator.attempt(a)).collect();
        let (candidates, counts) = generator.candidates(trials).unwrap();
        assert!(counts.tried > 30, "{counts:?}");
        let kept = candidates.iter().filter_map(|c| generator.judge(c)).collect();
        (candidates, kept)
    }

    #[test]
    fn magnets_hold_a_plate_by_its_broad_faces_only() {
        let (candidates, kept) = grasps_of(vec![box_part(Vector3::new(0.1, 0.1, 0.008))]);
        assert!(
            2 * kept.len() > candidates.len() && kept.len() > 50,
            "{} of {}",
            kept.len(),
            candidates.len()
        );
        for grasp in &kept {
            assert!(grasp.approach_in_object.z.abs() > 0.99, "{}", grasp.approach_in_object.into_inner());
            // Both magnets are on the plate, nearly as a whole.
            let along = grasp.object_from_tool.rotation * Vector3::y();
            for side in [-1.0, 1.0] {
                let magnet = grasp.object_from_tool.translation.vector + along * (0.02 * side);
                assert!(magnet.x.abs() < 0.05 && magnet.y.abs() < 0.05, "{magnet}");
            }
            assert!(grasp.epsilon > 0.0 && grasp.closed.is_empty());
        }
        assert!(kept.iter().any(|g| g.steadiness.unwrap().held == 1.0));
    }

    #[test]
    fn bumps_and_posts_are_too_small_to_hold() {
        let posts = [-0.02, 0.02]
            .map(|y| box_part(Vector3::new(0.003, 0.003, 0.05)).transformed(&Pose::translation(0.0, y, 0.0)));
        let (candidates, _) = grasps_of(posts.to_vec());
        assert!(candidates.is_empty(), "{} grasps", candidates.len());
    }
}
