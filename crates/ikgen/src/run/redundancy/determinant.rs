//! The determinant of a loop of seven turns, of which one is given, as a polynomial of two angles.
//!
//! The elimination of [`crate::kernel::elimination`] in numbers of twice as many digits. The given joint is on the left side of the
//! equations, which are linear in its cosine and sine as in those of the others.

use super::double::{Double, Turn, both, division, turn_along};
use super::two_angles::TwoAngles;
use crate::kernel::vector::{Line, Motion};
use crate::kernel::waves::MAX_DEGREE;

/// Highest wave of the determinant in the given joint: twelve rows, each linear.
const GIVEN_DEGREE: usize = 12;

/// Columns of the right side nearer to depending on each other than this do.
const DEPENDENT: f64 = 1e-12;

type Vector = [Double; 3];

#[derive(Clone, Copy)]
struct Axis {
    direction: Vector,
    point: Vector,
}

/// Six equations: a coefficient for each product of one of `1, c, s` of the sampled angle, one of `t^2, t, 1` of the half tangent of a
/// second one, and one of `1, c, s` of the third.
type Six = [[Double; 27]; 6];

/// The equations of a loop where the given joint is turned by none, a quarter and a half: in between they are linear.
pub(super) struct Equations([Six; 3]);

impl Equations {
    /// Of the loop `e1 ... e7 = goal` whose joint at `place` (3 to 5 from zero) is given, whose third one is sampled. Of the other two on
    /// the left side the first is eliminated by its half tangent, the second if `swapped`.
    ///
    /// `None` where the right side does not tell its own two joints from each other: then solutions may meet and the left side not know.
    pub(super) fn new(lines: &[Line; 7], goal: &Motion, place: usize, swapped: bool) -> Option<Self> {
        let origin = lines[2].point;
        let far = lines.iter().flat_map(|line| (0..3).map(move |i| (line.point[i] - origin[i]).abs()));
        let unit = far.fold(f64::MIN_POSITIVE, f64::max);
        let axes = lines.map(|line| Axis::of(&line, origin, unit));
        let right = right(&axes, &last(&lines[6], goal, origin, unit));
        let [none, quarter, half] = quarters().map(|turn| {
            let moved: [Axis; 6] =
                std::array::from_fn(
                    |i| if i < place { axes[i] } else { axes[place].moved(&axes[i + 1], turn) },
                );
            let mut left = left(&moved, swapped);
            left.iter_mut().zip(&right).for_each(|(left, right)| left[0] -= right[0]);
            without_right(left, right)
        });
        Some(Self([none?, quarter?, half?]))
    }

    /// The determinant as a function of the sampled joint and of the given one; of the latter as it is seen from around `centre`, where
    /// half a turn of it is `width` times as wide.
    pub(super) fn seen(&self, centre: f64, width: f64) -> Option<TwoAngles> {
        // One wave more than there are, to see what is rounding.
        let (rows, columns) = (2 * MAX_DEGREE + 3, 2 * GIVEN_DEGREE + 3);
        let centre = turn_along(libm::cos(centre), libm::sin(centre));
        // Far from angles at which axes may line up.
        let start = turn_along(1.0, 0.094);
        let (sampled, halves) = (division(rows), division(2 * columns));
        let mut samples = vec![vec![Double::ZERO; columns]; rows];
        for j in 0..columns {
            let [c, s] = [halves[j][0], halves[j][1] * Double::from(width)];
            let stretch = c * c + s * s;
            let turn = both(centre, [c * c - s * s, (c + c) * s]);
            let equations = self.at(turn, stretch);
            for (row, sampled) in samples.iter_mut().zip(&sampled) {
                row[j] = determinant(&equations, both(start, *sampled));
            }
        }
        TwoAngles::new(&samples, [MAX_DEGREE, GIVEN_DEGREE])
    }

    /// The equations, times `stretch`, where cosine and sine of the given joint are `turn` by `stretch`.
    fn at(&self, [c, s]: Turn, stretch: Double) -> Six {
        let [right, up, left] = &self.0;
        let half = Double::from(0.5);
        std::array::from_fn(|r| {
            std::array::from_fn(|n| {
                let still = half * (right[r][n] + left[r][n]);
                stretch * still + c * (right[r][n] - still) + s * (up[r][n] - still)
            })
        })
    }
}

fn dot(a: Vector, b: Vector) -> Double {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn combined(a: Vector, by: Double, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] + by * b[i])
}

fn normalised(v: Vector) -> Vector {
    let size = dot(v, v).sqrt();
    v.map(|x| x / size)
}

impl Axis {
    /// A line from an origin on, in units of this length; its direction to all digits a unit vector.
    fn of(line: &Line, origin: [f64; 3], unit: f64) -> Self {
        let point = std::array::from_fn(|i| {
            (Double::from(line.point[i]) - Double::from(origin[i])) / Double::from(unit)
        });
        Self { direction: normalised(line.direction.map(Double::from)), point }
    }

    fn turned(&self, v: Vector, [c, s]: Turn) -> Vector {
        let along = dot(self.direction, v) * (Double::ONE - c);
        let across = cross(self.direction, v);
        std::array::from_fn(|i| c * v[i] + along * self.direction[i] + s * across[i])
    }

    fn moved(&self, line: &Self, turn: Turn) -> Self {
        let from = combined(line.point, -Double::ONE, self.point);
        let point = combined(self.turned(from, turn), Double::ONE, self.point);
        Self { direction: self.turned(line.direction, turn), point }
    }
}

/// The last line after the goal, whose rotation is taken to all digits.
fn last(line: &Line, goal: &Motion, origin: [f64; 3], unit: f64) -> Axis {
    let [a, b, _] = goal.rows.map(|row| row.map(Double::from));
    let a = normalised(a);
    let b = normalised(combined(b, -dot(a, b), a));
    let rows = [a, b, cross(a, b)];
    let own = Axis::of(line, [0.0; 3], 1.0);
    let unit = Double::from(unit);
    let point = std::array::from_fn(|i| {
        (dot(rows[i], own.point) + Double::from(goal.place[i]) - Double::from(origin[i])) / unit
    });
    Axis { direction: rows.map(|row| dot(row, own.direction)), point }
}

/// No turn, a quarter and a half.
fn quarters() -> [Turn; 3] {
    [[Double::ONE, Double::ZERO], [Double::ZERO, Double::ONE], [-Double::ONE, Double::ZERO]]
}

/// The fourteen functions of a line.
fn functions(line: &Axis) -> [Double; 14] {
    let (p, l) = (line.point, line.direction);
    let (pp, pl, m) = (dot(p, p), dot(p, l), cross(p, l));
    let w: Vector = std::array::from_fn(|i| l[i] * pp - (pl + pl) * p[i]);
    [p[0], p[1], p[2], l[0], l[1], l[2], pp, pl, m[0], m[1], m[2], w[0], w[1], w[2]]
}

/// Coefficients of the products of `1, c, s` of the three joints on the left side.
fn left(axes: &[Axis; 6], swapped: bool) -> [[Double; 27]; 14] {
    // The angle that is eliminated by its half tangent is counted from where no arm is on purpose.
    let shifted = quarters().map(|turn| both(turn, turn_along(0.8, 0.6)));
    let (fourth, fifth) = if swapped { (quarters(), shifted) } else { (shifted, quarters()) };
    let mut left = [[Double::ZERO; 27]; 14];
    for k in 0..3 {
        let after_fifth = axes[4].moved(&axes[5], fifth[k]);
        for j in 0..3 {
            let after_fourth = axes[3].moved(&after_fifth, fourth[j]);
            for (i, turn) in quarters().into_iter().enumerate() {
                let column = if swapped { 9 * i + 3 * k + j } else { 9 * i + 3 * j + k };
                let values = functions(&axes[2].moved(&after_fourth, turn));
                left.iter_mut().zip(values).for_each(|(row, value)| row[column] = value);
            }
        }
    }
    for row in &mut left {
        [1, 3, 9].into_iter().for_each(|stride| fit(row, stride));
    }
    left
}

/// Coefficients of the products of `1, c, s` of the first two joints.
fn right(axes: &[Axis; 7], last: &Axis) -> [[Double; 9]; 14] {
    let mut right = [[Double::ZERO; 9]; 14];
    for (i, [c, s]) in quarters().into_iter().enumerate() {
        let before_first = axes[0].moved(last, [c, -s]);
        for (j, [c, s]) in quarters().into_iter().enumerate() {
            let values = functions(&axes[1].moved(&before_first, [c, -s]));
            right.iter_mut().zip(values).for_each(|(row, value)| row[3 * i + j] = value);
        }
    }
    for row in &mut right {
        [1, 3].into_iter().for_each(|stride| fit(row, stride));
    }
    right
}

/// From values at quarter turns to the coefficients of `1, c, s`, for the index of this stride.
fn fit(values: &mut [Double], stride: usize) {
    for outer in (0..values.len()).step_by(3 * stride) {
        for base in outer..outer + stride {
            let [a, b, c] = [values[base], values[base + stride], values[base + 2 * stride]];
            let still = Double::from(0.5) * (a + c);
            values[base] = still;
            values[base + stride] = a - still;
            values[base + 2 * stride] = b - still;
        }
    }
}

/// What of the left side holds whatever the first two joints are: reflections take all columns of the right side but the first to eight
/// rows; the other six are left. `None` when the columns are not independent.
fn without_right(mut left: [[Double; 27]; 14], mut right: [[Double; 9]; 14]) -> Option<Six> {
    let mut open: Vec<usize> = (1..9).collect();
    for step in 0..8 {
        let square = |c: usize| right[step..].iter().map(|row| row[c] * row[c]).sum::<Double>();
        let largest = |a: &usize, b: &usize| square(*a).near().total_cmp(&square(*b).near());
        let place = (0..open.len()).max_by(|a, b| largest(&open[*a], &open[*b]))?;
        let pivot = open.remove(place);
        let square = square(pivot);
        if square.near() < DEPENDENT * DEPENDENT {
            return None;
        }
        let mut mirror: Vec<Double> = right.iter().map(|row| row[pivot]).collect();
        let size = if mirror[step].near() < 0.0 { -square.sqrt() } else { square.sqrt() };
        let factor = Double::ONE / (square + mirror[step] * size);
        mirror[step] += size;
        mirrored(&mut left, &mirror, step, factor);
        mirrored(&mut right, &mirror, step, factor);
    }
    Some(std::array::from_fn(|r| {
        let mut row = left[8 + r];
        for i in 0..3 {
            for k in 0..3 {
                // (1 + t^2) (one + cos c + sin s)
                let [one, cos, sin] = [0, 3, 6].map(|j| row[9 * i + j + k]);
                (row[9 * i + k], row[9 * i + 3 + k], row[9 * i + 6 + k]) = (one - cos, sin + sin, one + cos);
            }
        }
        row
    }))
}

/// Reflects the rows from `step` on.
fn mirrored<const N: usize>(rows: &mut [[Double; N]; 14], mirror: &[Double], step: usize, factor: Double) {
    for c in 0..N {
        let sum: Double = (step..14).map(|r| mirror[r] * rows[r][c]).sum();
        for r in step..14 {
            rows[r][c] -= factor * mirror[r] * sum;
        }
    }
}

/// Determinant of the six equations and their multiples by the half tangent, with row exchanges over all of it: slower than the kernel's,
/// and exact where parts of it are singular.
fn determinant(six: &Six, [c, s]: Turn) -> Double {
    let mut m = [[Double::ZERO; 12]; 12];
    for r in 0..6 {
        for n in 0..9 {
            let x = six[r][n] + c * six[r][9 + n] + s * six[r][18 + n];
            m[r][n] = x;
            m[6 + r][3 + n] = x;
        }
    }
    let mut product = Double::ONE;
    for k in 0..12 {
        let size = |r: usize| m[r][k].abs().near();
        let pivot = (k..12).fold(k, |best, r| if size(r) > size(best) { r } else { best });
        if pivot != k {
            m.swap(pivot, k);
            product = -product;
        }
        let top = m[k];
        if top[k] == Double::ZERO {
            return Double::ZERO;
        }
        product = product * top[k];
        for row in &mut m[k + 1..] {
            if row[k] != Double::ZERO {
                let factor = row[k] / top[k];
                for (x, above) in row[k + 1..].iter_mut().zip(&top[k + 1..]) {
                    *x -= factor * *above;
                }
            }
        }
    }
    product
}
