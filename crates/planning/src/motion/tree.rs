//! A search tree in flat memory that is kept from one search to the next.

use std::f32::consts::TAU;

use pulp::NullaryFnOnce;

use crate::space::Space;

/// States with their parents; the first is the root.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    dimension: usize,
    states: Vec<f64>,
    parents: Vec<u32>,
    /// Whether the motion from the parent is proven free.
    proven: Vec<bool>,
    /// For each node, how far away samples may be for it to be extended.
    domains: Vec<f64>,
    /// The states once more, weighted, in single precision: for each block of nodes a row for each coordinate, filled up with infinity.
    rows: Vec<[f32; BLOCK]>,
    /// For each coordinate, a turn in its row; infinite when it does not wrap.
    turns: Vec<f32>,
    /// The state that the nearest node is looked for, as in the rows.
    query: Vec<f32>,
    arch: pulp::Arch,
}

/// Distances that are computed together.
const BLOCK: usize = 16;

impl Tree {
    pub(super) fn new(space: &Space) -> Self {
        let turn =
            |axis: &crate::space::Axis| if axis.wraps { TAU * axis.weight as f32 } else { f32::INFINITY };
        Self {
            dimension: space.dimension(),
            states: Vec::new(),
            parents: Vec::new(),
            proven: Vec::new(),
            domains: Vec::new(),
            rows: Vec::new(),
            turns: space.axes().iter().map(turn).collect(),
            query: Vec::new(),
            arch: pulp::Arch::new(),
        }
    }

    /// Forgets everything but the memory and starts from a root.
    pub(super) fn plant(&mut self, space: &Space, root: &[f64]) {
        self.states.clear();
        self.parents.clear();
        self.proven.clear();
        self.domains.clear();
        self.rows.clear();
        self.push(space, 0, root, true);
    }

    pub(super) fn len(&self) -> usize {
        self.parents.len()
    }

    pub(super) fn state(&self, node: usize) -> &[f64] {
        &self.states[node * self.dimension..(node + 1) * self.dimension]
    }

    pub(super) fn push(&mut self, space: &Space, parent: usize, q: &[f64], proven: bool) -> usize {
        let node = self.len();
        self.states.extend_from_slice(q);
        self.parents.push(parent as u32);
        self.proven.push(proven);
        self.domains.push(f64::INFINITY);
        if node.is_multiple_of(BLOCK) {
            self.rows.resize(self.rows.len() + self.dimension, [f32::INFINITY; BLOCK]);
        }
        let first = self.first_row(node);
        for ((row, axis), &x) in self.rows[first..].iter_mut().zip(space.axes()).zip(q) {
            row[node % BLOCK] = place(axis, x);
        }
        node
    }

    /// The first row of the block of a node.
    fn first_row(&self, node: usize) -> usize {
        node / BLOCK * self.dimension
    }

    /// The node nearest to `q` and its distance. Nodes that are equally near but for rounding count as equal; the first of
    /// them is taken.
    pub(super) fn nearest(&mut self, space: &Space, q: &[f64]) -> (usize, f64) {
        self.query.clear();
        self.query.extend(space.axes().iter().zip(q).map(|(axis, &x)| place(axis, x)));
        let Self { rows, turns, query, dimension, .. } = &*self;
        let node = self.arch.dispatch(Nearest { rows, turns, query, dimension: *dimension });
        (node, space.distance(self.state(node), q))
    }

    /// How far away samples may be for a node to be extended.
    pub(super) fn domain(&mut self, node: usize) -> &mut f64 {
        &mut self.domains[node]
    }

    /// The first motion on the way from the root to `node` that is not proven: the node at its end.
    pub(super) fn first_unproven(&self, mut node: usize) -> Option<usize> {
        let mut found = None;
        while node != 0 {
            if !self.proven[node] {
                found = Some(node);
            }
            node = self.parents[node] as usize;
        }
        found
    }

    pub(super) fn parent(&self, node: usize) -> usize {
        self.parents[node] as usize
    }

    pub(super) fn prove(&mut self, node: usize) {
        self.proven[node] = true;
    }

    /// Takes a node away with all that hangs on it.
    pub(super) fn prune(&mut self, node: usize) {
        const GONE: u32 = u32::MAX;
        // Parents come before their children, so that one pass finds what goes and where the rest goes.
        let mut place: Vec<u32> = (0..node as u32).collect();
        let mut kept = node;
        for old in node..self.len() {
            let parent = self.parents[old] as usize;
            if old == node || place[parent] == GONE {
                place.push(GONE);
                continue;
            }
            place.push(kept as u32);
            self.parents[kept] = place[parent];
            self.proven[kept] = self.proven[old];
            self.domains[kept] = self.domains[old];
            let from = old * self.dimension;
            self.states.copy_within(from..from + self.dimension, kept * self.dimension);
            let (source, target) = (self.first_row(old), self.first_row(kept));
            for i in 0..self.dimension {
                self.rows[target + i][kept % BLOCK] = self.rows[source + i][old % BLOCK];
            }
            kept += 1;
        }
        self.rows.truncate(kept.div_ceil(BLOCK) * self.dimension);
        let last = self.first_row(kept);
        self.rows.iter_mut().skip(last).for_each(|row| row[kept % BLOCK..].fill(f32::INFINITY));
        self.parents.truncate(kept);
        self.proven.truncate(kept);
        self.domains.truncate(kept);
        self.states.truncate(kept * self.dimension);
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

/// The nearest node, by rows of coordinates.
struct Nearest<'a> {
    rows: &'a [[f32; BLOCK]],
    turns: &'a [f32],
    query: &'a [f32],
    dimension: usize,
}

impl NullaryFnOnce for Nearest<'_> {
    type Output = usize;

    #[inline(always)]
    fn call(self) -> usize {
        // For each place in a block, the least square so far and the block that it is in.
        let (mut least, mut blocks) = ([f32::INFINITY; BLOCK], [0_u32; BLOCK]);
        for (block, rows) in self.rows.chunks_exact(self.dimension).enumerate() {
            let mut squares = [0.0_f32; BLOCK];
            for ((row, &x), &turn) in rows.iter().zip(self.query).zip(self.turns) {
                if turn.is_finite() {
                    for k in 0..BLOCK {
                        let d = (x - row[k]).abs();
                        let round = (turn - d).abs();
                        let d = if round < d { round } else { d };
                        squares[k] += d * d;
                    }
                } else {
                    for k in 0..BLOCK {
                        let d = x - row[k];
                        squares[k] += d * d;
                    }
                }
            }
            for k in 0..BLOCK {
                let nearer = squares[k] < least[k];
                least[k] = if nearer { squares[k] } else { least[k] };
                blocks[k] = if nearer { block as u32 } else { blocks[k] };
            }
        }
        let mut nearest = least;
        halve(&mut nearest, |a, b| if b < a { b } else { a });
        let mut nodes = [u32::MAX; BLOCK];
        for k in 0..BLOCK {
            if least[k] == nearest[0] {
                nodes[k] = blocks[k] * BLOCK as u32 + k as u32;
            }
        }
        halve(&mut nodes, |a, b| a.min(b));
        nodes[0] as usize
    }
}

/// Leaves in the first place what `least` makes of all.
#[inline(always)]
fn halve<T: Copy>(values: &mut [T; BLOCK], least: impl Fn(T, T) -> T) {
    let mut half = BLOCK / 2;
    while half > 0 {
        for k in 0..half {
            values[k] = least(values[k], values[k + half]);
        }
        half /= 2;
    }
}

/// A coordinate as it stands in a row; angles that wrap are in one turn.
fn place(axis: &crate::space::Axis, x: f64) -> f32 {
    use std::f64::consts::TAU;
    let x = if axis.wraps { x - TAU * (x / TAU).floor() } else { x };
    (axis.weight * x) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::Axis;
    use robotc_core::Seed;

    #[test]
    fn the_nearest_is_found_after_pruning_too() {
        let heavy = Axis { weight: 2.0, ..Axis::bounded(-4.0, 1.0) };
        let space = Space::new(vec![Axis::wrapping(), heavy, Axis::bounded(0.0, 1.0)]);
        let mut rng = Seed::new(4).rng();
        let mut tree = Tree::new(&space);
        tree.plant(&space, &space.sample(&mut rng));
        for _ in 0..300 {
            // Some a turn away.
            let mut q = space.sample(&mut rng);
            q[0] += std::f64::consts::TAU * rng.below(3) as f64;
            let parent = rng.below(tree.len());
            tree.push(&space, parent, &q, rng.below(2) == 0);
        }
        for _ in 0..20 {
            for _ in 0..20 {
                let q = space.sample(&mut rng);
                let (node, distance) = tree.nearest(&space, &q);
                assert_eq!(distance, space.distance(tree.state(node), &q));
                let least = (0..tree.len()).map(|i| space.distance(tree.state(i), &q));
                assert!(distance <= least.fold(f64::INFINITY, f64::min) + 1e-5);
            }
            let gone = 1 + rng.below(tree.len() - 1);
            let state = tree.state(gone).to_vec();
            let before = tree.len();
            tree.prune(gone);
            assert!(tree.len() < before);
            assert!((0..tree.len()).all(|i| tree.state(i) != state && tree.parent(i) <= i));
            if tree.len() < 100 {
                break;
            }
        }
    }

    #[test]
    fn pruning_keeps_the_ways_of_the_others() {
        let space = Space::new(vec![Axis::bounded(0.0, 9.0)]);
        let mut tree = Tree::new(&space);
        tree.plant(&space, &[0.0]);
        for (parent, x) in [(0, 1.0), (1, 2.0), (0, 3.0), (2, 4.0), (3, 5.0), (5, 6.0)] {
            tree.push(&space, parent, &[x], x == 3.0);
        }
        tree.prune(2);
        assert_eq!(tree.len(), 5);
        assert_eq!(tree.to_root(4), [[6.0], [5.0], [3.0], [0.0]].map(|q| q.to_vec()));
        assert_eq!(tree.first_unproven(4), Some(3));
        assert_eq!(tree.first_unproven(2), None);
    }
}
