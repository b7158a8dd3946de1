//! How much a grasp moves when the object is not where it was thought to be: repeatability (thesis, algorithm 4.1).
//!
//! The object is disturbed and grasped again, many times. The hand of a steady grasp ends up as displaced as the object; that
//! of a fragile one slips, and moves farther. This tells apart what point contacts alone cannot: force closure of the
//! nominal contacts says nothing about an edge that is hit by a hair.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_core::Seed;

use crate::kinds::grip::hand::Hand;

/// How repeatability is tested.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SteadinessOptions {
    /// Largest displacement of any point of the object, metres.
    pub(super) disturbance: f64,
    /// Number of disturbed grasps.
    pub(super) repeats: usize,
    /// A grasp is fragile when this much of its deviation is more than the disturbance.
    pub(super) slip: f64,
}

/// Where the object may really be, as `object_from_disturbed`. A random share of the displacement is a turn about the
/// centre, such that the farthest point moves by that share; the rest is a shift.
pub(super) fn disturbances(
    options: &SteadinessOptions,
    centre: &Point3<f64>,
    farthest: f64,
    seed: Seed,
) -> Vec<Pose> {
    let seed = seed.split("disturbances");
    let one = |i: usize| {
        let mut rng = seed.at(i as u64).rng();
        let share = rng.unit();
        let angle = share * options.disturbance / farthest;
        let turn = UnitQuaternion::from_axis_angle(&rng.direction(), angle);
        let shift = rng.direction().into_inner() * ((1.0 - share) * options.disturbance);
        let about = Translation3::from(centre.coords);
        Translation3::from(shift) * about * Pose::from_parts(Translation3::identity(), turn) * about.inverse()
    };
    (0..options.repeats).map(one).collect()
}

/// Where a hand ended up in one disturbed grasp.
pub(super) struct Regrasp {
    /// Origin of the tool in the undisturbed object frame, which stands still.
    pub(super) tool: Point3<f64>,
    /// Finger values.
    pub(super) closed: Vec<f64>,
}

/// Standard deviation of the tool's position, plus the largest that the finger values cause at any link: deviations of joints
/// times the reach of the link below them, summed along the chain; metres.
pub(super) fn deviation(hand: &Hand, regrasps: &[Regrasp]) -> f64 {
    let count = regrasps.len().max(1) as f64;
    let mean = regrasps.iter().map(|r| r.tool.coords).sum::<Vector3<f64>>() / count;
    let variance = regrasps.iter().map(|r| (r.tool.coords - mean).norm_squared()).sum::<f64>() / count;
    let of_finger = |finger: usize| {
        let mean = regrasps.iter().map(|r| r.closed[finger]).sum::<f64>() / count;
        let variance = regrasps.iter().map(|r| (r.closed[finger] - mean).powi(2)).sum::<f64>() / count;
        variance.sqrt()
    };
    let mut of_links = vec![0.0; hand.links.len()];
    for finger in 0..hand.gripper().dofs.len() {
        let sigma = of_finger(finger);
        for travel in hand.travels(finger) {
            of_links[travel.link] += sigma * travel.most_speed;
        }
    }
    variance.sqrt() + of_links.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_point_moves_farther_than_the_disturbance_and_most_move() {
        let options = SteadinessOptions { disturbance: 0.01, repeats: 200, slip: 0.7 };
        let centre = Point3::new(0.3, 0.1, -0.2);
        let all = disturbances(&options, &centre, 0.08, Seed::new(1));
        assert_eq!(all, disturbances(&options, &centre, 0.08, Seed::new(1)));
        let mut largest: f64 = 0.0;
        for (i, moved) in all.iter().enumerate() {
            let mut rng = Seed::new(2).at(i as u64).rng();
            let p = centre + rng.direction().into_inner() * 0.08;
            let way = (moved * p - p).norm();
            assert!(way <= 0.01 + 1e-12, "{way}");
            largest = largest.max(way);
        }
        assert!(largest > 0.009, "{largest}");
    }
}
