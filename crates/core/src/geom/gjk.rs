//! Distance between two convex point sets (Gilbert, Johnson and Keerthi 1988), with a proof for each answer.
//!
//! "Farther apart than the limit" is answered only with a direction along which the gap was measured; every doubt
//! counts as near. So a numeric accident can block a motion but never clear one.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use super::{ConvexPart, Otherwise, RoomAsked};

/// What the distance is asked of: a compact convex set.
pub(super) trait Convex {
    /// The point farthest along `direction`, to within rounding.
    fn farthest(&self, direction: &Vector3<f64>) -> Point3<f64>;

    /// Some point of it, as central as is easily known.
    fn middle(&self) -> Point3<f64>;
}

impl Convex for ConvexPart {
    #[inline]
    fn farthest(&self, direction: &Vector3<f64>) -> Point3<f64> {
        *self.support(direction)
    }

    #[inline]
    fn middle(&self) -> Point3<f64> {
        self.bounding_sphere().0
    }
}

/// Two convex sets in the frame of the first.
pub(super) struct Pair<'a, B = ConvexPart> {
    a: &'a ConvexPart,
    b: &'a B,
    a_from_b: Matrix3<f64>,
    b_origin_in_a: Vector3<f64>,
}

/// A point of the difference a - b, and the points it comes from; all in the frame of a.
#[derive(Clone, Copy)]
struct Corner {
    w: Vector3<f64>,
    on_a: Point3<f64>,
    on_b: Point3<f64>,
}

/// What is known of the distance.
pub(super) enum Gap {
    /// The parts overlap, or are too near to tell; with a common point in the frame of a.
    Overlap { common: Point3<f64> },
    /// At most the limit; not refined.
    Near,
    /// More than the limit, proven.
    Far,
    /// The distance, with the nearest points in the frame of a.
    Apart { distance: f64, on_a: Point3<f64>, on_b: Point3<f64> },
}

/// What the caller wants to know.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Ask {
    /// Only whether the distance is more than the limit.
    Whether,
    /// The distance, if not more than the limit.
    Distance,
}

/// Gaps below this are contact: lengths here are below 100 m, and doubles keep 1e-14 of that.
const TOUCHING: f64 = 1e-12;

/// The distance is refined until the proven bound is within this fraction of it.
const RELATIVE_ERROR: f64 = 1e-9;

/// A distance that is asked for roughly is found to within this fraction.
const ROUGHLY: f64 = 0.1;

/// A tetrahedron lower than this fraction of its edge is flat.
const FLAT: f64 = 1e-10;

/// More rounds than ever needed; then the answer is "near".
const MAX_ROUNDS: usize = 100;

impl<'a, B: Convex> Pair<'a, B> {
    /// Sets `a` and `b`, with `a_from_b` between their frames.
    pub(super) fn new(a: &'a ConvexPart, b: &'a B, a_from_b: &Isometry3<f64>) -> Self {
        let rotation = *a_from_b.rotation.to_rotation_matrix().matrix();
        Self::with_matrix(a, b, rotation, a_from_b.translation.vector)
    }

    /// The same with the rotation as a matrix.
    pub(super) fn with_matrix(
        a: &'a ConvexPart,
        b: &'a B,
        a_from_b: Matrix3<f64>,
        b_origin_in_a: Vector3<f64>,
    ) -> Self {
        Self { a, b, a_from_b, b_origin_in_a }
    }

    fn support(&self, direction: &Vector3<f64>) -> Corner {
        let on_a = self.a.farthest(direction);
        let towards_a = -self.a_from_b.tr_mul(direction);
        let on_b = Point3::from(self.a_from_b * self.b.farthest(&towards_a).coords + self.b_origin_in_a);
        Corner { w: on_a - on_b, on_a, on_b }
    }

    fn between(&self) -> Vector3<f64> {
        self.a_from_b * self.b.middle().coords + self.b_origin_in_a - self.a.middle().coords
    }

    /// The gap between the two, as far as asked.
    pub(super) fn gap(&self, limit: f64, ask: Ask) -> Gap {
        let between = self.between();
        let start = if between.norm_squared() > 0.0 { between } else { Vector3::x() };
        let mut simplex = Simplex::new(self.support(&start));
        let mut v = simplex.corners[0].w;
        let mut lower: f64 = 0.0;
        for _ in 0..MAX_ROUNDS {
            let length = v.norm();
            if length <= TOUCHING {
                return simplex.overlap();
            }
            let corner = self.support(&-v);
            lower = lower.max(corner.w.dot(&v) / length);
            if lower > limit + TOUCHING {
                return Gap::Far;
            }
            if ask == Ask::Whether && length <= limit {
                return Gap::Near;
            }
            if length - lower <= RELATIVE_ERROR * length || simplex.has(&corner.w) {
                return simplex.apart(length);
            }
            let previous = simplex;
            simplex.push(corner);
            match simplex.reduce() {
                None => return simplex.overlap(),
                Some(nearer) if nearer.norm_squared() < v.norm_squared() => v = nearer,
                Some(_) => return previous.apart(length),
            }
        }
        simplex.apart(v.norm())
    }

    /// A unit direction from a to b, in the frame of a, with the gap along it: at least `1 - relative` times the distance.
    /// `None` when the parts overlap or are too near to tell.
    pub(super) fn separation(&self, relative: f64) -> Option<(Vector3<f64>, f64)> {
        let between = self.between();
        let start = if between.norm_squared() > 0.0 { between } else { Vector3::x() };
        let mut simplex = Simplex::new(self.support(&start));
        let mut v = simplex.corners[0].w;
        let mut best = (Vector3::zeros(), TOUCHING);
        for _ in 0..MAX_ROUNDS {
            let length = v.norm();
            if length <= TOUCHING {
                return None;
            }
            let corner = self.support(&-v);
            let gap = corner.w.dot(&v) / length;
            if gap > best.1 {
                best = (-v / length, gap);
            }
            if length - best.1 <= relative * length || simplex.has(&corner.w) {
                break;
            }
            simplex.push(corner);
            match simplex.reduce() {
                None => return None,
                Some(nearer) if nearer.norm_squared() < v.norm_squared() => v = nearer,
                Some(_) => break,
            }
        }
        (best.1 > TOUCHING).then_some(best)
    }

    /// A unit direction from a to b, in the frame of a, along which the gap is more than `asked.least`, both without `grown`
    /// metres of b's surroundings that belong to it; `None` when they are nearer than that or it cannot be told. How much
    /// more it is: see [`RoomAsked`].
    pub(super) fn room(&self, grown: f64, asked: &RoomAsked) -> Option<(Vector3<f64>, f64)> {
        let least = asked.least.max(TOUCHING) + grown;
        let enough = (asked.enough + grown).max(least);
        let mut v = asked.along.unwrap_or_else(|| self.between());
        if v.norm_squared() == 0.0 {
            v = Vector3::x();
        }
        let corner = self.support(&v);
        // The first corner already says something about the gap along the direction that it was looked for in.
        let length = v.norm();
        let mut best = (v / length, -corner.w.dot(&v) / length);
        let mut simplex = Simplex::new(corner);
        v = simplex.corners[0].w;
        for _ in 0..MAX_ROUNDS {
            if best.1 > enough {
                break;
            }
            let length = v.norm();
            if length <= least {
                return None;
            }
            let corner = self.support(&-v);
            let gap = corner.w.dot(&v) / length;
            if gap > best.1 {
                best = (-v / length, gap);
            }
            let is_close = match asked.otherwise {
                Otherwise::Roughly => length - best.1 <= ROUGHLY * (length - grown),
                Otherwise::Anything => length <= enough,
            };
            if best.1 > least && is_close || simplex.has(&corner.w) {
                break;
            }
            simplex.push(corner);
            match simplex.reduce() {
                None => return None,
                Some(nearer) if nearer.norm_squared() < v.norm_squared() => v = nearer,
                Some(_) => break,
            }
        }
        (best.1 > least).then_some((best.0, best.1 - grown))
    }
}

/// One to four corners, with the weights of the point of their hull nearest to the origin.
#[derive(Clone, Copy)]
struct Simplex {
    corners: [Corner; 4],
    weights: [f64; 4],
    len: usize,
}

impl Simplex {
    fn new(corner: Corner) -> Self {
        Self { corners: [corner; 4], weights: [1.0, 0.0, 0.0, 0.0], len: 1 }
    }

    fn has(&self, w: &Vector3<f64>) -> bool {
        self.corners[..self.len].iter().any(|c| c.w == *w)
    }

    fn push(&mut self, corner: Corner) {
        self.corners[self.len] = corner;
        self.len += 1;
    }

    fn apart(&self, distance: f64) -> Gap {
        let (on_a, on_b) = self.witnesses();
        Gap::Apart { distance, on_a, on_b }
    }

    /// The answer when the origin is in the simplex; a tetrahedron's weights are its sub-volumes.
    fn overlap(mut self) -> Gap {
        if self.len == 4 {
            let w = |i: usize| self.corners[i].w;
            let volumes = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]
                .map(|[i, j, k]| w(i).cross(&w(j)).dot(&w(k)).abs());
            let sum: f64 = volumes.iter().sum();
            self.weights = if sum > 0.0 { volumes.map(|v| v / sum) } else { [0.25; 4] };
        }
        Gap::Overlap { common: self.witnesses().0 }
    }

    /// The point of each part that the weights stand for.
    fn witnesses(&self) -> (Point3<f64>, Point3<f64>) {
        let mut on_a = Vector3::zeros();
        let mut on_b = Vector3::zeros();
        for i in 0..self.len {
            on_a += self.corners[i].on_a.coords * self.weights[i];
            on_b += self.corners[i].on_b.coords * self.weights[i];
        }
        (Point3::from(on_a), Point3::from(on_b))
    }

    /// Keeps the corners that carry the nearest point and returns it; `None` when the origin is inside.
    fn reduce(&mut self) -> Option<Vector3<f64>> {
        let w = |i: usize| self.corners[i].w;
        let nearest = match self.len {
            1 => (w(0), [(0, 1.0), (0, 0.0), (0, 0.0)]),
            2 => nearest_on_segment(&w(0), &w(1), [0, 1]),
            3 => nearest_on_face(&w(0), &w(1), &w(2), [0, 1, 2]),
            _ => {
                let faces = [[0, 1, 2, 3], [0, 1, 3, 2], [0, 2, 3, 1], [1, 2, 3, 0]];
                let mut best: Option<(Vector3<f64>, [(usize, f64); 3])> = None;
                for [i, j, k, opposite] in faces {
                    let normal = (w(j) - w(i)).cross(&(w(k) - w(i)));
                    let origin_side = -normal.dot(&w(i));
                    let inner = w(opposite) - w(i);
                    let inner_side = normal.dot(&inner);
                    // The sign of a flat tetrahedron's height is noise: then every face is looked at.
                    let flat = inner_side.abs() <= FLAT * normal.norm() * inner.norm();
                    if origin_side * inner_side > 0.0 && !flat {
                        continue;
                    }
                    let candidate = nearest_on_face(&w(i), &w(j), &w(k), [i, j, k]);
                    if best.is_none_or(|b| candidate.0.norm_squared() < b.0.norm_squared()) {
                        best = Some(candidate);
                    }
                }
                best?
            }
        };
        let (point, carriers) = nearest;
        let corners = self.corners;
        self.len = 0;
        for (i, weight) in carriers {
            if weight > 0.0 {
                self.corners[self.len] = corners[i];
                self.weights[self.len] = weight;
                self.len += 1;
            }
        }
        Some(point)
    }
}

type Nearest = (Vector3<f64>, [(usize, f64); 3]);

fn nearest_on_segment(a: &Vector3<f64>, b: &Vector3<f64>, [i, j]: [usize; 2]) -> Nearest {
    let ab = b - a;
    let t = -a.dot(&ab) / ab.norm_squared();
    if t.is_nan() || t <= 0.0 {
        (*a, [(i, 1.0), (j, 0.0), (i, 0.0)])
    } else if t >= 1.0 {
        (*b, [(j, 1.0), (i, 0.0), (i, 0.0)])
    } else {
        (a + ab * t, [(i, 1.0 - t), (j, t), (i, 0.0)])
    }
}

/// The point of triangle abc nearest to the origin (Ericson 2005, section 5.1.5).
fn nearest_on_face(a: &Vector3<f64>, b: &Vector3<f64>, c: &Vector3<f64>, [i, j, k]: [usize; 3]) -> Nearest {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (-ab.dot(a), -ac.dot(a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (*a, [(i, 1.0), (i, 0.0), (i, 0.0)]);
    }
    let (d3, d4) = (-ab.dot(b), -ac.dot(b));
    if d3 >= 0.0 && d4 <= d3 {
        return (*b, [(j, 1.0), (i, 0.0), (i, 0.0)]);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return nearest_on_segment(a, b, [i, j]);
    }
    let (d5, d6) = (-ab.dot(c), -ac.dot(c));
    if d6 >= 0.0 && d5 <= d6 {
        return (*c, [(k, 1.0), (i, 0.0), (i, 0.0)]);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return nearest_on_segment(a, c, [i, k]);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return nearest_on_segment(b, c, [j, k]);
    }
    let sum = va + vb + vc;
    if sum <= 0.0 || sum.is_nan() {
        // A triangle without area that fell through: its best edge.
        let edges = [
            nearest_on_segment(a, b, [i, j]),
            nearest_on_segment(a, c, [i, k]),
            nearest_on_segment(b, c, [j, k]),
        ];
        let shortest = |x: Nearest, y: Nearest| if y.0.norm_squared() < x.0.norm_squared() { y } else { x };
        return edges.into_iter().reduce(shortest).expect("three edges");
    }
    let (v, t) = (vb / sum, vc / sum);
    (a + ab * v + ac * t, [(i, 1.0 - v - t), (j, v), (k, t)])
}
