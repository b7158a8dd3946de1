//! Poses over time.

use robotc_core::Pose;

/// Pose changes below this do not show: metres, or radians.
const STILL: f64 = 1e-6;
/// Times closer than this are one, seconds.
const ROUNDING: f64 = 1e-9;

/// A pose at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampled {
    /// Seconds.
    pub time: f64,
    /// `parent_from_node`.
    pub pose: Pose,
}

/// `parent_from_node` over time: linear in position, shortest arc in rotation between samples, constant outside them.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    rest: Pose,
    samples: Vec<Sampled>,
}

impl Track {
    /// A node that stays where it is.
    pub fn still(pose: Pose) -> Self {
        Self { rest: pose, samples: Vec::new() }
    }

    /// Samples in strictly increasing time; empty for a node never told to move.
    pub fn samples(&self) -> &[Sampled] {
        &self.samples
    }

    /// Whether the pose ever changes.
    pub fn moves(&self) -> bool {
        self.samples.len() > 1
    }

    /// Time of the last sample, seconds.
    pub fn end(&self) -> f64 {
        self.samples.last().map_or(0.0, |s| s.time)
    }

    /// Adds a sample; a second one of the same time replaces the first. Runs of equal poses keep their two ends only.
    ///
    /// Panics when `time` is before the last sample (by more than sums of steps differ by rounding) or not finite: a
    /// recording goes forward.
    pub fn push(&mut self, time: f64, mut pose: Pose) {
        assert!(time.is_finite() && time >= self.end() - ROUNDING, "samples of a track go forward in time");
        let time = time.max(self.end());
        if let Some(last) = self.samples.last()
            && last.pose.rotation.coords.dot(&pose.rotation.coords) < 0.0
        {
            // The same rotation, written so that components can be interpolated one by one.
            pose.rotation = nalgebra::Unit::new_unchecked(-pose.rotation.into_inner());
        }
        if self.samples.last().is_some_and(|last| time - last.time < ROUNDING) {
            self.samples.pop();
        }
        if let [.., a, b] = self.samples[..]
            && same(&a.pose, &b.pose)
            && same(&a.pose, &pose)
        {
            self.samples.pop();
        }
        self.samples.push(Sampled { time, pose });
    }

    /// The pose at a time.
    pub fn at(&self, time: f64) -> Pose {
        let after = self.samples.partition_point(|s| s.time <= time);
        match (after.checked_sub(1).map(|i| self.samples[i]), self.samples.get(after)) {
            (None, None) => self.rest,
            (None, Some(first)) => first.pose,
            (Some(last), None) => last.pose,
            (Some(a), Some(b)) => between(&a.pose, &b.pose, (time - a.time) / (b.time - a.time)),
        }
    }
}

fn same(a: &Pose, b: &Pose) -> bool {
    (a.translation.vector - b.translation.vector).norm() < STILL
        && (a.rotation.coords - b.rotation.coords).norm() < STILL
}

fn between(a: &Pose, b: &Pose, fraction: f64) -> Pose {
    let translation = a.translation.vector.lerp(&b.translation.vector, fraction);
    let rotation = a.rotation.nlerp(&b.rotation, fraction);
    Pose::from_parts(translation.into(), rotation)
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};

    use super::*;

    fn x(metres: f64) -> Pose {
        Pose::translation(metres, 0.0, 0.0)
    }

    #[test]
    fn poses_are_interpolated_and_held_outside() {
        let mut track = Track::still(x(9.0));
        assert_eq!(track.at(3.0), x(9.0));
        track.push(1.0, x(0.0));
        track.push(2.0, x(1.0));
        assert_eq!(track.at(0.0), x(0.0));
        assert!((track.at(1.25).translation.x - 0.25).abs() < 1e-12);
        assert_eq!(track.at(5.0), x(1.0));
    }

    #[test]
    fn a_rest_keeps_its_ends_only() {
        let mut track = Track::still(x(0.0));
        for step in 0..=100 {
            track.push(f64::from(step), x(if step < 50 { 0.0 } else { f64::from(step - 50) }));
        }
        assert_eq!(track.samples().len(), 52);
        assert_eq!(track.at(30.0), x(0.0));
        assert!((track.at(50.5).translation.x - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_second_sample_of_the_same_time_wins() {
        let mut track = Track::still(x(0.0));
        track.push(0.0, x(1.0));
        track.push(0.0, x(2.0));
        assert_eq!((track.samples().len(), track.at(0.0)), (1, x(2.0)));
    }

    #[test]
    fn rotations_take_the_short_way() {
        let turn = |angle: f64| {
            Pose::from_parts(
                Vector3::zeros().into(),
                UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle),
            )
        };
        let mut track = Track::still(Pose::identity());
        track.push(0.0, turn(3.0));
        track.push(1.0, turn(3.4));
        assert!((track.at(0.5).rotation.angle_to(&turn(3.2).rotation)) < 1e-9);
        assert!(track.samples()[0].pose.rotation.coords.dot(&track.samples()[1].pose.rotation.coords) > 0.0);
    }
}
