//! RRT-Connect with goals sampled during the search (thesis algorithm 3.1, after Kuffner and LaValle, 2000).
//!
//! Two forests grow towards each other: one from the start, one whose roots are the goals drawn so far. The forest
//! with fewer nodes is grown next, so that a cramped goal does not starve the other side.

use std::collections::BTreeMap;
use std::fmt;

use robotc_core::rng::Rng;
use serde::{Deserialize, Serialize};

use crate::budget::{Budget, Interrupt};
use crate::constraint::Constraint;
use crate::edge::{Blocked, EdgeChecker, Obstruction};
use crate::goal::{GoalDraw, GoalSampler};
use crate::tree::Tree;

/// Parameters of a search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RrtOptions {
    /// Longest edge, as a fraction of the diameter of the space.
    pub step: f64,
    /// Share of samples drawn near a random node of the growing forest, no farther than the longest edge, rather than
    /// anywhere: they find the way out of cramped places, where long motions are all blocked.
    pub local: f64,
    /// A goal is asked for every this many iterations, once the first is known.
    pub goal_period: u32,
    /// Iterations after which the search gives up.
    pub max_iterations: u32,
    /// Draws without a first goal after which the search gives up.
    pub max_goal_draws: u32,
}

impl Default for RrtOptions {
    fn default() -> Self {
        Self { step: 0.1, local: 0.3, goal_period: 50, max_iterations: 20_000, max_goal_draws: 10_000 }
    }
}

/// Two states, one of each forest, that a search could not join.
#[derive(Debug, Clone, PartialEq)]
pub struct Gap {
    /// Between them, in the metric of the space.
    pub distance: f64,
    /// Reached from the start.
    pub from_start: Vec<f64>,
    /// Reached from a goal.
    pub from_goal: Vec<f64>,
}

/// What a search did.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RrtStatistics {
    /// Iterations run.
    pub iterations: u32,
    /// Goals drawn.
    pub goals: u32,
    /// Nodes of the forest that grew from the start.
    pub start_nodes: usize,
    /// Nodes of the forest that grew from the goals.
    pub goal_nodes: usize,
    /// Edges asked for.
    pub edges: u32,
    /// How many edges each obstruction stopped.
    pub blocked: BTreeMap<Obstruction, u32>,
    /// The smallest gap that was left when forests were to be joined.
    pub nearest: Option<Gap>,
}

/// A path from start to goal.
#[derive(Debug, Clone, PartialEq)]
pub struct RrtSolution {
    /// States from start to goal; the straight motions between them are valid.
    pub path: Vec<Vec<f64>>,
    /// Number of the goal reached, in the order of drawing.
    pub goal: usize,
    /// What it took.
    pub statistics: RrtStatistics,
}

/// Why there is no path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RrtFailureReason {
    /// The start itself is invalid.
    Start(Obstruction),
    /// The sampler had no goal to give.
    NoGoal,
    /// The limit on iterations was reached.
    Iterations,
    /// The budget ended.
    Interrupted(Interrupt),
}

/// Why there is no path, and what was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct RrtFailure {
    /// What ended the search.
    pub reason: RrtFailureReason,
    /// What was tried.
    pub statistics: RrtStatistics,
}

impl fmt::Display for RrtFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let s = &self.statistics;
        match self.reason {
            RrtFailureReason::Start(_) => write!(f, "the start is not free"),
            RrtFailureReason::NoGoal => write!(f, "no goal configuration was found"),
            RrtFailureReason::Iterations => {
                write!(f, "no path after {} iterations towards {} goals", s.iterations, s.goals)
            }
            RrtFailureReason::Interrupted(interrupt) => {
                write!(f, "{interrupt} after {} iterations", s.iterations)
            }
        }
    }
}

/// A search that can be continued: with more iterations, or with other goals on the same start tree.
#[derive(Debug, Clone)]
pub struct RrtConnect {
    start: Vec<f64>,
    from_start: Tree,
    from_goals: Tree,
    statistics: RrtStatistics,
}

/// How far one forest got towards a state.
enum Reach {
    /// The node that is the state itself.
    There(usize),
    /// The last node, short of the state.
    Short(usize),
    /// Not a single step.
    Stuck,
}

impl RrtConnect {
    /// A search from `start`.
    pub fn new(start: &[f64]) -> Self {
        let mut from_start = Tree::new(start.len());
        from_start.push_root(start, 0);
        let from_goals = Tree::new(start.len());
        Self { start: start.to_vec(), from_start, from_goals, statistics: RrtStatistics::default() }
    }

    /// Forgets the goals and keeps what is known around the start; goals are numbered from zero again.
    pub fn forget_goals(&mut self) {
        self.from_goals = Tree::new(self.start.len());
        self.statistics.goals = 0;
    }

    /// Edges of both forests, parent then child: for display.
    pub fn edges(&self) -> impl Iterator<Item = (&[f64], &[f64])> {
        self.from_start.edges().chain(self.from_goals.edges())
    }

    /// Grows until the forests meet or a limit is reached.
    ///
    /// Every path returned consists of edges that `checker` found valid; with a `constraint`, of states on it.
    pub fn run<C: EdgeChecker + ?Sized>(
        &mut self,
        checker: &mut C,
        constraint: Option<&dyn Constraint>,
        goals: &mut dyn GoalSampler,
        options: &RrtOptions,
        budget: &Budget<'_>,
        rng: &mut Rng,
    ) -> Result<RrtSolution, RrtFailure> {
        let step = options.step * checker.space().diameter();
        let mut growth = Growth { checker, constraint, step, statistics: &mut self.statistics };
        let outcome = search(
            &mut growth,
            &self.start,
            &mut self.from_start,
            &mut self.from_goals,
            goals,
            options,
            budget,
            rng,
        );
        self.statistics.start_nodes = self.from_start.len();
        self.statistics.goal_nodes = self.from_goals.len();
        let statistics = self.statistics.clone();
        match outcome {
            Ok((a, b)) => {
                let mut path = self.from_start.path_to_root(a);
                path.reverse();
                // Both nodes are the same state; keep it once.
                path.extend(self.from_goals.path_to_root(b).into_iter().skip(1));
                Ok(RrtSolution { path, goal: self.from_goals.root(b), statistics })
            }
            Err(reason) => Err(RrtFailure { reason, statistics }),
        }
    }
}

/// Node of the start forest and node of the goal forest that are the same state.
fn search<C: EdgeChecker + ?Sized>(
    growth: &mut Growth<'_, C>,
    start: &[f64],
    from_start: &mut Tree,
    from_goals: &mut Tree,
    goals: &mut dyn GoalSampler,
    options: &RrtOptions,
    budget: &Budget<'_>,
    rng: &mut Rng,
) -> Result<(usize, usize), RrtFailureReason> {
    growth.checker.state(start).map_err(RrtFailureReason::Start)?;
    let mut exhausted = false;
    let mut draws = 0;
    for iteration in 0..options.max_iterations {
        while !exhausted && (from_goals.len() == 0 || iteration % options.goal_period.max(1) == 0) {
            budget.check().map_err(RrtFailureReason::Interrupted)?;
            match goals.draw(budget).map_err(RrtFailureReason::Interrupted)? {
                GoalDraw::Goal(q) => {
                    let number = growth.statistics.goals as usize;
                    growth.statistics.goals += 1;
                    let root = from_goals.push_root(&q, number);
                    // Most problems are easy: try the straight way to each new goal first.
                    let near = from_start.nearest(growth.checker.space(), &q);
                    match growth.connect(from_start, near, &q) {
                        Reach::There(a) => return Ok((a, root)),
                        Reach::Short(last) => growth.note_gap(from_start.state(last), &q),
                        Reach::Stuck => growth.note_gap(from_start.state(near), &q),
                    }
                    break;
                }
                GoalDraw::Pending if from_goals.len() > 0 => break,
                GoalDraw::Pending => {
                    draws += 1;
                    exhausted = draws >= options.max_goal_draws;
                }
                GoalDraw::Exhausted => exhausted = true,
            }
        }
        if from_goals.len() == 0 {
            return Err(RrtFailureReason::NoGoal);
        }
        budget.check().map_err(RrtFailureReason::Interrupted)?;
        growth.statistics.iterations += 1;

        let grow_start = from_start.len() <= from_goals.len();
        let (grown, other) = if grow_start {
            (&mut *from_start, &mut *from_goals)
        } else {
            (&mut *from_goals, &mut *from_start)
        };
        let local = rng.unit() < options.local;
        let centre = local.then(|| grown.state(rng.below(grown.len())).to_vec());
        let Some(sample) = growth.sample(centre.as_deref(), rng) else { continue };
        let near = grown.nearest(growth.checker.space(), &sample);
        let node = match growth.extend(grown, near, &sample) {
            Reach::There(node) | Reach::Short(node) => node,
            Reach::Stuck => continue,
        };
        let target = grown.state(node).to_vec();
        let near = other.nearest(growth.checker.space(), &target);
        let last = match growth.connect(other, near, &target) {
            Reach::There(met) => return Ok(if grow_start { (node, met) } else { (met, node) }),
            Reach::Short(last) => other.state(last),
            Reach::Stuck => other.state(near),
        };
        if grow_start {
            growth.note_gap(&target, last);
        } else {
            growth.note_gap(last, &target);
        }
    }
    Err(RrtFailureReason::Iterations)
}

/// What both forests need to grow.
struct Growth<'a, C: ?Sized> {
    checker: &'a mut C,
    constraint: Option<&'a dyn Constraint>,
    step: f64,
    statistics: &'a mut RrtStatistics,
}

impl<C: EdgeChecker + ?Sized> Growth<'_, C> {
    /// A state on the constraint, within a step of `centre` if there is one; `None` when the projection failed.
    fn sample(&self, centre: Option<&[f64]>, rng: &mut Rng) -> Option<Vec<f64>> {
        let space = self.checker.space();
        let mut q = match centre {
            None => space.sample(rng),
            Some(centre) => space.sample_near(centre, self.step * rng.unit(), rng),
        };
        match self.constraint {
            Some(constraint) if !constraint.project(&mut q) => None,
            _ => Some(q),
        }
    }

    /// One step from `node` towards `target`.
    fn extend(&mut self, tree: &mut Tree, node: usize, target: &[f64]) -> Reach {
        let space = self.checker.space();
        let from = tree.state(node);
        let distance = space.distance(from, target);
        if distance == 0.0 {
            return Reach::There(node);
        }
        let arrives = distance <= self.step;
        let mut q =
            if arrives { target.to_vec() } else { space.interpolate(from, target, self.step / distance) };
        if let (Some(constraint), false) = (self.constraint, arrives) {
            // A projection that jumps, or that leads back, makes no progress along the constraint.
            let useful = constraint.project(&mut q)
                && space.distance(from, &q) <= 2.0 * self.step
                && space.distance(&q, target) < distance - 0.1 * self.step;
            if !useful {
                return Reach::Stuck;
            }
        }
        self.statistics.edges += 1;
        match self.checker.edge(from, &q) {
            Ok(()) => {
                let new = tree.push(node, &q);
                if arrives { Reach::There(new) } else { Reach::Short(new) }
            }
            Err(Blocked { by, .. }) => {
                *self.statistics.blocked.entry(by).or_insert(0) += 1;
                Reach::Stuck
            }
        }
    }

    /// Remembers the gap between two states that could not be joined, if it is the smallest.
    fn note_gap(&mut self, from_start: &[f64], from_goal: &[f64]) {
        let distance = self.checker.space().distance(from_start, from_goal);
        if self.statistics.nearest.as_ref().is_none_or(|least| distance < least.distance) {
            let (from_start, from_goal) = (from_start.to_vec(), from_goal.to_vec());
            self.statistics.nearest = Some(Gap { distance, from_start, from_goal });
        }
    }

    /// Steps from `node` towards `target` until there or stuck.
    fn connect(&mut self, tree: &mut Tree, mut node: usize, target: &[f64]) -> Reach {
        let mut reach = Reach::Stuck;
        loop {
            match self.extend(tree, node, target) {
                Reach::Short(next) => {
                    node = next;
                    reach = Reach::Short(next);
                }
                Reach::Stuck => return reach,
                there => return there,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::edge::walk_path;
    use crate::goal::FixedGoals;
    use crate::toy::Toy;
    use robotc_core::Seed;

    fn run(toy: &mut Toy, goals: &mut dyn GoalSampler, seed: u64) -> Result<RrtSolution, RrtFailure> {
        let options = RrtOptions { max_iterations: 2000, ..RrtOptions::default() };
        let mut search = RrtConnect::new(&[1.0, 1.0]);
        search.run(toy, None, goals, &options, &Budget::unlimited(), &mut Seed::new(seed).rng())
    }

    #[test]
    fn goes_round_a_wall_with_every_seed() {
        for seed in 0..50 {
            let mut toy = Toy::wall(0.05);
            toy.padding = 0.025;
            let solution = run(&mut toy, &mut FixedGoals::new(vec![vec![9.0, 1.0]]), seed).unwrap();
            assert_eq!(solution.path[0], [1.0, 1.0]);
            assert_eq!(solution.path[solution.path.len() - 1], [9.0, 1.0]);
            // Padded by half the resolution, edges are free without gaps: a much finer walk finds nothing.
            walk_path(&mut Toy::wall(0.0005), &solution.path).unwrap();
        }
    }

    #[test]
    fn runs_repeat_by_seed() {
        let path =
            |seed| run(&mut Toy::wall(0.05), &mut FixedGoals::new(vec![vec![9.0, 1.0]]), seed).unwrap();
        assert_eq!(path(3), path(3));
        assert_ne!(path(3).path, path(4).path);
    }

    #[test]
    fn a_goal_that_comes_later_is_reached() {
        /// A goal in a closed room first; the good one only after `wait` draws.
        struct Late {
            wait: u32,
        }
        impl GoalSampler for Late {
            fn draw(&mut self, _: &Budget<'_>) -> Result<GoalDraw, Interrupt> {
                self.wait = self.wait.saturating_sub(1);
                Ok(match self.wait {
                    9 => GoalDraw::Goal(vec![8.0, 8.0]),
                    1 => GoalDraw::Goal(vec![1.0, 9.0]),
                    0 => GoalDraw::Exhausted,
                    _ => GoalDraw::Pending,
                })
            }
        }
        let solution = run(&mut Toy::room(0.05), &mut Late { wait: 12 }, 5).unwrap();
        assert_eq!(solution.goal, 1);
        assert_eq!(solution.statistics.goals, 2);
        assert_eq!(solution.path.last().unwrap(), &[1.0, 9.0]);
    }

    #[test]
    fn failures_say_why() {
        let closed = run(&mut Toy::room(0.05), &mut FixedGoals::new(vec![vec![8.0, 8.0]]), 1).unwrap_err();
        assert_eq!(closed.reason, RrtFailureReason::Iterations);
        assert!(closed.statistics.blocked.keys().any(|o| matches!(o, Obstruction::Contact(_))));
        assert!(closed.statistics.start_nodes > 10 && closed.statistics.goal_nodes > 10);
        // The walls of the room are half a unit thick.
        let nearest = closed.statistics.nearest.unwrap();
        assert!((0.5..1.5).contains(&nearest.distance), "{nearest:?}");
        assert!(nearest.from_goal.iter().all(|x| (6.5..=9.5).contains(x)), "{nearest:?}");

        let none = run(&mut Toy::room(0.05), &mut FixedGoals::default(), 1).unwrap_err();
        assert_eq!(none.reason, RrtFailureReason::NoGoal);

        let mut covered = Toy::new(vec![([0.0, 0.0], [2.0, 2.0])], 0.05);
        let start = run(&mut covered, &mut FixedGoals::default(), 1).unwrap_err();
        assert_eq!(start.reason, RrtFailureReason::Start(Obstruction::Contact(0)));
    }

    #[test]
    fn budgets_are_honoured_and_searches_continue() {
        let calls = std::cell::Cell::new(0);
        let interrupt = || {
            calls.set(calls.get() + 1);
            (calls.get() > 5).then_some(Interrupt::TimeUp)
        };
        let (mut toy, mut rng) = (Toy::wall(0.05), Seed::new(1).rng());
        let options = RrtOptions { step: 0.02, ..RrtOptions::default() };
        let mut search = RrtConnect::new(&[1.0, 1.0]);
        let mut goals = FixedGoals::new(vec![vec![9.0, 1.0]]);
        let stopped =
            search.run(&mut toy, None, &mut goals, &options, &Budget::new(&interrupt), &mut rng).unwrap_err();
        assert_eq!(stopped.reason, RrtFailureReason::Interrupted(Interrupt::TimeUp));
        assert!(stopped.statistics.iterations <= 5);
        let done = search.run(&mut toy, None, &mut goals, &options, &Budget::unlimited(), &mut rng).unwrap();
        assert!(done.statistics.iterations > stopped.statistics.iterations);

        search.forget_goals();
        let mut other = FixedGoals::new(vec![vec![9.0, 9.0]]);
        let again = search.run(&mut toy, None, &mut other, &options, &Budget::unlimited(), &mut rng).unwrap();
        assert_eq!(again.path.last().unwrap(), &[9.0, 9.0]);
    }

    #[test]
    fn constrained_paths_stay_on_the_constraint() {
        /// The circle of radius 4 around the middle.
        struct Circle;
        impl Constraint for Circle {
            fn holds(&self, q: &[f64]) -> bool {
                ((q[0] - 5.0).hypot(q[1] - 5.0) - 4.0).abs() < 1e-9
            }
            fn size(&self, _: &[f64]) -> f64 {
                0.0
            }
            fn project(&self, q: &mut [f64]) -> bool {
                let (x, y) = (q[0] - 5.0, q[1] - 5.0);
                let r = x.hypot(y);
                (q[0], q[1]) = (5.0 + 4.0 * x / r, 5.0 + 4.0 * y / r);
                r > 1e-9
            }
        }
        let mut toy = Toy::new(vec![([4.0, 8.0], [6.0, 10.0])], 0.02);
        let options = RrtOptions { step: 0.05, ..RrtOptions::default() };
        let mut search = RrtConnect::new(&[1.0, 5.0]);
        let mut goals = FixedGoals::new(vec![vec![9.0, 5.0]]);
        let mut rng = Seed::new(2).rng();
        let solution = search
            .run(&mut toy, Some(&Circle), &mut goals, &options, &Budget::unlimited(), &mut rng)
            .unwrap();
        for q in &solution.path {
            assert!(((q[0] - 5.0).hypot(q[1] - 5.0) - 4.0).abs() < 1e-9, "{q:?}");
        }
        assert!(solution.path.iter().any(|q| q[1] < 1.5), "the way is below, since the top is blocked");
    }
}
