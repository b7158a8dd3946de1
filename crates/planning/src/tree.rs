//! A search tree in flat arrays that grow with use.

use crate::space::Space;

/// States with their parents; several roots are allowed.
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    dimension: usize,
    states: Vec<f64>,
    /// Parent of each node; roots are their own parents.
    parents: Vec<u32>,
    /// Number given to the root that each node hangs on.
    roots: Vec<u32>,
}

impl Tree {
    pub(crate) fn new(dimension: usize) -> Self {
        Self { dimension, states: Vec::new(), parents: Vec::new(), roots: Vec::new() }
    }

    pub(crate) fn len(&self) -> usize {
        self.parents.len()
    }

    pub(crate) fn state(&self, node: usize) -> &[f64] {
        &self.states[node * self.dimension..(node + 1) * self.dimension]
    }

    /// The number of the root that a node hangs on.
    pub(crate) fn root(&self, node: usize) -> usize {
        self.roots[node] as usize
    }

    pub(crate) fn push_root(&mut self, q: &[f64], number: usize) -> usize {
        let node = self.len();
        self.states.extend_from_slice(q);
        self.parents.push(node as u32);
        self.roots.push(number as u32);
        node
    }

    pub(crate) fn push(&mut self, parent: usize, q: &[f64]) -> usize {
        let node = self.len();
        self.states.extend_from_slice(q);
        self.parents.push(parent as u32);
        self.roots.push(self.roots[parent]);
        node
    }

    /// The node nearest to `q`; the first of equals. The tree must not be empty.
    pub(crate) fn nearest(&self, space: &Space, q: &[f64]) -> usize {
        self.nearest_by(|_, state| space.squared_distance(state, q))
    }

    /// The node with the smallest value of `distance`, which is given node and state; the first of equals.
    pub(crate) fn nearest_by(&self, distance: impl Fn(usize, &[f64]) -> f64) -> usize {
        let mut best = (f64::INFINITY, 0);
        for (node, state) in self.states.chunks_exact(self.dimension).enumerate() {
            let distance = distance(node, state);
            if distance < best.0 {
                best = (distance, node);
            }
        }
        best.1
    }

    /// States from `node` to its root, both included.
    pub(crate) fn path_to_root(&self, mut node: usize) -> Vec<Vec<f64>> {
        let mut path = vec![self.state(node).to_vec()];
        while self.parents[node] as usize != node {
            node = self.parents[node] as usize;
            path.push(self.state(node).to_vec());
        }
        path
    }

    /// Parent and child states of all edges, in order of growth.
    pub(crate) fn edges(&self) -> impl Iterator<Item = (&[f64], &[f64])> {
        let children = (0..self.len()).filter(|&n| self.parents[n] as usize != n);
        children.map(|n| (self.state(self.parents[n] as usize), self.state(n)))
    }
}
