//! The tree of tool poses that grows from the goals.

use super::workspace::Workspace;
use robotc_core::rng::Rng;

/// Poses with their parents; the roots are the goals, in their order.
pub(super) struct GoalTree<P> {
    points: Vec<P>,
    /// Parent of each node; roots are their own parents.
    parents: Vec<usize>,
    /// How often following ended at each node.
    dead_ends: Vec<u32>,
}

impl<P: Clone> GoalTree<P> {
    pub(super) fn new(goals: &[P]) -> Self {
        Self { points: goals.to_vec(), parents: (0..goals.len()).collect(), dead_ends: vec![0; goals.len()] }
    }

    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    pub(super) fn point(&self, node: usize) -> &P {
        &self.points[node]
    }

    /// The next node on the way to the goal; `None` at the goal.
    pub(super) fn parent(&self, node: usize) -> Option<usize> {
        let parent = self.parents[node];
        (parent != node).then_some(parent)
    }

    /// Remembers that following ended at a node.
    pub(super) fn note_dead_end(&mut self, node: usize) {
        self.dead_ends[node] += 1;
    }

    /// How often following ended anywhere between a node and its goal; what ended at the goal itself came from elsewhere.
    pub(super) fn dead_ends(&self, mut node: usize) -> u32 {
        let mut sum = 0;
        while let Some(parent) = self.parent(node) {
            sum += self.dead_ends[node];
            node = parent;
        }
        sum
    }

    /// The number of the goal that a node leads to.
    pub(super) fn root(&self, mut node: usize) -> usize {
        while let Some(parent) = self.parent(node) {
            node = parent;
        }
        node
    }

    /// The node nearest to a pose; the first of equals.
    pub(super) fn nearest<W: Workspace<Point = P> + ?Sized>(&self, workspace: &W, point: &P) -> usize {
        let mut best = (f64::INFINITY, 0);
        for (node, other) in self.points.iter().enumerate() {
            let distance = workspace.distance(other, point);
            if distance < best.0 {
                best = (distance, node);
            }
        }
        best.1
    }

    /// One step towards a random pose, or now and then towards `start`; kept when the tool may go there and `supported` agrees.
    pub(super) fn extend<W: Workspace<Point = P> + ?Sized>(
        &mut self,
        workspace: &mut W,
        start: &P,
        start_bias: f64,
        step: f64,
        rng: &mut Rng,
        supported: &mut dyn FnMut(&mut W, &P, &mut Rng) -> bool,
    ) {
        let target = if rng.unit() < start_bias { start.clone() } else { workspace.sample(rng) };
        let near = self.nearest(workspace, &target);
        let next = workspace.toward(&self.points[near], &target, step);
        if workspace.tool_motion(&self.points[near], &next) && supported(workspace, &next, rng) {
            self.points.push(next);
            self.parents.push(near);
            self.dead_ends.push(0);
        }
    }
}
