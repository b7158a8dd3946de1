//! A tree of boxes: median splits, the same tree for the same boxes.

use nalgebra::{Point3, Vector3};

use super::Aabb;

/// Most items of a leaf.
const LEAF_ITEMS: usize = 4;

#[derive(Debug, Clone)]
enum Node {
    /// Items `first..first + count` of the order.
    Leaf { first: u32, count: u32 },
    /// The left child follows; this is the right one.
    Inner { right: u32 },
}

/// A binary tree over boxed items.
#[derive(Debug, Clone, Default)]
pub(super) struct Bvh {
    nodes: Vec<(Aabb, Node)>,
    order: Vec<u32>,
}

impl Bvh {
    /// The tree over items with these boxes.
    pub(super) fn new(boxes: &[Aabb]) -> Self {
        let mut bvh = Self { nodes: Vec::new(), order: (0..boxes.len() as u32).collect() };
        if !boxes.is_empty() {
            let mut order = std::mem::take(&mut bvh.order);
            bvh.build(boxes, &mut order, 0);
            bvh.order = order;
        }
        bvh
    }

    fn build(&mut self, boxes: &[Aabb], items: &mut [u32], first: usize) {
        let bounds = items.iter().map(|&i| boxes[i as usize]).reduce(|a, b| a.union(&b));
        let bounds = bounds.expect("a node has items");
        let here = self.nodes.len();
        self.nodes.push((bounds, Node::Leaf { first: first as u32, count: items.len() as u32 }));
        if items.len() <= LEAF_ITEMS {
            return;
        }
        let doubled_centre = |i: u32| boxes[i as usize].low.coords + boxes[i as usize].high.coords;
        let spread = items.iter().map(|&i| doubled_centre(i)).fold(None, |acc, c| match acc {
            None => Some((c, c)),
            Some((low, high)) => Some((low.inf(&c), high.sup(&c))),
        });
        let (low, high) = spread.expect("a node has items");
        let axis = (high - low).imax();
        let key = |i: &u32| doubled_centre(*i)[axis];
        items.sort_by(|a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        let middle = items.len() / 2;
        let (left, right) = items.split_at_mut(middle);
        self.build(boxes, left, first);
        let right_node = self.nodes.len() as u32;
        self.build(boxes, right, first + middle);
        self.nodes[here].1 = Node::Inner { right: right_node };
    }

    /// Visits items whose boxes the ray may meet at a distance in `0..=limit()`, nearer boxes first; `visit` may
    /// lower the limit by returning a new one.
    pub(super) fn ray(
        &self,
        origin: &Point3<f64>,
        direction: &Vector3<f64>,
        limit: f64,
        mut visit: impl FnMut(u32, f64) -> f64,
    ) {
        let inverse = direction.map(|x| 1.0 / x);
        self.search(
            limit,
            |bounds, limit| Some(bounds.ray_interval(origin, &inverse, (0.0, limit))?.0),
            &mut visit,
        );
    }

    /// Visits items whose boxes are within the limit of `point`, nearer boxes first, as for [`Bvh::ray`].
    pub(super) fn near(&self, point: &Point3<f64>, limit: f64, mut visit: impl FnMut(u32, f64) -> f64) {
        let reach = |bounds: &Aabb, limit: f64| {
            let distance = bounds.distance_to(point);
            (distance <= limit).then_some(distance)
        };
        self.search(limit, reach, &mut visit);
    }

    fn search(
        &self,
        mut limit: f64,
        reach: impl Fn(&Aabb, f64) -> Option<f64>,
        visit: &mut impl FnMut(u32, f64) -> f64,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let mut stack = vec![(0.0, 0_u32)];
        while let Some((at, node)) = stack.pop() {
            if at > limit {
                continue;
            }
            match self.nodes[node as usize].1 {
                Node::Leaf { first, count } => {
                    for &item in &self.order[first as usize..(first + count) as usize] {
                        limit = limit.min(visit(item, limit));
                    }
                }
                Node::Inner { right } => {
                    let near = |n: u32| reach(&self.nodes[n as usize].0, limit).map(|at| (at, n));
                    match (near(node + 1), near(right)) {
                        (Some(a), Some(b)) if a.0 <= b.0 => stack.extend([b, a]),
                        (a, b) => stack.extend(a.into_iter().chain(b)),
                    }
                }
            }
        }
    }
}
