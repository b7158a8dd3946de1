//! A* over a grid of two coordinates.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use robotc_core::Seed;
use robotc_planning::problem::{PathFailure, PathFailureReason, PathPlanner, PathSolution, Query};
use robotc_planning::{Blocked, Budget, EdgeChecker, GoalDraw, Obstruction, Space};

/// The shortest path over cells; the problem's option `cells` says how many there are along each axis.
pub(crate) struct Grid;

/// A corner of the grid, or a goal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Node {
    Start,
    Cell(usize, usize),
    Goal(usize),
}

struct Search<'s> {
    checker: &'s mut dyn EdgeChecker,
    cells: usize,
    start: Vec<f64>,
    goals: Vec<Vec<f64>>,
    blocked: BTreeMap<Obstruction, u32>,
}

impl PathPlanner for Grid {
    fn name(&self) -> &str {
        "grid"
    }

    fn summary(&self) -> &str {
        "The shortest path over a grid of two coordinates."
    }

    fn plan(
        &self,
        checker: &mut dyn EdgeChecker,
        query: Query<'_>,
        budget: &Budget<'_>,
        _: Seed,
    ) -> Result<PathSolution, PathFailure> {
        let fail = |reason, iterations, blocked| Err(PathFailure { reason, iterations, blocked });
        if checker.space().dimension() != 2 || query.constraint.is_some() {
            let what = "it needs two coordinates and no constraint".to_owned();
            return fail(PathFailureReason::Unsupported(what), 0, BTreeMap::new());
        }
        if let Err(by) = checker.state(query.start) {
            return fail(PathFailureReason::Start(by), 0, BTreeMap::new());
        }
        let mut goals = Vec::new();
        loop {
            match budget.check().and_then(|()| query.goals.draw(budget)) {
                Ok(GoalDraw::Goal(q)) => goals.push(q),
                Ok(GoalDraw::Pending) => {}
                Ok(GoalDraw::Exhausted) => break,
                Err(interrupt) => return fail(PathFailureReason::Interrupted(interrupt), 0, BTreeMap::new()),
            }
        }
        if goals.is_empty() {
            return fail(PathFailureReason::NoGoal, 0, BTreeMap::new());
        }
        let cells = query.problem.options.get("cells").and_then(|v| v.as_u64()).unwrap_or(50) as usize;
        let start = query.start.to_vec();
        let mut search = Search { checker, cells: cells.max(1), start, goals, blocked: BTreeMap::new() };
        search.run(budget)
    }
}

impl Search<'_> {
    fn run(&mut self, budget: &Budget<'_>) -> Result<PathSolution, PathFailure> {
        // Distances are ordered as bits: they are not negative.
        let mut open = BinaryHeap::from([Reverse((self.to_go(Node::Start).to_bits(), Node::Start))]);
        let mut known: BTreeMap<Node, (f64, Node)> = BTreeMap::from([(Node::Start, (0.0, Node::Start))]);
        let mut iterations = 0;
        while let Some(Reverse((_, node))) = open.pop() {
            if let Err(interrupt) = budget.check() {
                let reason = PathFailureReason::Interrupted(interrupt);
                return Err(PathFailure { reason, iterations, blocked: std::mem::take(&mut self.blocked) });
            }
            iterations += 1;
            if let Node::Goal(goal) = node {
                let mut path = vec![self.state(node)];
                let mut at = node;
                while at != Node::Start {
                    at = known[&at].1;
                    path.push(self.state(at));
                }
                path.reverse();
                return Ok(PathSolution { path, goal, iterations });
            }
            let (so_far, from) = (known[&node].0, self.state(node));
            for next in self.neighbours(node) {
                let to = self.state(next);
                let cost = so_far + self.checker.space().distance(&from, &to);
                if known.get(&next).is_some_and(|(best, _)| *best <= cost) {
                    continue;
                }
                match self.checker.edge(&from, &to) {
                    Ok(()) => {
                        known.insert(next, (cost, node));
                        open.push(Reverse(((cost + self.to_go(next)).to_bits(), next)));
                    }
                    Err(Blocked { by, .. }) => *self.blocked.entry(by).or_insert(0) += 1,
                }
            }
        }
        let blocked = std::mem::take(&mut self.blocked);
        Err(PathFailure { reason: PathFailureReason::Exhausted, iterations, blocked })
    }

    fn state(&self, node: Node) -> Vec<f64> {
        match node {
            Node::Start => self.start.clone(),
            Node::Goal(goal) => self.goals[goal].clone(),
            Node::Cell(x, y) => {
                let axes = self.checker.space().axes();
                let at = |axis: usize, k: usize| {
                    axes[axis].lower + (axes[axis].upper - axes[axis].lower) * k as f64 / self.cells as f64
                };
                vec![at(0, x), at(1, y)]
            }
        }
    }

    /// The distance to the nearest goal: never more than the way.
    fn to_go(&self, node: Node) -> f64 {
        let state = self.state(node);
        let space: &Space = self.checker.space();
        self.goals.iter().map(|goal| space.distance(&state, goal)).fold(f64::INFINITY, f64::min)
    }

    /// Corners around a node, and goals within two cells of it.
    fn neighbours(&self, node: Node) -> Vec<Node> {
        let space = self.checker.space();
        let state = self.state(node);
        let size = |axis: usize| (space.axes()[axis].upper - space.axes()[axis].lower) / self.cells as f64;
        let cell = |axis: usize| ((state[axis] - space.axes()[axis].lower) / size(axis)).round() as i64;
        let mut found = Vec::new();
        for x in cell(0) - 1..=cell(0) + 1 {
            for y in cell(1) - 1..=cell(1) + 1 {
                let inside = |k: i64| (0..=self.cells as i64).contains(&k);
                if inside(x) && inside(y) && Node::Cell(x as usize, y as usize) != node {
                    found.push(Node::Cell(x as usize, y as usize));
                }
            }
        }
        let near = 2.0 * size(0).hypot(size(1));
        let goals = (0..self.goals.len()).filter(|&g| space.distance(&state, &self.goals[g]) <= near);
        found.extend(goals.map(Node::Goal));
        found
    }
}
