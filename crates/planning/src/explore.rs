//! A search without a goal state: it ends at the first state that a condition accepts (thesis algorithm 3.9), such as
//! one from which other joints can move along a given path (algorithm 3.10).

use std::collections::BTreeMap;
use std::fmt;

use robotc_core::Seed;
use robotc_core::rng::Rng;
use serde::{Deserialize, Serialize};

use crate::budget::{Budget, Interrupt};
use crate::constraint::Constraint;
use crate::edge::{Blocked, EdgeChecker, Obstruction};
use crate::jitter::Ball;
use crate::subspace::Subspace;
use crate::tree::Tree;

/// Parameters of an exploring search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ExploreOptions {
    /// Longest edge, as a fraction of the diameter of the space.
    pub step: f64,
    /// Share of samples drawn near a random node of the tree, no farther than the longest edge.
    pub local: f64,
    /// Iterations after which the search gives up.
    pub max_iterations: u32,
}

impl Default for ExploreOptions {
    fn default() -> Self {
        Self { step: 0.05, local: 0.3, max_iterations: 5000 }
    }
}

/// What a search did.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ExploreStatistics {
    /// Iterations run.
    pub iterations: u32,
    /// States reached.
    pub nodes: usize,
    /// How many edges each obstruction stopped.
    pub blocked: BTreeMap<Obstruction, u32>,
    /// How many states the condition refused, and why.
    pub refused: BTreeMap<Obstruction, u32>,
}

/// A path to a state that the condition accepts.
#[derive(Debug, Clone, PartialEq)]
pub struct ExploreSolution {
    /// States from the start; the straight motions between them are valid.
    pub path: Vec<Vec<f64>>,
    /// What it took.
    pub statistics: ExploreStatistics,
}

/// Why no such state was reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExploreFailureReason {
    /// The start itself is invalid.
    Start(Obstruction),
    /// The limit on iterations was reached.
    Iterations,
    /// The budget ended.
    Interrupted(Interrupt),
}

/// Why no such state was reached, and what was tried.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExploreFailure {
    /// What ended the search.
    pub reason: ExploreFailureReason,
    /// What was tried.
    pub statistics: ExploreStatistics,
}

impl fmt::Display for ExploreFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.reason {
            ExploreFailureReason::Start(_) => write!(f, "the start is not free"),
            ExploreFailureReason::Iterations => {
                write!(f, "none of {} states reached is suitable", self.statistics.nodes)
            }
            ExploreFailureReason::Interrupted(interrupt) => {
                write!(f, "{interrupt} after {} iterations", self.statistics.iterations)
            }
        }
    }
}

/// Grows a tree from `start` until `accept` takes a state.
///
/// `accept` is asked about the start and then about every new state, once; what it returns as obstruction is counted.
pub fn explore<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    constraint: Option<&dyn Constraint>,
    start: &[f64],
    accept: &mut dyn FnMut(&mut C, &[f64]) -> Result<(), Obstruction>,
    options: &ExploreOptions,
    budget: &Budget<'_>,
    rng: &mut Rng,
) -> Result<ExploreSolution, ExploreFailure> {
    let mut tree = Tree::new(start.len());
    let mut statistics = ExploreStatistics::default();
    let outcome = grow(checker, constraint, start, accept, options, budget, rng, &mut tree, &mut statistics);
    statistics.nodes = tree.len();
    match outcome {
        Ok(node) => {
            let mut path = tree.path_to_root(node);
            path.reverse();
            Ok(ExploreSolution { path, statistics })
        }
        Err(reason) => Err(ExploreFailure { reason, statistics }),
    }
}

/// The node that is accepted.
fn grow<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    constraint: Option<&dyn Constraint>,
    start: &[f64],
    accept: &mut dyn FnMut(&mut C, &[f64]) -> Result<(), Obstruction>,
    options: &ExploreOptions,
    budget: &Budget<'_>,
    rng: &mut Rng,
    tree: &mut Tree,
    statistics: &mut ExploreStatistics,
) -> Result<usize, ExploreFailureReason> {
    checker.state(start).map_err(ExploreFailureReason::Start)?;
    let step = options.step * checker.space().diameter();
    let mut newest = tree.push_root(start, 0);
    budget.check().map_err(ExploreFailureReason::Interrupted)?;
    loop {
        match accept(checker, tree.state(newest)) {
            Ok(()) => return Ok(newest),
            Err(by) => *statistics.refused.entry(by).or_insert(0) += 1,
        }
        newest = loop {
            if statistics.iterations >= options.max_iterations {
                return Err(ExploreFailureReason::Iterations);
            }
            budget.check().map_err(ExploreFailureReason::Interrupted)?;
            statistics.iterations += 1;
            let mut q = if rng.unit() < options.local {
                let centre = tree.state(rng.below(tree.len()));
                checker.space().sample_near(centre, step * rng.unit(), rng)
            } else {
                checker.space().sample(rng)
            };
            let near = tree.nearest(checker.space(), &q);
            let distance = checker.space().distance(tree.state(near), &q);
            if distance > step {
                q = checker.space().interpolate(tree.state(near), &q, step / distance);
            }
            if constraint.is_some_and(|c| !c.project(&mut q)) {
                continue;
            }
            match checker.edge(tree.state(near), &q) {
                Ok(()) => break tree.push(near, &q),
                Err(Blocked { by, .. }) => *statistics.blocked.entry(by).or_insert(0) += 1,
            }
        };
    }
}

/// A path that some coordinates shall follow while all others stand still: the fingers open, the torso turns.
#[derive(Debug, Clone, PartialEq)]
pub struct FixedMotion {
    /// Positions of these coordinates in the whole space.
    pub coordinates: Vec<usize>,
    /// Their values on the way, the present ones first; straight in between.
    pub path: Vec<Vec<f64>>,
    /// At the end of the path all stays free when any point of the robot moves by up to this, in the unit of
    /// [`EdgeChecker::travel`].
    pub ball: f64,
    /// How many moves within the ball are tried where the checker's clearance proves nothing.
    pub perturbations: u32,
}

impl FixedMotion {
    /// The straight path from the values in `start`, a state of the whole space, to `to`; with a ball of 1 cm.
    pub fn straight(coordinates: &[usize], start: &[f64], to: &[f64]) -> Self {
        let from = coordinates.iter().map(|&i| start[i]).collect();
        Self {
            coordinates: coordinates.to_vec(),
            path: vec![from, to.to_vec()],
            ball: 0.01,
            perturbations: 20,
        }
    }

    /// The states of the whole space that the motion goes through when it starts at `q`.
    pub fn states_from(&self, q: &[f64]) -> Vec<Vec<f64>> {
        let with = |values: &Vec<f64>| {
            let mut all = q.to_vec();
            for (&i, &x) in self.coordinates.iter().zip(values) {
                all[i] = x;
            }
            all
        };
        self.path.iter().map(with).collect()
    }

    /// Whether the motion is free from `q`, a state of the whole space, and its end robust (thesis algorithm 3.10).
    ///
    /// The whole robot is perturbed, not only the links that the coordinates move: that is more than the thesis asks
    /// for, and needs no list of links.
    pub fn check<C: EdgeChecker + ?Sized>(
        &self,
        checker: &mut C,
        q: &[f64],
        rng: &mut Rng,
    ) -> Result<(), Obstruction> {
        let states = self.states_from(q);
        let Some(end) = states.last() else { return Ok(()) };
        // Most states fail at the end, so that comes first.
        let clearance = checker.state(end)?;
        if clearance < self.ball {
            let ball = Ball::new(checker);
            for _ in 0..self.perturbations {
                let mut moved = ball.within(checker, end, self.ball, rng);
                checker.space().clamp(&mut moved);
                checker.state(&moved)?;
            }
        }
        checker.state(&states[0])?;
        for pair in states.windows(2) {
            checker.edge(&pair[0], &pair[1]).map_err(|blocked| blocked.by)?;
        }
        Ok(())
    }
}

/// Moves all coordinates but those of `motion` until `motion` is possible, and then makes it.
///
/// `start` is a state of the whole space, with the coordinates of `motion` at the start of its path. The path returned
/// ends with the states of the motion.
pub fn make_way<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    start: &[f64],
    motion: &FixedMotion,
    options: &ExploreOptions,
    budget: &Budget<'_>,
    seed: Seed,
) -> Result<ExploreSolution, ExploreFailure> {
    let free: Vec<usize> = (0..start.len()).filter(|i| !motion.coordinates.contains(i)).collect();
    let mut perturbing = seed.split("perturbations").rng();
    let mut free_checker = Subspace::new(checker, &free, start);
    let from = free_checker.select(start);
    let mut accept = |checker: &mut Subspace<'_, C>, q: &[f64]| {
        let all = checker.embed(q);
        motion.check(checker.whole(), &all, &mut perturbing)
    };
    let mut rng = seed.split("explore").rng();
    let mut solution = explore(&mut free_checker, None, &from, &mut accept, options, budget, &mut rng)?;
    solution.path = solution.path.iter().map(|q| free_checker.embed(q)).collect();
    let last = solution.path.last().map_or(start, Vec::as_slice);
    let motion = motion.states_from(last);
    solution.path.extend(motion.into_iter().skip(1));
    Ok(solution)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edge::walk_path;
    use crate::testbed::{self, OPEN, REST};
    use crate::toy::Toy;

    #[test]
    fn the_free_coordinate_makes_way_for_the_fixed_one() {
        // x is free, y shall go from 1 to 9; a shelf is above x < 6.
        let boxes = vec![([0.0, 4.0], [6.0, 5.0])];
        for seed in 0..20 {
            let mut toy = Toy::new(boxes.clone(), 0.02);
            toy.padding = 0.01;
            let motion = FixedMotion { ball: 0.3, ..FixedMotion::straight(&[1], &[2.0, 1.0], &[9.0]) };
            let solution = make_way(
                &mut toy,
                &[2.0, 1.0],
                &motion,
                &ExploreOptions::default(),
                &Budget::unlimited(),
                Seed::new(seed),
            )
            .unwrap();
            walk_path(&mut Toy::new(boxes.clone(), 0.001), &solution.path).unwrap();
            let [.., before, end] = solution.path.as_slice() else { panic!("two states at least") };
            assert_eq!((before[1], end[1]), (1.0, 9.0));
            assert!(before[0] == end[0] && end[0] > 6.0);
            assert!(solution.statistics.refused.contains_key(&Obstruction::Contact(0)));
        }
    }

    #[test]
    fn ends_are_robust() {
        // Two posts leave a gap of 0.4 at x = 5 to 5.4, and one of 2 at x > 8; the end is between the posts.
        let boxes = vec![([0.0, 8.0], [5.0, 10.0]), ([5.4, 8.0], [8.0, 10.0])];
        let run = |ball: f64| {
            let mut toy = Toy::new(boxes.clone(), 0.02);
            toy.clearance = false;
            let motion =
                FixedMotion { ball, perturbations: 200, ..FixedMotion::straight(&[1], &[5.2, 1.0], &[9.0]) };
            let options = ExploreOptions::default();
            make_way(&mut toy, &[5.2, 1.0], &motion, &options, &Budget::unlimited(), Seed::new(2)).unwrap()
        };
        assert_eq!(run(0.1).path.len(), 2, "in the small gap there is room for a small ball");
        assert!(run(0.5).path.last().unwrap()[0] > 8.4, "a large one needs the large gap");
    }

    #[test]
    fn failures_say_why() {
        // The shelf is above everything.
        let boxes = vec![([0.0, 4.0], [10.0, 5.0])];
        let motion = FixedMotion::straight(&[1], &[2.0, 1.0], &[9.0]);
        let options = ExploreOptions { max_iterations: 200, ..ExploreOptions::default() };
        let run = |start: [f64; 2], budget: &Budget<'_>| {
            let mut toy = Toy::new(boxes.clone(), 0.02);
            make_way(&mut toy, &start, &motion, &options, budget, Seed::new(1)).unwrap_err()
        };
        let failure = run([2.0, 1.0], &Budget::unlimited());
        assert_eq!(failure.reason, ExploreFailureReason::Iterations);
        assert!(failure.statistics.nodes > 50 && failure.statistics.iterations == 200);
        assert_eq!(failure.statistics.refused.keys().collect::<Vec<_>>(), [&Obstruction::Contact(0)]);
        let start = run([2.0, 4.5], &Budget::unlimited());
        assert_eq!(start.reason, ExploreFailureReason::Start(Obstruction::Contact(0)));
        let spent = || Some(Interrupt::TimeUp);
        let stopped = run([2.0, 1.0], &Budget::new(&spent));
        assert_eq!(stopped.reason, ExploreFailureReason::Interrupted(Interrupt::TimeUp));
    }

    #[test]
    fn an_arm_moves_its_gripper_to_where_it_can_open() {
        let robot = testbed::robot(false);
        let arm = testbed::arm(false);
        let mut q = testbed::rest(&robot);
        q.set(&robot.grippers[0].dofs, &[0.01]);
        // A post on either side of the closed fingers.
        let tip = arm.world_from_tool(&REST).translation.vector;
        let post = |y: f64| ([0.03, 0.02, 0.14], [tip.x, tip.y + y, tip.z - 0.03]);
        let scene = testbed::scene(&robot, &[post(0.055), post(-0.055)]);
        let (space, dofs) = testbed::arm_and_fingers(&robot);
        let mut checker = crate::scene::RobotChecker::new(
            &scene,
            &space,
            &dofs,
            &q,
            crate::scene::Rules { margin: 0.002, ..Default::default() },
            0.004,
        );
        let start = q.select(&dofs);
        let motion = FixedMotion::straight(&[6], &start, &[OPEN]);
        let mut rng = Seed::new(1).rng();
        assert!(motion.check(&mut checker, &start, &mut rng).is_err(), "the fingers cannot open here");
        let options = ExploreOptions { step: 0.03, ..ExploreOptions::default() };
        let solution =
            make_way(&mut checker, &start, &motion, &options, &Budget::unlimited(), Seed::new(1)).unwrap();
        walk_path(&mut checker, &solution.path).unwrap();
        assert_eq!(solution.path.last().unwrap()[6], OPEN);
    }
}
