//! Which filter rejected how many candidates, and what was in the way.

use std::collections::BTreeMap;
use std::fmt;

use crate::cartesian::LineObstacle;

/// What a candidate grasp or placing can fail on, in the order of the tests: the cheap ones come first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Filter {
    /// The object is stuck in something where it stands.
    Standing,
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
            Self::Standing => "object not free where it stands",
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

/// What was in the way.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Cause {
    /// Two things touch: a link or the held object, and a link or a body.
    Touch {
        /// The one that moves.
        one: String,
        /// The other one.
        other: String,
    },
    /// A joint limit is exceeded.
    Bounds,
    /// The path constraint does not hold.
    Constraint,
    /// A straight motion of the tool ends early, and not for a contact.
    Line(LineObstacle),
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Touch { one, other } => write!(f, "{one} touches {other}"),
            Self::Bounds => f.write_str("a joint limit is exceeded"),
            Self::Constraint => f.write_str("the held object tilts too far"),
            Self::Line(obstacle) => obstacle.fmt(f),
        }
    }
}

/// Counts of rejected candidates by filter, and of what was in the way.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Rejections {
    /// Candidates rejected by each filter.
    pub counts: BTreeMap<Filter, u32>,
    /// How often each filter met each cause.
    pub causes: BTreeMap<(Filter, Cause), u32>,
    /// How many edges of the searches for free motions each cause stopped.
    pub edges: BTreeMap<Cause, u32>,
}

impl Rejections {
    /// Counts a rejection.
    pub fn add(&mut self, filter: Filter) {
        *self.counts.entry(filter).or_insert(0) += 1;
    }

    /// Counts a rejection for a cause.
    pub fn add_because(&mut self, filter: Filter, cause: Cause) {
        self.add(filter);
        *self.causes.entry((filter, cause)).or_insert(0) += 1;
    }

    /// Adds the counts of `other`.
    pub fn merge(&mut self, other: &Self) {
        for (&filter, count) in &other.counts {
            *self.counts.entry(filter).or_insert(0) += count;
        }
        for (key, count) in &other.causes {
            *self.causes.entry(key.clone()).or_insert(0) += count;
        }
        for (cause, count) in &other.edges {
            *self.edges.entry(cause.clone()).or_insert(0) += count;
        }
    }

    /// How often each pair of link and body, of two links, or of held object and other body was found touching, over
    /// all filters and searches.
    pub fn contacts(&self) -> BTreeMap<(&str, &str), u32> {
        let mut contacts = BTreeMap::new();
        let all = self.causes.iter().map(|((_, cause), n)| (cause, n)).chain(&self.edges);
        for (cause, count) in all {
            if let Cause::Touch { one, other } = cause {
                *contacts.entry((one.as_str(), other.as_str())).or_insert(0) += count;
            }
        }
        contacts
    }

    /// Whether nothing was rejected.
    pub fn is_empty(&self) -> bool {
        self.counts.is_empty() && self.edges.is_empty()
    }
}

/// Causes named for each filter; the rest is left to the counts.
const NAMED_CAUSES: usize = 3;

impl fmt::Display for Rejections {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (&filter, count)) in self.counts.iter().enumerate() {
            write!(f, "{}{filter}: {count}", if i == 0 { "" } else { "; " })?;
            let of_filter = self.causes.iter().filter(|((of, _), _)| *of == filter);
            name_causes(f, ", of which ", of_filter.map(|((_, cause), &n)| (cause, n)).collect())?;
        }
        if !self.edges.is_empty() {
            write!(f, "{}edges stopped", if self.counts.is_empty() { "" } else { "; " })?;
            name_causes(f, ": ", self.edges.iter().map(|(cause, &n)| (cause, n)).collect())?;
        }
        Ok(())
    }
}

/// Says that no grasp of a set of `known` ones can be used.
pub(super) fn none_usable(known: usize) -> String {
    match known {
        0 => "the knowledge base knows of none; computing its set anew says why".into(),
        _ => format!("none of {known} passes all tests"),
    }
}

/// The most frequent causes with their counts, behind `prefix`.
fn name_causes(f: &mut fmt::Formatter<'_>, prefix: &str, mut causes: Vec<(&Cause, u32)>) -> fmt::Result {
    causes.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(b.0)));
    for (k, (cause, n)) in causes.iter().take(NAMED_CAUSES).enumerate() {
        write!(f, "{}{cause} {n}", if k == 0 { prefix } else { ", " })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touch(one: &str) -> Cause {
        Cause::Touch { one: one.into(), other: "table".into() }
    }

    fn rejections() -> Rejections {
        let mut r = Rejections::default();
        r.add(Filter::GraspOutOfReach);
        for (link, n) in [("hand", 1), ("finger", 3)] {
            for _ in 0..n {
                r.add_because(Filter::HandAtGrasp, touch(link));
            }
        }
        r.edges.insert(touch("hand"), 7);
        r
    }

    #[test]
    fn the_most_frequent_causes_are_named() {
        assert_eq!(
            rejections().to_string(),
            "gripper not free at the grasp: 4, of which finger touches table 3, hand touches table 1; grasp out of \
             reach: 1; edges stopped: hand touches table 7"
        );
    }

    #[test]
    fn counts_add_up() {
        let mut twice = rejections();
        twice.merge(&rejections());
        assert_eq!(twice.counts[&Filter::HandAtGrasp], 8);
        assert_eq!(twice.contacts()[&("hand", "table")], 16);
        assert_eq!(twice.contacts()[&("finger", "table")], 6);
    }
}
