//! The grasp strategy: approach until the hand touches, stand back, close the fingers until they touch. Tips that attract
//! approach and touch.
//!
//! Thesis section 4.2 (and 3.2 for its use in planning). Everything is kinematic: the object does not move, but a hand
//! whose fingers share one drive is centred on the object, as parallel jaws do when the first jaw touches; one whose only drive closes
//! on a fixed jaw is brought up to that.

use nalgebra::{Point3, Translation3, Unit, UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_core::geom::{ConvexParts, any_within, separation};
use robotc_planning::grasp::tangents;
use serde::{Deserialize, Serialize};

use super::advance::{TOUCH, close_drive, first_touch};
use super::hand::{Hand, Jaws};

/// Where and how a hand comes in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Approach {
    /// A point of the object that the approach ray of the hand goes through, object frame.
    pub(crate) target_in_object: Point3<f64>,
    /// Direction of motion, object frame.
    pub(crate) direction_in_object: Unit<Vector3<f64>>,
    /// Turn of the tool about the direction, radians.
    pub(crate) roll: f64,
    /// Where the ray of the hand starts beside the tool's origin, in the tool frame.
    pub(crate) ray_in_tool: Vector3<f64>,
    /// Position in `Gripper::preshapes`.
    pub(crate) preshape: usize,
    /// How far to stand back from the first touch, metres.
    pub(crate) standoff: f64,
}

/// A hand that is about to come in along its approach direction: any place on that line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Start {
    pub(crate) object_from_tool: Pose,
    pub(crate) preshape: usize,
    pub(crate) standoff: f64,
}

/// A hand closed on the object.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ClosedHand {
    /// Where the tool ended up.
    pub(crate) object_from_tool: Pose,
    /// Finger values.
    pub(crate) closed: Vec<f64>,
    /// `object_from_link` of each of [`Hand::links`].
    pub(crate) object_from_links: Vec<Pose>,
}

/// Why an approach gave no closed hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Miss {
    /// The hand never came near the object.
    NoTouch,
    /// Fewer than two fingers touch when closed, or not all tips that attract.
    FewFingers,
    /// Something other than a finger touches the closed hand's object.
    PalmTouches,
    /// A finger is inside of the object.
    Inside,
}

/// Rounds of closing and centring; the rest gap halves at least with each.
const CENTRING_ROUNDS: usize = 12;

impl Approach {
    /// The tool with its ray on the line through the target point, the start of the ray at that point.
    pub(crate) fn start(&self, approach_in_tool: &Unit<Vector3<f64>>) -> Start {
        let align = UnitQuaternion::rotation_between(approach_in_tool, &self.direction_in_object)
            .unwrap_or_else(|| {
                UnitQuaternion::from_axis_angle(
                    &Unit::new_unchecked(tangents(approach_in_tool).0),
                    std::f64::consts::PI,
                )
            });
        let turn = UnitQuaternion::from_axis_angle(&self.direction_in_object, self.roll) * align;
        let origin = self.target_in_object - turn * self.ray_in_tool;
        let object_from_tool = Pose::from_parts(Translation3::from(origin.coords), turn);
        Start { object_from_tool, preshape: self.preshape, standoff: self.standoff }
    }
}

/// Runs the strategy.
pub(crate) fn close_on(hand: &Hand, object: &ConvexParts, start: &Start) -> Result<ClosedHand, Miss> {
    let (object_from_tool, _) = arrive(hand, object, start)?;
    close_fingers(hand, object, object_from_tool, &hand.gripper().preshapes[start.preshape].values)
}

/// Where the tool and [`Hand::links`] are when the hand, coming in with its preshape, has touched and stood back.
pub(crate) fn arrive(hand: &Hand, object: &ConvexParts, start: &Start) -> Result<(Pose, Vec<Pose>), Miss> {
    let gripper = hand.gripper();
    let open = &gripper.preshapes[start.preshape].values;
    let object_from_palm = start.object_from_tool * gripper.palm_from_tool.inverse();
    let mut object_from_links: Vec<Pose> =
        hand.palm_from_links(open).iter().map(|palm_from_link| object_from_palm * palm_from_link).collect();
    let direction = start.object_from_tool.rotation * gripper.approach_in_tool;
    let travel = first_touch(hand, &object_from_links, &direction, object).ok_or(Miss::NoTouch)?;
    let back = Translation3::from(direction.into_inner() * (travel - start.standoff));
    object_from_links.iter_mut().for_each(|object_from_link| *object_from_link = back * *object_from_link);
    Ok((back * start.object_from_tool, object_from_links))
}

/// Brings tips that attract up to the object: nothing moves but the hand as a whole. Every finger has to come within `give` metres,
/// as far as it and the object yield when they are pulled together.
pub(crate) fn touch_with_tips(
    hand: &Hand,
    object: &ConvexParts,
    start: &Start,
    give: f64,
) -> Result<ClosedHand, Miss> {
    let (object_from_tool, object_from_links) = arrive(hand, object, start)?;
    for (link, object_from_link) in hand.links.iter().zip(&object_from_links) {
        let near = |gap: f64| any_within(object, &Pose::identity(), link.parts, object_from_link, gap);
        if link.is_finger && !near(give) {
            return Err(Miss::FewFingers);
        }
        if !link.is_finger && near(TOUCH) {
            return Err(Miss::PalmTouches);
        }
    }
    let closed = hand.gripper().preshapes[start.preshape].values.clone();
    Ok(ClosedHand { object_from_tool, closed, object_from_links })
}

/// Whether a hand with these finger values stands clear of the object.
pub(crate) fn is_clear(hand: &Hand, object: &ConvexParts, object_from_tool: &Pose, values: &[f64]) -> bool {
    let object_from_palm = object_from_tool * hand.gripper().palm_from_tool.inverse();
    let mut links = hand.links.iter().zip(hand.palm_from_links(values));
    !links.any(|(link, palm_from_link)| {
        any_within(object, &Pose::identity(), link.parts, &(object_from_palm * palm_from_link), 0.0)
    })
}

/// Closes each drive until a link that it moves touches; a drive whose fingers oppose each other is centred.
pub(crate) fn close_fingers(
    hand: &Hand,
    object: &ConvexParts,
    tool: Pose,
    open: &[f64],
) -> Result<ClosedHand, Miss> {
    let gripper = hand.gripper();
    let tool_from_palm = gripper.palm_from_tool.inverse();
    let mut object_from_tool = tool;
    let mut values = open.to_vec();
    for finger in (0..values.len()).filter(|&f| gripper.closing[f] != 0.0) {
        for _ in 0..CENTRING_ROUNDS {
            let object_from_palm = object_from_tool * tool_from_palm;
            close_drive(hand, object, &object_from_palm, &mut values, finger);
            let Some(jaws) = hand.jaws(finger) else { break };
            let rest = rest_gap(hand, jaws, object, &object_from_palm, &values);
            if rest.abs() <= TOUCH {
                break;
            }
            let shift = object_from_palm.rotation * jaws.axis * (0.5 * rest);
            object_from_tool = Translation3::from(shift) * object_from_tool;
        }
    }
    let object_from_palm = object_from_tool * tool_from_palm;
    let object_from_links: Vec<Pose> = hand
        .palm_from_links(&values)
        .iter()
        .map(|palm_from_link| object_from_palm * palm_from_link)
        .collect();
    let touches = |i: usize, gap: f64| {
        any_within(object, &Pose::identity(), hand.links[i].parts, &object_from_links[i], gap)
    };
    let mut touching = 0;
    for (i, link) in hand.links.iter().enumerate() {
        if link.is_finger {
            // Centring may have pushed a finger into what was behind it.
            if touches(i, 0.0) {
                return Err(Miss::Inside);
            }
            touching += usize::from(touches(i, 3.0 * TOUCH));
        } else if touches(i, TOUCH) {
            return Err(Miss::PalmTouches);
        }
    }
    if touching < 2 {
        return Err(Miss::FewFingers);
    }
    Ok(ClosedHand { object_from_tool, closed: values, object_from_links })
}

/// How much farther the second side of a pair of jaws is from the object than the first, metres; the hand moves by half of that along
/// the axis, away from what the second side has still to reach, for both to touch.
fn rest_gap(hand: &Hand, jaws: &Jaws, object: &ConvexParts, object_from_palm: &Pose, values: &[f64]) -> f64 {
    let palm_from_links = hand.palm_from_links(values);
    let [first, second] = jaws.sides.each_ref().map(|links| {
        let gaps = links.iter().map(|&i| link_gap(hand, i, &(object_from_palm * palm_from_links[i]), object));
        gaps.fold(f64::INFINITY, f64::min)
    });
    second - first
}

/// Distance between a link and the object to a thousandth of itself, metres; zero when they touch.
fn link_gap(hand: &Hand, link: usize, object_from_link: &Pose, object: &ConvexParts) -> f64 {
    let mut best = f64::INFINITY;
    for part in hand.links[link].parts {
        let (centre, radius) = part.bounding_sphere();
        let centre_in_object = object_from_link * centre;
        for other in object {
            let (other_centre, other_radius) = other.bounding_sphere();
            if (centre_in_object - other_centre).norm() - radius - other_radius < best {
                best = best.min(separation(other, part, object_from_link, 1e-3).map_or(0.0, |s| s.gap));
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::super::jaws::{fixed_jaw, jaws, jaws_with_knuckles};
    use super::*;
    use robotc_core::geom::box_part;

    #[test]
    fn a_hand_beside_a_box_is_centred_on_it_whatever_hangs_on_its_jaws() {
        let object = ConvexParts::new(vec![box_part(Vector3::new(0.1, 0.03, 0.1))]);
        for (kinematics, gripper, parts) in [jaws(), jaws_with_knuckles()] {
            let part = |l| parts.iter().find(|(link, _)| *link == l).map(|(_, p)| p);
            let hand = Hand::new(&kinematics, &gripper, part);
            for aside in [-0.02, 0.0, 0.015] {
                let tool = Pose::translation(0.0, aside, -0.03);
                let closed = close_fingers(&hand, &object, tool, &[0.04]).unwrap();
                assert!(closed.object_from_tool.translation.y.abs() < TOUCH, "{}", closed.object_from_tool);
                assert!((closed.closed[0] - 0.015).abs() < 2.0 * TOUCH, "{:?}", closed.closed);
            }
        }
    }

    #[test]
    fn a_hand_with_a_fixed_jaw_is_brought_up_to_it() {
        let object = ConvexParts::new(vec![box_part(Vector3::new(0.1, 0.03, 0.1))]);
        let (kinematics, gripper, parts) = fixed_jaw();
        let hand =
            Hand::new(&kinematics, &gripper, |l| parts.iter().find(|(link, _)| *link == l).map(|(_, p)| p));
        for aside in [-0.017, -0.02, -0.024] {
            let closed =
                close_fingers(&hand, &object, Pose::translation(0.0, aside, -0.03), &[0.04]).unwrap();
            // The inner side of the fixed jaw is at the middle of the palm.
            assert!(
                (closed.object_from_tool.translation.y + 0.015).abs() < 4.0 * TOUCH,
                "{}",
                closed.object_from_tool
            );
            assert!((closed.closed[0] - 0.03).abs() < 4.0 * TOUCH, "{:?}", closed.closed);
        }
    }
}
