//! How much nearer two shapes may come to each other.

use nalgebra::Vector3;
use robotc_core::Pose;
use robotc_core::geom::{Otherwise, RoomAsked};

use super::shape::Shape;

/// How far apart two things have to be.
#[derive(Debug, Clone, Copy)]
pub(super) enum Keeps {
    /// Farther than this, metres.
    Margin(f64),
    /// They may be this deep in each other, metres.
    Depth(f64),
}

impl Keeps {
    /// The least distance, metres: negative when they may be in each other.
    pub(super) fn least(self) -> f64 {
        match self {
            Self::Margin(margin) => margin,
            Self::Depth(depth) => -depth,
        }
    }
}

/// A direction, in the frame of the other shape, along which there was a gap when the two were looked at last: nearby there may
/// be one still.
pub(super) type Hint = Option<Vector3<f64>>;

/// How much nearer two shapes may come to each other, at least, metres; `None` when they are too near already.
///
/// More than `far` is not looked for; what is less is as [`Otherwise`] says. `hint` is remembered for the next time.
pub(super) fn between(
    one: &Shape,
    other: &Shape,
    other_from_one: &Pose,
    keeps: Keeps,
    far: f64,
    otherwise: Otherwise,
    hint: &mut Hint,
) -> Option<f64> {
    let least = keeps.least();
    // What is asked of the parts that are still to come.
    let mut enough = far.max(0.0);
    let bound = other.bounds.distance_to(&(other_from_one * one.centre)) - one.radius;
    // A box and a ball that overlap say nothing.
    if bound > 0.0 && bound - least > enough {
        return Some(bound - least);
    }
    let mut left = f64::INFINITY;
    let one_from_other = other_from_one.inverse();
    for part in one.cover() {
        let centre = other_from_one * part.centre;
        for against in other.solids() {
            let (at_least, at_most) = (least.max(0.0), (enough + least).max(0.0));
            let asked = RoomAsked { least: at_least, enough: at_most, otherwise, along: *hint };
            let bound = against.bounds().distance_to(&centre) - part.radius;
            let gap = match bound > at_most {
                true => Some(bound),
                false => against.room(&part.part, other_from_one, &one_from_other, &asked, hint),
            };
            let nearer = match (gap, keeps) {
                (Some(gap), _) => gap - least,
                (None, Keeps::Margin(_)) => return None,
                (None, Keeps::Depth(depth)) => {
                    let deep = against.depth(&part.part, other_from_one, &one_from_other);
                    if deep > depth {
                        return None;
                    }
                    depth - deep
                }
            };
            left = left.min(nearer);
            if left < enough {
                enough = match otherwise {
                    Otherwise::Roughly => left,
                    Otherwise::Anything => 0.0,
                };
            }
        }
    }
    Some(left)
}
