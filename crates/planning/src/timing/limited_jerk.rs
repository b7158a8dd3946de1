//! Limited jerk along a path: the fastest motion under limits of velocity and acceleration, averaged over time.
//!
//! Positions q(0), q(h), q(2 h) ... of the fastest motion become control points of a cubic B-spline with knots h apart. Its derivatives are
//! convex combinations of divided differences of control points (de Boor, "A practical guide to splines", 1978, chapter X), so that of the
//! first order they are mean velocities of the fastest motion, of the second mean accelerations, and of the third, the jerk,
//! the difference of two mean accelerations by h: with an acceleration of no more than a, at most 2 a / h. So h = 2 a / j keeps all limits
//! whatever the path, and costs no more than 3 h of time. Moving averages of fast motions are an old way to
//! smooth them (Biagiotti and Melchiorri, "FIR filters for online trajectory planning with time- and frequency-domain specifications", 2012).

use robotc_core::trajectory::TrajectoryPoint;

use super::blend::Interval;
use super::timed::TimedPath;
use super::{MotionLimits, profile};
use crate::edge::EdgeChecker;

/// Shares of 2 a / j that are tried as distance of the knots, in turn: only a jump from one limit of the acceleration to the other needs all.
const SHARES: [f64; 3] = [0.5, 0.75, 1.0];

/// Largest use of a limit of the jerk: what is over one is rounding.
const FULL: f64 = 1.0 + 1e-9;

/// How often a motion is made half as fast to stay nearer to its path.
const HALVINGS: usize = 12;

/// How often half the acceleration is tried: it takes half the distance of the knots.
const GENTLER: usize = 8;

/// A fast motion along the intervals, at rest at both ends, that keeps the limits of velocity, acceleration and jerk.
///
/// It leaves the path by a sixth of a h^2 at most, a little inside of corners. Where `checker` finds that not free, the motion is made
/// slower until it is.
pub(super) fn limit_jerk<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    grid: &[Interval],
    limits: &MotionLimits,
) -> TimedPath {
    let gentler = |limits: &MotionLimits, share: f64| {
        let acceleration = limits.acceleration.iter().map(|a| share * a).collect();
        MotionLimits { acceleration, ..limits.clone() }
    };
    let mut limits = limits.clone();
    let mut motion = fastest(grid, &limits);
    let mut shortest = spline(&motion, &limits);
    for _ in 0..GENTLER {
        let gentle = gentler(&limits, 0.5);
        let next = fastest(grid, &gentle);
        let spline = spline(&next, &gentle);
        if spline.duration() >= shortest.duration() {
            break;
        }
        (limits, motion, shortest) = (gentle, next, spline);
    }
    for _ in 0..HALVINGS {
        if shortest.near_or_free(checker) {
            break;
        }
        motion.stretch(2.0);
        limits = gentler(&limits, 0.25);
        shortest = spline(&motion, &limits);
    }
    shortest.timed()
}

/// The fastest motion under limits of velocity and acceleration.
fn fastest(grid: &[Interval], limits: &MotionLimits) -> TimedPath {
    let mut motion = profile::fastest(grid, limits);
    motion.slow_down_to(limits);
    motion
}

/// The spline of a motion that keeps limits of velocity and acceleration, with the shortest distance of knots that keeps those of the jerk.
fn spline(motion: &TimedPath, limits: &MotionLimits) -> Spline {
    let ratios = limits.acceleration.iter().zip(&limits.jerk).map(|(a, j)| 2.0 * a / j);
    let sure = ratios.fold(0.0, f64::max);
    let mut made = Spline::of(motion, SHARES[0] * sure);
    for share in &SHARES[1..] {
        if made.jerk_use(limits) <= FULL {
            break;
        }
        made = Spline::of(motion, share * sure);
    }
    made
}

/// A uniform cubic B-spline.
struct Spline {
    /// Control points, the first and the last three times.
    control: Vec<Vec<f64>>,
    /// Seconds between knots.
    h: f64,
}

impl Spline {
    fn of(motion: &TimedPath, h: f64) -> Self {
        let mut control: Vec<Vec<f64>> = motion.resample(h).into_iter().map(|(_, p)| p.positions).collect();
        let (first, last) = (control[0].clone(), control[control.len() - 1].clone());
        control.splice(0..0, [first.clone(), first]);
        control.extend([last.clone(), last]);
        Self { control, h }
    }

    fn duration(&self) -> f64 {
        self.h * (self.control.len() - 3) as f64
    }

    /// The largest share of a limit of the jerk that is used anywhere: third differences are all there is.
    fn jerk_use(&self, limits: &MotionLimits) -> f64 {
        let cubed = self.h * self.h * self.h;
        let mut most = 0.0_f64;
        for w in self.control.windows(4) {
            for (i, limit) in limits.jerk.iter().enumerate() {
                let difference = w[3][i] - 3.0 * w[2][i] + 3.0 * w[1][i] - w[0][i];
                most = most.max(difference.abs() / (cubed * limit));
            }
        }
        most
    }

    /// Where it is at the knot in the middle of three control points, and how far from the middle one.
    fn at(w: &[Vec<f64>]) -> (Vec<f64>, Vec<f64>) {
        let bend: Vec<f64> = (0..w[0].len()).map(|i| (w[0][i] - 2.0 * w[1][i] + w[2][i]) / 6.0).collect();
        (w[1].iter().zip(&bend).map(|(p, b)| p + b).collect(), bend)
    }

    /// Whether it stays so near to the motion that this makes no difference, or is free where it does not.
    fn near_or_free<C: EdgeChecker + ?Sized>(&self, checker: &mut C) -> bool {
        let near = checker.resolution() / 16.0;
        let mut before: Option<(Vec<f64>, bool)> = None;
        for w in self.control.windows(3) {
            let (at, bend) = Self::at(w);
            let bent = checker.travel(&bend) > near;
            if let Some((from, was_bent)) = &before
                && (bent || *was_bent)
                && checker.edge(from, &at).is_err()
            {
                return false;
            }
            before = Some((at, bent));
        }
        true
    }

    /// The same as knots: a trajectory is cubic between them.
    fn timed(&self) -> TimedPath {
        let h = self.h;
        let mut timed = TimedPath::default();
        for (k, w) in self.control.windows(3).enumerate() {
            let (positions, bend) = Self::at(w);
            let velocities = w[2].iter().zip(&w[0]).map(|(c, a)| (c - a) / (2.0 * h)).collect();
            let accelerations = bend.iter().map(|b| 6.0 * b / (h * h)).collect();
            timed.push(k as f64 * h, TrajectoryPoint { positions, velocities, accelerations });
        }
        timed
    }
}

#[cfg(test)]
mod tests {
    use super::super::blend::{round_corners, subdivide};
    use super::super::{TimeLaw, TimingOptions, time_path};
    use super::*;
    use crate::toy::Toy;
    use proptest::prelude::*;

    fn timed(toy: &mut Toy, path: &[Vec<f64>], limits: &MotionLimits, law: TimeLaw) -> TimedPath {
        time_path(toy, path, limits, &TimingOptions { law, ..TimingOptions::default() })
    }

    proptest! {
        #![proptest_config(crate::properties::cases(60))]
        #[test]
        fn finite_differences_keep_all_limits(
            points in prop::collection::vec(prop::array::uniform2(0.0..10.0f64), 2..7),
            v in prop::array::uniform2(0.1..5.0f64),
            a in prop::array::uniform2(0.1..20.0f64),
            j in prop::array::uniform2(1.0..400.0f64),
        ) {
            let path: Vec<Vec<f64>> = points.iter().map(|p| p.to_vec()).collect();
            let limits = MotionLimits { velocity: v.to_vec(), acceleration: a.to_vec(), jerk: j.to_vec() };
            let mut open = Toy::new(vec![], 0.05);
            let limited = timed(&mut open, &path, &limits, TimeLaw::AlongPathLimitedJerk);
            prop_assert!(limited.limit_use(&limits) <= 1.0 + 1e-5);
            prop_assert!(limited.jerk_use(&limits) <= 1.0 + 1e-5, "{}", limited.jerk_use(&limits));
            let end = &limited.knots[limited.knots.len() - 1];
            prop_assert_eq!(&limited.knots[0].positions, &path[0]);
            prop_assert!((0..2).all(|i| (end.positions[i] - path[path.len() - 1][i]).abs() < 1e-9));
            // Positions alone, evenly in time, with rest before and after: differences divided by the step are means of
            // the derivatives, jumps at the ends included.
            let h = limited.duration() / 900.0;
            let mut samples = vec![path[0].clone(); 3];
            samples.extend(limited.resample(h).into_iter().map(|(_, p)| p.positions));
            samples.extend(vec![end.positions.clone(); 3]);
            for window in samples.windows(4) {
                for i in 0..2 {
                    let [p, q, r, s] = [0, 1, 2, 3].map(|k| window[k][i]);
                    let (speed, acceleration, jerk) = (s - r, s - 2.0 * r + q, s - 3.0 * r + 3.0 * q - p);
                    for (value, limit, step) in [(speed, v[i], h), (acceleration, a[i], h * h), (jerk, j[i], h * h * h)] {
                        let (value, doubt) = (value / step, 2e-13 / step);
                        prop_assert!(value.abs() <= limit * (1.0 + 1e-6) + doubt, "{value} over {limit}");
                    }
                }
            }
            // No more than three of the longest knots for each section is lost, and it is not faster than without, which is found
            // on a grid.
            let fastest = timed(&mut open, &path, &limits, TimeLaw::AlongPath);
            let sections = path.len() as f64;
            let knot = (0..2).map(|i| 2.0 * a[i] / j[i]).fold(0.0, f64::max);
            prop_assert!(limited.duration() >= 0.98 * fastest.duration());
            let most = fastest.duration() + 3.0 * knot * sections;
            prop_assert!(limited.duration() <= most * (1.0 + 1e-9), "{} over {most}", limited.duration());
        }
    }

    #[test]
    fn corners_are_not_stopped_at() {
        let path = vec![vec![1.0, 1.0], vec![5.0, 1.0], vec![5.0, 5.0]];
        let limits = MotionLimits { velocity: vec![2.0; 2], acceleration: vec![4.0; 2], jerk: vec![40.0; 2] };
        let mut open = Toy::new(vec![], 0.05);
        let [along, limited, stopping] =
            [TimeLaw::AlongPath, TimeLaw::AlongPathLimitedJerk, TimeLaw::PointToPoint]
                .map(|law| timed(&mut open, &path, &limits, law).duration());
        assert!(along < limited && limited < stopping - 0.1, "{along} {limited} {stopping}");
    }

    #[test]
    fn near_an_obstacle_it_is_slower_and_free() {
        let limits = MotionLimits { velocity: vec![2.0; 2], acceleration: vec![4.0; 2], jerk: vec![20.0; 2] };
        let path = vec![vec![1.0, 2.0], vec![5.0, 2.0], vec![5.0, 8.0]];
        let mut open = Toy::new(vec![], 0.002);
        let section = round_corners(&mut open, &path, 0.05).remove(0);
        let grid = subdivide(&section, 160);
        let free = limit_jerk(&mut open, &grid, &limits);
        // How far towards the corner the curve and the motion get.
        let of_curve = grid.iter().map(|i| i.start[0] - i.start[1]).fold(0.0, f64::max);
        let samples = free.resample(0.001);
        let of_motion = samples.iter().map(|(_, p)| p.positions[0] - p.positions[1]).fold(0.0, f64::max);
        assert!(of_motion < of_curve - 1e-3, "{of_motion} inside of {of_curve}");
        // A box between the two.
        let inside = 0.5 * (3.0 - 0.5 * (of_curve + of_motion));
        let obstacle = ([1.0, 2.0 + inside], [5.0 - inside, 9.0]);
        let motion = limit_jerk(&mut Toy::new(vec![obstacle], 0.002), &grid, &limits);
        let mut exact = Toy::new(vec![obstacle], 0.002);
        let hits = |motion: &TimedPath, exact: &mut Toy| {
            motion.resample(0.001).iter().filter(|(_, p)| exact.state(&p.positions).is_err()).count()
        };
        assert!(hits(&free, &mut exact) > 0 && hits(&motion, &mut exact) == 0);
        assert!(motion.duration() > free.duration() && motion.jerk_use(&limits) <= 1.0 + 1e-6);
    }
}
