//! Proof that a whole path is free, not only some states of it.

use thiserror::Error;

use crate::edge::{Blocked, BlockedPath, EdgeChecker, Motion};

/// Why a path is not proven free.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum Unproven {
    /// A state of it is invalid.
    #[error("motion {} of the path is blocked", .0.edge)]
    Blocked(BlockedPath),
    /// Bodies come closer than can be told apart from a contact.
    #[error("motion {edge} of the path comes closer than {least} m at {fraction:.4}")]
    TooClose {
        /// The motion from state `edge` to state `edge + 1`.
        edge: usize,
        /// How far along it, 0 to 1.
        fraction: f64,
        /// The clearance that is asked for.
        least: f64,
    },
}

/// Proves that every state of a path is valid, first and last included; returns how many were looked at.
///
/// A valid state with a clearance proves the states around it up to where some point has travelled that far, so that a
/// piece of a motion is free when the travel along it is no more than the clearances of its two ends together; other
/// pieces are halved (conservative advancement: Schwarzer, Saha and Latombe, "Exact collision checking of robot paths",
/// 2002). A state with less clearance than `least` metres ends the attempt: nothing is assumed between samples.
///
/// The checker's resolution plays no part.
pub fn certify_path<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    path: &[Vec<f64>],
    least: f64,
) -> Result<u64, Unproven> {
    let blocked = |edge, blocked| Unproven::Blocked(BlockedPath { edge, blocked });
    let Some(first) = path.first() else { return Ok(0) };
    let mut start_clearance = checker.state(first).map_err(|by| blocked(0, Blocked { fraction: 0.0, by }))?;
    let mut states = 1;
    for (edge, pair) in path.windows(2).enumerate() {
        let mut motion = Motion::new(checker.space(), &pair[0], &pair[1]);
        let travel = checker.travel(motion.difference());
        let end_clearance = motion.check(checker, 1.0).map_err(|b| blocked(edge, b))?;
        states += 1;
        let mut open = vec![((0.0, start_clearance), (1.0, end_clearance))];
        while let Some((start, end)) = open.pop() {
            let (start, end): ((f64, f64), (f64, f64)) = (start, end);
            if (end.0 - start.0) * travel <= start.1 + end.1 {
                continue;
            }
            let fraction = 0.5 * (start.0 + end.0);
            let clearance = motion.check(checker, fraction).map_err(|b| blocked(edge, b))?;
            states += 1;
            if clearance < least {
                return Err(Unproven::TooClose { edge, fraction, least });
            }
            open.push((start, (fraction, clearance)));
            open.push(((fraction, clearance), end));
        }
        start_clearance = end_clearance;
    }
    Ok(states)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toy::Toy;

    #[test]
    fn a_path_with_room_is_proven_and_a_thin_wall_is_found() {
        let mut toy = Toy::wall(1e9);
        let around = [vec![1.0, 1.0], vec![2.0, 9.5], vec![8.0, 9.5], vec![9.0, 1.0]];
        let states = certify_path(&mut toy, &around, 1e-6).unwrap();
        assert!(states < 200, "{states}");
        let through = [vec![1.0, 1.0], vec![9.0, 1.0]];
        assert!(matches!(certify_path(&mut toy, &through, 1e-6), Err(Unproven::Blocked(_))));
    }

    #[test]
    fn touching_is_not_proven() {
        // Along the face of the wall at x = 4.
        let mut toy = Toy::wall(1e9);
        let along = [vec![4.0 - 1e-9, 0.5], vec![4.0 - 1e-9, 8.0]];
        assert!(matches!(certify_path(&mut toy, &along, 1e-6), Err(Unproven::TooClose { .. })));
    }
}
