//! Raghavan and Roth's elimination for a loop of six turns: from fourteen equations to one determinant.

use super::math::{cos_sin, sqrt};
use super::vector::{Line, Motion, Vector, back, cross, dot, minus, times};
use super::waves::MAX_SAMPLES;

/// Six equations, each with a coefficient for each product of one of `1, c, s` of the sampled angle `q3`, one of `t^2, t, 1` of the
/// half tangent `t` of a second one, and one of `1, c, s` of the third.
pub type Six = [[f64; 27]; 6];

/// Cosine and sine at which equations are sampled, one turn for each of `1, c, s`.
const PLACES: [[f64; 2]; 3] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];

/// The angle that is eliminated by its half tangent is counted from here: far from the multiples of 90 degrees, where
/// an arm may be on purpose, so that none of those is at infinity.
const START: [f64; 2] = [0.8, 0.6];

/// The sum of two turns given by cosine and sine.
fn sum(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[1] * b[0] + a[0] * b[1]]
}

/// The turn that belongs to a half tangent, given as a vector along half of the turn.
pub fn turn_of_half(half: [f64; 2]) -> [f64; 2] {
    sum(sum(half, half), START)
}

/// From values at [`PLACES`] to the coefficients of `1, c, s`, for the index of this stride.
fn fit(values: &mut [f64], stride: usize) {
    for outer in (0..values.len()).step_by(3 * stride) {
        for base in outer..outer + stride {
            let [a, b, c] = [values[base], values[base + stride], values[base + 2 * stride]];
            let still = 0.5 * (a + c);
            values[base] = still;
            values[base + stride] = a - still;
            values[base + 2 * stride] = b - still;
        }
    }
}

/// The fourteen functions of a line on which the elimination rests, with `p` a point on it and `l` its direction.
fn functions(line: &Line) -> [f64; 14] {
    let (p, l) = (line.point, line.direction);
    let (pp, pl, m) = (dot(p, p), dot(p, l), cross(p, l));
    let w = minus(times(l, pp), times(p, 2.0 * pl));
    [p[0], p[1], p[2], l[0], l[1], l[2], pp, pl, m[0], m[1], m[2], w[0], w[1], w[2]]
}

/// Coefficients of the products of `1, c, s` of `q3`, `q4` and `q5`, less what is constant on the right side.
pub type Left = [[f64; 27]; 14];

/// Coefficients of the products of `1, c, s` of `q1` and `q2`.
pub type Right = [[f64; 9]; 14];

/// The equations without `q1` and `q2`, for the loop `e1 ... e6 = goal`. The half tangent is that of `q4`, or of `q5` if `swapped`.
pub fn eliminate(lines: &[Line; 6], goal: &Motion, swapped: bool) -> Six {
    let (left, right) = sides(lines, goal, swapped);
    without_right(left, right)
}

/// Both sides of the fourteen equations.
pub fn sides(lines: &[Line; 6], goal: &Motion, swapped: bool) -> (Left, Right) {
    let measure = Measure::of(lines, lines[2].point);
    let scaled = |line: Line| measure.scaled(line);
    let (places4, places5) = places(swapped);
    let mut left = [[0.0; 27]; 14];
    for k in 0..3 {
        let after5 = lines[4].moved(&lines[5], places5[k]);
        for j in 0..3 {
            let after4 = lines[3].moved(&after5, places4[j]);
            for i in 0..3 {
                let values = functions(&scaled(lines[2].moved(&after4, PLACES[i])));
                let column = if swapped { 9 * i + 3 * k + j } else { 9 * i + 3 * j + k };
                for (row, value) in left.iter_mut().zip(values) {
                    row[column] = value;
                }
            }
        }
    }
    let right = right_side(lines, goal, &measure);
    for (left, right) in left.iter_mut().zip(&right) {
        fit(left, 1);
        fit(left, 3);
        fit(left, 9);
        left[0] -= right[0];
    }
    (left, right)
}

/// Where points are measured from, and in what unit: the functions of lines are to be of one size.
pub struct Measure {
    origin: Vector,
    scale: f64,
}

impl Measure {
    /// That of lines, seen from a point.
    pub fn of(lines: &[Line], origin: Vector) -> Measure {
        let mut size = 0.0f64;
        for line in lines {
            let d = minus(line.point, origin);
            size = size.max(dot(d, d));
        }
        Measure { origin, scale: 1.0 / sqrt(size) }
    }

    fn scaled(&self, line: Line) -> Line {
        Line { point: times(minus(line.point, self.origin), self.scale), ..line }
    }
}

/// Turns of `q4` and of `q5` at which the left side is sampled.
fn places(swapped: bool) -> ([[f64; 2]; 3], [[f64; 2]; 3]) {
    let shifted = PLACES.map(|place| sum(place, START));
    if swapped { (PLACES, shifted) } else { (shifted, PLACES) }
}

fn right_side(lines: &[Line; 6], goal: &Motion, measure: &Measure) -> Right {
    let mut right = [[0.0; 9]; 14];
    let last = goal.moved(&lines[5]);
    for i in 0..3 {
        let before1 = lines[0].moved(&last, back(PLACES[i]));
        for j in 0..3 {
            let values = functions(&measure.scaled(lines[1].moved(&before1, back(PLACES[j]))));
            for (row, value) in right.iter_mut().zip(values) {
                row[3 * i + j] = value;
            }
        }
    }
    for right in &mut right {
        fit(right, 1);
        fit(right, 3);
    }
    right
}

/// The right side of a loop, by what it leaves of the left one.
pub struct Shadow {
    /// Six combinations of the fourteen equations that hold whatever `q1` and `q2` are.
    rows: [[f64; 14]; 6],
    /// What is constant on the right side.
    constant: [f64; 14],
    /// Square of the volume that its columns span: with it as a factor the determinant is a smooth function of the loop.
    pub volume: f64,
}

/// The right side of a loop, measured so.
pub fn shadow(lines: &[Line; 6], goal: &Motion, measure: &Measure) -> Shadow {
    let mut right = right_side(lines, goal, measure);
    let mut constant = [0.0; 14];
    let mut all = [[0.0; 14]; 14];
    for i in 0..14 {
        constant[i] = right[i][0];
        all[i][i] = 1.0;
    }
    let volume = reflect(&mut all, &mut right);
    let mut rows = [[0.0; 14]; 6];
    rows.copy_from_slice(&all[8..]);
    Shadow { rows, constant, volume }
}

/// As [`eliminate`], of a loop whose third joint does not turn: the six equations hold for `q3` at zero.
pub fn eliminate_still(lines: &[Line; 6], swapped: bool, measure: &Measure, shadow: &Shadow) -> Six {
    let (places4, places5) = places(swapped);
    let mut left = [[0.0; 9]; 14];
    for k in 0..3 {
        let after5 = lines[4].moved(&lines[5], places5[k]);
        for j in 0..3 {
            let values = functions(&measure.scaled(lines[3].moved(&after5, places4[j])));
            let column = if swapped { 3 * k + j } else { 3 * j + k };
            for (row, value) in left.iter_mut().zip(values) {
                row[column] = value;
            }
        }
    }
    for (left, constant) in left.iter_mut().zip(shadow.constant) {
        fit(left, 1);
        fit(left, 3);
        left[0] -= constant;
    }
    let mut six = [[0.0; 27]; 6];
    for (six, row) in six.iter_mut().zip(&shadow.rows) {
        for (left, part) in left.iter().zip(row) {
            for (x, from) in six.iter_mut().zip(left) {
                *x += part * from;
            }
        }
        by_half_tangent(&mut six[..9]);
    }
    six
}

/// What of the left side holds whatever `q1` and `q2` are.
pub fn without_right(mut left: Left, mut right: Right) -> Six {
    reflect(&mut left, &mut right);
    let mut six = [[0.0; 27]; 6];
    six.copy_from_slice(&left[8..]);
    for row in &mut six {
        for part in row.chunks_exact_mut(9) {
            by_half_tangent(part);
        }
    }
    six
}

/// From the coefficients of `1, c, s` to those of `t^2, t, 1`, three of each.
fn by_half_tangent(row: &mut [f64]) {
    for k in 0..3 {
        // (1 + t^2) (one + cos c + sin s)
        let [one, cos, sin] = [row[k], row[3 + k], row[6 + k]];
        (row[k], row[3 + k], row[6 + k]) = (one - cos, 2.0 * sin, one + cos);
    }
}

/// Takes all columns of `right` but the first to its first eight rows, by reflections of both sides; returns the square of the volume
/// that they span.
fn reflect<const C: usize>(left: &mut [[f64; C]; 14], right: &mut Right) -> f64 {
    let mut volume = 1.0;
    let mut done = [false; 9];
    done[0] = true;
    for step in 0..8 {
        let mut squares = [0.0; 9];
        for row in &right[step..] {
            for (square, x) in squares.iter_mut().zip(row) {
                *square += x * x;
            }
        }
        let (mut pivot, mut most) = (0, -1.0);
        for c in 1..9 {
            if !done[c] && squares[c] > most {
                (pivot, most) = (c, squares[c]);
            }
        }
        done[pivot] = true;
        if most < 1e-24 {
            break;
        }
        volume *= most;
        let mut mirror = [0.0; 14];
        for r in step..14 {
            mirror[r] = right[r][pivot];
        }
        let head = mirror[step];
        mirror[step] += if head < 0.0 { -sqrt(most) } else { sqrt(most) };
        let factor = 1.0 / (most + head.abs() * sqrt(most));
        let mut sums = ([0.0; C], [0.0; 9]);
        for r in step..14 {
            for (sum, x) in sums.0.iter_mut().zip(&left[r]) {
                *sum += mirror[r] * x;
            }
            for (sum, x) in sums.1.iter_mut().zip(&right[r]) {
                *sum += mirror[r] * x;
            }
        }
        for r in step..14 {
            let by = factor * mirror[r];
            for (x, sum) in left[r].iter_mut().zip(&sums.0) {
                *x -= by * sum;
            }
            for (x, sum) in right[r].iter_mut().zip(&sums.1) {
                *x -= by * sum;
            }
        }
    }
    volume
}

/// The six equations at one value of `q3`: three forms in `1, c, s` of the third angle, with `t^2`, `t` and 1.
pub fn at(six: &Six, [cos, sin]: [f64; 2]) -> [[f64; 9]; 6] {
    let mut rows = [[0.0; 9]; 6];
    for (row, six) in rows.iter_mut().zip(six) {
        for (n, x) in row.iter_mut().enumerate() {
            *x = six[n] + cos * six[9 + n] + sin * six[18 + n];
        }
    }
    rows
}

/// The square system at one value of `q3`, reduced to the unknowns `(t y, y)` with `y` for `1, c, s` of the third angle: its
/// determinant is `factor` times that of `rows`.
///
/// The six equations and their multiples by `t` are twelve in `(t^3 y, t^2 y, t y, y)`. In blocks of three columns they
/// are, after the first three columns of the six have been cleared below `U`,
///
/// ```text
/// U T T 0
/// 0 L L 0
/// 0 U T T      the three rows L L 0 and U T T clear the second block of columns,
/// 0 0 L L      and leave three that join the last
/// ```
pub struct Reduced {
    /// The system in `(t y, y)`.
    pub rows: [[f64; 6]; 6],
    /// Product of the pivots so far.
    pub factor: f64,
    /// Magnitude of the smallest of them.
    pub least: f64,
}

/// Reduces the system.
pub fn reduced(six: &Six, turn: [f64; 2]) -> Reduced {
    let mut rows = at(six, turn);
    // The same steps act on the equations and on their multiples, so that the sign of exchanges cancels.
    let (first, _, least) = clear(&mut rows, 3);
    let mut next = [[0.0; 9]; 6];
    for r in 0..3 {
        next[r][..6].copy_from_slice(&rows[3 + r][3..]);
        next[3 + r] = rows[r];
    }
    let (second, sign, next_least) = clear(&mut next, 3);
    let mut left = [[0.0; 6]; 6];
    for r in 0..3 {
        left[r].copy_from_slice(&next[3 + r][3..]);
        left[3 + r].copy_from_slice(&rows[3 + r][3..]);
    }
    Reduced { rows: left, factor: sign * first * second, least: least.min(next_least) }
}

/// The determinant whose roots are the values of `q3`, and the magnitude of its smallest pivot.
pub fn determinant(six: &Six, turn: [f64; 2]) -> (f64, f64) {
    let Reduced { mut rows, factor, least } = reduced(six, turn);
    let (pivots, sign, last) = clear(&mut rows, 6);
    (sign * factor * pivots, least.min(last))
}

/// Clears the first columns below the diagonal, with row exchanges; returns the product of the pivots, the sign of the
/// exchanges, and the magnitude of the smallest pivot.
fn clear<const C: usize>(rows: &mut [[f64; C]; 6], columns: usize) -> (f64, f64, f64) {
    let (mut product, mut sign, mut least) = (1.0, 1.0, f64::INFINITY);
    for k in 0..columns {
        let mut pivot = k;
        for r in k + 1..6 {
            if rows[r][k].abs() > rows[pivot][k].abs() {
                pivot = r;
            }
        }
        if pivot != k {
            rows.swap(pivot, k);
            sign = -sign;
        }
        let (top, below) = rows.split_at_mut(k + 1);
        let top = &top[k];
        product *= top[k];
        least = least.min(top[k].abs());
        if top[k] == 0.0 {
            continue;
        }
        let inverse = 1.0 / top[k];
        for row in below {
            let factor = row[k] * inverse;
            row[k] = 0.0;
            for c in k + 1..C {
                row[c] -= factor * top[c];
            }
        }
    }
    (product, sign, least)
}

/// How the sampled angle is looked at: `tan((q3 - centre) / 2) = width tan(u / 2)`.
///
/// A determinant is a trigonometric polynomial of `u` as well, when it is multiplied by a power of what the half angle is stretched
/// by. Where it is all but zero over a part of the circle, a small width shows what is there.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// Cosine and sine of the angle at `u = 0`.
    pub centre: [f64; 2],
    /// Angle for each unit of `u` there.
    pub width: f64,
}

impl View {
    /// The angle as it is.
    pub const WHOLE: View = View { centre: [1.0, 0.0], width: 1.0 };

    /// The angle at `u`, as cosine and sine, and the square of the stretch.
    pub fn turn(&self, u: f64) -> ([f64; 2], f64) {
        let [c, s] = cos_sin(0.5 * u);
        let s = self.width * s;
        let square = c * c + s * s;
        (sum(self.centre, [(c * c - s * s) / square, 2.0 * c * s / square]), square)
    }

    /// The determinant at `u`, as a trigonometric polynomial of this degree, and the magnitude of its smallest pivot.
    pub fn value(&self, six: &Six, degree: usize, u: f64) -> (f64, f64) {
        let (turn, square) = self.turn(u);
        let (mut value, least) = determinant(six, turn);
        for _ in 0..degree {
            value *= square;
        }
        (value, least)
    }

    /// Samples of that at equal steps of `u`, as many as its degree asks for, and the largest of the smallest pivots.
    pub fn samples(&self, six: &Six, degree: usize) -> ([f64; MAX_SAMPLES], f64) {
        let mut samples = [0.0; MAX_SAMPLES];
        let n = 2 * degree + 1;
        let mut clear = 0.0f64;
        for (i, x) in samples.iter_mut().enumerate().take(n) {
            let (value, least) = self.value(six, degree, core::f64::consts::TAU * i as f64 / n as f64);
            *x = value;
            clear = clear.max(least);
        }
        (samples, clear)
    }

    /// Whether a turn of `u` is far from the centre of a narrow view: what is there shows better in the view before.
    pub fn is_beside(&self, turn: [f64; 2]) -> bool {
        self.width < 1.0 && turn[0] < 0.0
    }

    /// The view of this width round `u`.
    pub fn zoomed(&self, u: f64, width: f64) -> View {
        let (centre, square) = self.turn(u);
        View { centre, width: width * self.width / square }
    }
}
