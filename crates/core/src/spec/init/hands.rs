//! Guesses grippers: bodies at the end of an arm that carry short moving branches.

use nalgebra::{Point3, Vector3};

use super::bodies::{Bodies, FINGER, HAND, NEITHER};
use crate::Pose;
use crate::ids::{DofIdx, LinkIdx};
use crate::model::{Configuration, Drive, JointMotion, Kinematics, RobotModel};
use crate::spec::extent::extent;

/// Most driven joints of a finger, one below the other.
const FINGER_JOINTS: usize = 8;

/// Fewest joints between the root and a palm.
const ARM_JOINTS: usize = 3;

/// Largest reach of a finger as a share of the reach of the arm.
const FINGER_REACH: f64 = 0.4;

/// A guessed gripper.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hand {
    /// The palm's body.
    pub(super) body: usize,
    /// The link that the fingers hang on.
    pub(super) palm: LinkIdx,
    pub(super) dofs: Vec<DofIdx>,
    /// 1, -1 or 0 for each of `dofs`.
    pub(super) closing: Vec<f64>,
    /// Links with shapes that the joints move; with a single one of them its palm, which is then the other jaw.
    pub(super) fingers: Vec<LinkIdx>,
    /// Origin of the tool frame in the palm frame; metres.
    pub(super) tool: [f64; 3],
    /// Direction of approach in the palm frame, of length one.
    pub(super) approach: [f64; 3],
}

/// All grippers, in the order of the bodies.
pub(super) fn find(bodies: &Bodies, kinematics: &Kinematics) -> Vec<Hand> {
    let mut palms: Vec<usize> = Vec::new();
    let mut taken: Vec<usize> = Vec::new();
    // Several fingers tell a palm by themselves; the topmost is it, since fingers may branch again.
    for body in 0..bodies.all.len() {
        if !taken.contains(&body) && may_be_palm(bodies, body) && branches(bodies, body) >= 2 {
            taken.extend(bodies.subtree(body));
            palms.push(body);
        }
    }
    // One finger is told from the rest of a wrist by its name only; the palm is the last link not called a finger.
    for body in (0..bodies.all.len()).rev() {
        let below = bodies.subtree(body);
        let single = bodies.all[body].children.iter().any(|&child| bodies.mentions(child, HAND));
        let free = !taken.contains(&body) && !below.iter().any(|b| palms.contains(b));
        if free && single && !bodies.mentions(body, FINGER) && may_be_palm(bodies, body) {
            taken.extend(below);
            palms.push(body);
        }
    }
    palms.sort_unstable();
    palms.into_iter().filter_map(|palm| describe(bodies, palm, kinematics)).collect()
}

/// Whether what is below a body is short against what is above, and none of it is called otherwise.
fn may_be_palm(bodies: &Bodies, body: usize) -> bool {
    let above = bodies.path(0, body).iter().filter(|&&b| bodies.is_driven(b)).count();
    if bodies.all[body].children.is_empty() || above < ARM_JOINTS || bodies.depth(body) > FINGER_JOINTS {
        return false;
    }
    let below = bodies.subtree(body);
    let longest = below.iter().map(|&b| bodies.reach(body, b)).fold(0.0, f64::max);
    !below.iter().any(|&b| bodies.mentions(b, NEITHER)) && longest <= FINGER_REACH * bodies.reach(0, body)
}

/// Number of branches below a body, without stubs that have no shape.
fn branches(bodies: &Bodies, body: usize) -> usize {
    let stub = |child: usize| bodies.all[child].children.is_empty() && !bodies.has_shape(child);
    bodies.all[body].children.iter().filter(|&&child| !stub(child)).count()
}

/// The link of `body` that all joints below it hang on, directly or through fixed joints.
fn palm_link(bodies: &Bodies, body: usize) -> LinkIdx {
    let model = bodies.model;
    let joints = bodies.all[body].children.iter().filter_map(|&child| bodies.all[child].joint);
    let parents: Vec<LinkIdx> = joints.map(|j| model.joints()[j].parent).collect();
    let mut palm = parents[0];
    while !parents.iter().all(|&p| model.joints_between(palm, p).is_some()) {
        palm = model.parent(palm).expect("the body's first link is above all of its links");
    }
    palm
}

fn describe(bodies: &Bodies, body: usize, kinematics: &Kinematics) -> Option<Hand> {
    let model = bodies.model;
    let palm = palm_link(bodies, body);
    let below: Vec<usize> = bodies.subtree(body).into_iter().skip(1).collect();
    let dofs: Vec<DofIdx> = below
        .iter()
        .filter_map(|&b| match model.joints()[bodies.all[b].joint?].drive {
            Drive::Dof(dof) => Some(dof),
            _ => None,
        })
        .collect();
    if dofs.is_empty() {
        return None;
    }
    let shapes = Shapes { kinematics, palm };
    let middle = at_share(model, &dofs, &vec![1.0; dofs.len()], 0.5);
    let approach = snapped(shapes.mean(bodies, &below, &middle).coords)?;
    let tips = tips(&shapes, bodies, &below, &middle, &approach);
    let closing = closing(&shapes, bodies, &dofs, &tips, &middle, &approach);
    let tool = between_tips(&shapes, bodies, &dofs, &closing, &tips, &approach);
    let mut fingers = finger_links(bodies, &below);
    if tips.len() == 1 && closing.iter().filter(|sign| **sign != 0.0).count() == 1 {
        fingers.push(palm);
    }
    Some(Hand {
        body,
        palm,
        fingers,
        dofs,
        closing,
        tool: tool.map(|x| (x * 1e4).round() / 1e4 + 0.0).into(),
        approach: approach.into(),
    })
}

/// Where the shapes of bodies are in the palm frame.
struct Shapes<'a> {
    kinematics: &'a Kinematics,
    palm: LinkIdx,
}

impl Shapes<'_> {
    /// Corners of the boxes round the shapes of a body; the origins of its links where they have no shapes.
    fn points(&self, bodies: &Bodies, body: usize, q: &Configuration) -> Vec<Point3<f64>> {
        let palm_from_root = self.kinematics.root_from_link(q, self.palm).inverse();
        let mut points = Vec::new();
        let mut origins = Vec::new();
        for &link in &bodies.all[body].links {
            let palm_from_link = palm_from_root * self.kinematics.root_from_link(q, link);
            let link_data = &bodies.model.links()[link];
            let shapes =
                if link_data.collisions.is_empty() { &link_data.visuals } else { &link_data.collisions };
            if let Some(bounds) = extent(shapes, &Pose::identity()) {
                let corner = |i: usize| {
                    let pick = |k: usize| if i >> k & 1 == 0 { bounds.low[k] } else { bounds.high[k] };
                    palm_from_link * Point3::new(pick(0), pick(1), pick(2))
                };
                points.extend((0..8).map(corner));
            }
            origins.push(Point3::from(palm_from_link.translation.vector));
        }
        if points.is_empty() { origins } else { points }
    }

    fn centre(&self, bodies: &Bodies, body: usize, q: &Configuration) -> Point3<f64> {
        mean(&self.points(bodies, body, q))
    }

    fn mean(&self, bodies: &Bodies, some: &[usize], q: &Configuration) -> Point3<f64> {
        mean(&some.iter().map(|&b| self.centre(bodies, b, q)).collect::<Vec<_>>())
    }

    /// How far a body reaches along a direction.
    fn height(&self, bodies: &Bodies, body: usize, q: &Configuration, along: &Vector3<f64>) -> (f64, f64) {
        let heights = self.points(bodies, body, q).into_iter().map(|p| p.coords.dot(along));
        heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)))
    }
}

fn mean(points: &[Point3<f64>]) -> Point3<f64> {
    let sum: Vector3<f64> = points.iter().map(|p| p.coords).sum();
    Point3::from(sum / points.len().max(1) as f64)
}

/// The direction as an axis of the frame when it is close to one; `None` when it has no length.
fn snapped(direction: Vector3<f64>) -> Option<Vector3<f64>> {
    let direction = direction.try_normalize(1e-6)?;
    let axis = direction.iamax();
    if direction[axis].abs() < 0.8 {
        return direction.map(|x| (x * 1e3).round() / 1e3).try_normalize(1e-6);
    }
    let mut snapped = Vector3::zeros();
    snapped[axis] = direction[axis].signum();
    Some(snapped)
}

/// Leaf bodies that reach far along the approach: the others are linkages.
fn tips(
    shapes: &Shapes,
    bodies: &Bodies,
    below: &[usize],
    q: &Configuration,
    approach: &Vector3<f64>,
) -> Vec<usize> {
    let leaves: Vec<(usize, f64)> = below
        .iter()
        .filter(|&&b| bodies.all[b].children.is_empty())
        .map(|&b| (b, shapes.height(bodies, b, q, approach).1))
        .collect();
    let farthest = leaves.iter().map(|(_, height)| *height).fold(f64::NEG_INFINITY, f64::max);
    leaves.iter().filter(|(_, height)| *height >= 0.7 * farthest).map(|(b, _)| *b).collect()
}

/// The direction in which each joint brings the tips to the axis between them.
fn closing(
    shapes: &Shapes,
    bodies: &Bodies,
    dofs: &[DofIdx],
    tips: &[usize],
    middle: &Configuration,
    approach: &Vector3<f64>,
) -> Vec<f64> {
    let model = bodies.model;
    // A single moving jaw closes towards the palm's own axis.
    let axis_at = if tips.len() > 1 { shapes.mean(bodies, tips, middle) } else { Point3::origin() };
    let opening = |q: &Configuration| -> f64 {
        let off_axis = |&tip: &usize| {
            let from_axis = shapes.centre(bodies, tip, q) - axis_at;
            (from_axis - approach * from_axis.dot(approach)).norm()
        };
        tips.iter().map(off_axis).sum()
    };
    let direction = |&dof: &DofIdx| {
        let joint = &model.joints()[model.dofs()[dof].joint];
        let palm_from_root = shapes.kinematics.root_from_link(middle, shapes.palm).inverse();
        let palm_from_child = palm_from_root * shapes.kinematics.root_from_link(middle, joint.child);
        let axis = palm_from_child * joint.unit_axis().into_inner();
        if joint.motion == JointMotion::Revolute && axis.dot(approach).abs() > 0.9 {
            return 0.0;
        }
        let (low, high) = ends(model, dof);
        let at = |value: f64| {
            let mut q = middle.clone();
            q[dof] = value;
            opening(&q)
        };
        match at(high) - at(low) {
            change if change > 1e-4 => -1.0,
            change if change < -1e-4 => 1.0,
            _ => 0.0,
        }
    };
    let mut signs: Vec<f64> = dofs.iter().map(direction).collect();
    if signs.iter().all(|sign| *sign == 0.0) {
        signs[0] = -1.0;
    }
    signs
}

/// The ends of a joint's range, or half a radian (metre) to either side.
fn ends(model: &RobotModel, dof: DofIdx) -> (f64, f64) {
    let dof = &model.dofs()[dof];
    let finite = |bound: f64, other: f64| if bound.is_finite() { bound } else { other };
    (finite(dof.lower, -0.5), finite(dof.upper, 0.5))
}

/// All joints neutral, those of the hand at a share of the way from open to closed.
fn at_share(model: &RobotModel, dofs: &[DofIdx], closing: &[f64], share: f64) -> Configuration {
    let mut q = Configuration::neutral(model);
    for (&dof, &sign) in dofs.iter().zip(closing) {
        let (low, high) = ends(model, dof);
        if sign != 0.0 {
            q[dof] = if sign > 0.0 { low + share * (high - low) } else { high + share * (low - high) };
        }
    }
    q
}

/// A point between the tips, a little behind their ends, where they are closest to each other.
fn between_tips(
    shapes: &Shapes,
    bodies: &Bodies,
    dofs: &[DofIdx],
    closing: &[f64],
    tips: &[usize],
    approach: &Vector3<f64>,
) -> Vector3<f64> {
    let configurations = (0..=10).map(|i| at_share(bodies.model, dofs, closing, f64::from(i) / 10.0));
    let spread = |q: &Configuration| -> f64 {
        let middle = shapes.mean(bodies, tips, q);
        let off = |&tip: &usize| {
            let from_middle = shapes.centre(bodies, tip, q) - middle;
            (from_middle - approach * from_middle.dot(approach)).norm()
        };
        tips.iter().map(off).sum()
    };
    let closest = if tips.len() > 1 {
        configurations.min_by(|a, b| spread(a).total_cmp(&spread(b))).expect("eleven of them")
    } else {
        // Half-way to where it meets the palm: what is to be held comes in between.
        at_share(bodies.model, dofs, closing, 0.5)
    };
    let heights: Vec<(f64, f64)> =
        tips.iter().map(|&t| shapes.height(bodies, t, &closest, approach)).collect();
    let end = heights.iter().map(|(_, high)| *high).fold(f64::NEG_INFINITY, f64::max);
    let length = heights.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    let middle = shapes.mean(bodies, tips, &closest).coords;
    let across = middle - approach * middle.dot(approach);
    across + approach * (end - (0.2 * length).min(0.02))
}

fn finger_links(bodies: &Bodies, below: &[usize]) -> Vec<LinkIdx> {
    let model = bodies.model;
    let links: Vec<LinkIdx> = below.iter().flat_map(|&b| bodies.all[b].links.iter().copied()).collect();
    let with = |test: &dyn Fn(LinkIdx) -> bool| -> Vec<LinkIdx> {
        links.iter().copied().filter(|&l| test(l)).collect()
    };
    let touching = with(&|l| !model.links()[l].collisions.is_empty());
    if !touching.is_empty() {
        return touching;
    }
    let visible = with(&|l| !model.links()[l].visuals.is_empty());
    if visible.is_empty() { links } else { visible }
}
