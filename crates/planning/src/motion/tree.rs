//! A search tree in flat memory that is kept from one search to the next.

use crate::space::Space;

/// States with their parents; the first is the root.
#[derive(Debug, Clone, Default)]
pub(super) struct Tree {
    dimension: usize,
    states: Vec<f64>,
    parents: Vec<u32>,
}

impl Tree {
    /// Forgets everything but the memory and starts from a root.
    pub(super) fn plant(&mut self, root: &[f64]) {
        self.dimension = root.len();
        self.states.clear();
        self.parents.clear();
        self.push(0, root);
    }

    pub(super) fn len(&self) -> usize {
        self.parents.len()
    }

    pub(super) fn state(&self, node: usize) -> &[f64] {
        &self.states[node * self.dimension..(node + 1) * self.dimension]
    }

    pub(super) fn push(&mut self, parent: usize, q: &[f64]) -> usize {
        let node = self.len();
        self.states.extend_from_slice(q);
        self.parents.push(parent as u32);
        node
    }

    /// The node nearest to `q`, the first of equals, and its distance.
    pub(super) fn nearest(&self, space: &Space, q: &[f64]) -> (usize, f64) {
        let mut best = (0, f64::INFINITY);
        for (node, state) in self.states.chunks_exact(self.dimension).enumerate() {
            let distance = space.squared_distance(state, q);
            if distance < best.1 {
                best = (node, distance);
            }
        }
        (best.0, best.1.sqrt())
    }

    /// States from `node` to the root, both included.
    pub(super) fn to_root(&self, mut node: usize) -> Vec<Vec<f64>> {
        let mut path = vec![self.state(node).to_vec()];
        while node != 0 {
            node = self.parents[node] as usize;
            path.push(self.state(node).to_vec());
        }
        path
    }
}
