//! The tree of configurations that grows from the start.

use std::collections::BTreeMap;

use robotc_core::rng::Rng;

use super::metric::{Mixed, TreeMetric, nearness};
use super::workspace::Workspace;
use crate::edge::{Blocked, EdgeChecker, Obstruction};
use crate::tree::Tree;

/// A tree that knows how near it is to the goals.
pub(super) struct Forward<'g, P> {
    pub(super) tree: Tree,
    goals: &'g [P],
    /// How near the base of each node is to the nearest goal, 0 to 1.
    nearness: Vec<f64>,
    /// The smallest distance of a node's tool to a goal: distance, node, goal.
    pub(super) nearest: (f64, usize, usize),
    pub(super) blocked: BTreeMap<Obstruction, u32>,
}

impl<'g, P: Clone> Forward<'g, P> {
    pub(super) fn new<W: Workspace<Point = P> + ?Sized>(
        workspace: &W,
        start: &[f64],
        goals: &'g [P],
    ) -> Self {
        let mut forward = Self {
            tree: Tree::new(start.len()),
            goals,
            nearness: Vec::new(),
            nearest: (f64::INFINITY, 0, 0),
            blocked: BTreeMap::new(),
        };
        let root = forward.tree.push_root(start, 0);
        forward.note(workspace, root);
        forward
    }

    /// The goals of the tool.
    pub(super) fn goals(&self) -> &'g [P] {
        self.goals
    }

    pub(super) fn push<W: Workspace<Point = P> + ?Sized>(
        &mut self,
        workspace: &W,
        parent: usize,
        q: &[f64],
    ) -> usize {
        let node = self.tree.push(parent, q);
        self.note(workspace, node);
        node
    }

    /// Finds out how near a new node is to the goals.
    fn note<W: Workspace<Point = P> + ?Sized>(&mut self, workspace: &W, node: usize) {
        let q = self.tree.state(node);
        let point = workspace.point(q);
        let mut best: f64 = 0.0;
        for (number, goal) in self.goals.iter().enumerate() {
            best = best.max(nearness(workspace.base_distance(q, goal), workspace.reach()));
            let distance = workspace.distance(&point, goal);
            if distance < self.nearest.0 {
                self.nearest = (distance, node, number);
            }
        }
        self.nearness.push(best);
    }

    pub(super) fn nearness(&self, node: usize) -> f64 {
        self.nearness[node]
    }

    /// Checks an edge and counts what stops it.
    pub(super) fn is_free<C: EdgeChecker + ?Sized>(
        &mut self,
        checker: &mut C,
        from: &[f64],
        to: &[f64],
    ) -> bool {
        match checker.edge(from, to) {
            Ok(()) => true,
            Err(Blocked { by, .. }) => {
                *self.blocked.entry(by).or_insert(0) += 1;
                false
            }
        }
    }

    /// One step towards a random configuration: the new node, unless the way is blocked.
    pub(super) fn extend<W: Workspace<Point = P> + ?Sized, C: EdgeChecker + ?Sized>(
        &mut self,
        workspace: &W,
        checker: &mut C,
        metric: TreeMetric,
        step: f64,
        rng: &mut Rng,
    ) -> Option<usize> {
        let space = checker.space();
        let sample = space.sample(rng);
        let mixed = Mixed::new(space, workspace.base());
        let distance = |node: usize, q: &[f64]| match metric {
            TreeMetric::Plain => space.distance(q, &sample),
            TreeMetric::Mixed => mixed.distance(self.nearness[node], q, &sample),
        };
        let near = self.tree.nearest_by(distance);
        let from = self.tree.state(near).to_vec();
        let length = distance(near, &from);
        let longest = step
            * match metric {
                TreeMetric::Plain => space.diameter(),
                TreeMetric::Mixed => mixed.diameter(),
            };
        let q = if length > longest { space.interpolate(&from, &sample, longest / length) } else { sample };
        if self.is_free(checker, &from, &q) { Some(self.push(workspace, near, &q)) } else { None }
    }
}
