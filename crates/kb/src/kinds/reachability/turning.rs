//! An arm and its first axis: what a turn about it changes.

use std::collections::BTreeMap;

use nalgebra::{Point3, Vector3};
use robotc_core::geom::any_within;
use robotc_core::ids::LinkIdx;
use robotc_core::{Configuration, LinkPoses, Pose};

use super::arm::{ArmAlone, Scratch};
use super::azimuth::Sectors;

/// An arm whose first joint turns, seen from the axis of that joint.
pub(super) struct Turning<'a> {
    arm: &'a ArmAlone,
    /// A point on the axis, and its direction, in the frame of the mechanism's root.
    origin: Point3<f64>,
    direction: Vector3<f64>,
    /// For each link that stays with the base: farthest point from the axis, lowest and highest along it.
    envelopes: BTreeMap<LinkIdx, [f64; 3]>,
}

/// What is known of a pose and all that it becomes by a turn about the first axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Azimuths {
    /// Sectors in which it is reached at every azimuth.
    pub(super) whole: Sectors,
    /// Sectors in which it is reached at some azimuth.
    pub(super) part: Sectors,
}

impl<'a> Turning<'a> {
    /// The axis of an arm.
    pub(super) fn new(arm: &'a ArmAlone) -> Self {
        let mut poses = LinkPoses::default();
        arm.kinematics.link_poses(&Configuration::neutral(arm.kinematics.model()), &mut poses);
        let first = poses.root_from(arm.base) * arm.chain.joints[0].previous_from_joint;
        let origin = Point3::from(first.translation.vector);
        let direction = first.rotation * arm.chain.joints[0].axis.into_inner();
        let mut envelopes = BTreeMap::new();
        for &(fixed, _) in &arm.against_base {
            let mut envelope = [0.0, f64::INFINITY, f64::NEG_INFINITY];
            for point in arm.links[fixed].points() {
                let from_origin = poses.root_from(fixed) * point - origin;
                let height = from_origin.dot(&direction);
                let distance = (from_origin - direction * height).norm();
                envelope = [envelope[0].max(distance), envelope[1].min(height), envelope[2].max(height)];
            }
            envelopes.insert(fixed, envelope);
        }
        Self { arm, origin, direction, envelopes }
    }

    /// Adds the azimuths, turned by which about the first axis one of `solutions` reaches a pose without self-collision; says
    /// whether one does at any azimuth, as far as it was looked at. Of the sectors as a whole only those in `needed` are
    /// looked for; with `count`, something is looked for even if it adds nothing.
    pub(super) fn add<'s>(
        &self,
        solutions: impl Iterator<Item = &'s [f64]>,
        needed: Sectors,
        count: bool,
        found: &mut Azimuths,
        scratch: &mut Scratch,
    ) -> bool {
        let mut joints = std::mem::take(&mut scratch.joints);
        let mut reached = false;
        for solution in solutions {
            if !self.arm.within_limits(solution, 1, &mut joints) {
                continue;
            }
            let (whole, part) = self.turns(joints[0]);
            let whole = whole.and(needed);
            let adds = !found.whole.contains(whole) || !found.part.contains(part);
            // Only what adds to what is known is worth a collision test.
            if !adds && (reached || !count) {
                continue;
            }
            let free_of = self.free_azimuths(&joints, part, scratch);
            reached |= !free_of.is_empty();
            found.whole = found.whole.or(whole.and(free_of));
            found.part = found.part.or(part.and(free_of));
        }
        scratch.joints = joints;
        reached
    }

    /// The azimuths, turned by which about the first axis one joint vector reaches its pose.
    pub(super) fn azimuths_of(&self, joints: &[f64], scratch: &mut Scratch) -> Sectors {
        let (_, part) = self.turns(joints[0]);
        self.free_azimuths(joints, part, scratch)
    }

    /// The azimuths that the first joint's limits leave to a solution with this value at azimuth zero, as a whole and in
    /// parts.
    pub(super) fn turns(&self, first: f64) -> (Sectors, Sectors) {
        let limits = &self.arm.chain.variables[0];
        if !(limits.lower.is_finite() && limits.upper.is_finite()) {
            return (Sectors::ALL, Sectors::ALL);
        }
        Sectors::of_arc(limits.lower - first, limits.upper - limits.lower)
    }

    /// Those of `wanted` azimuths, turned by which about the first axis the arm does not touch itself or its base. Touching
    /// the base is tested at the centre of each sector.
    fn free_azimuths(&self, joints: &[f64], wanted: Sectors, scratch: &mut Scratch) -> Sectors {
        self.arm.pose(joints, scratch);
        let poses = &scratch.poses;
        if self.arm.touch(&self.arm.together, poses) {
            return Sectors::NONE;
        }
        let near: Vec<_> =
            self.arm.against_base.iter().copied().filter(|&(b, m)| self.near_base(b, m, poses)).collect();
        if near.is_empty() {
            return wanted;
        }
        let (origin, direction) = (self.origin, self.direction);
        let axis = nalgebra::Unit::new_unchecked(direction);
        let mut free = Sectors::NONE;
        for (sector, azimuth) in wanted.centres() {
            // It is the base that turns back, so that the arm needs no forward kinematics.
            let back = nalgebra::UnitQuaternion::from_axis_angle(&axis, -azimuth);
            let touches = near.iter().any(|&(b, m)| {
                let turned = Pose::from_parts((origin - back * origin).into(), back) * poses.root_from(b);
                any_within(&self.arm.links[b], &turned, &self.arm.links[m], poses.root_from(m), 0.0)
            });
            if !touches {
                free = free.or(sector);
            }
        }
        free
    }

    /// Whether a link gets to where a link of the base would be if it were turned all round the first axis.
    fn near_base(&self, fixed: LinkIdx, moved: LinkIdx, poses: &LinkPoses) -> bool {
        let [widest, lowest, highest] = self.envelopes[&fixed];
        let (origin, direction) = (self.origin, self.direction);
        self.arm.links[moved].iter().any(|part| {
            let (centre, radius) = part.bounding_sphere();
            let from_origin = poses.root_from(moved) * centre - origin;
            let height = from_origin.dot(&direction);
            let distance = (from_origin - direction * height).norm();
            distance - radius <= widest && height + radius >= lowest && height - radius <= highest
        })
    }
}
