//! From approaches to a ranked grasp set.

use std::fmt;

use nalgebra::Point3;
use robotc_core::geom::{ConvexParts, MeshIndex};
use robotc_core::model::TriMesh;
use robotc_core::robot::Hold;
use robotc_core::{Pose, Seed};
use robotc_planning::grasp::{
    Contact, ContactModel, Grasp, Steadiness, bears, closes, epsilon, strength, volume, wrenches,
};
use serde::{Deserialize, Serialize};

use super::contacts::{PatchOptions, patch};
use super::coverage::{DIRECTIONS, direction_range};
use super::steadiness::{Regrasp, SteadinessOptions, deviation, disturbances};
use super::stored::{Stored, StoredPose};
use super::tips::{TipOptions, Tips};
use crate::kind::DecodeError;
use crate::kinds::grip::hand::Hand;
use crate::kinds::grip::strategy::{
    Approach, ClosedHand, Miss, Start, arrive, close_fingers, close_on, is_clear, touch_with_tips,
};
use crate::kinds::grip::surface::{ApproachOptions, Surface, approaches};

/// Points of the surface across the narrowest tip of a hand that attracts.
const POINTS_ACROSS_TIPS: f64 = 16.0;

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
    /// Whether the volumes of the wrench hulls are computed.
    pub(super) volumes: bool,
    /// How repeatability is tested.
    pub(super) steadiness: SteadinessOptions,
    /// What contacts of a hand that attracts have to be like.
    pub(super) tips: TipOptions,
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

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { tried, no_touch, few_fingers, palm, no_closure, closed } = self;
        write!(
            f,
            "of {tried} approaches {no_touch} passed the object by, {few_fingers} closed with fewer than two fingers on it, \
             {palm} had the palm or the back of a finger in it, {no_closure} gave contacts that do not hold, and {closed} \
             held but slip away when the object is moved a little"
        )
    }
}

/// Everything that trying an approach needs.
pub(super) struct Generator<'a> {
    hand: &'a Hand<'a>,
    object: &'a ConvexParts,
    surface: Surface,
    contact: ContactModel,
    options: &'a GenerateOptions,
    disturbances: Vec<Pose>,
    /// Of a hand that attracts.
    tips: Option<Tips>,
    /// The approaches to try.
    pub(super) approaches: Vec<Approach>,
}

/// A grasp with force closure, and how the hand came to it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Candidate {
    grasp: Grasp,
    start: Start,
}

/// What became of one approach, as kept between the processes of one build.
#[derive(Serialize, Deserialize)]
pub(super) enum Trial {
    /// Force closure; where the hand started.
    Grasp(Box<Stored>, StoredPose),
    /// The contacts do not close, or too weakly.
    NoClosure,
    /// The strategy gave no closed hand.
    Miss(Miss),
}

impl<'a> Generator<'a> {
    /// Prepares the trials; `seed` thins their approaches and disturbs the object. Mesh, parts and centre of mass are in the
    /// object frame. `None` when the mesh is empty.
    pub(super) fn new(
        hand: &'a Hand<'a>,
        mesh: &TriMesh,
        object: &'a ConvexParts,
        centre_of_mass: Point3<f64>,
        options: &'a GenerateOptions,
        seed: Seed,
    ) -> Option<Self> {
        let attracts = hand.gripper().hold == Hold::Attract;
        let tips = attracts.then(|| Tips::of(hand, options.patch.depth, options.tips));
        // Contacts are points of the surface: there have to be enough of them across a tip to see how wide it touches.
        let of_tips = tips.as_ref().map_or(f64::INFINITY, |tips| tips.narrowest() / POINTS_ACROSS_TIPS);
        let surface = Surface::new(mesh, options.surface_spacing.min(of_tips));
        let farthest = surface.points().iter().map(|s| (s.point - centre_of_mass).norm()).reduce(f64::max)?;
        let contact = ContactModel {
            friction: options.friction,
            cone_edges: options.cone_edges,
            centre: centre_of_mass,
            length: farthest.max(f64::MIN_POSITIVE),
            hold: hand.gripper().hold,
        };
        let disturbances = disturbances(&options.steadiness, &centre_of_mass, contact.length, seed);
        let approaches = approaches(mesh, &MeshIndex::new(mesh), &options.approaches, seed);
        Some(Self { hand, object, surface, contact, options, disturbances, tips, approaches })
    }

    /// Runs the grasp strategy along one approach and judges its contacts.
    pub(super) fn attempt(&self, approach: &Approach) -> Trial {
        let gripper = self.hand.gripper();
        let start = approach.start(&gripper.approach_in_tool);
        let closed = match self.hold(&start) {
            Ok(closed) => closed,
            Err(miss) => return Trial::Miss(miss),
        };
        let contacts = self.contacts_of(&closed.object_from_links);
        if !self.lies_flat(&contacts, &closed) {
            return Trial::NoClosure;
        }
        let wrenches = wrenches(&contacts, &self.contact);
        if !closes(&wrenches) {
            return Trial::NoClosure;
        }
        let epsilon = match epsilon(&wrenches) {
            Some(epsilon) if epsilon.lower >= self.options.least_epsilon => epsilon.lower,
            _ => return Trial::NoClosure,
        };
        let grasp = Grasp {
            preshape: approach.preshape,
            object_from_tool: closed.object_from_tool,
            approach_in_object: closed.object_from_tool.rotation * gripper.approach_in_tool,
            standoff: approach.standoff,
            closed: closed.closed,
            contacts,
            epsilon,
            volume: None,
            steadiness: None,
            score: strength(&wrenches),
        };
        Trial::Grasp(Box::new(Stored::of(&grasp)), StoredPose::of(&start.object_from_tool))
    }

    /// The distinct candidates, and what became of the rest; `trials` in the order of the approaches. The best of every range
    /// of approach directions come in turn, so that the first of them have a grasp however the object lies and
    /// whatever stands around it.
    pub(super) fn candidates(&self, trials: Vec<Trial>) -> Result<(Vec<Candidate>, Counts), DecodeError> {
        let mut counts = Counts { tried: trials.len(), ..Counts::default() };
        let mut candidates = Vec::new();
        for trial in trials {
            match trial {
                Trial::Grasp(grasp, object_from_tool) => {
                    counts.closed += 1;
                    let grasp = grasp.grasp()?;
                    let (preshape, standoff) = (grasp.preshape, grasp.standoff);
                    let start = Start { object_from_tool: object_from_tool.pose()?, preshape, standoff };
                    candidates.push(Candidate { grasp, start });
                }
                Trial::NoClosure => counts.no_closure += 1,
                Trial::Miss(Miss::NoTouch) => counts.no_touch += 1,
                Trial::Miss(Miss::FewFingers) => counts.few_fingers += 1,
                Trial::Miss(Miss::PalmTouches | Miss::Inside) => counts.palm += 1,
            }
        }
        Ok((in_turns(distinct(candidates)), counts))
    }

    /// The grasp of a candidate with all its measures; `None` when it is fragile.
    pub(super) fn judge(&self, candidate: &Candidate) -> Option<Grasp> {
        let mut grasp = candidate.grasp.clone();
        if !self.disturbances.is_empty() {
            let steadiness = self.steadiness(candidate)?;
            grasp.score *= steadiness.held;
            grasp.steadiness = Some(steadiness);
        }
        grasp.volume = self.options.volumes.then(|| volume(&wrenches(&grasp.contacts, &self.contact)));
        Some(grasp)
    }

    /// Grasps the disturbed object again and again; `None` when the grasp is fragile.
    ///
    /// The hand opens where it was planned to stand, as one that sees the object elsewhere than it is will do. When it is not
    /// clear there the grasp does not hold; how far the hand would deviate is then seen by coming in once more.
    fn steadiness(&self, candidate: &Candidate) -> Option<Steadiness> {
        let Candidate { grasp, start } = candidate;
        let open = &self.hand.gripper().preshapes[start.preshape].values;
        let mut regrasps = Vec::with_capacity(self.disturbances.len());
        let mut held = 0;
        for object_from_disturbed in &self.disturbances {
            let disturbed_from_object = object_from_disturbed.inverse();
            let planned = disturbed_from_object * grasp.object_from_tool;
            // Tips come in until they touch, wherever that is.
            let clear = self.tips.is_some() || is_clear(self.hand, self.object, &planned, open);
            let closed = if clear && self.tips.is_none() {
                close_fingers(self.hand, self.object, planned, open)
            } else {
                let object_from_tool = disturbed_from_object * start.object_from_tool;
                self.hold(&Start { object_from_tool, ..*start })
            };
            let Ok(closed) = closed else { continue };
            let contacts = self.contacts_of(&closed.object_from_links);
            let holds = || bears(&wrenches(&contacts, &self.contact), 0.5 * grasp.score);
            held += usize::from(clear && self.lies_flat(&contacts, &closed) && holds());
            let tool = Point3::from((object_from_disturbed * closed.object_from_tool).translation.vector);
            regrasps.push(Regrasp { tool, closed: closed.closed });
        }
        let deviation = deviation(self.hand, &regrasps);
        let SteadinessOptions { disturbance, slip, .. } = self.options.steadiness;
        let enough = 2 * regrasps.len() > self.disturbances.len();
        let held = held as f64 / self.disturbances.len() as f64;
        (enough && slip * deviation <= disturbance).then_some(Steadiness { deviation, held })
    }

    /// Runs the strategy of the hand.
    fn hold(&self, start: &Start) -> Result<ClosedHand, Miss> {
        let Some(tips) = &self.tips else { return close_on(self.hand, self.object, start) };
        // What is attracted turns until it lies against the tips.
        let (object_from_tool, object_from_links) = arrive(self.hand, self.object, start)?;
        let touched = self.contacts_of(&object_from_links);
        let turned = tips.turned(&touched, &object_from_tool, &self.hand.gripper().approach_in_tool);
        let start = Start { object_from_tool: turned, ..*start };
        touch_with_tips(self.hand, self.object, &start, self.options.patch.depth)
    }

    /// Whether tips that attract lie flat; of no matter to fingers.
    fn lies_flat(&self, contacts: &[Contact], closed: &ClosedHand) -> bool {
        self.tips.as_ref().is_none_or(|tips| tips.lie_flat(contacts, &closed.object_from_tool))
    }

    /// Contact patches of all fingers of a closed hand.
    fn contacts_of(&self, object_from_links: &[Pose]) -> Vec<Contact> {
        let mut contacts = Vec::new();
        for (link, object_from_link) in self.hand.links.iter().zip(object_from_links) {
            if link.is_finger {
                contacts.extend(patch(link.parts, object_from_link, &self.surface, &self.options.patch));
            }
        }
        contacts
    }
}

/// The best candidate of every range of approach directions, then the second best of every range, and so on.
fn in_turns(mut candidates: Vec<Candidate>) -> Vec<Candidate> {
    candidates.sort_by(|a, b| b.grasp.score.total_cmp(&a.grasp.score));
    // Each one's place among those from its directions; ties keep the order of scores.
    let mut seen = [0usize; DIRECTIONS];
    let mut turns: Vec<(usize, Candidate)> = Vec::with_capacity(candidates.len());
    for candidate in candidates {
        let place = &mut seen[direction_range(&candidate.grasp.approach_in_object)];
        turns.push((*place, candidate));
        *place += 1;
    }
    turns.sort_by_key(|(place, _)| *place);
    turns.into_iter().map(|(_, candidate)| candidate).collect()
}

/// Poses closer than this are the same grasp: metres, and sine of the half angle.
const SAME_GRASP: f64 = 2e-3;

/// Drops grasps that repeat an earlier one, as rays beside each other often give after centring.
fn distinct(candidates: Vec<Candidate>) -> Vec<Candidate> {
    let mut kept: Vec<Candidate> = Vec::with_capacity(candidates.len());
    for candidate in candidates {
        let tool = candidate.grasp.object_from_tool;
        let same = |other: &Candidate| {
            let other_tool = other.grasp.object_from_tool;
            other.grasp.preshape == candidate.grasp.preshape
                && (other_tool.translation.vector - tool.translation.vector).norm() < SAME_GRASP
                && (other_tool.rotation.inverse() * tool.rotation).imag().norm() < SAME_GRASP
        };
        if !kept.iter().any(same) {
            kept.push(candidate);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinds::grip::jaws::jaws;

    use nalgebra::Vector3;
    use robotc_core::geom::box_part;

    fn options() -> GenerateOptions {
        GenerateOptions {
            approaches: ApproachOptions {
                spacing: 0.02,
                rolls: 4,
                directions: 1,
                cone: 0.0,
                standoffs: vec![0.005],
                rays: vec![Vector3::zeros()],
                preshapes: 1,
                most: 100_000,
            },
            patch: PatchOptions { depth: 1e-3, gap: 1e-3, points: 6 },
            surface_spacing: 0.003,
            friction: 0.5,
            cone_edges: 8,
            least_epsilon: 1e-3,
            volumes: true,
            steadiness: SteadinessOptions { disturbance: 0.005, repeats: 8, slip: 0.7 },
            tips: TipOptions { footprint: 0.7, agreement: 0.3 },
        }
    }

    fn with_generator<R>(size: [f64; 3], use_it: impl FnOnce(&Generator) -> R) -> R {
        let (kinematics, gripper, parts) = jaws();
        let hand =
            Hand::new(&kinematics, &gripper, |l| parts.iter().find(|(link, _)| *link == l).map(|(_, p)| p));
        let part = box_part(Vector3::from(size));
        let mesh = part.mesh();
        let object = ConvexParts::new(vec![part]);
        let options = options();
        use_it(&Generator::new(&hand, &mesh, &object, Point3::origin(), &options, Seed::new(1)).unwrap())
    }

    fn candidates_of(generator: &Generator) -> (Vec<Candidate>, Counts) {
        generator.candidates(generator.approaches.iter().map(|a| generator.attempt(a)).collect()).unwrap()
    }

    #[test]
    fn jaws_hold_a_box_across_its_narrow_side_centred() {
        let (candidates, counts) = with_generator([0.05, 0.12, 0.12], candidates_of);
        assert!(counts.closed > 20, "{counts:?}");
        for Candidate { grasp: g, .. } in &candidates {
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
    fn a_wide_face_is_held_steadily() {
        with_generator([0.05, 0.12, 0.12], |generator| {
            let (candidates, _) = candidates_of(generator);
            let kept: Vec<Grasp> = candidates.iter().filter_map(|c| generator.judge(c)).collect();
            assert!(3 * kept.len() > 2 * candidates.len(), "{} of {}", kept.len(), candidates.len());
            for grasp in &kept {
                let steadiness = grasp.steadiness.unwrap();
                // The hand follows the object, whose points move by up to 5 mm.
                assert!(steadiness.deviation > 1e-4 && steadiness.deviation < 0.0072, "{steadiness:?}");
                assert!(grasp.volume.unwrap() > 0.0 && grasp.score <= 1.0);
            }
            let held = kept.iter().map(|g| g.steadiness.unwrap().held).fold(0.0, f64::max);
            assert!(held > 0.9, "{held}");
        });
    }

    #[test]
    fn the_first_candidates_have_all_directions() {
        let (candidates, _) = with_generator([0.05, 0.12, 0.12], candidates_of);
        let directions = |candidates: &[Candidate]| {
            let ranges = candidates.iter().map(|c| direction_range(&c.grasp.approach_in_object));
            ranges.collect::<std::collections::BTreeSet<_>>()
        };
        let all = directions(&candidates);
        assert!(all.len() >= 4);
        assert_eq!(directions(&candidates[..all.len()]), all);
    }

    #[test]
    fn a_box_wider_than_the_jaws_cannot_be_held() {
        let (candidates, counts) = with_generator([0.1, 0.1, 0.1], candidates_of);
        assert!(candidates.is_empty() && counts.tried > 0, "{counts:?}");
    }
}
