//! Bodies of revolution about z.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Point3, Vector2};
use robotc_core::model::TriMesh;

use super::{Ring, circle, skin};

/// A corner of a profile: radius, height, and the radius it is rounded with.
pub(crate) type Corner = [f64; 3];

/// Roundings up to this radius, metres, become a bevel.
const SMALL: f64 = 0.0045;

/// Turns a profile about z. Corners run from the bottom to the top along the outside (and on along the inside, for
/// a hollow body); a corner of radius zero lies on the axis.
pub(crate) fn lathe(profile: &[Corner], around: usize) -> TriMesh {
    let rings: Vec<Ring> = rounded(profile)
        .into_iter()
        .map(|p| circle(around).map(|[c, s]| Point3::new(p.x * c, p.x * s, p.y)).collect())
        .collect();
    skin(&rings)
}

/// A cylinder along z from `low` to `high` with rounded rims.
pub(crate) fn drum(radius: f64, low: f64, high: f64, rim: f64) -> TriMesh {
    lathe(&[[0.0, low, 0.0], [radius, low, rim], [radius, high, rim], [0.0, high, 0.0]], 24)
}

/// The profile with each corner replaced by an arc.
fn rounded(profile: &[Corner]) -> Vec<Vector2<f64>> {
    let point = |c: &Corner| Vector2::new(c[0], c[1]);
    let mut points = Vec::new();
    for (i, corner) in profile.iter().enumerate() {
        let at = point(corner);
        if i == 0 || i + 1 == profile.len() || corner[2] <= 0.0 {
            points.push(at);
            continue;
        }
        let before = (point(&profile[i - 1]) - at).normalize();
        let after = (point(&profile[i + 1]) - at).normalize();
        let half_angle = libm::acos(before.dot(&after).clamp(-1.0, 1.0)) / 2.0;
        let from = at + before * (corner[2] / libm::tan(half_angle));
        let centre = at + (before + after).normalize() * (corner[2] / libm::sin(half_angle));
        let turn = -2.0 * (FRAC_PI_2 - half_angle) * before.perp(&after).signum();
        let steps = if corner[2] > SMALL { 3 } else { 1 };
        for step in 0..=steps {
            let angle = turn * f64::from(step) / f64::from(steps);
            let (s, c) = (libm::sin(angle), libm::cos(angle));
            let r = from - centre;
            points.push(centre + Vector2::new(c * r.x - s * r.y, s * r.x + c * r.y));
        }
    }
    points
}
