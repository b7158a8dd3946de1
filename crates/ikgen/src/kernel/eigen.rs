//! Eigenvalues of small real Hessenberg matrices, and through them the roots of polynomials in the tangent of a half angle.

use core::ops::Range;

use super::math::sqrt;

/// Largest matrix.
pub const MAX_SIZE: usize = 16;

/// A square matrix of which the leading `n` rows and columns are used.
pub type Square = [[f64; MAX_SIZE]; MAX_SIZE];

/// Eigenvalues `[real, imaginary]` of the leading `n` by `n` part of an upper Hessenberg matrix, which is destroyed.
///
/// Francis's double-shift QR iteration (Golub and Van Loan, Matrix Computations, section 7.5). Returns how many were found:
/// all `n` but for matrices that are not finite.
pub fn hessenberg_eigenvalues(h: &mut Square, n: usize, found: &mut [[f64; 2]; MAX_SIZE]) -> usize {
    let mut count = 0;
    let mut size = n;
    let mut sweeps = 0;
    let mut norm = 0.0f64;
    for row in &h[..n] {
        for x in &row[..n] {
            norm = norm.max(x.abs());
        }
    }
    // Steps round by this part of the norm, so smaller neighbours on the diagonal say nothing; where eigenvalues come in pairs of
    // opposite sign they vanish.
    let least = 0.01 * norm;
    while size > 0 {
        // The trailing block that no negligible subdiagonal entry cuts. Where two blocks have the same eigenvalues the entry between
        // them stops shrinking at some times the rounding of a step.
        let negligible = f64::EPSILON * (1u64 << (sweeps / 4)) as f64;
        let mut start = size - 1;
        while start > 0 {
            let scale = least.max(h[start - 1][start - 1].abs() + h[start][start].abs());
            if h[start][start - 1].abs() <= negligible * scale {
                h[start][start - 1] = 0.0;
                break;
            }
            start -= 1;
        }
        if start + 1 == size {
            found[count] = [h[start][start], 0.0];
            (count, size, sweeps) = (count + 1, start, 0);
        } else if start + 2 == size {
            let [first, second] = two_by_two(
                h[start][start],
                h[start][start + 1],
                h[start + 1][start],
                h[start + 1][start + 1],
            );
            (found[count], found[count + 1]) = (first, second);
            (count, size, sweeps) = (count + 2, start, 0);
        } else {
            sweeps += 1;
            if sweeps > 60 {
                break;
            }
            double_step(h, start, size, sweeps);
        }
    }
    count
}

/// Eigenvalues of `[[a, b], [c, d]]`.
fn two_by_two(a: f64, b: f64, c: f64, d: f64) -> [[f64; 2]; 2] {
    let half = 0.5 * (a - d);
    let middle = 0.5 * (a + d);
    let square = half * half + b * c;
    if square < 0.0 {
        let imaginary = sqrt(-square);
        return [[middle, imaginary], [middle, -imaginary]];
    }
    let far = if half < 0.0 { half - sqrt(square) } else { half + sqrt(square) };
    let other = if far == 0.0 { d } else { d - b * c / far };
    [[d + far, 0.0], [other, 0.0]]
}

/// One implicit step on rows `start..size`, with the eigenvalues of the trailing two by two block as shifts. Both never part two such
/// blocks that have the same eigenvalues: after some sweeps only the one nearer to the corner is taken, twice, if they are real.
fn double_step(h: &mut Square, start: usize, size: usize, sweep: i32) {
    let (k, l) = (size - 2, size - 1);
    let (mut trace, mut determinant) = (h[k][k] + h[l][l], h[k][k] * h[l][l] - h[k][l] * h[l][k]);
    if sweep % 10 == 0 {
        // Breaks the rare cycles.
        let s = h[l][k].abs() + h[k][k - 1].abs();
        (trace, determinant) = (1.5 * s, s * s);
    } else if sweep > 8 {
        let [[x, imaginary], [y, _]] = two_by_two(h[k][k], h[k][l], h[l][k], h[l][l]);
        if imaginary == 0.0 {
            let shift = if (x - h[l][l]).abs() < (y - h[l][l]).abs() { x } else { y };
            (trace, determinant) = (2.0 * shift, shift * shift);
        }
    }
    // The first column of (H - s1)(H - s2).
    let (i, j) = (start, start + 1);
    let mut x = h[i][i] * (h[i][i] - trace) + determinant + h[i][j] * h[j][i];
    let mut y = h[j][i] * (h[i][i] + h[j][j] - trace);
    let mut z = h[j][i] * h[start + 2][j];
    for k in start..size - 2 {
        let from = if k > start { k - 1 } else { k };
        reflect(h, k, [x, y, z], from..size, start..if k + 4 < size { k + 4 } else { size });
        if k > start {
            (h[k + 1][k - 1], h[k + 2][k - 1]) = (0.0, 0.0);
        }
        (x, y) = (h[k + 1][k], h[k + 2][k]);
        z = if k + 3 < size { h[k + 3][k] } else { 0.0 };
    }
    reflect(h, size - 2, [x, y], size - 3..size, start..size);
    h[size - 1][size - 3] = 0.0;
}

/// Reflects rows and columns from `k` on, as many as the vector has entries, so that it comes to lie along the first of them.
fn reflect<const N: usize>(
    h: &mut Square,
    k: usize,
    vector: [f64; N],
    columns: Range<usize>,
    rows: Range<usize>,
) {
    let norm = sqrt(vector.iter().map(|x| x * x).sum());
    if !(norm > 0.0) {
        return;
    }
    let norm = if vector[0] < 0.0 { -norm } else { norm };
    let (beta, mirror) = ((vector[0] + norm) / norm, vector.map(|x| x / (vector[0] + norm)));
    let Some(top) = h[k..].first_chunk_mut::<N>() else { return };
    for i in columns.start..columns.end.min(MAX_SIZE) {
        let mut sum = top[0][i];
        for r in 1..N {
            sum += mirror[r] * top[r][i];
        }
        top[0][i] -= beta * sum;
        for r in 1..N {
            top[r][i] -= beta * mirror[r] * sum;
        }
    }
    for row in &mut h[rows] {
        let Some(row) = row[k..].first_chunk_mut::<N>() else { return };
        let mut sum = row[0];
        for r in 1..N {
            sum += mirror[r] * row[r];
        }
        row[0] -= beta * sum;
        for r in 1..N {
            row[r] -= beta * mirror[r] * sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    #[test]
    fn eigenvalues_of_opposite_sign_are_found() {
        // t^8 + a t^6 + b t^4 + c t^2 + d with a double root in t^2: the diagonal stays at zero.
        let squares = [0.3, 0.3, -0.7, 2.0];
        let mut powers = [0.0; 9];
        powers[0] = 1.0;
        for (k, root) in squares.into_iter().enumerate() {
            for i in (0..=2 * k).rev().step_by(2) {
                powers[i + 2] += powers[i];
                powers[i] *= -root;
            }
        }
        let mut h = [[0.0; MAX_SIZE]; MAX_SIZE];
        for k in 0..8 {
            h[k][7] = -powers[k];
            if k > 0 {
                h[k][k - 1] = 1.0;
            }
        }
        let mut found = [[0.0; 2]; MAX_SIZE];
        assert_eq!(hessenberg_eigenvalues(&mut h, 8, &mut found), 8);
        for root in squares {
            let near = found[..8]
                .iter()
                .filter(|[x, y]| (x * x - y * y - root).abs() < 1e-6 && (x * y).abs() < 1e-6);
            assert_eq!(near.count(), 2 * squares.iter().filter(|s| **s == root).count());
        }
    }

    #[test]
    fn eigenvalues_have_the_right_symmetric_functions() {
        let mut rng = Seed::new(5).rng();
        for case in 0..2000 {
            let n = 1 + case % MAX_SIZE;
            let mut h = [[0.0; MAX_SIZE]; MAX_SIZE];
            for (i, row) in h.iter_mut().enumerate().take(n) {
                for x in &mut row[i.saturating_sub(1)..n] {
                    *x = rng.range(-1.0, 1.0);
                }
            }
            let (mut trace, mut square) = (0.0, 0.0);
            for i in 0..n {
                trace += h[i][i];
                for j in 0..n {
                    square += h[i][j] * h[j][i];
                }
            }
            let mut found = [[0.0; 2]; MAX_SIZE];
            assert_eq!(hessenberg_eigenvalues(&mut h, n, &mut found), n);
            let sum: f64 = found[..n].iter().map(|z| z[0]).sum();
            let squares: f64 = found[..n].iter().map(|z| z[0] * z[0] - z[1] * z[1]).sum();
            assert!((sum - trace).abs() < 1e-12 && (squares - square).abs() < 1e-11, "{n} {sum} {trace}");
        }
    }
}
