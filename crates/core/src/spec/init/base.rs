//! Guesses how a robot stands.

use super::arms::below_planar_joints;
use super::bodies::{Bodies, WHEEL};
use crate::geom::Aabb;
use crate::model::{Configuration, Kinematics};
use crate::robot::Base;
use crate::spec::extent::extent;

/// Edge of the outline where no shape tells; metres.
const UNKNOWN_EDGE: f64 = 0.5;

/// Planar when the root has planar joints or wheels, else fixed.
pub(super) fn guess(bodies: &Bodies, kinematics: &Kinematics) -> Base {
    let start = below_planar_joints(bodies);
    let wheels: Vec<usize> = (1..bodies.all.len()).filter(|&b| bodies.mentions(b, WHEEL)).collect();
    if start == 0 && wheels.len() < 2 {
        return Base::Fixed;
    }
    let q = Configuration::neutral(bodies.model);
    let links = bodies.all[start].links.iter().chain(wheels.iter().flat_map(|&w| &bodies.all[w].links));
    let bounds = links
        .filter_map(|&link| {
            let shapes = &bodies.model.links()[link];
            let shapes = if shapes.collisions.is_empty() { &shapes.visuals } else { &shapes.collisions };
            extent(shapes, &kinematics.root_from_link(&q, link))
        })
        .reduce(|a: Aabb, b| a.union(&b));
    let half = UNKNOWN_EDGE / 2.0;
    let [x0, x1, y0, y1] = match bounds {
        Some(b) if b.size().x > 0.01 && b.size().y > 0.01 => {
            let outwards = |low: f64, high: f64| ((low * 1e3).floor() / 1e3, (high * 1e3).ceil() / 1e3);
            let ((x0, x1), (y0, y1)) = (outwards(b.low.x, b.high.x), outwards(b.low.y, b.high.y));
            [x0, x1, y0, y1]
        }
        _ => [-half, half, -half, half],
    };
    let footprint = vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
    Base::Planar { footprint, holonomic: start != 0, joints: None }
}
