//! Which solutions of a pose a caller wants, and in which order.

use std::f64::consts::TAU;

use super::IkSolutions;
use crate::model::{ChainJoint, ChainMotion, SerialChain};

/// Rounding at a limit is not a violation.
const LIMIT_SLACK: f64 = 1e-9;

/// Aliases of one angle that are considered at most: limits further apart are no limits.
const MOST_TURNS: f64 = 8.0;

/// What values a variable of a chain may take.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VariableRange {
    /// Turns have aliases 2 pi apart, lengths have none. An angle that another joint follows by a part of it counts as a length: a full
    /// turn is another place.
    pub motion: ChainMotion,
    /// Smallest value, radians or metres; minus infinity when there is none.
    pub lower: f64,
    /// Largest value; infinity when there is none.
    pub upper: f64,
}

impl VariableRange {
    /// The ranges of a chain's variables, as described.
    pub fn of(chain: &SerialChain) -> Vec<Self> {
        let slides = |v| {
            let part = |j: &ChainJoint| j.motion == ChainMotion::Prismatic || j.multiplier.fract() != 0.0;
            chain.joints.iter().any(|j| j.variable == v && part(j))
        };
        let motion = |v| if slides(v) { ChainMotion::Prismatic } else { ChainMotion::Revolute };
        let variables = chain.variables.iter().enumerate();
        variables.map(|(v, x)| Self { motion: motion(v), lower: x.lower, upper: x.upper }).collect()
    }

    /// The same variable without limits.
    pub fn unlimited(self) -> Self {
        Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY, ..self }
    }

    /// Whether it turns without end, so that its aliases are one and the same place.
    pub fn is_continuous(&self) -> bool {
        self.motion == ChainMotion::Revolute
            && !(self.lower > f64::NEG_INFINITY || self.upper < f64::INFINITY)
    }

    /// The value itself if it is within the limits. Up to 1e-9 beyond, it is moved onto the limit.
    pub fn within(&self, value: f64) -> Option<f64> {
        let inside = self.lower - LIMIT_SLACK <= value && value <= self.upper + LIMIT_SLACK;
        inside.then(|| value.max(self.lower).min(self.upper))
    }

    /// The aliases of a value within the limits, ascending: all of them for an angle that both limits hold, otherwise the one
    /// nearest to `near`.
    pub fn aliases(&self, value: f64, near: f64) -> Vec<f64> {
        if self.motion == ChainMotion::Prismatic || self.upper - self.lower == f64::INFINITY {
            return self.nearest(value, near).into_iter().collect();
        }
        let (first, last) = self.turns_within(value);
        let mut found = Vec::new();
        let mut turns = first.max(-MOST_TURNS);
        while turns <= last.min(MOST_TURNS) {
            found.extend(self.within(value + TAU * turns));
            turns += 1.0;
        }
        found
    }

    /// The alias of a value that is within the limits and nearest to `near`; of two equally near ones that which takes
    /// fewer turns.
    pub fn nearest(&self, value: f64, near: f64) -> Option<f64> {
        if self.motion == ChainMotion::Prismatic {
            return self.within(value);
        }
        let (first, last) = self.turns_within(value);
        if last < first || value.is_nan() {
            return None;
        }
        // Of aliases in order the nearest is that whose number of turns is nearest.
        let away = (near - value) / TAU;
        let turns = if away.abs() <= 0.5 { 0.0 } else { away.round() };
        let turns = turns.clamp(first, last);
        self.within(value + TAU * turns)
    }

    /// Fewest and most turns that bring an angle within the limits; the first is larger than the second if there are none.
    fn turns_within(&self, value: f64) -> (f64, f64) {
        let first = ((self.lower - LIMIT_SLACK - value) / TAU).ceil();
        let last = ((self.upper + LIMIT_SLACK - value) / TAU).floor();
        (first, last)
    }

    /// How far two values are from each other: the short way round where the variable turns without end.
    pub fn distance(&self, a: f64, b: f64) -> f64 {
        let gap = (a - b).abs();
        if self.is_continuous() { (gap - TAU * (gap / TAU).round()).abs() } else { gap }
    }
}

/// Which limits solutions must keep.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Limits {
    /// Those of the chain.
    #[default]
    Described,
    /// None.
    Ignored,
    /// Lower and upper value of each variable, base to tip.
    Given(Vec<[f64; 2]>),
}

/// Which of the values 2 pi apart a turning variable takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Aliases {
    /// The one within the limits that is nearest to the seed, or to zero without one.
    #[default]
    Nearest,
    /// Every one within the limits, in all combinations. A variable that lacks a limit has only its nearest one.
    All,
}

/// Which solutions of a pose a caller wants, and in which order.
///
/// The default: every solution within the limits of the chain once, in the solver's branch order.
#[derive(Debug, Clone, PartialEq)]
pub struct Preferences {
    /// Limits to keep.
    pub limits: Limits,
    /// Which aliases to return.
    pub aliases: Aliases,
    /// A joint vector: solutions nearest to it come first. Without it they come in the solver's branch order.
    pub near: Option<Vec<f64>>,
    /// Weight of each variable in the distance to `near`, the root of `sum (weight * difference)^2`; empty: 1 each.
    pub weights: Vec<f64>,
    /// Most solutions to return, at least one. Without `near` the search stops when they are found.
    pub max_solutions: usize,
}

impl Default for Preferences {
    fn default() -> Self {
        Self {
            limits: Limits::default(),
            aliases: Aliases::default(),
            near: None,
            weights: Vec::new(),
            max_solutions: usize::MAX,
        }
    }
}

/// Why preferences do not fit a chain.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PreferenceError {
    /// A list has a wrong length.
    #[error("{what}: expected {expected} values, got {found}")]
    Length {
        /// Which list.
        what: &'static str,
        /// Variables of the chain.
        expected: usize,
        /// Its length.
        found: usize,
    },
    /// A number cannot be meant.
    #[error("{0} is not a possible value")]
    Value(&'static str),
}

impl Preferences {
    /// The ranges to keep, of a chain whose own ranges are `described`; checks that everything fits.
    pub fn ranges(&self, described: &[VariableRange]) -> Result<Vec<VariableRange>, PreferenceError> {
        let expected = described.len();
        let length = |what, found| {
            if found == expected { Ok(()) } else { Err(PreferenceError::Length { what, expected, found }) }
        };
        if let Some(near) = &self.near {
            length("near", near.len())?;
            if near.iter().any(|x| !x.is_finite()) {
                return Err(PreferenceError::Value("near"));
            }
        }
        if !self.weights.is_empty() {
            length("weights", self.weights.len())?;
            if self.weights.iter().any(|w| !(w.is_finite() && *w >= 0.0)) {
                return Err(PreferenceError::Value("weights"));
            }
        }
        if self.max_solutions == 0 {
            return Err(PreferenceError::Value("max_solutions"));
        }
        match &self.limits {
            Limits::Described => Ok(described.to_vec()),
            Limits::Ignored => Ok(described.iter().map(|r| r.unlimited()).collect()),
            Limits::Given(limits) => {
                length("limits", limits.len())?;
                if limits.iter().any(|[low, high]| low.is_nan() || high.is_nan() || low > high) {
                    return Err(PreferenceError::Value("limits"));
                }
                let pairs = described.iter().zip(limits);
                Ok(pairs.map(|(r, &[lower, upper])| VariableRange { lower, upper, ..*r }).collect())
            }
        }
    }

    /// Adds the wanted forms of one solution to `out`, none when it is outside of the limits; says whether there is one.
    pub fn offer(&self, ranges: &[VariableRange], solution: &[f64], out: &mut IkSolutions) -> bool {
        let near = |v: usize| self.near.as_ref().map_or(0.0, |near| near[v]);
        let forms = ranges.iter().zip(solution).enumerate().map(|(v, (range, value))| match self.aliases {
            Aliases::All => range.aliases(*value, near(v)),
            Aliases::Nearest => range.nearest(*value, near(v)).into_iter().collect(),
        });
        let forms: Vec<Vec<f64>> = forms.collect();
        if forms.iter().any(Vec::is_empty) {
            return false;
        }
        let most = if self.near.is_some() { usize::MAX } else { self.max_solutions };
        let mut pick = vec![0; forms.len()];
        while out.len() < most {
            let form: Vec<f64> = pick.iter().zip(&forms).map(|(i, values)| values[*i]).collect();
            out.push(&form);
            // Counts up, the last variable fastest.
            let Some(v) = (0..pick.len()).rev().find(|v| pick[*v] + 1 < forms[*v].len()) else { break };
            pick[v] += 1;
            pick[v + 1..].fill(0);
        }
        true
    }

    /// Puts what was [offered](Self::offer) in order and keeps as many as are wanted.
    pub fn finish(&self, ranges: &[VariableRange], out: &mut IkSolutions) {
        if let Some(near) = &self.near {
            out.sort_by_cost(|q| self.squared_distance(ranges, q, near));
        }
        out.truncate(self.max_solutions);
    }

    /// Whether nothing more need be offered.
    pub fn is_enough(&self, out: &IkSolutions) -> bool {
        self.near.is_none() && out.len() >= self.max_solutions
    }

    /// Square of the weighted distance of two joint vectors.
    pub fn squared_distance(&self, ranges: &[VariableRange], a: &[f64], b: &[f64]) -> f64 {
        let terms = ranges.iter().zip(a.iter().zip(b)).enumerate().map(|(v, (range, (a, b)))| {
            let weighted = self.weights.get(v).copied().unwrap_or(1.0) * range.distance(*a, *b);
            weighted * weighted
        });
        terms.sum()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::Seed;

    fn turn(lower: f64, upper: f64) -> VariableRange {
        VariableRange { motion: ChainMotion::Revolute, lower, upper }
    }

    #[test]
    fn the_nearest_alias_is_the_nearest_of_all() {
        let mut rng = Seed::new(3).rng();
        for _ in 0..2000 {
            let lower = rng.range(-12.0, 6.0);
            let range = turn(lower, lower + rng.range(0.0, 15.0));
            let (value, near) = (rng.range(-PI, PI), rng.range(-15.0, 15.0));
            let all = range.aliases(value, near);
            for x in &all {
                let turns = (x - value) / TAU;
                assert!((turns - turns.round()).abs() < 1e-9 && range.lower <= *x && *x <= range.upper);
            }
            let expected = (range.upper - range.lower) / TAU;
            assert!((all.len() as f64 - expected).abs() < 1.0, "{range:?} {value} {all:?}");
            let best = all.into_iter().min_by(|a, b| (a - near).abs().total_cmp(&(b - near).abs()));
            assert_eq!(range.nearest(value, near), best);
        }
    }

    #[test]
    fn aliases_keep_to_the_limits() {
        assert_eq!(turn(-4.0, 4.0).nearest(3.0, -3.0), Some(3.0 - TAU));
        assert_eq!(turn(-4.0, 4.0).nearest(3.0, 2.0), Some(3.0));
        assert_eq!(turn(3.5, 6.0).nearest(-1.0, 0.0), Some(TAU - 1.0));
        assert_eq!(turn(-1.0, 1.0).nearest(2.0, 0.0), None);
        assert_eq!(turn(-1.0, 1.0).nearest(1.0 + 1e-12, 0.0), Some(1.0));
        assert_eq!(turn(-4.0, 4.0).nearest(PI, 0.0), Some(PI));
    }

    #[test]
    fn limits_aliases_and_order() {
        let ranges =
            [turn(-4.0, 4.0), VariableRange { motion: ChainMotion::Prismatic, lower: 0.0, upper: 1.0 }];
        let collect = |preferences: &Preferences, found: &[[f64; 2]]| {
            let kept = preferences.ranges(&ranges).unwrap();
            let mut out = IkSolutions::new();
            out.reset(2);
            for q in found {
                preferences.offer(&kept, q, &mut out);
            }
            preferences.finish(&kept, &mut out);
            out.iter().map(<[f64]>::to_vec).collect::<Vec<_>>()
        };
        let found = [[3.0, 0.5], [0.1, 0.2], [0.2, 1.5], [0.3, 1.0 + 1e-12]];
        let plain = Preferences::default();
        assert_eq!(collect(&plain, &found), [[3.0, 0.5], [0.1, 0.2], [0.3, 1.0]]);
        let all = Preferences { aliases: Aliases::All, ..plain.clone() };
        assert_eq!(collect(&all, &found[..1]), [[3.0 - TAU, 0.5], [3.0, 0.5]]);
        let near = Preferences { near: Some(vec![-3.0, 0.5]), max_solutions: 2, ..plain.clone() };
        assert_eq!(collect(&near, &found), [[3.0 - TAU, 0.5], [0.1, 0.2]]);
        let weighted = Preferences { weights: vec![0.0, 1.0], near: Some(vec![0.0, 0.2]), ..plain.clone() };
        assert_eq!(collect(&weighted, &found), [[0.1, 0.2], [3.0, 0.5], [0.3, 1.0]]);
        let free = Preferences { limits: Limits::Ignored, near: Some(vec![6.2, 0.0]), ..plain.clone() };
        assert_eq!(collect(&free, &found)[0][0], 0.1 + TAU);
        let given = Preferences { limits: Limits::Given(vec![[0.0, 0.15], [0.0, 1.0]]), ..plain };
        assert_eq!(collect(&given, &found), [[0.1, 0.2]]);
    }

    #[test]
    fn what_does_not_fit_is_said() {
        let ranges = [turn(-1.0, 1.0)];
        let refused = |p: Preferences| p.ranges(&ranges).unwrap_err().to_string();
        let near = Preferences { near: Some(vec![0.0; 2]), ..Preferences::default() };
        assert_eq!(refused(near), "near: expected 1 values, got 2");
        let limits = Preferences { limits: Limits::Given(vec![[1.0, -1.0]]), ..Preferences::default() };
        assert_eq!(refused(limits), "limits is not a possible value");
        assert!(Preferences { max_solutions: 0, ..Preferences::default() }.ranges(&ranges).is_err());
    }
}
