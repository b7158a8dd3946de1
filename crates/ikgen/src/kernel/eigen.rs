//! Eigenvalues of small real Hessenberg matrices, and through them the roots of polynomials in the tangent of a half angle.

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
    while size > 0 {
        // The trailing block that no negligible subdiagonal entry cuts.
        let mut start = size - 1;
        while start > 0 {
            let scale = h[start - 1][start - 1].abs() + h[start][start].abs();
            if h[start][start - 1].abs() <= f64::EPSILON * scale {
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
            double_step(h, start, size, sweeps % 10 == 0);
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

/// One implicit step with both eigenvalues of the trailing two by two block as shifts, on rows `start..size`.
fn double_step(h: &mut Square, start: usize, size: usize, exceptional: bool) {
    let (k, l) = (size - 2, size - 1);
    let (trace, determinant) = if exceptional {
        // Breaks the rare cycles.
        let s = h[l][k].abs() + h[k][k - 1].abs();
        (1.5 * s, s * s)
    } else {
        (h[k][k] + h[l][l], h[k][k] * h[l][l] - h[k][l] * h[l][k])
    };
    // The first column of (H - s1)(H - s2).
    let (i, j) = (start, start + 1);
    let mut x = h[i][i] * (h[i][i] - trace) + determinant + h[i][j] * h[j][i];
    let mut y = h[j][i] * (h[i][i] + h[j][j] - trace);
    let mut z = h[j][i] * h[start + 2][j];
    for k in start..size - 1 {
        let rows = if k + 2 < size { 3 } else { 2 };
        if rows == 2 {
            z = 0.0;
        }
        // The reflection that takes (x, y, z) onto the first axis.
        let scale = x.abs() + y.abs() + z.abs();
        if scale > 0.0 {
            (x, y, z) = (x / scale, y / scale, z / scale);
            let norm = sqrt(x * x + y * y + z * z);
            let norm = if x < 0.0 { -norm } else { norm };
            let v = [1.0, y / (x + norm), z / (x + norm)];
            let beta = (x + norm) / norm;
            for c in (if k > start { k - 1 } else { k })..size {
                let sum =
                    beta * (h[k][c] + v[1] * h[k + 1][c] + if rows > 2 { v[2] * h[k + 2][c] } else { 0.0 });
                h[k][c] -= sum;
                h[k + 1][c] -= sum * v[1];
                if rows > 2 {
                    h[k + 2][c] -= sum * v[2];
                }
            }
            let last = if k + 4 < size { k + 4 } else { size };
            for row in h[start..last].iter_mut() {
                let sum =
                    beta * (row[k] + v[1] * row[k + 1] + if rows > 2 { v[2] * row[k + 2] } else { 0.0 });
                row[k] -= sum;
                row[k + 1] -= sum * v[1];
                if rows > 2 {
                    row[k + 2] -= sum * v[2];
                }
            }
            if k > start {
                h[k + 1][k - 1] = 0.0;
                if rows > 2 {
                    h[k + 2][k - 1] = 0.0;
                }
            }
        }
        if k + 2 < size {
            x = h[k + 1][k];
            y = h[k + 2][k];
            z = if k + 3 < size { h[k + 3][k] } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

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
