//! How far points are from what stands around: good enough to order things by.

use nalgebra::Point3;
use robotc_core::BodyIdx;

use super::Scene;

impl Scene {
    /// Distance, metres, of a point from the nearest body but `beside`, at most `limit`.
    ///
    /// It is measured to the boxes around convex parts and around lumps of piles, along the axes of each: never too large, and zero in
    /// the corner of a box that its part does not fill.
    pub(crate) fn room_about(&self, point_in_world: &Point3<f64>, beside: BodyIdx, limit: f64) -> f64 {
        let mut room = limit;
        for (index, body) in self.bodies.enumerate() {
            if index == beside || body.shape.is_empty() {
                continue;
            }
            let point = body.body_from_world * point_in_world;
            if body.shape.bounds.distance_to(&point) < room {
                let parts = body.shape.parts.iter().map(|part| part.bounds.distance_to(&point));
                room = parts.fold(room, f64::min);
                for pile in &body.shape.piles {
                    pile.pile.walk(&(pile.body_from_pile.inverse() * point), |lump, leaf| {
                        let gap = lump.bounds().distance_to(&(pile.body_from_pile.inverse() * point));
                        let nearer = gap < room;
                        if nearer && leaf {
                            room = gap;
                        }
                        nearer
                    });
                }
            }
        }
        room
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testbed;
    use robotc_core::ids::Idx;

    #[test]
    fn room_ends_at_the_nearest_other_body() {
        let robot = testbed::robot(false);
        let scene =
            testbed::scene(&robot, &[([0.2, 0.2, 0.2], [1.0, 0.0, 0.0]), ([0.2, 0.2, 0.2], [2.0, 0.0, 0.0])]);
        let [near, far] = [0, 1].map(BodyIdx::new);
        let gap = |x: f64, beside, limit| scene.room_about(&Point3::new(x, 0.0, 0.0), beside, limit);
        let half = scene.bodies[near].shape.bounds.high.x;
        assert!((gap(1.4, far, 1.0) - (0.4 - half)).abs() < 1e-12);
        assert!((gap(1.4, near, 1.0) - (0.6 - half)).abs() < 1e-12);
        assert_eq!(gap(1.4, far, 0.05), 0.05);
        assert_eq!(gap(1.0, far, 1.0), 0.0, "inside");
    }
}
