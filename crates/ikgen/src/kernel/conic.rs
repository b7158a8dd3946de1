//! Where a conic meets the unit circle.

use super::math::sqrt;
use super::roots::{Roots, VANISHING, circle};

/// The angles with `q[0] cos^2 + q[1] cos sin + q[2] sin^2 + q[3] cos + q[4] sin + q[5] = 0`.
///
/// The pencil of the conic and the unit circle holds a pair of real lines through their common points; a cubic gives it,
/// and each line meets the circle in at most two angles. A Newton step on the equation restores lost digits.
pub fn conic(q: [f64; 6], slack: f64) -> Roots<4> {
    let mut size = 0.0f64;
    for x in q {
        size = size.max(x.abs());
    }
    if !(size < f64::INFINITY) {
        return Roots::NONE;
    }
    if size < VANISHING {
        return Roots::ANY_ANGLE;
    }
    let [a, b, c, d, e, f] = q.map(|x| x / size);
    // Symmetric matrix of the conic; the circle is diag(1, 1, -1).
    let (b, d, e) = (0.5 * b, 0.5 * d, 0.5 * e);
    // det(conic + t circle) = -(t^3 + p t^2 + r t + u).
    let p = a + c - f;
    let r = a * c - b * b - f * (a + c) + d * d + e * e;
    let u = -(a * (c * f - e * e) - b * (b * f - e * d) + d * (b * e - c * d));
    let mut best = [0.0f64; 9];
    let mut lowest = f64::INFINITY;
    for t in cubic(p, r, u) {
        let m = [a + t, b, d, b, c + t, e, d, e, f - t];
        // Product of the two eigenvalues that are not zero: negative for a pair of real lines.
        let product = m[0] * m[4] - m[1] * m[1] + m[0] * m[8] - m[2] * m[2] + m[4] * m[8] - m[5] * m[5];
        if product < lowest {
            (lowest, best) = (product, m);
        }
    }
    let mut roots = Roots::NONE;
    for line in split(&best) {
        let n = sqrt(line[0] * line[0] + line[1] * line[1]);
        if n < VANISHING {
            continue;
        }
        let met = circle(line[0] / n, line[1] / n, -line[2] / n, slack.max(1e-7));
        for i in 0..met.count() {
            roots.push(improve([a, 2.0 * b, c, 2.0 * d, 2.0 * e, f], met.get(i)));
        }
    }
    roots
}

/// Real roots of `t^3 + p t^2 + r t + u`, the first repeated where there is only one.
fn cubic(p: f64, r: f64, u: f64) -> [f64; 3] {
    // Newton from outside of all roots on the side of the inflection where a root must be: monotone.
    let inflection = -p / 3.0;
    let value = |t: f64| ((t + p) * t + r) * t + u;
    let spread = sqrt((p * p - 3.0 * r).max(0.0));
    let side = if value(inflection) > 0.0 { -1.0 } else { 1.0 };
    let mut t = inflection + side * (spread * 0.7 + 1e-9);
    while value(t) * side < 0.0 {
        t = inflection + 2.0 * (t - inflection);
    }
    for _ in 0..60 {
        let slope = (3.0 * t + 2.0 * p) * t + r;
        if slope == 0.0 {
            break;
        }
        let next = t - value(t) / slope;
        if !(next < f64::INFINITY && next > -f64::INFINITY) || (next - t).abs() <= 1e-16 * t.abs() {
            break;
        }
        t = next;
    }
    // The other two from the quotient t^2 + (p + t) t + (r + t (p + t)).
    let (b, c) = (p + t, r + t * (p + t));
    let half = -0.5 * b;
    let discriminant = half * half - c;
    if discriminant < 0.0 {
        // A double root whose discriminant was lost to rounding still counts.
        return if discriminant > -1e-12 * (half * half + c.abs()) { [t, half, half] } else { [t, t, t] };
    }
    let far = if half < 0.0 { half - sqrt(discriminant) } else { half + sqrt(discriminant) };
    [t, far, if far == 0.0 { 0.0 } else { c / far }]
}

/// The two lines of a degenerate conic, row by row.
fn split(m: &[f64; 9]) -> [[f64; 3]; 2] {
    let adjugate = [
        m[5] * m[7] - m[4] * m[8],
        m[1] * m[8] - m[2] * m[7],
        m[2] * m[4] - m[1] * m[5],
        0.0,
        m[2] * m[6] - m[0] * m[8],
        m[0] * m[5] - m[2] * m[3],
        0.0,
        0.0,
        m[1] * m[3] - m[0] * m[4],
    ];
    // Minus the adjugate is the square p p^T of the point where the lines meet.
    let square = [
        [adjugate[0], adjugate[1], adjugate[2]],
        [adjugate[1], adjugate[4], adjugate[5]],
        [adjugate[2], adjugate[5], adjugate[8]],
    ];
    let mut i = 0;
    for k in 1..3 {
        if square[k][k] > square[i][i] {
            i = k;
        }
    }
    let root = sqrt(square[i][i]);
    let meeting = if root > 0.0 { square[i].map(|x| x / root) } else { [0.0; 3] };
    let [x, y, z] = meeting;
    let lines = [[m[0], m[1] - z, m[2] + y], [m[3] + z, m[4], m[5] - x], [m[6] - y, m[7] + x, m[8]]];
    let (mut row, mut column) = (0, 0);
    for i in 0..3 {
        for j in 0..3 {
            if lines[i][j].abs() > lines[row][column].abs() {
                (row, column) = (i, j);
            }
        }
    }
    [lines[row], [lines[0][column], lines[1][column], lines[2][column]]]
}

/// Two Newton steps of the conic's equation along the circle, taken only where they help.
fn improve(q: [f64; 6], root: [f64; 2]) -> [f64; 2] {
    let value = |[c, s]: [f64; 2]| (q[0] * c + q[1] * s + q[3]) * c + (q[2] * s + q[4]) * s + q[5];
    let mut at = root;
    let mut error = value(at);
    for _ in 0..2 {
        let [c, s] = at;
        let slope = 2.0 * (q[2] - q[0]) * c * s + q[1] * (c * c - s * s) - q[3] * s + q[4] * c;
        let step = -error / slope;
        if !(step.abs() < 1e-2) {
            break;
        }
        let next = [c - s * step, s + c * step];
        let n = sqrt(next[0] * next[0] + next[1] * next[1]);
        let next = [next[0] / n, next[1] / n];
        let next_error = value(next);
        if next_error.abs() >= error.abs() {
            break;
        }
        (at, error) = (next, next_error);
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    #[test]
    fn conics_through_known_angles_are_met_there() {
        let mut rng = Seed::new(3).rng();
        for case in 0..20_000 {
            // A product of two chords of the circle has its four end points as roots.
            let angles = core::array::from_fn::<f64, 4, _>(|_| rng.range(-3.0, 3.0));
            let chord = |p: f64, q: f64| {
                let (m, h) = (0.5 * (p + q), 0.5 * (p - q));
                [m.cos(), m.sin(), -h.cos()]
            };
            let (l, m) = (chord(angles[0], angles[1]), chord(angles[2], angles[3]));
            // Any multiple of the circle changes nothing.
            let t = rng.range(-1.0, 1.0);
            let q = [
                l[0] * m[0] + t,
                l[0] * m[1] + l[1] * m[0],
                l[1] * m[1] + t,
                l[0] * m[2] + l[2] * m[0],
                l[1] * m[2] + l[2] * m[1],
                l[2] * m[2] - t,
            ];
            let roots = conic(q, 1e-9);
            for angle in angles {
                let gap =
                    angles.iter().filter(|a| **a != angle).map(|a| (a - angle).abs()).fold(9.0, f64::min);
                let near = (0..roots.count())
                    .map(|i| (roots.get(i)[0] - angle.cos()).abs().max((roots.get(i)[1] - angle.sin()).abs()))
                    .fold(9.0, f64::min);
                assert!(near < 1e-10 / gap.min(1.0).powi(2), "case {case}: {angles:?} {roots:?} {near:e}");
            }
        }
    }
}
