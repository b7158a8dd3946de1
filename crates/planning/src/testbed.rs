//! A small arm with closed-form inverse kinematics for tests: shoulder, elbow, spherical wrist, two-finger gripper,
//! and if wanted a rail under it that makes it redundant.

use std::sync::Arc;

use nalgebra::{Rotation3, Vector3};
use robotc_core::geom::{ConvexParts, box_part};
use robotc_core::ik::{IkSolutions, InverseKinematics};
use robotc_core::model::{
    DynamicLimits, Geometry, JointMotion, Link, Origin, RobotBuilder, RobotModel, Shape,
};
use robotc_core::robot::{Arm, Base, Gripper, Hold, Preshape, Robot};
use robotc_core::world::World;
use robotc_core::{Configuration, DofIdx, Kinematics, LinkIdx, Pose, TypedVec};

use crate::arm::ArmModel;
use crate::constraint::Constraint;
use crate::edge::{EdgeChecker, Obstruction};
use crate::scene::{RobotChecker, Rules, Scene};
use crate::space::Space;

const SHOULDER: f64 = 0.4;
const UPPER: f64 = 0.5;
const FORE: f64 = 0.5;
const HAND: f64 = 0.1;
/// From the hand to the point between the finger tips.
const TOOL: f64 = 0.12;
/// Half the opening of the fingers.
pub(crate) const OPEN: f64 = 0.05;

/// A bent configuration with the tool pointing forward and down (without the rail).
pub(crate) const REST: [f64; 6] = [0.0, -1.6, 1.9, 0.0, 1.2, 0.0];

fn shape(xyz: [f64; 3], size: [f64; 3]) -> Vec<Geometry> {
    let origin = Origin { xyz, rpy: [0.0; 3] };
    vec![Geometry { origin, shape: Shape::Box { size }, colour: None }]
}

fn limits(range: f64) -> (f64, f64, bool, DynamicLimits) {
    let dynamics = DynamicLimits { velocity: 2.0, acceleration: 8.0, ..DynamicLimits::DEFAULT };
    (-range, range, false, dynamics)
}

/// The arm: x forward when straight, joints about z, y, y, x, y, x.
pub(crate) fn model(rail: bool) -> RobotModel {
    model_on(false, rail)
}

/// The arm, bolted down or with joints by which its base drives.
fn model_on(wheels: bool, rail: bool) -> RobotModel {
    let mut b = RobotBuilder::new("testbed");
    if wheels {
        for name in ["floor", "along_x", "along_y"] {
            b.link(name, vec![], vec![], None);
        }
        let mut drive = |name: &str, motion, parent: &str, child: &str, axis, range| {
            b.moving(name, motion, parent, child, Origin::default(), axis, limits(range), None);
        };
        drive("drive_x", JointMotion::Prismatic, "floor", "along_x", [1.0, 0.0, 0.0], 5.0);
        drive("drive_y", JointMotion::Prismatic, "along_x", "along_y", [0.0, 1.0, 0.0], 5.0);
        drive("drive_turn", JointMotion::Revolute, "along_y", "base", [0.0, 0.0, 1.0], 6.0);
    }
    b.link("base", vec![], shape([0.0, 0.0, 0.15], [0.15, 0.15, 0.3]), None);
    b.link("column", vec![], vec![], None);
    b.link("shoulder", vec![], shape([0.0, 0.0, -0.02], [0.08, 0.08, 0.08]), None);
    b.link("upper", vec![], shape([0.5 * UPPER, 0.0, 0.0], [UPPER - 0.12, 0.08, 0.08]), None);
    b.link("fore", vec![], shape([0.5 * FORE, 0.0, 0.0], [FORE - 0.12, 0.06, 0.06]), None);
    b.link("wrist1", vec![], vec![], None);
    b.link("wrist2", vec![], shape([0.0; 3], [0.05, 0.05, 0.05]), None);
    b.link("hand", vec![], shape([0.5 * HAND, 0.0, 0.0], [0.04, 0.12, 0.05]), None);
    let finger = |y: f64| shape([HAND + 0.5 * TOOL - 0.02, y, 0.0], [TOOL, 0.01, 0.02]);
    b.link("left", vec![], finger(0.005), None);
    b.link("right", vec![], finger(-0.005), None);
    let at = |x: f64, z: f64| Origin { xyz: [x, 0.0, z], rpy: [0.0; 3] };
    if rail {
        b.moving(
            "rail",
            JointMotion::Prismatic,
            "base",
            "column",
            at(0.0, 0.0),
            [0.0, 1.0, 0.0],
            limits(0.5),
            None,
        );
    } else {
        b.fixed("rail", "base", "column", at(0.0, 0.0));
    }
    let mut revolute = |name: &str, parent: &str, child: &str, origin, axis, range| {
        b.moving(name, JointMotion::Revolute, parent, child, origin, axis, limits(range), None);
    };
    revolute("j1", "column", "shoulder", at(0.0, SHOULDER), [0.0, 0.0, 1.0], 3.0);
    revolute("j2", "shoulder", "upper", at(0.0, 0.0), [0.0, 1.0, 0.0], 2.5);
    revolute("j3", "upper", "fore", at(UPPER, 0.0), [0.0, 1.0, 0.0], 2.7);
    revolute("j4", "fore", "wrist1", at(FORE, 0.0), [1.0, 0.0, 0.0], 4.0);
    revolute("j5", "wrist1", "wrist2", at(0.0, 0.0), [0.0, 1.0, 0.0], 2.2);
    revolute("j6", "wrist2", "hand", at(0.0, 0.0), [1.0, 0.0, 0.0], 4.0);
    let opening =
        (0.0, OPEN, false, DynamicLimits { velocity: 0.2, acceleration: 1.0, ..DynamicLimits::DEFAULT });
    b.moving("finger", JointMotion::Prismatic, "hand", "left", at(0.0, 0.0), [0.0, 1.0, 0.0], opening, None);
    let follow = Some(("finger".to_owned(), -1.0, 0.0));
    b.moving(
        "finger2",
        JointMotion::Prismatic,
        "hand",
        "right",
        at(0.0, 0.0),
        [0.0, 1.0, 0.0],
        opening,
        follow,
    );
    b.build().expect("the test arm is a robot")
}

/// The arm with its gripper, resting at [`REST`].
pub(crate) fn robot(rail: bool) -> Robot {
    robot_of(model(rail), rail)
}

/// The arm without rail on a base that drives, half a metre to each side.
pub(crate) fn mobile_robot() -> Robot {
    let robot = robot_of(model_on(true, false), false);
    let dof = |name: &str| robot.model.dof_named(name).expect("a joint of the base");
    let joints = Some([dof("drive_x"), dof("drive_y"), dof("drive_turn")]);
    let footprint = vec![[0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5]];
    Robot { base: Base::Planar { footprint, holonomic: true, joints }, ..robot }
}

fn robot_of(model: RobotModel, rail: bool) -> Robot {
    let link = |name: &str| model.link_named(name).expect("a link of the test arm");
    let dof = |name: &str| model.dof_named(name).expect("a joint of the test arm");
    let names = ["rail", "j1", "j2", "j3", "j4", "j5", "j6"];
    let dofs = names.iter().filter_map(|n| model.dof_named(n)).collect();
    let home = if rail { [&[0.0], &REST[..]].concat() } else { REST.to_vec() };
    let adjacent = [("base", "shoulder"), ("shoulder", "upper"), ("upper", "fore"), ("fore", "wrist2")];
    let hand = [("fore", "hand"), ("wrist2", "hand"), ("hand", "left"), ("hand", "right"), ("left", "right")];
    let mut ignored_pairs: Vec<_> = adjacent
        .iter()
        .chain(&hand)
        .map(|(a, b)| (link(a).min(link(b)), link(a).max(link(b))))
        .chain([(link("wrist2"), link("left")), (link("wrist2"), link("right"))])
        .collect();
    ignored_pairs.sort();
    Robot {
        arms: vec![Arm {
            name: "arm".into(),
            base: link("base"),
            tip: link("hand"),
            dofs,
            gripper: Some(0),
            free: rail.then(|| vec![dof("rail")]),
            home: Some(home),
        }],
        grippers: vec![Gripper {
            name: "hand".into(),
            palm: link("hand"),
            palm_from_tool: Pose::translation(HAND + TOOL - 0.04, 0.0, 0.0),
            approach_in_tool: Vector3::x_axis(),
            hold: Hold::Close,
            dofs: vec![dof("finger")],
            closing: vec![-1.0],
            fingers: vec![link("left"), link("right")],
            preshapes: vec![Preshape { name: "open".into(), values: vec![OPEN] }],
        }],
        cameras: vec![],
        base: Base::Fixed,
        ignored_pairs,
        weights: vec![],
        model: Arc::new(model),
    }
}

/// Everything at rest, fingers open.
pub(crate) fn rest(robot: &Robot) -> Configuration {
    let mut q = Configuration::neutral(&robot.model);
    q.set(&robot.arms[0].dofs, robot.arms[0].home.as_ref().expect("the test arm has a home"));
    q.set(&robot.grippers[0].dofs, &[OPEN]);
    q
}

/// The arm at the world's origin.
pub(crate) fn arm(rail: bool) -> ArmModel {
    arm_with(rail, Arc::new(ClosedForm { rail }))
}

/// The arm with another solver.
pub(crate) fn arm_with(rail: bool, ik: Arc<dyn InverseKinematics>) -> ArmModel {
    arm_of(&robot(rail), ik)
}

/// The arm of one of these robots.
pub(crate) fn arm_of(robot: &Robot, ik: Arc<dyn InverseKinematics>) -> ArmModel {
    let kinematics = Kinematics::new(robot.model.clone());
    let weights = vec![1.0; robot.arms[0].dofs.len()];
    ArmModel::new(robot, &kinematics, 0, ik, &weights, &Pose::identity(), &rest(robot))
        .expect("the test arm has a chain")
}

/// Wrist centre by law of cosines, then the wrist's rotation as x, y, x angles.
pub(crate) struct ClosedForm {
    pub(crate) rail: bool,
}

impl InverseKinematics for ClosedForm {
    fn variables(&self) -> usize {
        if self.rail { 7 } else { 6 }
    }

    fn free_variables(&self) -> &[usize] {
        if self.rail { &[0] } else { &[] }
    }

    fn solve(&self, base_from_tip: &Pose, free: &[f64], out: &mut IkSolutions) {
        out.reset(self.variables());
        let p = base_from_tip.translation.vector - Vector3::y() * free.first().copied().unwrap_or(0.0);
        let yaw = p.y.atan2(p.x);
        let z = p.z - SHOULDER;
        for (q1, r) in [(yaw, p.x.hypot(p.y)), (flip(yaw), -p.x.hypot(p.y))] {
            let cos3 = (r * r + z * z - UPPER * UPPER - FORE * FORE) / (2.0 * UPPER * FORE);
            if cos3.abs() > 1.0 {
                continue;
            }
            for q3 in [cos3.acos(), -cos3.acos()] {
                // Pitch turns x down: the point at angle q in the plane is (cos q, -sin q).
                let q2 = (-z).atan2(r) - (FORE * q3.sin()).atan2(UPPER + FORE * q3.cos());
                let q2 = q2.sin().atan2(q2.cos());
                let turned = Rotation3::from_axis_angle(&Vector3::z_axis(), q1)
                    * Rotation3::from_axis_angle(&Vector3::y_axis(), q2 + q3);
                let m = turned.inverse() * base_from_tip.rotation.to_rotation_matrix();
                let q5 = m[(0, 0)].clamp(-1.0, 1.0).acos();
                let (q4, q6) = (m[(1, 0)].atan2(-m[(2, 0)]), m[(0, 1)].atan2(m[(0, 2)]));
                for wrist in [[q4, q5, q6], [flip(q4), -q5, flip(q6)]] {
                    let all =
                        [free.first().copied().unwrap_or(0.0), q1, q2, q3, wrist[0], wrist[1], wrist[2]];
                    out.push(&all[usize::from(!self.rail)..]);
                }
            }
        }
    }
}

fn flip(angle: f64) -> f64 {
    if angle > 0.0 { angle - std::f64::consts::PI } else { angle + std::f64::consts::PI }
}

/// Joint limits, and a constraint if there is one: nothing to collide with.
pub(crate) struct Limits<'a> {
    space: &'a Space,
    constraint: Option<&'a dyn Constraint>,
}

impl<'a> Limits<'a> {
    pub(crate) fn new(arm: &'a ArmModel) -> Self {
        Self { space: arm.space(), constraint: None }
    }

    pub(crate) fn with_constraint(self, constraint: &'a dyn Constraint) -> Self {
        Self { constraint: Some(constraint), ..self }
    }
}

impl EdgeChecker for Limits<'_> {
    fn space(&self) -> &Space {
        self.space
    }

    fn state(&mut self, q: &[f64]) -> Result<f64, Obstruction> {
        match (self.space.contains(q), self.constraint) {
            (false, _) => Err(Obstruction::Bounds),
            (true, Some(constraint)) if !constraint.holds(q) => Err(Obstruction::Constraint),
            _ => Ok(0.0),
        }
    }

    fn travel(&self, difference: &[f64]) -> f64 {
        let travel = difference.iter().map(|d| d.abs()).sum();
        self.constraint.map_or(travel, |c| travel.max(self.resolution() * c.size(difference)))
    }

    fn resolution(&self) -> f64 {
        0.02
    }
}

/// The arm at the origin among boxes, given by size and centre; bodies are numbered in this order.
pub(crate) fn scene(robot: &Robot, boxes: &[([f64; 3], [f64; 3])]) -> Scene {
    let kinematics = Kinematics::new(robot.model.clone());
    let mut world = World::new(kinematics, Pose::identity(), rest(robot));
    let mut body_parts = TypedVec::new();
    for (i, (size, at)) in boxes.iter().enumerate() {
        world.add(&format!("box{i}"), Arc::new(vec![]), Pose::translation(at[0], at[1], at[2]));
        body_parts.push(Arc::new(ConvexParts::new(vec![box_part(Vector3::from(*size))])));
    }
    let part = |g: &Geometry| match g.shape {
        Shape::Box { size } => box_part(Vector3::from(size)).transformed(&g.origin.pose()),
        _ => panic!("the test arm is made of boxes"),
    };
    let parts = |link: &Link| Arc::new(link.collisions.iter().map(part).collect());
    let link_parts: TypedVec<LinkIdx, Arc<ConvexParts>> = robot.model.links().iter().map(parts).collect();
    let links: Vec<LinkIdx> = robot.model.links().indices().collect();
    let self_pairs = links
        .iter()
        .flat_map(|&a| links.iter().map(move |&b| (a, b)))
        .filter(|pair| pair.0 < pair.1 && !robot.ignored_pairs.contains(pair))
        .collect();
    Scene::new(&world, &link_parts, &body_parts, self_pairs)
}

/// Motions of the arm with 2 mm of margin, looked at every 4 mm.
pub(crate) fn checker<'a>(scene: &'a Scene, arm: &'a ArmModel, q: &Configuration) -> RobotChecker<'a> {
    let rules = Rules { margin: 0.002, ..Rules::default() };
    RobotChecker::new(scene, arm.space(), arm.dofs(), q, rules, 0.004)
}

/// The joints of the arm and then the fingers.
pub(crate) fn arm_and_fingers(robot: &Robot) -> (Space, Vec<DofIdx>) {
    let dofs: Vec<DofIdx> = robot.arms[0].dofs.iter().chain(&robot.grippers[0].dofs).copied().collect();
    let axis = |dof: &DofIdx| {
        let d = &robot.model.dofs()[*dof];
        crate::space::Axis::bounded(d.lower, d.upper)
    };
    (Space::new(dofs.iter().map(axis).collect()), dofs)
}
