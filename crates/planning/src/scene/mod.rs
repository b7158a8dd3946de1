//! The robot among bodies: what touches what, and how much room is left.
//!
//! Every moving body (a link, or the object in the gripper) is first compared by its bounding sphere with the box of
//! every other one; parts are looked at where these bounds do not settle it. The bounds that settle it add up to the
//! clearance of the state, with which [edge checks](crate::edge) skip what cannot collide.

mod checker;
mod shape;

use std::sync::Arc;

use robotc_core::geom::{ConvexParts, contact, within};
use robotc_core::ids::Idx;
use robotc_core::world::World;
use robotc_core::{BodyIdx, DofIdx, Kinematics, LinkIdx, LinkPoses, Pose, TypedVec};

pub use checker::RobotChecker;
use shape::Shape;

use crate::edge::Obstruction;
use crate::travel::TravelBounds;

/// A robot and bodies around it. Cheap to clone: shapes are shared, poses are not.
#[derive(Debug, Clone)]
pub struct Scene {
    kinematics: Kinematics,
    world_from_robot: Pose,
    links: Arc<TypedVec<LinkIdx, Shape>>,
    self_pairs: Arc<Vec<(LinkIdx, LinkIdx)>>,
    bodies: TypedVec<BodyIdx, Body>,
}

#[derive(Debug, Clone)]
struct Body {
    name: Arc<str>,
    shape: Arc<Shape>,
    world_from_body: Pose,
    body_from_world: Pose,
}

/// A body that moves with a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Grip {
    /// The body.
    pub body: BodyIdx,
    /// The link that carries it.
    pub link: LinkIdx,
    /// The body in the frame of that link.
    pub link_from_body: Pose,
}

/// What counts as a collision for a stretch of motion.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rules {
    /// Robot and held body stay farther than this from other bodies, metres. Links may come closer to each other.
    pub margin: f64,
    /// What the gripper holds. The links of `gripper` may touch it.
    pub held: Option<Grip>,
    /// Links of the gripper, ascending.
    pub gripper: Vec<LinkIdx>,
    /// A body that the links of the gripper may touch: the target of a grasp.
    pub target: Option<BodyIdx>,
    /// How deep the held body may be in other bodies, metres: it stands on one when it is picked up and put down.
    /// `None` asks for the margin.
    pub sink: Option<f64>,
}

/// A pair of touching bodies: links count first, then the bodies of the scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Touch(u16, u16);

impl From<Touch> for Obstruction {
    fn from(touch: Touch) -> Self {
        Obstruction::Contact(u32::from(touch.0) << 16 | u32::from(touch.1))
    }
}

/// Space that makes it worth looking no closer, metres: clearances are found up to about this.
const ROOM: f64 = 0.03;

impl Scene {
    /// The robot and the bodies of a world, where they are now. Disabled bodies are left out; what the world holds
    /// stands still here.
    ///
    /// `links` and `bodies` are the convex parts that cover each link and body, in their own frames (empty without
    /// shape); `self_pairs` are the pairs of links to compare with each other.
    pub fn new(
        world: &World,
        links: &TypedVec<LinkIdx, Arc<ConvexParts>>,
        bodies: &TypedVec<BodyIdx, Arc<ConvexParts>>,
        self_pairs: Vec<(LinkIdx, LinkIdx)>,
    ) -> Self {
        let body = |(body, parts): (&robotc_core::world::Body, &Arc<ConvexParts>)| Body {
            name: body.name.as_str().into(),
            shape: Arc::new(if body.enabled {
                Shape::new(parts)
            } else {
                Shape::new(&ConvexParts::default())
            }),
            world_from_body: body.world_from_body,
            body_from_world: body.world_from_body.inverse(),
        };
        Self {
            kinematics: world.kinematics().clone(),
            world_from_robot: *world.world_from_robot(),
            links: Arc::new(links.iter().map(|parts| Shape::new(parts)).collect()),
            self_pairs: Arc::new(self_pairs),
            bodies: world.bodies().iter().zip(bodies).map(body).collect(),
        }
    }

    /// The robot's kinematics.
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// Where the robot stands.
    pub fn world_from_robot(&self) -> &Pose {
        &self.world_from_robot
    }

    /// Where a body is.
    pub fn world_from_body(&self, body: BodyIdx) -> &Pose {
        &self.bodies[body].world_from_body
    }

    /// Moves a body.
    pub fn place(&mut self, body: BodyIdx, world_from_body: Pose) {
        self.bodies[body].world_from_body = world_from_body;
        self.bodies[body].body_from_world = world_from_body.inverse();
    }

    /// The same scene with one body elsewhere.
    pub fn with_body_at(&self, body: BodyIdx, world_from_body: Pose) -> Self {
        let mut scene = self.clone();
        scene.place(body, world_from_body);
        scene
    }

    /// Bounds on the travel of all links, and of what is held, for motions of `dofs`.
    pub fn travel_bounds(&self, dofs: &[DofIdx], held: Option<&Grip>) -> TravelBounds {
        let mut bounds = TravelBounds::new(dofs);
        for (link, shape) in self.links.enumerate() {
            if !shape.is_empty() {
                bounds.add(&self.kinematics, link, shape.radius_about_origin());
            }
        }
        if let Some(grip) = held {
            let shape = &self.bodies[grip.body].shape;
            let radius = shape.radius_about_origin() + grip.link_from_body.translation.vector.norm();
            bounds.add(&self.kinematics, grip.link, radius);
        }
        bounds
    }

    /// A clause that names a touching pair.
    pub fn describe(&self, obstruction: Obstruction) -> Option<String> {
        let Obstruction::Contact(code) = obstruction else { return None };
        let name = |n: usize| match n.checked_sub(self.links.len()) {
            None => Some(self.kinematics.model().links()[LinkIdx::new(n)].name.as_str()),
            Some(body) => self.bodies.get(BodyIdx::new(body)).map(|b| &*b.name),
        };
        Some(format!("{} touches {}", name((code >> 16) as usize)?, name((code & 0xffff) as usize)?))
    }

    /// Whether `links` and the held body of a robot at `world_from_robot`, its links at `poses`, collide with other
    /// bodies; if not, their clearance: how far all of them may travel without a collision.
    pub fn against_bodies(
        &self,
        world_from_robot: &Pose,
        poses: &LinkPoses,
        links: &[LinkIdx],
        rules: &Rules,
    ) -> Result<f64, Touch> {
        let mut clearance = f64::INFINITY;
        for &link in links {
            let world_from_link = world_from_robot * poses.root_from(link);
            let mover =
                Mover { shape: &self.links[link], world_from_mover: world_from_link, number: link.index() };
            let of_gripper = rules.gripper.binary_search(&link).is_ok();
            let ignored = |body: BodyIdx| {
                rules.held.as_ref().is_some_and(|grip| grip.body == body)
                    || (of_gripper && rules.target == Some(body))
            };
            clearance = clearance.min(self.mover_against_bodies(&mover, rules.margin, None, ignored)?);
        }
        if let Some(grip) = &rules.held {
            let world_from_link = world_from_robot * poses.root_from(grip.link);
            let mover = self.held_mover(grip, world_from_link * grip.link_from_body);
            let free =
                self.mover_against_bodies(&mover, rules.margin, rules.sink, |body| body == grip.body)?;
            clearance = clearance.min(free);
        }
        Ok(clearance)
    }

    /// Whether a body placed at `world_from_body` is deeper than `sink` metres in another one.
    pub fn body_against_bodies(&self, body: BodyIdx, world_from_body: Pose, sink: f64) -> Result<(), Touch> {
        let shape = &self.bodies[body].shape;
        let mover =
            Mover { shape, world_from_mover: world_from_body, number: self.links.len() + body.index() };
        self.mover_against_bodies(&mover, 0.0, Some(sink), |other| other == body).map(|_| ())
    }

    /// Whether links touch each other or the held body; if not, the clearance (half of the room between them, since
    /// both may move).
    pub fn against_self(&self, poses: &LinkPoses, rules: &Rules) -> Result<f64, Touch> {
        let mut clearance = f64::INFINITY;
        let mover = |link: LinkIdx| Mover {
            shape: &self.links[link],
            world_from_mover: *poses.root_from(link),
            number: link.index(),
        };
        for &(a, b) in self.self_pairs.iter() {
            clearance = clearance.min(0.5 * pair_clearance(&mover(a), &mover(b))?);
        }
        if let Some(grip) = &rules.held {
            let held = self.held_mover(grip, poses.root_from(grip.link) * grip.link_from_body);
            for (link, shape) in self.links.enumerate() {
                if !shape.is_empty() && rules.gripper.binary_search(&link).is_err() {
                    clearance = clearance.min(0.5 * pair_clearance(&mover(link), &held)?);
                }
            }
        }
        Ok(clearance)
    }

    fn held_mover(&self, grip: &Grip, pose: Pose) -> Mover<'_> {
        Mover {
            shape: &self.bodies[grip.body].shape,
            world_from_mover: pose,
            number: self.links.len() + grip.body.index(),
        }
    }

    fn mover_against_bodies(
        &self,
        mover: &Mover<'_>,
        margin: f64,
        sink: Option<f64>,
        ignored: impl Fn(BodyIdx) -> bool,
    ) -> Result<f64, Touch> {
        if mover.shape.is_empty() {
            return Ok(f64::INFINITY);
        }
        let margin = if sink.is_some() { 0.0 } else { margin };
        let centre = mover.world_from_mover * mover.shape.centre;
        let mut clearance = f64::INFINITY;
        for (index, body) in self.bodies.enumerate() {
            if body.shape.is_empty() {
                continue;
            }
            let gap = body.shape.bounds.distance_to(&(body.body_from_world * centre)) - mover.shape.radius;
            if gap > margin + ROOM {
                clearance = clearance.min(gap - margin);
                continue;
            }
            if ignored(index) {
                continue;
            }
            let body_from_mover = body.body_from_world * mover.world_from_mover;
            for part in &mover.shape.parts {
                let part_centre = body_from_mover * part.centre;
                for other in &body.shape.parts {
                    let gap = other.bounds.distance_to(&part_centre) - part.radius;
                    if gap > margin + ROOM {
                        clearance = clearance.min(gap - margin);
                        continue;
                    }
                    let poses = (&body_from_mover, &Pose::identity());
                    if !within(&part.part, poses.0, &other.part, poses.1, margin + ROOM) {
                        clearance = clearance.min(ROOM);
                        continue;
                    }
                    let touches = match sink {
                        None => within(&part.part, poses.0, &other.part, poses.1, margin),
                        Some(sink) => contact(&part.part, poses.0, &other.part, poses.1, 0.0)
                            .is_some_and(|c| c.depth > sink),
                    };
                    if touches {
                        return Err(Touch(mover.number as u16, (self.links.len() + index.index()) as u16));
                    }
                    clearance = 0.0;
                }
            }
        }
        Ok(clearance)
    }
}

/// Something that moves, at one place.
struct Mover<'a> {
    shape: &'a Shape,
    world_from_mover: Pose,
    number: usize,
}

/// The room between two movers, or their touch; zero when they are close.
fn pair_clearance(a: &Mover<'_>, b: &Mover<'_>) -> Result<f64, Touch> {
    let (centre_a, centre_b) = (a.world_from_mover * a.shape.centre, b.world_from_mover * b.shape.centre);
    let gap = (centre_a - centre_b).norm() - a.shape.radius - b.shape.radius;
    if gap > 2.0 * ROOM {
        return Ok(gap);
    }
    let mut clearance = f64::INFINITY;
    let b_from_a = b.world_from_mover.inv_mul(&a.world_from_mover);
    for part in &a.shape.parts {
        let centre = b_from_a * part.centre;
        for other in &b.shape.parts {
            let gap = other.bounds.distance_to(&centre) - part.radius;
            if gap > 2.0 * ROOM {
                clearance = clearance.min(gap);
                continue;
            }
            if !within(&part.part, &b_from_a, &other.part, &Pose::identity(), 2.0 * ROOM) {
                clearance = clearance.min(2.0 * ROOM);
                continue;
            }
            if within(&part.part, &b_from_a, &other.part, &Pose::identity(), 0.0) {
                return Err(Touch(a.number as u16, b.number as u16));
            }
            clearance = 0.0;
        }
    }
    Ok(clearance)
}
