//! All roots of a trigonometric polynomial whose coefficients are intervals.

use std::f64::consts::PI;

use super::interval::{Interval, Undecided};

/// Arcs that the circle is cut into before arcs are halved.
const ARCS: usize = 32;

/// Arcs are halved no further than this, radians.
const NARROW: f64 = 1e-7;

/// `a0 + a1 cos q + b1 sin q + ... + a4 cos 4q + b4 sin 4q`, coefficients in that order.
pub(super) type Polynomial = [Interval; 9];

/// `a cos^2 + b cos sin + c sin^2 + d cos + e sin + f` as a polynomial.
pub(super) fn of_conic([a, b, c, d, e, f]: [Interval; 6]) -> Polynomial {
    let (half, zero) = (Interval::point(0.5), Interval::point(0.0));
    let still = a.plus(c).times(half).plus(f);
    [still, d, e, a.minus(c).times(half), b.times(half), zero, zero, zero, zero]
}

/// Its value on an arc, and its derivative. The value is also bounded from the middle of the arc by the derivative: near a double
/// root, where both are small, that is much narrower.
fn value(q: &Polynomial, arc: Interval) -> [Interval; 2] {
    let [here, slope] = natural(q, arc);
    if arc.width() == 0.0 {
        return [here, slope];
    }
    let middle = Interval::point(arc.middle());
    let from_middle = natural(q, middle)[0].plus(slope.times(arc.minus(middle)));
    [here.common(from_middle), slope]
}

fn natural(q: &Polynomial, arc: Interval) -> [Interval; 2] {
    let (mut here, mut slope) = (q[0], Interval::point(0.0));
    for (k, pair) in (1..).zip(q[1..].chunks_exact(2)) {
        if pair.iter().all(|x| *x == Interval::point(0.0)) {
            continue;
        }
        let times = Interval::point(f64::from(k));
        let angle = arc.times(times);
        let (c, s) = (angle.cos(), angle.sin());
        here = here.plus(pair[0].times(c)).plus(pair[1].times(s));
        slope = slope.plus(times.times(pair[1].times(c).minus(pair[0].times(s))));
    }
    [here, slope]
}

/// The angles of its roots, if there are as many for all coefficients, each of them single.
pub(super) fn roots(q: &Polynomial) -> Result<Vec<Interval>, Undecided> {
    let step = 2.0 * PI / ARCS as f64;
    // The ends of arcs are at no angle that a chain would have.
    let start = -PI + 0.0123;
    let mut open: Vec<Interval> = (0..ARCS)
        .rev()
        .map(|k| Interval { low: start + step * k as f64, high: start + step * (k + 1) as f64 })
        .collect();
    // Arcs on which the function is monotonic and may have a root, in ascending order.
    let mut steep: Vec<Interval> = Vec::new();
    while let Some(arc) = open.pop() {
        let [here, slope] = value(q, arc);
        if !here.holds(0.0) {
            continue;
        }
        if !slope.holds(0.0) {
            match steep.last_mut() {
                Some(last) if last.high == arc.low => *last = last.hull(arc),
                _ => steep.push(arc),
            }
        } else if arc.width() < NARROW {
            return Err(Undecided);
        } else {
            let middle = arc.middle();
            open.push(Interval { low: middle, high: arc.high });
            open.push(Interval { low: arc.low, high: middle });
        }
    }
    let mut found = Vec::new();
    for arc in steep {
        let ends = [arc.low, arc.high].map(|x| value(q, Interval::point(x))[0]);
        let signs = ends.map(|e| {
            if e.low > 0.0 {
                1
            } else if e.high < 0.0 {
                -1
            } else {
                0
            }
        });
        // Arcs that touch slope the same way, so that all of it is monotonic.
        match signs[0] * signs[1] {
            -1 => found.push(narrowed(q, arc)),
            1 => {}
            _ => return Err(Undecided),
        }
    }
    Ok(found)
}

/// An arc with one root for all coefficients and signs that differ at its ends, made narrower: by Newton steps where its slope is
/// bounded, by halves where it is not.
fn narrowed(q: &Polynomial, mut arc: Interval) -> Interval {
    let sign = |x: f64| {
        let here = value(q, Interval::point(x))[0];
        if here.low > 0.0 {
            1.0
        } else if here.high < 0.0 {
            -1.0
        } else {
            0.0
        }
    };
    let rises = sign(arc.high);
    for _ in 0..40 {
        let slope = value(q, arc)[1];
        let middle = Interval::point(arc.middle());
        let next = if slope.holds(0.0) {
            let side = rises * sign(middle.low);
            Interval {
                low: if side < 0.0 { middle.low } else { arc.low },
                high: if side > 0.0 { middle.low } else { arc.high },
            }
        } else {
            let next = middle.minus(value(q, middle)[0].over(slope));
            Interval { low: next.low.max(arc.low), high: next.high.min(arc.high) }
        };
        if !(next.width() < 0.9 * arc.width()) {
            break;
        }
        arc = next;
    }
    arc
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    #[test]
    fn roots_of_narrow_coefficients_are_those_of_points() {
        let mut rng = Seed::new(2).rng();
        let (mut decided, mut roots_found) = (0, 0);
        for _ in 0..300 {
            let numbers: [f64; 6] = std::array::from_fn(|_| rng.range(-1.0, 1.0));
            let conic = numbers.map(|x| Interval { low: x, high: x + 1e-6 });
            let Ok(found) = roots(&of_conic(conic)) else { continue };
            decided += 1;
            let [a, b, c, d, e, f] = numbers;
            let at = |q: f64| {
                let (x, y) = (q.cos(), q.sin());
                a * x * x + b * x * y + c * y * y + d * x + e * y + f
            };
            let steps = 4000;
            let place = |k: usize| -PI + 0.0123 + 2.0 * PI * k as f64 / steps as f64;
            let changes: Vec<usize> = (0..steps).filter(|k| at(place(*k)) * at(place(k + 1)) < 0.0).collect();
            assert_eq!(changes.len(), found.len());
            for (k, root) in changes.iter().zip(&found) {
                assert!(root.width() < 1e-3 && root.low < place(k + 1) && root.high > place(*k));
            }
            roots_found += found.len();
        }
        assert!(decided > 280 && roots_found > 200, "{decided} {roots_found}");
    }
}
