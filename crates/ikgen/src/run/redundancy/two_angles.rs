//! Trigonometric polynomials of two angles: whether the roots in one of them are as many, and single, for all values of the other in a
//! stretch.

use std::f64::consts::{PI, TAU};

/// Least rounding of a value, as a part of the largest sample.
const NOISE: f64 = 1e-14;

/// Rounding of values is no more than so many times the largest wave that should not be there.
const SAFETY: f64 = 30.0;

/// With more rounding than this nothing can be said: the function is rounding of one that vanishes everywhere.
const HOPELESS: f64 = 1e-4;

/// Arcs that the circle is cut into before arcs are halved.
const ARCS: usize = 48;

/// Arcs are halved no further than this, half of their widths, radians.
const NARROW: f64 = 1e-7;

/// Derivatives that the value on an arc is bounded from.
const ORDER: usize = 5;

/// `sum f[i][j] b_i(q) b_j(u)` with `b = 1, cos, sin, cos 2, sin 2, ...`.
#[derive(Debug, Clone)]
pub(super) struct TwoAngles {
    rows: Vec<Vec<f64>>,
    noise: f64,
}

/// The polynomial of `q` on a stretch of `u`: for each `u` its value is `value + d change` for some `d` of the half width, but for what
/// it bends.
struct Stretch {
    value: Vec<f64>,
    change: Vec<f64>,
    half: f64,
    /// Bounds of what is left, for the function and its slope.
    rest: [f64; 2],
}

impl TwoAngles {
    /// From samples at equal steps, those of `q` in rows, those of `u` in columns, odd numbers of both, and the highest waves of both: what
    /// the samples show beyond them is rounding. `None` where all is.
    pub(super) fn new(samples: &[Vec<f64>], degrees: [usize; 2]) -> Option<Self> {
        let largest = samples.iter().flatten().fold(0.0, |a: f64, x| a.max(x.abs()));
        if !(largest > 1e-200 && largest < f64::INFINITY) {
            return None;
        }
        let by_u: Vec<Vec<f64>> = samples.iter().map(|row| waves(row)).collect();
        let columns: Vec<Vec<f64>> = (0..by_u[0].len())
            .map(|j| waves(&by_u.iter().map(|row| row[j] / largest).collect::<Vec<f64>>()))
            .collect();
        let [kept_rows, kept_columns] = degrees.map(|degree| 2 * degree + 1);
        let mut beyond = 0.0f64;
        for (j, column) in columns.iter().enumerate() {
            let from = if j < kept_columns { kept_rows } else { 0 };
            beyond = column[from..].iter().fold(beyond, |a, x| a.max(x.abs()));
        }
        let noise = NOISE + SAFETY * beyond;
        let kept = &columns[..kept_columns];
        let rows = (0..kept_rows).map(|i| kept.iter().map(|column| column[i]).collect()).collect();
        (noise < HOPELESS).then_some(Self { rows, noise })
    }

    fn stretch(&self, low: f64, high: f64) -> Stretch {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let count = self.rows[0].len();
        let (mut basis, mut slopes, mut bends) = (vec![1.0; count], vec![0.0; count], vec![0.0; count]);
        for j in 1..count {
            let k = j.div_ceil(2) as f64;
            let (c, s) = (libm::cos(k * middle), libm::sin(k * middle));
            (basis[j], slopes[j]) = if j % 2 == 1 { (c, -k * s) } else { (s, k * c) };
            bends[j] = 0.5 * k * k * half * half;
        }
        let sum = |row: &[f64], by: &[f64]| row.iter().zip(by).map(|(f, b)| f * b).sum::<f64>();
        let mut rest = [self.noise; 2];
        for (i, row) in self.rows.iter().enumerate() {
            let bend: f64 = row.iter().zip(&bends).map(|(f, b)| f.abs() * b).sum();
            rest[0] += bend;
            rest[1] += bend * i.div_ceil(2) as f64;
        }
        rest[1] += self.noise * self.rows.len() as f64;
        Stretch {
            value: self.rows.iter().map(|row| sum(row, &basis)).collect(),
            change: self.rows.iter().map(|row| sum(row, &slopes)).collect(),
            half,
            rest,
        }
    }

    /// Whether the roots in `q` are as many, and each of them single, for all `u` from `low` to `high`; `false` also means not known.
    pub(super) fn is_steady(&self, low: f64, high: f64) -> bool {
        let stretch = self.stretch(low, high);
        let size = |row: &[f64], power: i32| -> f64 {
            row.iter().enumerate().map(|(i, x)| x.abs() * (i.div_ceil(2) as f64).powi(power)).sum()
        };
        let bounds = [size(&stretch.value, ORDER as i32), size(&stretch.change, ORDER as i32)];
        let mut open: Vec<(f64, f64)> =
            (0..ARCS).map(|k| (-PI + TAU * (k as f64 + 0.5) / ARCS as f64, PI / ARCS as f64)).collect();
        while let Some((centre, radius)) = open.pop() {
            let value = derivatives(&stretch.value, centre);
            let change = derivatives(&stretch.change, centre);
            // What the derivative of this order is at the centre less what it can become: free of roots when positive.
            let left = |order: usize, radius: f64| {
                let mut moved = 0.0;
                let mut factor = 1.0;
                for k in order..ORDER {
                    if k > order {
                        factor *= radius / (k - order) as f64;
                        moved += value[k].abs() * factor;
                    }
                    moved += stretch.half * change[k].abs() * factor;
                }
                factor *= radius / (ORDER - order) as f64;
                moved += (bounds[0] + stretch.half * bounds[1]) * factor;
                value[order].abs() - moved - stretch.rest[order]
            };
            if left(0, radius) > 0.0 || left(1, radius) > 0.0 {
                continue;
            }
            // No narrower arc would tell.
            if radius < NARROW || left(0, 0.0) <= 0.0 && left(1, 0.0) <= 0.0 {
                return false;
            }
            open.push((centre - 0.5 * radius, 0.5 * radius));
            open.push((centre + 0.5 * radius, 0.5 * radius));
        }
        true
    }
}

/// Coefficients of `1, cos, sin, cos 2, ...` from an odd number of samples at equal steps from zero.
fn waves(samples: &[f64]) -> Vec<f64> {
    let n = samples.len();
    let turns: Vec<(f64, f64)> = (0..n)
        .map(|i| {
            let angle = TAU * i as f64 / n as f64;
            (libm::cos(angle), libm::sin(angle))
        })
        .collect();
    (0..n)
        .map(|i| {
            let k = i.div_ceil(2);
            let sum: f64 = samples
                .iter()
                .enumerate()
                .map(|(place, x)| {
                    let (c, s) = turns[place * k % n];
                    x * if i % 2 == 1 || i == 0 { c } else { s }
                })
                .sum();
            sum * if i == 0 { 1.0 } else { 2.0 } / n as f64
        })
        .collect()
}

/// The value and its derivatives at an angle.
fn derivatives(row: &[f64], angle: f64) -> [f64; ORDER] {
    let (c, s) = (libm::cos(angle), libm::sin(angle));
    let (mut x, mut y) = (1.0, 0.0);
    let mut found = [0.0; ORDER];
    found[0] = row[0];
    for (k, pair) in (1..).zip(row[1..].chunks_exact(2)) {
        (x, y) = (x * c - y * s, x * s + y * c);
        let k = f64::from(k);
        let (mut along, mut across) = (pair[0] * x + pair[1] * y, pair[1] * x - pair[0] * y);
        for entry in &mut found {
            *entry += along;
            (along, across) = (k * across, -k * along);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    /// Roots in `q` at one `u`, by dense sampling.
    fn count(f: &impl Fn(f64, f64) -> f64, u: f64) -> usize {
        let n = 1000;
        let at = |i: usize| f(TAU * i as f64 / f64::from(n as u32), u) > 0.0;
        (0..n).filter(|i| at(*i) != at(i + 1)).count()
    }

    #[test]
    fn steady_stretches_hold_no_fold() {
        let mut rng = Seed::new(3).rng();
        let (mut steady, mut folds) = (0, 0);
        for _ in 0..8 {
            let numbers: Vec<f64> = (0..12).map(|_| rng.range(-1.0, 1.0)).collect();
            let a = |i: usize| numbers[i];
            let f = move |q: f64, u: f64| {
                a(0) + a(1) * (q + u).cos()
                    + a(2) * (2.0 * q - u).sin()
                    + a(3) * (3.0 * q).cos() * u.sin()
                    + a(4) * (2.0 * u).cos()
                    + a(5) * (4.0 * q + 2.0 * u).sin()
            };
            let samples: Vec<Vec<f64>> = (0..11)
                .map(|i| (0..7).map(|j| f(TAU * f64::from(i) / 11.0, TAU * f64::from(j) / 7.0)).collect())
                .collect();
            let polynomial = TwoAngles::new(&samples, [4, 2]).unwrap();
            let here = derivatives(&polynomial.stretch(0.7, 0.7).value, 1.2);
            assert!(
                (here[0] * samples.iter().flatten().fold(0.0, |b: f64, x| b.max(x.abs())) - f(1.2, 0.7))
                    .abs()
                    < 1e-13
            );
            for k in 0..64 {
                let (low, high) = (-PI + TAU * f64::from(k) / 64.0, -PI + TAU * f64::from(k + 1) / 64.0);
                let counts: Vec<usize> =
                    (0..=8).map(|i| count(&f, low + (high - low) * f64::from(i) / 8.0)).collect();
                let same = counts.iter().all(|c| *c == counts[0]);
                if polynomial.is_steady(low, high) {
                    assert!(same, "{low} {high} {counts:?}");
                    steady += 1;
                }
                folds += usize::from(!same);
            }
        }
        assert!(steady > 250 && folds > 8, "{steady} {folds}");
    }
}
