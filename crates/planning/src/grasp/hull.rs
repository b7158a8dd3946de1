//! The convex hull of wrenches in six dimensions: how strong a grasp is.
//!
//! Epsilon (Ferrari and Canny, "Planning optimal grasps", 1992) is the radius of the largest ball about the origin inside the
//! hull. For it the hull is not built as a whole: a polytope inside it grows, always through its facet nearest to the
//! origin, until that facet lies on the hull. The facet's distance bounds epsilon from below and the hull's extent
//! beyond it from above, so that the search can stop at any moment with a bound.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nalgebra::{Matrix6, Vector6};

use super::wrench::support;

/// What is known of the radius of the largest ball about the origin inside a hull.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Epsilon {
    /// It is not smaller than this; negative when the origin is outside.
    pub lower: f64,
    /// It is not larger than this.
    pub upper: f64,
}

/// The smallest part of a wrench that counts as a direction of its own.
const RANK_TOLERANCE: f64 = 1e-7;
/// A point no higher than this over a facet is on it; epsilon is exact to about this.
const ON_FACET: f64 = 1e-10;
/// Most facets that a polytope may ever have; grasps need a few thousand at most.
const MOST_FACETS: usize = 400_000;

/// The Ferrari-Canny epsilon of the convex hull of `wrenches`, to 1e-9 unless the search runs out of facets. When the contacts
/// do not close, only the sign has a meaning. `None` when the wrenches do not span six dimensions, as those of two hard
/// point contacts.
pub fn epsilon(wrenches: &[Vector6<f64>]) -> Option<Epsilon> {
    let mut polytope = Polytope::new(wrenches)?;
    let mut upper = f64::INFINITY;
    loop {
        let nearest = polytope.nearest_facet()?;
        let lower = polytope.facets[nearest].offset;
        let (point, height) = support(wrenches, &polytope.facets[nearest].normal);
        upper = upper.min(height);
        let done = height <= lower + ON_FACET || polytope.facets.len() > MOST_FACETS;
        if done || !polytope.grow(point, nearest) {
            return Some(Epsilon { lower, upper: upper.max(lower) });
        }
    }
}

/// Volume of the convex hull of `wrenches`; zero when they do not span six dimensions. The other measure of Ferrari and Canny:
/// what a grasp resists on average, where epsilon is what it resists at worst.
pub fn volume(wrenches: &[Vector6<f64>]) -> f64 {
    let Some(mut polytope) = Polytope::new(wrenches) else { return 0.0 };
    for point in 0..wrenches.len() {
        while let Some(below) = polytope.highest_below(point) {
            if polytope.facets.len() > MOST_FACETS || !polytope.grow(point, below) {
                break;
            }
        }
    }
    polytope.volume()
}

/// A simplex of five dimensions on the boundary of a polytope.
#[derive(Clone)]
struct Facet {
    /// Unit, outward.
    normal: Vector6<f64>,
    /// Signed distance of the origin behind the facet: positive when the origin is inside.
    offset: f64,
    vertices: [u32; 6],
    /// The facet on the other side of the ridge opposite to each vertex.
    beside: [u32; 6],
    alive: bool,
    /// Whether the plane was computed from the vertices rather than from facets beside it.
    exact: bool,
    /// The growth step that last saw this facet from outside.
    seen: u32,
}

impl Facet {
    fn height(&self, p: &Vector6<f64>) -> f64 {
        self.normal.dot(p) - self.offset
    }

    fn slot_of(&self, vertex: u32) -> usize {
        self.vertices.iter().position(|&v| v == vertex).expect("a facet beside a ridge has its vertices")
    }

    fn slot_beside(&self, facet: u32) -> usize {
        self.beside.iter().position(|&f| f == facet).expect("facets are beside each other both ways")
    }
}

/// An entry of the queue of facets, nearest to the origin first, then oldest.
#[derive(PartialEq)]
struct Queued(f64, u32);

impl Eq for Queued {}

impl Ord for Queued {
    fn cmp(&self, other: &Self) -> Ordering {
        other.0.total_cmp(&self.0).then(other.1.cmp(&self.1))
    }
}

impl PartialOrd for Queued {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

struct Polytope<'a> {
    points: &'a [Vector6<f64>],
    interior: Vector6<f64>,
    /// Points that are, or were, corners.
    used: Vec<bool>,
    facets: Vec<Facet>,
    queue: BinaryHeap<Queued>,
    steps: u32,
}

impl<'a> Polytope<'a> {
    /// A simplex of seven of the points; `None` when they do not span six dimensions.
    fn new(points: &'a [Vector6<f64>]) -> Option<Self> {
        let corners = initial_simplex(points)?;
        let interior = corners.iter().map(|&i| points[i as usize]).sum::<Vector6<f64>>() / 7.0;
        let mut used = vec![false; points.len()];
        corners.iter().for_each(|&i| used[i as usize] = true);
        let facets = Vec::with_capacity(1024);
        let mut polytope = Self { points, interior, used, facets, queue: BinaryHeap::new(), steps: 0 };
        for left_out in 0..7 {
            let kept = |slot: usize| slot + usize::from(slot >= left_out);
            let vertices = std::array::from_fn(|slot| corners[kept(slot)]);
            // Facet k lacks corner k, so the facet opposite to a vertex is the one named after it.
            let beside = std::array::from_fn(|slot| kept(slot) as u32);
            let (normal, offset) = polytope.plane(&vertices)?;
            polytope.push(Facet { normal, offset, vertices, beside, alive: true, exact: true, seen: 0 });
        }
        Some(polytope)
    }

    fn push(&mut self, facet: Facet) -> u32 {
        let index = self.facets.len() as u32;
        self.queue.push(Queued(facet.offset, index));
        self.facets.push(facet);
        index
    }

    /// Plane through six points, its normal away from the interior; `None` if they span no hyperplane.
    fn plane(&self, vertices: &[u32; 6]) -> Option<(Vector6<f64>, f64)> {
        let normal = hyperplane_normal(&vertices.map(|i| self.points[i as usize]))?;
        let offset = normal.dot(&self.points[vertices[0] as usize]);
        let outward = offset > normal.dot(&self.interior);
        Some(if outward { (normal, offset) } else { (-normal, -offset) })
    }

    /// The facet nearest to the origin, its plane computed anew from its vertices.
    fn nearest_facet(&mut self) -> Option<usize> {
        while let Some(Queued(offset, index)) = self.queue.pop() {
            let facet = &self.facets[index as usize];
            if !facet.alive || facet.offset != offset {
                continue;
            }
            if facet.exact {
                return Some(index as usize);
            }
            let plane = self.plane(&facet.vertices);
            let facet = &mut self.facets[index as usize];
            facet.exact = true;
            // A facet without extent keeps the plane it has.
            if let Some((normal, offset)) = plane {
                (facet.normal, facet.offset) = (normal, offset);
            }
            let offset = facet.offset;
            self.queue.push(Queued(offset, index));
        }
        None
    }

    /// The facet that a point is highest above, if it is outside.
    fn highest_below(&self, point: usize) -> Option<usize> {
        let p = &self.points[point];
        let mut highest = (None, ON_FACET);
        for (i, facet) in self.facets.iter().enumerate() {
            if facet.alive && facet.height(p) > highest.1 {
                highest = (Some(i), facet.height(p));
            }
        }
        highest.0
    }

    /// Replaces the polytope by its hull with a point above the facet `below`; false when rounding leaves nothing to
    /// replace.
    fn grow(&mut self, point: usize, below: usize) -> bool {
        let p = self.points[point];
        if self.facets[below].height(&p) <= 0.0 || std::mem::replace(&mut self.used[point], true) {
            return false;
        }
        self.steps += 1;
        let step = self.steps;
        // The facets that the point sees, and the ridges where sight ends.
        self.facets[below].seen = step;
        let mut visible = vec![below as u32];
        let mut horizon: Vec<(u32, usize)> = Vec::new();
        let mut next = 0;
        while next < visible.len() {
            let f = visible[next];
            next += 1;
            for slot in 0..6 {
                let other = self.facets[f as usize].beside[slot];
                let facet = &mut self.facets[other as usize];
                if facet.seen == step {
                    continue;
                }
                if facet.height(&p) > 0.5 * ON_FACET {
                    facet.seen = step;
                    visible.push(other);
                } else {
                    horizon.push((f, slot));
                }
            }
        }
        let first = self.facets.len() as u32;
        for (born, &(f, slot)) in horizon.iter().enumerate() {
            let (inner, outer) = (&self.facets[f as usize], self.facets[f as usize].beside[slot]);
            let (normal, offset) = tilted(inner, &self.facets[outer as usize], &p);
            let mut vertices = inner.vertices;
            vertices[slot] = point as u32;
            let mut beside = [u32::MAX; 6];
            beside[slot] = outer;
            let index = first + born as u32;
            let back = self.facets[outer as usize].slot_beside(f);
            self.facets[outer as usize].beside[back] = index;
            self.push(Facet { normal, offset, vertices, beside, alive: true, exact: false, seen: 0 });
            // The dead facet remembers which facet replaces it across this ridge.
            self.facets[f as usize].beside[slot] = index;
        }
        for (born, &(f, slot)) in horizon.iter().enumerate() {
            let index = first + born as u32;
            for side in (0..6).filter(|&side| side != slot) {
                if self.facets[index as usize].beside[side] == u32::MAX {
                    let (other, other_side) = self.across(f, slot, side, step, first);
                    self.facets[index as usize].beside[side] = other;
                    self.facets[other as usize].beside[other_side] = index;
                }
            }
        }
        for f in visible {
            self.facets[f as usize].alive = false;
        }
        true
    }

    /// The new facet beside that on ridge `slot` of a seen facet, across the face that lacks `side` too, and the slot there: found
    /// by walking over seen facets round that face.
    fn across(&self, facet: u32, slot: usize, side: usize, step: u32, first: u32) -> (u32, usize) {
        let (mut at, mut behind, mut ahead) = (facet, slot, side);
        loop {
            let next = self.facets[at as usize].beside[ahead];
            if next >= first {
                // Sight ends here: the new facet has the point in place of `ahead`.
                return (next, behind);
            }
            debug_assert_eq!(self.facets[next as usize].seen, step);
            let kept = self.facets[at as usize].vertices[behind];
            let entered = self.facets[next as usize].slot_beside(at);
            (ahead, behind) = (self.facets[next as usize].slot_of(kept), entered);
            at = next;
        }
    }

    fn volume(&self) -> f64 {
        let of = |facet: &Facet| {
            let edge = |slot: usize| self.points[facet.vertices[slot] as usize] - self.interior;
            let edges: [Vector6<f64>; 6] = std::array::from_fn(edge);
            Matrix6::from_columns(&edges).determinant().abs()
        };
        self.facets.iter().filter(|f| f.alive).map(of).sum::<f64>() / 720.0
    }
}

/// The plane through a point and the ridge between a facet that the point sees and one that it does not: both planes contain the
/// ridge, so every sum of them does, and weights of the right signs make it contain the point.
fn tilted(seen: &Facet, unseen: &Facet, p: &Vector6<f64>) -> (Vector6<f64>, f64) {
    let (above, below) = (seen.height(p), (-unseen.height(p)).max(0.0));
    let normal = unseen.normal * above + seen.normal * below;
    let length = normal.norm();
    if length > 0.0 {
        let normal = normal / length;
        (normal, normal.dot(p))
    } else {
        (unseen.normal, unseen.offset)
    }
}

/// Seven affinely independent points, each the farthest from the span of those before it.
fn initial_simplex(points: &[Vector6<f64>]) -> Option<[u32; 7]> {
    let mut chosen = [0; 7];
    let origin = *points.first()?;
    let mut rests: Vec<Vector6<f64>> = points.iter().map(|p| p - origin).collect();
    for slot in 1..7 {
        let mut farthest = (0, 0.0);
        for (i, rest) in rests.iter().enumerate() {
            let square = rest.norm_squared();
            if square > farthest.1 {
                farthest = (i, square);
            }
        }
        if farthest.1 < RANK_TOLERANCE * RANK_TOLERANCE {
            return None;
        }
        chosen[slot] = farthest.0 as u32;
        let axis = rests[farthest.0].normalize();
        for rest in &mut rests {
            *rest -= axis * axis.dot(rest);
        }
    }
    Some(chosen)
}

/// Unit normal of the hyperplane through six points: Gram-Schmidt on the five edges, then the axis with the
/// largest part outside of their span.
fn hyperplane_normal(points: &[Vector6<f64>; 6]) -> Option<Vector6<f64>> {
    let mut edges: [Vector6<f64>; 5] = [Vector6::zeros(); 5];
    for k in 0..5 {
        let mut edge = points[k + 1] - points[0];
        let length = edge.norm();
        // Twice is enough for full accuracy.
        for _ in 0..2 {
            for basis in &edges[..k] {
                edge -= basis * basis.dot(&edge);
            }
        }
        let rest = edge.norm();
        if rest <= 1e-11 * length.max(1e-3) {
            return None;
        }
        edges[k] = edge / rest;
    }
    // The squares of each axis' part in the span sum to five: some axis is far out of it.
    let inside = |axis: usize| edges.iter().map(|e| e[axis] * e[axis]).sum::<f64>();
    let axis = (0..6).min_by(|&a, &b| inside(a).total_cmp(&inside(b)))?;
    let mut rest = Vector6::zeros();
    rest[axis] = 1.0;
    for _ in 0..2 {
        for basis in &edges {
            rest -= basis * basis.dot(&rest);
        }
    }
    Some(rest.normalize())
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Unit, Vector3};
    use robotc_core::Seed;

    use robotc_core::robot::Hold;

    use super::super::{Contact, ContactModel, closes, wrenches};
    use super::*;

    fn contact(point: [f64; 3], inward: [f64; 3]) -> Contact {
        let normal_in_object = Unit::new_normalize(Vector3::from(inward));
        Contact { point_in_object: Point3::from(point), normal_in_object }
    }

    fn model(friction: f64) -> ContactModel {
        ContactModel { friction, cone_edges: 8, centre: Point3::origin(), length: 1.0, hold: Hold::Close }
    }

    /// Two flat pads on opposite faces of a cube.
    fn jaws() -> Vec<Contact> {
        let mut contacts = Vec::new();
        for side in [-1.0, 1.0] {
            for (y, z) in [(-0.3, -0.3), (-0.3, 0.3), (0.3, -0.3), (0.3, 0.3)] {
                contacts.push(contact([side, y, z], [-side, 0.0, 0.0]));
            }
        }
        contacts
    }

    fn random_contacts(trial: u64, count: usize) -> Vec<Contact> {
        let mut rng = Seed::new(3).at(trial).rng();
        let mut one = || {
            let out = rng.direction();
            let tilt = rng.direction().into_inner() * 0.4;
            contact(out.into_inner().into(), (tilt - out.into_inner()).into())
        };
        (0..count).map(|_| one()).collect()
    }

    #[test]
    fn two_hard_points_never_close_and_two_patches_do() {
        let points = [contact([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]), contact([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0])];
        let hard = wrenches(&points, &model(0.5));
        assert!(epsilon(&hard).is_none() && !closes(&hard));
        let soft = wrenches(&jaws(), &model(0.5));
        assert!(epsilon(&soft).unwrap().lower > 0.05 && closes(&soft));
    }

    #[test]
    fn one_side_alone_does_not_close() {
        let side: Vec<_> = jaws().into_iter().filter(|c| c.point_in_object.x > 0.0).collect();
        let w = wrenches(&side, &model(0.5));
        assert!(epsilon(&w).is_none_or(|e| e.lower <= 1e-9) && !closes(&w));
    }

    #[test]
    fn more_friction_resists_more() {
        let value = |mu: f64| epsilon(&wrenches(&jaws(), &model(mu))).unwrap().lower;
        let values: Vec<f64> = [0.1, 0.3, 0.6, 1.0].map(value).to_vec();
        assert!(values.windows(2).all(|w| w[0] < w[1]), "{values:?}");
    }

    #[test]
    fn cross_polytope_and_cube_have_known_measures() {
        let mut cross = Vec::new();
        for axis in 0..6 {
            for sign in [-1.0, 1.0] {
                let mut p = Vector6::zeros();
                p[axis] = sign;
                cross.push(p);
            }
        }
        let found = epsilon(&cross).unwrap();
        assert!((found.lower - 1.0 / 6f64.sqrt()).abs() < 1e-12 && found.upper - found.lower < 1e-9);
        assert!((volume(&cross) - 64.0 / 720.0).abs() < 1e-12);
        let corner = |bits: usize| Vector6::from_fn(|k, _| if bits >> k & 1 == 0 { -1.0 } else { 1.0 });
        let cube: Vec<_> = (0..64).map(corner).collect();
        assert!((epsilon(&cube).unwrap().lower - 1.0).abs() < 1e-12);
        assert!((volume(&cube) - 64.0).abs() < 1e-9, "{}", volume(&cube));
    }

    /// No direction has a support below the lower bound, the bounds meet, and yes or no agrees with a linear programme:
    /// maximise t subject to sum l_i w_i = 0, sum l_i = 1, l_i >= t.
    #[test]
    fn agrees_with_sampled_supports_and_a_linear_programme() {
        let mut closed = 0;
        for trial in 0..80 {
            let mut rng = Seed::new(4).at(trial).rng();
            let w = wrenches(&random_contacts(trial, 3 + rng.below(6)), &model(0.4));
            let Epsilon { lower, upper } = epsilon(&w).expect("random contacts span all directions");
            assert!(upper - lower < 1e-9, "trial {trial}: {lower} to {upper}");
            for _ in 0..300 {
                let direction = Vector6::from_fn(|_, _| rng.normal()).normalize();
                let (_, height) = support(&w, &direction);
                assert!(lower <= 0.0 || height >= lower - 1e-9, "support {height} below epsilon {lower}");
            }
            assert_eq!(lower > 1e-9, closes_by_linear_programme(&w), "trial {trial}, epsilon {lower}");
            assert_eq!(lower > 1e-7, closes(&w), "trial {trial}, epsilon {lower}");
            closed += usize::from(lower > 0.0);
        }
        assert!((10..70).contains(&closed), "{closed}");
    }

    /// The share of directions in which random points of a box around the hull are inside gives its volume.
    #[test]
    fn volume_of_a_grasp_lies_between_those_of_bodies_inside_and_around() {
        for trial in 0..6 {
            let w = wrenches(&random_contacts(trial, 4), &model(0.5));
            let found = volume(&w);
            let largest = (0..6)
                .map(|k| {
                    let mut axis = Vector6::zeros();
                    axis[k] = 1.0;
                    support(&w, &axis).1 + support(&w, &-axis).1
                })
                .product::<f64>();
            // The volume of the unit ball in six dimensions is pi^3 / 6.
            let ball =
                epsilon(&w).map_or(0.0, |e| e.lower.max(0.0).powi(6)) * std::f64::consts::PI.powi(3) / 6.0;
            assert!(found > ball && found < largest, "{ball} {found} {largest}");
            // Turned round, the hull is the same body.
            let turned: Vec<_> = w.iter().rev().map(|p| -p).collect();
            assert!((volume(&turned) - found).abs() < 1e-9 * found);
        }
    }

    fn closes_by_linear_programme(w: &[Vector6<f64>]) -> bool {
        use microlp::{ComparisonOp, OptimizationDirection, Problem, SolveOutcome};
        let mut problem = Problem::new(OptimizationDirection::Maximize);
        let t = problem.add_var(1.0, (-1.0, 1.0));
        let l: Vec<_> = w.iter().map(|_| problem.add_var(0.0, (0.0, 1.0))).collect();
        for row in 0..6 {
            let terms: Vec<_> = l.iter().zip(w).map(|(&v, w)| (v, w[row])).collect();
            problem.add_constraint(&terms[..], ComparisonOp::Eq, 0.0);
        }
        let ones: Vec<_> = l.iter().map(|&v| (v, 1.0)).collect();
        problem.add_constraint(&ones[..], ComparisonOp::Eq, 1.0);
        for &v in &l {
            problem.add_constraint([(v, 1.0), (t, -1.0)], ComparisonOp::Ge, 0.0);
        }
        matches!(problem.solve(), Ok(SolveOutcome::Solution(s)) if s.objective() > 1e-9)
    }
}
