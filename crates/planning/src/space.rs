//! A configuration space: bounds, wrapping coordinates, metric, sampling.

use std::f64::consts::{PI, TAU};

use robotc_core::rng::Rng;

/// One coordinate of a space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// Smallest value; ignored when the axis wraps.
    pub lower: f64,
    /// Largest value; ignored when the axis wraps.
    pub upper: f64,
    /// Whether values 2 pi apart are the same state.
    pub wraps: bool,
    /// Factor of this coordinate's difference in the metric; positive.
    pub weight: f64,
}

/// A box of coordinates, some of which wrap at 2 pi, with a weighted Euclidean metric.
///
/// States are slices of [`dimension`](Self::dimension) values. Wrapping coordinates may hold any value; differences
/// take the short way round.
#[derive(Debug, Clone, PartialEq)]
pub struct Space {
    axes: Vec<Axis>,
}

impl Space {
    /// The space of these coordinates.
    pub fn new(axes: Vec<Axis>) -> Self {
        Self { axes }
    }

    /// Number of coordinates.
    pub fn dimension(&self) -> usize {
        self.axes.len()
    }

    /// The coordinates.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The motion from `from` to `to`: `to - from`, the short way round (in [-pi, pi]) where the axis wraps.
    pub fn difference(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        self.axes.iter().zip(from.iter().zip(to)).map(|(axis, (&a, &b))| axis.difference(a, b)).collect()
    }

    /// [`difference`](Self::difference) into memory that is there already.
    pub fn difference_into(&self, from: &[f64], to: &[f64], difference: &mut Vec<f64>) {
        difference.clear();
        let each = self.axes.iter().zip(from.iter().zip(to));
        difference.extend(each.map(|(axis, (&a, &b))| axis.difference(a, b)));
    }

    /// Distance in the metric: the Euclidean norm of the weighted difference.
    pub fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        self.squared_distance(a, b).sqrt()
    }

    /// Square of [`distance`](Self::distance).
    pub fn squared_distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (axis, (&a, &b)) in self.axes.iter().zip(a.iter().zip(b)) {
            let d = axis.weight * axis.difference(a, b);
            sum += d * d;
        }
        sum
    }

    /// The state a fraction `t` of the way from `from` to `to`; wrapping coordinates continue from `from` unwrapped.
    pub fn interpolate(&self, from: &[f64], to: &[f64], t: f64) -> Vec<f64> {
        let along = |(axis, (&a, &b)): (&Axis, (&f64, &f64))| a + t * axis.difference(a, b);
        self.axes.iter().zip(from.iter().zip(to)).map(along).collect()
    }

    /// [`interpolate`](Self::interpolate), appended to memory that is there already.
    pub fn interpolate_into(&self, from: &[f64], to: &[f64], t: f64, out: &mut Vec<f64>) {
        let each = self.axes.iter().zip(from.iter().zip(to));
        out.extend(each.map(|(axis, (&a, &b))| a + t * axis.difference(a, b)));
    }

    /// Whether all coordinates are in bounds.
    pub fn contains(&self, q: &[f64]) -> bool {
        self.axes.iter().zip(q).all(|(axis, &x)| axis.wraps || (axis.lower <= x && x <= axis.upper))
    }

    /// Moves coordinates that are out of bounds to the nearest bound.
    pub fn clamp(&self, q: &mut [f64]) {
        for (axis, x) in self.axes.iter().zip(q) {
            if !axis.wraps {
                *x = x.clamp(axis.lower, axis.upper);
            }
        }
    }

    /// A uniform state; wrapping coordinates in [-pi, pi).
    pub fn sample(&self, rng: &mut Rng) -> Vec<f64> {
        let mut q = vec![0.0; self.dimension()];
        self.sample_into(&mut q, rng);
        q
    }

    /// [`sample`](Self::sample) into memory that is there already.
    pub fn sample_into(&self, q: &mut [f64], rng: &mut Rng) {
        for (x, axis) in q.iter_mut().zip(&self.axes) {
            let (low, high) = if axis.wraps { (-PI, PI) } else { (axis.lower, axis.upper) };
            *x = rng.range(low, high);
        }
    }

    /// A state in a random direction at `distance` from `centre`, moved into the bounds.
    pub fn sample_near(&self, centre: &[f64], distance: f64, rng: &mut Rng) -> Vec<f64> {
        let direction: Vec<f64> = centre.iter().map(|_| rng.normal()).collect();
        let norm = direction.iter().map(|d| d * d).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
        let along = |(axis, (c, d)): (&Axis, (&f64, &f64))| c + distance * d / (norm * axis.weight);
        let mut q: Vec<f64> = self.axes.iter().zip(centre.iter().zip(&direction)).map(along).collect();
        self.clamp(&mut q);
        q
    }

    /// The largest distance between two states.
    pub fn diameter(&self) -> f64 {
        let extent = |axis: &Axis| axis.weight * if axis.wraps { PI } else { axis.upper - axis.lower };
        self.axes.iter().map(extent).map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Rewrites wrapping coordinates so that no step of the path is longer than pi: the path a motor follows.
    pub fn unwrap_path(&self, path: &mut [Vec<f64>]) {
        for i in 1..path.len() {
            let step = self.difference(&path[i - 1], &path[i]);
            for (axis, d) in step.iter().enumerate() {
                if self.axes[axis].wraps {
                    path[i][axis] = path[i - 1][axis] + d;
                }
            }
        }
    }

    /// Length of a path in the metric.
    pub fn length(&self, path: &[Vec<f64>]) -> f64 {
        path.windows(2).map(|w| self.distance(&w[0], &w[1])).sum()
    }

    /// The point of a path at distance `along` from its start, its end beyond that, and the edge that it is on.
    pub(crate) fn point_at(&self, path: &[Vec<f64>], mut along: f64) -> (usize, Vec<f64>) {
        for (edge, pair) in path.windows(2).enumerate() {
            let length = self.distance(&pair[0], &pair[1]);
            if along < length {
                return (edge, self.interpolate(&pair[0], &pair[1], along / length));
            }
            along -= length;
        }
        (path.len() - 2, path[path.len() - 1].clone())
    }
}

impl Axis {
    /// A coordinate with bounds and weight 1.
    pub fn bounded(lower: f64, upper: f64) -> Self {
        Self { lower, upper, wraps: false, weight: 1.0 }
    }

    /// A coordinate that wraps at 2 pi, weight 1.
    pub fn wrapping() -> Self {
        Self { lower: -PI, upper: PI, wraps: true, weight: 1.0 }
    }

    fn difference(&self, from: f64, to: f64) -> f64 {
        let d = to - from;
        if !self.wraps || (-PI..=PI).contains(&d) {
            return d;
        }
        d - TAU * (d / TAU).round()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use robotc_core::Seed;

    fn space() -> Space {
        Space::new(vec![Axis::wrapping(), Axis { weight: 2.0, ..Axis::bounded(-1.0, 3.0) }])
    }

    #[test]
    fn wrapping_takes_the_short_way() {
        let d = space().difference(&[3.0, 0.0], &[-3.0, 1.0]);
        assert!((d[0] - (TAU - 6.0)).abs() < 1e-12);
        assert_eq!(d[1], 1.0);
        let middle = space().interpolate(&[3.0, 0.0], &[-3.0, 1.0], 0.5);
        assert!((middle[0] - PI).abs() < 1e-12);
    }

    #[test]
    fn unwrapped_paths_have_no_jumps() {
        let mut path = vec![vec![3.0, 0.0], vec![-3.0, 0.0], vec![-1.0, 0.0], vec![3.0, 0.0]];
        space().unwrap_path(&mut path);
        assert!(path.windows(2).all(|w| (w[1][0] - w[0][0]).abs() <= PI));
        assert!((path[1][0] - (TAU - 3.0)).abs() < 1e-12);
    }

    #[test]
    fn samples_are_in_bounds_and_nearer_than_the_diameter() {
        let (space, mut rng) = (space(), Seed::new(1).rng());
        let mut last = space.sample(&mut rng);
        for _ in 0..500 {
            let q = space.sample(&mut rng);
            assert!(space.contains(&q));
            assert!(space.distance(&q, &last) <= space.diameter() + 1e-12);
            let near = space.sample_near(&q, 0.5, &mut rng);
            assert!(space.contains(&near) && space.distance(&q, &near) <= 0.5 + 1e-12);
            last = q;
        }
    }

    proptest! {
        #![proptest_config(crate::properties::cases(256))]
        #[test]
        fn the_metric_is_symmetric_and_satisfies_the_triangle_inequality(
            a in prop::array::uniform2(-9.0..9.0f64),
            b in prop::array::uniform2(-9.0..9.0f64),
            c in prop::array::uniform2(-9.0..9.0f64),
        ) {
            let s = space();
            prop_assert!((s.distance(&a, &b) - s.distance(&b, &a)).abs() < 1e-9);
            prop_assert!(s.distance(&a, &c) <= s.distance(&a, &b) + s.distance(&b, &c) + 1e-9);
        }
    }
}
