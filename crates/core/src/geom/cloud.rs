//! Points that a sensor measured, as a solid.

use nalgebra::Point3;
use thiserror::Error;

use super::{Aabb, Lump};
use crate::model::TriMesh;

/// Points with one radius: the union of balls about them. Metres, in the frame of whatever owns it.
///
/// The points are kept in the leaves of a balanced tree with a box about each node, so that what is asked of a million of them
/// looks at a few. Their order is that of the tree: a function of the points alone, however they were ordered before.
#[derive(Debug, Clone, PartialEq)]
pub struct PointCloud {
    points: Vec<Point3<f64>>,
    radius: f64,
    /// Number of leaves, a power of two.
    leaves: usize,
    /// Boxes about the points of each node, rounded outwards; the children of node `i` are `2 i` and `2 i + 1`, the root is 1.
    nodes: Vec<NodeBox>,
}

/// Lowest x, y, z and highest x, y, z of a box, in single precision and never too small.
pub type NodeBox = [f32; 6];

/// Why points are not a cloud.
#[derive(Debug, Clone, Copy, Error, PartialEq)]
pub enum CloudError {
    /// There is none.
    #[error("a point cloud without points")]
    Empty,
    /// There are too many.
    #[error("a point cloud of more than {most} points", most = PointCloud::MOST_POINTS)]
    TooMany,
    /// A coordinate is not finite, or farther out than any place in a robot's world.
    #[error("point {0} of a cloud has a coordinate that is no number within {far} m", far = PointCloud::FARTHEST)]
    Coordinate(usize),
    /// The radius is not usable.
    #[error("the radius of a point cloud has to be positive and finite")]
    Radius,
}

/// Most points of a leaf.
const LEAF: usize = 8;

impl PointCloud {
    /// Most points of one cloud.
    pub const MOST_POINTS: usize = 1 << 24;

    /// Largest size of a coordinate, metres.
    pub const FARTHEST: f64 = 1e4;

    /// Balls of `radius` metres about these points. It takes about 0.1 s for a million of them.
    pub fn new(mut points: Vec<Point3<f64>>, radius: f64) -> Result<Self, CloudError> {
        if points.is_empty() {
            return Err(CloudError::Empty);
        }
        if points.len() > Self::MOST_POINTS {
            return Err(CloudError::TooMany);
        }
        if !(radius > 0.0 && radius < Self::FARTHEST) {
            return Err(CloudError::Radius);
        }
        // No number is within a bound, either.
        let outside = |p: &Point3<f64>| !p.iter().all(|x| x.abs() <= Self::FARTHEST);
        if let Some(first) = points.iter().position(outside) {
            return Err(CloudError::Coordinate(first));
        }
        // Zero has one sign, so that equal points are equal in every respect.
        points.iter_mut().for_each(|p| p.coords.add_scalar_mut(0.0));
        let leaves = points.len().div_ceil(LEAF).next_power_of_two();
        let mut nodes = vec![[0.0; 6]; 2 * leaves];
        let mut tree = Builder { total: points.len(), leaves, nodes: &mut nodes };
        tree.build(&mut points, 1, 0..leaves);
        Ok(Self { points, radius, leaves, nodes })
    }

    /// The points, in the order of the tree.
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// The cloud of those points that are `kept`; `None` when there is none.
    pub fn filtered(&self, kept: impl FnMut(&Point3<f64>) -> bool) -> Option<Self> {
        let mut kept = kept;
        let points = self.points.iter().filter(|point| kept(point)).copied().collect();
        Self::new(points, self.radius).ok()
    }

    /// Radius of each ball, metres.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The box about the points of a node, without the radius. Nodes count from 1, the root; the children of `node` are `2 node` and
    /// `2 node + 1`.
    pub fn node(&self, node: usize) -> &NodeBox {
        &self.nodes[node]
    }

    /// The points of a leaf: one to eight. `None` for nodes with children.
    pub fn leaf(&self, node: usize) -> Option<&[Point3<f64>]> {
        let leaf = node.checked_sub(self.leaves)?;
        Some(&self.points[share(self.points.len(), leaf, self.leaves)])
    }

    /// Box around all balls.
    pub fn bounds(&self) -> Aabb {
        self.node_bounds(1).padded(self.radius)
    }

    /// What to show of it: an octahedron in the place of each ball, of `most` of them when there are more.
    pub fn mesh(&self, most: usize) -> TriMesh {
        let mut mesh = TriMesh::default();
        let (points, shown) = (self.points.len(), self.points.len().min(most));
        // Neighbours in the tree are neighbours in space.
        for point in (0..shown).map(|i| share(points, i, shown).start) {
            let first = mesh.vertices.len() as u32;
            for axis in 0..3 {
                for side in [-self.radius, self.radius] {
                    let mut corner = self.points[point];
                    corner[axis] += side;
                    mesh.vertices.push(corner);
                }
            }
            for (x, y, z) in (0..8).map(|i| (i & 1, i >> 1 & 1, i >> 2 & 1)) {
                let corners = [first + x, first + 2 + y, first + 4 + z];
                let [a, b, c] = corners;
                mesh.faces.push(if (x + y + z) % 2 == 1 { [a, b, c] } else { [a, c, b] });
            }
        }
        mesh
    }

    fn node_bounds(&self, node: usize) -> Aabb {
        let [x, y, z, to_x, to_y, to_z] = self.nodes[node].map(f64::from);
        Aabb { low: Point3::new(x, y, z), high: Point3::new(to_x, to_y, to_z) }
    }

    /// See [`Pile::walk`](super::Pile::walk).
    pub(super) fn walk(&self, from: &Point3<f64>, visit: &mut impl FnMut(&Lump, bool) -> bool) {
        let mut stack = vec![1];
        while let Some(node) = stack.pop() {
            let cover = Lump::Box { bounds: self.node_bounds(node), radius: self.radius };
            if !visit(&cover, false) {
                continue;
            }
            match self.leaf(node) {
                Some(points) => points.iter().for_each(|point| {
                    visit(&Lump::Ball { centre: *point, radius: self.radius }, true);
                }),
                None => {
                    let far = |node: usize| self.node_bounds(node).distance_to(from);
                    let (left, right) = (2 * node, 2 * node + 1);
                    stack.extend(if far(left) < far(right) { [right, left] } else { [left, right] });
                }
            }
        }
    }
}

/// The items of the `i`-th of `n` parts of nearly equal size.
fn share(items: usize, i: usize, n: usize) -> std::ops::Range<usize> {
    items * i / n..items * (i + 1) / n
}

/// A tree while it is made.
struct Builder<'n> {
    total: usize,
    leaves: usize,
    nodes: &'n mut [NodeBox],
}

impl Builder<'_> {
    /// Sorts the points of a node into its leaves, by halving them along the longest side of their box.
    fn build(&mut self, points: &mut [Point3<f64>], node: usize, leaves: std::ops::Range<usize>) {
        let bounds = Aabb::of_points(points.iter()).expect("every leaf has a point");
        let Aabb { low, high } = bounds;
        self.nodes[node] =
            [below(low.x), below(low.y), below(low.z), above(high.x), above(high.y), above(high.z)];
        let axis = bounds.size().imax();
        // All coordinates count, so that only equal points are equal, and what is left of the middle does not depend on the
        // order in which they came.
        let order = |a: &Point3<f64>, b: &Point3<f64>| {
            let by = |k: usize| a[(axis + k) % 3].total_cmp(&b[(axis + k) % 3]);
            by(0).then_with(|| by(1)).then_with(|| by(2))
        };
        if leaves.len() == 1 {
            points.sort_unstable_by(order);
            return;
        }
        let between = leaves.start + leaves.len() / 2;
        let first = |leaf: usize| share(self.total, leaf, self.leaves).start;
        let middle = first(between) - first(leaves.start);
        points.select_nth_unstable_by(middle, order);
        let (left, right) = points.split_at_mut(middle);
        self.build(left, 2 * node, leaves.start..between);
        self.build(right, 2 * node + 1, between..leaves.end);
    }
}

/// The largest single-precision number that is not larger.
pub(super) fn below(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x { near.next_down() } else { near }
}

/// The smallest single-precision number that is not smaller.
pub(super) fn above(x: f64) -> f32 {
    -below(-x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Seed;
    use proptest::prelude::*;

    fn cloud(points: &[[f64; 3]]) -> Result<PointCloud, CloudError> {
        PointCloud::new(points.iter().copied().map(Point3::from).collect(), 0.01)
    }

    proptest! {
        #[test]
        fn every_node_contains_its_points_and_the_order_they_came_in_does_not_matter(
            // Few places, so that many points are equal in a coordinate or in all.
            mut points in prop::collection::vec([0..9_i32, 0..9, -3..3].prop_map(|p| p.map(|x| f64::from(x) * 0.1)), 1..300),
        ) {
            let found = cloud(&points).unwrap();
            let mut seen = 0;
            for node in 1..2 * found.leaves {
                if let Some(leaf) = found.leaf(node) {
                    seen += leaf.len();
                    prop_assert!((1..=LEAF).contains(&leaf.len()));
                    // In its own box and in all above.
                    let mut above = node;
                    while above > 0 {
                        prop_assert!(leaf.iter().all(|p| found.node_bounds(above).contains(p)));
                        above /= 2;
                    }
                }
            }
            prop_assert_eq!(seen, points.len());
            points.reverse();
            prop_assert_eq!(&cloud(&points).unwrap(), &found);
            let by_all = |a: &[f64; 3], b: &[f64; 3]| a.partial_cmp(b).unwrap();
            let mut kept: Vec<[f64; 3]> = found.points().iter().map(|p| p.coords.into()).collect();
            kept.sort_by(by_all);
            points.sort_by(by_all);
            prop_assert_eq!(kept, points);
        }
    }

    #[test]
    fn what_is_no_cloud_is_refused() {
        assert_eq!(cloud(&[]), Err(CloudError::Empty));
        assert_eq!(cloud(&[[0.0; 3], [0.0, f64::NAN, 0.0]]), Err(CloudError::Coordinate(1)));
        assert_eq!(cloud(&[[1e9, 0.0, 0.0]]), Err(CloudError::Coordinate(0)));
        for radius in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(PointCloud::new(vec![Point3::origin()], radius), Err(CloudError::Radius));
        }
        assert_eq!(cloud(&[[-0.0, 0.0, 0.0]]), cloud(&[[0.0, -0.0, 0.0]]));
    }

    #[test]
    fn numbers_are_rounded_to_their_side() {
        let mut rng = Seed::new(4).rng();
        for _ in 0..1000 {
            let x = rng.range(-3.0, 3.0);
            assert!(f64::from(below(x)) <= x && f64::from(above(x)) >= x);
            assert!(f64::from(above(x)) - f64::from(below(x)) < 1e-6);
        }
        assert_eq!((below(0.5), above(0.5)), (0.5, 0.5));
    }
}
