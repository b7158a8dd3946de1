//! Balls around balls.

use nalgebra::Point3;

use super::{Ball, SphereNode, depth};
use crate::geom::ConvexParts;

/// Most children of a node: one level then settles about as much as it costs.
const FAN_OUT: usize = 8;

/// How much farther than needed a ball reaches beyond those below it, metres: rounding does not turn the order.
const NESTED: f64 = 1e-6;

/// The nodes of a tree over the balls, parents first. A ball contains those below it, so that what is away from it is away
/// from them.
pub(super) fn build(parts: &ConvexParts, balls: Vec<Ball>) -> Vec<SphereNode> {
    let mut nodes = Vec::new();
    if balls.is_empty() {
        return nodes;
    }
    grow(parts, balls, &mut nodes);
    nodes
}

fn grow(parts: &ConvexParts, balls: Vec<Ball>, nodes: &mut Vec<SphereNode>) {
    let leaf = |ball: &Ball, at: usize| SphereNode {
        centre: ball.centre,
        outer: ball.outer,
        inner: ball.inner.min(ball.outer),
        next: at as u32 + 1,
    };
    if let [only] = balls.as_slice() {
        nodes.push(leaf(only, nodes.len()));
        return;
    }
    let around: Vec<(Point3<f64>, f64)> = balls.iter().map(|b| (b.centre, b.outer)).collect();
    let (centre, outer) = enclosing(&around);
    let own = nodes.len();
    nodes.push(SphereNode { centre, outer, inner: depth(parts, &centre).min(outer), next: 0 });
    let groups = if balls.len() <= FAN_OUT {
        balls.into_iter().map(|ball| vec![ball]).collect()
    } else {
        groups(balls)
    };
    for group in groups {
        grow(parts, group, nodes);
    }
    nodes[own].next = nodes.len() as u32;
    let reach = |below: &SphereNode| (below.centre - centre).norm() + below.outer;
    let farthest = nodes[own + 1..].iter().map(reach).fold(outer, f64::max);
    nodes[own].outer = farthest + NESTED;
}

/// Splits the largest group along its longest side until there are enough.
fn groups(balls: Vec<Ball>) -> Vec<Vec<Ball>> {
    let mut groups = vec![balls];
    while groups.len() < FAN_OUT {
        let mut largest = 0;
        for (i, group) in groups.iter().enumerate() {
            if group.len() > groups[largest].len() {
                largest = i;
            }
        }
        let mut group = std::mem::take(&mut groups[largest]);
        let extent = |axis: usize| {
            let along = group.iter().map(|b| b.centre[axis]);
            let (low, high) =
                along.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            high - low
        };
        let mut axis = 0;
        for other in 1..3 {
            if extent(other) > extent(axis) {
                axis = other;
            }
        }
        group.sort_by(|a, b| a.centre[axis].total_cmp(&b.centre[axis]));
        let upper = group.split_off(group.len() / 2);
        groups[largest] = group;
        groups.insert(largest + 1, upper);
    }
    groups
}

/// A small ball around balls (Badoiu and Clarkson, "Smaller core-sets for balls", 2003: step towards the farthest, each
/// time less).
fn enclosing(balls: &[(Point3<f64>, f64)]) -> (Point3<f64>, f64) {
    const STEPS: usize = 200;
    let reach = |centre: &Point3<f64>, ball: &(Point3<f64>, f64)| (ball.0 - centre).norm() + ball.1;
    let mean = balls.iter().map(|b| b.0.coords).sum::<nalgebra::Vector3<f64>>() / balls.len() as f64;
    let mut centre = Point3::from(mean);
    let mut best = (centre, f64::INFINITY);
    for step in 1..=STEPS {
        let (mut farthest, mut radius) = (0, f64::NEG_INFINITY);
        for (i, ball) in balls.iter().enumerate() {
            let far = reach(&centre, ball);
            if far > radius {
                (farthest, radius) = (i, far);
            }
        }
        if radius < best.1 {
            best = (centre, radius);
        }
        centre += (balls[farthest].0 - centre) / (step as f64 + 1.0);
    }
    best
}
