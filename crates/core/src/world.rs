//! The state of a robot among bodies: who is where, who holds what, and when that was.
//!
//! A world is cheap to clone: shapes and the robot model are shared, positions are its own. A planner clones the world and
//! does as it likes, while sensors and controllers keep updating the original (thesis appendix A).

use std::sync::Arc;

use crate::Pose;
use crate::ids::{BodyIdx, LinkIdx, TypedVec};
use crate::model::{Configuration, Geometry, Kinematics};
use crate::task::Task;

/// A thing that is not a link of the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Unique in its world.
    pub name: String,
    /// Its shape, shared between clones.
    pub geometry: Arc<Vec<Geometry>>,
    /// Where it is.
    pub world_from_body: Pose,
    /// Whether it takes part in collisions and is seen by sensors.
    pub enabled: bool,
}

/// A body that moves with a link.
#[derive(Debug, Clone, PartialEq)]
pub struct Grab {
    /// The body.
    pub body: BodyIdx,
    /// The link that carries it.
    pub link: LinkIdx,
    /// The body in the frame of that link.
    pub link_from_body: Pose,
    /// Links that touched the body when it was grabbed, ascending: they may go on touching it, no others may.
    pub touching: Vec<LinkIdx>,
}

/// A robot among bodies at one moment.
#[derive(Debug, Clone)]
pub struct World {
    kinematics: Kinematics,
    world_from_robot: Pose,
    q: Configuration,
    bodies: TypedVec<BodyIdx, Body>,
    grabs: Vec<Grab>,
    time: f64,
    version: u64,
}

impl World {
    /// A robot alone, at time zero.
    pub fn new(kinematics: Kinematics, world_from_robot: Pose, q: Configuration) -> Self {
        Self {
            kinematics,
            world_from_robot,
            q,
            bodies: TypedVec::new(),
            grabs: Vec::new(),
            time: 0.0,
            version: 0,
        }
    }

    /// The start of a task: its objects in order, then its obstacles.
    pub fn of_task(task: &Task, kinematics: Kinematics) -> Self {
        let mut world = Self::new(kinematics, task.world_from_robot, task.start.clone());
        for object in &task.objects {
            world.add(&object.name, object.geometry.clone(), object.world_from_object);
        }
        for obstacle in &task.obstacles {
            world.add(&obstacle.name, obstacle.geometry.clone(), obstacle.world_from_obstacle);
        }
        world
    }

    /// Adds a body.
    pub fn add(&mut self, name: &str, geometry: Arc<Vec<Geometry>>, world_from_body: Pose) -> BodyIdx {
        self.version += 1;
        self.bodies.push(Body { name: name.to_owned(), geometry, world_from_body, enabled: true })
    }

    /// The robot's model and calibration.
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// Where the robot stands.
    pub fn world_from_robot(&self) -> &Pose {
        &self.world_from_robot
    }

    /// Joint values of the robot.
    pub fn q(&self) -> &Configuration {
        &self.q
    }

    /// All bodies.
    pub fn bodies(&self) -> &TypedVec<BodyIdx, Body> {
        &self.bodies
    }

    /// What is held, in the order in which it was grabbed.
    pub fn grabs(&self) -> &[Grab] {
        &self.grabs
    }

    /// Seconds; what the clock that stamps this world counts from is its owner's business.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Grows with every change, so that two snapshots of one world can be told apart.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// The body of this name.
    pub fn body_named(&self, name: &str) -> Option<BodyIdx> {
        self.bodies.position(|body| body.name == name)
    }

    /// Pose of a link in the world.
    pub fn world_from_link(&self, link: LinkIdx) -> Pose {
        self.world_from_robot * self.kinematics.root_from_link(&self.q, link)
    }

    /// Sets the time stamp.
    pub fn set_time(&mut self, time: f64) {
        self.time = time;
        self.version += 1;
    }

    /// Moves the joints, and with them what is held.
    pub fn set_q(&mut self, q: Configuration) {
        self.q = q;
        self.carry();
    }

    /// Moves the robot as a whole, and with it what is held.
    pub fn set_world_from_robot(&mut self, world_from_robot: Pose) {
        self.world_from_robot = world_from_robot;
        self.carry();
    }

    fn carry(&mut self) {
        self.version += 1;
        for i in 0..self.grabs.len() {
            let Grab { body, link, link_from_body, .. } = self.grabs[i];
            self.bodies[body].world_from_body = self.world_from_link(link) * link_from_body;
        }
    }

    /// Moves a body. One that is held is let go first.
    pub fn place(&mut self, body: BodyIdx, world_from_body: Pose) {
        self.release(body);
        self.bodies[body].world_from_body = world_from_body;
        self.version += 1;
    }

    /// Lets a body take part in collisions and be seen, or not.
    pub fn set_enabled(&mut self, body: BodyIdx, enabled: bool) {
        self.bodies[body].enabled = enabled;
        self.version += 1;
    }

    /// From now on the body moves with the link. `touching` are the links that touch it now; a body that is held already
    /// changes hands.
    pub fn grab(&mut self, body: BodyIdx, link: LinkIdx, mut touching: Vec<LinkIdx>) {
        self.release(body);
        touching.sort();
        touching.dedup();
        let link_from_body = self.world_from_link(link).inverse() * self.bodies[body].world_from_body;
        self.grabs.push(Grab { body, link, link_from_body, touching });
        self.version += 1;
    }

    /// The body stays where it is. Nothing happens when it is not held.
    pub fn release(&mut self, body: BodyIdx) {
        self.grabs.retain(|grab| grab.body != body);
        self.version += 1;
    }

    /// Does something with the world and puts everything back: joints, poses, grabs, flags and time. The version goes on
    /// growing, so that what was seen inside cannot be taken for the present.
    pub fn scoped<R>(&mut self, work: impl FnOnce(&mut Self) -> R) -> R {
        let before = self.clone();
        let result = work(self);
        let version = self.version + 1;
        *self = Self { version, ..before };
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ids::{DofIdx, Idx};
    use crate::model::{DynamicLimits, JointMotion, Origin, RobotBuilder};

    fn world() -> (World, BodyIdx, LinkIdx) {
        let mut builder = RobotBuilder::new("crane");
        builder.link("base", vec![], vec![], None).link("hook", vec![], vec![], None);
        let limits = (-1.0, 1.0, false, DynamicLimits::DEFAULT);
        let z = [0.0, 0.0, 1.0];
        builder.moving("lift", JointMotion::Prismatic, "base", "hook", Origin::default(), z, limits, None);
        let model = Arc::new(builder.build().unwrap());
        let hook = model.link_named("hook").unwrap();
        let q = Configuration::neutral(&model);
        let mut world = World::new(Kinematics::new(model), Pose::translation(1.0, 0.0, 0.0), q);
        let load = world.add("load", Arc::new(vec![]), Pose::translation(1.0, 0.0, -0.5));
        (world, load, hook)
    }

    fn lifted(world: &World, height: f64) -> Configuration {
        let mut q = world.q().clone();
        q[DofIdx::new(0)] = height;
        q
    }

    #[test]
    fn what_is_held_moves_with_the_link_and_stays_when_released() {
        let (mut world, load, hook) = world();
        world.grab(load, hook, vec![hook, hook]);
        assert_eq!(world.grabs()[0].touching, [hook]);
        world.set_q(lifted(&world, 0.3));
        assert!((world.bodies()[load].world_from_body.translation.z + 0.2).abs() < 1e-12);
        world.set_world_from_robot(Pose::translation(2.0, 0.0, 0.0));
        assert!((world.bodies()[load].world_from_body.translation.x - 2.0).abs() < 1e-12);
        world.release(load);
        world.set_q(lifted(&world, -0.3));
        assert!((world.bodies()[load].world_from_body.translation.z + 0.2).abs() < 1e-12);
    }

    #[test]
    fn a_scope_restores_everything_but_the_version() {
        let (mut world, load, hook) = world();
        let (q, version) = (world.q().clone(), world.version());
        world.scoped(|inner| {
            inner.grab(load, hook, vec![]);
            inner.set_q(lifted(inner, 0.5));
            inner.set_enabled(load, false);
            inner.set_time(9.0);
        });
        assert_eq!((world.q(), world.time(), world.grabs().len()), (&q, 0.0, 0));
        assert!(world.bodies()[load].enabled && world.version() > version);
        assert_eq!(world.bodies()[load].world_from_body, Pose::translation(1.0, 0.0, -0.5));
    }

    #[test]
    fn clones_share_shapes_and_nothing_else() {
        let (mut world, load, _) = world();
        let before = world.clone();
        world.place(load, Pose::identity());
        assert_ne!(before.bodies()[load].world_from_body, world.bodies()[load].world_from_body);
        assert!(Arc::ptr_eq(&before.bodies()[load].geometry, &world.bodies()[load].geometry));
    }
}
