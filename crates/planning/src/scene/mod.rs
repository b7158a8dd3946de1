//! The robot among bodies: what touches what, and how much room is left.
//!
//! Every moving body (a link, or the object in the gripper) is first compared by its bounding sphere with the box of
//! every other one; parts are looked at where these bounds do not settle it. What is found is the clearance of the
//! state, with which [edge checks](crate::edge) skip what cannot collide. It is counted in the travel of the fastest
//! point: a link that moves at a third of that pace has three times the room.

mod along;
mod article;
mod between;
mod checker;
mod mobile;
mod pairs;
mod room;
mod rows;
mod shape;

use std::sync::Arc;

use nalgebra::Point3;
use robotc_core::geom::{ConvexPart, ConvexParts, Otherwise};
use robotc_core::ids::Idx;
use robotc_core::model::Geometry;
use robotc_core::world::World;
use robotc_core::{BodyIdx, Configuration, Kinematics, LinkIdx, LinkPoses, Pose, TypedVec};

pub(crate) use along::Along;
pub use article::MovingArticle;
use between::{Keeps, between};
pub use checker::RobotChecker;
pub use mobile::{Carriage, MobileChecker};
pub(crate) use shape::PlacedPile;
use shape::Shape;

use crate::edge::Obstruction;

/// A robot and bodies around it. Cheap to clone: shapes are shared, poses are not.
#[derive(Debug, Clone)]
pub struct Scene {
    kinematics: Kinematics,
    world_from_robot: Pose,
    links: Arc<TypedVec<LinkIdx, Shape>>,
    self_pairs: Arc<Vec<(LinkIdx, LinkIdx)>>,
    bodies: TypedVec<BodyIdx, Body>,
    /// Bounds on travel, for the degrees of freedom that were asked for.
    rows: Arc<rows::KnownRows>,
}

#[derive(Debug, Clone)]
struct Body {
    name: Arc<str>,
    /// What the parts cover.
    geometry: Arc<Vec<Geometry>>,
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
    /// How deep these links may be in the target, metres. `None`: as deep as it looks.
    pub give: Option<f64>,
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
            geometry: body.geometry.clone(),
            shape: Arc::new(if body.enabled {
                Shape::new(parts, &body.geometry)
            } else {
                Shape::new(&ConvexParts::default(), &[])
            }),
            world_from_body: body.world_from_body,
            body_from_world: body.world_from_body.inverse(),
        };
        Self {
            kinematics: world.kinematics().clone(),
            world_from_robot: *world.world_from_robot(),
            links: Arc::new(links.iter().map(|parts| Shape::new(parts, &[])).collect()),
            self_pairs: Arc::new(self_pairs),
            bodies: world.bodies().iter().zip(bodies).map(body).collect(),
            rows: Arc::default(),
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

    /// The same scene with the robot elsewhere.
    pub fn standing_at(&self, world_from_robot: Pose) -> Self {
        Self { world_from_robot, ..self.clone() }
    }

    /// Where a body is.
    pub fn world_from_body(&self, body: BodyIdx) -> &Pose {
        &self.bodies[body].world_from_body
    }

    /// Number of links of the robot.
    pub(crate) fn links(&self) -> usize {
        self.links.len()
    }

    /// Convex parts of a link, in its frame.
    pub(crate) fn link_parts(&self, link: LinkIdx) -> impl Iterator<Item = &ConvexPart> {
        self.links[link].parts.iter().map(|part| &part.part)
    }

    /// Convex parts that cover a body, in its frame; of a point cloud or a height field the box around it.
    pub(crate) fn body_parts(&self, body: BodyIdx) -> impl Iterator<Item = &ConvexPart> {
        self.bodies[body].shape.cover().map(|part| &part.part)
    }

    /// What a body is made of, in its frame: convex parts and piles.
    pub(crate) fn made_of(&self, body: BodyIdx) -> (impl Iterator<Item = &ConvexPart>, &[PlacedPile]) {
        let shape = &self.bodies[body].shape;
        (shape.parts.iter().map(|part| &part.part), &shape.piles)
    }

    /// Bodies that have a shape: where they are, and what they look like.
    pub(crate) fn solids(&self) -> impl Iterator<Item = (BodyIdx, Pose, &[Geometry])> {
        let solid = self.bodies.enumerate().filter(|(_, body)| !body.shape.is_empty());
        solid.map(|(index, body)| (index, body.world_from_body, body.geometry.as_slice()))
    }

    /// Moves a body.
    pub fn place(&mut self, body: BodyIdx, world_from_body: Pose) {
        self.bodies[body].world_from_body = world_from_body;
        self.bodies[body].body_from_world = world_from_body.inverse();
    }

    /// The same scene with one more body of this look, or with one of another look in its place; `parts` are the convex parts of what
    /// is no pile, in the frame of the body.
    pub fn with_body(&self, body: &robotc_core::world::Body, parts: &ConvexParts) -> Self {
        let mut scene = self.clone();
        let made = Body {
            name: body.name.as_str().into(),
            geometry: body.geometry.clone(),
            shape: Arc::new(Shape::new(parts, &body.geometry)),
            world_from_body: body.world_from_body,
            body_from_world: body.world_from_body.inverse(),
        };
        match scene.bodies.position(|known| *known.name == body.name) {
            Some(known) => scene.bodies[known] = made,
            None => {
                scene.bodies.push(made);
            }
        }
        scene
    }

    /// The same scene with one body elsewhere.
    pub fn with_body_at(&self, body: BodyIdx, world_from_body: Pose) -> Self {
        let mut scene = self.clone();
        scene.place(body, world_from_body);
        scene
    }

    /// The names of a touching pair; `None` when the obstruction is not a contact of this scene.
    pub fn names(&self, obstruction: Obstruction) -> Option<[&str; 2]> {
        let Obstruction::Contact(code) = obstruction else { return None };
        let name = |n: usize| match n.checked_sub(self.links.len()) {
            None => Some(self.kinematics.model().links()[LinkIdx::new(n)].name.as_str()),
            Some(body) => self.bodies.get(BodyIdx::new(body)).map(|b| &*b.name),
        };
        Some([name((code >> 16) as usize)?, name((code & 0xffff) as usize)?])
    }

    /// A clause that names a touching pair.
    pub fn describe(&self, obstruction: Obstruction) -> Option<String> {
        self.names(obstruction).map(|[one, other]| format!("{one} touches {other}"))
    }

    /// A clause that says what is in the way of a motion; `bounds` names what is exceeded outside of its space.
    pub(crate) fn explain(&self, obstruction: Obstruction, bounds: &str) -> String {
        match obstruction {
            Obstruction::Bounds => format!("{bounds} is exceeded"),
            Obstruction::Constraint => "the path constraint is violated".into(),
            Obstruction::Contact(n) => self.describe(obstruction).unwrap_or_else(|| format!("contact {n}")),
        }
    }

    /// How deep a touching pair is in each other with the robot at `q`, metres; zero when they come too near without touching,
    /// `None` when the obstruction is not a contact of this scene.
    pub fn depth(&self, q: &Configuration, held: Option<&Grip>, obstruction: Obstruction) -> Option<f64> {
        let Obstruction::Contact(code) = obstruction else { return None };
        let mut poses = LinkPoses::default();
        self.kinematics.link_poses(q, &mut poses);
        let world_from_link = |link: LinkIdx| self.world_from_robot * poses.root_from(link);
        let placed = |n: usize| match n.checked_sub(self.links.len()) {
            None => Some((self.links.get(LinkIdx::new(n))?, world_from_link(LinkIdx::new(n)))),
            Some(body) => {
                let index = BodyIdx::new(body);
                let body = self.bodies.get(index)?;
                let grip = held.filter(|grip| grip.body == index);
                let pose = grip.map_or(body.world_from_body, |g| world_from_link(g.link) * g.link_from_body);
                Some((&*body.shape, pose))
            }
        };
        let (one, world_from_one) = placed((code >> 16) as usize)?;
        let (other, world_from_other) = placed((code & 0xffff) as usize)?;
        let other_from_one = world_from_other.inv_mul(&world_from_one);
        let mut deepest: f64 = 0.0;
        let one_from_other = other_from_one.inverse();
        for part in one.cover() {
            for against in other.solids() {
                deepest = deepest.max(against.depth(&part.part, &other_from_one, &one_from_other));
            }
        }
        Some(deepest)
    }

    /// Diagonal of the box around a body, metres.
    pub fn body_diagonal(&self, body: BodyIdx) -> f64 {
        self.bodies[body].shape.bounds.diagonal()
    }

    /// Distance from a point to the farthest point of `links` with the robot at `q`, metres; zero without shape.
    pub fn farthest(&self, q: &Configuration, links: &[LinkIdx], point_in_world: &Point3<f64>) -> f64 {
        let mut poses = LinkPoses::default();
        self.kinematics.link_poses(q, &mut poses);
        let of_link = |&link: &LinkIdx| {
            let world_from_link = self.world_from_robot * poses.root_from(link);
            let point_in_link = world_from_link.inverse() * point_in_world;
            let points = self.links[link].parts.iter().flat_map(|part| part.part.points());
            points.map(move |p| (p - point_in_link).norm()).fold(0.0, f64::max)
        };
        links.iter().map(of_link).fold(0.0, f64::max)
    }

    /// Those of `links` that are no farther than `gap` metres from a body with the robot at `q`, in their order.
    pub fn links_touching(
        &self,
        q: &Configuration,
        links: &[LinkIdx],
        body: BodyIdx,
        gap: f64,
    ) -> Vec<LinkIdx> {
        let mut poses = LinkPoses::default();
        self.kinematics.link_poses(q, &mut poses);
        let body = &self.bodies[body];
        let touches = |link: &LinkIdx| {
            let body_from_link = body.body_from_world * self.world_from_robot * poses.root_from(*link);
            let shape = &self.links[*link];
            between(
                shape,
                &body.shape,
                &body_from_link,
                Keeps::Margin(gap),
                0.0,
                Otherwise::Anything,
                &mut None,
            )
            .is_none()
        };
        links.iter().copied().filter(touches).collect()
    }

    /// Whether `movers` of a robot at `world_from_robot`, its links at `poses`, collide with other bodies; if not, their
    /// clearance, cut at `room`: how far they may travel, each at its pace, without a collision.
    pub(crate) fn against_bodies(
        &self,
        world_from_robot: &Pose,
        poses: &LinkPoses,
        movers: &Movers,
        rules: &Rules,
        room: f64,
    ) -> Result<f64, Touch> {
        let mut clearance = room;
        for &(link, pace) in &movers.links {
            let placed = Placed {
                shape: &self.links[link],
                pose: world_from_robot * poses.root_from(link),
                number: link.index(),
            };
            let of_gripper = rules.gripper.binary_search(&link).is_ok();
            let depth = |body: BodyIdx| {
                if rules.held.as_ref().is_some_and(|grip| grip.body == body) {
                    Some(f64::INFINITY)
                } else {
                    (of_gripper && rules.target == Some(body)).then(|| rules.give.unwrap_or(f64::INFINITY))
                }
            };
            self.one_against_bodies(&placed, rules.margin, depth, pace, &mut clearance)?;
        }
        if let Some(grip) = &rules.held {
            let world_from_link = world_from_robot * poses.root_from(grip.link);
            let held = self.held(grip, world_from_link * grip.link_from_body);
            let depth = |body: BodyIdx| if body == grip.body { Some(f64::INFINITY) } else { rules.sink };
            self.one_against_bodies(&held, rules.margin, depth, movers.held, &mut clearance)?;
        }
        Ok(clearance)
    }

    /// Whether a body placed at `world_from_body` is deeper than `sink` metres in another one.
    pub fn body_against_bodies(&self, body: BodyIdx, world_from_body: Pose, sink: f64) -> Result<(), Touch> {
        let shape = &self.bodies[body].shape;
        let placed = Placed { shape, pose: world_from_body, number: self.links.len() + body.index() };
        let depth = |other| Some(if other == body { f64::INFINITY } else { sink });
        self.one_against_bodies(&placed, 0.0, depth, 1.0, &mut 0.0)
    }

    /// Whether links touch each other or the held body; if not, the clearance, cut at `room`.
    pub(crate) fn against_self(
        &self,
        poses: &LinkPoses,
        movers: &Movers,
        rules: &Rules,
        room: f64,
    ) -> Result<f64, Touch> {
        let mut clearance = room;
        let placed = |link: LinkIdx| Placed {
            shape: &self.links[link],
            pose: *poses.root_from(link),
            number: link.index(),
        };
        for &(a, b, pace) in &movers.pairs {
            compare(&placed(a), &placed(b), pace, &mut clearance)?;
        }
        if let Some(grip) = &rules.held {
            let held = self.held(grip, poses.root_from(grip.link) * grip.link_from_body);
            for &(link, pace) in &movers.beside_held {
                compare(&placed(link), &held, pace, &mut clearance)?;
            }
        }
        Ok(clearance)
    }

    fn held(&self, grip: &Grip, pose: Pose) -> Placed<'_> {
        let number = self.links.len() + grip.body.index();
        Placed { shape: &self.bodies[grip.body].shape, pose, number }
    }

    /// Lowers `clearance` to that of one mover, or finds what it touches. `depth` says how deep it may be in a body, metres;
    /// where it says nothing, the mover keeps the margin.
    fn one_against_bodies(
        &self,
        mover: &Placed<'_>,
        margin: f64,
        depth: impl Fn(BodyIdx) -> Option<f64>,
        pace: f64,
        clearance: &mut f64,
    ) -> Result<(), Touch> {
        let centre = mover.pose * mover.shape.centre;
        for (index, body) in self.bodies.enumerate() {
            let gap = body.shape.bounds.distance_to(&(body.body_from_world * centre)) - mover.shape.radius;
            let far = *clearance * pace;
            if gap > margin + far || body.shape.is_empty() {
                continue;
            }
            let keeps = match depth(index) {
                Some(f64::INFINITY) => continue,
                Some(depth) => Keeps::Depth(depth),
                None => Keeps::Margin(margin),
            };
            let body_from_mover = body.body_from_world * mover.pose;
            let room = between(
                mover.shape,
                &body.shape,
                &body_from_mover,
                keeps,
                far,
                Otherwise::Roughly,
                &mut None,
            )
            .ok_or_else(|| Touch(mover.number as u16, (self.links.len() + index.index()) as u16))?;
            *clearance = clearance.min(room / pace);
        }
        Ok(())
    }
}

/// What moves in a motion, and at which pace: the part of the motion's travel that it makes at most.
#[derive(Debug, Clone, Default)]
pub(crate) struct Movers {
    /// Links that move against the bodies.
    pub(crate) links: Vec<(LinkIdx, f64)>,
    /// Pairs of links that move against each other.
    pub(crate) pairs: Vec<(LinkIdx, LinkIdx, f64)>,
    /// The held body against the bodies.
    pub(crate) held: f64,
    /// Links that the held body moves against, those of the gripper left out.
    pub(crate) beside_held: Vec<(LinkIdx, f64)>,
}

impl Movers {
    /// Links of which nothing is known but that they move.
    pub(crate) fn of(links: &[LinkIdx]) -> Self {
        Self { links: links.iter().map(|&l| (l, 1.0)).collect(), held: 1.0, ..Self::default() }
    }
}

/// A shape at one place; the number is for messages.
struct Placed<'a> {
    shape: &'a Shape,
    pose: Pose,
    number: usize,
}

/// Lowers `clearance` to what is between two movers, or finds that they touch.
fn compare(a: &Placed<'_>, b: &Placed<'_>, pace: f64, clearance: &mut f64) -> Result<(), Touch> {
    let centres = (a.pose * a.shape.centre, b.pose * b.shape.centre);
    if (centres.0 - centres.1).norm() - a.shape.radius - b.shape.radius > *clearance * pace {
        return Ok(());
    }
    let (b_from_a, far) = (b.pose.inv_mul(&a.pose), *clearance * pace);
    let room = between(a.shape, b.shape, &b_from_a, Keeps::Margin(0.0), far, Otherwise::Roughly, &mut None)
        .ok_or(Touch(a.number as u16, b.number as u16))?;
    *clearance = clearance.min(room / pace);
    Ok(())
}
