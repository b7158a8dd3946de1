//! A point among boxes.

use robotc_planning::problem::PlanningProblem;
use robotc_planning::{EdgeChecker, Obstruction, Space};

/// Names, lower and upper corners.
const BOXES: [(&str, [f64; 2], [f64; 2]); 3] = [
    ("the wall", [4.0, 0.0], [5.0, 7.0]),
    ("the shelf", [0.0, 8.5], [3.0, 9.0]),
    ("the pillar", [6.5, 6.5], [7.5, 7.5]),
];

/// The plane of a problem: its limits, its margin, its resolution.
pub(crate) struct Plane {
    space: Space,
    margin: f64,
    resolution: f64,
    /// States looked at so far.
    pub(crate) looked: u64,
}

impl Plane {
    pub(crate) fn new(problem: &PlanningProblem) -> Self {
        Self { space: problem.space(), margin: problem.margin, resolution: problem.resolution, looked: 0 }
    }
}

impl EdgeChecker for Plane {
    fn space(&self) -> &Space {
        &self.space
    }

    fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction> {
        self.looked += 1;
        if !self.space.contains(q) {
            return Err(Obstruction::Bounds);
        }
        let mut room = f64::INFINITY;
        for (number, (_, low, high)) in BOXES.iter().enumerate() {
            let gap = |i: usize| (low[i] - q[i]).max(q[i] - high[i]).max(0.0);
            let distance = gap(0).hypot(gap(1)) - self.margin;
            if distance <= 0.0 {
                return Err(Obstruction::Contact(number as u32));
            }
            room = room.min(distance);
        }
        // Clearance lets edge checks skip what cannot collide.
        Ok(room)
    }

    fn travel(&self, difference: &[f64]) -> f64 {
        difference[0].hypot(difference[1])
    }

    fn resolution(&self) -> f64 {
        self.resolution
    }

    fn describe(&self, obstruction: Obstruction) -> String {
        match obstruction {
            Obstruction::Contact(number) => {
                let name = BOXES.get(number as usize).map_or("something", |(name, ..)| name);
                format!("the point touches {name}")
            }
            Obstruction::Bounds => "the edge of the plane".into(),
            Obstruction::Constraint => "the path constraint".into(),
        }
    }
}
