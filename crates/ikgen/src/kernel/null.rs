//! From a root of the eliminated equation to the two angles beside it: null vectors of the reduced system.

use super::eigen::{MAX_SIZE, Square, hessenberg_eigenvalues};
use super::elimination::{Six, View, at, reduced, turn_of_half};
use super::math::sqrt;
use super::roots::circle;
use super::vector::{Vector, cross, dot, minus, times, unit};
use super::waves::Waves;

/// A pivot that is smaller than this part of the first one counts as zero.
pub const NOTHING: f64 = 1e-6;

/// A pivot that is larger than this part is clear of zero.
pub const NEARLY_NOTHING: f64 = 1e-3;

/// Below the square of this angle, about, two third angles are one.
const SHARED: f64 = 1e-8;

/// The turn whose half tangent was eliminated, and the one beside it.
pub type Pair = [[f64; 2]; 2];

/// A root of the determinant near that of its waves, which are exact to rounding of the largest sample.
///
/// Newton's method with the determinant itself and the slope of the waves, taken only where rounding matters.
pub fn refined(six: &Six, waves: &Waves, view: &View, start: f64) -> f64 {
    let mut q = start;
    for _ in 0..8 {
        let [_, slope] = waves.at(q);
        let doubt = 1e-15 * waves.largest / slope.abs();
        if q == start && doubt < 1e-13 {
            break;
        }
        let change = -view.value(six, waves.degree, q).0 / slope;
        if !(change.abs() < 0.05) {
            break;
        }
        q += change;
        // What is left is about this part of the change.
        if change.abs() * (doubt + change.abs()) < 1e-13 {
            break;
        }
    }
    q
}

/// The null space of the reduced system: vectors `(t y, y)`, and how many there are, three at most; pivots below the part `nothing` of the
/// first one count as zero.
fn null_space(six: &Six, turn: [f64; 2], most: usize, nothing: f64) -> ([[f64; 6]; 3], usize) {
    let mut m = reduced(six, turn).rows;
    let mut columns = [0, 1, 2, 3, 4, 5];
    let (mut rank, mut largest) = (0, 0.0f64);
    while rank < 6 {
        let (mut row, mut column) = (rank, rank);
        for r in rank..6 {
            for c in rank..6 {
                if m[r][c].abs() > m[row][column].abs() {
                    (row, column) = (r, c);
                }
            }
        }
        let pivot = m[row][column].abs();
        largest = largest.max(pivot);
        // The system is singular, whatever rounding says.
        if rank == 5 || (rank + most >= 6 && pivot <= nothing * largest) || pivot == 0.0 {
            break;
        }
        m.swap(rank, row);
        columns.swap(rank, column);
        for r in &mut m {
            r.swap(rank, column);
        }
        for r in rank + 1..6 {
            let factor = m[r][rank] / m[rank][rank];
            for c in rank + 1..6 {
                m[r][c] -= factor * m[rank][c];
            }
        }
        rank += 1;
    }
    let count = if 6 - rank < 3 { 6 - rank } else { 3 };
    let mut vectors = [[0.0; 6]; 3];
    for (i, vector) in vectors.iter_mut().enumerate().take(count) {
        let mut x = [0.0; 6];
        x[rank + i] = 1.0;
        for r in (0..rank).rev() {
            let mut sum = 0.0;
            for c in r + 1..6 {
                sum += m[r][c] * x[c];
            }
            x[r] = -sum / m[r][r];
        }
        for (value, column) in x.into_iter().zip(columns) {
            vector[column] = value;
        }
    }
    (vectors, count)
}

fn halves(v: &[f64; 6]) -> (Vector, Vector) {
    ([v[0], v[1], v[2]], [v[3], v[4], v[5]])
}

/// The turn of which this is a multiple of `1, c, s`.
fn turn_of(y: Vector) -> Option<[f64; 2]> {
    let sign = if y[0] < 0.0 { -1.0 } else { 1.0 };
    unit(sign * y[1], sign * y[2], 0.0)
}

/// The pair at a simple root.
pub fn single(six: &Six, turn: [f64; 2]) -> Option<Pair> {
    let (vectors, _) = null_space(six, turn, 1, NOTHING);
    let (high, low) = halves(&vectors[0]);
    let (h, l, hl) = (dot(high, high), dot(low, low), dot(high, low));
    let (half, y) = if h > l { (unit(hl, h, 0.0)?, high) } else { (unit(l, hl, 0.0)?, low) };
    Some([turn_of_half(half), turn_of(y)?])
}

/// Whether only one null vector is anywhere near: of two solutions that share the angle there are two.
pub fn is_alone(six: &Six, turn: [f64; 2]) -> bool {
    null_space(six, turn, 3, NEARLY_NOTHING).1 == 1
}

/// The pairs at a root where several solutions share the angle: as many null vectors as there are solutions, mixed. Multiplication
/// by `t` maps their space to itself, and its eigenvalues are the values of `t`.
///
/// Pivots below the part `nothing` of the first one count as zero: [`NOTHING`], or where the root is known to few digits
/// [`NEARLY_NOTHING`]; the pairs may then be none of solutions. Returns the dimension of the null space; a space of one dimension gives
/// no pairs.
pub fn several(six: &Six, turn: [f64; 2], nothing: f64, mut found: impl FnMut(Pair)) -> usize {
    let (vectors, n) = null_space(six, turn, 3, nothing);
    if n < 2 {
        return n;
    }
    let (mut highs, mut lows) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
    for i in 0..n {
        (highs[i], lows[i]) = halves(&vectors[i]);
    }
    let rows = at(six, turn);
    // Those that share the third angle first.
    let mut others = n;
    if let Some((y, rest)) = shared(&mut highs, &mut lows, n) {
        others = rest;
        let mut form = [0.0; 3];
        for row in &rows {
            let next = [0, 3, 6].map(|k| dot([row[k], row[k + 1], row[k + 2]], y));
            if dot(next, next) > dot(form, form) {
                form = next;
            }
        }
        if let Some(other) = turn_of(y) {
            halves_of(form, |half| found([turn_of_half(half), other]));
        }
    }
    let (dimension, n) = (n, others);
    // high = low T, by normal equations, solved by elimination.
    let mut left = [[0.0; 3]; 3];
    let mut right = [[0.0; 3]; 3];
    for i in 0..n {
        for j in 0..n {
            left[i][j] = dot(lows[i], lows[j]);
            right[i][j] = dot(lows[i], highs[j]);
        }
    }
    for k in 0..n {
        for r in 0..n {
            if r != k {
                let factor = left[r][k] / left[k][k];
                for c in 0..n {
                    left[r][c] -= factor * left[k][c];
                    right[r][c] -= factor * right[k][c];
                }
            }
        }
    }
    let mut map: Square = [[0.0; MAX_SIZE]; MAX_SIZE];
    for i in 0..n {
        for j in 0..n {
            map[i][j] = right[i][j] / left[i][i];
        }
    }
    if n == 3 {
        to_hessenberg(&mut map);
    }
    let mut values = [[0.0; 2]; MAX_SIZE];
    let count = hessenberg_eigenvalues(&mut map, n, &mut values);
    for [t, imaginary] in &values[..count] {
        if imaginary.abs() > 1e-3 * (1.0 + t * t) {
            continue;
        }
        let Some(half) = unit(1.0, *t, 0.0) else { continue };
        let [c, s] = half;
        let mut forms = [[0.0; 3]; 6];
        for (form, row) in forms.iter_mut().zip(&rows) {
            for (k, x) in form.iter_mut().enumerate() {
                *x = row[k] * s * s + row[3 + k] * s * c + row[6 + k] * c * c;
            }
        }
        third(&forms, |other| found([turn_of_half(half), other]));
    }
    dimension
}

/// The third angle, as a multiple of `1, c, s`, that two solutions share which differ in `t`: both `(y, 0)` and `(0, y)` are null vectors
/// then, and no map says what `t` is. Also how many of the vectors are of others; they come first, with nothing of `y` left in them.
fn shared(highs: &mut [Vector; 3], lows: &mut [Vector; 3], n: usize) -> Option<(Vector, usize)> {
    for k in 0..n - 1 {
        let mut longest = k;
        for i in k + 1..n {
            if dot(lows[i], lows[i]) > dot(lows[longest], lows[longest]) {
                longest = i;
            }
        }
        lows.swap(k, longest);
        highs.swap(k, longest);
        for i in k + 1..n {
            let part = dot(lows[i], lows[k]) / dot(lows[k], lows[k]);
            lows[i] = minus(lows[i], times(lows[k], part));
            highs[i] = minus(highs[i], times(highs[k], part));
        }
    }
    let (y, low) = (highs[n - 1], lows[n - 1]);
    let square = dot(y, y);
    if !(dot(low, low) < SHARED * square) {
        return None;
    }
    let mut longest = 0;
    let mut most = 0.0;
    for i in 0..n - 1 {
        let before = dot(lows[i], lows[i]);
        lows[i] = minus(lows[i], times(y, dot(lows[i], y) / square));
        highs[i] = minus(highs[i], times(y, dot(highs[i], y) / square));
        let part = dot(lows[i], lows[i]) / before;
        if part > most {
            (longest, most) = (i, part);
        }
    }
    lows.swap(0, longest);
    highs.swap(0, longest);
    Some((y, usize::from(most > SHARED)))
}

/// The halves of turns, as vectors along them, with `a t^2 + b t + c = 0`.
fn halves_of([a, b, c]: Vector, mut found: impl FnMut([f64; 2])) {
    let square = b * b - 4.0 * a * c;
    if !(square > -SHARED * (b * b + 4.0 * (a * c).abs())) {
        return;
    }
    let far = if b < 0.0 { b - sqrt(square) } else { b + sqrt(square) };
    for half in [unit(-2.0 * a, far, 0.0), unit(far, -2.0 * c, 0.0)].into_iter().flatten() {
        found(half);
    }
}

/// A similar matrix of three rows whose lower left corner is zero.
fn to_hessenberg(m: &mut Square) {
    if m[2][0].abs() > m[1][0].abs() {
        m.swap(1, 2);
        for row in m.iter_mut() {
            row.swap(1, 2);
        }
    }
    if m[1][0] != 0.0 {
        let factor = m[2][0] / m[1][0];
        for c in 0..3 {
            m[2][c] -= factor * m[1][c];
        }
        for row in m.iter_mut() {
            row[1] += factor * row[2];
        }
    }
}

/// The turns at which all forms in `1, c, s` vanish: one, or two where the forms are multiples of one.
fn third(forms: &[Vector; 6], mut found: impl FnMut([f64; 2])) {
    let mut first = forms[0];
    for form in forms {
        if dot(*form, *form) > dot(first, first) {
            first = *form;
        }
    }
    let mut y = [0.0; 3];
    for form in forms {
        let across = cross(first, *form);
        if dot(across, across) > dot(y, y) {
            y = across;
        }
    }
    if dot(y, y) > 1e-10 * dot(first, first) * dot(first, first) {
        if let Some(turn) = turn_of(y) {
            found(turn);
        }
    } else {
        let roots = circle(first[1], first[2], -first[0], 1e-9);
        for i in 0..roots.count().min(2) {
            found(roots.get(i));
        }
    }
}
