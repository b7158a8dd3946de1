//! A plan as one table of joint values over time, for controllers and spreadsheets.

use std::fmt::Write as _;

use robotc_core::{Configuration, DofIdx, RobotModel};
use robotc_planning::manipulation::Plan;
use serde::Serialize;

/// Joint values over time: a row for each time, a column for each joint that moves. Radians or metres, seconds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MotionTable {
    /// Joint names, in the order of the columns.
    pub names: Vec<String>,
    /// Seconds from the start, growing.
    pub times: Vec<f64>,
    /// A row for each time.
    pub positions: Vec<Vec<f64>>,
    /// The same, per second.
    pub velocities: Vec<Vec<f64>>,
    /// The same, per second squared.
    pub accelerations: Vec<Vec<f64>>,
}

impl MotionTable {
    /// All segments of a plan, one after the other, from `start` on: the knots of their trajectories. Joints that a
    /// segment does not move keep their values.
    pub fn of(model: &RobotModel, start: &Configuration, plan: &Plan) -> Self {
        let mut moving: Vec<DofIdx> =
            plan.segments.iter().flat_map(|s| s.trajectory.dofs().to_vec()).collect();
        moving.sort();
        moving.dedup();
        let mut table = Self {
            names: moving.iter().map(|&d| model.dofs()[d].name.clone()).collect(),
            times: Vec::new(),
            positions: Vec::new(),
            velocities: Vec::new(),
            accelerations: Vec::new(),
        };
        let mut q = start.clone();
        let mut elapsed = 0.0;
        for (number, segment) in plan.segments.iter().enumerate() {
            let trajectory = &segment.trajectory;
            for (k, (time, knot)) in trajectory.times().iter().zip(trajectory.knots()).enumerate() {
                q.set(trajectory.dofs(), &knot.positions);
                // The first knot of a segment repeats the last of the one before.
                if k == 0 && number > 0 {
                    continue;
                }
                let column = |values: &[f64], dof: &DofIdx| {
                    trajectory.dofs().iter().position(|d| d == dof).map_or(0.0, |i| values[i])
                };
                table.times.push(elapsed + time);
                table.positions.push(q.select(&moving));
                table.velocities.push(moving.iter().map(|d| column(&knot.velocities, d)).collect());
                table.accelerations.push(moving.iter().map(|d| column(&knot.accelerations, d)).collect());
            }
            elapsed += trajectory.duration();
        }
        table
    }

    /// As JSON with the keys `names`, `times`, `positions`, `velocities`, `accelerations`.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).expect("plain numbers always have a JSON form")
    }

    /// As comma-separated values: `time`, then position, velocity and acceleration of each joint.
    pub fn to_csv(&self) -> String {
        let mut text = String::from("time");
        for (what, names) in
            [("position", &self.names), ("velocity", &self.names), ("acceleration", &self.names)]
        {
            names.iter().for_each(|name| text += &format!(",{name}_{what}"));
        }
        text.push('\n');
        for (i, time) in self.times.iter().enumerate() {
            let _ = write!(text, "{time}");
            for values in [&self.positions[i], &self.velocities[i], &self.accelerations[i]] {
                values.iter().for_each(|value| {
                    let _ = write!(text, ",{value}");
                });
            }
            text.push('\n');
        }
        text
    }
}
