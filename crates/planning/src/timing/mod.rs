//! When to be where along a path: corners are rounded, then speed is as high as the limits of all joints allow.
//!
//! [`blend`] makes the path smooth enough to be followed without stopping, [`profile`] finds the fastest speed along
//! it. The result keeps the limits between its knots too, which [`TimedPath::limit_use`] measures independently.
//! [`point_to_point()`] motions stop at corners instead, and limit the jerk as well; [`limited_jerk`] limits it along rounded corners.

mod blend;
mod limited_jerk;
mod point_to_point;
mod profile;
mod timed;

pub use point_to_point::point_to_point;
pub use timed::TimedPath;
pub(crate) use timed::{jerk_use, limit_use};

use serde::{Deserialize, Serialize};

use crate::edge::EdgeChecker;
use crate::space::Space;

/// How fast each coordinate may go.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionLimits {
    /// Largest speed of each coordinate, per second; positive.
    pub velocity: Vec<f64>,
    /// Largest acceleration of each coordinate, per second squared; positive.
    pub acceleration: Vec<f64>,
    /// Largest jerk of each coordinate, per second cubed; positive. Not kept by [`TimeLaw::AlongPath`].
    pub jerk: Vec<f64>,
}

/// How a path of straight edges is driven.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeLaw {
    /// Without stopping: corners are rounded, and the speed is as high as velocity and acceleration limits allow.
    /// Acceleration may jump.
    #[default]
    AlongPath,
    /// The same with limited jerk: a little slower, and a little inside of the rounded corners; from state to state where that is
    /// faster.
    AlongPathLimitedJerk,
    /// From state to state, at rest at each: on the edges themselves, with limited jerk.
    PointToPoint,
}

/// Parameters of the time parameterisation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct TimingOptions {
    /// How the path is driven.
    pub law: TimeLaw,
    /// Longest piece cut off on each side of a corner, as a fraction of the diameter of the space. Where a blend is
    /// not free it is halved, and below a thousandth of this the motion stops at the corner instead.
    pub blend: f64,
    /// Number of intervals that a path is divided into, more or less: more come nearer to the fastest motion.
    pub intervals: u32,
}

impl Default for TimingOptions {
    fn default() -> Self {
        Self { law: TimeLaw::default(), blend: 0.05, intervals: 160 }
    }
}

/// The motion along a valid path of straight edges that is the fastest by its [law](TimeLaw) under `limits`, at rest at
/// both ends.
///
/// Corners are rounded where the law asks for it and `checker` finds the rounding free.
pub fn time_path<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    path: &[Vec<f64>],
    limits: &MotionLimits,
    options: &TimingOptions,
) -> TimedPath {
    let mut path = path.to_vec();
    checker.space().unwrap_path(&mut path);
    drop_repeated(checker.space(), &mut path);
    let Some(first) = path.first() else { return TimedPath::default() };
    match options.law {
        TimeLaw::PointToPoint => stopping(&path, first, limits),
        TimeLaw::AlongPathLimitedJerk => {
            let mut timed = TimedPath::resting_at(first);
            for section in blend::round_corners(checker, &path, options.blend) {
                let grid = blend::subdivide(&section, options.intervals);
                let (first, last) = (&grid[0], &grid[grid.len() - 1]);
                let straight = grid.iter().all(|interval| interval.curvature.iter().all(|c| *c == 0.0));
                timed.append(if straight {
                    point_to_point(&first.start, &last.end(), limits)
                } else {
                    limited_jerk::limit_jerk(checker, &grid, limits)
                });
            }
            // Where the jerk counts for more than the acceleration, corners are better stopped at.
            let stopping = stopping(&path, first, limits);
            if stopping.duration() < timed.duration() { stopping } else { timed }
        }
        TimeLaw::AlongPath => {
            let mut timed = TimedPath::resting_at(first);
            for section in blend::round_corners(checker, &path, options.blend) {
                let grid = blend::subdivide(&section, options.intervals);
                timed.append(profile::fastest(&grid, limits));
            }
            timed.slow_down_to(limits);
            timed
        }
    }
}

/// The motion that rests at every state of the path.
fn stopping(path: &[Vec<f64>], first: &[f64], limits: &MotionLimits) -> TimedPath {
    let mut timed = TimedPath::resting_at(first);
    for edge in path.windows(2) {
        timed.append(point_to_point(&edge[0], &edge[1], limits));
    }
    timed
}

/// States nearer to their neighbours than this fraction of the diameter of the space say nothing about the path.
const REPEATED: f64 = 1e-6;

/// Leaves out states next to the one before or to the end; both ends stay.
fn drop_repeated(space: &Space, path: &mut Vec<Vec<f64>>) {
    let least = REPEATED * space.diameter();
    let Some(end) = path.pop() else { return };
    path.dedup_by(|b, a| space.distance(a, b) <= least);
    while path.len() > 1 && space.distance(&path[path.len() - 1], &end) <= least {
        path.pop();
    }
    if path.first() != Some(&end) || path.len() > 1 {
        path.push(end);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toy::Toy;
    use proptest::prelude::*;

    fn limits(v: [f64; 2], a: [f64; 2]) -> MotionLimits {
        MotionLimits { velocity: v.to_vec(), acceleration: a.to_vec(), jerk: vec![10.0; 2] }
    }

    fn open() -> Toy {
        Toy::new(vec![], 0.05)
    }

    #[test]
    fn a_straight_line_is_bang_bang() {
        // Distance 8 with v = 2, a = 1: two seconds up, two down, 4 m at 2 m/s in between.
        let path = vec![vec![1.0, 1.0], vec![9.0, 1.0]];
        let timed = time_path(&mut open(), &path, &limits([2.0, 9.0], [1.0, 9.0]), &TimingOptions::default());
        assert!((timed.duration() - 6.0).abs() < 0.02, "{}", timed.duration());
        // Without reaching full speed: distance 1 with a = 1 takes 2 s.
        let short = vec![vec![1.0, 1.0], vec![2.0, 1.0]];
        let timed =
            time_path(&mut open(), &short, &limits([2.0, 9.0], [1.0, 9.0]), &TimingOptions::default());
        assert!((timed.duration() - 2.0).abs() < 0.02, "{}", timed.duration());
    }

    #[test]
    fn nothing_to_do_takes_no_time() {
        let limits = limits([1.0; 2], [1.0; 2]);
        let path = vec![vec![1.0, 1.0], vec![1.0, 1.0]];
        let timed = time_path(&mut open(), &path, &limits, &TimingOptions::default());
        assert_eq!(timed.duration(), 0.0);
        assert_eq!(timed.knots[0].positions, [1.0, 1.0]);
    }

    #[test]
    fn corners_are_rounded_and_faster_than_stopping() {
        let path = vec![vec![1.0, 1.0], vec![5.0, 1.0], vec![5.0, 5.0]];
        let limits = limits([2.0; 2], [2.0; 2]);
        let timed = time_path(&mut open(), &path, &limits, &TimingOptions::default());
        let stopping: f64 = path
            .windows(2)
            .map(|leg| time_path(&mut open(), leg, &limits, &TimingOptions::default()).duration())
            .sum();
        assert!(timed.duration() < stopping - 0.1, "{} against {stopping}", timed.duration());
    }

    #[test]
    fn point_to_point_rests_at_every_corner() {
        let path = vec![vec![1.0, 1.0], vec![5.0, 1.0], vec![5.0, 1.0], vec![5.0, 5.0]];
        let limits = limits([2.0; 2], [2.0; 2]);
        let options = TimingOptions { law: TimeLaw::PointToPoint, ..TimingOptions::default() };
        let timed = time_path(&mut open(), &path, &limits, &options);
        let legs = [&path[..2], &path[2..]].map(|leg| point_to_point(&leg[0], &leg[1], &limits).duration());
        assert!((timed.duration() - legs[0] - legs[1]).abs() < 1e-12);
        let corner = timed.knots.iter().find(|k| k.positions == path[1]).expect("the corner is a knot");
        assert_eq!(corner.velocities, [0.0, 0.0]);
        assert!(timed.limit_use(&limits) <= 1.0 + 1e-9);
    }

    #[test]
    fn a_corner_round_an_obstacle_stays_free() {
        // The corner passes a box closely on its inside.
        for (gap, resolution, stops) in [(0.2, 0.02, false), (1e-4, 1e-4, true)] {
            let obstacle = ([1.0, 2.0 + gap], [5.0 - gap, 9.0]);
            let mut toy = Toy::new(vec![obstacle], resolution);
            toy.padding = 0.5 * resolution;
            let path = vec![vec![1.0, 2.0], vec![5.0, 2.0], vec![5.0, 8.0]];
            let timed = time_path(&mut toy, &path, &limits([2.0; 2], [2.0; 2]), &TimingOptions::default());
            let mut exact = Toy::new(vec![obstacle], 0.02);
            for (time, point) in timed.resample(0.001) {
                assert!(exact.state(&point.positions).is_ok(), "{gap} at {time}");
            }
            let slowest = timed.knots[1..timed.knots.len() - 1]
                .iter()
                .map(|k| k.velocities[0].hypot(k.velocities[1]))
                .fold(f64::INFINITY, f64::min);
            assert_eq!(slowest < 1e-6, stops, "{slowest}");
        }
    }

    #[test]
    fn nearly_equal_legs_and_nearly_equal_states_keep_the_limits() {
        let limits = limits([1.0; 2], [2.0; 2]);
        for k in 0..12 {
            let tiny = 10.0_f64.powi(-k);
            let path = vec![
                vec![1.0, 1.0],
                vec![1.5, 1.0],
                vec![2.0 + tiny, 1.1],
                vec![2.0 + tiny, 1.1 + tiny],
                vec![2.5 + tiny, 1.3],
                vec![2.5 + tiny, 1.8 + 2.0 * tiny],
            ];
            let timed = time_path(&mut open(), &path, &limits, &TimingOptions::default());
            assert!(timed.limit_use(&limits) <= 1.0 + 1e-9, "{tiny}: {}", timed.limit_use(&limits));
            assert!(timed.duration() < 5.0 + 5.0 * tiny, "{tiny}: {}", timed.duration());
        }
    }

    proptest! {
        #![proptest_config(crate::properties::cases(60))]
        #[test]
        fn limits_hold_everywhere(
            points in prop::collection::vec(prop::array::uniform2(0.0..10.0f64), 2..7),
            v in prop::array::uniform2(0.1..5.0f64),
            a in prop::array::uniform2(0.1..20.0f64),
        ) {
            let path: Vec<Vec<f64>> = points.iter().map(|p| p.to_vec()).collect();
            let limits = limits(v, a);
            let timed = time_path(&mut open(), &path, &limits, &TimingOptions::default());
            prop_assert!(timed.limit_use(&limits) <= 1.0 + 1e-9);
            let mut last: Option<(f64, Vec<f64>)> = None;
            for (t, point) in timed.resample(timed.duration() / 700.0) {
                for i in 0..2 {
                    prop_assert!(point.velocities[i].abs() <= v[i] * (1.0 + 1e-9));
                    prop_assert!(point.accelerations[i].abs() <= a[i] * (1.0 + 1e-9));
                    // The same by differences of positions, which trusts no stored derivative.
                    if let Some((before, q)) = &last {
                        let speed = (point.positions[i] - q[i]).abs() / (t - before).max(1e-12);
                        prop_assert!(speed <= v[i] * (1.0 + 1e-6));
                    }
                }
                last = Some((t, point.positions));
            }
            prop_assert_eq!(&timed.knots[0].positions, &path[0]);
            let end = &timed.knots.last().unwrap().positions;
            prop_assert!((0..2).all(|i| (end[i] - path[path.len() - 1][i]).abs() < 1e-9));
        }
    }
}
