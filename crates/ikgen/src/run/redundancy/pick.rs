//! Solutions of a redundant arm from all values of a free variable at once: the nearest to a joint vector, and some spread evenly.

use robotc_core::Pose;
use robotc_core::ik::{IkSolutions, PreferenceError, Preferences};

use super::{FreeIntervals, RedundancyOptions};
use crate::run::Solver;

/// Values of the free variable at which the distance is looked at first, beside the ends of its intervals.
const PLACES: usize = 48;

/// Of these the best are followed downhill.
const FOLLOWED: usize = 4;

/// Steps downhill are halved down to this, radians or metres.
const SMALLEST: f64 = 1e-9;

impl Solver {
    /// The solution that keeps the limits of `preferences` and is nearest to its `near`, over all values of the `k`-th free variable; the
    /// others have the values in `free`. Without `near`, nearest to all variables at zero; `None` when there is none.
    ///
    /// Panics as [`free_intervals`](Self::free_intervals).
    pub fn solve_nearest(
        &self,
        base_from_tip: &Pose,
        free: &[f64],
        k: usize,
        preferences: &Preferences,
        options: &RedundancyOptions,
    ) -> Result<Option<Vec<f64>>, PreferenceError> {
        let found = self.free_intervals(base_from_tip, free, k, preferences, options)?;
        let ranges = preferences.ranges(self.ranges())?;
        let near = preferences.near.clone().unwrap_or_else(|| vec![0.0; ranges.len()]);
        let first = Preferences { near: Some(near.clone()), max_solutions: 1, ..preferences.clone() };
        let mut given = free.to_vec();
        let mut out = IkSolutions::new();
        let mut at = |value: f64| -> Result<Option<(f64, Vec<f64>)>, PreferenceError> {
            given[k] = value;
            self.solve_preferred(base_from_tip, &given, &first, &mut out)?;
            Ok(out.iter().next().map(|q| (preferences.squared_distance(&ranges, q, &near), q.to_vec())))
        };
        let mut places: Vec<(f64, f64, Vec<f64>)> = Vec::new();
        let seed = near.get(self.program().free[k]).and_then(|seed| found.nearest(*seed));
        let ends = found.intervals.iter().flatten().copied();
        for value in found.spread(PLACES).into_iter().chain(ends).chain(seed) {
            places.extend(at(value)?.map(|(cost, q)| (cost, value, q)));
        }
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        places.truncate(FOLLOWED);
        let mut best: Option<(f64, Vec<f64>)> = None;
        for (mut cost, mut value, mut q) in places {
            let mut step = found.measure() / PLACES as f64;
            while step > SMALLEST {
                step *= 0.5;
                for next in [value - step, value + step] {
                    if found.contains(next)
                        && let Some((less, nearer)) = at(next)?.filter(|(less, _)| *less < cost)
                    {
                        (cost, value, q) = (less, next, nearer);
                        break;
                    }
                }
            }
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, q));
            }
        }
        Ok(best.map(|(_, q)| q))
    }

    /// The solutions that are wanted at `count` values of the `k`-th free variable, [spread](FreeIntervals::spread) evenly over those that
    /// have any; the others have the values in `free`. They come in ascending order of the value.
    ///
    /// Panics as [`free_intervals`](Self::free_intervals).
    pub fn solve_spread(
        &self,
        base_from_tip: &Pose,
        free: &[f64],
        k: usize,
        count: usize,
        preferences: &Preferences,
        options: &RedundancyOptions,
        out: &mut IkSolutions,
    ) -> Result<FreeIntervals, PreferenceError> {
        let found = self.free_intervals(base_from_tip, free, k, preferences, options)?;
        let mut given = free.to_vec();
        let mut here = IkSolutions::new();
        out.reset(self.ranges().len());
        for value in found.spread(count) {
            given[k] = value;
            self.solve_preferred(base_from_tip, &given, preferences, &mut here)?;
            here.iter().for_each(|q| out.push(q));
        }
        Ok(found)
    }
}
