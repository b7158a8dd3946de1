//! Two edge checkers beside each other: a planner asks one, the other is asked the same, and where they differ is kept (thesis section
//! A.2: collision checkers are interchangeable, so that they can be compared).

use crate::edge::{Blocked, EdgeChecker, Obstruction, Patience};
use crate::space::Space;

/// What two checkers differ about.
#[derive(Debug, Clone, PartialEq)]
pub enum Difference {
    /// Whether a state is valid.
    State {
        /// The state.
        q: Vec<f64>,
        /// What the checker that is used says: clearance or obstruction.
        used: Result<f64, Obstruction>,
        /// What the other one says.
        other: Result<f64, Obstruction>,
    },
    /// Whether a straight motion is valid.
    Edge {
        /// Where it starts.
        from: Vec<f64>,
        /// Where it ends.
        to: Vec<f64>,
        /// What the checker that is used says.
        used: Result<(), Blocked>,
        /// What the other one says.
        other: Result<(), Blocked>,
    },
}

/// The checker that is used, with another one that is asked the same questions.
///
/// Answers are those of the first alone, so that a search takes the same way with and without the second. Where an answer claims
/// nothing (see [`Patience`]: a motion that would take long to prove, or was only looked at) the second is not asked.
///
/// ```
/// use robotc_planning::{Beside, EdgeChecker};
///
/// fn differ(mine: &mut dyn EdgeChecker, theirs: &mut dyn EdgeChecker, motions: &[(Vec<f64>, Vec<f64>)]) -> usize {
///     let mut both = Beside::new(mine, theirs);
///     for (from, to) in motions {
///         let _ = both.edge(from, to);
///     }
///     both.differences().len()
/// }
/// ```
pub struct Beside<'c, A: EdgeChecker + ?Sized, B: EdgeChecker + ?Sized> {
    used: &'c mut A,
    other: &'c mut B,
    patience: Patience,
    compared: u64,
    differences: Vec<Difference>,
}

/// Differences that are kept.
const MOST: usize = 1000;

impl<'c, A: EdgeChecker + ?Sized, B: EdgeChecker + ?Sized> Beside<'c, A, B> {
    /// Puts `other` beside `used`.
    ///
    /// # Panics
    ///
    /// If the states of the two have different dimensions.
    pub fn new(used: &'c mut A, other: &'c mut B) -> Self {
        assert_eq!(used.space().dimension(), other.space().dimension());
        Self { used, other, patience: Patience::default(), compared: 0, differences: Vec::new() }
    }

    /// Answers that were compared.
    pub fn compared(&self) -> u64 {
        self.compared
    }

    /// What the two differ about, in the order of the questions; the first thousand.
    pub fn differences(&self) -> &[Difference] {
        &self.differences
    }

    fn note(&mut self, differ: bool, difference: impl FnOnce() -> Difference) {
        self.compared += 1;
        if differ && self.differences.len() < MOST {
            self.differences.push(difference());
        }
    }
}

impl<A: EdgeChecker + ?Sized, B: EdgeChecker + ?Sized> EdgeChecker for Beside<'_, A, B> {
    fn space(&self) -> &Space {
        self.used.space()
    }

    fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction> {
        let (used, other) = (self.used.state(q), self.other.state(q));
        self.note(used.is_ok() != other.is_ok(), || Difference::State { q: q.to_vec(), used, other });
        used
    }

    fn travel(&self, difference: &[f64]) -> f64 {
        self.used.travel(difference)
    }

    fn resolution(&self) -> f64 {
        self.used.resolution()
    }

    fn edge(&mut self, from: &[f64], to: &[f64]) -> Result<(), Blocked> {
        let used = self.used.edge(from, to);
        let claims = match self.patience {
            Patience::Thorough => true,
            Patience::Hasty => used.is_ok(),
            Patience::Hopeful => used.is_err(),
            // Neither answer is certain.
            Patience::Wary => false,
        };
        if claims {
            let other = self.other.edge(from, to);
            self.note(used.is_ok() != other.is_ok(), || Difference::Edge {
                from: from.to_vec(),
                to: to.to_vec(),
                used,
                other,
            });
        }
        used
    }

    fn set_patience(&mut self, patience: Patience) {
        self.patience = patience;
        self.used.set_patience(patience);
    }

    fn describe(&self, obstruction: Obstruction) -> String {
        self.used.describe(obstruction)
    }
}

#[cfg(test)]
mod tests {
    use robotc_core::Seed;

    use super::*;
    use crate::budget::Budget;
    use crate::goal::FixedGoals;
    use crate::rrt::{RrtConnect, RrtOptions};
    use crate::toy::Toy;

    fn search<C: EdgeChecker>(checker: &mut C) -> Vec<Vec<f64>> {
        let mut goals = FixedGoals::new(vec![vec![8.0, 2.0]]);
        let found = RrtConnect::new(&[2.0, 2.0]).run(
            checker,
            None,
            &mut goals,
            &RrtOptions::default(),
            &Budget::unlimited(),
            &mut Seed::new(3).rng(),
        );
        found.unwrap().path
    }

    #[test]
    fn equal_checkers_agree_and_the_search_does_not_notice() {
        let alone = search(&mut Toy::wall(0.05));
        let (mut used, mut other) = (Toy::wall(0.05), Toy::wall(0.05));
        let mut both = Beside::new(&mut used, &mut other);
        assert_eq!(search(&mut both), alone);
        assert!(both.compared() > 20 && both.differences().is_empty());
    }

    #[test]
    fn a_wall_that_only_one_knows_is_found_where_the_search_goes_through_it() {
        let (mut used, mut other) = (Toy::new(vec![], 0.05), Toy::wall(0.05));
        let mut both = Beside::new(&mut used, &mut other);
        let path = search(&mut both);
        let touches_wall = |d: &Difference| match d {
            Difference::Edge { from, to, used: Ok(()), other: Err(_) } => {
                from[0].min(to[0]) <= 5.0 && from[0].max(to[0]) >= 4.0
            }
            _ => false,
        };
        assert!(path.len() >= 2 && !both.differences().is_empty());
        assert!(both.differences().iter().all(touches_wall));
        let _ = both.state(&[4.5, 3.0]);
        assert!(matches!(
            both.differences().last(),
            Some(Difference::State { used: Ok(_), other: Err(_), .. })
        ));
    }

    #[test]
    fn what_is_only_looked_at_claims_nothing() {
        let (mut used, mut other) = (Toy::new(vec![], 0.05), Toy::wall(0.05));
        let mut both = Beside::new(&mut used, &mut other);
        both.set_patience(Patience::Hopeful);
        assert!(both.edge(&[1.0, 1.0], &[8.0, 1.0]).is_ok());
        assert_eq!((both.compared(), both.differences().len()), (0, 0));
    }
}
