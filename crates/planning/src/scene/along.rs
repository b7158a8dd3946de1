//! Whether a timed motion is free, at every moment of it.
//!
//! As for an edge, each pair that has to stay apart is looked at as often as its own travel and its own room ask for (see
//! [`pairs`](super::pairs)). What the joints do in between is not straight, so that travel follows from how far each of them moves,
//! back and forth added up.

use robotc_core::Trajectory;
use robotc_core::geom::Otherwise;

use super::RobotChecker;
use super::checker::ROOM;
use crate::edge::Obstruction;
use crate::space::Space;

/// A trajectory, with how far each of its degrees of freedom has moved until each knot.
pub(crate) struct Along<'t> {
    trajectory: &'t Trajectory,
    /// For each knot, one for each degree of freedom; flat.
    moved: Vec<f64>,
}

/// A stretch of time with the pairs that are open in it, as a range of those that are listed.
#[derive(Clone)]
struct Stretch {
    start: f64,
    end: f64,
    pairs: std::ops::Range<usize>,
}

impl<'t> Along<'t> {
    pub(crate) fn new(trajectory: &'t Trajectory) -> Self {
        let mut moved = vec![0.0; trajectory.dofs().len()];
        for knot in 1..trajectory.times().len() {
            for dof in 0..trajectory.dofs().len() {
                let before = moved[moved.len() - trajectory.dofs().len()];
                moved.push(before + Cubic::of(trajectory, knot - 1, dof).moved(f64::INFINITY));
            }
        }
        Self { trajectory, moved }
    }

    /// How far each degree of freedom has moved until `time`.
    fn moved_until(&self, time: f64, moved: &mut Vec<f64>) {
        let dofs = self.trajectory.dofs().len();
        let knot = self.trajectory.knot_before(time);
        let since = time - self.trajectory.times()[knot];
        moved.clear();
        moved.extend_from_slice(&self.moved[knot * dofs..(knot + 1) * dofs]);
        if since > 0.0 && knot + 1 < self.trajectory.times().len() {
            for (dof, moved) in moved.iter_mut().enumerate() {
                *moved += Cubic::of(self.trajectory, knot, dof).moved(since);
            }
        }
    }

    /// When the motion is out of bounds, if it ever is.
    fn leaves(&self, space: &Space) -> Option<f64> {
        let (times, knots) = (self.trajectory.times(), self.trajectory.knots());
        for (knot, time) in times.iter().enumerate() {
            if !space.contains(&knots[knot].positions) {
                return Some(*time);
            }
            if knot + 1 == times.len() {
                break;
            }
            for (dof, axis) in space.axes().iter().enumerate().filter(|(_, axis)| !axis.wraps) {
                let cubic = Cubic::of(self.trajectory, knot, dof);
                let beyond = |t: &f64| !(axis.lower..=axis.upper).contains(&cubic.at(*t));
                if let Some(turn) = cubic.turns().find(beyond) {
                    return Some(time + turn);
                }
            }
        }
        None
    }
}

/// One degree of freedom between two knots: p0 + v0 t + c2 t^2 + c3 t^3.
struct Cubic {
    p0: f64,
    v0: f64,
    c2: f64,
    c3: f64,
    duration: f64,
}

impl Cubic {
    fn of(trajectory: &Trajectory, knot: usize, dof: usize) -> Self {
        let (times, knots) = (trajectory.times(), trajectory.knots());
        let duration = times[knot + 1] - times[knot];
        let [p0, v0, c2, c3] = robotc_core::trajectory::cubic(&knots[knot], &knots[knot + 1], dof, duration);
        Self { p0, v0, c2, c3, duration }
    }

    fn at(&self, t: f64) -> f64 {
        self.p0 + t * (self.v0 + t * (self.c2 + t * self.c3))
    }

    /// Times strictly within the piece at which the velocity changes its sign, ascending.
    fn turns(&self) -> impl Iterator<Item = f64> + use<> {
        // v0 + 2 c2 t + 3 c3 t^2, by the form that does not subtract what is nearly equal.
        let (a, b, c) = (3.0 * self.c3, self.c2, self.v0);
        let q = -(b + b.signum() * (b * b - a * c).max(0.0).sqrt());
        let roots = if b * b < a * c { [f64::NAN; 2] } else { [q / a, c / q] };
        let ascending = if roots[0] > roots[1] { [roots[1], roots[0]] } else { roots };
        let duration = self.duration;
        ascending.into_iter().filter(move |t| 0.0 < *t && *t < duration)
    }

    /// How far it moves from the start of the piece until `t`, or the end of the piece.
    fn moved(&self, t: f64) -> f64 {
        let end = t.min(self.duration);
        let mut at = self.p0;
        let mut moved = 0.0;
        for turn in self.turns().take_while(|turn| *turn < end).chain([end]) {
            let next = self.at(turn);
            moved += (next - at).abs();
            at = next;
        }
        moved
    }
}

impl RobotChecker<'_> {
    /// Whether all of a motion is free, up to half of the resolution between states that are looked at; if not, a time at which it
    /// is not, and why.
    pub(crate) fn all_along(&mut self, along: &Along<'_>) -> Result<(), (f64, Obstruction)> {
        if let Some(time) = along.leaves(self.space) {
            return Err((time, Obstruction::Bounds));
        }
        let slack = 0.5 * self.resolution;
        let farthest = ROOM * self.resolution;
        let whole = along.trajectory.duration();
        let (mut at, mut before, mut here, mut after) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut travels, mut back) = (Vec::new(), Vec::new());
        let mut open: Vec<u32> = (0..self.pairs.len() as u32).collect();
        // The start and then the end stand for the whole motion where they can.
        let ends = [0.0, whole].map(|end| (end, Stretch { start: 0.0, end: whole, pairs: 0..open.len() }));
        let mut stretches = std::collections::VecDeque::from(ends);
        while let Some((time, Stretch { start, end, pairs })) = stretches.pop_front() {
            along.moved_until(start, &mut before);
            along.moved_until(time, &mut here);
            along.moved_until(end, &mut after);
            before.iter_mut().zip(&here).for_each(|(before, here)| *before = here - *before);
            after.iter_mut().zip(&here).for_each(|(after, here)| *after -= here);
            self.pairs.travels(&before, &mut back);
            self.pairs.travels(&after, &mut travels);
            travels.iter_mut().zip(&back).for_each(|(travel, back)| *travel = travel.max(*back));
            along.trajectory.positions_at(time, &mut at);
            self.place(&at);
            let left = open.len();
            for i in pairs {
                let pair = open[i] as usize;
                let needed = travels[self.pairs.row(pair)] - slack;
                // Room that would not be enough is not worth finding.
                let far = if needed <= farthest { needed } else { 0.0 };
                let room =
                    self.pairs.room(self.scene, &self.rules, &self.poses, pair, far, Otherwise::Anything);
                if room.map_err(|touch| (time, touch.into()))? < needed {
                    open.push(pair as u32);
                }
            }
            let rest = left..open.len();
            if time == 0.0 && whole > 0.0 {
                // The end is asked about what the start leaves open.
                if let Some((_, last)) = stretches.front_mut() {
                    last.pairs = rest;
                }
            } else if !rest.is_empty() {
                let halves = match time == whole {
                    true => vec![(start, end)],
                    false => vec![(start, time), (time, end)],
                };
                for (start, end) in halves {
                    let stretch = Stretch { start, end, pairs: rest.clone() };
                    stretches.push_back((0.5 * (start + end), stretch));
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use robotc_core::ids::Idx;
    use robotc_core::{DofIdx, trajectory::TrajectoryPoint};

    proptest! {
        #![proptest_config(crate::properties::cases(100))]
        #[test]
        fn what_moved_is_the_sum_of_small_steps(
            knots in prop::collection::vec((0.2..2.0f64, -3.0..3.0f64, -3.0..3.0f64), 2..6),
        ) {
            let mut times = vec![0.0];
            times.extend(knots[1..].iter().scan(0.0, |sum, k| { *sum += k.0; Some(*sum) }));
            let knot = |k: &(f64, f64, f64)| TrajectoryPoint {
                positions: vec![k.1], velocities: vec![k.2], accelerations: vec![0.0],
            };
            let points = knots.iter().map(knot).collect();
            let trajectory = Trajectory::new(vec![DofIdx::new(0)], vec!["j".into()], times, points).unwrap();
            let along = Along::new(&trajectory);
            let (mut sum, mut farthest) = (0.0, f64::NEG_INFINITY);
            let (mut last, mut at, mut moved) = (trajectory.start()[0], Vec::new(), Vec::new());
            for i in 0..=4000 {
                let time = trajectory.duration() * f64::from(i) / 4000.0;
                trajectory.positions_at(time, &mut at);
                prop_assert_eq!(&at, &trajectory.sample(time).positions);
                sum += (at[0] - last).abs();
                last = at[0];
                farthest = farthest.max(last);
                along.moved_until(time, &mut moved);
                prop_assert!((moved[0] - sum).abs() < 0.02, "{} {sum} at {time}", moved[0]);
            }
            for (bound, inside) in [(farthest + 0.01, true), (farthest - 0.01, false)] {
                let space = Space::new(vec![crate::space::Axis::bounded(-100.0, bound)]);
                prop_assert!(along.leaves(&space).is_none() || !inside);
                prop_assert!(along.leaves(&space).is_some() || inside);
            }
        }
    }
}
