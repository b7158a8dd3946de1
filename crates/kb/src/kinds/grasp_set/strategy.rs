//! The grasp strategy: approach until the hand touches, stand back, close the fingers until they touch.
//!
//! Thesis section 4.2 (and 3.2 for its use in planning). Everything is kinematic: the object does not move, but a hand
//! whose fingers share one drive is centred on the object, as parallel jaws do when the first jaw touches.

use nalgebra::{Point3, Translation3, Unit, UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_core::geom::{self, ConvexParts};

use super::closure::tangents;
use super::hand::Hand;

/// Where and how a hand comes in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Approach {
    /// A point of the object that the tool axis goes through, object frame.
    pub(super) target_in_object: Point3<f64>,
    /// Direction of motion, object frame.
    pub(super) direction_in_object: Unit<Vector3<f64>>,
    /// Turn of the tool about the direction, radians.
    pub(super) roll: f64,
    /// Position in `Gripper::preshapes`.
    pub(super) preshape: usize,
    /// How far to stand back from the first touch, metres.
    pub(super) standoff: f64,
}

/// A hand closed on the object.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ClosedHand {
    /// Where the tool ended up.
    pub(super) object_from_tool: Pose,
    /// Finger values.
    pub(super) closed: Vec<f64>,
    /// `object_from_link` of each of [`Hand::links`].
    pub(super) object_from_links: Vec<Pose>,
}

/// Why an approach gave no closed hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Miss {
    /// The hand never came near the object.
    NoTouch,
    /// Fewer than two fingers touch when closed.
    FewFingers,
    /// After centring, something other than a finger touches.
    PalmTouches,
    /// After centring, a finger is inside of the object.
    Inside,
}

/// The object to be grasped.
pub(super) struct Target<'a> {
    /// Its convex parts in the object frame.
    pub(super) parts: &'a ConvexParts,
    /// Centre of its bounding ball, object frame.
    pub(super) centre: Point3<f64>,
    /// Radius of that ball, metres.
    pub(super) radius: f64,
}

/// A gap smaller than this is a touch, metres.
pub(super) const TOUCH: f64 = 3e-4;
/// Steps of an advance before it is taken as grazing; each step covers most of the free distance.
const MOST_STEPS: usize = 48;
/// Rounds of closing and centring; the rest gap halves at least with each.
const CENTRING_ROUNDS: usize = 12;

/// Runs the strategy.
pub(super) fn close_on(hand: &Hand, target: &Target, approach: &Approach) -> Result<ClosedHand, Miss> {
    let gripper = hand.gripper();
    let open = &gripper.preshapes[approach.preshape].values;
    let palm_from_links = hand.palm_from_links(open);
    let tool_from_palm = gripper.palm_from_tool.inverse();
    let start = tool_at(approach, &gripper.approach_in_tool);

    // Far enough back that nothing can touch, then forward by the free distance until something does.
    let reach = palm_from_links
        .iter()
        .zip(&hand.links)
        .map(|(pose, l)| {
            l.parts.points().map(|p| (tool_from_palm * pose * p).coords.norm()).fold(0.0, f64::max)
        })
        .fold(0.0, f64::max);
    let span = (approach.target_in_object - target.centre).norm() + target.radius + reach;
    let direction = approach.direction_in_object.into_inner();
    let at = |travel: f64| Translation3::from(direction * travel) * start;
    let mut travel = -span;
    let mut touched = false;
    for _ in 0..MOST_STEPS {
        let object_from_palm = at(travel) * tool_from_palm;
        let free = gap(hand, &object_from_palm, &palm_from_links, target, |_| true, f64::INFINITY);
        if free < TOUCH {
            touched = true;
            break;
        }
        travel += free - 0.5 * TOUCH;
        if travel > span {
            return Err(Miss::NoTouch);
        }
    }
    if !touched {
        return Err(Miss::NoTouch);
    }
    close_fingers(hand, target, at(travel - approach.standoff), open)
}

/// The tool with its approach axis on the line through the target point and its origin at that point.
fn tool_at(approach: &Approach, approach_in_tool: &Unit<Vector3<f64>>) -> Pose {
    let align = UnitQuaternion::rotation_between(approach_in_tool, &approach.direction_in_object)
        .unwrap_or_else(|| {
            UnitQuaternion::from_axis_angle(
                &Unit::new_unchecked(tangents(approach_in_tool).0),
                std::f64::consts::PI,
            )
        });
    let roll = UnitQuaternion::from_axis_angle(&approach.direction_in_object, approach.roll);
    Pose::from_parts(Translation3::from(approach.target_in_object.coords), roll * align)
}

/// Closes each drive until a link that it moves touches; a drive with several fingers is centred.
fn close_fingers(hand: &Hand, target: &Target, tool: Pose, open: &[f64]) -> Result<ClosedHand, Miss> {
    let gripper = hand.gripper();
    let tool_from_palm = gripper.palm_from_tool.inverse();
    let mut object_from_tool = tool;
    let mut values = open.to_vec();
    for finger in (0..values.len()).filter(|&f| gripper.closing[f] != 0.0) {
        let opposed = hand.links.iter().filter(|l| l.is_finger && l.moved_by.contains(&finger)).count() > 1
            && fingers_oppose(hand, finger);
        let rounds = if opposed { CENTRING_ROUNDS } else { 1 };
        for _ in 0..rounds {
            advance(hand, target, &(object_from_tool * tool_from_palm), &mut values, finger);
            if !opposed {
                break;
            }
            match rest_gap(hand, target, &(object_from_tool * tool_from_palm), &values, finger) {
                Some((shift, rest)) if rest > TOUCH => {
                    object_from_tool = Translation3::from(shift * (0.5 * rest)) * object_from_tool;
                }
                _ => break,
            }
        }
    }
    let object_from_palm = object_from_tool * tool_from_palm;
    let palm_from_links = hand.palm_from_links(&values);
    let clear =
        gap(hand, &object_from_palm, &palm_from_links, target, |i| !hand.links[i].is_finger, 2.0 * TOUCH);
    if clear < TOUCH {
        return Err(Miss::PalmTouches);
    }
    let object_from_links: Vec<Pose> = palm_from_links.iter().map(|p| object_from_palm * p).collect();
    let mut touching = 0;
    for i in (0..hand.links.len()).filter(|&i| hand.links[i].is_finger) {
        let free = link_gap(hand, i, &object_from_links[i], target, 4.0 * TOUCH);
        // Centring may have pushed a finger into what was behind it.
        if free <= 0.0 {
            return Err(Miss::Inside);
        }
        touching += usize::from(free < 3.0 * TOUCH);
    }
    if touching < 2 {
        return Err(Miss::FewFingers);
    }
    Ok(ClosedHand { object_from_tool, closed: values, object_from_links })
}

/// Closes one drive by the free distance until one of its links touches or its range ends.
fn advance(hand: &Hand, target: &Target, object_from_palm: &Pose, values: &mut [f64], finger: usize) {
    let (low, high) = hand.range(finger);
    let sign = hand.gripper().closing[finger].signum();
    let end = if sign > 0.0 { high } else { low };
    let per_unit = hand.travel_bound(finger).max(1e-9);
    for _ in 0..MOST_STEPS {
        let palm_from_links = hand.palm_from_links(values);
        let moved = |i: usize| hand.links[i].moved_by.contains(&finger);
        let free = gap(hand, object_from_palm, &palm_from_links, target, moved, f64::INFINITY);
        if free < TOUCH || values[finger] == end {
            return;
        }
        let next = values[finger] + sign * (free - 0.5 * TOUCH) / per_unit;
        values[finger] = if sign > 0.0 { next.min(end) } else { next.max(end) };
    }
}

/// Whether links moved by one drive close towards each other, as jaws do.
fn fingers_oppose(hand: &Hand, finger: usize) -> bool {
    let directions = closing_directions(hand, finger);
    directions.iter().enumerate().any(|(i, (_, a))| directions[..i].iter().any(|(_, b)| a.dot(b) < -0.5))
}

/// Finger links of a drive with the direction in which they close, in the palm frame, at the middle of the range.
fn closing_directions(hand: &Hand, finger: usize) -> Vec<(usize, Vector3<f64>)> {
    let gripper = hand.gripper();
    let (low, high) = hand.range(finger);
    let (sign, step) = (gripper.closing[finger].signum(), 0.01 * (high - low));
    let mut values = gripper.preshapes[0].values.clone();
    values[finger] = 0.5 * (low + high);
    let before = hand.palm_from_links(&values);
    values[finger] += sign * step;
    let after = hand.palm_from_links(&values);
    (0..hand.links.len())
        .filter(|&i| hand.links[i].is_finger && hand.links[i].moved_by.contains(&finger))
        .filter_map(|i| {
            let centre = hand.links[i].parts.bounds()?.centre();
            let moved = after[i] * centre - before[i] * centre;
            Some((i, moved.try_normalize(1e-12)?))
        })
        .collect()
}

/// How far the finger that does not touch yet is away, and which way the hand must go to share that gap.
fn rest_gap(
    hand: &Hand,
    target: &Target,
    object_from_palm: &Pose,
    values: &[f64],
    finger: usize,
) -> Option<(Vector3<f64>, f64)> {
    let palm_from_links = hand.palm_from_links(values);
    let mut nearest: Option<(Vector3<f64>, f64)> = None;
    let mut farthest: f64 = 0.0;
    for (i, closing_in_palm) in closing_directions(hand, finger) {
        let free = link_gap(hand, i, &(object_from_palm * palm_from_links[i]), target, f64::INFINITY);
        if nearest.is_none_or(|(_, best)| free < best) {
            nearest = Some((object_from_palm.rotation * -closing_in_palm, free));
        }
        farthest = farthest.max(free);
    }
    // The touching finger gives way: the hand moves against its closing direction.
    nearest.map(|(away, free)| (away, farthest - free))
}

/// Smallest distance between the chosen hand links and the object, metres; values above `limit` may be any bound above it.
fn gap(
    hand: &Hand,
    object_from_palm: &Pose,
    palm_from_links: &[Pose],
    target: &Target,
    chosen: impl Fn(usize) -> bool,
    limit: f64,
) -> f64 {
    let mut best = limit;
    for i in (0..hand.links.len()).filter(|&i| chosen(i)) {
        best = best.min(link_gap(hand, i, &(object_from_palm * palm_from_links[i]), target, best));
    }
    best
}

fn link_gap(hand: &Hand, link: usize, object_from_link: &Pose, target: &Target, limit: f64) -> f64 {
    let mut best = limit;
    for a in hand.links[link].parts {
        let (centre, radius) = a.bounding_sphere();
        let centre_in_object = object_from_link * centre;
        for b in target.parts {
            let (other, other_radius) = b.bounding_sphere();
            if (centre_in_object - other).norm() - radius - other_radius >= best {
                continue;
            }
            best = best.min(geom::distance(a, object_from_link, b, &Pose::identity()).distance);
        }
    }
    best
}
