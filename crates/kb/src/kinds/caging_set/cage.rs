//! Whether a hand cages a part that turns or slides (thesis, algorithm 4.2).

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use robotc_core::geom::{ConvexParts, any_within};
use robotc_core::{Pose, Seed};
use robotc_planning::caging::CageGrasp;
use robotc_planning::mechanism::MechanismMotion;

use super::{Cage, CageHold};
use crate::kinds::grip::advance::first_touch;
use crate::kinds::grip::hand::Hand;
use crate::kinds::grip::strategy::{Start, close_on};

/// How cages are tested.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CageOptions {
    /// Share of the way back to the preshape by which closed fingers open again.
    pub(super) looseness: f64,
    /// How far the part may move at the tool before it is stopped, metres.
    pub(super) slack: f64,
    /// The same for a closed hand in contact, metres.
    pub(super) play: f64,
    /// Largest shift of a jittered hand, metres.
    pub(super) jitter: f64,
    /// Largest turn of a jittered hand, radians.
    pub(super) jitter_turn: f64,
    /// Jittered hands that have to cage.
    pub(super) needed: u32,
    /// Jittered hands that are drawn.
    pub(super) tries: u32,
}

/// A part and a hand, in the axis frame of the part.
pub(super) struct Caged<'a> {
    pub(super) hand: &'a Hand<'a>,
    pub(super) parts: &'a ConvexParts,
    pub(super) motion: MechanismMotion,
    pub(super) options: &'a CageOptions,
}

/// A hand that may cage.
#[derive(Clone, Copy)]
pub(super) struct Seedling<'a> {
    pub(super) part_from_tool: Pose,
    pub(super) values: &'a [f64],
}

/// The part is stopped at least this often on its way, metres at the tool, so that no finger is jumped over.
const STEP: f64 = 0.004;
/// Gap between a part and a hand that only pushes it, metres.
const PUSH_GAP: f64 = 0.002;

impl Caged<'_> {
    /// The grip that an approach leads to: fingers closed and opened again where that cages, else the preshape where it pushes
    /// or pulls.
    pub(super) fn attempt(&self, start: &Start, seed: Seed) -> Option<Cage> {
        let gripper = self.hand.gripper();
        let open = &gripper.preshapes[start.preshape].values;
        if let Ok(closed) = close_on(self.hand, self.parts, start) {
            let part_from_tool = closed.object_from_tool;
            let back = |(shut, open): (&f64, &f64)| shut + self.options.looseness * (open - shut);
            let loose: Vec<f64> = closed.closed.iter().zip(open).map(back).collect();
            let seedling = Seedling { part_from_tool, values: &loose };
            if let Some(hold) = self.hold(&seedling, seed) {
                let tight = Seedling { part_from_tool, values: &closed.closed };
                let contact = hold == CageHold::Both && self.is_tight(&tight);
                let grasp = CageGrasp { part_from_tool, contact };
                return Some(Cage { grasp, hold, preshape: start.preshape, loose, closed: closed.closed });
            }
        }
        // Fingers need not close to push: the open hand, just clear of the part.
        let direction = start.object_from_tool.rotation * gripper.approach_in_tool;
        let part_from_palm = start.object_from_tool * gripper.palm_from_tool.inverse();
        let links: Vec<Pose> = self.hand.palm_from_links(open).iter().map(|p| part_from_palm * p).collect();
        let travel = first_touch(self.hand, &links, &direction, self.parts)?;
        let ahead = Translation3::from(direction.into_inner() * (travel - PUSH_GAP));
        let part_from_tool = ahead * start.object_from_tool;
        let hold = self.hold(&Seedling { part_from_tool, values: open }, seed)?;
        let grasp = CageGrasp { part_from_tool, contact: false };
        Some(Cage { grasp, hold, preshape: start.preshape, loose: open.clone(), closed: open.clone() })
    }

    /// Whether a closed hand lets the part move neither way.
    pub(super) fn is_tight(&self, closed: &Seedling) -> bool {
        [1.0, -1.0].iter().all(|way| self.stops(closed, way * self.options.play, 1))
    }

    /// In which directions the part is stopped by this hand and by all that are jittered from it; `None` when in none, or when
    /// there is no room to jitter.
    pub(super) fn hold(&self, seedling: &Seedling, seed: Seed) -> Option<CageHold> {
        if self.touches(seedling, 0.0) {
            return None;
        }
        let slack = self.options.slack;
        // The part lags behind a hand that opens it.
        let mut opening = self.stops(seedling, -slack, 1);
        let mut closing = self.stops(seedling, slack, 1);
        let mut rng = seed.rng();
        let mut clear = 0;
        for _ in 0..self.options.tries {
            if clear == self.options.needed || !(opening || closing) {
                break;
            }
            let shift = rng.direction().into_inner() * (rng.unit() * self.options.jitter);
            let turn =
                UnitQuaternion::from_axis_angle(&rng.direction(), rng.unit() * self.options.jitter_turn);
            let moved = seedling.part_from_tool.translation.vector + shift;
            let part_from_tool =
                Pose::from_parts(Translation3::from(moved), turn * seedling.part_from_tool.rotation);
            let jittered = Seedling { part_from_tool, ..*seedling };
            if self.touches(&jittered, 0.0) {
                continue;
            }
            clear += 1;
            opening = opening && self.stops(&jittered, -slack, 1);
            closing = closing && self.stops(&jittered, slack, 1);
        }
        match (opening, closing) {
            _ if clear < self.options.needed => None,
            (true, true) => Some(CageHold::Both),
            (true, false) => Some(CageHold::Opening),
            (false, true) => Some(CageHold::Closing),
            (false, false) => None,
        }
    }

    /// Whether the hand is hit when the part moves by `way`, metres at the tool, looked at `fineness` times as often as needed.
    pub(super) fn stops(&self, seedling: &Seedling, way: f64, fineness: u32) -> bool {
        let reach = seedling.part_from_tool.translation.vector.xy().norm();
        let units = match self.motion {
            MechanismMotion::Slide => way,
            // A hand on the axis is not moved by a turn: then anything up to a radian counts.
            MechanismMotion::Hinge => way / reach.max(way.abs()),
        };
        let steps = (way.abs() / STEP).ceil().max(1.0) * f64::from(fineness);
        (1..=steps as u32).any(|k| self.touches(seedling, units * f64::from(k) / steps))
    }

    /// Whether the hand touches the part when its joint has moved by `value`.
    pub(super) fn touches(&self, seedling: &Seedling, value: f64) -> bool {
        let moved = match self.motion {
            MechanismMotion::Slide => Pose::translation(0.0, 0.0, value),
            MechanismMotion::Hinge => Pose::from_parts(
                Translation3::identity(),
                UnitQuaternion::from_axis_angle(&Vector3::z_axis(), value),
            ),
        };
        let palm = seedling.part_from_tool * self.hand.gripper().palm_from_tool.inverse();
        let links = self.hand.palm_from_links(seedling.values);
        self.hand.links.iter().zip(&links).any(|(link, palm_from_link)| {
            any_within(self.parts, &moved, link.parts, &(palm * palm_from_link), 0.0)
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use nalgebra::Unit;
    use robotc_core::geom::box_part;

    use super::*;
    use crate::kinds::grip::jaws::jaws;

    /// A bar along y, 15 cm in front of a panel that slides along z (a drawer): the hand comes along -z.
    pub(in crate::kinds::caging_set) fn drawer() -> ConvexParts {
        let bar = box_part(Vector3::new(0.02, 0.2, 0.02)).transformed(&Pose::translation(0.0, 0.0, 0.16));
        let panel = box_part(Vector3::new(0.4, 0.4, 0.02));
        ConvexParts::new(vec![bar, panel])
    }

    pub(in crate::kinds::caging_set) fn grip(way: Vector3<f64>, tool: [f64; 3], jaw: Vector3<f64>) -> Start {
        let z = Unit::new_normalize(way);
        let x = jaw.cross(&z);
        let rotation = nalgebra::Rotation3::from_basis_unchecked(&[x, jaw, z.into_inner()]);
        let object_from_tool =
            Pose::from_parts(Translation3::from(tool), UnitQuaternion::from_rotation_matrix(&rotation));
        Start { object_from_tool, preshape: 0, standoff: 0.005 }
    }

    /// A test by the hand of the tests.
    pub(in crate::kinds::caging_set) fn with_jaws<T>(
        parts: &ConvexParts,
        motion: MechanismMotion,
        test: impl FnOnce(&Caged<'_>) -> T,
    ) -> T {
        let (kinematics, gripper, shapes) = jaws();
        let hand = Hand::new(&kinematics, &gripper, |l| {
            shapes.iter().find(|(link, _)| *link == l).map(|(_, parts)| parts)
        });
        let options = CageOptions {
            looseness: 0.3,
            slack: 0.04,
            play: 0.004,
            jitter: 0.003,
            jitter_turn: 0.05,
            needed: 20,
            tries: 100,
        };
        test(&Caged { hand: &hand, parts, motion, options: &options })
    }

    fn attempt(parts: &ConvexParts, motion: MechanismMotion, start: &Start) -> Option<Cage> {
        with_jaws(parts, motion, |caged| caged.attempt(start, Seed::new(1)))
    }

    #[test]
    fn jaws_round_a_drawers_bar_only_push_it_when_they_come_straight() {
        // Straight on, the jaws embrace the bar across the slide: nothing stops it when the hand goes back.
        let start = grip(-Vector3::z(), [0.0, 0.0, 0.16], Vector3::x());
        let cage = attempt(&drawer(), MechanismMotion::Slide, &start).expect("a grip");
        assert_eq!(cage.hold, CageHold::Closing, "{cage:?}");
    }

    #[test]
    fn jaws_across_the_slide_cage_a_bar_and_hold_it() {
        // From above, one jaw between bar and panel: the jaws close along the slide.
        let start = grip(-Vector3::x(), [0.0, 0.0, 0.16], Vector3::z());
        let cage = attempt(&drawer(), MechanismMotion::Slide, &start).expect("a grip");
        assert_eq!(cage.hold, CageHold::Both, "{cage:?}");
        assert!(cage.grasp.contact);
        assert!(cage.loose[0] > cage.closed[0] + 1e-3);
    }

    #[test]
    fn a_hand_beside_the_bar_of_a_door_moves_it_one_way() {
        // The door turns about z; the hand pushes against its face from +y.
        let door = ConvexParts::new(vec![
            box_part(Vector3::new(0.5, 0.02, 0.6)).transformed(&Pose::translation(0.25, 0.0, 0.0)),
        ]);
        let start = grip(-Vector3::y(), [0.4, 0.0, 0.0], Vector3::x());
        let cage = attempt(&door, MechanismMotion::Hinge, &start).expect("a push");
        assert_eq!(cage.hold, CageHold::Closing);
        assert!(!cage.grasp.contact);
        let other = grip(Vector3::y(), [0.4, 0.0, 0.0], Vector3::x());
        assert_eq!(attempt(&door, MechanismMotion::Hinge, &other).map(|c| c.hold), Some(CageHold::Opening));
    }
}
