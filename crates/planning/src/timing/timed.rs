//! A path with times.

use robotc_core::ids::DofIdx;
use robotc_core::trajectory::{Trajectory, TrajectoryError, TrajectoryPoint, cubic};

use super::MotionLimits;

/// Knots of a motion with their times, in the coordinates of the space that was planned in.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TimedPath {
    /// Seconds, from zero, growing.
    pub times: Vec<f64>,
    /// One for each time; cubic in between, see [`Trajectory`].
    pub knots: Vec<TrajectoryPoint>,
}

impl TimedPath {
    pub(super) fn resting_at(q: &[f64]) -> Self {
        let rest = vec![0.0; q.len()];
        let knot = TrajectoryPoint { positions: q.to_vec(), velocities: rest.clone(), accelerations: rest };
        Self { times: vec![0.0], knots: vec![knot] }
    }

    pub(super) fn push(&mut self, time: f64, knot: TrajectoryPoint) {
        self.times.push(time);
        self.knots.push(knot);
    }

    /// Adds a motion that starts where and when this one ends.
    pub(super) fn append(&mut self, next: TimedPath) {
        let offset = self.duration();
        // The first knot of `next` knows the acceleration to come.
        self.times.pop();
        self.knots.pop();
        self.times.extend(next.times.iter().map(|t| t + offset));
        self.knots.extend(next.knots);
    }

    /// The first `count` coordinates, and the others, at the same times.
    pub fn split(self, count: usize) -> (Self, Self) {
        let part = |range: &dyn Fn(&[f64]) -> Vec<f64>| {
            let knot = |k: &TrajectoryPoint| TrajectoryPoint {
                positions: range(&k.positions),
                velocities: range(&k.velocities),
                accelerations: range(&k.accelerations),
            };
            Self { times: self.times.clone(), knots: self.knots.iter().map(knot).collect() }
        };
        (part(&|all| all[..count].to_vec()), part(&|all| all[count..].to_vec()))
    }

    /// Seconds from start to end.
    pub fn duration(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// The largest fraction of any limit that the motion uses anywhere, between the knots too; speeds count as they
    /// are, accelerations by their square root, so that stretching time by this factor satisfies all limits.
    pub fn limit_use(&self, limits: &MotionLimits) -> f64 {
        limit_use(&self.times, &self.knots, limits)
    }

    /// The largest fraction of any limit of the jerk that the motion uses anywhere; infinite where an acceleration jumps, at the ends
    /// from or to rest included.
    pub fn jerk_use(&self, limits: &MotionLimits) -> f64 {
        jerk_use(&self.times, &self.knots, limits)
    }

    /// Stretches time where rounding or interpolation left the motion a trace too fast.
    pub(super) fn slow_down_to(&mut self, limits: &MotionLimits) {
        let factor = self.limit_use(limits);
        if factor > 1.0 {
            self.stretch(factor);
        }
    }

    /// The same motion, slower by this factor.
    pub(super) fn stretch(&mut self, factor: f64) {
        for time in &mut self.times {
            *time *= factor;
        }
        for knot in &mut self.knots {
            knot.velocities.iter_mut().for_each(|v| *v /= factor);
            knot.accelerations.iter_mut().for_each(|a| *a /= factor * factor);
        }
    }

    /// States at times from zero in steps of `period`, and at the end.
    pub fn resample(&self, period: f64) -> Vec<(f64, TrajectoryPoint)> {
        let dofs = (0..self.knots[0].positions.len()).map(robotc_core::ids::Idx::new).collect();
        let names = vec![String::new(); self.knots[0].positions.len()];
        let trajectory = self.clone().into_trajectory(dofs, names).expect("times of a timed path grow");
        trajectory.sample_times(period).into_iter().map(|t| (t, trajectory.sample(t))).collect()
    }

    /// The motion as one of these degrees of freedom of a robot; `names` are their joints.
    pub fn into_trajectory(
        self,
        dofs: Vec<DofIdx>,
        names: Vec<String>,
    ) -> Result<Trajectory, TrajectoryError> {
        Trajectory::new(dofs, names, self.times, self.knots)
    }
}

/// See [`TimedPath::limit_use`].
pub(crate) fn limit_use(times: &[f64], knots: &[TrajectoryPoint], limits: &MotionLimits) -> f64 {
    let mut most = 0.0_f64;
    for (times, knots) in times.windows(2).zip(knots.windows(2)) {
        let h = times[1] - times[0];
        for i in 0..limits.velocity.len() {
            // Acceleration is linear, velocity has one extremum.
            let [_, v0, c2, c3] = cubic(&knots[0], &knots[1], i, h);
            let acceleration = (2.0 * c2).abs().max((2.0 * c2 + 6.0 * c3 * h).abs());
            let turn = if c3 == 0.0 { 0.0 } else { (-c2 / (3.0 * c3)).clamp(0.0, h) };
            let between = v0 + turn * (2.0 * c2 + 3.0 * turn * c3);
            let velocity = v0.abs().max(knots[1].velocities[i].abs()).max(between.abs());
            most = most.max(velocity / limits.velocity[i]);
            most = most.max((acceleration / limits.acceleration[i]).sqrt());
        }
    }
    most
}

/// Accelerations that differ by less than this fraction of their limit from one piece to the next are continuous, but for rounding.
const CONTINUOUS: f64 = 1e-5;

/// See [`TimedPath::jerk_use`].
pub(crate) fn jerk_use(times: &[f64], knots: &[TrajectoryPoint], limits: &MotionLimits) -> f64 {
    let mut most = 0.0_f64;
    for i in 0..limits.jerk.len() {
        let mut before = 0.0;
        let jump = |from: f64, to: f64| (to - from).abs() > CONTINUOUS * limits.acceleration[i];
        for (times, knots) in times.windows(2).zip(knots.windows(2)) {
            let h = times[1] - times[0];
            let [_, _, c2, c3] = cubic(&knots[0], &knots[1], i, h);
            if jump(before, 2.0 * c2) {
                return f64::INFINITY;
            }
            before = 2.0 * c2 + 6.0 * c3 * h;
            most = most.max(6.0 * c3.abs() / limits.jerk[i]);
        }
        if jump(before, 0.0) {
            return f64::INFINITY;
        }
    }
    most
}
