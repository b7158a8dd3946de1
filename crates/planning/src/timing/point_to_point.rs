//! From rest to rest along a straight edge with limited jerk: seven pieces of constant jerk, in closed form.
//!
//! All coordinates share one time law s(t) from 0 to 1, so the edge stays straight; a coordinate that travels d has d times
//! the derivatives of s, and the tightest of its limits bound them. Under these bounds the law is the fastest: at any time
//! the jerk is at its limit, or the acceleration, or the speed (Biagiotti and Melchiorri, "Trajectory planning for
//! automatic machines and robots", 2008, section 3.4).

use robotc_core::trajectory::TrajectoryPoint;

use super::MotionLimits;
use super::timed::TimedPath;

/// Bounds of the first three derivatives of s.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bounds {
    velocity: f64,
    acceleration: f64,
    jerk: f64,
}

/// The fastest motion on the straight edge between two states, at rest at both ends, that keeps the limits of velocity,
/// acceleration and jerk of every coordinate; takes no time when the states are equal.
///
/// Knots are where the jerk changes, and a trajectory is cubic between its knots: it is this motion, not an approximation.
pub fn point_to_point(from: &[f64], to: &[f64], limits: &MotionLimits) -> TimedPath {
    let mut path = TimedPath::resting_at(from);
    let difference: Vec<f64> = from.iter().zip(to).map(|(a, b)| b - a).collect();
    if difference.iter().all(|d| *d == 0.0) {
        return path;
    }
    let bound = |limits: &[f64]| {
        let ratios = limits.iter().zip(&difference).map(|(limit, d)| limit / d.abs());
        ratios.fold(f64::INFINITY, f64::min)
    };
    let pieces = pieces(&Bounds {
        velocity: bound(&limits.velocity),
        acceleration: bound(&limits.acceleration),
        jerk: bound(&limits.jerk),
    });
    let scaled = |x: f64| -> Vec<f64> { difference.iter().map(|d| d * x).collect() };
    let (mut time, mut s, mut speed, mut acceleration) = (0.0, 0.0, 0.0, 0.0);
    for (t, jerk) in pieces.into_iter().filter(|(t, _)| *t > 0.0) {
        time += t;
        s += t * (speed + t * (acceleration / 2.0 + t * jerk / 6.0));
        speed += t * (acceleration + t * jerk / 2.0);
        acceleration += t * jerk;
        let positions = from.iter().zip(&difference).map(|(a, d)| a + d * s).collect();
        let (velocities, accelerations) = (scaled(speed), scaled(acceleration));
        path.push(time, TrajectoryPoint { positions, velocities, accelerations });
    }
    // What is left of the sums there is rounding.
    if let Some(end) = path.knots.last_mut() {
        *end = TimedPath::resting_at(to).knots.swap_remove(0);
    }
    path
}

/// Durations and jerks of the pieces that bring s from 0 to 1; some take no time.
fn pieces(bounds: &Bounds) -> [(f64, f64); 7] {
    let Bounds { velocity: v, acceleration: a, jerk: j } = *bounds;
    // How long a jerk lasts, and the whole of speeding up, if full speed is to be reached.
    let full = match v * j >= a * a {
        true => (a / j, a / j + v / a),
        false => ((v / j).sqrt(), 2.0 * (v / j).sqrt()),
    };
    // Speeding up to a speed and slowing down again cover that speed times the time of one of them.
    let (jerking, speeding, cruising) = if v * full.1 <= 1.0 {
        (full.0, full.1, 1.0 / v - full.1)
    } else if 2.0 * a * a * a <= j * j {
        // Full acceleration is reached and full speed is not: 1 = a (speeding - jerking) speeding.
        let jerking = a / j;
        (jerking, 0.5 * (jerking + (jerking * jerking + 4.0 / a).sqrt()), 0.0)
    } else {
        let jerking = libm::cbrt(1.0 / (2.0 * j));
        (jerking, 2.0 * jerking, 0.0)
    };
    let steady = (speeding - 2.0 * jerking).max(0.0);
    [(jerking, j), (steady, 0.0), (jerking, -j), (cruising, 0.0), (jerking, -j), (steady, 0.0), (jerking, j)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn limits(velocity: f64, acceleration: f64, jerk: f64) -> MotionLimits {
        MotionLimits { velocity: vec![velocity], acceleration: vec![acceleration], jerk: vec![jerk] }
    }

    fn duration(distance: f64, limits: &MotionLimits) -> f64 {
        point_to_point(&[0.0], &[distance], limits).duration()
    }

    #[test]
    fn each_regime_takes_the_time_of_its_formula() {
        // Jerk alone: four pieces of a quarter of the time each; distance = j T^3 / 32.
        assert!((duration(2.0, &limits(1e9, 1e9, 1.0)) - 4.0).abs() < 1e-9);
        // No limit of the jerk to speak of: the trapezoid of 2 s up, 2 s at full speed, 2 s down.
        assert!((duration(8.0, &limits(2.0, 1.0, 1e9)) - 6.0).abs() < 1e-6);
        // Acceleration and jerk; full speed is not reached: 6 = (T - 1) T has T = 3.
        assert!((duration(6.0, &limits(9.0, 1.0, 1.0)) - 6.0).abs() < 1e-9);
        // All seven pieces: speeding up takes 2 / 1 + 1 / 1 = 3 s and 3 m, cruising 4 m at 2 m/s.
        assert!((duration(10.0, &limits(2.0, 1.0, 1.0)) - 8.0).abs() < 1e-9);
        // Speed and jerk, full acceleration never: 2 s up, 1 m; 1 m at 1 m/s; 2 s down.
        assert!((duration(3.0, &limits(1.0, 9.0, 1.0)) - 5.0).abs() < 1e-9);
        assert_eq!(duration(0.0, &limits(1.0, 1.0, 1.0)), 0.0);
    }

    proptest! {
        #![proptest_config(crate::properties::cases(200))]
        #[test]
        fn finite_differences_keep_all_limits_and_use_one(
            from in prop::array::uniform3(-3.0..3.0f64),
            to in prop::array::uniform3(-3.0..3.0f64),
            v in prop::array::uniform3(0.1..5.0f64),
            a in prop::array::uniform3(0.1..20.0f64),
            j in prop::array::uniform3(0.1..200.0f64),
        ) {
            let limits = MotionLimits { velocity: v.to_vec(), acceleration: a.to_vec(), jerk: j.to_vec() };
            let timed = point_to_point(&from, &to, &limits);
            let end = timed.duration();
            prop_assert_eq!(&timed.knots[0].positions[..], &from[..]);
            prop_assert_eq!(&timed.knots[timed.knots.len() - 1].positions[..], &to[..]);
            // Positions alone, evenly in time, with rest before and after: differences divided by the step are means of
            // the derivatives, jumps at the ends included.
            let n = 400_usize;
            let h = end / n as f64;
            let mut samples = vec![from.to_vec(); 3];
            samples.extend(timed.resample(h).into_iter().map(|(_, p)| p.positions));
            samples.extend(vec![to.to_vec(); 3]);
            let rounding = 1e-14;
            let mut most = 0.0_f64;
            for window in samples.windows(4) {
                for i in 0..3 {
                    let [p, q, r, s] = [0, 1, 2, 3].map(|k| window[k][i]);
                    let (speed, acceleration, jerk) = (s - r, s - 2.0 * r + q, s - 3.0 * r + 3.0 * q - p);
                    let used = [(speed / h, v[i], h), (acceleration / (h * h), a[i], h * h)];
                    for (value, limit, step) in used.into_iter().chain([(jerk / (h * h * h), j[i], h * h * h)]) {
                        let doubt = 8.0 * rounding / step;
                        prop_assert!(value.abs() <= limit * (1.0 + 1e-6) + doubt, "{value} over {limit}");
                        most = most.max((value.abs() - doubt) / limit);
                    }
                }
            }
            prop_assert!(most > 0.98, "nothing is used to the full: {most}");
        }

        #[test]
        fn nothing_is_faster_than_any_limit_alone_allows(
            distance in 0.01..5.0f64, v in 0.1..5.0f64, a in 0.1..20.0f64, j in 0.1..200.0f64,
        ) {
            let limited = duration(distance, &limits(v, a, j));
            let alone = [distance / v, 2.0 * (distance / a).sqrt(), libm::cbrt(32.0 * distance / j)];
            prop_assert!(alone.iter().all(|least| limited >= least - 1e-9));
            prop_assert!(limited >= duration(0.999 * distance, &limits(v, a, j)));
            prop_assert!(limited >= duration(distance, &limits(v, a, 2.0 * j)) - 1e-12);
        }
    }
}
