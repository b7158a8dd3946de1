//! The robot as the lane kernel sees it: moving frames in a row, and on each of them bodies made of spheres.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use nalgebra::{Point3, Rotation3, Unit, UnitQuaternion, Vector3};
use pulp::Simd;
use robotc_core::geom::{ConvexPart, ConvexParts, SphereCover, SphereNode};
use robotc_core::ids::Idx;
use robotc_core::model::{Drive, JointMotion};
use robotc_core::{BodyIdx, Configuration, DofIdx, JointIdx, Kinematics, LinkIdx, Pose, TypedVec};

use super::apart::Apart;
use super::kernel::COARSE;
use super::lane::Lanes;
use super::pile::Question;
use crate::scene::{Grip, Scene};

/// A robot prepared for vectorised checks of motions of some of its degrees of freedom.
#[derive(Debug, Clone)]
pub struct LaneRobot {
    pub(super) steps: Vec<Step>,
    pub(super) bodies: Vec<Body>,
    pub(super) pairs: Vec<Pair>,
    /// Bodies that move as one.
    pub(super) groups: Vec<Group>,
    /// Spheres of all bodies, in the frames that carry them, then those around groups.
    pub(super) spheres: Vec<Sphere>,
    /// For each link, the frame that carries it and where it is in that frame.
    pub(super) carriers: TypedVec<LinkIdx, (usize, Pose)>,
    /// Links of the hand, ascending: they may be asked to touch what the others may not.
    hand: Vec<LinkIdx>,
    /// The body of the scene that the robot holds.
    pub(super) held: Option<BodyIdx>,
    /// For each step, how far it slides at most.
    pub(super) extents: Vec<f64>,
    /// How far rounding can move a computed point at most, metres.
    pub(super) rounding: f64,
}

/// A joint that moves. Frame `i + 1` is the one that step `i` moves; frame 0 is the root of the robot.
#[derive(Debug, Clone)]
pub(super) struct Step {
    /// The frame that it hangs on.
    pub(super) parent: usize,
    /// Which degree of freedom gives its value.
    pub(super) column: usize,
    /// value = factor * degree of freedom + offset
    pub(super) factor: f64,
    pub(super) offset: f64,
    pub(super) slides: bool,
    /// Where the joint is in its parent frame, its axis along z.
    pub(super) parent_from_joint: Pose,
    /// The same in single precision: rows of the rotation, and the translation.
    pub(super) rows: [[f32; 3]; 3],
    pub(super) shift: [f32; 3],
}

/// All bodies on one frame that may touch the same.
#[derive(Debug, Clone)]
pub(super) struct Group {
    pub(super) frame: usize,
    pub(super) bodies: Vec<usize>,
    /// The sphere around all of them.
    pub(super) ball: usize,
}

/// A rigid body of the robot.
#[derive(Debug, Clone)]
pub(super) struct Body {
    /// The link, or `None` for something that is held.
    pub(super) link: Option<LinkIdx>,
    pub(super) frame: usize,
    pub(super) group: usize,
    /// Where the body is in its frame.
    pub(super) frame_from_body: Pose,
    /// Its spheres; the first is the ball around all of it.
    pub(super) spheres: std::ops::Range<usize>,
    /// Steps that move it, from the root on, each with the largest distance of any of its points from the axis; 1 for a
    /// step that slides.
    pub(super) chain: Vec<(usize, f64)>,
}

/// Two bodies that are compared.
#[derive(Debug, Clone)]
pub(super) struct Pair {
    pub(super) a: usize,
    pub(super) b: usize,
    /// Steps that move one against the other, with how far they bring points of the two together per unit at most.
    pub(super) closing: Vec<(usize, f64)>,
    /// The same steps in their order from the one to the other, with the largest distance of points of the other from the axis.
    pub(super) between: Vec<(usize, f64)>,
    /// Where the two are known to stay apart.
    pub(super) apart: Option<Arc<Apart>>,
}

/// A node of a sphere tree in single precision.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sphere {
    pub(super) centre: [f32; 3],
    pub(super) outer: f32,
    pub(super) inner: f32,
    /// For each [`Trust`], what looks go by.
    insides: [Inside; 2],
    /// Position of the first sphere that is not below this one.
    pub(super) next: u32,
}

/// What a look takes for the inside of the robot.
#[derive(Debug, Clone, Copy)]
pub(super) struct Inside {
    /// Of a sphere about the same middle; not above zero when there is none.
    pub(super) radius: f32,
    /// Such spheres of this node and of those below it are within this distance; below zero when there are none.
    pub(super) core: f32,
}

impl Sphere {
    /// What looks go by.
    #[inline(always)]
    pub(super) fn inside(&self, trust: Trust) -> Inside {
        self.insides[trust as usize]
    }
}

impl Inside {
    /// Whether in some lane the sphere has less `room` than this between it and an obstacle, the square of whose distance from the
    /// middle is `most`, at most.
    #[inline(always)]
    pub(super) fn touches<S: Simd>(&self, most: Lanes<S>, room: f32, rounding: f32) -> bool {
        let inner = self.radius + room - rounding;
        most.less_equal_number(inner * inner).any()
    }
}

/// What looks take for the inside of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Trust {
    /// What certainly is.
    Certain,
    /// What most likely is, so that little that looks free is not.
    Wary,
}

/// How far from the largest sphere inside of the robot to the one that covers its part of it a wary look goes, as a fraction.
const LIKELY: f64 = 0.25;

impl LaneRobot {
    /// Motions of `dofs` from configuration `q` on.
    ///
    /// `parts` and `covers` belong to the links; `self_pairs` are the pairs of links to compare, of which those that
    /// `dofs` do not move against each other are left out. See [`with_tables`](Self::with_tables) for robots of many motions.
    pub fn new(
        kinematics: &Kinematics,
        dofs: &[DofIdx],
        q: &Configuration,
        parts: &TypedVec<LinkIdx, Arc<ConvexParts>>,
        covers: &TypedVec<LinkIdx, Arc<SphereCover>>,
        self_pairs: &[(LinkIdx, LinkIdx)],
    ) -> Self {
        let model = kinematics.model();
        let mut steps: Vec<Step> = Vec::new();
        let mut carriers: TypedVec<LinkIdx, (usize, Pose)> =
            model.links().iter().map(|_| (0, Pose::identity())).collect();
        for &joint in model.topological_order() {
            let described = &model.joints()[joint];
            let (frame, frame_from_parent) = carriers[described.parent];
            carriers[described.child] = match moving(kinematics, dofs, joint) {
                None => {
                    let value = kinematics.joint_value(joint, q);
                    (frame, frame_from_parent * kinematics.parent_from_child(joint, value))
                }
                Some((column, factor, offset)) => {
                    let slides = described.motion == JointMotion::Prismatic;
                    let parent_from_joint = frame_from_parent * joint_pose(kinematics, joint);
                    // Turned so that the axis is z; the child is turned back.
                    let joint_from_axis = z_onto(described.unit_axis());
                    let pose = parent_from_joint * joint_from_axis;
                    steps.push(Step::new(frame, column, factor, offset, slides, pose));
                    (steps.len(), Pose::from_parts(Default::default(), joint_from_axis.inverse()))
                }
            };
        }
        let extents = extents(kinematics, &steps, dofs);
        let mut robot = Self {
            steps,
            bodies: Vec::new(),
            pairs: Vec::new(),
            groups: Vec::new(),
            spheres: Vec::new(),
            carriers,
            hand: Vec::new(),
            held: None,
            extents,
            rounding: 0.0,
        };
        let mut body_of: TypedVec<LinkIdx, Option<usize>> = model.links().iter().map(|_| None).collect();
        for link in model.links().indices() {
            let (frame, frame_from_link) = robot.carriers[link];
            // Links that stand still too: something that is held may come near them.
            if !covers[link].nodes().is_empty() {
                let corners = corners(parts[link].iter());
                let body = robot.add(Some(link), frame, frame_from_link, &corners, &covers[link]);
                body_of[link] = Some(body);
            }
        }
        for &(link_a, link_b) in self_pairs {
            if let (Some(a), Some(b)) = (body_of[link_a], body_of[link_b]) {
                let corners = [corners(parts[link_a].iter()), corners(parts[link_b].iter())];
                robot.pairs.extend(robot.pair(a, b, [&corners[0], &corners[1]]));
            }
        }
        robot.group();
        robot.rounding = robot.rounding();
        robot
    }

    /// The same robot, of which `links` may be allowed to touch what the others may not.
    pub fn with_hand(mut self, links: &[LinkIdx]) -> Self {
        self.hand = links.to_vec();
        self.hand.sort_unstable();
        self.group();
        self
    }

    /// The same robot with a body of `scene` in its hand, which `cover` covers. Links for which `beside` is true are compared with
    /// it, except those that it never moves against.
    pub fn holding(
        &self,
        scene: &Scene,
        grip: &Grip,
        cover: &SphereCover,
        beside: impl Fn(LinkIdx) -> bool,
    ) -> Self {
        let mut robot = self.clone();
        let (frame, frame_from_link) = robot.carriers[grip.link];
        let of_held = corners(scene.body_parts(grip.body));
        let held = robot.add(None, frame, frame_from_link * grip.link_from_body, &of_held, cover);
        robot.held = Some(grip.body);
        for other in 0..held {
            if let Some(link) = robot.bodies[other].link.filter(|link| beside(*link)) {
                let of_link = corners(scene.link_parts(link));
                robot.pairs.extend(robot.pair(other, held, [&of_link, &of_held]));
            }
        }
        robot.group();
        robot.rounding = robot.rounding();
        robot
    }

    /// What a look asks of an obstacle: whether spheres inside of the robot, this one or one below it, may come so near.
    #[inline(always)]
    pub(super) fn question<S: Simd>(&self, simd: S, sphere: usize, room: f32, trust: Trust) -> Question<S> {
        let Sphere { outer, next, .. } = self.spheres[sphere];
        let core = self.spheres[sphere].inside(trust).core;
        let leaf = next as usize == sphere + 1;
        let limit = Lanes::splat(simd, core + room + self.rounding as f32);
        Question { limit, coarse: if leaf { 0.0 } else { COARSE * outer } }
    }

    /// Whether a link belongs to the hand.
    pub(super) fn is_of_hand(&self, body: usize) -> bool {
        self.bodies[body].link.is_some_and(|link| self.hand.binary_search(&link).is_ok())
    }

    /// Adds a body with these corners that moves with a frame; returns its position.
    fn add(
        &mut self,
        link: Option<LinkIdx>,
        frame: usize,
        frame_from_body: Pose,
        corners: &[Point3<f64>],
        cover: &SphereCover,
    ) -> usize {
        // Spheres around groups come last, and are found again.
        self.ungroup();
        let first = self.spheres.len();
        let certain = insides(cover.nodes(), |_, node| node.inner);
        let wary = insides(cover.nodes(), |leaf, node| match leaf {
            true => node.inner + LIKELY * (node.outer - node.inner),
            false => node.inner,
        });
        for (node, insides) in cover.nodes().iter().zip(certain.into_iter().zip(wary)) {
            let centre = frame_from_body * node.centre;
            self.spheres.push(Sphere {
                centre: [centre.x as f32, centre.y as f32, centre.z as f32],
                outer: node.outer as f32,
                inner: node.inner as f32,
                insides: [insides.0, insides.1],
                next: first as u32 + node.next,
            });
        }
        let points: Vec<Point3<f64>> = corners.iter().map(|p| frame_from_body * p).collect();
        let reach = points.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
        let beside = points.iter().map(|p| p.x.hypot(p.y)).fold(0.0, f64::max);
        let chain = self.chain(frame, reach, beside);
        let spheres = first..self.spheres.len();
        self.bodies.push(Body { link, frame, group: 0, frame_from_body, spheres, chain });
        self.bodies.len() - 1
    }

    fn ungroup(&mut self) {
        self.spheres.truncate(self.spheres.len() - self.groups.len());
        self.groups.clear();
    }

    /// Finds bodies that move as one and may touch the same, and puts pairs of bodies of the same groups one after another.
    fn group(&mut self) {
        self.ungroup();
        // 0 for links of the arm, 1 for those of the hand, 2 for what is held.
        let class = |robot: &Self, i: usize| match robot.bodies[i].link {
            Some(_) => usize::from(robot.is_of_hand(i)),
            None => 2,
        };
        for key in (0..=self.steps.len()).flat_map(|frame| [0, 1, 2].map(|class| (frame, class))) {
            let of_key = |&i: &usize| (self.bodies[i].frame, class(self, i)) == key;
            let bodies: Vec<usize> = (0..self.bodies.len()).filter(of_key).collect();
            let frame = key.0;
            let balls: Vec<Sphere> =
                bodies.iter().map(|&i| self.spheres[self.bodies[i].spheres.start]).collect();
            if let Some(around) = around(&balls) {
                bodies.iter().for_each(|&i| self.bodies[i].group = self.groups.len());
                self.groups.push(Group { frame, bodies, ball: self.spheres.len() });
                self.spheres.push(around);
            }
        }
        let groups = |pair: &Pair| (self.bodies[pair.a].group, self.bodies[pair.b].group);
        self.pairs.sort_by_key(groups);
    }

    /// How far points of a body are from the axes that move it, at most and in any configuration: no farther than the bones
    /// between are long. In the body's own frame, they are no farther than `reach` from the origin, and than `beside` from the axis.
    pub(super) fn chain(&self, frame: usize, mut reach: f64, mut beside: f64) -> Vec<(usize, f64)> {
        let mut chain = Vec::new();
        // `reach` is from the origin of the frame reached so far.
        let mut at = frame;
        while at > 0 {
            let step = &self.steps[at - 1];
            chain.push((at - 1, if step.slides { 1.0 } else { beside }));
            if step.slides {
                reach += self.extents[at - 1];
            }
            reach += step.parent_from_joint.translation.vector.norm();
            beside = reach;
            at = step.parent;
        }
        chain.reverse();
        chain
    }

    /// The pair of two bodies; `None` when nothing moves one against the other.
    ///
    /// What a step does to the distance of the two can be seen from either side: it moves the one, or the other the other
    /// way. So the smaller of their distances from its axis bounds how fast they come together.
    fn pair(&self, a: usize, b: usize, corners: [&[Point3<f64>]; 2]) -> Option<Pair> {
        let (chain_a, chain_b) = (&self.bodies[a].chain, &self.bodies[b].chain);
        let only = |own: &[(usize, f64)], other: &[(usize, f64)]| -> Vec<(usize, f64)> {
            own.iter().copied().filter(|(step, _)| other.iter().all(|(s, _)| s != step)).collect()
        };
        let (own, other) = (only(chain_a, chain_b), only(chain_b, chain_a));
        let (from_b, from_a) =
            (self.branch_seen_from(b, corners[1], &own), self.branch_seen_from(a, corners[0], &other));
        let smaller = |(&(step, one), &(_, other)): (&(usize, f64), &(usize, f64))| (step, one.min(other));
        let closing: Vec<(usize, f64)> =
            own.iter().zip(&from_b).chain(other.iter().zip(&from_a)).map(smaller).collect();
        let between = from_b.into_iter().rev().chain(other).collect();
        (!closing.is_empty()).then_some(Pair { a, b, closing, between, apart: None })
    }

    /// The steps of a branch that does not move a body, each with the largest distance of points of the body from its axis, in any
    /// configuration.
    fn branch_seen_from(
        &self,
        body: usize,
        corners: &[Point3<f64>],
        branch: &[(usize, f64)],
    ) -> Vec<(usize, f64)> {
        let extents = &self.extents;
        let Some(&(first, _)) = branch.first() else { return vec![] };
        let Body { frame, frame_from_body, .. } = self.bodies[body];
        let root = self.steps[first].parent;
        let points = || corners.iter().map(|p| frame_from_body * p);
        // From the origin of the frame reached so far: first towards the root, then out along the branch.
        let mut reach = points().map(|p| p.coords.norm()).fold(0.0, f64::max);
        let mut at = frame;
        while at != root {
            let step = &self.steps[at - 1];
            reach += step.parent_from_joint.translation.vector.norm() + extents[at - 1];
            at = step.parent;
        }
        let mut bounded = Vec::new();
        for (i, &(step, _)) in branch.iter().enumerate() {
            let joint = &self.steps[step];
            let mut beside = reach + joint.parent_from_joint.translation.vector.norm();
            reach = beside + extents[step];
            if i == 0 && frame == root {
                let inside = points().map(|p| joint.parent_from_joint.inverse_transform_point(&p));
                let far = inside.map(|p| (p.x.hypot(p.y), p.coords.norm()));
                let (from_axis, from_origin) =
                    far.fold((0.0_f64, 0.0_f64), |most, p| (most.0.max(p.0), most.1.max(p.1)));
                (beside, reach) = (from_axis, from_origin + extents[step]);
            }
            bounded.push((step, if joint.slides { 1.0 } else { beside }));
        }
        bounded
    }

    /// A step turns what hangs on it by an angle that is known to about a millionth, and adds about as much by its own
    /// rounding; each such error moves a point by no more than the length of the arm.
    pub(super) fn rounding(&self) -> f64 {
        const EACH_STEP: f64 = 6e-6;
        let reach = |body: &Body| body.chain.iter().map(|(_, distance)| *distance).fold(0.0, f64::max);
        let longest = self.bodies.iter().map(reach).fold(0.0, f64::max);
        EACH_STEP * (self.steps.len() + 1) as f64 * longest
    }

    /// Change of a joint along the motion by `difference`, its size.
    pub(super) fn change(&self, step: usize, difference: &[f64]) -> f64 {
        let step = &self.steps[step];
        (step.factor * difference[step.column]).abs()
    }

    /// Half of a bound on the acceleration of points that a chain of steps moves, each step with the largest distance of them from its
    /// axis; `change` tells how far each step goes. Per motion squared.
    pub(super) fn bend(&self, chain: &[(usize, f64)], change: impl Fn(usize) -> f64) -> f64 {
        // Second derivative of a point by two joints, the second one farther out: no more than its distance from the
        // axis of that one; nothing when the first one slides.
        let (mut bend, mut turned) = (0.0, 0.0);
        for &(step, distance) in chain {
            let own = change(step);
            if self.steps[step].slides {
                bend += own * distance * 2.0 * turned;
            } else {
                bend += own * distance * (own + 2.0 * turned);
                turned += own;
            }
        }
        0.5 * bend
    }

    /// How a body moves where frames are at `root_from_frames` in the motion by `difference`: velocity of a point of it, and angular
    /// velocity, in the root frame and per motion.
    pub(super) fn twist(
        &self,
        body: usize,
        point_in_root: &Point3<f64>,
        difference: &[f64],
        root_from_frames: &[Pose],
    ) -> (Vector3<f64>, Vector3<f64>) {
        let (mut velocity, mut spin) = (Vector3::zeros(), Vector3::zeros());
        for &(step, _) in &self.bodies[body].chain {
            let frame = &root_from_frames[step + 1];
            let step = &self.steps[step];
            let axis = frame.rotation * Vector3::z() * (step.factor * difference[step.column]);
            if step.slides {
                velocity += axis;
            } else {
                velocity += axis.cross(&(point_in_root.coords - frame.translation.vector));
                spin += axis;
            }
        }
        (velocity, spin)
    }

    /// Poses of all frames in the root frame, exactly; `values` are those of the degrees of freedom.
    pub(super) fn poses(&self, values: &[f64], root_from_frames: &mut Vec<Pose>) {
        root_from_frames.clear();
        root_from_frames.push(Pose::identity());
        for step in &self.steps {
            let value = step.factor * values[step.column] + step.offset;
            let motion = if step.slides {
                Pose::translation(0.0, 0.0, value)
            } else {
                let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), value);
                Pose::from_parts(Default::default(), turn)
            };
            root_from_frames.push(root_from_frames[step.parent] * step.parent_from_joint * motion);
        }
    }
}

impl Step {
    pub(super) fn new(
        parent: usize,
        column: usize,
        factor: f64,
        offset: f64,
        slides: bool,
        pose: Pose,
    ) -> Self {
        let rotation = pose.rotation.to_rotation_matrix();
        let row = |i: usize| [0, 1, 2].map(|k| snapped(rotation.matrix()[(i, k)]));
        let shift = pose.translation.vector;
        Self {
            parent,
            column,
            factor,
            offset,
            slides,
            parent_from_joint: pose,
            rows: [row(0), row(1), row(2)],
            shift: [shift.x as f32, shift.y as f32, shift.z as f32],
        }
    }

    /// Joint value at the start of a motion, brought near zero when it is an angle, and its change along the motion.
    pub(super) fn motion(&self, from: &[f64], difference: &[f64]) -> (f64, f64) {
        (self.value(from), self.factor * difference[self.column])
    }

    /// Joint value in a state, brought near zero when it is an angle.
    pub(super) fn value(&self, state: &[f64]) -> f64 {
        let value = self.factor * state[self.column] + self.offset;
        let far = !self.slides && value.abs() > PI;
        if far { value - TAU * (value / TAU).round() } else { value }
    }
}

/// A sphere around spheres; `None` around none.
fn around(spheres: &[Sphere]) -> Option<Sphere> {
    let centre = [0, 1, 2].map(|k| {
        let low = spheres.iter().map(|s| s.centre[k] - s.outer).fold(f32::INFINITY, f32::min);
        let high = spheres.iter().map(|s| s.centre[k] + s.outer).fold(f32::NEG_INFINITY, f32::max);
        0.5 * (low + high)
    });
    let reach = |s: &Sphere| {
        let away: f64 = (0..3).map(|k| f64::from(s.centre[k] - centre[k]).powi(2)).sum();
        away.sqrt() + f64::from(s.outer)
    };
    let outer = spheres.iter().map(reach).reduce(f64::max)?;
    // A hair more, for rounding.
    let outer = (outer * (1.0 + 1e-6)) as f32;
    Some(Sphere { centre, outer, inner: 0.0, insides: [Inside { radius: 0.0, core: outer }; 2], next: 0 })
}

/// For each node, what a look goes by: `radius` tells that of the sphere inside of a node, which may be a leaf.
fn insides(nodes: &[SphereNode], radius: impl Fn(bool, &SphereNode) -> f64) -> Vec<Inside> {
    let is_leaf = |i: usize| nodes[i].next as usize == i + 1;
    let inside = |(i, node): (usize, &SphereNode)| {
        let below = (i..node.next as usize)
            .map(|j| ((nodes[j].centre - node.centre).norm(), radius(is_leaf(j), &nodes[j])));
        let reach = below.filter(|(_, radius)| *radius > 0.0).map(|(away, radius)| away + radius);
        // A hair more, for rounding.
        let core = reach.reduce(f64::max).map_or(-1.0, |reach| (reach * (1.0 + 1e-6)) as f32);
        Inside { radius: radius(is_leaf(i), node) as f32, core }
    };
    nodes.iter().enumerate().map(inside).collect()
}

/// A coefficient that is zero but for rounding becomes zero, which the kernel skips.
fn snapped(x: f64) -> f32 {
    if x.abs() < 1e-9 { 0.0 } else { x as f32 }
}

/// The column, factor and offset of a joint that the degrees of freedom move.
fn moving(kinematics: &Kinematics, dofs: &[DofIdx], joint: JointIdx) -> Option<(usize, f64, f64)> {
    let (dof, factor, offset) = match kinematics.model().joints()[joint].drive {
        Drive::Fixed => return None,
        Drive::Dof(dof) => (dof, 1.0, 0.0),
        Drive::Mimic { dof, multiplier, offset } => (dof, multiplier, offset),
    };
    let column = dofs.iter().position(|&own| own == dof)?;
    let zero = kinematics.calibration().joint(joint).map_or(0.0, |c| c.value_offset);
    Some((column, factor, offset + zero))
}

fn joint_pose(kinematics: &Kinematics, joint: JointIdx) -> Pose {
    let described = kinematics.model().joints()[joint].parent_from_joint();
    match kinematics.calibration().joint(joint) {
        None => *described,
        Some(c) => described * c.joint_from_corrected,
    }
}

/// Corners of all parts.
fn corners<'p>(parts: impl Iterator<Item = &'p ConvexPart>) -> Vec<Point3<f64>> {
    parts.flat_map(|part| part.points().iter().copied()).collect()
}

/// For each step, how far it slides at most.
fn extents(kinematics: &Kinematics, steps: &[Step], dofs: &[DofIdx]) -> Vec<f64> {
    let limits = kinematics.model().dofs();
    let extent = |step: &Step| {
        let dof = &limits[dofs[step.column]];
        let at = |value: f64| (step.factor * value + step.offset).abs();
        if step.slides { at(dof.lower).max(at(dof.upper)) } else { 0.0 }
    };
    steps.iter().map(extent).collect()
}

/// A rotation that takes the z axis onto `axis`.
pub(super) fn z_onto(axis: &Unit<Vector3<f64>>) -> UnitQuaternion<f64> {
    let rotation = Rotation3::rotation_between(&Vector3::z(), axis)
        .unwrap_or_else(|| Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
    UnitQuaternion::from_rotation_matrix(&rotation)
}

/// Numbers by which contacts are reported: links first, then bodies of the scene.
pub(super) fn number_of(link: LinkIdx) -> usize {
    link.index()
}
