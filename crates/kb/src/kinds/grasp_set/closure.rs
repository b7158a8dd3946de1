//! Force closure and the Ferrari-Canny epsilon of a set of contacts.
//!
//! A contact presses with a unit force inside its friction cone. The cone is replaced by a pyramid; each edge gives a
//! wrench (force, torque about the centre of mass divided by a length of the object, so that epsilon has no unit).
//! Epsilon is the radius of the largest ball about the origin inside the convex hull of these wrenches: the smallest
//! disturbance, whatever its direction, that unit contact forces cannot resist (Ferrari and Canny, "Planning optimal
//! grasps", 1992; thesis section 4.2).
//!
//! The hull in six dimensions is never built as a whole. A polytope inside it grows, always through its facet
//! nearest to the origin, until that facet lies on the hull: then its distance is epsilon exactly.

use std::collections::BTreeMap;

use nalgebra::{Matrix6, Point3, Unit, Vector3, Vector6};

/// A point where the hand presses on the object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PointContact {
    /// Where, in the object frame, metres.
    pub(super) point: Point3<f64>,
    /// Direction of the pressing force: into the object.
    pub(super) inward: Unit<Vector3<f64>>,
}

/// What a contact can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ContactModel {
    /// Coulomb friction coefficient.
    pub(super) friction: f64,
    /// Edges of the pyramid that stands for the friction cone; at least 3.
    pub(super) cone_edges: usize,
    /// Torques are taken about this point of the object frame: its centre of mass.
    pub(super) centre: Point3<f64>,
    /// Torques are divided by this length, metres: the largest distance of the object's surface from `centre`.
    pub(super) length: f64,
}

/// The wrenches of all pyramid edges of all contacts: unit normal force plus friction, and its scaled torque.
pub(super) fn wrenches(contacts: &[PointContact], model: &ContactModel) -> Vec<Vector6<f64>> {
    let mut out = Vec::with_capacity(contacts.len() * model.cone_edges);
    for contact in contacts {
        let normal = contact.inward.into_inner();
        let (u, v) = tangents(&contact.inward);
        let arm = (contact.point - model.centre) / model.length;
        for edge in 0..model.cone_edges {
            let angle = std::f64::consts::TAU * edge as f64 / model.cone_edges as f64;
            let force = normal + (u * libm::cos(angle) + v * libm::sin(angle)) * model.friction;
            let torque = arm.cross(&force);
            out.push(Vector6::new(force.x, force.y, force.z, torque.x, torque.y, torque.z));
        }
    }
    out
}

/// Two unit vectors that make a right-handed frame with `normal`.
pub(super) fn tangents(normal: &Unit<Vector3<f64>>) -> (Vector3<f64>, Vector3<f64>) {
    let smallest = normal.iamin();
    let mut other = Vector3::zeros();
    other[smallest] = 1.0;
    let u = normal.cross(&other).normalize();
    (u, normal.cross(&u))
}

/// The smallest part of a wrench that counts as a direction of its own.
const RANK_TOLERANCE: f64 = 1e-7;
/// A facet closer than this to the hull is on the hull.
const GROWTH_TOLERANCE: f64 = 1e-10;
/// Growth steps before the lower bound reached so far is returned; real grasps need a few dozen.
const MOST_STEPS: usize = 2_000;

/// Ferrari-Canny epsilon of the convex hull of `points`: positive when the origin lies strictly inside (force
/// closure), zero or negative when it does not (then only the sign has a meaning), and `None` when the points do not
/// span six dimensions, as with two hard point contacts.
pub(super) fn epsilon(points: &[Vector6<f64>]) -> Option<f64> {
    let simplex = initial_simplex(points)?;
    let mut polytope = Polytope::new(points, &simplex)?;
    let mut bound = f64::NEG_INFINITY;
    for _ in 0..MOST_STEPS {
        let nearest = polytope.nearest_facet();
        bound = nearest.offset;
        let (support, height) = support(points, &nearest.normal);
        if height <= nearest.offset + GROWTH_TOLERANCE || !polytope.grow(support) {
            return Some(bound);
        }
    }
    Some(bound)
}

fn support(points: &[Vector6<f64>], direction: &Vector6<f64>) -> (usize, f64) {
    let mut best = (0, f64::NEG_INFINITY);
    for (i, p) in points.iter().enumerate() {
        let height = p.dot(direction);
        if height > best.1 {
            best = (i, height);
        }
    }
    best
}

/// Seven affinely independent points, each the farthest from the span of those before it.
fn initial_simplex(points: &[Vector6<f64>]) -> Option<[usize; 7]> {
    let mut chosen = [0; 7];
    let mut basis: Vec<Vector6<f64>> = Vec::with_capacity(6);
    let origin = *points.first()?;
    for slot in 1..7 {
        let residual = |p: &Vector6<f64>| {
            let mut rest = p - origin;
            for b in &basis {
                rest -= b * b.dot(&rest);
            }
            rest
        };
        let mut farthest = (0, 0.0);
        for (i, p) in points.iter().enumerate() {
            let distance = residual(p).norm();
            if distance > farthest.1 {
                farthest = (i, distance);
            }
        }
        if farthest.1 < RANK_TOLERANCE {
            return None;
        }
        chosen[slot] = farthest.0;
        basis.push(residual(&points[farthest.0]).normalize());
    }
    Some(chosen)
}

#[derive(Clone)]
struct Facet {
    vertices: [usize; 6],
    normal: Vector6<f64>,
    /// Signed distance of the origin behind the facet: positive when the origin is inside.
    offset: f64,
}

struct Polytope<'a> {
    points: &'a [Vector6<f64>],
    interior: Vector6<f64>,
    facets: Vec<Facet>,
}

impl<'a> Polytope<'a> {
    fn new(points: &'a [Vector6<f64>], simplex: &[usize; 7]) -> Option<Self> {
        let interior = simplex.iter().map(|&i| points[i]).sum::<Vector6<f64>>() / 7.0;
        let mut polytope = Self { points, interior, facets: Vec::new() };
        for left_out in 0..7 {
            let mut vertices = [0; 6];
            let kept = simplex.iter().enumerate().filter(|(i, _)| *i != left_out);
            for (slot, (_, &vertex)) in vertices.iter_mut().zip(kept) {
                *slot = vertex;
            }
            let facet = polytope.facet(vertices)?;
            polytope.facets.push(facet);
        }
        Some(polytope)
    }

    fn nearest_facet(&self) -> &Facet {
        let mut best = &self.facets[0];
        for facet in &self.facets {
            if facet.offset < best.offset {
                best = facet;
            }
        }
        best
    }

    /// The facet through six points, its normal away from the interior; `None` if they span no hyperplane.
    fn facet(&self, mut vertices: [usize; 6]) -> Option<Facet> {
        vertices.sort_unstable();
        let normal = hyperplane_normal(&vertices.map(|i| self.points[i]))?;
        let offset = normal.dot(&self.points[vertices[0]]);
        let outward = offset > normal.dot(&self.interior);
        let (normal, offset) = if outward { (normal, offset) } else { (-normal, -offset) };
        Some(Facet { vertices, normal, offset })
    }

    /// Replaces the polytope by its hull with a point; false when rounding leaves nothing to replace.
    fn grow(&mut self, point: usize) -> bool {
        let p = self.points[point];
        let visible = |f: &Facet| f.normal.dot(&p) > f.offset + 0.5 * GROWTH_TOLERANCE;
        let mut ridges: BTreeMap<[usize; 5], u32> = BTreeMap::new();
        for facet in self.facets.iter().filter(|f| visible(f)) {
            for left_out in 0..6 {
                let mut ridge = [0; 5];
                let kept = facet.vertices.iter().enumerate().filter(|(i, _)| *i != left_out);
                for (slot, (_, &vertex)) in ridge.iter_mut().zip(kept) {
                    *slot = vertex;
                }
                *ridges.entry(ridge).or_default() += 1;
            }
        }
        let mut fresh = Vec::new();
        for (ridge, _) in ridges.iter().filter(|(_, count)| **count == 1) {
            let vertices = [ridge[0], ridge[1], ridge[2], ridge[3], ridge[4], point];
            match self.facet(vertices) {
                Some(facet) => fresh.push(facet),
                None => return false,
            }
        }
        if fresh.is_empty() {
            return false;
        }
        self.facets.retain(|f| !visible(f));
        self.facets.append(&mut fresh);
        true
    }
}

/// Unit normal of the hyperplane through six points: Gram-Schmidt on the five edges, then the axis with the
/// largest part outside of their span.
fn hyperplane_normal(points: &[Vector6<f64>; 6]) -> Option<Vector6<f64>> {
    let mut edges: Matrix6<f64> = Matrix6::zeros();
    for k in 0..5 {
        let mut edge = points[k + 1] - points[0];
        let length = edge.norm();
        // Twice is enough for full accuracy.
        for _ in 0..2 {
            for j in 0..k {
                let basis = edges.column(j).into_owned();
                edge -= basis * basis.dot(&edge);
            }
        }
        let rest = edge.norm();
        if rest <= 1e-11 * length.max(1e-3) {
            return None;
        }
        edges.set_column(k, &(edge / rest));
    }
    let mut best = Vector6::zeros();
    for axis in 0..6 {
        let mut rest = Vector6::zeros();
        rest[axis] = 1.0;
        for _ in 0..2 {
            for j in 0..5 {
                let basis = edges.column(j).into_owned();
                rest -= basis * basis.dot(&rest);
            }
        }
        if rest.norm_squared() > best.norm_squared() {
            best = rest;
        }
    }
    Some(best.normalize())
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    fn contact(point: [f64; 3], inward: [f64; 3]) -> PointContact {
        PointContact { point: Point3::from(point), inward: Unit::new_normalize(Vector3::from(inward)) }
    }

    fn model(friction: f64) -> ContactModel {
        ContactModel { friction, cone_edges: 8, centre: Point3::origin(), length: 1.0 }
    }

    /// Two flat pads on opposite faces of a cube.
    fn jaws() -> Vec<PointContact> {
        let mut contacts = Vec::new();
        for side in [-1.0, 1.0] {
            for (y, z) in [(-0.3, -0.3), (-0.3, 0.3), (0.3, -0.3), (0.3, 0.3)] {
                contacts.push(contact([side, y, z], [-side, 0.0, 0.0]));
            }
        }
        contacts
    }

    #[test]
    fn two_hard_points_never_close_and_two_patches_do() {
        let points = [contact([1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]), contact([-1.0, 0.0, 0.0], [1.0, 0.0, 0.0])];
        assert_eq!(epsilon(&wrenches(&points, &model(0.5))), None);
        assert!(epsilon(&wrenches(&jaws(), &model(0.5))).unwrap() > 0.05);
    }

    #[test]
    fn one_side_alone_does_not_close() {
        let side: Vec<_> = jaws().into_iter().filter(|c| c.point.x > 0.0).collect();
        assert!(epsilon(&wrenches(&side, &model(0.5))).is_none_or(|e| e <= 1e-9));
    }

    #[test]
    fn more_friction_resists_more() {
        let values: Vec<f64> =
            [0.1, 0.3, 0.6, 1.0].iter().map(|&mu| epsilon(&wrenches(&jaws(), &model(mu))).unwrap()).collect();
        assert!(values.windows(2).all(|w| w[0] < w[1]), "{values:?}");
    }

    #[test]
    fn cross_polytope_has_the_known_inner_radius() {
        let mut points = Vec::new();
        for axis in 0..6 {
            for sign in [-1.0, 1.0] {
                let mut p = Vector6::zeros();
                p[axis] = sign;
                points.push(p);
            }
        }
        assert!((epsilon(&points).unwrap() - 1.0 / 6f64.sqrt()).abs() < 1e-12);
    }

    /// No direction may have a support smaller than a positive epsilon, and force closure must agree with a linear programme:
    /// maximise t subject to sum l_i w_i = 0, sum l_i = 1, l_i >= t.
    #[test]
    fn agrees_with_sampled_supports_and_a_linear_programme() {
        for trial in 0..60 {
            let mut rng = Seed::new(3).at(trial).rng();
            let count = 3 + rng.below(6);
            let contacts: Vec<_> = (0..count)
                .map(|_| {
                    let out = rng.direction();
                    let tilt = rng.direction().into_inner() * 0.4;
                    PointContact {
                        point: Point3::from(out.into_inner()),
                        inward: Unit::new_normalize(-out.into_inner() + tilt),
                    }
                })
                .collect();
            let w = wrenches(&contacts, &model(0.4));
            let value = epsilon(&w).expect("random contacts span all directions");
            for _ in 0..300 {
                let mut u = Vector6::zeros();
                for i in 0..6 {
                    u[i] = rng.normal();
                }
                let (_, height) = support(&w, &u.normalize());
                assert!(value <= 0.0 || height >= value - 1e-9, "support {height} below epsilon {value}");
            }
            assert_eq!(value > 1e-9, closes_by_linear_programme(&w), "trial {trial}, epsilon {value}");
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
