//! A controller's library that holds a generated solver: the file `kr6.rs` was written by
//! `robotc ik kr6.urdf --base base --tip tool -o kr6.rs` and dropped in as it is. Nothing of robotc is linked.

#![no_std]

#[rustfmt::skip]
pub mod kr6;

use kr6::{Frame, Solutions, VARIABLES};

/// Limits of the joints, radians.
pub const LIMITS: [[f64; 2]; VARIABLES] =
    [[-2.97, 2.97], [-3.32, 0.79], [-2.09, 2.72], [-3.23, 3.23], [-2.09, 2.09], [-6.11, 6.11]];

/// The joint vector within limits that brings the tool to a pose and is nearest to `now`, if there is one; its largest step counts.
/// `room` is where the solver puts its answers.
pub fn nearest(
    base_from_tip: &Frame,
    now: &[f64; VARIABLES],
    room: &mut Solutions,
) -> Option<[f64; VARIABLES]> {
    kr6::solve(base_from_tip, &[], room);
    let mut best = None;
    let mut least = f64::INFINITY;
    for values in room.as_slice() {
        let mut joints = *values;
        let mut step = 0.0;
        for ((x, now), [low, high]) in joints.iter_mut().zip(now).zip(LIMITS) {
            // The same angle, a turn on or back, that is within limits and nearest.
            let turns = [*x - core::f64::consts::TAU, *x, *x + core::f64::consts::TAU];
            let inside = turns.into_iter().filter(|x| (low..=high).contains(x));
            let Some(near) = inside.min_by(|a, b| (a - now).abs().total_cmp(&(b - now).abs())) else {
                step = f64::INFINITY;
                break;
            };
            *x = near;
            step = f64::max(step, (near - now).abs());
        }
        if step < least {
            (best, least) = (Some(joints), step);
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_motion_of_the_tool_is_a_small_motion_of_the_joints() {
        let mut now = [0.3, -1.2, 1.4, 0.5, 0.9, 4.0];
        let mut room = Solutions::new();
        for step in 0..200 {
            let turn = f64::from(step) * 0.002;
            let wanted = [0.3 + turn, -1.2 - 0.5 * turn, 1.4, 0.5 - turn, 0.9, 4.0 + 2.0 * turn];
            let pose = kr6::forward(&wanted);
            let found = nearest(&pose, &now, &mut room).expect("the pose is that of joints within limits");
            assert!(kr6::forward(&found).distance(&pose) < 1e-9);
            assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {wanted:?}");
            now = found;
        }
        let out_of_reach = Frame { position: [9.0, 0.0, 0.0], ..kr6::forward(&now) };
        assert_eq!(nearest(&out_of_reach, &now, &mut room), None);
    }
}
