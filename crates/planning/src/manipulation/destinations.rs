//! The poses that an object may be put in, as a list to try in order.

use std::f64::consts::TAU;

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use robotc_core::Pose;
use robotc_core::rng::Rng;
use robotc_core::task::Destination;

/// Turns tried when any turn about the vertical is as good.
const TURNS: usize = 16;

/// At most `count` poses `world_from_object` that satisfy `destination`.
///
/// A given pose comes first, then its turns spread ever more finely; poses of a region are random.
pub fn destination_poses(destination: &Destination, count: usize, rng: &mut Rng) -> Vec<Pose> {
    match destination {
        Destination::Pose { world_from_object, any_yaw: false } => vec![*world_from_object],
        Destination::Pose { world_from_object, any_yaw: true } => {
            let turned = |k: usize| {
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), TAU * bit_reversed(k));
                Pose::from_parts(world_from_object.translation, turn * world_from_object.rotation)
            };
            (0..TURNS.min(count)).map(turned).collect()
        }
        Destination::Region { world_from_region, size, origin_height } => (0..count)
            .map(|_| {
                let (x, y) = (rng.range(-0.5, 0.5) * size[0], rng.range(-0.5, 0.5) * size[1]);
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), rng.range(0.0, TAU));
                world_from_region * Pose::from_parts(Translation3::new(x, y, *origin_height), turn)
            })
            .collect(),
    }
}

/// The binary digits of `k` behind the point, lowest first: 0, 1/2, 1/4, 3/4, 1/8 …
fn bit_reversed(mut k: usize) -> f64 {
    let (mut value, mut digit) = (0.0, 0.5);
    while k > 0 {
        if k % 2 == 1 {
            value += digit;
        }
        digit *= 0.5;
        k /= 2;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;
    use robotc_core::Seed;

    #[test]
    fn turns_start_with_the_pose_itself_and_are_all_different() {
        let world_from_object = Pose::translation(1.0, 2.0, 3.0);
        let destination = Destination::Pose { world_from_object, any_yaw: true };
        let poses = destination_poses(&destination, 99, &mut Seed::new(1).rng());
        assert_eq!(poses.len(), TURNS);
        assert_eq!(poses[0], world_from_object);
        for (i, a) in poses.iter().enumerate() {
            assert_eq!(a.translation, world_from_object.translation);
            assert!(poses[..i].iter().all(|b| a.rotation.angle_to(&b.rotation) > 0.99 * TAU / TURNS as f64));
        }
    }

    #[test]
    fn region_poses_are_inside_and_upright() {
        let world_from_region = Pose::translation(1.0, 0.0, 0.5);
        let destination = Destination::Region { world_from_region, size: [0.2, 0.4], origin_height: 0.05 };
        let poses = destination_poses(&destination, 50, &mut Seed::new(1).rng());
        assert_eq!(poses.len(), 50);
        for pose in poses {
            let p = (world_from_region.inverse() * pose).translation;
            assert!(p.x.abs() <= 0.1 && p.y.abs() <= 0.2);
            assert!((pose.translation.z - 0.55).abs() < 1e-12);
            assert!(((pose.rotation * Vector3::z()).z - 1.0).abs() < 1e-12);
        }
    }
}
