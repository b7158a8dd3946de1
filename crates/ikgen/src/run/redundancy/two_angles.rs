//! Trigonometric polynomials of two angles: whether the roots in one of them are as many, and single, for all values of the other in a
//! stretch.

use std::f64::consts::{PI, TAU};

use super::double::{Double, both, division, turn_along};

/// Rounding of a value on a stretch, as a part of the sizes that it is the sum of.
const NOISE: f64 = 1e-14;

/// Rounding of coefficients is no more than so many times the largest wave that should not be there.
const SAFETY: f64 = 30.0;

/// With more rounding than this nothing can be said: the function is rounding of one that vanishes everywhere.
const HOPELESS: f64 = 1e-4;

/// Least rounding of coefficients, as a part of the largest sample.
const ROUNDING: f64 = 1e-28;

/// Arcs that the circle is cut into before arcs are halved.
const ARCS: usize = 48;

/// Arcs are halved no further than this, half of their widths, radians.
const NARROW: f64 = 1e-7;

/// Derivatives that the value on an arc is bounded from.
const ORDER: usize = 5;

/// Derivatives that the polynomial on a stretch is bounded from.
const CHANGES: usize = 5;

/// `sum f[i][j] b_i(q) b_j(u)` with `b = 1, cos, sin, cos 2, sin 2, ...`.
#[derive(Debug, Clone)]
pub(super) struct TwoAngles {
    rows: Vec<Vec<Double>>,
    noise: f64,
}

/// The polynomial of `q` on a stretch of `u`: its value in the middle, then what each derivative can add to it at most, as a part of
/// that derivative's own polynomial.
struct Stretch {
    terms: [Vec<f64>; CHANGES],
    /// Bounds of what is left, for the function and its slope.
    rest: [f64; 2],
}

impl TwoAngles {
    /// From samples at equal steps, those of `q` in rows, those of `u` in columns, odd numbers of both, and the highest waves of both: what
    /// the samples show beyond them is rounding. `None` where all is.
    pub(super) fn new(samples: &[Vec<Double>], degrees: [usize; 2]) -> Option<Self> {
        let largest = samples.iter().flatten().fold(0.0, |a: f64, x| a.max(x.near().abs()));
        if !(largest > 1e-200 && largest < f64::INFINITY) {
            return None;
        }
        let scale = Double::ONE / Double::from(largest);
        let by_u: Vec<Vec<Double>> = samples.iter().map(|row| waves(row)).collect();
        let columns: Vec<Vec<Double>> = (0..by_u[0].len())
            .map(|j| waves(&by_u.iter().map(|row| row[j] * scale).collect::<Vec<_>>()))
            .collect();
        let [kept_rows, kept_columns] = degrees.map(|degree| 2 * degree + 1);
        let mut beyond = 0.0f64;
        for (j, column) in columns.iter().enumerate() {
            let from = if j < kept_columns { kept_rows } else { 0 };
            beyond = column[from..].iter().fold(beyond, |a, x| a.max(x.near().abs()));
        }
        let noise = ROUNDING + SAFETY * beyond;
        let kept = &columns[..kept_columns];
        let rows = (0..kept_rows).map(|i| kept.iter().map(|column| column[i]).collect()).collect();
        (noise < HOPELESS).then_some(Self { rows, noise })
    }

    fn stretch(&self, low: f64, high: f64) -> Stretch {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let count = self.rows[0].len();
        // Cosines and sines of the waves, each derivative the other one times its frequency and half of the width, by its order.
        let mut bases = vec![vec![Double::ZERO; count]; CHANGES];
        let mut left = vec![0.0; count];
        let step = turn_along(libm::cos(middle), libm::sin(middle));
        let mut turn = [Double::ONE, Double::ZERO];
        bases[0][0] = Double::ONE;
        for (k, j) in (1..).zip((1..count).step_by(2)) {
            turn = both(turn, step);
            let mut pair = turn;
            let mut size = 1.0;
            for (order, basis) in bases.iter_mut().enumerate() {
                [basis[j], basis[j + 1]] = pair;
                let factor = Double::from(f64::from(k) * half / (order + 1) as f64);
                pair = [-pair[1] * factor, pair[0] * factor];
                size *= f64::from(k) * half / (order + 1) as f64;
            }
            (left[j], left[j + 1]) = (size, size);
        }
        let mut rest = [self.noise; 2];
        for (i, row) in self.rows.iter().enumerate() {
            let bend: f64 = row.iter().zip(&left).map(|(f, b)| f.near().abs() * b).sum();
            rest[0] += bend;
            rest[1] += bend * i.div_ceil(2) as f64;
        }
        rest[1] += self.noise * self.rows.len() as f64;
        let along = |basis: &[Double]| -> Vec<f64> {
            let sum = |row: &Vec<Double>| row.iter().zip(basis).map(|(f, b)| *f * *b).sum::<Double>();
            self.rows.iter().map(|row| sum(row).near()).collect()
        };
        Stretch { terms: std::array::from_fn(|order| along(&bases[order])), rest }
    }

    /// Whether the roots in `q` are as many, and each of them single, for all `u` from `low` to `high`; `false` also means not known.
    pub(super) fn is_steady(&self, low: f64, high: f64) -> bool {
        let Stretch { terms, mut rest } = self.stretch(low, high);
        let size = |row: &[f64], power: i32| -> f64 {
            row.iter().enumerate().map(|(i, x)| x.abs() * (i.div_ceil(2) as f64).powi(power)).sum()
        };
        rest[0] += NOISE * size(&terms[0], 0);
        rest[1] += NOISE * size(&terms[0], 1);
        let bound: f64 = terms.iter().map(|row| size(row, ORDER as i32)).sum();
        let mut open: Vec<Strip> = (0..ARCS)
            .map(|k| Strip {
                centre: -PI + TAU * (k as f64 + 0.5) / ARCS as f64,
                radius: PI / ARCS as f64,
                lean: 0.0,
            })
            .collect();
        while let Some(mut strip) = open.pop() {
            let slopes = Slopes::at(&terms, strip.centre);
            strip.follow(&slopes);
            let Strip { centre, radius, lean } = strip;
            let leaning = slopes.along(lean);
            // What the function, or its slope, is in the middle less what it can become: free of roots when positive.
            let left = |slope: usize, radius: f64| {
                let (mut lost, mut power) = (0.0, 1.0);
                for (j, row) in leaning.0.iter().enumerate().skip(slope) {
                    let times = if slope == 1 { j as f64 } else { 1.0 };
                    lost += times * power * row.iter().map(|x| x.abs()).sum::<f64>();
                    power *= radius;
                }
                let tail = (1..=ORDER - slope).fold(bound, |x, k| x * (radius + lean.abs()) / k as f64);
                // The middle itself was counted as lost.
                2.0 * leaning.0[slope][0].abs() - lost - tail - rest[slope]
            };
            if left(0, radius) > 0.0 || left(1, radius) > 0.0 {
                continue;
            }
            // No narrower strip would tell.
            if radius < NARROW || left(0, 0.0) <= 0.0 && left(1, 0.0) <= 0.0 {
                return false;
            }
            for side in [-0.5, 0.5] {
                open.push(Strip { centre: centre + side * radius, radius: 0.5 * radius, lean });
            }
        }
        true
    }
}

/// Angles `q` within `radius` of `centre + lean w`, where `w` runs from -1 to 1 as `u` does over its stretch.
#[derive(Clone, Copy)]
struct Strip {
    centre: f64,
    radius: f64,
    lean: f64,
}

impl Strip {
    /// Leans as the roots in it do, if it does not become much wider by that: it holds all that it held.
    fn follow(&mut self, slopes: &Slopes) {
        let a = &slopes.0;
        let single = a[1][0].abs() > self.radius * a[2][0].abs();
        let lean = if single { -a[0][1] / a[1][0] } else { -0.5 * a[1][1] / a[2][0] };
        let more = (lean - self.lean).abs();
        if more < 0.25 * self.radius {
            self.lean = lean;
            self.radius += more;
        }
    }
}

/// Coefficients of `d^j w^p` around a place, `d` being what `q` differs from it.
struct Slopes([[f64; ORDER + CHANGES]; ORDER]);

impl Slopes {
    fn at(terms: &[Vec<f64>; CHANGES], centre: f64) -> Self {
        let mut found = [[0.0; ORDER + CHANGES]; ORDER];
        for (p, row) in terms.iter().enumerate() {
            let mut factor = 1.0;
            for (j, x) in derivatives(row, centre).into_iter().enumerate() {
                factor /= j.max(1) as f64;
                found[j][p] = x * factor;
            }
        }
        Self(found)
    }

    /// The same where the place moves by `lean w`.
    fn along(&self, lean: f64) -> Self {
        let mut found = [[0.0; ORDER + CHANGES]; ORDER];
        for k in 0..ORDER {
            // (d + lean w)^k
            let mut part = 1.0;
            for j in (0..=k).rev() {
                for p in 0..CHANGES {
                    found[j][k - j + p] += part * self.0[k][p];
                }
                part *= lean * j as f64 / (k - j + 1) as f64;
            }
        }
        Self(found)
    }
}

/// Coefficients of `1, cos, sin, cos 2, ...` from an odd number of samples at equal steps from zero.
fn waves(samples: &[Double]) -> Vec<Double> {
    let n = samples.len();
    let turns = division(n);
    (0..n)
        .map(|i| {
            let k = i.div_ceil(2);
            let part = usize::from(i % 2 == 0 && i > 0);
            let sum: Double = samples.iter().enumerate().map(|(at, x)| *x * turns[at * k % n][part]).sum();
            sum * Double::from(if i == 0 { 1.0 } else { 2.0 }) / Double::from(n as f64)
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
            let doubles: Vec<Vec<Double>> =
                samples.iter().map(|row| row.iter().map(|x| Double::from(*x)).collect()).collect();
            let polynomial = TwoAngles::new(&doubles, [4, 2]).unwrap();
            let here = derivatives(&polynomial.stretch(0.7, 0.7).terms[0], 1.2);
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
