//! Six revolute joints in general: up to sixteen solutions, by elimination to a univariate equation.
//!
//! The loop is `e1 e2 e3 e4 e5 e6 = G`, each `e` a turn about a line. The image of the last line under `e3 e4 e5` must be what
//! `e2^-1 e1^-1` makes of its image under `G`. Raghavan and Roth (1993) write this as fourteen equations, each linear in
//! the cosine and sine of every angle:
//!
//! 1. Their right sides hold eight monomials of `q1` and `q2`; a reflection for each of them leaves six equations in `q3`, `q4`
//!    and `q5` alone.
//! 2. For a given `q3` those are six forms in `(1, c5, s5)`, quadratic in the tangent of half of `q4`. They and their multiples by
//!    that tangent are a square system of twelve, whose determinant is a trigonometric polynomial of `q3` of degree eight.
//! 3. Seventeen samples give it, the eigenvalues of a companion matrix its roots; Newton's method on the system itself
//!    (Manocha and Canny, 1994, solve it as one large eigenproblem instead) restores the digits that the polynomial lost.
//! 4. The null vector of the system gives `q4` and `q5`, what remains of the loop `q2`, `q1` and `q6`.
//!
//! Any of the six joints can be first in the loop, and the loop can be run backwards: an *order*. In some the determinant
//! vanishes for all angles, because of how the axes of an arm lie; the compiler finds out which are good.

use super::eigen::MAX_SIZE;
use super::math::{cos_sin, sqrt};
use super::vector::{Line, Motion, Vector, back, cross, dot, minus, plus, times, unit};
use super::waves::{self, MAX_SAMPLES};

/// A turn of each joint, as `[cos, sin]`.
pub type Turns = [[f64; 2]; 6];

/// Most candidates of one pose.
pub const MOST: usize = 48;

/// Candidate turns of six joints.
#[derive(Clone, Copy, Debug)]
pub struct Candidates {
    items: [Turns; MOST],
    len: usize,
    /// Never: candidates are not representatives of a continuum.
    pub free: bool,
}

impl Candidates {
    /// None.
    pub const NONE: Candidates = Candidates { items: [[[1.0, 0.0]; 6]; MOST], len: 0, free: false };

    /// How many there are.
    pub fn count(&self) -> usize {
        self.len
    }

    /// One of them.
    pub fn get(&self, i: usize) -> Turns {
        self.items[i]
    }

    fn push(&mut self, turns: Turns) {
        if self.len < MOST {
            self.items[self.len] = turns;
            self.len += 1;
        }
    }
}

/// A way to run round the loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Order {
    /// Number from 0 to 23: which joint is first, in which direction, and which of the two angles beside the sampled one is
    /// eliminated by its half tangent.
    pub code: usize,
    /// Degree of the determinant, eight at most.
    pub degree: usize,
}

/// Roots whose imaginary part is smaller may be real: pairs that fall together lose half of their digits.
const NEARLY_REAL: f64 = 1e-3;

/// Roots that are nearer to each other ask for another order, in which the solutions may be farther apart.
const APART: f64 = 3e-3;

/// Number of orders.
pub const ORDERS: usize = 24;

/// A loop turned and shifted to an order.
struct Arranged {
    lines: [Line; 6],
    goal: Motion,
    /// The joint at each place of the order.
    joints: [usize; 6],
    swapped: bool,
}

fn arrange(lines: &[Line; 6], goal: &Motion, code: usize) -> Arranged {
    let reversed = code >= 12;
    let (shift, swapped) = (code % 12 / 2, code % 2 == 1);
    let goal = if reversed { goal.inverse() } else { *goal };
    let undo = goal.inverse();
    let (mut placed, mut joints) = (*lines, [0; 6]);
    for i in 0..6 {
        let place = (i + shift) % 6;
        joints[i] = if reversed { 5 - place } else { place };
        placed[i] = lines[joints[i]];
        if reversed {
            placed[i].direction = times(placed[i].direction, -1.0);
        }
        if i + shift >= 6 {
            // e1 X = G is X (G^-1 e1 G) = G.
            placed[i] = undo.moved(&placed[i]);
        }
    }
    Arranged { lines: placed, goal, joints, swapped }
}

/// Six equations, each with a coefficient for each product of one of `1, c, s` of the sampled angle, one of `t^2, t, 1` of the
/// one that is eliminated by its half tangent `t`, and one of `1, c, s` of the third.
type Six = [[f64; 27]; 6];

/// The square system of twelve at one value of the sampled angle.
type System = [[f64; 12]; 12];

/// Cosine and sine at which equations are sampled, one turn for each of `1, c, s`.
const PLACES: [[f64; 2]; 3] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];

/// From values at [`PLACES`] to the coefficients of `1, c, s`, for the index of this stride.
fn fit(values: &mut [f64], stride: usize) {
    for base in 0..values.len() {
        if (base / stride).is_multiple_of(3) {
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

/// Step 1: the equations without `q1` and `q2`.
fn eliminate(loop_: &Arranged) -> Six {
    let lines = &loop_.lines;
    let origin = lines[2].point;
    let mut size = 0.0f64;
    for line in lines {
        let d = minus(line.point, origin);
        size = size.max(dot(d, d));
    }
    let scale = 1.0 / sqrt(size);
    let scaled = |line: Line| Line { point: times(minus(line.point, origin), scale), ..line };

    let mut left = [[0.0; 27]; 14];
    for k in 0..3 {
        let after5 = lines[4].moved(&lines[5], PLACES[k]);
        for j in 0..3 {
            let after4 = lines[3].moved(&after5, PLACES[j]);
            for i in 0..3 {
                let values = functions(&scaled(lines[2].moved(&after4, PLACES[i])));
                let column = if loop_.swapped { 9 * i + 3 * k + j } else { 9 * i + 3 * j + k };
                for (row, value) in left.iter_mut().zip(values) {
                    row[column] = value;
                }
            }
        }
    }
    let mut right = [[0.0; 9]; 14];
    let last = loop_.goal.moved(&lines[5]);
    for i in 0..3 {
        let before1 = lines[0].moved(&last, back(PLACES[i]));
        for j in 0..3 {
            let values = functions(&scaled(lines[1].moved(&before1, back(PLACES[j]))));
            for (row, value) in right.iter_mut().zip(values) {
                row[3 * i + j] = value;
            }
        }
    }
    for (left, right) in left.iter_mut().zip(&mut right) {
        fit(right, 1);
        fit(right, 3);
        fit(left, 1);
        fit(left, 3);
        fit(left, 9);
        left[0] -= right[0];
    }
    reflect(&mut left, &mut right);
    let mut six = [[0.0; 27]; 6];
    six.copy_from_slice(&left[8..]);
    for row in &mut six {
        for i in 0..3 {
            for k in 0..3 {
                // (1 + t^2) (one + cos c + sin s)
                let [one, cos, sin] = [0, 3, 6].map(|j| row[9 * i + j + k]);
                (row[9 * i + k], row[9 * i + 3 + k], row[9 * i + 6 + k]) = (one - cos, 2.0 * sin, one + cos);
            }
        }
    }
    six
}

/// Takes all columns of `right` but the first to its first eight rows, by reflections of both sides.
fn reflect(left: &mut [[f64; 27]; 14], right: &mut [[f64; 9]; 14]) {
    let mut done = [false; 9];
    done[0] = true;
    for step in 0..8 {
        let (mut pivot, mut most) = (0, -1.0);
        for c in 1..9 {
            let mut square = 0.0;
            for row in &right[step..] {
                square += row[c] * row[c];
            }
            if !done[c] && square > most {
                (pivot, most) = (c, square);
            }
        }
        done[pivot] = true;
        if most < 1e-24 {
            return;
        }
        let mut mirror = [0.0; 14];
        for r in step..14 {
            mirror[r] = right[r][pivot];
        }
        let head = mirror[step];
        mirror[step] += if head < 0.0 { -sqrt(most) } else { sqrt(most) };
        let factor = 1.0 / (most + head.abs() * sqrt(most));
        let mut sums = ([0.0; 27], [0.0; 9]);
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
}

/// Step 2: the system at `one + cos c + sin s` of the coefficients.
fn system(six: &Six, [one, cos, sin]: [f64; 3]) -> System {
    let mut m = [[0.0; 12]; 12];
    for r in 0..6 {
        for n in 0..9 {
            let x = one * six[r][n] + cos * six[r][9 + n] + sin * six[r][18 + n];
            m[r][n] = x;
            m[6 + r][n + 3] = x;
        }
    }
    m
}

/// A system as a product of triangles.
struct Factored {
    m: System,
    order: [usize; 12],
    determinant: f64,
}

fn factor(mut m: System) -> Factored {
    let mut order = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11];
    let mut determinant = 1.0;
    for k in 0..12 {
        let mut pivot = k;
        for r in k + 1..12 {
            if m[r][k].abs() > m[pivot][k].abs() {
                pivot = r;
            }
        }
        if pivot != k {
            m.swap(pivot, k);
            order.swap(pivot, k);
            determinant = -determinant;
        }
        determinant *= m[k][k];
        if m[k][k].abs() < 1e-150 {
            m[k][k] = 1e-150;
        }
        let (top, below) = m.split_at_mut(k + 1);
        let top = &top[k];
        for row in below {
            let factor = row[k] / top[k];
            row[k] = factor;
            if factor != 0.0 {
                for c in k + 1..12 {
                    row[c] -= factor * top[c];
                }
            }
        }
    }
    Factored { m, order, determinant }
}

impl Factored {
    /// The right null vector, nearly, at length one.
    fn right(&self, start: &[f64; 12]) -> [f64; 12] {
        let mut x = [0.0; 12];
        for i in 0..12 {
            x[i] = start[self.order[i]];
            for j in 0..i {
                x[i] -= self.m[i][j] * x[j];
            }
        }
        for i in (0..12).rev() {
            for j in i + 1..12 {
                x[i] -= self.m[i][j] * x[j];
            }
            x[i] /= self.m[i][i];
        }
        unit12(x)
    }

    /// The left null vector, nearly, at length one.
    fn left(&self, start: &[f64; 12]) -> [f64; 12] {
        let mut y = *start;
        for i in 0..12 {
            for j in 0..i {
                y[i] -= self.m[j][i] * y[j];
            }
            y[i] /= self.m[i][i];
        }
        let mut x = [0.0; 12];
        for i in (0..12).rev() {
            for j in i + 1..12 {
                y[i] -= self.m[j][i] * y[j];
            }
            x[self.order[i]] = y[i];
        }
        unit12(x)
    }
}

fn unit12(x: [f64; 12]) -> [f64; 12] {
    let mut largest = 0.0f64;
    for v in x {
        largest = largest.max(v.abs());
    }
    let mut square = 0.0;
    for v in x {
        square += v / largest * (v / largest);
    }
    let n = largest * sqrt(square);
    x.map(|v| v / n)
}

/// Samples of the determinant, as many as its degree asks for.
fn sample(six: &Six, degree: usize) -> [f64; MAX_SAMPLES] {
    let mut samples = [0.0; MAX_SAMPLES];
    let n = 2 * degree + 1;
    for (i, x) in samples.iter_mut().enumerate().take(n) {
        let [c, s] = cos_sin(core::f64::consts::TAU * i as f64 / n as f64);
        *x = factor(system(six, [1.0, c, s])).determinant;
    }
    samples
}

/// Steps 3 and 4 from a root: the sampled angle, refined, and the two that the null vector holds.
fn refine(six: &Six, angle: f64) -> Option<[[f64; 2]; 3]> {
    let (mut q, mut right, mut left) = (angle, [0.3; 12], [0.3; 12]);
    for step in 0..6 {
        let [c, s] = cos_sin(q);
        let m = system(six, [1.0, c, s]);
        let factored = factor(m);
        for _ in 0..2 - step.min(1) {
            right = factored.right(&right);
            left = factored.left(&left);
        }
        let slope = system(six, [0.0, -s, c]);
        let (mut value, mut rise) = (0.0, 0.0);
        for i in 0..12 {
            value += left[i] * inner(&m[i], &right);
            rise += left[i] * inner(&slope[i], &right);
        }
        let change = -value / rise;
        if !(change.abs() < 0.1) {
            break;
        }
        q += change;
        if change.abs() < 1e-7 {
            break;
        }
    }
    // (t^3, t^2, t, 1) times (1, c, s): the larger end gives both.
    let part = |i: usize| [right[3 * i], right[3 * i + 1], right[3 * i + 2]];
    let (first, last) = (dot(part(0), part(0)), dot(part(3), part(3)));
    let (top, bottom, other) = if first > last {
        (first, dot(part(0), part(1)), part(0))
    } else {
        (dot(part(2), part(3)), last, part(3))
    };
    // The half angle along (bottom, top), doubled.
    let half = unit(bottom, top, 0.0)?;
    let sign = if other[0] < 0.0 { -1.0 } else { 1.0 };
    Some([
        cos_sin(q),
        [half[0] * half[0] - half[1] * half[1], 2.0 * half[0] * half[1]],
        unit(sign * other[1], sign * other[2], 0.0)?,
    ])
}

fn inner(a: &[f64; 12], b: &[f64; 12]) -> f64 {
    let mut sum = 0.0;
    for (x, y) in a.iter().zip(b) {
        sum += x * y;
    }
    sum
}

/// The first two turns and the last, from the middle three.
fn close(loop_: &Arranged, middle: [[f64; 2]; 3]) -> Option<[[f64; 2]; 3]> {
    let lines = &loop_.lines;
    let reached =
        lines[2].moved(&lines[3].moved(&lines[4].moved(&lines[5], middle[2]), middle[1]), middle[0]);
    let goal = loop_.goal.moved(&lines[5]);
    let (h1, h2) = (lines[0].direction, lines[1].direction);
    // e1 e2 takes the line (p, l) to (g, m); what e1 leaves alone is linear in the cosine and sine of q2.
    let (p, l) = (minus(reached.point, lines[1].point), reached.direction);
    let (g, m) = (minus(goal.point, lines[0].point), goal.direction);
    let step = minus(lines[1].point, lines[0].point);
    // u . R2 v = right as coefficients of cosine and sine, and what is left.
    let turned = |u: Vector, v: Vector, right: f64| {
        let along = times(h2, dot(h2, v));
        [dot(u, minus(v, along)), dot(u, cross(h2, v)), right - dot(u, along)]
    };
    let moment = turned(h1, cross(p, l), dot(h1, cross(g, m)));
    let lever = turned(cross(h1, step), l, 0.0);
    let equations = [
        turned(h1, l, dot(h1, m)),
        turned(h1, p, dot(h1, g) - dot(h1, step)),
        turned(step, p, 0.5 * (dot(g, g) - dot(p, p) - dot(step, step))),
        turned(step, l, dot(g, m) - dot(p, l)),
        plus(moment, lever),
    ];
    let [mut cc, mut cs, mut ss, mut cr, mut sr] = [0.0; 5];
    for [c, s, r] in equations {
        cc += c * c;
        cs += c * s;
        ss += s * s;
        cr += c * r;
        sr += s * r;
    }
    let q2 = unit(cr * ss - sr * cs, sr * cc - cr * cs, 0.0)?;
    let moved = [plus(lines[1].turned(p, q2), step), lines[1].turned(l, q2)];
    let q1 = align(h1, moved, [g, m])?;
    // A vector that is not along the last axis shows how far that has turned.
    let h6 = lines[5].direction;
    let side = if h6[0].abs() < 0.8 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let mut seen = loop_.goal.turned(side);
    for (line, turn) in lines.iter().zip([q1, q2, middle[0], middle[1], middle[2]]) {
        seen = line.turned(seen, back(turn));
    }
    Some([q1, q2, align(h6, [side, [0.0; 3]], [seen, [0.0; 3]])?])
}

/// The turn about `axis` that takes vectors to others as well as it can.
fn align(axis: Vector, from: [Vector; 2], to: [Vector; 2]) -> Option<[f64; 2]> {
    let (mut x, mut y) = (0.0, 0.0);
    for (from, to) in from.into_iter().zip(to) {
        let across = minus(from, times(axis, dot(axis, from)));
        x += dot(across, to);
        y += dot(axis, cross(across, to));
    }
    unit(x, y, 0.0)
}

/// Candidates for `e1 ... e6 = goal`: the joints' lines at zero turn. The orders are tried one after the other until in
/// one of them all roots lie apart.
pub fn six(lines: &[Line; 6], goal: &Motion, orders: &[Order], slack: f64) -> Candidates {
    let mut found = Candidates::NONE;
    for order in orders {
        if solve(lines, goal, *order, slack, &mut found) {
            break;
        }
    }
    found
}

/// Adds the candidates of one order; says whether they are all that there are.
fn solve(lines: &[Line; 6], goal: &Motion, order: Order, slack: f64, found: &mut Candidates) -> bool {
    let loop_ = arrange(lines, goal, order.code);
    let six = eliminate(&loop_);
    let samples = sample(&six, order.degree);
    let mut roots = [[0.0; 2]; MAX_SIZE];
    let count = waves::roots(&samples, order.degree, &mut roots);
    let mut all = count == 2 * order.degree;
    let before = found.len;
    for (i, [angle, imaginary]) in roots[..count].iter().enumerate() {
        if imaginary.abs() > NEARLY_REAL + slack {
            continue;
        }
        // Roots that nearly fall together are less exact than Newton's method needs, or are solutions with the same angle.
        for (j, other) in roots[..count].iter().enumerate() {
            let apart = 0.5 * (angle - other[0]);
            all &= i == j || cos_sin(apart)[1].abs() + (imaginary - other[1]).abs() > APART;
        }
        let Some(middle) = refine(&six, *angle) else { continue };
        let middle = if loop_.swapped { [middle[0], middle[2], middle[1]] } else { middle };
        let Some([q1, q2, q6]) = close(&loop_, middle) else { continue };
        let mut turns = [[1.0, 0.0]; 6];
        for (joint, turn) in loop_.joints.into_iter().zip([q1, q2, middle[0], middle[1], middle[2], q6]) {
            turns[joint] = turn;
        }
        found.push(turns);
    }
    all && found.len > before
}

/// Samples of the determinant of an order, from which the compiler learns its degree.
pub fn samples(lines: &[Line; 6], goal: &Motion, code: usize) -> [f64; MAX_SAMPLES] {
    sample(&eliminate(&arrange(lines, goal, code)), waves::MAX_DEGREE)
}

/// Numbers that [`six_of`] takes: six lines as direction and point, the rows of the goal's rotation, its place, and
/// [`MOST_ORDERS`] orders as code and degree (zero for none).
pub const NUMBERS: usize = 48 + 2 * MOST_ORDERS;

/// Most orders of a program.
pub const MOST_ORDERS: usize = 3;

/// As [`six`], from plain numbers.
pub fn six_of(x: &[f64; NUMBERS], slack: f64) -> Candidates {
    let vector = |i: usize| [x[i], x[i + 1], x[i + 2]];
    let mut lines = [Line { direction: [0.0; 3], point: [0.0; 3] }; 6];
    for (i, line) in lines.iter_mut().enumerate() {
        *line = Line { direction: vector(6 * i), point: vector(6 * i + 3) };
    }
    let goal = Motion { rows: [vector(36), vector(39), vector(42)], place: vector(45) };
    let mut orders = [Order { code: 0, degree: 0 }; MOST_ORDERS];
    let mut count = 0;
    for pair in x[48..].chunks(2) {
        let degree = pair[1] as usize;
        if (1..=waves::MAX_DEGREE).contains(&degree) {
            orders[count] = Order { code: pair[0] as usize % ORDERS, degree };
            count += 1;
        }
    }
    for number in x {
        if !(number.abs() < f64::INFINITY) {
            return Candidates::NONE;
        }
    }
    six(&lines, &goal, &orders[..count], slack)
}
