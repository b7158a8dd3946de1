//! Timed joint motion.

use thiserror::Error;

use crate::ids::DofIdx;

/// Position, velocity and acceleration of the moving degrees of freedom at one time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TrajectoryPoint {
    /// Radians or metres.
    pub positions: Vec<f64>,
    /// Per second.
    pub velocities: Vec<f64>,
    /// Per second squared.
    pub accelerations: Vec<f64>,
}

/// Why knots make no trajectory.
#[derive(Debug, Clone, Error, PartialEq, Eq)]
pub enum TrajectoryError {
    /// Nothing to follow.
    #[error("a trajectory needs at least one knot")]
    Empty,
    /// Tables of different lengths.
    #[error("times, positions, velocities and accelerations differ in length")]
    Shape,
    /// Time stands still or runs backwards, or does not start at zero.
    #[error("times must start at zero and grow")]
    Times,
}

/// Joint values over time: knots with position and velocity, cubic between them.
///
/// The degrees of freedom need not be all of a robot: a trajectory of the arm leaves the fingers where they are.
/// Values of continuous joints are not wrapped, so that they change without jumps.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    dofs: Vec<DofIdx>,
    names: Vec<String>,
    times: Vec<f64>,
    knots: Vec<TrajectoryPoint>,
}

impl Trajectory {
    /// A trajectory through `knots` at `times` (seconds, from zero, growing). `names` are the joints of `dofs`.
    ///
    /// The acceleration of a knot is the one just after it (before it, for the last).
    pub fn new(
        dofs: Vec<DofIdx>,
        names: Vec<String>,
        times: Vec<f64>,
        knots: Vec<TrajectoryPoint>,
    ) -> Result<Self, TrajectoryError> {
        if times.is_empty() {
            return Err(TrajectoryError::Empty);
        }
        let width = dofs.len();
        let fits = |k: &TrajectoryPoint| {
            k.positions.len() == width && k.velocities.len() == width && k.accelerations.len() == width
        };
        if names.len() != width || times.len() != knots.len() || !knots.iter().all(fits) {
            return Err(TrajectoryError::Shape);
        }
        if times[0] != 0.0 || !times.windows(2).all(|w| w[0] < w[1]) {
            return Err(TrajectoryError::Times);
        }
        Ok(Self { dofs, names, times, knots })
    }

    /// Degrees of freedom that move, in the order of all values.
    pub fn dofs(&self) -> &[DofIdx] {
        &self.dofs
    }

    /// Joint names, in the order of [`dofs`](Self::dofs).
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Times of the knots, seconds from the start.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The knots, one for each time.
    pub fn knots(&self) -> &[TrajectoryPoint] {
        &self.knots
    }

    /// Seconds from start to end.
    pub fn duration(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// Positions at the start.
    pub fn start(&self) -> &[f64] {
        &self.knots[0].positions
    }

    /// Positions at the end.
    pub fn end(&self) -> &[f64] {
        &self.knots[self.knots.len() - 1].positions
    }

    /// State at `time` seconds; before the start and after the end the robot rests there.
    pub fn sample(&self, time: f64) -> TrajectoryPoint {
        let last = self.knots.len() - 1;
        if time < 0.0 || time > self.duration() || last == 0 {
            let knot = &self.knots[if time < 0.0 { 0 } else { last }];
            let rest = vec![0.0; self.dofs.len()];
            let positions = knot.positions.clone();
            return TrajectoryPoint { positions, velocities: rest.clone(), accelerations: rest };
        }
        let knot = self.knot_before(time).min(last - 1);
        let (a, b) = (&self.knots[knot], &self.knots[knot + 1]);
        let t = time - self.times[knot];
        let mut point = TrajectoryPoint::default();
        for i in 0..self.dofs.len() {
            let [p0, v0, c2, c3] = cubic(a, b, i, self.times[knot + 1] - self.times[knot]);
            point.positions.push(p0 + t * (v0 + t * (c2 + t * c3)));
            point.velocities.push(v0 + t * (2.0 * c2 + 3.0 * t * c3));
            point.accelerations.push(2.0 * c2 + 6.0 * t * c3);
        }
        point
    }

    /// Positions of [`sample`](Self::sample) alone, into memory that is there already.
    pub fn positions_at(&self, time: f64, positions: &mut Vec<f64>) {
        positions.clear();
        let last = self.knots.len() - 1;
        if time < 0.0 || time > self.duration() || last == 0 {
            let knot = &self.knots[if time < 0.0 { 0 } else { last }];
            positions.extend_from_slice(&knot.positions);
            return;
        }
        let knot = self.knot_before(time).min(last - 1);
        let (a, b) = (&self.knots[knot], &self.knots[knot + 1]);
        let (t, h) = (time - self.times[knot], self.times[knot + 1] - self.times[knot]);
        positions.extend((0..self.dofs.len()).map(|i| {
            let [p0, v0, c2, c3] = cubic(a, b, i, h);
            p0 + t * (v0 + t * (c2 + t * c3))
        }));
    }

    /// The last knot that is not after `time`; the first one before the start.
    pub fn knot_before(&self, time: f64) -> usize {
        self.times.partition_point(|&t| t <= time).saturating_sub(1)
    }

    /// Times from zero in steps of `period` seconds (must be positive), and the end.
    pub fn sample_times(&self, period: f64) -> Vec<f64> {
        assert!(period > 0.0, "a sampling period is positive");
        let duration = self.duration();
        let count = (duration / period).floor() as usize;
        let mut times: Vec<f64> = (0..=count).map(|i| i as f64 * period).filter(|&t| t < duration).collect();
        times.push(duration);
        times
    }
}

/// Between two knots that are `duration` seconds apart, one degree of freedom is at p0 + v0 t + c2 t^2 + c3 t^3: these four.
pub fn cubic(from: &TrajectoryPoint, to: &TrajectoryPoint, dof: usize, duration: f64) -> [f64; 4] {
    let slope = (to.positions[dof] - from.positions[dof]) / duration;
    let (v0, v1) = (from.velocities[dof], to.velocities[dof]);
    let c2 = (3.0 * slope - 2.0 * v0 - v1) / duration;
    let c3 = (v0 + v1 - 2.0 * slope) / (duration * duration);
    [from.positions[dof], v0, c2, c3]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ids::Idx;

    fn knot(p: f64, v: f64, a: f64) -> TrajectoryPoint {
        TrajectoryPoint { positions: vec![p], velocities: vec![v], accelerations: vec![a] }
    }

    fn trajectory(times: Vec<f64>, knots: Vec<TrajectoryPoint>) -> Result<Trajectory, TrajectoryError> {
        Trajectory::new(vec![DofIdx::new(0)], vec!["j".into()], times, knots)
    }

    #[test]
    fn constant_acceleration_is_followed_exactly() {
        let t = trajectory(
            vec![0.0, 1.0, 2.0],
            vec![knot(0.0, 0.0, 2.0), knot(1.0, 2.0, -2.0), knot(2.0, 0.0, -2.0)],
        )
        .unwrap();
        for (time, p, v, a) in [(0.25, 0.0625, 0.5, 2.0), (1.5, 1.75, 1.0, -2.0), (2.0, 2.0, 0.0, -2.0)] {
            let s = t.sample(time);
            assert!((s.positions[0] - p).abs() < 1e-12, "{time}");
            assert!((s.velocities[0] - v).abs() < 1e-12, "{time}");
            assert!((s.accelerations[0] - a).abs() < 1e-12, "{time}");
        }
        assert_eq!(t.sample(9.0).positions, [2.0]);
        assert_eq!(t.sample_times(0.75), [0.0, 0.75, 1.5, 2.0]);
    }

    #[test]
    fn malformed_knots_are_refused() {
        assert_eq!(trajectory(vec![], vec![]), Err(TrajectoryError::Empty));
        assert_eq!(trajectory(vec![0.0], vec![]), Err(TrajectoryError::Shape));
        let two = vec![knot(0.0, 0.0, 0.0), knot(0.0, 0.0, 0.0)];
        assert_eq!(trajectory(vec![0.0, 0.0], two), Err(TrajectoryError::Times));
    }
}
