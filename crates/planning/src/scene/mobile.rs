//! The edge checker of a robot that drives on a plane and moves its joints.

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use robotc_core::{Configuration, DofIdx, LinkIdx, LinkPoses, Pose};

use super::checker::movers;
use super::{Movers, Rules, Scene};
use crate::edge::{EdgeChecker, Obstruction};
use crate::space::{Axis, Space};
use crate::travel::TravelBounds;

/// Motions of a base and some degrees of freedom at once. States are x, y and heading of the base in the world, and then
/// the joints; the base keeps the height that the robot has in the scene, and
/// stands upright.
pub struct MobileChecker<'a> {
    scene: &'a Scene,
    space: Space,
    dofs: &'a [DofIdx],
    movers: Movers,
    bounds: TravelBounds,
    /// Farthest that any point of the robot or of what it holds is from the base's origin, metres.
    radius: f64,
    resolution: f64,
    rules: Rules,
    q: Configuration,
    poses: LinkPoses,
    states: u64,
}

/// Clearance beyond this is not looked for, metres.
const ROOM: f64 = 0.2;

impl<'a> MobileChecker<'a> {
    /// The base within `low` to `high` (x and y), and `dofs` with the axes of `joints`, the others as in `q`; bodies travel
    /// no more than `resolution` metres between two checked states.
    ///
    /// The metric counts metres of the base and radians of its heading as they are; weights of joints are those of `joints`.
    pub fn new(
        scene: &'a Scene,
        (low, high): ([f64; 2], [f64; 2]),
        joints: &Space,
        dofs: &'a [DofIdx],
        q: &Configuration,
        rules: Rules,
        resolution: f64,
    ) -> Self {
        let (bounds, of_joints) = movers(scene, dofs, &rules);
        let mut axes = vec![Axis::bounded(low[0], high[0]), Axis::bounded(low[1], high[1]), Axis::wrapping()];
        axes.extend_from_slice(joints.axes());
        let shaped = scene.links.enumerate().filter(|(_, shape)| !shape.is_empty());
        let mut radius: f64 = 0.0;
        let mut links: Vec<(LinkIdx, f64)> = Vec::new();
        for (link, shape) in shaped {
            radius = radius.max(bounds.reach(&scene.kinematics, link, shape.radius_about_origin()));
            // The base moves all of them, at full pace.
            links.push((link, 1.0));
        }
        if let Some(grip) = &rules.held {
            let offset = grip.link_from_body.translation.vector.norm();
            let held = scene.bodies[grip.body].shape.radius_about_origin() + offset;
            radius = radius.max(bounds.reach(&scene.kinematics, grip.link, held));
        }
        Self {
            scene,
            space: Space::new(axes),
            dofs,
            movers: Movers { links, held: 1.0, ..of_joints },
            bounds,
            radius,
            resolution,
            rules,
            q: q.clone(),
            poses: LinkPoses::default(),
            states: 0,
        }
    }

    /// Number of states looked at so far.
    pub fn states(&self) -> u64 {
        self.states
    }

    /// The links for which `only` is true, with the joints as they are in the configuration given: those that move with the base, but
    /// not with the arm, are checked first when a base is placed.
    pub fn carriage(&self, only: &dyn Fn(LinkIdx) -> bool) -> Carriage {
        let mut poses = LinkPoses::default();
        self.scene.kinematics.link_poses(&self.q, &mut poses);
        let links = self.movers.links.iter().filter(|(link, _)| only(*link)).copied().collect();
        let movers = Movers { links, held: 1.0, ..Movers::default() };
        let rules = Rules { held: None, ..self.rules.clone() };
        Carriage { poses, movers, rules }
    }

    fn world_from_robot(&self, base: &[f64]) -> Pose {
        world_from_robot(self.scene, base)
    }
}

/// Links that stand still on a base that drives.
pub struct Carriage {
    poses: LinkPoses,
    movers: Movers,
    rules: Rules,
}

impl Carriage {
    /// Whether these links are free in a scene with the base at x, y and heading.
    pub fn is_free(&self, scene: &Scene, base: &[f64; 3]) -> Result<(), Obstruction> {
        let robot = world_from_robot(scene, base);
        scene.against_bodies(&robot, &self.poses, &self.movers, &self.rules, 0.0)?;
        Ok(())
    }
}

/// The base at x, y and heading, as high as the robot is in the scene.
fn world_from_robot(scene: &Scene, base: &[f64]) -> Pose {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), base[2]);
    Pose::from_parts(Translation3::new(base[0], base[1], scene.world_from_robot.translation.z), turn)
}

impl EdgeChecker for MobileChecker<'_> {
    fn space(&self) -> &Space {
        &self.space
    }

    fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction> {
        self.states += 1;
        if !self.space.contains(q) {
            return Err(Obstruction::Bounds);
        }
        self.q.set(self.dofs, &q[3..]);
        self.scene.kinematics.link_poses(&self.q, &mut self.poses);
        let robot = self.world_from_robot(q);
        let room = self.scene.against_bodies(&robot, &self.poses, &self.movers, &self.rules, ROOM)?;
        Ok(self.scene.against_self(&self.poses, &self.movers, &self.rules, room)?)
    }

    fn travel(&self, difference: &[f64]) -> f64 {
        let drive = difference[0].hypot(difference[1]) + self.radius * difference[2].abs();
        drive + self.bounds.travel(&difference[3..])
    }

    fn resolution(&self) -> f64 {
        self.resolution
    }

    fn describe(&self, obstruction: Obstruction) -> String {
        self.scene.explain(obstruction, "a joint limit or the edge of the floor")
    }
}
