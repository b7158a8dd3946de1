//! Continua of solutions: where axes line up, joints can move together without moving the tip.

/// How the joints of a family move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FamilyPath {
    /// Along a straight line: `solution + t * direction` reaches the pose for every `t` of the interval.
    Line,
    /// Along a curve that starts in this direction; `t` is how far the leading joint, the one whose entry is 1, has moved.
    Curve,
}

/// Infinitely many solutions through one.
#[derive(Debug, Clone, PartialEq)]
pub struct IkFamily {
    /// Which solution represents it: its position among the solutions.
    pub solution: usize,
    /// Which joints move together: an entry for each variable, 0 for those that stay, 1 for the leading one, radians or metres.
    pub direction: Vec<f64>,
    /// Whether that is all.
    pub path: FamilyPath,
    /// Smallest and largest `t`, zero inside; a turn from -pi to pi when the family closes. Limits are not applied.
    pub interval: [f64; 2],
}

impl IkFamily {
    /// The joint that leads.
    pub fn leader(&self) -> usize {
        self.direction.iter().position(|d| *d == 1.0).unwrap_or(0)
    }
}
