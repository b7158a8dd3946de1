//! Which filter rejected how many candidates, and what was in the way.

use std::collections::BTreeMap;
use std::fmt;

/// What a candidate grasp or placing can fail on, in the order of the tests: the cheap ones come first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Filter {
    /// The open gripper touches something on its approach.
    HandAtGrasp,
    /// The closed gripper touches something besides the object.
    ClosedHand,
    /// The object touches something at the destination.
    Destination,
    /// The gripper touches something at the destination.
    HandAtDestination,
    /// The grasp has no inverse kinematics.
    GraspOutOfReach,
    /// The grasp is reached only outside of the joint limits.
    GraspLimits,
    /// The arm touches something at the grasp.
    ArmAtGrasp,
    /// The straight approach cannot be driven.
    Approach,
    /// The straight lift cannot be driven.
    Lift,
    /// The destination has no inverse kinematics with this grasp.
    DestinationOutOfReach,
    /// The destination is reached only outside of the joint limits.
    DestinationLimits,
    /// The arm touches something at the destination.
    ArmAtDestination,
    /// The straight lowering cannot be driven.
    Lower,
    /// The straight retreat cannot be driven.
    Retreat,
    /// The path constraint does not hold.
    Constraint,
    /// Everything passed, but the search found no path.
    Path,
}

impl fmt::Display for Filter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::HandAtGrasp => "gripper not free at the grasp",
            Self::ClosedHand => "closed gripper not free",
            Self::Destination => "destination occupied",
            Self::HandAtDestination => "gripper not free at the destination",
            Self::GraspOutOfReach => "grasp out of reach",
            Self::GraspLimits => "grasp outside of the joint limits",
            Self::ArmAtGrasp => "arm not free at the grasp",
            Self::Approach => "approach not possible",
            Self::Lift => "lift not possible",
            Self::DestinationOutOfReach => "destination out of reach",
            Self::DestinationLimits => "destination outside of the joint limits",
            Self::ArmAtDestination => "arm not free at the destination",
            Self::Lower => "lowering not possible",
            Self::Retreat => "retreat not possible",
            Self::Constraint => "not upright",
            Self::Path => "no path",
        })
    }
}

/// Counts of rejected candidates by filter, and of the clauses that say what was in the way.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Rejections {
    /// Candidates rejected by each filter.
    pub counts: BTreeMap<Filter, u32>,
    /// How often each filter gave each reason, such as "hand touches table".
    pub reasons: BTreeMap<(Filter, String), u32>,
}

impl Rejections {
    /// Counts a rejection.
    pub fn add(&mut self, filter: Filter) {
        *self.counts.entry(filter).or_insert(0) += 1;
    }

    /// Counts a rejection for a reason.
    pub fn add_because(&mut self, filter: Filter, reason: String) {
        self.add(filter);
        *self.reasons.entry((filter, reason)).or_insert(0) += 1;
    }

    /// Adds the counts of `other`.
    pub fn merge(&mut self, other: &Self) {
        for (&filter, count) in &other.counts {
            *self.counts.entry(filter).or_insert(0) += count;
        }
        for (key, count) in &other.reasons {
            *self.reasons.entry(key.clone()).or_insert(0) += count;
        }
    }

    /// Whether nothing was rejected.
    pub fn is_empty(&self) -> bool {
        self.counts.is_empty()
    }
}

/// Reasons named for each filter; the rest is left to the counts.
const NAMED_REASONS: usize = 3;

impl fmt::Display for Rejections {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (&filter, count)) in self.counts.iter().enumerate() {
            write!(f, "{}{filter}: {count}", if i == 0 { "" } else { "; " })?;
            let mut reasons: Vec<(&str, u32)> = self
                .reasons
                .iter()
                .filter(|((of, _), _)| *of == filter)
                .map(|((_, reason), &n)| (reason.as_str(), n))
                .collect();
            reasons.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(b.0)));
            for (k, (reason, n)) in reasons.iter().take(NAMED_REASONS).enumerate() {
                write!(f, "{}{reason} {n}", if k == 0 { ", of which " } else { ", " })?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_most_frequent_reasons_are_named() {
        let mut r = Rejections::default();
        r.add(Filter::GraspOutOfReach);
        for (reason, n) in [("hand touches table", 1), ("finger touches table", 3)] {
            for _ in 0..n {
                r.add_because(Filter::HandAtGrasp, reason.into());
            }
        }
        assert_eq!(
            r.to_string(),
            "gripper not free at the grasp: 4, of which finger touches table 3, hand touches table 1; grasp out of \
             reach: 1"
        );
        let mut twice = r.clone();
        twice.merge(&r);
        assert_eq!(twice.counts[&Filter::HandAtGrasp], 8);
    }
}
