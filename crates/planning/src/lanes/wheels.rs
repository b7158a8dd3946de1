//! A robot on wheels: the same bodies, with three more coordinates that move all of them.

use std::sync::Arc;

use nalgebra::Vector3;
use robotc_core::Pose;

use super::mechanism::{LaneRobot, Step, z_onto};

/// Coordinates of a base that drives: x, y and heading.
const DRIVING: usize = 3;

impl LaneRobot {
    /// The same robot on a base that drives. Its first three coordinates are x and y, metres, from `low` to `high`, and the heading,
    /// radians; the other ones follow. The scene to check it in is one in which it [stands](crate::scene::Scene::standing_at) above the origin of the
    /// world, not turned.
    pub fn on_wheels(&self, (low, high): ([f64; 2], [f64; 2])) -> Self {
        let [along_x, along_y] = [Vector3::x_axis(), Vector3::y_axis()]
            .map(|axis| Pose::from_parts(Default::default(), z_onto(&axis)));
        let mut robot = self.clone();
        robot.steps = vec![
            Step::new(0, 0, 1.0, 0.0, true, along_x),
            Step::new(1, 1, 1.0, 0.0, true, along_x.inv_mul(&along_y)),
            Step::new(2, 2, 1.0, 0.0, false, along_y.inverse()),
        ];
        robot.steps.extend(self.steps.iter().map(|step| Step {
            parent: step.parent + DRIVING,
            column: step.column + DRIVING,
            ..step.clone()
        }));
        let farthest = [0, 1].map(|i| low[i].abs().max(high[i].abs()));
        robot.extents = [&farthest[..], &[0.0], &self.extents].concat();
        robot.carriers.iter_mut().for_each(|(frame, _)| *frame += DRIVING);
        robot.groups.iter_mut().for_each(|group| group.frame += DRIVING);
        for i in 0..robot.bodies.len() {
            let frame = robot.bodies[i].frame + DRIVING;
            let ball = &robot.spheres[robot.bodies[i].spheres.start];
            let [x, y, z] = ball.centre.map(f64::from);
            let (beside, radius) = (x.hypot(y), f64::from(ball.outer));
            robot.bodies[i].frame = frame;
            robot.bodies[i].chain = robot.chain(frame, beside.hypot(z) + radius, beside + radius);
        }
        for pair in &mut robot.pairs {
            pair.closing.iter_mut().chain(&mut pair.between).for_each(|(step, _)| *step += DRIVING);
            pair.apart = pair.apart.take().map(|table| Arc::new(table.behind(DRIVING)));
        }
        // Single precision is worth less far from the origin.
        robot.rounding = robot.rounding() + 1e-6 * (farthest[0] + farthest[1]);
        robot
    }
}
