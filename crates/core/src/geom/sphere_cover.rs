//! Spheres that cover a shape, in a tree: what vectorised collision checks compute with.
//!
//! Every leaf is a ball about a point of the shape. Two radii belong to it: the balls of the outer radii together contain
//! the shape, the ball of the inner radius is inside the shape. A shape whose outer balls touch nothing is free; one of
//! whose inner balls touches something is not.

use nalgebra::{Point3, Vector3};

use super::{Aabb, ConvexPart, ConvexParts};

mod net;
mod tree;

/// One ball, or a ball around several.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphereNode {
    /// Middle, in the frame of the shape; metres.
    pub centre: Point3<f64>,
    /// The part of the shape that this node and those below it stand for is within this distance.
    pub outer: f64,
    /// All points within this distance belong to the shape; zero when the centre is not inside.
    pub inner: f64,
    /// Position of the first node that is not below this one. A leaf is followed by it directly.
    pub next: u32,
}

/// A tree of balls that cover a shape, parents first. Empty for an empty shape.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SphereCover {
    nodes: Vec<SphereNode>,
}

/// How close a cover follows its shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoverOptions {
    /// How far a leaf may stand out of the part that it covers, as a fraction of the radius of a ball around the part.
    pub overshoot: f64,
    /// It may stand out this far in any case, metres: small parts then take few balls.
    pub least: f64,
}

impl Default for CoverOptions {
    fn default() -> Self {
        Self { overshoot: 0.06, least: 0.003 }
    }
}

impl SphereCover {
    /// Covers convex parts.
    ///
    /// Each part is filled with a net of cells; a ball covers a cell when it contains the ball around the cell. Cells are
    /// taken from the outside in, and each not yet covered gets the largest useful ball that reaches it without standing
    /// out of the part by more than the overshoot. That all cells are covered proves that the part is.
    pub fn of(parts: &ConvexParts, options: &CoverOptions) -> Self {
        let overshoot = options.overshoot.clamp(0.005, 1.0);
        let mut leaves: Vec<(Point3<f64>, f64)> = Vec::new();
        for part in parts {
            let slack = (overshoot * part.bounding_sphere().1).max(options.least);
            let net = net::Net::of(part, slack);
            leaves.extend(net.balls());
        }
        let balls: Vec<Ball> = leaves
            .into_iter()
            .map(|(centre, outer)| Ball { centre, outer, inner: depth(parts, &centre) })
            .collect();
        Self { nodes: tree::build(parts, balls) }
    }

    /// A cover from stored nodes; `None` unless they form one tree of finite balls.
    pub fn from_nodes(nodes: Vec<SphereNode>) -> Option<Self> {
        let finite = |n: &SphereNode| {
            n.centre.coords.iter().all(|x| x.is_finite())
                && n.outer.is_finite()
                && (0.0..=n.outer).contains(&n.inner)
        };
        let mut ends = vec![nodes.len()];
        for (i, node) in nodes.iter().enumerate() {
            while ends.last() == Some(&i) {
                ends.pop();
            }
            let (end, within) = (node.next as usize, *ends.last()?);
            if !finite(node) || end <= i || end > within || (i == 0 && end != nodes.len()) {
                return None;
            }
            ends.push(end);
        }
        Some(Self { nodes })
    }

    /// All nodes, parents first.
    pub fn nodes(&self) -> &[SphereNode] {
        &self.nodes
    }

    /// The balls that cover the shape.
    pub fn leaves(&self) -> impl Iterator<Item = &SphereNode> {
        self.nodes.iter().enumerate().filter(|(i, node)| node.next as usize == i + 1).map(|(_, node)| node)
    }

    /// Whether some leaf contains the point.
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        self.leaves().any(|leaf| (point - leaf.centre).norm() <= leaf.outer)
    }

    /// How far the cover stands out of the shape at most, metres: no point of a leaf is farther from the shape.
    ///
    /// A ball of radius r about a point at depth d leaves the shape by no more than r - d; one whose centre is outside
    /// reaches the shape, so that twice its radius is enough.
    pub fn overshoot(&self) -> f64 {
        let of =
            |leaf: &SphereNode| if leaf.inner > 0.0 { leaf.outer - leaf.inner } else { 2.0 * leaf.outer };
        self.leaves().map(of).fold(0.0, f64::max)
    }

    /// How many times the volume of the shape the cover has, by a lattice of `across` points along each side of the box around
    /// the cover; 1 for an empty shape.
    pub fn swelling(&self, parts: &ConvexParts, across: usize) -> f64 {
        let balls = self.leaves().flat_map(|leaf| {
            let reach = Vector3::repeat(leaf.outer);
            [leaf.centre - reach, leaf.centre + reach]
        });
        let Some(bounds) = Aabb::of_points(&balls.collect::<Vec<_>>()) else { return 1.0 };
        let corner = bounds.centre() - 0.5 * bounds.size();
        let (mut in_cover, mut in_shape) = (0_usize, 0_usize);
        for i in 0..across * across * across {
            let cell = [i % across, i / across % across, i / across / across];
            let share = Vector3::from(cell.map(|k| (k as f64 + 0.5) / across as f64));
            let point = corner + bounds.size().component_mul(&share);
            in_cover += usize::from(self.contains(&point));
            in_shape += usize::from(parts.contains(&point));
        }
        if in_shape == 0 { 1.0 } else { in_cover as f64 / in_shape as f64 }
    }
}

/// A leaf before it has a place in the tree.
#[derive(Debug, Clone, Copy)]
struct Ball {
    centre: Point3<f64>,
    outer: f64,
    inner: f64,
}

/// How deep a point is in a shape, by the part in which it is deepest; zero outside.
fn depth(parts: &ConvexParts, point: &Point3<f64>) -> f64 {
    parts.iter().map(|part: &ConvexPart| -part.height(point)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::{box_part, cylinder_part};
    use super::*;
    use crate::Pose;
    use crate::rng::Seed;

    fn shapes() -> Vec<ConvexParts> {
        let mut rng = Seed::new(5).rng();
        let cloud: Vec<Point3<f64>> = (0..60)
            .map(|_| Point3::from(rng.direction().into_inner().component_mul(&Vector3::new(0.1, 0.2, 0.06))))
            .collect();
        let mut two = ConvexParts::new(vec![box_part(Vector3::new(0.3, 0.05, 0.02))]);
        let other = ConvexParts::new(vec![cylinder_part(0.03, 0.2)]);
        two.extend(other.transformed(&Pose::translation(0.1, 0.0, 0.05)));
        vec![
            ConvexParts::new(vec![box_part(Vector3::repeat(0.1))]),
            ConvexParts::new(vec![cylinder_part(0.05, 0.4)]),
            ConvexParts::new(vec![ConvexPart::hull_of(&cloud).unwrap()]),
            ConvexParts::new(vec![box_part(Vector3::new(0.2, 0.1, 1e-4))]),
            two,
        ]
    }

    #[test]
    fn the_cover_contains_the_shape_and_the_inner_balls_are_inside() {
        let mut rng = Seed::new(6).rng();
        for parts in shapes() {
            let cover = SphereCover::of(&parts, &CoverOptions::default());
            assert_eq!(cover, SphereCover::of(&parts, &CoverOptions::default()));
            for part in &parts {
                let corners = part.points();
                for _ in 0..2000 {
                    // Random mixtures of corners, most of them near a face or an edge.
                    let mut sum = Vector3::zeros();
                    let mut total = 0.0;
                    for _ in 0..1 + rng.below(4) {
                        let weight = rng.unit();
                        sum += corners[rng.below(corners.len())].coords * weight;
                        total += weight;
                    }
                    let point = Point3::from(sum / total);
                    assert!(cover.contains(&point), "{point} is not covered");
                    assert!((point - cover.nodes()[0].centre).norm() <= cover.nodes()[0].outer + 1e-9);
                }
            }
            let radius = parts.iter().map(|p| p.bounding_sphere().1).fold(0.0, f64::max);
            // A ball whose centre is outside counts twice; looking at some of many faces only costs a little more.
            assert!(cover.overshoot() <= 2.0 * 0.065 * radius + 1e-9, "{} of {radius}", cover.overshoot());
            let swelling = cover.swelling(&parts, 20);
            let thin = parts.bounds().unwrap().size().min() < 0.01;
            assert!(swelling >= 1.0 && (thin || swelling < 1.6), "{swelling}");
            for leaf in cover.leaves() {
                let p = leaf.centre + rng.direction().into_inner() * (leaf.inner * 0.999);
                assert!(leaf.inner == 0.0 || parts.contains(&p));
            }
            // A lattice of balls as small as the allowed overshoot, over all of the box, is what anyone could do.
            let edge = 2.0 * 0.065 * radius / 3f64.sqrt();
            let lattice: f64 = parts.bounds().unwrap().size().iter().map(|x| (x / edge).ceil()).product();
            let count = cover.leaves().count();
            assert!(count as f64 <= 2.0 * lattice.min(300.0), "{count} balls, a lattice has {lattice}");
        }
    }

    #[test]
    fn parents_contain_their_leaves() {
        for parts in shapes() {
            let cover = SphereCover::of(&parts, &CoverOptions::default());
            let nodes = cover.nodes();
            for (i, node) in nodes.iter().enumerate() {
                for below in &nodes[i + 1..node.next as usize] {
                    let far = (below.centre - node.centre).norm() + below.outer;
                    assert!(far <= node.outer, "{far} {}", node.outer);
                }
            }
            assert_eq!(SphereCover::from_nodes(nodes.to_vec()).as_ref(), Some(&cover));
        }
        let node = |next| SphereNode { centre: Point3::origin(), outer: 1.0, inner: 0.5, next };
        for (nexts, good) in [
            (vec![1], true),
            (vec![3, 2, 3], true),
            (vec![2, 2, 3], false),
            (vec![3, 4, 3], false),
            (vec![1, 1], false),
            (vec![3, 3, 2], false),
        ] {
            let nodes = nexts.iter().map(|&n| node(n)).collect();
            assert_eq!(SphereCover::from_nodes(nodes).is_some(), good, "{nexts:?}");
        }
    }
}
