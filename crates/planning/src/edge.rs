//! Whether the straight motion between two states is free.

use crate::space::Space;

/// What makes a state invalid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Obstruction {
    /// A coordinate is out of bounds.
    Bounds,
    /// The path constraint is violated.
    Constraint,
    /// Two bodies touch; the number is the checker's own, see [`EdgeChecker::describe`].
    Contact(u32),
}

/// A motion that is not free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blocked {
    /// How far along the motion the invalid state is, 0 to 1.
    pub fraction: f64,
    /// What is wrong there.
    pub by: Obstruction,
}

/// How much work a motion is worth that passes narrowly.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Patience {
    /// Every free motion is found free.
    #[default]
    Thorough,
    /// A motion that would take long to prove free may count as blocked.
    Hasty,
    /// A motion that looks free at a few states may count as free: what is blocked is certainly blocked, the rest has to be
    /// asked about again.
    Hopeful,
    /// As hopeful, but a motion that passes narrowly may count as blocked too: what looks free is then seldom blocked after all.
    Wary,
}

/// Validity of states and of the straight motions between them: all that a planner knows about a robot and its world.
///
/// Methods take `&mut self` because checkers keep scratch space and count their work.
pub trait EdgeChecker {
    /// The space of the states.
    fn space(&self) -> &Space;

    /// Whether the state is valid, and if not, why.
    ///
    /// A valid state comes with its clearance: every point of the moving bodies may travel that far, each in its own
    /// direction, and the state stays valid. Zero when the checker does not know.
    fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction>;

    /// Whether the state is valid, without its clearance.
    fn is_free(&mut self, q: &[f64]) -> Result<(), Obstruction> {
        self.state(q).map(|_| ())
    }

    /// A bound on how far any point of the moving bodies travels in the straight motion by `difference`, in the unit
    /// of [`resolution`](Self::resolution). A norm: twice the difference, twice the bound.
    fn travel(&self, difference: &[f64]) -> f64;

    /// The largest travel between two checked states of an edge.
    ///
    /// A checker that asks for a distance of half the resolution between bodies makes whole edges free: every state in
    /// between is within half the resolution of a checked one.
    fn resolution(&self) -> f64;

    /// Whether the straight motion is valid. `from` is taken to be valid; `to` is checked.
    fn edge(&mut self, from: &[f64], to: &[f64]) -> Result<(), Blocked> {
        bisect_edge(self, from, to)
    }

    /// How much work the next edges are worth. Checkers whose every edge costs the same do not care.
    fn set_patience(&mut self, _: Patience) {}

    /// A clause naming an obstruction: `"hand touches table"`.
    fn describe(&self, obstruction: Obstruction) -> String {
        match obstruction {
            Obstruction::Bounds => "a joint limit is exceeded".into(),
            Obstruction::Constraint => "the path constraint is violated".into(),
            Obstruction::Contact(n) => format!("contact {n}"),
        }
    }
}

/// States of a straight motion, in one buffer.
pub(crate) struct Motion<'a> {
    from: &'a [f64],
    to: &'a [f64],
    difference: Vec<f64>,
    q: Vec<f64>,
}

impl<'a> Motion<'a> {
    pub(crate) fn new(space: &Space, from: &'a [f64], to: &'a [f64]) -> Self {
        Self { from, to, difference: space.difference(from, to), q: from.to_vec() }
    }

    /// The whole motion.
    pub(crate) fn difference(&self) -> &[f64] {
        &self.difference
    }

    /// The clearance of the state a fraction of the way along.
    pub(crate) fn check<C: EdgeChecker + ?Sized>(
        &mut self,
        checker: &mut C,
        fraction: f64,
    ) -> Result<f64, Blocked> {
        if fraction == 1.0 {
            // Start and difference together may be a rounding away from it, and so beyond a limit.
            self.q.copy_from_slice(self.to);
        } else {
            for (x, (a, d)) in self.q.iter_mut().zip(self.from.iter().zip(&self.difference)) {
                *x = a + fraction * d;
            }
        }
        checker.state(&self.q).map_err(|by| Blocked { fraction, by })
    }
}

/// Walks from `from` (taken to be valid) to `to` and stops at the first invalid state.
///
/// Each step is the resolution plus the clearance of the state it starts from; the end is looked at last (thesis
/// algorithm 4.10, whose printed stop test is the wrong way round).
pub fn walk_edge<C: EdgeChecker + ?Sized>(checker: &mut C, from: &[f64], to: &[f64]) -> Result<(), Blocked> {
    let mut motion = Motion::new(checker.space(), from, to);
    let travel = checker.travel(&motion.difference);
    let resolution = checker.resolution();
    let (mut walked, mut clearance) = (0.0, 0.0);
    loop {
        walked += resolution + clearance;
        if walked >= travel {
            return motion.check(checker, 1.0).map(|_| ());
        }
        clearance = motion.check(checker, walked / travel)?;
    }
}

/// Checks the end, then the middle, then the middles of what is left: finds a contact soonest.
///
/// A piece is done when the travel along it is no more than the resolution plus the clearances of its ends. `from`
/// is taken to be valid; the reported state need not be the first invalid one.
pub fn bisect_edge<C: EdgeChecker + ?Sized>(
    checker: &mut C,
    from: &[f64],
    to: &[f64],
) -> Result<(), Blocked> {
    let mut motion = Motion::new(checker.space(), from, to);
    let travel = checker.travel(&motion.difference);
    let resolution = checker.resolution();
    let end_clearance = motion.check(checker, 1.0)?;
    // Pieces still open, widest first: start and end as fraction and clearance.
    let mut pieces = vec![((0.0, 0.0), (1.0, end_clearance))];
    let mut next = 0;
    while next < pieces.len() {
        let (start, end): ((f64, f64), (f64, f64)) = pieces[next];
        next += 1;
        if (end.0 - start.0) * travel <= resolution + start.1 + end.1 {
            continue;
        }
        let fraction = 0.5 * (start.0 + end.0);
        let middle = (fraction, motion.check(checker, fraction)?);
        pieces.push((start, middle));
        pieces.push((middle, end));
    }
    Ok(())
}

/// A motion of a path that is not free.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlockedPath {
    /// The motion from state `edge` to state `edge + 1`; the first state itself when the fraction is zero.
    pub edge: usize,
    /// Where and why.
    pub blocked: Blocked,
}

/// Walks a whole path, its first state included, and stops at the first invalid state.
pub fn walk_path<C: EdgeChecker + ?Sized>(checker: &mut C, path: &[Vec<f64>]) -> Result<(), BlockedPath> {
    if let Some(first) = path.first() {
        let blocked = |by| BlockedPath { edge: 0, blocked: Blocked { fraction: 0.0, by } };
        checker.state(first).map_err(blocked)?;
    }
    for (edge, pair) in path.windows(2).enumerate() {
        walk_edge(checker, &pair[0], &pair[1]).map_err(|blocked| BlockedPath { edge, blocked })?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toy::Toy;

    #[test]
    fn the_walk_finds_the_first_contact_and_bisection_finds_one() {
        let mut toy = Toy::wall(0.01);
        let (from, to) = ([1.0, 1.0], [9.0, 1.0]);
        let first = walk_edge(&mut toy, &from, &to).unwrap_err();
        // The wall starts at x = 4.
        assert!((first.fraction - 3.0 / 8.0).abs() <= 0.01 / 8.0, "{first:?}");
        assert_eq!(first.by, Obstruction::Contact(0));
        assert!(bisect_edge(&mut toy, &from, &to).unwrap_err().fraction >= first.fraction);
    }

    #[test]
    fn no_two_checked_states_are_farther_apart_than_the_resolution() {
        for order in [walk_edge::<Toy>, bisect_edge::<Toy>] {
            let mut toy = Toy::wall(0.1);
            toy.clearance = false;
            order(&mut toy, &[1.0, 9.5], &[9.0, 9.5]).unwrap();
            let mut seen: Vec<f64> = toy.seen.iter().map(|q| q[0]).chain([1.0]).collect();
            seen.sort_by(f64::total_cmp);
            assert!(seen.windows(2).all(|w| w[1] - w[0] <= 0.1 + 1e-12));
            assert_eq!(seen.last(), Some(&9.0), "the end itself is checked");
            assert!((80..=129).contains(&seen.len()), "{}", seen.len());
        }
    }

    #[test]
    fn the_end_of_a_motion_is_looked_at_as_it_is() {
        let ends = [0.3, 1.1];
        for (i, end) in (0..500).flat_map(|i| ends.map(|end| (i, end))) {
            let mut toy = Toy::wall(0.5);
            bisect_edge(&mut toy, &[0.019 * f64::from(i), 9.5], &[end, 9.5]).unwrap();
            assert!(toy.seen.iter().any(|q| q[0] == end), "{i} {end}");
        }
    }

    #[test]
    fn clearance_saves_checks_without_missing_thin_walls() {
        for order in [walk_edge::<Toy>, bisect_edge::<Toy>] {
            let mut toy = Toy::wall(0.01);
            assert!(order(&mut toy, &[3.9, 0.0], &[3.9, 9.9]).is_ok());
            assert!(order(&mut toy, &[0.5, 0.5], &[0.5, 9.5]).is_ok());
            assert!(toy.seen.len() < 400, "{}", toy.seen.len());
            assert!(order(&mut toy, &[3.5, 4.0], &[4.2, 4.0]).is_err());
        }
    }
}
