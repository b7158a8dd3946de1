//! Some coordinates of a space, the others held still.

use crate::edge::{Blocked, EdgeChecker, Obstruction};
use crate::space::Space;

/// Motions of some coordinates of a larger checker: the arm of a mobile robot, or all joints but the fingers.
pub struct Subspace<'c, C: ?Sized> {
    whole: &'c mut C,
    space: Space,
    coordinates: Vec<usize>,
    /// What the other coordinates hold.
    rest: Vec<f64>,
}

impl<'c, C: EdgeChecker + ?Sized> Subspace<'c, C> {
    /// Motions of `coordinates` (positions in the larger space, in the order wanted) with the others as in `rest`, a
    /// state of the larger space.
    pub fn new(whole: &'c mut C, coordinates: &[usize], rest: &[f64]) -> Self {
        let axes = coordinates.iter().map(|&i| whole.space().axes()[i]).collect();
        Self { whole, space: Space::new(axes), coordinates: coordinates.to_vec(), rest: rest.to_vec() }
    }

    /// The larger checker.
    pub fn whole(&mut self) -> &mut C {
        self.whole
    }

    /// The state of the larger space.
    pub fn embed(&self, q: &[f64]) -> Vec<f64> {
        let mut all = self.rest.clone();
        for (&i, &x) in self.coordinates.iter().zip(q) {
            all[i] = x;
        }
        all
    }

    /// The coordinates of a state of the larger space.
    pub fn select(&self, all: &[f64]) -> Vec<f64> {
        self.coordinates.iter().map(|&i| all[i]).collect()
    }
}

impl<C: EdgeChecker + ?Sized> EdgeChecker for Subspace<'_, C> {
    fn space(&self) -> &Space {
        &self.space
    }

    fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction> {
        let all = self.embed(q);
        self.whole.state(&all)
    }

    fn travel(&self, difference: &[f64]) -> f64 {
        let mut all = vec![0.0; self.rest.len()];
        for (&i, &d) in self.coordinates.iter().zip(difference) {
            all[i] = d;
        }
        self.whole.travel(&all)
    }

    fn resolution(&self) -> f64 {
        self.whole.resolution()
    }

    fn edge(&mut self, from: &[f64], to: &[f64]) -> Result<(), Blocked> {
        let (from, to) = (self.embed(from), self.embed(to));
        self.whole.edge(&from, &to)
    }

    fn describe(&self, obstruction: Obstruction) -> String {
        self.whole.describe(obstruction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toy::Toy;

    #[test]
    fn a_line_in_the_plane() {
        let mut toy = Toy::wall(0.05);
        let mut line = Subspace::new(&mut toy, &[1], &[4.5, 0.0]);
        assert_eq!(line.space().dimension(), 1);
        assert_eq!((line.embed(&[3.0]), line.select(&[4.5, 3.0])), (vec![4.5, 3.0], vec![3.0]));
        assert!(line.state(&[5.0]).is_err() && line.state(&[9.5]).is_ok());
        assert!(line.edge(&[9.2], &[9.9]).is_ok() && line.edge(&[9.2], &[8.0]).is_err());
        assert_eq!(line.travel(&[2.0]), 2.0);
    }
}
