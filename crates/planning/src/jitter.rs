//! Small motions out of a grazing contact.
//!
//! A robot that has just grasped something, or that sees the world with an error, often starts a hair inside of an
//! obstacle. Jittering looks for a free state in a ball around it that grows up to a limit. The ball is one of the
//! swept-volume metric: its radius is how far any point of the robot may travel, in metres.

use std::collections::BTreeMap;
use std::fmt;

use robotc_core::rng::Rng;
use serde::{Deserialize, Serialize};

use crate::budget::{Budget, Interrupt};
use crate::constraint::Constraint;
use crate::edge::{EdgeChecker, Obstruction};

/// Parameters of jittering. Lengths are travel of the fastest point, in the unit of [`EdgeChecker::travel`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct JitterOptions {
    /// Radius of the first ball.
    pub smallest: f64,
    /// No farther than this.
    pub limit: f64,
    /// Each ball is this many times as large as the one before; more than one.
    pub growth: f64,
    /// States tried in each ball.
    pub attempts: u32,
}

impl Default for JitterOptions {
    fn default() -> Self {
        Self { smallest: 0.001, limit: 0.03, growth: 1.5, attempts: 30 }
    }
}

/// A free state near the one asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Jittered {
    /// The state; the one asked for when that is free.
    pub q: Vec<f64>,
    /// How far it is away, as travel of the fastest point.
    pub travel: f64,
    /// States tried.
    pub tried: u32,
}

/// Why no free state was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JitterFailureReason {
    /// None is near.
    Limit,
    /// The budget ended.
    Interrupted(Interrupt),
}

/// Why no free state was found, and what was tried.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JitterFailure {
    /// What ended it.
    pub reason: JitterFailureReason,
    /// What is wrong with the state asked for.
    pub initial: Obstruction,
    /// States tried.
    pub tried: u32,
    /// What was wrong with them, or with the way to them.
    pub blocked: BTreeMap<Obstruction, u32>,
}

impl fmt::Display for JitterFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.reason {
            JitterFailureReason::Limit => write!(f, "none of {} nearby states is free", self.tried),
            JitterFailureReason::Interrupted(interrupt) => write!(f, "{interrupt}"),
        }
    }
}

/// The state itself when it is free; otherwise a free one near to it, found by growing a ball.
///
/// The straight way out meets nothing but the obstruction that the state is in, and that only at its beginning; the
/// states returned are on the constraint, if there is one. Values a hair outside of the bounds are moved inside first.
pub fn jitter<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    constraint: Option<&dyn Constraint>,
    q: &[f64],
    options: &JitterOptions,
    budget: &Budget<'_>,
    rng: &mut Rng,
) -> Result<Jittered, JitterFailure> {
    let Err(initial) = checker.state(q) else {
        return Ok(Jittered { q: q.to_vec(), travel: 0.0, tried: 0 });
    };
    let mut failure =
        JitterFailure { reason: JitterFailureReason::Limit, initial, tried: 0, blocked: BTreeMap::new() };
    let ball = Ball::new(checker);
    let (mut inner, mut outer) = (0.0, options.smallest.min(options.limit));
    loop {
        for attempt in 0..options.attempts.max(1) {
            if let Err(interrupt) = budget.check() {
                failure.reason = JitterFailureReason::Interrupted(interrupt);
                return Err(failure);
            }
            // The very first candidate is the state moved into its bounds and onto the constraint.
            let mut candidate = match (inner, attempt) {
                (0.0, 0) => q.to_vec(),
                _ => ball.at(checker, q, rng.range(inner, outer), rng),
            };
            checker.space().clamp(&mut candidate);
            if constraint.is_some_and(|c| !c.project(&mut candidate)) {
                continue;
            }
            let travel = checker.travel(&checker.space().difference(q, &candidate));
            if travel > options.limit {
                continue;
            }
            failure.tried += 1;
            let free = checker.state(&candidate).map(|_| ());
            match free.and_then(|()| leaves(checker, q, &candidate, initial)) {
                Ok(()) => return Ok(Jittered { q: candidate, travel, tried: failure.tried }),
                Err(by) => *failure.blocked.entry(by).or_insert(0) += 1,
            }
        }
        if outer >= options.limit {
            return Err(failure);
        }
        inner = outer;
        outer = (outer * options.growth.max(1.01)).min(options.limit);
    }
}

/// Whether the straight way from `q`, which is in `initial`, to the valid state `free` leaves it once and meets nothing
/// else.
fn leaves<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    q: &[f64],
    free: &[f64],
    initial: Obstruction,
) -> Result<(), Obstruction> {
    let travel = checker.travel(&checker.space().difference(q, free));
    let steps = (travel / checker.resolution()).ceil().max(1.0);
    let mut outside = false;
    for k in 1..steps as usize {
        let state = checker.space().interpolate(q, free, k as f64 / steps);
        match checker.state(&state) {
            Ok(_) => outside = true,
            Err(by) if by == initial && !outside => {}
            Err(by) => return Err(by),
        }
    }
    Ok(())
}

/// Directions in which every coordinate has an equal share in the travel.
#[derive(Debug, Clone)]
pub struct Ball {
    /// Travel of a unit of each coordinate.
    travel: Vec<f64>,
}

impl Ball {
    /// For the states of this checker.
    pub fn new<C: EdgeChecker + ?Sized>(checker: &C) -> Self {
        let dimension = checker.space().dimension();
        let unit = |i: usize| (0..dimension).map(|k| f64::from(u8::from(k == i))).collect::<Vec<f64>>();
        Self { travel: (0..dimension).map(|i| checker.travel(&unit(i))).collect() }
    }

    /// The state at `radius` from `centre` in a random direction; it may be out of bounds.
    ///
    /// Coordinates that move nothing stay as they are.
    pub fn at<C: EdgeChecker + ?Sized>(
        &self,
        checker: &C,
        centre: &[f64],
        radius: f64,
        rng: &mut Rng,
    ) -> Vec<f64> {
        let draw = |&travel: &f64| if travel > 0.0 { rng.normal() / travel } else { 0.0 };
        let direction: Vec<f64> = self.travel.iter().map(draw).collect();
        let scale = radius / checker.travel(&direction).max(f64::MIN_POSITIVE);
        centre.iter().zip(&direction).map(|(c, d)| c + scale * d).collect()
    }

    /// A state in the ball of `radius` around `centre`; it may be out of bounds.
    pub fn within<C: EdgeChecker + ?Sized>(
        &self,
        checker: &C,
        centre: &[f64],
        radius: f64,
        rng: &mut Rng,
    ) -> Vec<f64> {
        let share = libm::pow(rng.unit(), 1.0 / self.travel.len().max(1) as f64);
        self.at(checker, centre, radius * share, rng)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testbed::{self, REST};
    use crate::toy::Toy;
    use robotc_core::Seed;

    fn run(toy: &mut Toy, q: [f64; 2], limit: f64, seed: u64) -> Result<Jittered, JitterFailure> {
        let options = JitterOptions { smallest: 0.01, limit, ..JitterOptions::default() };
        jitter(toy, None, &q, &options, &Budget::unlimited(), &mut Seed::new(seed).rng())
    }

    #[test]
    fn grazing_states_move_a_little_and_free_ones_stay() {
        let mut toy = Toy::wall(0.01);
        let free = run(&mut toy, [2.0, 2.0], 0.5, 1).unwrap();
        assert_eq!((free.q, free.travel, free.tried), (vec![2.0, 2.0], 0.0, 0));
        for seed in 0..50 {
            // A hair inside of the wall, near its left side.
            let moved = run(&mut toy, [4.05, 3.0], 0.5, seed).unwrap();
            assert!(moved.q[0] < 4.0, "out on the near side: {:?}", moved.q);
            assert!(moved.travel < 0.2 && moved.tried > 1, "{moved:?}");
        }
    }

    #[test]
    fn bounds_count_as_grazing() {
        let moved = run(&mut Toy::wall(0.01), [1.0, -1e-9], 0.5, 1).unwrap();
        assert_eq!((moved.q, moved.tried), (vec![1.0, 0.0], 1));
    }

    #[test]
    fn a_way_out_through_another_obstacle_is_refused() {
        // Thin obstacle 0, with obstacle 1 behind its left side and a pocket behind that.
        let boxes = vec![([4.0, 0.0], [5.0, 10.0]), ([3.9, 0.0], [4.0, 10.0])];
        let failure = run(&mut Toy::new(boxes.clone(), 0.01), [4.05, 3.0], 0.4, 2).unwrap_err();
        assert_eq!(failure.reason, JitterFailureReason::Limit);
        assert_eq!(failure.initial, Obstruction::Contact(0));
        assert!(failure.blocked[&Obstruction::Contact(1)] > 0);
        assert!(run(&mut Toy::new(boxes[..1].to_vec(), 0.01), [4.05, 3.0], 0.4, 2).is_ok());
    }

    #[test]
    fn deep_states_fail_and_budgets_are_honoured() {
        let failure = run(&mut Toy::wall(0.01), [4.5, 3.0], 0.2, 3).unwrap_err();
        assert_eq!(failure.reason, JitterFailureReason::Limit);
        assert!(failure.tried > 100 && failure.to_string().contains("nearby states"));
        let spent = || Some(Interrupt::TimeUp);
        let failure = jitter(
            &mut Toy::wall(0.01),
            None,
            &[4.5, 3.0],
            &JitterOptions::default(),
            &Budget::new(&spent),
            &mut Seed::new(1).rng(),
        )
        .unwrap_err();
        assert_eq!((failure.reason, failure.tried), (JitterFailureReason::Interrupted(Interrupt::TimeUp), 0));
    }

    #[test]
    fn an_arm_leaves_the_table_by_a_few_millimetres() {
        let robot = testbed::robot(false);
        let arm = testbed::arm(false);
        // The table's top is just above the lowest point of the fingers.
        let tip = arm.world_from_tool(&REST).translation.vector;
        let top = |height: f64| ([0.5, 0.5, 0.1], [tip.x, tip.y, height - 0.05]);
        let touching = (0..100)
            .map(|mm| tip.z - 0.08 + 0.001 * f64::from(mm))
            .find(|&height| {
                let scene = testbed::scene(&robot, &[top(height)]);
                testbed::checker(&scene, &arm, &testbed::rest(&robot)).state(&REST).is_err()
            })
            .expect("a high enough table is touched");
        let scene = testbed::scene(&robot, &[top(touching + 0.002)]);
        let mut checker = testbed::checker(&scene, &arm, &testbed::rest(&robot));
        for seed in 0..5 {
            let moved = jitter(
                &mut checker,
                None,
                &REST,
                &JitterOptions::default(),
                &Budget::unlimited(),
                &mut Seed::new(seed).rng(),
            )
            .unwrap_or_else(|e| panic!("{e}"));
            assert!(checker.state(&moved.q).is_ok() && moved.travel > 0.002 && moved.travel <= 0.03);
        }
    }
}
