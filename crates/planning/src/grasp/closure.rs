//! Whether contacts resist every wrench: force closure, yes or no.
//!
//! They do when the origin lies strictly inside the convex hull of their wrenches. The point of the hull nearest to the origin
//! (Wolfe, "Finding the nearest point in a polytope", 1976) settles most sets: away from the origin it is the normal of
//! a plane that separates. At the origin it comes with the wrenches that surround it; when they surround it in fewer
//! than six dimensions, what is left to ask is the same question across the space that they span.

use nalgebra::Vector6;

/// Wrenches shorter than this are zero, and a hull nearer to the origin than this contains it.
const ZERO: f64 = 1e-8;
/// Weights smaller than this are zero.
const NO_WEIGHT: f64 = 1e-12;
/// More rounds than ever needed; then the answer is no.
const MOST_ROUNDS: usize = 200;

/// Whether the origin lies strictly inside the convex hull of `wrenches`: whether contacts that can exert them, and all
/// their non-negative sums, resist every wrench. What is nearer than about 1e-8 to not closing counts as not closing.
pub fn closes(wrenches: &[Vector6<f64>]) -> bool {
    let mut points: Vec<Vector6<f64>> = wrenches.to_vec();
    let mut open = 6;
    loop {
        points.retain(|p| p.norm_squared() > ZERO * ZERO);
        let Some(around) = around_origin(&points) else { return false };
        let spanned = span(&around);
        if spanned.len() >= open {
            return true;
        }
        if spanned.is_empty() {
            return false;
        }
        open -= spanned.len();
        for p in &mut points {
            for axis in &spanned {
                *p -= axis * axis.dot(p);
            }
        }
    }
}

/// Points which, with one more, surround the origin: they span the space in which it is surrounded. `None` when the origin
/// is outside the hull of all points.
fn around_origin(points: &[Vector6<f64>]) -> Option<Vec<Vector6<f64>>> {
    let lengths = points.iter().map(Vector6::norm_squared).enumerate();
    let (shortest, _) = lengths.reduce(|a, b| if b.1 < a.1 { b } else { a })?;
    let mut corral = Corral { points, chosen: vec![shortest], weights: vec![1.0] };
    let mut nearest = points[shortest];
    for _ in 0..MOST_ROUNDS {
        let square = nearest.norm_squared();
        if square <= ZERO * ZERO {
            return Some(corral.all_but_heaviest());
        }
        let (mut lowest, mut height) = (0, f64::INFINITY);
        for (i, p) in points.iter().enumerate() {
            let h = p.dot(&nearest);
            if h < height {
                (lowest, height) = (i, h);
            }
        }
        // All points beyond a plane that the origin is not on.
        if height > 0.5 * ZERO * square.sqrt() || corral.chosen.contains(&lowest) {
            return None;
        }
        corral.chosen.push(lowest);
        corral.weights.push(0.0);
        nearest = corral.reduce()?;
    }
    None
}

/// Affinely independent points whose hull holds the nearest point found so far.
struct Corral<'a> {
    points: &'a [Vector6<f64>],
    chosen: Vec<usize>,
    weights: Vec<f64>,
}

impl Corral<'_> {
    /// The chosen points without that of the largest weight, which is a sum of the others.
    fn all_but_heaviest(&self) -> Vec<Vector6<f64>> {
        let by_weight = |a: &usize, b: &usize| self.weights[*a].total_cmp(&self.weights[*b]);
        let heaviest = (0..self.chosen.len()).max_by(by_weight);
        let others = self.chosen.iter().enumerate().filter(|(slot, _)| Some(*slot) != heaviest);
        others.map(|(_, &i)| self.points[i]).collect()
    }

    /// Moves to the nearest point of the hull of the chosen points, and drops those that do not carry it. `None` when they
    /// are not independent.
    fn reduce(&mut self) -> Option<Vector6<f64>> {
        loop {
            let wanted = self.flat_weights()?;
            if wanted.iter().all(|w| *w > NO_WEIGHT) {
                self.weights = wanted;
                let carried = self.chosen.iter().zip(&self.weights);
                return Some(carried.map(|(&i, w)| self.points[i] * *w).sum());
            }
            // As far towards it as all weights stay positive; the first to vanish leaves.
            let mut share: f64 = 1.0;
            for (have, want) in self.weights.iter().zip(&wanted) {
                if *want <= NO_WEIGHT {
                    share = share.min(have / (have - want).max(f64::MIN_POSITIVE));
                }
            }
            for (have, want) in self.weights.iter_mut().zip(&wanted) {
                *have += (want - *have) * share;
            }
            let mut keep = self.weights.iter().map(|w| *w > NO_WEIGHT).collect::<Vec<_>>();
            if keep.iter().all(|k| *k) {
                let smallest =
                    (0..keep.len()).min_by(|&a, &b| self.weights[a].total_cmp(&self.weights[b]))?;
                keep[smallest] = false;
            }
            let mut flags = keep.iter();
            self.chosen.retain(|_| flags.next() == Some(&true));
            let mut flags = keep.iter();
            self.weights.retain(|_| flags.next() == Some(&true));
            if self.chosen.is_empty() {
                return None;
            }
        }
    }

    /// Weights of the point nearest to the origin in the affine hull of the chosen points; they sum to one.
    ///
    /// With G the products of the points, (G + 1) u = 1 gives them up to scale; G + 1 is positive definite when the points are
    /// affinely independent.
    fn flat_weights(&self) -> Option<Vec<f64>> {
        const MOST: usize = 7;
        let n = self.chosen.len();
        if n > MOST {
            return None;
        }
        let mut factor = [[0.0; MOST]; MOST];
        for i in 0..n {
            for j in 0..=i {
                let mut sum = self.points[self.chosen[i]].dot(&self.points[self.chosen[j]]) + 1.0;
                for k in 0..j {
                    sum -= factor[i][k] * factor[j][k];
                }
                if i > j {
                    factor[i][j] = sum / factor[j][j];
                } else if sum > 1e-14 {
                    factor[i][i] = sum.sqrt();
                } else {
                    return None;
                }
            }
        }
        let mut u = [1.0; MOST];
        for i in 0..n {
            for k in 0..i {
                u[i] -= factor[i][k] * u[k];
            }
            u[i] /= factor[i][i];
        }
        for i in (0..n).rev() {
            for k in i + 1..n {
                u[i] -= factor[k][i] * u[k];
            }
            u[i] /= factor[i][i];
        }
        let sum: f64 = u[..n].iter().sum();
        Some(u[..n].iter().map(|x| x / sum).collect())
    }
}

/// Orthonormal axes of the space that the points span.
fn span(points: &[Vector6<f64>]) -> Vec<Vector6<f64>> {
    let mut axes: Vec<Vector6<f64>> = Vec::with_capacity(6);
    for p in points {
        let mut rest = *p;
        for _ in 0..2 {
            for axis in &axes {
                rest -= axis * axis.dot(&rest);
            }
        }
        let length = rest.norm();
        if length > 1e-7 * p.norm() {
            axes.push(rest / length);
        }
    }
    axes
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    fn axis(i: usize, length: f64) -> Vector6<f64> {
        let mut p = Vector6::zeros();
        p[i] = length;
        p
    }

    #[test]
    fn a_cross_closes_until_one_end_is_cut() {
        let mut points: Vec<_> = (0..6).flat_map(|i| [axis(i, 1.0), axis(i, -0.5)]).collect();
        assert!(closes(&points));
        points.pop();
        assert!(!closes(&points));
        points.push(axis(5, -1e-3) + axis(2, 4.0));
        assert!(closes(&points));
    }

    #[test]
    fn a_simplex_closes_exactly_when_it_contains_the_origin() {
        let mut rng = Seed::new(5).rng();
        let (mut yes, mut no) = (0, 0);
        for _ in 0..400 {
            let points: Vec<Vector6<f64>> = (0..7).map(|_| Vector6::from_fn(|_, _| rng.normal())).collect();
            // The barycentric coordinates of the origin.
            let system =
                nalgebra::SMatrix::<f64, 7, 7>::from_fn(
                    |row, column| {
                        if row < 6 { points[column][row] } else { 1.0 }
                    },
                );
            let mut one = nalgebra::SVector::<f64, 7>::zeros();
            one[6] = 1.0;
            let Some(weights) = system.lu().solve(&one) else { continue };
            if weights.iter().any(|w| w.abs() < 1e-6) {
                continue;
            }
            let inside = weights.iter().all(|w| *w > 0.0);
            assert_eq!(closes(&points), inside, "{weights}");
            if inside { yes += 1 } else { no += 1 }
        }
        assert!(yes >= 1 && no > 300, "{yes} {no}");
    }

    #[test]
    fn nothing_and_too_little_do_not_close() {
        assert!(!closes(&[]));
        assert!(!closes(&[Vector6::zeros(); 9]));
        assert!(!closes(&[axis(0, 1.0), axis(0, -1.0)]));
    }
}
