//! From approaches to a ranked grasp set.

use nalgebra::Point3;
use robotc_core::Seed;
use robotc_core::geom::{ConvexParts, MeshIndex};
use robotc_core::model::TriMesh;
use robotc_planning::grasp::{Contact, Grasp};

use super::closure::{ContactModel, PointContact, epsilon, wrenches};
use super::contacts::{PatchOptions, patch};
use super::hand::Hand;
use super::strategy::{Approach, ClosedHand, Miss, Target, close_on};
use super::surface::{ApproachOptions, SurfacePoint, approaches, sample};

/// How a set is made.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct GenerateOptions {
    /// Which approaches are tried.
    pub(super) approaches: ApproachOptions,
    /// What counts as touching.
    pub(super) patch: PatchOptions,
    /// Distance of the surface points that contacts are made of, metres.
    pub(super) surface_spacing: f64,
    /// Coulomb friction.
    pub(super) friction: f64,
    /// Edges of the pyramid that stands for a friction cone.
    pub(super) cone_edges: usize,
    /// Smallest epsilon of a grasp that is kept.
    pub(super) least_epsilon: f64,
    /// Most grasps that are kept, best first.
    pub(super) most_grasps: usize,
}

/// What became of the approaches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Counts {
    /// Approaches tried.
    pub(super) tried: usize,
    /// The hand passed by.
    pub(super) no_touch: usize,
    /// Fewer than two fingers touched.
    pub(super) few_fingers: usize,
    /// The palm or the back of a finger touched after the hand was centred.
    pub(super) palm: usize,
    /// The contacts do not close, or too weakly.
    pub(super) no_closure: usize,
    /// Force closure.
    pub(super) closed: usize,
}

/// Everything that trying an approach needs.
pub(super) struct Generator<'a> {
    hand: &'a Hand<'a>,
    target: Target<'a>,
    surface: Vec<SurfacePoint>,
    contact: ContactModel,
    options: &'a GenerateOptions,
    /// The approaches to try.
    pub(super) approaches: Vec<Approach>,
}

/// What became of one approach.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Trial {
    /// Force closure.
    Grasp(Box<Grasp>),
    /// The contacts do not close, or too weakly.
    NoClosure,
    /// The strategy gave no closed hand.
    Miss(Miss),
}

impl<'a> Generator<'a> {
    /// Prepares the trials, `seed` thins their approaches. Mesh, parts and centre of mass are in the object frame. `None` when the mesh is empty.
    pub(super) fn new(
        hand: &'a Hand<'a>,
        mesh: &TriMesh,
        parts: &'a ConvexParts,
        centre_of_mass: Point3<f64>,
        options: &'a GenerateOptions,
        seed: Seed,
    ) -> Option<Self> {
        let (low, high) = mesh.bounds()?;
        let centre = nalgebra::center(&low, &high);
        let radius = mesh.vertices.iter().map(|v| (v - centre).norm()).fold(0.0, f64::max);
        let surface = sample(mesh, options.surface_spacing);
        let length = surface.iter().map(|s| (s.point - centre_of_mass).norm()).fold(0.0, f64::max);
        let contact = ContactModel {
            friction: options.friction,
            cone_edges: options.cone_edges,
            centre: centre_of_mass,
            length: length.max(f64::MIN_POSITIVE),
        };
        let approaches = approaches(mesh, &MeshIndex::new(mesh), &options.approaches, seed);
        Some(Self { hand, target: Target { parts, centre, radius }, surface, contact, options, approaches })
    }

    /// Runs the grasp strategy along one approach and judges its contacts.
    pub(super) fn attempt(&self, approach: &Approach) -> Trial {
        let closed = match close_on(self.hand, &self.target, approach) {
            Ok(closed) => closed,
            Err(miss) => return Trial::Miss(miss),
        };
        let contacts = contacts_of(self.hand, &closed, &self.surface, &self.options.patch);
        let epsilon = match epsilon(&wrenches(&contacts, &self.contact)) {
            Some(epsilon) if epsilon >= self.options.least_epsilon => epsilon,
            _ => return Trial::NoClosure,
        };
        let contacts = contacts
            .iter()
            .map(|c| Contact { point_in_object: c.point, normal_in_object: c.inward })
            .collect();
        Trial::Grasp(Box::new(Grasp {
            preshape: approach.preshape,
            object_from_tool: closed.object_from_tool,
            approach_in_object: closed.object_from_tool.rotation * self.hand.gripper().approach_in_tool,
            standoff: approach.standoff,
            closed: closed.closed,
            contacts,
            epsilon,
            score: epsilon,
        }))
    }

    /// The distinct grasps, best first, and what became of the rest; `trials` in the order of the approaches.
    pub(super) fn collect(&self, trials: Vec<Trial>) -> (Vec<Grasp>, Counts) {
        let mut counts = Counts { tried: trials.len(), ..Counts::default() };
        let mut grasps = Vec::new();
        for trial in trials {
            match trial {
                Trial::Grasp(grasp) => {
                    counts.closed += 1;
                    grasps.push(*grasp);
                }
                Trial::NoClosure => counts.no_closure += 1,
                Trial::Miss(Miss::NoTouch) => counts.no_touch += 1,
                Trial::Miss(Miss::FewFingers) => counts.few_fingers += 1,
                Trial::Miss(Miss::PalmTouches | Miss::Inside) => counts.palm += 1,
            }
        }
        (spread(distinct(grasps), self.options.most_grasps), counts)
    }
}

/// Contact patches of all fingers of a closed hand.
pub(super) fn contacts_of(
    hand: &Hand,
    closed: &ClosedHand,
    surface: &[SurfacePoint],
    options: &PatchOptions,
) -> Vec<PointContact> {
    let mut contacts = Vec::new();
    for (link, object_from_link) in hand.links.iter().zip(&closed.object_from_links) {
        if link.is_finger {
            contacts.extend(patch(link.parts, object_from_link, surface, options));
        }
    }
    contacts
}

/// At most `count` grasps, best first: the best of every range of approach directions in turn, so that the set has a
/// grasp however the object lies and whatever stands around it.
fn spread(mut grasps: Vec<Grasp>, count: usize) -> Vec<Grasp> {
    grasps.sort_by(|a, b| b.score.total_cmp(&a.score));
    // Each grasp's place among those from its directions; ties keep the order of scores.
    let mut seen = [0usize; DIRECTIONS];
    let mut turns: Vec<(usize, Grasp)> = Vec::with_capacity(grasps.len());
    for grasp in grasps {
        let place = &mut seen[direction_range(&grasp.approach_in_object)];
        turns.push((*place, grasp));
        *place += 1;
    }
    turns.sort_by_key(|(place, _)| *place);
    turns.truncate(count);
    let mut kept: Vec<Grasp> = turns.into_iter().map(|(_, grasp)| grasp).collect();
    kept.sort_by(|a, b| b.score.total_cmp(&a.score));
    kept
}

/// Number of ranges of directions: three dominant axes and the signs of all coordinates.
const DIRECTIONS: usize = 24;

fn direction_range(direction: &nalgebra::Unit<nalgebra::Vector3<f64>>) -> usize {
    let sign = |axis: usize| usize::from(direction[axis] < 0.0) << axis;
    direction.iamax() * 8 + sign(0) + sign(1) + sign(2)
}

/// Poses closer than this are the same grasp: metres, and sine of the half angle.
const SAME_GRASP: f64 = 2e-3;

/// Drops grasps that repeat an earlier one, as rays beside each other often give after centring.
fn distinct(grasps: Vec<Grasp>) -> Vec<Grasp> {
    let mut kept: Vec<Grasp> = Vec::with_capacity(grasps.len());
    for grasp in grasps {
        let same = |other: &Grasp| {
            let between = other.object_from_tool.inverse() * grasp.object_from_tool;
            other.preshape == grasp.preshape
                && between.translation.vector.norm() < SAME_GRASP
                && between.rotation.imag().norm() < SAME_GRASP
        };
        if !kept.iter().any(same) {
            kept.push(grasp);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use nalgebra::Vector3;
    use robotc_core::geom::box_part;
    use robotc_core::ids::Idx;
    use robotc_core::model::{DynamicLimits, JointMotion, Kinematics, Origin, RobotBuilder};
    use robotc_core::robot::{Gripper, Preshape};
    use robotc_core::{DofIdx, LinkIdx, Pose};

    /// A palm with two jaws that open to 80 mm; the second follows the first.
    fn jaws() -> (Kinematics, Gripper, Vec<(LinkIdx, ConvexParts)>) {
        let mut b = RobotBuilder::new("jaws");
        b.link("palm", vec![], vec![], None).link("left", vec![], vec![], None).link(
            "right",
            vec![],
            vec![],
            None,
        );
        let limits = (0.0, 0.04, false, DynamicLimits::DEFAULT);
        let slide = JointMotion::Prismatic;
        b.moving("left", slide, "palm", "left", Origin::default(), [0.0, 1.0, 0.0], limits, None);
        let follow = Some(("left".to_owned(), 1.0, 0.0));
        b.moving("right", slide, "palm", "right", Origin::default(), [0.0, -1.0, 0.0], limits, follow);
        let model = Arc::new(b.build().unwrap());
        let pad =
            |y: f64| box_part(Vector3::new(0.02, 0.01, 0.05)).transformed(&Pose::translation(0.0, y, 0.075));
        let parts = vec![
            (LinkIdx::new(0), ConvexParts::new(vec![box_part(Vector3::new(0.06, 0.2, 0.1))])),
            (LinkIdx::new(1), ConvexParts::new(vec![pad(0.005)])),
            (LinkIdx::new(2), ConvexParts::new(vec![pad(-0.005)])),
        ];
        let gripper = Gripper {
            name: "jaws".into(),
            palm: LinkIdx::new(0),
            palm_from_tool: Pose::translation(0.0, 0.0, 0.09),
            approach_in_tool: Vector3::z_axis(),
            dofs: vec![DofIdx::new(0)],
            closing: vec![-1.0],
            fingers: vec![LinkIdx::new(1), LinkIdx::new(2)],
            preshapes: vec![Preshape { name: "open".into(), values: vec![0.04] }],
        };
        (Kinematics::new(model), gripper, parts)
    }

    fn options() -> GenerateOptions {
        GenerateOptions {
            approaches: ApproachOptions {
                spacing: 0.02,
                rolls: 4,
                directions: 1,
                cone: 0.0,
                standoffs: vec![0.005],
                preshapes: 1,
                most: 100_000,
            },
            patch: PatchOptions { depth: 1e-3, gap: 1e-3, points: 6 },
            surface_spacing: 0.003,
            friction: 0.5,
            cone_edges: 8,
            least_epsilon: 1e-3,
            most_grasps: 1000,
        }
    }

    fn grasps_of(size: [f64; 3]) -> (Vec<Grasp>, Counts) {
        let (kinematics, gripper, parts) = jaws();
        let hand =
            Hand::new(&kinematics, &gripper, |l| parts.iter().find(|(link, _)| *link == l).map(|(_, p)| p));
        let part = box_part(Vector3::from(size));
        let mesh = part.mesh();
        let object = ConvexParts::new(vec![part]);
        let options = options();
        let generator =
            Generator::new(&hand, &mesh, &object, Point3::origin(), &options, Seed::new(1)).unwrap();
        generator.collect(generator.approaches.iter().map(|a| generator.attempt(a)).collect())
    }

    #[test]
    fn jaws_hold_a_box_across_its_narrow_side_centred() {
        let (grasps, counts) = grasps_of([0.05, 0.12, 0.12]);
        assert!(counts.closed > 20, "{counts:?}");
        for g in &grasps {
            // The jaws move along tool y, which must be the narrow side of the box, and both touch: 25 mm each.
            let jaw = g.object_from_tool.rotation * Vector3::y();
            assert!(jaw.x.abs() > 0.99, "{jaw}");
            assert!(g.object_from_tool.translation.x.abs() < 1e-3, "{}", g.object_from_tool.translation);
            assert!((g.closed[0] - 0.025).abs() < 2e-3, "{:?}", g.closed);
            assert!(g.contacts.iter().any(|c| c.point_in_object.x > 0.0));
            assert!(g.contacts.iter().any(|c| c.point_in_object.x < 0.0));
        }
    }

    #[test]
    fn a_small_set_keeps_all_directions_of_a_large_one() {
        let (grasps, _) = grasps_of([0.05, 0.12, 0.12]);
        let directions = |grasps: &[Grasp]| {
            let ranges = grasps.iter().map(|g| direction_range(&g.approach_in_object));
            ranges.collect::<std::collections::BTreeSet<_>>()
        };
        let all = directions(&grasps);
        let few = spread(grasps, all.len());
        assert!(all.len() >= 4 && few.len() == all.len());
        assert_eq!(directions(&few), all);
    }

    #[test]
    fn a_box_wider_than_the_jaws_cannot_be_held() {
        let (grasps, counts) = grasps_of([0.1, 0.1, 0.1]);
        assert!(grasps.is_empty() && counts.tried > 0, "{counts:?}");
    }
}
