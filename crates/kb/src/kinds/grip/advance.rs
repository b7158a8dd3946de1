//! How far a hand may move before it touches: conservative advancement, so that nothing is ever jumped over.
//!
//! Each step takes a direction along which hand and object are apart and the speed at which the motion uses that gap up.
//! Straight motions use it up evenly, and a motion that does not go against the direction never touches at all; for
//! turning fingers a bound on the acceleration makes the step safe (after Mirtich, "Impulse-based dynamic
//! simulation of rigid body systems", 1996).

use nalgebra::{Translation3, Unit, Vector3};
use robotc_core::Pose;
use robotc_core::geom::{ConvexPart, ConvexParts, separation};

use super::hand::Hand;

/// A gap smaller than this is a touch, metres.
pub(crate) const TOUCH: f64 = 3e-4;
/// Steps of an advance before it is taken as touching; each covers most of the gap that is left.
const MOST_STEPS: usize = 64;
/// How far below the distance a gap may be: a rough gap costs a step more now and then, a precise one costs every step.
const ROUGH: f64 = 0.05;

/// How far along `direction` the hand can move, from wherever on that line `object_from_links` are (the travel may be
/// negative), until some link is within [`TOUCH`] of the object; `None` when it passes by.
pub(crate) fn first_touch(
    hand: &Hand,
    object_from_links: &[Pose],
    direction: &Unit<Vector3<f64>>,
    object: &ConvexParts,
) -> Option<f64> {
    // Pairs of parts by the travel at which their bounding spheres meet.
    let mut pairs: Vec<(f64, &Pose, &ConvexPart, &ConvexPart)> = Vec::new();
    for (link, object_from_link) in hand.links.iter().zip(object_from_links) {
        for part in link.parts {
            let (centre, radius) = part.bounding_sphere();
            let centre_in_object = object_from_link * centre;
            for other in object {
                let (other_centre, other_radius) = other.bounding_sphere();
                let ahead = other_centre - centre_in_object;
                let along = ahead.dot(direction);
                let reach = radius + other_radius + TOUCH;
                let beside = ahead.norm_squared() - along * along;
                if beside < reach * reach {
                    let meet = along - (reach * reach - beside).sqrt();
                    pairs.push((meet, object_from_link, part, other));
                }
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut first = f64::INFINITY;
    for (meet, object_from_link, part, other) in pairs {
        if meet >= first {
            break;
        }
        let mut travel = meet;
        for step in 0.. {
            let moved = Translation3::from(direction.into_inner() * travel) * object_from_link;
            let Some(apart) = separation(other, part, &moved, ROUGH).filter(|s| s.gap >= TOUCH) else {
                break;
            };
            let speed = -direction.dot(&apart.direction);
            travel += (apart.gap - 0.5 * TOUCH) / speed;
            if speed <= 1e-9 || travel >= first {
                travel = f64::INFINITY;
                break;
            }
            if step == MOST_STEPS {
                break;
            }
        }
        first = first.min(travel);
    }
    first.is_finite().then_some(first)
}

/// Closes one drive until one of the links that it moves is within [`TOUCH`] of the object, or its range ends.
pub(crate) fn close_drive(
    hand: &Hand,
    object: &ConvexParts,
    object_from_palm: &Pose,
    values: &mut [f64],
    finger: usize,
) {
    let (low, high) = hand.range(finger);
    let sign = hand.gripper().closing[finger].signum();
    let end = if sign > 0.0 { high } else { low };
    for _ in 0..MOST_STEPS {
        let left = (end - values[finger]) * sign;
        if left <= 0.0 {
            return;
        }
        match safe_step(hand, object, object_from_palm, values, finger, left) {
            None => return,
            Some(step) if step < left => values[finger] += sign * step,
            Some(_) => {
                values[finger] = end;
                return;
            }
        }
    }
}

/// How far a drive can close, at most `left`, so that its links stay clear of the object; `None` when one touches.
fn safe_step(
    hand: &Hand,
    object: &ConvexParts,
    object_from_palm: &Pose,
    values: &[f64],
    finger: usize,
    left: f64,
) -> Option<f64> {
    let sign = hand.gripper().closing[finger].signum();
    let palm_from_links = hand.palm_from_links(values);
    let twists = hand.twists(values, finger);
    let mut step = left;
    for travel in hand.travels(finger) {
        let object_from_link = object_from_palm * palm_from_links[travel.link];
        // The motion of the link for one unit of closing, object frame, at the palm's origin.
        let (turn, shift) = &twists[travel.link];
        let turn = object_from_palm.rotation * turn * sign;
        let shift = object_from_palm.rotation * shift * sign;
        let palm = object_from_palm.translation.vector;
        for part in hand.links[travel.link].parts {
            let (centre, radius) = part.bounding_sphere();
            let centre_in_object = object_from_link * centre;
            for other in object {
                let (other_centre, other_radius) = other.bounding_sphere();
                let between = (centre_in_object - other_centre).norm() - radius - other_radius;
                if between - TOUCH >= travel.most_speed * step {
                    continue;
                }
                let apart = separation(other, part, &object_from_link, ROUGH).filter(|s| s.gap >= TOUCH)?;
                // The fastest point of the part against the direction: a corner, because velocity is linear in place.
                let lever = turn.cross(&apart.direction);
                let corner = part.support(&object_from_link.rotation.inverse_transform_vector(&lever));
                let arm = (object_from_link * corner).coords - palm;
                let speed = (lever.dot(&arm) - apart.direction.dot(&shift)).max(0.0);
                let gap = apart.gap - 0.5 * TOUCH;
                let bend = 2.0 * travel.most_acceleration * gap;
                step = step.min(2.0 * gap / (speed + (speed * speed + bend).sqrt()).max(f64::MIN_POSITIVE));
            }
        }
    }
    Some(step)
}
