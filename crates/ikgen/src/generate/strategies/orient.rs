//! Three revolute joints that bring a rotation about.
//!
//! `R4 R5 R6 = R`: the angle between axes 4 and 6 gives two values of `q5`, each of which leaves one of `q4` and `q6`. Where axes 4
//! and 6 are aligned `q4` is free and `q6` makes up for whatever it is.

use nalgebra::Vector3;

use crate::generate::builder::{Builder, Turn, Vector};
use crate::generate::facts::tidy;

/// Cosine of an angle, that between axes 4 and 6 at its least: above this the axes are taken to line up somewhere, if not exactly.
const NEARLY_ALL: f64 = 0.999_99;

/// The turns of three axes with these directions; `rotated` is the wanted rotation of a vector.
pub(super) fn orient<'b>(
    b: &'b Builder,
    names: [&str; 3],
    directions: [&Vector3<f64>; 3],
    rotated: &dyn Fn(Vector<'b>) -> Vector<'b>,
) -> [Turn<'b>; 3] {
    let [h4, h5, h6] = directions.map(|h| b.vector(h));
    let last = rotated(h6);
    b.note("the angle between the first and the last axis of the wrist");
    let q5 = angle_between(b, names[1], directions, last);
    let tilted = h6.turned(h5, q5);
    let tilted = tilted - tilted.along(h4);
    let q4 = b.align(names[0], tilted.dot(last), h4.dot(tilted.cross(last)));
    let side = across(directions[2]);
    let turned = rotated(b.vector(&side)).turned_back(h4, q4).turned_back(h5, q5);
    let q6 =
        b.align(names[2], turned.dot(b.vector(&side)), turned.dot(b.vector(&directions[2].cross(&side))));
    [q4, q5, q6]
}

/// The turns of axis `h5` for which `h4 . R5 h6 = h4 . wanted`.
pub(super) fn angle_between<'b>(
    b: &'b Builder,
    name: &str,
    [h4, h5, h6]: [&Vector3<f64>; 3],
    wanted: Vector<'b>,
) -> Turn<'b> {
    let axis = b.vector(h4);
    let (cos, sin) = (tidy(h4.dot(&(h6 - h5 * h5.dot(h6)))), tidy(h4.dot(&h5.cross(h6))));
    if h4.dot(h5).abs() < 1e-12 && h5.dot(h6).abs() < 1e-12 {
        // All of it turns, so the sine is the length of a cross product: exact near the singularity too.
        let crossed = axis.cross(wanted);
        let t = b.mirror(name, axis.dot(wanted), crossed.square().sqrt());
        return t.plus(Turn { cos: b.constant(cos), sin: b.constant(sin) });
    }
    let still = h4.dot(h5) * h5.dot(h6);
    let swing = libm::hypot(cos, sin);
    if swing > NEARLY_ALL {
        // Differences of vectors keep the digits that cosines lose where the axes line up.
        let fold = |side: f64| {
            let turned = Turn { cos: b.constant(side * cos / swing), sin: b.constant(side * sin / swing) };
            let nearest = b.vector(h6).turned(b.vector(h5), turned);
            ((axis - wanted * b.constant(side)).square() - (axis - nearest * b.constant(side)).square())
                * b.constant(0.5)
        };
        let t = b.mirror(name, axis.dot(wanted) - b.constant(still), (fold(1.0) * fold(-1.0)).sqrt());
        return t.plus(Turn { cos: b.constant(cos / swing), sin: b.constant(sin / swing) });
    }
    let still = b.constant(tidy(still));
    b.circle(name, b.constant(cos), b.constant(sin), axis.dot(wanted) - still)
}

/// A unit vector at a right angle to `h`.
pub(super) fn across(h: &Vector3<f64>) -> Vector3<f64> {
    let other = if h.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    (other - h * h.dot(&other)).normalize().map(tidy)
}
