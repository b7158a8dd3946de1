//! The angles at which four waves cancel.

use super::eigen::MAX_SIZE;
use super::math::{cos_sin, sqrt};
use super::roots::{Roots, VANISHING};
use super::waves::{Root, Waves};

/// Most roots.
pub const MOST_ANGLES: usize = 8;

/// Roots that are nearer to each other, or to the real line, may be one that rounding has split.
const NEAR: f64 = 1e-2;

/// They are, where the sum is no larger than this part of its largest wave at its extremum between them.
const ROUNDING: f64 = 2e-14;

/// The angles with `a[0] + a[1] cos q + a[2] sin q + a[3] cos 2q + ... + a[8] sin 4q = 0`.
///
/// They are eigenvalues of a companion matrix, improved by Newton steps. A pair of roots that rounding has split, or has moved off the
/// real line, is where the sum has its extremum between them. With slack so are pairs that are farther off the real line.
pub fn octic(a: [f64; 9], slack: f64) -> Roots<MOST_ANGLES> {
    let mut size = 0.0f64;
    for x in a {
        if !(x.abs() < f64::INFINITY) {
            return Roots::NONE;
        }
        size = size.max(x.abs());
    }
    if size < VANISHING {
        return Roots::ANY_ANGLE;
    }
    let waves = Waves::of_fourth(a.map(|x| x / size));
    let mut found = [Root { angle: 0.0, imaginary: 0.0 }; MAX_SIZE];
    let count = waves.roots(false, &mut found);
    let mut roots = Roots::NONE;
    let mut done = [false; MAX_SIZE];
    for i in 0..count {
        let Root { angle, imaginary } = found[i];
        // Of conjugate roots one is enough.
        if done[i] || imaginary < 0.0 || imaginary > NEAR.max(5.0 * sqrt(slack)) {
            continue;
        }
        if imaginary > 0.0 {
            let (turn, value) = waves.improved(angle, true);
            if value.abs() < ROUNDING || slack > 0.0 {
                roots.push(turn);
            }
            continue;
        }
        let mut one = None;
        for j in i + 1..count {
            let gap = sine_of_half(found[j].angle - angle);
            if !done[j] && found[j].imaginary == 0.0 && gap.abs() < 0.5 * NEAR {
                let (turn, value) = waves.improved(angle + gap, true);
                if value.abs() < ROUNDING {
                    (one, done[j]) = (Some(turn), true);
                    break;
                }
            }
        }
        roots.push(match one {
            Some(turn) => turn,
            None => waves.improved(angle, false).0,
        });
    }
    roots
}

/// Sine of half of a difference between angles, of whichever half is within a quarter turn.
fn sine_of_half(gap: f64) -> f64 {
    let [c, s] = cos_sin(0.5 * gap);
    if c < 0.0 { -s } else { s }
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    /// The waves of a product of eight half angles.
    fn waves_with(angles: &[f64; 8]) -> [f64; 9] {
        let value = |q: f64| angles.iter().map(|a| (0.5 * (q - a)).sin()).product::<f64>();
        let mut a = [0.0; 9];
        for i in 0..9 {
            let q = core::f64::consts::TAU * i as f64 / 9.0;
            a[0] += value(q) / 9.0;
            for k in 1..5 {
                a[2 * k - 1] += 2.0 * value(q) * (k as f64 * q).cos() / 9.0;
                a[2 * k] += 2.0 * value(q) * (k as f64 * q).sin() / 9.0;
            }
        }
        a
    }

    fn nearest(roots: &Roots<MOST_ANGLES>, angle: f64) -> f64 {
        let gap = |[c, s]: [f64; 2]| {
            (s * angle.cos() - c * angle.sin()).abs().max((1.0 - c * angle.cos() - s * angle.sin()).abs())
        };
        (0..roots.count()).map(|i| gap(roots.get(i))).fold(9.0, f64::min)
    }

    #[test]
    fn known_angles_are_found_single_and_double() {
        let mut rng = Seed::new(8).rng();
        for case in 0..2000 {
            let mut angles = core::array::from_fn::<f64, 8, _>(|_| rng.range(-3.0, 3.0));
            let double = case % 2 == 1;
            if double {
                angles[1] = angles[0];
            }
            let slope = |a: f64| -> f64 {
                angles.iter().filter(|b| **b != a).map(|b| (0.5 * (a - b)).sin()).product::<f64>().abs()
            };
            let roots = octic(waves_with(&angles), 0.0);
            for (i, a) in angles.iter().enumerate() {
                let allowed = if double && i < 2 { 1e-12 } else { 1e-13 } / slope(*a);
                assert!(
                    nearest(&roots, *a) < allowed || allowed > 1e-6,
                    "{case} {i} {:e} {allowed:e}",
                    nearest(&roots, *a)
                );
            }
        }
        assert!(octic([0.0; 9], 0.0).free);
        assert_eq!(octic([f64::NAN; 9], 0.0).count(), 0);
        assert_eq!(octic([2.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0).count(), 0);
    }
}
