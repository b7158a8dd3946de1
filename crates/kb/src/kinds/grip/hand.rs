//! A gripper on its own: the links that can touch an object and how its fingers move them, without the arm.

use nalgebra::Vector3;
use robotc_core::Pose;
use robotc_core::geom::ConvexParts;
use robotc_core::ids::{DofIdx, Idx, JointIdx, LinkIdx};
use robotc_core::model::{Drive, JointMotion, Kinematics};
use robotc_core::robot::Gripper;

/// A part of the hand that moves as one.
pub(crate) struct HandLink<'a> {
    /// The link.
    pub(crate) link: LinkIdx,
    /// Its convex parts, in the link frame.
    pub(crate) parts: &'a ConvexParts,
    /// Degrees of freedom of the gripper that move it, positions in [`Gripper::dofs`]; empty: rigid with the palm.
    pub(crate) moved_by: Vec<usize>,
    /// Whether it may touch the object.
    pub(crate) is_finger: bool,
}

/// How a drive moves a link, at most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Travel {
    /// Position in [`Hand::links`].
    pub(crate) link: usize,
    /// Metres that a point of the link moves for one unit of the drive, at most.
    pub(crate) most_speed: f64,
    /// Metres for one unit squared by which the velocity of a point changes, at most.
    pub(crate) most_acceleration: f64,
}

/// The links rigid with or below the palm that have geometry.
pub(crate) struct Hand<'a> {
    kinematics: &'a Kinematics,
    gripper: &'a Gripper,
    /// Links with geometry: palm side first, then fingers, ascending link index in each.
    pub(crate) links: Vec<HandLink<'a>>,
    /// How to reach every link below the palm from its parent: position of the parent, joint, position of the child.
    walk: Vec<(usize, JointIdx, usize)>,
    /// Palm-relative pose slots: one for each entry of `slot_of`.
    slots: usize,
    slot_of: Vec<usize>,
    rigid: Vec<(usize, Pose)>,
    /// For each degree of freedom of the gripper.
    travels: Vec<Vec<Travel>>,
    jaws: Vec<Option<Jaws>>,
}

/// The finger links of a drive that close towards each other.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Jaws {
    /// Unit vector from the second side to the first, palm frame.
    pub(crate) axis: Vector3<f64>,
    /// Links of either side, positions in [`Hand::links`]. All links of a linkage that swings as one finger are on its side.
    pub(crate) sides: [Vec<usize>; 2],
}

impl<'a> Hand<'a> {
    /// The hand of `gripper`; `parts_of` gives the convex parts of a link (empty when it has none).
    pub(crate) fn new(
        kinematics: &'a Kinematics,
        gripper: &'a Gripper,
        parts_of: impl Fn(LinkIdx) -> Option<&'a ConvexParts>,
    ) -> Self {
        let model = kinematics.model();
        let subtree = model.subtree(gripper.palm);
        let mut slots: Vec<LinkIdx> = subtree.clone();
        let mut walk = Vec::new();
        for (child, &link) in subtree.iter().enumerate().skip(1) {
            let joint = model.links()[link].parent_joint.expect("links below the palm have a parent joint");
            let parent = model.joints()[joint].parent;
            let parent =
                subtree.iter().position(|&l| l == parent).expect("a subtree is closed under parents");
            walk.push((parent, joint, child));
        }
        // Links above the palm but rigid with it (a flange, a force sensor) can touch as well.
        let neutral = robotc_core::Configuration::neutral(model);
        let root_from_palm = kinematics.root_from_link(&neutral, gripper.palm);
        let mut rigid = Vec::new();
        for link in model.rigid_group(gripper.palm) {
            if !subtree.contains(&link) {
                rigid.push((
                    slots.len(),
                    root_from_palm.inverse() * kinematics.root_from_link(&neutral, link),
                ));
                slots.push(link);
            }
        }
        let mut links = Vec::new();
        let mut slot_of = Vec::new();
        for (slot, &link) in slots.iter().enumerate() {
            let Some(parts) = parts_of(link).filter(|p| !p.is_empty()) else { continue };
            let moved_by = gripper
                .dofs
                .iter()
                .enumerate()
                .filter(|(_, dof)| moves(kinematics, **dof, link))
                .map(|(i, _)| i)
                .collect();
            links.push(HandLink { link, parts, moved_by, is_finger: gripper.fingers.contains(&link) });
            slot_of.push(slot);
        }
        let mut hand = Self {
            kinematics,
            gripper,
            links,
            walk,
            slots: slots.len(),
            slot_of,
            rigid,
            travels: Vec::new(),
            jaws: Vec::new(),
        };
        for finger in 0..gripper.dofs.len() {
            let moved = (0..hand.links.len()).filter(|&i| hand.links[i].moved_by.contains(&finger));
            hand.travels.push(moved.map(|link| hand.travel(link, finger)).collect());
            let directions = hand.directions(finger);
            hand.jaws.push(Jaws::of(&directions).or_else(|| hand.against_fixed(&directions)));
        }
        hand
    }

    /// The gripper this is the hand of.
    pub(crate) fn gripper(&self) -> &Gripper {
        self.gripper
    }

    /// `palm_from_link` of each of `links` when the fingers have these values (in the order of [`Gripper::dofs`]).
    pub(crate) fn palm_from_links(&self, values: &[f64]) -> Vec<Pose> {
        let palm_from = self.palm_from_slots(values);
        self.slot_of.iter().map(|&slot| palm_from[slot]).collect()
    }

    fn palm_from_slots(&self, values: &[f64]) -> Vec<Pose> {
        let model = self.kinematics.model();
        let mut palm_from = vec![Pose::identity(); self.slots];
        for &(parent, joint, child) in &self.walk {
            let value = match model.joints()[joint].drive {
                Drive::Fixed => 0.0,
                Drive::Dof(dof) => self.value_of(dof, values),
                Drive::Mimic { dof, multiplier, offset } => multiplier * self.value_of(dof, values) + offset,
            };
            palm_from[child] = palm_from[parent] * self.kinematics.parent_from_child(joint, value);
        }
        for (slot, pose) in &self.rigid {
            palm_from[*slot] = *pose;
        }
        palm_from
    }

    /// How each of `links` moves for one unit of a degree of freedom: turning velocity, and the velocity of the point of it that
    /// is at the palm's origin; both in the palm frame.
    pub(crate) fn twists(&self, values: &[f64], finger: usize) -> Vec<(Vector3<f64>, Vector3<f64>)> {
        let model = self.kinematics.model();
        let palm_from = self.palm_from_slots(values);
        let dof = self.gripper.dofs[finger];
        let mut twists = vec![(Vector3::zeros(), Vector3::zeros()); self.slots];
        for &(parent, joint, child) in &self.walk {
            twists[child] = twists[parent];
            let factor = self.factor(joint, dof);
            if factor == 0.0 {
                continue;
            }
            // A joint's axis stands still in the child's frame.
            let axis = palm_from[child].rotation * model.joints()[joint].unit_axis().into_inner() * factor;
            if model.joints()[joint].motion == JointMotion::Prismatic {
                twists[child].1 += axis;
            } else {
                twists[child].0 += axis;
                twists[child].1 -= axis.cross(&palm_from[child].translation.vector);
            }
        }
        self.slot_of.iter().map(|&slot| twists[slot]).collect()
    }

    /// How many units a joint moves for one unit of a degree of freedom.
    fn factor(&self, joint: JointIdx, dof: DofIdx) -> f64 {
        match self.kinematics.model().joints()[joint].drive {
            Drive::Dof(d) if d == dof => 1.0,
            Drive::Mimic { dof: d, multiplier, .. } if d == dof => multiplier,
            _ => 0.0,
        }
    }

    /// Degrees of freedom outside of the gripper stay where the model is neutral.
    fn value_of(&self, dof: DofIdx, values: &[f64]) -> f64 {
        match self.gripper.dofs.iter().position(|&d| d == dof) {
            Some(i) => values[i],
            None => {
                let d = &self.kinematics.model().dofs()[dof];
                0.0_f64.clamp(d.lower, d.upper)
            }
        }
    }

    /// Range of a finger value, in the order of [`Gripper::dofs`].
    pub(crate) fn range(&self, finger: usize) -> (f64, f64) {
        self.kinematics.model().dofs()[self.gripper.dofs[finger]].sampling_range()
    }

    /// How a degree of freedom moves the links that it moves.
    pub(crate) fn travels(&self, finger: usize) -> &[Travel] {
        &self.travels[finger]
    }

    /// The links that one drive closes towards each other; `None` when they all go the same way, or it closes nothing.
    pub(crate) fn jaws(&self, finger: usize) -> Option<&Jaws> {
        self.jaws[finger].as_ref()
    }

    /// Bounds over all finger values. With joints of factors f below each other, no point is farther from an axis than the
    /// bones between them and its link's size make possible; velocities add up along the chain, and each turn bends
    /// the velocities that those below it cause.
    fn travel(&self, link: usize, finger: usize) -> Travel {
        let model = self.kinematics.model();
        let dof = self.gripper.dofs[finger];
        let mut distance = self.links[link].parts.points().map(|p| p.coords.norm()).fold(0.0, f64::max);
        let (mut turn, mut slide, mut most_speed) = (0.0, 0.0, 0.0);
        let mut at = self.links[link].link;
        while at != self.gripper.palm {
            let Some(j) = model.links()[at].parent_joint else { break };
            let joint = &model.joints()[j];
            let factor = self.factor(j, dof).abs();
            if joint.motion == JointMotion::Prismatic {
                let (low, high) = self.prismatic_range(j);
                distance += low.abs().max(high.abs());
                slide += factor;
                most_speed += factor;
            } else {
                turn += factor;
                most_speed += factor * distance;
            }
            distance += joint.parent_from_joint().translation.vector.norm();
            at = joint.parent;
        }
        let most_acceleration = turn * turn * distance + 2.0 * turn * slide;
        Travel { link, most_speed, most_acceleration }
    }

    /// How far a sliding joint of the hand can go.
    fn prismatic_range(&self, joint: JointIdx) -> (f64, f64) {
        let model = self.kinematics.model();
        let range = |dof: DofIdx| model.dofs()[dof].sampling_range();
        match model.joints()[joint].drive {
            Drive::Fixed => (0.0, 0.0),
            Drive::Dof(dof) => range(dof),
            Drive::Mimic { dof, multiplier, offset } => {
                let (low, high) = range(dof);
                (multiplier * low + offset, multiplier * high + offset)
            }
        }
    }

    /// Finger links of a drive with the direction in which they close, palm frame, at the middle of the range.
    fn directions(&self, finger: usize) -> Vec<(usize, Vector3<f64>)> {
        let (low, high) = self.range(finger);
        let sign = self.gripper.closing[finger].signum();
        if self.gripper.closing[finger] == 0.0 || !(high - low).is_finite() {
            return Vec::new();
        }
        let mut values = self.gripper.preshapes[0].values.clone();
        values[finger] = 0.5 * (low + high);
        let before = self.palm_from_links(&values);
        values[finger] += sign * 0.01 * (high - low);
        let after = self.palm_from_links(&values);
        (0..self.links.len())
            .filter(|&i| self.links[i].is_finger && self.links[i].moved_by.contains(&finger))
            .filter_map(|i| {
                let centre = self.links[i].parts.bounds()?.centre();
                let moved = after[i] * centre - before[i] * centre;
                Some((i, moved.try_normalize(1e-12)?))
            })
            .collect()
    }
}

impl Hand<'_> {
    /// A jaw that closes against fingers that nothing moves, as the only drive of its hand.
    fn against_fixed(&self, directions: &[(usize, Vector3<f64>)]) -> Option<Jaws> {
        let fixed = self.gripper.fixed_jaw(self.kinematics.model());
        let fixed: Vec<usize> =
            (0..self.links.len()).filter(|&i| fixed.contains(&self.links[i].link)).collect();
        let closing: Vector3<f64> = directions.iter().map(|(_, closing)| *closing).sum();
        let axis = -closing.try_normalize(1e-6).filter(|_| !fixed.is_empty())?;
        Some(Jaws { axis, sides: [directions.iter().map(|(link, _)| *link).collect(), fixed] })
    }
}

/// Links close against each other when the angle between their directions is larger than this (cosine).
const AGAINST: f64 = -0.5;

impl Jaws {
    /// From the directions in which links close.
    fn of(directions: &[(usize, Vector3<f64>)]) -> Option<Self> {
        let pairs = directions
            .iter()
            .enumerate()
            .flat_map(|(i, (_, a))| directions[..i].iter().map(move |(_, b)| (b.dot(a), b - a)));
        let (cosine, difference) = pairs.min_by(|(a, _), (b, _)| a.total_cmp(b))?;
        if cosine >= AGAINST {
            return None;
        }
        // The first side closes against the axis that points to it.
        let axis = -difference.normalize();
        let side = |sign: f64| {
            let on_it = directions.iter().filter(|(_, closing)| sign * closing.dot(&axis) < 0.0);
            on_it.map(|(link, _)| *link).collect()
        };
        Some(Self { axis, sides: [side(1.0), side(-1.0)] })
    }
}

/// Whether `dof` moves `link`, directly or through a joint that mimics it.
fn moves(kinematics: &Kinematics, dof: DofIdx, link: LinkIdx) -> bool {
    kinematics.model().dofs_moving(link).iter().any(|d| d.index() == dof.index())
}
